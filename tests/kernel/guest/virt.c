/* SPDX-License-Identifier: MIT */
#include "virt.h"

int main(void)
{
    guest_case_t cases[64];
    size_t count = 0;
    for (size_t i = 0; i != virt_uart_case_count; i++) cases[count++] = virt_uart_cases[i];
    for (size_t i = 0; i != virt_pins_case_count; i++) cases[count++] = virt_pins_cases[i];
    guest_run(cases, count);
    return 0;
}
