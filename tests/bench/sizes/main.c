/* SPDX-License-Identifier: MIT */
#include "programs.h"

/* PROGRAM_begin and PROGRAM_use of the program that this is built for. */
fathom_sensor_t BEGIN(void);
void USE(const fathom_sample_t *sample);

int main(void)
{
    const fathom_sensor_t sensor = BEGIN();
    for (;;) {
        fathom_sample_t sample;
        if (fathom_poll(&sensor, &sample) == FATHOM_OK) USE(&sample);
    }
}
