/* SPDX-License-Identifier: MIT */
#ifndef FIRST_BOARD_H
#define FIRST_BOARD_H

#include "board_bus.h" /* board_bus_t: the bus of the port, whose members `line` and `modbus` drivers use */
#include "fathom/engine/output.h"
#include "fathom/engine/sensor.h"

/*
 * What differs from machine to machine in a first program. NAME/board.c of each machine says at its top how the sensor
 * is wired. `argc` and `argv` are those of main(), and only Linux reads them.
 */

/* Opens the line for sensors that get requests. Returns false, after a message if the machine has a screen, if it
 * fails. */
bool board_open(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv);

/* Opens the line for sensors that send by themselves. */
bool board_open_listening(board_bus_t *bus, const fathom_line_settings_t *settings, int argc, char **argv);

/* Waits for the next reading or error. */
fathom_status_t board_read(board_bus_t *bus, fathom_sensor_t sensor, fathom_sample_t *sample);

/* The pins of a sensor without a line. */
typedef struct {
    fathom_pin_t contact;     /* the level of a switch or a relay */
    fathom_capture_t capture; /* the pulses of an A16 with PWM output */
    fathom_output_t trigger;  /* the RX of the same A16 */
    fathom_clock_t clock;
} board_pins_t;

/* Opens the pin of a contact: sets `contact` and `clock`. */
bool board_open_contact(board_pins_t *pins, int argc, char **argv);

/* Opens the pins of a pulse and its trigger: sets `capture`, `trigger` and `clock`. */
bool board_open_pulse(board_pins_t *pins, int argc, char **argv);

/* Waits for the next reading or error of a sensor at these pins. */
fathom_status_t board_read_pins(board_pins_t *pins, fathom_sensor_t sensor, fathom_sample_t *sample);

/* Prints a line: the reading, or the error. */
void board_print(fathom_status_t status, const fathom_sample_t *sample);

#endif
