/* SPDX-License-Identifier: MIT */
#include "fathom/a05_dyp.h"
#include "line_bench.h"

/* Which address has the one A05 on this line? */

static const uint8_t ask_anyone[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E}; /* FF + FF + 10 = 20E */
/* 1953 mm from 5: FF + 05 + 10 + 07 + A1 = 1BC; from 254: FF + FE + 10 + 07 + A1 = 2B5. */
static const uint8_t from_5[] = {0x55, 0xAA, 0x05, 0x10, 0x07, 0xA1, 0xBC};
static const uint8_t from_254[] = {0x55, 0xAA, 0xFE, 0x10, 0x07, 0xA1, 0xB5};

static fathom_a05_dyp_find_t find;
static uint8_t address;

static int set_up_find(void **state)
{
    set_up(state);
    memset(&find, 0, sizeof find);
    address = 0xA5;
    return 0;
}

static const suite_t suite = {.set_up = set_up_find};

static fathom_status_t find_for(uint32_t us)
{
    for (uint32_t passed_us = 0; passed_us < us; passed_us += 200) {
        const fathom_status_t status = fathom_a05_dyp_find(&find, &bench.line, &address);
        if (status != FATHOM_PENDING) return status;
        bench.fake.now_us += 200;
    }
    return FATHOM_PENDING;
}

static void until_asked(size_t written)
{
    for (unsigned i = 0; bench.fake.written != written; i++) {
        assert_true(i < 5000);
        assert_int_equal(find_for(200), FATHOM_PENDING);
    }
    assert_int_equal(bench.fake.writes[written - 1].length, sizeof ask_anyone);
    assert_memory_equal(bench.fake.writes[written - 1].bytes, ask_anyone, sizeof ask_anyone);
    assert_int_equal(find_for(70000), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, written);
}

TEST(the_address_is_where_the_answer_came_from)
{
    until_asked(1);
    receive(from_5, sizeof from_5);
    assert_int_equal(find_for(200), FATHOM_READY);
    assert_int_equal(address, 5);
}

TEST(each_outcome_comes_once_and_the_next_call_asks_anew)
{
    until_asked(1);
    receive(from_5, sizeof from_5);
    assert_int_equal(find_for(200), FATHOM_READY);
    until_asked(2);
    receive(from_254, sizeof from_254);
    assert_int_equal(find_for(200), FATHOM_READY);
    assert_int_equal(address, 254);
}

TEST(silence_is_no_answer_and_leaves_the_address_alone)
{
    until_asked(1);
    assert_int_equal(find_for(5 * BYTE_US + 200000 - 70000 - 1000), FATHOM_PENDING);
    assert_int_equal(find_for(2000), FATHOM_ERR_NO_ANSWER);
    assert_int_equal(address, 0xA5);
}

TEST(what_is_damaged_gives_no_address)
{
    uint8_t damaged[sizeof from_5];
    for (unsigned bit = 0; bit != 8 * sizeof from_5; bit++) {
        set_up_find(state);
        memcpy(damaged, from_5, sizeof damaged);
        damaged[bit / 8] ^= (uint8_t)(1u << bit % 8);
        until_asked(1);
        receive(damaged, sizeof damaged);
        assert_true(find_for(200000) < 0);
        assert_int_equal(address, 0xA5);
    }
}

TEST(of_two_answers_the_first_is_taken)
{
    uint8_t glued[sizeof from_5 + sizeof from_254];
    memcpy(glued, from_254, sizeof from_254);
    memcpy(glued + sizeof from_254, from_5, sizeof from_5);
    until_asked(1);
    receive(glued, sizeof glued);
    assert_int_equal(find_for(200), FATHOM_READY);
    assert_int_equal(address, 254);
    assert_int_equal(find.value, 1953);
}

TEST(on_an_echoing_line_the_echo_is_no_device)
{
    bench.config.echo = FATHOM_LINE_ECHO_AUTO;
    for (unsigned i = 0; bench.fake.written != 1; i++) {
        assert_true(i < 5000);
        assert_int_equal(find_for(200), FATHOM_PENDING);
    }
    fake_trickle(&bench.fake, 0, BYTE_US, ask_anyone, sizeof ask_anyone);
    fake_trickle(&bench.fake, 70000, BYTE_US, from_5, sizeof from_5);
    assert_int_equal(find_for(100000), FATHOM_READY);
    assert_int_equal(address, 5);
    assert_int_equal(fathom_line_echo(&bench.line), FATHOM_LINE_ECHO_ON);
}

TEST(it_can_be_given_up)
{
    until_asked(1);
    fathom_a05_dyp_find_cancel(&find, &bench.line);
    assert_null(bench.line.head);
    fathom_a05_dyp_find_cancel(&find, &bench.line); /* nothing to give up */
    assert_int_equal(find_for(2 * 200000 - 75000), FATHOM_PENDING);
    assert_int_equal(bench.fake.written, 1); /* all owe an answer */
    until_asked(2);
    receive(from_5, sizeof from_5);
    assert_int_equal(find_for(200), FATHOM_READY);
    assert_int_equal(address, 5);
}

TEST(a_broken_port_ends_it)
{
    until_asked(1);
    bench.fake.read_fails = true;
    assert_int_equal(find_for(200), FATHOM_ERR_PORT);
    assert_int_equal(address, 0xA5);
}

TEST(a_line_without_room_says_so)
{
    bench.config.frame_size = 12;
    assert_int_equal(find_for(200), FATHOM_ERR_CAPACITY);
    assert_int_equal(find_for(200), FATHOM_ERR_CAPACITY);
    assert_null(bench.line.head);
}
