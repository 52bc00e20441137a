/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_CONFORMANCE_KIT_H
#define FATHOM_CONFORMANCE_KIT_H

#include "../fathom_conformance.h"

/* kit.c: what the items share. These are in the order in which they are reported. */
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
    MOST = 360,   /* bytes that are looked at in one go */
    FILL = 320,   /* more than any ring that is known: 128, 64, 256 */
    POISON = 0xEE /* no byte that is sent on purpose */
};

typedef struct {
    uint32_t at_us; /* when the read returned that brought it */
    uint8_t byte;
    uint8_t flags;          /* of its read, for the first byte of that */
    bool is_first, is_last; /* of its read */
} arrival_t;

typedef struct {
    const fathom_conformance_t *bench;
    unsigned failed;
    uint32_t not_kept; /* 1 << item_t */
    uint32_t character_us;
    uint32_t step_us; /* the clock's, the coarsest that was seen */
    uint32_t last_us, back_us;
    bool has_wire; /* what is sent comes back */
    bool has_time; /* and takes its time */

    uint8_t next;    /* what is sent next; all values but POISON, in turn */
    uint8_t awaited; /* the first one of `arrivals` */
    uint16_t got;
    uint32_t wrote_us, called_us; /* the last write: when it was taken, how long it took */
    uint32_t stamp_us;            /* of the last read that was TIMED */
    arrival_t arrivals[MOST];
    uint8_t out[255];
    uint8_t in[300]; /* more than a read is asked for */
    uint16_t capacity;
    uint16_t beyond; /* bytes that a read returned or wrote beyond its capacity */
} kit_t;

/* The clock, and as it is without a look at whether it goes back. */
uint32_t kit_now(kit_t *kit);
uint32_t kit_raw_now(const kit_t *kit);

void kit_tell(kit_t *kit, item_t item, fathom_verdict_t verdict, uint32_t figure);
fathom_verdict_t kit_kept_if(bool kept);

#define BIT_OF(item) (UINT32_C(1) << (item))
/* Is one of these not kept? */
bool kit_lacks(const kit_t *kit, uint32_t items);
/* Bytes come back as they were sent: without that most items show nothing. */
bool kit_has_wire(const kit_t *kit);

/* What `count` bytes may take, handed over late and all. */
uint32_t kit_patience_us(const kit_t *kit, uint32_t count);
uint32_t kit_since(kit_t *kit, uint32_t since_us);
void kit_wait(kit_t *kit, uint32_t us); /* and read nothing */

void kit_read(kit_t *kit);
/* Reads until so many have come since kit_begin; false: they do not come. */
bool kit_await(kit_t *kit, uint16_t count);
void kit_begin(kit_t *kit);                       /* nothing comes any more; what has come is forgotten */
uint8_t kit_value(const kit_t *kit, uint16_t at); /* that arrivals[at] should have */
uint8_t kit_after(uint8_t value);                 /* what is sent after that value */

/* Writes so many of the next bytes, as soon as they are taken, and overwrites the memory that they were in. False: they
 * never are. */
bool kit_send(kit_t *kit, uint8_t length);
bool kit_await_sent(kit_t *kit); /* without a read */
bool kit_is_sent(const kit_t *kit);

/* The items, in send.c, receive.c and settings.c. */
void kit_sending(kit_t *kit);
void kit_receiving(kit_t *kit);
void kit_settings(kit_t *kit);

#endif
