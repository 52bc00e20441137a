/* SPDX-License-Identifier: MIT */
/* Sleeps that are over before they have begun. */
#include "check.h"
#include "fathom_mps2.h"
#include "start.h"

void timer0_interrupt(void) { fathom_mps2_timer0_interrupt(); }

int main(void)
{
    fathom_mps2_idle_t no_wake = {0, 0};
    fathom_mps2_clock_begin();
    return check_short_sleeps(fathom_mps2_idle, &no_wake);
}
