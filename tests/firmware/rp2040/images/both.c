/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_rp2040.h"
#include "report.h"
#include "rp2040.h"
#include "vectors.h"

/*
 * An A16 by pulse and an HPS-167S over RS-485 in one loop that never sleeps and comes round every SCRATCH2 us (0: as
 * often as it can), wired as in the two examples. Both report on UART0; who it was is told by the distances.
 */
enum { TRIGGER = 2, ECHO = 3, DI = 4, RO = 5, DE = 6, TEXT_TX = 0, TEXT_RX = 1, DE_ALARM = 0 };

static fathom_rp2040_edges_t echo;
static fathom_rp2040_uart_t text;
static fathom_rp2040_uart_t rs485;
static uint8_t line_of_text[REPORT_SIZE];
static uint8_t request[8];

void io_irq_bank0(void) { fathom_rp2040_edges_interrupt(&echo); }
void uart0_irq(void) { fathom_rp2040_uart_interrupt(&text); }
void uart1_irq(void) { fathom_rp2040_uart_interrupt(&rs485); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&rs485); }

static const fathom_rp2040_uart_config_t text_config = {
    .wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 0, .tx = TEXT_TX, .rx = TEXT_RX},
    .line = {.baud = 115200, .parity = FATHOM_PARITY_NONE, .stop_bits = 1},
    .request = line_of_text,
    .request_size = sizeof line_of_text,
};

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
};

/* Their names are for the test, which times them. */
fathom_status_t poll_a16(const fathom_sensor_t *a16, fathom_sample_t *sample);
fathom_status_t poll_hps167s(const fathom_sensor_t *hps, fathom_sample_t *sample);

__attribute__((noinline)) fathom_status_t poll_a16(const fathom_sensor_t *a16, fathom_sample_t *sample)
{
    return fathom_poll(a16, sample);
}

__attribute__((noinline)) fathom_status_t poll_hps167s(const fathom_sensor_t *hps, fathom_sample_t *sample)
{
    return fathom_poll(hps, sample);
}

int main(void)
{
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    if (!fathom_rp2040_uart_init(&text, &text_config)) return 1;
    if (!fathom_rp2040_uart_init(&rs485, &rs485_config)) return 2;
    RP2040_NVIC_IPR(RP2040_IRQ_TIMER_0 / 4) = 0x40404040;
    RP2040_NVIC_IPR(RP2040_IRQ_UART0 / 4) = 0x40404040;
    const fathom_uart_t out = fathom_rp2040_uart(&text);
    const fathom_uart_t wire = fathom_rp2040_uart(&rs485);

    const fathom_pin_t trigger = fathom_rp2040_output(TRIGGER, true);
    const fathom_pin_t level = fathom_rp2040_input(ECHO, false);
    fathom_edges_t edges;
    fathom_edges_init(&edges, &level);
    fathom_rp2040_edges_init(&echo, &edges, ECHO, NULL);
    const fathom_capture_t capture = fathom_edges_capture(&edges);
    fathom_a16_pwm_t a16;
    const fathom_output_t output = fathom_output_pin(&trigger);
    if (fathom_a16_pwm_init(&a16, &capture, &fathom_rp2040_clock, &output, NULL) != FATHOM_OK) return 3;

    uint8_t frame[32];
    fathom_line_t line;
    const fathom_line_parts_t line_parts = {
        .uart = &wire,
        .clock = &fathom_rp2040_clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .echo = FATHOM_LINE_ECHO_OFF,
        .marks = fathom_line_marks,
        .silence_us = FATHOM_T3_5_US(19200, 11),
    };
    if (fathom_line_init(&line, &line_parts) != FATHOM_OK) return 4;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    fathom_hps167s_t hps;
    if (fathom_hps167s_init(&hps, &modbus, NULL) != FATHOM_OK) return 5;

    const fathom_sensor_t pulse = fathom_a16_pwm_sensor(&a16);
    const fathom_sensor_t modbus_sensor = fathom_hps167s_sensor(&hps);
    const uint32_t round_us = RP2040_WATCHDOG_SCRATCH(2);
    uint32_t since_us = RP2040_TIMER_RAWL;
    for (;;) {
        fathom_sample_t sample;
        fathom_status_t status = poll_a16(&pulse, &sample);
        if (status != FATHOM_PENDING) report(&out, status, &sample);
        status = poll_hps167s(&modbus_sensor, &sample);
        if (status != FATHOM_PENDING) report(&out, status, &sample);
        while (fathom_elapsed_us(RP2040_TIMER_RAWL, since_us) < round_us) {
        }
        since_us = RP2040_TIMER_RAWL;
    }
}
