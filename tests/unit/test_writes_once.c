/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fake_modbus.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_settings.h"

/* config.modbus.retries is for reading alone: what is written goes out once, whatever becomes of it. Flash wears, and
 * every A05 on the line obeys 55 AA 03. */

enum { RETRIES = 2, SECOND_US = 1000000 };

static fake_modbus_t fake;
static fathom_a16_modbus_t a16;
static fathom_a05_modbus_t a05;

static fathom_status_t set_a16_threshold(void)
{
    return fathom_a16_modbus_set_switch_threshold_mm(&a16, 2000);
}
static fathom_status_t set_a16_mode(void)
{
    return fathom_a16_modbus_set_operating_mode(&a16, FATHOM_A16_AUTOMATIC);
}
static fathom_status_t set_a05_address(void) { return fathom_a05_modbus_set_address(&a05, 5); }

/* Goes on until something was asked: with which function, and how often may it be repeated? */
static uint8_t asked(fathom_status_t (*set)(void), uint8_t retries_by_function[7])
{
    assert_int_equal(set(), FATHOM_PENDING);
    if (fake.request == NULL) fake.now_us += SECOND_US;
    assert_int_equal(set(), FATHOM_PENDING);
    assert_non_null(fake.request);
    const uint8_t function = fake.request->message.head[1];
    assert_true(function == 3 || function == 6);
    retries_by_function[function] = fake.request->transaction.retries;
    return function;
}

static const suite_t suite = {.set_up = set_up};

TEST(over_modbus_reads_are_repeated_and_writes_are_not)
{
    static fathom_status_t (*const settings[])(void) = {set_a16_threshold, set_a16_mode, set_a05_address};
    static const uint16_t one[] = {1}; /* the address, and another threshold than 2000 */
    for (unsigned i = 0; i != 3; i++) {
        uint8_t retries[7];
        memset(retries, 0xFF, sizeof retries);
        fake_modbus_init(&fake);
        const fathom_a16_modbus_config_t a16_config = {.modbus.retries = RETRIES};
        const fathom_a05_modbus_config_t a05_config = {.modbus.retries = RETRIES};
        assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, &a16_config), FATHOM_OK);
        assert_int_equal(fathom_a05_modbus_init(&a05, &fake.modbus, &a05_config), FATHOM_OK);
        for (unsigned asks = 0; asks != 3 && asked(settings[i], retries) == 3; asks++) {
            if (fake.request->message.head[0] == 1)
                fake_modbus_response(&fake, one, 1);
            else
                fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE); /* no device at the new address */
        }
        assert_int_equal(retries[3], RETRIES);
        assert_int_equal(retries[6], 0);
    }
}

/* 55 AA 01 10 and 0x75B mm: 55 + AA + 01 + 10 + 07 + 5B = 172, so that the sum is 72. */
static const uint8_t probe_1_of_1[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0x5B, 0x72};

/* How many of the frames that went out have this address and command. */
static unsigned sent(uint8_t address, uint8_t command)
{
    unsigned n = 0;
    for (size_t i = 0; i != bench.fake.written; i++) {
        const uint8_t *const bytes = bench.fake.writes[i].bytes;
        if (bytes[2] == address && bytes[3] == command) n++;
    }
    return n;
}

TEST(over_55_aa_requests_are_repeated_and_the_command_to_all_is_not)
{
    static fathom_a05_dyp_t dyp;
    const fathom_a05_dyp_config_t config = {.modbus.retries = RETRIES};
    fathom_status_t status = FATHOM_PENDING;
    bool is_answered = false;
    assert_int_equal(fathom_a05_dyp_init(&dyp, &bench.line, &config), FATHOM_OK);
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms < 30000);
        bench.fake.now_us += 1000;
        status = fathom_a05_dyp_broadcast_address(&dyp, 7);
        if (!is_answered && bench.fake.written == 1) {
            fake_receive(&bench.fake, 70000, probe_1_of_1, sizeof probe_1_of_1);
            is_answered = true;
        }
    }
    assert_int_equal(status, FATHOM_ERR_UNCONFIRMED);
    assert_int_equal(sent(7, 0x03), 1);
    assert_int_equal(sent(7, 0x10), 2 * (1 + RETRIES)); /* before it and after it */
    assert_int_equal(sent(1, 0x10), 1 + 1 + RETRIES);   /* the first was answered */
    expect_written(1 + 2 * (1 + RETRIES) + 1 + 1 + RETRIES);
}
