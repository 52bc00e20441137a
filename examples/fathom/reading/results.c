/* SPDX-License-Identifier: MIT */
#include "reading/results.h"

#include <inttypes.h>
#include <string.h>

#include "reading/poll_attempt.h"

/* So late it may be noticed that an alarm has had no distance for unknown_us. */
enum { TICK_US = 100000 };

static bool is_same_tank(const results_config_t *one, const results_config_t *other)
{
    const fathom_level_config_t *const tank = &one->tank;
    const fathom_level_config_t *const that = &other->tank;
    for (size_t i = 0; i != tank->point_count; i++)
        if (one->points[i].level_mm != other->points[i].level_mm ||
            one->points[i].volume != other->points[i].volume)
            return false;
    return tank->volume == that->volume && tank->point_count == that->point_count &&
           tank->capacity == that->capacity && tank->mounting_mm == that->mounting_mm &&
           tank->height_mm == that->height_mm && tank->offset_mm == that->offset_mm;
}

static bool is_same_alarm(const fathom_alarm_config_t *one, const fathom_alarm_config_t *other)
{
    return one->when == other->when && one->on_mm == other->on_mm && one->off_mm == other->off_mm &&
           one->on_hold_us == other->on_hold_us && one->off_hold_us == other->off_hold_us &&
           one->unknown_us == other->unknown_us && one->if_unknown == other->if_unknown &&
           one->if_no_response == other->if_no_response &&
           one->no_target_is_unknown == other->no_target_is_unknown;
}

bool results_config_is_same(const results_config_t *one, const results_config_t *other)
{
    return one->median == other->median && one->gate_mm == other->gate_mm &&
           one->unknown_us == other->unknown_us && one->has_level == other->has_level &&
           one->has_alarm == other->has_alarm && one->has_readings == other->has_readings &&
           is_same_tank(one, other) && is_same_alarm(&one->alarm, &other->alarm);
}

void results_config_copy(results_config_t *to, const results_config_t *from)
{
    *to = *from;
    if (from->tank.points != NULL) to->tank.points = to->points;
}

static result_probe_t *probe_of(results_t *results, const station_t *station, uint8_t probe)
{
    return &results->probes[station->slot][probe - 1];
}

/* Is this one of its probes, and wanted? */
static bool has_probe(const station_t *station, uint8_t probe)
{
    const uint8_t wanted = station->settings.probes;
    return probe <= station->model->probes &&
           (station->model->probes == 1 || wanted == 0 || (wanted >> (probe - 1) & 1) != 0);
}

static void begin_probe(const results_config_t *config, result_probe_t *probe, uint32_t now_us)
{
    const fathom_median_config_t median = {.window = probe->window,
                                           .unknown_us = config->unknown_us,
                                           .gate_mm = config->gate_mm,
                                           .count = config->median};
    if (config->median != 0) (void)fathom_median_init(&probe->median, &median);
    if (!config->has_alarm) return;
    (void)fathom_alarm_init(&probe->alarm, &config->alarm);
    probe->began_us = now_us;
    (void)fathom_alarm_add_status(&probe->alarm, FATHOM_PENDING, now_us);
}

void results_begin(results_t *results, poll_loop_t *loop, results_tell_t tell, void *ctx)
{
    results->loop = loop;
    results->tell = tell;
    results->ctx = ctx;
}

void results_add(results_t *results, const station_t *station, const results_config_t *config)
{
    results->configs[station->slot] = config;
    memset(results->probes[station->slot], 0, sizeof results->probes[station->slot]);
    for (size_t p = 0; p != FATHOM_DYP_PROBES; p++)
        begin_probe(config, &results->probes[station->slot][p], (uint32_t)poll_now_us(results->loop));
}

static const results_config_t *config_of(const results_t *results, const station_t *station)
{
    return results->configs[station->slot];
}

static bool tell(const results_t *results, const station_t *station, result_t *result)
{
    const results_config_t *const config = config_of(results, station);
    const fathom_sample_t *const sample = &result->sample;
    result->has_level =
        config->has_level && sample->kind == FATHOM_TARGET &&
        fathom_level_from_distance(&config->tank, sample->distance_mm, &result->level) == FATHOM_OK;
    return results->tell(results->ctx, station, result);
}

static bool tell_change(const results_t *results, const station_t *station, result_probe_t *probe,
                        result_t *result)
{
    probe->is_known = true;
    result->alarm = probe->alarm.state;
    result->is_on = fathom_alarm_is_on(&probe->alarm);
    return tell(results, station, result);
}

/* For the alarm: what came instead of a distance, at now_us. */
static bool take_status(results_t *results, const station_t *station, uint8_t number, fathom_status_t status,
                        uint32_t now_us)
{
    result_probe_t *const probe = probe_of(results, station, number);
    result_t result = {.sample = {.time_us = now_us,
                                  .kind = FATHOM_UNKNOWN,
                                  .model = (uint8_t)station->model->id,
                                  .address = station->address,
                                  .probe = number}};
    const bool has_changed = fathom_alarm_add_status(&probe->alarm, status, now_us);
    const bool is_late =
        !probe->is_known && fathom_elapsed_us(now_us, probe->began_us) > probe->alarm.config.unknown_us;
    return !has_changed && !is_late ? true : tell_change(results, station, probe, &result);
}

/* Makes the median of the sample. False: there is none. What the median leaves out stays as it came. */
static bool take_median(result_probe_t *probe, fathom_sample_t *sample)
{
    if (sample->kind == FATHOM_UNKNOWN || sample->kind == FATHOM_FAULT) return true;
    const bool has_median = fathom_median_add_sample(&probe->median, sample, sample);
    probe->dropped += probe->median.dropped;
    probe->median.dropped = 0;
    return has_median;
}

bool results_sample(results_t *results, const station_t *station, const fathom_sample_t *sample)
{
    const results_config_t *const config = config_of(results, station);
    result_probe_t *const probe = probe_of(results, station, sample->probe);
    result_t result = {.sample = *sample};
    const bool is_there = config->median == 0 || take_median(probe, &result.sample);
    const bool is_told = is_there && (!config->has_alarm || config->has_readings);
    if (is_told && !tell(results, station, &result)) return false;
    if (!config->has_alarm) return true;
    if (!is_there) return take_status(results, station, sample->probe, FATHOM_OK, sample->time_us);
    if (!fathom_alarm_add_sample(&probe->alarm, &result.sample)) return true;
    return tell_change(results, station, probe, &result);
}

/* Of all its probes: where the value of one was refused, it is a response of all. */
static void take_status_of_all(results_t *results, const station_t *station, fathom_status_t status)
{
    const uint32_t now_us = (uint32_t)poll_now_us(results->loop);
    for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
        if (has_probe(station, probe)) (void)take_status(results, station, probe, status, now_us);
}

void results_failure(results_t *results, const station_t *station, fathom_status_t status)
{
    if (config_of(results, station)->has_alarm) take_status_of_all(results, station, status);
}

uint32_t results_tick(results_t *results)
{
    const sensor_options_t *const options = &results->loop->options;
    bool has_alarm = false;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        if (!config_of(results, station)->has_alarm) continue;
        has_alarm = true;
        if (!poll_is_done(results->loop, station)) take_status_of_all(results, station, FATHOM_PENDING);
    }
    return has_alarm ? TICK_US : FATHOM_NO_DEADLINE;
}

uint64_t results_dropped(const results_t *results)
{
    uint64_t dropped = 0;
    const sensor_options_t *const options = &results->loop->options;
    for (size_t i = 0; i != options->station_count; i++)
        for (size_t p = 0; p != FATHOM_DYP_PROBES; p++)
            dropped += results->probes[options->stations[i]->slot][p].dropped;
    return dropped;
}

void results_print_dropped(const results_t *results, FILE *to)
{
    const sensor_options_t *const options = &results->loop->options;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        for (size_t p = 0; p != FATHOM_DYP_PROBES; p++) {
            const uint64_t dropped = results->probes[station->slot][p].dropped;
            if (dropped == 0) continue;
            (void)fprintf(to, "fathom: %s", station->name);
            if (station->model->probes > 1) (void)fprintf(to, " probe %u", (unsigned)p + 1);
            (void)fprintf(to, ": spikes dropped %" PRIu64 "\n", dropped);
        }
    }
}
