/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fake_modbus.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a16_switch.h"

/* What its levels mean, and Modbus on the same pins; test_driver_contract.c has the rest. */

enum { BIT_US = 104, BYTE_US = RIG_BYTE_US, TIMEOUT_US = 300000 };

/* A16 6(4), the last two examples: threshold to 2000 mm, polarity to negative. The responses equal the requests. */
static const uint8_t threshold_2000[8] = {0x01, 0x06, 0x02, 0x06, 0x07, 0xD0, 0x6B, 0xDF};
static const uint8_t negative[8] = {0x01, 0x06, 0x02, 0x05, 0x00, 0x00, 0x98, 0x73};
static const uint8_t nothing = 0;

static fathom_a16_switch_config_t config;
static fathom_a16_switch_t a16;
static fathom_contact_guard_t guard;
static fathom_modbus_request_t request;

static void start_at(uint32_t now_us, bool level)
{
    rig_start(now_us);
    rig.level = level;
    rig.fake.byte_us = BYTE_US;
    rig.line_parts.echo = FATHOM_LINE_ECHO_OFF;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    memset(&a16, 0x5A, sizeof a16);
    assert_int_equal(fathom_a16_switch_init(&a16, &rig.pin, &rig.fake.clock, &config), FATHOM_OK);
    rig.sensor = fathom_a16_switch_sensor(&a16);
}

static void start(bool level) { start_at(RIG_START_US, level); }

static int set_up(void **state)
{
    guard = fathom_contact_line_guard(&rig.line);
    config = (fathom_a16_switch_config_t){.guard = &guard};
    start(false);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* So much later there are so many samples, the last of this kind. */
static void after_ms(uint32_t ms, unsigned samples, uint8_t kind)
{
    rig_run(ms * 1000, 1000);
    rig_expect(samples, kind);
}

/* The level stands, and is the sample. */
static void stands_as(uint8_t kind) { after_ms(60, 1, kind); }

/* Unit 1 is told to set a register: this is an example of the datasheet. */
static void submit(const uint8_t *example)
{
    memset(&request, 0, sizeof request);
    request.transaction.timeout_us = TIMEOUT_US;
    fathom_modbus_write_single_register(&request.message, 1, (uint16_t)(example[2] << 8 | example[3]),
                                        (uint16_t)(example[4] << 8 | example[5]));
    assert_int_equal(fathom_modbus_client_submit(&rig.line, &request), FATHOM_PENDING);
}

/* At rest, and then asked; the request has left. */
static void asks(const uint8_t *example)
{
    rig_run(60 * MS, 1000);
    submit(example);
    rig_run(10 * MS, 1000);
    assert_int_equal(rig.fake.written, 1);
    assert_memory_equal(rig.fake.writes[0].bytes, example, 8);
}

static int8_t status(void) { return request.transaction.status; }

static void until_ended(void)
{
    while (status() == FATHOM_PENDING) rig_run(1 * MS, 1000);
}

/* The bits of a response on the pin, whose level is `level` before and after it, and the bytes at the UART. */
static void response(uint32_t in_us, bool level, const uint8_t *bytes)
{
    bool now = level;
    fake_trickle(&rig.fake, in_us, BYTE_US, bytes, 8);
    for (uint32_t n = 0; n <= 80; n++) {
        const uint32_t bit = n % 10;
        bool high = bit == 9 || (bit != 0 && (bytes[n / 10 % 8] >> (bit - 1) & 1) != 0);
        if (n == 80) high = level;
        if (high != now) rig_turn(in_us + n / 10 * BYTE_US + bit * BIT_US);
        now = high;
    }
}

/* ---- the level ---- */

TEST(high_is_near_from_the_factory_and_polarity_is_an_option)
{
    for (unsigned i = 0; i != 4; i++) {
        config.negative = i / 2 != 0;
        start(i % 2 != 0);
        stands_as(i == 1 || i == 2 ? FATHOM_NEAR : FATHOM_FAR);
        assert_int_equal(rig.sample.raw, i % 2);
    }
}

TEST(without_a_line_the_level_alone_counts)
{
    config.guard = NULL;
    start(true);
    rig_run(20 * MS, 20000);
    rig_expect(1, FATHOM_NEAR);
    assert_int_equal(rig.fake.reads, 0);
}

/* ---- Modbus on the same pins ---- */

/* Loops of 100 us to 20 ms, levels, and offsets of the response to the loop: the bits of the response are no levels. */
TEST(a_response_on_the_pin_is_no_change_in_any_loop)
{
    static const uint32_t steps_us[] = {100, 1000, 7000, 20000};
    for (unsigned s = 0; s != 4; s++) {
        for (uint32_t offset_us = 0; offset_us < 20000; offset_us += 700) {
            for (unsigned level = 0; level != 2; level++) {
                const uint32_t step_us = steps_us[s];
                start_at(UINT32_MAX - 150 * MS, level != 0);
                rig_run(60 * MS, step_us);
                rig_expect(1, level != 0 ? FATHOM_NEAR : FATHOM_FAR);
                submit(threshold_2000);
                while (rig.fake.written == 0) rig_run(step_us, step_us);
                response(30 * MS + offset_us, level != 0, threshold_2000);
                rig_run(200 * MS, step_us);
                assert_int_equal(status(), FATHOM_OK);
                assert_int_equal(rig.samples, 1);
                assert_int_equal(rig.stales, 0);
            }
        }
    }
}

TEST(a_level_that_has_all_but_settled_when_a_request_leaves_waits)
{
    stands_as(FATHOM_FAR);
    rig_turn(1 * MS);
    rig_run(20 * MS, 1000); /* seen for 19 ms */
    submit(threshold_2000);
    rig_run(1 * MS, 1000);
    assert_int_equal(rig.fake.written, 1);
    after_ms(100, 1, FATHOM_FAR);
}

/* The unit is quarantined, so the next request waits; the pin is free. */
TEST(a_request_that_waits_does_not_hide_the_level)
{
    asks(threshold_2000);
    until_ended();
    submit(threshold_2000);
    rig_turn(0);
    rig_run(50 * MS, 1000);
    assert_int_equal(rig.fake.written, 1);
    rig_expect(2, FATHOM_NEAR);
}

TEST(bytes_that_never_end_make_it_stale)
{
    for (unsigned i = 0; i != 4200; i++) {
        fake_receive(&rig.fake, 0, &nothing, 1);
        rig_run(1 * MS, 1000);
    }
    assert_int_equal(rig.samples, 0);
    assert_int_equal(rig.stales, 2);
    after_ms(26, 1, FATHOM_FAR);
}

TEST(while_the_line_is_busy_a_look_is_due_in_5_ms)
{
    stands_as(FATHOM_FAR);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 10000);
    submit(threshold_2000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0); /* the line's: send it */
    rig_run(1 * MS, 1000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 1000); /* the line's: has it left? */
    rig_run(20 * MS, 1000);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 5000);
    rig.fake.now_us += 2000;
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 3000);
}

TEST(a_broken_port_is_said_but_does_not_hide_the_level)
{
    rig.fake.read_fails = true;
    after_ms(100, 1, FATHOM_FAR);
    assert_int_equal(rig.ports, 100); /* each poll but the one of the sample */
    rig_turn(0);
    after_ms(22, 2, FATHOM_NEAR);
}

/* ---- polarity by Modbus ---- */

TEST(polarity_that_is_set_and_told_is_no_change)
{
    for (unsigned level = 0; level != 2; level++) {
        const uint8_t before = level != 0 ? FATHOM_NEAR : FATHOM_FAR;
        const uint8_t after = level != 0 ? FATHOM_FAR : FATHOM_NEAR;
        start(level != 0);
        asks(negative);
        fake_trickle(&rig.fake, 30 * MS, BYTE_US, negative, 8);
        until_ended();
        fathom_a16_switch_note_polarity(&a16, FATHOM_A16_NEGATIVE);
        rig_turn(10 * MS);
        after_ms(200, 1, before);
        rig_turn(0);
        after_ms(50, 2, after);
        fathom_a16_switch_note_polarity(&a16, FATHOM_A16_POSITIVE);
        after_ms(50, 3, before);
    }
}

/* Sets the polarity of a module that holds `held`. `ends` is the end of each request. Meanwhile the level turns. */
static fathom_status_t set_polarity(fathom_a16_polarity_t polarity, uint16_t held, fathom_status_t ends)
{
    fake_modbus_t fake;
    fathom_a16_modbus_t modbus;
    fathom_status_t result;
    fake_modbus_init(&fake);
    assert_int_equal(fathom_a16_modbus_init(&modbus, &fake.modbus, NULL), FATHOM_OK);
    rig_turn(0);
    while ((result = fathom_a16_switch_set_polarity(&a16, &modbus, polarity)) == FATHOM_PENDING) {
        rig_run(50 * MS, 1000);
        fake.now_us += 50 * MS;
        if (fake.request == NULL) continue;
        if (ends != FATHOM_OK) {
            fake_modbus_fail(&fake, ends);
        } else if (fake.request->message.head[1] == 6) {
            held = (uint16_t)(fake.request->message.head[4] << 8 | fake.request->message.head[5]);
            fake_modbus_acknowledge(&fake);
        } else {
            fake_modbus_response(&fake, &held, 1);
        }
    }
    return result;
}

TEST(while_the_polarity_is_set_no_level_counts_and_then_it_has_its_new_meaning)
{
    start(true);
    stands_as(FATHOM_NEAR);
    assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, 1, FATHOM_OK), FATHOM_OK);
    rig_expect(1, FATHOM_NEAR);
    after_ms(60, 1, FATHOM_NEAR); /* it is low now, and still near */
    rig_turn(0);
    after_ms(60, 2, FATHOM_FAR);
}

TEST(after_a_polarity_that_could_not_be_set_the_level_has_its_previous_meaning)
{
    start(true);
    stands_as(FATHOM_NEAR);
    assert_int_equal(set_polarity(FATHOM_A16_NEGATIVE, 1, FATHOM_ERR_NO_RESPONSE), FATHOM_ERR_NO_RESPONSE);
    rig_expect(1, FATHOM_NEAR);
    after_ms(60, 2, FATHOM_FAR);
}
