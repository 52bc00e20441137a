/* SPDX-License-Identifier: MIT */
/* examples/rp2040/first.c with the parts of the bus set up by hand, for the figure that compares both. */
#include <stdio.h>

#include "fathom/fathom.h"
#include "fathom_rp2040.h"
#include "vectors.h"

static fathom_rp2040_idle_t idle = {.alarm = 1};
static fathom_rp2040_uart_t port;
static fathom_uart_t uart;
static uint8_t request[16], frame[32];
static const fathom_line_parts_t parts = {.uart = &uart,
                                          .clock = &fathom_rp2040_clock,
                                          .frame = frame,
                                          .frame_size = sizeof frame,
                                          .silence_us = FATHOM_T3_5_US(9600, 10),
                                          .find_echo = fathom_line_find_echo,
                                          .senders = &fathom_line_senders,
                                          .marks = fathom_line_marks};
static fathom_line_t line;
static fathom_a05_dyp_t bumper;

void uart1_irq(void) { fathom_rp2040_uart_interrupt(&port); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&port); }
void timer_irq_1(void) { fathom_rp2040_idle_alarm(&idle); }

int main(void)
{
    static const fathom_rp2040_uart_config_t config = {
        .wiring = {.clk_peri_hz = 125000000, .number = 1, .tx = 4, .rx = 5, .has_driver = true, .driver = 6},
        .line = {9600, FATHOM_PARITY_NONE, 1},
        .request = request,
        .request_size = sizeof request,
        .idle = &idle};
    fathom_rp2040_clock_init(12000000);
    fathom_rp2040_idle_init(&idle);
    if (!fathom_rp2040_uart_init(&port, &config)) return 1;
    uart = fathom_rp2040_uart(&port);
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return 1;
    if (fathom_a05_dyp_init(&bumper, &line, NULL) != FATHOM_OK) return 1;
    const fathom_sensor_t sensor = fathom_a05_dyp_sensor(&bumper);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
        if (status != FATHOM_OK)
            printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
        else if (sample.kind == FATHOM_TARGET)
            printf("probe %u: %u mm\n", sample.probe, sample.distance_mm);
        else
            printf("probe %u: %s\n", sample.probe,
                   sample.kind == FATHOM_NO_TARGET ? "nothing in range" : "no distance");
    }
}
