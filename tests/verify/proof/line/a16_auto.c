/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a16_auto.c src/sensor/dyp_auto.c src/engine/line_pins.c
 * with:   src/sensor/dyp.c src/engine/stream.c src/engine/output.c src/engine/sensor.c
 *          src/codec/dyp_stream.c
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_a16_auto_init:50,fathom_dyp_auto_init:20,main:30,run:1,output_of:10,take:40
 *          -eva-split-return-function fathom_a16_auto_init:0,fathom_dyp_auto_init:0
 * unreached: fathom_output_set_line_byte
 * quick:   no
 *
 * The A16 that sends by itself: any calls in any order, any bytes.
 */
#include "fathom/sensor/a16_auto.h"
#include "outputs.h"

static fathom_a16_auto_t sensor;

static void any_call(const fathom_sensor_t *handle)
{
    const fathom_contact_guard_t guard = fathom_contact_line_guard(&any_line);
    switch (any_8_in(0, 3)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    case 2: /* a contact on the same line looks */
        (void)guard.poll(guard.ctx);
        (void)guard.is_clear(guard.ctx, any_32());
        (void)guard.due_us(guard.ctx);
        break;
    default:
        (void)fathom_a16_auto_select(&sensor, (fathom_dyp_value_t)any_8());
    }
}

/* The same loop for each that may drive the RX pin. */
static void run(const fathom_sensor_t *handle)
{
    while (any_bool()) any_call(handle);
    (void)fathom_a16_auto_deinit(&sensor);
}

void main(void)
{
    fathom_a16_auto_config_t config;
    const uint8_t which = any_8_in(0, 4);
    /*@ split which; */
    any_line_init();
    config.select = output_of(which);
    config.stale_us = any_32();
    config.gap_us = any_16();
    config.value = any_8();
    config.model = any_facts();
    const fathom_sensor_t handle = fathom_a16_auto_sensor(&sensor);
    any_call(&handle); /* in zeroed memory */
    const fathom_status_t status = fathom_a16_auto_init(&sensor, &blank_line, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    fathom_line_t *const line = any_bool() ? &any_line : NULL;
    if (fathom_a16_auto_init(&sensor, line, &config) != FATHOM_OK) return;
    run(&handle);
    (void)fathom_a16_auto_init(&sensor, line, NULL);
}
