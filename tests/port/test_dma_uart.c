/* SPDX-License-Identifier: MIT */
/* What examples/rp2040/dma_uart.c counts where its interrupts have priorities of their own, and one comes within
 * another: rp2040js cannot place that to an instruction. The registers are memory, which the test reads and sets. */
#include <string.h>

#include "suite.h"

#include "dma_uart.h"
#include "internal/alarm.h"
#include "rp2040.h"

enum { CHANNEL = 2, TRANSFER = 1024 };

#define COUNT UINT32_C(0x50000088) /* 2.5.7: CH2_TRANS_COUNT */
#define TRIG  UINT32_C(0x5000009C) /* CH2_AL1_TRANS_COUNT_TRIG */
#define INTS0 UINT32_C(0x5000040C)

/* ---- what it needs of the port ---- */

static uint32_t memory[4][0x60000 / 4]; /* from 0x40000000, 0x50000000, 0xD0000000 and 0xE000E000 on */
static uint32_t time_us;
static void (*interrupt)(void); /* comes before the next access to TRIG */

static uint32_t *at(uint32_t address)
{
    const unsigned block = address >> 28 == 4 ? 0 : address >> 28 == 5 ? 1 : address >> 28 == 0xD ? 2 : 3;
    const uint32_t offset = address - (block == 3 ? UINT32_C(0xE000E000) : address & UINT32_C(0xF0000000));
    assert_true(offset < sizeof memory[0]);
    return &memory[block][offset / 4];
}

void *rp2040_at(uint32_t address)
{
    if (address == TRIG && interrupt != NULL) {
        void (*const now)(void) = interrupt;
        interrupt = NULL;
        now();
    }
    return at(address);
}

static uint32_t now_us(void *ctx) { return time_us; }

const fathom_clock_t fathom_rp2040_clock = {now_us, NULL};

bool fathom_rp2040_uart_setup(const fathom_rp2040_wiring_t *wiring, const fathom_line_settings_t *line)
{
    return true;
}

void fathom_rp2040_alarm_set(unsigned alarm, uint32_t in_us) {}

void fathom_rp2040_alarm_clear(unsigned alarm) {}

void fathom_rp2040_alarm_enable(unsigned alarm) {}

/* ---- */

static dma_uart_t uart;
static fathom_uart_t wire;

static const dma_uart_config_t config = {
    .wiring = {.number = 1, .rx = 5}, .line = {9600, FATHOM_PARITY_NONE, 1}, .channel = CHANNEL};

static int set_up(void **state)
{
    memset(memory, 0, sizeof memory);
    memset(&uart, 0x5A, sizeof uart);
    *at(0x4000C008) = UINT32_MAX; /* RESETS_RESET_DONE */
    if (!dma_uart_begin(&uart, &config)) return -1;
    wire = dma_uart(&uart);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* So many bytes have come in all, `value` each; the transfers before this one are counted. */
static void bring(uint32_t bytes, uint8_t value)
{
    for (unsigned i = 0; i != DMA_UART_RING; i++) uart.ring[i] = value;
    *at(COUNT) = TRANSFER - bytes;
}

/* A transfer has ended, and its interrupt comes. */
static void end_transfer(void)
{
    *at(COUNT) = 0;
    *at(INTS0) = 1u << CHANNEL;
    *at(TRIG) = 0;
    dma_uart_ended(&uart);
    assert_int_equal(*at(TRIG), TRANSFER);
    *at(COUNT) = TRANSFER; /* what the hardware makes of it */
}

static void look(void)
{
    *at(0x400140F0) = 0; /* INTR0, of GPIO 0 to 7: no edge since the last look */
    dma_uart_look(&uart);
}

TEST(a_look_within_the_end_of_a_transfer_counts_the_bytes_of_that_once)
{
    bring(1000, 1);
    time_us = 5000;
    look();
    assert_int_equal(uart.seen, 1000);
    interrupt = look;
    time_us = 10000;
    end_transfer();
    assert_null(interrupt);
    assert_int_equal(uart.seen, TRANSFER);
    assert_int_equal(uart.marked, 0);

    time_us = 15000;
    look(); /* nothing since: a silence behind the last byte of the transfer */
    assert_int_equal(uart.marked, 1);
    assert_int_equal(uart.marks[0].at, TRANSFER);
    assert_int_equal(uart.marks[0].last_us, 10000);
}

TEST(a_silence_is_seen_by_a_look_within_the_end_of_a_transfer)
{
    *at(COUNT) = 0; /* the end waits for its turn */
    time_us = 5000;
    look();
    assert_int_equal(uart.seen, TRANSFER);
    interrupt = look;
    end_transfer();
    assert_int_equal(uart.marked, 1);
    assert_int_equal(uart.marks[0].at, TRANSFER);

    /* What comes next is the first thing after it. */
    uint8_t bytes[DMA_UART_RING];
    fathom_rx_t rx = {0, 0};
    int n;
    while ((n = wire.read(wire.ctx, bytes, sizeof bytes, &rx)) != 0) memset(&rx, 0, sizeof rx);
    bring(3, 7);
    assert_int_equal(wire.read(wire.ctx, bytes, sizeof bytes, &rx), 3);
    assert_int_equal(rx.flags, FATHOM_RX_SILENCE);
    assert_int_equal(bytes[2], 7);
}

TEST(bytes_go_on_from_transfer_to_transfer)
{
    uint8_t bytes[DMA_UART_RING];
    fathom_rx_t rx = {0, 0};
    for (unsigned transfer = 0; transfer != 3; transfer++) {
        for (uint32_t count = 32; count <= TRANSFER; count += 32) {
            bring(count, (uint8_t)count);
            assert_int_equal(wire.read(wire.ctx, bytes, sizeof bytes, &rx), 32);
            assert_int_equal(bytes[31], (uint8_t)count);
        }
        if (transfer == 1) interrupt = look;
        end_transfer();
        assert_int_equal(wire.read(wire.ctx, bytes, sizeof bytes, &rx), 0);
    }
    assert_int_equal(uart.overruns, 0);
}
