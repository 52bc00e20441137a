/* SPDX-License-Identifier: MIT */
#include "hps167s.h"

#include <string.h>

enum {
    VERSION = 0x0001,       /* #1 */
    CONFIGURATION = 0x0002, /* #2 */
    DETAILS = 0x0003,       /* #3 */
    TEMPERATURE = 0x0004,   /* #4 */
    MEASURE = 0x0008,       /* #5 */
    RESET = 0x0009          /* #6 */
};

enum { FACTORY_UNIT = 1, FACTORY_BAUD_CODE = 1, FACTORY_WARM_UP_S = 5 };
static const uint32_t factory_reconnect_ms = 180;
static const uint16_t over_range = 65530; /* "65.53 meters" (#5, note) */

/* The example of #3: UUID, 2019-09-23, version 3.9 (the datasheet's own reading of the bytes is wrong). */
static const uint8_t example_details[22] = {0xB0, 0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14, 0x20, 0x34,
                                            0x38, 0x35, 0x01, 0x06, 0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09};
/* No example is printed; the day of the datasheet's revision 2.1. */
static const uint8_t default_version[6] = {20, 9, 27, 2, 1, 0};
/* The example of #5. */
static const fathom_sim_optics_t example_optics = {0xDCB2, 0x07, 0x01, 0x0000};

/* The device is the first member. */
static fathom_sim_hps167s_t *hps_of(fathom_sim_device_t *device)
{
    return (fathom_sim_hps167s_t *)(void *)device;
}

static uint16_t pair(uint8_t high, uint8_t low) { return (uint16_t)(high * 256u + low); }

static uint16_t get16(const uint8_t *at) { return pair(at[0], at[1]); }

static uint32_t rate(uint8_t baud_code)
{
    switch (baud_code) { /* #9: "the others are all 19200" */
    case 2:
        return 57600;
    case 3:
        return 115200;
    case 4:
        return 230400;
    default:
        return 19200;
    }
}

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

/* All settings of the interface; what acts from the next power-on does so here too. */
static void factory_reset(fathom_sim_hps167s_t *hps)
{
    hps->device.unit = FACTORY_UNIT;
    hps->device.settings.baud = rate(FACTORY_BAUD_CODE);
    hps->device.counters.resets++;
    hps->baud_code = FACTORY_BAUD_CODE;
    hps->warm_up_s = FACTORY_WARM_UP_S;
    hps->reconnect_ms = factory_reconnect_ms;
    hps->termination = true;
    hps->auto_output = true;
}

/* From the end of the request to the answer: a measurement is ready, under way, or begins now. */
static uint32_t measure_us(fathom_sim_hps167s_t *hps, uint32_t reply_us)
{
    const fathom_sim_alarm_t *const rest = &hps->device.alarms[FATHOM_SIM_ALARM_REST];
    if (hps->device.alarms[FATHOM_SIM_ALARM_START].set) return FATHOM_NO_DEADLINE; /* #7: no output */
    if (!hps->measuring) return hps->period_us;
    if (!rest->set) return reply_us;
    const uint32_t ready_us = fathom_sim_until_us(rest->at_us, hps->device.heard_us);
    return ready_us > reply_us ? ready_us : reply_us;
}

static uint32_t read(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message, uint32_t reply_us)
{
    const uint16_t address = get16(message->head + 2);
    const uint16_t length = length_of(address);
    if (length == 0) {
        message->exception = FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
    } else if (get16(message->head + 4) != length) {
        message->exception = hps->wrong_length;
        if (address == RESET) hps->device.counters.resets_refused++;
    } else if (address == RESET) {
        factory_reset(hps);
    } else if (address == MEASURE) {
        return measure_us(hps, reply_us);
    }
    return reply_us;
}

static uint32_t request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    fathom_sim_hps167s_t *const hps = hps_of(device);
    const uint32_t reply_us = fathom_sim_device_delay_us(device, hps->reply_us);
    switch (message->head[1]) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        return read(hps, message, reply_us);
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
    case FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS:
        return FATHOM_NO_DEADLINE;
    default:
        return reply_us; /* the codec has set exception 01 */
    }
}

static void put_bytes(uint16_t *values, const uint8_t *bytes, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) values[i] = get16(bytes + 2 * i);
}

static void fill_measurement(fathom_sim_hps167s_t *hps, uint16_t *values, uint32_t now_us)
{
    const int32_t distance = fathom_sim_device_measure(&hps->device, 1, now_us);
    const fathom_sim_optics_t *const optics = hps->optics;
    fathom_sim_device_set_alarm(&hps->device, FATHOM_SIM_ALARM_REST, now_us + hps->period_us);
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

static void fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    fathom_sim_hps167s_t *const hps = hps_of(device);
    uint16_t *const values = message->values;
    switch (get16(message->head + 2)) {
    case VERSION:
        put_bytes(values, hps->version, 3);
        break;
    case CONFIGURATION:
        values[0] = pair(hps->termination ? 0xFF : 0, hps->auto_output ? 0xFF : 0);
        values[1] = pair(hps->warm_up_s, (uint8_t)(hps->reconnect_ms >> 24));
        values[2] = (uint16_t)(hps->reconnect_ms >> 8);
        values[3] = pair((uint8_t)hps->reconnect_ms, hps->baud_code);
        break;
    case DETAILS:
        put_bytes(values, hps->details, 11);
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

static uint32_t or_else(uint32_t value, uint32_t otherwise) { return value != 0 ? value : otherwise; }

void fathom_sim_hps167s_init(fathom_sim_hps167s_t *hps, const fathom_sim_hps167s_config_t *config)
{
    static const fathom_sim_model_t model = {.request = request,
                                             .fill = fill,
                                             .reading = {MEASURE, 4},
                                             .broadcast = FATHOM_MODBUS_BROADCAST,
                                             .strict_gap = true,
                                             .optical = true};
    fathom_sim_device_t *const device = &hps->device;
    memset(hps, 0, sizeof *hps);
    device->model = &model;
    device->faults = config->faults;
    device->scene = config->scene;
    device->settings.baud = rate(config->baud_code);
    device->settings.parity = FATHOM_PARITY_EVEN; /* 8E1 (HPS-167S 2.2.2, table 6) */
    device->settings.stop_bits = 1;
    device->start_us = (uint32_t)config->warm_up_s * UINT32_C(1000000);
    device->random = config->seed;
    device->unit = config->unit != 0 ? config->unit : FACTORY_UNIT;
    device->protocols[0] = &fathom_sim_modbus;
    device->listens = true;
    hps->optics = config->optics != NULL ? config->optics : &example_optics;
    hps->details = config->details != NULL ? config->details : example_details;
    hps->version = config->version != NULL ? config->version : default_version;
    hps->reconnect_ms = or_else(config->reconnect_ms, factory_reconnect_ms);
    hps->period_us = or_else(config->period_us, 18519);
    hps->reply_us = or_else(config->reply_us, 2500);
    hps->temperature_f = config->temperature_f != 0 ? config->temperature_f : 77;
    hps->warm_up_s = config->warm_up_s;
    hps->wrong_length = config->wrong_length != 0 ? config->wrong_length : FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
    hps->baud_code = config->baud_code >= 1 && config->baud_code <= 4 ? config->baud_code : FACTORY_BAUD_CODE;
    hps->termination = !config->no_termination;
    hps->auto_output = !config->no_auto_output;
    hps->measuring = hps->auto_output;
}
