/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/modbus_unit.h"

/* A unit that does not answer is asked less and less often. */
enum { UNIT = 9, PACE_US = 100000, TIMEOUT_US = 300000 };

static fake_modbus_t fake;
static fathom_modbus_unit_t unit;
static uint16_t values[3];

static fathom_modbus_question_t measure;
static const fathom_modbus_question_t version = {1000000, PACE_US, 0, NULL, values, 0x0001, 3, 0, true, 0};

static const uint16_t one_value[] = {754};
static const uint16_t three_values[] = {0x1409, 0x1B02, 0x0100};

static void set_up_at(uint32_t now_us)
{
    fake_modbus_init(&fake);
    fake.now_us = now_us;
    measure = (fathom_modbus_question_t){TIMEOUT_US, PACE_US, 0, NULL, values, 0x0100, 1, 0, false, 0};
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(fathom_modbus_unit_init(&unit, &fake.modbus, &fake.clock, UNIT), FATHOM_READY);
}

static int set_up(void **state)
{
    set_up_at(5000);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t read_after(uint32_t us, const fathom_modbus_question_t *question)
{
    fake.now_us += us;
    return fathom_modbus_unit_ask(&unit, question);
}

/* Nothing is asked for `us` - 1, and at `us` it is; until then due says how long that is. */
static void assert_paused_for(uint32_t us)
{
    const unsigned before = fake.submits;
    for (uint32_t part = 0; us != 0 && part != 4; part++) {
        assert_int_equal(fathom_modbus_unit_due_us(&unit), us - part * (us / 4));
        if (part == 3) break;
        assert_int_equal(read_after(us / 4, &measure), FATHOM_PENDING);
        assert_int_equal(fake.submits, before);
    }
    if (us != 0) {
        assert_int_equal(read_after(us - 3 * (us / 4) - 1, &measure), FATHOM_PENDING);
        assert_int_equal(fake.submits, before);
        fake.now_us += 1;
    }
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    assert_int_equal(read_after(0, &measure), FATHOM_PENDING);
    assert_int_equal(fake.submits, before + 1);
}

/* The request under way leaves, and ends so after the time-out. */
static void end_with(const fathom_modbus_question_t *question, fathom_status_t status)
{
    fake_modbus_send(&fake);
    assert_int_equal(read_after(0, question), FATHOM_PENDING);
    if (status == FATHOM_READY)
        fake_modbus_answer(&fake, question->is_command ? three_values : one_value, question->count);
    else
        fake_modbus_fail(&fake, status);
    assert_int_equal(read_after(question->timeout_us, question), status);
}

static void silence(void) { end_with(&measure, FATHOM_ERR_NO_ANSWER); }

static void ask_first(void) { assert_paused_for(0); }

/* So many silences in a row, with all the pauses between them; the last one's pause is to come. */
static void silences(unsigned count)
{
    static const uint8_t time_outs[] = {0, 0, 1, 2, 4, 8, 16, 16};
    ask_first();
    for (unsigned n = 0; n != count; n++) {
        if (n != 0) assert_paused_for(time_outs[n - 1] * (uint32_t)TIMEOUT_US);
        silence();
    }
}

TEST(the_third_silence_pauses_one_time_out_and_the_next_twice_as_much_up_to_16)
{
    static const uint8_t time_outs[] = {0, 0, 1, 2, 4, 8, 16, 16, 16, 16};
    ask_first();
    for (unsigned n = 0; n != sizeof time_outs; n++) {
        silence();
        assert_paused_for(time_outs[n] * (uint32_t)TIMEOUT_US);
    }
}

TEST(many_silences_go_on_at_16)
{
    silences(7);
    for (unsigned n = 0; n != 50; n++) {
        assert_paused_for(16 * TIMEOUT_US);
        silence();
    }
    assert_paused_for(16 * TIMEOUT_US);
}

TEST(the_config_caps_the_pause)
{
    static const uint32_t pauses_us[] = {0, 0, 300000, 600000, 700000, 700000, 700000};
    measure.backoff_us = 700000;
    ask_first();
    for (unsigned n = 0; n != sizeof pauses_us / sizeof *pauses_us; n++) {
        silence();
        assert_paused_for(pauses_us[n]);
    }
}

TEST(a_cap_below_the_time_out_is_the_pause)
{
    measure.backoff_us = 250000;
    ask_first();
    for (unsigned n = 0; n != 6; n++) {
        silence();
        assert_paused_for(n < 2 ? 0 : 250000);
    }
}

/* a05_modbus.h: less than the period is never less often. */
TEST(a_cap_of_less_than_the_pace_does_not_shorten_it)
{
    measure.backoff_us = 1;
    measure.pace_us = 1000000;
    ask_first();
    for (unsigned n = 0; n != 6; n++) {
        silence();
        assert_paused_for(1000000 - TIMEOUT_US);
    }
}

TEST(a_pause_shorter_than_the_pace_keeps_the_pace)
{
    static const uint32_t pauses_us[] = {700000, 700000, 700000, 700000, 1200000};
    measure.pace_us = 1000000;
    ask_first();
    for (unsigned n = 0; n != sizeof pauses_us / sizeof *pauses_us; n++) {
        silence();
        assert_paused_for(pauses_us[n]);
    }
}

/* 16 time-outs of five minutes would not fit into 32 bits; 2^31 us is the most. */
TEST(the_longest_pause_is_half_the_clock)
{
    measure.timeout_us = 300000000;
    measure.backoff_us = 0x80000000u;
    ask_first();
    for (unsigned n = 0; n != 8; n++) {
        silence();
        assert_paused_for(n < 2    ? 0
                          : n == 2 ? 300000000
                          : n == 3 ? 600000000
                          : n == 4 ? 1200000000
                                   : 0x80000000u);
    }
}

TEST(the_first_thing_that_it_says_ends_that)
{
    static const fathom_status_t said[] = {FATHOM_READY, FATHOM_ERR_EXCEPTION, FATHOM_ERR_CHECKSUM,
                                           FATHOM_ERR_MALFORMED};
    for (unsigned i = 0; i != sizeof said / sizeof *said; i++)
        for (unsigned before = 1; before != 8; before++) {
            set_up(state);
            silences(before);
            assert_paused_for(before < 3 ? 0 : (1u << (before - 3)) * (uint32_t)TIMEOUT_US);
            end_with(&measure, said[i]);
            assert_paused_for(0);
            silence(); /* and the count begins anew */
            assert_paused_for(0);
            silence();
            assert_paused_for(0);
            silence();
            assert_paused_for(TIMEOUT_US);
        }
}

TEST(the_pause_holds_across_the_wrap_of_the_clock)
{
    for (uint32_t before_us = 0; before_us < 12 * TIMEOUT_US; before_us += 50000) {
        set_up_at(UINT32_MAX - before_us);
        silences(6);
        assert_paused_for(8 * TIMEOUT_US);
    }
}

/* A command of the user goes out at once, and is no reason to pause more. */
TEST(a_command_is_not_held_back)
{
    silences(7);
    (void)read_after(1000, &measure);
    assert_int_equal(fake.submits, 7);
    assert_int_equal(read_after(0, &version), FATHOM_PENDING);
    fake_modbus_assert_asked(&fake, 8, UNIT, 0x0001, 3);
    end_with(&version, FATHOM_READY);
    assert_paused_for(0); /* it has answered */
}

TEST(a_command_is_not_held_back_by_a_silence_that_comes_while_it_waits)
{
    silences(6);
    assert_paused_for(8 * TIMEOUT_US);
    fake_modbus_send(&fake);
    assert_int_equal(read_after(0, &version), FATHOM_PENDING); /* the measurement is on the wire */
    fake_modbus_fail(&fake, FATHOM_ERR_NO_ANSWER);
    (void)read_after(TIMEOUT_US, &version);
    (void)read_after(PACE_US, &version);
    fake_modbus_assert_asked(&fake, 8, UNIT, 0x0001, 3);
}

/* The device's own pace holds for it all the same, and due says how long that is. */
TEST(a_command_waits_for_the_pace_and_not_for_the_back_off)
{
    enum { SLOW_US = 4 * TIMEOUT_US };
    silences(6);
    measure.pace_us = SLOW_US;
    assert_paused_for(8 * TIMEOUT_US);
    silence();
    const unsigned before = fake.submits;
    assert_int_equal(read_after(0, &version), FATHOM_PENDING);
    assert_int_equal(fathom_modbus_unit_due_us(&unit), SLOW_US - TIMEOUT_US);
    assert_int_equal(read_after(SLOW_US - TIMEOUT_US - 1, &version), FATHOM_PENDING);
    assert_int_equal(fake.submits, before);
    assert_int_equal(read_after(1, &version), FATHOM_PENDING);
    assert_int_equal(fake.submits, before + 1);
}

TEST(a_command_that_nobody_answers_counts_too)
{
    silences(2);
    assert_int_equal(read_after(0, &version), FATHOM_PENDING);
    fake_modbus_assert_asked(&fake, 3, UNIT, 0x0001, 3);
    end_with(&version, FATHOM_ERR_NO_ANSWER);
    assert_paused_for(1000000); /* its own time-out */
}

TEST(cancel_does_not_end_the_pause)
{
    silences(4);
    fathom_modbus_unit_cancel(&unit);
    assert_paused_for(2 * TIMEOUT_US);
}
