/* SPDX-License-Identifier: MIT */
/* fathom commission: what it does not do, and what it says then. */
#include "commission_bench.h"

#include <stdio.h>
#include <string.h>

static const suite_t suite = {.set_up = site_set_up, .tear_down = site_tear_down};

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
        expect(done, 1, "two sensors at address 1, or a loose wire: ");
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
           "nothing was written: a sensor responds at address 2, which the sensor at address 1 is to get");
    assert_int_equal(writes(), 0);
    assert_int_equal(count_of(record_text(), " planned 2"), 0);
}

TEST(an_a16_is_not_given_an_address_that_is_in_use)
{
    add_a16_units(2);
    site.device[0]->address = 2;
    connect_next();
    expect(commission("a16 --addresses 2,3 --wait 20"), 1, "a sensor responds at address 2, which ");
    assert_int_equal(writes(), 0);
}

TEST(with_a_damaged_record_nothing_is_sent)
{
    static const struct {
        const char *text;
        const char *says;
    } rows[] = {
        {"", " is empty. Remove the file"},
        {"hello\n", ":1: this file is no record of fathom commission"},
        {TITLE "hps167s 2 " FIRST " done\n", ":2: a line has five words"},
        {TITLE "hps167s 2 " FIRST " done now and\n", ":2: a line has five words"},
        {TITLE "hps167s 2 " FIRST " done now", ":2: the end of the line is missing"},
        {TITLE "hps168s 2 " FIRST " done now\n", ":2: unknown sensor"},
        {TITLE "hps167s 33 " FIRST " done now\n", ":2: this sensor cannot have this address"},
        {TITLE "hps167s 0 " FIRST " done now\n", ":2: this sensor cannot have this address"},
        {TITLE "hps167s 2 - done now\n", ":2: invalid UUID"},
        {TITLE "hps167s 2 " FIRST "0 done now\n", ":2: invalid UUID"},
        {TITLE "a16 2 " FIRST " done now\n", ":2: invalid UUID"},
        {TITLE "hps167s 2 " FIRST " Done now\n", ":2: the state is neither planned nor done"},
        {TITLE "hps167s 2 " FIRST " planned \x1b[2J\n", ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned \x9b"
               "2J\n",
         ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned x\",\"y\n", ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned x\\\n", ":2: invalid time"},
        {TITLE "#\na16 2 - done now\na05 2 - done now\n", ":4: this address is in the record twice"},
        {TITLE "hps167s 2 " FIRST " done now\nhps167s 3 " FIRST " done now\n",
         ":3: this UUID is in the record twice"},
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
           "fathom: cannot write /tmp/fathom-no-such-folder/record.txt: No such file or directory\n");
    assert_int_equal(bench.line.counters.from_host, 0);
}

TEST(wrong_words_are_usage_errors)
{
    static const struct {
        const char *more;
        const char *says;
    } rows[] = {
        {"hps167s", "--addresses is missing. It takes addresses and ranges"},
        {"hps167s --addresses 2-33", "from 1 to 32"},
        {"hps167s --addresses 5-2", "such as 2-9"},
        {"hps167s --addresses 2,,3", "such as 2-9"},
        {"hps167s --addresses 1-8", "has address 1 before its end."},
        {"hps167s --addresses 2-4,3", "--addresses has address 3 twice."},
        {"hps167s --addresses 2-4 --terminated 5",
         "--terminated is '5'. It takes one of --addresses, or none."},
        {"a16 --addresses 2-4 --terminated 4", "--terminated has no effect on a16"},
        {"hps167s:3 --addresses 2", "new sensors have address 1. Leave address 3 out."},
        {"hps167s a16 --addresses 2", "'a16' is one word too many."},
        {"a05 --mode dyp --addresses 2", "--mode is dyp, but this needs mode modbus."},
        {"hps167s --addresses 2 --wait 0", "--wait is '0'. It takes a whole number from 1 to 86400 s."},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        expect(commission(rows[i].more), 2, rows[i].says);
    expect(tool_run(&bench.tool, "commission hps167s --port line --addresses 2"), 2, "--record is missing");
    expect(tool_run(&bench.tool, "commission hps167s --port tcp:localhost --addresses 2 --record r"), 2,
           "tcp:localhost is no serial port.");
    write_record(TITLE "a16 2 - done now\n");
    expect(commission("hps167s --addresses 2-4"), 2, "address 2 belongs to an a16 in the record");
    write_record(TITLE "a16 1 - done now\n");
    expect(commission("a16 --addresses 2-4"), 2, "a sensor keeps address 1 in the record");
}

/* Their responses do not meet: each is whole. */
TEST(two_that_answer_one_after_the_other_are_two)
{
    add_hps_units(2);
    site.unit[1].hps.reply_us = 40 * MS; /* the response of the first one takes 15.5 ms of that */
    connect_next();
    const tool_run_t *const done = tool_run(
        &bench.tool, "commission hps167s --addresses 2,3 --wait 20 --port line --record %s", site.record);
    expect(done, 1, "two responses to one request. Connect one sensor only");
    assert_int_equal(writes(), 0);
}

TEST(address_1_is_not_given_while_another_is_open)
{
    add_hps_units(1);
    write_record(TITLE "hps167s 3 ffffffffffffffffffffffffffffffff planned 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 3,1 --wait 20"), 1, "0 of 2 addresses");
    assert_int_equal(count_of(record_text(), "hps167s 1 "), 0);
}
