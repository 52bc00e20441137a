#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Images of port/stm32f4 that check themselves, in simulated time."""
import qemu

qemu.alone(
    the_clock_is_right_across_its_wrap_and_a_sleep_ends=('clock', 6),
    every_usart_is_where_it_is_and_is_set_as_it_was_told=('settings', 44))
