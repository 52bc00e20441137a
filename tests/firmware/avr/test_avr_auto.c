/* SPDX-License-Identifier: MIT */
/* Frames that A16 and A05 send by themselves, at their true spacing, with noise and lost bytes: each good one gives its
 * reading, and no other reading is ever given. */
#include "suite.h"

#include "fathom/hal.h"
#include "fathom/sample.h"
#include "modbus_desk.h"

/* A processor that sleeps is simulated fast. In the long run there are twice as many. */
enum { FRAMES = 100, FRAMES_AWAKE = 15, MOST_FRAMES = 2 * FRAMES };
static uint32_t in_time(uint32_t frames) { return board_has_time() ? 2 * frames : frames; }

static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_a05_t a05;
static fathom_sim_fault_t fault;

/* What was measured for each frame, probe 1; the other probes 100 mm more each. */
static uint16_t truth[MOST_FRAMES + 8];
static uint32_t measured;

static uint32_t zero_us; /* of the image's clock */

/* A sum right in two places (511), the bytes of a beginning (FF FF), and everything around. */
static uint16_t distance_of(uint32_t frame)
{
    static const uint16_t odd[] = {511, 255, 256, 2047, 3840, 4095, 1, 300};
    return frame % 5 == 0 ? odd[frame / 5 % 8] : (uint16_t)(500 + frame * 13);
}

static int32_t measure(void *ctx, uint8_t probe, uint32_t now_us)
{
    if (probe == 1) {
        const uint16_t mm = distance_of(measured);
        truth[measured < MOST_FRAMES + 7 ? measured : MOST_FRAMES + 7] = mm;
        measured++;
    }
    return distance_of(measured - 1) + 100 * (probe - 1);
}

static void order(uint8_t orders, uint32_t clock_us)
{
    board_start("sensors");
    measured = 0;
    const fathom_sim_scene_t scene = {measure, NULL};
    fathom_sim_device_t *device = &a16.device;
    if ((orders & ORDER_A16) != 0) {
        fathom_sim_a16_init(&a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_UART, .scene = scene});
    } else {
        fathom_sim_a05_init(&a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = scene});
        device = &a05.device;
    }
    fathom_sim_fault_init(&fault, 7);
    board_attach(&line, device, true);
    fathom_sim_fault_attach(&fault, &line, device);
    board_join_line(&line);
    zero_us = desk_begin(orders, clock_us);
}

static const suite_t suite = {.tear_down = desk_stop};

typedef struct {
    uint32_t samples, errors, wrong;
} result_t;

/* Until so many frames have been sent. A reading is right if it is of one of the last two. */
static result_t run(uint8_t probes, uint32_t frames)
{
    result_t result = {0, 0, 0};
    uint16_t last_sequence = 0xFFFF;
    while (measured < frames) {
        const board_record_t *const record = board_next_record(4000000);
        assert_non_null(record);
        if (record->kind == REPORT_ERROR) {
            result.errors++;
            continue;
        }
        assert_int_equal(record->kind, REPORT_SAMPLE);
        const uint16_t mm = (uint16_t)board_number(record->bytes + 4, 2);
        const uint16_t sequence = (uint16_t)board_number(record->bytes + 6, 2);
        const uint8_t probe = record->bytes[10];
        assert_int_equal(record->bytes[8], FATHOM_TARGET);
        assert_in_range(probe, 1, probes);
        if (probe == 1) assert_int_not_equal(sequence, last_sequence);
        last_sequence = sequence;
        const uint16_t first = (uint16_t)(mm - 100 * (probe - 1));
        if (first != truth[measured - 1] && (measured < 2 || first != truth[measured - 2])) result.wrong++;
        result.samples++;
    }
    return result;
}

/* Where in the frames the reading came is checked by its time: the last byte's end, as the clock has it. */
static void assert_time_of_last_byte(uint8_t length)
{
    for (int i = 0; i < 5; i++) {
        const board_record_t *record = board_next_record(4000000);
        assert_non_null(record);
        const uint32_t time_us = board_number(record->bytes, 4);
        uint32_t last = board.bytes_seen;
        while (last % length != 0) last--;
        const uint32_t end_us =
            (uint32_t)(board.bytes[(last - 1) % BOARD_BYTES].end_cycle / BOARD_CYCLES_PER_US) - zero_us;
        assert_in_range((uint32_t)(time_us - end_us), 0,
                        1200); /* when it was read, on waking; and crt's start */
    }
}

/* Each of so many frames gives its reading, or its four; one may be on its way. */
typedef struct {
    uint8_t orders;
    uint32_t frames, clock_us;
} all_t;

static void assert_all(void **state)
{
    const all_t *const row = *state;
    const uint8_t probes = (row->orders & ORDER_A16) != 0 ? 1 : 4;
    order(row->orders, row->clock_us);
    const uint32_t frames = in_time(row->frames);
    const result_t result = run(probes, frames);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.errors, 0);
    assert_true(result.samples >= probes * (frames - 1));
    if (row->orders == ORDER_A16) assert_true(board.asleep_cycles > board.avr->cycle / 100 * 98);
}

#define ALL(name, ...)                                                                                       \
    static const all_t name = {__VA_ARGS__};                                                                 \
    TEST_ROW(name, assert_all, &name)

ALL(every_frame_of_an_a16_gives_its_reading, ORDER_A16, FRAMES, 0)
ALL(every_frame_of_an_a05_gives_its_four_readings, ORDER_A05, FRAMES, 0)
/* The wrap comes after 4.2 s. */
ALL(across_the_wrap_of_the_clock_nothing_is_lost, ORDER_A16, FRAMES, 0xFFC00000)
ALL(across_the_wrap_of_the_clock_nothing_of_an_a05_is_lost, ORDER_A05, FRAMES, 0xFFC00000)
ALL(in_a_loop_that_comes_round_every_20_ms_too, ORDER_A16 | ORDER_SLOW_LOOP, FRAMES_AWAKE, 0)

TEST(in_a_loop_that_comes_round_every_20_ms_no_reading_of_an_a05_is_wrong)
{
    order(ORDER_A05 | ORDER_SLOW_LOOP, 0);
    assert_int_equal(run(4, in_time(FRAMES_AWAKE)).wrong, 0);
}

TEST(a_reading_has_the_time_of_its_last_byte)
{
    order(ORDER_A16, 0);
    assert_time_of_last_byte(4);
    order(ORDER_A05, 0);
    assert_time_of_last_byte(10);
}

/* Of the frames that were hit none gives a reading, and of the others all do. */
TEST(with_noise_and_lost_bytes_no_reading_is_wrong)
{
    static const struct {
        uint8_t kind;
        uint32_t us;
    } kinds[] = {
        {FATHOM_SIM_FAULT_FLIP_BIT, 0}, {FATHOM_SIM_FAULT_FLIP_BYTE, 0}, {FATHOM_SIM_FAULT_DROP, 0},
        {FATHOM_SIM_FAULT_INSERT, 0},   {FATHOM_SIM_FAULT_TRUNCATE, 0},  {FATHOM_SIM_FAULT_FRAMING, 0},
        {FATHOM_SIM_FAULT_OVERRUN, 0},  {FATHOM_SIM_FAULT_NOISE, 20000}, {FATHOM_SIM_FAULT_BREAK, 20000},
        {FATHOM_SIM_FAULT_SILENCE, 0},
    };
    for (int model = 0; model < 2; model++) {
        const uint8_t probes = model == 0 ? 1 : 4;
        for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
            order(model == 0 ? ORDER_A16 : ORDER_A05, 0);
            fathom_sim_fault_add(&fault, kinds[i].kind, 200000, 0)->us = kinds[i].us;
            const uint32_t frames = in_time(FRAMES);
            const result_t result = run(probes, frames);
            const uint32_t hit = fault.counters[kinds[i].kind];
            assert_int_equal(result.wrong, 0);
            assert_int_equal(result.errors, 0);
            assert_in_range(hit, frames / 10, frames / 3);
            const bool is_away = kinds[i].us != 0; /* 20 ms from its frame, which is read all the same */
            const uint32_t good = is_away ? measured : measured - hit;
            /* Where the last byte of a frame is lost, the next frame begins behind a loss and is doubted. */
            const uint32_t doubted = kinds[i].kind == FATHOM_SIM_FAULT_OVERRUN ? hit / 2 : 0;
            assert_true(result.samples >= probes * (good - doubted - 1));
            assert_true(result.samples <= probes * good);
            assert_false(board.finished);
        }
    }
}
