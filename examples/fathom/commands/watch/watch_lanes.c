/* SPDX-License-Identifier: MIT */
#include "commands/watch/watch_lanes.h"

#include <stdlib.h>
#include <string.h>

/* A step is as long as the user's interval, and not shorter than an eye can follow. */
enum { LEAST_STEP_US = 250000 };

/* How long a distance stands in the picture until the next outcome: as long as the last one took and half as long
 * again, but not for ever. */
enum { LONGEST_HOLD = 40 };

/* Over so long the rate is a mean. */
enum { RATE_US = 5000000 };

static const struct {
    char character;
    bool is_loss;
    const char *name;
} marks[MARKS] = {
    [MARK_NONE] = {' ', false, ""},
    [MARK_NO_TARGET] = {'-', false, "no target"},
    [MARK_INTERFERENCE] = {'~', false, "interference"},
    [MARK_UNKNOWN] = {'?', false, "unknown"},
    [MARK_TOO_NEAR] = {'n', false, "too near"},
    [MARK_FAR] = {'_', false, "far"},
    [MARK_NEAR] = {'N', false, "near"},
    [MARK_STALE] = {'s', true, "stale"},
    [MARK_NO_RESPONSE] = {'x', true, "no response"},
    [MARK_LINE_BUSY] = {'b', true, "line busy"},
    [MARK_OTHER_MASTER] = {'m', true, "other master"},
    [MARK_BAD_RESPONSE] = {'!', true, "unusable"},
    [MARK_FAULT] = {'F', false, "fault"},
    [MARK_PORT] = {'P', true, "port lost"},
};

char mark_character(mark_t mark) { return marks[mark].character; }

const char *mark_name(mark_t mark) { return marks[mark].name; }

bool mark_is_loss(mark_t mark) { return marks[mark].is_loss; }

static void init_lane(lanes_t *lanes, const sensor_t *sensor, uint8_t probe)
{
    lane_t *const lane = &lanes->lane[lanes->count++];
    const bool has_probes = sensor->model->probes > 1 && !sensor_is_contact(sensor);
    lane->sensor = sensor;
    lane->probe = probe;
    (void)snprintf(lane->name, sizeof lane->name, has_probes ? "%s probe %u" : "%s", sensor->name, probe);
    const size_t length = strlen(lane->name);
    if (length > lanes->name_width) lanes->name_width = (uint16_t)(length < MOST_NAME ? length : MOST_NAME);
}

bool lanes_init(lanes_t *lanes, const site_t *site)
{
    const uint32_t interval_us = site->sensors[0]->settings.period_us; /* of all sensors */
    lanes->step_us = interval_us > LEAST_STEP_US ? interval_us : LEAST_STEP_US;
    lanes->name_width = LEAST_NAME;
    lanes->lane = calloc(site->sensor_count * FATHOM_DYP_PROBES, sizeof *lanes->lane);
    if (lanes->lane == NULL) return false;
    for (size_t i = 0; i != site->sensor_count; i++)
        for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
            if (sensor_has_probe(site->sensors[i], probe)) init_lane(lanes, site->sensors[i], probe);
    return true;
}

void lanes_free(lanes_t *lanes)
{
    free(lanes->lane);
    lanes->lane = NULL;
}

static uint64_t number_now(const lanes_t *lanes) { return lanes->now_us / lanes->step_us; }

void lanes_pass(lanes_t *lanes, uint64_t now_us)
{
    const uint64_t before = number_now(lanes);
    lanes->now_us = now_us;
    const uint64_t passed = number_now(lanes) - before;
    for (size_t i = 0; i != lanes->count; i++)
        for (uint64_t n = passed < LANE_STEPS ? passed : LANE_STEPS; n != 0; n--)
            lanes->lane[i].steps[(number_now(lanes) - n + 1) % LANE_STEPS] = (step_t){.mark = MARK_NONE};
}

/* Does it stand until the next one? */
static bool is_held(mark_t mark) { return mark == MARK_NONE || mark == MARK_NEAR || mark == MARK_FAR; }

static uint8_t hold_of(const lanes_t *lanes, const lane_t *lane)
{
    const uint64_t gap_us = lane->has_outcome ? lanes->now_us - lane->heard_us : 0;
    const uint64_t steps = (gap_us * 3 / 2 + lanes->step_us) / lanes->step_us;
    return steps < LONGEST_HOLD ? (uint8_t)steps : LONGEST_HOLD;
}

/* Something has come for this lane: a distance if mark is MARK_NONE. */
static void add(lanes_t *lanes, lane_t *lane, mark_t mark, uint16_t distance_mm)
{
    step_t *const step = &lane->steps[number_now(lanes) % LANE_STEPS];
    if (mark > step->mark) step->mark = (uint8_t)mark;
    lanes->seen |= 1u << mark;
    if (mark == MARK_NONE) {
        step->has_distance = true;
        step->distance_mm = distance_mm;
    }
    step->hold = is_held(mark) ? hold_of(lanes, lane) : 0;
    if (!mark_is_loss(mark)) step->readings++;
    lane->heard_us = lanes->now_us;
    lane->has_outcome = true;
    lane->mark = mark;
    lane->distance_mm = distance_mm;
    lane->outcomes++;
    if (mark_is_loss(mark)) lane->lost++;
}

static mark_t mark_of_sample(const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    switch (sample->kind) {
    case FATHOM_NO_TARGET:
        return sample->interference ? MARK_INTERFERENCE : MARK_NO_TARGET;
    case FATHOM_UNKNOWN:
        return MARK_UNKNOWN;
    case FATHOM_NEAR:
        return sensor_is_contact(reading->sensor) ? MARK_NEAR : MARK_TOO_NEAR;
    case FATHOM_FAR:
        return MARK_FAR;
    case FATHOM_FAULT:
        return MARK_FAULT;
    default:
        return MARK_NONE;
    }
}

static mark_t mark_of_failure(fathom_status_t status)
{
    switch (status) {
    case FATHOM_ERR_NO_RESPONSE:
    case FATHOM_ERR_ECHO:
        return MARK_NO_RESPONSE;
    case FATHOM_ERR_LINE_BUSY:
        return MARK_LINE_BUSY;
    case FATHOM_ERR_OTHER_MASTER:
        return MARK_OTHER_MASTER;
    case FATHOM_ERR_STALE:
        return MARK_STALE;
    case FATHOM_ERR_PORT:
        return MARK_PORT;
    default:
        return MARK_BAD_RESPONSE;
    }
}

/* A port that is waited for is no attempt. */
static void add_absence(const lanes_t *lanes, lane_t *lane)
{
    lane->mark = MARK_PORT;
    lane->has_outcome = true;
    lane->steps[number_now(lanes) % LANE_STEPS].mark = MARK_PORT;
}

void lanes_add(lanes_t *lanes, const reading_t *reading)
{
    const bool is_good = reading->failure == NULL;
    const fathom_sample_t *const sample = &reading->result->sample;
    const failure_t *const evidence = reading->evidence;
    const bool is_of_one = is_good || (evidence != NULL && !evidence->is_whole && sample->probe != 0);
    for (size_t i = 0; i != lanes->count; i++) {
        lane_t *const lane = &lanes->lane[i];
        if (lane->sensor != reading->sensor || (is_of_one && lane->probe != sample->probe)) continue;
        if (is_good)
            add(lanes, lane, mark_of_sample(reading), sample->distance_mm);
        else if (evidence != NULL)
            add(lanes, lane, mark_of_failure(reading->status), 0);
        else
            add_absence(lanes, lane);
    }
}

static bool is_empty(const step_t *step) { return !step->has_distance && step->mark == MARK_NONE; }

step_t lane_step(const lanes_t *lanes, const lane_t *lane, uint32_t ago)
{
    step_t shown = {.mark = MARK_NONE};
    const uint64_t now = number_now(lanes);
    for (uint64_t held = 0; held <= LONGEST_HOLD && ago + held < LANE_STEPS && ago + held <= now; held++) {
        const step_t *const step = &lane->steps[(now - ago - held) % LANE_STEPS];
        if (is_empty(step)) continue;
        if (held == 0 || held <= step->hold) shown = *step;
        if (held != 0 && !is_held((mark_t)step->mark)) shown.mark = MARK_NONE; /* of its own step only */
        return shown;
    }
    return shown;
}

uint32_t lane_rate_tenths(const lanes_t *lanes, const lane_t *lane)
{
    const uint64_t now = number_now(lanes);
    uint64_t steps = RATE_US / lanes->step_us + 1;
    uint64_t readings = 0;
    if (steps > now + 1) steps = now + 1;
    if (steps > LANE_STEPS) steps = LANE_STEPS;
    for (uint64_t n = 0; n != steps; n++) readings += lane->steps[(now - n) % LANE_STEPS].readings;
    const uint64_t over_us = (steps - 1) * lanes->step_us + lanes->now_us % lanes->step_us;
    return over_us != 0 ? (uint32_t)(readings * 10000000u / over_us) : 0;
}

const char *lane_value(const lane_t *lane, char text[LANE_VALUE])
{
    if (!lane->has_outcome)
        (void)snprintf(text, LANE_VALUE, "waiting");
    else if (lane->mark == MARK_NONE)
        (void)snprintf(text, LANE_VALUE, "%u.%03u m", lane->distance_mm / 1000u, lane->distance_mm % 1000u);
    else
        (void)snprintf(text, LANE_VALUE, "%s", mark_name(lane->mark));
    return text;
}
