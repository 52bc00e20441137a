/* SPDX-License-Identifier: MIT */
/* What the HPS-167S does unasked, while it warms up, and without data from inside: all of them options. */
#include "sim_bench.h"

/* The response to #5 of the datasheet's example, the abnormal packet, and an exception to 03. */
#define EXAMPLE    "01 03 08 08 23 DC B2 07 01 00 00 FD 41"
#define ABNORMAL   "01 03 08 FF FF 00 00 00 FF FF FF E4 5C"
#define EXCEPTION  "01 83 04 40 F3"
#define MEASURE    "01 03 00 08 00 04 C5 CB"
#define READ_2     "01 03 00 02 00 04 E5 C9"
#define RESPONSE_2 "01 03 08 FF FF 00 00 00 00 B4 01 63 1C"
enum { FRAME = 13, CHARACTER_US = 573, SILENCE_US = 2005 }; /* 11 bits, and 3.5 of them, at 19200 */

static void lose(bool lost) { fathom_sim_hps167s_lose(&bench.hps, lost, bench.now_us); }

static const suite_t suite = {BENCH_ROUNDS};

/* ---- unasked: "continuous output" (#10, #15) ---- */

TEST(it_sends_by_itself_as_an_option)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS});
    const uint32_t start_us = bench.now_us;
    for (int i = 0; i < 51; i++) wait_ms(20); /* a loop that comes round every 20 ms */
    assert_int_equal(bench.heard, 10 * FRAME);
    for (size_t i = 0; i < 10; i++) {
        assert_true(is_hex(bench.bytes + FRAME * i, EXAMPLE));
        assert_int_equal(fathom_elapsed_us(bench.end_us[FRAME * i], start_us),
                         (i + 1) * 100 * MS + CHARACTER_US);
    }
    COUNTED(.automatic = 10, .answered = NONE, .measurements = 10);
}

TEST(it_fills_the_line_with_54_frames_a_second)
{
    set_hps(2083, (hps_config_t){.unasked_us = 18519});
    for (int i = 0; i < 51; i++) wait_ms(20);
    COUNTED(.automatic = 55); /* 1020 / 18.519 */
    assert_in_range(bench.heard, 54 * FRAME, 55 * FRAME);
}

TEST(what_it_sends_is_the_scene)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS, .address = 2});
    hear(110, "02 03 08 08 23 DC B2 07 01 00 00 F2 05");
    bench.fixed.value[0] = FATHOM_SIM_FAULT;
    hear(100, "02 03 08 FF FF 00 00 00 FF FF FF EB 18");
}

/* Asked at every time within a period. Returns true when the response came, and not only a frame. */
static bool asked_at(uint32_t at_us)
{
    size_t frames = 0, responses = 0, i = 0;
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS, .seed = at_us});
    wait_us(at_us);
    ask(READ_2, 60);
    while (i + FRAME <= bench.heard) {
        const bool is_frame = is_hex(bench.bytes + i, EXAMPLE);
        const bool is_response = is_hex(bench.bytes + i, RESPONSE_2);
        if (i != 0)
            assert_true(fathom_elapsed_us(bench.end_us[i], bench.end_us[i - 1]) >=
                        SILENCE_US + CHARACTER_US - 1);
        frames += is_frame;
        responses += is_response;
        i += FRAME;
    }
    /* one that collides with the request reaches the host garbled, and the request does not reach the device */
    assert_int_equal(i, bench.heard);
    if (bench.line.counters.collisions == 0) {
        assert_int_equal((frames + responses) * FRAME, bench.heard);
        assert_int_equal(responses, bench.hps.device.counters.answered);
    }
    return responses != 0;
}

TEST(it_answers_while_it_sends_by_itself)
{
    uint32_t answered = 0, beside = 0, collided = 0, tried = 0;
    /* the request lasts 4.6 ms, the response begins 4.2 to 4.5 ms behind it, and frames come at 100 and 200 ms */
    for (uint32_t at_us = 80 * MS; at_us < 120 * MS; at_us += 250) {
        const bool came = asked_at(at_us);
        tried++;
        answered += came;
        beside += came && bench.heard == 2 * FRAME;
        collided += bench.line.counters.collisions != 0;
        assert_true(came || bench.hps.device.counters.unheard + bench.hps.device.counters.truncated != 0);
    }
    assert_int_equal(tried, 160);
    assert_true(answered > 100);
    assert_true(beside > 50);
    /* a frame begins within the request in 18 of the 160, the request within a frame in 30 */
    assert_in_range(collided, 40, 52);
    assert_int_equal(answered + collided, tried);
}

TEST(a_measurement_that_is_asked_for_is_not_sent_unasked_as_well)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS});
    wait_ms(98); /* the request ends at 102.6 ms, when a frame is on the wire */
    hear(11, EXAMPLE);
    transact(MEASURE, 30, EXAMPLE); /* 109 to 113.6 ms; the next is ready at 118.5 */
    ASSERT_ANSWERED_IN(118519 - 113584 + CHARACTER_US - 1, 118519 - 113584 + CHARACTER_US + 1);
}

TEST(without_continuous_measuring_it_is_silent)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS, .no_auto_output = true});
    hear(1000, "");
    echoed("01 06 00 12 00 FF 69 8F", 30);
    hear(1000, "");
    cycle_power(0, 0); /* from the next power-on */
    hear(250, EXAMPLE EXAMPLE);
    ask("01 06 00 12 00 00 29 CF", 20);
    forget();
    hear(100, EXAMPLE);
    cycle_power(0, 0);
    hear(1000, "");
}

TEST(a_frame_between_a_new_rate_and_its_acknowledgement_has_the_old_one)
{
    uint32_t between = 0;
    for (uint32_t at_us = 90 * MS; at_us < 95300; at_us += 100) {
        set_hps(2083, (hps_config_t){.unasked_us = 100 * MS});
        wait_us(at_us);
        ask("01 06 00 11 00 03 99 CE", 30);
        if (bench.bytes[1] == 0x06) { /* the acknowledgement came first: then the frame is at the new rate */
            assert_true(is_hex(bench.bytes, "01 06 00 11 00 03 99 CE"));
            assert_false(is_hex(bench.bytes + 8, "01 03"));
            continue;
        }
        between++;
        expect(EXAMPLE "01 06 00 11 00 03 99 CE");
        wait_ms(100);
        assert_int_not_equal(bench.bytes[0], 0x01); /* garbled: it is at 115200 */
    }
    assert_true(between > 10);
}

TEST(a_fault_sends_one_more_of_them_before_the_first_request)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS});
    set_faults(1);
    FAULT(UNASKED, ALWAYS, 2);
    assert_true(fathom_sim_fault_applies(FATHOM_SIM_FAULT_EXCEPTION, &bench.hps.device));
    hear(350, EXAMPLE EXAMPLE EXAMPLE EXAMPLE);
    assert_int_equal(bench.fault.counters[FATHOM_SIM_FAULT_UNASKED], 1);
    assert_int_equal(bench.fault.frames, 3);
}

/* ---- warm-up: "the sensor will not output measurement data" (#7) ---- */

TEST(the_warm_up_is_silence_an_exception_or_the_abnormal_packet)
{
    for (uint8_t says = 0; says <= FATHOM_SIM_HPS167S_ABNORMAL; says++) {
        set_hps(2083, (hps_config_t){.warm_up_s = 5, .warm_up_says = says});
        for (int i = 0; i < 2; i++) {
            ask(MEASURE, 30);
            if (says == FATHOM_SIM_HPS167S_SILENCE) expect("");
            if (says == FATHOM_SIM_HPS167S_EXCEPTION) expect(EXCEPTION);
            if (says == FATHOM_SIM_HPS167S_ABNORMAL) expect(ABNORMAL);
            transact("01 03 00 04 00 01 C5 CB", 30, "01 03 02 00 4D 78 71"); /* the rest is answered */
            wait_ms(4700);
        }
        COUNTED(.measurements = NONE);
        wait_ms(200);
        transact(MEASURE, 30, EXAMPLE);
        fathom_sim_power_cycle(&bench.line, &bench.hps.device, 100 * MS, bench.now_us);
        wait_ms(5000); /* 4.9 s after power came: it is kept */
        ask(MEASURE, 30);
        COUNTED(.measurements = 1);
        wait_ms(100);
        forget();
        transact(MEASURE, 30, EXAMPLE);
    }
}

TEST(unasked_frames_wait_for_the_end_of_the_warm_up_or_are_abnormal_till_then)
{
    for (uint8_t says = 0; says <= FATHOM_SIM_HPS167S_ABNORMAL; says++) {
        set_hps(2083, (hps_config_t){.warm_up_s = 1, .warm_up_says = says, .unasked_us = 300 * MS});
        wait_ms(1100);
        if (says == FATHOM_SIM_HPS167S_ABNORMAL)
            expect(ABNORMAL ABNORMAL ABNORMAL);
        else
            expect("");
        hear(200, EXAMPLE);
    }
}

/* ---- no data: #15 ---- */

TEST(without_data_it_is_silent_for_the_reconnect_time_and_abnormal_then)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS, .reconnect_ms = 360});
    hear(150, EXAMPLE);
    lose(true); /* until 510 ms */
    hear(400, "");
    hear(200, ABNORMAL ABNORMAL); /* 600 and 700 ms */
    COUNTED(.measurements = 1);
    lose(false);
    hear(100, EXAMPLE);
    lose(true); /* for less than the reconnect time: no harm */
    wait_ms(200);
    lose(false);
    expect("");
    hear(100, EXAMPLE);
}

TEST(a_request_without_data_waits_for_the_reconnect_time)
{
    set_hps(2083, (hps_config_t){.reconnect_ms = 360});
    wait_ms(150);
    const uint32_t lost_us = bench.now_us;
    lose(true);
    wait_ms(100);
    ask(MEASURE, 300);
    ASSERT_SPAN(bench.end_us[0], lost_us, 360 * MS + CHARACTER_US - 1, 360 * MS + CHARACTER_US + 1);
    expect(ABNORMAL);
    ask(MEASURE, 30);
    ASSERT_ANSWERED_IN(2187 + CHARACTER_US - 1, 2500 + CHARACTER_US);
    expect(ABNORMAL);
    transact(READ_2, 30,
             "01 03 08 FF FF 00 00 00 01 68 01 6A 1C"); /* the interface itself is well; 360 is 0x168 */
    /* power begins the time anew */
    cycle_power(0, 0);
    const uint32_t power_us = bench.now_us;
    ask(MEASURE, 400);
    ASSERT_SPAN(bench.end_us[0], power_us, 360 * MS + CHARACTER_US - 1, 360 * MS + CHARACTER_US + 1);
    expect(ABNORMAL);
    lose(false);
    transact(MEASURE, 30, EXAMPLE);
}

TEST(a_reconnect_time_that_was_set_counts_and_half_an_hour_is_the_most)
{
    set_hps(2083, (hps_config_t){.unasked_us = 100 * MS});
    transact("01 10 00 20 00 02 04 FF FF FF FC B0 22", 30,
             "01 10 00 20 00 02 40 02"); /* the largest multiple of 18 */
    lose(true);
    wait_us(UINT32_C(1790000000));
    expect("");
    wait_us(UINT32_C(11000000));
    assert_true(bench.heard >= FRAME);
    forget();
    hear(100, ABNORMAL);
}

TEST(without_data_a_single_measurement_is_abnormal_after_its_time)
{
    set_hps(2083, (hps_config_t){.no_auto_output = true});
    lose(true);
    ask(MEASURE, 50);
    ASSERT_ANSWERED_IN(18519 + CHARACTER_US - 1, 18519 + CHARACTER_US);
    expect(ABNORMAL);
}
