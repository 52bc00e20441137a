/* SPDX-License-Identifier: MIT */
/* What each of the six USARTs is set to, in the registers, which QEMU keeps though no wire sees them. */
#include "board.h"
#include "check.h"
#include "fathom_stm32f4.h"
#include "start.h"

enum { USARTS = 6, BRR = 0x08 / 4, CR1 = 0x0C / 4, CR2 = 0x10 / 4 };
enum { PCLK1_HZ = 42000000, QEMU_TIMER_HZ = 1000000000 };

static fathom_stm32f4_usart_t usart;
static uint8_t request[8];

void usart2_interrupt(void) {}
void tim5_interrupt(void) { fathom_stm32f4_tim5_interrupt(); }

static uint32_t slept(uint32_t max_us)
{
    fathom_stm32f4_idle_t idle = {&usart, 1};
    return slept_us(&fathom_stm32f4_clock, fathom_stm32f4_idle, &idle, max_us);
}

static void set_all(const fathom_uart_t *uart, const volatile uint32_t *registers)
{
    /* BRR: 42 MHz by the rate, rounded. CR1: UE 2000, M 1000, PCE 0400, PS 0200, RXNEIE 0020, TE 0008, RE 0004. CR2:
     * 2 stop bits 2000. */
    check(set(uart, 9600, FATHOM_PARITY_NONE, 1) == 1 && registers[BRR] == 4375, "9600 baud are 4375");
    check(registers[CR1] == 0x202C && registers[CR2] == 0, "8N1 is a word of 8 bits");
    check(set(uart, 19200, FATHOM_PARITY_EVEN, 1) == 1 && registers[BRR] == 2188, "19200 baud are 2188");
    check(registers[CR1] == 0x342C && registers[CR2] == 0, "8E1 is a word of 9 bits with parity");
    check(set(uart, 115200, FATHOM_PARITY_ODD, 1) == 1 && registers[BRR] == 365, "115200 baud are 365");
    check(registers[CR1] == 0x362C && registers[CR2] == 0, "8O1 has odd parity");
    check(set(uart, 230400, FATHOM_PARITY_NONE, 2) == 1 && registers[BRR] == 182, "230400 baud are 182");
    check(registers[CR1] == 0x202C && registers[CR2] == 0x2000, "8N2 has two stop bits");
    check(set(uart, 230400, 3, 1) < 0, "there is no fourth parity");
    check(set(uart, 230400, FATHOM_PARITY_NONE, 3) < 0, "there are no three stop bits");
    check(set(uart, 2700000, FATHOM_PARITY_NONE, 1) < 0, "2700000 baud are refused");
    check(set(uart, 2545000, FATHOM_PARITY_NONE, 1) < 0, "2545000 baud, off by 2.9 %, are refused");
    check(set(uart, 600, FATHOM_PARITY_NONE, 1) < 0, "600 baud are refused");
    check(set(uart, 0, FATHOM_PARITY_NONE, 1) < 0, "0 baud are refused");
    check(registers[BRR] == 182 && registers[CR1] == 0x202C, "after which it is as it was");
}

int main(void)
{
    static const uint32_t bases[USARTS] = {0x40011000, 0x40004400, 0x40004800,
                                           0x40004C00, 0x40005000, 0x40011400};
    static const uint8_t many[8];
    fathom_stm32f4_usart_config_t config = {.request = request,
                                            .request_size = sizeof request,
                                            .bus_hz = PCLK1_HZ,
                                            .line = {19200, FATHOM_PARITY_EVEN, 1},
                                            .tx = {'A', 2},
                                            .rx = {'A', 3}};
    for (uint8_t i = 0; i != USARTS; i++) {
        const volatile uint32_t *const registers = (const volatile uint32_t *)bases[i];
        config.number = (uint8_t)(i + 1);
        check(registers[CR1] == 0, "a USART is off before its begin");
        check(fathom_stm32f4_usart_init(&usart, &config) && registers[BRR] == 2188, "and has 19200 after it");
    }
    fathom_stm32f4_clock_init(QEMU_TIMER_HZ);
    const fathom_uart_t uart = fathom_stm32f4_usart(&usart);
    set_all(&uart, (const volatile uint32_t *)bases[USARTS - 1]);

    check_request(&uart, sizeof request, 382); /* 8 characters of 11 bits at 230400 baud */
    check(uart.set_break(uart.ctx, true) == 0, "and no break");
    for (int i = 0; i != 9; i++) fathom_stm32f4_usart_interrupt(&usart); /* a byte each, and TXEIE for TCIE */
    check(!uart.sent(uart.ctx), "until its last stop bit");
    fathom_stm32f4_usart_interrupt(&usart);
    check(uart.sent(uart.ctx), "which ends it");
    check_within(slept(50000), 0, 100, "and the next sleep: it came before WFI");
    check_within(slept(50000), 50000, 500000, "but no other");
    check(uart.set_break(uart.ctx, true) == 1, "a break is taken");
    check(uart.write(uart.ctx, many, 8) == 0, "during which nothing leaves");
    check(uart.set_break(uart.ctx, false) == 1 && uart.write(uart.ctx, many, 8) == 8, "until it is over");

    config.number = 7;
    check(!fathom_stm32f4_usart_init(&usart, &config), "there is no USART 7");
    config.number = 0;
    check(!fathom_stm32f4_usart_init(&usart, &config), "and no USART 0");
    config.number = 1;
    config.tx.number = 16;
    check(!fathom_stm32f4_usart_init(&usart, &config), "and no PA16");
    return check_result();
}
