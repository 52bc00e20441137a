/* SPDX-License-Identifier: MIT */
#include "fathom/engine/line.h"

#include "line_internal.h"

/*
 * Many RS-485 adapters receive what they send. The echo arrives before the response and ends before it.
 *
 *     read    sent [request]
 *             wire [request][response]      differ: the first is the echo, the second is the response
 *
 *     write   sent [request]
 *             wire [request]                is this the echo, or the response of a unit without an echo?
 *             wire [request][request]       the echo and the response
 *
 *  - While echo is unknown, received bytes that equal the request are accepted as the echo, once per attempt
 *    (COPY_PAST). A write whose only received bytes equal its request therefore ends with FATHOM_ERR_ECHO.
 *  - If it is known that there is no echo, `copy` is COPY_PAST from the start, and the copy is the response.
 *  - The line learns ECHO_ON from an echo that cannot be a response: the bytes of the request form no response frame.
 *  - The line learns ECHO_OFF from a response without an echo before it. Noise before it proves nothing, because a
 *    damaged echo looks like noise (COPY_HIDDEN).
 *  - The bytes of a request can also begin with a shorter response frame, so a response of the request's length, or one
 *    byte less, can be the echo. A response of any other length cannot.
 *  - Once the time-out has passed, a second copy is discarded. Otherwise endless copies would keep the attempt alive.
 */
static bool can_be_echo(const fathom_line_t *line, uint8_t response_length)
{
    if (!expects_response(line)) return false;
    if (response_length == 0u) return true;
    return (line->attempt.copy != COPY_PAST) && ((response_length == line->attempt.request_length) ||
                                                 ((response_length + 1) == line->attempt.request_length));
}

bool fathom_line_is_echo(const fathom_line_t *line, uint8_t response_length)
{
    const fathom_protocol_t *const protocol = line->protocol;
    const uint8_t *const frame = line->parts->frame;
    const uint8_t request_length = line->attempt.request_length;
    if (!can_be_echo(line, response_length)) return false;
    if (!protocol->is_request(line->head, frame, line->received_count)) return false;
    return (line->received_count < request_length) || (protocol->check(frame, request_length) == 0u);
}
