/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/engine/wait.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_rp2040.h"
#include "report.h"
#include "vectors.h"

/*
 * An HPS-167S on a battery: it has power, by GPIO 7, for one reading every BATTERY_MINUTES, and most of that is its
 * warm-up of 5 s. GPIO 7 is the input of a switch for the sensor's 5 to 15 V. Wired as in hps167s_rs485.c otherwise;
 * the transceiver keeps its power, since GPIO 4, which idles high, would feed one without through its input. The core
 * sleeps all the time but for the bytes and a look at the clock once a minute. WFI alone leaves the clocks on; who
 * stops them too has to keep TIMER going, or to start again from the top of main.
 */
#ifndef BATTERY_MINUTES
#define BATTERY_MINUTES 10
#endif
#define MINUTE_US 60000000u

enum { DI = 4, RO = 5, DE = 6, POWER = 7, TEXT_TX = 0, TEXT_RX = 1, DE_ALARM = 0, IDLE_ALARM = 3 };

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_uart_t text;
static fathom_rp2040_uart_t rs485;

void uart0_irq(void) { fathom_rp2040_uart_interrupt(&text); }
void uart1_irq(void) { fathom_rp2040_uart_interrupt(&rs485); }
void timer_irq_0(void) { fathom_rp2040_uart_alarm(&rs485); }
void timer_irq_3(void) { fathom_rp2040_idle_alarm(&idle); }

static uint32_t now_us(void) { return fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx); }

/* Minute by minute, since the clock wraps after 71 of them: no span that is compared may be as long. *since_us moves on
 * by whole minutes, so that what a reading takes does not add up. */
static void sleep(unsigned minutes, uint32_t *since_us)
{
    for (; minutes != 0; minutes--) {
        uint32_t passed_us;
        while ((passed_us = fathom_elapsed_us(now_us(), *since_us)) < MINUTE_US)
            fathom_rp2040_idle(&idle, MINUTE_US - passed_us); /* any interrupt ends it */
        *since_us += MINUTE_US;
    }
}

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
    const fathom_pin_t power = fathom_rp2040_output(POWER, false);
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

    uint32_t since_us = now_us();
    for (;;) {
        fathom_sample_t sample;
        fathom_status_t status;
        power.set(power.ctx, true);
        fathom_line_flush(
            &line); /* drops what arrived during the sleep, a glitch of the switch for example */
        fathom_hps167s_power_on(&hps); /* also forgets a request from before the sleep */
        do status = fathom_wait(&sensor, &sample, fathom_rp2040_idle, &idle);
        while (status == FATHOM_ERR_WARMING_UP); /* which ends by itself */
        power.set(power.ctx, false);
        report(&out, status, &sample);
        sleep(BATTERY_MINUTES, &since_us);
        fathom_line_flush(&line); /* Bytes that arrived during the sleep are no response of now. */
    }
}
