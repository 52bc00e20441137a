/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/a16_settings.h"

/* The caller's own variable, as it is before, while and after a register is read: written on FATHOM_READY, and only
 * then. */

static fake_modbus_t fake;
static fathom_a16_modbus_t sensor;

static uint8_t address;
static fathom_a16_polarity_t polarity;
static uint16_t threshold_mm;
static fathom_a16_value_t value;

/* What no device has told. */
static const uint8_t address_before = 0xA5;
static const fathom_a16_polarity_t polarity_before = FATHOM_A16_POSITIVE;
static const uint16_t threshold_before_mm = 0xA5A5;
static const fathom_a16_value_t value_before = FATHOM_A16_REAL_TIME;

static fathom_status_t get_address(void) { return fathom_a16_address(&sensor, &address); }
static fathom_status_t get_polarity(void) { return fathom_a16_switch_polarity(&sensor, &polarity); }
static fathom_status_t get_threshold(void) { return fathom_a16_switch_threshold_mm(&sensor, &threshold_mm); }
static fathom_status_t get_value(void) { return fathom_a16_automatic_value(&sensor, &value); }

static fathom_status_t (*const gets[])(void) = {get_address, get_polarity, get_threshold, get_value};
enum { GETS = 4 };

static void assert_untouched(void)
{
    assert_int_equal(address, address_before);
    assert_int_equal(polarity, polarity_before);
    assert_int_equal(threshold_mm, threshold_before_mm);
    assert_int_equal(value, value_before);
}

static int set_up(void **state)
{
    fake_modbus_init(&fake);
    const fathom_a16_modbus_config_t config = {.modbus = &fake.modbus, .clock = &fake.clock};
    memset(&sensor, 0, sizeof sensor); /* 0 is something that each could be given by mistake */
    assert_int_equal(fathom_a16_modbus_init(&sensor, &config), FATHOM_READY);
    address = address_before;
    polarity = polarity_before;
    threshold_mm = threshold_before_mm;
    value = value_before;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void ask(fathom_status_t (*get)(void))
{
    fake.now_us += FATHOM_A16_MIN_PERIOD_US;
    assert_int_equal(get(), FATHOM_PENDING);
    assert_non_null(fake.request);
    assert_untouched();
}

TEST(while_it_is_asked_and_when_that_fails_it_is_left_alone)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM, FATHOM_ERR_PORT};
    for (unsigned i = 0; i != GETS; i++) {
        for (unsigned k = 0; k != sizeof errors / sizeof *errors; k++) {
            ask(gets[i]);
            fake_modbus_fail(&fake, errors[k]);
            assert_int_equal(gets[i](), errors[k]);
            assert_untouched();
        }
        ask(gets[i]);
        fake_modbus_refuse(&fake, 2);
        assert_int_equal(gets[i](), FATHOM_ERR_EXCEPTION);
        assert_untouched();
    }
}

TEST(a_command_that_is_busy_leaves_it_alone)
{
    for (unsigned i = 0; i != GETS; i++) {
        ask(gets[i]);
        for (unsigned other = 0; other != GETS; other++)
            if (other != i) assert_int_equal(gets[other](), FATHOM_ERR_BUSY);
        assert_untouched();
        fathom_a16_cancel(&sensor);
    }
}

TEST(an_answer_writes_that_one_alone)
{
    static const uint16_t zero[] = {0};
    for (unsigned i = 0; i != GETS; i++) {
        assert_int_equal(set_up(NULL), 0);
        ask(gets[i]);
        fake_modbus_answer(&fake, zero, 1);
        assert_int_equal(gets[i](), FATHOM_READY);
        assert_int_equal(address, i == 0 ? 0 : address_before);
        assert_int_equal(polarity, i == 1 ? FATHOM_A16_NEGATIVE : polarity_before);
        assert_int_equal(threshold_mm, i == 2 ? 0 : threshold_before_mm);
        assert_int_equal(value, i == 3 ? FATHOM_A16_PROCESSED : value_before);
    }
}
