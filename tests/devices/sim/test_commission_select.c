/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* An A05 with automatic output gets power (A05 1(1)): the driver holds RX low, by a pin or by a break of the line, and
 * it sends real-time values from then on; in loops of any length, and with Modbus on the same line. */

static fathom_a05_auto_t automatic;
static fathom_a05_modbus_t *const driver = &s.driver.a05;
static fathom_pin_t rx;

static void set_up_start(uint32_t loop_us, bool by_pin)
{
    stage_begin(&bench_9600, true, loop_us);
    bench.fixed = FIXED(1000, 2000, 1953, 3562);
    bench.processed = FIXED(1001, 2001, 1954, 3563);
    add_a05(FATHOM_SIM_A05_AUTO, (a05_config_t){.processed = PROCESSED});
    fathom_sim_pins_init(&s.pins, bench.device, &bench.line, &s.clock);
    rx = fathom_sim_rx_pin(&s.pins);
    const fathom_a05_auto_config_t config = {.select = by_pin ? fathom_output_pin(&rx)
                                                              : fathom_output_line_break(&s.line)};
    assert_int_equal(fathom_a05_auto_init(&automatic, &s.line, &config), FATHOM_OK);
    s.sensor = fathom_a05_auto_sensor(&automatic);
    init_driver(&s.driver, A05, 1, NULL);
}

/* The next sample of the first probe that is no error. */
static uint16_t first_probe_mm(void)
{
    for (;;) {
        assert_int_equal(measure(), FATHOM_OK);
        if (s.sample.probe == 1) return s.sample.distance_mm;
    }
}

/* The distance of the first probe in every sample of the next three seconds, which is always the same. */
static unsigned heard_mm(void)
{
    const uint32_t start_us = s.clock.now_us;
    unsigned mm = 0;
    while (since_us(start_us) < 3 * SECOND) {
        pass();
        while (fathom_poll(&s.sensor, &s.sample) == FATHOM_OK) {
            assert_true(s.sample.probe != 1 || mm == 0 || mm == s.sample.distance_mm);
            if (s.sample.probe == 1) mm = s.sample.distance_mm;
        }
    }
    return mm;
}

static void power(fathom_dyp_value_t value, uint32_t off_us)
{
    fathom_status_t status;
    for (; (status = fathom_a05_auto_select(&automatic, value)) == FATHOM_ERR_BUSY; pass_us(1 * MS))
        (void)fathom_line_poll(&s.line);
    assert_int_equal(status, FATHOM_OK);
    fathom_sim_power_cycle(&bench.line, bench.device, off_us, s.clock.now_us);
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(what_is_chosen_at_power_on_is_sent_until_the_next)
{
    for (unsigned i = 0; i != 4; i++) {
        set_up_start(loops_us[1 + i / 2], i % 2 != 0);
        assert_int_equal(heard_mm(), 1001);
        power(FATHOM_REAL_TIME, 50 * MS);
        assert_int_equal(heard_mm(), 1000);
        assert_int_equal(bench.device->rx_held, 0); /* RX is free again, and the values stay */
        assert_int_equal(heard_mm(), 1000);
        power(FATHOM_PROCESSED, 50 * MS);
        assert_int_equal(heard_mm(), 1001);
    }
}

TEST(rx_that_is_low_later_chooses_nothing)
{
    set_up_start(1 * MS, true);
    assert_int_equal(heard_mm(), 1001);
    rx.set(rx.ctx, false);
    assert_int_equal(heard_mm(), 1001);
}

TEST(the_values_are_those_that_were_chosen)
{
    for (unsigned l = 0; l != LOOPS; l++) {
        set_up_start(loops_us[l], false);
        power(FATHOM_REAL_TIME, 0);
        assert_int_equal(first_probe_mm(), 1000);
        power(FATHOM_PROCESSED, 0); /* in the middle of the low level for the other */
        assert_int_equal(first_probe_mm(), 1001);
        power(FATHOM_REAL_TIME, 0);
        for (unsigned i = 0; i != 10; i++) assert_int_equal(first_probe_mm(), 1000);
    }
}

TEST(the_line_is_held_low_for_a_second_and_a_half_and_no_longer)
{
    for (unsigned l = 1; l != LOOPS; l++) {
        set_up_start(loops_us[l], false);
        power(FATHOM_REAL_TIME, 0);
        const uint32_t start_us = s.clock.now_us;
        while (bench.line.in_break) {
            assert_true(since_us(start_us) <= 1500 * MS + loops_us[l]);
            (void)first_probe_mm();
            if (bench.line.in_break) pass();
        }
        assert_in_range(since_us(start_us), 1500 * MS, 2200 * MS);
    }
}

/* The A05 hears Modbus from then on, and its automatic output ends. */
TEST(a_request_of_meanwhile_is_answered_afterwards)
{
    for (unsigned l = 0; l != LOOPS; l++) {
        set_up_start(loops_us[l], false);
        power(FATHOM_REAL_TIME, 0);
        uint8_t address = 0;
        const fathom_sensor_t both[] = {s.sensor, fathom_a05_modbus_sensor(driver)};
        fathom_status_t status;
        const uint32_t start_us = s.clock.now_us;
        while ((status = fathom_a05_modbus_get_address(driver, &address)) != FATHOM_OK) {
            if (status != FATHOM_PENDING) { /* TX is low for longer than the line waits (line.h, rule 3). */
                assert_int_equal(status, FATHOM_ERR_LINE_BUSY);
                assert_true(bench.line.in_break);
            }
            while (fathom_poll(&s.sensor, &s.sample) == FATHOM_OK)
                assert_int_equal(s.sample.distance_mm, bench.fixed.value[s.sample.probe - 1]);
            if (bench.line.in_break) COUNTED(.requests = NONE);
            assert_true(since_us(start_us) < 10 * SECOND);
            pass_until(fathom_due_us(both, 2));
        }
        assert_int_equal(status, FATHOM_OK);
        assert_int_equal(address, 1);
        assert_true(since_us(start_us) >= 1500 * MS);
    }
}

TEST(while_a_request_is_on_its_way_it_is_busy_and_nothing_changes)
{
    uint8_t address = 0;
    set_up_start(1 * MS, false);
    for (pass_us(20 * MS); s.line.head == NULL || s.line.head->attempts == 0; pass_us(1 * MS))
        assert_int_equal(fathom_a05_modbus_get_address(driver, &address), FATHOM_PENDING);
    assert_int_equal(fathom_a05_auto_select(&automatic, FATHOM_REAL_TIME), FATHOM_ERR_BUSY);
    assert_false(bench.line.in_break);
    fathom_a05_modbus_cancel(driver);
    power(FATHOM_REAL_TIME, 0);
    assert_true(bench.line.in_break);
    assert_int_equal(first_probe_mm(), 1000);
}
