/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/modbus_unit.h"

/* Questions about one register that are not the same question: a read, a write, a measurement. */

enum { REGISTER = 0x0206, PACE_US = 100000 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t read_value;
static uint16_t wanted[2];

static const fathom_modbus_question_t measurement = {300000,   PACE_US, 0, NULL,  &read_value,
                                                     REGISTER, 1,       0, false, 0};
static const fathom_modbus_question_t reading = {300000,   PACE_US, 0, NULL, &read_value,
                                                 REGISTER, 1,       0, true, 0};
static const fathom_modbus_question_t one_write = {
    300000, PACE_US, 0, NULL, wanted, REGISTER, 1, 0, true, FATHOM_MODBUS_WRITE_SINGLE_REGISTER};
static const fathom_modbus_question_t two_written = {
    300000, PACE_US, 0, NULL, wanted, REGISTER, 2, 0, true, FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS};

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    read_value = 0;
    wanted[0] = 0x07D0;
    wanted[1] = 0x1234;
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(fathom_modbus_unit_init(&unit, &fake.modbus, &fake.clock, 1), FATHOM_READY);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t ask(const fathom_modbus_question_t *question)
{
    return fathom_modbus_unit_ask(&unit, question);
}

static void assert_asked(uint8_t function, uint8_t fourth, uint8_t fifth)
{
    const uint8_t head[6] = {1, function, 0x02, 0x06, fourth, fifth};
    assert_non_null(fake.request);
    assert_memory_equal(fake.log[fake.submits - 1], head, sizeof head);
}

TEST(a_read_of_a_register_that_is_being_written_is_told_busy)
{
    assert_int_equal(ask(&one_write), FATHOM_PENDING);
    assert_asked(6, 0x07, 0xD0);
    assert_int_equal(ask(&reading), FATHOM_ERR_BUSY);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(ask(&reading), FATHOM_ERR_BUSY); /* and does not take its outcome */
    assert_int_equal(ask(&one_write), FATHOM_READY);
    fake.now_us += PACE_US;
    assert_int_equal(ask(&reading), FATHOM_PENDING);
    assert_asked(3, 0, 1);
}

TEST(a_write_of_a_register_that_is_being_read_is_told_busy)
{
    static const uint16_t is[] = {1000};
    assert_int_equal(ask(&reading), FATHOM_PENDING);
    assert_asked(3, 0, 1);
    assert_int_equal(ask(&one_write), FATHOM_ERR_BUSY);
    assert_int_equal(ask(&two_written), FATHOM_ERR_BUSY);
    fake_modbus_answer(&fake, is, 1);
    assert_int_equal(ask(&one_write), FATHOM_ERR_BUSY); /* a reading is no acknowledgement */
    assert_int_equal(ask(&reading), FATHOM_READY);
    assert_int_equal(read_value, 1000);
    assert_int_equal(fake.submits, 1);
    fake.now_us += PACE_US;
    assert_int_equal(ask(&two_written), FATHOM_PENDING);
    assert_asked(16, 0, 2);
}

TEST(a_measurement_of_a_register_that_is_being_written_waits)
{
    assert_int_equal(ask(&one_write), FATHOM_PENDING);
    assert_int_equal(ask(&measurement), FATHOM_PENDING);
    fake_modbus_acknowledge(&fake);
    assert_int_equal(ask(&measurement), FATHOM_PENDING);
    assert_int_equal(ask(&one_write), FATHOM_READY);
    assert_int_equal(fake.submits, 1);
    fake.now_us += PACE_US;
    assert_int_equal(ask(&measurement), FATHOM_PENDING);
    assert_asked(3, 0, 1);
}
