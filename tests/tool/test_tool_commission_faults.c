/* SPDX-License-Identifier: MIT */
/* fathom commission with a sensor that falls silent, is missing, is another one, or reports its new termination late. */
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

/* Wherever a sensor falls silent for a while, the cause is printed, and the next run finishes. */
TEST(a_sensor_that_falls_silent_is_where_the_record_has_it)
{
    unsigned unconfirmed = 0;
    for (uint32_t frame = 1; frame != 25; frame++) {
        site_begin();
        add_hps_units(1);
        silence(0, frame, 12);
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 60");
        if (done->status != 0) {
            const bool is_told =
                strstr(done->err, "The sensor is at address 1 or at address 2, 19200 8E1") != NULL;
            unconfirmed += is_told;
            assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " planned "));
            assert_true(site.device[0]->address == 1 || is_told ||
                        strstr(done->err, "at address 2: ") != NULL);
            assert_non_null(strstr(done->out, "To continue, run the same command again\n"));
        }
        fathom_sim_fault_init(&faults, 1);
        expect(commission("hps167s --addresses 2 --terminated none --wait 60"), 0, "1 of 1");
        assert_int_equal(site.device[0]->address, 2);
        assert_in_range(site.device[0]->counters.flash_writes, 2, 3);
    }
    assert_true(unconfirmed != 0);
}

/* Interrupted, and its unit taken off: the others get the other addresses. */
TEST(the_address_of_a_missing_sensor_stays_reserved)
{
    add_hps_units(3);
    write_record(TITLE "hps167s 2 ffffffffffffffffffffffffffffffff planned 2026-01-01T00:00:00Z\n");
    const tool_run_t *const done = commission("hps167s --addresses 2-4 --wait 60");
    expect(done, 1, "address 2 stays reserved: its sensor ffffffffffffffffffffffffffffffff was not found\n");
    expect(done, 1,
           "address 2 is not done: the sensor with UUID ffffffffffffffffffffffffffffffff is at this ");
    expect(done, 1, "2 of 3 addresses are assigned and verified. To continue, run the same command again\n");
    assert_int_equal(site.device[0]->address, 3);
    assert_int_equal(site.device[1]->address, 4);
    assert_int_equal(site.device[2]->address, 1);
    assert_int_equal(site.device[2]->counters.writes, 0);
}

/* On a bench: what was moved without being heard, and connected again while others were at work. */
TEST(a_missing_sensor_is_finished_by_a_later_run)
{
    add_hps((fathom_sim_hps167s_config_t){.address = 2});
    add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
    write_record(TITLE "hps167s 2 " FIRST " planned 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 2,3"), 0, "hps167s at address 2, UUID " FIRST ": verifying\n");
    assert_int_equal(site.device[0]->counters.flash_writes, 1);
    assert_int_equal(site.device[1]->address, 3);
}

TEST(a_sensor_in_the_record_gets_its_own_address_again)
{
    add_hps_units(2);
    write_record(TITLE "hps167s 7 00390025423457142034383501060706 done 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 5,6 --wait 20"), 1,
           "the sensor at address 1 was at address 7 and gets this address again");
    assert_int_equal(site.device[0]->address, 5);
    assert_int_equal(site.device[1]->address, 7);
}

TEST(two_units_with_one_number_do_not_get_one_address)
{
    add_hps_units(2);
    site.unit[1].hps.number = 0;
    expect(commission("hps167s --addresses 2,3 --wait 20"), 1,
           "hps167s at address 2: a sensor with the same UUID responds at address 1 too");
    assert_int_equal(site.device[1]->counters.writes, 0);
}

TEST(sensors_without_a_uuid_have_to_stay_connected)
{
    add_a16_units(3);
    site.hand_us = 20 * SECOND; /* the second one comes later */
    bench.tool.ctrl_c_us = 12 * SECOND;
    expect(commission("a16 --addresses 2-4"), 1, "1 of 3");
    bench.tool.ctrl_c_us = 0;
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    const unsigned before = writes();
    expect(commission("a16 --addresses 2-4 --wait 20"), 1,
           "fathom: nothing was written: address 2 is done in the record, but no sensor responds there. "
           "Connect it and switch it on. If you took it away, remove its line from the record and its "
           "address from --addresses\n");
    assert_int_equal(writes(), before);
    write_record(TITLE);
    expect(commission("a16 --addresses 3,4 --wait 60"), 0, "2 of 2");
}

/* It may have address 2 already, and be in a box. */
TEST(an_interrupted_sensor_that_is_absent_keeps_its_address_reserved)
{
    add_a16_units(3);
    write_record(TITLE "a16 2 - planned 2026-01-01T00:00:00Z\n");
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    site.device[0]->address = 2;
    site.hand_us = 10 * SECOND;
    expect(commission("a16 --addresses 2-4 --wait 20"), 1,
           "address 2 stays reserved: its sensor was not found\n");
    assert_int_equal(site.device[1]->address, 3);
    assert_int_equal(site.device[2]->address, 4);
}

TEST(a_sensor_that_reports_a_fault_is_not_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_FAULT;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s at address 2: the address is set, but the sensor reports a fault\n");
    assert_non_null(strstr(record_text(), " planned 2"));
}

TEST(a_sensor_without_a_target_is_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    expect(commission("hps167s --addresses 2"), 0, "  address 2 is done: termination on, no_target\n");
}

TEST(commission_waits_for_a_sensor_that_warms_up)
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

TEST(a_sensor_with_another_uuid_at_the_new_address_is_not_accepted)
{
    add_hps_units(1);
    site.watch = become_another;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s at address 2: a sensor with another UUID responds");
    assert_non_null(strstr(record_text(), " planned 2"));
}

static void be_replaced(void)
{
    if (site.asked == 4) site.unit[0].hps.number = 9; /* three reads, and the new address was asked */
}

TEST(a_sensor_replaced_before_the_write_is_found_again)
{
    add_hps_units(1);
    site.watch = be_replaced;
    expect(commission("hps167s --addresses 2 --wait 20"), 0, "1 of 1");
    assert_null(strstr(record_text(), FIRST));
    assert_non_null(strstr(record_text(), "hps167s 2 0039002542345714203438350106070e done ")); /* 05 + 9 */
}

/* #2 reports the termination that acts now. #11 changes it at the next power-on. */
static void report_late(void) { site.unit[0].hps.termination = true; }

TEST(a_termination_that_reads_late_is_done_after_the_power_on)
{
    add_hps_units(1);
    site.watch = report_late;
    for (unsigned i = 0; i != 2; i++) {
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 20");
        expect(done, 1,
               "  address 2 is set, but the termination reads on until the next power-on. Switch the sensor "
               "off and on, and run the command again\n");
        assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " planned "));
        assert_int_equal(site.device[0]->counters.flash_writes, 2 + i); /* the termination once a run */
    }
    site.watch = NULL;
    site.unit[0].hps.termination = false;
    expect(commission("hps167s --addresses 2 --terminated none --wait 20"), 0, "1 of 1");
    assert_int_equal(site.device[0]->counters.flash_writes, 3);
}

/* Three reads when it is found, three before it is written; it falls silent at the next one. */
TEST(a_sensor_without_a_uuid_that_was_not_written_counts_as_new)
{
    add_a16_units(1);
    silence(0, 7, 3);
    const tool_run_t *const done = commission("a16 --addresses 2,3 --wait 20");
    expect(done, 1, "not written: no response");
    expect(done, 1, "1 of 2");
    assert_int_equal(site.device[0]->address, 2);
}
