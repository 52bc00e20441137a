/* SPDX-License-Identifier: MIT */
/*
 * Another master that knows nothing of us sends requests to the same unit. A response to the other master is
 * never our reading, an attempt that its request interrupts fails with FATHOM_ERR_OTHER_MASTER, and each request
 * ends in its bound.
 */
#include "wire_desk.h"

#include "hex.h"

enum { TIMEOUT_US = 150000, SECOND_US = 1000000, OURS = 0x0101, FORMS = 6 };

/* Forms of foreign requests, to unit 1 unless it is stated. */
static const char *const forms[][FORMS] = {
    {"01 03 01 00 00 01"}, /* another register */
    {"01 03 02 06 00 01", "01 03 01 00 00 01"},
    {"01 04 01 00 00 01"},                /* 04: its response has another function */
    {"01 06 02 06 00 05"},                /* a write of one: its response equals it */
    {"01 10 02 05 00 02 04 00 01 00 02"}, /* a write of many */
    {"01 03 01 00 00 02", "01 04 01 00 00 01", "01 06 02 06 00 05", "01 10 02 05 00 02 04 00 01 00 02"},
    {"02 03 01 00 00 01", "01 03 01 00 00 01"}, /* also to a unit that is not there */
};
enum { FORM_SETS = sizeof forms / sizeof *forms };

static uint8_t form_bytes[FORMS][WIRE_FRAME], form_lengths[FORMS];

static void add_master_of(uint8_t count, wire_us_t period_us, wire_us_t spread_us)
{
    wire.master = (wire_master_t){.forms = (const uint8_t(*)[WIRE_FRAME])form_bytes,
                                  .lengths = form_lengths,
                                  .form_count = count,
                                  .period_us = period_us,
                                  .spread_us = spread_us,
                                  .next_us = wire.now_us + 30000};
}

static void add_master(unsigned set, wire_us_t period_us, wire_us_t spread_us)
{
    uint8_t count = 0;
    for (; count != FORMS && forms[set][count] != NULL; count++)
        form_lengths[count] = wire_frame_of(forms[set][count], form_bytes[count]);
    add_master_of(count, period_us, spread_us);
}

typedef struct {
    unsigned right, wrong, other_master, busy, others;
} result_t;

static void add(result_t *all, const result_t *one)
{
    all->right += one->right;
    all->wrong += one->wrong;
    all->other_master += one->other_master;
    all->busy += one->busy;
    all->others += one->others;
}

/* A value is right if the unit measured it in this register after we had asked. */
static void note(result_t *result, const desk_request_t *request)
{
    switch (desk_status(request)) {
    case FATHOM_OK: {
        const wire_issue_t *const issue = wire_issue_of(request->values[0]);
        const bool is_right = issue != NULL && issue->reg == OURS && issue->at_us >= request->begin_us;
        result->right += is_right;
        if (!is_right && result->wrong == 0 && desk.config.masters != NULL) wire_print();
        result->wrong += !is_right;
        break;
    }
    case FATHOM_ERR_OTHER_MASTER:
        result->other_master++;
        break;
    case FATHOM_ERR_LINE_BUSY:
        result->busy++;
        break;
    default:
        result->others++;
        break;
    }
}

static result_t run_reads(uint8_t retries, wire_us_t pace_us, wire_us_t for_us)
{
    desk_request_t request = {0};
    result_t result = {0};
    const wire_us_t end_us = wire.now_us + for_us;
    const wire_us_t bound_us = desk_bound_us(TIMEOUT_US, retries, 0);
    wire_us_t due_us = wire.now_us;
    bool is_begun = false;
    while (wire.now_us < end_us) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
        if (is_begun && desk_status(&request) == FATHOM_PENDING) {
            assert_true(wire.now_us - request.begin_us <= bound_us);
            continue;
        }
        if (is_begun) note(&result, &request);
        is_begun = wire.now_us >= due_us;
        if (!is_begun) continue;
        desk_read(&request, OURS, 1, TIMEOUT_US, retries);
        due_us = wire.now_us + pace_us;
    }
    if (desk.config.masters == NULL) return result;
    assert_int_equal(result.wrong, 0);
    /* The line has heard a request for each of these attempts. */
    assert_true(desk_count(FATHOM_LINE_FOREIGN_REQUESTS) >= result.other_master);
    assert_true(desk_count(FATHOM_LINE_OTHER_MASTERS) >= result.other_master);
    if (retries == 0) assert_int_equal(desk_count(FATHOM_LINE_OTHER_MASTERS), result.other_master);
    return result;
}

static const unsigned loops_ms[] = {1, 4, 11, 21, 43, 60};
enum { LOOPS = sizeof loops_ms / sizeof *loops_ms };

/* One setting of the wire in each loop. */
static result_t run_wire(desk_parts_t parts, unsigned set, wire_us_t period_us, wire_us_t answer_us,
                         wire_busy_t when_busy, uint8_t retries, wire_us_t pace_us)
{
    result_t all = {0};
    for (unsigned l = 0; l != LOOPS; l++) {
        wire_open(WIRE_BYTE_9600_US, (uint64_t)period_us * 7 + answer_us + l);
        wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS,
                                .answer_us = answer_us,
                                .spread_us = answer_us / 2,
                                .when_busy = when_busy});
        desk_open(parts, loops_ms[l] * 1000u, loops_ms[l] * 20u);
        desk_learn_protocol();
        add_master(set, period_us, period_us / 3);
        const result_t one = run_reads(retries, pace_us, DESK_SHARE(60u, 3u) * SECOND_US);
        add(&all, &one);
    }
    return all;
}

/* The times of the unit reach from before our request to behind our time-out, so that the response to the other
 * master is due when ours is sent, and its request comes while ours is outstanding. */
static void run_retries(uint8_t retries)
{
    static const wire_us_t periods_us[] = {50000, 100000, 300000, 900000};
    static const wire_us_t answers_us[] = {2000, 20000, 40000, 90000};
    for (unsigned set = 0; set != FORM_SETS; set++) {
        result_t all = {0};
        for (unsigned p = 0; p != 4; p++)
            for (unsigned a = 0; a != 4; a++)
                for (unsigned busy = WIRE_IGNORES; busy <= WIRE_QUEUES; busy++) {
                    /* A unit that queues a request responds to two in up to 2 x (1.5 x answers_us + 8 bytes). A response
                     * later than one time-out is not covered, nor is a master that does not wait for it. */
                    const wire_us_t two_us = 2 * (3 * answers_us[a] / 2 + 8 * WIRE_BYTE_9600_US);
                    if (busy == WIRE_QUEUES && (two_us > TIMEOUT_US || two_us > periods_us[p])) continue;
                    const result_t one =
                        run_wire(DESK_ALL, set, periods_us[p], answers_us[a], (wire_busy_t)busy, retries, 0);
                    add(&all, &one);
                }
        assert_true(all.right != 0 && all.other_master != 0);
    }
}

TEST(no_response_to_another_master_is_our_reading) { run_retries(0); }

TEST(no_response_to_another_master_is_the_reading_of_a_retry) { run_retries(1); }

TEST(no_response_to_another_master_is_the_reading_of_the_second_retry) { run_retries(2); }

/* The other master is polite: its pauses are longer than a request and its response. */
TEST(beside_a_slow_master_nearly_each_request_is_answered)
{
    const result_t all = run_wire(DESK_ALL, 0, 900000, 20000, WIRE_IGNORES, 1, 200000);
    assert_true(all.right * 100 >= (all.right + all.other_master + all.busy + all.others) * 95);
}

/* What the part is for: without it the same wire gives wrong readings, which only this test can see. */
TEST(a_line_whose_config_does_not_name_other_masters_takes_their_responses)
{
    const result_t all = run_wire(DESK_SENDERS, 0, 300000, 90000, WIRE_TAKES_NEWER, 0, 0);
    assert_true(all.wrong != 0);
    assert_int_equal(all.other_master, 0);
}

/* The other master sends its next request `pause_us` after each response, or a time-out after a lost one. */
static void run_restless(wire_us_t pause_us)
{
    for (unsigned l = 0; l != LOOPS; l++) {
        wire_open(WIRE_BYTE_9600_US, pause_us + l);
        wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS, .answer_us = 5000});
        desk_open(DESK_ALL, loops_ms[l] * 1000u, loops_ms[l] * 20u);
        add_master(0, pause_us, 0);
        wire.master.timeout_us = TIMEOUT_US;
        const result_t result = run_reads(0, 0, DESK_SHARE(300u, 20u) * SECOND_US);
        /* Room for the silence, a request, the time of the unit and a response: 3.6 + 8.3 + 5 + 7.3 ms. */
        if (pause_us >= 30000) assert_true(result.right != 0);
    }
}

TEST(a_master_that_polls_without_pause_does_not_starve_us)
{
    static const wire_us_t pauses_us[] = {0, 2000, 4000, 10000, 30000};
    for (unsigned i = 0; i != 5; i++) run_restless(pauses_us[i]);
}

/* A write of ours whose acknowledgement could be another master's. */
TEST(a_write_is_acknowledged_by_its_own_response_alone)
{
    for (unsigned l = 0; l != LOOPS; l++)
        for (unsigned set = 3; set != 6; set++) {
            desk_request_t request = {0};
            unsigned ready = 0;
            wire_open(WIRE_BYTE_9600_US, l + 100 * set);
            wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS,
                                    .answer_us = 20000,
                                    .spread_us = 40000,
                                    .when_busy = WIRE_TAKES_NEWER});
            desk_open(DESK_ALL, loops_ms[l] * 1000u, loops_ms[l] * 20u);
            add_master(set, 150000, 100000);
            for (const wire_us_t end_us = wire.now_us + DESK_SHARE(300u, 20u) * SECOND_US;
                 wire.now_us < end_us;) {
                const unsigned writes = wire.units[0].writes;
                desk_write(&request, 0x0205, 1, TIMEOUT_US);
                const fathom_status_t status = desk_wait(&request, desk_bound_us(TIMEOUT_US, 0, 0));
                assert_int_not_equal(status, FATHOM_PENDING);
                if (status == FATHOM_OK) assert_true(wire.units[0].writes != writes);
                ready += status == FATHOM_OK;
            }
            assert_true(ready != 0);
        }
}

/* A05 with 55 AA: the same unit is measured by two masters. */
TEST(no_55_aa_response_to_another_master_is_our_reading)
{
    static const char *const requests[] = {"55 AA 01 01 01", "55 AA 01 11 11", "55 AA 01 10 10"};
    for (unsigned l = 0; l != LOOPS; l++) {
        unsigned right = 0;
        desk_request_t request = {0};
        wire_open(WIRE_BYTE_9600_US, l);
        wire_add(&(wire_unit_t){
            .kind = WIRE_DYP_55AA, .answer_us = 65000, .spread_us = 10000, .when_busy = WIRE_TAKES_NEWER});
        desk_open(DESK_ALL, loops_ms[l] * 1000u, loops_ms[l] * 20u);
        for (unsigned i = 0; i != 3; i++) form_lengths[i] = hex_parse(requests[i], form_bytes[i]);
        add_master_of(3, 250000, 250000);
        for (const wire_us_t end_us = wire.now_us + DESK_SHARE(600u, 60u) * SECOND_US;
             wire.now_us < end_us;) {
            fathom_modbus_read_holding_registers(&request.request.message, 1, 0x0106, 1, request.values);
            request.request.transaction.timeout_us = 2 * TIMEOUT_US;
            request.begin_us = wire.now_us;
            assert_int_equal(fathom_dyp_client_submit(&desk.line, &request.request), FATHOM_PENDING);
            assert_int_not_equal(desk_wait(&request, desk_bound_us(2 * TIMEOUT_US, 0, 0)), FATHOM_PENDING);
            if (desk_status(&request) == FATHOM_OK && wire_has_chance_of(request.values[0])) continue;
            if (desk_status(&request) == FATHOM_OK) {
                const wire_issue_t *const issue = wire_issue_of(request.values[0]);
                assert_non_null(issue);
                assert_int_equal(issue->reg, 0x0106);
                assert_true(issue->at_us >= request.begin_us);
                right++;
            }
        }
        assert_true(right != 0);
    }
}

/*
 * A late response to us and a response to the other master are due, and the first frame may be either.
 *
 *     ours     [request]|<--- time-out --->|                          no request until 218 ms
 *     master                                 [request]
 *     unit                                             [ours, late]                   [theirs]
 *     ms                0                100 110  118  130       137                  210  217
 */
TEST(a_foreign_request_to_a_unit_in_quarantine_holds_us_for_its_whole_time)
{
    enum { FIRST_TIMEOUT_US = 100000 };
    uint8_t frame[WIRE_FRAME];
    desk_request_t request = {0};
    wire_open(WIRE_BYTE_9600_US, 1);
    desk_open(DESK_ALL, 1000, 0);
    desk_run(20000);
    desk_read(&request, OURS, 1, FIRST_TIMEOUT_US, 0);
    assert_int_equal(desk_wait(&request, SECOND_US), FATHOM_ERR_NO_RESPONSE);
    const wire_us_t asked_us = wire.host_end_us;
    (void)wire_send(WIRE_MASTER, asked_us + 110000, frame, wire_frame_of("01 03 01 00 00 01", frame));
    (void)wire_send(WIRE_FIRST_UNIT, asked_us + 130000, frame, wire_frame_of("01 03 02 02 F2", frame));
    (void)wire_send(WIRE_FIRST_UNIT, asked_us + 210000, frame, wire_frame_of("01 03 02 07 D0", frame));
    desk_read(&request, OURS, 1, FIRST_TIMEOUT_US, 0);
    assert_int_equal(desk_wait(&request, SECOND_US), FATHOM_ERR_NO_RESPONSE);
    assert_true(wire.host_start_us >= asked_us + 217000);
}

/* What a poll reads may have arrived while the response to the other master was still due. */
TEST(a_response_that_a_slow_loop_reads_late_is_judged_by_the_time_before_the_poll)
{
    for (unsigned offset_us = 0; offset_us != 200000; offset_us += 1000) {
        desk_request_t request = {0};
        uint8_t frame[WIRE_FRAME];
        result_t result = {0};
        wire_open(WIRE_BYTE_9600_US, 1);
        wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS, .answer_us = 132000, .when_busy = WIRE_TAKES_NEWER});
        desk_open(DESK_ALL, 60000, 0);
        desk_run(120000);
        desk_read(&request, OURS, 1, TIMEOUT_US, 1);
        while (wire.host_frames == 0) {
            desk_turn();
            (void)fathom_line_poll(&desk.line);
        }
        (void)wire_send(WIRE_MASTER, wire.host_end_us + offset_us, frame,
                        wire_frame_of("01 03 01 00 00 01", frame));
        assert_int_not_equal(desk_wait(&request, desk_bound_us(TIMEOUT_US, 1, 0)), FATHOM_PENDING);
        note(&result, &request);
        assert_int_equal(result.wrong, 0);
    }
}

/*
 * An HPS-167S that sends by itself: the frame after a foreign request is unsolicited, and the response comes behind it. The
 * response to command #2 has the shape of a measurement.
 */
TEST(beside_a_unit_that_sends_by_itself_an_answer_is_not_our_measurement)
{
    unsigned measured = 0;
    for (unsigned turn_us = 500; turn_us <= 2500; turn_us += 500) {
        desk_request_t request = {0};
        wire_open(WIRE_BYTE_19200_US, turn_us);
        wire_add(&(wire_unit_t){.kind = WIRE_HPS167S,
                                .period_us = 18519,
                                .answer_us = 12000,
                                .spread_us = 25000,
                                .measure_us = 2000,
                                .when_busy = WIRE_TAKES_NEWER});
        desk_open(DESK_ALL, turn_us, 0);
        form_lengths[0] = wire_frame_of("01 03 00 02 00 04", form_bytes[0]);
        add_master_of(1, 150000, 100000);
        wire.master.next_us = wire.now_us + 100000;
        for (const wire_us_t end_us = wire.now_us + DESK_SHARE(600u, 60u) * SECOND_US;
             wire.now_us < end_us;) {
            desk_run(wire_random(100000)); /* the line hears frames that no request was heard for */
            desk_read(&request, WIRE_MEASUREMENT, 4, TIMEOUT_US, 0);
            assert_int_not_equal(desk_wait(&request, desk_bound_us(TIMEOUT_US, 0, 0)), FATHOM_PENDING);
            if (desk_status(&request) != FATHOM_OK) continue;
            if (wire_issue_of(request.values[0]) == NULL) wire_print();
            assert_non_null(wire_issue_of(request.values[0]));
            measured++;
        }
    }
    assert_true(measured != 0);
}
