/* SPDX-License-Identifier: MIT */

/* Frames that A16 and A05 send by themselves, at their true spacing, with noise and lost bytes: each good one gives its
 * reading, and no other reading is ever given. */
#include <stdint.h>

#include "suite.h"

#include "board.h"
#include "fathom/hal.h"
#include "fathom/sample.h"
#include "reports.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"

enum { FRAMES = 200, FRAMES_AWAKE = 30 }; /* a processor that sleeps is simulated fast */

static const fathom_line_settings_t at_9600 = {9600, FATHOM_PARITY_NONE, 1};

static board_t board;
static fathom_sim_line_t line;
static fathom_sim_a16_t a16;
static fathom_sim_a05_t a05;
static fathom_sim_fault_t fault;

/* What was measured for each frame, probe 1; the other probes 100 mm more each. */
static uint16_t truth[FRAMES + 8];
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
    (void)ctx, (void)now_us;
    if (probe == 1) {
        const uint16_t mm = distance_of(measured);
        truth[measured < FRAMES + 7 ? measured : FRAMES + 7] = mm;
        measured++;
    }
    return distance_of(measured - 1) + 100 * (probe - 1);
}

static void order(uint8_t orders, uint32_t clock_us)
{
    assert_true(board_start(&board, "auto"));
    measured = 0;
    const fathom_sim_scene_t scene = {measure, NULL};
    fathom_sim_line_init(&line, &at_9600, board.clock.now_us);
    line.full_duplex = true;
    fathom_sim_fault_init(&fault, 7);
    fathom_sim_device_t *device;
    if ((orders & ORDER_A16) != 0) {
        const fathom_sim_a16_config_t config = {.mode = FATHOM_SIM_A16_UART, .scene = scene};
        fathom_sim_a16_init(&a16, &config);
        device = &a16.device;
    } else {
        const fathom_sim_a05_config_t config = {.mode = FATHOM_SIM_A05_AUTO, .scene = scene};
        fathom_sim_a05_init(&a05, &config);
        device = &a05.device;
    }
    fathom_sim_fault_attach(&fault, &line, device);
    fathom_sim_attach(&line, device, board.clock.now_us);
    board_join_line(&board, &line);
    const board_record_t *const ready = board_next_record(&board, 1000);
    assert_int_equal(ready->kind, REPORT_READY);
    zero_us = (uint32_t)(ready->cycle / BOARD_CYCLES_PER_US);
    for (int i = 0; i < 4; i++) board_data(&board, "periods_us")[i] = (uint8_t)(clock_us >> 8 * i);
    board.avr->data[0x3E] = orders;
    assert_int_equal(board_next_record(&board, 1000)->kind, REPORT_BEGUN);
}

static int stop(void **state)
{
    assert_false(board.finished);
    board_end(&board);
    return 0;
}

static const suite_t suite = {.tear_down = stop};

typedef struct {
    uint32_t samples, errors, wrong;
} result_t;

/* Until so many frames have been sent. A reading is right if it is of one of the last two. */
static result_t run(uint8_t probes, uint32_t frames)
{
    result_t result = {0, 0, 0};
    uint16_t last_sequence = 0xFFFF;
    while (measured < frames) {
        const board_record_t *const record = board_next_record(&board, 4000000);
        assert_non_null(record);
        if (record->kind == REPORT_ERROR) {
            result.errors++;
            continue;
        }
        assert_int_equal(record->kind, REPORT_SAMPLE);
        const uint16_t mm = (uint16_t)(record->bytes[4] | record->bytes[5] << 8);
        const uint16_t sequence = (uint16_t)(record->bytes[6] | record->bytes[7] << 8);
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
        const board_record_t *record = board_next_record(&board, 4000000);
        assert_non_null(record);
        uint32_t time_us = 0;
        for (int at = 3; at >= 0; at--) time_us = time_us << 8 | record->bytes[at];
        uint32_t last = board.bytes_seen;
        while (last % length != 0) last--;
        const uint32_t end_us =
            (uint32_t)(board.bytes[(last - 1) % BOARD_BYTES].end_cycle / BOARD_CYCLES_PER_US) - zero_us;
        assert_in_range((uint32_t)(time_us - end_us), 0,
                        1200); /* when it was read, on waking; and crt's start */
    }
}

TEST(every_frame_of_an_a16_gives_its_reading)
{
    order(ORDER_A16, 0);
    const result_t result = run(1, FRAMES);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.errors, 0);
    assert_true(result.samples >= FRAMES - 1);
    assert_true(board.asleep_cycles > board.avr->cycle / 100 * 98);
}

TEST(every_frame_of_an_a05_gives_its_four_readings)
{
    order(ORDER_A05, 0);
    const result_t result = run(4, FRAMES);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.errors, 0);
    assert_true(result.samples >= 4 * (FRAMES - 1));
}

TEST(across_the_wrap_of_the_clock_nothing_is_lost)
{
    for (int a16_first = 0; a16_first < 2; a16_first++) {
        order(a16_first != 0 ? ORDER_A16 : ORDER_A05, 0xFFC00000); /* the wrap comes after 4.2 s */
        const result_t result = run(a16_first != 0 ? 1 : 4, FRAMES);
        assert_int_equal(result.wrong, 0);
        assert_int_equal(result.errors, 0);
        assert_true(result.samples >= (a16_first != 0 ? 1u : 4u) * (FRAMES - 1));
        if (a16_first == 0) stop(state);
    }
}

TEST(in_a_loop_that_comes_round_every_20_ms_too)
{
    order(ORDER_A16 | ORDER_20_MS, 0);
    const result_t result = run(1, FRAMES_AWAKE);
    assert_int_equal(result.wrong, 0);
    assert_int_equal(result.errors, 0);
    assert_true(result.samples >= FRAMES_AWAKE - 1);
    stop(state);
    order(ORDER_A05 | ORDER_20_MS, 0);
    assert_int_equal(run(4, FRAMES_AWAKE).wrong, 0);
}

TEST(a_reading_has_the_time_of_its_last_byte)
{
    order(ORDER_A16, 0);
    assert_time_of_last_byte(4);
    stop(state);
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
            const result_t result = run(probes, FRAMES);
            const uint32_t hit = fault.counters[kinds[i].kind];
            assert_int_equal(result.wrong, 0);
            assert_int_equal(result.errors, 0);
            assert_in_range(hit, FRAMES / 10, FRAMES / 3);
            const bool is_away = kinds[i].us != 0; /* 20 ms from its frame, which is read all the same */
            const uint32_t good = is_away ? measured : measured - hit;
            /* Where the last byte of a frame is lost, the next frame begins behind a loss and is doubted. */
            const uint32_t doubted = kinds[i].kind == FATHOM_SIM_FAULT_OVERRUN ? hit / 2 : 0;
            assert_true(result.samples >= probes * (good - doubted - 1));
            assert_true(result.samples <= probes * good);
            stop(state);
        }
    }
    order(ORDER_A16, 0);
}
