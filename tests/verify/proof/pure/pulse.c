/* SPDX-License-Identifier: MIT */
/*
 * The trigger, what drives it, the meter of pulses and the A16 that is read by it: any config that init admits, polled
 * and asked for its due time at any time, with deinit between.
 *
 * proves: src/engine/pulse.c src/engine/trigger.c src/engine/output.c src/sensor/a16_pwm.c src/engine/sensor.c
 *         src/engine/wait.c
 * with: src/codec/pulse_width.c
 * options: -eva-precision 1
 *         -eva-slevel-function polls:1,look:100,fathom_poll:100,fathom_a16_pwm_sensor_poll:100,fathom_pulse_poll:100,take:100,end_cycle:20
 *         -eva-split-return-function assumed_take:0:1,take:0,end_cycle:0,fathom_pulse_poll:0,fathom_a16_pwm_sensor_poll:0,fathom_poll:0
 *         -eva-split-return-function fathom_trigger_drive:0,fathom_trigger_init:0
 *         -eva-split-return-function fathom_pulse_init:0,fathom_a16_pwm_init:0
 */
#include "assumptions.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_pwm.h"

static void look(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    if (fathom_poll(sensor, &sample) == FATHOM_OK) {
        /*@ assert \initialized(&sample.raw) && \initialized(&sample.kind) && \initialized(&sample.probe); */
    }
    (void)fathom_due_us(sensor, 1);
}

static void polls(fathom_a16_pwm_t *pwm)
{
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(pwm);
    while (any_bool()) {
        look(&sensor);
        if (any_bool()) (void)fathom_a16_pwm_deinit(pwm);
    }
}

static void any_pwm(const fathom_clock_t *clock, const fathom_capture_t *capture, fathom_output_t output)
{
    static fathom_a16_pwm_t pwm, blank;
    static fathom_model_facts_t facts;
    const fathom_sensor_t none = fathom_a16_pwm_sensor(&blank);
    look(&none); /* in zeroed memory */
    fathom_a16_pwm_config_t config;
    facts.line_settings = NULL;
    facts.min_mm = any_16();
    facts.max_mm = any_16();
    facts.period_ms = any_16();
    facts.trigger_us = any_16();
    facts.us_per_dm = any_16();
    facts.start = any_8();
    facts.no_target_ms = any_8();
    config.model = any_bool() ? &facts : NULL;
    config.period_us = any_32();
    config.in_air = any_bool();
    config.air_dc = Frama_C_short_interval(INT16_MIN, INT16_MAX);
    if (fathom_a16_pwm_init(&pwm, capture, clock, &output, NULL) == FATHOM_OK)
        (void)fathom_a16_pwm_deinit(&pwm);
    if (fathom_a16_pwm_init(&pwm, capture, clock, &output, &config) != FATHOM_OK) return;
    polls(&pwm);
}

static void idle(void *ctx, uint32_t max_us)
{ /*@ assert ctx == &assumed_ctx; */
}

static fathom_status_t any_poll(void *ctx, fathom_sample_t *sample)
{
    /*@ assert ctx == &assumed_ctx; */
    if (any_bool()) return (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_ERR_ARGUMENT);
    return any_bool() ? FATHOM_OK : FATHOM_PENDING;
}

/* A sensor in zeroed memory. */
static void no_sensor(void)
{
    static const fathom_sensor_t none;
    fathom_sample_t sample;
    const fathom_status_t status = fathom_poll(&none, &sample);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    const uint32_t due_us = fathom_due_us(&none, 1);
    /*@ assert due_us == 0; */
}

/* Of any sensors, so many; and the blocking form. */
static void any_sensors(void)
{
    enum { MOST = 4 };
    static fathom_sensor_t sensors[MOST];
    fathom_sample_t sample;
    for (uint8_t i = 0; i != MOST; i++) {
        sensors[i].poll = any_poll;
        sensors[i].due_us = assumed_now_us;
        sensors[i].ctx = &assumed_ctx;
    }
    for (uint8_t count = 0; count <= MOST; count++) (void)fathom_due_us(sensors + MOST - count, count);
    (void)fathom_wait(sensors, &sample, any_bool() ? idle : NULL, &assumed_ctx);
}

int main(void)
{
    static const fathom_capture_t no_arm = {NULL, assumed_take, &assumed_ctx};
    static const fathom_capture_t no_take = {assumed_arm, NULL, &assumed_ctx};
    fathom_output_t none;
    none.set = NULL;
    none.ctx = NULL;
    any_pwm(NULL, &assumed_capture, fathom_output_pin(&assumed_output));
    any_pwm(&assumed_clock, NULL, fathom_output_pin(&assumed_output));
    any_pwm(&assumed_clock, &no_arm, fathom_output_pin(&assumed_output));
    any_pwm(&assumed_clock, &no_take, fathom_output_pin(&assumed_output));
    any_pwm(&assumed_clock, &assumed_capture, none);
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_pin(NULL));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_pin(&assumed_input));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_break(NULL));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_pin(&assumed_output));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_inverted_pin(&assumed_output));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_inverted_pin(&assumed_input));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_inverted_pin(NULL));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_none());
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_break(&assumed_uart));
    any_pwm(&assumed_clock, &assumed_capture, fathom_output_break(&assumed_bare_uart));
    no_sensor();
    any_sensors();
    return 0;
}
