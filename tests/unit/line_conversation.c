/* SPDX-License-Identifier: MIT */
#include "line_conversation.h"

#include "hex.h"

static unsigned number; /* of the step in progress, for the report of a failure */

#define EXPECT_THAT(is_so, ...)                                                                              \
    do {                                                                                                     \
        if (!(is_so)) {                                                                                      \
            print_message("step %u: ", number);                                                              \
            fail_msg(__VA_ARGS__);                                                                           \
        }                                                                                                    \
    } while (0)

fathom_modbus_request_t *request_of(const step_t *step)
{
    return step->which == A ? &bench.request : &bench.other;
}

static uint16_t *value_of(const step_t *step) { return step->which == A ? &bench.value : &bench.other_value; }

static void expect_status(const step_t *step, fathom_status_t status)
{
    const fathom_status_t is = status_of(request_of(step));
    EXPECT_THAT(is == status, "%s, not %s", fathom_status_name(is), fathom_status_name(status));
}

static void expect_requests(size_t count)
{
    EXPECT_THAT(bench.fake.written == count, "%u requests, not %u", (unsigned)bench.fake.written,
                (unsigned)count);
}

/* ---- actions ---- */

void play_queue(const step_t *step)
{
    ask(request_of(step), step->unit, value_of(step), (uint8_t)step->value);
    request_of(step)->transaction.timeout_us = step->us;
}

void play_ask(const step_t *step)
{
    const size_t before = bench.fake.written;
    play_queue(step);
    run(T3_5_US + 200);
    expect_requests(before + 1);
    run(8 * BYTE_US + 100);
}

void play_write(const step_t *step) { ask_to_write(request_of(step), step->unit); }

void play_cancel(const step_t *step)
{
    cancel(request_of(step));
    expect_status(step, FATHOM_ERR_CANCELLED);
}

void play_wait(const step_t *step) { run(step->us); }
void play_poll(const step_t *step) { assert_int_equal(poll_line(), FATHOM_PENDING); }
void play_poll_after(const step_t *step) { run_in_steps(step->us, step->us); }
void play_response(const step_t *step) { deliver_response(step->unit, (uint16_t)step->value); }

void play_arrive(const step_t *step)
{
    uint8_t bytes[32];
    receive_rx(bytes, hex_parse(step->hex, bytes), step->which);
}

void play_receive(const step_t *step)
{
    play_arrive(step);
    run(100);
}

void play_send(const step_t *step)
{
    uint8_t bytes[32];
    const uint8_t length = hex_parse(step->hex, bytes);
    fake_trickle(&bench.fake, 0, BYTE_US, bytes, length);
    run((uint32_t)(length * BYTE_US / 100 * 100 + 100));
}

void play_pass(const step_t *step) { bench.fake.now_us += step->us; }

void play_break(const step_t *step)
{
    const fathom_status_t status = fathom_line_break(&bench.line, step->which != 0);
    EXPECT_THAT(status == step->value, "%s", fathom_status_name(status));
}

void play_jam(const step_t *step)
{
    for (uint32_t us = 0; us < step->us; us += BYTE_US) {
        receive_hex("00");
        run_in_steps(BYTE_US, BYTE_US);
    }
}

void play_echo(const step_t *step) { set_up_echo((uint8_t)step->value); }
void play_listen(const step_t *step)
{
    listen_for((uint16_t)step->us);
    bench_listener.base.stale_us = (uint32_t)step->value;
}

void play_flush(const step_t *step) { fathom_line_flush(&bench.line); }
void play_break_port(const step_t *step) { break_port(); }
void play_refuse(const step_t *step) { bench.fake.write_busy = step->which != 0; }
void play_never_sent(const step_t *step) { bench.fake.never_sent = step->which != 0; }
void play_silence(const step_t *step) { bench.config.silence_us = (uint16_t)step->us; }
void play_busy_us(const step_t *step) { bench.config.busy_us = step->us; }

void play_leaves_in(const step_t *step)
{
    bench.fake.uart.leaves_in_us = fake_leaves_in_us;
    bench.fake.leaves_in_us = step->us;
}

/* ---- expectations ---- */

void play_ends(const step_t *step) { expect_status(step, (fathom_status_t)step->value); }

void play_fails(const step_t *step)
{
    play_ends(step);
    EXPECT_THAT(*value_of(step) == 0xDEAD, "a request without a response has a value");
}

void play_reads(const step_t *step)
{
    expect_status(step, FATHOM_OK);
    EXPECT_THAT(*value_of(step) == (uint16_t)step->value, "%u mm", *value_of(step));
}

void play_attempts(const step_t *step)
{
    assert_int_equal(request_of(step)->transaction.attempts, step->value);
}

void play_written(const step_t *step) { expect_requests((size_t)step->value); }

void play_request_to(const step_t *step)
{
    const uint8_t unit = bench.fake.writes[step->value].bytes[0];
    EXPECT_THAT(unit == step->unit, "to unit %u", unit);
}

void play_sent(const step_t *step)
{
    const size_t before = bench.fake.written;
    run(step->us);
    expect_requests(before);
    run((uint32_t)step->value);
    expect_requests(before + 1);
}

void play_due(const step_t *step)
{
    EXPECT_THAT(due() == step->us, "due in %lu us, not %lu", (unsigned long)due(), (unsigned long)step->us);
}

void play_in_break(const step_t *step)
{
    EXPECT_THAT(bench.fake.in_break == (step->which != 0), "in a break or not");
}

void play_idle(const step_t *step)
{
    EXPECT_THAT(fathom_line_is_idle(&bench.line) == (step->which != 0), "idle or not");
}

void play_echo_is(const step_t *step) { assert_int_equal(fathom_line_get_echo(&bench.line), step->value); }

void play_count(const step_t *step)
{
    EXPECT_THAT(counter(step->which) == (unsigned)step->value, "a count of %u", counter(step->which));
}

void play_heard(const step_t *step)
{
    uint8_t bytes[32];
    const size_t length = hex_parse(step->hex, bytes);
    EXPECT_THAT(bench_listener.length == length && memcmp(bench_listener.bytes, bytes, length) == 0,
                "%u other bytes", (unsigned)bench_listener.length);
    EXPECT_THAT(bench_listener.gaps == step->which, "%u gaps", bench_listener.gaps);
}

void play_gap_at(const step_t *step) { assert_int_equal(bench_listener.gap_at, step->value); }

void play_lost_at(const step_t *step)
{
    assert_int_equal(bench_listener.losses, step->which);
    assert_int_equal(bench_listener.lost_at, step->value);
}

void play_conversation(void **state, int (*begin)(void **state))
{
    const conversation_t *const row = *state;
    const uint16_t *const counts = &row->counts.responses;
    (void)begin(state);
    for (number = 0; number != COUNT_OF(row->steps) && row->steps[number].play != NULL; number++)
        row->steps[number].play(&row->steps[number]);
    for (unsigned which = 0; which != FATHOM_LINE_COUNTERS; which++)
        if (counter(which) != counts[which])
            fail_msg("counter %u: %u, not %u", which, counter(which), counts[which]);
}
