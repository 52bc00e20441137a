/* SPDX-License-Identifier: MIT */
/* The simulated A05: its registers, its commands, and what its four probes measure. The relay is in a05_relay.c. */
#include "a05.h"

#include <string.h>

#include "fathom/codec/dyp_55aa.h"
#include "fathom/codec/dyp_stream.h"
#include "internal/switches.h"

enum { PROBES = FATHOM_DYP_PROBES, FIRST_PROBE = 0x0106, FIRST_ALIAS = 0x0010, ADDRESS = 0x0200 };

/* 1..4, or 0 when the register is no probe. */
static uint8_t probe_at(uint16_t address)
{
    if (address >= FIRST_PROBE && address < FIRST_PROBE + PROBES) return (uint8_t)(address - FIRST_PROBE + 1);
    if (address >= FIRST_ALIAS && address < FIRST_ALIAS + PROBES) return (uint8_t)(address - FIRST_ALIAS + 1);
    return 0;
}

static uint32_t refuse(fathom_sim_a05_t *a05, fathom_modbus_message_t *message, uint8_t exception)
{
    message->exception = exception;
    return a05->exceptions ? fathom_sim_device_delay_us(&a05->device, a05->settings_us) : FATHOM_NO_DEADLINE;
}

static void set_address(fathom_sim_device_t *device, uint16_t address)
{
    device->address = (uint8_t)address;
    device->counters.writes++;
    device->counters.flash_writes++;
}

static uint32_t request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    fathom_sim_a05_t *const a05 = fathom_sim_a05_of(device);
    const uint16_t address = fathom_sim_get16(message->head + 2);
    const uint16_t value = fathom_sim_get16(message->head + 4);
    const uint8_t probe = probe_at(address);
    uint32_t most_us = a05->settings_us;
    switch (message->head[1]) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        if (probe == 0 && address != ADDRESS) return refuse(a05, message, FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS);
        /* "but only up to 0x0109" (A05 3(3) remark 1) */
        if (value == 0 || value > (uint16_t)(probe == 0 ? 1 : PROBES + 1 - probe))
            return refuse(a05, message, FATHOM_MODBUS_ILLEGAL_DATA_VALUE);
        if (probe != 0) most_us = (uint32_t)(a05->probe_us * value);
        break;
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
        if (address != ADDRESS) return refuse(a05, message, FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS);
        if (value > 0xFE) return refuse(a05, message, FATHOM_MODBUS_ILLEGAL_DATA_VALUE);
        set_address(device, value);
        break;
    default: /* A05 3(1): 03 and 06 only */
        return refuse(a05, message, FATHOM_MODBUS_ILLEGAL_FUNCTION);
    }
    return fathom_sim_device_delay_us(device, most_us);
}

/* 55 AA. "t2 = 200~210ms", "65~75ms" (A05 2(3)1): the spread is 10 ms. */
static uint32_t command(fathom_sim_device_t *device, uint8_t address, uint8_t code)
{
    const fathom_sim_a05_t *const a05 = fathom_sim_a05_of(device);
    const uint32_t spread_us = 10000;
    switch (fathom_dyp_55aa_value_count(code)) {
    case PROBES:
        return fathom_sim_device_between_us(device, a05->all_us - spread_us, a05->all_us);
    case 1:
        return fathom_sim_device_between_us(device, a05->one_us - spread_us, a05->one_us);
    default:
        break;
    }
    /* The address is 01..FE (A05 2(3)2). */
    if (code != FATHOM_DYP_SET_ADDRESS || address == 0 || address == FATHOM_DYP_ANY_ADDRESS)
        return FATHOM_NO_DEADLINE;
    set_address(device, address);
    return fathom_sim_device_delay_us(device, a05->settings_us);
}

static void fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    uint8_t probe = probe_at(fathom_sim_get16(message->head + 2));
    if (probe == 0) {
        message->values[0] = device->address;
        return;
    }
    for (uint8_t i = 0; i < message->head[5]; i++, probe++)
        message->values[i] = fathom_sim_device_ultrasonic(device, probe, false, now_us); /* A05 3(3) */
}

static uint8_t automatic(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    const bool processed = !fathom_sim_a05_of(device)->selected;
    uint16_t values[PROBES];
    for (uint8_t i = 0; i < PROBES; i++)
        values[i] = fathom_sim_device_ultrasonic(device, (uint8_t)(i + 1), processed, now_us);
    return fathom_dyp_stream_encode(bytes, values, PROBES);
}

/* "The level of the RX input pin will be read and recorded within one second of power-on" (A05 1(1)): here at once. */
static void power_on(fathom_sim_device_t *device, uint32_t now_us)
{
    fathom_sim_a05_t *const a05 = fathom_sim_a05_of(device);
    fathom_sim_device_set_level(device, true, now_us);
    /* The start bits of what the host sends just then are no choice. */
    const uint8_t held = device->rx_held & (FATHOM_SIM_HELD_BY_PIN | FATHOM_SIM_HELD_BY_BREAK);
    a05->selected = a05->real_time || held != 0;
}

void fathom_sim_a05_init(fathom_sim_a05_t *a05, const fathom_sim_a05_config_t *config)
{
    static const fathom_sim_model_t model = {.request = request,
                                             .fill = fill,
                                             .automatic = automatic,
                                             .command = command,
                                             .power_on = power_on,
                                             .reading = {FIRST_PROBE, PROBES},
                                             .broadcast = 0xFF,
                                             .deaf_at_start = true};
    fathom_sim_device_t *const device = &a05->device;
    if (config->mode == FATHOM_SIM_A05_RELAY) {
        fathom_sim_a05_relay_init(a05, config);
        return;
    }
    memset(a05, 0, sizeof *a05);
    device->model = &model;
    device->faults = config->faults;
    device->scene = config->scene;
    device->processed = config->processed;
    device->settings.baud = 9600; /* 8N1 (A05 1(1), 2(1)) */
    device->settings.stop_bits = 1;
    device->start_us = config->start_us;
    device->random = config->seed;
    device->address = config->address != 0 ? config->address : 1;
    if (config->address_zero) device->address = 0;
    device->listens = true;
    device->dyp_silent_broadcast = config->dyp_silent_broadcast;
    device->protocols[0] = &fathom_sim_modbus;
    if (config->mode == FATHOM_SIM_A05_DYP) {
        device->protocols[0] = &fathom_sim_dyp;
        device->protocols[1] = &fathom_sim_modbus;
    }
    device->answers_broadcast = config->answers_broadcast;
    device->answers_from_new = config->answers_from_new;
    if (config->mode == FATHOM_SIM_A05_AUTO)
        device->period_us = fathom_sim_or_else(config->period_us, 300000);
    device->linger_us = fathom_sim_or_else(config->linger_us, 150000);
    a05->probe_us = fathom_sim_or_else(config->probe_us, 100000);
    a05->all_us = fathom_sim_or_else(config->all_us, 210000);
    a05->one_us = fathom_sim_or_else(config->one_us, 75000);
    a05->settings_us = fathom_sim_or_else(config->settings_us, 20000);
    a05->exceptions = config->exceptions;
    a05->real_time = config->real_time;
}
