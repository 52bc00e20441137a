/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "dma_uart.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom_rp2040.h"
#include "report.h"
#include "vectors.h"

/*
 * An A16 that sends by itself (UART automatic, or RS232), received by DMA: its TX at GPIO 5, its RX at GPIO 4, which
 * idles high: the processed value. Readings go out as text on GPIO 0, 115200 8N1. The core sleeps while bytes come.
 */
enum { A16_RX = 4, A16_TX = 5, TEXT_TX = 0, TEXT_RX = 1, LOOK_ALARM = 0, IDLE_ALARM = 3, CHANNEL = 2 };

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_uart_t text;
dma_uart_t a16_line;

void uart0_irq(void) { fathom_rp2040_uart_interrupt(&text); }
void dma_irq_0(void) { dma_uart_ended(&a16_line); }
void io_irq_bank0(void) { dma_uart_edge(&a16_line); }
void timer_irq_0(void) { dma_uart_look(&a16_line); }
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
    static const dma_uart_config_t dma_config = {
        .wiring =
            {.clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 1, .tx = A16_RX, .rx = A16_TX, .alarm = LOOK_ALARM},
        .line = {.baud = 9600, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
        .channel = CHANNEL,
        .idle = &idle,
    };
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    if (!fathom_rp2040_uart_init(&text, &text_config)) return 1;
    if (!dma_uart_begin(&a16_line, &dma_config)) return 2;
    const fathom_uart_t out = fathom_rp2040_uart(&text);
    const fathom_uart_t wire = dma_uart(&a16_line);

    uint8_t frame[16];
    fathom_line_t line;
    /* What the UART marks as bad is counted: FATHOM_LINE_BAD_BYTES. */
    static uint16_t counters[FATHOM_LINE_COUNTERS];
    const fathom_line_parts_t line_parts = {.uart = &wire,
                                            .clock = &fathom_rp2040_clock,
                                            .frame = frame,
                                            .frame_size = sizeof frame,
                                            .marks = fathom_line_marks,
                                            .count = fathom_line_count,
                                            .counters = counters};
    if (fathom_line_init_listening(&line, &line_parts) != FATHOM_OK) return 3;
    fathom_a16_auto_t a16;
    if (fathom_a16_auto_init(&a16, &line, NULL) != FATHOM_OK) return 4;
    const fathom_sensor_t sensor = fathom_a16_auto_sensor(&a16);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
        report(&out, status, &sample);
    }
}
