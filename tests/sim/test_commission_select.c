/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* An A05 with automatic output gets power (A05 1(1)): the choice of its values by a break of the line, in loops of any
 * length, with Modbus on the same line. */

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_sim_fixed_t real_time;
    fathom_sim_fixed_t processed;
    fathom_sim_a05_t a05;
    fathom_uart_t uart;
    fathom_clock_t hal_clock;
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[32];
    fathom_a05_auto_t automatic;
    fathom_a05_modbus_t asking;
    uint32_t loop_us;
} start_t;

static const uint32_t loops_us[] = {0, 1 * MS, 20 * MS, 300 * MS};

static void set_up_start(start_t *s, uint32_t loop_us)
{
    memset(s, 0, sizeof *s);
    s->loop_us = loop_us;
    s->real_time = (fathom_sim_fixed_t){{1000, 2000, 1953, 3562}};
    s->processed = (fathom_sim_fixed_t){{1001, 2001, 1954, 3563}};
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_line_init(&s->wire, &bench_9600, bench_start_us);
    s->wire.full_duplex = true;
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->uart = fathom_sim_uart(&s->port);
    s->hal_clock = fathom_sim_clock(&s->clock);
    s->config = (fathom_line_config_t){
        .uart = &s->uart, .clock = &s->hal_clock, .frame = s->frame, .frame_size = sizeof s->frame};
    assert_int_equal(fathom_line_init(&s->line, &s->config), FATHOM_READY);
    s->modbus = fathom_modbus_client(&s->line);
    const fathom_a05_auto_config_t automatic = {.line = &s->line};
    const fathom_a05_modbus_config_t asking = {.modbus = &s->modbus, .clock = &s->hal_clock};
    assert_int_equal(fathom_a05_auto_init(&s->automatic, &automatic), FATHOM_READY);
    assert_int_equal(fathom_a05_modbus_init(&s->asking, &asking), FATHOM_READY);
    const fathom_sim_a05_config_t device = {.mode = FATHOM_SIM_A05_AUTO,
                                            .scene = fathom_sim_fixed(&s->real_time),
                                            .processed = fathom_sim_fixed(&s->processed)};
    fathom_sim_a05_init(&s->a05, &device);
    fathom_sim_attach(&s->wire, &s->a05.device, s->clock.now_us);
}

/* The next sample of the first probe that is no error. */
static uint16_t first_probe_mm(start_t *s)
{
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&s->automatic);
    const uint32_t start_us = s->clock.now_us;
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_poll(&sensor, &sample);
        if (status == FATHOM_READY && sample.probe == 1) return sample.distance_mm;
        if (status == FATHOM_READY) continue;
        assert_int_equal(status, FATHOM_PENDING);
        assert_true(fathom_elapsed_us(s->clock.now_us, start_us) < 5 * SECOND);
        if (s->loop_us != 0)
            fathom_sim_clock_advance(&s->clock, s->loop_us);
        else
            fathom_sim_clock_idle(&s->clock, fathom_due_us(&sensor, 1));
    }
}

static void power(start_t *s, fathom_a05_value_t value)
{
    fathom_status_t status;
    while ((status = fathom_a05_auto_power_on(&s->automatic, value)) == FATHOM_ERR_BUSY) {
        fathom_sim_clock_advance(&s->clock, 1 * MS);
        (void)fathom_line_poll(&s->line);
    }
    assert_int_equal(status, FATHOM_READY);
    fathom_sim_power_cycle(&s->wire, &s->a05.device, 0, s->clock.now_us);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(the_values_are_those_that_were_chosen)
{
    static start_t s;
    for (unsigned l = 0; l != 4; l++) {
        set_up_start(&s, loops_us[l]);
        power(&s, FATHOM_A05_REAL_TIME);
        assert_int_equal(first_probe_mm(&s), 1000);
        power(&s, FATHOM_A05_PROCESSED); /* in the middle of the low level for the other */
        assert_int_equal(first_probe_mm(&s), 1001);
        power(&s, FATHOM_A05_REAL_TIME);
        for (unsigned i = 0; i != 10; i++) assert_int_equal(first_probe_mm(&s), 1000);
    }
}

TEST(the_line_is_held_low_for_a_second_and_a_half_and_no_longer)
{
    static start_t s;
    for (unsigned l = 1; l != 4; l++) {
        set_up_start(&s, loops_us[l]);
        power(&s, FATHOM_A05_REAL_TIME);
        const uint32_t start_us = s.clock.now_us;
        while (s.wire.in_break) {
            assert_true(fathom_elapsed_us(s.clock.now_us, start_us) <= 1500 * MS + loops_us[l]);
            (void)first_probe_mm(&s);
            if (s.wire.in_break) fathom_sim_clock_advance(&s.clock, s.loop_us);
        }
        ASSERT_SPAN(s.clock.now_us, start_us, 1500 * MS, 2200 * MS);
    }
}

/* The A05 hears Modbus from then on, and its automatic output ends. */
TEST(what_was_asked_meanwhile_is_sent_afterwards)
{
    static start_t s;
    for (unsigned l = 0; l != 4; l++) {
        set_up_start(&s, loops_us[l]);
        power(&s, FATHOM_A05_REAL_TIME);
        uint8_t address = 0;
        const fathom_sensor_t both[] = {fathom_a05_auto_sensor(&s.automatic),
                                        fathom_a05_modbus_sensor(&s.asking)};
        fathom_status_t status;
        const uint32_t start_us = s.clock.now_us;
        while ((status = fathom_a05_modbus_address(&s.asking, &address)) == FATHOM_PENDING) {
            fathom_sample_t sample;
            while (fathom_poll(&both[0], &sample) == FATHOM_READY)
                assert_int_equal(sample.distance_mm, s.real_time.value[sample.probe - 1]);
            if (s.wire.in_break) assert_int_equal(s.a05.device.counters.requests, 0);
            assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 10 * SECOND);
            if (s.loop_us != 0)
                fathom_sim_clock_advance(&s.clock, s.loop_us);
            else
                fathom_sim_clock_idle(&s.clock, fathom_due_us(both, 2));
        }
        assert_int_equal(status, FATHOM_READY);
        assert_int_equal(address, 1);
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) >= 1500 * MS);
    }
}

TEST(while_a_request_is_on_its_way_it_is_busy_and_nothing_changes)
{
    static start_t s;
    uint8_t address = 0;
    set_up_start(&s, 1 * MS);
    fathom_sim_clock_advance(&s.clock, 20 * MS);
    while (s.line.head == NULL || s.line.head->attempts == 0) {
        assert_int_equal(fathom_a05_modbus_address(&s.asking, &address), FATHOM_PENDING);
        fathom_sim_clock_advance(&s.clock, 1 * MS);
    }
    assert_int_equal(fathom_a05_auto_power_on(&s.automatic, FATHOM_A05_REAL_TIME), FATHOM_ERR_BUSY);
    assert_false(s.wire.in_break);
    fathom_a05_modbus_cancel(&s.asking);
    power(&s, FATHOM_A05_REAL_TIME);
    assert_true(s.wire.in_break);
    assert_int_equal(first_probe_mm(&s), 1000);
}
