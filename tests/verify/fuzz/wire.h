/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_FUZZ_WIRE_H
#define FATHOM_TESTS_FUZZ_WIRE_H

#include "fathom/engine/line.h"
#include "fuzz.h"

/*
 * The far end of a line, and its port: whatever hal.h allows, as the input says. It remembers what the line has heard,
 * so that nothing can be told that was not there.
 */
enum { WIRE_HEARD = 2048, WIRE_QUEUE = 320, WIRE_FRAME = 255 };

typedef struct {
    uint32_t now_us;
    uint64_t passed_us; /* since wire_begin */
    /* what waits in the port, and what it says of it */
    uint8_t queue[WIRE_QUEUE];
    unsigned queued;
    uint8_t flags;
    uint32_t last_us;
    /* what the line has read; is_broken: at this place bytes were lost, or not to be believed */
    uint8_t heard[WIRE_HEARD];
    bool is_broken[WIRE_HEARD];
    unsigned count;
    bool has_marks; /* the line's config names them */
    /* the last request that was taken */
    uint8_t request[WIRE_FRAME];
    uint8_t length;
    uint32_t wrote_us;
    uint32_t leaves_us; /* so long after that */
    unsigned writes;    /* taken, ... */
    unsigned reads;     /* ... and reads of the port, both since wire_poll_begins */
    bool is_draining;   /* it works, and says nothing more */
    /* how often a call fails, and how */
    uint8_t read_fails, write_fails, set_line_fails, set_break_fails, sent_late;
    int8_t break_result, line_result, write_result;
    bool is_low;
} wire_t;

extern wire_t wire;
extern const fathom_clock_t wire_clock;
extern const fathom_uart_t wire_uart;
extern const fathom_line_settings_t wire_settings[2];

void wire_begin(uint32_t now_us, bool has_marks);

void wire_pass(uint32_t us);

/* Of the ops of a script all that do not depend on who reads the line: bytes, responses, time, marks, faults. */
enum { WIRE_OPS = 12 };
void wire_op(uint8_t op);

/* From here on nothing comes and nothing fails. */
void wire_drain(void);

/* Before and after each poll of the line: hal.h's rules for it, and line.h's for a poll. */
void wire_poll_begins(void);
void wire_poll_has_ended(void);

/* Is this time in the future? Also one before the beginning, which it is told from where less than 71 minutes have
 * passed. */
bool wire_is_future(uint32_t time_us);

/* Is there, among what was heard since `from`, a whole Modbus frame with a right CRC from this unit (255: any) with
 * this function and, of a read, `count` registers with these values? values NULL: any. */
bool wire_heard_read(unsigned from, uint8_t unit, uint8_t count, const uint16_t *values);
bool wire_heard_head(unsigned from, const uint8_t head[6]); /* of a write */
bool wire_heard_exception(unsigned from, uint8_t unit, uint8_t function, uint8_t code);
/* One register with this value in any right frame. */
bool wire_heard_register(unsigned from, uint8_t unit, uint16_t value);
/* The same of a frame that ends in its sum: one that begins with `start`, 55 or FF, of `length` bytes. */
bool wire_heard_sum(unsigned from, uint8_t start, uint8_t length, uint16_t value);
/* A measurement of an HPS-167 with this distance. */
bool wire_heard_hps167(uint16_t value);

#endif
