/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_PIN_H
#define FATHOM_SIM_PIN_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "uart.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The pins of a simulated device as the host's board has them: its RX driven by a pin, its TX read as a level,
 * captured as pulses, or seen edge by edge, in simulated time. What a fathom_sim_uart_t on the same line does to RX,
 * a break or a byte, is the same wire: RX is high when none of them holds it low, and when it is not driven.
 *
 * The bits of bytes that the device sends can be seen by `get`; they make no pulses and no edges.
 */
enum { FATHOM_SIM_PULSES = 4 }; /* that wait to be taken */

/* What stands on the wire between the device's TX and the host, whatever the device does. */
typedef enum {
    FATHOM_SIM_WIRE_WHOLE = 0,
    FATHOM_SIM_WIRE_LOW = 1, /* cut, with a pull-down; or shorted to ground */
    FATHOM_SIM_WIRE_HIGH = 2 /* stuck high */
} fathom_sim_tx_wire_t;

typedef struct {
    fathom_sim_line_t *line;
    fathom_sim_device_t *device;
    fathom_sim_clock_t *clock;
    uint32_t began_us; /* with `began`: the rising edge */
    bool began;        /* in a pulse whose rising edge was after arm */
    bool armed;
    bool high;     /* of TX, as the host's end of the wire has it */
    uint8_t wire;  /* fathom_sim_tx_wire_t */
    uint8_t first; /* of `pulses` */
    uint8_t waiting;
    uint16_t lost; /* pulses that found no room; the caller may set it to 0 */
    fathom_pulse_t pulses[FATHOM_SIM_PULSES];

    /* The caller's to set: a pin interrupt. Called within whatever lets the simulated time pass, in the order of
     * time, with the HAL's clock at the edge; it may not call into the simulation. */
    void (*on_edge)(void *ctx, bool high, uint32_t time_us);
    void *on_edge_ctx;
} fathom_sim_pins_t;

/* Puts `line` on `clock` if it is not there, and takes the pins of `device`, which has been initialised and hangs on
 * `line` or will; all outlive the pins. One such struct a device. */
void fathom_sim_pins_init(fathom_sim_pins_t *pins, fathom_sim_device_t *device, fathom_sim_line_t *line,
                          fathom_sim_clock_t *clock);

fathom_pin_t fathom_sim_rx_pin(fathom_sim_pins_t *pins);      /* set */
fathom_pin_t fathom_sim_tx_pin(fathom_sim_pins_t *pins);      /* get */
fathom_capture_t fathom_sim_capture(fathom_sim_pins_t *pins); /* holds FATHOM_SIM_PULSES */

/* The wire from the device's TX pin breaks, sticks or is mended: from now on, with the edges that this makes. A pulse
 * of noise is high and whole again a moment later. */
void fathom_sim_tx_wire(fathom_sim_pins_t *pins, fathom_sim_tx_wire_t wire);

#ifdef __cplusplus
}
#endif

#endif
