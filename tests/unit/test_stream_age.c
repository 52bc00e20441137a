/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/sensor/a16_auto.h"

/* stream.h, rule 6: how old a frame may be, and that no frame is made of bytes from before and after a pause. */

static const uint8_t mm_1953[] = {0xFF, 0x07, 0xA1, 0xA7}; /* A16 2(4) */

enum { STALE_US = 2000000, LATE_US = FATHOM_LINE_LATE_US };

static fathom_stream_t stream;
static uint8_t storage[FATHOM_STREAM_STORAGE(FATHOM_DYP_A16_LENGTH)];
static uint32_t start_us;

static int set_up(void **state)
{
    const fathom_stream_config_t config = {.storage = storage, .length = FATHOM_DYP_A16_LENGTH};
    memset(&stream, 0xA5, sizeof stream);
    assert_int_equal(fathom_stream_init(&stream, &config, start_us), FATHOM_OK);
    return 0;
}

/* The second round crosses the wrap of the clock at each step. */
static void begin_round(unsigned round) { start_us = round != 0 ? UINT32_MAX - 1000 : 1000; }

static const suite_t suite = {.set_up = set_up, .begin_round = begin_round, .rounds = 2};

/* Times from the start. */
static void feed(const uint8_t *bytes, uint8_t count, bool after_gap, uint32_t us)
{
    fathom_stream_feed(&stream, bytes, count, after_gap, start_us + us);
}

static void expect(uint32_t us, fathom_status_t status)
{
    assert_int_equal(fathom_stream_poll(&stream, start_us + us), status);
}

/* ---- a stream that is fed by hand ---- */

TEST(a_frame_is_returned_until_it_is_older_than_the_stale_limit_and_half_a_second)
{
    feed(mm_1953, 4, true, 10);
    expect(10 + STALE_US + LATE_US, FATHOM_OK);
    assert_int_equal(stream.time_us, start_us + 10);
    feed(mm_1953, 4, true, 5000000);
    expect(5000000 + STALE_US + LATE_US + 1, FATHOM_ERR_STALE);
    assert_int_equal(stream.counters[FATHOM_STREAM_FRAMES], 2);
    assert_int_equal(stream.counters[FATHOM_STREAM_MISSED], 1);
}

/* The bytes of the frame are no damage. */
TEST(a_frame_of_300_s_ago_is_stale_and_the_next_one_is_read)
{
    feed(mm_1953, 4, true, 10);
    expect(300000000, FATHOM_ERR_STALE);
    expect(300000001, FATHOM_PENDING);
    feed(mm_1953, 4, true, 300100000);
    expect(300105000, FATHOM_OK);
    assert_int_equal(stream.time_us, start_us + 300100000);
}

/* Less than 100 ms: the clock stands still, and nothing is old or stale for that. */
TEST(a_clock_that_was_set_back_a_little_costs_no_frame)
{
    feed(mm_1953, 4, true, 200000);
    expect(200000 - 99000, FATHOM_PENDING); /* nor is the silence over */
    assert_int_equal(fathom_stream_due_us(&stream, start_us + 200000 - 99000), 5000);
    expect(205000, FATHOM_OK);
    expect(205000 - 99000, FATHOM_PENDING);
    assert_int_equal(fathom_stream_due_us(&stream, start_us + 205000 - 99000), STALE_US);
}

TEST(the_ranges_of_the_config_are_kept)
{
    static const struct {
        uint32_t stale_us;
        uint16_t gap_us;
        fathom_status_t status;
    } rows[] = {
        {0, 0, FATHOM_OK},
        {1, 1042, FATHOM_OK},
        {0x7FFFFFFF, 65535, FATHOM_OK},
        {0x80000000, 0, FATHOM_ERR_ARGUMENT},
        {UINT32_MAX, 0, FATHOM_ERR_ARGUMENT},
        {0, 1, FATHOM_ERR_ARGUMENT},
        {0, 1041, FATHOM_ERR_ARGUMENT},
    };
    for (unsigned i = 0; i != COUNT(rows); i++) {
        const fathom_stream_config_t config = {
            .storage = storage, .length = 4, .stale_us = rows[i].stale_us, .gap_us = rows[i].gap_us};
        assert_int_equal(fathom_stream_init(&stream, &config, 0), rows[i].status);
    }
}

/* ---- a stream that listens to a line ---- */

static fathom_a16_auto_t a16;

static void begin_a16(void)
{
    rig_start(start_us);
    assert_int_equal(fathom_a16_auto_init(&a16, &rig.line, NULL), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&a16);
}

static fathom_status_t poll_after(uint32_t us)
{
    rig.fake.now_us += us;
    return rig_poll();
}

/* A logger: it reads one sample, sleeps, and the port keeps its oldest bytes. Each pause up to 2.5 s loses nothing. */
TEST(a_sleeping_logger_gets_no_sample_of_before_its_sleep)
{
    static const uint32_t sleeps_us[] = {100000, 2000000, 2400000, 2600000, 10000000, 300000000};
    for (unsigned i = 0; i != COUNT(sleeps_us); i++) {
        begin_a16();
        PENDS(poll_after(1000));
        PENDS(poll_after(5000));
        fake_receive(&rig.fake, 0, mm_1953, 4);
        const fathom_status_t first = poll_after(sleeps_us[i]);
        if (sleeps_us[i] <= STALE_US + LATE_US) {
            assert_int_equal(first, sleeps_us[i] < STALE_US ? FATHOM_PENDING : FATHOM_ERR_CHECKSUM);
            assert_int_equal(poll_after(5000), FATHOM_OK);
        } else {
            assert_int_equal(first, FATHOM_ERR_STALE);
            PENDS(poll_after(5000));
            fake_receive(&rig.fake, 0, mm_1953, 4);
            PENDS(poll_after(1000));
            assert_int_equal(poll_after(5000), FATHOM_OK);
            assert_in_range(rig.fake.now_us - rig.sample.time_us, 5000, 6000);
        }
    }
}

/* A program that sleeps until a byte arrives, or for due_us, and wakes half a second late at most: no frame is lost. */
TEST(a_sleeper_by_due_us_that_is_late_by_half_a_second_loses_no_frame)
{
    static const uint32_t periods_us[] = {100000, 1000000, 1970000};
    for (unsigned p = 0; p != COUNT(periods_us); p++) {
        begin_a16();
        rig_run(20000, 5000);
        for (unsigned n = 1; n <= 20; n++) {
            const uint32_t comes_us = periods_us[p] - LATE_US % periods_us[p];
            fake_receive(&rig.fake, comes_us, mm_1953, 4);
            for (uint32_t at_us = rig.fake.now_us + comes_us; rig.fake.now_us != at_us;) {
                const uint32_t due_us = fathom_due_us(&rig.sensor, 1);
                const uint32_t left_us = at_us - rig.fake.now_us;
                rig.fake.now_us += due_us < left_us ? due_us : left_us;
                if (rig.fake.now_us != at_us) rig_poll();
            }
            rig.fake.now_us += LATE_US - 10000; /* late */
            rig_run(10000, 5000);
            assert_int_equal(rig.samples, n);
        }
        assert_int_equal(rig.stales + rig.damaged, 0);
    }
}
