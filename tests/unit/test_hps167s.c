/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/hps167s_info.h"

enum { GUARD = 0xA5, PACE_US = 18519 };

static fake_modbus_t fake;
static fathom_hps167s_config_t config;
static fathom_hps167s_t hps;
static fathom_sensor_t sensor;
static fathom_sample_t sample;
static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;

/* Command #5: 08 23, DC B2, 07, 01, 00 00. Table 10 has no example: 2020-09-27, 2.1, revision 0. Command #3. */
static const uint16_t measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};
static const uint16_t versioned[3] = {0x1409, 0x1B02, 0x0100};
static const uint16_t detailed[11] = {0xB000, 0x3900, 0x2542, 0x3457, 0x1420, 0x3438,
                                      0x3501, 0x0607, 0x0513, 0x0917, 0x0309};

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    memset(&config, 0, sizeof config);
    config.modbus = &fake.modbus;
    config.clock = &fake.clock;
    memset(&hps, 0x5A, sizeof hps);
    return 0;
}

/* Commands #1, #3 and #5 at their one right length (tables 9, 13, 17), and nothing else whatever happened: 0009 is
 * a factory reset. */
static int nothing_else_was_sent(void **state)
{
    static const uint8_t allowed[3][5] = {{3, 0, 1, 0, 3}, {3, 0, 3, 0, 11}, {3, 0, 8, 0, 4}};
    for (unsigned i = 0; i != fake.submits; i++) {
        unsigned found = 0;
        for (unsigned n = 0; n != 3; n++) found += memcmp(fake.log[i] + 1, allowed[n], 5) == 0;
        if (found == 1) continue;
        print_error("sent: function %u, first %02X%02X\n", fake.log[i][1], fake.log[i][2], fake.log[i][3]);
        return -1;
    }
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = nothing_else_was_sent};

static void start(void)
{
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
    sensor = fathom_hps167s_sensor(&hps);
}

static fathom_status_t poll_after(uint32_t us)
{
    fake.now_us += us;
    memset(&sample, GUARD, sizeof sample);
    return fathom_poll(&sensor, &sample);
}

static fathom_status_t version_after(uint32_t us)
{
    fake.now_us += us;
    memset(&version, GUARD, sizeof version);
    return fathom_hps167s_interface_version(&hps, &version);
}

static fathom_status_t details_after(uint32_t us)
{
    fake.now_us += us;
    memset(&details, GUARD, sizeof details);
    return fathom_hps167s_details(&hps, &details);
}

static void assert_guard(const void *object, size_t size)
{
    for (size_t i = 0; i != size; i++) assert_int_equal(((const uint8_t *)object)[i], GUARD);
}

static void assert_nothing_after(uint32_t us)
{
    assert_int_equal(poll_after(us), FATHOM_PENDING);
    assert_guard(&sample, sizeof sample);
}

/* ---- measurements ---- */

TEST(by_default_it_asks_unit_1_to_measure_with_500_ms_and_no_retry)
{
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0008, 4);
    assert_int_equal(fake.request->exchange.timeout_us, 500000);
    assert_int_equal(fake.request->exchange.retries, 0);
}

TEST(the_config_is_asked_as_it_says)
{
    config.address = 32;
    config.timeout_us = 170000;
    config.retries = 5;
    start();
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 1, 32, 0x0008, 4);
    assert_int_equal(fake.request->exchange.timeout_us, 170000);
    assert_int_equal(fake.request->exchange.retries, 5);
    fake_modbus_answer(&fake, measured, 4);
    assert_int_equal(poll_after(9000), FATHOM_READY);
    assert_int_equal(sample.unit, 32);
}

TEST(wrong_arguments_are_refused)
{
    config.modbus = NULL;
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_ERR_ARGUMENT);
    set_up(NULL);
    config.clock = NULL;
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_ERR_ARGUMENT);
    for (unsigned address = 0; address != 256; address++) {
        set_up(NULL);
        config.address = (uint8_t)address;
        assert_int_equal(fathom_hps167s_init(&hps, &config),
                         address > 32 ? FATHOM_ERR_ARGUMENT : FATHOM_READY);
    }
    assert_int_equal(fake.submits + fake.polls, 0);
}

TEST(the_pace_is_the_period_but_at_most_54_a_second)
{
    static const uint32_t periods[][2] = {
        {0, 18519}, {1, 18519}, {18518, 18519}, {18520, 18520}, {1000000, 1000000}};
    for (unsigned i = 0; i != 5; i++) {
        set_up(NULL);
        config.period_us = periods[i][0];
        start();
        assert_nothing_after(0);
        fake_modbus_answer(&fake, measured, 4);
        assert_int_equal(poll_after(12000), FATHOM_READY);
        assert_int_equal(fathom_due_us(&sensor, 1), periods[i][1]);
        assert_nothing_after(periods[i][1] - 1);
        assert_int_equal(fake.submits, 1);
        assert_nothing_after(1);
        assert_int_equal(fake.submits, 2);
    }
    assert_true(54 * FATHOM_HPS167S_MIN_PERIOD_US >= 1000000);
}

/* Command #5: 2.083 m, (DCB2 << 7) / 10000 = 723.1744, ambient 1, precision 0. */
TEST(the_example_of_command_5_has_all_its_members)
{
    start();
    assert_nothing_after(0);
    fake.heard_us = 98765;
    fake_modbus_answer(&fake, measured, 4);
    assert_int_equal(poll_after(9000), FATHOM_READY);
    assert_int_equal(sample.time_us, 98765);
    assert_int_equal(sample.magnitude, 7231744);
    assert_int_equal(sample.sequence, 1);
    assert_int_equal(sample.raw, 2083);
    assert_int_equal(sample.distance_mm, 2083);
    assert_int_equal(sample.precision, 0);
    assert_int_equal(sample.kind, FATHOM_TARGET);
    assert_int_equal(sample.model, FATHOM_HPS167S);
    assert_int_equal(sample.unit, 1);
    assert_int_equal(sample.probe, 1);
    assert_int_equal(sample.ambient, 1);
    assert_false(sample.interference);
    assert_nothing_after(0);
}

/* Command #5: distance, ambient and precision all FF, magnitude 00; what the exponent is stands nowhere. */
TEST(the_abnormal_packet_is_a_fault)
{
    static const uint16_t exponents[] = {0x0000, 0x1100, 0xFF00};
    for (unsigned i = 0; i != 3; i++) {
        const uint16_t registers[4] = {0xFFFF, 0x0000, (uint16_t)(exponents[i] | 0xFF), 0xFFFF};
        set_up(NULL);
        start();
        assert_nothing_after(0);
        fake_modbus_answer(&fake, registers, 4);
        assert_int_equal(poll_after(9000), FATHOM_READY);
        assert_int_equal(sample.kind, FATHOM_FAULT);
        assert_int_equal(sample.raw, 65535);
        assert_int_equal(sample.distance_mm, 0);
        assert_int_equal(sample.magnitude, 0);
        assert_int_equal(sample.ambient, 255);
        assert_int_equal(sample.precision, 65535);
    }
}

TEST(figures_that_it_cannot_mean_are_an_error_and_no_sample)
{
    static const uint16_t wrong[][4] = {
        {0, 0xDCB2, 0x0701, 0}, {30001, 0xDCB2, 0x0701, 0}, {65529, 0, 0x0701, 0}, {2083, 0xDCB2, 0x1101, 0}};
    start();
    for (unsigned i = 0; i != 4; i++) {
        assert_nothing_after(PACE_US);
        fake_modbus_answer(&fake, wrong[i], 4);
        assert_int_equal(poll_after(9000), FATHOM_ERR_MALFORMED);
        assert_guard(&sample, sizeof sample);
    }
    assert_nothing_after(PACE_US);
    fake_modbus_answer(&fake, measured, 4);
    assert_int_equal(poll_after(9000), FATHOM_READY);
    assert_int_equal(sample.sequence, 1);
}

TEST(every_error_passes_through_and_leaves_all_outputs_alone)
{
    /* No answer comes last: after three of them the unit is left alone for a while. */
    static const fathom_status_t errors[] = {FATHOM_ERR_CHECKSUM, FATHOM_ERR_EXCEPTION, FATHOM_ERR_MALFORMED,
                                             FATHOM_ERR_PORT,     FATHOM_ERR_CANCELLED, FATHOM_ERR_NO_ANSWER};
    start();
    for (unsigned i = 0; i != sizeof errors / sizeof *errors; i++) {
        fake.exception = 2;
        assert_nothing_after(PACE_US);
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(poll_after(9000), errors[i]);
        assert_guard(&sample, sizeof sample);
        assert_int_equal(version_after(PACE_US), FATHOM_PENDING);
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(version_after(9000), errors[i]);
        assert_guard(&version, sizeof version);
        assert_int_equal(details_after(PACE_US), FATHOM_PENDING);
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(details_after(9000), errors[i]);
        assert_guard(&details, sizeof details);
        if (errors[i] == FATHOM_ERR_EXCEPTION) assert_int_equal(hps.unit.request.message.exception, 2);
    }
}

/* ---- commands ---- */

TEST(the_interface_version_is_read_byte_by_byte)
{
    config.retries = 3;
    start();
    assert_int_equal(version_after(0), FATHOM_PENDING);
    assert_guard(&version, sizeof version);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0001, 3);
    assert_int_equal(fake.request->exchange.timeout_us, 1000000);
    assert_int_equal(fake.request->exchange.retries, 3);
    fake_modbus_answer(&fake, versioned, 3);
    assert_int_equal(version_after(9000), FATHOM_READY);
    assert_int_equal(version.year, 2020);
    assert_int_equal(version.month, 9);
    assert_int_equal(version.day, 27);
    assert_int_equal(version.major, 2);
    assert_int_equal(version.minor, 1);
    assert_int_equal(version.revision, 0);
}

/* Command #3 reads 13 09 17 as "19/09/27" and 03 09 as "Ver. 2.1"; the bytes say 2019-09-23 and 3.9. */
TEST(the_details_are_what_the_bytes_say_and_not_the_text)
{
    static const uint8_t uuid[16] = {0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14,
                                     0x20, 0x34, 0x38, 0x35, 0x01, 0x06, 0x07, 0x05};
    start();
    assert_int_equal(details_after(0), FATHOM_PENDING);
    assert_guard(&details, sizeof details);
    fake_modbus_assert_asked(&fake, 1, 1, 0x0003, 11);
    assert_int_equal(fake.request->exchange.timeout_us, 1000000);
    fake_modbus_answer(&fake, detailed, 11);
    assert_int_equal(details_after(9000), FATHOM_READY);
    assert_memory_equal(details.uuid, uuid, 16);
    assert_int_equal(details.year, 2019);
    assert_int_equal(details.month, 9);
    assert_int_equal(details.day, 23);
    assert_int_equal(details.major, 3);
    assert_int_equal(details.minor, 9);
}

TEST(details_with_any_other_ack_byte_are_malformed)
{
    uint16_t registers[11];
    memcpy(registers, detailed, sizeof registers);
    start();
    for (unsigned ack = 0; ack != 256; ack++) {
        registers[0] = (uint16_t)(ack * 256);
        assert_int_equal(details_after(PACE_US), FATHOM_PENDING);
        fake_modbus_answer(&fake, registers, 11);
        assert_int_equal(details_after(9000), ack == 0xB0 ? FATHOM_READY : FATHOM_ERR_MALFORMED);
        if (ack != 0xB0) assert_guard(&details, sizeof details);
        assert_int_equal(nothing_else_was_sent(NULL), 0);
        fake.submits = 0;
    }
}

TEST(a_command_takes_its_turn_after_a_measurement_under_way)
{
    start();
    assert_nothing_after(0);
    assert_int_equal(details_after(1000), FATHOM_PENDING);
    assert_int_equal(fake.submits, 1);
    assert_nothing_after(0);
    fake_modbus_answer(&fake, measured, 4);
    assert_int_equal(details_after(1000), FATHOM_PENDING);
    assert_int_equal(fake.submits, 1); /* its pace is kept */
    assert_int_equal(details_after(PACE_US), FATHOM_PENDING);
    fake_modbus_assert_asked(&fake, 2, 1, 0x0003, 11);
    assert_nothing_after(1000);
    fake_modbus_answer(&fake, detailed, 11);
    assert_int_equal(details_after(1000), FATHOM_READY);
    assert_int_equal(details.year, 2019);
}

/* The device answers whatever it is asked 12 ms later. A loop of 1 ms polls and asks for the details in turns. */
static unsigned ms_until_details_are_asked(bool poll_first)
{
    unsigned answer_in_ms = 0;
    start();
    for (unsigned ms = 0; ms != 1000; ms++) {
        fake.now_us += 1000;
        if (fake.request == NULL) answer_in_ms = 12;
        if (fake.request != NULL && fake.request->message.head[3] == 3) return ms;
        if (fake.request != NULL && answer_in_ms != 0) {
            if (--answer_in_ms == 11) fake_modbus_send(&fake);
            if (answer_in_ms == 0) fake_modbus_answer(&fake, measured, 4);
        }
        if (poll_first) poll_after(0);
        assert_int_equal(details_after(0), FATHOM_PENDING);
        if (!poll_first) poll_after(0);
        fake.submits = fake.submits % 32;
    }
    return 1000;
}

/* hps167s.h: "A command takes its turn after a measurement that is under way", "with the loop going on". */
TEST(a_command_is_not_starved_by_a_loop_that_goes_on_polling)
{
    assert_in_range(ms_until_details_are_asked(false), 0, 60);
    set_up(NULL);
    assert_in_range(ms_until_details_are_asked(true), 0, 60);
}

TEST(measurements_wait_until_the_outcome_of_a_command_was_taken)
{
    start();
    assert_int_equal(version_after(0), FATHOM_PENDING);
    assert_nothing_after(1000);
    fake_modbus_answer(&fake, versioned, 3);
    for (unsigned i = 0; i != 4; i++) assert_nothing_after(PACE_US);
    assert_int_equal(fake.submits, 1);
    assert_int_equal(version_after(0), FATHOM_READY);
    assert_int_equal(version.year, 2020);
    assert_nothing_after(0);
    fake_modbus_assert_asked(&fake, 2, 1, 0x0008, 4);
    fake_modbus_answer(&fake, measured, 4);
    assert_int_equal(poll_after(9000), FATHOM_READY);
    assert_int_equal(sample.distance_mm, 2083);
}

TEST(a_second_command_is_told_busy)
{
    start();
    assert_int_equal(version_after(0), FATHOM_PENDING);
    assert_int_equal(details_after(1000), FATHOM_ERR_BUSY);
    assert_guard(&details, sizeof details);
    fake_modbus_answer(&fake, versioned, 3);
    assert_int_equal(details_after(1000), FATHOM_ERR_BUSY);
    assert_int_equal(version_after(0), FATHOM_READY);
    assert_int_equal(details_after(PACE_US), FATHOM_PENDING);
    assert_int_equal(fake.submits, 2);
}

TEST(cancel_and_deinit_give_up_what_is_under_way)
{
    start();
    assert_int_equal(version_after(0), FATHOM_PENDING);
    fathom_hps167s_cancel(&hps);
    assert_int_equal(fake.cancels, 1);
    assert_nothing_after(PACE_US);
    fake_modbus_assert_asked(&fake, 2, 1, 0x0008, 4);
    fathom_hps167s_deinit(&hps);
    assert_int_equal(fake.cancels, 2);
    assert_null(fake.request);
}
