#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Images of port/mps2 that check themselves, in simulated time."""
import qemu


class Alone(qemu.Case):
    def test_the_clock_is_right_across_its_wrap_and_so_is_the_sleep(self):
        self.self_test('clock', 8)

    def test_every_uart_is_where_it_is_and_takes_what_it_can_be_set_to(self):
        self.self_test('settings', 34)

    def test_a_sleep_that_is_over_before_it_has_begun_ends(self):
        self.self_test('sleeps', 1, shift=10)


if __name__ == '__main__':
    qemu.main()
