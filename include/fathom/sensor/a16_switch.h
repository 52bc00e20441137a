/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_A16_SWITCH_H
#define FATHOM_A16_SWITCH_H

#include "fathom/engine/contact.h"
#include "fathom/engine/sensor.h"
#include "fathom/sensor/a16_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * A16 with switch output (A16 4): a level on its TX pin says whether something is nearer than its threshold, 1 m
 * from the factory. It measures every 500 ms and changes the level after 3 measurements in a row below the threshold,
 * or 5 above it: 1.5 and 2.5 s. The pin has no driving capability: an input of 3 V logic reads it, no load hangs on
 * it. debounce.h is the same rule in software, for any sensor in any mode.
 *
 * A sample for the first level and for each new one: FATHOM_NEAR or FATHOM_FAR, without a distance; time_us is when
 * the level was first seen, raw is the level. The datasheet leaves open what the level is before the module's first
 * decision. A switch cannot say "no response": a cut wire reads as the level that the board pulls it to, so pull it to
 * the harmless one. The errors of fathom_poll:
 *   FATHOM_ERR_STALE  no level stood still for settle_us in stale_us: noise, or a line that is never silent
 *   FATHOM_ERR_PORT   the port of the line on the same pins is broken; returned by every poll that has no sample
 *
 * Threshold and polarity are set by Modbus on the same pins, 9600 8N1 (A16 4(1), 6(3)), with a16_settings.h on a
 * fathom_a16_modbus_t beside this driver, which need not be polled otherwise. The module receives on RX and responds on
 * TX: with a `guard` in the config (line_pins.h), the level does not count while a request is under way there, nor
 * until 5 ms after the last byte. To the host's UART a low level is a break: bytes with framing errors may stand before
 * a response and behind it, which the line drops and counts (FATHOM_LINE_BAD_BYTES). They keep it from finding out that
 * it has no echo, so configure FATHOM_LINE_ECHO_OFF: there is a wire each way. A UART that reports a break again and
 * again while it lasts makes the line look busy for ever; switch its receiver off while no request is under way.
 */

/* Read by init only; what it points to outlives the sensor. Members that are 0 mean their defaults. */
typedef struct {
    const fathom_pin_t *pin; /* reads TX */
    const fathom_clock_t *clock;
    /* Of the line on the same pins (fathom_contact_line_guard), which this driver polls too. NULL: there is none, and
     * the module gets no requests. */
    const fathom_contact_guard_t *guard;
    fathom_contact_timing_t timing; /* contact.h: how long a level stands, and so on */
    /* Low is FATHOM_NEAR: register 0x0205 is 0. false: high is, as from the factory, where "less than 1 meter" is a
     * high level (A16 4(2)). */
    bool negative;
    uint8_t address; /* its Modbus address, of the samples; 0: without Modbus */
} fathom_a16_switch_config_t;

typedef struct {
    fathom_contact_t base;
} fathom_a16_switch_t;

/* FATHOM_READY, or FATHOM_ERR_ARGUMENT: no clock, or no pin that can be read. */
fathom_status_t fathom_a16_switch_init(fathom_a16_switch_t *sensor, const fathom_a16_switch_config_t *config);

/*
 * Sets the polarity by Modbus: as fathom_a16_modbus_set_switch_polarity of `modbus`, the driver of the same module on
 * the same line, with the same return values; call it until it is not FATHOM_PENDING. Meanwhile the level does not
 * count, since it turns somewhere on the way; after FATHOM_READY it is read by the new polarity, after anything else
 * by the one before. After FATHOM_ERR_UNCONFIRMED it may be either: read it with fathom_a16_modbus_switch_polarity, and
 * call fathom_a16_switch_polarity_is.
 */
fathom_status_t fathom_a16_switch_set_polarity(fathom_a16_switch_t *sensor, fathom_a16_modbus_t *modbus,
                                               fathom_a16_polarity_t polarity);

/* The level is read by this polarity from now on: it was set or read without this driver; or setting it was given up
 * (fathom_a16_modbus_cancel). */
void fathom_a16_switch_polarity_is(fathom_a16_switch_t *sensor, fathom_a16_polarity_t polarity);

/* For fathom_poll. There is nothing to undo: forget the sensor when it is no longer polled. */
fathom_sensor_t fathom_a16_switch_sensor(fathom_a16_switch_t *sensor);

#ifdef __cplusplus
}
#endif

#endif
