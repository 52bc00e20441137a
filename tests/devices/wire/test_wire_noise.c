/* SPDX-License-Identifier: MIT */
/*
 * Noise on the wire of a unit that responds. Each request has an outcome within the bound of its configuration,
 * and a write never leaves into noise.
 */
#include "wire_desk.h"

enum { TIMEOUT_US = 100000, SECOND_US = 1000000, OTHERS = 3 };

typedef struct {
    wire_us_t period_us, spread_us; /* both 0: no noise of its own */
    bool is_in_phase;               /* one byte in each turn */
    bool is_constant;               /* of zeros */
} noise_t;

static const noise_t noises[] = {
    {1000, 0, false, false},             /* a byte each 1 ms */
    {2000, 0, false, false},             /* a byte each 2 ms */
    {20000, 0, false, false},            /* a byte each 20 ms */
    {1, 3999, false, false},             /* 500 random bytes a second */
    {0, 0, true, false},                 /* a byte in each turn */
    {WIRE_BYTE_9600_US, 0, false, true}, /* zeros without a pause */
    {3000, 0, false, true},              /* a zero each 3 ms */
};

static const unsigned loops_ms[] = {1, 5, 10, 20, 30, 50};

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

/* `count` requests, all queued at once; each begins again when it has ended. */
static void run_requests(unsigned count, bool is_write, uint8_t retries, wire_us_t for_us)
{
    static desk_request_t requests[OTHERS + 1];
    memset(requests, 0, sizeof requests);
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
            if (is_write)
                desk_write(request, 0x0200, 1, TIMEOUT_US);
            else
                desk_read(request, 0x0101, 1, TIMEOUT_US, retries);
        }
        is_begun = true;
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
}

static void run_noises(bool is_write, uint8_t retries, unsigned count)
{
    const wire_us_t for_us = DESK_SHARE(300u, 15u) * SECOND_US;
    for (size_t n = 0; n != sizeof noises / sizeof *noises; n++) {
        for (size_t l = 0; l != sizeof loops_ms / sizeof *loops_ms; l++)
            for (unsigned parts = DESK_PLAIN; parts <= DESK_ALL; parts++) {
                if (!suite_is_long && parts != DESK_PLAIN && parts != DESK_ALL) continue;
                begin(&noises[n], (desk_parts_t)parts, loops_ms[l]);
                run_requests(count, is_write, retries, for_us);
                assert_true(wire.least_quiet_us >= desk.config.silence_us);
            }
    }
}

TEST(a_read_in_noise_has_an_outcome_within_its_bound) { run_noises(false, 0, 1); }

TEST(a_read_with_2_retries_in_noise_has_an_outcome_within_its_bound) { run_noises(false, 2, 1); }

TEST(a_read_behind_3_others_in_noise_has_an_outcome_within_its_bound) { run_noises(false, 0, OTHERS + 1); }

TEST(a_write_never_leaves_into_noise) { run_noises(true, 0, 1); }

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
