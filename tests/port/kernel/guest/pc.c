/* SPDX-License-Identifier: MIT */
#include "pc.h"

int main(void)
{
    guest_begin();
    guest_run(pc_port_cases, pc_port_case_count);
    guest_run(pc_sensor_cases, pc_sensor_case_count);
    guest_end();
    return 0;
}
