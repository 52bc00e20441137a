/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "contract.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/models.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_settings.h"

/* Each row of src/models, read by its driver: at the edges of its range, with each value that is no distance, with its
 * trigger, and at the edges of the time of its response. */

static const fathom_model_description_t *row;
static const fathom_model_facts_t *facts;
static unsigned rows_read;

static bool next_row(uint16_t index)
{
    row = fathom_model_at(index);
    facts = row != NULL ? row->facts : NULL;
    return row != NULL;
}

static void must(bool holds, const char *what, uint32_t value)
{
    if (!holds) fail_msg("%s, mode %u: %s %lu", row->name, row->mode, what, (unsigned long)value);
}

/* ---- values ---- */

/* A device sends a value; what comes of it, and the sample. */
typedef fathom_status_t (*sends_t)(uint16_t value);

static void is_read(sends_t sends, const fathom_sample_t *sample, uint16_t value, uint8_t kind)
{
    must(sends(value) == FATHOM_OK, "does not read", value);
    must(sample->kind == kind && sample->raw == value && sample->model == row->family, "misreads", value);
    must(sample->distance_mm == (kind == FATHOM_TARGET ? value : 0), "has a wrong distance for", value);
    must(sample->interference == (value == 0xFFFE), "interference", value);
}

static void is_refused(sends_t sends, uint16_t value)
{
    must(sends(value) == FATHOM_ERR_MALFORMED, "does not refuse", value);
}

/* FFFD is no target and FFFE interference (A21, A22), and 0, FFFB and FFFF mean nothing, unless a source says more. */
static void expect_values(sends_t sends, const fathom_sample_t *sample)
{
    const bool is_l04 = fathom_model_is_called(row, "L041MTW") || fathom_model_is_called(row, "L042MTW");
    const bool is_aj = fathom_model_is_called(row, "AJ-SR04M") && row->mode == FATHOM_MODE_CONTROLLED;
    const bool is_l08 = fathom_model_is_called(row, "L081MTW") || fathom_model_is_called(row, "L08-RS485");
    is_read(sends, sample, facts->min_mm, FATHOM_TARGET);
    is_read(sends, sample, facts->max_mm, FATHOM_TARGET);
    if (facts->min_mm > 1) is_refused(sends, (uint16_t)(facts->min_mm - 1));
    is_refused(sends, (uint16_t)(facts->max_mm + 1));
    is_read(sends, sample, 0, is_l04 || is_aj ? FATHOM_NO_TARGET : FATHOM_UNKNOWN);
    is_read(sends, sample, 0xFFFD, FATHOM_NO_TARGET);
    is_read(sends, sample, 0xFFFE, FATHOM_NO_TARGET);
    is_refused(sends, 0xFFFF);
    is_refused(sends, 0xFFFC);
    if (is_l08)
        is_read(sends, sample, 0xFFFB, FATHOM_UNKNOWN);
    else
        is_refused(sends, 0xFFFB);
    is_read(sends, sample, (uint16_t)(facts->min_mm + 1), FATHOM_TARGET);
    rows_read++;
}

static const contract_driver_t *driver;
static fathom_status_t contract_sends(uint16_t value) { return driver->kind->says(driver, value); }

/* The driver of a row that needs no trigger, or NULL. */
static const contract_driver_t *driver_of_row(void)
{
    const bool is_a05 = row->family == FATHOM_A05;
    if (row->family == FATHOM_HPS167S) return NULL;
    if (row->mode == FATHOM_MODE_AUTO) return is_a05 ? &contract_a05_auto : &contract_a16_auto;
    if (row->mode == FATHOM_MODE_MODBUS) return is_a05 ? &contract_a05_modbus : &contract_a16_modbus;
    return row->mode == FATHOM_MODE_55AA ? &contract_a05_dyp : NULL;
}

TEST(each_row_that_sends_or_responds_is_read_by_its_driver)
{
    rows_read = 0;
    for (uint16_t index = 0; next_row(index); index++) {
        driver = driver_of_row();
        if (driver == NULL) continue;
        driver->kind->begin(1000);
        driver->prepare();
        *driver->facts = *facts;
        must(driver->init() == FATHOM_OK, "is refused", 0);
        *driver->kind->sensor = driver->sensor();
        expect_values(contract_sends, driver->kind->sample);
    }
    assert_true(rows_read >= 35);
}

/* ---- repeats ---- */

static fathom_a16_auto_t automatic;

/* A frame whose last byte arrives after this time. */
static void hears(uint16_t value, uint32_t in_us)
{
    uint8_t frame[4];
    const uint32_t byte_us = UINT32_C(10000000) / facts->line_settings->baud;
    fake_trickle(&rig.fake, in_us - 4 * byte_us, byte_us, frame, rig_dyp_stream(frame, &value, 1));
    for (const unsigned samples = rig.samples; rig.samples == samples;) rig_run(1 * MS, 1 * MS);
}

TEST(a_frame_with_the_old_value_within_the_period_is_the_same_measurement)
{
    for (uint16_t index = 0; next_row(index); index++) {
        const fathom_a16_auto_config_t config = {.model = facts};
        const uint32_t period_us = UINT32_C(1000) * facts->period_ms;
        if (row->mode != FATHOM_MODE_AUTO || row->family != FATHOM_A16) continue;
        rig_start(1000);
        assert_int_equal(fathom_a16_auto_init(&automatic, &rig.line, &config), FATHOM_OK);
        rig.sensor = fathom_a16_auto_sensor(&automatic);
        rig_run(20 * MS, 1 * MS);
        hears(1953, 20 * MS);
        hears(1953, 20 * MS);
        must(rig.sample.sequence == (period_us == 0 ? 2 : 1), "sequence", rig.sample.sequence);
        hears(1954, 20 * MS);
        hears(1954, period_us + 20 * MS);
        must(rig.sample.sequence == (period_us == 0 ? 4 : 3), "sequence", rig.sample.sequence);
    }
}

/* ---- triggered frames ---- */

static fathom_line_byte_t line_byte;

/* The number of triggers so far. */
static unsigned triggers(void)
{
    return facts->start == FATHOM_STARTS_BYTE ? (unsigned)rig.fake.written : controlled.pin.falls;
}

static void start_controlled(void)
{
    line_byte = (fathom_line_byte_t){&rig.line, facts->trigger_byte};
    controlled.config = (fathom_a16_controlled_config_t){.model = facts};
    controlled.trigger = fathom_output_pin(&controlled.pin.trigger);
    if (facts->start == FATHOM_STARTS_BYTE) controlled.trigger = fathom_output_line_byte(&line_byte);
    controlled_start();
}

static void run_to_trigger_of_row(void)
{
    for (const unsigned before = triggers(); triggers() == before;) rig_run(100, 100);
}

/* What comes of a trigger whose response has its last byte after this time. */
static fathom_status_t responds_after(uint16_t value, uint32_t after_us)
{
    uint8_t frame[4];
    const uint32_t byte_us = UINT32_C(10000000) / facts->line_settings->baud;
    run_to_trigger_of_row();
    fake_trickle(&rig.fake, after_us - 4 * byte_us, byte_us, frame, rig_dyp_stream(frame, &value, 1));
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned polls = 0; status == FATHOM_PENDING; polls++) {
        must(polls < 20000, "nothing comes of", value);
        rig.fake.now_us += 100;
        status = rig_poll();
    }
    return status;
}

static fathom_status_t sends_in_time(uint16_t value)
{
    return responds_after(value,
                          UINT32_C(1000) * facts->earliest_ms / 2 + UINT32_C(1000) * facts->latest_ms / 2);
}

TEST(each_row_with_a_trigger_is_read_by_its_driver)
{
    rows_read = 0;
    for (uint16_t index = 0; next_row(index); index++) {
        if (row->mode != FATHOM_MODE_CONTROLLED) continue;
        start_controlled();
        expect_values(sends_in_time, &rig.sample);
    }
    assert_true(rows_read >= 15);
}

TEST(each_row_with_a_trigger_has_responses_in_its_window_only)
{
    for (uint16_t index = 0; next_row(index); index++) {
        if (row->mode != FATHOM_MODE_CONTROLLED) continue;
        const uint32_t frame_us = UINT32_C(40000000) / facts->line_settings->baud;
        const uint32_t earliest_us = UINT32_C(1000) * facts->earliest_ms;
        const uint32_t latest_us = UINT32_C(1000) * facts->latest_ms;
        const uint32_t first_us = earliest_us > frame_us + 200 ? earliest_us : frame_us + 200;
        start_controlled();
        must(responds_after(facts->max_mm, latest_us) == FATHOM_OK, "last response", latest_us);
        must(responds_after(facts->min_mm, first_us) == FATHOM_OK, "first response", first_us);
        assert_int_equal(rig.samples, 2);
        if (earliest_us > frame_us + 1 * MS) {
            must(responds_after(facts->max_mm, earliest_us - 600) == FATHOM_ERR_NO_RESPONSE, "too early", 0);
            assert_int_equal(controlled.a16.late, 1);
        }
        must(responds_after(facts->max_mm, latest_us + 600) < 0, "too late", 0);
        run_to_trigger_of_row(); /* the rest of the late frame arrives, and is no response */
        assert_int_equal(rig.samples, 2);
    }
}

TEST(each_row_with_a_trigger_is_triggered_as_it_needs_and_no_sooner_than_its_period)
{
    for (uint16_t index = 0; next_row(index); index++) {
        if (row->mode != FATHOM_MODE_CONTROLLED) continue;
        const uint32_t frame_us = UINT32_C(40000000) / facts->line_settings->baud;
        start_controlled();
        uint32_t before_us = 0;
        for (unsigned n = 0; n != 6; n++) {
            run_to_trigger_of_row();
            const uint32_t passed_us = rig.fake.now_us - before_us;
            must(n == 0 || passed_us >= UINT32_C(1000) * facts->period_ms, "period", passed_us);
            must(n == 0 || passed_us <= UINT32_C(1000) * facts->period_ms + 100, "period", passed_us);
            before_us = rig.fake.now_us;
            /* at once: a response does not bring the next trigger forward */
            const uint16_t value = (uint16_t)(facts->min_mm + n);
            uint8_t frame[4];
            fake_trickle(&rig.fake, UINT32_C(1000) * facts->earliest_ms + 200, frame_us / 4, frame,
                         rig_dyp_stream(frame, &value, 1));
        }
        if (facts->start == FATHOM_STARTS_BYTE) {
            for (unsigned n = 0; n != 6; n++) {
                assert_int_equal(rig.fake.writes[n].length, 1);
                assert_int_equal(rig.fake.writes[n].bytes[0], facts->trigger_byte);
            }
            assert_int_equal(rig.fake.breaks + controlled.pin.falls, 0);
        } else {
            must(controlled.pin.low_us >= facts->trigger_us, "low for", controlled.pin.low_us);
            must(controlled.pin.low_us <= facts->trigger_us + 100u, "low for", controlled.pin.low_us);
            assert_int_equal(rig.fake.written, 0);
        }
    }
}

/* ---- pulses ---- */

static fake_t fake_uart;
static fake_pin_t pins;
static fathom_a16_pwm_t pwm;
static fathom_sensor_t pwm_sensor;
static fathom_sample_t pulse;

static void start_pwm(void)
{
    const fathom_a16_pwm_config_t config = {.model = facts};
    fake_init(&fake_uart);
    fake_pin_init(&pins, &fake_uart);
    fathom_output_t output = fathom_output_none();
    if (facts->start == FATHOM_STARTS_FALLING) output = fathom_output_pin(&pins.trigger);
    if (facts->start == FATHOM_STARTS_HIGH_PULSE) output = fathom_output_inverted_pin(&pins.trigger);
    must(fathom_a16_pwm_init(&pwm, &pins.capture, &fake_uart.clock, &output, &config) == FATHOM_OK,
         "is refused", 0);
    pwm_sensor = fathom_a16_pwm_sensor(&pwm);
}

/* What comes of a pulse of this width: after a trigger, or with the module's own period. */
static fathom_status_t pulses(uint32_t width_us)
{
    fathom_status_t status = FATHOM_PENDING;
    pins.response_after_us = 1 * MS;
    pins.response_width_us = width_us;
    if (facts->start == FATHOM_STARTS_ALONE)
        fake_pulse(&pins, UINT32_C(1000) * facts->period_ms - width_us, width_us);
    for (unsigned polls = 0; status == FATHOM_PENDING; polls++) {
        must(polls < 10000, "nothing comes of a pulse of", width_us);
        fake_uart.now_us += 50;
        status = checked_poll(&pwm_sensor, &pulse);
    }
    return status;
}

/* The width of the pulse of a distance, rounded to the nearest. */
static uint32_t width_of(uint16_t mm) { return ((uint32_t)mm * facts->us_per_dm + 50) / 100; }

static void measures(uint16_t mm)
{
    must(pulses(width_of(mm)) == FATHOM_OK && pulse.kind == FATHOM_TARGET, "does not measure", mm);
    must(pulse.distance_mm == mm && pulse.raw == width_of(mm), "measures wrongly", mm);
}

static void has_kind(uint32_t width_us, uint8_t kind)
{
    must(pulses(width_us) == FATHOM_OK && pulse.kind == kind && pulse.distance_mm == 0, "kind of", width_us);
}

TEST(each_row_with_a_pulse_is_measured_by_its_driver)
{
    rows_read = 0;
    for (uint16_t index = 0; next_row(index); index++) {
        if (facts->us_per_dm == 0) continue;
        const uint32_t none_us = UINT32_C(1000) * facts->no_target_ms;
        start_pwm();
        measures(facts->min_mm);
        measures(facts->max_mm);
        must(pulses(width_of((uint16_t)(facts->min_mm - 1))) == FATHOM_ERR_MALFORMED, "too near", 0);
        must(pulses(width_of((uint16_t)(facts->max_mm + 1))) == FATHOM_ERR_MALFORMED, "too far", 0);
        if (none_us != 0) {
            has_kind(none_us, FATHOM_NO_TARGET);
            if (none_us + 12 * MS < UINT32_C(1000) * facts->period_ms)
                has_kind(none_us + 12 * MS, FATHOM_FAULT);
        }
        measures((uint16_t)(facts->min_mm + 1));
        rows_read++;
    }
    assert_true(rows_read >= 13);
}

TEST(each_row_with_a_pulse_gets_its_trigger_no_sooner_than_its_period)
{
    for (uint16_t index = 0; next_row(index); index++) {
        if (row->mode != FATHOM_MODE_PULSE) continue;
        const bool is_high = facts->start == FATHOM_STARTS_HIGH_PULSE;
        const uint32_t floor_us = facts->trigger_us;
        start_pwm();
        assert_int_equal(pins.level, !is_high);
        for (unsigned n = 0; n != 5; n++) measures(facts->min_mm);
        must(pins.least_us >= UINT32_C(1000) * facts->period_ms, "period", pins.least_us);
        must(pins.least_us <= UINT32_C(1000) * facts->period_ms + 100, "period", pins.least_us);
        const uint32_t width_us = is_high ? pins.least_high_us : pins.low_us;
        must(width_us >= floor_us && width_us <= floor_us + 50, "trigger", width_us);
    }
}

TEST(a_module_that_sends_pulses_alone_gets_no_trigger)
{
    facts = &fathom_model_jsn_sr04t_free;
    row = fathom_model_find("JSN-SR04T", FATHOM_MODE_FREE_PULSE);
    start_pwm();
    for (uint16_t mm = 1000; mm != 1005; mm++) measures(mm);
    assert_int_equal(pins.sets, 0);
}

/* ---- public frames, with what their sources say ---- */

static void start_auto(const fathom_model_facts_t *model)
{
    const fathom_a16_auto_config_t config = {.model = model};
    rig_start(1000);
    assert_int_equal(fathom_a16_auto_init(&automatic, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&automatic);
}

TEST(the_public_frames_are_read)
{
    static const struct {
        const fathom_model_facts_t *model;
        uint8_t frame[4];
        fathom_status_t status;
        uint8_t kind;
        uint16_t mm;
    } frames[] = {
        /* DFRobot SEN0311, SEN0312; JSN-SR04T */
        {&fathom_model_a02yyuw, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        {&fathom_model_me007ys, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        {&fathom_model_jsn_sr04t_auto, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        /* a tool for the GL04; an L081 without an echo; an L041 without an echo */
        {&fathom_model_l041mtw, {0xFF, 0x07, 0x5F, 0x65}, FATHOM_OK, FATHOM_TARGET, 1887},
        {&fathom_model_l081mtw, {0xFF, 0xFF, 0xFD, 0xFB}, FATHOM_OK, FATHOM_NO_TARGET, 0},
        {&fathom_model_l041mtw, {0xFF, 0x00, 0x00, 0xFF}, FATHOM_OK, FATHOM_NO_TARGET, 0},
        /* 222 mm of an AJ-SR04M whose sum leaves FF out: no frame of the A16 */
        {&fathom_model_aj_sr04m_auto, {0xFF, 0x00, 0xDE, 0xDE}, FATHOM_PENDING, 0, 0},
        {&fathom_model_aj_sr04m_auto, {0xFF, 0x00, 0xDE, 0xDD}, FATHOM_OK, FATHOM_TARGET, 222},
    };
    for (unsigned i = 0; i != COUNT(frames); i++) {
        start_auto(frames[i].model);
        assert_int_equal(rig_send(frames[i].frame, 4, 500), frames[i].status);
        assert_int_equal(rig.samples, frames[i].status == FATHOM_OK);
        assert_int_equal(rig.sample.kind, frames[i].kind);
        assert_int_equal(rig.sample.distance_mm, frames[i].mm);
    }
}

static fathom_a16_modbus_t by_modbus;
static int16_t temperature_dc;
static fathom_status_t get_temperature(void)
{
    return fathom_a16_modbus_get_temperature(&by_modbus, &temperature_dc);
}
static fathom_status_t get_distance(void) { return checked_poll(&rig.sensor, &rig.sample); }

/* Seeed's PDF, and the sheets of A22 and GL04: 754 mm processed, 751 mm real-time, 30.0 degrees C. */
TEST(the_public_transactions_are_read)
{
    static const struct {
        uint8_t value;
        uint8_t request[8], response[7];
        uint16_t mm;
    } reads[] = {{FATHOM_PROCESSED,
                  {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6},
                  {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1},
                  754},
                 {FATHOM_REAL_TIME,
                  {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36},
                  {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8},
                  751}};
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x02, 0x00, 0x01, 0x24, 0x36};
    static const uint8_t response[] = {0x01, 0x03, 0x02, 0x01, 0x2C, 0xB8, 0x09};
    static const fathom_model_facts_t *const models[] = {&fathom_model_seeed_750, &fathom_model_a22_rs485,
                                                         &fathom_model_l042m4w};
    for (unsigned i = 0; i != COUNT(models) * COUNT(reads); i++) {
        rig_start(1000);
        const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
        const fathom_a16_modbus_config_t config = {.model = models[i / 2], .value = reads[i % 2].value};
        assert_int_equal(fathom_a16_modbus_init(&by_modbus, &transport, &config), FATHOM_OK);
        rig.sensor = fathom_a16_modbus_sensor(&by_modbus);
        assert_int_equal(rig_transaction(get_distance, reads[i % 2].request, 8, reads[i % 2].response, 7),
                         FATHOM_OK);
        assert_int_equal(rig.sample.distance_mm, reads[i % 2].mm);
        rig.fake.now_us += 200 * MS;
        assert_int_equal(rig_transaction(get_temperature, request, 8, response, 7), FATHOM_OK);
        assert_int_equal(temperature_dc, 300);
    }
}

/* Which models measure a temperature stands here by hand. */
TEST(only_models_with_a_temperature_are_asked_for_it)
{
    static const char with[] = "A02YY4W A12-RS485 A21-RS485 A22-RS485 L041M4W L042M4W Seeed-101991041";
    unsigned found = 0;
    for (uint16_t index = 0; next_row(index); index++) {
        if (row->mode != FATHOM_MODE_MODBUS || row->family != FATHOM_A16) continue;
        const bool has = strstr(with, row->name) != NULL;
        rig_start(1000);
        const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
        const fathom_a16_modbus_config_t config = {.model = facts};
        assert_int_equal(fathom_a16_modbus_init(&by_modbus, &transport, &config), FATHOM_OK);
        must(get_temperature() == (has ? FATHOM_PENDING : FATHOM_ERR_UNSUPPORTED), "temperature", has);
        found += has;
    }
    assert_int_equal(found, 7);
}
