/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "board.h"

/* examples/first/MODE.c on an ATmega328P: their text leaves at PB2, 9600 8N1, made by software. Not every mode runs here:
 * each kind of line and pin does. */
enum { LEVELS = 8192, TEXT = 512, BAUD = 9600, BITS = 8, PATIENCE_US = 3000000 };

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_a05_t a05;
static fathom_sim_hps167s_t hps;
static fathom_sim_pins_t pins;
static fathom_sim_fixed_t scene;

/* The levels of PB2 behind the line of text that was taken last. */
static board_edge_t levels[LEVELS];
static unsigned level_count;
static char text[TEXT];

static void changed(void *ctx, bool high)
{
    assert_true(level_count != LEVELS);
    levels[level_count++] = (board_edge_t){board.avr->cycle, high};
}

static bool level_at(double cycle)
{
    bool high = true;
    for (unsigned i = 0; i != level_count && (double)levels[i].cycle <= cycle; i++) high = levels[i].high;
    return high;
}

/* Forgets the levels before a time. */
static void forget(double cycle)
{
    unsigned first = 0;
    while (first != level_count && (double)levels[first].cycle < cycle) first++;
    level_count -= first;
    memmove(levels, &levels[first], level_count * sizeof levels[0]);
}

/* Takes a line of text, without its end. NULL: there is no whole line yet. */
static const char *take_line(void)
{
    const double bit = (double)BOARD_HZ / BAUD;
    unsigned length = 0;
    double next = 0;
    for (unsigned i = 0; i != level_count; i++) {
        if (levels[i].high || (double)levels[i].cycle < next) continue;
        const double start = (double)levels[i].cycle;
        if (start + 10 * bit > (double)board.avr->cycle) return NULL;
        unsigned byte = 0;
        for (int at = 0; at != BITS; at++) byte |= (unsigned)level_at(start + (1.5 + at) * bit) << at;
        assert_true(level_at(start + 9.5 * bit)); /* the stop bit */
        next = start + 9.5 * bit;
        if (byte == '\n') {
            text[length] = '\0';
            forget(next);
            return text;
        }
        assert_true(length != TEXT - 1);
        if (byte != '\r') text[length++] = (char)byte;
    }
    return NULL;
}

/* The next line of text; "": none came. */
static const char *next_line(void)
{
    for (uint32_t us = 0; us < PATIENCE_US; us += 5000) {
        const char *const taken = take_line();
        if (taken != NULL) return taken;
        if (!board_run_us(5000)) break;
    }
    return "";
}

static void start(const char *image, fathom_sim_device_t *device, bool full_duplex)
{
    level_count = 0;
    board_start(image);
    board_attach(&line, device, full_duplex);
    assert_non_null(board_watch('B', 2, true, changed, NULL));
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
