/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake.h"
#include "fathom/sensor/a16_modbus.h"
#include "fathom_loop.h"

/* fathom_loop.h: each turn of a source polls its line once, however many sensors the line has. */
enum { UNITS = 8, TIMEOUT_US = 100000 };

static fake_t fake;
static fathom_loop_t loop;
static fathom_line_t line;
static fathom_loop_source_t source;
static fathom_modbus_t modbus;
static fathom_a16_modbus_t drivers[UNITS];
static fathom_loop_sensor_t nodes[UNITS];
static unsigned outcomes;

static uint64_t now_us(void *ctx) { return fake.now_us; }

static void sleep_us(void *ctx, fathom_loop_t *of, uint32_t max_us) { fake.now_us += max_us; }

static int no_fd(const fathom_loop_source_t *of) { return -1; }

static bool poll_line(fathom_loop_source_t *of) { return fathom_line_poll(&line) != FATHOM_ERR_PORT; }

static uint32_t line_due_us(fathom_loop_source_t *of) { return fathom_line_due_us(&line); }

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    assert_int_equal(status, FATHOM_ERR_NO_RESPONSE);
    outcomes++;
}

TEST(a_turn_with_eight_sensors_reads_the_port_once)
{
    static const fathom_loop_kind_t kind = {.fd = no_fd, .poll = poll_line, .due_us = line_due_us};
    static uint8_t frame[32];
    static fathom_line_parts_t config;
    fake_init(&fake);
    config = (fathom_line_parts_t){.uart = &fake.uart,
                                   .clock = &fake.clock,
                                   .frame = frame,
                                   .frame_size = sizeof frame,
                                   .echo = FATHOM_LINE_ECHO_OFF};
    assert_int_equal(fathom_line_init(&line, &config), FATHOM_OK);
    assert_int_equal(fathom_line_poll(&line), FATHOM_PENDING);
    modbus = fathom_modbus_client(&line);
    assert_int_equal(fathom_loop_init(&loop, &(fathom_loop_config_t){.now_us = now_us, .sleep = sleep_us}),
                     FATHOM_POSIX_OK);
    source = (fathom_loop_source_t){.kind = &kind};
    fathom_loop_add(&loop, &source);
    for (uint8_t i = 0; i != UNITS; i++) {
        const fathom_a16_modbus_config_t unit = {.modbus.address = (uint8_t)(i + 1),
                                                 .modbus.timeout_us = TIMEOUT_US};
        assert_int_equal(fathom_a16_modbus_init(&drivers[i], &modbus, &unit), FATHOM_OK);
        fathom_loop_read(&source, &nodes[i], fathom_a16_modbus_sensor(&drivers[i]), take, NULL);
    }
    outcomes = 0;
    while (outcomes != UNITS) {
        const unsigned before = fake.reads;
        const unsigned outcomes_before = outcomes;
        fake.now_us++;
        fathom_loop_step(&loop, FATHOM_NO_DEADLINE);
        /* A sensor that has returned an outcome is polled again, until it returns FATHOM_PENDING. */
        assert_in_range(fake.reads - before, 0, 1 + (outcomes - outcomes_before));
    }
    fathom_loop_deinit(&loop);
}
