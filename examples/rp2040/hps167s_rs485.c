/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_rp2040.h"
#include "report.h"
#include "vectors.h"

/*
 * An HPS-167S with its factory settings, address 1 and 19200 8E1, behind an RS-485 transceiver for 3.3 V, as the
 * MAX3485 (a pin does not stand 5 V): DI at GPIO 4, RO at GPIO 5, DE and /RE at GPIO 6. Readings go out as text on GPIO
 * 0, 115200 8N1. The core sleeps between the bytes.
 */
enum { DI = 4, RO = 5, DE = 6, TEXT_TX = 0, TEXT_RX = 1, DE_ALARM = 0, IDLE_ALARM = 3 };

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_uart_t text;
static fathom_rp2040_uart_t rs485;

void uart0_irq(void) { fathom_rp2040_uart_interrupt(&text); }
void uart1_irq(void) { fathom_rp2040_uart_interrupt(&rs485); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&rs485); }
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
    static uint8_t request[8];
    static const fathom_rp2040_uart_config_t rs485_config = {
        .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ,
                   .number = 1,
                   .tx = DI,
                   .rx = RO,
                   .has_driver = true,
                   .driver = DE,
                   .alarm = DE_ALARM},
        .line = {.baud = 19200, .parity = FATHOM_PARITY_EVEN, .stop_bits = 1},
        .request = request,
        .request_size = sizeof request,
        .idle = &idle,
    };
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    if (!fathom_rp2040_uart_init(&text, &text_config)) return 1;
    if (!fathom_rp2040_uart_init(&rs485, &rs485_config)) return 2;
    const fathom_uart_t out = fathom_rp2040_uart(&text);
    const fathom_uart_t wire = fathom_rp2040_uart(&rs485);

    uint8_t frame[32];
    fathom_line_t line;
    const fathom_line_parts_t line_parts = {
        .uart = &wire,
        .clock = &fathom_rp2040_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .senders = &fathom_line_senders, /* with factory settings the sensor sends measurements unasked */
        .silence_us = FATHOM_T3_5_US(19200, 11),
    };
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) return 3;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);

    fathom_hps167s_t hps;
    if (fathom_hps167s_init(&hps, &modbus, NULL) != FATHOM_OK) return 4;
    const fathom_sensor_t sensor = fathom_hps167s_sensor(&hps);
    for (;;) {
        fathom_sample_t sample;
        const fathom_status_t status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
        report(&out, status, &sample);
    }
}
