/* SPDX-License-Identifier: MIT */
#include "sensors/a05.h"
#include "sensors/dyp.h"

/* The registers of the A05 (3(3)), and its command 55 AA 03 (2(3)5). */

static fathom_status_t set_every_address(reader_t *reader, const setting_t *setting, int32_t value)
{
    (void)setting;
    return fathom_a05_dyp_broadcast_address(&reader->driver.a05_dyp, (uint8_t)value);
}

/* All probes in one text: the samples of one response. */
static fathom_status_t get_distances(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    size_t length = 0;
    fathom_sample_t sample;
    (void)setting;
    fathom_status_t status = reader_poll(reader, &sample);
    if (status == FATHOM_PENDING || (status < 0 && status != FATHOM_ERR_MALFORMED)) return status;
    do {
        char one[SETTING_TEXT] = "no distance";
        dyp_print_distance(one, status, &sample);
        length +=
            (size_t)snprintf(text + length, SETTING_TEXT - length, "%s%s", length != 0 ? ", " : "", one);
        if (!reader_has_more(reader)) return FATHOM_OK;
        status = reader_poll(reader, &sample);
    } while (length < SETTING_TEXT);
    return FATHOM_OK;
}

const setting_t a05_settings[] = {
    {.name = "address",
     .what = "Modbus address (register 0x0200), also of 55 AA",
     .read_at = DYP_ADDRESS,
     .write_at = DYP_ADDRESS,
     .effect = DYP_EFFECT,
     .least = 1,
     .most = DYP_MAX_ADDRESS,
     .has_zero = true,
     .moves = true,
     .is_never_blind = true,
     .get = dyp_get,
     .set = dyp_set},
    {.name = "every-address",
     .what = "the same by 55 AA 03, which EVERY A05 on the line obeys; with --mode dyp",
     .kind = SETTING_PRESENT,
     .mode = "dyp",
     .effect = DYP_EFFECT,
     .least = 1,
     .most = DYP_MAX_ADDRESS,
     .moves = true,
     .is_never_blind = true,
     .set = set_every_address},
    {.name = "distances",
     .what = "of the four probes (0x0106 to 0x0109)",
     .read_at = FATHOM_A05_REGISTERS,
     .kind = SETTING_PRESENT,
     .unit = "mm",
     .get = get_distances},
    {.name = NULL},
};
