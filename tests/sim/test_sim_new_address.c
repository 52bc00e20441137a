/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* Not in the datasheets, and known of sister models: an ultrasonic sensor whose address was just changed may
 * acknowledge that from the old address or from the new one. Either will do, since a reading at the new one decides.
 * The HPS-167S is in test_sim_hps167s_moves.c. */

enum { MS = 1000, SECOND = 1000000, OLD = 1, NEW = 5 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t fixed;
    fathom_sim_a16_t sim_a16;
    fathom_sim_a05_t sim_a05;
    fathom_uart_t uart;
    fathom_clock_t hal_clock;
    uint8_t frame[32];
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    fathom_a16_modbus_t a16;
    fathom_a05_modbus_t a05;
} stage_t;

static stage_t s;

static void set_up_line(void)
{
    memset(&s, 0, sizeof s);
    s.fixed = (fathom_sim_fixed_t){{1953, 1953, 1953, 1953}};
    fathom_sim_clock_init(&s.clock, bench_start_us, 0);
    fathom_sim_line_init(&s.wire, &bench_9600, bench_start_us);
    fathom_sim_uart_init(&s.port, &s.wire, &s.clock);
    s.uart = fathom_sim_uart(&s.port);
    s.hal_clock = fathom_sim_clock(&s.clock);
    s.config = (fathom_line_config_t){
        .uart = &s.uart, .clock = &s.hal_clock, .frame = s.frame, .frame_size = sizeof s.frame};
    assert_int_equal(fathom_line_init(&s.line, &s.config), FATHOM_READY);
    s.modbus = fathom_modbus_client(&s.line);
}

/* Time goes on until the driver needs it, or in a loop of 20 ms; false when it takes too long. */
static bool pass(const fathom_sensor_t *sensor, uint32_t loop_us, uint32_t since_us)
{
    if (loop_us != 0)
        fathom_sim_clock_advance(&s.clock, loop_us);
    else
        fathom_sim_clock_idle(&s.clock, fathom_due_us(sensor, 1));
    return fathom_elapsed_us(s.clock.now_us, since_us) < 20 * SECOND;
}

/* One reading at the new address, with the driver as the change has left it. */
static void assert_read_at_new(const fathom_sensor_t *sensor, uint32_t loop_us)
{
    fathom_sample_t sample;
    fathom_status_t status = fathom_poll(sensor, &sample);
    for (const uint32_t since_us = s.clock.now_us;
         status == FATHOM_PENDING && pass(sensor, loop_us, since_us);)
        status = fathom_poll(sensor, &sample);
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(sample.unit, NEW);
    assert_int_equal(sample.distance_mm, 1953);
}

/* Written once. An acknowledgement from the new address is taken for the late answer to the question whether somebody is
 * there, which was put to it before. */
static void assert_told(const fathom_sim_device_t *device, bool from_new)
{
    assert_int_equal(device->unit, NEW);
    assert_int_equal(device->counters.writes, 1);
    assert_int_equal(s.line.counters[FATHOM_LINE_LATE_ANSWERS], from_new);
    assert_int_equal(s.line.counters[FATHOM_LINE_STRAYS], 0);
}

static void an_a16_is_followed(bool from_new, uint32_t loop_us)
{
    fathom_status_t status = FATHOM_PENDING;
    set_up_line();
    const fathom_sim_a16_config_t sim = {.mode = FATHOM_SIM_A16_MODBUS,
                                         .scene = fathom_sim_fixed(&s.fixed),
                                         .unit = OLD,
                                         .answers_from_new = from_new};
    fathom_sim_a16_init(&s.sim_a16, &sim);
    fathom_sim_attach(&s.wire, &s.sim_a16.device, s.clock.now_us);
    const fathom_a16_modbus_config_t config = {.modbus = &s.modbus, .clock = &s.hal_clock};
    assert_int_equal(fathom_a16_modbus_init(&s.a16, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_a16_modbus_sensor(&s.a16);
    const uint32_t since_us = s.clock.now_us;
    do status = fathom_a16_set_address(&s.a16, NEW);
    while (status == FATHOM_PENDING && pass(&sensor, loop_us, since_us));
    assert_int_equal(status, FATHOM_READY);
    assert_told(&s.sim_a16.device, from_new);
    assert_read_at_new(&sensor, loop_us);
}

static void an_a05_is_followed(bool from_new, uint32_t loop_us)
{
    fathom_status_t status = FATHOM_PENDING;
    set_up_line();
    const fathom_sim_a05_config_t sim = {.mode = FATHOM_SIM_A05_MODBUS,
                                         .scene = fathom_sim_fixed(&s.fixed),
                                         .unit = OLD,
                                         .answers_from_new = from_new};
    fathom_sim_a05_init(&s.sim_a05, &sim);
    fathom_sim_attach(&s.wire, &s.sim_a05.device, s.clock.now_us);
    const fathom_a05_modbus_config_t config = {.modbus = &s.modbus, .clock = &s.hal_clock};
    assert_int_equal(fathom_a05_modbus_init(&s.a05, &config), FATHOM_READY);
    const fathom_sensor_t sensor = fathom_a05_modbus_sensor(&s.a05);
    const uint32_t since_us = s.clock.now_us;
    do status = fathom_a05_modbus_set_address(&s.a05, NEW);
    while (status == FATHOM_PENDING && pass(&sensor, loop_us, since_us));
    assert_int_equal(status, FATHOM_READY);
    assert_told(&s.sim_a05.device, from_new);
    assert_read_at_new(&sensor, loop_us);
}

static void either(void (*follow)(bool from_new, uint32_t loop_us))
{
    for (unsigned i = 0; i != 4; i++) follow(i / 2 == 1, i % 2 == 1 ? 20 * MS : 0);
}

TEST(an_a16_may_acknowledge_from_its_old_or_its_new_address) { either(an_a16_is_followed); }

TEST(an_a05_may_acknowledge_from_its_old_or_its_new_address) { either(an_a05_is_followed); }
