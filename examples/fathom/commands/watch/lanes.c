/* SPDX-License-Identifier: MIT */
#include "commands/watch/lanes.h"

#include <inttypes.h>
#include <string.h>

#include "output/words.h"

/* A step lasts as long as the user's interval, but not shorter than an eye can follow. A distance is shown for as long as
 * the last gap and half of it, at most LONGEST_HOLD steps. The rate is a mean of RATE_US. */
enum { LEAST_STEP_US = 250000, LONGEST_HOLD = 40, RATE_US = 5000000 };

const mark_row_t marks[MARKS + 1] = {
    [MARK_NONE] = {' ', false, false, ""},
    [MARK_NO_TARGET] = {'-', false, false, "no target"},
    [MARK_INTERFERENCE] = {'~', false, false, "interference"},
    [MARK_UNKNOWN] = {'?', false, true, "unknown"},
    [MARK_TOO_NEAR] = {'n', false, true, "too near"},
    [MARK_FAR] = {'_', false, true, "far"},
    [MARK_NEAR] = {'N', false, true, "near"},
    [MARK_STALE] = {'s', true, false, "stale"},
    [MARK_NO_RESPONSE] = {'x', true, false, "no response"},
    [MARK_LINE_BUSY] = {'b', true, true, "line busy"},
    [MARK_OTHER_MASTER] = {'m', true, true, "other master"},
    [MARK_BAD_RESPONSE] = {'!', true, false, "unusable"},
    [MARK_FAULT] = {'F', false, false, "fault"},
    [MARK_PORT] = {'P', true, false, "port lost"},
    [MARK_WAITING] = {' ', false, false, "waiting"},
};

static void init_lane(lanes_t *lanes, const sensor_t *sensor, uint8_t probe)
{
    lane_t *const lane = &lanes->lane[lanes->count++];
    const bool has_probes = sensor->model->probes > 1 && !sensor_is_contact(sensor);
    lane->sensor = sensor;
    lane->probe = probe;
    lane->mark = MARK_WAITING;
    (void)snprintf(lane->name, sizeof lane->name, has_probes ? "%s probe %u" : "%s", sensor->name, probe);
    const int length = (int)strlen(lane->name);
    if (length > lanes->name_width) lanes->name_width = length < MOST_NAME ? length : MOST_NAME;
}

void lanes_init(lanes_t *lanes, const site_t *site)
{
    const uint32_t interval_us = site->sensors[0]->settings.period_us; /* of all sensors */
    lanes->step_us = interval_us > LEAST_STEP_US ? interval_us : LEAST_STEP_US;
    lanes->name_width = LEAST_NAME;
    lanes->lane = allocate(site->sensor_count * FATHOM_DYP_PROBES * sizeof *lanes->lane);
    for (size_t i = 0; i != site->sensor_count; i++)
        for (uint8_t probe = 1; probe <= FATHOM_DYP_PROBES; probe++)
            if (sensor_has_probe(site->sensors[i], probe)) init_lane(lanes, site->sensors[i], probe);
}

static uint64_t number_now(const lanes_t *lanes) { return lanes->now_us / lanes->step_us; }

/* The state of a contact lasts, as a distance does; other marks do not. */
static bool lasts(uint8_t mark) { return mark == MARK_NONE || mark == MARK_NEAR || mark == MARK_FAR; }

static void begin_step(lane_t *lane, uint64_t number)
{
    const step_t *const last = &lane->steps[(number - 1) % LANE_STEPS];
    step_t *const step = &lane->steps[number % LANE_STEPS];
    *step = (step_t){.mark = MARK_NONE};
    if (number > lane->held_until) return;
    step->is_held = true;
    step->has_distance = last->has_distance;
    step->distance_mm = last->distance_mm;
    step->mark = lasts(last->mark) ? last->mark : MARK_NONE;
}

void lanes_pass(lanes_t *lanes, uint64_t now_us)
{
    uint64_t number = number_now(lanes);
    lanes->now_us = now_us;
    const uint64_t last = number_now(lanes);
    if (last - number > LANE_STEPS + LONGEST_HOLD) number = last - LANE_STEPS;
    while (number++ != last)
        for (int i = 0; i != lanes->count; i++) begin_step(&lanes->lane[i], number);
}

/* Adds a mark to the present step, which nothing that is held stands in any more. */
static step_t *mark_step(const lanes_t *lanes, lane_t *lane, mark_t mark)
{
    step_t *const step = &lane->steps[number_now(lanes) % LANE_STEPS];
    if (step->is_held) *step = (step_t){.mark = MARK_NONE};
    if (mark > step->mark) step->mark = (uint8_t)mark;
    lane->held_until = 0;
    return step;
}

/* Returns how long a distance is shown, in steps. */
static uint64_t hold_of(const lanes_t *lanes, const lane_t *lane)
{
    const uint64_t gap_us = lane->mark != MARK_WAITING ? lanes->now_us - lane->heard_us : 0;
    const uint64_t steps = (gap_us * 3 / 2 + lanes->step_us) / lanes->step_us;
    return steps < LONGEST_HOLD ? steps : LONGEST_HOLD;
}

/* Adds an outcome: a distance if mark is MARK_NONE. */
static void add(lanes_t *lanes, lane_t *lane, mark_t mark, uint16_t distance_mm)
{
    step_t *const step = mark_step(lanes, lane, mark);
    lanes->seen |= 1u << mark;
    if (mark == MARK_NONE) {
        step->has_distance = true;
        step->distance_mm = distance_mm;
    }
    if (lasts((uint8_t)mark)) lane->held_until = number_now(lanes) + hold_of(lanes, lane);
    lane->heard_us = lanes->now_us;
    lane->mark = mark;
    lane->distance_mm = distance_mm;
    lane->outcomes++;
    if (marks[mark].is_loss)
        lane->lost++;
    else
        step->readings++;
}

static mark_t mark_of(const reading_t *reading)
{
    static const uint8_t failures[] = {
        [-FATHOM_ERR_NO_RESPONSE] = MARK_NO_RESPONSE,   [-FATHOM_ERR_ECHO] = MARK_NO_RESPONSE,
        [-FATHOM_ERR_LINE_BUSY] = MARK_LINE_BUSY,       [-FATHOM_ERR_STALE] = MARK_STALE,
        [-FATHOM_ERR_OTHER_MASTER] = MARK_OTHER_MASTER, [-FATHOM_ERR_PORT] = MARK_PORT,
    };
    static const uint8_t kinds[] = {
        [FATHOM_TARGET] = MARK_NONE, [FATHOM_NO_TARGET] = MARK_NO_TARGET, [FATHOM_UNKNOWN] = MARK_UNKNOWN,
        [FATHOM_FAR] = MARK_FAR,     [FATHOM_NEAR] = MARK_TOO_NEAR,       [FATHOM_FAULT] = MARK_FAULT,
    };
    const fathom_sample_t *const sample = &reading->result->sample;
    const size_t failure = (size_t)-reading->status;
    if (reading->failure != NULL)
        return failure < sizeof failures && failures[failure] != 0 ? failures[failure] : MARK_BAD_RESPONSE;
    if (sample->kind == FATHOM_NO_TARGET && sample->interference) return MARK_INTERFERENCE;
    if (sample->kind == FATHOM_NEAR && sensor_is_contact(reading->sensor)) return MARK_NEAR;
    return kinds[sample->kind];
}

void lanes_add(lanes_t *lanes, const reading_t *reading)
{
    const fathom_sample_t *const sample = &reading->result->sample;
    const failure_t *const evidence = reading->evidence;
    const bool is_absent = reading->failure != NULL && evidence == NULL; /* no attempt */
    const bool is_of_all = sample->probe == 0 || is_absent || (evidence != NULL && evidence->is_whole);
    for (int i = 0; i != lanes->count; i++) {
        lane_t *const lane = &lanes->lane[i];
        if (lane->sensor != reading->sensor || (!is_of_all && lane->probe != sample->probe)) continue;
        if (is_absent)
            (void)mark_step(lanes, lane, lane->mark = MARK_PORT);
        else
            add(lanes, lane, mark_of(reading), sample->distance_mm);
    }
}

const step_t *lane_step(const lanes_t *lanes, const lane_t *lane, int ago)
{
    return &lane->steps[(number_now(lanes) - (uint64_t)ago) % LANE_STEPS];
}

const char *lane_rate(const lanes_t *lanes, const lane_t *lane, char text[LANE_TEXT])
{
    const uint64_t now = number_now(lanes);
    uint64_t steps = RATE_US / lanes->step_us + 1;
    uint64_t readings = 0;
    if (steps > now + 1) steps = now + 1;
    for (int ago = 0; ago != (int)steps; ago++) readings += lane_step(lanes, lane, ago)->readings;
    const uint64_t over_us = (steps - 1) * lanes->step_us + lanes->now_us % lanes->step_us;
    const uint32_t tenths = over_us != 0 ? (uint32_t)(readings * 10000000u / over_us) : 0;
    (void)snprintf(text, LANE_TEXT, "%" PRIu32 ".%" PRIu32 "/s", tenths / 10, tenths % 10);
    return text;
}

const char *lane_value(const lane_t *lane, char text[LANE_TEXT])
{
    if (lane->mark != MARK_NONE) return marks[lane->mark].name;
    (void)snprintf(text, LANE_TEXT, "%u.%03u m", lane->distance_mm / 1000u, lane->distance_mm % 1000u);
    return text;
}
