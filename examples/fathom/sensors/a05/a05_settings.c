/* SPDX-License-Identifier: MIT */
#include "sensors/a05/a05.h"
#include "sensors/dyp.h"

/* A05 2(3)5, 3(3). */

static fathom_status_t get_address(reader_t *reader, char text[SETTING_TEXT])
{
    uint8_t address = 0;
    const fathom_status_t status = fathom_a05_modbus_get_address(&reader->driver.a05_modbus, &address);
    dyp_put_number(text, status, address);
    return status;
}

static fathom_status_t set_address(reader_t *reader, int32_t value)
{
    fathom_a05_modbus_t *const driver = &reader->driver.a05_modbus;
    return value == 0 ? fathom_a05_modbus_set_address_0(driver)
                      : fathom_a05_modbus_set_address(driver, (uint8_t)value);
}

static fathom_status_t set_every_address(reader_t *reader, int32_t value)
{
    return fathom_a05_dyp_broadcast_address(&reader->driver.a05_dyp, (uint8_t)value);
}

/* All probes, as they are read: the samples of one response, one after the other. */
static fathom_status_t get_distances(reader_t *reader, char text[SETTING_TEXT])
{
    size_t length = 0;
    fathom_sample_t sample;
    fathom_status_t status = fathom_poll(&reader->sensor, &sample);
    if (status == FATHOM_PENDING || (status < 0 && status != FATHOM_ERR_MALFORMED)) return status;
    do {
        char one[SETTING_TEXT] = "no distance";
        dyp_put_distance(one, status, &sample);
        length +=
            (size_t)snprintf(text + length, SETTING_TEXT - length, "%s%s", length != 0 ? ", " : "", one);
        if (!reader_has_more(reader)) return FATHOM_OK;
        status = fathom_poll(&reader->sensor, &sample);
    } while (length < SETTING_TEXT);
    return FATHOM_OK;
}

const setting_t a05_settings[] = {
    {.name = "address",
     .what = "Modbus address (register 0x0200), of 55 AA too",
     .mode = "modbus",
     .effect = DYP_KEPT_UNSAID,
     .least = 1,
     .most = 254,
     .has_zero = true,
     .moves = true,
     .is_never_blind = true,
     .get = get_address,
     .set = set_address},
    {.name = "every-address",
     .what = "the same by 55 AA 03, which EVERY A05 on the line obeys; with --mode dyp",
     .kind = SETTING_PRESENT,
     .mode = "dyp",
     .effect = DYP_KEPT_UNSAID,
     .least = 1,
     .most = 254,
     .moves = true,
     .is_never_blind = true,
     .set = set_every_address},
    {.name = "distances",
     .what = "of the four probes",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .unit = "mm",
     .get = get_distances},
    {.name = NULL},
};
