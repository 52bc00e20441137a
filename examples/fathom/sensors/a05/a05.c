/* SPDX-License-Identifier: MIT */
#include "sensors/a05/a05.h"

#include "sensors/dyp.h"

/* ---- reading ---- */

static bool read_auto(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_auto_t *const driver = &reader->driver.a05_auto;
    const fathom_a05_auto_config_t config = {
        .select = fathom_output_line_break(&channel->line),
        .stale_us = settings->timeout_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
        .probes = settings->probes,
    };
    if (fathom_a05_auto_init(driver, &channel->line, &config) != FATHOM_OK) return false;
    (void)dyp_open_stream(reader, &driver->base, fathom_a05_auto_sensor(driver));
    return !settings->has_value || a05_select(reader, channel, settings->value);
}

static bool read_modbus(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_modbus_t *const driver = &reader->driver.a05_modbus;
    const fathom_a05_modbus_config_t config = {
        .modbus = driver_config(channel, settings),
        .window = settings->window,
        .registers = settings->registers,
        .probes = settings->probes,
    };
    return fathom_a05_modbus_init(driver, &channel->modbus, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a05_modbus_sensor(driver));
}

static bool read_dyp(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_dyp_t *const driver = &reader->driver.a05_dyp;
    const fathom_a05_dyp_config_t config = {
        .modbus = driver_config(channel, settings),
        .window = settings->window,
        .probes = settings->probes,
    };
    return fathom_a05_dyp_init(driver, &channel->line, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a05_dyp_sensor(driver));
}

/* The contact (A05 4) goes to where the input's resistor does not pull; it is the normally open one, unless the user says
 * that near is the other level. */
static bool read_relay(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a05_relay_t *const driver = &reader->driver.a05_relay;
    const pin_options_t *const wanted = &channel->pins.wanted;
    const bool conducts_high = wanted->bias == FATHOM_GPIO_BIAS_PULL_DOWN;
    const bool is_normally_closed = wanted->near == (conducts_high ? PINS_NEAR_LOW : PINS_NEAR_HIGH);
    const fathom_a05_relay_config_t config = {
        .timing = driver_contact_timing(channel, settings),
        .wiring = is_normally_closed ? FATHOM_A05_RELAY_NORMALLY_CLOSED : FATHOM_A05_RELAY_NORMALLY_OPEN,
        .level = conducts_high ? FATHOM_A05_RELAY_CONDUCTS_HIGH : FATHOM_A05_RELAY_CONDUCTS_LOW,
    };
    return fathom_a05_relay_init(driver, &channel->pins.in, &channel->clock, &config) == FATHOM_OK &&
           driver_open_contact(reader, &driver->base, fathom_a05_relay_sensor(driver));
}

/* ---- simulation ---- */

static void simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a05_config_t config = {.address = settings->address,
                                            .address_zero = settings->address == 0,
                                            .mode = simulated_as,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a05_init(&device->simulator.a05, &config);
    device->base = &device->simulator.a05.device;
}

/* ---- the model ---- */

const model_t model_a05 = {
    .name = "a05",
    .what = "four ultrasonic probes",
    .id = FATHOM_A05,
    .line = DYP_LINE,
    .modes = {{.name = "auto",
               .takes = DYP_TAKES | READER_TAKES_PROBES | READER_TAKES_VALUE,
               .read = read_auto,
               .simulated_as = FATHOM_SIM_A05_AUTO},
              {.name = "modbus",
               .protocol = "Modbus",
               .is_modbus = true,
               .has_address = true,
               .takes = DYP_TAKES | READER_TAKES_PROBES | READER_TAKES_REGISTERS,
               .read = read_modbus,
               .simulated_as = FATHOM_SIM_A05_MODBUS},
              {.name = "dyp",
               .protocol = "55 AA",
               .has_address = true,
               .can_move_others = true, /* one wrong bit makes a response a command that sets the address */
               .takes = DYP_TAKES | READER_TAKES_PROBES,
               .read = read_dyp,
               .simulated_as = FATHOM_SIM_A05_DYP},
              {.name = "relay", .is_contact = true, .pins = MODEL_PIN_IN, .read = read_relay}},
    .settings = a05_settings,
    .max_address = DYP_MAX_ADDRESS,
    .is_dyp = true,
    .probes = FATHOM_DYP_PROBES,
    .max_mm = FATHOM_A05_MAX_MM,
    .simulate = simulate,
    .near_mm = 250,
    .far_mm = 4500,
    .traits = 1u << DEVICE_EXCEPTIONS | 1u << DEVICE_ANSWERS_BROADCAST | 1u << DEVICE_REAL_TIME |
              1u << DEVICE_ANSWERS_FROM_NEW,
    /* Probe 1. */
    .scan = {.first = DYP_ADDRESS, .count = 1, .frame_length = FATHOM_DYP_A05_LENGTH, .own = 0x0106},
    .describe = dyp_describe,
    .protocols = DECODE_MODBUS | DECODE_DYP | DECODE_STREAM_FOUR,
    .decode = a05_decode,
    .decode_sum = a05_decode_sum,
    .request_ends = "the automatic output of an A05 with UART, until power-off",
};
