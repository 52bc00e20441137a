/* SPDX-License-Identifier: MIT */
#include "scan_others.h"

stranger_t stranger;

static uint16_t first_of(const fathom_modbus_message_t *message)
{
    return (uint16_t)(message->head[2] * 256u + message->head[3]);
}

static uint32_t stranger_request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    const uint16_t first = first_of(message);
    if (stranger.only[0] != 0 && first != stranger.only[0] && first != stranger.only[1])
        return FATHOM_NO_DEADLINE;
    message->exception = stranger.exception;
    return 5000;
}

static void stranger_fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    const uint16_t first = first_of(message);
    for (uint8_t i = 0; i != message->head[5]; i++) message->values[i] = stranger.value;
    if (first == 0x0001)
        for (uint8_t i = 0; i != message->head[5]; i++) message->values[i] = stranger.version;
    if (first == 0x0200) message->values[0] = stranger.address;
}

void begin_stranger(uint8_t unit, const fathom_line_settings_t *line)
{
    static const fathom_sim_model_t model = {.request = stranger_request, .fill = stranger_fill};
    static fathom_sim_device_t device;
    memset(&device, 0, sizeof device);
    device.model = &model;
    device.settings = *line;
    device.address = unit;
    device.listens = true;
    device.protocols[0] = &fathom_sim_modbus;
    rig_attach(&device);
}

const uint8_t hps_response[13] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                  0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
const uint8_t a16_request[8] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
const uint8_t junk[6] = {0x02, 0x84, 0x31, 0x90, 0x11, 0xE7};

static const uint8_t *speech;
static uint8_t speech_length;

static uint8_t speak(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    memcpy(bytes, speech, speech_length);
    return speech_length;
}

static bool speaker_hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us);

static const fathom_sim_protocol_t speaker_protocol = {speaker_hear, speak, NULL, 0};

static bool speaker_hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    if (device->address != 0 && frame[0] != device->address) return true;
    device->reply_settings = device->settings;
    fathom_sim_device_reply(device, &speaker_protocol, 5000);
    return true;
}

fathom_sim_device_t *begin_speaker(const fathom_line_settings_t *line, uint32_t period_us,
                                   const uint8_t *bytes, uint8_t length)
{
    static const fathom_sim_model_t model = {.automatic = speak};
    static fathom_sim_device_t device;
    memset(&device, 0, sizeof device);
    speech = bytes;
    speech_length = length;
    device.model = &model;
    device.settings = *line;
    device.period_us = period_us;
    device.listens = period_us == 0;
    device.protocols[0] = &speaker_protocol;
    rig_attach(&device);
    return &device;
}
