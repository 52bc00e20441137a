/* SPDX-License-Identifier: MIT */
/*
 * proves: src/sensor/hps167_uart.c
 * with:   src/codec/hps167_frames.c src/codec/hps167s_registers.c src/codec/modbus_rtu.c src/codec/crc16.c
 *          src/engine/modbus_command.c src/engine/modbus_unit.c src/engine/sensor.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 700 -eva-widening-delay 20
 *          -eva-slevel-function fathom_modbus_unit_init:400,is_usable:50,is_valid:50,fathom_hps167_uart_init:100,fathom_line_submit:20,fathom_hps167_decode:10,main:200,run:1,receive:20,drop_first:20,fathom_hps167_crc:20,fathom_hps167_frame_length:20
 *          -eva-split-return-function fathom_modbus_unit_init:0,is_usable:1,is_valid:1,fathom_hps167_uart_init:0
 * quick:   no
 *
 * The HPS-167 with a UART, single and continuous, over any line: any calls in any order, any bytes.
 */
#include "fathom/sensor/hps167_uart.h"
#include "any_line.h"

static fathom_hps167_uart_t sensor;
static fathom_hps167s_limits_t any_limits;

/* What the line asks the protocol besides. */
static void any_frame(void)
{
    uint8_t frame[ANY_FRAME_SIZE];
    if (any_line_queued == NULL || any_line_queued->protocol == NULL) return; /* EVA cannot tell them apart */
    const fathom_protocol_t *const protocol = any_line_queued->protocol;
    any_bytes(frame, ANY_FRAME_SIZE);
    const uint8_t length = protocol->length(frame, any_8_in(1, ANY_FRAME_SIZE));
    if (length > 2) (void)protocol->check(frame, length);
    (void)protocol->check(frame, FATHOM_HPS167_REQUEST_LENGTH);
    (void)protocol->is_request(any_line_queued, frame, any_8_in(1, ANY_FRAME_SIZE));
    (void)protocol->may_collide(any_line_queued);
}

static void any_call(const fathom_sensor_t *handle)
{
    uint16_t temperature;
    switch (any_8_in(0, 7)) {
    case 0:
        any_poll(handle);
        break;
    case 1:
        fathom_hps167_uart_power_on(&sensor);
        break;
    case 2:
        fathom_hps167_uart_cancel(&sensor);
        break;
    case 3:
        (void)fathom_line_poll(&any_line); /* another driver has */
        break;
    case 4:
        (void)fathom_hps167_uart_stop(&sensor);
        break;
    case 5:
        (void)fathom_hps167_uart_get_temperature(&sensor, &temperature);
        break;
    case 6:
        any_frame();
        break;
    default:
        (void)fathom_hps167_uart_set_limits(&sensor, &any_limits);
    }
}

/* The same loop for each of the two modes. */
static void run(void)
{
    const fathom_sensor_t handle = fathom_hps167_uart_sensor(&sensor);
    while (any_bool()) any_call(&handle);
}

void main(void)
{
    fathom_hps167_uart_config_t config;
    any_line_init();
    const bool is_small = any_bool();
    /*@ split is_small; */
    any_line_config.frame_size = is_small ? any_8_in(8, FATHOM_HPS167_MEASUREMENT_LENGTH - 1)
                                          : any_8_in(FATHOM_HPS167_MEASUREMENT_LENGTH, ANY_FRAME_SIZE);
    const fathom_sensor_t none = fathom_hps167_uart_sensor(&sensor);
    any_call(&none); /* in zeroed memory */
    fathom_hps167_uart_deinit(&sensor);
    any_modbus_config(&config.modbus);
    config.start_us = any_32();
    config.stale_us = any_32();
    config.continuous = any_bool();
    any_limits.max_mm = any_16();
    any_limits.over_range_mm = any_16();
    any_limits.min_mm = any_16();
    (void)fathom_hps167_uart_init(&sensor, &any_line, NULL);
    if (fathom_hps167_uart_init(&sensor, &any_line, &config) != FATHOM_OK) return;
    const bool is_continuous = config.continuous;
    /*@ split is_continuous; */
    run();
    if (any_bool()) fathom_hps167_uart_deinit(&sensor);
    (void)fathom_hps167_uart_init(&sensor, &any_line, &config); /* again, perhaps while a request is queued */
}
