#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Images of port/virt that check themselves, in simulated time."""
import qemu


class Alone(qemu.Case):
    def test_the_clock_is_right_across_its_wrap_and_so_is_the_sleep(self):
        self.self_test('clock', 16)

    def test_the_uart_takes_what_it_can_be_set_to(self):
        self.self_test('settings', 30)

    def test_a_sleep_that_is_over_before_it_has_begun_ends(self):
        self.self_test('sleeps', 1, shift=10)


if __name__ == '__main__':
    qemu.main()
