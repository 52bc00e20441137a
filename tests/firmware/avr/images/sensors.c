/* SPDX-License-Identifier: MIT */
/* Listens to an A16 or an A05 that sends by itself, or asks one or two HPS-167S over RS-485, driver-enable on PD3. */
#include <avr/interrupt.h>
#include <stddef.h>
#include <util/delay.h>

#include "../reports.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_avr.h"

/* ---- what it tells the bench (../board.h) ---- */

static void report_16(uint16_t value)
{
    GPIOR0 = (uint8_t)value;
    GPIOR0 = (uint8_t)(value >> 8);
}

static void report_32(uint32_t value)
{
    report_16((uint16_t)value);
    report_16((uint16_t)(value >> 16));
}

static void report_sample(const fathom_sample_t *sample)
{
    report_32(sample->time_us);
    report_16(sample->distance_mm);
    report_16(sample->sequence);
    GPIOR0 = sample->kind;
    GPIOR0 = sample->address;
    GPIOR0 = sample->probe;
    GPIOR1 = REPORT_SAMPLE;
}

static void report_error(fathom_status_t status)
{
    GPIOR0 = (uint8_t)-status;
    GPIOR1 = REPORT_ERROR;
}

static void report_counters(const uint16_t *counters, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) report_16(counters[i]);
    GPIOR1 = REPORT_COUNTERS;
}

/* What the test has written there: how to begin, and what to do while it runs. */
volatile uint8_t ordered;

static uint8_t await_orders(void)
{
    GPIOR1 = REPORT_READY;
    while (ordered == 0) continue;
    const uint8_t orders = ordered;
    ordered = 0;
    GPIOR1 = REPORT_BEGUN;
    return orders;
}

static uint8_t request[8], frame[16];
static fathom_line_t line;
static fathom_modbus_t modbus;
static fathom_a16_auto_t a16;
static fathom_a05_auto_t a05;
static fathom_hps167s_t hps[2];
static fathom_sensor_t sensors[2];

static fathom_avr_usart_config_t usart = {
    .request = request, .request_size = sizeof request, .line = {9600, FATHOM_PARITY_NONE, 1}};
static uint16_t counters[FATHOM_LINE_COUNTERS];

static fathom_line_parts_t line_parts = {.uart = &fathom_avr_usart0,
                                         .clock = &fathom_avr_clock,
                                         .frame = frame,
                                         .frame_size = sizeof frame,
                                         .find_echo = fathom_line_find_echo,
                                         .marks = fathom_line_marks,
                                         .count = fathom_line_count,
                                         .counters = counters};

static void set_up_rs485(uint8_t orders)
{
    usart.driver = (fathom_avr_pin_t){.port = &PORTD, .mask = _BV(PORTD3)};
    usart.line.baud = (orders & ORDER_115200) != 0 ? 115200 : 19200;
    usart.line.parity = FATHOM_PARITY_EVEN;
    line_parts.silence_us = FATHOM_T3_5_US(usart.line.baud, 11);
}

/* Returns how many sensors there are. */
static uint8_t begin(uint8_t orders)
{
    const uint8_t units = (orders & ORDER_TWO_UNITS) != 0 ? 2 : 1;
    if ((orders & ORDER_HPS167S) != 0) set_up_rs485(orders);
    if (!fathom_avr_usart0_init(&usart)) GPIOR2 = 1;
    sei();
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) GPIOR2 = 2;
    if ((orders & ORDER_A16) != 0) {
        if (fathom_a16_auto_init(&a16, &line, NULL) != FATHOM_OK) GPIOR2 = 3;
        sensors[0] = fathom_a16_auto_sensor(&a16);
    } else if ((orders & ORDER_A05) != 0) {
        if (fathom_a05_auto_init(&a05, &line, NULL) != FATHOM_OK) GPIOR2 = 4;
        sensors[0] = fathom_a05_auto_sensor(&a05);
    } else {
        modbus = fathom_modbus_client(&line);
        for (uint8_t i = 0; i < units; i++) {
            const fathom_hps167s_config_t config = {.modbus.address = (uint8_t)(1 + i),
                                                    .modbus.timeout_us = 100000,
                                                    .modbus.retries = (orders & ORDER_RETRY) != 0};
            if (fathom_hps167s_init(&hps[i], &modbus, &config) != FATHOM_OK) GPIOR2 = 5;
            sensors[i] = fathom_hps167s_sensor(&hps[i]);
        }
    }
    return units;
}

static void obey(uint8_t order)
{
    ordered = 0;
    GPIOR1 = REPORT_ASKED;
    if (order == ORDER_AWAY) _delay_ms(60);
    if (order != ORDER_COUNTERS) return;
    report_counters(counters, FATHOM_LINE_COUNTERS);
    const uint16_t port[] = {fathom_avr_usart0_counters.parity, fathom_avr_usart0_counters.framing,
                             fathom_avr_usart0_counters.overruns};
    report_counters(port, 3);
}

int main(void)
{
    fathom_avr_clock_init();
    const uint8_t orders = await_orders();
    const uint8_t count = begin(orders);
    for (;;) {
        bool has_sample = false;
        for (uint8_t i = 0; i < count; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensors[i], &sample);
            if (status == FATHOM_OK) report_sample(&sample);
            if (status < 0) report_error(status);
            has_sample |= status == FATHOM_OK;
        }
        if (ordered != 0) obey(ordered);
        if (has_sample && (orders & ORDER_HPS167S) == 0) continue; /* a frame of an A05 is four */
        if ((orders & ORDER_SLOW_LOOP) != 0)
            _delay_ms(20);
        else
            fathom_avr_idle(NULL, fathom_due_us(sensors, count));
    }
}
