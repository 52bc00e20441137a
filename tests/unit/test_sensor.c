/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fathom/engine/wait.h"
#include "fathom/hal.h"

/* A driver that is pending some times and then says what it has, and what it was told to be due in. */
typedef struct {
    fathom_status_t status;
    uint32_t due_us;
    unsigned pendings;
    fathom_sample_t *sample; /* that it was called with */
    unsigned polls;
    unsigned dues;
    unsigned idles;
    uint32_t told_us[8];
} driver_t;

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    driver_t *const driver = ctx;
    driver->polls++;
    driver->sample = sample;
    if (driver->polls <= driver->pendings) return FATHOM_PENDING;
    if (driver->status == FATHOM_OK) sample->distance_mm = 1953;
    return driver->status;
}

static uint32_t due_us(void *ctx)
{
    driver_t *const driver = ctx;
    driver->dues++;
    return driver->due_us;
}

/* Another time each poll, and without a deadline before the first. */
static uint32_t changing_us(void *ctx)
{
    const driver_t *const driver = ctx;
    return driver->polls == 1 ? FATHOM_NO_DEADLINE : driver->due_us + driver->polls;
}

static void idle(void *ctx, uint32_t max_us)
{
    driver_t *const driver = ctx;
    assert_true(driver->idles < COUNT(driver->told_us));
    driver->told_us[driver->idles++] = max_us;
    assert_int_equal(driver->idles, driver->polls); /* once after each poll */
}

/* ---- fathom_poll and fathom_due_us ---- */

static const fathom_status_t all[] = {FATHOM_OK,
                                      FATHOM_PENDING,
                                      FATHOM_ERR_ARGUMENT,
                                      FATHOM_ERR_PORT,
                                      FATHOM_ERR_NO_RESPONSE,
                                      FATHOM_ERR_CHECKSUM,
                                      FATHOM_ERR_EXCEPTION,
                                      FATHOM_ERR_MALFORMED,
                                      FATHOM_ERR_STALE,
                                      FATHOM_ERR_CANCELLED,
                                      FATHOM_ERR_BUSY,
                                      FATHOM_ERR_CAPACITY,
                                      FATHOM_ERR_ECHO,
                                      FATHOM_ERR_UNSUPPORTED,
                                      FATHOM_ERR_WARMING_UP,
                                      FATHOM_ERR_UNCONFIRMED,
                                      FATHOM_ERR_IN_USE};

TEST(poll_hands_on_what_the_driver_says)
{
    for (unsigned i = 0; i != COUNT(all); i++) {
        driver_t driver = {.status = all[i]};
        const fathom_sensor_t sensor = {poll, due_us, &driver};
        fathom_sample_t sample;
        memset(&sample, GUARD, sizeof sample);
        assert_int_equal(fathom_poll(&sensor, &sample), all[i]);
        assert_ptr_equal(driver.sample, &sample);
        assert_int_equal(driver.polls, 1);
        assert_int_equal(driver.dues, 0);
        if (all[i] == FATHOM_OK)
            assert_int_equal(sample.distance_mm, 1953);
        else
            assert_guard(&sample, sizeof sample);
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
    for (unsigned i = 0; i != COUNT(cases); i++) {
        driver_t drivers[3];
        fathom_sensor_t sensors[3];
        for (unsigned n = 0; n != 3; n++) {
            drivers[n] = (driver_t){.due_us = cases[i][n]};
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
    static const uint32_t rows[][3] = {
        {10, 4, 6}, {4, 4, 0}, {0, UINT32_MAX, 1}, {5, UINT32_MAX - 4, 10}, {3, 4, UINT32_MAX}};
    for (unsigned i = 0; i != COUNT(rows); i++)
        assert_true(fathom_elapsed_us(rows[i][0], rows[i][1]) == rows[i][2]);
}

TEST(a_count_down_stops_at_0)
{
    static const uint32_t rows[][3] = {{10, 0, 10}, {10, 9, 1}, {1, 1, 0}, {0, 0, 0}, {3, UINT32_MAX, 0}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        uint32_t left_us = rows[i][0];
        assert_int_equal(fathom_count_down(&left_us, rows[i][1]), rows[i][2] == 0);
        assert_int_equal(left_us, rows[i][2]);
    }
}

/* ---- fathom_wait ---- */

/* What it returns when the driver has been pending so often; without OK it writes nothing. */
static fathom_status_t waits(driver_t *driver, void (*hook)(void *ctx, uint32_t max_us))
{
    const fathom_sensor_t sensor = {poll, changing_us, driver};
    fathom_sample_t sample;
    memset(&sample, GUARD, sizeof sample);
    const fathom_status_t status = fathom_wait(&sensor, &sample, hook, hook != NULL ? driver : NULL);
    if (status == FATHOM_OK)
        assert_int_equal(sample.distance_mm, 1953);
    else
        assert_guard(&sample, sizeof sample);
    assert_int_equal(driver->polls, driver->pendings + 1);
    assert_int_equal(driver->idles, hook != NULL ? driver->pendings : 0);
    return status;
}

TEST(a_reading_that_is_there_is_returned_without_idling)
{
    driver_t driver = {.status = FATHOM_OK};
    assert_int_equal(waits(&driver, idle), FATHOM_OK);
}

TEST(it_idles_until_the_driver_is_due_and_no_longer)
{
    driver_t driver = {.pendings = 3, .status = FATHOM_OK, .due_us = 1000};
    assert_int_equal(waits(&driver, idle), FATHOM_OK);
    assert_true(driver.told_us[0] == FATHOM_NO_DEADLINE);
    assert_int_equal(driver.told_us[1], 1002);
    assert_int_equal(driver.told_us[2], 1003);
}

TEST(without_an_idle_hook_it_spins)
{
    driver_t driver = {.pendings = 1000, .status = FATHOM_OK};
    assert_int_equal(waits(&driver, NULL), FATHOM_OK);
}
