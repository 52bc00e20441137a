/* SPDX-License-Identifier: MIT */
/* The settings of the simulated HPS-167S: commands #7 to #15 of its manual. */
#include "internal/hps167s_parts.h"

enum {
    WARM_UP = 0x000A,     /* #7 */
    UNIT = 0x0010,        /* #8 */
    BAUD = 0x0011,        /* #9 */
    AUTO_OUTPUT = 0x0012, /* #10 */
    TERMINATION = 0x0013, /* #11 */
    OFFSET = 0x0014,      /* #12 */
    LOAD = 0x0015,        /* #13 */
    FILTER = 0x0016,      /* #14 */
    RECONNECT = 0x0020    /* #15 */
};
enum { HEAD_ADDRESS = 2, HEAD_VALUE = 4, RECONNECT_LENGTH = 2 };
enum { FACTORY_WARM_UP_S = 5, MOST_WARM_UP_S = 255, MOST_UNIT = 32, MOST_BAUD_CODE = 4 };
enum { OFF = 0x0000, ON = 0x00FF, USER = 0x0000, FACTORY = 0x00FF };
enum { RECONNECT_STEP_MS = 18 };

static int16_t to_signed(uint16_t value)
{
    return (int16_t)(value < 0x8000 ? (int32_t)value : (int32_t)value - 0x10000);
}

/* ---- the rate ---- */

static uint32_t rate(uint8_t baud_code)
{
    switch (baud_code) { /* #9: "the others are all 19200bps" */
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

void fathom_sim_hps167s_set_rate(fathom_sim_hps167s_t *hps)
{
    hps->device.settings.baud = rate(hps->baud_code);
}

/* ---- power ---- */

void fathom_sim_hps167s_wait_for_data(fathom_sim_hps167s_t *hps, uint32_t now_us)
{
    const uint32_t most_ms = 1800000; /* what an alarm can be ahead */
    const uint32_t wait_ms = hps->reconnect_ms < most_ms ? hps->reconnect_ms : most_ms;
    fathom_sim_device_set_alarm(&hps->device, FATHOM_SIM_ALARM_LOST, now_us + wait_ms * 1000);
}

void fathom_sim_hps167s_power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_hps167s_t *const hps = fathom_sim_hps167s_of(device);
    fathom_sim_device_set_level(device, true, now_us);
    fathom_sim_hps167s_set_rate(hps);
    hps->measuring = hps->auto_output;
    hps->terminated = hps->termination;
    device->start_us = hps->warm_up_s * UINT32_C(1000000);
    device->period_us = hps->measuring ? hps->unasked_us : 0;
    if (hps->lost) fathom_sim_hps167s_wait_for_data(hps, now_us);
}

/* ---- commands ---- */

/* "Restore all settings of the RS485 interface" (table 8). The rate and the address act at once, as after #8
 * and #9; what acts from the next power-on does so here too. */
void fathom_sim_hps167s_reset(fathom_sim_hps167s_t *hps)
{
    hps->device.address = FATHOM_SIM_HPS167S_UNIT;
    hps->baud_code = FATHOM_SIM_HPS167S_BAUD_CODE;
    fathom_sim_hps167s_set_rate(hps);
    hps->warm_up_s = FACTORY_WARM_UP_S;
    hps->reconnect_ms = FATHOM_SIM_HPS167S_RECONNECT_MS;
    hps->termination = true;
    hps->auto_output = true;
    hps->device.counters.resets++;
    hps->device.counters.flash_writes++;
}

static bool set_baud(fathom_sim_hps167s_t *hps, uint16_t value)
{
    const bool known = value >= 1 && value <= MOST_BAUD_CODE;
    hps->baud_code = (uint8_t)(known ? value : FATHOM_SIM_HPS167S_BAUD_CODE);
    if (!hps->baud_at_power_on) fathom_sim_hps167s_set_rate(hps);
    return true;
}

static bool set_switch(bool *setting, uint16_t value)
{
    if (value != OFF && value != ON) return false;
    *setting = value == ON;
    return true;
}

static bool set_offset(fathom_sim_hps167s_t *hps, uint16_t value)
{
    int32_t offset_mm = to_signed(value);
    if (hps->offset_adds) offset_mm += hps->sensor.offset_mm;
    if (offset_mm > INT16_MAX) offset_mm = INT16_MAX;
    if (offset_mm < INT16_MIN) offset_mm = INT16_MIN;
    hps->sensor.offset_mm = hps->user.offset_mm = (int16_t)offset_mm;
    return true;
}

static bool load(fathom_sim_hps167s_t *hps, uint16_t value)
{
    const fathom_sim_hps167s_sensor_t factory = {0, 0};
    if (value != USER && value != FACTORY) return false;
    hps->sensor = value == USER ? hps->user : factory;
    if (value == FACTORY) hps->device.counters.resets++;
    return true;
}

/* False: the command does not have the value. */
static bool set(fathom_sim_hps167s_t *hps, uint16_t address, uint16_t value)
{
    switch (address) {
    case WARM_UP:
        if (value > MOST_WARM_UP_S) return false;
        hps->warm_up_s = (uint8_t)value;
        return true;
    case UNIT:
        if (value == 0 || value > MOST_UNIT) return false;
        hps->device.address = (uint8_t)value;
        return true;
    case BAUD:
        return set_baud(hps, value);
    case AUTO_OUTPUT:
        return set_switch(&hps->auto_output, value);
    case TERMINATION:
        return set_switch(&hps->termination, value);
    case OFFSET:
        return set_offset(hps, value);
    case LOAD:
        return load(hps, value);
    default: /* #14 */
        hps->sensor.filter = hps->user.filter = to_signed(value);
        return true;
    }
}

static void obey(fathom_sim_hps167s_t *hps)
{
    hps->device.counters.writes++;
    hps->device.counters.flash_writes++;
}

void fathom_sim_hps167s_write(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message)
{
    const uint16_t address = fathom_sim_get16(message->head + HEAD_ADDRESS);
    if (address != WARM_UP && (address < UNIT || address > FILTER)) {
        message->exception = FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
        if (address == FATHOM_SIM_HPS167S_RESET) hps->device.counters.resets_refused++;
    } else if (!set(hps, address, fathom_sim_get16(message->head + HEAD_VALUE))) {
        message->exception = hps->wrong_value;
    } else {
        obey(hps);
    }
}

void fathom_sim_hps167s_write_many(fathom_sim_hps167s_t *hps, fathom_modbus_message_t *message)
{
    const uint16_t address = fathom_sim_get16(message->head + HEAD_ADDRESS);
    if (address != RECONNECT) {
        message->exception = FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
        if (address == FATHOM_SIM_HPS167S_RESET) hps->device.counters.resets_refused++;
        return;
    }
    /* the codec minds a count beyond what is kept here, and one that does not go with the bytes */
    if (message->exception != 0 || fathom_sim_get16(message->head + HEAD_VALUE) != RECONNECT_LENGTH) {
        message->exception = hps->wrong_length;
        return;
    }
    const uint32_t reconnect_ms = (uint32_t)message->values[0] << 16 | message->values[1];
    if (reconnect_ms % RECONNECT_STEP_MS != 0) { /* "an integer multiple of 18" */
        message->exception = hps->wrong_value;
        return;
    }
    hps->reconnect_ms = reconnect_ms;
    obey(hps);
}
