/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "suite.h"

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/sim.h"
#include "sim/uart.h"

/* What the README's programs call, and what a port provides. */
static fathom_uart_t my_uart;
static fathom_clock_t my_clock;
static fathom_status_t begin(fathom_line_t *line);
static int other_work(void);
static void use(const fathom_sample_t *sample);
void read_three_sensors(fathom_line_t *a16, fathom_line_t *a05, fathom_line_t *hps);

#include "readme_example.c" /* cut out of README.md by support/cut.py */

/* What the simulated sensors see. */
enum { A16_MM = 1953, HPS167S_MM = 2083, SAMPLES = 32 };
static const uint16_t a05_mm[4] = {1000, 2000, 1953, 3562};

static fathom_sim_clock_t sim_clock;
static unsigned heard[4][4]; /* by model and probe */
static unsigned samples;

static int other_work(void)
{
    fathom_sim_clock_advance(&sim_clock, 1000); /* a loop of a millisecond */
    return samples < SAMPLES && sim_clock.now_us < 5000000;
}

static void use(const fathom_sample_t *sample)
{
    samples++;
    assert_int_equal(sample->kind, FATHOM_TARGET);
    assert_in_range(sample->model, FATHOM_A16, FATHOM_HPS167S);
    assert_in_range(sample->probe, 1, 4);
    heard[sample->model][sample->probe - 1]++;
    if (sample->model == FATHOM_A16) assert_int_equal(sample->distance_mm, A16_MM);
    if (sample->model == FATHOM_A05) assert_int_equal(sample->distance_mm, a05_mm[sample->probe - 1]);
    if (sample->model == FATHOM_HPS167S) {
        assert_int_equal(sample->distance_mm, HPS167S_MM);
        assert_int_equal(sample->magnitude, 7231744); /* the datasheet's example of #5: 723.1744 */
    }
}

/* A line of the application, its HAL, and the simulated wire behind it. */
typedef struct {
    fathom_sim_line_t wire;
    fathom_sim_uart_t sim;
    fathom_uart_t uart;
    uint8_t frame[32];
    fathom_line_config_t config;
    fathom_line_t line;
} desk_t;

static desk_t desks[3];

static fathom_line_t *desk(desk_t *desk, uint32_t baud, uint8_t parity, fathom_sim_device_t *device,
                           const fathom_clock_t *clock)
{
    const fathom_line_settings_t settings = {baud, parity, 1};
    fathom_sim_line_init(&desk->wire, &settings, sim_clock.now_us);
    fathom_sim_uart_init(&desk->sim, &desk->wire, &sim_clock);
    fathom_sim_attach(&desk->wire, device, sim_clock.now_us);
    desk->uart = fathom_sim_uart(&desk->sim);
    desk->config = (fathom_line_config_t){.uart = &desk->uart,
                                          .clock = clock,
                                          .frame = desk->frame,
                                          .frame_size = sizeof desk->frame,
                                          .find_echo = fathom_line_find_echo,
                                          .marks = fathom_line_marks,
                                          .silence_us = FATHOM_T3_5_US(19200, 11)};
    assert_int_equal(fathom_line_init(&desk->line, &desk->config), FATHOM_READY);
    return &desk->line;
}

TEST(the_program_of_the_readme_reads_three_sensors)
{
    fathom_sim_fixed_t a16_scene = {{A16_MM}};
    fathom_sim_fixed_t a05_scene = {{a05_mm[0], a05_mm[1], a05_mm[2], a05_mm[3]}};
    fathom_sim_fixed_t hps_scene = {{HPS167S_MM}};
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps;
    fathom_sim_a16_init(
        &a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_AUTO, .scene = fathom_sim_fixed(&a16_scene)});
    fathom_sim_a05_init(
        &a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&a05_scene)});
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&hps_scene)});
    fathom_sim_clock_init(&sim_clock, 0, 0);
    const fathom_clock_t clock = fathom_sim_clock(&sim_clock);

    read_three_sensors(desk(&desks[0], 9600, FATHOM_PARITY_NONE, &a16.device, &clock),
                       desk(&desks[1], 9600, FATHOM_PARITY_NONE, &a05.device, &clock),
                       desk(&desks[2], 19200, FATHOM_PARITY_EVEN, &hps.device, &clock));

    assert_true(heard[FATHOM_A16][0] >= 1);
    for (int probe = 0; probe != 4; probe++) assert_true(heard[FATHOM_A05][probe] >= 1);
    assert_true(heard[FATHOM_HPS167S][0] >= 10);
}

/* The line as it is printed, which says what it has to of echo. */
TEST(the_line_of_the_readme_sets_a_register)
{
    static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    fathom_sim_fixed_t scene = {{HPS167S_MM}};
    fathom_sim_line_t wire;
    fathom_sim_uart_t end;
    fathom_sim_hps167s_t device;
    fathom_line_t line;
    fathom_hps167s_t gate;
    fathom_status_t status;
    fathom_sim_clock_init(&sim_clock, 0, 0);
    fathom_sim_line_init(&wire, &settings, sim_clock.now_us);
    fathom_sim_uart_init(&end, &wire, &sim_clock);
    fathom_sim_hps167s_init(&device, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&scene)});
    fathom_sim_attach(&wire, &device.device, sim_clock.now_us);
    my_uart = fathom_sim_uart(&end);
    my_clock = fathom_sim_clock(&sim_clock);

    assert_int_equal(begin(&line), FATHOM_READY);
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    const fathom_hps167s_config_t gate_config = {.modbus.transport = &modbus};
    assert_int_equal(fathom_hps167s_init(&gate, &gate_config), FATHOM_READY);
    while ((status = fathom_hps167s_set_warm_up_s(&gate, 9)) == FATHOM_PENDING)
        fathom_sim_clock_advance(&sim_clock, 1000);
    assert_int_equal(status, FATHOM_READY);
    assert_true(fathom_hps167s_is_written(&gate));
    assert_int_equal(device.device.counters.writes, 1);
}
