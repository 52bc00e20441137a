/* SPDX-License-Identifier: MIT */
#include "sensors/a16/a16.h"

#include "sensors/dyp.h"

/* ---- reading ---- */

/* RX goes high again. */
static fathom_status_t end_auto(reader_t *reader) { return fathom_a16_auto_deinit(&reader->driver.a16_auto); }

static fathom_status_t end_controlled(reader_t *reader)
{
    return fathom_a16_controlled_deinit(&reader->driver.a16_controlled);
}

/* A level at RX selects (A16 2(2)): that of the port's TX. */
static bool read_auto(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_auto_t *const driver = &reader->driver.a16_auto;
    fathom_a16_auto_config_t config = {
        .stale_us = settings->timeout_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
        .value = settings->value,
    };
    if (settings->has_value) {
        driver_end_break(channel);
        config.select = fathom_output_line_break(&channel->line);
    }
    if (settings->value == FATHOM_REAL_TIME && !driver_has_break(reader, channel)) return false;
    if (fathom_a16_auto_init(driver, &channel->line, &config) != FATHOM_OK) return false;
    reader->end = end_auto;
    return dyp_open_stream(reader, &driver->base, fathom_a16_auto_sensor(driver));
}

/* Triggered by a break of the port, whose TX is the module's RX. */
static bool read_controlled(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_controlled_t *const driver = &reader->driver.a16_controlled;
    const fathom_output_t trigger = fathom_output_line_break(&channel->line);
    const fathom_a16_controlled_config_t config = {
        .period_us = settings->period_us,
        .gap_us = CHANNEL_STREAM_GAP_US,
        .window = settings->window,
    };
    if (fathom_a16_controlled_init(driver, &channel->line, &trigger, &config) != FATHOM_OK) return false;
    reader->sensor = fathom_a16_controlled_sensor(driver);
    reader->end = end_controlled;
    reader->frames = driver->stream.counters;
    reader->values = driver->values;
    reader->value_count = 1;
    reader->response = &driver->measurement;
    reader->window = &driver->measurement.window;
    reader->sequence = &driver->measurement.sequence;
    reader->period_us = &driver->trigger.period_us;
    return true;
}

static bool read_modbus(reader_t *reader, channel_t *channel, const reader_settings_t *settings)
{
    fathom_a16_modbus_t *const driver = &reader->driver.a16_modbus;
    const fathom_a16_modbus_config_t config = {
        .modbus = driver_config(channel, settings),
        .window = settings->window,
        .value = settings->value,
    };
    return fathom_a16_modbus_init(driver, &channel->modbus, &config) == FATHOM_OK &&
           dyp_open_asked(reader, &driver->base, fathom_a16_modbus_sensor(driver));
}

/* ---- simulation ---- */

static void simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t *const traits = settings->traits;
    const fathom_sim_a16_config_t config = {.address = settings->address,
                                            .address_zero = settings->address == 0,
                                            .mode = simulated_as,
                                            .exceptions = traits[DEVICE_EXCEPTIONS] != 0,
                                            .answers_broadcast = traits[DEVICE_ANSWERS_BROADCAST] != 0,
                                            .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
                                            .real_time = traits[DEVICE_REAL_TIME] != 0,
                                            .seed = settings->seed,
                                            .scene = settings->scene};
    fathom_sim_a16_init(&device->simulator.a16, &config);
    device->base = &device->simulator.a16.device;
}

/* ---- the model ---- */

const model_t model_a16 = {
    .name = "a16",
    .what = "one ultrasonic probe",
    .id = FATHOM_A16,
    .line = DYP_LINE,
    .modes = {{.name = "auto",
               .takes = DYP_TAKES | READER_TAKES_VALUE,
               .read = read_auto,
               .simulated_as = FATHOM_SIM_A16_AUTO},
              {.name = "modbus",
               .protocol = "Modbus",
               .is_modbus = true,
               .has_address = true,
               .takes = DYP_TAKES | READER_TAKES_VALUE,
               .read = read_modbus,
               .simulated_as = FATHOM_SIM_A16_MODBUS},
              {.name = "controlled",
               .is_triggered = true,
               .takes = DYP_TAKES,
               .read = read_controlled,
               .simulated_as = FATHOM_SIM_A16_CONTROLLED},
              {.name = "pwm",
               .is_triggered = true,
               .has_pulses = true,
               .takes = READER_TAKES_WINDOW,
               .pins = MODEL_PIN_TRIGGER | MODEL_PIN_ECHO,
               .read = a16_read_pwm},
              {.name = "switch", .is_contact = true, .pins = MODEL_PIN_IN, .read = a16_read_switch}},
    .automatic_again = ", or when 1 is written to its register 0x0202",
    .settings = a16_settings,
    .max_address = DYP_MAX_ADDRESS,
    .is_dyp = true,
    .probes = 1,
    .max_mm = FATHOM_A16_MAX_MM,
    .simulate = simulate,
    .near_mm = 500,
    .far_mm = 5000,
    .traits = 1u << DEVICE_EXCEPTIONS | 1u << DEVICE_ANSWERS_BROADCAST | 1u << DEVICE_REAL_TIME |
              1u << DEVICE_ANSWERS_FROM_NEW,
    /* The last measurement (0x0101), and where that is not there the processed distance (0x0100). */
    .scan = {.first = DYP_ADDRESS,
             .count = 1,
             .frame_length = FATHOM_DYP_A16_LENGTH,
             .own = 0x0101,
             .slow_own = 0x0100},
    .describe = dyp_describe,
    .protocols = DECODE_MODBUS | DECODE_STREAM_ONE,
    .decode = a16_decode,
    .decode_sum = a16_decode_sum,
    .request_ends =
        "the automatic output of an A16 with RS232, until power-off or `fathom set a16 automatic-output on`",
};
