/* SPDX-License-Identifier: MIT */
#include "desk.h"
#include "fathom/engine/internal/modbus_unit.h"

enum { UNIT = 9, PACE_US = 100000, TIMEOUT_US = 300000 };

static fathom_modbus_unit_t unit;
static uint16_t values[11];
static uint16_t wanted[2] = {0x07D0, 0x1234};

/* As drivers use them: one repeated request, and two commands. */
static const fathom_modbus_unit_request_t measure = {values, 0x0100, 1, 3, 1};
static const fathom_modbus_unit_request_t version = {values, 0x0001, 3, 3, 0x80};
static const fathom_modbus_unit_request_t details = {values, 0x0003, 11, 3, 0xFF};

static void set_up_at(uint32_t now_us)
{
    desk_begin(now_us);
    memset(values, GUARD, sizeof values);
    memset(&unit, 0x5A, sizeof unit);
    assert_int_equal(init_unit(&unit, &fake.modbus, &(fathom_modbus_config_t){.address = UNIT, .retries = 2},
                               TIMEOUT_US, PACE_US),
                     FATHOM_OK);
}

static int set_up(void **state)
{
    set_up_at(5000);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* What happens in the order of time. */
typedef struct {
    const fathom_modbus_unit_request_t *request; /* is asked; NULL: the transport does something */
    uint32_t after_us;
    /* What comes of it; of the transport: how it ends the request, or FATHOM_PENDING: it sends it. */
    fathom_status_t is;
    uint8_t submits; /* requests so far */
} step_t;

#define P(us, request, submits)                                                                              \
    (step_t) { &(request), us, FATHOM_PENDING, submits }
#define IS(status, us, request, submits)                                                                     \
    (step_t) { &(request), us, status, submits }
#define SENT                                                                                                 \
    (step_t) { NULL, 0, FATHOM_PENDING, 0 }
#define ENDS(status)                                                                                         \
    (step_t) { NULL, 0, status, 0 }
#define ANSWERED ENDS(FATHOM_OK)
/* It is asked and on the wire; and the response has been taken, so long after. */
#define ON_WIRE(request, submits)   P(0, request, submits), SENT, P(0, request, submits)
#define TAKEN(us, request, submits) ON_WIRE(request, submits), ANSWERED, IS(FATHOM_OK, us, request, submits)
/* It is asked in exactly so long. */
#define ASKED_IN(us, request, submits) P((us)-1, request, (submits)-1), P(1, request, submits)

static const uint16_t three_values[] = {0x1409, 0x1B02, 0x0100};

static void go(const step_t *steps, unsigned count)
{
    static const uint16_t one_value[] = {754};
    for (const step_t *step = steps; step != steps + count; step++) {
        if (step->request != NULL) {
            fake.now_us += step->after_us;
            const unsigned before = fake.submits;
            const fathom_modbus_unit_request_t *const asked = step->request;
            fathom_modbus_unit_poll(&unit);
            assert_int_equal(ask_unit(&unit, asked), step->is);
            assert_int_equal(fake.submits, step->submits);
            if (fake.submits == before) continue;
            const uint8_t *const head = fake.log[before];
            assert_int_equal(head[0], UNIT);
            assert_int_equal(head[1], asked->function);
            assert_int_equal(head[2] * 256u + head[3], asked->first);
            assert_int_equal(head[4] * 256u + head[5], asked->last);
        } else if (step->is == FATHOM_PENDING) {
            fake_modbus_send(&fake);
        } else if (step->is == FATHOM_OK && fake.request->message.head[1] == 3) {
            const uint8_t asked = fake.request->message.head[5];
            fake_modbus_response(&fake, asked == 1 ? one_value : three_values, asked);
        } else {
            fake_modbus_fail(&fake, step->is);
        }
    }
}

#define GO(...) go((const step_t[]){__VA_ARGS__}, sizeof((const step_t[]){__VA_ARGS__}) / sizeof(step_t))
#define STEPS(promise, ...)                                                                                  \
    TEST(promise) { GO(__VA_ARGS__); }

static uint32_t due(void) { return fathom_modbus_unit_due_us(&unit); }

/* ---- setting up ---- */

TEST(a_unit_needs_a_transport_an_initialised_line_and_an_address_of_one_device)
{
    fathom_modbus_unit_t other;
    fathom_modbus_config_t config = {.address = 1};
    assert_int_equal(init_unit(&other, NULL, &config, 1000, 0), FATHOM_ERR_ARGUMENT);
    fake.line.parts = NULL;
    assert_int_equal(init_unit(&other, &fake.modbus, &config, 1000, 0), FATHOM_ERR_ARGUMENT);
    fake.line.parts = &fake.parts;
    fake.modbus.line = NULL;
    assert_int_equal(init_unit(&other, &fake.modbus, &config, 1000, 0), FATHOM_ERR_ARGUMENT);
    fake.modbus.line = &fake.line;
    for (unsigned address = 0; address != 256; address++) {
        const bool is_good = address != 255;
        config.address = (uint8_t)address;
        config.address_zero = false;
        assert_int_equal(init_unit(&other, &fake.modbus, &config, 1000, 0),
                         is_good ? FATHOM_OK : FATHOM_ERR_ARGUMENT);
        if (is_good) assert_int_equal(other.address, address != 0 ? address : 1);
        config.address_zero = true;
        assert_int_equal(init_unit(&other, &fake.modbus, &config, 1000, 0),
                         address == 0 ? FATHOM_OK : FATHOM_ERR_ARGUMENT);
        if (address == 0) assert_int_equal(other.address, 0);
    }
    assert_int_equal(fake.polls + fake.submits, 0);
}

TEST(the_first_request_goes_out_at_once_just_as_it_was_asked)
{
    assert_int_equal(due(), 0);
    fake.now_us += 1000000;
    assert_int_equal(due(), 0);
    GO(P(0, measure, 1));
    assert_int_equal(fake.request->transaction.timeout_us, TIMEOUT_US);
    assert_int_equal(fake.request->transaction.retries, 2);
    assert_ptr_equal(fake.request->message.values, values);
}

/* ---- outcomes ---- */

TEST(a_request_that_the_transport_does_not_take_is_tried_again_each_time)
{
    static const fathom_status_t errors[] = {FATHOM_ERR_ARGUMENT, FATHOM_ERR_CAPACITY, FATHOM_ERR_BUSY};
    for (unsigned i = 0; i != 3; i++) {
        fake.refuses = errors[i];
        GO(IS(errors[i], 1, measure, 0), IS(errors[i], 1, measure, 0));
        assert_int_equal(due(), 0);
    }
    fake.refuses = 0;
    GO(P(0, measure, 1));
    assert_int_equal(fathom_modbus_unit_failures(&unit), 0);
}

/* ---- pace ---- */

/* A slow loop: sent and answered since the last poll. */
STEPS(the_pace_does_not_count_what_passed_before_the_poll_that_sent_it, P(0, measure, 1), ANSWERED,
      IS(FATHOM_OK, 3 * PACE_US, measure, 1), ASKED_IN(PACE_US, measure, 2))

/* It was sent since the last poll, and so was the one before. */
STEPS(the_pace_of_the_second_request_counts_from_the_poll_that_found_it_sent, TAKEN(PACE_US, measure, 1),
      P(0, measure, 2), SENT, P(40000, measure, 2), ANSWERED, IS(FATHOM_OK, 0, measure, 2),
      ASKED_IN(PACE_US, measure, 3))

/* modbus_unit.h: "from this request to the next one to the unit, at least"; a retry is a request too. */
STEPS(the_pace_counts_from_the_last_attempt, ON_WIRE(measure, 1), P(6 * PACE_US, measure, 1), SENT,
      P(0, measure, 1), ANSWERED, IS(FATHOM_OK, 25000, measure, 1), ASKED_IN(PACE_US - 25000, measure, 2))

STEPS(a_response_slower_than_the_pace_is_followed_at_once, TAKEN(PACE_US, measure, 1), P(0, measure, 2))

/* ---- commands beside the repeated request ---- */

STEPS(an_error_of_a_command_waits_for_who_asked_too, ON_WIRE(version, 1), ENDS(FATHOM_ERR_EXCEPTION),
      P(PACE_US, measure, 1), P(PACE_US, measure, 1), IS(FATHOM_ERR_EXCEPTION, 0, version, 1))

STEPS(a_second_command_is_told_busy_until_the_first_was_taken, ON_WIRE(version, 1),
      IS(FATHOM_ERR_BUSY, 10, details, 1), ANSWERED, IS(FATHOM_ERR_BUSY, 10, details, 1),
      IS(FATHOM_ERR_BUSY, PACE_US, details, 1), IS(FATHOM_OK, 10, version, 1), P(10, details, 2))

static const fathom_modbus_unit_request_t at_0000 = {values, 0x0000, 1, 3, 0x7F};
static const fathom_modbus_unit_request_t at_ffff = {values, 0xFFFF, 1, 3, 0x81};

STEPS(any_register_can_be_asked_for, ON_WIRE(at_ffff, 1), ANSWERED, P(PACE_US, at_0000, 1),
      IS(FATHOM_OK, 0, at_ffff, 1), P(0, at_0000, 2))

STEPS(a_command_that_waits_for_the_pace_comes_before_the_repeated_request, TAKEN(1000, measure, 1),
      P(1000, version, 1), P(PACE_US, measure, 1), /* the pause is over, but a command waits */
      IS(FATHOM_ERR_BUSY, 0, details, 1),          /* another one must not overtake it */
      P(0, version, 2))

/* An outcome of the repeated request may be replaced by a newer one: once it has given way it is not handed over. */
STEPS(an_outcome_that_gave_way_to_a_command_is_not_handed_over, ON_WIRE(measure, 1), ANSWERED,
      P(0, version, 1), /* within the pace */
      P(0, measure, 1), P(PACE_US, version, 2))

/* ---- due ---- */

/* "how long until something can happen": to take the outcome is something. */
TEST(the_outcome_of_a_command_is_due_at_once_within_the_pace)
{
    GO(ON_WIRE(version, 1), ANSWERED, P(0, measure, 1)); /* in which the command ends */
    assert_int_equal(due(), 0);
}

/* Several drivers share a transport, so that one driver's poll may end another's request. */
TEST(it_is_due_at_once_when_anothers_poll_has_ended_its_request)
{
    GO(ON_WIRE(measure, 1), ANSWERED);
    fathom_line_poll(&fake.line);
    assert_int_equal(due(), 0);
}

/* ---- requests about one register that are not the same request: a read, a write, a measurement ---- */

enum { REGISTER = 0x0206 };
static const fathom_modbus_unit_request_t measurement = {values, REGISTER, 1, 3, 2};
static const fathom_modbus_unit_request_t reading = {values, REGISTER, 1, 3, 0x82};
static const fathom_modbus_unit_request_t one_write = {NULL, REGISTER, 0x07D0, 6, 0xC2};
static const fathom_modbus_unit_request_t two_written = {wanted, REGISTER, 2, 16, 0xC3};

/* The read does not take the outcome of the write. */
STEPS(while_a_register_is_written_a_read_is_told_busy_and_a_measurement_waits, P(0, one_write, 1),
      IS(FATHOM_ERR_BUSY, 0, reading, 1), P(0, measurement, 1), ANSWERED, IS(FATHOM_ERR_BUSY, 0, reading, 1),
      P(0, measurement, 1), IS(FATHOM_OK, 0, one_write, 1), P(PACE_US, measurement, 2), ANSWERED,
      IS(FATHOM_OK, 0, measurement, 2), P(PACE_US, reading, 3))

/* A reading is no acknowledgement. */
STEPS(a_write_of_a_register_that_is_being_read_is_told_busy, P(0, reading, 1),
      IS(FATHOM_ERR_BUSY, 0, one_write, 1), IS(FATHOM_ERR_BUSY, 0, two_written, 1), ANSWERED,
      IS(FATHOM_ERR_BUSY, 0, one_write, 1), IS(FATHOM_OK, 0, reading, 1), P(PACE_US, two_written, 2))

/* ---- a unit that does not answer is asked less and less often ---- */

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
