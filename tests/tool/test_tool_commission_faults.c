/* SPDX-License-Identifier: MIT */
/* fathom commission where something goes wrong: a unit falls silent, is missing, is another one, or tells late what was
 * set. */
#include "commission_bench.h"

#include <stdio.h>
#include <string.h>

#include "sim/fault.h"

static const suite_t suite = {.set_up = site_set_up, .tear_down = site_tear_down};

static fathom_sim_fault_t faults;

/* The unit says nothing from its n-th frame on, for `run` frames. */
static void silence(size_t i, uint32_t frame, uint32_t run)
{
    fathom_sim_fault_init(&faults, 1);
    fathom_sim_fault_attach(&faults, &bench.line, site.device[i]);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&faults, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    assert_non_null(rule);
    rule->run = run;
}

/* Wherever a unit falls silent for a while, from the first frame on: it is told, and then it is taken up again. */
TEST(a_unit_that_falls_silent_is_where_the_record_has_it)
{
    unsigned unconfirmed = 0;
    for (uint32_t frame = 1; frame != 25; frame++) {
        site_begin();
        add_hps_units(1);
        silence(0, frame, 12);
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 60");
        if (done->status != 0) {
            const bool is_told = strstr(done->err, "it is at address 1 or at address 2, 19200 8E1") != NULL;
            unconfirmed += is_told;
            assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " planned "));
            assert_true(site.device[0]->address == 1 || is_told ||
                        strstr(done->err, "at address 2: ") != NULL);
            assert_non_null(strstr(done->out, "the same command again goes on from there\n"));
        }
        fathom_sim_fault_init(&faults, 1);
        expect(commission("hps167s --addresses 2 --terminated none --wait 60"), 0, "1 of 1");
        assert_int_equal(site.device[0]->address, 2);
        assert_in_range(site.device[0]->counters.flash_writes, 2, 3);
    }
    assert_true(unconfirmed != 0);
}

/* Interrupted, and its unit taken off: the others get the other addresses. */
TEST(the_address_of_a_unit_that_is_missing_stays_reserved)
{
    add_hps_units(3);
    write_record(TITLE "hps167s 2 ffffffffffffffffffffffffffffffff planned 2026-01-01T00:00:00Z\n");
    const tool_run_t *const done = commission("hps167s --addresses 2-4 --wait 60");
    expect(done, 1, "address 2 stays reserved: its unit ffffffffffffffffffffffffffffffff was not found\n");
    expect(done, 1, "address 2 is open: UUID ffffffffffffffffffffffffffffffff, which is there or still at ");
    expect(done, 1, "2 of 3 addresses are given and verified; the same command again goes on from there\n");
    assert_int_equal(site.device[0]->address, 3);
    assert_int_equal(site.device[1]->address, 4);
    assert_int_equal(site.device[2]->address, 1);
    assert_int_equal(site.device[2]->counters.writes, 0);
}

/* On a bench: what was moved without being heard, and connected again while others were at work. */
TEST(a_unit_that_was_missing_is_done_when_it_comes_back)
{
    add_hps((fathom_sim_hps167s_config_t){.address = 2});
    add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
    write_record(TITLE "hps167s 2 " FIRST " planned 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 2,3"), 0,
           "hps167s at address 2, UUID " FIRST ": is looked through\n");
    assert_int_equal(site.device[0]->counters.flash_writes, 1);
    assert_int_equal(site.device[1]->address, 3);
}

TEST(a_unit_in_the_record_gets_its_own_address_again)
{
    add_hps_units(2);
    write_record(TITLE "hps167s 7 00390025423457142034383501060706 done 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 5,6 --wait 20"), 1,
           "the unit at address 1 was address 7 before, and gets that again");
    assert_int_equal(site.device[0]->address, 5);
    assert_int_equal(site.device[1]->address, 7);
}

TEST(two_units_with_one_number_do_not_get_one_address)
{
    add_hps_units(2);
    site.unit[1].hps.number = 0;
    expect(commission("hps167s --addresses 2,3 --wait 20"), 1,
           "hps167s at address 2: a unit with the same UUID answers at address 1 too; disconnect one of the "
           "two");
    assert_int_equal(site.device[1]->counters.writes, 0);
}

TEST(units_without_a_number_have_to_stay_connected)
{
    add_a16_units(3);
    site.hand_us = 20 * SECOND; /* the second one comes later */
    bench.tool.ctrl_c_us = 12 * SECOND;
    expect(commission("a16 --addresses 2-4"), 1, "1 of 3");
    bench.tool.ctrl_c_us = 0;
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    const unsigned before = writes();
    expect(
        commission("a16 --addresses 2-4 --wait 20"), 1,
        "fathom: address 2 is done by the record, and no unit answers there: nothing was written. Connect it "
        "and switch it on, or if it was taken away: --taken-away\n");
    assert_int_equal(writes(), before);
    expect(commission("a16 --addresses 2-4 --wait 60 --taken-away"), 0, "3 of 3");
}

/* It may have address 2 already, and be in a box. */
TEST(an_interrupted_unit_that_was_taken_off_keeps_its_address_reserved)
{
    add_a16_units(3);
    write_record(TITLE "a16 2 - planned 2026-01-01T00:00:00Z\n");
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    site.device[0]->address = 2;
    site.hand_us = 10 * SECOND;
    expect(commission("a16 --addresses 2-4 --wait 20"), 1,
           "address 2 stays reserved: its unit was not found\n");
    assert_int_equal(site.device[1]->address, 3);
    assert_int_equal(site.device[2]->address, 4);
}

/* The same, and what is at address 1 can be another one. */
TEST(with_those_taken_away_an_interrupted_address_is_not_given_to_another)
{
    add_a16_units(1);
    write_record(TITLE "a16 2 - planned 2026-01-01T00:00:00Z\n");
    expect(commission("a16 --addresses 2,3 --wait 20 --taken-away"), 1, "address 2 stays reserved");
    assert_int_equal(site.device[0]->address, 3);
}

TEST(a_unit_that_reports_a_fault_is_not_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_FAULT;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s at address 2: it reports a fault; it has its address, and does not measure\n");
    assert_non_null(strstr(record_text(), " planned 2"));
}

TEST(a_unit_that_sees_nothing_is_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    expect(commission("hps167s --addresses 2"), 0, "  address 2 is done: termination on, no target\n");
}

TEST(a_unit_that_warms_up_is_waited_for)
{
    add_hps((fathom_sim_hps167s_config_t){.warm_up_s = 12});
    connect_next();
    expect(commission("hps167s --addresses 2"), 0, "1 of 1");
}

/* ---- what befalls a unit in the middle of its work ---- */

static void become_another(void)
{
    if (site.device[0]->address != 1) site.unit[0].hps.number = 9;
}

TEST(another_unit_at_the_new_address_is_not_taken_for_it)
{
    add_hps_units(1);
    site.watch = become_another;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s at address 2: another unit answers there, by its UUID");
    assert_non_null(strstr(record_text(), " planned 2"));
}

static void be_replaced(void)
{
    if (site.asked == 4) site.unit[0].hps.number = 9; /* three reads, and the new address was asked */
}

TEST(a_unit_that_was_replaced_after_it_was_found_is_found_anew)
{
    add_hps_units(1);
    site.watch = be_replaced;
    expect(commission("hps167s --addresses 2 --wait 20"), 0, "1 of 1");
    assert_null(strstr(record_text(), FIRST));
    assert_non_null(strstr(record_text(), "hps167s 2 0039002542345714203438350106070e done ")); /* 05 + 9 */
}

/* #2 tells what acts, which #11 changes at the next power-on. */
static void tell_late(void) { site.unit[0].hps.termination = true; }

TEST(a_termination_that_is_told_from_the_next_power_on_is_written_once_and_waited_for)
{
    add_hps_units(1);
    site.watch = tell_late;
    for (int i = 0; i != 2; i++) {
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 20");
        expect(done, 1, "switch the units off and on whose termination reads otherwise until then\n");
        expect(done, 1, "address 2 is open: UUID " FIRST ", it is to be switched off and on\n");
        assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " restart "));
        assert_int_equal(site.device[0]->counters.flash_writes, 2);
    }
    site.watch = NULL;
    site.unit[0].hps.termination = false;
    expect(commission("hps167s --addresses 2 --terminated none --wait 20"), 0, "1 of 1");
    assert_int_equal(site.device[0]->counters.flash_writes, 2);
}

/* It was ended before the address was written. */
TEST(a_termination_that_was_written_is_not_written_again)
{
    add_hps_units(1);
    write_record(TITLE "hps167s 2 " FIRST " restart 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 2 --terminated none --wait 20"), 1,
           "address 2 is set; its termination reads on until it is switched off and on\n");
    assert_int_equal(site.device[0]->address, 2);
    assert_int_equal(site.device[0]->counters.flash_writes, 1);
}

/* Three reads when it is found, three before it is written; it falls silent at the next one. */
TEST(a_unit_without_a_number_that_was_not_written_is_a_new_one_again)
{
    add_a16_units(1);
    silence(0, 7, 3);
    const tool_run_t *const done = commission("a16 --addresses 2,3 --wait 20");
    expect(done, 1, "nothing was written: no response");
    expect(done, 1, "1 of 2");
    assert_int_equal(site.device[0]->address, 2);
}
