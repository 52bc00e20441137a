/* SPDX-License-Identifier: MIT */
#include "fathom/engine/dyp_client.h"
#include "fathom/engine/line_pins.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_controlled.h"
#include "fathom/sensor/a16_rs232.h"
#include "fathom/sensor/hps167_uart.h"
#include "fathom/sensor/hps167s_auto.h"
#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"
#include "wire.h"

/*
 * Every driver on a line, one or two that go together, with its commands and settings. Each reading was heard; an
 * output is written with FATHOM_OK only; when the far end falls silent, each request and each command ends.
 */
enum { SENSORS = 2, POLLS = 8, NONE = 0xFF };

static fathom_line_t line;
static fathom_line_parts_t config;
static fathom_modbus_t transport;
static fathom_sensor_t sensors[SENSORS];
static int count;
static bool is_asked; /* else they only listen */
static uint8_t only;  /* the address that a sample has; NONE: several are right */

static fathom_hps167s_t hps;
static fathom_hps167s_auto_t hps_auto;
static fathom_hps167_uart_t hps167;
static fathom_a16_modbus_t a16;
static fathom_a16_auto_t a16_auto;
static fathom_a16_rs232_t rs232;
static fathom_a16_controlled_t controlled;
static fathom_a05_modbus_t a05;
static fathom_a05_dyp_t a05_dyp;
static fathom_a05_dyp_find_t dyp_find;
static fathom_dyp_modbus_find_t modbus_find;
static fathom_a05_auto_t a05_auto;

static bool pin_level;
static void set_pin(void *ctx, bool high)
{
    (void)ctx;
    pin_level = high;
}
static const fathom_pin_t pin = {set_pin, NULL, NULL};

/* ---- commands: called until they are not PENDING ---- */

static union {
    fathom_sample_t sample;
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    uint8_t byte;
    uint16_t word;
    fathom_a16_polarity_t polarity;
    fathom_dyp_value_t value;
    uint8_t bytes[64];
} out;

typedef fathom_status_t (*command_t)(uint8_t argument);
static command_t command;
static uint8_t argument;
static unsigned commanded; /* what was heard when it began */

#define COMMAND(name, call)                                                                                  \
    static fathom_status_t name(uint8_t x)                                                                   \
    {                                                                                                        \
        (void)x; /* not all have a choice */                                                                 \
        return call;                                                                                         \
    }
COMMAND(hps_version, fathom_hps167s_get_interface_version(&hps, &out.version))
COMMAND(hps_configuration, fathom_hps167s_get_configuration(&hps, &out.configuration))
COMMAND(hps_details, fathom_hps167s_get_details(&hps, &out.details))
COMMAND(hps_temperature, fathom_hps167s_get_temperature(&hps, &out.temperature))
COMMAND(hps_warm_up, fathom_hps167s_set_warm_up_s(&hps, x))
COMMAND(hps_address, fathom_hps167s_set_address(&hps, x % 40))
COMMAND(hps_baud, fathom_hps167s_set_baud(&hps, fathom_hps167s_baud(x % 6)))
COMMAND(hps_measures, fathom_hps167s_set_measures_after_power_on(&hps, x & 1))
COMMAND(hps_termination, fathom_hps167s_set_termination(&hps, x & 1))
COMMAND(hps_all, fathom_hps167s_broadcast_termination(&hps, x & 1))
COMMAND(hps_offset, fathom_hps167s_set_distance_offset_mm(&hps, (int16_t)(x - 100)))
COMMAND(hps_load, fathom_hps167s_load_user_settings(&hps))
COMMAND(hps_filter, fathom_hps167s_set_filter_sensitivity(&hps, (int16_t)(x - 100)))
COMMAND(hps_reconnect, fathom_hps167s_set_reconnect_time_ms(&hps, x * 9u))
COMMAND(hps_restore, fathom_hps167s_restore_factory_settings(&hps))
static const command_t hps_commands[] = {hps_version,     hps_configuration, hps_details, hps_temperature,
                                         hps_warm_up,     hps_address,       hps_baud,    hps_measures,
                                         hps_termination, hps_all,           hps_offset,  hps_load,
                                         hps_filter,      hps_reconnect,     hps_restore};

COMMAND(a16_address, fathom_a16_modbus_get_address(&a16, &out.byte))
COMMAND(a16_threshold, fathom_a16_modbus_get_switch_threshold_mm(&a16, &out.word))
COMMAND(a16_set_address, fathom_a16_modbus_set_address(&a16, x))
COMMAND(a16_set_mode, fathom_a16_modbus_set_operating_mode(&a16, (fathom_a16_operating_mode_t)(x & 1)))
COMMAND(a16_polarity, fathom_a16_modbus_get_switch_polarity(&a16, &out.polarity))
COMMAND(a16_set_polarity, fathom_a16_modbus_set_switch_polarity(&a16, (fathom_a16_polarity_t)(x & 1)))
COMMAND(a16_set_threshold, fathom_a16_modbus_set_switch_threshold_mm(&a16, (uint16_t)(x * 100)))
COMMAND(a16_value, fathom_a16_modbus_get_automatic_value(&a16, &out.value))
COMMAND(a16_set_value, fathom_a16_modbus_set_automatic_value(&a16, (fathom_dyp_value_t)(x & 1)))
COMMAND(a16_measure, fathom_a16_modbus_measure(&a16, (fathom_dyp_value_t)(x & 1), &out.sample))
COMMAND(a16_zero, fathom_a16_modbus_set_address_0(&a16))
COMMAND(a16_return, fathom_a16_rs232_return_to_automatic(&rs232, &out.sample))
static const command_t a16_commands[] = {a16_address,   a16_threshold,    a16_set_address,   a16_set_mode,
                                         a16_polarity,  a16_set_polarity, a16_set_threshold, a16_value,
                                         a16_set_value, a16_measure,      a16_zero,          a16_return};

COMMAND(a05_address, fathom_a05_modbus_get_address(&a05, &out.byte))
COMMAND(a05_set_address, fathom_a05_modbus_set_address(&a05, x))
COMMAND(a05_find, fathom_dyp_modbus_find(&modbus_find, &transport, &out.byte))
static const command_t a05_commands[] = {a05_address, a05_set_address, a05_find};

COMMAND(dyp_set_address, fathom_a05_dyp_broadcast_address(&a05_dyp, x))
COMMAND(dyp_finds, fathom_a05_dyp_find(&dyp_find, &line, &out.byte))
static const command_t dyp_commands[] = {dyp_set_address, dyp_finds};

COMMAND(hps167_temperature, fathom_hps167_uart_get_temperature(&hps167, &out.word))
COMMAND(hps167_stop, fathom_hps167_uart_stop(&hps167))
static const command_t hps167_commands[] = {hps167_temperature, hps167_stop};

static const command_t *commands;
static unsigned command_count;
#define COMMANDS(table) (commands = (table), command_count = sizeof(table) / sizeof *(table))

static void go_on_with_command(void)
{
    if (command == NULL) return;
    wire_poll_begins();
    const fathom_status_t status = command(argument);
    PROMISE(status <= FATHOM_PENDING && status >= FATHOM_ERR_LINE_BUSY && status != FATHOM_ERR_STALE,
            "what a command or a setting returns");
    if (status != FATHOM_OK)
        PROMISE(fuzz_is_guard(&out, sizeof out),
                "hps167s_info.h, a16_settings.h: *out is written on OK only");
    if (status == FATHOM_OK && (command == a16_address || command == a05_address))
        PROMISE(wire_heard_register(commanded, 255, out.byte), "a16_settings.h: the address was read");
    if (status == FATHOM_OK && command == a16_threshold)
        PROMISE(wire_heard_register(commanded, 255, out.word), "a16_settings.h: the threshold was read");
    if (status == FATHOM_OK && command == a16_set_threshold)
        PROMISE(wire_heard_register(commanded, 255, (uint16_t)(argument * 100)),
                "a16_settings.h: OK: it is so");
    if (status == FATHOM_OK && command == hps_temperature)
        PROMISE(wire_heard_register(commanded, 255, (uint16_t)out.temperature.fahrenheit),
                "hps167s_info.h: #4");
    if (status == FATHOM_OK && command == a16_zero) only = 0;
    if (status != FATHOM_PENDING && status != FATHOM_ERR_BUSY) command = NULL;
}

static void begin_command(void)
{
    if (command != NULL || commands == NULL) return;
    command = commands[fuzz_byte() % command_count];
    argument = fuzz_byte();
    commanded = wire.count;
    memset(&out, FUZZ_GUARD, sizeof out);
    if (command == a16_return && count != 2) command = NULL; /* it takes both drivers */
    if (command == dyp_finds) fathom_a05_dyp_cancel(&a05_dyp);
}

static void cancel(uint8_t how)
{
    command = NULL;
    if (commands == hps_commands)
        (how & 1) != 0 ? fathom_hps167s_cancel(&hps) : fathom_hps167s_power_on(&hps);
    if (commands == hps167_commands)
        (how & 1) != 0 ? fathom_hps167_uart_cancel(&hps167) : fathom_hps167_uart_power_on(&hps167);
    if (commands == a16_commands) {
        if (count == 2) fathom_a16_rs232_cancel(&rs232);
        (how & 1) != 0 ? fathom_a16_modbus_cancel(&a16) : fathom_a16_modbus_power_on(&a16);
    }
    if (commands == a05_commands) {
        fathom_dyp_modbus_find_cancel(&modbus_find, &transport);
        (how & 1) != 0 ? fathom_a05_modbus_cancel(&a05) : fathom_a05_modbus_power_on(&a05);
    }
    if (commands == dyp_commands) {
        fathom_a05_dyp_find_cancel(&dyp_find, &line);
        (how & 1) != 0 ? fathom_a05_dyp_cancel(&a05_dyp) : fathom_a05_dyp_power_on(&a05_dyp);
    }
}

/* ---- readings ---- */

static void check_sample(const fathom_sample_t *sample)
{
    const uint16_t raw = (uint16_t)sample->raw;
    PROMISE(sample->raw <= UINT16_MAX && sample->kind >= FATHOM_TARGET && sample->kind <= FATHOM_UNKNOWN,
            "sample.h: raw, kind");
    PROMISE(sample->distance_mm == (sample->kind == FATHOM_TARGET ? raw : 0),
            "sample.h: 0 unless kind is TARGET");
    PROMISE(sample->probe >= 1 && sample->probe <= (sample->model == FATHOM_A05   ? 4
                                                    : sample->model == FATHOM_A16 ? 1
                                                                                  : 4),
            "sample.h: probe");
    PROMISE(!wire_is_future(sample->time_us), "sample.h: time_us: when the last byte came");
    bool is_heard = wire_heard_register(0, sample->address, raw);
    if (sample->address == 0)
        is_heard = is_heard || wire_heard_sum(0, 0xFF, sample->model == FATHOM_A16 ? 4 : 10, raw);
    if (sensors[0].ctx == &a05_dyp || sensors[0].ctx == &a05_dyp.base)
        is_heard = wire_heard_sum(0, 0x55, 13, raw) || wire_heard_sum(0, 0x55, 7, raw);
    if (sensors[0].ctx == &hps167) is_heard = wire_heard_hps167(raw);
    PROMISE(is_heard, "a reading that was not heard");
    const uint16_t most_mm = sample->model == FATHOM_HPS167S ? 30000
                             : sample->model == FATHOM_A05   ? 6000
                                                             : 16350;
    PROMISE(sample->distance_mm <= most_mm, "a distance that the sensor cannot measure");
}

static bool poll_one(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    bool has_outcome = false;
    for (int polls = 0; polls != POLLS; polls++) {
        memset(&sample, FUZZ_GUARD, sizeof sample);
        wire_poll_begins();
        const fathom_status_t status = fathom_poll(sensor, &sample);
        wire_poll_has_ended();
        if (status == FATHOM_PENDING || status < 0)
            PROMISE(fuzz_is_guard(&sample, sizeof sample),
                    "sensor.h: PENDING or an error: *sample is untouched");
        PROMISE(status == FATHOM_ERR_LINE_BUSY ||
                    (status <= FATHOM_PENDING && status >= FATHOM_ERR_WARMING_UP &&
                     status != FATHOM_ERR_ARGUMENT),
                "the errors of fathom_poll");
        if (is_asked)
            PROMISE(status != FATHOM_ERR_STALE || sensor != sensors, "STALE is for what sends by itself");
        if (status == FATHOM_PENDING) break;
        has_outcome = true;
        if (status != FATHOM_OK) break;
        check_sample(&sample);
    }
    return has_outcome;
}

static bool poll(void)
{
    bool has_outcome = false;
    /* a16_rs232.h: leave fathom_poll of both drivers alone meanwhile */
    for (int i = 0; i != count && command != a16_return; i++)
        has_outcome = poll_one(&sensors[i]) || has_outcome;
    go_on_with_command();
    return has_outcome;
}

/* ---- the worlds ---- */

static void add(fathom_sensor_t sensor) { sensors[count++] = sensor; }

static void add_hps(bool is_beside, uint8_t how, const fathom_modbus_config_t *modbus)
{
    const fathom_hps167s_config_t of = {.modbus = *modbus,
                                        .same_responses = how % 9,
                                        .low_word_first = (how & 16) != 0,
                                        .no_warm_up = (how & 32) != 0};
    PROMISE(fathom_hps167s_init(&hps, &transport, &of) == FATHOM_OK, "hps167s.h: init");
    add(fathom_hps167s_sensor(&hps));
    COMMANDS(hps_commands);
    if (!is_beside) return;
    PROMISE(fathom_hps167s_auto_init(&hps_auto, &line, NULL) == FATHOM_OK, "hps167s_auto.h: init");
    fathom_hps167s_auto_follow(&hps_auto, &hps);
    add(fathom_hps167s_auto_sensor(&hps_auto));
}

static void add_a16(bool is_rs232, uint8_t how, const fathom_modbus_config_t *modbus)
{
    const fathom_a16_modbus_config_t of = {.modbus = *modbus, .value = how & 1};
    PROMISE(fathom_a16_modbus_init(&a16, &transport, &of) == FATHOM_OK, "a16_modbus.h: init");
    add(fathom_a16_modbus_sensor(&a16));
    COMMANDS(a16_commands);
    if (!is_rs232) return;
    PROMISE(fathom_a16_auto_init(&a16_auto, &line, NULL) == FATHOM_OK, "a16_auto.h: init");
    add(fathom_a16_auto_sensor(&a16_auto));
    fathom_a16_rs232_init(&rs232, &a16, &a16_auto);
}

static void add_hps167(bool is_continuous, const fathom_modbus_config_t *modbus)
{
    const fathom_hps167_uart_config_t of = {.modbus = *modbus, .continuous = is_continuous};
    PROMISE(fathom_hps167_uart_init(&hps167, &line, &of) == FATHOM_OK, "hps167_uart.h: init");
    add(fathom_hps167_uart_sensor(&hps167));
    COMMANDS(hps167_commands);
}

static void add_controlled(uint8_t how)
{
    const fathom_output_t trigger =
        (how & 1) != 0 ? fathom_output_line_break(&line) : fathom_output_pin(&pin);
    PROMISE(fathom_a16_controlled_init(&controlled, &line, &trigger, NULL) == FATHOM_OK,
            "a16_controlled.h: init");
    add(fathom_a16_controlled_sensor(&controlled));
}

static void add_world(uint8_t world, uint8_t how)
{
    fathom_modbus_config_t modbus = {.retries = how >> 7};
    modbus.line_settings = (how & 64) != 0 ? &wire_settings[1] : NULL;
    const fathom_a05_auto_config_t of_a05_auto = {.probes = how % 16};
    const fathom_a05_modbus_config_t of_a05 = {.modbus = modbus, .probes = how % 16};
    const fathom_a05_dyp_config_t of_dyp = {.modbus = modbus, .probes = how % 16};
    is_asked = world < 6 || world == 9;
    switch (world) {
    case 0:
    case 1:
        add_hps(world == 1, how, &modbus);
        break;
    case 2:
    case 3:
        add_a16(world == 3, how, &modbus);
        break;
    case 4:
        PROMISE(fathom_a05_modbus_init(&a05, &transport, &of_a05) == FATHOM_OK, "a05_modbus.h: init");
        add(fathom_a05_modbus_sensor(&a05));
        COMMANDS(a05_commands);
        break;
    case 5:
        PROMISE(fathom_a05_dyp_init(&a05_dyp, &line, &of_dyp) == FATHOM_OK, "a05_dyp.h: init");
        add(fathom_a05_dyp_sensor(&a05_dyp));
        COMMANDS(dyp_commands);
        break;
    case 6:
        PROMISE(fathom_a05_auto_init(&a05_auto, &line, &of_a05_auto) == FATHOM_OK, "a05_auto.h: init");
        add(fathom_a05_auto_sensor(&a05_auto));
        break;
    case 7:
        PROMISE(fathom_hps167s_auto_init(&hps_auto, &line, NULL) == FATHOM_OK, "hps167s_auto.h: init");
        add(fathom_hps167s_auto_sensor(&hps_auto));
        break;
    case 8:
        add_controlled(how);
        break;
    default:
        add_hps167(world == 10, &modbus);
    }
}

static void begin(void)
{
    static uint8_t frame[64];
    const uint8_t world = fuzz_byte();
    const uint8_t how = fuzz_byte();
    const bool has_marks = (how & 32) != 0;
    wire_begin((uint32_t)fuzz_word() << 16, has_marks);
    config = (fathom_line_parts_t){.uart = &wire_uart,
                                   .clock = &wire_clock,
                                   .frame = frame,
                                   .frame_size = sizeof frame,
                                   .echo = 1 + (world >> 4) % 2,
                                   .gap_us = (world & 64) != 0 ? 25000 : 0,
                                   .marks = has_marks ? fathom_line_marks : NULL};
    PROMISE(fathom_line_init(&line, &config) == FATHOM_OK, "line.h: init");
    transport = (world & 128) != 0 ? fathom_modbus_client_with_zero(&line) : fathom_modbus_client(&line);
    count = 0;
    command = NULL;
    commands = NULL;
    memset(&dyp_find, 0, sizeof dyp_find);
    memset(&modbus_find, 0, sizeof modbus_find);
    add_world(world % 16 % 11, how);
}

static uint32_t due(void)
{
    uint32_t due_us = fathom_due_us(sensors, (size_t)count);
    if (command == a16_return) due_us = fathom_a16_rs232_due_us(&rs232);
    /* a command that waits for its first call has nothing that due_us could know of */
    return command != NULL && due_us > 500000 ? 500000 : due_us;
}

/* The longest command, the configuration, has 8 requests, each with a retry, a time-out of 1 s and a quarantine of
 * twice that; a measurement under way before it, and 16 time-outs of back-off, come to it. */
static void drain(void)
{
    const uint64_t most_us = 100000000;
    uint64_t passed_us = 0;
    unsigned zeros = 0;
    bool has_outcome = false;
    wire_drain();
    for (int polls = 0; !has_outcome || command != NULL; polls++) {
        const uint32_t due_us = due();
        PROMISE(due_us != FATHOM_NO_DEADLINE, "sensor.h: due_us: a driver has something to wait for");
        PROMISE(passed_us < most_us && polls < 20000, "each attempt, and each command, ends");
        PROMISE(due_us != 0 || ++zeros < 1000, "sensor.h: due_us: 0 is not for ever");
        wire_pass(due_us);
        passed_us += due_us;
        has_outcome = poll() || has_outcome;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    begin();
    while (fuzz_more() && wire.count < WIRE_HEARD - 400) {
        const uint8_t op = fuzz_byte();
        if (op % 16 < WIRE_OPS) {
            wire_op(op);
        } else if (op % 16 == 12) {
            begin_command();
        } else if (op % 16 == 13 && op >= 0xC0) {
            cancel(op >> 4);
        } else {
            const uint32_t due_us = due();
            if (due_us != FATHOM_NO_DEADLINE) wire_pass(due_us);
        }
        if ((op & 0x80) == 0 || op % 16 >= WIRE_OPS) (void)poll();
    }
    drain();
    return 0;
}
