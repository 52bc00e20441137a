/* SPDX-License-Identifier: MIT */
/* What each of the five UARTs can be set to, and what its port refuses. */
#include "check.h"
#include "fathom_mps2.h"
#include "start.h"

enum { UARTS = 5, BAUDDIV = 0x10 / 4, CTRL = 0x08 / 4 };

static fathom_mps2_uart_t uarts[UARTS];
static uint8_t request[8];

void uart0_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[0]); }
void uart1_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[1]); }
void uart2_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[2]); }
void uart3_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[3]); }
void uart4_interrupt(void) { fathom_mps2_uart_interrupt(&uarts[4]); }

static void set_all(const fathom_uart_t *uart, const volatile uint32_t *registers)
{
    /* 25 MHz by the rate, rounded. */
    check(set(uart, 9600, FATHOM_PARITY_NONE, 1) == 1 && registers[BAUDDIV] == 2604, "9600 baud are 2604");
    check(set(uart, 57600, FATHOM_PARITY_NONE, 1) == 1 && registers[BAUDDIV] == 434, "57600 baud are 434");
    check(set(uart, 115200, FATHOM_PARITY_NONE, 1) == 1 && registers[BAUDDIV] == 217, "115200 baud are 217");
    check(set(uart, 230400, FATHOM_PARITY_NONE, 1) == 1 && registers[BAUDDIV] == 109, "230400 baud are 109");
    check(set(uart, 230400, FATHOM_PARITY_EVEN, 1) < 0, "even parity is refused");
    check(set(uart, 9600, FATHOM_PARITY_NONE, 2) < 0, "two stop bits are refused");
    check(set(uart, 1600000, FATHOM_PARITY_NONE, 1) < 0, "1600000 baud are refused");
    check(set(uart, 1515000, FATHOM_PARITY_NONE, 1) < 0, "1515000 baud, off by 3 %, are refused");
    check(set(uart, 20, FATHOM_PARITY_NONE, 1) < 0, "20 baud are refused");
    check(set(uart, 0, FATHOM_PARITY_NONE, 1) < 0, "0 baud are refused");
    check(registers[BAUDDIV] == 109, "after which it is as it was");
}

int main(void)
{
    static const uint32_t bases[UARTS] = {0x40004000, 0x40005000, 0x40006000, 0x40007000, 0x40009000};
    fathom_mps2_uart_config_t config = {request, sizeof request, 0, {19200, FATHOM_PARITY_NONE, 1}};
    fathom_rx_t rx = {0, 0};
    uint8_t byte;
    fathom_mps2_clock_begin();
    for (uint8_t i = 0; i != UARTS; i++) {
        const volatile uint32_t *const registers = (const volatile uint32_t *)bases[i];
        config.number = i;
        check(registers[CTRL] == 0, "a UART is off before its begin");
        check(fathom_mps2_uart_begin(&uarts[i], &config) && registers[BAUDDIV] == 1302,
              "and has 19200 after it");
    }
    const fathom_uart_t uart = fathom_mps2_uart(&uarts[4]);
    set_all(&uart, (const volatile uint32_t *)bases[4]);
    check(uart.set_break == 0, "it has no break");
    check(uart.read(uart.ctx, &byte, 1, &rx) == 0, "nothing has come");
    __asm__ volatile("cpsid i"); /* QEMU takes a byte at once, so that interrupts would take all */
    check_request(&uart, sizeof request, 348); /* 8 characters of 10 bits at 230400 baud */
    check(set(&uart, 230400, FATHOM_PARITY_NONE, 1) == 1, "but the same one");
    __asm__ volatile("cpsie i");
    const uint32_t since_us = fathom_mps2_clock.now_us(0);
    while (!uart.sent(uart.ctx) && fathom_elapsed_us(fathom_mps2_clock.now_us(0), since_us) < 100000)
        continue;
    /* At 230400 baud a character is 43 us. */
    check_within(fathom_elapsed_us(fathom_mps2_clock.now_us(0), since_us), 30, 500, "until it has left");
    check(set(&uart, 9600, FATHOM_PARITY_NONE, 1) == 1, "when it is set");
    config.number = 5;
    check(!fathom_mps2_uart_begin(&uarts[0], &config), "there is no sixth UART");
    config.number = 0;
    config.request = 0;
    check(!fathom_mps2_uart_begin(&uarts[0], &config), "without memory there is no beginning");
    return check_result();
}
