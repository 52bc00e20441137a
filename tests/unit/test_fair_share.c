/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/codec/crc16.h"
#include "fathom/engine/fair_share.h"

/* Units that answer so long after a request, and are asked again so long after that. */
typedef struct {
    uint8_t unit;
    uint32_t works_us;
    uint32_t rests_us;
    bool is_dead;
    bool is_left_alone;
    uint32_t timeout_us;

    fathom_modbus_request_t request;
    uint16_t value;
    bool is_asked;
    bool has_left;
    uint32_t sent_us;
    uint32_t ask_at_us;
    uint32_t free_us; /* it has waited since; it was quarantined before */
    unsigned left;    /* requests */
    uint32_t line_us; /* from the silence before a request to its end */
    uint32_t longest_us;
    uint32_t longest_wait_us;
} asker_t;

enum { ASKERS = 4, STEP_US = 250, FRAME_US = T3_5_US + 8 * BYTE_US };

#define MS     ((int32_t)1000) /* an int may have 16 bits */
#define SECOND (1000 * MS)

static asker_t askers[ASKERS];
static fathom_fair_share_t share;
static uint8_t order[64]; /* whose requests left */
static size_t orders;

static void start_at(uint32_t now_us)
{
    bench.fake.now_us = bench.fake.busy_until_us = now_us;
    memset(askers, 0, sizeof askers);
    memset(&share, 0x5A, sizeof share);
    orders = 0;
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    fathom_fair_share(&share, &bench.line);
}

static int begin(void **state)
{
    set_up(state);
    start_at(UINT32_MAX - SECOND); /* every test goes through the wrap */
    return 0;
}

static const suite_t suite = {.set_up = begin};

static asker_t *add(uint8_t unit, uint32_t works_us, uint32_t rests_us)
{
    asker_t *free = askers;
    while (free->timeout_us != 0) free++;
    free->unit = unit;
    free->works_us = works_us;
    free->rests_us = rests_us;
    free->timeout_us = 600 * MS;
    free->ask_at_us = bench.fake.now_us;
    return free;
}

static void end(asker_t *asker)
{
    const uint32_t now_us = bench.fake.now_us;
    const uint32_t line_us = now_us - asker->sent_us + T3_5_US;
    asker->is_asked = asker->has_left = false;
    asker->ask_at_us = now_us + asker->rests_us;
    asker->line_us += line_us;
    if (line_us > asker->longest_us) asker->longest_us = line_us;
}

static void step(asker_t *asker)
{
    const uint32_t now_us = bench.fake.now_us;
    if (asker->has_left && status_of(&asker->request) != FATHOM_PENDING) end(asker);
    if (!asker->is_asked && !asker->is_left_alone && (int32_t)(now_us - asker->ask_at_us) >= 0) {
        fathom_modbus_message_t *const message = &asker->request.message;
        fathom_modbus_read_holding_registers(message, asker->unit, 0x0100, 1, &asker->value);
        if (asker->unit == 0) fathom_modbus_write_single_register(message, 0, 0x0100, 1);
        asker->request.transaction.timeout_us = asker->timeout_us;
        assert_int_equal(fathom_modbus_client_submit(&bench.line, &asker->request), FATHOM_PENDING);
        asker->is_asked = true;
        asker->free_us = now_us;
    }
    if (!asker->has_left && fathom_line_is_quarantined(&bench.line, asker->unit)) asker->free_us = now_us;
}

static void sent(asker_t *asker)
{
    const uint32_t wait_us = bench.fake.now_us - asker->free_us;
    if (wait_us > asker->longest_wait_us) asker->longest_wait_us = wait_us;
    asker->left++;
    asker->sent_us = bench.fake.now_us;
    asker->has_left = true;
    if (orders != COUNT_OF(order)) order[orders++] = asker->unit;
    if (asker->is_dead) return;
    uint8_t frame[] = {asker->unit, 0x03, 0x02, 0x02, 0xF2, 0, 0};
    const uint16_t crc = fathom_crc16(frame, 5);
    frame[5] = (uint8_t)crc;
    frame[6] = (uint8_t)(crc >> 8);
    fake_receive(&bench.fake, 8 * BYTE_US + asker->works_us, frame, sizeof frame);
}

static void play(uint32_t for_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += STEP_US) {
        bench.fake.now_us += STEP_US;
        bench.fake.written = 0; /* the one on the wire stays the first */
        poll_line();
        for (asker_t *a = askers; a != askers + ASKERS && a->timeout_us != 0; a++) {
            if (bench.fake.written != 0 && bench.fake.writes[0].bytes[0] == a->unit) sent(a);
            step(a);
        }
    }
}

/* So many of this asker's requests leave for one of the other. */
#define expect_ratio(many, few, low, high)                                                                   \
    assert_true((many)->left >= (low) * (few)->left && (many)->left <= (high) * (few)->left)

/* The slow one takes 3.6 ms of silence, 8.3 of request and 400 of work. The fast one takes 8.3 and 2, and rests for 4
 * ms, the silence among them, in which the slow one could begin: 14.3 ms, up to 15 in this loop. 412 is 27.5 to 28.8
 * times that. */
TEST(a_fast_one_is_asked_many_times_between_two_requests_of_a_slow_one)
{
    asker_t *const fast = add(7, 2 * MS, 4 * MS);
    asker_t *const slow = add(2, 400 * MS, 0);
    play(60 * SECOND);
    assert_in_range(slow->line_us, 29 * SECOND, 31 * SECOND);
    expect_ratio(fast, slow, 27, 29);
}

TEST(without_it_they_take_turns)
{
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    asker_t *const fast = add(7, 2 * MS, 4 * MS);
    asker_t *const slow = add(2, 400 * MS, 0);
    play(60 * SECOND);
    assert_in_range(fast->left - slow->left + 1, 0, 2);
}

/* Beside a fast one as above, so that each has a third. */
TEST(three_have_a_third_each)
{
    asker_t *const fast = add(7, 2 * MS, 4 * MS);
    asker_t *const slow = add(2, 400 * MS, 0);
    asker_t *const slower = add(1, 500 * MS, 0);
    play(120 * SECOND);
    assert_in_range(slow->line_us, 39 * SECOND, 41 * SECOND);
    assert_in_range(slower->line_us, 39 * SECOND, 41 * SECOND);
    assert_in_range(fast->left, 2600, 2800); /* 40 s / 14.3..15 ms */
}

/* ---- holding back ---- */

/* Both have been asked; the fast one's next request would come 4 ms after its response, and the slow one waits. */
static asker_t *begin_fast_and_slow(uint32_t rests_us)
{
    asker_t *const fast = add(7, 2 * MS, rests_us);
    (void)add(2, 400 * MS, 0);
    play(2 * SECOND);
    const unsigned left = fast->left;
    while (fast->left < left + 2) play(STEP_US); /* two in succession: it has used less */
    while (fast->is_asked) play(STEP_US);
    return fast;
}

/* The hold time is an eighth of 412 ms, 51.5 ms. */
TEST(for_one_that_asks_no_more_the_line_is_idle_for_the_hold_time_once)
{
    asker_t *const fast = begin_fast_and_slow(4 * MS);
    const unsigned before = askers[1].left;
    fast->is_left_alone = true;
    assert_in_range(due(), 51 * MS, 52 * MS);
    play(51 * MS);
    assert_int_equal(askers[1].left, before);
    play(MS);
    assert_int_equal(askers[1].left, before + 1);
    play(10 * SECOND);
    assert_in_range(askers[1].left, before + 24, before + 25); /* 10 s / 412 ms */
}

/* Its time-out is 20 ms, and its quarantine as long again: the slow one leaves at once, since the line has been
 * silent. */
TEST(for_a_quarantined_unit_nothing_is_held_back)
{
    asker_t *const fast = add(7, 0, MS);
    asker_t *const slow = add(2, 400 * MS, 0);
    fast->is_dead = true;
    fast->timeout_us = 20 * MS;
    play(SECOND);
    const unsigned left = fast->left;
    while (fast->left < left + 2) play(STEP_US);
    while (fast->has_left) play(STEP_US);
    play(2 * STEP_US);
    assert_true(slow->has_left);
}

/* ---- silence, quarantine, broadcasts, cancels ---- */

/* 600 ms of time-out are its use; its quarantine is as long again, and it is asked by its turn after that. */
TEST(one_that_is_dead_has_used_its_time_outs_and_takes_no_more_than_its_share)
{
    asker_t *const dead = add(3, 0, 0);
    asker_t *const fast = add(7, 2 * MS, 4 * MS);
    asker_t *const slow = add(2, 400 * MS, 0);
    dead->is_dead = true;
    play(120 * SECOND);
    assert_in_range(dead->line_us, 36 * SECOND, 41 * SECOND);
    assert_true(slow->line_us > 38 * SECOND);
    assert_true(fast->left > 2500);
}

TEST(where_all_are_quarantined_it_is_due_when_that_ends)
{
    asker_t *const dead = add(3, 0, 0);
    dead->is_dead = true;
    play(700 * MS);
    assert_int_equal(dead->left, 1);
    assert_true(dead->is_asked);
    assert_true(fathom_line_is_quarantined(&bench.line, 3));
    assert_false(fathom_line_is_quarantined(&bench.line, 2));
    expect_due(bench.line.quarantine_left_us);
    play(550 * MS);
    assert_int_equal(dead->left, 2);
}

/* Each broadcast has the line for its time-out, 100 ms, with 12 of silence and request. */
TEST(a_broadcast_is_used_time_of_unit_0)
{
    asker_t *const all = add(0, 0, 0);
    asker_t *const fast = add(7, 2 * MS, 4 * MS);
    all->is_dead = true;
    all->timeout_us = 100 * MS;
    play(20 * SECOND);
    assert_in_range(all->line_us, 9 * SECOND, 11 * SECOND);
    assert_true(fast->left > 600);
}

/* What was on the wire when it was cancelled has been used until then; the unit is quarantined, and not waited for. */
TEST(a_request_that_is_cancelled_has_used_its_time)
{
    asker_t *const a = add(1, 300 * MS, 4 * MS);
    play(200 * MS);
    a->is_left_alone = true;
    cancel(&a->request);
    step(a);
    assert_int_equal(due(), FATHOM_NO_DEADLINE);
    (void)add(2, 50 * MS, 0);
    play(SECOND);
    a->is_left_alone = false;
    bench.fake.written = 0;
    assert_in_range(share.units[1].hold_us, 190 * MS / 8, 210 * MS / 8);
    play(SECOND);
    assert_true(a->left > 1 && askers[1].left > 4);
}

/* Those whose addresses are equal modulo 16: half for both of them, and half for the third. */
TEST(two_that_are_equal_modulo_16_share_one_share)
{
    asker_t *const a = add(1, 50 * MS, 0);
    asker_t *const b = add(17, 50 * MS, 0);
    asker_t *const c = add(2, 50 * MS, 0);
    play(30 * SECOND);
    assert_in_range(c->line_us, 14 * SECOND, 16 * SECOND);
    assert_in_range(a->left - b->left + 1, 0, 2);
}

/* ---- the longest wait ---- */

static uint32_t random_state;

static uint32_t any(uint32_t below)
{
    random_state = random_state * 1664525 + 1013904223;
    return (uint32_t)((uint64_t)random_state * below >> 32);
}

/* (n - 1) * (L + 2 H) + S, and what the loop is late at each of them. */
static void expect_waits_within_the_bound(void)
{
    uint32_t longest_us = 0, sum_us = 0, n = 0;
    for (const asker_t *a = askers; a != askers + ASKERS; a++, n++) {
        sum_us += a->longest_us;
        if (a->longest_us > longest_us) longest_us = a->longest_us;
    }
    const uint32_t hold_us = longest_us / 8 < UINT16_MAX ? longest_us / 8 : UINT16_MAX;
    for (const asker_t *a = askers; a != askers + ASKERS; a++) {
        const uint32_t bound_us = (n - 1) * (a->longest_us + 2 * hold_us) + sum_us - a->longest_us;
        assert_true(a->left > 1);
        assert_true(a->longest_wait_us <= bound_us + n * 2 * STEP_US + T3_5_US);
    }
}

/* Four units of any speed, one of them perhaps dead, one of which stops asking now and then. */
TEST(none_waits_longer_than_the_header_says)
{
    for (uint32_t seed = 1; seed != 60; seed++) {
        set_up(state);
        start_at(seed * 0x10000000);
        random_state = seed;
        for (uint8_t unit = 1; unit != 1 + ASKERS; unit++) {
            const uint32_t scale_us = any(2) != 0 ? 20 * MS : 500 * MS;
            asker_t *const a = add(unit, any(scale_us), any(2) != 0 ? any(20 * MS) : any(500 * MS));
            a->is_dead = unit == 1 && any(3) == 0;
        }
        for (unsigned part = 0; part != 10; part++) {
            askers[1].is_left_alone = any(2) != 0 && part != 0;
            play(2 * SECOND);
        }
        expect_waits_within_the_bound();
    }
}
