/* SPDX-License-Identifier: MIT */
/* Every driver and every command of it against devices of which each has made its own choices: 1,000 of each kind. */
#include "second_lives.h"

#include <stdlib.h>

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
TEST(hps167) { live(SECOND_HPS167, life_hps167, 50); }
TEST(hps167_continuous) { live(SECOND_HPS167, life_hps167_continuous, 50); }
