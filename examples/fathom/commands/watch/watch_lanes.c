/* SPDX-License-Identifier: MIT */
#include "commands/watch/watch_lanes.h"

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

static bool is_contact(const station_t *station) { return station->mode->is_contact; }

void lanes_begin(lanes_t *lanes, const sensor_options_t *options)
{
    const uint32_t interval_us = options->stations[0]->settings.period_us; /* which all have */
    lanes->step_us = interval_us > LEAST_STEP_US ? interval_us : LEAST_STEP_US;
    lanes->count = 0;
    lanes->name_width = LEAST_NAME;
    lanes->now_us = 0;
    lanes->seen = 0;
    for (size_t i = 0; i != options->station_count; i++) {
        const station_t *const station = options->stations[i];
        const uint8_t probes = is_contact(station) ? 1 : station->model->probes;
        for (uint8_t probe = 1; probe <= probes; probe++) {
            const uint8_t wanted = station->settings.probes;
            if (probes > 1 && wanted != 0 && (wanted >> (probe - 1) & 1) == 0) continue;
            lane_t *const lane = &lanes->lane[lanes->count++];
            memset(lane, 0, sizeof *lane);
            lane->station = station;
            lane->probe = probe;
            (void)snprintf(lane->name, sizeof lane->name, probes > 1 ? "%s probe %u" : "%s", station->name,
                           probe);
            const size_t length = strlen(lane->name);
            if (length > lanes->name_width)
                lanes->name_width = (uint16_t)(length < MOST_NAME ? length : MOST_NAME);
        }
    }
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
static void take(lanes_t *lanes, lane_t *lane, mark_t mark, uint16_t distance_mm)
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

void lanes_reading(lanes_t *lanes, const station_t *station, const fathom_sample_t *sample)
{
    mark_t mark = MARK_NONE;
    if (sample->kind == FATHOM_NO_TARGET) mark = sample->interference ? MARK_INTERFERENCE : MARK_NO_TARGET;
    if (sample->kind == FATHOM_UNKNOWN) mark = MARK_UNKNOWN;
    if (sample->kind == FATHOM_NEAR) mark = is_contact(station) ? MARK_NEAR : MARK_TOO_NEAR;
    if (sample->kind == FATHOM_FAR) mark = MARK_FAR;
    if (sample->kind == FATHOM_FAULT) mark = MARK_FAULT;
    for (size_t i = 0; i != lanes->count; i++)
        if (lanes->lane[i].station == station && lanes->lane[i].probe == sample->probe)
            take(lanes, &lanes->lane[i], mark, sample->distance_mm);
}

void lanes_failure(lanes_t *lanes, const failure_t *failure, const station_t *station)
{
    const fathom_status_t status = failure->status;
    /* 0: it is the failure of all */
    const bool is_of_one = status == FATHOM_ERR_MALFORMED && !failure->is_whole;
    const uint8_t probe = is_of_one ? reader_facts(station->reader).refused_probe : 0;
    mark_t mark = MARK_BAD_RESPONSE;
    if (status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_ECHO) mark = MARK_NO_RESPONSE;
    if (status == FATHOM_ERR_LINE_BUSY) mark = MARK_LINE_BUSY;
    if (status == FATHOM_ERR_OTHER_MASTER) mark = MARK_OTHER_MASTER;
    if (status == FATHOM_ERR_STALE) mark = MARK_STALE;
    if (status == FATHOM_ERR_PORT) mark = MARK_PORT;
    for (size_t i = 0; i != lanes->count; i++)
        if (lanes->lane[i].station == station && (probe == 0 || lanes->lane[i].probe == probe))
            take(lanes, &lanes->lane[i], mark, 0);
}

void lanes_away(lanes_t *lanes, const station_t *station)
{
    for (size_t i = 0; i != lanes->count; i++) {
        if (lanes->lane[i].station != station) continue;
        lanes->lane[i].mark = MARK_PORT;
        lanes->lane[i].has_outcome = true;
        lanes->lane[i].steps[number_now(lanes) % LANE_STEPS].mark = MARK_PORT;
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
