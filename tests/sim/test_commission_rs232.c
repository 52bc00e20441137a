/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* An A16 with RS232 (A16 5): it sends by itself while its settings are changed by Modbus on the same line, and is led
 * back to sending, with every fault at each frame. */

typedef struct {
    commission_t s;
    fathom_a16_auto_t automatic;
    fathom_a16_rs232_t rs232;
    fathom_sensor_t stream;
    unsigned heard; /* good readings of the stream */
} serial_t;

/* 301: in a loop of whole periods of 100 ms each look may come within the 4 ms after a frame, in which nothing is sent. */
static const uint32_t loops_us[] = {0, 1 * MS, 20 * MS, 301 * MS};

static void set_up_serial(serial_t *t, uint32_t loop_us)
{
    commission_t *const s = &t->s;
    memset(t, 0, sizeof *t);
    set_up(s, A16, 1, loop_us, FATHOM_LINE_ECHO_AUTO);
    fathom_sim_detach(&s->wire, device_of(s, 0), s->clock.now_us);
    fathom_sim_line_init(&s->wire, &bench_9600, s->clock.now_us);
    fathom_sim_clock_init(&s->clock, bench_start_us, 0);
    fathom_sim_uart_init(&s->port, &s->wire, &s->clock);
    s->wire.full_duplex = true;
    const fathom_sim_a16_config_t device = {.mode = FATHOM_SIM_A16_AUTO,
                                            .scene = fathom_sim_fixed(&s->fixed)};
    fathom_sim_a16_init(&s->device[0].a16, &device);
    fathom_sim_fault_init(&s->fault, 1);
    s->fault.clock = &s->clock;
    fathom_sim_fault_attach(&s->fault, &s->wire, device_of(s, 0));
    fathom_sim_attach(&s->wire, device_of(s, 0), s->clock.now_us);
    const fathom_a16_auto_config_t config = {.line = &s->line};
    assert_int_equal(fathom_a16_auto_init(&t->automatic, &config), FATHOM_READY);
    fathom_a16_rs232_init(&t->rs232, &s->driver.a16, &t->automatic);
    t->stream = fathom_a16_auto_sensor(&t->automatic);
}

/* A reading of the stream is the distance that there is, and nothing else. */
static void hear(serial_t *t)
{
    fathom_sample_t sample;
    while (fathom_poll(&t->stream, &sample) == FATHOM_READY) {
        assert_int_equal(sample.kind, FATHOM_TARGET);
        assert_int_equal(sample.distance_mm, 1234);
        t->heard++;
    }
}

static void sleep_until_due(serial_t *t, uint32_t due_us)
{
    if (t->s.loop_us != 0)
        fathom_sim_clock_advance(&t->s.clock, t->s.loop_us);
    else
        fathom_sim_clock_idle(&t->s.clock, due_us);
}

static void hear_for(serial_t *t, uint32_t us)
{
    const uint32_t start_us = t->s.clock.now_us;
    while (fathom_elapsed_us(t->s.clock.now_us, start_us) < us) {
        hear(t);
        sleep_until_due(t, fathom_due_us(&t->stream, 1));
    }
}

/* The setting while the device may still be sending. */
static fathom_status_t set_threshold(serial_t *t, uint16_t threshold_mm)
{
    const uint32_t start_us = t->s.clock.now_us;
    for (;;) {
        const fathom_status_t status = fathom_a16_set_switch_threshold_mm(&t->s.driver.a16, threshold_mm);
        if (status != FATHOM_PENDING) return status;
        hear(t);
        assert_true(fathom_elapsed_us(t->s.clock.now_us, start_us) < 60 * SECOND);
        const fathom_sensor_t both[] = {t->stream, sensor_of(&t->s)};
        sleep_until_due(t, fathom_due_us(both, 2));
    }
}

static fathom_status_t return_to_automatic(serial_t *t)
{
    const uint32_t start_us = t->s.clock.now_us;
    fathom_sample_t sample = {.distance_mm = 9};
    for (;;) {
        const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&t->rs232, &sample);
        assert_int_equal(sample.distance_mm, status == FATHOM_READY ? 1234 : 9);
        if (status != FATHOM_PENDING) return status;
        assert_true(fathom_elapsed_us(t->s.clock.now_us, start_us) < 60 * SECOND);
        sleep_until_due(t, fathom_a16_rs232_due_us(&t->rs232));
    }
}

static bool is_sending(serial_t *t)
{
    const uint32_t before = device_of(&t->s, 0)->counters.automatic;
    hear_for(t, 500 * MS);
    return device_of(&t->s, 0)->counters.automatic >= before + 3;
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(settings_are_changed_while_it_sends_and_it_sends_again_afterwards)
{
    static serial_t t;
    for (unsigned l = 0; l != 4; l++)
        for (uint32_t later_us = 0; later_us < 100 * MS; later_us += 7 * MS) { /* of the period of 100 ms */
            set_up_serial(&t, loops_us[l]);
            hear_for(&t, 350 * MS);
            assert_true(t.heard >= 1);
            fathom_sim_clock_advance(&t.s.clock, later_us);
            assert_int_equal(set_threshold(&t, 750), FATHOM_READY);
            assert_int_equal(t.s.device[0].a16.threshold_mm, 750);
            assert_int_equal(told(&t.s), 1);
            assert_false(is_sending(&t));
            assert_int_equal(return_to_automatic(&t), FATHOM_READY);
            assert_true(is_sending(&t));
            assert_int_equal(set_threshold(&t, 750), FATHOM_READY); /* it is so already */
            assert_int_equal(told(&t.s), 2);                        /* with 0x0202 */
        }
}

static void with_fault(uint8_t kind, uint32_t frame, uint32_t loop_us)
{
    static serial_t t;
    set_up_serial(&t, loop_us);
    hear_for(&t, 350 * MS);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&t.s.fault, kind, FATHOM_SIM_FAULT_ALWAYS_PPM, t.s.fault.frames + frame);
    assert_non_null(rule);
    const fathom_status_t is_set = set_threshold(&t, 750);
    assert_true(told(&t.s) <= 1);
    const uint16_t has = t.s.device[0].a16.threshold_mm;
    assert_true(has == 750 || (has == 1000 && is_set != FATHOM_READY));
    if (is_set != FATHOM_READY && is_set != FATHOM_ERR_UNCONFIRMED && kind != FATHOM_SIM_FAULT_EXCEPTION)
        assert_int_equal(has, 1000);
    const fathom_status_t is_back = return_to_automatic(&t);
    /* A frame that is late or a module without power is sending, though not at once. */
    if (is_back == FATHOM_READY && kind != FATHOM_SIM_FAULT_POWER_CYCLE && kind != FATHOM_SIM_FAULT_LATE)
        assert_true(is_sending(&t));
    /* Whatever it was, it can be tried again. */
    fathom_sim_fault_enable(&t.s.fault, false);
    hear_for(&t, 5 * SECOND);
    assert_int_equal(set_threshold(&t, 800), FATHOM_READY);
    assert_int_equal(return_to_automatic(&t), FATHOM_READY);
    assert_true(is_sending(&t));
}

TEST(no_fault_shows_a_wrong_reading_or_a_return_that_was_none)
{
    for (uint8_t kind = FATHOM_SIM_FAULT_UNIT; kind != FATHOM_SIM_FAULT_END; kind++)
        for (uint32_t frame = 1; frame <= 8; frame++)
            for (unsigned l = 0; l != 4; l++)
                if (kind != FATHOM_SIM_FAULT_UNASKED) with_fault(kind, frame, loops_us[l]);
}

TEST(what_was_given_up_is_begun_anew)
{
    static serial_t t;
    for (unsigned step = 0; step != 120; step++) {
        fathom_sample_t sample;
        set_up_serial(&t, 20 * MS);
        assert_int_equal(set_threshold(&t, 750), FATHOM_READY);
        for (unsigned i = 0; i != step; i++) {
            if (fathom_a16_rs232_return_to_automatic(&t.rs232, &sample) != FATHOM_PENDING) break;
            sleep_until_due(&t, 0);
        }
        fathom_a16_rs232_cancel(&t.rs232);
        assert_int_equal(set_threshold(&t, 800), FATHOM_READY); /* which ends automatic output again */
        hear_for(&t, 5 * SECOND);
        assert_int_equal(return_to_automatic(&t), FATHOM_READY);
        assert_true(is_sending(&t));
    }
}

TEST(a_loop_that_slept_too_long_is_due_at_once_and_hears_what_came)
{
    static serial_t t;
    fathom_sample_t sample;
    set_up_serial(&t, 1 * MS);
    assert_int_equal(set_threshold(&t, 750), FATHOM_READY);
    while (!t.rs232.is_listening) {
        assert_int_equal(fathom_a16_rs232_return_to_automatic(&t.rs232, &sample), FATHOM_PENDING);
        fathom_sim_clock_advance(&t.s.clock, 1 * MS);
    }
    fathom_sim_clock_advance(&t.s.clock, 3 * SECOND); /* over FATHOM_A16_RS232_RETURN_US */
    assert_int_equal(fathom_a16_rs232_due_us(&t.rs232), 0);
    assert_int_equal(return_to_automatic(&t), FATHOM_READY);
}
