/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_settings.h"

/* The facts of models (model_facts.h): what a relative does that the A16 and A05 of the datasheets do not. */

static fathom_model_facts_t model;
static fathom_a16_auto_t a16;
static fathom_a05_auto_t a05;
static fathom_line_byte_t line_byte;

static const suite_t suite = {.set_up = controlled_set_up};

/* ---- automatic output: frames that repeat the measurement ---- */

static void listen(uint16_t period_ms)
{
    const fathom_a16_auto_config_t config = {.model = &model};
    model = fathom_a16_auto_model;
    model.period_ms = period_ms;
    rig_start(0);
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
    rig_run(10 * MS, 500);
}

/* A frame whose last byte comes this long after now, and then a silence; what comes of it. */
static fathom_status_t hears(const uint16_t *values, unsigned count, uint32_t in_us)
{
    uint8_t frame[10];
    const uint32_t at_us = rig.fake.now_us + in_us;
    const size_t length = rig_dyp_stream(frame, values, count);
    fake_receive_rx(&rig.fake, in_us, frame, length, (fathom_rx_t){at_us, FATHOM_RX_TIMED});
    rig.fake.now_us = at_us;
    PENDS(rig_poll());
    rig.fake.now_us = at_us + RIG_GAP_US;
    return rig_poll();
}

static fathom_status_t hears_value(uint16_t value, uint32_t in_us) { return hears(&value, 1, in_us); }

/* Three quarters of 100 ms are 75 ms, from the last byte of the first frame: 5 ms of them are the silence behind it. */
TEST(the_old_value_within_three_quarters_of_the_period_is_the_same_measurement)
{
    listen(100);
    assert_int_equal(hears_value(1953, 10 * MS), FATHOM_OK);
    const uint32_t first_us = rig.sample.time_us;
    assert_int_equal(first_us, 20 * MS);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(hears_value(1953, 20 * MS), FATHOM_OK);
    assert_int_equal(hears_value(1953, 45 * MS - 1), FATHOM_OK); /* 5 + 20 + 5 + 45 - 0.001 */
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig.sample.time_us, first_us);
    assert_int_equal(rig.sample.distance_mm, 1953);
    assert_int_equal(hears_value(511, 20 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 2);
    assert_int_equal(hears_value(511, 70 * MS), FATHOM_OK); /* 75 ms */
    assert_int_equal(rig.sample.sequence, 3);
    assert_int_equal(rig.sample.time_us, rig.fake.now_us - RIG_GAP_US);
    assert_int_equal(hears_value(767, 10 * MS), FATHOM_OK); /* 0x02FF: 511 is 0x01FF */
    assert_int_equal(hears_value(511, 10 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 5);
    assert_int_equal(rig.samples, 7);
}

/* A DS1603L sends every 4 s: 2 s and 4 * 4.096 s are 18.384 s. The A16 of the datasheet has no period. */
TEST(a_model_that_sends_seldom_becomes_stale_later)
{
    static const struct {
        uint16_t period_ms;
        uint32_t stale_us;
    } rows[] = {{0, 2000 * MS}, {100, 2400 * MS}, {4000, 18000 * MS}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        listen(rows[i].period_ms);
        rig.fake.now_us = rows[i].stale_us - 1;
        PENDS(rig_poll());
        rig.fake.now_us = rows[i].stale_us;
        assert_int_equal(rig_poll(), FATHOM_ERR_STALE);
    }
}

TEST(the_old_value_is_a_new_measurement_if_no_period_is_known)
{
    listen(0);
    for (unsigned n = 1; n <= 5; n++) {
        assert_int_equal(hears_value(1953, 10 * MS), FATHOM_OK);
        assert_int_equal(rig.sample.sequence, n);
    }
}

/* No value precedes the first one, although memory is 0 and the clock is less than the period. */
TEST(the_first_frame_is_a_measurement_also_if_it_has_0)
{
    listen(1000);
    assert_int_equal(hears_value(0, 10 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(rig.sample.time_us, 20 * MS);
    assert_int_equal(hears_value(0, 10 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 1);
}

/* 49.151 s is three quarters of the longest period, 65.535 s. */
TEST(a_repeated_refused_value_is_refused_again_and_long_periods_count)
{
    listen(65535);
    assert_int_equal(hears_value(0xFFFF, 10 * MS), FATHOM_ERR_MALFORMED);
    assert_int_equal(hears_value(0xFFFF, 10 * MS), FATHOM_ERR_MALFORMED);
    assert_int_equal(a16.base.measurement.implausible, 2);
    assert_int_equal(hears_value(0xFFFD, 10 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 2);
    for (unsigned s = 0; s != 49; s++) assert_int_equal(hears_value(0xFFFD, 995 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 2);
    assert_int_equal(hears_value(0xFFFD, 995 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 3);
}

TEST(an_a05_repeats_a_measurement_only_if_all_four_values_are_the_old_ones)
{
    static const uint16_t values[][4] = {{1000, 2000, 3000, 4000},
                                         {1000, 2000, 3000, 4000},
                                         {1001, 2000, 3000, 4000},
                                         {1001, 2000, 3000, 4001},
                                         {1001, 2000, 3000, 4001}};
    static const uint16_t sequences[] = {1, 1, 2, 3, 3};
    const fathom_a05_auto_config_t config = {.model = &model};
    model = fathom_a05_auto_model;
    model.period_ms = 300;
    rig_start(1000);
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a05_auto_sensor(&a05);
    rig_run(10 * MS, 500);
    for (unsigned i = 0; i != COUNT(values); i++) {
        assert_int_equal(hears(values[i], 4, 30 * MS), FATHOM_OK);
        for (uint8_t probe = 2; probe <= 4; probe++) assert_int_equal(rig_poll(), FATHOM_OK);
        assert_int_equal(rig.sample.probe, 4);
        assert_int_equal(rig.sample.distance_mm, values[i][3]);
        assert_int_equal(rig.sample.sequence, sequences[i]);
    }
}

/* FF + FF + FB = 2F9: out of water, as an L081MTW sends it. */
TEST(each_value_has_the_meaning_of_the_model)
{
    static const uint8_t out_of_water[] = {0xFF, 0xFF, 0xFB, 0xF9};
    uint8_t frame[4];
    const uint16_t value = 0xFFFB;
    assert_int_equal(rig_dyp_stream(frame, &value, 1), 4);
    assert_memory_equal(frame, out_of_water, 4);
    listen(0);
    assert_int_equal(hears_value(0xFFFB, 10 * MS), FATHOM_ERR_MALFORMED);
    model.value_fffb = FATHOM_MEANS_FAULT; /* the driver keeps the pointer */
    assert_int_equal(hears_value(0xFFFB, 10 * MS), FATHOM_OK);
    assert_int_equal(rig.sample.kind, FATHOM_FAULT);
    assert_int_equal(rig.sample.raw, 0xFFFB);
}

/* ---- a byte as the trigger ---- */

/* L041MTW: 50 to 6000 mm, at least 19 ms between two triggers, answers after 13 ms, 0 without an echo. */
static void start_l041(void)
{
    controlled.model = (fathom_model_facts_t){.min_mm = 50,
                                              .max_mm = 6000,
                                              .period_ms = 19,
                                              .start = FATHOM_STARTS_BYTE,
                                              .trigger_byte = 0x55,
                                              .earliest_ms = 8,
                                              .latest_ms = 18,
                                              .value_0 = FATHOM_MEANS_NO_TARGET};
    line_byte.line = &rig.line;
    line_byte.byte = controlled.model.trigger_byte;
    controlled.trigger = fathom_output_line_byte(&line_byte);
    controlled_start();
}

TEST(a_byte_that_the_port_does_not_take_is_tried_again_and_reported_after_a_second)
{
    start_l041();
    rig.fake.write_busy = true;
    rig_run(900 * MS, 1 * MS);
    assert_int_equal(rig.ports, 0);
    rig_run(110 * MS, 1 * MS);
    assert_int_equal(rig.ports, 1);
    rig.fake.write_busy = false;
    rig_run(1 * MS, 1 * MS);
    assert_int_equal(rig.fake.written, 1);
    rig.fake.write_fails = true;
    rig_run(18 * MS, 1 * MS);
    assert_int_equal(rig.ports, 1);
    rig_run(4 * MS, 1 * MS);
    assert_in_range(rig.ports, 2, 5);
}

static void sets_byte(uint8_t level, fathom_status_t status)
{
    assert_int_equal(fathom_output_set(&controlled.trigger, level), status);
}

/* A level that sends nothing has no reason to be refused. */
static void sends_nothing(void)
{
    sets_byte(FATHOM_OUTPUT_HIGH, FATHOM_OK);
    sets_byte(FATHOM_OUTPUT_REST, FATHOM_OK);
    sets_byte(FATHOM_OUTPUT_FREE, FATHOM_OK);
}

TEST(a_byte_is_not_sent_while_a_transaction_or_a_break_uses_the_line)
{
    static fathom_a16_modbus_t modbus;
    const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
    fathom_sample_t sample;
    start_l041();
    sends_nothing();
    assert_int_equal(rig.fake.written, 0);
    assert_int_equal(fathom_line_break(&rig.line, true), FATHOM_OK);
    sets_byte(FATHOM_OUTPUT_LOW, FATHOM_ERR_BUSY);
    sends_nothing();
    assert_int_equal(fathom_line_break(&rig.line, false), FATHOM_OK);
    assert_int_equal(fathom_a16_modbus_init(&modbus, &transport, NULL), FATHOM_OK);
    for (unsigned polls = 0; rig.fake.written == 0; polls++) {
        assert_true(polls < 100);
        rig.fake.now_us += 1 * MS;
        PENDS(fathom_a16_modbus_poll(&modbus, &sample));
    }
    for (unsigned polls = 0; polls != 2; polls++) { /* on its way, and waited for */
        sets_byte(FATHOM_OUTPUT_LOW, FATHOM_ERR_BUSY);
        sends_nothing();
        rig.fake.now_us += 20 * MS;
        PENDS(fathom_a16_modbus_poll(&modbus, &sample));
    }
    assert_int_equal(rig.fake.written, 1);
    fathom_a16_modbus_deinit(&modbus);
    sets_byte(FATHOM_OUTPUT_LOW, FATHOM_OK);
    assert_int_equal(rig.fake.written, 2);
}

TEST(a_port_that_cannot_send_has_no_byte)
{
    start_l041();
    rig.fake.uart.write = NULL;
    sets_byte(FATHOM_OUTPUT_REST, FATHOM_ERR_UNSUPPORTED);
    sets_byte(FATHOM_OUTPUT_LOW, FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(controlled_init(), FATHOM_ERR_UNSUPPORTED);
    assert_null(rig.line.listener);
}

/* "0: none is known": the next trigger follows the latest response. */
TEST(without_a_known_period_the_trigger_follows_the_latest_response)
{
    start_l041();
    controlled.model.period_ms = 0;
    controlled.model.latest_ms = 60;
    controlled_start();
    assert_int_equal(controlled.a16.trigger.period_us, 60 * MS);
    controlled.config.period_us = 59999;
    controlled_start();
    assert_int_equal(controlled.a16.trigger.period_us, 60 * MS);
    controlled.config.period_us = 60001;
    controlled_start();
    assert_int_equal(controlled.a16.trigger.period_us, 60001);
}

/* ---- pins ---- */

TEST(each_output_of_a_pin_has_its_level)
{
    static const struct {
        uint8_t level;
        bool pin, inverted;
    } rows[] = {{FATHOM_OUTPUT_LOW, false, true},  {FATHOM_OUTPUT_HIGH, true, false},
                {FATHOM_OUTPUT_LOW, false, true},  {FATHOM_OUTPUT_FREE, false, true}, /* it keeps the level */
                {FATHOM_OUTPUT_REST, true, false}, {FATHOM_OUTPUT_FREE, true, false}};
    fake_pin_t pin, inverted;
    fake_pin_init(&pin, &rig.fake);
    fake_pin_init(&inverted, &rig.fake);
    const fathom_output_t outputs[] = {fathom_output_pin(&pin.trigger),
                                       fathom_output_inverted_pin(&inverted.trigger), fathom_output_none()};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        for (unsigned o = 0; o != COUNT(outputs); o++)
            assert_int_equal(fathom_output_set(&outputs[o], rows[i].level), FATHOM_OK);
        assert_int_equal(pin.level, rows[i].pin);
        assert_int_equal(inverted.level, rows[i].inverted);
    }
    assert_int_equal(inverted.sets, 4);
    const fathom_pin_t input = {NULL, NULL, NULL};
    const fathom_output_t wrong[] = {fathom_output_inverted_pin(&input), fathom_output_inverted_pin(NULL)};
    for (unsigned o = 0; o != COUNT(wrong); o++)
        assert_int_equal(fathom_output_set(&wrong[o], FATHOM_OUTPUT_LOW), FATHOM_ERR_UNSUPPORTED);
}

/* ---- register 0x0102 ---- */

static fathom_a16_modbus_t by_modbus;
static int16_t temperature_dc;

static fathom_status_t get_temperature(void)
{
    return fathom_a16_modbus_get_temperature(&by_modbus, &temperature_dc);
}

/* The printed frames are 30.0 degrees C; -10.5 are -105, FF97, with the CRC 1AB8. */
TEST(the_temperature_is_signed_and_in_tenths_of_a_degree)
{
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x02, 0x00, 0x01, 0x24, 0x36};
    static const uint8_t warm[] = {0x01, 0x03, 0x02, 0x01, 0x2C, 0xB8, 0x09};
    static const uint8_t cold[] = {0x01, 0x03, 0x02, 0xFF, 0x97, 0xB8, 0x1A};
    const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
    const fathom_a16_modbus_config_t config = {.model = &model};
    model = fathom_a16_modbus_model;
    model.registers = FATHOM_HAS_TEMPERATURE;
    rig_start(1000);
    assert_int_equal(fathom_a16_modbus_init(&by_modbus, &transport, &config), FATHOM_OK);
    assert_int_equal(rig_transaction(get_temperature, request, 8, warm, 7), FATHOM_OK);
    assert_int_equal(temperature_dc, 300);
    rig.fake.now_us += 200 * MS;
    assert_int_equal(rig_transaction(get_temperature, request, 8, cold, 7), FATHOM_OK);
    assert_int_equal(temperature_dc, -105);
}

TEST(an_a16_has_no_temperature)
{
    const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
    temperature_dc = 77;
    memset(&by_modbus, 0, sizeof by_modbus);
    assert_int_equal(get_temperature(), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_init(&by_modbus, &transport, NULL), FATHOM_OK);
    assert_int_equal(get_temperature(), FATHOM_ERR_UNSUPPORTED);
    rig.fake.now_us += 1000 * MS;
    assert_int_equal(get_temperature(), FATHOM_ERR_UNSUPPORTED);
    assert_int_equal(rig.fake.written, 0);
    assert_int_equal(temperature_dc, 77);
}
