/* SPDX-License-Identifier: MIT */
/*
 * The simulated HPS-167S: its registers, its measurements and its automatic output. Settings are in hps167s_settings.c.
 */
#include <string.h>

#include "internal/hps167s_parts.h"

enum {
    VERSION = 0x0001,       /* #1 */
    CONFIGURATION = 0x0002, /* #2 */
    DETAILS = 0x0003,       /* #3 */
    TEMPERATURE = 0x0004,   /* #4 */
    MEASURE = 0x0008,       /* #5 */
    RESET = FATHOM_SIM_HPS167S_RESET
};

enum { UUID_END = 8 }; /* the register of #3 with the last byte of the UUID, and the year */

static const uint16_t over_range = 65530; /* "65.53 meters" (#5, note) */

/* The example of #3: UUID, 2019-09-23, version 3.9 (the datasheet's own reading of the bytes is wrong). */
static const uint8_t example_details[22] = {0xB0, 0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14, 0x20, 0x34,
                                            0x38, 0x35, 0x01, 0x06, 0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09};
/* No example is printed; the day of the datasheet's revision 2.1. */
static const uint8_t default_version[6] = {20, 9, 27, 2, 1, 0};
/* The example of #5. */
static const fathom_sim_optics_t example_optics = {0xDCB2, 0x07, 0x01, 0x0000};

static uint16_t pair(uint8_t high, uint8_t low) { return (uint16_t)(high * 256u + low); }

/* The one count that a command allows; 0: no command. */
static uint16_t length_of(uint16_t address)
{
    switch (address) {
    case VERSION:
        return 3;
    case CONFIGURATION:
        return 4;
    case DETAILS:
        return 11;
    case TEMPERATURE:
        return 1;
    case MEASURE:
        return 4;
    case RESET:
        return 1;
    default:
        return 0;
    }
}

static bool warming_up(const fathom_sim_hps167s_t *hps)
{
    return hps->device.alarms[FATHOM_SIM_ALARM_START].set;
}

/* `least_us`, or longer when an alarm wants it. */
static uint32_t until_us(const fathom_sim_hps167s_t *hps, uint8_t alarm, uint32_t least_us)
{
    if (!hps->device.alarms[alarm].set) return least_us;
    const uint32_t due_us = fathom_sim_until_us(hps->device.alarms[alarm].at_us, hps->device.heard_us);
    return due_us > least_us ? due_us : least_us;
}

/* From the end of the request to the response: a measurement is ready, under way, or begins now. */
static uint32_t measure_us(const fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message,
                           uint32_t reply_us)
{
    if (warming_up(hps) && hps->warm_up_says != FATHOM_SIM_HPS167S_ABNORMAL) {
        if (hps->warm_up_says != FATHOM_SIM_HPS167S_EXCEPTION) return FATHOM_NO_DEADLINE;
        message->exception = FATHOM_MODBUS_SERVER_DEVICE_FAILURE;
        return reply_us;
    }
    if (!hps->measuring) return hps->period_us;
    return until_us(hps, FATHOM_SIM_ALARM_LOST, until_us(hps, FATHOM_SIM_ALARM_REST, reply_us));
}

static uint32_t read(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message, uint32_t reply_us)
{
    const uint16_t address = fathom_sim_get16(message->head + 2);
    const uint16_t length = length_of(address);
    if (length == 0) {
        message->exception = FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
    } else if (fathom_sim_get16(message->head + 4) != length) {
        message->exception = hps->wrong_length;
        if (address == RESET) hps->device.counters.resets_refused++;
    } else if (address == RESET) {
        fathom_sim_hps167s_reset(hps);
    } else if (address == MEASURE) {
        return measure_us(hps, message, reply_us);
    }
    return reply_us;
}

static uint32_t request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    fathom_sim_hps167s_t *const hps = fathom_sim_hps167s_of(device);
    const uint32_t reply_us = fathom_sim_device_delay_us(device, hps->reply_us);
    switch (message->head[1]) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        return read(hps, message, reply_us);
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
        fathom_sim_hps167s_write(hps, message);
        break;
    case FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS:
        fathom_sim_hps167s_write_many(hps, message);
        break;
    default: /* the codec has set exception 01 */
        break;
    }
    return reply_us;
}

static void put_bytes(uint16_t *values, const uint8_t *bytes, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) values[i] = fathom_sim_get16(bytes + 2 * i);
}

/* #12. What is beyond all distances stays: 65530 and up are marks. */
static uint16_t compensated(const fathom_sim_hps167s_t *hps, int32_t distance)
{
    if (distance >= over_range) return (uint16_t)distance;
    distance += hps->sensor.offset_mm;
    if (distance < 0) return 0;
    return distance < over_range ? (uint16_t)distance : (uint16_t)(over_range - 1);
}

void fathom_sim_hps167s_put(uint16_t *values, int32_t distance, const fathom_sim_optics_t *optics)
{
    if (optics == NULL) optics = &example_optics;
    if (distance == FATHOM_SIM_FAULT) { /* #5: "all 0xFF and the value of Magnitude is 0x00" */
        values[0] = 0xFFFF;
        values[1] = 0;
        values[2] = 0x00FF;
        values[3] = 0xFFFF;
        return;
    }
    values[0] = (uint16_t)distance;
    values[1] = optics->magnitude;
    values[2] = pair(optics->exponent, optics->ambient);
    values[3] = optics->precision;
    if (distance < 0) { /* too far or too weak: next to nothing comes back */
        values[0] = over_range;
        values[1] = 0x0010;
        values[2] = pair(0, optics->ambient);
    }
}

static void fill_measurement(fathom_sim_hps167s_t *hps, uint16_t *values, uint32_t now_us)
{
    const bool has_data = !hps->lost && !warming_up(hps);
    const int32_t distance = has_data ? fathom_sim_device_measure(&hps->device, 1, now_us) : FATHOM_SIM_FAULT;
    fathom_sim_device_set_alarm(&hps->device, FATHOM_SIM_ALARM_REST, now_us + hps->period_us);
    fathom_sim_hps167s_put(values, distance < 0 ? distance : compensated(hps, distance), hps->optics);
}

static void fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    fathom_sim_hps167s_t *const hps = fathom_sim_hps167s_of(device);
    uint16_t *const values = message->values;
    switch (fathom_sim_get16(message->head + 2)) {
    case VERSION:
        put_bytes(values, hps->version, 3);
        break;
    case CONFIGURATION:
        values[0] = pair(hps->termination ? 0xFF : 0, hps->auto_output ? 0xFF : 0);
        values[1] = pair(hps->warm_up_s, (uint8_t)(hps->reconnect_ms >> 24));
        values[2] = (uint16_t)(hps->reconnect_ms >> 8);
        values[3] = pair((uint8_t)hps->reconnect_ms, hps->no_baud_code ? 0 : hps->baud_code);
        break;
    case DETAILS:
        put_bytes(values, hps->details, 11);
        values[UUID_END] =
            pair((uint8_t)(hps->details[2 * UUID_END] + hps->number), hps->details[2 * UUID_END + 1]);
        break;
    case TEMPERATURE:
        values[0] = (uint16_t)hps->temperature_f;
        break;
    case MEASURE:
        fill_measurement(hps, values, now_us);
        break;
    default: /* #6 */
        values[0] = 0x0001;
        break;
    }
}

/* Of continuous output. */
static bool silent(fathom_sim_device_t *device)
{
    const fathom_sim_hps167s_t *const hps = fathom_sim_hps167s_of(device);
    if (warming_up(hps)) return hps->warm_up_says != FATHOM_SIM_HPS167S_ABNORMAL;
    return device->alarms[FATHOM_SIM_ALARM_LOST].set;
}

void fathom_sim_hps167s_lose(fathom_sim_hps167s_t *hps, bool lost, uint32_t now_us)
{
    hps->device.alarms[FATHOM_SIM_ALARM_LOST].set = false;
    hps->lost = lost;
    if (lost) fathom_sim_hps167s_wait_for_data(hps, now_us);
}

void fathom_sim_hps167s_init(fathom_sim_hps167s_t *hps, const fathom_sim_hps167s_config_t *config)
{
    static const fathom_sim_model_t model = {.request = request,
                                             .fill = fill,
                                             .power_on = fathom_sim_hps167s_power_on,
                                             .unasked = &fathom_sim_modbus,
                                             .silent = silent,
                                             .reading = {MEASURE, 4},
                                             .broadcast = FATHOM_MODBUS_BROADCAST,
                                             .strict_gap = true,
                                             .optical = true};
    fathom_sim_device_t *const device = &hps->device;
    memset(hps, 0, sizeof *hps);
    device->model = &model;
    device->faults = config->faults;
    device->scene = config->scene;
    device->settings.parity = FATHOM_PARITY_EVEN; /* 8E1 (HPS-167S 2.2.2, table 6) */
    device->settings.stop_bits = 1;
    device->random = config->seed;
    device->address = config->address != 0 ? config->address : FATHOM_SIM_HPS167S_UNIT;
    device->protocols[0] = &fathom_sim_modbus;
    device->listens = true;
    device->answers_from_new = config->answers_from_new;
    hps->optics = config->optics;
    hps->number = config->number;
    hps->details = config->details != NULL ? config->details : example_details;
    hps->version = config->version != NULL ? config->version : default_version;
    hps->reconnect_ms = fathom_sim_or_else(config->reconnect_ms, FATHOM_SIM_HPS167S_RECONNECT_MS);
    hps->unasked_us = config->unasked_us;
    hps->period_us = fathom_sim_or_else(config->period_us, 18519);
    hps->reply_us = fathom_sim_or_else(config->reply_us, 2500);
    hps->temperature_f = config->temperature_f != 0 ? config->temperature_f : 77;
    hps->warm_up_s = config->warm_up_s;
    hps->wrong_length = config->wrong_length != 0 ? config->wrong_length : FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
    hps->wrong_value = config->wrong_value != 0 ? config->wrong_value : FATHOM_MODBUS_ILLEGAL_DATA_VALUE;
    hps->warm_up_says = config->warm_up_says;
    hps->baud_code =
        config->baud_code >= 1 && config->baud_code <= 4 ? config->baud_code : FATHOM_SIM_HPS167S_BAUD_CODE;
    hps->baud_at_power_on = config->baud_at_power_on;
    hps->offset_adds = config->offset_adds;
    hps->no_baud_code = config->no_baud_code;
    hps->termination = !config->no_termination;
    hps->auto_output = !config->no_auto_output;
    fathom_sim_hps167s_power_on(device, 0); /* as it will be; nothing is lost yet, so that no time counts */
}
