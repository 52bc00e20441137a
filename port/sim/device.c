/* SPDX-License-Identifier: MIT */
/* What all simulated devices share: power, address, alarms, reception of frames, and sending of responses. */
#include "device.h"

#include <string.h>

enum {
    POWER = FATHOM_SIM_ALARM_POWER,
    START = FATHOM_SIM_ALARM_START,
    SILENCE = FATHOM_SIM_ALARM_SILENCE,
    RESPONSE = FATHOM_SIM_ALARM_RESPONSE,
    AUTOMATIC = FATHOM_SIM_ALARM_AUTOMATIC,
    PIN = FATHOM_SIM_ALARM_PIN
};

void fathom_sim_device_set_alarm(fathom_sim_device_t *device, uint8_t alarm, uint32_t at_us)
{
    device->alarms[alarm].at_us = at_us;
    device->alarms[alarm].set = true;
}

/* ---- what the sensors need ---- */

uint32_t fathom_sim_device_between_us(fathom_sim_device_t *device, uint32_t least_us, uint32_t most_us)
{
    /* The generator of Numerical Recipes; its high bits are the good ones. */
    device->random = (uint32_t)(device->random * UINT32_C(1664525) + UINT32_C(1013904223));
    return most_us - (device->random >> 8) % (most_us - least_us + 1);
}

uint32_t fathom_sim_device_delay_us(fathom_sim_device_t *device, uint32_t most_us)
{
    return fathom_sim_device_between_us(device, most_us - most_us / 8, most_us);
}

static int32_t measure(fathom_sim_device_t *device, const fathom_sim_scene_t *scene, uint8_t probe,
                       uint32_t now_us)
{
    int32_t value = FATHOM_SIM_NO_TARGET;
    device->counters.measurements++;
    if (scene->distance != NULL) value = scene->distance(scene->ctx, probe, now_us);
    if (device->faults != NULL && device->faults->measured != NULL)
        value = device->faults->measured(device->faults->ctx, probe, value);
    return value;
}

int32_t fathom_sim_device_measure(fathom_sim_device_t *device, uint8_t probe, uint32_t now_us)
{
    return measure(device, &device->scene, probe, now_us);
}

uint16_t fathom_sim_device_ultrasonic(fathom_sim_device_t *device, uint8_t probe, bool processed,
                                      uint32_t now_us)
{
    const bool differs = processed && device->processed.distance != NULL;
    const int32_t value = measure(device, differs ? &device->processed : &device->scene, probe, now_us);
    if (value == FATHOM_SIM_INTERFERENCE) return 0xFFFE;
    return value < 0 ? 0xFFFD : (uint16_t)value;
}

/* ---- pins ---- */

static void send_break(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_sender_t *const sender = &device->sender;
    const uint8_t nothing = 0;
    fathom_sim_sender_put(sender, &device->settings, &nothing, 1, now_us);
    sender->paused = 0;
    sender->marked = true;
    sender->marks[0] = FATHOM_RX_FRAMING;
    device->own = 1;
    device->in_break = true;
}

void fathom_sim_device_set_level(fathom_sim_device_t *device, bool high, uint32_t now_us)
{
    if (device->tx_high == high) return;
    device->tx_high = high;
    if (device->watch != NULL) device->watch(device->watch_ctx, high, now_us);
    if (!high && device->tx_is_uart && fathom_sim_sender_idle(&device->sender)) send_break(device, now_us);
}

bool fathom_sim_device_level(const fathom_sim_device_t *device, uint32_t now_us)
{
    /* a break that set_level sends is no byte: the level is what it is */
    const bool is_break = device->sender.marked && (device->sender.marks[0] & FATHOM_RX_FRAMING) != 0;
    return device->sender.on_wire && !is_break ? fathom_sim_sender_level(&device->sender, now_us)
                                               : device->tx_high;
}

void fathom_sim_device_hold_rx(fathom_sim_device_t *device, uint8_t by, bool low, uint32_t now_us)
{
    const bool was_high = device->rx_held == 0;
    device->rx_held = (uint8_t)(low ? device->rx_held | by : device->rx_held & ~by);
    const bool high = device->rx_held == 0;
    if (high == was_high || device->alarms[POWER].set || device->model->edge == NULL) return;
    device->model->edge(device, high, now_us);
}

/* ---- power ---- */

/* It forgets what it was doing. */
static void stop(fathom_sim_device_t *device)
{
    for (uint8_t i = 0; i < FATHOM_SIM_ALARMS; i++) device->alarms[i].set = false;
    device->sender.length = device->sender.sent = 0;
    device->sender.on_wire = false;
    device->length = 0;
    device->off_us = 0;
    device->is_invalid = device->busy = device->leaving = device->in_break = device->is_raised = false;
}

void fathom_sim_device_power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    stop(device);
    if (device->model->power_on != NULL)
        device->model->power_on(device, now_us);
    else
        fathom_sim_device_set_level(device, true, now_us);
    if (device->start_us != 0) fathom_sim_device_set_alarm(device, START, now_us + device->start_us);
    if (device->period_us != 0) {
        const uint32_t first_us = now_us + device->period_us;
        fathom_sim_device_set_alarm(device, AUTOMATIC,
                                    device->model->deaf_at_start ? first_us + device->start_us : first_us);
    }
}

void fathom_sim_device_power_off(fathom_sim_device_t *device, uint32_t for_us, uint32_t now_us)
{
    stop(device);
    fathom_sim_device_set_alarm(device, POWER, now_us + for_us);
    if (device->tx_high == device->off_high) return;
    device->tx_high = device->off_high;
    if (device->watch != NULL) device->watch(device->watch_ctx, device->off_high, now_us);
}

/* ---- hearing ---- */

static bool deaf(const fathom_sim_device_t *device, bool full_duplex)
{
    const bool sending = device->sender.on_wire && !full_duplex;
    const bool starting = device->model->deaf_at_start && device->alarms[START].set;
    return !device->listens || device->busy || sending || starting || device->alarms[POWER].set;
}

void fathom_sim_device_receive_start(fathom_sim_device_t *device, uint32_t now_us)
{
    /* Several bytes may be on the line at once: they garble each other, which the line reports at their end. */
    device->others_on_wire++;
    if (device->model->strict_gap && device->alarms[SILENCE].set &&
        fathom_elapsed_us(now_us, device->heard_us) > fathom_sim_gap_us(&device->settings))
        device->is_invalid = true;
}

void fathom_sim_device_receive_end(fathom_sim_device_t *device, const fathom_line_settings_t *settings,
                                   uint8_t byte, bool good, bool full_duplex, uint32_t now_us)
{
    device->others_on_wire--;
    if (deaf(device, full_duplex)) {
        device->counters.unheard++;
        /* what was heard of a frame before is no frame any more */
        if (device->alarms[SILENCE].set) device->is_invalid = true;
        return;
    }
    if (!fathom_sim_same_settings(&device->settings, settings)) {
        device->counters.wrong_settings++;
        good = false;
    }
    if (good && device->length < FATHOM_SIM_MAX_FRAME)
        device->frame[device->length++] = byte;
    else
        device->is_invalid = true;
    device->heard_us = now_us;
    fathom_sim_device_set_alarm(device, SILENCE, now_us + fathom_sim_silence_us(&device->settings));
}

static void frame_ended(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_frame_t frame = {.bytes = device->frame, .length = device->length, .now_us = now_us};
    const bool is_invalid = device->is_invalid;
    device->length = 0;
    device->is_invalid = false;
    if (is_invalid) {
        device->counters.truncated++;
        return;
    }
    if (device->faults != NULL && device->faults->incoming != NULL)
        device->faults->incoming(device->faults->ctx, &frame);
    if (frame.length == 0) return;
    for (uint8_t i = 0; i < FATHOM_SIM_PROTOCOLS && device->protocols[i] != NULL; i++)
        if (device->protocols[i]->hear(device, frame.bytes, frame.length, now_us)) return;
}

/* ---- sending ---- */

void fathom_sim_device_reply(fathom_sim_device_t *device, const fathom_sim_protocol_t *protocol,
                             uint32_t delay_us)
{
    device->protocol = protocol;
    device->busy = true;
    /* A time that is over by now, t3.5 after the request, means at once. */
    fathom_sim_device_set_alarm(device, RESPONSE, device->heard_us + delay_us);
}

/* False: a hook kept the frame back. */
static bool send(fathom_sim_device_t *device, const fathom_line_settings_t *settings,
                 fathom_sim_frame_t *frame)
{
    fathom_sim_sender_t *const sender = &device->sender;
    if (device->faults != NULL && device->faults->outgoing != NULL)
        device->faults->outgoing(device->faults->ctx, frame);
    if (frame->length == 0) {
        if (frame->off_us != 0) fathom_sim_device_power_off(device, frame->off_us, frame->now_us);
        return false;
    }
    fathom_sim_sender_put(sender, settings, frame->bytes, frame->length, frame->now_us + frame->delay_us);
    sender->paused = frame->paused;
    sender->marked = frame->marked;
    memcpy(sender->pauses, frame->pauses, sizeof sender->pauses);
    if (frame->marked) memcpy(sender->marks, frame->marks, frame->length);
    device->own = (uint16_t)(frame->length - frame->after);
    device->off_us = frame->off_us;
    return device->own != 0;
}

/* True: TX rests low, and the host's UART makes noise of its rise; the response follows that. */
static bool rise(fathom_sim_device_t *device, uint32_t now_us)
{
    if (!device->tx_is_uart || device->tx_high || device->is_raised) return false;
    device->is_raised = true;
    send_break(device, now_us);
    fathom_sim_device_set_alarm(device, RESPONSE, now_us);
    return true;
}

static void response(fathom_sim_device_t *device, uint32_t now_us)
{
    if (rise(device, now_us)) return;
    device->is_raised = false;
    uint8_t bytes[FATHOM_SIM_MAX_FRAME];
    fathom_sim_frame_t frame = {.bytes = bytes, .now_us = now_us, .protocol = device->protocol->id};
    frame.length = device->protocol->response(device, bytes, now_us);
    device->counters.answered++;
    device->busy = send(device, &device->reply_settings, &frame);
}

static void automatic(fathom_sim_device_t *device, uint32_t was_due_us, uint32_t now_us)
{
    const fathom_sim_protocol_t *const unasked = device->model->unasked;
    uint8_t bytes[FATHOM_SIM_MAX_FRAME];
    fathom_sim_frame_t frame = {
        .bytes = bytes, .automatic = true, .now_us = now_us, .protocol = FATHOM_SIM_STREAM};
    if (device->leaving && fathom_sim_until_us(device->leave_us, now_us) == 0) return;
    /* from start to start, also where a response was in the way, and never two for one delay */
    do was_due_us += device->period_us;
    while (fathom_sim_until_us(was_due_us, now_us) == 0);
    fathom_sim_device_set_alarm(device, AUTOMATIC, was_due_us);
    if (device->model->silent != NULL && device->model->silent(device)) return;
    if (unasked != NULL) frame.protocol = unasked->id;
    frame.length = unasked != NULL ? unasked->unasked(device, bytes, now_us)
                                   : device->model->automatic(device, bytes, now_us);
    device->counters.automatic++;
    /* a new rate counts from behind the response to the command that sets it */
    send(device, device->busy ? &device->reply_settings : &device->settings, &frame);
}

/* There is silence on both sides of a Modbus frame (HPS-167S 2.2.3), also of an unsolicited one. */
static void keep_silence(fathom_sim_device_t *device, uint32_t now_us)
{
    const uint32_t silence_us = fathom_sim_silence_us(&device->sender.settings);
    for (uint8_t i = RESPONSE; i <= AUTOMATIC; i++)
        if (device->alarms[i].set && fathom_sim_until_us(device->alarms[i].at_us, now_us) < silence_us)
            device->alarms[i].at_us = now_us + silence_us;
}

void fathom_sim_device_response(fathom_sim_device_t *device, const uint8_t *bytes, uint8_t length,
                                uint32_t now_us)
{
    uint8_t copy[FATHOM_SIM_MAX_FRAME]; /* a hook may alter it */
    memcpy(copy, bytes, length);
    fathom_sim_frame_t frame = {
        .bytes = copy, .length = length, .now_us = now_us, .protocol = FATHOM_SIM_STREAM};
    device->counters.answered++;
    send(device, &device->settings, &frame);
}

void fathom_sim_device_sent(fathom_sim_device_t *device, uint32_t now_us)
{
    const bool idle = fathom_sim_sender_idle(&device->sender);
    if (idle || device->sender.sent == device->own) device->busy = device->alarms[RESPONSE].set;
    if (idle && device->model->strict_gap) keep_silence(device, now_us);
    const bool falls = !device->in_break && !device->tx_high && device->tx_is_uart;
    if (idle) device->in_break = false;
    if (idle && falls && device->off_us == 0) send_break(device, now_us);
    if (idle && device->off_us != 0) fathom_sim_device_power_off(device, device->off_us, now_us);
}

/* ---- time ---- */

/* A frame does not end while a byte is arriving, and nothing leaves before the last frame has. */
static bool held(const fathom_sim_device_t *device, uint8_t alarm)
{
    if (alarm == SILENCE) return device->others_on_wire != 0;
    return (alarm == RESPONSE || alarm == AUTOMATIC) && !fathom_sim_sender_idle(&device->sender);
}

uint32_t fathom_sim_device_due_us(const fathom_sim_device_t *device, uint32_t now_us)
{
    uint32_t due_us = FATHOM_NO_DEADLINE;
    for (uint8_t i = 0; i < FATHOM_SIM_ALARMS; i++) {
        if (!device->alarms[i].set || held(device, i)) continue;
        const uint32_t until_us = fathom_sim_until_us(device->alarms[i].at_us, now_us);
        if (until_us < due_us) due_us = until_us;
    }
    return due_us;
}

void fathom_sim_device_act(fathom_sim_device_t *device, uint32_t now_us)
{
    for (uint8_t i = 0; i < FATHOM_SIM_ALARMS; i++) {
        fathom_sim_alarm_t *const alarm = &device->alarms[i];
        if (!alarm->set || held(device, i) || fathom_sim_until_us(alarm->at_us, now_us) != 0) continue;
        alarm->set = false;
        if (i == POWER) fathom_sim_device_power_on(device, now_us);
        if (i == SILENCE) frame_ended(device, now_us);
        if (i == RESPONSE) response(device, now_us);
        if (i == AUTOMATIC) automatic(device, alarm->at_us, now_us);
        if (i == PIN) device->model->alarm(device, now_us);
        return;
    }
}
