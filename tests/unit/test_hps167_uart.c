/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/hps167_uart.h"

/* An HPS-167 on the fake UART; test_driver_contract.c has what every driver promises. At 115200 8N1 a byte takes 87 us. */
enum { LENGTH = RIG_HPS167_LENGTH, BYTE_US = 87, STEP_US = 250, OUTPUT_US = 20000, STALE_US = 2000000 };

/* The frames of test_hps167_frames.c. */
static const uint8_t single[] = {0x0A, 0x22, 0, 0, 0, 0, 0, 0, 0xAE, 0x57};
static const uint8_t continuous[] = {0x0A, 0x24, 0, 0, 0, 0, 0, 0, 0x0F, 0x72};
static const uint8_t stop_it[] = {0x0A, 0x30, 1, 0, 0, 0, 0, 0, 0xBC, 0x6F};
static const uint8_t ask_temperature[] = {0x0A, 0x3F, 1, 0, 0, 0, 0, 0, 0x36, 0x86};
static const uint8_t printed[LENGTH] = {0x0A, 0x0D, 0x01, 0x01, 0x01, 0x06, 0xD9, 0xFC,
                                        0x8C, 0x02, 0x01, 0x00, 0x01, 0x9B, 0x94};
static const uint8_t acknowledged[] = {0x0A, 0x03, 0x01, 0xF1, 0xD1};
static const uint8_t refused[] = {0x0A, 0x03, 0x00, 0xE1, 0xF0};
static const uint8_t greeting[] = {'H', 'y', 'p', 'e', 'r', 's', 'e', 'n'};

static fathom_hps167_uart_config_t config;
static fathom_hps167_uart_t hps;
static uint16_t counters[FATHOM_LINE_COUNTERS];

static void begin(void)
{
    assert_int_equal(fathom_hps167_uart_init(&hps, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_hps167_uart_sensor(&hps);
}

static void begin_at(uint32_t now_us, bool is_continuous)
{
    rig_start(now_us);
    rig.line_parts.echo = FATHOM_LINE_ECHO_OFF;
    rig.line_parts.silence_us = 304; /* FATHOM_T3_5_US(115200, 10) */
    rig.line_parts.count = fathom_line_count;
    rig.line_parts.counters = counters;
    memset(counters, 0, sizeof counters);
    rig.fake.byte_us = BYTE_US;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    config = (fathom_hps167_uart_config_t){.continuous = is_continuous};
    memset(&hps, 0x5A, sizeof hps);
    begin();
}

static int set_up(void **state)
{
    begin_at(RIG_START_US, false);
    return 0;
}

static int set_up_continuous(void **state)
{
    begin_at(RIG_START_US, true);
    return 0;
}

static const suite_t suite = {.set_up = set_up};
static const suite_t streaming = {.set_up = set_up_continuous};

/* The status that comes next within `us`, of a call in a loop. */
static fathom_status_t next_of(fathom_status_t (*call)(void), uint32_t us)
{
    fathom_status_t status = FATHOM_PENDING;
    for (uint32_t passed_us = 0; passed_us < us && status == FATHOM_PENDING; passed_us += STEP_US) {
        rig.fake.now_us += STEP_US;
        status = call();
    }
    return status;
}

static fathom_status_t next(uint32_t us) { return next_of(rig_poll, us); }
static void nothing_for(uint32_t us) { PENDS(next(us)); }

static void was_written(size_t index, const uint8_t *request)
{
    assert_in_range(rig.fake.written, index + 1, FAKE_WRITES);
    assert_int_equal(rig.fake.writes[index].length, 10);
    assert_memory_equal(rig.fake.writes[index].bytes, request, 10);
}

/* Until one more request has left, which is this one. */
static void sends_by(fathom_status_t (*call)(void), const uint8_t *request)
{
    const size_t written = rig.fake.written;
    for (unsigned i = 0; rig.fake.written == written; i++) {
        assert_true(i < 60000);
        PENDS(next_of(call, STEP_US));
    }
    was_written(written, request);
    PENDS(next_of(call, 2000));
}

static void sends(const uint8_t *request) { sends_by(rig_poll, request); }

static void receive(const uint8_t *bytes, size_t length)
{
    fake_trickle(&rig.fake, 0, BYTE_US, bytes, length);
}

static fathom_status_t hears(const uint8_t *bytes, size_t length)
{
    receive(bytes, length);
    return next((uint32_t)length * BYTE_US + 2 * STEP_US);
}

/* A frame of the output with this distance, and the pause before it. */
static fathom_status_t hears_mm(uint16_t mm)
{
    uint8_t frame[LENGTH];
    rig_hps167_frame(frame, mm, 0xDCB2, 0x0701, 0x0000);
    nothing_for(OUTPUT_US - LENGTH * BYTE_US - 2 * STEP_US);
    return hears(frame, LENGTH);
}

static void reads_mm(uint16_t mm)
{
    assert_int_equal(hears_mm(mm), FATHOM_OK);
    assert_int_equal(rig.sample.distance_mm, mm);
}

static fathom_status_t stop(void) { return fathom_hps167_uart_stop(&hps); }

static uint16_t temperature;
static fathom_status_t get_temperature(void)
{
    return fathom_hps167_uart_get_temperature(&hps, &temperature);
}

/* ---- single measurements ---- */

TEST(each_measurement_is_requested_and_read)
{
    for (uint16_t i = 1; i != 4; i++) {
        sends(single);
        assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
        assert_sample(&rig.sample, (fathom_sample_t){.time_us = rig.sample.time_us,
                                                     .raw = 1753,
                                                     .sequence = i,
                                                     .distance_mm = 1753,
                                                     .magnitude = 258608,
                                                     .ambient = 1,
                                                     .precision = 1,
                                                     .kind = FATHOM_TARGET,
                                                     .model = FATHOM_HPS167S,
                                                     .probe = 1});
        assert_in_range(rig.fake.now_us - rig.sample.time_us, 0, STEP_US);
    }
    assert_int_equal(counters[FATHOM_LINE_RESPONSES], 3);
    assert_int_equal(fathom_modbus_unit_responses(fathom_hps167_uart_unit(&hps)), 3);
}

TEST(over_range_is_no_target_and_what_cannot_be_is_refused)
{
    uint8_t frame[LENGTH];
    sends(single);
    rig_hps167_frame(frame, 65530, 0x0010, 0x0001, 0x0000);
    assert_int_equal(hears(frame, LENGTH), FATHOM_OK);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
    assert_int_equal(rig.sample.distance_mm, 0);
    sends(single);
    rig_hps167_frame(frame, 0xFFFF, 0x0000, 0x00FF, 0xFFFF);
    assert_int_equal(hears(frame, LENGTH), FATHOM_OK);
    assert_int_equal(rig.sample.kind, FATHOM_FAULT);
    sends(single);
    rig_hps167_frame(frame, 30001, 0xDCB2, 0x0701, 0x0000);
    assert_int_equal(hears(frame, LENGTH), FATHOM_ERR_MALFORMED);
    assert_int_equal(hps.implausible, 1);
}

TEST(other_limits_are_used_and_wrong_ones_are_not)
{
    static fathom_hps167s_limits_t narrow, wrong;
    narrow = (fathom_hps167s_limits_t){.max_mm = 1752};
    wrong = (fathom_hps167s_limits_t){.min_mm = 2000, .max_mm = 1000};
    assert_int_equal(fathom_hps167_uart_set_limits(&hps, &narrow), FATHOM_OK);
    assert_int_equal(fathom_hps167_uart_set_limits(&hps, &wrong), FATHOM_ERR_ARGUMENT);
    sends(single);
    assert_int_equal(hears(printed, LENGTH), FATHOM_ERR_MALFORMED);
}

/* "20 ms" from one request to the next, "500 ms" for the response. */
TEST(the_pace_is_20_ms_and_the_time_out_500_ms_or_as_the_config_says)
{
    for (unsigned i = 0; i != 2; i++) {
        begin_at(RIG_START_US, false);
        config.modbus.period_us = i * 35000u;
        config.modbus.timeout_us = i * 90000u;
        begin();
        sends(single);
        assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
        sends(single);
        assert_in_range(rig.fake.writes[1].at_us - rig.fake.writes[0].at_us, i == 0 ? 20000 : 35000,
                        (i == 0 ? 20000 : 35000) + 3 * STEP_US);
        const uint32_t sent_us = rig.fake.writes[1].at_us + 10 * BYTE_US;
        assert_int_equal(next(1000000), FATHOM_ERR_NO_RESPONSE);
        assert_in_range(rig.fake.now_us - sent_us, i == 0 ? 500000 : 90000,
                        (i == 0 ? 500000 : 90000) + 3 * STEP_US);
    }
}

TEST(a_response_is_found_behind_foreign_bytes_and_every_beginning_of_another)
{
    for (unsigned cut = 0; cut != LENGTH; cut++) {
        uint8_t bytes[sizeof greeting + 2 + 2 * LENGTH];
        begin_at(0xFFFF0000u, false);
        memcpy(bytes, greeting, sizeof greeting);
        bytes[sizeof greeting] = 0x0A;
        memcpy(bytes + sizeof greeting + 1, printed, cut);
        memcpy(bytes + sizeof greeting + 1 + cut, printed, LENGTH);
        sends(single);
        assert_int_equal(hears(bytes, sizeof greeting + 1 + cut + LENGTH), FATHOM_OK);
        assert_int_equal(rig.sample.raw, 1753);
    }
}

/* 15 bytes with a wrong CRC end the attempt at the next gap; a response that lacks bytes does too; a response whose second
 * byte is wrong is noise. */
TEST(no_damaged_response_is_a_reading)
{
    for (unsigned at = 0; at != LENGTH; at++) {
        uint8_t bytes[LENGTH];
        for (unsigned is_cut = 0; is_cut != 2; is_cut++) {
            begin_at(RIG_START_US, false);
            config.modbus.timeout_us = 50000;
            begin();
            memcpy(bytes, printed, LENGTH);
            bytes[at] ^= 0x10;
            sends(single);
            receive(is_cut != 0 ? printed : bytes, is_cut != 0 ? at : LENGTH);
            assert_int_equal(next(100000),
                             (is_cut != 0 ? at > 2 : at > 1) ? FATHOM_ERR_CHECKSUM : FATHOM_ERR_NO_RESPONSE);
            assert_int_equal(rig.samples, 0);
            sends(single);
            assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
        }
    }
}

TEST(the_response_to_another_command_is_no_measurement)
{
    sends(single);
    receive(acknowledged, sizeof acknowledged);
    assert_int_equal(next(600000), FATHOM_ERR_MALFORMED);
    sends(single);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
}

TEST(the_echo_of_an_adapter_is_passed_over)
{
    static const uint8_t echo[] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_ON};
    for (unsigned i = 0; i != COUNT(echo); i++) {
        begin_at(RIG_START_US, false);
        rig.line_parts.echo = echo[i];
        assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
        begin();
        sends(single);
        receive(single, sizeof single);
        nothing_for(2000);
        assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
        assert_int_equal(counters[FATHOM_LINE_STRAYS], 0);
        assert_int_equal(fathom_line_get_echo(&rig.line), FATHOM_LINE_ECHO_ON);
    }
}

TEST(a_retry_is_the_same_request)
{
    config.modbus.retries = 1;
    begin();
    sends(single);
    sends(single);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    assert_int_equal(counters[FATHOM_LINE_NO_RESPONSES], 1);
}

/* Noise without a pause: after busy_us (1 s) the request leaves all the same. */
TEST(noise_does_not_keep_a_request_back)
{
    static const uint8_t noise[] = {0xC3};
    for (unsigned i = 0; rig.fake.written == 0; i++) {
        assert_true(i < 5000);
        fake_receive(&rig.fake, 0, noise, 1);
        nothing_for(STEP_US);
    }
    was_written(0, single);
    assert_in_range(rig.fake.now_us - RIG_START_US, 1000000, 1010000);
}

TEST(commands_are_sent_between_measurements)
{
    static const uint8_t degrees[] = {0x0A, 0x04, 0x0B, 0xB8, 0xE7, 0x26};
    sends(single);
    receive(printed, LENGTH);
    temperature = 0;
    sends_by(get_temperature, ask_temperature);
    PENDS(rig_poll());
    receive(degrees, sizeof degrees);
    assert_int_equal(stop(), FATHOM_ERR_BUSY);
    assert_int_equal(next_of(get_temperature, 10000), FATHOM_OK);
    assert_int_equal(temperature, 3000);
    sends_by(stop, stop_it);
    receive(acknowledged, sizeof acknowledged);
    assert_int_equal(next_of(stop, 10000), FATHOM_OK);
    sends_by(stop, stop_it);
    receive(refused, sizeof refused);
    assert_int_equal(next_of(stop, 10000), FATHOM_ERR_EXCEPTION);
    sends_by(stop, stop_it);
    assert_int_equal(next_of(stop, 2000000), FATHOM_ERR_NO_RESPONSE);
    sends(single);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
}

TEST(single_measurements_leave_the_listener_of_the_line_alone_and_need_no_stop)
{
    assert_null(rig.line.listener);
    sends(single);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    rig.fake.now_us += 5000;
    fathom_hps167_uart_deinit(&hps);
    assert_int_equal(rig.fake.written, 1);
    assert_null(rig.line.head);
}

TEST(after_power_on_silence_is_warming_up)
{
    static const uint32_t starts_us[][2] = {{0, 5000000}, {700000, 700000}};
    for (unsigned i = 0; i != COUNT(starts_us); i++) {
        fathom_status_t status = FATHOM_ERR_WARMING_UP;
        begin_at(RIG_START_US, i != 0);
        config.start_us = starts_us[i][0];
        begin();
        fathom_hps167_uart_power_on(&hps);
        while (status == FATHOM_ERR_WARMING_UP) status = next(9000000);
        assert_int_equal(status, FATHOM_ERR_NO_RESPONSE);
        assert_in_range(rig.fake.now_us - RIG_START_US, starts_us[i][1], starts_us[i][1] + 4500000);
    }
}

/* ---- the continuous measurement ---- */

TEST_IN(streaming, the_output_is_requested_once_and_each_frame_is_a_sample)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    assert_int_equal(rig.sample.distance_mm, 1753);
    assert_int_equal(rig.sample.sequence, 1);
    for (uint16_t i = 0; i != 200; i++) {
        reads_mm((uint16_t)(1000 + i));
        assert_int_equal(rig.sample.sequence, i + 2);
        assert_int_equal(rig.sample.address, 0);
        assert_in_range(rig.fake.now_us - rig.sample.time_us, 0, STEP_US);
    }
    assert_int_equal(rig.fake.written, 1);
    assert_int_equal(hps.missed + hps.dropped_bytes + hps.damaged + hps.implausible, 0);
}

TEST_IN(streaming, an_output_that_stops_is_stale_and_requested_again)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    reads_mm(1500);
    const uint32_t since_us = rig.fake.now_us;
    assert_int_equal(next(2 * STALE_US), FATHOM_ERR_STALE);
    assert_in_range(rig.fake.now_us - since_us, STALE_US, STALE_US + STEP_US);
    sends(continuous);
    assert_int_equal(next(600000), FATHOM_ERR_NO_RESPONSE); /* it is still away */
    receive(greeting, sizeof greeting);                     /* it has power again */
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    assert_int_equal(rig.sample.sequence, 3);
    reads_mm(1600);
    assert_int_equal(rig.fake.written, 3);
}

TEST_IN(streaming, bytes_without_a_frame_are_damage_after_the_same_time)
{
    config.stale_us = 300000;
    begin();
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    const uint32_t since_us = rig.fake.now_us;
    receive(greeting, sizeof greeting);
    assert_int_equal(next(1000000), FATHOM_ERR_CHECKSUM);
    assert_in_range(rig.fake.now_us - since_us, 300000, 300000 + STEP_US);
    assert_int_equal(hps.dropped_bytes, sizeof greeting);
    sends(continuous);
}

/* It sends already when the driver begins, so that the request is in no hurry. */
TEST_IN(streaming, an_output_that_runs_already_is_read)
{
    rig.fake.write_busy = true;
    reads_mm(1000);
    reads_mm(1001);
    rig.fake.write_busy = false;
    for (uint16_t i = 2; i != 100; i++) reads_mm((uint16_t)(1000 + i));
    assert_int_equal(rig.fake.written, 1);
    assert_int_equal(rig.sample.sequence, 100);
    assert_int_equal(next(3 * STALE_US), FATHOM_ERR_STALE); /* and no frame is read twice */
}

TEST_IN(streaming, a_frame_is_found_behind_foreign_bytes_and_every_beginning_of_another)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    for (unsigned cut = 0; cut != LENGTH; cut++) {
        uint8_t bytes[2 * LENGTH + 2];
        bytes[0] = 0x0A;
        bytes[1] = 0x03; /* no measurement begins so */
        memcpy(bytes + 2, printed, cut);
        memcpy(bytes + 2 + cut, printed, LENGTH);
        hps.dropped_bytes = 0;
        assert_int_equal(hears(bytes, 2 + cut + LENGTH), FATHOM_OK);
        assert_int_equal(rig.sample.raw, 1753);
        assert_in_range(rig.fake.now_us - rig.sample.time_us, 0, STEP_US);
        assert_int_equal(hps.dropped_bytes, 2 + cut);
        assert_int_equal(hps.held_count, 0);
    }
}

/* Each byte damaged, and each byte missing: that frame is lost, and no other one. */
TEST_IN(streaming, a_damaged_frame_is_no_sample_and_costs_no_other_frame)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    for (unsigned at = 0; at != LENGTH; at++)
        for (unsigned is_missing = 0; is_missing != 2; is_missing++) {
            uint8_t bytes[LENGTH];
            const unsigned samples = rig.samples;
            memcpy(bytes, printed, LENGTH);
            if (is_missing != 0)
                memmove(bytes + at, bytes + at + 1, LENGTH - 1 - at);
            else
                bytes[at] ^= 0x81;
            PENDS(hears(bytes, LENGTH - is_missing));
            /* behind a missing byte the driver waits for one more */
            reads_mm(1200);
            assert_int_equal(rig.samples, samples + 1);
        }
    /* of the 13 bytes behind 0A 0D each made one damaged frame, and each missing one but 0A and 0D another */
    assert_int_equal(hps.damaged, 13 + 13);
}

/* A distance of 0A0D looks like the beginning of a frame. */
TEST_IN(streaming, a_beginning_inside_a_frame_is_none)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    for (unsigned i = 0; i != 20; i++) reads_mm(0x0A0D);
    PENDS(hears(printed + 1, LENGTH - 1)); /* out of step, with a frame that is full of them */
    for (unsigned i = 0; i != 20; i++) reads_mm(0x0A0D);
}

TEST_IN(streaming, lost_bytes_end_a_frame)
{
    const fathom_rx_t lost = {0, FATHOM_RX_OVERRUN};
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    nothing_for(2000);
    PENDS(hears(printed, 6));
    assert_int_equal(hps.held_count, 6);
    fake_receive_rx(&rig.fake, 0, printed + 6, LENGTH - 6, lost);
    nothing_for(OUTPUT_US);
    assert_int_equal(hps.held_count, 0);
    reads_mm(1200);
}

TEST_IN(streaming, of_several_frames_the_newest_is_returned_and_an_old_one_is_none)
{
    uint8_t frame[LENGTH];
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    for (uint16_t i = 0; i != 3; i++) {
        rig_hps167_frame(frame, (uint16_t)(1000 + i), 0xDCB2, 0x0701, 0x0000);
        fake_receive(&rig.fake, 0, frame, LENGTH);
    }
    assert_int_equal(next(STEP_US), FATHOM_OK);
    assert_int_equal(rig.sample.distance_mm, 1002);
    assert_int_equal(hps.missed, 2);
    fake_receive(&rig.fake, STEP_US, frame, LENGTH);
    rig.fake.now_us += STEP_US;
    assert_int_equal(fathom_line_poll(&rig.line), FATHOM_PENDING); /* another user polls the line */
    rig.fake.now_us += STALE_US + FATHOM_LINE_LATE_US + 1000;
    assert_int_equal(next(STEP_US), FATHOM_ERR_STALE);
    assert_int_equal(hps.missed, 3);
}

TEST_IN(streaming, values_that_cannot_be_are_refused_and_the_output_goes_on)
{
    sends(continuous);
    assert_int_equal(hears_mm(30001), FATHOM_ERR_MALFORMED);
    assert_int_equal(hears_mm(65530), FATHOM_OK);
    assert_int_equal(rig.sample.kind, FATHOM_NO_TARGET);
    assert_int_equal(rig.sample.sequence, 1);
    assert_int_equal(hps.implausible, 1);
}

/* The first frame is damaged, so the request has failed, but the sensor sends. */
TEST_IN(streaming, a_damaged_first_frame_is_an_error_once)
{
    uint8_t bytes[LENGTH];
    memcpy(bytes, printed, LENGTH);
    bytes[7] ^= 0x01;
    sends(continuous);
    receive(bytes, LENGTH);
    assert_int_equal(next(100000), FATHOM_ERR_CHECKSUM);
    for (unsigned i = 0; i != 100; i++) reads_mm(1700);
    assert_in_range(rig.fake.written, 1, 2);
    assert_int_equal(rig.samples, 100);
}

TEST_IN(streaming, a_broken_port_is_reported_until_it_works)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    rig.fake.read_fails = true;
    for (unsigned i = 0; i != 3; i++) assert_int_equal(next(STEP_US), FATHOM_ERR_PORT);
    rig.fake.read_fails = false;
    nothing_for(2000);
    reads_mm(1500);
}

TEST_IN(streaming, stop_ends_the_output_and_a_poll_starts_it_again)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    nothing_for(25000);
    sends_by(stop, stop_it);
    receive(printed, LENGTH); /* a frame that was under way */
    receive(acknowledged, sizeof acknowledged);
    assert_int_equal(next_of(stop, 10000), FATHOM_OK);
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
}

TEST_IN(streaming, a_temperature_is_read_between_frames)
{
    static const uint8_t degrees[] = {0x0A, 0x04, 0x0B, 0xB8, 0xE7, 0x26};
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    nothing_for(25000);
    sends_by(get_temperature, ask_temperature);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    receive(degrees, sizeof degrees);
    assert_int_equal(next_of(get_temperature, 10000), FATHOM_OK);
    assert_int_equal(temperature, 3000);
    reads_mm(1500);
}

TEST_IN(streaming, deinit_sends_the_stop_and_leaves_the_line)
{
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    fathom_hps167_uart_deinit(&hps);
    assert_int_equal(rig.fake.written, 2);
    was_written(1, stop_it);
    assert_null(rig.line.head);
    assert_null(rig.line.listener);
    memset(&hps, 0x5A, sizeof hps);
    for (unsigned i = 0; i != 100; i++, rig.fake.now_us += 100) fathom_line_poll(&rig.line);
}

/* Neither before the output has started, nor twice, nor if the port is busy. */
TEST_IN(streaming, deinit_without_an_output_sends_nothing)
{
    sends(continuous);
    fathom_hps167_uart_deinit(&hps);
    fathom_hps167_uart_deinit(&hps);
    assert_int_equal(rig.fake.written, 1);
    begin();
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    rig.fake.write_busy = true;
    fathom_hps167_uart_deinit(&hps);
    assert_int_equal(rig.fake.written, 2);
    assert_null(rig.line.head);
    assert_null(rig.line.listener);
}

TEST_IN(streaming, another_listener_is_busy)
{
    static fathom_hps167_uart_t other;
    assert_int_equal(fathom_hps167_uart_init(&other, &rig.line, &config), FATHOM_ERR_BUSY);
    assert_ptr_equal(rig.line.listener, &hps.listener);
    const fathom_sensor_t sensor = fathom_hps167_uart_sensor(&other);
    assert_int_equal(checked_poll(&sensor, &rig.sample), FATHOM_ERR_ARGUMENT);
    config.continuous = false; /* the same driver again, without a listener */
    begin();
    assert_null(rig.line.listener);
}

/* A program that sleeps for what due_us tells, or until a byte comes, loses nothing. */
TEST_IN(streaming, the_due_time_wakes_the_program_in_time)
{
    uint8_t frame[LENGTH];
    sends(continuous);
    assert_int_equal(hears(printed, LENGTH), FATHOM_OK);
    const uint32_t since_us = rig.fake.now_us;
    fathom_status_t status = FATHOM_PENDING;
    unsigned polls = 0;
    for (; status == FATHOM_PENDING; polls++) {
        assert_true(polls < 50);
        const uint32_t due_us = fathom_due_us(&rig.sensor, 1);
        assert_in_range(due_us, 1, STALE_US);
        rig.fake.now_us += due_us;
        status = rig_poll();
    }
    assert_int_equal(status, FATHOM_ERR_STALE);
    assert_in_range(rig.fake.now_us - since_us, STALE_US, STALE_US + 2000);
    rig_hps167_frame(frame, 1000, 0xDCB2, 0x0701, 0x0000);
    fake_receive(&rig.fake, 0, frame, LENGTH);
    fathom_line_poll(&rig.line);
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
}
