/* SPDX-License-Identifier: MIT */
/* Drivers that listen to frames of which some arrive with wrong bits, or as zeros. */
#include "second_damage.h"

#include <stdlib.h>

#include "suite.h"

static rig_t rig;

enum { SECOND_US = 1000000, STALE_US = 4 * SECOND_US };

/* A driver that listens to the line of the rig. */
typedef struct {
    second_kind_t kind;
    uint32_t stale_us;
    fathom_sensor_t (*begin)(void);
    damage_counted_t (*end)(void);
} listener_t;

static fathom_a16_auto_t a16;
static fathom_a05_auto_t a05;
static fathom_hps167s_auto_t hps;
static fathom_a16_controlled_t controlled;

static damage_counted_t counted_by(const fathom_stream_t *stream)
{
    const uint16_t *counters = stream->counters;
    return (damage_counted_t){.frames = counters[FATHOM_STREAM_FRAMES],
                              .dropped_bytes = counters[FATHOM_STREAM_DROPPED_BYTES],
                              .damaged = counters[FATHOM_STREAM_DAMAGED]};
}

static fathom_sensor_t begin_a16(void)
{
    const fathom_a16_auto_config_t config = {.stale_us = STALE_US, .gap_us = rig.line_parts.gap_us};
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, &config), FATHOM_OK);
    return fathom_a16_auto_sensor(&a16);
}

static damage_counted_t end_a16(void)
{
    const damage_counted_t counted = counted_by(&a16.base.stream);
    fathom_a16_auto_deinit(&a16);
    return counted;
}

static fathom_sensor_t begin_a05(void)
{
    const fathom_a05_auto_config_t config = {
        .stale_us = STALE_US, .gap_us = rig.line_parts.gap_us, .probes = rig.device.config.fitted};
    assert_int_equal(fathom_a05_auto_init(&a05, &rig.line, &config), FATHOM_OK);
    return fathom_a05_auto_sensor(&a05);
}

static damage_counted_t end_a05(void)
{
    const damage_counted_t counted = counted_by(&a05.base.stream);
    fathom_a05_auto_deinit(&a05);
    return counted;
}

static fathom_sensor_t begin_hps(void)
{
    const fathom_hps167s_auto_config_t config = {.stale_us = STALE_US, .address = rig.device.address};
    assert_int_equal(fathom_hps167s_auto_init(&hps, &rig.line, &config), FATHOM_OK);
    return fathom_hps167s_auto_sensor(&hps);
}

static damage_counted_t end_hps(void)
{
    const damage_counted_t counted = {.frames = (unsigned)hps.sequence + hps.implausible + hps.missed,
                                      .dropped_bytes = hps.dropped_bytes,
                                      .damaged = hps.damaged};
    fathom_hps167s_auto_deinit(&hps);
    return counted;
}

static fathom_sensor_t begin_controlled(void)
{
    const fathom_output_t trigger = fathom_output_line_break(&rig.line);
    const fathom_a16_controlled_config_t config = {.gap_us = rig.line_parts.gap_us};
    assert_int_equal(fathom_a16_controlled_init(&controlled, &rig.line, &trigger, &config), FATHOM_OK);
    return fathom_a16_controlled_sensor(&controlled);
}

static damage_counted_t end_controlled(void)
{
    const damage_counted_t counted = counted_by(&controlled.stream);
    assert_int_equal(fathom_a16_controlled_deinit(&controlled), FATHOM_OK);
    return counted;
}

static const listener_t a16_auto_listener = {SECOND_A16_AUTO, STALE_US, begin_a16, end_a16};
static const listener_t a05_auto_listener = {SECOND_A05_UART, STALE_US, begin_a05, end_a05};
static const listener_t hps167s_auto_listener = {SECOND_HPS167S, STALE_US, begin_hps, end_hps};
static const listener_t a16_controlled_listener = {SECOND_A16_CONTROLLED, 0, begin_controlled,
                                                   end_controlled};

/* The target moves every second, so that an old frame shows. */
static void live(const fathom_sensor_t *sensor, unsigned seconds)
{
    static const int32_t there_mm[] = {754, 1953, 3000, 511, 4460, 280};
    for (unsigned i = 0; i != seconds; i++) {
        const int32_t mm = there_mm[i % 6];
        rig_scene(&rig, mm, mm + 100, SECOND_NOTHING, mm + 33);
        damage_poll(sensor, SECOND_US);
    }
}

/* The rates of damage: 5 to 300 of 1000 bytes, or three times as many of 1000 frames. */
static uint32_t of_1000(rig_damage_t damage, uint64_t seed)
{
    static const uint32_t bytes[] = {5, 20, 100, 300};
    return bytes[seed % 4] * (damage == RIG_ONE_BIT ? 3 : 1);
}

static fathom_sensor_t begin(const listener_t *listener, uint64_t seed)
{
    static const second_override_t sends[] = {{"hps_unasked", 1}, {"hps_auto_out", 255}};
    const bool is_hps = listener->kind == SECOND_HPS167S;
    const second_config_t config = {.kind = listener->kind,
                                    .seed = seed,
                                    .fitted = seed % 3 == 0 ? 0x0F : (uint8_t)(1 + seed % 15),
                                    .no_misprints = true,
                                    .overrides = is_hps ? sends : NULL,
                                    .override_count = is_hps ? 2 : 0};
    rig_open(&rig, &config);
    rig.set = rig.device.line;
    rig.sees_parity =
        is_hps && seed % 2 == 1; /* the even seeds: as behind an adapter that reports no parity errors */
    const fathom_sensor_t sensor = listener->begin();
    judge_begin("damage");
    damage_begin(listener->stale_us);
    rig_power(&rig, true);
    return sensor;
}

/* Returns true if a stream may join the halves of two frames, because it sees no silence between them (stream.h, rule 4). */
static bool joins_halves(rig_damage_t damage) { return damage == RIG_LOSSES && rig.loop == RIG_EVERY_20_MS; }

/* Without damage, with damage (RIG_UNHARMED: with zeros in place of all bytes), without power. */
static void under(const listener_t *listener, rig_damage_t damage)
{
    const char *from = getenv("FATHOM_SEED");
    uint64_t seed = from != NULL ? strtoull(from, NULL, 10) : 0;
    const uint64_t last = from != NULL ? seed : suite_is_long ? 1000 : 30;
    unsigned damaged_frames = 0, damage_errors = 0, stale_errors = 0;
    judge = (judge_t){.rig = &rig};
    for (; seed <= last; seed++) {
        const fathom_sensor_t sensor = begin(listener, seed);
        if (joins_halves(damage)) {
            (void)listener->end();
            continue;
        }
        live(&sensor, 15);
        rig_damage(&rig, damage, of_1000(damage, seed));
        if (damage == RIG_UNHARMED) rig_zeros(&rig, 10 * SECOND_US);
        live(&sensor, 15);
        rig_power(&rig, false);
        live(&sensor, 15);
        damage_end(listener->end());
        assert_int_equal(second_state(&rig.device).lost, 0);
        damaged_frames += damage_heard.frames[FRAME_DAMAGED];
        damage_errors += damage_heard.damage_errors;
        stale_errors += damage_heard.stale_errors;
    }
    assert_int_equal(judge.wrong, 0);
    if (from == NULL) assert_true(damaged_frames != 0 && damage_errors != 0 && stale_errors != 0);
}

static void under_all(const listener_t *listener)
{
    under(listener, RIG_ONE_BIT);
    under(listener, RIG_SOFT_UART);
    under(listener, RIG_UNHARMED);
    /* hps167s_auto joins the halves of two equal frames: the CRC of the result is right. */
    if (listener->kind != SECOND_HPS167S) under(listener, RIG_LOSSES);
}

#define IS_SEEN(...)                                                                                         \
    do {                                                                                                     \
        judge.wrong = 0;                                                                                     \
        __VA_ARGS__;                                                                                         \
        assert_true(judge.wrong > 0);                                                                        \
    } while (0)

/* A sensor that returns a prepared outcome once. */
static fathom_status_t prepared_status;
static fathom_sample_t prepared_sample;

static fathom_status_t poll_prepared(void *ctx, fathom_sample_t *sample)
{
    const fathom_status_t status = prepared_status;
    (void)ctx;
    *sample = prepared_sample;
    prepared_status = FATHOM_PENDING;
    return status;
}

static uint32_t prepared_due_us(void *ctx)
{
    (void)ctx;
    return SECOND_US;
}

static void outcome_after(fathom_status_t status, uint64_t us)
{
    const fathom_sensor_t sensor = {.poll = poll_prepared, .due_us = prepared_due_us};
    prepared_status = FATHOM_PENDING;
    damage_poll(&sensor, us);
    prepared_status = status;
    damage_poll(&sensor, 1);
}

TEST(the_judge_sees_a_damaged_reading_a_false_error_and_damage_that_is_not_counted)
{
    judge = (judge_t){.rig = &rig};
    (void)begin(&a16_auto_listener, 0);
    rig_scene(&rig, 754, 754, 754, 754);
    outcome_after(FATHOM_PENDING, 20 * SECOND_US);
    rig_damage(&rig, RIG_SOFT_UART, 1000);
    outcome_after(FATHOM_ERR_CHECKSUM, 3 * SECOND_US);
    IS_SEEN(outcome_after(FATHOM_ERR_STALE, 3 * SECOND_US)); /* damaged bytes arrived */
    IS_SEEN(outcome_after(FATHOM_ERR_MALFORMED, 3 * SECOND_US));
    IS_SEEN(outcome_after(FATHOM_ERR_PORT, 3 * SECOND_US));
    IS_SEEN(outcome_after(FATHOM_PENDING, 5 * SECOND_US)); /* longer than stale_us */
    const second_event_t *frame = second_log_at(&rig.device, second_log_count(&rig.device) - 1);
    prepared_sample = (fathom_sample_t){.kind = FATHOM_TARGET,
                                        .distance_mm = 754,
                                        .raw = 754,
                                        .probe = 1,
                                        .time_us = rig_clock_us(&rig, frame->end_us)};
    assert_int_equal(frame->kind, SECOND_EVENT_MEASUREMENT);
    assert_int_equal(frame->sent[0], 754);
    IS_SEEN(outcome_after(FATHOM_OK, 0)); /* the device sent this, but a damaged frame arrived */
    rig_power(&rig, false);
    outcome_after(FATHOM_ERR_CHECKSUM, SECOND_US);
    IS_SEEN(outcome_after(FATHOM_ERR_CHECKSUM, 3 * SECOND_US)); /* no byte arrived */
    const unsigned clean = damage_heard.frames[FRAME_CLEAN], damaged = damage_heard.frames[FRAME_DAMAGED];
    const unsigned dropped = (unsigned)rig.received_count - 4 * clean;
    assert_int_equal(damage_heard.frames[FRAME_UNSEEN], 0);
    judge.wrong = 0;
    damage_end((damage_counted_t){clean, dropped, damaged});
    assert_int_equal(judge.wrong, 0);
    IS_SEEN(damage_end((damage_counted_t){clean + 1, dropped - 4, damaged}));
    IS_SEEN(damage_end((damage_counted_t){clean - 2, dropped + 8, damaged}));
    IS_SEEN(damage_end((damage_counted_t){clean, 0, damaged}));
    IS_SEEN(damage_end((damage_counted_t){clean, dropped + 1, damaged}));
    IS_SEEN(damage_end((damage_counted_t){clean, dropped, 0}));
    IS_SEEN(damage_end((damage_counted_t){clean, dropped, damaged + 2}));
}

TEST(a16_auto_reads_around_damage) { under_all(&a16_auto_listener); }
TEST(a05_auto_reads_around_damage) { under_all(&a05_auto_listener); }
TEST(hps167s_auto_reads_around_damage) { under_all(&hps167s_auto_listener); }
TEST(a16_controlled_reads_around_damage) { under_all(&a16_controlled_listener); }
