/* SPDX-License-Identifier: MIT */
/* The sketches for sensors on RS485 beside the HPS-167S, and for contacts. */
#include "suite.h"

#include "console.h"

enum { A_SECOND_US = 1000000 };

static struct {
    fathom_sim_line_t line;
    fathom_sim_a05_t a05;
    fathom_sim_a16_t a16;
    fathom_sim_fixed_t scene;
} bench;

static const suite_t suite = {.tear_down = board_stop};

static void begin(const char *image, fathom_sim_device_t *device)
{
    board_start(image);
    board_attach(&bench.line, device, false);
    board_join_line(&bench.line);
    board_join_driver('D', 2);
    console_join('B', 3, 115200); /* pin 11 */
}

static void begin_a05(const char *image, uint8_t mode)
{
    memset(&bench, 0, sizeof bench);
    bench.scene = (fathom_sim_fixed_t){{1000, 2000, 1953, 3562}};
    fathom_sim_a05_init(&bench.a05,
                        &(fathom_sim_a05_config_t){.mode = mode, .scene = fathom_sim_fixed(&bench.scene)});
    begin(image, &bench.a05.device);
}

/* Each of the four, again and again. */
static void expect_four(void)
{
    for (int round = 0; round != 3; round++) {
        assert_string_equal(console_line(2 * A_SECOND_US), "1: 1000");
        assert_string_equal(console_line(A_SECOND_US), "2: 2000");
        assert_string_equal(console_line(A_SECOND_US), "3: 1953");
        assert_string_equal(console_line(A_SECOND_US), "4: 3562");
    }
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
    fathom_sim_detach(&bench.line, &bench.a05.device, board.clock.now_us);
    board_plan();
    const char *line;
    do line = console_line(2 * A_SECOND_US);
    while (*line >= '1' && *line <= '4');
    assert_string_equal(line, "0: NO_RESPONSE");
}

TEST(an_a05_is_asked_by_modbus)
{
    begin_a05("a05_modbus", FATHOM_SIM_A05_MODBUS);
    expect_four();
}

TEST(an_a05_is_asked_by_55_aa)
{
    begin_a05("a05_dyp", FATHOM_SIM_A05_DYP);
    expect_four();
}

TEST(an_a16_is_asked_by_modbus)
{
    memset(&bench, 0, sizeof bench);
    bench.scene.value[0] = 1953;
    fathom_sim_a16_init(&bench.a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_MODBUS,
                                                               .scene = fathom_sim_fixed(&bench.scene)});
    begin("a16_modbus", &bench.a16.device);
    for (int n = 0; n != 5; n++) assert_string_equal(console_line(2 * A_SECOND_US), "1953");
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
}

/* A contact is printed when it changes, and once a second. */
static void expect_states(const char *image, bool near)
{
    board_start(image);
    for (int n = 0; n != 6; n++) {
        const bool is_near = n % 3 != 0;
        board_drive('D', 4, is_near == near);
        assert_string_equal(board_line(3 * A_SECOND_US / 2), is_near ? "NEAR" : "FAR");
    }
}

TEST(a_switch_is_near_or_far) { expect_states("a16_switch", true); } /* A16 4(2): high is less than 1 m */

TEST(a_relay_is_near_or_far) { expect_states("a05_relay", false); } /* closed to ground: near */
