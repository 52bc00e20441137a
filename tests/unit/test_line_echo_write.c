/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/* Local echo on writes: the response to function 06 and to 55 AA 03 is the request again. */

static const uint8_t dyp_address_5[] = {0x55, 0xAA, 0x05, 0x03, 0x07}; /* A05 2(3)5 */

/* Two protocols, one rule. */
typedef struct {
    const uint8_t *bytes;
    size_t length;
    bool is_dyp;
} write_t;

static const write_t writes[] = {{set_address_5, sizeof set_address_5, false},
                                 {dyp_address_5, sizeof dyp_address_5, true}};
static const write_t *wanted;

/* A new line, and what is written on it. */
static void set_up_for(size_t which, uint8_t mode)
{
    wanted = &writes[which];
    set_up_with(mode);
}

/* The write is on its way from now on. */
static void start_write(uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    bench.request.transaction.timeout_us = TIMEOUT_US;
    bench.request.transaction.retries = retries;
    if (wanted->is_dyp)
        assert_int_equal(fathom_dyp_client_broadcast_address(&bench.line, &bench.request, 5), FATHOM_PENDING);
    else
        ask_to_write(&bench.request, 1);
    run_until_written(before + 1, step_us);
    expect_bytes(before, wanted->bytes, wanted->length);
}

static uint32_t leaves_us(void) { return (uint32_t)wanted->length * BYTE_US; }

static void copy_in(unsigned seed, uint32_t in_us) { come(seed, in_us, wanted->bytes, wanted->length); }

/* What one copy of the request means where nothing else comes. */
static fathom_status_t of_one_copy(uint8_t mode)
{
    if (mode == FATHOM_LINE_ECHO_OFF) return FATHOM_OK;
    return mode == FATHOM_LINE_ECHO_ON ? FATHOM_ERR_NO_RESPONSE : FATHOM_ERR_ECHO;
}

static void one_copy(const way_t *way)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (unsigned is_response = 0; is_response != 2; is_response++) { /* while it leaves, or after that */
            set_up_for(w, way->mode);
            start_write(0, way->step_us);
            copy_in(way->seed, is_response != 0 ? leaves_us() + way->pause_us : 0);
            run_in_steps(80000, way->step_us);
            if (way->mode == FATHOM_LINE_ECHO_OFF) {
                expect(FATHOM_OK);
                continue;
            }
            expect(FATHOM_PENDING);
            expect_count(FATHOM_LINE_RESPONSES, 0);
            run_in_steps(60000, way->step_us);
            expect(of_one_copy(way->mode));
            expect_count(way->mode == FATHOM_LINE_ECHO_ON ? FATHOM_LINE_NO_RESPONSES : FATHOM_LINE_ECHOES, 1);
            expect_count(FATHOM_LINE_RESPONSES, 0);
            expect_echo(way->mode); /* it proves nothing */
        }
}

static const suite_t suite = {.set_up = set_up};

TEST(one_copy_of_a_write_acknowledges_it_only_where_there_is_no_echo) { in_every_way(one_copy); }

static void two_copies(const way_t *way)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (unsigned is_late = 0; is_late != 2; is_late++) { /* what the port says of the request */
            set_up_for(w, way->mode);
            bench.fake.never_sent = is_late != 0;
            start_write(0, way->step_us);
            copy_in(way->seed, 0);
            copy_in(way->seed, leaves_us() + way->pause_us);
            run_in_steps(80000, way->step_us);
            expect(FATHOM_OK);
            expect_count(FATHOM_LINE_RESPONSES, 1);
            /* Without an echo the first copy is the response. The second belongs to no transaction: it is a stray,
             * unless a silence or a slow loop has cut it in two. */
            assert_in_range(counter(FATHOM_LINE_STRAYS), 0, way->mode == FATHOM_LINE_ECHO_OFF ? 1 : 0);
            expect_count(FATHOM_LINE_LATE_RESPONSES, 0);
        }
}

TEST(two_copies_of_a_write_acknowledge_it) { in_every_way(two_copies); }

TEST(the_first_copy_alone_never_ends_a_write_where_an_echo_is_known)
{
    set_up_for(0, FATHOM_LINE_ECHO_AUTO);
    read_once(true);
    expect_echo(FATHOM_LINE_ECHO_ON);
    start_write(0, 100);
    copy_in(BY_BYTE, 0);
    expect_after(TIMEOUT_US + 10000, FATHOM_ERR_NO_RESPONSE); /* the device is dead, and the line says so */
}

TEST(after_a_read_without_echo_one_copy_acknowledges_a_write)
{
    set_up_for(0, FATHOM_LINE_ECHO_AUTO);
    read_once(false);
    start_write(0, 100);
    copy_in(BY_BYTE, 20000);
    expect_after(30000, FATHOM_OK);
}

TEST(a_write_that_nothing_answers_is_no_response_whatever_is_known)
{
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (size_t m = 0; m != COUNT_OF(modes); m++) {
            set_up_for(w, modes[m]);
            start_write(0, 100);
            expect_after(2 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
        }
}

/* A copy with a wrong checksum is no copy: of the two that came one was hit. */
TEST(a_damaged_copy_does_not_count)
{
    uint8_t damaged[8];
    for (size_t w = 0; w != COUNT_OF(writes); w++)
        for (size_t m = 0; m != COUNT_OF(modes); m++)
            for (unsigned bit = 0; bit != 8 * writes[w].length; bit++) {
                set_up_for(w, modes[m]);
                memcpy(damaged, wanted->bytes, wanted->length);
                damaged[bit / 8] ^= (uint8_t)(1u << bit % 8);
                start_write(0, 100);
                come(BY_BYTE, 0, damaged, wanted->length);
                run(2 * TIMEOUT_US);
                assert_int_not_equal(status_of(&bench.request), FATHOM_OK);
                assert_int_not_equal(status_of(&bench.request), FATHOM_ERR_ECHO);
                expect_count(FATHOM_LINE_RESPONSES, 0);
                expect_echo(modes[m]);
            }
}

/* FATHOM_ERR_ECHO: "one copy of the request came, and the line does not know yet whether it echoes". Bytes that the
 * port marked before it, or with it, do not tell. */
TEST(one_copy_behind_marked_bytes_is_no_acknowledgement)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING, FATHOM_RX_OVERRUN};
    for (size_t i = 0; i != COUNT_OF(flags); i++) {
        const bool is_overrun =
            flags[i] == FATHOM_RX_OVERRUN; /* the port reports it with the bytes behind it */
        set_up_for(0, FATHOM_LINE_ECHO_AUTO);
        start_write(0, 100);
        run(8 * BYTE_US);
        if (!is_overrun) receive_rx(auto_frame, 2, flags[i]);
        run(100);
        receive_rx(set_address_5, sizeof set_address_5, is_overrun ? FATHOM_RX_OVERRUN : 0);
        expect_after(TIMEOUT_US + 100, FATHOM_ERR_ECHO);
    }
}

/* ---- attempts ---- */

TEST(each_attempt_of_a_write_needs_its_own_two_copies)
{
    set_up_for(0, FATHOM_LINE_ECHO_ON);
    start_write(1, 100);
    copy_in(BY_BYTE, 0);
    run_until_written(2, 100); /* twice the time-out later */
    copy_in(BY_BYTE, 0);
    expect_after(9 * BYTE_US, FATHOM_PENDING);
    copy_in(BY_BYTE, 0);
    expect_after(9 * BYTE_US, FATHOM_OK);
    assert_int_equal(bench.request.transaction.attempts, 2);
    expect_count(FATHOM_LINE_NO_RESPONSES, 1);
}

TEST(the_last_attempt_of_an_unknown_echo_says_echo)
{
    set_up_for(0, FATHOM_LINE_ECHO_AUTO);
    start_write(2, 100);
    for (unsigned attempt = 1; attempt <= 3; attempt++) {
        run_until_written(attempt, 100);
        expect(FATHOM_PENDING);
        copy_in(BY_BYTE, 0);
    }
    expect_after(TIMEOUT_US + 10000, FATHOM_ERR_ECHO);
    expect_count(FATHOM_LINE_ECHOES, 3);
}

TEST(a_late_second_copy_serves_the_retry_of_a_write)
{
    set_up_for(0, FATHOM_LINE_ECHO_ON);
    start_write(1, 100);
    copy_in(BY_BYTE, 0);
    run(TIMEOUT_US + 20000);
    expect_count(FATHOM_LINE_NO_RESPONSES, 1);
    copy_in(BY_BYTE, 0);
    expect_after(9 * BYTE_US, FATHOM_OK);
    expect_count(FATHOM_LINE_LATE_RESPONSES, 1);
    expect_written(1);
}

TEST(a_refused_write_on_an_echoing_line_is_an_exception)
{
    static const uint8_t refusal[] = {0x01, 0x86, 0x03, 0x02, 0x61};
    for (size_t m = 0; m != COUNT_OF(modes); m++) {
        if (modes[m] == FATHOM_LINE_ECHO_OFF) continue;
        set_up_for(0, modes[m]);
        start_write(0, 100);
        copy_in(BY_BYTE, 0);
        come_all(20000, refusal);
        expect_after(30000, FATHOM_ERR_EXCEPTION);
        assert_int_equal(bench.request.message.exception, 3);
        expect_echo(modes[m]); /* not OFF, above all */
    }
}

/* ---- a write of many, whose response is shorter than the request ---- */

static void start_write_of_many(uint32_t step_us)
{
    ask_to_write_36_ms();
    run_until_written(1, step_us);
    expect_bytes(0, set_36_ms, sizeof set_36_ms);
}

static void write_of_many(const way_t *way)
{
    for (unsigned echoes = 0; echoes != 2; echoes++) {
        set_up_with(way->mode);
        start_write_of_many(way->step_us);
        if (echoes != 0) come(way->seed, 0, set_36_ms, sizeof set_36_ms);
        come(way->seed, sizeof set_36_ms * BYTE_US + way->pause_us, set_ms_done, sizeof set_ms_done);
        run_in_steps(80000, way->step_us);
        expect(FATHOM_OK);
        expect_learned(way->mode, echoes != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
        expect_count(FATHOM_LINE_DROPPED_BYTES, 0);
    }
}

TEST(a_write_of_many_registers_is_told_from_its_echo) { in_every_way(write_of_many); }

TEST(the_echo_of_a_write_of_many_is_no_response)
{
    set_up_with(FATHOM_LINE_ECHO_AUTO);
    start_write_of_many(100);
    come_all(0, set_36_ms);
    expect_after(2 * TIMEOUT_US, FATHOM_ERR_NO_RESPONSE);
    expect_echo(FATHOM_LINE_ECHO_ON);
}
