/* SPDX-License-Identifier: MIT */
/* What port/stm32f4 does to the registers that no simulator here has: captures, pins, the errors of a USART. Memory
 * lies in their place, at their addresses (RM0090 2.3), which the test reads and sets. It has no side effects: a
 * register keeps what was written to it last. */
#define _GNU_SOURCE 1 /* MAP_FIXED_NOREPLACE */
#include <stdlib.h>
#include <sys/mman.h>

#include "suite.h"

#include "internal/stm32f4_port.h"

#define PERIPHERALS ((void *)0x40000000)
enum { LENGTH = 0x24000 };

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))
#define TIM2_AT(offset)   REGISTER(0x40000000 + (offset))
#define USART2_AT(offset) REGISTER(0x40004400 + (offset))
#define GPIOA_AT(offset)  REGISTER(0x40020000 + (offset))
#define GPIOB_AT(offset)  REGISTER(0x40020400 + (offset))
enum { SR = 0x00, DR = 0x04, CR1 = 0x0C };                                                /* of a USART */
enum { MODER = 0x00, PUPDR = 0x0C, IDR = 0x10, BSRR = 0x18, AFRL = 0x20 };                /* of a port */
enum { PE = 0x01, FE = 0x02, NE = 0x04, ORE = 0x08, RXNE = 0x20, TC = 0x40, TXE = 0x80 }; /* in SR */
enum { CC1IF = 2, CC2IF = 4, CC1OF = 0x200 }; /* in SR of a timer */

static uint8_t enabled; /* the interrupt */
volatile uint8_t fathom_stm32f4_happened;
void fathom_stm32f4_enable_interrupt(uint8_t number) { enabled = number; }

static void map(unsigned round)
{
    if (mmap(PERIPHERALS, LENGTH, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE,
             -1, 0) != PERIPHERALS)
        abort();
}

/* ---- the capture ---- */

static fathom_edges_t edges;
static fathom_capture_t capture;
static fathom_pulse_t pulse;

static int begin_capture(void **state)
{
    static const fathom_stm32f4_pin_t pa0 = {'A', 0};
    memset(PERIPHERALS, 0, LENGTH);
    fathom_stm32f4_happened = 0;
    fathom_edges_init(&edges, NULL);
    capture = fathom_edges_capture(&edges);
    if (!fathom_stm32f4_capture_init(&pa0, &edges)) return -1;
    capture.arm(capture.ctx);
    return 0;
}

static const suite_t suite = {.set_up = begin_capture, .begin_round = map};

static void captured(uint32_t flags, uint32_t rise_us, uint32_t fall_us)
{
    TIM2_AT(0x10) = flags;
    TIM2_AT(0x34) = rise_us;
    TIM2_AT(0x38) = fall_us;
    fathom_stm32f4_tim2_interrupt();
}

static void assert_pulse(uint32_t width_us, uint32_t end_us)
{
    assert_int_equal(capture.take(capture.ctx, &pulse), 1);
    assert_int_equal(pulse.width_us, width_us);
    assert_int_equal(pulse.end_us, end_us);
}

TEST(the_captures_are_set_up_for_both_edges_of_ti1)
{
    assert_int_equal(TIM2_AT(0x18), 0x3231); /* CCMR1: CC1S 01, CC2S 10, IC1F and IC2F 0011 (RM0090 18.4.7) */
    assert_int_equal(TIM2_AT(0x20), 0x0031); /* CCER: CC1E, CC2E, CC2P (18.4.9) */
    assert_int_equal(TIM2_AT(0x0C), 0x0006); /* DIER: CC1IE, CC2IE (18.4.4) */
    assert_int_equal(enabled, 28);
    assert_int_equal(GPIOA_AT(MODER) & 3, 2);
    assert_int_equal(GPIOA_AT(AFRL) & 15, 1);
    assert_int_equal(REGISTER(0x40023830) & 1, 1); /* AHB1ENR: GPIOA */
}

TEST(only_the_pins_of_tim2_ch1_are_taken)
{
    static const fathom_stm32f4_pin_t others[] = {{'A', 1}, {'B', 0}, {'A', 16}, {0, 0}};
    static const fathom_stm32f4_pin_t pa5 = {'A', 5};
    static const fathom_stm32f4_pin_t pa15 = {'A', 15};
    for (size_t i = 0; i != sizeof others / sizeof others[0]; i++)
        assert_false(fathom_stm32f4_capture_init(&others[i], &edges));
    assert_true(fathom_stm32f4_capture_init(&pa5, &edges));
    assert_true(fathom_stm32f4_capture_init(&pa15, &edges));
    assert_int_equal(GPIOA_AT(AFRL + 4) >> 28, 1);
}

TEST(both_in_one_interrupt_are_a_pulse_also_across_the_wrap_of_the_clock)
{
    captured(CC1IF | CC2IF, 1000, 4000);
    assert_pulse(3000, 4000);
    captured(CC1IF | CC2IF, 0xFFFFFFF0, 90000);
    assert_pulse(90016, 90000);
}

TEST(a_rise_and_a_fall_are_a_pulse_also_before_the_next_rise)
{
    captured(CC1IF, 1000, 0);
    assert_int_equal(fathom_stm32f4_happened, 1);
    assert_int_equal(capture.take(capture.ctx, &pulse), 0);
    captured(CC1IF | CC2IF, 5000, 4000);
    assert_pulse(3000, 4000);
    captured(CC2IF, 5000, 0x7000);
    assert_pulse(0x7000 - 5000, 0x7000);
}

TEST(a_spike_within_a_microsecond_loses_no_pulse_after_it)
{
    captured(CC1IF | CC2IF, 1000, 1000); /* a line that is low */
    assert_pulse(0, 1000);
    captured(CC1IF, 2000, 1000);
    captured(CC1IF | CC2IF, 3000, 3000); /* and one that is high */
    assert_pulse(1000, 3000);
    captured(CC2IF, 3000, 90000);
    assert_pulse(87000, 90000);
}

/* Rise at 1000, read from SR; fall at 1001 and rise at 1002 before CCR1 is read; the fall has its interrupt then. */
TEST(a_fall_that_was_overtaken_by_the_next_rise_ends_no_pulse)
{
    captured(CC1IF, 1002, 1001);
    captured(CC2IF | CC1OF, 1002, 1001);
    assert_int_equal(capture.take(capture.ctx, &pulse), 0);
    captured(CC2IF, 1002, 4002);
    assert_pulse(3000, 4002);
    captured(CC1IF, 2, 4002); /* 71.6 minutes later, less 4 ms: a rise like any other */
    captured(CC2IF, 2, 5002);
    assert_pulse(5000, 5002);
}

TEST(an_interrupt_without_a_capture_is_nothing)
{
    captured(0, 1000, 4000);
    captured(1, 1000, 4000); /* UIF */
    assert_int_equal(fathom_stm32f4_happened, 0);
    assert_int_equal(capture.take(capture.ctx, &pulse), 0);
    assert_false(pulse.is_high);
}

/* ---- pins and clock ---- */

static int clear(void **state)
{
    memset(PERIPHERALS, 0, LENGTH);
    return 0;
}

static const suite_t clear_suite = {.set_up = clear};

TEST_IN(clear_suite, an_output_is_high_before_it_is_driven_and_an_input_has_its_pull)
{
    static const fathom_stm32f4_pin_t pb1 = {'B', 1};
    static const fathom_stm32f4_pin_t pb2 = {'B', 2};
    const fathom_pin_t output = fathom_stm32f4_output(&pb1);
    assert_int_equal(GPIOB_AT(BSRR), 1 << 1);
    assert_int_equal(GPIOB_AT(MODER), 1 << 2);
    assert_int_equal(REGISTER(0x40023830), 2); /* AHB1ENR: GPIOB */
    output.set(output.ctx, false);
    assert_int_equal(GPIOB_AT(BSRR), 1 << 17);
    output.set(output.ctx, true);
    assert_int_equal(GPIOB_AT(BSRR), 1 << 1);
    const fathom_pin_t input = fathom_stm32f4_input(&pb2, FATHOM_STM32F4_DOWN);
    assert_int_equal(GPIOB_AT(PUPDR), 2 << 4);
    assert_int_equal(GPIOB_AT(MODER), 1 << 2);
    assert_false(input.get(input.ctx));
    GPIOB_AT(IDR) = 1 << 2;
    assert_true(input.get(input.ctx));
    assert_null(output.get);
    assert_null(input.set);
}

TEST_IN(clear_suite, the_clock_is_tim2_divided_to_1_mhz)
{
    fathom_stm32f4_clock_init(84000000);
    assert_int_equal(TIM2_AT(0x28), 83);         /* PSC */
    assert_int_equal(TIM2_AT(0x2C), 0xFFFFFFFF); /* ARR */
    assert_int_equal(TIM2_AT(0x00) & 1, 1);      /* CR1: CEN */
    assert_int_equal(REGISTER(0x40023840), 9);   /* APB1ENR: TIM2, TIM5 */
    TIM2_AT(0x24) = 0xFEDCBA98;
    assert_int_equal(fathom_stm32f4_clock.now_us(fathom_stm32f4_clock.ctx), 0xFEDCBA98);
}

/* ---- USART2 with TX on PA2, RX on PA3, the driver on PA1 ---- */

static fathom_stm32f4_usart_t usart;
static fathom_uart_t uart;
static uint8_t request[8];

/* driver: the port of its pin 1. */
static int begin_with_driver(char driver)
{
    const fathom_stm32f4_usart_config_t config = {.request = request,
                                                  .request_size = sizeof request,
                                                  .number = 2,
                                                  .bus_hz = 42000000,
                                                  .line = {19200, FATHOM_PARITY_EVEN, 1},
                                                  .tx = {'A', 2},
                                                  .rx = {'A', 3},
                                                  .driver = {driver, 1}};
    if (!fathom_stm32f4_usart_init(&usart, &config)) return -1;
    uart = fathom_stm32f4_usart(&usart);
    return 0;
}

static int begin_usart(void **state)
{
    (void)clear(state);
    return begin_with_driver('A');
}

static const suite_t usart_suite = {.set_up = begin_usart};

static void interrupt(uint32_t why)
{
    USART2_AT(SR) = why;
    fathom_stm32f4_usart_interrupt(&usart);
}

TEST_IN(usart_suite, its_pins_are_its_own_and_the_driver_is_off)
{
    assert_int_equal(GPIOA_AT(MODER), 1 << 2 | 2 << 4 | 2 << 6);
    assert_int_equal(GPIOA_AT(AFRL), 7 << 8 | 7 << 12);
    assert_int_equal(GPIOA_AT(PUPDR), 2 << 2 | 1 << 4 | 1 << 6);
    assert_int_equal(GPIOA_AT(BSRR), 1 << 17);
    assert_int_equal(REGISTER(0x40023840), 1 << 17); /* APB1ENR: USART2 */
    assert_int_equal(enabled, 38);
}

TEST_IN(usart_suite, the_driver_is_on_from_before_the_first_byte_until_the_last_stop_bit_has_left)
{
    static const uint8_t bytes[] = {0x11, 0x22, 0x33};
    static const uint32_t left_us[] = {1719, 1719, 1146}; /* 3 or 2 characters of 11 bits at 19200 baud */
    assert_int_equal(uart.leaves_in_us(uart.ctx), 0);
    assert_int_equal(uart.write(uart.ctx, bytes, 3), 3);
    assert_int_equal(GPIOA_AT(BSRR), 1 << 1);
    assert_int_equal(USART2_AT(DR), 0);
    GPIOA_AT(BSRR) = 0;
    for (int i = 0; i != 3; i++) {
        interrupt(TXE | TC);
        assert_int_equal(USART2_AT(DR), bytes[i]);
        assert_int_equal(uart.leaves_in_us(uart.ctx), left_us[i]);
    }
    interrupt(TXE); /* the last one has gone to the wire */
    assert_int_equal(USART2_AT(CR1) & 0xC0, TC);
    interrupt(TXE); /* something else interrupts */
    assert_false(uart.sent(uart.ctx));
    assert_int_equal(GPIOA_AT(BSRR), 0);
    interrupt(TXE | TC);
    assert_true(uart.sent(uart.ctx));
    assert_int_equal(uart.leaves_in_us(uart.ctx), 0);
    assert_int_equal(GPIOA_AT(BSRR), 1 << 17);
    assert_int_equal(USART2_AT(CR1) & 0xC0, 0);
    assert_int_equal(USART2_AT(DR), 0x33);
}

static void received(uint32_t why, uint32_t data)
{
    USART2_AT(DR) = data;
    interrupt(why | TXE);
}

static void assert_read(uint8_t byte, uint8_t flags)
{
    fathom_rx_t rx = {0, 0};
    uint8_t got[4];
    assert_int_equal(uart.read(uart.ctx, got, sizeof got, &rx), 1);
    assert_int_equal(got[0], byte);
    assert_int_equal(rx.flags, flags);
}

TEST_IN(usart_suite, a_byte_is_read_without_its_parity_and_with_its_errors)
{
    received(RXNE, 0x1AA); /* with 9 bits a word, DR has the parity above the byte */
    assert_read(0xAA, 0);
    received(RXNE | PE, 0x55);
    assert_read(0x55, FATHOM_RX_PARITY);
    received(RXNE | FE, 0x00);
    assert_read(0x00, FATHOM_RX_FRAMING);
    received(RXNE | PE | FE, 0x0F);
    assert_read(0x0F, FATHOM_RX_PARITY | FATHOM_RX_FRAMING);
    received(RXNE | NE, 0x77); /* noise alone: the checksum will tell */
    assert_read(0x77, 0);
    assert_int_equal(usart.noise, 1);
    assert_int_equal(usart.serial.parity, 2);
    assert_int_equal(usart.serial.framing, 2);
}

TEST_IN(usart_suite, an_overrun_is_told_of_the_byte_behind_the_loss)
{
    received(RXNE | ORE, 1);
    assert_read(1, 0);
    received(RXNE, 2);
    assert_read(2, FATHOM_RX_OVERRUN);
    received(ORE, 3); /* DR has been read: nothing is in it, but reading it clears ORE */
    received(RXNE, 4);
    assert_read(4, FATHOM_RX_OVERRUN);
    assert_int_equal(usart.serial.overruns, 2);
}

TEST_IN(usart_suite, a_break_holds_the_pin_low_with_the_driver_on)
{
    static const uint8_t byte = 1;
    assert_int_equal(begin_with_driver('B'), 0); /* whose BSRR is another one than TX's */
    assert_int_equal(uart.set_break(uart.ctx, true), 1);
    assert_int_equal(GPIOB_AT(BSRR), 1 << 1);
    assert_int_equal(GPIOA_AT(BSRR), 1 << 18);
    assert_int_equal(GPIOA_AT(MODER), 1 << 2 | 1 << 4 | 2 << 6);
    assert_int_equal(uart.write(uart.ctx, &byte, 1), 0);
    assert_int_equal(uart.set_break(uart.ctx, false), 1);
    assert_int_equal(GPIOB_AT(BSRR), 1 << 17);
    assert_int_equal(GPIOA_AT(MODER), 1 << 2 | 2 << 4 | 2 << 6);
    assert_int_equal(uart.write(uart.ctx, &byte, 1), 1);
    assert_int_equal(uart.set_break(uart.ctx, true), 0);
}
