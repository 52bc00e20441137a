/* SPDX-License-Identifier: MIT */
#include "fathom/engine/edges.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_switch.h"
#include "fuzz.h"

/*
 * What hangs on pins: the pulses of an A16 by the edges of a pin, a switch and a relay. Edges come at any time, twice
 * or not at all. A reading is a pulse that there was; a level is the pin's.
 */
enum { PULSES = 256, PERIOD_US = 220000 };

static uint32_t now_us;
static bool level;
static bool trigger;
static bool is_triggered;
static uint32_t triggered_us;
static fathom_edges_t edges;
static uint32_t widths[PULSES];
static uint32_t ends[PULSES];
static unsigned count;
static uint32_t rise_us;

static uint32_t read_clock(void *ctx) { return now_us; }
static const fathom_clock_t clock_of_pins = {read_clock, NULL};

static void set_trigger(void *ctx, bool high)
{
    if (trigger && !high) {
        if (is_triggered)
            PROMISE(fathom_elapsed_us(now_us, triggered_us) > PERIOD_US,
                    "A16 1(2): it must be greater than 220ms");
        is_triggered = true;
        triggered_us = now_us;
    }
    trigger = high;
}
static bool get_level(void *ctx) { return level; }
static const fathom_pin_t output = {set_trigger, NULL, NULL};
static const fathom_pin_t input = {NULL, get_level, NULL};

/* is_seen: the interrupt has run. */
static void edge(bool high, bool is_seen)
{
    if (high && !level) rise_us = now_us;
    if (!high && level && count < PULSES) {
        widths[count] = now_us - rise_us;
        ends[count++] = now_us;
    }
    level = high;
    if (is_seen) fathom_edges_feed(&edges, high, now_us);
}

static void check_pulse(const fathom_sample_t *sample)
{
    const bool is_pulse = sample->kind == FATHOM_TARGET || sample->kind == FATHOM_NO_TARGET;
    PROMISE(is_pulse || sample->kind == FATHOM_FAULT || sample->kind == FATHOM_UNKNOWN,
            "a16_pwm.h: the kinds");
    PROMISE(sample->model == FATHOM_A16 && sample->probe == 1 && sample->address == 0, "sample.h: who it is");
    /* pulse.h: by its width */
    if (sample->kind == FATHOM_TARGET)
        PROMISE(sample->raw >= 2700 && sample->raw < 92000 && sample->distance_mm >= 1 &&
                    sample->distance_mm <= 18000,
                "pulse.h: noise_us .. no_target_us is a target");
    else
        PROMISE(sample->distance_mm == 0, "sample.h: 0 unless it is a target");
    if (sample->kind == FATHOM_NO_TARGET)
        PROMISE(sample->raw >= 92000 && sample->raw <= 105000, "pulse.h: no_target_us .. stuck_us");
    if (sample->kind == FATHOM_FAULT)
        PROMISE(sample->raw == 0 || sample->raw > 105000, "pulse.h: more, or high when the cycle is over");
    if (sample->kind == FATHOM_UNKNOWN)
        PROMISE(sample->raw >= FATHOM_PULSE_SHORT_US && sample->raw < 2700, "pulse.h: 100 us .. noise_us");
    for (unsigned i = 0; is_pulse && i != count; i++)
        if (widths[i] == sample->raw && ends[i] == sample->time_us) return;
    PROMISE(!is_pulse, "a16_pwm.h: raw is the width of the pulse, time_us its end");
}

static void check_level(const fathom_sample_t *sample, bool is_near)
{
    PROMISE(sample->kind == (is_near ? FATHOM_NEAR : FATHOM_FAR) && sample->distance_mm == 0,
            "contact.h: NEAR or FAR");
}

static bool poll(const fathom_sensor_t *sensors)
{
    bool has_outcome = false;
    for (int i = 0; i != 3; i++) {
        fathom_sample_t sample;
        memset(&sample, FUZZ_GUARD, sizeof sample);
        const fathom_status_t status = fathom_poll(&sensors[i], &sample);
        if (status != FATHOM_OK)
            PROMISE(fuzz_is_guard(&sample, sizeof sample), "sensor.h: *sample is untouched");
        if (status == FATHOM_PENDING) continue;
        if (i == 0) {
            has_outcome = true;
            PROMISE(status == FATHOM_OK || status == FATHOM_ERR_NO_RESPONSE ||
                        status == FATHOM_ERR_MALFORMED || status == FATHOM_ERR_STALE,
                    "a16_pwm.h: the errors of fathom_poll");
            if (status == FATHOM_OK) check_pulse(&sample);
        } else {
            PROMISE(status == FATHOM_OK || status == FATHOM_ERR_STALE,
                    "contact.h: the errors of fathom_poll");
            if (status == FATHOM_OK) check_level(&sample, (i == 1) == (sample.raw == 1));
            if (status == FATHOM_OK) PROMISE(sample.raw == level, "contact.h: raw is the level");
        }
    }
    return has_outcome;
}

static void happen(uint8_t op)
{
    const uint8_t high = op >> 3;
    switch (op % 8) {
    case 0:
        now_us += high * 10u;
        break;
    case 1:
        now_us += high * 1000u;
        break;
    case 2: /* a pulse; or both edges of it late, with a bounce */
        edge(true, true);
        now_us += 2000u + fuzz_byte() * 500u;
        edge(false, true);
        break;
    case 3:
        edge((high & 1) != 0, true);
        break;
    case 4: /* an edge of which no interrupt tells, and one that comes twice */
        if ((high & 2) != 0) fathom_edges_feed(&edges, level, now_us);
        break;
    case 5:
        now_us += (uint32_t)fuzz_byte() << (high & 15);
        break;
    default:
        now_us += 221000;
        break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fathom_a16_pwm_t pwm;
    fathom_a16_switch_t contact;
    fathom_a05_relay_t relay;
    fuzz_begin(data, size);
    now_us = (uint32_t)fuzz_word() << 16;
    const uint8_t how = fuzz_byte();
    level = (how & 1) != 0;
    trigger = true;
    is_triggered = false;
    count = 0;
    rise_us = now_us;
    fathom_edges_init(&edges, &input);
    const fathom_capture_t capture = fathom_edges_capture(&edges);
    const fathom_output_t rx = fathom_output_pin(&output);
    const fathom_a16_pwm_config_t of_pwm = {.in_air = (how & 2) != 0, .air_dc = (int16_t)(how - 50)};
    PROMISE(fathom_a16_pwm_init(&pwm, &capture, &clock_of_pins, &rx, &of_pwm) == FATHOM_OK,
            "a16_pwm.h: init");
    PROMISE(fathom_a16_switch_init(&contact, &input, &clock_of_pins, NULL) == FATHOM_OK,
            "a16_switch.h: init");
    PROMISE(fathom_a05_relay_init(&relay, &input, &clock_of_pins, NULL) == FATHOM_OK, "a05_relay.h: init");
    const fathom_sensor_t sensors[] = {fathom_a16_pwm_sensor(&pwm), fathom_a16_switch_sensor(&contact),
                                       fathom_a05_relay_sensor(&relay)};
    while (fuzz_more()) {
        const uint8_t op = fuzz_byte();
        if (op % 8 == 7)
            now_us += fathom_due_us(sensors, 3);
        else
            happen(op);
        if ((op & 0x80) == 0) (void)poll(sensors);
    }
    /* Nothing comes any more: a cycle ends all the same, and due_us leads there. */
    unsigned polls = 0;
    for (int outcomes = 0; outcomes != 2; polls++) {
        const uint32_t due_us = fathom_due_us(sensors, 1);
        PROMISE(due_us != FATHOM_NO_DEADLINE && polls < 100,
                "pulse.h: due_us: never FATHOM_NO_DEADLINE; a cycle ends");
        now_us += due_us;
        outcomes += poll(sensors);
    }
    return 0;
}
