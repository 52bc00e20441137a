/* SPDX-License-Identifier: MIT */
/* Every driver and every command of it against devices of which each has made its own choices: 1,000 of each kind. */
#include "second_lives.h"

#include <stdlib.h>
#include <string.h>

#include "suite.h"

static rig_t rig;

static void live(second_kind_t kind, life_t life, unsigned good_of_100)
{
    const char *from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    uint64_t last = from != NULL ? seed : suite_is_long ? 1000 : 60; /* plain ctest takes half a minute */
    judge = (judge_t){.rig = &rig};
    for (; seed <= last; seed++) {
        second_config_t config = {.kind = kind,
                                  .seed = seed,
                                  .fitted = seed % 3 == 0 ? 0x0F : (uint8_t)(1 + seed % 15),
                                  .scene = {{1234, 1234, 1234, 1234}}};
        rig_open(&rig, &config);
        life(&rig);
        if (rig.to_all > 0) judge.wrong++;
        assert_int_equal(second_state(&rig.device).lost, 0);
        if (from != NULL) second_print_choices(&rig.device, stdout);
    }
    judge_end(good_of_100);
}

#define IS_SEEN(...)                                                                                         \
    do {                                                                                                     \
        judge_begin("what is false");                                                                        \
        judge.wrong = 0;                                                                                     \
        __VA_ARGS__;                                                                                         \
        assert_true(judge.wrong > 0);                                                                        \
    } while (0)

TEST(the_judge_sees_a_wrong_reading_and_false_statements)
{
    const second_config_t config = {.kind = SECOND_A16_RS485, .scene = {{1234, 0, 0, 0}}};
    const fathom_sample_t never_sent = {.kind = FATHOM_TARGET, .distance_mm = 1234, .raw = 1234, .probe = 1};
    judge = (judge_t){.rig = &rig};
    rig_open(&rig, &config);
    IS_SEEN(judge_sample(&never_sent));
    IS_SEEN(judge_set(FATHOM_OK, false, HOLDS(0x0206, 2000)));             /* "unchanged": it has 1000 */
    IS_SEEN(judge_set(FATHOM_OK, true, HOLDS(0x0206, 1000)));              /* "written" */
    IS_SEEN(judge_set(FATHOM_ERR_UNCONFIRMED, true, HOLDS(0x0206, 2000))); /* "it was sent" */
    IS_SEEN(judge_set(FATHOM_ERR_DIFFERS, true, HOLDS(0x0206, 2000)));
    IS_SEEN(judge_read(FATHOM_OK, false));
    rig_power(&rig, true);
    rig_wait(&rig, 5000000);
    IS_SEEN(judge_read(FATHOM_ERR_EXCEPTION, true));   /* it has refused nothing, ... */
    IS_SEEN(judge_read(FATHOM_ERR_NO_RESPONSE, true)); /* ... and was asked nothing */
}

/*
 * The host sleeps at any moment of a request or frame, for 1.6 to 300 s, and the target moves meanwhile. Each reading
 * after that is one that the device sent at the time that the reading states: the judge knows no other. A sleep that is
 * no longer than the time-out and FATHOM_LINE_LATE_US, here up to 1.5 s, would only make that time less exact (line.h).
 */
static void sleeps(second_kind_t kind, fathom_sensor_t (*begin)(rig_t *rig))
{
    enum { ROUNDS = 6, POLLS = 20000, READINGS = 3 };
    static const uint32_t sleeps_us[ROUNDS] = {2600000, 1600000, 20000000, 1700000, 300000000, 5000000};
    unsigned readings = 0;
    judge = (judge_t){.rig = &rig};
    for (uint64_t seed = 0; seed != 12; seed++) {
        const second_config_t config = {
            .kind = kind, .seed = seed, .fitted = 0x0F, .scene = {{1234, 1234, 1234, 1234}}};
        rig_open(&rig, &config);
        rig_power(&rig, true);
        const fathom_sensor_t sensor = begin(&rig);
        judge_begin("a host that sleeps");
        for (unsigned round = 0; round != ROUNDS; round++) {
            unsigned left = READINGS;
            for (unsigned polls = 0; polls != POLLS && left != 0; polls++) {
                fathom_sample_t sample;
                if (fathom_poll(&sensor, &sample) != FATHOM_OK) {
                    rig_pass(&rig, fathom_due_us(&sensor, 1));
                    continue;
                }
                judge_sample(&sample);
                readings++;
                left--;
            }
            for (uint64_t polls = 0; polls != seed * 3 + round;
                 polls++) { /* into the next request or frame */
                fathom_sample_t sample;
                if (fathom_poll(&sensor, &sample) == FATHOM_OK) judge_sample(&sample);
                rig_pass(&rig, 1000);
            }
            /* The other probes of a response that was received: their time is that of the response. */
            for (fathom_sample_t sample; fathom_poll(&sensor, &sample) == FATHOM_OK;) judge_sample(&sample);
            rig_sleep(&rig, sleeps_us[round]);
            rig_scene(&rig, 800 + 100 * (int32_t)round, 900, 1000, 1100);
        }
    }
    assert_int_equal(judge.wrong, 0);
    assert_true(readings > 12 * ROUNDS); /* and it works again after each sleep */
}

static fathom_sensor_t begin_a16_modbus(rig_t *on)
{
    static fathom_a16_modbus_t sensor;
    memset(&sensor, 0, sizeof sensor);
    (void)fathom_a16_modbus_init(&sensor, &on->modbus, NULL);
    return fathom_a16_modbus_sensor(&sensor);
}

static fathom_sensor_t begin_a05_dyp(rig_t *on)
{
    static fathom_a05_dyp_t sensor;
    memset(&sensor, 0, sizeof sensor);
    (void)fathom_a05_dyp_init(&sensor, &on->line, NULL);
    return fathom_a05_dyp_sensor(&sensor);
}

static fathom_sensor_t begin_hps167s(rig_t *on)
{
    static fathom_hps167s_t sensor;
    memset(&sensor, 0, sizeof sensor);
    (void)fathom_hps167s_init(&sensor, &on->modbus, NULL);
    return fathom_hps167s_sensor(&sensor);
}

TEST(a16_rs485_gives_a_host_that_sleeps_no_old_reading) { sleeps(SECOND_A16_RS485, begin_a16_modbus); }
TEST(a05_dyp_gives_a_host_that_sleeps_no_old_reading) { sleeps(SECOND_A05_RS485, begin_a05_dyp); }
TEST(hps167s_gives_a_host_that_sleeps_no_old_reading) { sleeps(SECOND_HPS167S, begin_hps167s); }

/*
 * Another master reads the threshold of the switch, 1000 mm, of the same unit: a response of the shape of a measurement.
 * 01 03 02 06 00 01 and its CRC 65 B3. No target is at 1000 mm.
 */
TEST(a16_rs485_gives_no_response_to_another_master)
{
    static const uint8_t foreign[] = {0x01, 0x03, 0x02, 0x06, 0x00, 0x01, 0x65, 0xB3};
    enum { READINGS = 100, POLLS = 400000 };
    judge = (judge_t){.rig = &rig};
    unsigned others = 0;
    for (uint64_t seed = 0; seed != 12; seed++) {
        const second_config_t config = {
            .kind = SECOND_A16_RS485, .seed = seed, .fitted = 1, .scene = {{1234, 1234, 1234, 1234}}};
        rig_open(&rig, &config);
        rig_power(&rig, true);
        const fathom_sensor_t sensor = begin_a16_modbus(&rig);
        judge_begin("another master");
        uint64_t next_us = rig.now_us + 200000;
        unsigned left = READINGS;
        for (unsigned polls = 0; polls != POLLS && left != 0; polls++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensor, &sample);
            if (status == FATHOM_OK) judge_sample(&sample);
            if (status == FATHOM_ERR_OTHER_MASTER) others++;
            if (status != FATHOM_PENDING) left--;
            rig_pass(&rig, 1000);
            if (rig.now_us < next_us) continue;
            rig_foreign_request(&rig, foreign, sizeof foreign);
            next_us = rig.now_us + 150000 + 37000 * (seed % 5);
        }
        assert_int_equal(left, 0);
    }
    assert_int_equal(judge.wrong, 0);
    assert_true(others != 0);
}

TEST(a16_auto) { live(SECOND_A16_AUTO, life_a16_auto, 85); }
TEST(a16_controlled) { live(SECOND_A16_CONTROLLED, life_a16_controlled, 65); }
TEST(a16_pwm) { live(SECOND_A16_PWM, life_a16_pwm, 90); }
TEST(a16_switch) { live(SECOND_A16_SWITCH, life_a16_switch, 100); }
TEST(a05_relay) { live(SECOND_A05_RELAY, life_a05_relay, 100); }
TEST(a16_rs232) { live(SECOND_A16_RS232, life_a16_rs232, 80); }
TEST(a16_rs485) { live(SECOND_A16_RS485, life_a16_rs485, 65); }
TEST(a05_uart) { live(SECOND_A05_UART, life_a05_uart, 75); }
TEST(a05_rs485) { live(SECOND_A05_RS485, life_a05_rs485, 70); }
TEST(a05_dyp) { live(SECOND_A05_RS485, life_a05_dyp, 75); }
TEST(hps167s) { live(SECOND_HPS167S, life_hps167s, 40); }
TEST(hps167s_auto) { live(SECOND_HPS167S, life_hps167s_auto, 45); }
