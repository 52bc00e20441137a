/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_modbus.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_loop.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "suite.h"

/*
 * 64 lines in one loop, in simulated time: half of them HPS-167S, half A16, whose responses come late, damaged, in two
 * parts or not at all, and whose ports are lost again and again. Every distance tells which line it is of and when it was
 * measured.
 */
enum { LINES = 64, STEP_US = 1000, PHASE_US = 16384, PHASES = 128, BASE_MM = 1000 };

/* The time-outs, and in phases what those and a loop and a port take. A response that is late by LATE, which comes in the
 * quarantine, would be older. */
enum { HPS_TIMEOUT_US = 200000, HPS_LATE_US = 300000, HPS_OLDEST = 15 };
enum { A16_TIMEOUT_US = 300000, A16_LATE_US = 450000, A16_OLDEST = 21 };

typedef struct {
    fathom_loop_source_t source; /* first */
    unsigned number;
    bool is_plugged;
    bool is_broken; /* the port that was opened last is */
    fathom_sim_line_t wire;
    fathom_sim_uart_t end;
    fathom_uart_t inner, uart;
    fathom_sim_a16_t a16;
    fathom_sim_hps167s_t hps;
    fathom_sim_fault_t fault;
    fathom_line_parts_t config;
    fathom_line_t line;
    uint8_t frame[32];
    fathom_modbus_t modbus;
    fathom_a16_modbus_t a16_driver;
    fathom_hps167s_t hps_driver;
    fathom_loop_sensor_t sensor;
    unsigned readings, errors, port_errors, losses;
    uint64_t unplugged_us, opened_us, heard_us, longest_us;
} place_t;

static place_t places[LINES];
static fathom_sim_clock_t time;
static fathom_clock_t clock_of_time;
static fathom_loop_t loop;
static uint64_t now_us;
static uint32_t seed;
static unsigned transactions;

static uint32_t draw(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

static bool is_a16(const place_t *place) { return place->number % 2 != 0; }

/* ---- the world ---- */

static int32_t distance(void *ctx, uint8_t probe, uint32_t at_us)
{
    const place_t *const place = ctx;
    return (int32_t)(BASE_MM + place->number * PHASES + at_us / PHASE_US % PHASES);
}

static bool is_gone(const place_t *place) { return !place->is_plugged || place->is_broken; }

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const place_t *const place = ctx;
    return is_gone(place) ? -1 : place->inner.read(place->inner.ctx, bytes, capacity, rx);
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const place_t *const place = ctx;
    return is_gone(place) ? -1 : place->inner.write(place->inner.ctx, bytes, length);
}

static bool port_sent(void *ctx)
{
    const place_t *const place = ctx;
    return is_gone(place) || place->inner.sent(place->inner.ctx);
}

static uint32_t port_leaves_in_us(void *ctx)
{
    const place_t *const place = ctx;
    return place->inner.leaves_in_us(place->inner.ctx);
}

/* ---- the source ---- */

static place_t *of(fathom_loop_source_t *source) { return (place_t *)source; }

static bool open_place(fathom_loop_source_t *source)
{
    place_t *const place = of(source);
    uint8_t byte;
    fathom_rx_t rx;
    if (!place->is_plugged) return false;
    while (place->inner.read(place->inner.ctx, &byte, 1, &rx) > 0) {
    } /* as fathom_posix_open */
    place->is_broken = false;
    place->opened_us = place->heard_us = now_us;
    return true;
}

static int no_fd(const fathom_loop_source_t *source) { return -1; }
static bool poll_place(fathom_loop_source_t *source)
{
    return fathom_line_poll(&of(source)->line) != FATHOM_ERR_PORT;
}
static uint32_t due_us(fathom_loop_source_t *source) { return fathom_line_due_us(&of(source)->line); }

static void take(void *ctx, fathom_status_t status, const fathom_sample_t *sample)
{
    place_t *const place = ctx;
    transactions++;
    if (status == FATHOM_ERR_PORT)
        place->port_errors++;
    else if (status != FATHOM_OK)
        place->errors++;
    if (status != FATHOM_OK) return;
    place->readings++;
    if (now_us - place->heard_us > place->longest_us) place->longest_us = now_us - place->heard_us;
    place->heard_us = now_us;
    assert_int_equal(sample->kind, FATHOM_TARGET);
    assert_int_equal((sample->distance_mm - BASE_MM) / PHASES, place->number);
    const unsigned measured = (sample->distance_mm - (unsigned)BASE_MM) % PHASES;
    assert_in_range((time.now_us / PHASE_US - measured) % PHASES, 0, is_a16(place) ? A16_OLDEST : HPS_OLDEST);
}

/* ---- the loop's time ---- */

static uint64_t loop_now_us(void *ctx) { return now_us; }

/* Now and then a port is lost. */
static void lose_one(void)
{
    place_t *const place = &places[draw(LINES)];
    if (draw(100) != 0) return;
    if (place->is_plugged) {
        place->is_plugged = false;
        place->is_broken = true;
        place->losses++;
        place->unplugged_us = now_us;
        fathom_loop_wake(&place->source); /* the hang-up */
    }
}

static void sleep_a_step(void *ctx, fathom_loop_t *of_loop, uint32_t max_us)
{
    const uint32_t by_us = max_us < STEP_US ? max_us : STEP_US;
    fathom_sim_clock_advance(&time, by_us);
    now_us += by_us;
    lose_one();
    for (unsigned i = 0; i != LINES; i++) {
        place_t *const place = &places[i];
        if (!place->is_plugged && now_us - place->unplugged_us > draw(3000000)) place->is_plugged = true;
        if (place->wire.waiting != 0) fathom_loop_wake(&place->source);
    }
}

/* ---- setting up ---- */

static void add_faults(place_t *place, fathom_sim_device_t *device)
{
    static const struct {
        uint8_t kind;
        uint32_t us;
    } kinds[] = {
        {FATHOM_SIM_FAULT_FLIP_BIT, 0}, {FATHOM_SIM_FAULT_FLIP_BYTE, 0}, {FATHOM_SIM_FAULT_DROP, 0},
        {FATHOM_SIM_FAULT_INSERT, 0},   {FATHOM_SIM_FAULT_TRUNCATE, 0},  {FATHOM_SIM_FAULT_SPLIT, 10000},
        {FATHOM_SIM_FAULT_LATE, 0},     {FATHOM_SIM_FAULT_SILENCE, 0},   {FATHOM_SIM_FAULT_NOISE, 0}};
    fathom_sim_fault_init(&place->fault, place->number + 1);
    for (size_t i = 0; i != sizeof kinds / sizeof kinds[0]; i++) {
        fathom_sim_fault_rule_t *const rule = fathom_sim_fault_add(&place->fault, kinds[i].kind, 5000, 0);
        if (kinds[i].us != 0) rule->us = kinds[i].us;
        if (rule->kind == FATHOM_SIM_FAULT_LATE) rule->us = is_a16(place) ? A16_LATE_US : HPS_LATE_US;
    }
    fathom_sim_fault_attach(&place->fault, &place->wire, device);
    fathom_sim_attach(&place->wire, device, time.now_us);
}

static void add_place(unsigned number)
{
    static const fathom_loop_kind_t kind = {
        .open = open_place, .fd = no_fd, .poll = poll_place, .due_us = due_us};
    static const fathom_line_settings_t infrared = {19200, FATHOM_PARITY_EVEN, 1};
    static const fathom_line_settings_t ultrasonic = {9600, FATHOM_PARITY_NONE, 1};
    place_t *const place = &places[number];
    const fathom_sim_scene_t scene = {.distance = distance, .ctx = place};
    place->number = number;
    place->is_plugged = true;
    fathom_sim_line_init(&place->wire, is_a16(place) ? &ultrasonic : &infrared, time.now_us);
    fathom_sim_uart_init(&place->end, &place->wire, &time);
    place->end.knows = 0; /* as a tty, which says nothing of single bytes */
    place->inner = fathom_sim_uart(&place->end);
    if (is_a16(place)) {
        fathom_sim_a16_init(&place->a16,
                            &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_MODBUS, .scene = scene});
        add_faults(place, &place->a16.device);
    } else {
        fathom_sim_hps167s_init(&place->hps, &(fathom_sim_hps167s_config_t){.scene = scene});
        add_faults(place, &place->hps.device);
    }
    const fathom_uart_t port = {.read = port_read,
                                .write = port_write,
                                .sent = port_sent,
                                .leaves_in_us = port_leaves_in_us,
                                .ctx = place};
    place->uart = fathom_loop_uart(&place->source, &port);
    place->source.kind = &kind;
    place->source.reads_all = true;
    place->config = (fathom_line_parts_t){.uart = &place->uart,
                                          .clock = &clock_of_time,
                                          .frame = place->frame,
                                          .frame_size = sizeof place->frame,
                                          .find_echo = fathom_line_find_echo,
                                          .silence_us = 4011,
                                          .gap_us = 25000};
    assert_int_equal(fathom_line_init(&place->line, &place->config), FATHOM_OK);
    place->modbus = fathom_modbus_client(&place->line);
    fathom_sensor_t sensor;
    if (is_a16(place)) {
        assert_int_equal(
            fathom_a16_modbus_init(&place->a16_driver, &place->modbus,
                                   &(fathom_a16_modbus_config_t){.modbus.timeout_us = A16_TIMEOUT_US,
                                                                 .value = FATHOM_REAL_TIME}),
            FATHOM_OK);
        sensor = fathom_a16_modbus_sensor(&place->a16_driver);
    } else {
        assert_int_equal(fathom_hps167s_init(&place->hps_driver, &place->modbus,
                                             &(fathom_hps167s_config_t){.modbus.timeout_us = HPS_TIMEOUT_US}),
                         FATHOM_OK);
        sensor = fathom_hps167s_sensor(&place->hps_driver);
    }
    fathom_loop_add(&loop, &place->source);
    fathom_loop_read(&place->source, &place->sensor, sensor, take, place);
}

TEST(every_one_of_64_lines_goes_on_and_no_reading_is_wrong)
{
    const unsigned wanted = suite_is_long ? 1000000 : 100000;
    const fathom_loop_config_t config = {.now_us = loop_now_us, .sleep = sleep_a_step};
    memset(places, 0, sizeof places);
    seed = 1;
    transactions = 0;
    now_us = ((uint64_t)1 << 32) - 1000000;
    fathom_sim_clock_init(&time, (uint32_t)now_us, 0);
    clock_of_time = fathom_sim_clock(&time);
    assert_int_equal(fathom_loop_init(&loop, &config), FATHOM_POSIX_OK);
    for (unsigned i = 0; i != LINES; i++) add_place(i);
    while (transactions < wanted) fathom_loop_step(&loop, FATHOM_NO_DEADLINE);

    unsigned sum[2] = {0, 0};
    for (unsigned i = 0; i != LINES; i++) sum[i % 2] += places[i].readings;
    for (unsigned i = 0; i != LINES; i++) {
        const place_t *const place = &places[i];
        assert_true(place->losses > 0);
        assert_in_range(place->port_errors, 1, place->losses);
        assert_true(place->errors > 0);
        /* None gets less than half of what its kind gets, and none waits for longer than pauses and time-outs. */
        assert_true(place->readings > sum[i % 2] / (LINES / 2) / 2);
        assert_true(place->longest_us < 10000000);
    }
    fathom_loop_deinit(&loop);
}
