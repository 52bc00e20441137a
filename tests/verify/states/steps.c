/* SPDX-License-Identifier: MIT */
#include "world.h"

#include "line_internal.h"

#include <string.h>

#include "fathom/codec/dyp_55aa.h"
#include "fathom/status.h"

/* What may happen next, and what comes of it. Each step is one thing: a tick, a call, or something on the wire. */

enum { FIRST_BYTES = 4, THIRD_UNIT = 3 };

static bool has_space(void) { return world.rx_length <= RX - 9 && (world.came & ALONE) == 0; }

/* All that could come has come, all that could pass has passed: a tick more changes nothing. */
static bool stands_still(void)
{
    for (int i = 0; i != TICKETS; i++)
        if (world.tickets[i].stage != NONE) return false;
    return world.passed == 0 && world.asked == 0 && !world.has_spoken && world.line.awaited_left_us == 0 &&
           world.due == NEVER && world.leaving == 0 && world.rx_length == 0 &&
           world.line.received_count == 0 && world.line.quarantined_units == 0 &&
           world.quiet >= options.silence && world.line.silent_us > options.silence * TICK_US &&
           world.line.silent_us > options.gap * TICK_US;
}

/* A unit ends one response before it begins another. */
static bool is_due(int ticket)
{
    for (int i = 0; i != TICKETS; i++)
        if (world.tickets[i].stage == BEGUN &&
            unit_of(world.tickets[i].transaction) == unit_of(world.tickets[ticket].transaction))
            return false;
    return world.tickets[ticket].stage == DUE;
}

static bool is_any_due(void)
{
    for (int i = 0; i != TICKETS; i++)
        if (world.tickets[i].stage > LEAVING) return true;
    return false;
}

static bool is_piece_possible(int ticket)
{
    return is_due(ticket) && (world.tickets[ticket].flags & PIECE) == 0;
}

/* A unit whose response is late, or will be when the program polls, sends nothing by itself (README.md). */
static bool has_late_response(int unit)
{
    for (int i = 0; i != TICKETS; i++) {
        const ticket_t *const ticket = &world.tickets[i];
        const int x = ticket->transaction;
        if (ticket->stage == NONE || unit_of(x) != unit) continue;
        if ((ticket->flags & CLOSED) != 0 || ticket->age + options.poll >= timeout_of(x)) return true;
    }
    return false;
}

/* One device sends in a tick, into an empty port. */
static bool may_speak(void) { return has_space() && world.rx_length == 0 && !world.has_spoken; }

/* Ticks after another master's request within which the unit responds: the line waits so long for it. */
static int answer_limit(void)
{
    const int least = options.timeout[0] < options.timeout[1] ? options.timeout[0] : options.timeout[1];
    return options.busy < least ? options.busy : least;
}

static bool is_unit_queued(int unit) { return is_queued(2 * unit) || is_queued(2 * unit + 1); }

bool is_possible(int step)
{
    if (step >= SUBMIT && step < CANCEL) return there_is(step - SUBMIT) && !is_queued(step - SUBMIT);
    if (step >= CANCEL && step < CANCEL_UNIT) return options.cancel && is_queued(step - CANCEL);
    if (step >= CANCEL_UNIT && step < CANCEL_UNIT + UNITS)
        return options.cancel_unit && is_unit_queued(step - CANCEL_UNIT);
    if (step >= RESPOND && step < FOREIGN) {
        if (!has_space()) return false;
        const int ticket = step % TICKETS;
        switch (step - ticket) {
        case RESPOND:
            return is_due(ticket);
        case EXCEPTION:
            return is_due(ticket) && options.exception;
        case DAMAGED:
            return is_due(ticket) && options.damaged;
        case UNEXPECTED:
            return is_due(ticket) && options.unexpected;
        case SEND_PIECE:
            return is_piece_possible(ticket) && options.piece && world.rx_length == 0 &&
                   (options.crowd || world.line.received_count == 0);
        case BEGIN:
            return is_due(ticket) && options.halves;
        default:
            return world.tickets[ticket].stage == BEGUN;
        }
    }
    switch (step) {
    case TICK:
        return world.passed < options.poll && !stands_still();
    case PAUSE:
        return world.rx_length == 0 && world.line.received_count == 0 && !is_any_due();
    case PAUSE_STAYS:
        return options.write_busy && is_possible(PAUSE);
    case POLL:
        return true;
    case POLL_READ_FAILS:
        return options.read_fails;
    case POLL_WRITE_FAILS:
        return options.write_fails;
    case POLL_WRITE_BUSY:
        return options.write_busy;
    case POLL_SET_BUSY:
    case POLL_SET_FAILS:
        return options.set_line;
    case POLL_DRAWN:
        return world.line.sender == SENDER_LOST_2;
    case FOREIGN:
        return options.foreign && may_speak();
    case STREAM:
        return options.stream && may_speak();
    case OWN:
        return options.own && may_speak() && !has_late_response(0);
    case NOISE:
        return options.noise && may_speak();
    case ASK:
        return options.asks && may_speak() && world.asked == 0 && world.leaving == 0;
    case ANSWER:
        return world.asked != 0 && has_space();
    default:
        return false;
    }
}

static void put_echo(int transaction)
{
    uint8_t bytes[8];
    if (options.dyp) {
        put(bytes, fathom_dyp_55aa_encode_request(bytes, address_of(transaction), FATHOM_DYP_FIRST_PROBE));
        return;
    }
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, address_of(transaction), 0x0106, 1, NULL);
    put(bytes, fathom_modbus_rtu_encode_request(&message, bytes));
}

static void forget(ticket_t *ticket) { memset(ticket, 0, sizeof *ticket); }

static void age(ticket_t *ticket)
{
    if (ticket->stage == LEAVING) {
        if (world.leaving != 0) return;
        ticket->stage = DUE;
        if (options.echo) put_echo(ticket->transaction);
    } else if (ticket->stage == DUE) {
        if (++ticket->age >= latest(ticket->transaction)) forget(ticket);
    } else if (ticket->stage == BEGUN) {
        if (++ticket->age >= latest(ticket->transaction) + options.gap) forget(ticket);
    }
}

static void tick(void)
{
    world.now_us += TICK_US;
    world.passed++;
    world.has_spoken = 0;
    if (is_waiting(&world.line) && world.waited < options.busy) world.waited++;
    if (world.asked != 0 && ++world.asked_age >= answer_limit()) world.asked = world.asked_age = 0;
    if (world.due != 0 && world.due != NEVER) world.due--;
    if (world.quiet < options.silence) world.quiet++;
    if (world.leaving != 0) {
        world.quiet = 0;
        world.leaving--;
    }
    for (int i = 0; i != TICKETS; i++) age(&world.tickets[i]);
}

static void look_when_due(void)
{
    const uint32_t us = fathom_line_due_us(&world.line);
    /* A port that does not tell when it is ready is tried again at each poll. */
    const bool is_unknown = world.line.phase >= FATHOM_LINE_DRAINING &&
                            world.line.phase <= FATHOM_LINE_SENDING && world.leaving == 0;
    const uint32_t ticks = us / TICK_US + (us % TICK_US != 0);
    world.due = ticks < NEVER && !is_unknown ? (uint8_t)ticks : NEVER;
}

/* Of a port that is broken nothing more leaves. */
static void lose_request(void)
{
    if (world.leaving != 0) world.quiet = 0;
    world.leaving = 0;
    for (int i = 0; i != TICKETS; i++)
        if (world.tickets[i].stage == LEAVING) forget(&world.tickets[i]);
}

/* Where the line draws by the clock, the clock decides. */
static void set_draw(bool is_drawn)
{
    const uint32_t by_us = (is_drawn ? 0u : 1u) - world.now_us;
    world.now_us += by_us;
    world.line.polled_us += by_us;
}

static void poll(void)
{
    if (options.senders) set_draw(false);
    if (fathom_line_poll(&world.line) == FATHOM_ERR_PORT) lose_request();
    world.passed = 0;
    world.is_news = 0;
    look_when_due();
}

static void poll_drawn(void)
{
    set_draw(true);
    (void)fathom_line_poll(&world.line);
    world.passed = 0;
    world.is_news = 0;
    look_when_due();
}

/* A second. What could still come does not; a request that leaves got stuck in the port. */
static void pause(void)
{
    world.now_us += LONG_US;
    world.quiet = (uint8_t)options.silence;
    for (int i = 0; i != TICKETS; i++)
        if (world.leaving == 0) forget(&world.tickets[i]);
    world.asked = world.asked_age = world.has_spoken = 0;
    if (is_waiting(&world.line)) world.waited = (uint8_t)options.busy;
    world.due = 0;
    poll();
}

static void note(int what, bool is_in_time)
{
    world.came = (uint8_t)(world.came | what | (is_in_time ? IN_TIME : 0));
}

static void come(int step)
{
    uint8_t bytes[13];
    const int number = step % TICKETS;
    ticket_t *const ticket = &world.tickets[number];
    const bool is_open = (ticket->flags & CLOSED) == 0;
    const bool is_first = world.rx_length == 0 && world.line.received_count == 0;
    const bool is_in_time =
        is_first && ticket->age < timeout_of(ticket->transaction) && (world.came & CLAIMED) == 0;
    uint8_t length = response(number, bytes);
    switch (step - number) {
    case RESPOND:
        if (is_open && is_in_time && (ticket->flags & PIECE) == 0) ticket->flags |= SURE;
        break;
    case EXCEPTION: {
        fathom_modbus_message_t message;
        fathom_modbus_read_holding_registers(&message, address_of(ticket->transaction), 0x0106, 1, NULL);
        message.exception = (uint8_t)(number + 1);
        length = fathom_modbus_rtu_encode_response(&message, bytes);
        break;
    }
    case DAMAGED:
        bytes[length - 2] ^= 0x40;
        if (is_open) note(BAD, is_in_time);
        break;
    case UNEXPECTED:
        if (options.dyp) {
            const uint16_t value = 0x0700;
            length = fathom_dyp_55aa_encode_response(bytes, address_of(ticket->transaction),
                                                     FATHOM_DYP_FIRST_PROBE + 1, &value);
        } else {
            uint16_t values[2] = {0x0700, 0x0701};
            fathom_modbus_message_t message;
            fathom_modbus_read_holding_registers(&message, address_of(ticket->transaction), 0x0106, 2,
                                                 values);
            length = fathom_modbus_rtu_encode_response(&message, bytes);
        }
        if (is_open) note(OTHER, is_in_time);
        break;
    case SEND_PIECE:
        put(bytes, FIRST_BYTES);
        ticket->flags |= PIECE;
        if (!options.crowd) world.came |= ALONE;
        if (is_open) note(BAD, is_in_time);
        return;
    case BEGIN:
        put(bytes, FIRST_BYTES);
        ticket->stage = BEGUN;
        if (is_open) note(BAD, is_in_time);
        return;
    default:
        put(bytes + FIRST_BYTES, (uint8_t)(length - FIRST_BYTES));
        world.has_frame = 1;
        ticket->stage = CAME;
        return;
    }
    put(bytes, length);
    if (step - number != DAMAGED) world.has_frame = 1;
    ticket->stage = CAME;
}

static bool is_asked(int unit)
{
    return world.line.attempt.request_length != 0 &&
           unit_of((int)((const fathom_modbus_request_t *)world.line.head - world.requests)) == unit;
}

/* A read of `count` registers from `first` on of a unit, as another master sends it. */
static void put_read(uint8_t address, uint16_t first, uint16_t *values, uint8_t count, bool is_response)
{
    uint8_t bytes[13];
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, address, first, count, values);
    put(bytes, is_response ? fathom_modbus_rtu_encode_response(&message, bytes)
                           : fathom_modbus_rtu_encode_request(&message, bytes));
}

static void speak(int step)
{
    uint16_t values[2] = {OTHERS_VALUE, OTHERS_VALUE};
    const uint8_t noise = 0x07; /* two of them begin no frame: 7 is no function of Modbus */
    world.has_spoken = 1;
    switch (step) {
    case OWN:
        put_read(1, 0x0106, values, 2, true);
        if (is_asked(0)) note(OTHER, false);
        break;
    case NOISE:
        put(&noise, 1);
        return;
    case ASK:
        put_read(1, 0x0107, values, 1, false);
        world.asked = 1;
        world.asked_age = 0;
        if (is_asked(0)) world.came |= CLAIMED;
        break;
    default:
        put_read(1, 0x0107, values, 1, true);
        world.asked = world.asked_age = 0;
    }
    world.has_frame = 1;
}

static void come_unasked(int step)
{
    static const uint8_t stream[4] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4): 1953 mm */
    uint8_t bytes[8];
    uint16_t value = OTHERS_VALUE;
    world.has_spoken = 1;
    world.has_frame |= step == FOREIGN;
    if (step == STREAM) {
        put(stream, sizeof stream);
        return;
    }
    if (options.dyp) {
        put(bytes, fathom_dyp_55aa_encode_response(bytes, THIRD_UNIT, FATHOM_DYP_FIRST_PROBE, &value));
        return;
    }
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, THIRD_UNIT, 0x0106, 1, &value);
    put(bytes, fathom_modbus_rtu_encode_response(&message, bytes));
}

static void call(int step)
{
    fault = PORT_WORKS;
    switch (step) {
    case POLL_READ_FAILS:
        fault = READ_FAILS;
        break;
    case POLL_WRITE_FAILS:
        fault = WRITE_FAILS;
        break;
    case POLL_WRITE_BUSY:
        fault = WRITE_BUSY;
        break;
    case POLL_SET_BUSY:
        fault = SET_BUSY;
        break;
    case POLL_SET_FAILS:
        fault = SET_FAILS;
        break;
    case PAUSE_STAYS:
        fault = STAYS;
        break;
    default:
        break;
    }
    if (step == TICK)
        tick();
    else if (step == PAUSE || step == PAUSE_STAYS)
        pause();
    else if (step < SUBMIT)
        poll();
    else if (step == POLL_DRAWN)
        poll_drawn();
    else if (step > STREAM)
        speak(step);
    else if (step >= FOREIGN)
        come_unasked(step);
    else if (step >= RESPOND)
        come(step);
    else {
        if (step < CANCEL)
            (void)world_submit(step - SUBMIT);
        else if (step < CANCEL_UNIT)
            fathom_line_cancel(&world.line, &world.requests[step - CANCEL].transaction);
        else
            fathom_line_cancel_unit(&world.line, (uint8_t)(step - CANCEL_UNIT + 1));
        look_when_due();
    }
}

/* What the step has done to each transaction. */
static void gather(void)
{
    for (int i = 0; i != TRANSACTIONS; i++) {
        const fathom_modbus_request_t *const request = &world.requests[i];
        effect.ended[i] = was_queued(i) && !is_queued(i) ? request->transaction.status : FATHOM_PENDING;
        effect.delivered[i] = -1;
        if (effect.ended[i] == FATHOM_OK) effect.delivered[i] = world.values[i] - 0x0700;
        if (effect.ended[i] == FATHOM_ERR_EXCEPTION) effect.delivered[i] = request->message.exception - 1;
    }
}

static bool send(int transaction)
{
    for (int i = 0; i != TICKETS; i++) {
        if (world.tickets[i].stage != NONE) continue;
        world.tickets[i].stage = LEAVING;
        world.tickets[i].transaction = (uint8_t)transaction;
        world.leaving = (uint8_t)(world.leaving + options.leave);
        world.quiet = 0;
        world.came &= ALONE;
        if (world.line.wait == WAIT_SKIPPED) world.came |= SKIPPED;
        return true;
    }
    return false;
}

/* What has ended has ended for its tickets too, and its memory is the caller's, who has other plans with it. */
static const char *settle(void)
{
    for (int i = 0; i != TICKETS; i++) {
        ticket_t *const ticket = &world.tickets[i];
        if (ticket->stage == NONE) continue;
        if (effect.ended[ticket->transaction] != FATHOM_PENDING) ticket->flags |= ENDED;
        if (world.line.attempt.request_length == 0) ticket->flags |= CLOSED;
        if ((ticket->flags & ENDED) != 0) ticket->flags = (ticket->flags | CLOSED) & (uint8_t)~SURE;
        if (ticket->stage == CAME && world.rx_length == 0 && world.line.received_count == 0) forget(ticket);
    }
    if (world.line.attempt.request_length == 0) world.came &= ALONE;
    if (world.rx_length == 0 && world.line.received_count == 0) world.came &= (uint8_t)~ALONE;
    bool has_ended = effect.sent >= 0;
    for (int i = 0; i != TRANSACTIONS; i++)
        if (effect.ended[i] != FATHOM_PENDING)
            has_ended = has_ended || i == effect.queue[0] || effect.ended[i] != FATHOM_ERR_CANCELLED;
    if (has_ended || !is_waiting(&world.line)) world.waited = world.has_frame = 0;
    for (int i = 0; i != TRANSACTIONS; i++) {
        if (effect.ended[i] == FATHOM_PENDING) continue;
        memset(&world.requests[i], 0xA5, sizeof world.requests[i]);
        memset(&world.values[i], 0xA5, sizeof world.values[i]);
    }
    const int watched = options.watched;
    if (watched < TRANSACTIONS && (!is_queued(watched) || effect.sent == watched ||
                                   fathom_line_is_quarantined(&world.line, address_of(watched))))
        world.others = 0;
    if (effect.sent >= 0 && !send(effect.sent)) return "more requests are out than the world has tickets";
    return NULL;
}

const char *carry_out(int step)
{
    const world_t before = world;
    memset(&effect, 0, sizeof effect);
    effect.sent = -1;
    const fathom_transaction_t *x = world.line.head;
    for (int i = 0; i != TRANSACTIONS; i++) {
        effect.queue[i] = x != NULL ? (int)((const fathom_modbus_request_t *)x - world.requests) : -1;
        if (x != NULL) x = x->link.next;
    }
    call(step);
    gather();
    const char *const broken = judge(step, &before);
    if (broken != NULL) return broken;
    return settle();
}
