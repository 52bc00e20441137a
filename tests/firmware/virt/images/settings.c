/* SPDX-License-Identifier: MIT */
/* What the UART can be set to, and what its port refuses. */
#include "check.h"
#include "fathom_virt.h"
#include "start.h"

static volatile uint8_t *const registers = (volatile uint8_t *)0x10000000;
enum { IER = 1, LCR = 3 };

static fathom_virt_uart_t port;
static uint8_t request[20];

void external_interrupt(void) { fathom_virt_external_interrupt(&port); }

static uint32_t divisor(void)
{
    registers[LCR] |= 0x80;
    const uint32_t low = registers[0];
    const uint32_t high = registers[1];
    registers[LCR] &= 0x7F;
    return high << 8 | low;
}

int main(void)
{
    static const uint8_t many[8];
    fathom_virt_uart_config_t config = {request, sizeof request, FATHOM_VIRT_UART_HZ, {115200, 0, 1}};
    check(!fathom_virt_uart_begin(&port, &config), "with this clock there are no 115200 baud");
    config.clock_hz = 3686400; /* 16 * 230400 */
    check(fathom_virt_uart_begin(&port, &config) && divisor() == 2, "with 3.6864 MHz they are 2");
    const fathom_uart_t uart = fathom_virt_uart(&port);
    /* LCR: 8 bits 03, 2 stop bits 04, parity 08, even 10, break 40. */
    check(set(&uart, 9600, FATHOM_PARITY_NONE, 1) == 1 && divisor() == 24, "9600 baud are 24");
    check(registers[LCR] == 0x03, "8N1");
    check(set(&uart, 19200, FATHOM_PARITY_EVEN, 1) == 1 && divisor() == 12, "19200 baud are 12");
    check(registers[LCR] == 0x1B, "8E1");
    check(set(&uart, 57600, FATHOM_PARITY_ODD, 1) == 1 && divisor() == 4, "57600 baud are 4");
    check(registers[LCR] == 0x0B, "8O1");
    check(set(&uart, 300, FATHOM_PARITY_NONE, 2) == 1 && divisor() == 768, "300 baud are 768");
    check(registers[LCR] == 0x07, "8N2");
    check(set(&uart, 9600, 3, 1) < 0, "there is no fourth parity");
    check(set(&uart, 9600, FATHOM_PARITY_NONE, 3) < 0, "there are no three stop bits");
    check(set(&uart, 0, FATHOM_PARITY_NONE, 1) < 0, "0 baud are refused");
    check(set(&uart, 3, FATHOM_PARITY_NONE, 1) < 0, "3 baud are refused");
    check(set(&uart, 250000, FATHOM_PARITY_NONE, 1) < 0, "250000 baud, off by 8 %, are refused");
    check(divisor() == 768 && registers[LCR] == 0x07, "after which it is as it was");
    check((registers[IER] & 1) != 0, "and receives");

    check(uart.set_break(uart.ctx, true) == 1 && registers[LCR] == 0x47, "a break is held");
    check(uart.write(uart.ctx, many, 8) == 0, "during which nothing leaves");
    check(set(&uart, 9600, FATHOM_PARITY_NONE, 1) == 0 && registers[LCR] == 0x47,
          "and no other rate ends it");
    check(uart.set_break(uart.ctx, false) == 1 && registers[LCR] == 0x07, "until it is over");
    registers[IER] |= 2; /* as write does after a byte's interrupt has sent all */
    check((registers[IER] & 2) == 0, "room for bytes that are not there interrupts once");
    __asm__ volatile(
        "csrc mstatus, %0" ::"r"(8)); /* QEMU takes a FIFO at once, so that interrupts would take all */
    check_request(&uart, sizeof request, 733334); /* 20 characters of 11 bits at 300 baud */
    check(uart.set_break(uart.ctx, true) == 0, "and no break");
    __asm__ volatile("csrs mstatus, %0" ::"r"(8));
    const uint32_t since_us = fathom_virt_clock.now_us(0);
    while (!uart.sent(uart.ctx) && fathom_elapsed_us(fathom_virt_clock.now_us(0), since_us) < 100000)
        continue;
    check(set(&uart, 9600, FATHOM_PARITY_NONE, 1) == 1, "until it has left");
    return check_result();
}
