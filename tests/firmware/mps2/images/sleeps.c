/* SPDX-License-Identifier: MIT */
/* Sleeps that are over before they have begun: the test runs this with 1 us an instruction, so that every place on the
 * way to WFI is one at which the time may be up. Where that loses the alarm the sleep does not end. */
#include "check.h"
#include "fathom_mps2.h"
#include "start.h"

void timer0_interrupt(void) { fathom_mps2_timer0_interrupt(); }

int main(void)
{
    fathom_mps2_idle_t nobody = {0, 0};
    fathom_mps2_clock_begin();
    for (uint32_t us = 1; us <= 200; us++) fathom_mps2_idle(&nobody, us);
    check(true, "200 short sleeps have ended");
    return check_result();
}
