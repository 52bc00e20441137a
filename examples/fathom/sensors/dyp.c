/* SPDX-License-Identifier: MIT */
#include "sensors/driver.h"

/* Reading and simulating the sensors of DYP: A16 and A05. */

static bool open_response(reader_t *reader, fathom_dyp_measurement_t *measurement, uint8_t count,
                          fathom_sensor_t sensor)
{
    reader->sensor = sensor;
    reader->values = measurement->values;
    reader->value_count = count;
    reader->response = measurement;
    reader->window = measurement->facts;
    reader->sequence = &measurement->sequence;
    return true;
}

/* Returns the facts of a sensor with the settings of the user. */
static const fathom_model_facts_t *model_of(reader_t *reader, const reader_settings_t *settings,
                                            const fathom_model_facts_t *datasheet)
{
    fathom_model_facts_t *const model = &reader->model;
    const reader_window_t *const window = &settings->window;
    *model = reader->mode->row != NULL ? *reader->mode->row->facts : *datasheet;
    if (window->max_mm != 0) {
        model->min_mm = window->min_mm;
        model->max_mm = window->max_mm;
    }
    if (window->value_0 != 0) model->value_0 = window->value_0;
    if (window->value_fffd != 0) model->value_fffd = window->value_fffd;
    if (window->value_fffe != 0) model->value_fffe = window->value_fffe;
    if (window->value_ffff != 0) model->value_ffff = window->value_ffff;
    return model;
}

/* ---- with requests ---- */

static bool open_asked(reader_t *reader, fathom_dyp_modbus_t *base, fathom_sensor_t sensor)
{
    reader->dyp = base;
    reader->unit = &base->unit;
    reader->period_us = &base->unit.pace_us;
    return open_response(reader, &base->measurement, base->count, sensor);
}

static fathom_status_t a16_get_temperature(reader_t *reader, int16_t *dc)
{
    return fathom_a16_modbus_get_temperature(&reader->driver.a16_modbus, dc);
}

static bool a16_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_modbus_t *const driver = &reader->driver.a16_modbus;
    const bool has_temperature =
        settings->temperature_us != 0 && (reader->mode->takes & READER_TAKES_TEMPERATURE) != 0;
    fathom_a16_modbus_config_t config = {.modbus = driver_config(port, settings),
                                         .model = model_of(reader, settings, &fathom_a16_modbus_model),
                                         .value = settings->value};
    if (has_temperature) config.modbus.period_us = 0;
    if (fathom_a16_modbus_init(driver, &port->modbus, &config) != FATHOM_OK) return false;
    (void)open_asked(reader, &driver->base, fathom_a16_modbus_sensor(driver));
    if (has_temperature) driver_add_temperature(reader, settings, a16_get_temperature);
    return true;
}

static bool a05_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_modbus_t *const driver = &reader->driver.a05_modbus;
    const fathom_a05_modbus_config_t config = {.modbus = driver_config(port, settings),
                                               .model = model_of(reader, settings, &fathom_a05_modbus_model),
                                               .probes = settings->probes};
    return fathom_a05_modbus_init(driver, &port->modbus, &config) == FATHOM_OK &&
           open_asked(reader, &driver->base, fathom_a05_modbus_sensor(driver));
}

static bool a05_read_dyp(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_dyp_t *const driver = &reader->driver.a05_dyp;
    const fathom_a05_dyp_config_t config = {.modbus = driver_config(port, settings),
                                            .model = model_of(reader, settings, &fathom_a05_dyp_model),
                                            .probes = settings->probes};
    return fathom_a05_dyp_init(driver, &port->line, &config) == FATHOM_OK &&
           open_asked(reader, &driver->base, fathom_a05_dyp_sensor(driver));
}

/* ---- automatic output ---- */

static bool open_stream(reader_t *reader, fathom_dyp_auto_t *base, fathom_sensor_t sensor)
{
    reader->frames = base->stream.counters;
    return open_response(reader, &base->measurement, (uint8_t)(base->stream.length / 2 - 1), sensor);
}

/* Lets the port's TX go high. For real-time values, returns false with a refusal if the port cannot hold it low. */
static bool can_select(reader_t *reader, port_t *port, uint8_t value)
{
    (void)fathom_line_break(&port->line, false); /* a port that cannot end a break holds none */
    if (value != FATHOM_REAL_TIME || (port->has_wire && port->uart.set_break != NULL)) return true;
    reader->refusal =
        "this port cannot hold its TX low (a break), which selects real-time values; try another "
        "adapter, or connect the sensor's RX to its ground and leave --value out";
    return false;
}

static fathom_status_t end_a16_auto(reader_t *reader)
{
    return fathom_a16_auto_deinit(&reader->driver.a16_auto); /* RX becomes high again */
}

/* The level of the port's TX at the module's RX selects the value (A16 2(2)). */
static bool a16_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_auto_t *const driver = &reader->driver.a16_auto;
    fathom_a16_auto_config_t config = {.stale_us = settings->timeout_us,
                                       .gap_us = port_stream_gap_us(port),
                                       .model = model_of(reader, settings, &fathom_a16_auto_model),
                                       .value = settings->value};
    if (settings->has_value) {
        if (!can_select(reader, port, settings->value)) return false;
        config.select = fathom_output_line_break(&port->line);
    }
    if (fathom_a16_auto_init(driver, &port->line, &config) != FATHOM_OK) return false;
    reader->end = end_a16_auto;
    return open_stream(reader, &driver->base, fathom_a16_auto_sensor(driver));
}

/*
 * An A05 samples its RX in the first second after power-on: high selects processed values, low real-time values
 * (A05 1(1)). The reader holds the port's TX at this level until the frames of the sensor stop and start again. It reports
 * no measurement before that.
 */

/* A longer pause between two frames means that the sensor was off. No period is printed, but a "response time" of 1.5 s
 * (A05 1). */
#define OFF_US     2000000u
#define SWITCH_OFF "when it is switched on: switch its supply off for 3 seconds and on"

/* The driver holds RX low for another 1.5 s and then lets it go high. */
static fathom_status_t begin_readings(reader_t *reader)
{
    const driver_selection_t *const selection = &reader->selection;
    const fathom_status_t status =
        fathom_a05_auto_select(&reader->driver.a05_auto, (fathom_dyp_value_t)selection->value);
    if (status != FATHOM_OK) return status == FATHOM_ERR_BUSY ? FATHOM_PENDING : status;
    reader->sensor = selection->listening;
    reader->remark = "it has been switched on: readings begin";
    return FATHOM_PENDING;
}

static fathom_status_t poll_selection(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    driver_selection_t *const selection = &reader->selection;
    fathom_sample_t unselected;
    (void)sample;
    const fathom_status_t status = fathom_poll(&selection->listening, &unselected);
    const uint32_t now = driver_now_us(reader);
    if (status == FATHOM_ERR_PORT) return status;
    if (fathom_elapsed_us(now, selection->heard_us) >= OFF_US) selection->has_been_off = true;
    /* Bytes that form no frame may be noise of a module without power. */
    if (status == FATHOM_PENDING || status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM)
        return FATHOM_PENDING;
    selection->heard_us = now;
    return selection->has_been_off ? begin_readings(reader) : FATHOM_PENDING;
}

static uint32_t due_us_selection(void *ctx)
{
    const reader_t *const reader = ctx;
    return fathom_due_us(&reader->selection.listening, 1);
}

static fathom_status_t end_selection(reader_t *reader)
{
    const fathom_status_t status = fathom_a05_auto_deinit(&reader->driver.a05_auto);
    return status == FATHOM_OK ? fathom_output_set(&reader->selection.rx, FATHOM_OUTPUT_FREE) : status;
}

static bool select_value(reader_t *reader, port_t *port, uint8_t value)
{
    driver_selection_t *const selection = &reader->selection;
    const bool is_low = value == FATHOM_REAL_TIME;
    if (!can_select(reader, port, value)) return false;
    selection->rx = fathom_output_line_break(reader->line);
    if (is_low && fathom_output_set(&selection->rx, FATHOM_OUTPUT_LOW) != FATHOM_OK) return false;
    selection->listening = reader->sensor;
    selection->value = value;
    selection->heard_us = driver_now_us(reader);
    reader->sensor = (fathom_sensor_t){poll_selection, due_us_selection, reader};
    reader->end = end_selection;
    reader->remark = is_low ? "its RX is held low, which selects real-time values " SWITCH_OFF
                            : "its RX is high, which selects processed values " SWITCH_OFF;
    return true;
}

static bool a05_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_auto_t *const driver = &reader->driver.a05_auto;
    const fathom_a05_auto_config_t config = {.select = fathom_output_line_break(&port->line),
                                             .stale_us = settings->timeout_us,
                                             .gap_us = port_stream_gap_us(port),
                                             .model = model_of(reader, settings, &fathom_a05_auto_model),
                                             .probes = settings->probes};
    if (fathom_a05_auto_init(driver, &port->line, &config) != FATHOM_OK) return false;
    (void)open_stream(reader, &driver->base, fathom_a05_auto_sensor(driver));
    return !settings->has_value || select_value(reader, port, settings->value);
}

/* ---- with a trigger ---- */

/*
 * Does the module send without a trigger? A module with a trigger sends one frame for each, and the frame for the trigger
 * before may be late: at most two frames between two triggers. Three frames prove that the module sends automatically.
 * If a trigger has no frame, or two, the next trigger is held once, for a time in which an automatic module sends three.
 */
enum {
    MOST_FRAMES = 2,
    /* The slowest automatic output of a form with a trigger is that of an A02, whose maker has 500 ms for processed values.
     * In four of these times three frames are received, although the system delays one. */
    HELD_US = 2000000
};

/* A trigger has begun: judges the frames since the trigger before. Directly after the edge the whole period is left. */
static void check_frames(driver_check_t *check, fathom_trigger_t *trigger)
{
    const uint32_t held_us = check->period_us > HELD_US ? check->period_us : HELD_US;
    if (check->frames > MOST_FRAMES) {
        check->is_automatic = true;
    } else if (check->is_held) {
        check->is_automatic = false;
        check->is_proven = true;
    }
    check->is_held = check->is_automatic || (check->has_frames && check->frames != 1 && !check->is_proven);
    trigger->period_us = trigger->left_us = check->is_held ? held_us : check->period_us;
    check->frames = 0;
}

/* A frame of a module that sends automatically is no response: it can be as old as the pause between two frames. */
static fathom_status_t poll_controlled(void *ctx, fathom_sample_t *sample)
{
    reader_t *const reader = ctx;
    fathom_a16_controlled_t *const driver = &reader->driver.a16_controlled;
    driver_check_t *const check = &reader->check;
    const fathom_status_t status = fathom_a16_controlled_poll(driver, sample);
    const bool is_response = status == FATHOM_OK || status == FATHOM_ERR_MALFORMED;
    check->frames = (uint16_t)(check->frames + driver->late + is_response);
    driver->late = 0;
    if (check->frames != 0) check->has_frames = true;
    if (check->edge_us != driver->edge_us) check_frames(check, &driver->trigger);
    check->edge_us = driver->edge_us;
    return is_response && check->is_automatic ? FATHOM_ERR_NO_RESPONSE : status;
}

static uint32_t due_us_controlled(void *ctx)
{
    reader_t *const reader = ctx;
    return fathom_a16_controlled_due_us(&reader->driver.a16_controlled);
}

static fathom_status_t end_controlled(reader_t *reader)
{
    return fathom_a16_controlled_deinit(&reader->driver.a16_controlled);
}

/* A GPIO line that falls, or rises, as the module wants it. */
static fathom_output_t trigger_pin(const pins_t *pins, const fathom_model_facts_t *facts)
{
    return facts->start == FATHOM_STARTS_HIGH_PULSE ? fathom_output_inverted_pin(&pins->trigger)
                                                    : fathom_output_pin(&pins->trigger);
}

/* The trigger is a GPIO line, or a break of the port or a byte, whose TX is the module's RX. */
static bool a16_read_controlled(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_controlled_t *const driver = &reader->driver.a16_controlled;
    const fathom_model_facts_t *const facts = model_of(reader, settings, &fathom_a16_controlled_model);
    reader->trigger_byte = (fathom_line_byte_t){&port->line, facts->trigger_byte};
    const fathom_output_t trigger = facts->start == FATHOM_STARTS_BYTE
                                        ? fathom_output_line_byte(&reader->trigger_byte)
                                    : port->options.pins.chip != 0 ? trigger_pin(&port->pins, facts)
                                                                   : fathom_output_line_break(&port->line);
    const fathom_a16_controlled_config_t config = {
        .period_us = settings->period_us, .gap_us = port_stream_gap_us(port), .model = facts};
    if (fathom_a16_controlled_init(driver, &port->line, &trigger, &config) != FATHOM_OK) return false;
    reader->end = end_controlled;
    reader->frames = driver->stream.counters;
    reader->check = (driver_check_t){.period_us = driver->trigger.period_us, .edge_us = driver->edge_us};
    reader->period_us = &reader->check.period_us;
    return open_response(reader, &driver->measurement, 1,
                         (fathom_sensor_t){poll_controlled, due_us_controlled, reader});
}

static fathom_status_t end_pwm(reader_t *reader) { return fathom_a16_pwm_deinit(&reader->driver.a16_pwm); }

/* Each trigger returns one pulse (A16 1), or pulses come without one. */
static bool a16_read_pwm(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_pwm_t *const driver = &reader->driver.a16_pwm;
    const pins_t *const pins = &port->pins;
    const fathom_model_facts_t *const facts = model_of(reader, settings, &fathom_a16_pwm_model);
    const fathom_output_t output =
        facts->start == FATHOM_STARTS_ALONE ? fathom_output_none() : trigger_pin(pins, facts);
    const fathom_a16_pwm_config_t config = {.period_us = settings->period_us, .model = facts};
    if (fathom_a16_pwm_init(driver, &pins->capture, &port->clock, &output, &config) != FATHOM_OK)
        return false;
    reader->sensor = fathom_a16_pwm_sensor(driver);
    reader->end = end_pwm;
    reader->sequence = &driver->sequence;
    reader->meter = &driver->meter;
    reader->pins = pins;
    reader->window = driver->facts;
    reader->period_us = &driver->meter.trigger.period_us;
    return true;
}

/* ---- contacts ---- */

static fathom_contact_timing_t contact_timing(const port_t *port, const reader_settings_t *settings)
{
    enum { WITHOUT_EVENT_US = 1000000 }; /* A change without an event is seen within this time. */
    /* Without an interval, changes alone are readings, as far as the library allows. */
    const uint32_t repeat_us = settings->repeat_us != 0 ? settings->repeat_us : FATHOM_MAX_DURATION_US;
    return (fathom_contact_timing_t){.period_us = settings->period_us != 0 ? settings->period_us : repeat_us,
                                     .interval_us = port->pins.wakes ? WITHOUT_EVENT_US : 0,
                                     .stale_us = settings->timeout_us};
}

static bool open_contact(reader_t *reader, fathom_contact_t *contact, fathom_sensor_t sensor)
{
    reader->sensor = sensor;
    reader->sequence = &contact->sequence;
    return true;
}

/* With factory settings "less than 1 meter" is a high level (A16 4). */
static bool a16_read_switch(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a16_switch_t *const driver = &reader->driver.a16_switch;
    const fathom_a16_switch_config_t config = {.timing = contact_timing(port, settings),
                                               .negative = port->pins.wanted.near == PINS_NEAR_LOW};
    return fathom_a16_switch_init(driver, &port->pins.in, &port->clock, &config) == FATHOM_OK &&
           open_contact(reader, &driver->base, fathom_a16_switch_sensor(driver));
}

/* The contact (A05 4) goes to where the input's resistor does not pull; it is the normally open one, unless the user
 * sets that near is the other level. */
static bool a05_read_relay(reader_t *reader, port_t *port, const reader_settings_t *settings)
{
    fathom_a05_relay_t *const driver = &reader->driver.a05_relay;
    const pin_options_t *const wanted = &port->pins.wanted;
    const bool conducts_high = wanted->bias == FATHOM_GPIO_BIAS_PULL_DOWN;
    const bool is_normally_closed = wanted->near == (conducts_high ? PINS_NEAR_LOW : PINS_NEAR_HIGH);
    const fathom_a05_relay_config_t config = {
        .timing = contact_timing(port, settings),
        .wiring = is_normally_closed ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN,
        .level = conducts_high ? FATHOM_A05_RELAY_CONDUCTS_HIGH : FATHOM_A05_RELAY_CONDUCTS_LOW,
    };
    return fathom_a05_relay_init(driver, &port->pins.in, &port->clock, &config) == FATHOM_OK &&
           open_contact(reader, &driver->base, fathom_a05_relay_sensor(driver));
}

/* ---- the modes ---- */

enum { TAKES = READER_TAKES_MEANINGS | READER_TAKES_WINDOW };

const model_mode_t a16_modes[MODEL_MODES] = {
    {"auto", "A16 2", .reads = FATHOM_MODE_AUTO, .takes = TAKES | READER_TAKES_VALUE,
     .simulated_as = FATHOM_SIM_A16_AUTO, .read = a16_read_auto},
    {"modbus", "A16 6", "Modbus", .reads = FATHOM_MODE_MODBUS, .is_modbus = true, .has_address = true,
     .takes = TAKES | READER_TAKES_VALUE, .simulated_as = FATHOM_SIM_A16_MODBUS, .read = a16_read_modbus},
    {"controlled", "A16 3", .reads = FATHOM_MODE_CONTROLLED, .is_triggered = true, .takes = TAKES,
     .may_pins = MODEL_PIN_TRIGGER, .simulated_as = FATHOM_SIM_A16_CONTROLLED, .read = a16_read_controlled},
    {"pwm", "A16 1", .reads = FATHOM_MODE_PULSE, .is_triggered = true, .has_pulses = true,
     .takes = READER_TAKES_WINDOW, .pins = MODEL_PIN_TRIGGER | MODEL_PIN_ECHO, .read = a16_read_pwm},
    {"switch", "A16 4", .is_contact = true, .pins = MODEL_PIN_IN, .read = a16_read_switch},
};

const model_mode_t dyp_free_mode = {"free",
                                    "A16 1",
                                    .reads = FATHOM_MODE_FREE_PULSE,
                                    .has_pulses = true,
                                    .takes = READER_TAKES_WINDOW,
                                    .pins = MODEL_PIN_ECHO,
                                    .read = a16_read_pwm};

const model_mode_t a05_modes[MODEL_MODES] = {
    {"auto", "A05 1", .reads = FATHOM_MODE_AUTO, .takes = TAKES | READER_TAKES_PROBES | READER_TAKES_VALUE,
     .simulated_as = FATHOM_SIM_A05_AUTO, .read = a05_read_auto},
    {"modbus", "A05 3", "Modbus", .reads = FATHOM_MODE_MODBUS, .is_modbus = true, .has_address = true,
     .takes = TAKES | READER_TAKES_PROBES, .simulated_as = FATHOM_SIM_A05_MODBUS, .read = a05_read_modbus},
    /* One wrong bit turns a response into the command that sets the address. */
    {"dyp", "A05 2", "55 AA", .reads = FATHOM_MODE_55AA, .has_address = true, .can_move_others = true,
     .takes = TAKES | READER_TAKES_PROBES, .simulated_as = FATHOM_SIM_A05_DYP, .read = a05_read_dyp},
    {"relay", "A05 4", .is_contact = true, .pins = MODEL_PIN_IN, .read = a05_read_relay},
};

/* ---- simulation ---- */

/* The members that the two simulators share. */
#define SIMULATED(settings, simulated_as)                                                                    \
    .address = (settings)->address, .address_zero = (settings)->address == 0, .mode = (simulated_as),        \
    .exceptions = (settings)->traits[DEVICE_EXCEPTIONS] != 0,                                                \
    .answers_broadcast = (settings)->traits[DEVICE_ANSWERS_BROADCAST] != 0,                                  \
    .answers_from_new = (settings)->traits[DEVICE_ANSWERS_FROM_NEW] != 0,                                    \
    .real_time = (settings)->traits[DEVICE_REAL_TIME] != 0, .seed = (settings)->seed,                        \
    .scene = (settings)->scene

/* The response of a relative leaves in the middle of its times. */
void a16_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    static const fathom_model_facts_t datasheet;
    const fathom_model_facts_t *const facts = settings->facts != NULL ? settings->facts : &datasheet;
    const uint32_t period_us = facts->period_ms * 1000u;
    const uint32_t middle_us = (facts->earliest_ms + facts->latest_ms) * 500u;
    const fathom_sim_a16_config_t config = {
        SIMULATED(settings, simulated_as),
        .has_temperature = (facts->registers & FATHOM_HAS_TEMPERATURE) != 0,
        .baud = facts->line_settings != NULL ? facts->line_settings->baud : 0,
        .period_us = period_us,
        .cycle_us = period_us - period_us / 16,
        .least_us = middle_us,
        .most_us = middle_us,
        .has_byte = facts->start == FATHOM_STARTS_BYTE,
        .byte = facts->trigger_byte};
    fathom_sim_a16_init(&device->a16, &config);
}

void a05_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const fathom_sim_a05_config_t config = {SIMULATED(settings, simulated_as)};
    fathom_sim_a05_init(&device->a05, &config);
}
