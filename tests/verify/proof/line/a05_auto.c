/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/a05_auto.c
 * with:   src/sensor/dyp_auto.c src/sensor/dyp.c src/engine/stream.c src/engine/output.c src/engine/sensor.c
 *          src/codec/dyp_stream.c src/engine/line_pins.c
 * options: -eva-precision 0 -eva-ilevel 16
 *          -eva-slevel-function fathom_a05_auto_init:50,fathom_dyp_auto_init:20,main:200,run:1,odd_probe:20,fathom_dyp_measurement_next:20,fathom_dyp_first_probe:20,output_of:10,take:40
 *          -eva-split-return-function fathom_a05_auto_init:0,fathom_dyp_auto_init:0
 * unreached: due_us poll
 * quick:   no
 *
 * The A05 that sends by itself: any calls in any order, any bytes.
 */
#include "fathom/sensor/a05_auto.h"
#include "outputs.h"

static fathom_a05_auto_t sensor;

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
        (void)fathom_a05_auto_select(&sensor, (fathom_dyp_value_t)any_8());
    }
}

/* The same loop for each that may drive the RX pin. */
static void run(void)
{
    const fathom_sensor_t handle = fathom_a05_auto_sensor(&sensor);
    while (any_bool()) any_call(&handle);
    (void)fathom_a05_auto_deinit(&sensor);
}

void main(void)
{
    fathom_a05_auto_config_t config;
    const uint8_t which = any_8_in(0, 4);
    /*@ split which; */
    any_line_init();
    config.select = output_of(which);
    config.stale_us = any_32();
    config.gap_us = any_16();
    config.model = any_facts();
    config.probes = any_8_in(16, UINT8_MAX);
    fathom_line_t *const line = any_bool() ? &any_line : NULL;
    fathom_status_t status = fathom_a05_auto_init(&sensor, line, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    config.probes = any_8_in(0, 15);
    status = fathom_a05_auto_init(&sensor, &blank_line, &config);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    const fathom_sensor_t none = fathom_a05_auto_sensor(&sensor);
    any_call(&none); /* in zeroed memory */
    if (fathom_a05_auto_init(&sensor, line, NULL) == FATHOM_OK) (void)fathom_a05_auto_deinit(&sensor);
    if (fathom_a05_auto_init(&sensor, line, &config) != FATHOM_OK) return;
    run();
}
