/* SPDX-License-Identifier: MIT */
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/fair_share.h"
#include "fathom/engine/modbus_client.h"
#include "wire.h"

/*
 * line.h with both clients: three requests of any kind, a listener, breaks and cancels, on a port and a far end that do
 * what the input says. At the end the far end is silent, and all that is under way has to end.
 */
enum { REQUESTS = 3, MOST_TIMEOUT_US = 200000, VALUES = 125, SET_ADDRESS = 0x55, GUARD = 0xA5A5 };

typedef enum { IS_READ, IS_WRITE, IS_WRITE_MANY, IS_DYP, IS_DYP_ADDRESS } kind_t;

typedef struct {
    fathom_modbus_request_t request;
    kind_t kind;
    uint8_t unit; /* that was asked */
    bool is_on;
    bool has_left;
    unsigned from; /* what was heard when it left first */
    uint16_t values[VALUES];
} asked_t;

static asked_t asked[REQUESTS];
static fathom_line_t line;
static fathom_line_parts_t config;
static uint16_t counters[FATHOM_LINE_COUNTERS];
static uint16_t counted[FATHOM_LINE_COUNTERS];
static fathom_listener_t listener;
static unsigned listened; /* of what was heard, so much was told or dropped */

static void receive(fathom_listener_t *to, const uint8_t *bytes, uint8_t count, bool after_gap,
                    uint32_t time_us)
{
    PROMISE(to == &listener && !wire_is_future(time_us),
            "line.h: receive: time_us is when the last of them came");
    for (; count != 0; count--, bytes++) {
        while (listened < wire.count && wire.heard[listened] != *bytes) listened++;
        PROMISE(listened < wire.count, "line.h: receive: the bytes in the order in which they came");
        listened++;
    }
}

/* ---- requests ---- */

static void check_status(const asked_t *one)
{
    const fathom_transaction_t *const transaction = &one->request.transaction;
    const int status = transaction->status;
    const uint8_t *const head = one->request.message.head;
    const bool is_read = one->kind == IS_READ || one->kind == IS_DYP;
    PROMISE(status == FATHOM_OK || (status <= FATHOM_ERR_PORT && status >= FATHOM_ERR_MALFORMED) ||
                status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_ECHO ||
                status == FATHOM_ERR_UNSUPPORTED || status == FATHOM_ERR_LINE_BUSY ||
                (status == FATHOM_ERR_OTHER_MASTER && config.masters != NULL),
            "line.h: the outcomes of a transaction");
    PROMISE(transaction->attempts <= transaction->retries + 1u, "line.h: retries: further attempts");
    PROMISE(transaction->attempts == 0 || one->has_left, "line.h: attempts: how often it was sent");
    if (status == FATHOM_ERR_UNSUPPORTED)
        PROMISE(!one->has_left || transaction->retries != 0, "line.h: nothing was sent");
    if (is_read && status != FATHOM_OK)
        for (unsigned i = 0; i != 8; i++)
            PROMISE(one->values[i] == GUARD, "modbus.h: values are written on OK only");
    if (status == FATHOM_ERR_EXCEPTION)
        PROMISE(wire_heard_exception(one->from, head[0], head[1], one->request.message.exception),
                "line.h: EXCEPTION: the unit refused");
    if (status != FATHOM_OK) return;
    PROMISE(one->has_left, "line.h: OK: after it was sent");
    const bool is_broadcast = one->unit == 0 && (one->kind == IS_WRITE || one->kind == IS_WRITE_MANY);
    if (one->kind == IS_READ)
        PROMISE(wire_heard_read(one->from, head[0], head[5], one->values),
                "line.h: OK: its response has come");
    else if (one->kind == IS_DYP)
        PROMISE(wire_heard_sum(one->from, 0x55, head[5] == 4 ? 13 : 7, one->values[0]),
                "line.h: OK: its response has come");
    else if (one->kind != IS_DYP_ADDRESS && !is_broadcast)
        PROMISE(wire_heard_head(one->from, head), "line.h: OK: it was acknowledged");
    if (one->unit != FATHOM_LINE_ANY_UNIT)
        PROMISE(head[0] == one->unit || one->kind == IS_DYP_ADDRESS, "the unit stays");
    if (!is_broadcast)
        PROMISE(!wire_is_future(transaction->link.heard_us), "line.h: heard_us: when the last byte came");
}

static bool is_under_way(void)
{
    bool is_any = false;
    for (int i = 0; i != REQUESTS; i++) is_any = is_any || asked[i].is_on;
    return is_any;
}

static void check_requests(void)
{
    for (int i = 0; i != REQUESTS; i++) {
        asked_t *const one = &asked[i];
        if (!one->is_on) continue;
        const bool is_pending = one->request.transaction.status == FATHOM_PENDING;
        PROMISE(fathom_line_is_queued(&line, &one->request.transaction) == is_pending,
                "line.h: PENDING while it is queued");
        if (is_pending) continue;
        one->is_on = false;
        check_status(one);
    }
    for (int i = 0; config.count != NULL && i != FATHOM_LINE_COUNTERS; i++) {
        PROMISE(counters[i] >= counted[i], "line.h: counters stop at 65535");
        counted[i] = counters[i];
    }
}

static fathom_status_t describe(asked_t *one, uint8_t how)
{
    fathom_modbus_request_t *const request = &one->request;
    const uint8_t count = fuzz_byte();
    const bool is_with_zero = (how & 64) != 0;
    fathom_status_t (*const submit)(fathom_line_t *, fathom_modbus_request_t *) =
        is_with_zero ? fathom_modbus_client_submit_with_zero : fathom_modbus_client_submit;
    switch (one->kind) {
    case IS_READ:
        fathom_modbus_read_holding_registers(&request->message, one->unit, 0x0100, 1 + count % 125,
                                             one->values);
        return submit(&line, request);
    case IS_WRITE:
        fathom_modbus_write_single_register(&request->message, one->unit, 0x0200, count);
        return submit(&line, request);
    case IS_WRITE_MANY:
        fathom_modbus_write_multiple_registers(&request->message, one->unit, 0x20, 1 + count % 123,
                                               one->values);
        return submit(&line, request);
    case IS_DYP:
        fathom_modbus_read_holding_registers(&request->message, one->unit, (uint16_t)(0x0106 + count % 5 % 4),
                                             count % 5 == 4 ? 4 : 1, one->values);
        return fathom_dyp_client_submit(&line, request);
    default:
        return fathom_dyp_client_broadcast_address(&line, request, count);
    }
}

static void submit(uint8_t how)
{
    asked_t *const one = &asked[how % REQUESTS];
    if (one->is_on) {
        PROMISE(fathom_line_submit(&line, &one->request.transaction) == FATHOM_ERR_BUSY,
                "line.h: BUSY: it is queued");
        return;
    }
    const uint8_t which = fuzz_byte();
    one->kind = (kind_t)(which % 5);
    one->unit = (which & 0x40) != 0 ? fuzz_byte() : (uint8_t)(1 + (which >> 4 & 1));
    one->has_left = false;
    memset(one->values, 0xA5, sizeof one->values);
    one->request.transaction.timeout_us = (how & 4) != 0 ? MOST_TIMEOUT_US : 50000;
    one->request.transaction.retries = how >> 3 & 3;
    one->request.transaction.line_settings = (how & 32) != 0 ? &wire_settings[which >> 7] : NULL;
    const fathom_status_t status = describe(one, how);
    one->is_on = status == FATHOM_PENDING;
    PROMISE(one->is_on || status == FATHOM_ERR_ARGUMENT || status == FATHOM_ERR_CAPACITY ||
                status == FATHOM_ERR_UNSUPPORTED,
            "modbus.h: what submit returns");
}

/* ---- polling ---- */

static void poll(void)
{
    const unsigned before = wire.count;
    wire_poll_begins();
    const fathom_transaction_t *const first = line.head;
    const fathom_status_t status = fathom_line_poll(&line);
    PROMISE(status == FATHOM_PENDING || status == FATHOM_ERR_PORT, "line.h: PENDING, or PORT");
    wire_poll_has_ended();
    (void)first;
    /* What was heard before the request left cannot serve it; the port is read before that, in each poll. */
    for (int i = 0; wire.writes != 0 && i != REQUESTS; i++) {
        asked_t *const one = &asked[i];
        if (!one->is_on || one->has_left || one->request.transaction.attempts == 0) continue;
        one->has_left = true;
        one->from = wire.count;
        PROMISE(wire.count >= before, "it is read before it is sent");
    }
    if (status == FATHOM_ERR_PORT)
        for (int i = 0; i != REQUESTS; i++)
            PROMISE(!asked[i].is_on || asked[i].request.transaction.status != FATHOM_PENDING,
                    "line.h: PORT: every queued transaction has ended with that");
    check_requests();
}

static void go_to_due(void)
{
    const uint32_t due_us = fathom_line_due_us(&line);
    if (due_us != FATHOM_NO_DEADLINE) wire_pass(due_us);
}

static void call(uint8_t op)
{
    const uint8_t how = fuzz_byte();
    switch (how % 4) {
    case 0:
        fathom_line_cancel(&line, &asked[how / 4 % REQUESTS].request.transaction);
        break;
    case 1:
        if (how == 0xFD)
            fathom_line_flush(&line);
        else
            fathom_line_cancel_unit(&line, how >> 4);
        break;
    case 2:
        listened = wire.count >= line.received_count ? wire.count - line.received_count : 0;
        listener = (fathom_listener_t){.receive = receive,
                                       .gap_us = (how & 16) != 0 ? 5000 : 0,
                                       .stale_us = (how & 32) != 0 ? 100000 : 0};
        (void)fathom_line_replace_listener(&line, (how & 8) != 0 ? &listener : NULL);
        break;
    default: {
        const fathom_status_t status = fathom_line_break(&line, (how & 4) != 0);
        PROMISE(status == FATHOM_OK || status == FATHOM_PENDING || status == FATHOM_ERR_BUSY ||
                    status == FATHOM_ERR_PORT,
                "line.h: what break returns");
        if (status == FATHOM_OK) PROMISE(wire.is_low == ((how & 4) != 0), "line.h: OK: it is so now");
    }
    }
    check_requests();
}

/* line.h: what is under way ends, after so many more attempts at the latest, and due_us leads there. */
static void drain(void)
{
    uint64_t passed_us = 0;
    uint64_t most_us = 3000000;
    unsigned zeros = 0;
    wire_drain();
    /* A request that leaves, its time-out, and twice that of quarantine; what the line keeps between frames, or waits for
     * another master at most. */
    for (int i = 0; i != REQUESTS; i++) most_us += 4u * (3u * MOST_TIMEOUT_US + 500000u);
    PROMISE(fathom_line_break(&line, false) == FATHOM_OK, "line.h: break: the port works");
    poll();
    while (is_under_way()) {
        const uint32_t due_us = fathom_line_due_us(&line);
        PROMISE(due_us != FATHOM_NO_DEADLINE, "line.h: due_us: what is queued has something to wait for");
        PROMISE(passed_us <= most_us, "line.h: each transaction ends");
        PROMISE(due_us != 0 || ++zeros < 200, "line.h: due_us: 0 is not for ever");
        if (due_us > 1 && wire_uart.leaves_in_us(NULL) == 0) { /* nothing happens before */
            const bool was_on[REQUESTS] = {asked[0].is_on, asked[1].is_on, asked[2].is_on};
            wire_pass(due_us - 1);
            poll();
            PROMISE(wire.writes == 0, "line.h: due_us: nothing is sent before");
            for (int i = 0; i != REQUESTS; i++)
                PROMISE(asked[i].is_on == was_on[i], "line.h: due_us: nothing ends before");
            wire_pass(1);
        } else {
            wire_pass(due_us);
        }
        passed_us += due_us;
        poll();
    }
    PROMISE(line.head == NULL, "line.h: the queue is empty");
}

static bool begin(uint8_t **frame)
{
    static const uint8_t sizes[] = {255, 64, 13, 8};
    const uint8_t how = fuzz_byte();
    const uint8_t more = fuzz_byte();
    const uint8_t size = sizes[how & 3];
    wire_begin((uint32_t)fuzz_word() << 16, (how & 16) != 0);
    *frame = fuzz_guarded(size);
    memset(&line, FUZZ_GUARD, sizeof line);
    config = (fathom_line_parts_t){.uart = &wire_uart,
                                   .clock = &wire_clock,
                                   .frame = *frame,
                                   .frame_size = size,
                                   .echo = how >> 2 & 3,
                                   .silence_us = (how & 64) != 0 ? 1750 : 0,
                                   .gap_us = (how & 128) != 0 ? 25000 : 0};
    if (config.echo == 0 || config.echo == 3) {
        config.echo = FATHOM_LINE_ECHO_AUTO;
        config.find_echo = fathom_line_find_echo;
    }
    if ((more & 2) != 0) config.senders = &fathom_line_senders;
    if ((more & 4) != 0) config.masters = &fathom_line_masters;
    if ((more & 8) != 0) config.busy_us = 40000;
    if ((how & 16) != 0) config.marks = fathom_line_marks;
    if ((how & 32) != 0) config.count = fathom_line_count;
    config.counters = counters;
    for (int i = 0; i != FATHOM_LINE_COUNTERS; i++) counters[i] = counted[i] = (more & 1) != 0 ? 65534 : 0;
    for (int i = 0; i != REQUESTS; i++) {
        asked[i].is_on = false;
        asked[i].request.transaction.status = FATHOM_OK;
    }
    return fathom_line_init(&line, &config) == FATHOM_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *frame;
    fuzz_begin(data, size);
    PROMISE(begin(&frame), "line.h: init");
    while (fuzz_more() && wire.count < WIRE_HEARD - 400) {
        const uint8_t op = fuzz_byte();
        if (op % 16 < WIRE_OPS)
            wire_op(op);
        else if (op % 16 < 14)
            submit(op >> 4 | (op & 1) << 5);
        else if (op % 16 == 14)
            call(op);
        else
            go_to_due();
        if ((op & 0x80) == 0 || op % 16 >= WIRE_OPS) poll();
    }
    drain();
    free(frame);
    return 0;
}
