/* SPDX-License-Identifier: MIT */
#include "reading/run.h"

#include "output/words.h"

uint64_t loop_now_us(const loop_t *loop) { return loop->host->now_us(loop->host->ctx); }

uint64_t loop_time_us(const loop_t *loop) { return loop_now_us(loop) - loop->start_us; }

uint64_t loop_sample_us(const loop_t *loop, uint32_t sample_us)
{
    return time_extend(loop_now_us(loop), sample_us) - loop->start_us;
}

uint64_t loop_utc_us(const loop_t *loop, uint64_t time_us)
{
    return loop->host->utc_us(loop->host->ctx) - (loop_time_us(loop) - time_us);
}

bool loop_is_over(const loop_t *loop)
{
    const host_t *const host = loop->host;
    const uint64_t duration_us = loop->site.duration_us;
    return loop->is_stopped || host->has_ended(host->ctx) || host->is_output_gone(host->ctx) ||
           loop->lines_left == 0 || (duration_us != 0 && loop_time_us(loop) >= duration_us);
}
