/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "sim/scene.h"
#include "sim/uart.h"

/* The simulator is there, with headers that include each other: it sees what was put there. */
int main(void)
{
    fathom_sim_fixed_t fixed = {{1234, 0, 0, 0}};
    const fathom_sim_scene_t scene = fathom_sim_fixed(&fixed);
    printf("%ld mm\n", (long)scene.distance(scene.ctx, 1, 0));
    return fathom_sim_clock_idle == NULL;
}
