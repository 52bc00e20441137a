/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/* What is made of the bytes that come to a line for requests. */

enum { LEAST_TRUNCATED = 3 };

void fathom_line_learn(fathom_line_t *line, uint8_t echo)
{
    if (line->config->find_echo != NULL) line->config->find_echo(line, echo);
}

/*
 * The first `length` bytes were not taken. After its time-out a response that has begun may end, but what begins then
 * is another unit's, or endless noise: the attempt is over.
 */
static void leave(fathom_line_t *line, uint8_t length)
{
    fathom_line_leave(line, length);
    if (!expects_response(line)) {
        const uint16_t known = (uint16_t)(line->known + (length * ONE_UNASKED));
        line->known = (uint8_t)((known < OTHERS_SEND) ? known : (line->known | OTHERS_SEND));
        return;
    }
    /* It may be what is left of its response. A whole frame hides no echo. */
    if (length == 1u) line->state |= NOISY;
    if ((line->left_us == 0u) && (phase(line) == LISTENING)) fathom_line_end_attempt(line);
}

/* What is no frame may be the request; so may a frame that is all of it, or all but its last byte. */
static uint8_t match_echo(const fathom_line_t *line, uint8_t frame_length)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->config->frame;
    const uint8_t sent = line->sent;
    if ((sent == 0u) ||
        ((frame_length != 0u) && (((line->state & ECHOED) != 0) || ((uint8_t)(sent - frame_length) > 1u))))
        return 0;
    if (!protocol->is_request(line->head, frame, line->have)) return 0;
    return ((sent > line->have) || (protocol->check(frame, sent) == 0u)) ? sent : 0u;
}

enum { TAKEN = 0x100 };

/* What to do with the front of what was received: so many bytes leave, with TAKEN to a transaction; or, below zero, so
 * many are needed to know. `over`: nothing more will come to complete a frame. */
static int judge(fathom_line_t *line, bool over)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->config->frame;
    const uint8_t have = line->have;
    if (!expects_response(line) && (line->quarantined == 0u)) return have;
    const uint8_t length = protocol->length(frame, have);
    if ((length > have) && (length <= line->config->frame_size) && !over) return -length;
    const bool is_whole = (uint8_t)(length - 1u) < have;
    const bool is_frame = is_whole && (protocol->check(frame, length) == 0u);
    const uint8_t echo = match_echo(line, is_frame ? length : 0u);
    if ((echo > have) && !over) return -echo;
    if ((uint8_t)(echo - 1u) < have) {
        if (!is_frame) fathom_line_learn(line, FATHOM_LINE_ECHO_ON); /* which may equal the response */
        /* Copies without end must not keep it after its time-out. */
        if ((line->left_us == 0u) && ((line->state & ECHOED) != 0)) return echo;
        line->state |= ECHOED;
        return echo | TAKEN;
    }
    if (is_frame) return fathom_line_deliver(line) ? (length | TAKEN) : length;
    /* While the request leaves, noise is likelier than a response. */
    if ((length != 0u) && (have >= LEAST_TRUNCATED) &&
        fathom_line_expects_unit(line, frame[protocol->address_at]))
        line->state |=
            (uint8_t)((is_whole && (phase(line) == LISTENING)) ? RESPONSE_CORRUPT : RESPONSE_TRUNCATED);
    return 1;
}

void fathom_line_scan_responses(fathom_line_t *line, bool over)
{
    while (line->have != 0u) {
        const int judged = judge(line, over);
        if (judged < 0) {
            line->need = (uint8_t)-judged;
            return;
        }
        if (judged >= TAKEN) {
            /* What the listener has heard has ended where this began. */
            line->known = (uint8_t)((line->known & ~(unsigned)UNASKED) | LATE | AFTER_GAP);
        } else {
            leave(line, (uint8_t)judged);
            forget(line, AFTER_GAP);
        }
        fathom_line_drop(line, (uint8_t)judged);
    }
}
