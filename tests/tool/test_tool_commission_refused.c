/* SPDX-License-Identifier: MIT */
/* fathom commission: what it does not do, and what it says then. */
#include "commission_bench.h"

#include <stdio.h>
#include <string.h>

#include "sim/fault.h"

static int set_up(void **state)
{
    site_begin();
    return 0;
}

static int tear_down(void **state)
{
    site_end();
    return 0;
}

static const suite_t suite = {.set_up = set_up, .tear_down = tear_down};

TEST(of_two_units_at_address_1_none_is_written)
{
    for (int row = 0; row != 3; row++) {
        static const char *const models[] = {"hps167s", "a16", "a05"};
        site_begin();
        if (row == 0) add_hps_units(2);
        if (row == 1) add_a16_units(2);
        if (row == 2) add_a05_units(2);
        connect_next();
        char more[80];
        (void)snprintf(more, sizeof more, "%s --addresses 2,3 --wait 20", models[row]);
        const tool_run_t *const done =
            tool_run(&bench.tool, "commission %s --port line --record %s", more, site.record);
        expect(done, 1, "two units at address 1, or a loose wire: what answers is ");
        assert_int_equal(writes(), 0);
        assert_int_equal(count_of(record_text(), " planned 2"), 0);
        fathom_sim_detach(&bench.line, site.device[1], bench.clock.now_us);
        site.connected--; /* the idle hook connects it again */
        expect(commission(more), 0, "2 of 2");
    }
}

TEST(nothing_is_written_where_the_new_address_is_in_use)
{
    add_hps((fathom_sim_hps167s_config_t){.address = 2});
    add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
    connect_next();
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "something answers at address 2, which the unit at address 1 is to get: nothing was written");
    assert_int_equal(writes(), 0);
    assert_int_equal(count_of(record_text(), " planned 2"), 0);
}

TEST(an_a16_is_not_given_an_address_that_is_in_use)
{
    add_a16_units(2);
    site.device[0]->address = 2;
    connect_next();
    expect(commission("a16 --addresses 2,3 --wait 20"), 1, "something answers at address 2, which ");
    assert_int_equal(writes(), 0);
}

TEST(with_a_damaged_record_nothing_is_sent)
{
    static const struct {
        const char *text;
        const char *says;
    } rows[] = {
        {"", " is empty; remove it to begin anew"},
        {"hello\n", ", line 1: this is no record of fathom commission"},
        {TITLE "hps167s 2 " FIRST " done\n", ", line 2: it has five words"},
        {TITLE "hps167s 2 " FIRST " done now and\n", ", line 2: it has five words"},
        {TITLE "hps167s 2 " FIRST " done now", ", line 2: the end of the line is missing"},
        {TITLE "hps168s 2 " FIRST " done now\n", ", line 2: there is no such sensor"},
        {TITLE "hps167s 33 " FIRST " done now\n", ", line 2: no address that it can have"},
        {TITLE "hps167s 0 " FIRST " done now\n", ", line 2: no address that it can have"},
        {TITLE "hps167s 2 - done now\n", ", line 2: no UUID"},
        {TITLE "hps167s 2 " FIRST "0 done now\n", ", line 2: no UUID"},
        {TITLE "a16 2 " FIRST " done now\n", ", line 2: no UUID"},
        {TITLE "hps167s 2 " FIRST " Done now\n", ", line 2: neither planned, restart nor done"},
        {TITLE "#\na16 2 - done now\na05 2 - done now\n", ", line 4: this address stands there twice"},
        {TITLE "hps167s 2 " FIRST " done now\nhps167s 3 " FIRST " done now\n",
         ", line 3: this UUID stands there twice"},
    };
    add_hps_units(1);
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        write_record(rows[i].text);
        const tool_run_t *const done = commission("hps167s --addresses 2-4 --wait 9");
        expect(done, 1, rows[i].says);
        assert_string_equal(done->out, "");
        assert_string_equal(record_text(), rows[i].text);
        assert_int_equal(bench.line.counters.from_host, 0);
    }
}

TEST(with_a_record_that_cannot_be_written_nothing_is_sent)
{
    add_hps_units(1);
    (void)snprintf(site.record, sizeof site.record, "/tmp/fathom-no-such-folder/record.txt");
    expect(commission("hps167s --addresses 2"), 1,
           "fathom: the record /tmp/fathom-no-such-folder/record.txt cannot be written: No such file or "
           "directory\n");
    assert_int_equal(bench.line.counters.from_host, 0);
}

TEST(wrong_words_are_usage_errors)
{
    static const struct {
        const char *more;
        const char *says;
    } rows[] = {
        {"hps167s", "which addresses are to be given? --addresses is missing"},
        {"hps167s --addresses 2-33", "from 1 to 32"},
        {"hps167s --addresses 5-2", "such as 2-9"},
        {"hps167s --addresses 2,,3", "such as 2-9"},
        {"hps167s --addresses 1-8", "put it at the end"},
        {"hps167s --addresses 2-4,3", "address 3 stands twice"},
        {"hps167s --addresses 2-4 --terminated 5", "--terminated takes one of --addresses, or none, not '5'"},
        {"a16 --addresses 2-4 --terminated 4", "a16 has no termination"},
        {"hps167s --addresses 2 --taken-away", "known by its UUID"},
        {"hps167s:3 --addresses 2", "address 1, with which they come; leave 3 out"},
        {"hps167s a16 --addresses 2", "one model at a time; 'a16' is too much"},
        {"a05 --mode dyp --addresses 2", "this takes --mode modbus"},
        {"hps167s --addresses 2 --wait 0", "--wait takes a whole number from 1"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        expect(commission(rows[i].more), 2, rows[i].says);
    expect(tool_run(&bench.tool, "commission hps167s --port line --addresses 2"), 2, "--record is missing");
    expect(tool_run(&bench.tool, "commission hps167s --port tcp:localhost --addresses 2 --record r"), 2,
           "it needs a serial port");
    write_record(TITLE "a16 2 - done now\n");
    expect(commission("hps167s --addresses 2-4"), 2, "address 2 is that of an a16 by the record");
    write_record(TITLE "a16 1 - done now\n");
    expect(commission("a16 --addresses 2-4"), 2, "a unit keeps address 1 by the record");
}

/* ---- what does not go well ---- */

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
