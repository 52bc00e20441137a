#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Images of port/stm32f4 that check themselves, in simulated time."""
import qemu


class Alone(qemu.Case):
    def test_the_clock_is_right_across_its_wrap_and_a_sleep_ends(self):
        self.self_test('clock', 6)

    def test_every_usart_is_where_it_is_and_is_set_as_it_was_told(self):
        self.self_test('settings', 44)


if __name__ == '__main__':
    qemu.main()
