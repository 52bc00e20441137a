/* SPDX-License-Identifier: MIT */
/* Every driver and every command of it against devices of which each has made its own choices: 1,000 of each kind. */
#include "second_lives.h"

#include <stdlib.h>

#include "suite.h"

static rig_t rig;

static void live(second_kind_t kind, life_t life)
{
    const char *from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    uint64_t last = from != NULL ? seed : suite_is_long ? 1000 : 100;
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
    judge_end(50);
}

TEST(a16_auto) { live(SECOND_A16_AUTO, life_a16_auto); }
TEST(a16_controlled) { live(SECOND_A16_CONTROLLED, life_a16_controlled); }
TEST(a16_pwm) { live(SECOND_A16_PWM, life_a16_pwm); }
TEST(a16_switch) { live(SECOND_A16_SWITCH, life_a16_switch); }
TEST(a05_relay) { live(SECOND_A05_RELAY, life_a05_relay); }
TEST(a16_rs232) { live(SECOND_A16_RS232, life_a16_rs232); }
TEST(a16_rs485) { live(SECOND_A16_RS485, life_a16_rs485); }
TEST(a05_uart) { live(SECOND_A05_UART, life_a05_uart); }
TEST(a05_rs485) { live(SECOND_A05_RS485, life_a05_rs485); }
TEST(a05_dyp) { live(SECOND_A05_RS485, life_a05_dyp); }
TEST(hps167s) { live(SECOND_HPS167S, life_hps167s); }
TEST(hps167s_auto) { live(SECOND_HPS167S, life_hps167s_auto); }
