/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_rs232.h"

#include "../common.h"

/*
 * The return of an A16 with RS232 output from Modbus to automatic output. The Modbus driver writes the
 * operating mode, and the automatic driver proves it by a frame.
 */

static uint32_t now_us(const fathom_a16_rs232_t *rs232)
{
    return clock_us(rs232->modbus->base.unit.transport.line->parts->clock);
}

void fathom_a16_rs232_init(fathom_a16_rs232_t *rs232, fathom_a16_modbus_t *modbus,
                           fathom_a16_auto_t *automatic)
{
    rs232->modbus = modbus;
    rs232->automatic = automatic;
    rs232->return_us = FATHOM_A16_RS232_DEFAULT_RETURN_US;
    rs232->since_us = 0;
    rs232->polled_us = 0;
    rs232->is_listening = false;
}

static bool is_since(const fathom_a16_rs232_t *rs232, uint32_t time_us)
{
    return fathom_elapsed_us(time_us, rs232->since_us) <= (UINT32_MAX / 2u);
}

/*
 * Of a pause between two calls in which the line dropped what it heard, only the stale limit counts as waiting: the
 * sensor may have sent frames that were dropped, so the driver waits for a frame of now.
 *
 *     calls     | | | |  . . . 11 s without a call . . .  | | |
 *     counted   |<--->|<---2 s--->|                       |<-----> ... return_us
 */
static void discount_pause(fathom_a16_rs232_t *rs232)
{
    const uint32_t stale_us = rs232->automatic->base.stream.listener.stale_us;
    const uint32_t now = now_us(rs232);
    const uint32_t pause_us = time_since_us(now, rs232->polled_us);
    rs232->polled_us = now;
    if (rest_us(pause_us, FATHOM_LINE_LATE_US) > stale_us) rs232->since_us += pause_us - stale_us;
}

fathom_status_t fathom_a16_rs232_return_to_automatic(fathom_a16_rs232_t *rs232, fathom_sample_t *sample)
{
    fathom_dyp_auto_t *const automatic = &rs232->automatic->base;
    fathom_status_t status;
    if (!rs232->is_listening) {
        status = fathom_a16_modbus_set_operating_mode(rs232->modbus, FATHOM_A16_AUTOMATIC);
        /* Without an acknowledgement the mode may be set all the same. The frames decide. */
        if ((status != FATHOM_OK) && (status != FATHOM_ERR_UNCONFIRMED)) return status;
        rs232->is_listening = true;
        rs232->since_us = now_us(rs232);
        rs232->polled_us = rs232->since_us;
    }
    discount_pause(rs232);
    status = fathom_dyp_auto_take(automatic);
    /* A frame from before the command may have waited. It proves nothing. */
    if ((status == FATHOM_OK) && is_since(rs232, automatic->measurement.time_us))
        status = fathom_dyp_measurement_next(&automatic->measurement, sample);
    else if (status == FATHOM_OK)
        status = FATHOM_PENDING;
    if ((status != FATHOM_OK) && (status != FATHOM_ERR_PORT)) {
        if (fathom_elapsed_us(now_us(rs232), rs232->since_us) < rs232->return_us) return FATHOM_PENDING;
        status = FATHOM_ERR_UNCONFIRMED;
    }
    rs232->is_listening = false;
    return status;
}

void fathom_a16_rs232_cancel(fathom_a16_rs232_t *rs232)
{
    rs232->is_listening = false;
    fathom_a16_modbus_cancel(rs232->modbus);
}

uint32_t fathom_a16_rs232_due_us(const fathom_a16_rs232_t *rs232)
{
    if (!rs232->is_listening) return fathom_modbus_unit_due_us(&rs232->modbus->base.unit);
    const uint32_t due_us = fathom_dyp_auto_due_us(&rs232->automatic->base);
    const uint32_t passed_us = fathom_elapsed_us(now_us(rs232), rs232->since_us);
    return least_us(rest_us(rs232->return_us, passed_us), due_us);
}
