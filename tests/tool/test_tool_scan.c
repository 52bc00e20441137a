/* SPDX-License-Identifier: MIT */
/* What `fathom scan` finds, how long it takes, and that it harms no device. */
#include "scan_bench.h"

#include <stdlib.h>
#include <string.h>

#include "commands/scan/scan.h"

static const suite_t suite = {.set_up = scan_set_up};

/* A device that responds adds at most this time to the estimate. */
enum { FOUND_US = 1500000 };

/* Address 4 is the dead one. */
#define EIGHT                                                                                                \
    "a16 1 9600 8N1, a16 2 9600 8N1, a05 3 9600 8N1, a05 5 9600 8N1, a16 9 9600 8N1, hps167s 6 19200 8E1, "  \
    "hps167s 7 19200 8E1, hps167s 8 19200 8E1"

/* Returns the sensor with address 2 or 7. */
static fathom_sim_device_t *two, *seven;
static void add_eight(void)
{
    scan_begin();
    (void)add_a16((fathom_sim_a16_config_t){.address = 1, .seed = 1});
    two = add_a16((fathom_sim_a16_config_t){.address = 2, .seed = 2});
    (void)add_a16((fathom_sim_a16_config_t){.address = 9, .seed = 9});
    (void)add_a05((fathom_sim_a05_config_t){.address = 3, .seed = 3});
    (void)add_a05((fathom_sim_a05_config_t){.address = 5, .seed = 5, .mode = FATHOM_SIM_A05_DYP});
    (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 6, .seed = 6, .no_termination = true});
    seven = add_hps167s((fathom_sim_hps167s_config_t){.address = 7, .seed = 7});
    (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 8, .seed = 8});
}

/* Returns the time that --estimate states, in microseconds. */
static uint64_t estimate_us(const char *options)
{
    const tool_run_t *const run = tool_run(&bench.tool, "scan --estimate --format json %s", options);
    const char *const seconds = strstr(run->out, "\"duration_s\":");
    assert_non_null(seconds);
    assert_string_equal(run->err, "");
    return strtoull(seconds + strlen("\"duration_s\":"), NULL, 10) * 1000000u;
}

/* ---- what a scan finds ---- */

TEST(eight_sensors_of_three_models_are_found_and_their_identities_printed)
{
    add_eight();
    const uint64_t said_us = estimate_us("");
    const tool_run_t *const run = scan_finds(EIGHT, "");
    assert_int_equal(run->status, 0);
    assert_true(run->took_us <= said_us + 8u * FOUND_US);
    /* HPS-167S #3: the example is version 3.9 of 2019-09-23 */
    assert_says(run,
                "hps167s  address 6    19200 8E1    interface 2.1.0 of 2020-09-27, sensor 3.9 of 2019-09-23, "
                "termination off  ->  fathom read hps167s:6:modbus --port line\n");
    assert_says(run, "termination on  ->  fathom read hps167s:8:modbus --port line\n");
    assert_says(run, "fathom: 2 sensors have their termination resistor on, the factory setting, which "
                     "overloads the line. ");
    assert_says(run, "with 'fathom set hps167s:ADDRESS --port line termination off'.\n");
    assert_says(run, "fathom: sensors found: 8, after ");
    assert_null(strstr(run->out, "twice"));
}

TEST(eight_sensors_are_found_by_a_main_loop_of_20_ms)
{
    add_eight();
    scans.coarse_us = 20000;
    (void)scan_finds(EIGHT, "");
}

TEST(eight_sensors_are_found_behind_an_adapter_that_echoes)
{
    add_eight();
    bench.line.echo = true;
    assert_null(strstr(scan_finds(EIGHT, "")->err, "another master"));
}

TEST(eight_sensors_are_found_although_one_is_noisy_and_another_damages_half_of_its_responses)
{
    uint32_t flipped = 0;
    for (uint32_t seed = 1; seed != 9; seed++) {
        add_eight();
        const fathom_sim_fault_t *const noise =
            add_fault(two, FATHOM_SIM_FAULT_NOISE, FATHOM_SIM_FAULT_ALWAYS_PPM, 0, seed);
        const fathom_sim_fault_t *const flips = add_fault(seven, FATHOM_SIM_FAULT_FLIP_BIT, 500000, 0, seed);
        (void)scan_finds(EIGHT, "");
        assert_true(noise->frames_hit >= 2);
        flipped += flips->frames_hit;
    }
    assert_true(flipped >= 8);
}

TEST(an_echo_alone_is_no_device_at_any_address)
{
    /* Neither is the echo of the requests to units 83 and 147, which looks like a response. */
    bench.line.echo = true;
    const tool_run_t *const run = scan_finds("", "--address 1-254");
    assert_int_equal(run->status, 1);
    assert_says(run, "only the tool's own request was received");

    scan_begin();
    bench.line.echo = true;
    (void)add_a16((fathom_sim_a16_config_t){.address = 83});
    (void)add_a05((fathom_sim_a05_config_t){.address = 147});
    (void)scan_finds("a16 83 9600 8N1, a05 147 9600 8N1", "--address 1-254");
}

TEST(a_sensor_at_another_rate_is_found_there_and_other_parities_are_not_tried)
{
    (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 12, .baud_code = 2});
    const tool_run_t *const run = scan_finds("hps167s 12 57600 8E1", "--baud all --parity all");
    assert_says(run, "fathom read hps167s:12:modbus --port line --baud 57600\n");
    assert_int_equal(scans.probed[2][FATHOM_PARITY_EVEN], 32);
    assert_int_equal(scans.probed[2][FATHOM_PARITY_NONE], 31);
    assert_int_equal(scans.probed[2][FATHOM_PARITY_ODD], 31);
}

TEST(a_late_response_is_found_while_the_next_address_is_asked)
{
    (void)add_a16(
        (fathom_sim_a16_config_t){.address = 3, .settings_us = 250000}); /* the time-out is 150 ms */
    (void)add_a16((fathom_sim_a16_config_t){.address = 5});
    (void)scan_finds("a16 5 9600 8N1, a16 3 9600 8N1", "");
}

TEST(an_a05_with_frames_55_aa_is_found_at_an_address_beyond_the_range)
{
    (void)add_a05((fathom_sim_a05_config_t){.address = 100, .mode = FATHOM_SIM_A05_DYP});
    assert_says(scan_finds("a05 100 9600 8N1", ""), "fathom read a05:100:dyp --port line\n");
}

TEST(an_a16_at_address_0_is_found_and_no_broadcast_is_sent)
{
    (void)add_a16((fathom_sim_a16_config_t){.address = 1});
    (void)scan_finds("", "--address 0 --baud 9600");
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 1);
    (void)scan_finds("", "--address 0 --baud 19200");
}

TEST(measurements_may_take_longer_than_the_first_response)
{
    (void)add_a16((fathom_sim_a16_config_t){.address = 1, .realtime_us = 290000});
    (void)add_a05((fathom_sim_a05_config_t){.address = 2, .probe_us = 290000});
    (void)scan_finds("a16 1 9600 8N1, a05 2 9600 8N1", "");
}

TEST(sensors_that_refuse_instead_of_being_silent_are_found)
{
    (void)add_a16((fathom_sim_a16_config_t){.address = 1, .exceptions = true});
    (void)add_a05((fathom_sim_a05_config_t){.address = 2, .exceptions = true});
    (void)add_hps167s(
        (fathom_sim_hps167s_config_t){.address = 3, .wrong_length = FATHOM_MODBUS_ILLEGAL_DATA_VALUE});
    (void)scan_finds("a16 1 9600 8N1, a05 2 9600 8N1, hps167s 3 19200 8E1", "");
}

TEST(an_a05_whose_measurement_is_lost_once_is_found)
{
    fathom_sim_device_t *const a05 = add_a05((fathom_sim_a05_config_t){.address = 9});
    const fathom_sim_fault_t *const fault = add_fault(
        a05, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2, 1); /* the first is that of 0200 */
    (void)scan_finds("a05 9 9600 8N1", "");
    assert_int_equal(fault->frames_hit, 1);
}

TEST(a_line_of_json_has_the_identity_and_the_next_command)
{
    (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 13});
    assert_string_equal(
        scan("--address 13 --baud 19200 --format json")->out,
        "{\"kind\":\"sensor\",\"model\":\"hps167s\",\"address\":13,\"baud\":19200,\"parity\":\"even\","
        "\"stop_bits\":1,\"mode\":\"modbus\",\"interface_version\":\"2.1.0 of 2020-09-27\","
        "\"sensor_version\":\"3.9 of 2019-09-23\","
        "\"uuid\":\"00390025423457142034383501060705\",\"termination\":true,"
        "\"is_double\":false,\"next\":\"fathom read hps167s:13:modbus --port line\"}\n");
}

/* ---- how long it takes ---- */

TEST(every_address_at_every_rate_and_parity_takes_as_long_as_estimated_and_less_than_10_minutes)
{
    static const char everything[] = "--address 1-254 --baud all --parity all";
    const uint64_t said_us = estimate_us(everything);
    const tool_run_t *const run = scan_finds("", everything);
    assert_true(said_us < UINT64_C(600000000));
    assert_int_equal(scans.requests, 254 * 5 * 3 + 1); /* and one to any A05 */
    for (unsigned rate = 0; rate != 5; rate++)
        for (unsigned parity = 0; parity != 3; parity++) assert_int_equal(scans.probed[rate][parity], 254);
    /* Simulated time has no late wake-ups, for which the estimate has 5 ms a request. It is a whole number of seconds. */
    assert_true(run->took_us <= said_us);
    assert_true(run->took_us + 254u * 15u * 5000u + 1005000u >= said_us);
}

TEST(eight_sensors_add_less_than_their_surcharge_to_a_scan_of_every_address)
{
    static const char everything[] = "--address 1-254 --baud all --parity all";
    add_eight();
    const tool_run_t *const run = scan_finds(EIGHT, everything);
    assert_true(run->took_us < UINT64_C(600000000));
    assert_true(run->took_us <= estimate_us(everything) + 8u * FOUND_US);
}

TEST(the_default_is_32_addresses_at_the_factory_settings_in_18_s)
{
    const tool_run_t *const run = tool_run(&bench.tool, "scan --estimate");
    /* 8 + 32 * (0.163 + 0.110) + 0.755 is 17.5 */
    assert_string_equal(
        run->out, "addresses 1 to 32 at 9600 8N1, 19200 8E1: about 18 s, and a second for each sensor\n");
    assert_string_equal(tool_run(&bench.tool, "scan --estimate --format json")->out,
                        "{\"settings\":2,\"addresses\":32,\"duration_s\":18}\n");
    assert_says(scan("--address 1-2"),
                "fathom: asking addresses 1 to 2 at 9600 8N1, 19200 8E1 takes about 10 s, and a "
                "second for each sensor\n");
}

static void has_settings(void **state)
{
    const char *const *const row = *state;
    const tool_run_t *const run = tool_run(&bench.tool, "scan --estimate --address 7 %s", row[0]);
    assert_non_null(strstr(run->out, row[1]));
}

#define HAS_SETTINGS(name, options, settings)                                                                \
    static const char *const row_##name[] = {options, "address 7 at " settings ": about "};                  \
    TEST_ROW(name, has_settings, row_##name)

HAS_SETTINGS(a_rate_counts_once_and_keeps_its_place, "--baud 57600,9600,57600", "57600 8E1, 9600 8N1")
HAS_SETTINGS(each_rate_has_each_parity, "--parity odd,none", "9600 8N1, 9600 8O1, 19200 8N1, 19200 8O1")
HAS_SETTINGS(the_parity_of_the_factory_comes_first, "--baud 38400 --parity all",
             "38400 8E1, 38400 8N1, 38400 8O1")
HAS_SETTINGS(two_stop_bits_replace_the_parity, "--stop-bits 2", "9600 8N2, 19200 8N2")
HAS_SETTINGS(two_stop_bits_keep_a_given_parity, "--baud 19200 --parity even,none --stop-bits 2",
             "19200 8E2, 19200 8N2")
HAS_SETTINGS(all_rates_are_those_of_the_sensors, "--baud all",
             "9600 8N1, 19200 8E1, 57600 8E1, 115200 8E1, 230400 8E1")

TEST(a_silent_address_is_asked_again_as_often_as_the_user_says)
{
    const uint64_t said_us = estimate_us("--retries 2 --address 1-4");
    const tool_run_t *const run = scan_finds("", "--retries 2 --address 1-4");
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 4 * 3);
    assert_int_equal(scans.probed[1][FATHOM_PARITY_EVEN], 4 * 3);
    assert_true(run->took_us <= said_us);
    assert_int_equal(estimate_us("--address 5 --baud 19200 --timeout 2000 --listen 4"), 7000000);
    assert_int_equal(estimate_us("--address 5 --baud 19200 --timeout 2000 --listen 4 --retries 1"), 11000000);
}

TEST(the_time_out_is_what_the_user_says)
{
    const uint64_t said_us = estimate_us("--timeout 400 --address 1-2");
    const tool_run_t *const run = scan_finds("", "--timeout 400 --address 1-2");
    assert_in_range(run->took_us, 8000000 + 4 * 400000 + 300000, said_us);
}

TEST(an_address_has_150_ms_on_the_line_of_a16_and_a05_and_100_ms_elsewhere)
{
    /* 8 bytes of 10 bits, the time-out and as long again, in which the unit may still respond; 5 bytes and a time-out for
     * any A05 */
    const uint64_t dyp_us = 8333 + 2 * 150000 + 5208 + 300000;
    assert_in_range(scan("--address 1 --baud 9600 --listen 1")->took_us, 1000000 + dyp_us, 1010000 + dyp_us);
    /* 8 bytes of 11 bits and the time-out */
    assert_in_range(scan("--address 1 --baud 9600 --parity odd --listen 1")->took_us, 1000000 + 9167 + 100000,
                    1010000 + 9167 + 100000);
    assert_in_range(scan("--address 1 --baud 19200 --listen 1")->took_us, 1000000 + 4583 + 100000,
                    1010000 + 4583 + 100000);
}

/* ---- wrong usage ---- */

REFUSES(a_scan_needs_a_serial_port, "scan", {"", "--port is missing"},
        {"--port /nowhere a16", "takes options only, not 'a16'"},
        {"--port tcp:127.0.0.1",
         "scan needs a serial port. The rates behind 'tcp:127.0.0.1' are those of the gateway."},
        {"--port /nowhere --port /elsewhere", "--port is given twice"})

#define ADDRESSES "It takes an address from 1 to 254, a range such as 1-32, or 0."
REFUSES(a_wrong_range_of_addresses_is_refused, "scan --port line --address",
        {"0-5", "--address is '0-5'. " ADDRESSES}, {"255", ADDRESSES}, {"00", ADDRESSES},
        {"1-255", ADDRESSES}, {"9-8", ADDRESSES}, {"1-", ADDRESSES}, {"-5", ADDRESSES}, {"1-5-9", ADDRESSES})

REFUSES(a_wrong_list_is_refused, "scan --port line",
        {"--baud 4800", "--baud is '4800'. It takes all, or some of 9600, "},
        {"--baud All", "--baud is 'All'"}, {"--baud 9600,", "--baud is '9600,'"},
        {"--baud ,9600", "--baud is ',9600'"},
        {"--parity mark",
         "--parity is 'mark'. It takes all, or some of none, even and odd with commas between them."},
        {"--parity none,", "--parity is 'none,'"})

REFUSES(a_wrong_number_or_word_is_refused, "scan --port line",
        {"--stop-bits 0", "a whole number from 1 to 2"}, {"--timeout 0", "a whole number from 1 to 10000"},
        {"--retries 10", "a whole number from 0 to 9"}, {"--listen 0", "a whole number from 1 to 60"},
        {"--format csv", "--format is 'csv'. It takes text or json."}, {"--fast", "unknown option '--fast'"})

/* ---- how it ends ---- */

TEST(a_rate_that_the_port_does_not_have_is_left_out)
{
    scans.refused_baud = 230400;
    (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 1});
    assert_says(scan_finds("hps167s 1 19200 8E1", "--baud 9600,230400,19200"),
                "fathom: this port does not have 230400 8E1, so the scan leaves it out.\n");
}

TEST(ctrl_c_ends_the_scan_at_once_and_keeps_what_was_found)
{
    for (uint64_t ms = 1; ms < 18000; ms += 331) {
        add_eight();
        bench.tool.ctrl_c_us = ms * 1000;
        const tool_run_t *const run = scan("");
        /* The signal ends a wait of the bench with its time-out, which is at most that for any A05. */
        assert_in_range(run->took_us, ms * 1000, ms * 1000 + 300000);
        assert_int_equal(run->status, run->out[0] != '\0' ? 0 : 1);
        assert_says(run, "fathom: the scan ended before all addresses were asked. Sensors found: ");
    }
}

TEST(a_port_that_fails_ends_the_scan)
{
    add_eight();
    scans.is_broken = true;
    const tool_run_t *const run = scan_finds("", "");
    assert_int_equal(run->status, 1);
    assert_says(run, "the port did not send the request. Check the adapter");
}

TEST(a_port_that_does_not_exist_is_named)
{
    const tool_port_t port = {.path = "elsewhere"};
    bench.tool.ports = &port;
    bench.tool.port_count = 1;
    const tool_run_t *const run = scan("");
    assert_int_equal(run->status, 1);
    assert_says(run, "fathom: line: no such device");
}

TEST(a_line_without_a_sound_is_explained)
{
    const tool_run_t *run = scan("--address 1");
    assert_int_equal(run->status, 1);
    assert_says(run, "no sensor was found at line: no byte was received. Check the power, whether A and B");
    assert_says(run, "sensors found: 0");
    assert_null(strstr(run->err, "--baud all")); /* the user chose the range */
    assert_says(scan(""),
                "run 'fathom scan --port line --address 1-254 --baud all --parity all' (about 7 minutes)");
}

TEST(neither_the_reset_nor_a_broadcast_can_be_sent)
{
    static const struct {
        uint16_t first;
        uint8_t count, address;
    } reads[] = {{0x0009, 1, 1},
                 {0x0009, SCAN_REGISTERS, 1},
                 {0x0008, 2, 1},
                 {0x0001, 3, 0}, /* unit 0 */
                 {0x0001, SCAN_REGISTERS + 1, 1} /* more than a response has room for */};
    static scan_t none;
    for (size_t i = 0; i != sizeof reads / sizeof reads[0]; i++) {
        none.read = (scan_read_t){.line = &hps167s_line,
                                  .first = reads[i].first,
                                  .count = reads[i].count,
                                  .address = reads[i].address};
        scan_ask(&none);
        assert_int_equal(none.read.status, FATHOM_ERR_ARGUMENT);
    }
}
