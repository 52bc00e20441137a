/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom_rp2040.h"
#include "report.h"
#include "rp2040.h"
#include "vectors.h"

/*
 * An A16 with PWM output: its RX at GPIO 2, its TX at GPIO 3. Readings go out as text on GPIO 0, 115200 8N1. The core
 * sleeps between the edges.
 */
enum { TRIGGER = 2, ECHO = 3, TEXT_TX = 0, TEXT_RX = 1, IDLE_ALARM = 3 };

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_edges_t echo;
static fathom_rp2040_uart_t text;

void io_irq_bank0(void) { fathom_rp2040_edges_interrupt(&echo); }
void uart0_irq(void) { fathom_rp2040_uart_interrupt(&text); }
void timer_irq_3(void) { fathom_rp2040_idle_alarm(&idle); }

int main(void)
{
    static uint8_t line_of_text[REPORT_SIZE];
    static const fathom_rp2040_uart_config_t text_config = {
        .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 0, .tx = TEXT_TX, .rx = TEXT_RX},
        .line = {.baud = 115200, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
        .request = line_of_text,
        .request_size = sizeof line_of_text,
    };
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    if (!fathom_rp2040_uart_init(&text, &text_config)) return 1;
    const fathom_uart_t out = fathom_rp2040_uart(&text);

    /* The edges first: all others one step below the highest priority, which is where they start. */
    RP2040_NVIC_IPR(RP2040_IRQ_TIMER_0 / 4) = 0x40404040;
    RP2040_NVIC_IPR(RP2040_IRQ_UART0 / 4) = 0x40404040;

    const fathom_pin_t trigger = fathom_rp2040_output(TRIGGER, true);
    const fathom_pin_t level = fathom_rp2040_input(ECHO, false);
    fathom_edges_t edges;
    fathom_edges_init(&edges, &level);
    fathom_rp2040_edges_init(&echo, &edges, ECHO, &idle);
    const fathom_capture_t capture = fathom_edges_capture(&edges);

    fathom_a16_pwm_t a16;
    const fathom_output_t output = fathom_output_pin(&trigger);
    if (fathom_a16_pwm_init(&a16, &capture, &fathom_rp2040_clock, &output, NULL) != FATHOM_OK) return 2;
    const fathom_sensor_t sensor = fathom_a16_pwm_sensor(&a16);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
        report(&out, status, &sample);
    }
}
