/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a16_controlled.c src/engine/line_pins.c
 * with:   src/sensor/dyp_auto.c src/sensor/dyp.c src/engine/stream.c src/engine/output.c src/engine/sensor.c
 *          src/codec/dyp_stream.c src/engine/trigger.c
 * options: -eva-precision 0
 *          -eva-slevel-function fathom_a16_controlled_init:50,fathom_dyp_auto_init:20,main:30,output_of:10,take:40
 *          -eva-split-return-function fathom_a16_controlled_init:0,fathom_dyp_auto_init:0,fathom_trigger_init:0
 * unreached: due_us poll is_clear fathom_contact_line_guard
 * quick:   no
 *
 * The A16 that a pin triggers: any calls in any order, any bytes.
 */
#include "fathom/sensor/a16_controlled.h"
#include "outputs.h"

static fathom_a16_controlled_t sensor;

static void any_call(const fathom_sensor_t *handle)
{
    switch (any_8_in(0, 2)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    default:
        (void)fathom_a16_controlled_deinit(&sensor);
    }
}

static void port_that_cannot_send(void)
{
    static const fathom_uart_t mute;
    static fathom_line_parts_t parts;
    static fathom_line_t line;
    static fathom_line_byte_t byte;
    parts.uart = &mute;
    line.parts = &parts;
    byte.line = &line;
    const fathom_output_t output = fathom_output_line_byte(&byte);
    const fathom_status_t status = fathom_output_set(&output, any_8());
    /*@ assert status == FATHOM_ERR_UNSUPPORTED; */
}

void main(void)
{
    fathom_a16_controlled_config_t config;
    const uint8_t which = any_8_in(0, 6);
    /*@ split which; */
    any_line_init();
    any_line.phase = any_8_in(FATHOM_LINE_IDLE, FATHOM_LINE_FINISHING);
    port_that_cannot_send();
    const fathom_output_t trigger = output_of(which);
    config.period_us = any_32();
    config.gap_us = any_16();
    config.model = any_facts();
    const fathom_sensor_t handle = fathom_a16_controlled_sensor(&sensor);
    any_call(&handle); /* in zeroed memory */
    fathom_status_t status = fathom_a16_controlled_init(&sensor, &blank_line, &trigger, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    status = fathom_a16_controlled_init(&sensor, &any_line, NULL, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    fathom_line_t *const line = any_bool() ? &any_line : NULL;
    status = fathom_a16_controlled_init(&sensor, line, &trigger, NULL);
    if (status == FATHOM_OK) (void)fathom_a16_controlled_deinit(&sensor);
    if (fathom_a16_controlled_init(&sensor, line, &trigger, &config) != FATHOM_OK) return;
    while (any_bool()) any_call(&handle);
    (void)fathom_a16_controlled_deinit(&sensor);
}
