/* SPDX-License-Identifier: MIT */
#include "desk.h"
#include "fathom/engine/internal/modbus_unit.h"

/* A unit that does not answer is asked less and less often. */
enum { UNIT = 9, PACE_US = 100000, TIMEOUT_US = 300000 };

static fathom_modbus_unit_t unit;
static uint16_t values[3];

static const fathom_modbus_unit_request_t measure = {values, 0x0100, 1, 3, 1};
static const fathom_modbus_unit_request_t version = {values, 0x0001, 3, 3, 0x81};

static void set_up_at(uint32_t now_us)
{
    desk_begin(now_us);
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(
        init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = UNIT}, TIMEOUT_US, PACE_US),
        FATHOM_OK);
}

static int set_up(void **state)
{
    set_up_at(5000);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static fathom_status_t read_after(uint32_t us, const fathom_modbus_unit_request_t *request)
{
    fake.now_us += us;
    fathom_modbus_unit_poll(&unit);
    return ask_unit(&unit, request);
}

/* Nothing is asked for `us` - 1, and at `us` it is; until then due says how long that is. */
static void assert_paused_for(uint32_t us)
{
    const unsigned before = fake.submits;
    for (uint32_t part = us != 0 ? 4 : 0; part != 0; part--) {
        const uint32_t step_us = part != 1 ? us / 4 : us - 3 * (us / 4) - 1;
        assert_int_equal(fathom_modbus_unit_due_us(&unit), (part - 1) * (us / 4) + us - 3 * (us / 4));
        PENDS(read_after(step_us, &measure));
        assert_int_equal(fake.submits, before);
    }
    if (us != 0) fake.now_us += 1;
    assert_int_equal(fathom_modbus_unit_due_us(&unit), 0);
    PENDS(read_after(0, &measure));
    assert_int_equal(fake.submits, before + 1);
}

/* The request under way leaves, and ends so after the time-out. */
static void end_with(const fathom_modbus_unit_request_t *request, fathom_status_t status)
{
    static const uint16_t says[3];
    fake_modbus_send(&fake);
    PENDS(read_after(0, request));
    if (status == FATHOM_OK)
        fake_modbus_response(&fake, says, (uint8_t)request->last);
    else
        fake_modbus_fail(&fake, status);
    assert_int_equal(read_after(request == &measure ? unit.timeout_us : 1000000, request), status);
}

static void silence(void) { end_with(&measure, FATHOM_ERR_NO_RESPONSE); }

static void ask_first(void) { assert_paused_for(0); }

/* So many time-outs in a row, with these pauses after them, the last of which goes on. */
static void timeouts_in_row(unsigned count, const uint32_t *pauses_us, unsigned known)
{
    ask_first();
    for (unsigned n = 0; n != count; n++) {
        silence();
        assert_paused_for(pauses_us[n < known ? n : known - 1]);
    }
}

static const uint32_t time_outs_us[] = {0, 0, 300000, 600000, 1200000, 2400000, 4800000};

/* All but the last one's pause. */
static void silent_for(unsigned count)
{
    timeouts_in_row(count - 1, time_outs_us, COUNT(time_outs_us));
    silence();
}

TEST(the_third_silence_pauses_one_time_out_and_the_next_twice_as_much_up_to_16)
{
    timeouts_in_row(57, time_outs_us, COUNT(time_outs_us));
}

/* A pause is at least the pace, which counts from the request, a time-out before. a05_modbus.h: a cap of less than the
 * period is never less often. And 16 time-outs of five minutes would not fit into 32 bits; 2^31 us is the most. */
typedef struct {
    uint32_t timeout_us, backoff_us, pace_us;
    uint32_t pauses_us[6]; /* the last goes on */
} cap_t;

static void pauses_as_in(void **state)
{
    const cap_t *const cap = *state;
    unit.timeout_us = cap->timeout_us;
    unit.backoff_us = cap->backoff_us;
    unit.pace_us = cap->pace_us;
    timeouts_in_row(8, cap->pauses_us, 6);
}

#define CAP(promise, timeout_us, backoff_us, pace_us, ...)                                                   \
    static const cap_t promise = {timeout_us, backoff_us, pace_us, {__VA_ARGS__}};                           \
    TEST_ROW(promise, pauses_as_in, &promise)

CAP(the_config_caps_the_pause, 300000, 700000, PACE_US, 0, 0, 300000, 600000, 700000, 700000)
CAP(a_cap_below_the_time_out_is_the_pause, 300000, 250000, PACE_US, 0, 0, 250000, 250000, 250000, 250000)
CAP(a_cap_of_less_than_the_pace_does_not_shorten_it, 300000, 1, 1000000, 700000, 700000, 700000, 700000,
    700000, 700000)
CAP(a_pause_shorter_than_the_pace_keeps_the_pace, 300000, 1200000, 1000000, 700000, 700000, 700000, 700000,
    1200000, 1200000)
CAP(the_longest_pause_is_half_the_clock, 300000000, 0x7FFFFFFFu, PACE_US, 0, 0, 300000000, 600000000,
    1200000000, 0x7FFFFFFFu)

TEST(the_first_thing_that_it_says_ends_that)
{
    static const fathom_status_t outcomes[] = {FATHOM_OK, FATHOM_ERR_EXCEPTION, FATHOM_ERR_CHECKSUM,
                                               FATHOM_ERR_MALFORMED};
    for (unsigned i = 0; i != COUNT(outcomes); i++)
        for (unsigned before = 1; before != 8; before++) {
            set_up(state);
            timeouts_in_row(before, time_outs_us, COUNT(time_outs_us));
            end_with(&measure, outcomes[i]);
            assert_paused_for(0);
            silence(); /* and the count begins anew */
            assert_paused_for(0);
            silence();
            assert_paused_for(0);
            silence();
            assert_paused_for(TIMEOUT_US);
        }
}

/* They prove nothing about the unit: the count of its time-outs stays, and so does the length of the pause. */
TEST(a_busy_line_and_another_master_leave_the_back_off_as_it_is)
{
    static const fathom_status_t outcomes[] = {FATHOM_ERR_LINE_BUSY, FATHOM_ERR_OTHER_MASTER};
    for (unsigned i = 0; i != COUNT(outcomes); i++)
        for (unsigned before = 0; before != 8; before++) {
            set_up(state);
            if (before == 0)
                ask_first();
            else
                timeouts_in_row(before, time_outs_us, COUNT(time_outs_us));
            const uint32_t pause_us = before == 0 ? 0 : time_outs_us[before - 1];
            const uint32_t next_us = time_outs_us[before > 6 ? 6 : before];
            for (unsigned n = 0; n != 3; n++) {
                end_with(&measure, outcomes[i]);
                assert_paused_for(pause_us);
            }
            silence(); /* counts on from there */
            assert_paused_for(next_us);
        }
}

/* The device's own pace holds for it all the same, and due says how long that is. */
TEST(a_command_waits_for_the_pace_and_not_for_the_back_off)
{
    enum { SLOW_US = 4 * TIMEOUT_US };
    silent_for(6);
    unit.pace_us = SLOW_US;
    assert_paused_for(8 * TIMEOUT_US);
    silence();
    const unsigned before = fake.submits;
    PENDS(read_after(0, &version));
    assert_int_equal(fathom_modbus_unit_due_us(&unit), SLOW_US - TIMEOUT_US);
    PENDS(read_after(SLOW_US - TIMEOUT_US - 1, &version));
    assert_int_equal(fake.submits, before);
    PENDS(read_after(1, &version));
    assert_int_equal(fake.submits, before + 1);
}

/* modbus_unit.h: "what was asked is forgotten": the silences of a device without power too. */
TEST(after_power_on_three_time_outs_in_a_row_are_needed_again)
{
    ask_first();
    for (unsigned times = 0; times != 2; times++) {
        for (unsigned n = 0; n != 3; n++) {
            silence();
            if (n != 2) assert_paused_for(0);
        }
        assert_int_equal(fathom_modbus_unit_due_us(&unit), TIMEOUT_US); /* it is left alone */
        fathom_modbus_unit_power_on(&unit, 0);
        assert_paused_for(0);
    }
}
