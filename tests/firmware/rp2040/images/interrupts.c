/* SPDX-License-Identifier: MIT */
/* Each path of the port that an interrupt may break into, once when it is told to: ../../interrupts/README.md. Nothing
 * but the port's function stands between the reports of its begin and its end. */
#include "../../interrupts/rp2040/calls.h"
#include "board.h"
#include "fathom_rp2040.h"
#include "interrupts_serial.h"
#include "rp2040.h"
#include "vectors.h"

#define REPORT RP2040_WATCHDOG_SCRATCH(CALLS_REPORT)
#define PATH(call)                                                                                           \
    do {                                                                                                     \
        REPORT = CALLS_BEGIN;                                                                                \
        call;                                                                                                \
        REPORT = CALLS_END;                                                                                  \
    } while (0)

enum { TX = 4, RX = 5, DRIVER = 6, OUTPUT = 7, ECHO = 3, SERIAL_TX = 0, SERIAL_RX = 1 };
enum { SERIAL_ALARM = 0, DRIVER_ALARM = 1, IDLE_ALARM = 2 };

extern calls_t calls;
extern fathom_rp2040_uart_t port;
extern fathom_edges_t edges;
calls_t calls;
fathom_rp2040_uart_t port;
fathom_edges_t edges;

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_edges_t echo;
static fathom_rp2040_uart_config_t config;
static uint8_t request[CALLS_REQUEST];
static fathom_uart_t uart;
static fathom_pin_t output, input;
static fathom_capture_t capture;

void uart0_irq(void) { serial_interrupt(RP2040_UART(0)); }
void uart1_irq(void) { fathom_rp2040_uart_interrupt(&port); }
void timer_irq_1(void) { fathom_rp2040_uart_alarm(&port); }
void timer_irq_2(void) { fathom_rp2040_idle_alarm(&idle); }
void io_irq_bank0(void) { fathom_rp2040_edges_interrupt(&echo); }

static int32_t receive(bool is_serial)
{
    fathom_rx_t rx = {0, 0};
    const uint32_t capacity = calls.length;
    int count;
    if (is_serial)
        PATH(count = serial_read(calls.bytes, capacity, &rx));
    else
        PATH(count = uart.read(uart.ctx, calls.bytes, capacity, &rx));
    calls.flags = rx.flags;
    calls.time_us[0] = rx.last_us;
    return count;
}

static int32_t send(bool is_serial)
{
    const uint32_t length = calls.length;
    int taken;
    if (is_serial)
        PATH(taken = serial_write(RP2040_UART(0), calls.bytes, length));
    else
        PATH(taken = uart.write(uart.ctx, calls.bytes, length));
    return taken;
}

static int32_t set_line(void)
{
    const fathom_line_settings_t line = {calls.baud, (uint8_t)calls.parity, (uint8_t)calls.stop_bits};
    int result;
    PATH(result = uart.set_line(uart.ctx, &line));
    return result;
}

static int32_t look(void)
{
    fathom_pulse_t pulse = {0, 0, false};
    int result;
    PATH(result = capture.take(capture.ctx, &pulse));
    calls.time_us[0] = pulse.width_us;
    calls.time_us[1] = pulse.end_us;
    calls.is_high = pulse.is_high;
    return result;
}

static int32_t call(uint32_t what)
{
    const bool flag = calls.flags != 0u;
    const uint32_t most_us = calls.time_us[0];
    uint32_t first_us = 0;
    uint32_t second_us = 0;
    int32_t result = 0;
    switch (what) {
    case CALL_NOW: /* twice: it is monotonic */
        PATH(first_us = fathom_rp2040_clock.now_us(NULL); second_us = fathom_rp2040_clock.now_us(NULL));
        break;
    case CALL_READ:
    case CALL_SERIAL_READ:
        return receive(what == CALL_SERIAL_READ);
    case CALL_WRITE:
    case CALL_SERIAL_WRITE:
        return send(what == CALL_SERIAL_WRITE);
    case CALL_SENT:
        PATH(result = uart.sent(uart.ctx));
        break;
    case CALL_LEAVES:
        PATH(first_us = uart.leaves_in_us(uart.ctx));
        break;
    case CALL_SERIAL_LEAVES:
        PATH(first_us = serial_leaves_in_us());
        break;
    case CALL_SET_LINE:
        return set_line();
    case CALL_SET_BREAK:
        PATH(result = uart.set_break(uart.ctx, flag));
        break;
    case CALL_ARM:
        PATH(capture.arm(capture.ctx));
        break;
    case CALL_TAKE:
        return look();
    case CALL_IDLE:
        PATH(fathom_rp2040_idle(&idle, most_us));
        break;
    case CALL_PIN:
        PATH(output.set(output.ctx, flag));
        break;
    case CALL_LEVEL:
        PATH(result = input.get(input.ctx));
        break;
    case CALL_EDGES_BEGIN: /* once more */
        PATH(fathom_rp2040_edges_init(&echo, &edges, ECHO, &idle));
        break;
    default:
        return -99;
    }
    calls.time_us[0] = first_us;
    calls.time_us[1] = second_us;
    return result;
}

int main(void)
{
    const uint32_t without = RP2040_WATCHDOG_SCRATCH(CALLS_WITHOUT);
    const fathom_rp2040_wiring_t wiring = {.clk_peri_hz = BOARD_CLK_PERI_HZ,
                                           .number = 1,
                                           .tx = TX,
                                           .rx = RX,
                                           .has_driver = (without & CALLS_NO_DRIVER) == 0u,
                                           .driver = DRIVER,
                                           .alarm = DRIVER_ALARM};
    const fathom_rp2040_wiring_t serial_wiring = {
        .clk_peri_hz = BOARD_CLK_PERI_HZ, .number = 0, .tx = SERIAL_TX, .rx = SERIAL_RX};
    const fathom_line_settings_t line = {19200, FATHOM_PARITY_EVEN, 1};
    fathom_rp2040_idle_t *const woken = (without & CALLS_NO_IDLE) == 0u ? &idle : NULL;
    config.wiring = wiring;
    config.line = line;
    config.request = request;
    config.request_size = sizeof request;
    config.idle = woken;
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    /* As the port's header advises: edges above all others. */
    RP2040_NVIC_IPR(RP2040_IRQ_TIMER_0 / 4) = 0x40404040;
    RP2040_NVIC_IPR(RP2040_IRQ_UART0 / 4) = 0x40404040;
    if (!fathom_rp2040_uart_init(&port, &config)) return 1;
    uart = fathom_rp2040_uart(&port);
    if (!fathom_rp2040_uart_setup(&serial_wiring, &line)) return 2;
    serial_begin(RP2040_UART(0), &line);
    RP2040_NVIC_ISER = UINT32_C(1) << RP2040_IRQ_UART0;
    output = fathom_rp2040_output(OUTPUT, false);
    input = fathom_rp2040_input(ECHO, false);
    fathom_edges_init(&edges, (without & CALLS_NO_PIN) == 0u ? &input : NULL);
    fathom_rp2040_edges_init(&echo, &edges, ECHO, woken);
    capture = fathom_edges_capture(&edges);
    REPORT = CALLS_READY;
    for (;;) {
        while (calls.call == 0u) __asm__ volatile("wfi"); /* which the host ends, too */
        calls.result = call(calls.call);
        calls.call = 0;
    }
}
