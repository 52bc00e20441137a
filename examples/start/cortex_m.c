/* SPDX-License-Identifier: MIT */
#include "cortex_m.h"

extern uint32_t start_data_in_flash[], start_data[], start_data_end[], start_bss[], start_bss_end[];

int main(void);

void start_reset(void)
{
    const uint32_t *from = start_data_in_flash;
    for (uint32_t *to = start_data; to != start_data_end; to++) *to = *from++;
    for (uint32_t *to = start_bss; to != start_bss_end; to++) *to = 0;
    start_end(main());
    for (;;) {
    }
}

void start_fault(void)
{
    start_end(START_FAULT);
    for (;;) {
    }
}
