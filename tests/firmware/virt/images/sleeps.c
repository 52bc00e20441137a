/* SPDX-License-Identifier: MIT */
/* Sleeps that are over before they have begun: the test runs this with 1 us an instruction, so that every place on the
 * way to WFI is one at which the time may be up. Where that loses the alarm the sleep does not end. */
#include "check.h"
#include "fathom_virt.h"
#include "start.h"

void timer_interrupt(void) { fathom_virt_timer_interrupt(); }

int main(void)
{
    for (uint32_t us = 1; us <= 200; us++) fathom_virt_idle(0, us);
    check(true, "200 short sleeps have ended");
    return check_result();
}
