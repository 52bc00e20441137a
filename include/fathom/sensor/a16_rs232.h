/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_RS232_H
#define FATHOM_A16_RS232_H

#include <stdint.h>

#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with RS232 output (A16 5): it sends by itself until the first Modbus request, and from then on it only responds.
 * Power, or 1 written to register 0x0202, makes it send again; which of the two it does is not kept over power-off.
 *
 * Two drivers on one line read it, a16_auto.h and a16_modbus.h. Polling the second is what ends automatic output: the
 * response to its first request may come among frames, which go to the first driver. This here is the way back.
 */
typedef struct {
    fathom_a16_modbus_t *modbus; /* initialised; over the same line */
    fathom_a16_auto_t *automatic;
    /* How long frames may take to begin after the acknowledgement: 10 s; the caller may change it after init. */
    uint32_t return_us;
    uint32_t since_us;  /* the acknowledgement, and the time that does not count since */
    uint32_t polled_us; /* the clock at the last call */
    bool is_listening;
} fathom_a16_rs232_t;

/* The datasheet prints no period of the frames. Its "response time" of the processed value is 2.5 to 7.5 s, within
 * which that value settles; the first frame may be that late, so this is more. */
#define FATHOM_A16_RS232_DEFAULT_RETURN_US 10000000uL

/* Both drivers outlive it. */
void fathom_a16_rs232_init(fathom_a16_rs232_t *rs232, fathom_a16_modbus_t *modbus,
                           fathom_a16_auto_t *automatic);

/*
 * Reads the address, writes 1 to 0x0202 and waits for a frame, since a read would end automatic output again. Call
 * it, with the loop going on in between, until it is not FATHOM_PENDING; leave fathom_poll of both drivers alone
 * meanwhile.
 *   FATHOM_OK            *sample is the first reading that the sensor has sent by itself. From now on poll the
 *                           automatic driver only
 *   FATHOM_ERR_UNCONFIRMED  it was written, and there was no frame in return_us. Of a pause between two calls that is
 *                           longer than the stale limit of `automatic` and FATHOM_LINE_LATE_US, only the stale limit
 *                           counts: the line drops what it heard in the pause, so a frame of now confirms the return
 *   FATHOM_ERR_EXCEPTION    refused: it is no RS232 variant?
 *   FATHOM_ERR_BUSY         another command is not finished
 *   FATHOM_ERR_PORT         the port is broken
 *   others                  of fathom_a16_modbus_set_operating_mode: nothing was written
 * An acknowledgement that is lost or damaged is no error: the frames decide.
 */
fathom_status_t fathom_a16_rs232_return_to_automatic(fathom_a16_rs232_t *rs232, fathom_sample_t *sample);

/* Gives that up at any point; the next call begins anew. */
void fathom_a16_rs232_cancel(fathom_a16_rs232_t *rs232);

/* How long, in us, until that function has something to do if no byte comes. */
uint32_t fathom_a16_rs232_due_us(const fathom_a16_rs232_t *rs232);

#ifdef __cplusplus
}
#endif

#endif
