/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/hal.h"
#include "fathom/wait.h"

/* A driver that is pending some times and then says what it has, and what it was told to be due in. */
typedef struct {
    unsigned pendings;
    fathom_status_t status;
    unsigned polls;
    unsigned idles;
    uint32_t due_us;
    uint32_t told_us[8];
} driver_t;

static fathom_status_t poll(void *ctx, fathom_sample_t *sample)
{
    driver_t *const driver = ctx;
    driver->polls++;
    if (driver->polls <= driver->pendings) return FATHOM_PENDING;
    if (driver->status == FATHOM_READY) sample->distance_mm = 754;
    return driver->status;
}

/* Another time each poll, and without a deadline before the first. */
static uint32_t due_us(void *ctx)
{
    const driver_t *const driver = ctx;
    return driver->polls == 1 ? FATHOM_NO_DEADLINE : driver->due_us + driver->polls;
}

static void idle(void *ctx, uint32_t max_us)
{
    driver_t *const driver = ctx;
    assert_true(driver->idles < 8);
    driver->told_us[driver->idles++] = max_us;
    assert_int_equal(driver->idles, driver->polls); /* once after each poll */
}

TEST(a_reading_that_is_there_is_returned_without_idling)
{
    driver_t driver = {.status = FATHOM_READY};
    const fathom_sensor_t sensor = {poll, due_us, &driver};
    fathom_sample_t sample = {0};
    assert_int_equal(fathom_wait(&sensor, &sample, idle, &driver), FATHOM_READY);
    assert_int_equal(sample.distance_mm, 754);
    assert_int_equal(driver.polls, 1);
    assert_int_equal(driver.idles, 0);
}

TEST(it_idles_until_the_driver_is_due_and_no_longer)
{
    driver_t driver = {.pendings = 3, .status = FATHOM_READY, .due_us = 1000};
    const fathom_sensor_t sensor = {poll, due_us, &driver};
    fathom_sample_t sample = {0};
    assert_int_equal(fathom_wait(&sensor, &sample, idle, &driver), FATHOM_READY);
    assert_int_equal(sample.distance_mm, 754);
    assert_int_equal(driver.polls, 4);
    assert_int_equal(driver.idles, 3);
    assert_true(driver.told_us[0] == FATHOM_NO_DEADLINE);
    assert_int_equal(driver.told_us[1], 1002);
    assert_int_equal(driver.told_us[2], 1003);
}

TEST(every_error_ends_it_and_leaves_the_sample_alone)
{
    for (int error = FATHOM_ERR_CAPACITY; error <= FATHOM_ERR_ARGUMENT; error++) {
        driver_t driver = {.pendings = 1, .status = (fathom_status_t)error};
        const fathom_sensor_t sensor = {poll, due_us, &driver};
        fathom_sample_t sample;
        fathom_sample_t before;
        memset(&sample, 0xA5, sizeof sample);
        memset(&before, 0xA5, sizeof before);
        assert_int_equal(fathom_wait(&sensor, &sample, idle, &driver), error);
        assert_memory_equal(&sample, &before, sizeof before);
        assert_int_equal(driver.idles, 1);
    }
}

TEST(without_an_idle_hook_it_spins)
{
    driver_t driver = {.pendings = 1000, .status = FATHOM_READY};
    const fathom_sensor_t sensor = {poll, due_us, &driver};
    fathom_sample_t sample = {0};
    assert_int_equal(fathom_wait(&sensor, &sample, NULL, NULL), FATHOM_READY);
    assert_int_equal(driver.polls, 1001);
    assert_int_equal(sample.distance_mm, 754);
}
