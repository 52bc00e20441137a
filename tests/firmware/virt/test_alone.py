#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Images for the port virt that check themselves, in simulated time."""
import qemu

qemu.alone(
    the_clock_is_right_across_its_wrap_and_so_is_the_sleep=('clock', 16),
    the_uart_takes_what_it_can_be_set_to=('settings', 30),
    a_sleep_that_is_over_before_it_has_begun_ends=('sleeps', 1, 10))
