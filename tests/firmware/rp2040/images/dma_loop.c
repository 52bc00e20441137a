/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_auto.h"
#include "rp2040.h"

/*
 * examples/rp2040/a16_dma.c in a loop that comes round every SCRATCH2 us (0: as often as it can): this stands in the
 * place of its fathom_wait, by the linker. SCRATCH3 gets the time of the last reading, SCRATCH4 what the line counts as
 * bad bytes.
 */
fathom_status_t __wrap_fathom_wait(const fathom_sensor_t *sensor, fathom_sample_t *sample, fathom_idle_t idle,
                                   void *idle_ctx);

fathom_status_t __wrap_fathom_wait(const fathom_sensor_t *sensor, fathom_sample_t *sample, fathom_idle_t idle,
                                   void *idle_ctx)
{
    static uint32_t since_us;
    const uint32_t round_us = RP2040_WATCHDOG_SCRATCH(2);
    const fathom_line_t *const line = ((const fathom_dyp_auto_t *)sensor->ctx)->line;
    for (;;) {
        for (uint32_t passed_us; (passed_us = fathom_elapsed_us(RP2040_TIMER_RAWL, since_us)) < round_us;)
            idle(idle_ctx, round_us - passed_us);
        since_us = RP2040_TIMER_RAWL;
        const fathom_status_t status = fathom_poll(sensor, sample);
        if (status == FATHOM_OK) RP2040_WATCHDOG_SCRATCH(3) = sample->time_us;
        RP2040_WATCHDOG_SCRATCH(4) = line->parts->counters[FATHOM_LINE_BAD_BYTES];
        if (status != FATHOM_PENDING) return status;
    }
}
