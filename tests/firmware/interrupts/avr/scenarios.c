/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <string.h>

/* Each call of the port that shares something with an interrupt, with what decides which way it goes. Addresses that
 * none of them carries out are found by run.py. */

enum { FLAWED = FATHOM_RX_PARITY | FATHOM_RX_FRAMING };
enum { PERIOD_US = 32768, CARRY_US = 0x00FF8000, WRAP_US = UINT32_MAX - PERIOD_US + 1 };

/* ---- the clock ---- */

/* So that the image does not wait for it for a period: behind the slots (run.c). */
static void near_the_overflow(void) { board_stall(truth_overflow_cycle() - board.avr->cycle - 6000); }

/* ---- the ring ---- */

static void receive(uint8_t byte, uint8_t flags)
{
    event_byte(byte, flags);
    image_run(120);
}

static void fill(uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) receive((uint8_t)(1 + i), 0);
}

/* 254 have come and gone: the ring wraps behind the second from here, and so does a byte that counts them. */
static void at_the_end(void)
{
    for (int i = 0; i < 254; i++) {
        if (truth.count == 32 || i == 0) {
            image_calls()->length = CALLS_BYTES;
            image_call(CALL_READ);
            truth.count = 0;
        }
        receive((uint8_t)i, 0);
    }
    image_call(CALL_READ);
    truth.count = 0;
}

static void one(void) { fill(1); }
static void two(void) { fill(2); }
static void three(void) { fill(3); }
static void one_wraps(void)
{
    at_the_end();
    fill(1);
}
static void two_wrapped(void)
{
    at_the_end();
    fill(2);
}
static void flawed(void) { receive(1, FLAWED); }
static void behind(void) { receive(1, FATHOM_RX_OVERRUN); }
static void flawed_second(void)
{
    receive(1, 0);
    receive(2, FLAWED);
    receive(3, 0);
}
static void flawed_uncounted(void)
{
    for (int i = 0; i < 6; i++) board_data("fathom_avr_usart0_counters")[i] = 0xFF;
    receive(1, FLAWED | FATHOM_RX_OVERRUN);
}
static void full(void) { fill(63); }

/* ---- the transmitter ---- */

static void leave(uint8_t count)
{
    volatile calls_t *const calls = image_calls();
    for (uint8_t i = 0; i < count; i++) calls->bytes[i] = (uint8_t)(0x31 + i);
    calls->length = count;
    image_call(CALL_WRITE);
    image_run(200);
}
/* One is on the wire, one in UDR0, one is left. */
static void leaving(void) { leave(3); }
/* One is on the wire, and none is left. */
static void last_leaving(void) { leave(1); }
static void leaving_and_one(void)
{
    leave(3);
    fill(1);
}
static void in_break(void)
{
    image_calls()->flags = 1;
    image_call(CALL_SET_BREAK);
}

/* ---- pulses ---- */

static void edge(uint8_t which, uint32_t after_us)
{
    board_stall(after_us * BOARD_CYCLES_PER_US);
    event_edge(which);
    image_run(700);
}

static void arm(uint8_t which)
{
    image_calls()->which = which;
    image_call(CALL_ARM);
}

/* So that what is read half before and half after is none of them (outcome.c). */
static void pulses(uint8_t which, uint8_t count)
{
    static const uint16_t widths_us[] = {300, 608, 1172, 2248};
    arm(which);
    for (uint8_t i = 0; i < count; i++) {
        edge(which, 100);
        edge(which, widths_us[i] - 700 / BOARD_CYCLES_PER_US);
    }
}

static void high(uint8_t which)
{
    arm(which);
    edge(which, 500);
}

/* It rose before arm: the pulse counts for nothing. */
static void stale(uint8_t which)
{
    edge(which, 500);
    arm(which);
    edge(which, 500);
}

static void full_and_high(uint8_t which)
{
    pulses(which, 4);
    edge(which, 100);
    board_stall(4346 * BOARD_CYCLES_PER_US);
}

static void high_0(void) { high(0); }
static void high_1(void) { high(1); }
static void stale_0(void) { stale(0); }
static void stale_and_one_0(void)
{
    stale(0);
    edge(0, 100);
    edge(0, 300);
}
static void without_pin_0(void)
{
    enum { PIN = 47 }; /* as outcome.c has the rest of fathom_edges_t */
    memset(board_data("sides") + PIN, 0, 2);
}
/* The next pulse goes to the last place of the ring, behind which the first one follows. */
static void last_place_0(void)
{
    enum { WRITE_AT = 44, READ_AT = 46, LAST = 3 };
    board_data("sides")[WRITE_AT] = LAST;
    board_data("sides")[READ_AT] = LAST;
    pulses(0, 1);
}
static void one_without_pin_0(void)
{
    without_pin_0();
    pulses(0, 1);
}
static void high_without_pin_0(void)
{
    without_pin_0();
    high(0);
}
static void one_0(void) { pulses(0, 1); }
static void one_1(void) { pulses(1, 1); }
static void full_0(void) { full_and_high(0); }
static void full_1(void) { full_and_high(1); }

#define RECEIVED EVENT_BYTE, EVENT_FLAWED, EVENT_BEHIND
#define TIMES    EVENT_OVERFLOW, EVENT_INT0, EVENT_ICP1

/* What may come at each boundary, and what may come in pairs. */
#define COMES(...)                                                                                           \
    {                                                                                                        \
        __VA_ARGS__                                                                                          \
    }
#define SENDING COMES(EVENT_LEFT, EVENT_LATE, EVENT_BYTE, TIMES)
#define NOW(NAME, ZERO, MASKED)                                                                              \
    {                                                                                                        \
        .name = NAME, .call = CALL_NOW, .zero_us = ZERO, .is_masked = MASKED,                                \
        .events = COMES(TIMES, EVENT_BYTE), .pairs = COMES(TIMES, EVENT_BYTE)                                \
    }
#define READ(NAME, PREPARE, CAPACITY)                                                                        \
    {                                                                                                        \
        .name = NAME, .call = CALL_READ, .prepare = PREPARE, .length = CAPACITY,                             \
        .events = COMES(RECEIVED, TIMES), .pairs = COMES(EVENT_BYTE, EVENT_FLAWED)                           \
    }
#define WRITE(NAME, PREPARE, LENGTH)                                                                         \
    {                                                                                                        \
        .name = NAME, .call = CALL_WRITE, .prepare = PREPARE, .length = LENGTH, .events = SENDING,           \
        .pairs = COMES(EVENT_LEFT, EVENT_BYTE)                                                               \
    }
#define LINE(NAME, CALL, PREPARE, FLAGS)                                                                     \
    {                                                                                                        \
        .name = NAME, .call = CALL, .prepare = PREPARE, .flags = FLAGS, .events = SENDING,                   \
        .pairs = COMES(EVENT_LEFT, EVENT_BYTE)                                                               \
    }
/* Long ones, which divide. */
#define RATE(NAME, PREPARE, BAUD, PARITY, STOP_BITS)                                                         \
    {                                                                                                        \
        .name = NAME, .call = CALL_SET_LINE, .prepare = PREPARE, .baud = BAUD,                               \
        .parity = FATHOM_PARITY_##PARITY, .stop_bits = STOP_BITS, .events = COMES(EVENT_BYTE, EVENT_LEFT)    \
    }
#define PULSE(NAME, CALL, WHICH, PREPARE, EDGE)                                                              \
    {                                                                                                        \
        .name = NAME, .call = CALL, .which = WHICH, .prepare = PREPARE, .events = COMES(TIMES, EVENT_BYTE),  \
        .pairs = COMES(EDGE, EVENT_OVERFLOW)                                                                 \
    }
#define IDLE(NAME, PREPARE, MOST, GATHER, ...)                                                               \
    {                                                                                                        \
        .name = NAME, .call = CALL_IDLE, .prepare = PREPARE, .most_us = MOST, .gather_us = GATHER,           \
        .events = COMES(EVENT_BYTE, EVENT_LEFT, __VA_ARGS__), .pairs = COMES(EVENT_BYTE, EVENT_INT0)         \
    }

const scenario_t scenarios[] = {
    NOW("now", 0, false),
    NOW("now_carry", CARRY_US, false),
    NOW("now_wrap", WRAP_US, false),
    NOW("now_masked", CARRY_US, true),
    {.name = "now_pending",
     .call = CALL_NOW,
     .prepare = near_the_overflow,
     .zero_us = CARRY_US,
     .is_masked = CALLS_PENDING,
     .events = {EVENT_BYTE, EVENT_INT0, EVENT_ICP1}},

    READ("read_empty", NULL, 64),
    READ("read_one", one, 64),
    READ("read_one_wraps", one_wraps, 64),
    READ("read_two_wrapped", two_wrapped, 64),
    READ("read_three_in_part", three, 2),
    READ("read_nothing", two, 0),
    READ("read_flawed", flawed, 64),
    READ("read_behind", behind, 64),
    READ("read_flawed_second", flawed_second, 64),
    READ("read_flawed_uncounted", flawed_uncounted, 64),
    {.name = "read_full",
     .call = CALL_READ,
     .prepare = full,
     .length = 1,
     .may_drop = true,
     .events = {EVENT_BYTE, EVENT_BEHIND, EVENT_OVERFLOW},
     .pairs = {EVENT_BYTE, EVENT_BEHIND}},
    {.name = "read_full_whole",
     .call = CALL_READ,
     .prepare = full,
     .length = 64,
     .may_drop = true,
     .events = {EVENT_BYTE}},
    {.name = "read_masked",
     .call = CALL_READ,
     .prepare = one,
     .length = 64,
     .is_masked = true,
     .events = {RECEIVED, TIMES}},
    {.name = "read_leaving",
     .call = CALL_READ,
     .prepare = leaving_and_one,
     .length = 64,
     .events = {EVENT_BYTE, EVENT_LEFT, EVENT_LATE},
     .pairs = {EVENT_BYTE, EVENT_LEFT, EVENT_LATE}},

    WRITE("write_one", NULL, 1),
    WRITE("write_three", NULL, 3),
    WRITE("write_most", NULL, 8),
    WRITE("write_nothing", NULL, 0),
    WRITE("write_too_much", NULL, 9),
    WRITE("write_leaving", leaving, 2),
    WRITE("write_last_leaving", last_leaving, 2),
    WRITE("write_in_break", in_break, 2),

    LINE("sent", CALL_SENT, NULL, 0),
    LINE("sent_leaving", CALL_SENT, leaving, 0),
    LINE("sent_last_leaving", CALL_SENT, last_leaving, 0),
    LINE("leaves", CALL_LEAVES, NULL, 0),
    LINE("leaves_leaving", CALL_LEAVES, leaving, 0),
    LINE("leaves_last_leaving", CALL_LEAVES, last_leaving, 0),
    LINE("break_on", CALL_SET_BREAK, NULL, 1),
    LINE("break_off", CALL_SET_BREAK, in_break, 0),
    LINE("break_last_leaving", CALL_SET_BREAK, last_leaving, 1),
    RATE("line_same", last_leaving, 1200, EVEN, 1),
    RATE("line_new", NULL, 9600, ODD, 2),
    RATE("line_twice", NULL, 57600, NONE, 1),
    RATE("line_even", NULL, 1200, EVEN, 2),
    RATE("line_odd", NULL, 1200, ODD, 1),
    RATE("line_too_slow", NULL, 300, EVEN, 1),
    RATE("line_none", NULL, 0, EVEN, 1),
    RATE("line_no_parity", NULL, 1200, ODD + 1, 1),
    RATE("line_no_stop", NULL, 1200, EVEN, 0),
    RATE("line_many_stops", NULL, 1200, EVEN, 3),
    RATE("line_last_leaving", last_leaving, 2400, EVEN, 1),
    LINE("pin_high", CALL_PIN, last_leaving, 1),
    LINE("pin_low", CALL_PIN, last_leaving, 0),

    PULSE("arm_int0", CALL_ARM, 0, one_0, EVENT_INT0),
    PULSE("arm_int0_high", CALL_ARM, 0, high_0, EVENT_INT0),
    PULSE("arm_icp1", CALL_ARM, 1, one_1, EVENT_ICP1),
    PULSE("take_int0", CALL_TAKE, 0, NULL, EVENT_INT0),
    PULSE("take_int0_high", CALL_TAKE, 0, high_0, EVENT_INT0),
    PULSE("take_int0_one", CALL_TAKE, 0, one_0, EVENT_INT0),
    PULSE("take_int0_without_pin", CALL_TAKE, 0, one_without_pin_0, EVENT_INT0),
    PULSE("take_int0_last_place", CALL_TAKE, 0, last_place_0, EVENT_INT0),
    PULSE("arm_int0_last_place", CALL_ARM, 0, last_place_0, EVENT_INT0),
    PULSE("take_int0_high_without_pin", CALL_TAKE, 0, high_without_pin_0, EVENT_INT0),
    PULSE("take_int0_stale", CALL_TAKE, 0, stale_0, EVENT_INT0),
    PULSE("take_int0_stale_and_one", CALL_TAKE, 0, stale_and_one_0, EVENT_INT0),
    PULSE("take_int0_full", CALL_TAKE, 0, full_0, EVENT_INT0),
    PULSE("take_icp1", CALL_TAKE, 1, NULL, EVENT_ICP1),
    PULSE("take_icp1_high", CALL_TAKE, 1, high_1, EVENT_ICP1),
    PULSE("take_icp1_one", CALL_TAKE, 1, one_1, EVENT_ICP1),
    PULSE("take_icp1_full", CALL_TAKE, 1, full_1, EVENT_ICP1),
    {.name = "icp1_begin",
     .call = CALL_ICP1_BEGIN,
     .which = 1,
     .events = {EVENT_ICP1, EVENT_BYTE, EVENT_OVERFLOW}},
    {.name = "int0_begin", .call = CALL_INT0_BEGIN, .events = {EVENT_INT0, EVENT_BYTE, EVENT_OVERFLOW}},
    {.name = "icp1_begin_high",
     .call = CALL_ICP1_BEGIN,
     .which = 1,
     .prepare = high_1,
     .events = {EVENT_BYTE, EVENT_OVERFLOW}},

    IDLE("idle", NULL, 250, 0, EVENT_INT0, EVENT_ICP1),
    {.name = "idle_overflow", .call = CALL_IDLE, .most_us = 30, .events = {EVENT_OVERFLOW, EVENT_BYTE}},
    IDLE("idle_last_leaving", last_leaving, 250, 0, EVENT_INT0, EVENT_ICP1),
    IDLE("idle_gather", NULL, 300, 50, EVENT_INT0, EVENT_ICP1),
    IDLE("idle_gather_shorter", NULL, 40, 50, EVENT_INT0, EVENT_ICP1),
    IDLE("idle_happened", one_0, 250, 0, EVENT_INT0, EVENT_ICP1),
    IDLE("idle_gather_happened", one_0, 300, 50, EVENT_INT0, EVENT_ICP1),
    IDLE("idle_nothing", NULL, 0, 0, EVENT_INT0, EVENT_ICP1),
    {.name = "idle_byte_waits",
     .call = CALL_IDLE,
     .prepare = one,
     .most_us = 40000,
     .events = {EVENT_BYTE, EVENT_INT0}},
};

const unsigned scenario_count = sizeof scenarios / sizeof scenarios[0];

bool scenario_begins(void)
{
    return run.scenario->call == CALL_ICP1_BEGIN || run.scenario->call == CALL_INT0_BEGIN;
}
