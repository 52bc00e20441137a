/* SPDX-License-Identifier: MIT */
/*
 * Each row of src/models reads the module of its name in the second simulation, which knows it from the sources alone:
 * at the edges of the range and outside, with each value that is no distance, with the least time between triggers, with
 * the earliest and the latest response, and with repeated values. If a source is silent, both answers are played.
 */
#include "relatives.h"

#include <string.h>

#include "fathom/models.h"
#include "second_rig.h"
#include "suite.h"

enum { SECOND_US = 1000000, TRIES = 100000 };

static rig_t rig;
static const second_relative_t *row;            /* of the second simulation */
static const fathom_model_description_t *model; /* of the product */
static fathom_sensor_t sensor;
static fathom_sample_t sample;
static fathom_line_byte_t line_byte;
static fathom_output_t trigger;
static fathom_capture_t capture;
static union {
    fathom_a16_auto_t automatic;
    fathom_a16_controlled_t controlled;
    fathom_a16_pwm_t pwm;
    fathom_a16_modbus_t modbus;
    fathom_a05_auto_t a05_auto;
    fathom_a05_modbus_t a05_modbus;
    fathom_a05_dyp_t a05_dyp;
    fathom_hps167s_t hps167s;
    fathom_hps167_uart_t hps167;
} driver;

static void must(bool holds, const char *what, long value)
{
    const char *const how = rig.device.config.is_late ? "late" : "soon";
    if (!holds) fail_msg("%s, mode %u, %s: %s %ld", row->name, (unsigned)row->form, how, what, value);
}

static void set_trigger_pin(void *ctx, bool high) { second_rx_level(&rig.device, !high, rig.now_us); }
static const fathom_pin_t trigger_pin = {set_trigger_pin, NULL, NULL};

static fathom_status_t init_pwm(const fathom_model_facts_t *facts)
{
    const fathom_a16_pwm_config_t config = {.model = facts};
    capture = fathom_edges_capture(&rig.edges);
    trigger = fathom_output_none();
    if (facts->start == FATHOM_STARTS_FALLING) trigger = fathom_output_pin(&trigger_pin);
    if (facts->start == FATHOM_STARTS_HIGH_PULSE) trigger = fathom_output_inverted_pin(&trigger_pin);
    sensor = fathom_a16_pwm_sensor(&driver.pwm);
    return fathom_a16_pwm_init(&driver.pwm, &capture, &rig.clock, &trigger, &config);
}

static fathom_status_t init_controlled(const fathom_model_facts_t *facts)
{
    const fathom_a16_controlled_config_t config = {.model = facts};
    line_byte = (fathom_line_byte_t){&rig.line, facts->trigger_byte};
    trigger = facts->start == FATHOM_STARTS_BYTE ? fathom_output_line_byte(&line_byte)
                                                 : fathom_output_line_break(&rig.line);
    sensor = fathom_a16_controlled_sensor(&driver.controlled);
    return fathom_a16_controlled_init(&driver.controlled, &rig.line, &trigger, &config);
}

static fathom_status_t init_auto(const fathom_model_facts_t *facts)
{
    const fathom_a16_auto_config_t config = {.model = facts};
    const fathom_a05_auto_config_t a05_config = {.model = facts};
    if (model->family == FATHOM_A05) {
        sensor = fathom_a05_auto_sensor(&driver.a05_auto);
        return fathom_a05_auto_init(&driver.a05_auto, &rig.line, &a05_config);
    }
    sensor = fathom_a16_auto_sensor(&driver.automatic);
    return fathom_a16_auto_init(&driver.automatic, &rig.line, &config);
}

static fathom_status_t init_modbus(const fathom_model_facts_t *facts, uint8_t value)
{
    const fathom_a16_modbus_config_t config = {.model = facts, .value = value};
    const fathom_a05_modbus_config_t a05_config = {.model = facts};
    if (model->family == FATHOM_HPS167S) {
        sensor = fathom_hps167s_sensor(&driver.hps167s);
        return fathom_hps167s_init(&driver.hps167s, &rig.modbus, NULL);
    }
    if (model->family == FATHOM_A05) {
        sensor = fathom_a05_modbus_sensor(&driver.a05_modbus);
        return fathom_a05_modbus_init(&driver.a05_modbus, &rig.modbus, &a05_config);
    }
    sensor = fathom_a16_modbus_sensor(&driver.modbus);
    return fathom_a16_modbus_init(&driver.modbus, &rig.modbus, &config);
}

static fathom_status_t init_driver(uint8_t value)
{
    const fathom_model_facts_t *const facts = model->facts;
    const fathom_a05_dyp_config_t dyp_config = {.model = facts};
    switch (model->mode) {
    case FATHOM_MODE_AUTO:
        return init_auto(facts);
    case FATHOM_MODE_CONTROLLED:
        return init_controlled(facts);
    case FATHOM_MODE_MODBUS:
        return init_modbus(facts, value);
    case FATHOM_MODE_55AA:
        sensor = fathom_a05_dyp_sensor(&driver.a05_dyp);
        return fathom_a05_dyp_init(&driver.a05_dyp, &rig.line, &dyp_config);
    case FATHOM_MODE_0A:
        sensor = fathom_hps167_uart_sensor(&driver.hps167);
        return fathom_hps167_uart_init(&driver.hps167, &rig.line, NULL);
    default:
        return init_pwm(facts);
    }
}

/* Gives the module power and, when it is ready, reads it with the driver and the line settings of the product's row. */
static void begin(bool is_late, rig_loop_t loop, uint8_t value)
{
    const second_config_t config = {
        .kind = row->kind, .scene = {{1000, 300, 1000, 1000}}, .relative = row, .is_late = is_late};
    static const uint8_t starts[] = {[TRIGGER_NONE] = FATHOM_STARTS_ALONE,
                                     [TRIGGER_LOW] = FATHOM_STARTS_FALLING,
                                     [TRIGGER_HIGH] = FATHOM_STARTS_HIGH_PULSE,
                                     [TRIGGER_BYTE] = FATHOM_STARTS_BYTE};
    const fathom_line_settings_t *const line = model->facts->line_settings;
    rig_open(&rig, &config);
    rig.loop = loop;
    rig.has_stamps = loop == RIG_WOKEN;
    must((line == NULL) == (row->kind == SECOND_RELATIVE_PULSE), "has wrong line settings", 0);
    must(model->facts->start == starts[row->trigger], "has another trigger", model->facts->start);
    must(row->max_mm == 0 || (row->min_mm == model->facts->min_mm && row->max_mm == model->facts->max_mm),
         "has another range, to", model->facts->max_mm);
    if (line != NULL) assert_int_equal(rig.uart.set_line(&rig, line), 1);
    if (model->facts->start == FATHOM_STARTS_HIGH_PULSE) set_trigger_pin(NULL, false);
    rig_power(&rig, true);
    rig_wait(&rig, row->kind == SECOND_HPS167S ? 12 * SECOND_US : 2 * SECOND_US);
    must(init_driver(value) == FATHOM_OK, "is refused", 0);
}

/* Returns the number of measurements after event `from` that sent this, or with a pulse of this width. */
static unsigned measurements(uint64_t from, uint32_t sent)
{
    unsigned count = 0;
    for (uint64_t i = from; i < second_log_count(&rig.device); i++) {
        const second_event_t *const e = second_log_at(&rig.device, i);
        if (e == NULL || e->kind != SECOND_EVENT_MEASUREMENT) continue;
        count += (row->kind == SECOND_RELATIVE_PULSE ? (uint32_t)e->new_value : e->sent[0]) == sent;
    }
    return count;
}

/* Puts a target in front of the module, or a value into its frames. Returns the outcome after the second measurement of
 * it was sent, and `sample`. */
static fathom_status_t outcome(int32_t scene, uint32_t sent)
{
    const uint64_t from = second_log_count(&rig.device);
    fathom_status_t status = FATHOM_PENDING;
    rig_scene(&rig, scene, scene, scene, scene);
    for (unsigned tries = 0; tries != TRIES; tries++) {
        status = fathom_poll(&sensor, &sample);
        if (status != FATHOM_PENDING && measurements(from, sent) >= 3) return status;
        rig_pass(&rig, fathom_due_us(&sensor, 1));
    }
    must(false, "has no outcome for", scene);
    return status;
}

/* ---- distances and values ---- */

static bool is_pulse(void) { return row->kind == SECOND_RELATIVE_PULSE; }

/* Returns the microseconds for 100 mm. The two answers, if no source has it, are the A16's and that of 340 m/s. */
static uint32_t scale(void)
{
    return row->us_per_dm != 0 ? row->us_per_dm : rig.device.config.is_late ? 588 : 575;
}

/* Returns the width of the pulse of this distance, or the distance. */
static uint32_t sent_for(int32_t mm)
{
    return is_pulse() ? ((uint32_t)mm * scale() + 50) / 100 : (uint32_t)mm;
}

/* A driver cannot know a scale that no source has: 57.5 and 58.8 us for each cm are 2.3 % apart. */
static void reads(int32_t mm)
{
    const int32_t slack_mm = is_pulse() && row->us_per_dm == 0 ? mm / 40 : 0;
    must(outcome(mm, sent_for(mm)) == FATHOM_OK && sample.kind == FATHOM_TARGET, "does not read", mm);
    must(sample.model == model->family && sample.raw == sent_for(mm), "misreads", mm);
    must(sample.distance_mm >= mm - slack_mm && sample.distance_mm <= mm + slack_mm, "is wrong with", mm);
}

static void refuses(int32_t mm)
{
    must(outcome(mm, sent_for(mm)) == FATHOM_ERR_MALFORMED, "does not refuse", mm);
}

static void reads_value(uint16_t value, char meaning)
{
    const fathom_status_t status = outcome(value, value);
    const bool is_reading = status == FATHOM_OK;
    must(is_reading || meaning == '?', "refuses", value);
    must(!is_reading || sample.kind != FATHOM_TARGET, "takes for a distance", value);
    if (meaning == 'n' || meaning == 'i') {
        must(sample.kind == FATHOM_NO_TARGET && sample.raw == value, "has a wrong meaning of", value);
        must(sample.interference == (meaning == 'i'), "has a wrong meaning of", value);
    }
    if (meaning == 'u') must(sample.kind == FATHOM_UNKNOWN, "has a wrong meaning of", value);
}

static void reads_values(void)
{
    const char *const meanings = row->values != NULL ? row->values : "????";
    reads_value(0, meanings[0]);
    reads_value(0xFFFB, meanings[1]);
    reads_value(0xFFFD, meanings[2]);
    reads_value(0xFFFE, meanings[3]);
    reads_value(0xFFFF, '?');
}

/* With nothing in range a module gives the pulse of its row, or none. If no source has a pulse, it is a quarter longer
 * than that of the longest distance. */
static void reads_nothing(void)
{
    const uint32_t none_us = row->none_ms != 0 ? row->none_ms * 1000u : row->max_mm * scale() / 80;
    fathom_status_t status = outcome(SECOND_NO_PULSE, 0);
    must(status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_STALE, "reads a pulse that is not there",
         0);
    if (none_us + 20000 > model->facts->period_ms * 1000u) return; /* it has no place between two triggers */
    status = outcome(SECOND_NOTHING, none_us);
    must(status != FATHOM_OK || sample.kind != FATHOM_TARGET, "has a target", 0);
    must(row->none_ms == 0 || (status == FATHOM_OK && sample.kind == FATHOM_NO_TARGET), "has no outcome", 0);
}

static void reads_range(void)
{
    if (row->max_mm == 0) { /* it is not known: nothing that may be a distance is refused */
        reads(30);
        reads(10000);
        return;
    }
    if (is_pulse() && row->us_per_dm == 0) {
        reads(row->min_mm * 105 / 100);
        reads(row->max_mm * 95 / 100);
        refuses(row->min_mm * 90 / 100);
        if (!rig.device.config.is_late) refuses(row->max_mm * 105 / 100);
        return;
    }
    reads(row->min_mm + 1);
    reads(row->max_mm - 1);
    reads(row->min_mm);
    reads(row->max_mm);
    if (model->family == FATHOM_HPS167S) return; /* its drivers take no range */
    refuses(row->min_mm - 1);
    refuses(row->max_mm + 1);
    reads(row->min_mm);
}

/* ---- triggers ---- */

/* The module refused no trigger; and it got them as often as the product's row says. */
static void expect_triggers(void)
{
    uint64_t before_us = 0, least_us = SECOND_NEVER;
    unsigned refused = 0;
    for (uint64_t i = 0; i < second_log_count(&rig.device); i++) {
        const second_event_t *const e = second_log_at(&rig.device, i);
        if (e == NULL) continue;
        refused += e->kind == SECOND_EVENT_REFUSED;
        if (e->kind != SECOND_EVENT_MEASUREMENT || !e->asked || row->trigger == TRIGGER_NONE) continue;
        if (before_us != 0 && e->seen_from_us - before_us < least_us) least_us = e->seen_from_us - before_us;
        before_us = e->seen_from_us;
    }
    must(refused == 0, "is triggered too soon, times", (long)refused);
    if (row->trigger == TRIGGER_NONE) return;
    must(least_us >= row->gap_ms * 1000u, "has triggers too near, us", (long)least_us);
    must(least_us <= model->facts->period_ms * 1000u + 3000, "has triggers too far apart, us",
         (long)least_us);
}

/* ---- all rows ---- */

static bool next_row(size_t index)
{
    if (index == second_relatives_count) return false;
    row = &second_relatives[index];
    model = fathom_model_find(row->name, (uint8_t)row->form);
    if (model == NULL) fail_msg("the product has no %s, mode %u", row->name, (unsigned)row->form);
    return true;
}

TEST(each_row_of_the_product_is_one_of_the_second_simulation)
{
    for (uint16_t index = 0; fathom_model_at(index) != NULL; index++) {
        unsigned found = 0;
        for (size_t i = 0; next_row(i); i++) found += model == fathom_model_at(index);
        const fathom_model_description_t *const wanted = fathom_model_at(index);
        if (found != 1) fail_msg("%s, mode %u, has %u rows", wanted->name, wanted->mode, found);
    }
}

static void live(bool is_late, rig_loop_t loop)
{
    for (size_t i = 0; next_row(i); i++) {
        begin(is_late, loop, is_late ? FATHOM_PROCESSED : FATHOM_REAL_TIME);
        reads_range();
        if (row->kind == SECOND_RELATIVE) reads_values();
        if (is_pulse()) reads_nothing();
        if (row->kind == SECOND_RELATIVE || is_pulse()) expect_triggers();
        assert_int_equal(second_state(&rig.device).lost, 0);
    }
}

TEST(each_row_is_read_from_a_module_that_answers_soon) { live(false, RIG_WOKEN); }
TEST(each_row_is_read_from_a_module_that_answers_late) { live(true, RIG_WOKEN); }
TEST(each_row_is_read_by_a_program_that_polls_each_ms)
{
    live(false, RIG_EVERY_1_MS);
    live(true, RIG_EVERY_1_MS);
}

/* The module that is late sends each measurement three times, and measures the same distance. */
TEST(a_frame_that_repeats_a_measurement_is_not_a_new_one)
{
    for (size_t i = 0; next_row(i); i++) {
        if (row->kind != SECOND_RELATIVE || row->form != FORM_AUTO) continue;
        for (int is_late = 0; is_late <= 1; is_late++) {
            begin(is_late != 0, RIG_WOKEN, 0);
            assert_int_equal(outcome(1000, 1000), FATHOM_OK);
            const uint64_t from = second_log_count(&rig.device);
            const uint16_t before = sample.sequence;
            unsigned measured = 0;
            (void)outcome(1000, 1000);
            for (uint64_t n = from; n < second_log_count(&rig.device); n++) {
                const second_event_t *const e = second_log_at(&rig.device, n);
                measured += e != NULL && e->kind == SECOND_EVENT_MEASUREMENT && e->old_value == 0;
            }
            must((uint16_t)(sample.sequence - before) == measured, "counts measurements",
                 sample.sequence - before);
        }
    }
}

/* -10.5 degrees are -105 tenths. */
TEST(a_temperature_is_read_from_the_modules_that_have_one)
{
    for (size_t i = 0; next_row(i); i++) {
        int16_t tenths = 0;
        if (row->kind != SECOND_RELATIVE || row->form != FORM_MODBUS) continue;
        for (int16_t wanted = 300; wanted >= -105; wanted = (int16_t)(wanted - 405)) {
            begin(wanted < 0, RIG_WOKEN, 0);
            rig_scene(&rig, 1000, wanted, 0, 0);
            fathom_status_t status = FATHOM_PENDING;
            for (unsigned tries = 0; status == FATHOM_PENDING && tries != TRIES; tries++) {
                status = fathom_a16_modbus_get_temperature(&driver.modbus, &tenths);
                rig_pass(&rig, fathom_due_us(&sensor, 1));
            }
            must(status == (row->has_temperature ? FATHOM_OK : FATHOM_ERR_UNSUPPORTED), "temperature",
                 status);
            must(!row->has_temperature || tenths == wanted, "temperature", tenths);
        }
    }
}
