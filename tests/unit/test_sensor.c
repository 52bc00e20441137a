/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/hal.h"
#include "fathom/sensor.h"

typedef struct {
    fathom_status_t status;
    uint32_t due_us;
    fathom_sample_t *sample; /* that it was called with */
    unsigned polls;
    unsigned dues;
} driver_t;

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    driver_t *const driver = ctx;
    driver->polls++;
    driver->sample = sample;
    if (driver->status == FATHOM_READY) sample->distance_mm = 1953;
    return driver->status;
}

static uint32_t due_us(void *ctx)
{
    driver_t *const driver = ctx;
    driver->dues++;
    return driver->due_us;
}

TEST(poll_hands_on_what_the_driver_says)
{
    static const fathom_status_t all[] = {
        FATHOM_READY,         FATHOM_PENDING,       FATHOM_ERR_ARGUMENT,  FATHOM_ERR_PORT,
        FATHOM_ERR_NO_ANSWER, FATHOM_ERR_CHECKSUM,  FATHOM_ERR_EXCEPTION, FATHOM_ERR_MALFORMED,
        FATHOM_ERR_STALE,     FATHOM_ERR_CANCELLED, FATHOM_ERR_BUSY,      FATHOM_ERR_CAPACITY,
    };
    for (unsigned i = 0; i != sizeof all / sizeof *all; i++) {
        driver_t driver = {all[i], 0, NULL, 0, 0};
        const fathom_sensor_t sensor = {poll, due_us, &driver};
        fathom_sample_t sample;
        fathom_sample_t before;
        memset(&sample, 0xA5, sizeof sample);
        memset(&before, 0xA5, sizeof before);
        assert_int_equal(fathom_poll(&sensor, &sample), all[i]);
        assert_ptr_equal(driver.sample, &sample);
        assert_int_equal(driver.polls, 1);
        assert_int_equal(driver.dues, 0);
        if (all[i] == FATHOM_READY)
            assert_int_equal(sample.distance_mm, 1953);
        else
            assert_memory_equal(&sample, &before, sizeof before);
    }
}

TEST(no_sensor_has_no_deadline) { assert_true(fathom_due_us(NULL, 0) == FATHOM_NO_DEADLINE); }

TEST(the_first_to_have_something_to_do_decides)
{
    static const uint32_t cases[][4] = {
        {5, 7, 9, 5},
        {9, 5, 7, 5},
        {7, 9, 5, 5},
        {5, 5, 5, 5},
        {FATHOM_NO_DEADLINE, 0, 4294967294u, 0},
        {FATHOM_NO_DEADLINE, 4294967294u, FATHOM_NO_DEADLINE, 4294967294u},
        {FATHOM_NO_DEADLINE, FATHOM_NO_DEADLINE, FATHOM_NO_DEADLINE, FATHOM_NO_DEADLINE},
    };
    for (unsigned i = 0; i != sizeof cases / sizeof *cases; i++) {
        driver_t drivers[3];
        fathom_sensor_t sensors[3];
        for (unsigned n = 0; n != 3; n++) {
            drivers[n] = (driver_t){FATHOM_PENDING, cases[i][n], NULL, 0, 0};
            sensors[n] = (fathom_sensor_t){poll, due_us, &drivers[n]};
        }
        assert_true(fathom_due_us(sensors, 3) == cases[i][3]);
        assert_true(fathom_due_us(sensors + 1, 1) == cases[i][1]);
        assert_int_equal(drivers[0].polls + drivers[1].polls + drivers[2].polls, 0);
        assert_int_equal(drivers[0].dues + drivers[2].dues, 2);
        assert_int_equal(drivers[1].dues, 2);
    }
}

/* What fathom_due_us and all time-outs are built on (hal.h). */
TEST(elapsed_is_right_across_the_wrap)
{
    assert_int_equal(fathom_elapsed_us(10, 4), 6);
    assert_int_equal(fathom_elapsed_us(4, 4), 0);
    assert_int_equal(fathom_elapsed_us(0, UINT32_MAX), 1);
    assert_int_equal(fathom_elapsed_us(5, UINT32_MAX - 4), 10);
    assert_true(fathom_elapsed_us(3, 4) == UINT32_MAX);
}

TEST(a_count_down_stops_at_0)
{
    uint32_t left_us = 10;
    assert_false(fathom_run_down(&left_us, 0));
    assert_int_equal(left_us, 10);
    assert_false(fathom_run_down(&left_us, 9));
    assert_int_equal(left_us, 1);
    assert_true(fathom_run_down(&left_us, 1));
    assert_int_equal(left_us, 0);
    assert_true(fathom_run_down(&left_us, 0));
    left_us = 3;
    assert_true(fathom_run_down(&left_us, UINT32_MAX));
    assert_int_equal(left_us, 0);
}
