/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fake_modbus.h"
#include "fathom/a05_modbus.h"
#include "fathom/modbus_client.h"

enum { GUARD = 0xA5 };

static fake_modbus_t fake;
static fathom_a05_modbus_config_t config;
static fathom_a05_modbus_t a05;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    memset(&config, 0, sizeof config);
    config.modbus = &fake.modbus;
    config.clock = &fake.clock;
    memset(&a05, 0x5A, sizeof a05);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void start(void)
{
    assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_READY);
    sensor = fathom_a05_modbus_sensor(&a05);
}

static fathom_status_t poll_after(uint32_t us)
{
    fake.now_us += us;
    memset(&sample, GUARD, sizeof sample);
    return fathom_poll(&sensor, &sample);
}

static void assert_sample_untouched(void)
{
    uint8_t untouched[sizeof sample];
    memset(untouched, GUARD, sizeof untouched);
    assert_memory_equal(&sample, untouched, sizeof untouched);
}

static void assert_nothing_after(uint32_t us)
{
    assert_int_equal(poll_after(us), FATHOM_PENDING);
    assert_sample_untouched();
}

/* ---- what is asked ---- */

/* A05 3(3): probes 1 to 4 at 0106 to 0109 and at 0010 to 0013, about 100 ms each. One read covers the first to
 * the last probe that is wanted. */
typedef struct {
    uint8_t probes;
    uint16_t first;
    uint16_t alias_first;
    uint8_t count;
    uint32_t timeout_us;
    uint32_t pace_us;
} mask_t;

static const mask_t masks[15] = {
    {0x1, 0x0106, 0x0010, 1, 300000, 100000}, {0x2, 0x0107, 0x0011, 1, 300000, 100000},
    {0x3, 0x0106, 0x0010, 2, 400000, 200000}, {0x4, 0x0108, 0x0012, 1, 300000, 100000},
    {0x5, 0x0106, 0x0010, 3, 500000, 300000}, {0x6, 0x0107, 0x0011, 2, 400000, 200000},
    {0x7, 0x0106, 0x0010, 3, 500000, 300000}, {0x8, 0x0109, 0x0013, 1, 300000, 100000},
    {0x9, 0x0106, 0x0010, 4, 600000, 400000}, {0xA, 0x0107, 0x0011, 3, 500000, 300000},
    {0xB, 0x0106, 0x0010, 4, 600000, 400000}, {0xC, 0x0108, 0x0012, 2, 400000, 200000},
    {0xD, 0x0106, 0x0010, 4, 600000, 400000}, {0xE, 0x0107, 0x0011, 3, 500000, 300000},
    {0xF, 0x0106, 0x0010, 4, 600000, 400000},
};

/* What probe p reads: 1000 p + 1. Takes the samples of `probes` and nothing else. */
static void take_samples(uint8_t probes, uint16_t sequence)
{
    unsigned taken = 0;
    for (uint8_t probe = 1; probe <= 4; probe++) {
        if ((probes >> (probe - 1) & 1) == 0) continue;
        if (taken++ != 0) assert_int_equal(fathom_due_us(&sensor, 1), 0);
        assert_int_equal(poll_after(0), FATHOM_READY);
        assert_int_equal(sample.probe, probe);
        assert_int_equal(sample.raw, 1000 * probe + 1);
        assert_int_equal(sample.distance_mm, 1000 * probe + 1);
        assert_int_equal(sample.sequence, sequence);
    }
}

static void ask_mask(const mask_t *mask, uint16_t first)
{
    uint16_t values[4] = {0, 0, 0, 0};
    const uint8_t first_probe = (uint8_t)(first == mask->first ? first - 0x0105 : first - 0x000F);
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 1, first, mask->count);
    assert_int_equal(fake.request->exchange.timeout_us, mask->timeout_us);
    assert_int_equal(fake.request->exchange.retries, 0);

    for (uint8_t i = 0; i != mask->count; i++) values[i] = (uint16_t)(1000 * (first_probe + i) + 1);
    fake_modbus_send(&fake);
    assert_nothing_after(0);
    fake_modbus_answer(&fake, values, mask->count);
    fake.now_us += 90000;
    take_samples(mask->probes, 1);
    assert_nothing_after(mask->pace_us - 90001);
    assert_int_equal(fake.submits, 1);
    assert_int_equal(fathom_due_us(&sensor, 1), 1);
    assert_nothing_after(1);
    fake_modbus_assert_asked(&fake, 2, 1, first, mask->count);
}

TEST(every_choice_of_probes_is_one_read_with_its_own_time_out_and_pace)
{
    for (unsigned i = 0; i != 15; i++) {
        assert_int_equal(masks[i].probes, i + 1);
        set_up(NULL);
        config.probes = masks[i].probes;
        ask_mask(&masks[i], masks[i].first);
    }
}

/* A05 3(3) remark 2 prints "same function as 0x0106~0x0108"; the table beside it has 0013 for No. 4 too. */
TEST(every_choice_of_probes_in_the_other_block_of_registers)
{
    for (unsigned i = 0; i != 15; i++) {
        set_up(NULL);
        config.probes = masks[i].probes;
        config.registers = 0x0010;
        ask_mask(&masks[i], masks[i].alias_first);
    }
}

TEST(by_default_it_asks_unit_1_for_all_four_probes) { ask_mask(&masks[14], 0x0106); }

/* A05 3(3) calls 0109 "No.3 probe"; its description beside it says No. 4. */
TEST(register_0109_is_probe_4)
{
    config.probes = 0x8;
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0109, 1);
    fake_modbus_answer(&fake, (const uint16_t[]){2426}, 1);
    assert_int_equal(poll_after(90000), FATHOM_READY);
    assert_int_equal(sample.probe, 4);
}

TEST(the_config_is_asked_as_it_says)
{
    config.address = 254;
    config.probes = 0x2;
    config.timeout_us = 55000;
    config.retries = 2;
    config.period_us = 100001;
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 254, 0x0107, 1);
    assert_int_equal(fake.request->exchange.timeout_us, 55000);
    assert_int_equal(fake.request->exchange.retries, 2);
    fake_modbus_answer(&fake, (const uint16_t[]){2331}, 1);
    assert_int_equal(poll_after(0), FATHOM_READY);
    assert_int_equal(sample.unit, 254);
    assert_nothing_after(100000);
    assert_int_equal(fake.submits, 1);
    assert_nothing_after(1);
    assert_int_equal(fake.submits, 2);
}

TEST(a_period_that_the_probes_cannot_keep_is_stretched)
{
    config.period_us = 399999;
    start();
    assert_nothing_after(0);
    fake_modbus_answer(&fake, (const uint16_t[]){1001, 2001, 3001, 4001}, 4);
    take_samples(0xF, 1);
    assert_nothing_after(399999);
    assert_int_equal(fake.submits, 1);
    assert_nothing_after(1);
    assert_int_equal(fake.submits, 2);
}

TEST(wrong_arguments_are_refused)
{
    static const uint16_t registers[] = {0x0107, 0x0105, 0x0011, 0x000F, 0x0200, 1};
    config.modbus = NULL;
    assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.clock = NULL;
    assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.address = 255;
    assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.window.min_mm = 6001;
    assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    for (unsigned probes = 16; probes != 256; probes++) {
        set_up(NULL);
        config.probes = (uint8_t)probes;
        assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    }
    for (unsigned i = 0; i != sizeof registers / sizeof *registers; i++) {
        set_up(NULL);
        config.registers = registers[i];
        assert_int_equal(fathom_a05_modbus_init(&a05, &config), FATHOM_ERR_ARGUMENT);
    }
    assert_int_equal(fake.submits + fake.polls, 0);
}

/* ---- what comes back ---- */

TEST(the_samples_of_one_answer_share_sequence_and_time)
{
    config.address = 5;
    start();
    for (unsigned answer = 1; answer <= 3; answer++) {
        assert_nothing_after(400000);
        fake.heard_us = 1000 * answer;
        fake_modbus_answer(&fake, (const uint16_t[]){1000, 0xFFFD, 0xFFFE, 3562}, 4);
        for (unsigned probe = 1; probe <= 4; probe++) {
            assert_int_equal(poll_after(probe == 1 ? 0 : 7000), FATHOM_READY);
            assert_int_equal(sample.probe, probe);
            assert_int_equal(sample.sequence, answer);
            assert_int_equal(sample.time_us, 1000 * answer);
            assert_int_equal(sample.model, FATHOM_A05);
            assert_int_equal(sample.unit, 5);
            assert_int_equal(sample.magnitude + sample.precision + sample.ambient, 0);
            assert_int_equal(sample.kind, probe == 2 || probe == 3 ? FATHOM_NO_TARGET : FATHOM_TARGET);
            assert_true(sample.interference == (probe == 3));
        }
        assert_nothing_after(0);
    }
}

TEST(a_value_that_cannot_be_is_refused_alone)
{
    config.window.min_mm = 250;
    config.window.max_mm = 4500;
    start();
    assert_nothing_after(0);
    fake_modbus_answer(&fake, (const uint16_t[]){249, 250, 4501, 4500}, 4);
    assert_int_equal(poll_after(0), FATHOM_ERR_MALFORMED);
    assert_sample_untouched();
    assert_int_equal(poll_after(0), FATHOM_READY);
    assert_int_equal(sample.probe, 2);
    assert_int_equal(sample.distance_mm, 250);
    assert_int_equal(poll_after(0), FATHOM_ERR_MALFORMED);
    assert_sample_untouched();
    assert_int_equal(poll_after(0), FATHOM_READY);
    assert_int_equal(sample.probe, 4);
    assert_int_equal(a05.base.answer.implausible, 2);
    assert_nothing_after(0);
}

TEST(a_probe_between_that_is_not_wanted_gives_nothing_whatever_it_reads)
{
    config.probes = 0x9;
    start();
    assert_nothing_after(0);
    fake_modbus_answer(&fake, (const uint16_t[]){1001, 0xFFFF, 6001, 4001}, 4);
    take_samples(0x9, 1);
    assert_nothing_after(0);
    assert_int_equal(a05.base.answer.implausible, 0);
}

TEST(every_error_passes_through_and_leaves_the_sample_alone)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_MALFORMED, FATHOM_ERR_PORT,     FATHOM_ERR_CANCELLED};
    start();
    for (unsigned i = 0; i != sizeof errors / sizeof *errors; i++) {
        assert_nothing_after(400000);
        fake.exception = 2;
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(poll_after(1000), errors[i]);
        assert_sample_untouched();
        if (errors[i] == FATHOM_ERR_EXCEPTION) assert_int_equal(a05.base.unit.request.message.exception, 2);
        assert_nothing_after(0);
    }
    fake.refuses = FATHOM_ERR_CAPACITY;
    assert_int_equal(poll_after(400000), FATHOM_ERR_CAPACITY);
    assert_sample_untouched();
}

TEST(deinit_cancels_what_is_under_way)
{
    start();
    assert_nothing_after(0);
    fathom_a05_modbus_deinit(&a05);
    assert_int_equal(fake.cancels, 1);
}

/* A05 3(4)1 example 3, byte for byte: probes 2, 3, 4 read 250, 659, 2426 mm. */
TEST(the_example_of_the_datasheet_goes_over_a_line)
{
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6};
    static const uint8_t answer[] = {0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47};
    static const uint16_t distances[] = {250, 659, 2426};
    static fake_t uart;
    uint8_t frame[13];
    fathom_line_t line;
    unsigned got = 0;
    fake_init(&uart);
    uart.byte_us = 1042;
    const fathom_line_config_t line_config = {
        &uart.uart, &uart.clock, frame, sizeof frame, FATHOM_LINE_ECHO_AUTO, 3646, 5000};
    assert_int_equal(fathom_line_init(&line, &line_config), FATHOM_READY);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    config.modbus = &modbus;
    config.clock = &uart.clock;
    config.probes = 0xE;
    start();
    for (unsigned ms = 0; ms != 350; ms++) {
        uart.now_us += 1000;
        if (ms == 310) fake_trickle(&uart, 0, 1042, answer, sizeof answer);
        while (fathom_poll(&sensor, &sample) == FATHOM_READY) {
            assert_true(got < 3);
            assert_int_equal(sample.probe, got + 2);
            assert_int_equal(sample.distance_mm, distances[got]);
            got++;
        }
    }
    assert_int_equal(got, 3);
    assert_memory_equal(uart.writes[0].bytes, request, sizeof request);
}
