/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "fathom_rp2040.h"
#include "rp2040.h"
#include "vectors.h"

/*
 * The port's functions, one at a time, as the test asks for them: it writes the desk's operation, arguments and bytes,
 * then 1 to `ask`, and waits until that is 0 again. desk.js has the same layout.
 */
enum { BEGIN, READ, WRITE, SENT, SET_LINE, SET_BREAK, IDLE, OUTPUT, SET, INPUT, GET, NOW, COUNTER, LEAVES };
enum { DE_ALARM = 1, IDLE_ALARM = 2, REQUEST_SIZE = 200 };

typedef struct {
    volatile uint32_t ask;
    uint32_t operation, argument[8];
    int32_t result;
    uint32_t flags, last_us;
    uint8_t bytes[256];
} desk_t;

extern desk_t desk;
desk_t desk;

static fathom_rp2040_idle_t idle = {.alarm = IDLE_ALARM};
static fathom_rp2040_uart_t port;
static fathom_rp2040_uart_config_t config;
static fathom_uart_t uart;
static fathom_pin_t pin;
static uint8_t request[REQUEST_SIZE];

void uart0_irq(void) { fathom_rp2040_uart_interrupt(&port); }
void uart1_irq(void) { fathom_rp2040_uart_interrupt(&port); }
void timer_irq_1(void) { fathom_rp2040_uart_alarm(&port); }
void timer_irq_2(void) { fathom_rp2040_idle_alarm(&idle); }

static fathom_line_settings_t settings(const uint32_t *argument)
{
    const fathom_line_settings_t line = {argument[0], (uint8_t)argument[1], (uint8_t)argument[2]};
    return line;
}

/* argument: baud, parity, stop bits; number, tx, rx, driver (or 255); clk_peri */
static bool begin(const uint32_t *argument)
{
    const fathom_rp2040_uart_config_t wanted = {
        .wiring = {.clk_peri_hz = argument[7],
                   .number = (uint8_t)argument[3],
                   .tx = (uint8_t)argument[4],
                   .rx = (uint8_t)argument[5],
                   .has_driver = argument[6] != 255,
                   .driver = (uint8_t)argument[6],
                   .alarm = DE_ALARM},
        .line = settings(argument),
        .request = request,
        .request_size = sizeof request,
        .idle = &idle,
    };
    config = wanted;
    if (!fathom_rp2040_uart_init(&port, &config)) return false;
    uart = fathom_rp2040_uart(&port);
    return true;
}

static int32_t do_it(const uint32_t *argument)
{
    const fathom_line_settings_t line = settings(argument);
    fathom_rx_t rx = {0, 0};
    int32_t result = 0;
    switch (desk.operation) {
    case BEGIN:
        return begin(argument);
    case READ:
        result = uart.read(uart.ctx, desk.bytes, argument[0], &rx);
        desk.flags = rx.flags;
        desk.last_us = rx.last_us;
        return result;
    case WRITE:
        return uart.write(uart.ctx, desk.bytes, argument[0]);
    case SENT:
        return uart.sent(uart.ctx);
    case SET_LINE:
        return uart.set_line(uart.ctx, &line);
    case SET_BREAK:
        return uart.set_break(uart.ctx, argument[0] != 0);
    case IDLE:
        fathom_rp2040_idle(&idle, argument[0]);
        return 0;
    case OUTPUT:
        pin = fathom_rp2040_output(argument[0], argument[1] != 0);
        return 0;
    case SET:
        pin.set(pin.ctx, argument[0] != 0);
        return 0;
    case INPUT:
        pin = fathom_rp2040_input(argument[0], argument[1] != 0);
        return 0;
    case GET:
        return pin.get(pin.ctx);
    case NOW:
        return (int32_t)fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx);
    case COUNTER:
        return argument[0] == 0 ? port.parity : (argument[0] == 1 ? port.framing : port.overruns);
    case LEAVES:
        return (int32_t)uart.leaves_in_us(uart.ctx);
    default:
        return -99;
    }
}

int main(void)
{
    fathom_rp2040_clock_init(BOARD_CLK_REF_HZ);
    fathom_rp2040_idle_init(&idle);
    for (;;) {
        while (desk.ask == 0) __asm__ volatile("wfi"); /* which the test ends, too */
        desk.result = do_it(desk.argument);
        desk.ask = 0;
    }
}
