/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* An A16 with RS232 (A16 5): it sends by itself while its settings are changed by Modbus on the same line, and is led
 * back to sending, with every fault at each frame. */

static fathom_a16_auto_t automatic;
static fathom_a16_rs232_t rs232;
static unsigned heard; /* good readings of the stream, which is s.sensor */

/* 301: in a loop of whole periods of 100 ms each look may come within the 4 ms after a frame, in which nothing is
 * sent. */
static const uint32_t serial_loops_us[LOOPS] = {0, 1 * MS, 20 * MS, 301 * MS};

static void set_up_serial(uint32_t loop_us)
{
    stage_begin(&bench_9600, true, loop_us);
    bench.fixed = FIXED(1234);
    s.model = A16;
    init_driver(&s.driver, A16, 1, &s.settings);
    add_a16(FATHOM_SIM_A16_AUTO, (a16_config_t){0});
    set_faults(1);
    bench.fault.clock = &s.clock;
    assert_int_equal(fathom_a16_auto_init(&automatic, &s.line, NULL), FATHOM_OK);
    fathom_a16_rs232_init(&rs232, &s.driver.a16, &automatic);
    s.sensor = fathom_a16_auto_sensor(&automatic);
    heard = 0;
}

/* A reading of the stream is the distance that there is, and nothing else. */
static void hear_some(void)
{
    while (fathom_poll(&s.sensor, &s.sample) == FATHOM_OK) {
        assert_int_equal(s.sample.kind, FATHOM_TARGET);
        assert_int_equal(s.sample.distance_mm, 1234);
        heard++;
    }
}

static void hear_for(uint32_t us)
{
    for (const uint32_t start_us = s.clock.now_us; since_us(start_us) < us; pass()) hear_some();
}

/* The setting while the device may still be sending. */
static fathom_status_t set_threshold(uint16_t threshold_mm)
{
    const uint32_t start_us = s.clock.now_us;
    for (;;) {
        const fathom_status_t status = fathom_a16_modbus_set_switch_threshold_mm(&s.driver.a16, threshold_mm);
        if (status != FATHOM_PENDING) return status;
        hear_some();
        assert_ends(start_us);
        const fathom_sensor_t both[] = {s.sensor, sensor_of(&s.driver, A16)};
        pass_until(fathom_due_us(both, 2));
    }
}

static fathom_status_t return_to_automatic(void)
{
    const uint32_t start_us = s.clock.now_us;
    fathom_sample_t sample = {.distance_mm = 9};
    for (;;) {
        const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&rs232, &sample);
        assert_int_equal(sample.distance_mm, status == FATHOM_OK ? 1234 : 9);
        if (status != FATHOM_PENDING) return status;
        assert_ends(start_us);
        pass_until(fathom_a16_rs232_due_us(&rs232));
    }
}

static bool is_sending(void)
{
    const uint32_t before = bench.device->counters.automatic;
    hear_for(500 * MS);
    return bench.device->counters.automatic >= before + 3;
}

/* Two starts: the loops meet each frame at another time anyhow. */
static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(settings_are_changed_while_it_sends_and_it_sends_again_afterwards)
{
    for (unsigned l = 0; l != LOOPS; l++)
        for (uint32_t later_us = 0; later_us < 100 * MS; later_us += 7 * MS) { /* of the period of 100 ms */
            set_up_serial(serial_loops_us[l]);
            hear_for(350 * MS);
            assert_true(heard >= 1);
            pass_us(later_us);
            assert_int_equal(set_threshold(750), FATHOM_OK);
            assert_int_equal(bench.a16.threshold_mm, 750);
            assert_int_equal(kept_commands(), 1);
            assert_false(is_sending());
            assert_int_equal(return_to_automatic(), FATHOM_OK);
            assert_true(is_sending());
            assert_int_equal(set_threshold(750), FATHOM_OK); /* it is so already */
            assert_int_equal(kept_commands(), 2);            /* with 0x0202 */
        }
}

static void with_fault(uint8_t kind, uint32_t frame, uint32_t loop_us)
{
    set_up_serial(loop_us);
    hear_for(350 * MS);
    assert_non_null(fathom_sim_fault_add(&bench.fault, kind, ALWAYS, bench.fault.frames + frame));
    const fathom_status_t is_set = set_threshold(750);
    assert_true(kept_commands() <= 1);
    const uint16_t has = bench.a16.threshold_mm;
    assert_true(has == 750 || (has == 1000 && is_set != FATHOM_OK));
    if (is_set != FATHOM_OK && is_set != FATHOM_ERR_UNCONFIRMED && kind != FATHOM_SIM_FAULT_EXCEPTION)
        assert_int_equal(has, 1000);
    const fathom_status_t is_back = return_to_automatic();
    /* A frame that is late or a module without power is sending, though not at once. */
    if (is_back == FATHOM_OK && kind != FATHOM_SIM_FAULT_POWER_CYCLE && kind != FATHOM_SIM_FAULT_LATE)
        assert_true(is_sending());
    /* Whatever it was, it can be tried again. */
    fathom_sim_fault_enable(&bench.fault, false);
    hear_for(5 * SECOND);
    assert_int_equal(set_threshold(800), FATHOM_OK);
    assert_int_equal(return_to_automatic(), FATHOM_OK);
    assert_true(is_sending());
}

TEST(no_fault_shows_a_wrong_reading_or_a_return_that_was_none)
{
    for (uint8_t kind = FATHOM_SIM_FAULT_UNIT; kind != FATHOM_SIM_FAULT_END; kind++)
        for (uint32_t frame = 1; frame <= 8; frame++)
            for (unsigned l = 0; l != LOOPS; l++)
                if (kind != FATHOM_SIM_FAULT_UNASKED) with_fault(kind, frame, serial_loops_us[l]);
}

TEST(what_was_given_up_is_begun_anew)
{
    for (unsigned step = 0; step != 120; step++) {
        set_up_serial(20 * MS);
        assert_int_equal(set_threshold(750), FATHOM_OK);
        for (unsigned i = 0; i != step; i++) {
            if (fathom_a16_rs232_return_to_automatic(&rs232, &s.sample) != FATHOM_PENDING) break;
            pass();
        }
        fathom_a16_rs232_cancel(&rs232);
        assert_int_equal(set_threshold(800), FATHOM_OK); /* which ends automatic output again */
        hear_for(5 * SECOND);
        assert_int_equal(return_to_automatic(), FATHOM_OK);
        assert_true(is_sending());
    }
}

TEST(a_loop_that_slept_too_long_is_due_at_once_and_hears_what_came)
{
    set_up_serial(1 * MS);
    assert_int_equal(set_threshold(750), FATHOM_OK);
    for (; !rs232.is_listening; pass_us(1 * MS))
        assert_int_equal(fathom_a16_rs232_return_to_automatic(&rs232, &s.sample), FATHOM_PENDING);
    pass_us(11 * SECOND); /* over FATHOM_A16_RS232_DEFAULT_RETURN_US */
    assert_int_equal(fathom_a16_rs232_due_us(&rs232), 0);
    assert_int_equal(return_to_automatic(), FATHOM_OK);
}
