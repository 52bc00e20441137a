/* SPDX-License-Identifier: MIT */
/*
 * The range of each member of each configuration, as the headers state it: init accepts the least and the greatest value
 * and refuses the others with FATHOM_ERR_ARGUMENT.
 */
#include "desk.h"

#include "fathom/engine/dyp_client.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_modbus.h"
#include "fathom/sensor/hps167_uart.h"
#include "fathom/sensor/hps167s.h"

enum { ROWS = 24 };

/* 2^31 - 1 us, the longest time of any member; the two values that are refused. */
#define LONGEST 0x7FFFFFFFu
#define TOO_LONG                                                                                             \
    {                                                                                                        \
        0x80000000u, 0xFFFFFFFFu                                                                             \
    }

typedef struct {
    const char *what; /* NULL: the table ends */
    void *member;
    size_t size;
    uint32_t least, greatest;
    uint32_t refused[2]; /* both 0: every value of the type is accepted */
} range_t;

typedef struct {
    void (*prepare)(void);
    fathom_status_t (*init)(void);
    void (*deinit)(void);
    fathom_sensor_t (*sensor)(void);
    void *memory;
    size_t size;
    uint8_t frame_size; /* the least that the driver needs */
    range_t ranges[ROWS];
} driver_t;

static const fathom_modbus_t *transport;
static fathom_line_t *line;

#define DRIVER(name, on, ...)                                                                                \
    static fathom_##name##_t name;                                                                           \
    static fathom_##name##_config_t name##_config;                                                           \
    static void name##_prepare(void)                                                                         \
    {                                                                                                        \
        transport = &fake.modbus;                                                                            \
        line = &fake.line;                                                                                   \
        name##_config = (fathom_##name##_config_t){__VA_ARGS__};                                             \
        memset(&name, 0, sizeof name);                                                                       \
    }                                                                                                        \
    static fathom_status_t name##_init(void) { return fathom_##name##_init(&name, on, &name##_config); }     \
    static void name##_deinit(void) { fathom_##name##_deinit(&name); }                                       \
    static fathom_sensor_t name##_sensor(void) { return fathom_##name##_sensor(&name); }

#define ITSELF(name, needs)                                                                                  \
    .prepare = name##_prepare, .init = name##_init, .deinit = name##_deinit, .sensor = name##_sensor,        \
    .memory = &(name), .size = sizeof(name), .frame_size = needs

#define RANGE(name, its, from, to, ...)                                                                      \
    {                                                                                                        \
        .what = #its, .member = &name##_config.its, .size = sizeof name##_config.its, .least = from,         \
        .greatest = to, .refused = __VA_ARGS__                                                               \
    }
#define TIME(name, its) RANGE(name, its, 0, LONGEST, TOO_LONG)

#define MODBUS(name, last_address, ...)                                                                      \
    TIME(name, modbus.period_us), TIME(name, modbus.timeout_us), TIME(name, modbus.command_timeout_us),      \
        TIME(name, modbus.backoff_us), RANGE(name, modbus.retries, 0, 254, {255, 255}),                      \
        RANGE(name, modbus.address, 0, last_address, __VA_ARGS__)

#define FACT(name, its, from, to, ...)                                                                       \
    {                                                                                                        \
        .what = #its, .member = &name##_facts.its, .size = sizeof name##_facts.its, .least = from,           \
        .greatest = to, .refused = __VA_ARGS__                                                               \
    }

/* The prepared min_mm is 500. 1 and 5 are kinds of samples, and no meaning of a value that is no distance. */
#define MODEL(name, most)                                                                                    \
    FACT(name, min_mm, 0, most, {(most) + 1, 65535}), FACT(name, max_mm, 500, 65535, {499, 0}),              \
        FACT(name, value_fffb, 0, 8, {9, 1}), FACT(name, value_fffd, 0, 8, {9, 200}),                        \
        FACT(name, value_fffe, 0, 8, {1, 255}), FACT(name, value_ffff, 2, 4, {5, 200}),                      \
        FACT(name, value_0, 6, 8, {1, 5}), FACT(name, period_ms, 0, 65535, {0}), TIME(name, start_us)

#define DRIVER_OF_MODEL(name, on)                                                                            \
    static fathom_model_facts_t name##_facts;                                                                \
    DRIVER(name, on,                                                                                         \
           .model = (name##_facts = fathom_##name##_model, name##_facts.min_mm = 500, &name##_facts))

DRIVER_OF_MODEL(a16_modbus, transport)
DRIVER_OF_MODEL(a05_modbus, transport)
DRIVER_OF_MODEL(a05_dyp, line)
DRIVER(hps167_uart, line, .modbus.address = 0)
DRIVER(hps167s, transport, .modbus.address = 0)

static const driver_t of_a16_modbus = {
    ITSELF(a16_modbus, 7), /* address, function, count, one register, CRC */
    .ranges = {MODBUS(a16_modbus, 254, {255, 255}), RANGE(a16_modbus, modbus.address_zero, 0, 1, {0}),
               MODEL(a16_modbus, 16350), RANGE(a16_modbus, value, 0, 1, {2, 255})}};

static const driver_t of_a05_modbus = {
    ITSELF(a05_modbus, 13), /* four registers */
    .ranges = {MODBUS(a05_modbus, 254, {255, 255}), RANGE(a05_modbus, modbus.address_zero, 0, 1, {0}),
               MODEL(a05_modbus, 6000), RANGE(a05_modbus, registers, 0x0010, 0x0106, {0x0107, 0x0105}),
               RANGE(a05_modbus, registers, 0, 0x0106, {0x000F, 0x0011}),
               RANGE(a05_modbus, probes, 0, 15, {16, 255})}};

static const driver_t of_a05_dyp = {
    ITSELF(a05_dyp, 13), /* 55 AA, address, command, four distances, sum */
    .ranges = {MODBUS(a05_dyp, 254, {255, 255}), RANGE(a05_dyp, modbus.address_zero, 0, 0, {1, 1}),
               MODEL(a05_dyp, 6000), RANGE(a05_dyp, probes, 0, 15, {16, 255})}};

static const driver_t of_hps167_uart = {ITSELF(hps167_uart, 15), /* 0A 0D, 11 bytes, CRC */
                                        .ranges = {MODBUS(hps167_uart, 0, {1, 255}),
                                                   RANGE(hps167_uart, modbus.address_zero, 0, 0, {1, 1}),
                                                   TIME(hps167_uart, start_us), TIME(hps167_uart, stale_us)}};

static const driver_t of_hps167s = {
    ITSELF(hps167s, 13), /* four registers */
    .ranges = {MODBUS(hps167s, 32, {33, 255}), RANGE(hps167s, modbus.address_zero, 0, 0, {1, 1}),
               RANGE(hps167s, warm_up_s, 0, 255, {0}), RANGE(hps167s, no_warm_up, 0, 1, {0}),
               RANGE(hps167s, same_responses, 0, 8, {9, 255}), RANGE(hps167s, steps_per_degree, 0, 255, {0}),
               RANGE(hps167s, low_word_first, 0, 1, {0})}};

static int set_up(void **state)
{
    const driver_t *const driver = *state;
    desk_begin(1000);
    driver->prepare();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void put(const range_t *range, uint32_t value)
{
    if (range->size == sizeof(uint8_t))
        *(uint8_t *)range->member = (uint8_t)value;
    else if (range->size == sizeof(uint16_t))
        memcpy(range->member, &(uint16_t){(uint16_t)value}, sizeof(uint16_t));
    else
        memcpy(range->member, &value, sizeof value);
}

static void expect(const driver_t *driver, const range_t *range, uint32_t value, fathom_status_t status)
{
    driver->prepare();
    put(range, value);
    const fathom_status_t is = driver->init();
    if (is != status) fail_msg("%s %lu: %d", range->what, (unsigned long)value, is);
}

static void each_member_has_its_range(void **state)
{
    const driver_t *const driver = *state;
    for (const range_t *range = driver->ranges; range->what != NULL; range++) {
        expect(driver, range, range->least, FATHOM_OK);
        expect(driver, range, range->greatest, FATHOM_OK);
        if (range->refused[0] + range->refused[1] == 0) continue;
        expect(driver, range, range->refused[0], FATHOM_ERR_ARGUMENT);
        expect(driver, range, range->refused[1], FATHOM_ERR_ARGUMENT);
    }
    assert_int_equal(fake.polls + fake.submits + fake.cancels, 0);
}

/* The longest time-out with the longest back-off: the driver works, and nothing overflows. */
static void the_greatest_times_work(void **state)
{
    const driver_t *const driver = *state;
    fathom_sample_t sample;
    for (const range_t *range = driver->ranges; range->what != NULL; range++)
        if (range->greatest == LONGEST) put(range, LONGEST);
    assert_int_equal(driver->init(), FATHOM_OK);
    const fathom_sensor_t sensor = driver->sensor();
    for (unsigned n = 0; n != 8; n++) {
        fake.submits = 0;
        PENDS(checked_poll(&sensor, &sample));
        assert_int_equal(fake.submits, 1);
        fake_modbus_send(&fake);
        PENDS(checked_poll(&sensor, &sample));
        fake.now_us += LONGEST;
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(checked_poll(&sensor, &sample), FATHOM_ERR_NO_RESPONSE);
        assert_in_range(fathom_due_us(&sensor, 1), 0, LONGEST);
        fake.now_us += fathom_due_us(&sensor, 1);
    }
}

static void a_line_whose_frames_are_too_short_is_refused(void **state)
{
    const driver_t *const driver = *state;
    fake.parts.frame_size = (uint8_t)(driver->frame_size - 1);
    assert_int_equal(driver->init(), FATHOM_ERR_ARGUMENT);
    fake.parts.frame_size = driver->frame_size;
    assert_int_equal(driver->init(), FATHOM_OK);
}

static void a_missing_transport_or_line_and_a_line_that_is_not_initialised_are_refused(void **state)
{
    const driver_t *const driver = *state;
    static fathom_line_t blank;
    line = fake.modbus.line = &blank;
    assert_int_equal(driver->init(), FATHOM_ERR_ARGUMENT);
    line = fake.modbus.line = NULL;
    assert_int_equal(driver->init(), FATHOM_ERR_ARGUMENT);
    transport = NULL;
    assert_int_equal(driver->init(), FATHOM_ERR_ARGUMENT);
}

/* status.h, FATHOM_ERR_BUSY: "Nothing changed". */
static void a_second_init_is_refused_while_a_request_is_queued(void **state)
{
    static uint8_t before[sizeof(fathom_hps167s_t) + sizeof(fathom_a05_modbus_t)];
    const driver_t *const driver = *state;
    fathom_sample_t sample;
    assert_int_equal(driver->init(), FATHOM_OK);
    const fathom_sensor_t sensor = driver->sensor();
    PENDS(checked_poll(&sensor, &sample));
    assert_non_null(fake.request);
    assert_in_range(driver->size, 1, sizeof before);
    memcpy(before, driver->memory, driver->size);
    assert_int_equal(driver->init(), FATHOM_ERR_BUSY);
    assert_memory_equal(driver->memory, before, driver->size);
    driver->deinit();
    assert_null(fake.request);
    assert_int_equal(driver->init(), FATHOM_OK);
}

#define OF(promise, name) TEST_ROW(promise##_of_##name, promise, (void *)&of_##name)
#define ALL(promise)                                                                                         \
    OF(promise, a16_modbus)                                                                                  \
    OF(promise, a05_modbus) OF(promise, a05_dyp) OF(promise, hps167s) OF(promise, hps167_uart)

ALL(each_member_has_its_range)
ALL(the_greatest_times_work)
ALL(a_line_whose_frames_are_too_short_is_refused)
ALL(a_missing_transport_or_line_and_a_line_that_is_not_initialised_are_refused)
ALL(a_second_init_is_refused_while_a_request_is_queued)
