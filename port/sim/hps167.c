/* SPDX-License-Identifier: MIT */
/* The simulated HPS-167 with a UART: its frames, its measurements and its continuous output. */
#include "hps167.h"

#include <string.h>

#include "fathom/codec/hps167_frames.h"
#include "internal/hps167s_parts.h"

enum { COMMAND = 1, FIRST = 2, UNKNOWN = 3, MEASUREMENT = 11 };

/* The device is the first member. */
static fathom_sim_hps167_t *of(fathom_sim_device_t *device) { return (fathom_sim_hps167_t *)(void *)device; }

static void start(fathom_sim_device_t *device, uint32_t now_us)
{
    of(device)->is_sending = true;
    device->period_us = of(device)->measure_us;
    fathom_sim_device_set_alarm(device, FATHOM_SIM_ALARM_AUTOMATIC, now_us + device->period_us);
}

static void stop(fathom_sim_device_t *device)
{
    of(device)->is_sending = false;
    device->period_us = 0;
    device->alarms[FATHOM_SIM_ALARM_AUTOMATIC].set = false;
}

/* Returns the time until the response, or FATHOM_NO_DEADLINE if there is none. */
static uint32_t obey(fathom_sim_device_t *device, uint8_t first, uint32_t now_us)
{
    fathom_sim_hps167_t *const hps = of(device);
    switch (device->command) {
    case FATHOM_HPS167_SINGLE:
        return fathom_sim_device_delay_us(device, hps->measure_us);
    case FATHOM_HPS167_CONTINUOUS:
        start(device, now_us);
        return FATHOM_NO_DEADLINE;
    case FATHOM_HPS167_STOP:
    case FATHOM_HPS167_TEMPERATURE:
        if (first == 1) break;
        device->counters.unserved++;
        return FATHOM_NO_DEADLINE;
    default:
        device->counters.unserved++;
        return FATHOM_NO_DEADLINE;
    }
    if (device->command == FATHOM_HPS167_STOP) stop(device);
    return fathom_sim_device_delay_us(device, hps->reply_us);
}

static bool hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    if (length != FATHOM_HPS167_REQUEST_LENGTH || frame[0] != 0x0A ||
        !fathom_hps167_is_valid(frame, length)) {
        device->counters.crc_errors++;
        return true;
    }
    device->counters.requests++;
    device->command = frame[COMMAND];
    device->reply_settings = device->settings;
    const uint32_t delay_us = obey(device, frame[FIRST], now_us);
    if (delay_us != FATHOM_NO_DEADLINE) fathom_sim_device_reply(device, &fathom_sim_hps167, delay_us);
    return true;
}

static uint8_t measure(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    const fathom_sim_hps167_t *const hps = of(device);
    uint8_t data[MEASUREMENT];
    uint16_t values[4];
    for (unsigned i = 0; i < UNKNOWN; i++)
        data[i] = hps->unknown != NULL ? hps->unknown[i]
                                       : (uint8_t)fathom_sim_device_between_us(device, 0, UINT8_MAX);
    fathom_sim_hps167s_put(values, fathom_sim_device_measure(device, 1, now_us), hps->optics);
    for (unsigned i = 0; i < 4; i++) {
        data[UNKNOWN + 2 * i] = (uint8_t)(values[i] >> 8);
        data[UNKNOWN + 2 * i + 1] = (uint8_t)values[i];
    }
    return fathom_hps167_encode_response(bytes, data, MEASUREMENT);
}

static uint8_t response(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    const uint16_t temperature = of(device)->temperature;
    const uint8_t degrees[] = {(uint8_t)(temperature >> 8), (uint8_t)temperature};
    const uint8_t done = FATHOM_HPS167_DONE;
    if (device->command == FATHOM_HPS167_STOP) return fathom_hps167_encode_response(bytes, &done, 1);
    if (device->command == FATHOM_HPS167_TEMPERATURE)
        return fathom_hps167_encode_response(bytes, degrees, sizeof degrees);
    return measure(device, bytes, now_us);
}

static uint8_t unasked(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    static const char text[] = "Hypersen";
    fathom_sim_hps167_t *const hps = of(device);
    if (!hps->is_greeting) return measure(device, bytes, now_us);
    hps->is_greeting = false;
    if (!hps->is_sending) stop(device);
    memcpy(bytes, text, sizeof text - 1);
    return sizeof text - 1;
}

const fathom_sim_protocol_t fathom_sim_hps167 = {hear, response, unasked, FATHOM_SIM_HPS167};

static void power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_hps167_t *const hps = of(device);
    fathom_sim_device_set_level(device, true, now_us);
    hps->is_sending = false;
    hps->is_greeting = !hps->is_silent;
    device->period_us = hps->is_greeting ? hps->measure_us : 0; /* the text leaves so long after the start */
}

void fathom_sim_hps167_init(fathom_sim_hps167_t *hps, const fathom_sim_hps167_config_t *config)
{
    static const fathom_sim_model_t model = {
        .power_on = power_on, .unasked = &fathom_sim_hps167, .deaf_at_start = true, .optical = true};
    fathom_sim_device_t *const device = &hps->device;
    memset(hps, 0, sizeof *hps);
    device->model = &model;
    device->faults = config->faults;
    device->scene = config->scene;
    device->settings = (fathom_line_settings_t){115200, FATHOM_PARITY_NONE, 1};
    device->random = config->seed;
    device->start_us = config->start_us;
    device->protocols[0] = &fathom_sim_hps167;
    device->listens = true;
    hps->optics = config->optics;
    hps->unknown = config->unknown;
    hps->temperature = (uint16_t)fathom_sim_or_else(config->temperature, 2500);
    hps->measure_us = fathom_sim_or_else(config->period_us, 18519);
    hps->reply_us = fathom_sim_or_else(config->reply_us, 2500);
    hps->is_silent = config->is_silent;
}
