/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_STATUS_H
#define FATHOM_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What every call that can be unfinished or fail returns. An error is below zero, so `status < 0` asks
 * for one. None of these is ever a reading: "nothing in range" and "the sensor reports that it is broken"
 * are samples (sample.h), because the device did respond.
 *
 * The numbers are part of the interface: they fit an int8_t and new ones are only added.
 */
typedef enum {
    FATHOM_READY = 1,   /* finished; the outputs are new */
    FATHOM_PENDING = 0, /* not finished: nothing was written, call again */

    FATHOM_ERR_ARGUMENT = -1,    /* the caller's values are outside what the function's comment allows */
    FATHOM_ERR_PORT = -2,        /* the HAL reports a broken port, took part of a write, or cannot send */
    FATHOM_ERR_NO_RESPONSE = -3, /* nothing that could be the response came in time */
    FATHOM_ERR_CHECKSUM = -4,    /* a response began and its CRC was wrong, or it broke off */
    FATHOM_ERR_EXCEPTION = -5,   /* the device refused with a Modbus exception; its number is beside it */
    /* a response with a right checksum that does not fit the request, or a value that this device cannot mean */
    FATHOM_ERR_MALFORMED = -6,
    FATHOM_ERR_STALE = -7,     /* a sensor that sends by itself has sent nothing good for too long */
    FATHOM_ERR_CANCELLED = -8, /* ended by cancel */
    FATHOM_ERR_BUSY = -9,      /* this object is already at work; try again when it has finished */
    FATHOM_ERR_CAPACITY = -10, /* the memory that the caller gave is too small for this request */
    /* a write: all that came equals the request; whether that is the response or an echo is not known (line.h) */
    FATHOM_ERR_ECHO = -11,
    FATHOM_ERR_UNSUPPORTED = -12, /* the port, or what carries the request, cannot do this */
    FATHOM_ERR_WARMING_UP = -13,  /* no reading yet, so soon after power-on (..._power_on was called) */
    FATHOM_ERR_UNCONFIRMED = -14, /* a setting was sent and could not be read back: it may be set, or not */
    FATHOM_ERR_IN_USE = -15,      /* a unit responds at the address that was to be set; nothing was changed */
    FATHOM_ERR_DIFFERS = -16      /* a setting was acknowledged, and reads back as another value */
} fathom_status_t;

/*
 * Its name as it stands above, without FATHOM_ and ERR_: "READY", "NO_RESPONSE"; "?" for any other number. For messages
 * and logs; it is never NULL and lies in the program's constants.
 *
 * 202 bytes of flash on a Cortex-M0+. On an AVR constants lie in RAM: 154 bytes of it; print the number there.
 * What a program does not call is not in its image.
 */
const char *fathom_status_name(fathom_status_t status);

#ifdef __cplusplus
}
#endif

#endif
