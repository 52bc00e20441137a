/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "console.h"

/* examples/first/MODE.c on an ATmega328P: their text leaves at PB2, 9600 8N1, made by software. Not every mode runs here:
 * each kind of line and pin does. */
enum { PATIENCE_US = 3000000 };

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_a05_t a05;
static fathom_sim_hps167s_t hps;
static fathom_sim_pins_t pins;
static fathom_sim_fixed_t scene;

static const char *next_line(void) { return console_line(PATIENCE_US); }

static void start(const char *image, fathom_sim_device_t *device, bool full_duplex)
{
    board_start(image);
    board_attach(&line, device, full_duplex);
    console_join('B', 2, 9600);
}

static void start_a16(const char *image, fathom_sim_a16_mode_t mode)
{
    scene.value[0] = 1234;
    fathom_sim_a16_init(
        &a16, &(fathom_sim_a16_config_t){.mode = mode, .scene = fathom_sim_fixed(&scene), .address = 1});
    start(image, &a16.device, mode != FATHOM_SIM_A16_MODBUS);
}

static const suite_t suite = {.tear_down = board_stop};

static void assert_twice(const char *expected)
{
    assert_string_equal(next_line(), expected);
    assert_string_equal(next_line(), expected);
}

TEST(a16_auto_prints_what_the_sensor_sends)
{
    start_a16("first_a16_auto", FATHOM_SIM_A16_UART);
    board_join_line(&line);
    assert_twice("1234 mm");
}

TEST(a16_controlled_triggers_by_a_break_of_the_line)
{
    start_a16("first_a16_controlled", FATHOM_SIM_A16_CONTROLLED);
    board_join_line(&line);
    assert_twice("1234 mm");
}

TEST(a16_modbus_asks_through_a_transceiver)
{
    start_a16("first_a16_modbus", FATHOM_SIM_A16_MODBUS);
    board_join_line(&line);
    board_join_driver('D', 2);
    assert_twice("1234 mm");
}

TEST(a16_pwm_prints_the_pulse)
{
    start_a16("first_a16_pwm", FATHOM_SIM_A16_PWM);
    fathom_sim_pins_init(&pins, &a16.device, &line, &board.clock);
    board_join_pins(&pins, "B1", "B0", NULL);
    assert_twice("1234 mm");
    scene.value[0] = FATHOM_SIM_NO_TARGET;
    (void)next_line(); /* of the pulse in progress */
    assert_twice("nothing in range");
}

TEST(a05_auto_prints_four_probes)
{
    static const char *const expected[] = {"1000 mm", "2000 mm", "1953 mm", "nothing in range"};
    memcpy(scene.value, (const int32_t[4]){1000, 2000, 1953, FATHOM_SIM_NO_TARGET}, sizeof scene.value);
    fathom_sim_a05_init(
        &a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&scene)});
    start("first_a05_auto", &a05.device, true);
    board_join_line(&line);
    for (unsigned i = 0; i != 8; i++) assert_string_equal(next_line(), expected[i % 4]);
}

TEST(hps167s_asks_through_a_transceiver_and_prints_an_error_when_it_is_silent)
{
    scene.value[0] = 2083;
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&scene)});
    start("first_hps167s", &hps.device, false);
    board_join_line(&line);
    board_join_driver('D', 2);
    assert_twice("2083 mm");
    board_sync();
    fathom_sim_detach(&line, &hps.device, board.clock.now_us);
    board_plan();
    (void)next_line(); /* of the request in progress */
    assert_twice("error -3: no response");
    assert_int_equal(board.cut_bytes, 0);
    assert_int_equal(board.talked_over, 0);
}
