/* SPDX-License-Identifier: MIT */
/* How a simulated device receives and executes requests of the protocol 55 AA. */
#include "device.h"

#include "fathom/codec/dyp_55aa.h"

enum { START_1 = 0x55, START_2 = 0xAA, ADDRESS = 2, COMMAND = 3 };

/* No Modbus request begins like this: 0xAA is no function. */
static bool hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    (void)now_us;
    if (length < 2 || frame[0] != START_1 || frame[1] != START_2) return false;
    if (length < FATHOM_DYP_REQUEST_LENGTH || !fathom_dyp_55aa_is_valid(frame, length)) {
        device->counters.crc_errors++;
        return true;
    }
    const uint8_t command = frame[COMMAND];
    const bool to_all = frame[ADDRESS] == FATHOM_DYP_ANY_ADDRESS;
    /* 03 has the new address and no other, so it is for every device that receives it (A05 2(3)5). */
    if (!to_all && frame[ADDRESS] != device->address && command != FATHOM_DYP_SET_ADDRESS) {
        device->counters.others++;
        return true;
    }
    device->counters.requests++;
    uint32_t delay_us = FATHOM_NO_DEADLINE;
    if (length == FATHOM_DYP_REQUEST_LENGTH)
        delay_us = device->model->command(device, frame[ADDRESS], command);
    if (delay_us == FATHOM_NO_DEADLINE) {
        if (command == FATHOM_DYP_SET_ADDRESS) device->counters.writes_refused++;
        device->counters.unserved++;
        return true;
    }
    if (to_all && device->dyp_silent_broadcast) return true;
    device->command = command;
    device->reply_settings = device->settings;
    fathom_sim_device_reply(device, &fathom_sim_dyp, delay_us);
    return true;
}

static uint8_t measure(fathom_sim_device_t *device, uint8_t command, uint8_t *bytes, uint32_t now_us)
{
    uint16_t values[4];
    const uint8_t count = fathom_dyp_55aa_value_count(command);
    const uint8_t first =
        command == FATHOM_DYP_ALL_PROBES ? 1 : (uint8_t)(command - FATHOM_DYP_FIRST_PROBE + 1);
    for (uint8_t i = 0; i < count; i++)
        values[i] = fathom_sim_device_ultrasonic(device, (uint8_t)(first + i), false, now_us);
    return fathom_dyp_55aa_encode_response(bytes, device->address, command, values);
}

static uint8_t response(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    return measure(device, device->command, bytes, now_us);
}

static uint8_t unasked(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    return measure(device, FATHOM_DYP_ALL_PROBES, bytes, now_us);
}

const fathom_sim_protocol_t fathom_sim_dyp = {hear, response, unasked, FATHOM_SIM_DYP};
