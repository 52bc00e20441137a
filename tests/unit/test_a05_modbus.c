/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "desk.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_modbus.h"

/* Its four probes; test_driver_contract.c has the rest. */

static fathom_a05_modbus_config_t config;
static const fathom_modbus_t *transport;
static fathom_a05_modbus_t a05;

static int set_up(void **state)
{
    desk_begin(5000);
    config = (fathom_a05_modbus_config_t){0};
    transport = &fake.modbus;
    memset(&a05, 0x5A, sizeof a05);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void start(void)
{
    assert_int_equal(fathom_a05_modbus_init(&a05, transport, &config), FATHOM_OK);
    desk.sensor = fathom_a05_modbus_sensor(&a05);
}

/* Asks, and is answered with these. */
#define IS_TOLD(...)                                                                                         \
    do {                                                                                                     \
        desk_waits(400000);                                                                                  \
        fake_modbus_response(&fake, (const uint16_t[]){__VA_ARGS__},                                         \
                             (uint8_t)COUNT(((const uint16_t[]){__VA_ARGS__})));                             \
    } while (0)

/* ---- what is asked ---- */

/* A05 3(3): probes 1 to 4 at 0106 to 0109 and at 0010 to 0013, about 100 ms each. One read covers the first to
 * the last probe that is wanted. */
typedef struct {
    uint8_t first; /* probe */
    uint8_t count;
} span_t;

static const span_t spans[16] = {{1, 4}, {1, 1}, {2, 1}, {1, 2}, {3, 1}, {1, 3}, {2, 2}, {1, 3},
                                 {4, 1}, {1, 4}, {2, 3}, {1, 4}, {3, 2}, {1, 4}, {2, 3}, {1, 4}};

/* What probe p reads: 1000 p + 1. Takes the samples of `probes` and nothing else. */
static void take_samples(uint8_t probes, uint16_t sequence)
{
    unsigned taken = 0;
    for (uint8_t probe = 1; probe <= 4; probe++) {
        if ((probes >> (probe - 1) & 1) == 0) continue;
        if (taken++ != 0) assert_int_equal(fathom_due_us(&desk.sensor, 1), 0);
        assert_int_equal(desk_poll(), FATHOM_OK);
        assert_sample(&desk.sample, (fathom_sample_t){.time_us = fake.heard_us,
                                                      .raw = 1000u * probe + 1,
                                                      .distance_mm = (uint16_t)(1000 * probe + 1),
                                                      .sequence = sequence,
                                                      .kind = FATHOM_TARGET,
                                                      .model = FATHOM_A05,
                                                      .address = 1,
                                                      .probe = probe});
    }
}

static void ask_spans(uint16_t register_of_1)
{
    for (uint8_t probes = 0; probes != 16; probes++) { /* 0: all four */
        const span_t span = spans[probes];
        const uint16_t first = (uint16_t)(register_of_1 + span.first - 1);
        const uint32_t pace_us = 100000ul * span.count;
        uint16_t values[4] = {0, 0, 0, 0};
        set_up(NULL);
        config.probes = probes;
        config.registers = register_of_1 == 0x0106 && probes % 2 != 0 ? 0 : register_of_1;
        start();
        desk_waits(0);
        fake_modbus_assert_asked(&fake, 1, 1, first, span.count);
        assert_int_equal(fake.request->transaction.timeout_us, 200000 + pace_us);
        for (uint8_t i = 0; i != span.count; i++) values[i] = (uint16_t)(1000 * (span.first + i) + 1);
        fake_modbus_send(&fake);
        desk_waits(0);
        fake_modbus_response(&fake, values, span.count);
        fake.now_us += 90000;
        take_samples(probes == 0 ? 0xF : probes, 1);
        desk_waits(pace_us - 90001);
        assert_int_equal(fake.submits, 1);
        assert_int_equal(fathom_due_us(&desk.sensor, 1), 1);
        desk_waits(1);
        fake_modbus_assert_asked(&fake, 2, 1, first, span.count);
    }
}

TEST(every_choice_of_probes_is_one_read_with_its_own_time_out_and_pace) { ask_spans(0x0106); }

/* A05 3(3) remark 2 prints "same function as 0x0106~0x0108"; the table beside it has 0013 for No. 4 too. */
TEST(every_choice_of_probes_in_the_other_block_of_registers) { ask_spans(0x0010); }

/* ---- what comes back ---- */

TEST(the_samples_of_one_response_share_sequence_and_time)
{
    start();
    for (uint16_t response = 1; response <= 3; response++) {
        fake.heard_us = 1000u * response;
        IS_TOLD(1001, 2001, 3001, 4001);
        take_samples(0xF, response);
        desk_waits(7000);
    }
    IS_TOLD(1000, 0xFFFD, 0xFFFE, 3562);
    for (unsigned probe = 1; probe <= 4; probe++) {
        assert_int_equal(desk_poll_after(7000), FATHOM_OK);
        assert_int_equal(desk.sample.time_us, 3000);
        assert_int_equal(desk.sample.kind, probe == 2 || probe == 3 ? FATHOM_NO_TARGET : FATHOM_TARGET);
        assert_int_equal(desk.sample.interference, probe == 3);
    }
    desk_waits(0);
}

/* A05 3(4)1 example 3, byte for byte: probes 2, 3, 4 read 250, 659, 2426 mm. */
TEST(the_example_of_the_datasheet_goes_over_a_line)
{
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6};
    static const uint8_t response[] = {0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47};
    static const uint16_t distances[] = {250, 659, 2426};
    rig_start(RIG_START_US);
    const fathom_modbus_t modbus = fathom_modbus_client(&rig.line);
    transport = &modbus;
    config.probes = 0xE;
    start();
    rig.sensor = desk.sensor;
    assert_int_equal(rig_transaction(rig_poll, request, 8, response, 11), FATHOM_OK);
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(rig.sample.probe, i + 2);
        assert_int_equal(rig.sample.distance_mm, distances[i]);
        if (i != 2) assert_int_equal(rig_poll(), FATHOM_OK);
    }
}

/* Samples say where they were read. */
static fathom_status_t move(void) { return fathom_a05_modbus_set_address(&a05, 5); }

TEST(an_a05_that_has_moved_measures_at_its_new_address)
{
    start();
    PLAY(move, FATHOM_OK, READ(1, 0x0200, FATHOM_OK, 1), READ(5, 0x0200, FATHOM_ERR_NO_RESPONSE, 0),
         WRITE(1, 0x0200, 5, FATHOM_OK), READ(5, 0x0200, FATHOM_OK, 5));
    assert_true(fathom_a05_modbus_is_written(&a05));
    IS_TOLD(1001, 2001, 3001, 4001);
    fake_modbus_assert_asked(&fake, 1, 5, 0x0106, 4);
    for (unsigned probe = 1; probe <= 4; probe++) {
        assert_int_equal(desk_poll(), FATHOM_OK);
        assert_int_equal(desk.sample.address, 5);
    }
}

/* a05_modbus.h: "what was under way is forgotten": the other three probes of a response too. */
TEST(after_power_on_no_sample_of_before_is_handed_over)
{
    start();
    IS_TOLD(1000, 2000, 3000, 4000);
    assert_int_equal(desk_poll(), FATHOM_OK);
    assert_int_equal(desk.sample.distance_mm, 1000);
    fathom_a05_modbus_power_on(&a05);
    desk_waits(0);
    assert_int_equal(fake.submits, 2);
}

static uint8_t address;
static fathom_status_t get_address(void) { return fathom_a05_modbus_get_address(&a05, &address); }

/* "FATHOM_ERR_MALFORMED, where the register says more than 255". */
TEST(an_address_register_says_up_to_255)
{
    start();
    PLAY(get_address, FATHOM_OK, READ(1, 0x0200, FATHOM_OK, 255));
    PLAY(get_address, FATHOM_ERR_MALFORMED, READ(1, 0x0200, FATHOM_OK, 256));
    assert_int_equal(address, 255);
}
