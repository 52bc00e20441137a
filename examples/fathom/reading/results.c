/* SPDX-License-Identifier: MIT */
/* What is computed from the samples of each probe before they are reported: a median, then a level or an alarm. */
#include <string.h>

#include "reading/loop.h"

void results_config_copy(results_config_t *to, const results_config_t *from)
{
    *to = *from;
    if (from->tank.points != NULL) to->tank.points = to->points;
}

void results_start(sensor_t *sensor, uint32_t now_us)
{
    const results_config_t *const config = &sensor->processing;
    for (size_t p = 0; p != FATHOM_DYP_PROBES; p++) {
        result_probe_t *const probe = &sensor->probes[p];
        const fathom_median_config_t median = {.window = probe->window,
                                               .unknown_us = config->unknown_us,
                                               .gate_mm = config->gate_mm,
                                               .count = config->median};
        memset(probe, 0, sizeof *probe);
        if (config->median != 0) (void)fathom_median_init(&probe->median, &median);
        if (!config->has_alarm) continue;
        (void)fathom_alarm_init(&probe->alarm, &config->alarm);
        (void)fathom_alarm_add_status(&probe->alarm, FATHOM_PENDING, now_us);
        probe->began_us = now_us;
    }
}

static void report(loop_t *loop, sensor_t *sensor, result_t *result)
{
    const results_config_t *const config = &sensor->processing;
    const fathom_sample_t *const sample = &result->sample;
    result->has_level =
        config->has_level && sample->kind == FATHOM_TARGET &&
        fathom_level_from_distance(&config->tank, sample->distance_mm, &result->level) == FATHOM_OK;
    loop_report(loop, sensor, result);
}

static void report_change(loop_t *loop, sensor_t *sensor, result_t *result)
{
    result_probe_t *const probe = &sensor->probes[result->sample.probe - 1];
    probe->is_known = true;
    result->alarm = probe->alarm.state;
    result->is_on = fathom_alarm_is_on(&probe->alarm);
    report(loop, sensor, result);
}

/* Tells the alarm what was received at now_us instead of a distance. */
static void add_status(loop_t *loop, sensor_t *sensor, uint8_t number, fathom_status_t status,
                       uint32_t now_us)
{
    result_probe_t *const probe = &sensor->probes[number - 1];
    result_t result = {.sample = {.time_us = now_us,
                                  .kind = FATHOM_UNKNOWN,
                                  .model = (uint8_t)sensor->model->id,
                                  .address = sensor->address,
                                  .probe = number}};
    const bool has_changed = fathom_alarm_add_status(&probe->alarm, status, now_us);
    const bool is_late =
        !probe->is_known && fathom_elapsed_us(now_us, probe->began_us) > probe->alarm.config.unknown_us;
    if (has_changed || is_late) report_change(loop, sensor, &result);
}

/* Computes the median. False: there is none yet. A sample that the median ignores stays as it is. */
static bool add_to_median(result_probe_t *probe, fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_UNKNOWN || sample->kind == FATHOM_FAULT) return true;
    const bool has_median = fathom_median_add_sample(&probe->median, sample, sample);
    probe->dropped += probe->median.dropped;
    probe->median.dropped = 0;
    return has_median;
}

void results_sample(loop_t *loop, sensor_t *sensor, const fathom_sample_t *sample)
{
    const results_config_t *const config = &sensor->processing;
    result_probe_t *const probe = &sensor->probes[sample->probe - 1];
    result_t result = {.sample = *sample};
    const bool has_result = config->median == 0 || add_to_median(probe, &result.sample);
    if (has_result && (!config->has_alarm || config->has_readings)) report(loop, sensor, &result);
    if (!config->has_alarm) return;
    if (!has_result)
        add_status(loop, sensor, sample->probe, FATHOM_OK, sample->time_us);
    else if (fathom_alarm_add_sample(&probe->alarm, &result.sample))
        report_change(loop, sensor, &result);
}

/* A response whose value of one probe was refused is a response of all probes. */
void results_status(loop_t *loop, sensor_t *sensor, fathom_status_t status)
{
    if (!sensor->processing.has_alarm) return;
    const uint32_t now_us = (uint32_t)loop_now_us(loop);
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        if (sensor_has_probe(sensor, probe)) add_status(loop, sensor, probe, status, now_us);
}
