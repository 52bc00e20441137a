/* SPDX-License-Identifier: MIT */
/* What `fathom scan` makes of sensors that send automatically, two units with one address, other devices, other
 * protocols and another master. */
#include "scan_bench.h"

#include <string.h>

static const suite_t suite = {.set_up = scan_set_up};

/* ---- before the first request ---- */

/* A scan that heard a device and sent nothing. */
static const tool_run_t *hears(const char *finding, const char *text)
{
    const tool_run_t *const run = scan_finds(finding, "--listen 3");
    assert_int_equal(scans.requests, 0);
    assert_int_equal(bench.line.counters.from_host, 0);
    assert_says(run, "fathom: nothing was sent, because ");
    assert_says(run, "--wake");
    assert_says(run, text);
    return run;
}

TEST(a_silent_line_is_listened_to_for_as_long_as_the_user_says)
{
    (void)add_a16((fathom_sim_a16_config_t){.address = 1});
    (void)scan_finds("a16 1 9600 8N1", "--listen 3");
    assert_in_range(scans.first_us, 3000000, 3010000);
}

TEST(an_a16_and_an_a05_that_send_automatically_are_named_and_nothing_is_sent)
{
    /* Some values have bytes that look like frames one byte later: 511 mm is FF 01 FF FF. */
    static fathom_sim_fixed_t scenes[] = {{{511, 511, 511, 511}},     {{1000, 2000, 2047, 1339}},
                                          {{-1, -1, -1, -1}},         {{65281, 0, 255, 65535}},
                                          {{1023, 1023, 1023, 1023}}, {{44543, 44543, 44543, 44543}}};
    for (unsigned i = 0; i != 4 * sizeof scenes / sizeof scenes[0]; i++) {
        const fathom_sim_scene_t scene = fathom_sim_fixed(&scenes[i / 4]);
        scan_begin();
        bench.line.full_duplex = true;
        scans.coarse_us = i % 2 != 0 ? 20000 : 0;
        if (i / 2 % 2 == 0)
            (void)add_a16((fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO, .scene = scene});
        else
            (void)add_a05((fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = scene});
        const tool_run_t *const run = hears(
            i / 2 % 2 == 0 ? "a16 - 9600 8N1" : "a05 - 9600 8N1",
            i / 2 % 2 == 0 ? "even a read ends the automatic output of an A16 with RS232, until power-off or "
                           : "even a read ends the automatic output of an A05 with UART, until power-off. ");
        assert_says(run, i / 2 % 2 == 0 ? "sends without requests  ->  fathom read a16 --port line\n"
                                        : "sends without requests  ->  fathom read a05 --port line\n");
        assert_int_equal(run->status, 0);
    }
}

TEST(a_sensor_that_sends_automatically_is_asked_if_the_user_says_so)
{
    bench.line.full_duplex = true;
    (void)add_a16((fathom_sim_a16_config_t){.address = 7, .mode = FATHOM_SIM_A16_AUTO});
    assert_says(scan_finds("a16 7 9600 8N1", "--wake"),
                "the sensor sent automatically until the scan asked it. It sends again after a power cycle, "
                "or when 1 is written to its register 0x0202");
}

TEST(a_sensor_that_hears_no_request_and_goes_on_sending_is_named)
{
    bench.line.full_duplex = true;
    (void)add_a16((fathom_sim_a16_config_t){.address = 7, .mode = FATHOM_SIM_A16_UART});
    assert_null(strstr(scan_finds("a16 - 9600 8N1", "--wake")->err, "until the scan asked it"));
}

static void hear_hps167s_at_115200(uint32_t period_us)
{
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    (void)add_speaker(&fast, period_us, hps_response, sizeof hps_response);
    const tool_run_t *const run =
        hears("hps167s 1 115200 8E1", "requests would collide with its unsolicited frames");
    assert_says(run,
                "sends unsolicited responses  ->  fathom read hps167s:1:modbus --port line --baud 115200\n");
}

TEST(an_hps167s_that_sends_unsolicited_frames_is_found_at_its_rate)
{
    hear_hps167s_at_115200(40000); /* so often that the bytes at the wrong rate fill any memory */
}

TEST(a_rate_that_the_port_does_not_have_does_not_end_the_listening)
{
    scans.refused_baud = 57600;
    hear_hps167s_at_115200(180000);
}

TEST(another_master_is_not_disturbed)
{
    (void)add_speaker(&dyp_line, 500000, a16_request, sizeof a16_request);
    const tool_run_t *const run = hears("? 1 9600 8N1", "another master sends requests on this line");
    assert_says(run, "another master sends requests to this address\n");
    assert_int_equal(run->status, 1);
}

TEST(unknown_bytes_are_a_sender_and_a_few_bytes_are_noise)
{
    (void)add_speaker(&dyp_line, 1000000, junk, sizeof junk); /* three times in 3 s */
    (void)hears("? - 9600 8N1", "a device sends without a request. An HPS-167S made before 2020-09");

    scan_begin();
    (void)add_speaker(&dyp_line, 2000000, junk, sizeof junk); /* once */
    (void)scan_finds("", "--listen 3");
    assert_int_not_equal(scans.requests, 0);
}

/* ---- damaged responses ---- */

TEST(two_units_with_one_address_are_named_and_their_neighbours_found)
{
    for (uint32_t seed = 0; seed != 8; seed++) {
        scan_begin();
        (void)add_a16((fathom_sim_a16_config_t){.address = 1, .seed = seed});
        (void)add_a05((fathom_sim_a05_config_t){.address = 1, .seed = seed + 100});
        (void)add_a16((fathom_sim_a16_config_t){.address = 2});
        (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 4, .seed = seed});
        (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 4, .seed = seed + 100});
        (void)add_hps167s((fathom_sim_hps167s_config_t){.address = 5});
        const tool_run_t *const run =
            scan_finds("a16 2 9600 8N1, ? 1 9600 8N1, hps167s 5 19200 8E1, ? 4 19200 8E1", "");
        assert_says(run, "damaged responses: two sensors with one address?\n");
        assert_says(run,
                    "address 1 at 9600 8N1: the responses are damaged: do two sensors have this address?");
        assert_says(run,
                    "address 4 at 19200 8E1: the responses are damaged: do two sensors have this address?");
    }
}

TEST(two_responses_to_one_request_are_two_units)
{
    /* One unit responds to 0200 after 17.5 to 20 ms, the other after 35 to 40: both responses are whole. */
    (void)add_a16((fathom_sim_a16_config_t){.address = 6});
    (void)add_a16((fathom_sim_a16_config_t){.address = 6, .settings_us = 40000});
    const tool_run_t *const run = scan_finds("? 6 9600 8N1", "");
    assert_says(run, "responds twice: two sensors with one address?\n");
    assert_says(run, "address 6 at 9600 8N1: a request had two responses: do two sensors have this address?");
}

TEST(one_spike_is_no_device)
{
    /* once, 1.2 s after the scan began to ask */
    const fathom_sim_device_t *const spike = add_speaker(&dyp_line, 2200000, junk, 1);
    const tool_run_t *const run = scan_finds("", "--baud 9600 --address 1-12 --listen 1"); /* 2 s */
    assert_true(spike->counters.automatic != 0);
    assert_says(run, "bytes were received, but no Modbus frame");
}

TEST(responses_that_are_not_modbus_are_one_finding)
{
    (void)add_speaker(&hps167s_line, 0, junk, sizeof junk);
    (void)add_a16((fathom_sim_a16_config_t){.address = 3});
    const tool_run_t *const run = scan_finds("a16 3 9600 8N1, ? - 19200 8E1", "");
    assert_says(run,
                "fathom: 19200 8E1: a device responds, but not in Modbus. An HPS-167S made before 2020-09");
    /* 32 addresses, most of them asked twice and not four times */
    assert_in_range(scans.probed[1][FATHOM_PARITY_EVEN], 64, 80);
}

TEST(junk_from_one_address_of_two_is_damage_and_from_the_only_one_another_protocol)
{
    add_speaker(&dyp_line, 0, junk, sizeof junk)->address = 3;
    assert_says(scan_finds("? - 9600 8N1", "--address 3"), "a response that is not Modbus\n");
    assert_says(scan_finds("? 3 9600 8N1", "--address 3-4"), "damaged responses");
}

/* ---- other Modbus devices ---- */

static void is_other(stranger_t with, const fathom_line_settings_t *line)
{
    scan_begin();
    add_stranger(9, with, line);
    const tool_run_t *const run =
        scan_finds(line == &dyp_line ? "? 9 9600 8N1" : "? 9 19200 8E1", "--address 8-10");
    assert_says(run, "a Modbus device that is none of the known sensors\n");
    assert_int_equal(run->status, 1);
}

TEST(a_device_that_responds_to_everything_or_nothing_is_another_modbus_device)
{
    const fathom_line_settings_t *const lines[] = {&dyp_line, &hps167s_line};
    const uint16_t values[] = {0, 9, 0xFFFF, 0xB00B, 0x0909}; /* the last is a date */
    for (unsigned line = 0; line != 2; line++) {
        for (unsigned i = 0; i != sizeof values / sizeof values[0]; i++)
            is_other((stranger_t){.value = values[i], .version = values[i], .address = 9}, lines[line]);
        for (uint8_t exception = 1; exception != 5; exception++)
            is_other((stranger_t){.exception = exception}, lines[line]);
    }
}

TEST(a_device_with_another_address_in_0200_than_its_own_is_no_a16)
{
    stranger_t with = {.value = 754, .address = 9, .only = {0x0200, 0x0101}};
    add_stranger(9, with, &dyp_line);
    (void)scan_finds("a16 9 9600 8N1", "");
    for (with.address = 10; with.address != 12; with.address++) is_other(with, &dyp_line);
}

TEST(an_a16_that_responds_to_0100_alone_is_found)
{
    add_stranger(9, (stranger_t){.value = 754, .address = 9, .only = {0x0200, 0x0100}}, &dyp_line);
    assert_says(scan_finds("a16 9 9600 8N1", ""), " 754 mm ");
}

TEST(a_device_without_a_date_in_0001_is_no_hps167s)
{
    /* #3 begins with the right byte; in #1 the month is 0, 13 or 32, or the day is 0 */
    const uint16_t versions[] = {0x1400, 0x140D, 0x0020, 0x0009};
    for (unsigned i = 0; i != 4; i++)
        is_other((stranger_t){.value = 0xB000, .version = versions[i]}, &hps167s_line);
}

TEST(a_device_with_a_date_in_0001_and_zeros_elsewhere_is_no_hps167s)
{
    /* #2 has two switches and is the same twice, but so is what the device measures */
    is_other((stranger_t){.version = 0x0909}, &hps167s_line);
}

TEST(a_frame_of_an_address_beyond_the_range_is_mentioned)
{
    (void)add_speaker(&dyp_line, 0, a16_response, sizeof a16_response);
    const tool_run_t *const run = scan_finds("", "--address 2-4");
    assert_says(run, "a frame from address 1 was heard, which the scan did not ask. Use --address 1.\n");
    assert_null(strstr(run->err, "another master"));
}

TEST(another_master_that_starts_later_is_mentioned)
{
    (void)add_speaker(&dyp_line, 0, a16_request, sizeof a16_request);
    const tool_run_t *const run = scan_finds("", "--address 2-4");
    assert_says(run, "another master sends requests on this line (to address 1)");
    assert_null(strstr(run->err, "a frame from address"));
}

/* Each address is asked three times, and twice after four addresses in a row; so is any A05, once. */
TEST(a_line_that_is_never_silent_proves_nothing_about_its_addresses)
{
    (void)add_speaker(&dyp_line, 6000, junk, sizeof junk); /* 6.3 ms long */
    const tool_run_t *const run = scan_finds("? - 9600 8N1", "--wake --baud 9600 --address 1-8 --listen 1");
    assert_says(run, "fathom: 9 addresses could not be asked: ");
    assert_null(strstr(run->err, "nothing was heard"));
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 4 * 3 + 4 * 2);
}

/* ---- HPS-167S #2 ---- */

/* Table 12 prints no encoding of the rate, and the multiple of 18 of #15 is a rule for what is written. */
TEST(a_configuration_is_accepted_with_any_rate_and_any_reconnect_time)
{
    const uint32_t times_ms[] = {0, 1, 1000, UINT32_MAX};
    const uint8_t codes[] = {0, 5, 0xFF, 19};
    for (unsigned i = 0; i != 4; i++) {
        scan_begin();
        (void)add_hps167s((fathom_sim_hps167s_config_t){0});
        scans.hps167s[0].reconnect_ms = times_ms[i];
        scans.hps167s[0].baud_code = codes[i];
        assert_says(scan_finds("hps167s 1 19200 8E1", "--baud 19200 --address 1"), ", termination on ");
    }
}

/* 255 mm are 00 FF, two switches; and of a sensor that has failed (table 18) all but the magnitude is FF. */
TEST(an_unsolicited_measurement_is_no_configuration)
{
    static fathom_sim_fixed_t near = {{255, 0, 0, 0}};
    for (uint32_t i = 0; i != 60; i++) {
        scan_begin();
        (void)add_hps167s(
            (fathom_sim_hps167s_config_t){.unasked_us = 25000 + i * 7000, .scene = fathom_sim_fixed(&near)});
        if (i % 2 != 0) fathom_sim_hps167s_lose(&scans.hps167s[0], true, bench.clock.now_us);
        scans.lost_register = 0x02;
        const tool_run_t *const run =
            scan_finds("hps167s 1 19200 8E1", "--wake --baud 19200 --address 1 --listen 1");
        assert_null(strstr(run->out, "termination"));
    }
}
