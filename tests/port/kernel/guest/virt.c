/* SPDX-License-Identifier: MIT */
#include "virt.h"

int main(void)
{
    guest_begin();
    guest_run(virt_uart_cases, virt_uart_case_count);
    guest_run(virt_pins_cases, virt_pins_case_count);
    guest_end();
    return 0;
}
