/* SPDX-License-Identifier: MIT */
#include "bench.h"

#include <string.h>

#include "fathom/a05_auto.h"
#include "sim/a05.h"
#include "sim/pin.h"
#include "sim/scene.h"
#include "sim/uart.h"

/* A05 1(1), end to end: the driver holds RX low when the sensor gets power, by a pin or by a break of the line, and the
 * sensor sends real-time values from then on. */

enum { MS = 1000, REAL_TIME_MM = 1000, PROCESSED_MM = 2000 };

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_pins_t pins;
    fathom_sim_fixed_t real_time;
    fathom_sim_fixed_t processed;
    fathom_sim_a05_t device;
    fathom_uart_t uart;
    fathom_clock_t hal_clock;
    fathom_pin_t select;
    fathom_line_config_t config;
    fathom_line_t line;
    uint8_t frame[16];
    fathom_a05_auto_t a05;
} stage_t;

static void set_up(stage_t *s, bool by_pin)
{
    memset(s, 0, sizeof *s);
    s->real_time = (fathom_sim_fixed_t){{REAL_TIME_MM, REAL_TIME_MM, REAL_TIME_MM, REAL_TIME_MM}};
    s->processed = (fathom_sim_fixed_t){{PROCESSED_MM, PROCESSED_MM, PROCESSED_MM, PROCESSED_MM}};
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->wire, &bench_9600, bench_start_us);
    s->wire.full_duplex = true;
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->uart = fathom_sim_uart(&s->port);
    s->hal_clock = fathom_sim_clock(&s->clock);
    s->config = (fathom_line_config_t){
        .uart = &s->uart, .clock = &s->hal_clock, .frame = s->frame, .frame_size = sizeof s->frame};
    assert_int_equal(fathom_line_init(&s->line, &s->config), FATHOM_READY);
    const fathom_sim_a05_config_t device = {.mode = FATHOM_SIM_A05_AUTO,
                                            .scene = fathom_sim_fixed(&s->real_time),
                                            .processed = fathom_sim_fixed(&s->processed)};
    fathom_sim_a05_init(&s->device, &device);
    fathom_sim_pins_init(&s->pins, &s->device.device, &s->wire, &s->clock);
    s->select = fathom_sim_rx_pin(&s->pins);
    fathom_sim_attach(&s->wire, &s->device.device, s->clock.now_us);
    const fathom_a05_auto_config_t config = {.line = &s->line, .select = by_pin ? &s->select : NULL};
    assert_int_equal(fathom_a05_auto_init(&s->a05, &config), FATHOM_READY);
}

/* The distance that every sample of the next three seconds has. */
static unsigned heard_mm(stage_t *s, uint32_t loop_us)
{
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&s->a05);
    unsigned mm = 0;
    for (uint32_t us = 0; us < 3000 * MS; us += loop_us) {
        fathom_sample_t sample;
        fathom_sim_clock_advance(&s->clock, loop_us);
        while (fathom_poll(&sensor, &sample) == FATHOM_READY) {
            assert_true(mm == 0 || mm == sample.distance_mm);
            mm = sample.distance_mm;
        }
    }
    return mm;
}

static void cycle(stage_t *s, fathom_a05_value_t value)
{
    assert_int_equal(fathom_a05_auto_power_on(&s->a05, value), FATHOM_READY);
    fathom_sim_power_cycle(&s->wire, &s->device.device, 50 * MS, s->clock.now_us);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(what_is_chosen_at_power_on_is_sent_until_the_next)
{
    static const uint32_t loops_us[] = {1 * MS, 20 * MS};
    for (unsigned i = 0; i != 4; i++) {
        stage_t s;
        const uint32_t loop_us = loops_us[i / 2];
        set_up(&s, i % 2 != 0);
        assert_int_equal(heard_mm(&s, loop_us), PROCESSED_MM);
        cycle(&s, FATHOM_A05_REAL_TIME);
        assert_int_equal(heard_mm(&s, loop_us), REAL_TIME_MM);
        assert_int_equal(s.device.device.rx_held, 0); /* RX is free again, and the values stay */
        assert_int_equal(heard_mm(&s, loop_us), REAL_TIME_MM);
        cycle(&s, FATHOM_A05_PROCESSED);
        assert_int_equal(heard_mm(&s, loop_us), PROCESSED_MM);
    }
}

TEST(rx_that_is_low_later_chooses_nothing)
{
    stage_t s;
    set_up(&s, true);
    assert_int_equal(heard_mm(&s, 1 * MS), PROCESSED_MM);
    s.select.set(s.select.ctx, false);
    assert_int_equal(heard_mm(&s, 1 * MS), PROCESSED_MM);
}
