/* SPDX-License-Identifier: MIT */
/* The simulated A16: its registers, its commands, its modes and its pulses. The switch output is in a16_switch.c. */
#include "a16.h"

#include <string.h>

#include "fathom/codec/dyp_stream.h"
#include "internal/switches.h"

enum { AUTOMATIC = 1, POSITIVE = 1, REAL_TIME = 1 }; /* values of 0x0202, 0x0205, 0x0207 */

enum {
    PROCESSED = 0x0100,
    REALTIME = 0x0101,
    TEMPERATURE = 0x0102,
    ADDRESS = 0x0200,
    MODE = 0x0202,
    POLARITY = 0x0205,
    THRESHOLD = 0x0206,
    DATA_TYPE = 0x0207
};

/* How long the register takes; 0: there is none. */
static uint32_t read_us(const fathom_sim_a16_t *a16, uint16_t address)
{
    switch (address) {
    case PROCESSED:
        return a16->processed_us;
    case REALTIME:
        return a16->realtime_us;
    case TEMPERATURE:
        return a16->has_temperature ? a16->settings_us : 0;
    case ADDRESS:
    case POLARITY:
    case THRESHOLD:
    case DATA_TYPE:
        return a16->settings_us;
    default:
        return 0;
    }
}

static uint32_t refuse(fathom_sim_a16_t *a16, fathom_modbus_message_t *message, uint8_t exception)
{
    message->exception = exception;
    return a16->exceptions ? fathom_sim_device_delay_us(&a16->device, a16->settings_us) : FATHOM_NO_DEADLINE;
}

/* "To exit the controlled mode and return to the original automatic mode" (A16 6(4) example 4): this command
 * has ended the automatic output itself, if none has before. */
static void set_mode(fathom_sim_device_t *device, uint16_t mode)
{
    if (device->period_us == 0 || mode != AUTOMATIC) return;
    device->leaving = false;
    fathom_sim_device_set_alarm(device, FATHOM_SIM_ALARM_AUTOMATIC, device->heard_us + device->period_us);
}

/* 0, or the exception: there is no such register to write, or it has no such value. */
static uint8_t write(fathom_sim_a16_t *a16, uint16_t address, uint16_t value)
{
    fathom_sim_device_t *const device = &a16->device;
    switch (address) {
    case ADDRESS:
        if (value > 0xFE) return FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
        device->address = (uint8_t)value;
        break;
    case MODE:
        if (value > AUTOMATIC) return FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
        set_mode(device, value);
        break;
    case POLARITY:
        if (value > POSITIVE) return FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
        a16->polarity = (uint8_t)value;
        break;
    case THRESHOLD:
        a16->threshold_mm = value;
        break;
    case DATA_TYPE:
        if (value > REAL_TIME) return FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
        a16->data_type = (uint8_t)value;
        break;
    default:
        return FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
    }
    device->counters.writes++;
    if (address != MODE) device->counters.flash_writes++; /* "do not save when power off" */
    return 0;
}

static uint32_t request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    const uint16_t address = fathom_sim_get16(message->head + 2);
    const uint16_t value = fathom_sim_get16(message->head + 4);
    uint32_t most_us = a16->settings_us;
    uint8_t exception;
    switch (message->head[1]) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        most_us = read_us(a16, address);
        if (most_us == 0) return refuse(a16, message, FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS);
        if (value != 1) return refuse(a16, message, FATHOM_MODBUS_ILLEGAL_DATA_VALUE);
        break;
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
        exception = write(a16, address, value);
        if (exception != 0) return refuse(a16, message, exception);
        break;
    default: /* A16 6(1): 03 and 06 only */
        return refuse(a16, message, FATHOM_MODBUS_ILLEGAL_FUNCTION);
    }
    return fathom_sim_device_delay_us(device, most_us);
}

/* Where there is a switch output it obeys at once. */
static uint32_t switch_request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    const uint32_t delay_us = request(device, message);
    const uint16_t address = fathom_sim_get16(message->head + 2);
    if (message->head[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER && message->exception == 0 &&
        (address == POLARITY || address == THRESHOLD))
        fathom_sim_a16_switch_obey(fathom_sim_a16_of(device));
    return delay_us;
}

static void fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    const fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    const uint16_t address = fathom_sim_get16(message->head + 2);
    switch (address) {
    case TEMPERATURE:
        message->values[0] = (uint16_t)a16->temperature_dc;
        break;
    case ADDRESS:
        message->values[0] = device->address;
        break;
    case POLARITY:
        message->values[0] = a16->polarity;
        break;
    case THRESHOLD:
        message->values[0] = a16->threshold_mm;
        break;
    case DATA_TYPE:
        message->values[0] = a16->data_type;
        break;
    default:
        message->values[0] = fathom_sim_device_ultrasonic(device, 1, address == PROCESSED, now_us);
        break;
    }
}

static uint8_t automatic(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    const fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    /* A16 2(2): the UART looks at its RX pin; RS232 at register 0x0207 */
    const bool is_selected = a16->mode == FATHOM_SIM_A16_UART && device->rx_held != 0;
    const bool processed = a16->data_type != REAL_TIME && !is_selected;
    const uint16_t value = fathom_sim_device_ultrasonic(device, 1, processed, now_us);
    return fathom_dyp_stream_encode(bytes, &value, 1);
}

/* ---- PWM and controlled: the pins ---- */

static void power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_device_set_level(device, fathom_sim_a16_of(device)->mode != FATHOM_SIM_A16_PWM, now_us);
}

static void trigger(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    const bool is_pwm = a16->mode == FATHOM_SIM_A16_PWM;
    if (device->alarms[FATHOM_SIM_ALARM_START].set || device->alarms[FATHOM_SIM_ALARM_REST].set) {
        device->counters.unserved++;
        return;
    }
    device->counters.requests++;
    fathom_sim_device_set_alarm(device, FATHOM_SIM_ALARM_REST, now_us + a16->cycle_us + 1);
    /* "T2 = 90~110ms" (A16 3(3)) */
    fathom_sim_device_set_alarm(
        device, FATHOM_SIM_ALARM_PIN,
        now_us +
            (is_pwm ? a16->pulse_us : fathom_sim_device_between_us(device, a16->least_us, a16->most_us)));
}

static void edge(fathom_sim_device_t *device, bool high, uint32_t now_us)
{
    const fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    const bool is_triggered = a16->mode == FATHOM_SIM_A16_PWM || a16->mode == FATHOM_SIM_A16_CONTROLLED;
    if (!high && is_triggered && !a16->has_byte) trigger(device, now_us);
}

/* The trigger of a relative, which stands alone. */
static bool hear_byte(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    const bool is_it = length == 1 && frame[0] == fathom_sim_a16_of(device)->byte;
    if (is_it) trigger(device, now_us);
    return is_it;
}

/* S = T * V / 2, or S = T / 57.5 in cm (A16 1(4)); "T2 = 3~94ms" (A16 1(3)) */
static uint32_t width_us(fathom_sim_a16_t *a16, uint32_t now_us)
{
    const uint32_t shortest_us = 3000;
    const uint16_t mm = fathom_sim_device_ultrasonic(&a16->device, 1, false, now_us);
    const uint32_t us = (mm * UINT32_C(575) + 50) / 100;
    if (us > a16->no_target_us) return a16->no_target_us;
    return us < shortest_us ? shortest_us : us;
}

static void alarm(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a16_t *const a16 = fathom_sim_a16_of(device);
    if (a16->mode != FATHOM_SIM_A16_PWM) {
        uint8_t bytes[FATHOM_DYP_MAX_LENGTH];
        const uint16_t value = fathom_sim_device_ultrasonic(device, 1, false, now_us);
        fathom_sim_device_response(device, bytes, fathom_dyp_stream_encode(bytes, &value, 1), now_us);
    } else if (!device->tx_high) {
        device->counters.answered++;
        fathom_sim_device_set_alarm(device, FATHOM_SIM_ALARM_PIN, now_us + width_us(a16, now_us));
        fathom_sim_device_set_level(device, true, now_us);
    } else {
        fathom_sim_device_set_level(device, false, now_us);
    }
}

void fathom_sim_a16_init(fathom_sim_a16_t *a16, const fathom_sim_a16_config_t *config)
{
    static const fathom_sim_model_t model = {.request = request,
                                             .fill = fill,
                                             .automatic = automatic,
                                             .power_on = power_on,
                                             .edge = edge,
                                             .alarm = alarm,
                                             .reading = {REALTIME, 1},
                                             .broadcast = 0xFF,
                                             .deaf_at_start = true};
    static const fathom_sim_model_t switch_model = {.request = switch_request,
                                                    .fill = fill,
                                                    .power_on = fathom_sim_a16_switch_power_on,
                                                    .alarm = fathom_sim_a16_switch_alarm,
                                                    .reading = {REALTIME, 1},
                                                    .broadcast = 0xFF,
                                                    .deaf_at_start = true};
    const bool is_switch = config->mode == FATHOM_SIM_A16_SWITCH;
    fathom_sim_device_t *const device = &a16->device;
    memset(a16, 0, sizeof *a16);
    device->model = is_switch ? &switch_model : &model;
    device->tx_is_uart = is_switch;
    a16->every_us = fathom_sim_or_else(config->period_us, 500000);
    device->faults = config->faults;
    device->scene = config->scene;
    device->processed = config->processed;
    device->settings.baud = fathom_sim_or_else(config->baud, 9600); /* 8N1 (A16 2(2), 5(2)) */
    device->settings.stop_bits = 1;
    device->start_us = config->start_us;
    device->random = config->seed;
    device->address = config->address != 0 ? config->address : 1;
    if (config->address_zero) device->address = 0;
    device->protocols[0] = &fathom_sim_modbus;
    device->listens =
        config->mode == FATHOM_SIM_A16_AUTO || config->mode == FATHOM_SIM_A16_MODBUS || is_switch;
    if (config->has_byte) {
        static const fathom_sim_protocol_t byte_protocol = {.hear = hear_byte, .id = FATHOM_SIM_STREAM};
        device->protocols[0] = &byte_protocol;
        device->listens = true;
    }
    device->answers_broadcast = config->answers_broadcast;
    device->answers_from_new = config->answers_from_new;
    if (config->mode == FATHOM_SIM_A16_AUTO || config->mode == FATHOM_SIM_A16_UART)
        device->period_us = fathom_sim_or_else(config->period_us, 100000);
    device->linger_us = fathom_sim_or_else(config->linger_us, 150000);
    a16->realtime_us = fathom_sim_or_else(config->realtime_us, 120000);
    a16->processed_us = fathom_sim_or_else(config->processed_us, 520000);
    a16->settings_us = fathom_sim_or_else(config->settings_us, 20000);
    a16->threshold_mm = config->threshold_mm != 0 ? config->threshold_mm : 1000;
    a16->mode = config->mode;
    a16->has_byte = config->has_byte;
    a16->byte = config->byte;
    a16->has_temperature = config->has_temperature;
    a16->temperature_dc = config->temperature_dc != 0 ? config->temperature_dc : 200;
    a16->least_us = fathom_sim_or_else(config->least_us, 90000);
    a16->most_us = fathom_sim_or_else(config->most_us, 110000);
    a16->cycle_us =
        fathom_sim_or_else(config->cycle_us, config->mode == FATHOM_SIM_A16_PWM ? 220000 : 120000);
    a16->pulse_us = fathom_sim_or_else(config->pulse_us, 110000);
    a16->no_target_us = fathom_sim_or_else(config->no_target_us, 94000);
    a16->polarity = POSITIVE;
    a16->data_type = config->real_time ? REAL_TIME : 0;
    a16->exceptions = config->exceptions;
}
