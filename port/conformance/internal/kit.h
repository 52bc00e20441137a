/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONFORMANCE_KIT_H
#define FATHOM_CONFORMANCE_KIT_H

#include "../fathom_conformance.h"

/* kit.c: what the items share. The items stand in the order in which they are reported. */
typedef enum {
    CLOCK_RUNS,
    CLOCK_WRAP,
    SENT_COMES,
    WRITE_WHOLE,
    WRITE_COPY,
    READ_ORDER,
    READ_BOUNDS,
    CLOCK_US,
    WRITE_AT_ONCE,
    WRITE_NO_GAP,
    SENT_NOT_EARLY,
    LEAVES_IN_US,
    DRIVER,
    READ_SILENCE,
    READ_STAMP,
    READ_AGE,
    MARK_PARITY,
    MARK_FRAMING,
    WRITE_WHEN_FULL,
    READ_OVERRUN,
    SET_LINE_HOLDS,
    SET_LINE_WAITS,
    SET_LINE_KEEPS,
    SET_LINE_REFUSES,
    SET_BREAK,
    CLOCK_FORWARD
} item_t;

enum {
    MOST = 360,   /* bytes of one list of arrivals */
    FILL = 320,   /* bytes that fill any known ring: 128, 64, 256 */
    POISON = 0xEE /* a value that is never sent on purpose */
};

typedef struct {
    uint32_t at_us; /* when its read returned */
    uint8_t byte;
    uint8_t flags;          /* of its read, if it is the first byte of the read */
    bool is_first, is_last; /* of its read */
} arrival_t;

typedef struct {
    const fathom_conformance_t *bench;
    unsigned failed;
    uint32_t not_kept; /* 1 << item_t */
    uint32_t character_us;
    uint32_t step_us; /* the coarsest step of the clock that was seen */
    uint32_t last_us, back_us;
    bool has_wire; /* sent bytes come back */
    bool has_time; /* sent bytes take their time on the wire */

    uint8_t next;    /* the next value to send; all values but POISON in order */
    uint8_t awaited; /* the value that arrivals[0] should have */
    uint16_t got;
    uint32_t wrote_us, called_us; /* the last write: when it was accepted, how long it took */
    uint32_t stamp_us;            /* of the last read with FATHOM_RX_TIMED */
    arrival_t arrivals[MOST];
    uint8_t out[255];
    uint8_t in[300]; /* larger than the capacity of any read */
    uint16_t capacity;
    uint16_t beyond; /* bytes that a read returned or wrote beyond its capacity */
} kit_t;

/* Both return the clock. Only kit_now() checks whether it goes back. */
uint32_t kit_now(kit_t *kit);
uint32_t kit_raw_now(const kit_t *kit);

void kit_tell(kit_t *kit, item_t item, fathom_verdict_t verdict, uint32_t figure);
fathom_verdict_t kit_kept_if(bool kept);

#define BIT_OF(item) (UINT32_C(1) << (item))
/* Returns true if one of these items is not kept. */
bool kit_lacks(const kit_t *kit, uint32_t items);
/* Returns true if bytes come back as they were sent. Otherwise most items show nothing. */
bool kit_has_wire(const kit_t *kit);

/* Returns the longest time of `count` bytes, including a late return of the port. */
uint32_t kit_patience_us(const kit_t *kit, uint32_t count);
uint32_t kit_since(kit_t *kit, uint32_t since_us);
void kit_wait(kit_t *kit, uint32_t us); /* without a read */

void kit_read(kit_t *kit);
/* Reads until `count` bytes have arrived since kit_begin(). Returns false if they do not arrive. */
bool kit_await(kit_t *kit, uint16_t count);
void kit_begin(kit_t *kit);                       /* waits until nothing arrives, and discards all arrivals */
uint8_t kit_value(const kit_t *kit, uint16_t at); /* the value that arrivals[at] should have */
uint8_t kit_after(uint8_t value);                 /* the value that is sent after `value` */

/* Writes the next `length` bytes as soon as the port accepts them, and then overwrites their memory. Returns false if
 * the port never accepts them. */
bool kit_send(kit_t *kit, uint8_t length);
bool kit_await_sent(kit_t *kit); /* without a read */
bool kit_is_sent(const kit_t *kit);

/* The items, in send.c, receive.c and settings.c. */
void kit_sending(kit_t *kit);
void kit_receiving(kit_t *kit);
void kit_settings(kit_t *kit);

#endif
