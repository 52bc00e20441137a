/* SPDX-License-Identifier: MIT */
#include "suite.h"

/* Every suite of the program; a microcontroller is called with no arguments. */
int main(void)
{
    stand_in_left_out = FATHOM_LEFT_OUT;
    return suite_run(0, NULL);
}
