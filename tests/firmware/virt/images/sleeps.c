/* SPDX-License-Identifier: MIT */
/* Sleeps that are over before they have begun. */
#include "check.h"
#include "fathom_virt.h"
#include "start.h"

void timer_interrupt(void) { fathom_virt_timer_interrupt(); }

int main(void) { return check_short_sleeps(fathom_virt_idle, 0); }
