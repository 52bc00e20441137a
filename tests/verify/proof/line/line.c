/* SPDX-License-Identifier: MIT */
/*
 * proves: src/engine/line.c src/engine/line_attempt.c src/engine/line_masters.c src/engine/line_options.c
 *          src/engine/line_request.c src/engine/line_response.c src/engine/line_due.c src/engine/line_echo.c src/engine/line_refusals.c src/engine/line_round.c src/engine/line_senders.c
 * with:   src/codec/dyp_55aa.c src/codec/dyp_stream.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 128
 *          -eva-slevel-function fathom_line_begin:100,fathom_line_init:20,can_send:20,is_usable:20,main:5,fathom_line_poll:3,fathom_line_marks:30
 *          -eva-split-return-function fathom_line_begin:0,fathom_line_init:0
 * quick:   yes
 *
 * A line with up to three transactions of any protocol that keeps to transaction.h, with or without each optional part,
 * with a listener that comes and goes, and with breaks and flushes: any calls in any order, any bytes, receive flags and
 * times.
 */
#include "fathom/engine/line.h"
#include "contracts.h"
#include "fathom/engine/fair_share.h"

enum { FRAME_SIZE = 13 };

static uint8_t frame[FRAME_SIZE];
static fathom_line_t line;
static fathom_line_parts_t config;
static uint16_t counters[FATHOM_LINE_COUNTERS];
static fathom_transaction_t a, b, c;

#ifdef FAIR_SHARE
static fathom_fair_share_t share;
#endif

/* ---- any protocol, as fathom_protocol_t has it; those of the clients are proved in clients.c ---- */

static uint8_t encode(const fathom_transaction_t *transaction, uint8_t *to)
{
    const uint8_t length = any_8_in(1, FRAME_SIZE);
    /*@ assert to == &frame[0]; */
    (void)transaction->address;
    return length;
}

static uint8_t length(const uint8_t *bytes, uint8_t have)
{
    /*@ assert bytes == &frame[0]; */
    /*@ assert received: 1 <= have <= FRAME_SIZE; */
    return any_8();
}

static uint16_t check(const uint8_t *bytes, uint8_t length_of_it)
{
    /*@ assert bytes == &frame[0]; */
    /*@ assert whole: 1 <= length_of_it <= FRAME_SIZE; */
    return any_16();
}

static bool is_request(const fathom_transaction_t *transaction, const uint8_t *bytes, uint8_t have)
{
    /*@ assert bytes == &frame[0]; */
    /*@ assert received: 1 <= have <= FRAME_SIZE; */
    (void)transaction->address;
    return any_bool();
}

static fathom_status_t parse_response(fathom_transaction_t *transaction, const uint8_t *bytes)
{
    /*@ assert bytes == &frame[0]; */
    (void)transaction->address;
    return (fathom_status_t)Frama_C_interval(FATHOM_ERR_MALFORMED, FATHOM_OK);
}

static fathom_status_t parse_other(fathom_transaction_t *transaction, const uint8_t *bytes)
{
    return parse_response(transaction, bytes);
}

static bool may_collide(const fathom_transaction_t *transaction)
{
    (void)transaction->address;
    return any_bool();
}

static const fathom_protocol_t protocols[2] = {
    {encode, length, check, is_request, parse_response, 0, true, may_collide},
    {encode, length, check, is_request, parse_other, 2, false, NULL}};

/* ---- any listener ---- */

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t of_them, bool after_gap,
                    uint32_t time_us)
{
    (void)listener->gap_us;
    /*@ assert after_gap == 0 || after_gap == 1; */
    /*@ assert there: bytes == &frame[0] && of_them <= FRAME_SIZE; */
    (void)time_us;
}

static fathom_listener_t listener = {receive, 0, 0};

/* ---- any calls ---- */

static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};

static void submit(fathom_transaction_t *transaction)
{
    if (fathom_line_is_queued(
            &line, transaction)) { /* "leave it alone until its status is no longer FATHOM_PENDING" */
        (void)fathom_line_submit(&line, transaction);
        return;
    }
    transaction->protocol = any_bool() ? &protocols[0] : &protocols[1];
    transaction->line_settings = any_bool() ? &settings : NULL;
    transaction->timeout_us = any_32();
    transaction->address = any_8();
    transaction->retries = any_8();
    (void)fathom_line_submit(&line, transaction);
}

static fathom_transaction_t *any_transaction(void)
{
    if (any_bool()) return &a;
    return any_bool() ? &b : &c;
}

static void any_call(void)
{
    switch (any_8_in(0, 11)) {
    case 0:
        if (!fathom_line_was_polled(&line, any_32())) (void)fathom_line_poll(&line);
        break;
    case 1:
        submit(&a);
        break;
    case 2:
        submit(&b);
        break;
    case 3:
        submit(&c);
        break;
    case 4:
        fathom_line_cancel(&line, any_transaction());
        break;
    case 5:
        fathom_line_cancel_unit(&line, any_8());
        break;
    case 6:
        (void)fathom_line_replace_listener(&line, any_bool() ? &listener : NULL);
        break;
    case 7:
        (void)fathom_line_break(&line, any_bool());
        break;
    case 8:
        (void)fathom_line_due_us(&line);
        break;
    case 9:
        (void)fathom_line_listen(&line, any_bool() ? &listener : NULL);
        fathom_line_unlisten(&line, any_bool() ? &listener : NULL);
        break;
    case 10:
        fathom_line_flush(&line);
        break;
    default:
        (void)fathom_line_is_idle(&line);
        (void)fathom_line_last_byte_us(&line);
        (void)fathom_line_holds_bytes(&line);
        (void)fathom_line_get_echo(&line);
    }
}

/* What has left the line is the caller's again, whose memory may end with it: a pointer that is kept is an alarm. */
static void borrow(void)
{
    fathom_listener_t its_listener;
    fathom_transaction_t its_transaction;
    its_listener.receive = receive;
    its_listener.gap_us = any_16();
    its_listener.stale_us = any_32();
    its_transaction.protocol = &protocols[0];
    its_transaction.line_settings = NULL;
    its_transaction.timeout_us = any_32() & INT32_MAX;
    its_transaction.address = any_8();
    its_transaction.retries = 0;
    (void)fathom_line_replace_listener(&line, &its_listener);
    const fathom_status_t status = fathom_line_listen(&line, &listener);
    /*@ assert status == FATHOM_ERR_BUSY; */
    (void)fathom_line_submit(&line, &its_transaction);
    fathom_line_cancel(&line, &its_transaction);
    fathom_line_unlisten(&line, &its_listener);
}

/* A line whose config was refused refuses all calls. */
static void refuse(const fathom_line_parts_t *wrong)
{
    fathom_status_t status = fathom_line_init(&line, wrong);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    status = fathom_line_poll(&line);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    status = fathom_line_break(&line, any_bool());
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    status = fathom_line_submit(&line, &a);
    /*@ assert status == FATHOM_ERR_ARGUMENT; */
    const uint32_t due_us = fathom_line_due_us(&line);
    /*@ assert due_us == FATHOM_NO_DEADLINE; */
    const bool was_polled = fathom_line_was_polled(&line, any_32());
    /*@ assert was_polled == 0; */
    fathom_line_flush(&line);
    fathom_line_cancel(&line, &a);
}

static void refused(void)
{
    static uint8_t short_frame[7];
    static const fathom_clock_t no_time = {NULL, &assumed_ctx};
    fathom_line_parts_t wrong = config;
    fathom_uart_t uart = assumed_uart;
    wrong.uart = NULL;
    refuse(&wrong);
    wrong.uart = &uart;
    uart.read = NULL;
    refuse(&wrong);
    uart = assumed_uart;
    uart.write = NULL;
    refuse(&wrong);
    uart = assumed_uart;
    uart.sent = NULL;
    refuse(&wrong);
    wrong = config;
    wrong.clock = NULL;
    refuse(&wrong);
    wrong.clock = &no_time;
    refuse(&wrong);
    wrong = config;
    wrong.frame = NULL;
    refuse(&wrong);
    wrong.frame = short_frame;
    wrong.frame_size = any_8_in(0, sizeof short_frame);
    refuse(&wrong);
    wrong = config;
    wrong.count = fathom_line_count;
    wrong.counters = NULL;
    refuse(&wrong);
    wrong = config;
    wrong.echo = any_8_in(3, UINT8_MAX);
    refuse(&wrong);
    wrong = config;
    wrong.echo = FATHOM_LINE_ECHO_AUTO;
    wrong.find_echo = NULL;
    refuse(&wrong);
    wrong = config;
    wrong.silence_us = UINT16_MAX;
    refuse(&wrong);
    wrong = config;
    wrong.gap_us = any_8_in(1, 99);
    refuse(&wrong);
    wrong = config;
    wrong.busy_us = 1;
    refuse(&wrong);
}

void main(void)
{
    config.uart = any_bool() ? &assumed_uart : &assumed_bare_uart;
    config.clock = &assumed_clock;
    config.frame = frame;
    config.frame_size = FRAME_SIZE;
    config.echo = any_8_in(0, 2);
    config.silence_us = any_16();
    config.gap_us = any_16();
    config.find_echo = any_bool() ? fathom_line_find_echo : NULL;
    if (any_bool()) config.marks = any_bool() ? fathom_line_marks : fathom_line_refusals;
    config.count = any_bool() ? fathom_line_count : NULL;
    config.counters = counters;
    config.busy_us = any_32();
    config.senders = any_bool() ? &fathom_line_senders : NULL;
    config.masters = any_bool() ? &fathom_line_masters : NULL;
    listener.gap_us = any_16();
    listener.stale_us = any_32();
    refused();
    if (fathom_line_init(&line, &config) != FATHOM_OK) return;
#ifdef FAIR_SHARE
    fathom_fair_share(&share, &line);
#endif
    borrow();
    while (any_bool()) any_call();
}
