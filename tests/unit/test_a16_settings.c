/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "desk.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a16_settings.h"

/* Requests are those of A16 6(4), without their CRC. test_driver_contract.c has what every driver promises. */

static fathom_a16_modbus_t a16;
static fathom_a16_modbus_config_t config;

static void start(const fathom_modbus_t *transport)
{
    memset(&a16, 0, sizeof a16); /* 0 is something that each output could be given by mistake */
    assert_int_equal(fathom_a16_modbus_init(&a16, transport, &config), FATHOM_OK);
    desk.sensor = fathom_a16_modbus_sensor(&a16);
}

static int set_up(void **state)
{
    desk_begin(5000);
    config = (fathom_a16_modbus_config_t){0};
    start(&fake.modbus);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

#define OK     FATHOM_OK
#define SILENT FATHOM_ERR_NO_RESPONSE

/* ---- one register a row, in the caller's own variable, which keeps what no device has told until FATHOM_OK ---- */

static struct {
    uint8_t address;
    fathom_a16_polarity_t polarity;
    uint16_t threshold_mm;
    fathom_dyp_value_t value;
} is;

static fathom_status_t get_address(void) { return fathom_a16_modbus_get_address(&a16, &is.address); }
static fathom_status_t get_polarity(void)
{
    return fathom_a16_modbus_get_switch_polarity(&a16, &is.polarity);
}
static fathom_status_t get_threshold(void)
{
    return fathom_a16_modbus_get_switch_threshold_mm(&a16, &is.threshold_mm);
}
static fathom_status_t get_automatic(void) { return fathom_a16_modbus_get_automatic_value(&a16, &is.value); }

static fathom_status_t set_address(void)
{
    return fathom_a16_modbus_set_address(&a16, (uint8_t)desk.argument);
}
static fathom_status_t set_polarity(void)
{
    return fathom_a16_modbus_set_switch_polarity(&a16, (fathom_a16_polarity_t)desk.argument);
}
static fathom_status_t set_threshold(void)
{
    return fathom_a16_modbus_set_switch_threshold_mm(&a16, (uint16_t)desk.argument);
}
static fathom_status_t set_automatic(void)
{
    return fathom_a16_modbus_set_automatic_value(&a16, (fathom_dyp_value_t)desk.argument);
}
static fathom_status_t set_mode(void)
{
    return fathom_a16_modbus_set_operating_mode(&a16, (fathom_a16_operating_mode_t)desk.argument);
}

/* The register; a value that it has and one that the device cannot mean (0: there is none); to be set: the datasheet's
 * example, and what is allowed. */
static const struct {
    fathom_status_t (*get)(void);
    fathom_status_t (*set)(void);
    uint16_t address, is, impossible, example, least, most;
} rows[] = {
    {get_address, set_address, 0x0200, 1, 256, 5, 1, 254},
    {get_polarity, set_polarity, 0x0205, 1, 2, 0, 0, 1},
    {get_threshold, set_threshold, 0x0206, 1000, 0, 2000, 1, 16350},
    {get_automatic, set_automatic, 0x0207, 0, 2, 1, 0, 1},
    {NULL, set_mode, 0x0202, 0, 0, 1, 0, 1},
};
enum { GETS = 4, ALL = 5 };

static void forget(void)
{
    is.address = 0xA5;
    is.polarity = FATHOM_A16_POSITIVE;
    is.threshold_mm = 0xA5A5;
    is.value = FATHOM_REAL_TIME;
}

/* All but the one of this row. */
static void assert_untouched_but(unsigned row)
{
    if (row != 0) assert_int_equal(is.address, 0xA5);
    if (row != 1) assert_int_equal(is.polarity, FATHOM_A16_POSITIVE);
    if (row != 2) assert_int_equal(is.threshold_mm, 0xA5A5);
    if (row != 3) assert_int_equal(is.value, FATHOM_REAL_TIME);
}

static unsigned value_of(unsigned row)
{
    const unsigned values[] = {is.address, (unsigned)is.polarity, is.threshold_mm, (unsigned)is.value};
    return values[row];
}

TEST(a_register_is_read_into_that_one_variable)
{
    for (unsigned i = 0; i != GETS; i++) {
        for (unsigned zero = 0; zero != 2; zero++) {
            const uint16_t value = zero != 0 ? 0 : rows[i].is;
            set_up(state);
            forget();
            PLAY(rows[i].get, OK, READ(1, rows[i].address, OK, value));
            assert_int_equal(value_of(i), value);
            assert_untouched_but(i);
        }
    }
}

TEST(a_value_that_a_register_cannot_have_is_refused)
{
    forget();
    for (unsigned i = 0; i != GETS; i++) {
        if (rows[i].impossible == 0) continue;
        PLAY(rows[i].get, FATHOM_ERR_MALFORMED, READ(1, rows[i].address, OK, rows[i].impossible));
        assert_untouched_but(GETS);
    }
    PLAY(get_polarity, FATHOM_ERR_MALFORMED, READ(1, 0x0205, OK, 0x0100)); /* its low byte is 0 */
    assert_untouched_but(GETS);
}

TEST(a_command_that_is_busy_leaves_it_alone)
{
    forget();
    for (unsigned i = 0; i != GETS; i++) {
        fake.now_us += 120000;
        PENDS(rows[i].get());
        for (unsigned other = 0; other != GETS; other++)
            if (other != i) assert_int_equal(rows[other].get(), FATHOM_ERR_BUSY);
        assert_untouched_but(GETS);
        fathom_a16_modbus_cancel(&a16);
    }
}

TEST(a_register_is_set_as_in_the_examples_of_6_4)
{
    for (unsigned i = 1; i != GETS; i++) {
        const uint16_t address = rows[i].address;
        desk.argument = rows[i].example;
        PLAY(rows[i].set, OK, READ(1, address, OK, rows[i].is), WRITE(1, address, rows[i].example, OK),
             READ(1, address, OK, rows[i].example));
    }
}

TEST(what_is_out_of_range_is_not_sent)
{
    for (unsigned i = 0; i != ALL; i++) {
        set_up(state);
        desk.argument = rows[i].most + 1;
        assert_int_equal(rows[i].set(), FATHOM_ERR_ARGUMENT);
        desk.argument = (int32_t)rows[i].least - 1;
        if (rows[i].least != 0) assert_int_equal(rows[i].set(), FATHOM_ERR_ARGUMENT);
        desk.argument = 256; /* where an enumeration can hold it at all */
        if (rows[i].most == 1 && sizeof(fathom_dyp_value_t) != 1)
            assert_int_equal(rows[i].set(), FATHOM_ERR_ARGUMENT);
        assert_int_equal(fake.submits, 0);
        desk.argument = rows[i].most;
        PENDS(rows[i].set());
        fathom_a16_modbus_cancel(&a16);
        fake.now_us += 120000;
        desk.argument = rows[i].least;
        PENDS(rows[i].set());
        assert_int_equal(fake.submits, 2);
    }
}

TEST(the_address_is_read_and_followed_when_it_is_set)
{
    desk.argument = 5;
    PLAY(desk_poll, OK, READ(1, 0x0100, OK, 1000));
    assert_int_equal(desk.sample.address, 1);
    PLAY(set_address, OK, READ(1, 0x0200, OK, 1), READ(5, 0x0200, SILENT, 0), /* is a device there? */
         WRITE(1, 0x0200, 5, OK), READ(5, 0x0200, OK, 5));
    PLAY(desk_poll, OK, READ(5, 0x0100, OK, 754));
    assert_int_equal(desk.sample.address, 5);
    assert_int_equal(desk.sample.distance_mm, 754);
}

/* a16_settings.h: "it is written without reading anything before or afterwards, once ... The address, 0x0200, is
 * FATHOM_ERR_ARGUMENT then". */
TEST(each_setting_can_be_written_blind_but_the_address)
{
    desk.argument = 1;
    assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), OK);
    PLAY(set_polarity, FATHOM_ERR_UNCONFIRMED, WRITE(1, 0x0205, 1, OK));
    assert_true(fathom_a16_modbus_is_written(&a16));
    PLAY(set_polarity, OK, READ(1, 0x0205, OK, 1)); /* that was the last one */
    assert_false(fathom_a16_modbus_is_written(&a16));
    assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), OK);
    PLAY(set_mode, FATHOM_ERR_UNCONFIRMED, WRITE(1, 0x0202, 1, SILENT));
    assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), OK);
    assert_int_equal(set_address(), FATHOM_ERR_ARGUMENT);
    assert_null(fake.request);
}

/* a16_settings.h: "The setting after it is not blind." */
TEST(a_setting_after_a_refused_argument_is_not_blind)
{
    static const struct {
        fathom_status_t (*set)(void);
        int32_t argument;
    } refused[] = {{set_address, 5},   {set_address, 0},   {set_address, 255},     {set_polarity, 2},
                   {set_threshold, 0}, {set_automatic, 2}, {set_threshold, 16351}, {set_mode, 2}};
    for (unsigned i = 0; i != COUNT(refused); i++) {
        set_up(state);
        desk.argument = refused[i].argument;
        assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), OK);
        assert_int_equal(refused[i].set(), FATHOM_ERR_ARGUMENT);
        desk.argument = 1;
        PLAY(set_polarity, OK, READ(1, 0x0205, OK, 1));
    }
}

TEST(a_refused_argument_leaves_the_blind_setting_in_progress_blind)
{
    desk.argument = 1;
    assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), OK);
    PART(set_polarity, WRITE(1, 0x0205, 1, OK));
    desk.argument = 255;
    assert_int_equal(set_address(), FATHOM_ERR_ARGUMENT);
    desk.argument = 5;
    assert_int_equal(set_address(), FATHOM_ERR_BUSY);
    desk.argument = 1;
    assert_int_equal(set_polarity(), FATHOM_ERR_UNCONFIRMED);
}

TEST(the_operating_mode_is_write_only_and_its_acknowledgement_all_there_is)
{
    desk.argument = 1; /* is it there, and does the line echo? */
    PLAY(set_mode, OK, READ(1, 0x0200, OK, 1), WRITE(1, 0x0202, 1, OK));
}

/* modbus_unit.h, rule 5: a setting that is not called for 5 s and 16 calls of other functions ends. */
TEST(behind_an_abandoned_setting_the_operating_mode_is_written_after_its_read)
{
    desk.argument = 1;
    PENDS(set_polarity());
    for (unsigned calls = 1; calls != 17; calls++) {
        fake.now_us += 1000000;
        assert_int_equal(set_mode(), calls < 16 ? FATHOM_ERR_BUSY : FATHOM_PENDING);
    }
    fake.submits = 0;
    PLAY(set_mode, OK, READ(1, 0x0200, OK, 1), WRITE(1, 0x0202, 1, OK));
}

/* ---- a distance asked once ---- */

static fathom_status_t measure(void)
{
    return fathom_a16_modbus_measure(&a16, (fathom_dyp_value_t)desk.argument, &desk.sample);
}

TEST(either_distance_can_be_asked_once)
{
    static const uint16_t distances[] = {754, 751}; /* 6(4): 0100 is processed, 0101 real-time */
    for (uint8_t i = 0; i != 2; i++) {
        desk.argument = i;
        PLAY(measure, OK, READ(1, 0x0100 + i, OK, distances[i]));
        assert_int_equal(desk.sample.kind, FATHOM_TARGET);
        assert_int_equal(desk.sample.distance_mm, distances[i]);
        assert_int_equal(desk.sample.address, 1);
    }
    for (desk.argument = 2; desk.argument <= 256; desk.argument += 254)
        if (desk.argument == 2 || sizeof(fathom_dyp_value_t) != 1)
            assert_int_equal(measure(), FATHOM_ERR_ARGUMENT);
    desk.argument = 0;
    PLAY(measure, FATHOM_ERR_MALFORMED, READ(1, 0x0100, OK, 16351)); /* refused like any other */
}

TEST(a_distance_asked_once_is_not_mixed_up_with_the_repeated_one)
{
    desk_waits(0);
    PENDS(measure());
    assert_int_equal(fake.submits, 1);
    PLAY(measure, OK, READ(1, 0x0100, OK, 1111), /* to the repeated request, which is not taken */
         READ(1, 0x0100, OK, 2222));
    assert_int_equal(desk.sample.distance_mm, 2222);
}

/* dyp_modbus.h: "of registers that differ in their bits 0 to 3, 8 or 9"; one is under way, and the other has to wait. */
TEST(commands_of_two_registers_are_told_apart)
{
    static const uint16_t registers[] = {0x0010, 0x0011, 0x0110, 0x0210};
    uint16_t value = 0;
    for (unsigned i = 0; i != 4; i++)
        for (unsigned j = 0; j != 4; j++) {
            set_up(state);
            PENDS(fathom_dyp_modbus_get_register(&a16.base, registers[i], &value));
            assert_int_equal(fathom_dyp_modbus_get_register(&a16.base, registers[j], &value),
                             i == j ? FATHOM_PENDING : FATHOM_ERR_BUSY);
        }
}

/* ---- measurements ---- */

/* A16 6(3): 0101; 0100 is the processed value. */
TEST(the_real_time_value_is_asked_with_300_ms)
{
    config.value = FATHOM_REAL_TIME;
    start(&fake.modbus);
    for (unsigned i = 1; i <= 2; i++) {
        desk_waits(2000000);
        fake_modbus_assert_asked(&fake, i, 1, 0x0101, 1);
        assert_int_equal(fake.request->transaction.timeout_us, 300000);
        config.value = FATHOM_PROCESSED; /* read by init only */
        desk_says(751);
        assert_int_equal(desk_poll(), FATHOM_OK);
    }
}

/* A16 6(4) examples 1 and 2, byte for byte. */
static const uint8_t requests[][8] = {{0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6},
                                      {0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36}};
static const uint8_t responses[][7] = {{0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1},
                                       {0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8}};

TEST(the_examples_of_the_datasheet_go_over_a_line)
{
    for (uint8_t i = 0; i != 2; i++) {
        rig_start(RIG_START_US);
        const fathom_modbus_t modbus = fathom_modbus_client(&rig.line);
        config.value = i;
        config.modbus.timeout_us = 1000000;
        start(&modbus);
        rig.sensor = desk.sensor;
        assert_int_equal(rig_transaction(rig_poll, requests[i], 8, responses[i], 7), FATHOM_OK);
        assert_int_equal(rig.sample.distance_mm, i == 0 ? 754 : 751);
    }
}
