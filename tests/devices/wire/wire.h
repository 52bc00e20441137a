/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_WIRE_H
#define FATHOM_TESTS_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "fathom/hal.h"

/*
 * One half-duplex wire in simulated time, in microseconds. Any number of units, another master, noise and the host
 * under test send on it. Bytes of two senders that overlap are garbled for every receiver. A unit is deaf while it
 * sends. Every distance that a unit sends is issued once, so that a judge knows who measured a value, when, and for
 * whom.
 *
 *     host     [request]                            [request]
 *     unit                [response]   [unsolicited]
 *     master                                    [request]         overlaps: both are garbled
 *
 * A file of tests has one wire, `wire`. A test begins with wire_open(), adds senders, and moves the time with
 * wire_run(). The host's UART is `wire.uart`, its clock `wire.clock`.
 */
enum { WIRE_UNITS = 6, WIRE_FRAME = 96, WIRE_RING = 4096 };

typedef uint64_t wire_us_t;

#define WIRE_NEVER UINT64_MAX

/* Who sends, and for whom a unit measures. */
typedef enum { WIRE_UNSOLICITED, WIRE_HOST, WIRE_MASTER, WIRE_NOISE, WIRE_FIRST_UNIT } wire_source_t;

/* A whole frame. `is_hit`: at least one of its bytes overlapped another sender's. */
typedef struct {
    wire_us_t start_us, end_us;
    wire_us_t quiet_us; /* silence before the frame */
    uint8_t source;     /* a wire_source_t */
    uint8_t length;
    bool is_hit, is_cut; /* is_cut: its last bytes are missing */
    uint8_t bytes[WIRE_FRAME];
} wire_frame_t;

typedef enum {
    WIRE_HPS167S,    /* commands #1, #2, #5, #10; sends measurements if `period_us` is not 0 */
    WIRE_DYP_MODBUS, /* A16 and A05 in Modbus: registers that are read (03, 04) and written (06, 10) */
    WIRE_DYP_55AA,   /* A05 with its 55 AA frames */
    WIRE_A16_STREAM, /* FF H L SUM each `period_us`; once a falling edge if `period_us` is 0 */
    WIRE_A05_STREAM  /* FF and four distances each `period_us` */
} wire_kind_t;

/* What a unit does with a request that arrives before it has responded to another. */
typedef enum { WIRE_IGNORES, WIRE_TAKES_NEWER, WIRE_QUEUES } wire_busy_t;

typedef struct {
    wire_kind_t kind;
    uint8_t address;
    wire_busy_t when_busy;
    wire_us_t period_us;  /* between two frames that the unit sends by itself; 0: sends none */
    wire_us_t answer_us;  /* from the end of a request to the response */
    wire_us_t spread_us;  /* a random time below this is added to `answer_us` */
    wire_us_t measure_us; /* replaces `answer_us` for command #5, if not 0 */
    wire_us_t deaf_us;    /* after the unit sent */
    wire_us_t silence_us; /* a request with less silence before it is ignored; 0: none needed */
    unsigned late_one_in; /* one response in this number is `late_us` later; 0: none */
    wire_us_t late_us;
    unsigned lost_one_in; /* one request in this number is ignored; 0: none */
    bool is_dead;         /* responds to nothing */
    bool keeps_schedule;  /* a response delays one unsolicited frame, and not all that follow */
    uint8_t cuts;         /* each frame loses this number of bytes at its end */

    /* The unit's own. */
    wire_us_t next_frame_us, sends_until_us;
    wire_us_t delay_us;    /* of the next unsolicited frame, behind its place in the schedule */
    wire_us_t response_us; /* WIRE_NEVER: no response is due */
    uint8_t request[WIRE_FRAME];
    uint8_t asker;
    wire_frame_t queued;              /* `length` is 0 if there is none */
    uint16_t measures_after_power_on; /* #10 */
    unsigned responses, unsolicited, writes;
} wire_unit_t;

/* A distance that was sent: by which unit, from which register, when, and who had requested it. */
typedef struct {
    wire_us_t at_us;
    uint16_t reg;
    uint8_t unit; /* index of the unit */
    uint8_t asker;
} wire_issue_t;

enum { WIRE_FIRST_MM = 500, WIRE_ISSUES = 5000, WIRE_MEASUREMENT = 8, WIRE_CONFIGURATION = 2 };

/* Another master: sends the requests of `forms` in turns. */
typedef struct {
    const uint8_t (*forms)[WIRE_FRAME];
    const uint8_t *lengths;
    uint8_t form_count;
    wire_us_t period_us, spread_us; /* between two requests */
    /* If not 0, the master waits this long for the response, and begins `period_us` when a unit has sent. */
    wire_us_t timeout_us;
    wire_us_t next_us; /* WIRE_NEVER: sends nothing */
    unsigned requests;
} wire_master_t;

/* Random bytes, or `value` if `is_constant`. */
typedef struct {
    wire_us_t period_us, spread_us; /* between two bytes */
    wire_us_t next_us;              /* WIRE_NEVER: none */
    uint8_t value;
    bool is_constant;
    bool is_in_phase; /* one byte in each turn of the host: the host sends it */
} wire_noise_t;

typedef struct {
    wire_us_t now_us;
    uint32_t byte_us;
    int64_t skew_us; /* added to the host's clock */
    uint64_t seed, random;

    wire_unit_t units[WIRE_UNITS];
    uint8_t unit_count;
    wire_master_t master;
    wire_noise_t noise;
    wire_issue_t issues[WIRE_ISSUES];
    uint32_t issued; /* distances so far */

    /* What the host's port does. */
    size_t ring_size; /* the receive ring keeps its oldest bytes; 0: WIRE_RING */
    bool has_time_stamps;
    bool echoes;         /* the host receives what it sends */
    bool takes_no_bytes; /* write returns 0 */
    bool fails_to_write, fails_to_read;
    bool loses_bytes_when_broken; /* while `fails_to_read`, as an adapter that was unplugged */
    bool never_sends;             /* `sent` stays false */
    bool refuses_settings;        /* set_line is busy */
    bool refuses_break;           /* set_break is busy */
    bool is_low;                  /* the host holds TX low */
    void (*on_call)(void);        /* called in each function of the port and in the clock; NULL: nothing */

    wire_us_t host_start_us, host_end_us; /* the newest transmission of the host */
    unsigned host_frames, host_hits;
    wire_frame_t last_sent;   /* as the host wrote it; `is_hit` is not set */
    wire_us_t received_us;    /* the end of the last byte that the host can have received */
    wire_us_t least_quiet_us; /* the shortest time from there to a 06, 10 or 55 AA 03 of the host */

    fathom_uart_t uart;
    fathom_clock_t clock;
} wire_t;

extern wire_t wire;

/* 9600 8N1 and 19200 8E1: 10 and 11 bits. */
enum { WIRE_BYTE_9600_US = 1042, WIRE_BYTE_19200_US = 573 };

void wire_open(uint32_t byte_us, uint64_t seed);

/* Adds a unit, which is copied. */
wire_unit_t *wire_add(const wire_unit_t *unit);

/* Moves the time on; everything that happens until then happens. */
void wire_run(wire_us_t for_us);
void wire_run_to(wire_us_t until_us);

/* Sleeps until a byte waits in the host's port, but at most for a time. */
void wire_sleep(wire_us_t at_most_us);

/* Puts a frame on the wire from `start_us` on, which is not in the past. */
wire_frame_t *wire_send(uint8_t source, wire_us_t start_us, const uint8_t *bytes, size_t length);

/* A falling edge of the host's TX, or of a pin: triggers a controlled A16. */
void wire_edge(void);

/* Adds the CRC to a frame of `length` bytes; returns the length with it. By the bitwise definition. */
uint8_t wire_seal(uint8_t *frame, size_t length);
/* Parses "01 03 ..." to a frame, adds the CRC, and returns the length. */
uint8_t wire_frame_of(const char *hex, uint8_t *frame);

/* Returns what is known about a distance, or NULL if none was sent with this value. */
const wire_issue_t *wire_issue_of(uint16_t mm);

/*
 * Returns true if the bytes that the host has read contain these two bytes, H L, among bytes of noise, of a
 * collision or of a frame that broke off: then chance may have made a frame of them, which no receiver can detect.
 */
bool wire_has_chance_of(uint16_t mm);

/* A random number below `limit`. */
uint32_t wire_random(uint32_t limit);
/* Returns true once in `n` on average; never if `n` is 0. */
bool wire_one_in(unsigned n);

/* Prints the last frames on the wire, for a test that fails. */
void wire_print(void);

/* Bytes that wait in the host's port, and the time at which the first of them arrived. */
size_t wire_waiting(void);

#endif
