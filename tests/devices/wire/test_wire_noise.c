/* SPDX-License-Identifier: MIT */
/*
 * Noise on the wire of a unit that responds. Each request has an outcome within the bound of its configuration,
 * and a write never leaves into noise.
 */
#include "wire_desk.h"

enum { TIMEOUT_US = 100000, SECOND_US = 1000000, OTHERS = 3 };

typedef struct {
    const char *name;
    wire_us_t period_us, spread_us; /* both 0: no noise of its own */
    bool is_in_phase;               /* one byte in each turn */
    bool is_constant;               /* of zeros */
} noise_t;

static const noise_t noises[] = {
    {"a byte each 1 ms", 1000, 0, false, false},
    {"a byte each 2 ms", 2000, 0, false, false},
    {"a byte each 20 ms", 20000, 0, false, false},
    {"500 random bytes a second", 1, 3999, false, false},
    {"a byte in each turn", 0, 0, true, false},
    {"zeros without a pause", WIRE_BYTE_9600_US, 0, false, true},
    {"a zero each 3 ms", 3000, 0, false, true},
};

static const unsigned loops_ms[] = {1, 5, 10, 20, 30, 50};

typedef struct {
    wire_us_t longest_us;
    unsigned ready, busy, others;
    unsigned sent;
} result_t;

static void begin(const noise_t *noise, desk_parts_t parts, unsigned loop_ms)
{
    wire_open(WIRE_BYTE_9600_US, loop_ms);
    wire_add(&(wire_unit_t){.kind = WIRE_DYP_MODBUS, .answer_us = 2000});
    desk_open(parts, loop_ms * 1000u, loop_ms * 100u);
    wire.noise.is_in_phase = noise->is_in_phase;
    wire.noise.is_constant = noise->is_constant;
    wire.noise.period_us = noise->period_us;
    wire.noise.spread_us = noise->spread_us;
    if (noise->period_us != 0) wire.noise.next_us = wire.now_us;
}

static void note(result_t *result, const desk_request_t *request)
{
    const fathom_status_t status = desk_status(request);
    const wire_us_t took_us = wire.now_us - request->begin_us;
    if (result->longest_us < took_us) result->longest_us = took_us;
    result->ready += status == FATHOM_OK;
    result->busy += status == FATHOM_ERR_LINE_BUSY;
    result->others += status != FATHOM_OK && status != FATHOM_ERR_LINE_BUSY;
}

/* `count` requests, all queued at once; each begins again when it has ended. */
static result_t run_requests(unsigned count, bool is_write, uint8_t retries, wire_us_t for_us)
{
    static desk_request_t requests[OTHERS + 1];
    memset(requests, 0, sizeof requests);
    result_t result = {0};
    const wire_us_t end_us = wire.now_us + for_us;
    const wire_us_t bound_us = desk_bound_us(TIMEOUT_US, is_write ? 0 : retries, count - 1);
    bool is_begun = false;
    while (wire.now_us < end_us) {
        for (unsigned i = 0; i != count; i++) {
            desk_request_t *const request = &requests[i];
            if (is_begun && desk_status(request) == FATHOM_PENDING) {
                assert_true(wire.now_us - request->begin_us <= bound_us);
                continue;
            }
            if (is_begun) note(&result, request);
            if (is_write)
                desk_write(request, 0x0200, 1, TIMEOUT_US);
            else
                desk_read(request, 0x0101, 1, TIMEOUT_US, retries);
        }
        is_begun = true;
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
    result.sent = wire.host_frames;
    return result;
}

static void run_noises(const char *name, bool is_write, uint8_t retries, unsigned count)
{
    const wire_us_t for_us = DESK_SHARE(300u, 15u) * SECOND_US;
    for (size_t n = 0; n != sizeof noises / sizeof *noises; n++) {
        result_t all = {0};
        for (size_t l = 0; l != sizeof loops_ms / sizeof *loops_ms; l++)
            for (unsigned parts = DESK_PLAIN; parts <= DESK_ALL; parts++) {
                if (!suite_is_long && parts != DESK_PLAIN && parts != DESK_ALL) continue;
                begin(&noises[n], (desk_parts_t)parts, loops_ms[l]);
                const result_t one = run_requests(count, is_write, retries, for_us);
                assert_true(wire.least_quiet_us >= desk.config.silence_us);
                if (all.longest_us < one.longest_us) all.longest_us = one.longest_us;
                all.ready += one.ready;
                all.busy += one.busy;
                all.others += one.others;
                all.sent += one.sent;
            }
        DESK_REPORT("%s, %s: longest %.2f s; OK %u, LINE_BUSY %u, others %u, sent %u\n", noises[n].name, name,
                    (double)all.longest_us / 1e6, all.ready, all.busy, all.others, all.sent);
    }
}

TEST(a_read_in_noise_has_an_outcome_within_its_bound) { run_noises("read", false, 0, 1); }

TEST(a_read_with_2_retries_in_noise_has_an_outcome_within_its_bound)
{
    run_noises("read, 2 retries", false, 2, 1);
}

TEST(a_read_behind_3_others_in_noise_has_an_outcome_within_its_bound)
{
    run_noises("4 reads", false, 0, OTHERS + 1);
}

TEST(a_write_never_leaves_into_noise) { run_noises("write", true, 0, 1); }

/* After the noise the line works as before. */
TEST(after_noise_the_next_request_is_answered)
{
    for (size_t n = 0; n != sizeof noises / sizeof *noises; n++) {
        desk_request_t request = {0};
        begin(&noises[n], DESK_ALL, 5);
        desk_run(3 * SECOND_US);
        wire.noise.next_us = WIRE_NEVER;
        wire.noise.is_in_phase = false;
        desk_read(&request, 0x0101, 1, TIMEOUT_US, 0);
        assert_int_equal(desk_wait(&request, 65536 + 2 * TIMEOUT_US), FATHOM_OK);
    }
}

/* line.h: a response that has begun may finish. Each turn of the loop sees one more byte of it, and no gap. */
TEST(a_long_response_byte_by_byte_ends_within_the_bound)
{
    static uint8_t frame[255];
    static const uint8_t start[] = {0x01, 0x03, 0xF8};
    desk_request_t request = {0};
    wire_open(WIRE_BYTE_9600_US, 1);
    desk_open(DESK_ALL, 50000, 0);
    desk.config.frame = frame;
    desk.config.frame_size = sizeof frame;
    desk_init_line();
    desk_run(200000);
    desk_read(&request, 0x0101, 1, TIMEOUT_US, 0);
    for (unsigned i = 0; desk_status(&request) == FATHOM_PENDING; i++) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
        if (wire.host_frames == 1) (void)wire_send(WIRE_NOISE, wire.now_us, &start[i % 3], 1);
    }
    assert_true(wire.now_us - request.begin_us <= desk_bound_us(TIMEOUT_US, 0, 0));
}
