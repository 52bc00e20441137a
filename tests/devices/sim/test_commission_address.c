/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Addresses are set through the drivers of all models, in a loop that sleeps as long as it may and in one that comes
 * round every 20 ms. */

enum { OLD = 1, NEW = 5 };

static fathom_status_t set_address(uint8_t address)
{
    if (s.model == HPS) return fathom_hps167s_set_address(&s.driver.hps, address);
    if (s.model == A16) return fathom_a16_modbus_set_address(&s.driver.a16, address);
    if (s.model == A05) return fathom_a05_modbus_set_address(&s.driver.a05, address);
    return fathom_a05_dyp_broadcast_address(&s.driver.dyp, address);
}
static fathom_status_t set_new(void) { return set_address(NEW); }

/* Every model, in either loop, on a line without echo and on one with it. */
#define FOR_ALL_MODELS                                                                                       \
    for (unsigned n = 0; n != 4 * ADDRESSED; n++)                                                            \
        if (set_up_one(n), true)

static void set_up_one(unsigned n)
{
    set_up((model_t)(n / 4), OLD, loops_us[n % 2], FATHOM_LINE_ECHO_AUTO);
    bench.line.echo = n / 2 % 2 != 0;
    set_faults(1); /* which keep an echo that is there */
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(an_address_that_is_set_is_followed_and_not_set_twice_also_where_the_line_echoes)
{
    FOR_ALL_MODELS
    {
        assert_int_equal(carry_out(set_new), FATHOM_OK);
        assert_int_equal(bench.device->address, NEW);
        COUNTED(.writes = 1);
        assert_measures(NEW, 1234);
        assert_int_equal(carry_out(set_new), FATHOM_OK); /* and once more: it is so already */
        COUNTED(.writes = 1);
    }
}

/* Not in the datasheets, and known of sister models: a sensor whose address was just changed may acknowledge that from
 * the old address or from the new one. Either will do, since a reading at the new one decides. An acknowledgement from
 * the new address is taken for the late response to the probe of that address that was sent before. */
TEST(a_sensor_may_acknowledge_from_its_old_or_its_new_address)
{
    for (unsigned from_new = 0; from_new != 2; from_new++) FOR_ALL_MODELS
        {
            if (s.model == A05_DYP || bench.line.echo) continue;
            bench.device->answers_from_new = from_new != 0;
            assert_int_equal(carry_out(set_new), FATHOM_OK);
            assert_int_equal(bench.device->address, NEW);
            COUNTED(.writes = 1);
            assert_int_equal(s.counters[FATHOM_LINE_LATE_RESPONSES], from_new);
            assert_int_equal(s.counters[FATHOM_LINE_STRAYS], 0);
            assert_measures(NEW, 1234);
        }
}

TEST(an_address_at_which_another_answers_is_not_given)
{
    FOR_ALL_MODELS
    {
        const fathom_sim_device_t *const other = add_other(NEW);
        assert_int_equal(carry_out(set_new), FATHOM_ERR_IN_USE);
        assert_int_equal(bench.device->address, OLD);
        COUNTED(.writes = NONE);
        COUNTED_BY(other, .writes = NONE);
        assert_measures(OLD, 1234);
    }
}

/* Its first frame answers the first look; from the second on, the acknowledgement, nothing comes. */
TEST(without_confirmation_it_is_at_one_of_the_two)
{
    FOR_ALL_MODELS
    {
        silence_from(2, 1000);
        assert_int_equal(carry_out(set_new), FATHOM_ERR_UNCONFIRMED);
        assert_int_equal(bench.device->address, NEW);
        COUNTED(.writes = 1);
        assert_int_equal(measure(), FATHOM_ERR_NO_RESPONSE); /* the driver is where it was */
    }
}

TEST(a_lost_acknowledgement_does_not_matter_if_the_reading_confirms)
{
    FOR_ALL_MODELS
    {
        silence_from(2, 1);
        assert_int_equal(carry_out(set_new), FATHOM_OK);
        COUNTED(.writes = 1); /* it is not written again */
    }
}

TEST(a_dead_device_does_not_look_like_success_where_the_line_echoes)
{
    FOR_ALL_MODELS
    {
        fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
        assert_int_equal(carry_out(set_new), FATHOM_ERR_NO_RESPONSE);
    }
}

TEST(what_waits_for_the_old_address_is_cancelled)
{
    FOR_ALL_MODELS
    {
        if (s.model == A05_DYP || n % 4 != 0) continue;
        uint16_t value = 0;
        fathom_modbus_request_t request = {.transaction = {.timeout_us = 100 * MS}};
        fathom_modbus_request_t other = {.transaction = {.timeout_us = 100 * MS}};
        fathom_modbus_read_holding_registers(&request.message, OLD, 0x0101, 1, &value);
        fathom_modbus_read_holding_registers(&other.message, 9, 0x0101, 1, &value);
        /* Submitted in mid-write: behind it in the queue. */
        const uint32_t start_us = s.clock.now_us;
        for (; bench.device->counters.writes == 0; pass()) {
            assert_int_equal(set_new(), FATHOM_PENDING);
            assert_ends(start_us);
        }
        assert_int_equal(fathom_modbus_client_submit(&s.line, &request), FATHOM_PENDING);
        assert_int_equal(fathom_modbus_client_submit(&s.line, &other), FATHOM_PENDING);
        assert_int_equal(carry_out(set_new), FATHOM_OK);
        assert_int_equal(request.transaction.status, FATHOM_ERR_CANCELLED);
        assert_int_equal(request.transaction.attempts, 0);
        assert_int_equal(other.transaction.status, FATHOM_ERR_NO_RESPONSE);
    }
}

TEST(addresses_of_everybody_are_refused)
{
    FOR_ALL_MODELS
    {
        assert_int_equal(set_address(0), FATHOM_ERR_ARGUMENT);
        assert_int_equal(set_address(255), FATHOM_ERR_ARGUMENT);
        assert_null(s.line.head);
    }
}

/* ---- 00 and FF, over Modbus (A16 6(3), A05 3(3)) ---- */

static fathom_status_t set_to_0(void)
{
    return s.model == A16 ? fathom_a16_modbus_set_address_0(&s.driver.a16)
                          : fathom_a05_modbus_set_address_0(&s.driver.a05);
}

/* Those at FF are found there if the device answers it, which the datasheets leave open. */
static fathom_status_t find(uint8_t *address)
{
    fathom_dyp_modbus_find_t sought = {.is_asked = false};
    fathom_status_t status;
    while ((status = fathom_dyp_modbus_find(&sought, &s.modbus, address)) == FATHOM_PENDING)
        fathom_sim_clock_advance(&s.clock, 1 * MS);
    return status;
}

TEST(address_0_is_set_read_and_found)
{
    for (unsigned from_new = 0; from_new != 2; from_new++) FOR_ALL_MODELS
        {
            if ((s.model != A16 && s.model != A05) || bench.line.echo) continue;
            uint8_t address = 0xA5;
            bench.device->answers_from_new = from_new != 0;
            assert_int_equal(carry_out(set_to_0), FATHOM_OK);
            assert_int_equal(bench.device->address, 0);
            COUNTED(.writes = 1);
            assert_measures(0, 1234);
            assert_int_equal(set_address(NEW), FATHOM_ERR_ARGUMENT); /* which every unit would obey */
            bench.device->answers_broadcast = n % 2 != 0;
            rest(5 * SECOND);
            assert_int_equal(find(&address), n % 2 != 0 ? FATHOM_OK : FATHOM_ERR_NO_RESPONSE);
            assert_int_equal(address, n % 2 != 0 ? 0 : 0xA5);
            COUNTED(.writes = 1);
        }
}
