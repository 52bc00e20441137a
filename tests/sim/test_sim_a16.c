/* SPDX-License-Identifier: MIT */
#include "bench.h"
#include "sim/a16.h"
#include "sim/scene.h"

enum { MS = 1000 };

typedef struct {
    bench_t bench;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t a16;
} stage_t;

static void set(stage_t *stage, uint8_t mode, int32_t distance, fathom_sim_a16_config_t config)
{
    bench_init(&stage->bench, &bench_9600);
    stage->fixed.value[0] = distance;
    config.mode = mode;
    config.scene = fathom_sim_fixed(&stage->fixed);
    fathom_sim_a16_init(&stage->a16, &config);
    stage->bench.line.full_duplex = mode != FATHOM_SIM_A16_MODBUS;
    bench_attach(&stage->bench, &stage->a16.device);
}

#define DEFAULTS ((fathom_sim_a16_config_t){0})

static const suite_t suite = {BENCH_ROUNDS};

/* ---- automatic: A16 2, 5 ---- */

TEST(automatic_frame_is_that_of_a16_2_4)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_UART, 1953, DEFAULTS);
    bench_wait(&s.bench, 110 * MS);
    EXPECT(&s.bench, 0xFF, 0x07, 0xA1, 0xA7);
    set(&s, FATHOM_SIM_A16_AUTO, 1953, DEFAULTS); /* A16 5(4) */
    bench_wait(&s.bench, 110 * MS);
    EXPECT(&s.bench, 0xFF, 0x07, 0xA1, 0xA7);
}

TEST(automatic_frames_come_every_100_ms_byte_by_byte)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 1953, DEFAULTS);
    const uint32_t start_us = s.bench.now_us;
    for (int i = 0; i < 50; i++) bench_wait(&s.bench, 20 * MS); /* a loop that comes round every 20 ms */
    bench_wait(&s.bench, 5 * MS);
    assert_int_equal(s.bench.heard, 40);
    assert_int_equal(s.a16.device.counters.automatic, 10);
    for (size_t i = 0; i < 40; i++) {
        /* the first bit at n * 100 ms, then characters of 10 / 9600 s, each rounded up */
        const uint32_t byte_us[] = {1042, 2084, 3125, 4167};
        const uint32_t at_us = (uint32_t)(i / 4 + 1) * 100 * MS + byte_us[i % 4];
        assert_int_equal(fathom_elapsed_us(s.bench.end_us[i], start_us), at_us);
    }
}

TEST(a_byte_is_not_there_before_its_last_bit)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 1953, DEFAULTS);
    bench_wait(&s.bench, 100 * MS + 1041);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 1);
    EXPECT(&s.bench, 0xFF);
    assert_int_equal(fathom_sim_due_us(&s.bench.line, s.bench.now_us), 1042);
    bench_wait(&s.bench, 1041);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 1);
    EXPECT(&s.bench, 0x07);
}

TEST(the_period_and_the_start_are_options)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 511, (fathom_sim_a16_config_t){.period_us = 40 * MS, .start_us = 900 * MS});
    bench_wait(&s.bench, 940 * MS);
    EXPECT_SILENCE(&s.bench);
    bench_wait(&s.bench, 80 * MS + 5 * MS);
    EXPECT(&s.bench, 0xFF, 0x01, 0xFF, 0xFF, 0xFF, 0x01, 0xFF, 0xFF, 0xFF, 0x01, 0xFF, 0xFF);
}

TEST(no_target_and_interference_are_fffd_and_fffe)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, FATHOM_SIM_NO_TARGET, DEFAULTS);
    bench_wait(&s.bench, 110 * MS);
    EXPECT(&s.bench, 0xFF, 0xFF, 0xFD, 0xFB);
    s.fixed.value[0] = FATHOM_SIM_INTERFERENCE;
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, 0xFF, 0xFF, 0xFE, 0xFC);
    s.fixed.value[0] = 0; /* what older firmware says; any number can be said */
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, 0xFF, 0x00, 0x00, 0xFF);
    s.a16.device.scene.distance = NULL;
    bench_wait(&s.bench, 100 * MS);
    EXPECT(&s.bench, 0xFF, 0xFF, 0xFD, 0xFB);
}

/* ---- automatic, then Modbus: A16 5 ---- */

TEST(the_first_command_ends_automatic_output_with_frames_around_the_answer)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 751, DEFAULTS);
    bench_wait(&s.bench, 50 * MS);
    ASK(&s.bench, 300 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36); /* A16 6(4) example 2 */
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0,         /* at 100 ms, nobody stopped it yet */
           0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8, /* the answer, about 175 ms */
           0xFF, 0x02, 0xEF, 0xF0);                  /* at 200 ms, within the 150 ms */
    bench_wait(&s.bench, 60000 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(fathom_sim_due_us(&s.bench.line, s.bench.now_us), FATHOM_NO_DEADLINE);
}

TEST(without_lingering_the_command_is_the_end)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 751, (fathom_sim_a16_config_t){.linger_us = 1});
    bench_wait(&s.bench, 105 * MS);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0);
    ASK(&s.bench, 1000 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8);
}

TEST(a_command_is_heard_while_a_frame_leaves_on_two_wires_each_way)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 751, (fathom_sim_a16_config_t){.linger_us = 1});
    bench_wait(&s.bench, 95 * MS); /* the request lasts from 95 to 103.3 ms, the frame from 100 to 104.2 */
    ASK(&s.bench, 1000 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0, 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8);
}

TEST(only_a_command_for_it_ends_automatic_output)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 751, (fathom_sim_a16_config_t){.linger_us = 1});
    ASK(&s.bench, 10 * MS, 0x02, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x05); /* another unit's */
    ASK(&s.bench, 10 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x37); /* wrong CRC */
    bench_wait(&s.bench, 1000 * MS);
    assert_true(s.bench.heard >= 40);
    bench_forget(&s.bench);
    ASK(&s.bench, 10 * MS, 0x01, 0x03, 0x02, 0x02, 0x00, 0x01, 0x24, 0x72); /* not even a register */
    bench_forget(&s.bench);
    bench_wait(&s.bench, 1000 * MS);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.others, 1);
    assert_int_equal(s.a16.device.counters.crc_errors, 1);
    assert_int_equal(s.a16.device.counters.unserved, 1);
}

TEST(a_uart_module_takes_no_command)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_UART, 751, DEFAULTS);
    ASK(&s.bench, 10 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    bench_wait(&s.bench, 400 * MS);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0, 0xFF, 0x02, 0xEF, 0xF0, 0xFF, 0x02, 0xEF, 0xF0, 0xFF, 0x02, 0xEF,
           0xF0);
    assert_int_equal(s.a16.device.counters.unheard, 8);
    assert_int_equal(s.a16.device.counters.requests, 0);
}

TEST(power_makes_it_automatic_again)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_AUTO, 751, (fathom_sim_a16_config_t){.linger_us = 1});
    ASK(&s.bench, 500 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8);
    fathom_sim_detach(&s.bench.line, &s.a16.device, s.bench.now_us);
    fathom_sim_detach(&s.bench.line, &s.a16.device, s.bench.now_us); /* twice is no error */
    bench_wait(&s.bench, 500 * MS);
    EXPECT_SILENCE(&s.bench);
    bench_attach(&s.bench, &s.a16.device);
    bench_wait(&s.bench, 110 * MS);
    EXPECT(&s.bench, 0xFF, 0x02, 0xEF, 0xF0);
}

/* ---- Modbus: A16 6 ---- */

TEST(reads_are_those_of_a16_6_4)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 754, DEFAULTS);
    bench_wait(&s.bench, 10000 * MS);
    EXPECT_SILENCE(&s.bench);
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6); /* example 1, 0x0100 */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1);
    s.fixed.value[0] = 751;
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36); /* example 2, 0x0101 */
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x02, 0xEF, 0xF8, 0xA8);
    s.fixed.value[0] = FATHOM_SIM_NO_TARGET;
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0xFF, 0xFD, 0x38, 0x35);
    s.fixed.value[0] = FATHOM_SIM_INTERFERENCE;
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0xFF, 0xFE, 0x78, 0x34);
    assert_int_equal(s.a16.device.counters.requests, 4);
    assert_int_equal(s.a16.device.counters.answered, 4);
    assert_int_equal(s.a16.device.counters.measurements, 4);
}

TEST(settings_read_as_from_the_factory)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 754, DEFAULTS);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x02, 0x05, 0x00, 0x01, 0x95, 0xB3);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x02, 0x06, 0x00, 0x01, 0x65, 0xB3);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x03, 0xE8, 0xB8, 0xFA);
    ASK(&s.bench, 30 * MS, 0x01, 0x03, 0x02, 0x07, 0x00, 0x01, 0x34, 0x73);
    EXPECT(&s.bench, 0x01, 0x03, 0x02, 0x00, 0x00, 0xB8, 0x44);
    assert_int_equal(s.a16.device.counters.measurements, 0);
}

TEST(answers_take_their_time_and_the_seed_decides_which)
{
    stage_t s;
    uint32_t first_us[3][8];
    for (size_t run = 0; run < 3; run++) {
        set(&s, FATHOM_SIM_A16_MODBUS, 754, (fathom_sim_a16_config_t){.seed = run == 2 ? 99 : 7});
        for (size_t i = 0; i < 8; i++) {
            const uint32_t end_us = ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, (uint8_t)(i % 2), 0x00, 0x01,
                                        i % 2 == 0 ? 0x85 : 0xD4, i % 2 == 0 ? 0xF6 : 0x36);
            assert_int_equal(s.bench.heard, 7);
            /* from the last bit of the request to the last bit of the first byte */
            first_us[run][i] = fathom_elapsed_us(s.bench.end_us[0], end_us) - 1042;
            if (i % 2 == 0) assert_in_range(first_us[run][i], 455 * MS, 520 * MS);
            if (i % 2 == 1) assert_in_range(first_us[run][i], 105 * MS, 120 * MS);
            ASSERT_SPAN(s.bench.end_us[6], s.bench.end_us[0], 6249, 6251);
            bench_forget(&s.bench);
        }
    }
    assert_memory_equal(first_us[0], first_us[1], sizeof first_us[0]);
    assert_memory_not_equal(first_us[0], first_us[2], sizeof first_us[0]);
}

TEST(the_answer_times_are_options)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 754,
        (fathom_sim_a16_config_t){.realtime_us = 40 * MS, .processed_us = 1, .settings_us = 200 * MS});
    uint32_t end_us = ASK(&s.bench, 60 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 35 * MS + 1042, 40 * MS + 1042);
    bench_forget(&s.bench);
    /* never before it can know that the request has ended: t3.5 */
    end_us = ASK(&s.bench, 60 * MS, 0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 3646 + 1041, 3646 + 1042);
    bench_forget(&s.bench);
    end_us = ASK(&s.bench, 300 * MS, 0x01, 0x03, 0x02, 0x00, 0x00, 0x01, 0x85, 0xB2);
    ASSERT_SPAN(s.bench.end_us[0], end_us, 175 * MS + 1042, 200 * MS + 1042);
}

TEST(set_address_is_echoed_and_obeyed_a16_6_4_example_3)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, DEFAULTS);
    ASK(&s.bench, 50 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    EXPECT(&s.bench, 0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71);
    assert_int_equal(s.a16.device.counters.writes, 1);
    ASK(&s.bench, 300 * MS, 0x01, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD4, 0x36);
    EXPECT_SILENCE(&s.bench);
    ASK(&s.bench, 300 * MS, 0x05, 0x03, 0x01, 0x01, 0x00, 0x01, 0xD5, 0xB2);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x02, 0xEF, 0x09, 0x68);
    ASK(&s.bench, 50 * MS, 0x05, 0x03, 0x02, 0x00, 0x00, 0x01, 0x84, 0x36);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x00, 0x05, 0x89, 0x87);
}

TEST(address_ff_is_for_the_broadcast_and_cannot_be_set)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0x01, 0x06, 0x02, 0x00, 0x00, 0xFF, 0xC8, 0x32);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.unit, 1);
    assert_int_equal(s.a16.device.counters.writes, 0);
}

TEST(a_broadcast_is_obeyed_without_an_answer)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, DEFAULTS);
    ASK(&s.bench, 300 * MS, 0xFF, 0x06, 0x02, 0x00, 0x00, 0x05, 0x5D, 0xAF);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.unit, 5);
    assert_int_equal(s.a16.device.counters.writes, 1);
    ASK(&s.bench, 300 * MS, 0xFF, 0x03, 0x01, 0x01, 0x00, 0x01, 0xC1, 0xE8);
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.requests, 2);
    assert_int_equal(s.a16.device.counters.answered, 0);
}

TEST(a_broadcast_is_answered_from_its_own_address_as_an_option)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, (fathom_sim_a16_config_t){.unit = 5, .answers_broadcast = true});
    ASK(&s.bench, 300 * MS, 0xFF, 0x03, 0x01, 0x01, 0x00, 0x01, 0xC1, 0xE8);
    EXPECT(&s.bench, 0x05, 0x03, 0x02, 0x02, 0xEF, 0x09, 0x68);
}

TEST(what_it_does_not_know_is_silence)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, DEFAULTS);
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x02, 0x00, 0x01, 0x24, 0x36); /* unknown register */
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x01, 0x00, 0x00, 0x02, 0xC5, 0xF7); /* two at once */
    ASK(&s.bench, 600 * MS, 0x01, 0x03, 0x02, 0x02, 0x00, 0x01, 0x24, 0x72); /* write-only */
    ASK(&s.bench, 600 * MS, 0x01, 0x04, 0x01, 0x00, 0x00, 0x01, 0x30, 0x36); /* unknown function */
    EXPECT_SILENCE(&s.bench);
    assert_int_equal(s.a16.device.counters.requests, 4);
    assert_int_equal(s.a16.device.counters.unserved, 4);
}

TEST(exceptions_are_an_option)
{
    stage_t s;
    set(&s, FATHOM_SIM_A16_MODBUS, 751, (fathom_sim_a16_config_t){.exceptions = true});
    ASK(&s.bench, 100 * MS, 0x01, 0x03, 0x01, 0x02, 0x00, 0x01, 0x24, 0x36);
    EXPECT(&s.bench, 0x01, 0x83, 0x02, 0xC0, 0xF1);
    ASK(&s.bench, 100 * MS, 0x01, 0x03, 0x01, 0x00, 0x00, 0x02, 0xC5, 0xF7);
    EXPECT(&s.bench, 0x01, 0x83, 0x03, 0x01, 0x31);
    ASK(&s.bench, 100 * MS, 0x01, 0x04, 0x01, 0x00, 0x00, 0x01, 0x30, 0x36);
    EXPECT(&s.bench, 0x01, 0x84, 0x01, 0x82, 0xC0);
    assert_int_equal(s.a16.device.counters.exceptions, 3);
}
