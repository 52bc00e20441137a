/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/a16_settings.h"

/* The heads of requests are those of A16 6(4), without their CRC. */

static fake_modbus_t fake;
static fathom_a16_modbus_t sensor;

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    const fathom_a16_modbus_config_t config = {.modbus = &fake.modbus, .clock = &fake.clock};
    memset(&sensor, 0x5A, sizeof sensor);
    assert_int_equal(fathom_a16_modbus_init(&sensor, &config), FATHOM_READY);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void pass(void) { fake.now_us += FATHOM_A16_MIN_PERIOD_US; }

/* The call goes on; what it asks next goes out when the period is over. */
#define ASKS(call)                                                                                           \
    do {                                                                                                     \
        assert_int_equal(call, FATHOM_PENDING);                                                              \
        if (fake.request == NULL) pass();                                                                    \
        assert_int_equal(call, FATHOM_PENDING);                                                              \
        assert_non_null(fake.request);                                                                       \
    } while (0)

static void assert_head(const uint8_t head[6])
{
    assert_non_null(fake.request);
    assert_memory_equal(fake.log[fake.submits - 1], head, 6);
}

static void assert_reads(uint8_t unit, uint16_t address)
{
    const uint8_t head[] = {unit, 0x03, (uint8_t)(address >> 8), (uint8_t)(address & 0xFF), 0, 1};
    assert_head(head);
}

static void answer(uint16_t value)
{
    static uint16_t said;
    said = value;
    fake_modbus_answer(&fake, &said, 1);
    pass();
}

/* ---- one register a row: as numbers, whatever the type of the argument ---- */

static fathom_status_t get_address(unsigned *value)
{
    uint8_t address = 0;
    const fathom_status_t status = fathom_a16_address(&sensor, &address);
    if (status == FATHOM_READY) *value = address;
    return status;
}
static fathom_status_t set_address(unsigned value) { return fathom_a16_set_address(&sensor, (uint8_t)value); }

static fathom_status_t get_polarity(unsigned *value)
{
    fathom_a16_polarity_t polarity = FATHOM_A16_NEGATIVE;
    const fathom_status_t status = fathom_a16_switch_polarity(&sensor, &polarity);
    if (status == FATHOM_READY) *value = (unsigned)polarity;
    return status;
}
static fathom_status_t set_polarity(unsigned value)
{
    return fathom_a16_set_switch_polarity(&sensor, (fathom_a16_polarity_t)value);
}

static fathom_status_t get_threshold(unsigned *value)
{
    uint16_t mm = 0;
    const fathom_status_t status = fathom_a16_switch_threshold_mm(&sensor, &mm);
    if (status == FATHOM_READY) *value = mm;
    return status;
}
static fathom_status_t set_threshold(unsigned value)
{
    return fathom_a16_set_switch_threshold_mm(&sensor, (uint16_t)value);
}

static fathom_status_t get_automatic(unsigned *value)
{
    fathom_a16_value_t which = FATHOM_A16_PROCESSED;
    const fathom_status_t status = fathom_a16_automatic_value(&sensor, &which);
    if (status == FATHOM_READY) *value = (unsigned)which;
    return status;
}
static fathom_status_t set_automatic(unsigned value)
{
    return fathom_a16_set_automatic_value(&sensor, (fathom_a16_value_t)value);
}

static fathom_status_t set_mode(unsigned value)
{
    return fathom_a16_set_operating_mode(&sensor, (fathom_a16_operating_mode_t)value);
}

typedef struct {
    fathom_status_t (*get)(unsigned *value);
    fathom_status_t (*set)(unsigned value);
    uint8_t write[6];                     /* the datasheet's example */
    unsigned is, least, most, impossible; /* impossible: what the device cannot mean; 0: nothing is */
} row_t;

static const row_t rows[] = {
    {get_polarity, set_polarity, {0x01, 0x06, 0x02, 0x05, 0x00, 0x00}, 1, 0, 1, 2},
    {get_threshold, set_threshold, {0x01, 0x06, 0x02, 0x06, 0x07, 0xD0}, 1000, 1, 16350, 0},
    {get_automatic, set_automatic, {0x01, 0x06, 0x02, 0x07, 0x00, 0x01}, 0, 0, 1, 2},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

static uint16_t register_of(const row_t *row) { return (uint16_t)(row->write[2] << 8 | row->write[3]); }
static unsigned example_of(const row_t *row) { return (unsigned)row->write[4] << 8 | row->write[5]; }

TEST(a_register_is_read)
{
    for (const row_t *row = rows; row != rows + ROWS; row++) {
        unsigned value = 77;
        set_up(state);
        ASKS(row->get(&value));
        assert_reads(1, register_of(row));
        answer((uint16_t)row->is);
        assert_int_equal(row->get(&value), FATHOM_READY);
        assert_int_equal(value, row->is);
    }
}

TEST(a_value_that_a_register_cannot_have_is_refused)
{
    for (const row_t *row = rows; row != rows + ROWS; row++) {
        unsigned value = 77;
        if (row->impossible == 0) continue;
        set_up(state);
        ASKS(row->get(&value));
        answer((uint16_t)row->impossible);
        assert_int_equal(row->get(&value), FATHOM_ERR_MALFORMED);
        assert_int_equal(value, 77);
    }
}

TEST(a_failed_read_writes_nothing)
{
    unsigned value = 77;
    static fathom_status_t (*const gets[])(unsigned *value) = {get_address, get_polarity, get_threshold,
                                                               get_automatic};
    for (size_t i = 0; i != sizeof gets / sizeof gets[0]; i++) {
        set_up(state);
        ASKS(gets[i](&value));
        fake_modbus_refuse(&fake, 2);
        assert_int_equal(gets[i](&value), FATHOM_ERR_EXCEPTION);
        assert_int_equal(value, 77);
    }
}

TEST(a_register_is_set_as_in_the_examples_of_6_4)
{
    for (const row_t *row = rows; row != rows + ROWS; row++) {
        const unsigned wanted = example_of(row);
        set_up(state);
        ASKS(row->set(wanted));
        assert_reads(1, register_of(row));
        answer((uint16_t)row->is);
        ASKS(row->set(wanted));
        assert_head(row->write);
        fake_modbus_acknowledge(&fake);
        pass();
        ASKS(row->set(wanted));
        assert_reads(1, register_of(row));
        answer((uint16_t)wanted);
        assert_int_equal(row->set(wanted), FATHOM_READY);
    }
}

TEST(what_is_out_of_range_is_not_sent)
{
    for (const row_t *row = rows; row != rows + ROWS; row++) {
        set_up(state);
        assert_int_equal(row->set(row->most + 1), FATHOM_ERR_ARGUMENT);
        if (row->least != 0) assert_int_equal(row->set(row->least - 1), FATHOM_ERR_ARGUMENT);
        assert_int_equal(set_address(0), FATHOM_ERR_ARGUMENT);
        assert_int_equal(set_address(255), FATHOM_ERR_ARGUMENT);
        assert_int_equal(set_mode(2), FATHOM_ERR_ARGUMENT);
        assert_int_equal(fake.submits, 0);
        ASKS(row->set(row->most));
        fathom_a16_cancel(&sensor);
        ASKS(row->set(row->least));
        assert_int_equal(fake.submits, 2);
    }
}

TEST(the_address_is_read_and_followed_when_it_is_set)
{
    /* A16 6(4), example 3 */
    static const uint8_t write[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05};
    fathom_sample_t sample;
    unsigned address = 0;
    ASKS(get_address(&address));
    assert_reads(1, 0x0200);
    answer(1);
    assert_int_equal(get_address(&address), FATHOM_READY);
    assert_int_equal(address, 1);

    ASKS(set_address(5));
    assert_reads(1, 0x0200);
    answer(1);
    ASKS(set_address(5));
    assert_reads(5, 0x0200); /* is somebody there? */
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    pass();
    ASKS(set_address(5));
    assert_head(write);
    fake_modbus_acknowledge(&fake);
    pass();
    ASKS(set_address(5));
    assert_reads(5, 0x0200);
    answer(5);
    assert_int_equal(set_address(5), FATHOM_READY);

    const fathom_sensor_t driver = fathom_a16_modbus_sensor(&sensor);
    ASKS(fathom_poll(&driver, &sample));
    assert_reads(5, 0x0100);
    answer(754);
    assert_int_equal(fathom_poll(&driver, &sample), FATHOM_READY);
    assert_int_equal(sample.unit, 5);
}

TEST(an_address_over_255_is_none)
{
    unsigned address = 77;
    ASKS(get_address(&address));
    answer(256);
    assert_int_equal(get_address(&address), FATHOM_ERR_MALFORMED);
    assert_int_equal(address, 77);
}

TEST(the_operating_mode_is_write_only_and_its_acknowledgement_all_there_is)
{
    /* A16 6(4), example 4 */
    static const uint8_t write[] = {0x01, 0x06, 0x02, 0x02, 0x00, 0x01};
    ASKS(set_mode(1));
    assert_reads(1, 0x0200); /* is it there, and does the line echo? */
    answer(1);
    ASKS(set_mode(1));
    assert_head(write);
    fake_modbus_acknowledge(&fake);
    pass();
    assert_int_equal(set_mode(1), FATHOM_READY);
    assert_int_equal(fake.submits, 2);
}

TEST(the_operating_mode_of_one_that_does_not_answer_is_not_written)
{
    ASKS(set_mode(1));
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(set_mode(1), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(fake.submits, 1);
}

TEST(either_distance_can_be_asked_once)
{
    static const struct {
        fathom_a16_value_t value;
        uint16_t address, mm;
    } distances[] = {{FATHOM_A16_PROCESSED, 0x0100, 754}, {FATHOM_A16_REAL_TIME, 0x0101, 751}}; /* 6(4) */
    for (size_t i = 0; i != 2; i++) {
        fathom_sample_t sample;
        set_up(state);
        ASKS(fathom_a16_measure(&sensor, distances[i].value, &sample));
        assert_reads(1, distances[i].address);
        answer(distances[i].mm);
        assert_int_equal(fathom_a16_measure(&sensor, distances[i].value, &sample), FATHOM_READY);
        assert_int_equal(sample.kind, FATHOM_TARGET);
        assert_int_equal(sample.distance_mm, distances[i].mm);
        assert_int_equal(sample.unit, 1);
    }
    fathom_sample_t sample;
    assert_int_equal(fathom_a16_measure(&sensor, (fathom_a16_value_t)2, &sample), FATHOM_ERR_ARGUMENT);
}

TEST(a_distance_asked_once_is_refused_like_any_other)
{
    fathom_sample_t sample;
    ASKS(fathom_a16_measure(&sensor, FATHOM_A16_PROCESSED, &sample));
    answer(16351);
    assert_int_equal(fathom_a16_measure(&sensor, FATHOM_A16_PROCESSED, &sample), FATHOM_ERR_MALFORMED);
}

TEST(a_distance_asked_once_is_not_mixed_up_with_the_repeated_one)
{
    const fathom_sensor_t driver = fathom_a16_modbus_sensor(&sensor);
    fathom_sample_t sample;
    ASKS(fathom_poll(&driver, &sample));
    assert_int_equal(fathom_a16_measure(&sensor, FATHOM_A16_PROCESSED, &sample), FATHOM_PENDING);
    assert_int_equal(fake.submits, 1);
    answer(1111); /* to the repeated question, which nobody takes */
    ASKS(fathom_a16_measure(&sensor, FATHOM_A16_PROCESSED, &sample));
    assert_int_equal(fake.submits, 2);
    answer(2222);
    assert_int_equal(fathom_a16_measure(&sensor, FATHOM_A16_PROCESSED, &sample), FATHOM_READY);
    assert_int_equal(sample.distance_mm, 2222);
}

TEST(after_power_on_silence_is_warming_up_for_a_second_and_a_half)
{
    const fathom_sensor_t driver = fathom_a16_modbus_sensor(&sensor);
    fathom_sample_t sample;
    ASKS(fathom_poll(&driver, &sample));
    fathom_a16_modbus_power_on(&sensor);
    assert_null(fake.request);
    ASKS(fathom_poll(&driver, &sample));
    fake.now_us += 1499999;
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(fathom_poll(&driver, &sample), FATHOM_ERR_WARMING_UP);
    ASKS(fathom_poll(&driver, &sample)); /* takes the period, which is the rest of the time and more */
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(fathom_poll(&driver, &sample), FATHOM_ERR_NO_ANSWER);
}
