/* SPDX-License-Identifier: MIT */
#include "loop_fake.h"

#include <poll.h>

#include "suite.h"

/* Such that the 32-bit clock wraps after a second. */
#define START_US (((uint64_t)7 << 32) - 1000000u)

fake_t fake;

static uint64_t now_us(void *ctx) { return ((fake_t *)ctx)->now_us; }

static void sleep_until_something(void *ctx, fathom_loop_t *loop, uint32_t max_us)
{
    fake_wake_t *first = NULL;
    uint64_t until_us = fake.now_us + max_us;
    fake.slept_us = max_us;
    for (unsigned i = 0; i != FAKE_WAKES; i++)
        if (fake.wakes[i].source != NULL && fake.wakes[i].at_us <= until_us) {
            first = &fake.wakes[i];
            until_us = first->at_us;
        }
    if (until_us > fake.now_us) fake.now_us = until_us;
    if (first == NULL) return;
    fathom_loop_wake(first->source);
    first->source = NULL;
}

static void tell(void *ctx, const fathom_loop_source_t *source, bool is_open)
{
    assert_in_range(fake.count, 0, FAKE_NEWS - 1);
    fake_news_t *const news = &fake.news[fake.count++];
    news->source = (fathom_loop_source_t *)source;
    news->at_us = fake.now_us - fake.begin_us;
    news->is_open = is_open;
}

void fake_begin(uint32_t first_pause_us, uint32_t longest_pause_us)
{
    const fathom_loop_config_t config = {first_pause_us, longest_pause_us,      tell,
                                         now_us,         sleep_until_something, &fake};
    memset(&fake, 0, sizeof fake);
    fake.now_us = fake.begin_us = START_US;
    assert_int_equal(fathom_loop_init(&fake.loop, &config), FATHOM_POSIX_OK);
}

int fake_set_up(void **state)
{
    fake_begin(0, 0);
    return 0;
}

int fake_tear_down(void **state)
{
    fathom_loop_deinit(&fake.loop);
    return 0;
}

static fake_source_t *of(fathom_loop_source_t *source) { return (fake_source_t *)source; }
static const fake_source_t *of_const(const fathom_loop_source_t *source) { return (const void *)source; }

static bool open_it(fathom_loop_source_t *source)
{
    of(source)->opens++;
    return !of(source)->cannot_open;
}

static void close_it(fathom_loop_source_t *source) { of(source)->closes++; }
static int fd(const fathom_loop_source_t *source) { return of_const(source)->fd; }
static short events(const fathom_loop_source_t *source) { return of_const(source)->events; }

static bool poll_it(fathom_loop_source_t *source)
{
    of(source)->polls++;
    of(source)->polled_us = fake.now_us;
    of(source)->turn = ++fake.turns;
    return !of(source)->is_lost;
}

static uint32_t due_us(fathom_loop_source_t *source) { return of(source)->due_us; }
static const char *text(const fathom_loop_source_t *source) { return of_const(source)->text; }

void fake_source(fake_source_t *source)
{
    static const fathom_loop_kind_t kind = {open_it, close_it, fd, events, poll_it, due_us, text};
    memset(source, 0, sizeof *source);
    source->source.kind = &kind;
    source->fd = -1;
    source->events = POLLIN;
    source->due_us = 1000000;
    source->text = "";
}

static fathom_status_t poll_sensor(void *ctx, fathom_sample_t *sample)
{
    fake_sensor_t *const sensor = ctx;
    sensor->polls++;
    if (sensor->at == FAKE_SCRIPT || sensor->script[sensor->at] == FATHOM_PENDING) return sensor->for_ever;
    return sensor->script[sensor->at++];
}

static uint32_t sensor_due_us(void *ctx) { return ((const fake_sensor_t *)ctx)->due_us; }

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    fake_sensor_t *const sensor = ctx;
    assert_int_equal(sample != NULL, status == FATHOM_OK);
    if (status == FATHOM_OK)
        sensor->readings++;
    else if (status == FATHOM_ERR_PORT)
        sensor->port_errors++;
    else
        sensor->errors++;
    if (sensor->when_taken != NULL) sensor->when_taken(status);
}

void fake_sensor(fake_sensor_t *sensor, fake_source_t *on)
{
    memset(sensor, 0, sizeof *sensor);
    sensor->node.sensor = (fathom_sensor_t){poll_sensor, sensor_due_us, sensor};
    sensor->node.take = take;
    sensor->node.ctx = sensor;
    sensor->on = on;
    for (unsigned i = 0; i != FAKE_SCRIPT; i++) sensor->script[i] = FATHOM_PENDING;
    sensor->for_ever = FATHOM_PENDING;
    sensor->due_us = FATHOM_NO_DEADLINE;
    fathom_loop_add_sensor(&on->source, &sensor->node);
}

void fake_wake_in(fake_source_t *source, uint32_t us)
{
    unsigned i = 0;
    while (fake.wakes[i].source != NULL) i++;
    fake.wakes[i].at_us = fake.now_us + us;
    fake.wakes[i].source = &source->source;
}

void fake_pass(uint64_t us)
{
    const uint64_t until_us = fake.now_us + us;
    while (fake.now_us < until_us) {
        const uint64_t left_us = until_us - fake.now_us;
        fathom_loop_step(&fake.loop,
                         left_us < FATHOM_NO_DEADLINE ? (uint32_t)left_us : FATHOM_NO_DEADLINE - 1);
    }
}

uint64_t fake_elapsed_us(void) { return fake.now_us - fake.begin_us; }

unsigned fake_failures(const fake_source_t *source)
{
    unsigned failures = 0;
    for (unsigned i = 0; i != fake.count; i++)
        failures += fake.news[i].source == &source->source && !fake.news[i].is_open;
    return failures;
}
