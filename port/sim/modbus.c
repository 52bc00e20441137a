/* SPDX-License-Identifier: MIT */
/* How a simulated device receives and executes Modbus requests. */
#include "device.h"

#include "fathom/codec/crc16.h"

enum { UNIT = 0, FUNCTION = 1, MIN_LENGTH = 4 };

/* "any Modbus command switches the module" (A16 5(0), A05 1(1)) */
static void leave_automatic(fathom_sim_device_t *device, uint32_t now_us)
{
    if (device->model->unasked != NULL || device->leaving || !device->alarms[FATHOM_SIM_ALARM_AUTOMATIC].set)
        return;
    device->leaving = true;
    device->leave_us = now_us + device->linger_us;
}

/* Is it one of the shapes that a request can have? A response of another device may have the
 * same address and function. */
static bool fits(const uint8_t *frame, uint8_t length)
{
    if (frame[FUNCTION] >= FATHOM_MODBUS_EXCEPTION) return false;
    if (frame[FUNCTION] != FATHOM_MODBUS_READ_HOLDING_REGISTERS &&
        frame[FUNCTION] != FATHOM_MODBUS_WRITE_SINGLE_REGISTER &&
        frame[FUNCTION] != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS)
        return true; /* to be refused, whatever its length */
    return fathom_modbus_rtu_request_length(frame, length) == length;
}

static bool is_write(const uint8_t *frame)
{
    return frame[FUNCTION] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ||
           frame[FUNCTION] == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS;
}

/* What is no frame of another protocol is a damaged one of this. */
static bool hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    fathom_modbus_message_t *const message = &device->message;
    if (length < MIN_LENGTH || fathom_crc16(frame, length) != 0) {
        device->counters.crc_errors++;
        return true;
    }
    const bool to_all = frame[UNIT] == device->model->broadcast;
    if (!to_all && frame[UNIT] != device->address) {
        device->counters.others++;
        return true;
    }
    device->counters.requests++;
    leave_automatic(device, now_us);

    uint32_t delay_us = FATHOM_NO_DEADLINE;
    if (fits(frame, length)) {
        message->values = device->values;
        (void)fathom_modbus_rtu_parse_request(message, frame, FATHOM_SIM_REGISTERS);
        const uint8_t unit = device->address;
        device->reply_settings = device->settings;
        delay_us = device->model->request(device, message);
        if (device->answers_from_new)
            message->head[UNIT] = device->address;
        else if (to_all && device->answers_broadcast)
            message->head[UNIT] = unit;
        /* whatever a write was for: a refused one was sent all the same */
        if (is_write(frame) && (delay_us == FATHOM_NO_DEADLINE || message->exception != 0))
            device->counters.writes_refused++;
    }
    if (delay_us == FATHOM_NO_DEADLINE) device->counters.unserved++;
    if (delay_us != FATHOM_NO_DEADLINE && (!to_all || device->answers_broadcast))
        fathom_sim_device_reply(device, &fathom_sim_modbus, delay_us);
    return true;
}

static uint8_t response(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    fathom_modbus_message_t *const message = &device->message;
    if (message->exception != 0)
        device->counters.exceptions++;
    else if (message->head[FUNCTION] == FATHOM_MODBUS_READ_HOLDING_REGISTERS && device->model->fill != NULL)
        device->model->fill(device, message, now_us);
    return fathom_modbus_rtu_encode_response(message, bytes);
}

static uint8_t unasked(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    uint16_t values[FATHOM_SIM_REGISTERS];
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, device->address, device->model->reading[0],
                                         (uint8_t)device->model->reading[1], values);
    message.exception = 0;
    device->model->fill(device, &message, now_us);
    return fathom_modbus_rtu_encode_response(&message, bytes);
}

const fathom_sim_protocol_t fathom_sim_modbus = {hear, response, unasked, FATHOM_SIM_MODBUS};
