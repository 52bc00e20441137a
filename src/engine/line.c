/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * What every line does: it reads the port, measures silence, feeds the listener and holds breaks. What a line does with
 * the received bytes depends on its kind: line_request.c or line_listening.c. line_due.c computes the next deadline.
 */

enum { MAX_READS = 16, MIN_FRAME_SIZE = 8, MIN_GAP_US = 100 };

/* A value of `awaited_left_us`: the wait for the response to another master is over. The bytes that this poll reads may
 * have arrived before, so for them it is not. */
enum { ENDS_WITH_THIS_POLL = 1 };

/* ---- The optional parts ---- */

void fathom_line_add(fathom_line_t *line, uint8_t which, uint8_t by)
{
    const fathom_line_parts_t *const parts = line->parts;
    if (parts->count != NULL) parts->count(line, which, by);
}

void fathom_line_note_sender(fathom_line_t *line, uint8_t event, uint32_t amount)
{
    const fathom_line_senders_t *const senders = line->parts->senders;
    if (senders != NULL) senders->note(line, event, amount);
}

uint8_t fathom_line_find_request(fathom_line_t *line, bool is_response)
{
    const fathom_line_masters_t *const masters = line->parts->masters;
    return (masters != NULL) ? masters->find_request(line, is_response) : 0u;
}

/* ---- Initialisation ---- */

/* 65535 is what FATHOM_T3_5_US() returns if the silence does not fit. */
static bool is_silence(uint16_t us) { return us != UINT16_MAX; }

static bool is_usable(const fathom_line_parts_t *parts)
{
    if ((parts->uart == NULL) || (parts->uart->read == NULL) || (parts->clock == NULL) ||
        (parts->clock->now_us == NULL) || (parts->frame == NULL) || (parts->frame_size < MIN_FRAME_SIZE))
        return false;
    if ((parts->count != NULL) && (parts->counters == NULL)) return false;
    if ((parts->gap_us != 0u) && (parts->gap_us < MIN_GAP_US)) return false;
    return is_silence(parts->silence_us);
}

fathom_status_t fathom_line_begin(fathom_line_t *line, const fathom_line_parts_t *parts,
                                  const fathom_line_kind_t *kind)
{
    clear(line, sizeof *line);
    if (!is_usable(parts)) return FATHOM_ERR_ARGUMENT;
    line->parts = parts;
    FATHOM_ASSERT_NOTE(line->parts_sum = sum_of_parts(parts));
    line->kind = kind;
    line->echo = parts->echo;
    line->polled_us = clock_us(parts->clock);
    line->age = AGE_OLD;
    return FATHOM_OK;
}

/* ---- Time ---- */

/*
 * Moves all deadlines on to `now_us`.
 *
 * A quarantine is counted from the end of the request, so it does not run while a cancelled request still leaves.
 */
static void move_to(fathom_line_t *line, uint32_t now_us)
{
    const uint32_t passed_us = time_since_us(now_us, line->polled_us);
    line->polled_us = now_us;
    (void)fathom_count_down(&line->phase_left_us, passed_us);
    if ((line->awaited_left_us != 0u) && fathom_count_down(&line->awaited_left_us, passed_us))
        line->awaited_left_us = ENDS_WITH_THIS_POLL;
    if ((line->quarantined_units != 0u) && (line->phase != FATHOM_LINE_DRAINING) &&
        fathom_count_down(&line->quarantine_left_us, passed_us))
        line->quarantined_units = 0;
}

uint32_t fathom_line_last_byte_us(const fathom_line_t *line) { return line->polled_us - line->silent_us; }

/* ---- The listener ---- */

fathom_listener_t *fathom_line_replace_listener(fathom_line_t *line, fathom_listener_t *listener)
{
    fathom_listener_t *const previous = line->listener;
    line->listener = listener;
    return previous;
}

fathom_status_t fathom_line_listen(fathom_line_t *line, fathom_listener_t *listener)
{
    if ((listener != NULL) && (line->listener != NULL) && (line->listener != listener))
        return FATHOM_ERR_BUSY;
    line->listener = listener;
    return FATHOM_OK;
}

void fathom_line_unlisten(fathom_line_t *line, const fathom_listener_t *listener)
{
    if (line->listener == listener) line->listener = NULL;
}

bool fathom_line_holds_bytes(const fathom_line_t *line) { return holds_bytes(line); }

static bool is_listeners_gap(const fathom_line_t *line)
{
    return (line->listener != NULL) && (line->silent_us >= line->listener->gap_us);
}

void fathom_line_pass(fathom_line_t *line, uint8_t from, uint8_t length)
{
    fathom_listener_t *const listener = line->listener;
    if (listener == NULL)
        fathom_line_add(line, FATHOM_LINE_DROPPED_BYTES, length);
    else
        listener->receive(listener, &line->parts->frame[from], length, line->is_after_gap,
                          fathom_line_last_byte_us(line));
    line->is_after_gap = false;
}

/* ---- Silence ---- */

uint32_t fathom_line_gap_left_us(const fathom_line_t *line)
{
    const uint32_t gap_us = or_default(line->parts->gap_us, FATHOM_LINE_DEFAULT_GAP_US);
    if ((gap_us == FATHOM_LINE_NO_GAP) && (line->phase == FATHOM_LINE_WAITING)) return line->phase_left_us;
    return rest_us(gap_us, line->silent_us);
}

uint32_t fathom_line_silence_left_us(const fathom_line_t *line)
{
    return rest_us(silence_us(line), line->silent_us);
}

/* ---- The age of bytes ---- */

/* Returns true if a response may arrive that a transaction would accept. */
static bool may_respond(const fathom_line_t *line)
{
    return (line->head != NULL) && (is_busy(line) || (line->quarantined_units != 0u));
}

/*
 * Bytes that wait in the port may be as old as the pause since the previous poll.
 *
 *     polls      |  |  |                                    |  |
 *     port             . [response]  . . . no poll . . . . .
 *                      |<-- pause: more than the limit? --->| drop all bytes until the port is empty
 *
 *  - The limit is the time-out of the request on the wire, or of the one that waits for a late response, and the
 *    `stale_us` of the listener, whichever is less. A program that sleeps for due_us polls a little after the limit, so
 *    FATHOM_LINE_LATE_US comes on top.
 *  - A time stamp of the port (FATHOM_RX_TIMED) dates the bytes, so that young bytes behind a long pause are kept.
 *  - After the initialisation and after a read that failed, the age of the bytes is not known, so they count as old.
 *  - Dropped bytes are counted, and they still show that a device sends by itself.
 */
bool fathom_line_is_old(const fathom_line_t *line, uint32_t age_us)
{
    uint32_t limit_us = FATHOM_NO_DEADLINE;
    if (may_respond(line)) limit_us = line->head->timeout_us;
    if ((line->listener != NULL) && (line->listener->stale_us != 0u))
        limit_us = least_us(limit_us, line->listener->stale_us);
    return rest_us(age_us, FATHOM_LINE_LATE_US) > limit_us;
}

/* Drops all bytes until the port was seen empty. What is in the frame buffer arrived before the last poll: this function
 * passes it on, and its time is right as long as `polled_us` is that of the last poll. */
static void drop_port(fathom_line_t *line)
{
    line->kind->scan(line, true);
    if (line->age < AGE_OLD) line->age = (uint8_t)(line->age + AGE_OLD);
}

/* Reads the clock and moves all deadlines on. Returns the time since the previous call, in microseconds. */
static uint32_t begin_turn(fathom_line_t *line)
{
    const uint32_t now_us = clock_us(line->parts->clock);
    const uint32_t pause_us = time_since_us(now_us, line->polled_us);
    if ((pause_us > FATHOM_LINE_LATE_US) && fathom_line_is_old(line, pause_us)) drop_port(line);
    move_to(line, now_us);
    return pause_us;
}

void fathom_line_flush(fathom_line_t *line)
{
    if (!is_initialised(line)) return;
    drop_port(line);
    fathom_line_pass(line, 0, 0); /* A frame of before is no reading of now. */
}

/* The next bytes are young. */
static void end_dropping(fathom_line_t *line)
{
    if (line->age >= AGE_OLD) line->age = (uint8_t)(line->age - AGE_OLD);
}

/* Sets the silence from the port's time stamp. A stamp that is later than the clock counts as "now" (hal.h). */
static void apply_time_stamp(fathom_line_t *line, uint32_t last_us)
{
    uint32_t age_us = fathom_elapsed_us(line->polled_us, last_us);
    if (age_us > (UINT32_MAX / 2u)) age_us = 0;
    set_silent(line, age_us);
    if (!fathom_line_is_old(line, age_us)) end_dropping(line);
}

/* ---- Polling ---- */

fathom_status_t fathom_line_broken(fathom_line_t *line)
{
    fathom_line_add(line, FATHOM_LINE_PORT_ERRORS, 1);
    line->received_count = 0;
    line->passed_count = 0;
    /* The port may return as another device, so nothing that was learnt from received bytes remains valid. */
    line->echo = line->parts->echo;
    line->attempt.copy = COPY_PAST;
    line->is_after_gap = false;
    line->sender = SENDER_NONE;
    line->unsolicited_count = 0;
    line->unrequested_count = 0;
    /* The port has FATHOM_LINE_SEND_US again to end the break. */
    if (line->phase == FATHOM_LINE_ENDING_BREAK) line->phase = FATHOM_LINE_IN_BREAK;
    if (line->kind->fail_all != NULL) line->kind->fail_all(line);
    return FATHOM_ERR_PORT;
}

static void drop(fathom_line_t *line, uint8_t new_count)
{
    line->age = AGE_DROPPED;
    line->is_after_gap = false;
    fathom_line_add(line, FATHOM_LINE_OLD_BYTES, new_count);
    fathom_line_note_sender(line, SENDER_BYTES, new_count);
    if (line->parts->masters != NULL) line->parts->masters->note_lost_bytes(line);
}

/* For the listener, dropped bytes are lost bytes: no frame continues across them. The line reports the loss with the next
 * bytes, so that a pause of the program alone is no damage. */
static void report_loss(fathom_line_t *line)
{
    const bool is_after_gap = line->is_after_gap;
    line->age = AGE_KNOWN;
    fathom_line_pass(line, 0, 0);
    line->is_after_gap = is_after_gap;
}

/* Adds `new_count` bytes, which the port has written behind the received bytes, and scans all of them. */
static void receive(fathom_line_t *line, uint8_t new_count, const fathom_rx_t *rx)
{
    if (!holds_bytes(line) && is_listeners_gap(line)) line->is_after_gap = true;
    line->slot = SLOT_OPEN;
    line->silent_us = 0;
    move_to(line, clock_us(line->parts->clock));
    if ((rx->flags & FATHOM_RX_TIMED) != 0) apply_time_stamp(line, rx->last_us);
    if (line->parts->marks != NULL) new_count = line->parts->marks(line, rx, new_count);
    if (line->age >= AGE_OLD) {
        drop(line, new_count);
        return;
    }
    if (line->age == AGE_LOST) report_loss(line);
    line->received_count = (uint8_t)(line->received_count + new_count);
    line->kind->scan(line, false);
}

/*
 * Reads the port until it has no more bytes, at most MAX_READS times.
 *
 * Silence is counted only where a read returned nothing: bytes that wait in the port are no silence. The clock is read
 * before the first read and after each read that returned bytes, so `silent_us` is the silence up to the next read.
 */
static fathom_status_t read_port(fathom_line_t *line)
{
    const fathom_uart_t *const uart = line->parts->uart;
    const uint32_t pause_us = begin_turn(line);
    uint32_t silent_us = pause_us + line->silent_us;
    fathom_line_note_sender(line, SENDER_PAUSE, pause_us);
    for (uint8_t reads_left = MAX_READS; reads_left != 0u; reads_left--) {
        fathom_rx_t rx;
        rx.last_us = 0;
        rx.flags = 0;
        const int new_count = uart->read(uart->ctx, &line->parts->frame[line->received_count],
                                         (size_t)(line->parts->frame_size - line->received_count), &rx);
        if (new_count <= 0) {
            set_silent(line, silent_us);
            end_dropping(line);
            if (new_count == 0) return FATHOM_PENDING;
            line->age = AGE_DROPPED; /* Bytes may wait in a port that cannot be read. */
            return fathom_line_broken(line);
        }
        receive(line, (uint8_t)new_count, &rx);
        silent_us = line->silent_us;
    }
    line->silent_us = 0; /* The port may hold bytes that are newer than the time stamp of the last read. */
    line->slot = SLOT_OPEN;
    return FATHOM_PENDING;
}

uint32_t fathom_line_frame_over_us(const fathom_line_t *line)
{
    if (line->received_count == 0u) return FATHOM_NO_DEADLINE;
    return holds_bytes(line) ? fathom_line_gap_left_us(line) : fathom_line_silence_left_us(line);
}

fathom_status_t fathom_line_poll(fathom_line_t *line)
{
    if (!is_initialised(line)) return FATHOM_ERR_ARGUMENT;
    FATHOM_ASSERT(line->parts_sum ==
                  sum_of_parts(line->parts)); /* The parts changed, or their memory was freed. */
    const fathom_status_t status = read_port(line);
    if (status != FATHOM_PENDING) return status;
    if (line->awaited_left_us == ENDS_WITH_THIS_POLL) line->awaited_left_us = 0;
    if (fathom_line_frame_over_us(line) == 0u) line->kind->scan(line, true);
    return line->kind->advance(line);
}

bool fathom_line_is_idle(const fathom_line_t *line)
{
    return !is_busy(line) && (line->phase != FATHOM_LINE_DRAINING) && (line->received_count == 0u);
}

/* ---- Breaks ---- */

/* The port did not release TX. Like a port that does not send, it has FATHOM_LINE_SEND_US to do so. */
static void begin_ending(fathom_line_t *line)
{
    if (line->phase == FATHOM_LINE_IN_BREAK) line->phase_left_us = FATHOM_LINE_SEND_US;
    line->phase = FATHOM_LINE_ENDING_BREAK;
    line->wait = WAIT_NONE;
}

/* TX is high again. The silence before a request starts here; the listener's silence was not interrupted. */
static void release(fathom_line_t *line)
{
    line->phase = FATHOM_LINE_IDLE;
    line->wait = WAIT_NONE;
    if ((line->received_count == 0u) && is_listeners_gap(line)) line->is_after_gap = true;
    line->silent_us = 0;
}

fathom_status_t fathom_line_break(fathom_line_t *line, bool on)
{
    if (!is_initialised(line)) return FATHOM_ERR_ARGUMENT;
    const fathom_uart_t *const uart = line->parts->uart;
    if (uart->set_break == NULL) return FATHOM_ERR_UNSUPPORTED;
    if (is_busy(line)) return on ? FATHOM_ERR_BUSY : FATHOM_OK; /* TX is not low while a request leaves. */
    const int result = uart->set_break(uart->ctx, on);
    (void)begin_turn(line);
    if (result > 0) {
        if (!on)
            release(line);
        else if (line->phase != FATHOM_LINE_IN_BREAK) {
            line->phase = FATHOM_LINE_IN_BREAK;
            line->wait = WAIT_NONE;
        }
        return FATHOM_OK;
    }
    if (!on && is_in_break(line)) {
        begin_ending(line);
        if ((result < 0) || (line->phase_left_us == 0u)) return fathom_line_broken(line);
    }
    return (result < 0) ? FATHOM_ERR_PORT : FATHOM_PENDING;
}
