/* SPDX-License-Identifier: MIT */
#ifndef PROGRAMS_H
#define PROGRAMS_H

#include "fathom/fathom.h"

/*
 * The programs whose sizes tests/bench/sizes.py measures: each reads one driver alone, the way a user would, with
 * init, fathom_poll and every command that the driver's header has; deinit and cancel, which few call, are left out.
 * PROGRAM in a file of this folder is two functions:
 *
 *   PROGRAM_begin()   what is done once; returns the sensor that main() polls
 *   PROGRAM_use()     what is done with each reading; and the commands, one after the other
 *
 * All programs stand in the same few files: what a program does not call is not linked. What it needs of RAM are the
 * variables of these files that are linked, and the linker tells their names and sizes.
 */

/* What hal.c has for all of them. A program that calls none of these has no line; one that calls listening_begin() has
 * a line that asks nothing. Echo is told, and the line counts nothing: each of that is everything.c's. */
extern fathom_line_t line;
extern fathom_modbus_t modbus;
extern uint8_t frame[32];
void line_begin(void);
void listening_begin(void);
void modbus_begin(void); /* with line_begin() */

/* Those of ../mcu.c, and those of hal.c. */
extern const fathom_uart_t uart;
extern const fathom_clock_t clock;
extern const fathom_pin_t pin;
extern const fathom_capture_t capture;

/* Registers: what a command takes, and where its outcome goes. */
extern volatile uint16_t argument;
extern volatile uint16_t outcome;
extern volatile uint8_t level;

/* The driver of that name and how its program begins: after `before`, with these parameters of init behind the driver. */
#define DRIVER(name, before, ...)                                                                            \
    static fathom_##name##_t name;                                                                           \
    fathom_sensor_t name##_begin(void)                                                                       \
    {                                                                                                        \
        before;                                                                                              \
        fathom_##name##_init(&name, __VA_ARGS__);                                                            \
        return fathom_##name##_sensor(&name);                                                                \
    }

/* A program without commands. */
#define ONLY(name, what)                                                                                     \
    void name##_use(const fathom_sample_t *sample) { outcome = sample->what; }

/* All programs, in the order of the table. sizes.py reads their names here. */
#define PROGRAMS(X)                                                                                          \
    X(a16_auto)                                                                                              \
    X(a16_auto_alarm)                                                                                        \
    X(a16_auto_median)                                                                                       \
    X(tank)                                                                                                  \
    X(tank_lying)                                                                                            \
    X(tank_table)                                                                                            \
    X(a16_controlled)                                                                                        \
    X(a16_pwm)                                                                                               \
    X(a16_pwm_edges)                                                                                         \
    X(a16_switch)                                                                                            \
    X(a16_switch_set)                                                                                        \
    X(a16_modbus)                                                                                            \
    X(a16_settings)                                                                                          \
    X(a16_rs232)                                                                                             \
    X(a05_auto)                                                                                              \
    X(a05_modbus)                                                                                            \
    X(a05_dyp)                                                                                               \
    X(a05_relay)                                                                                             \
    X(a05_relay_rule)                                                                                        \
    X(hps167s)                                                                                               \
    X(hps167s_info)                                                                                          \
    X(hps167s_settings)                                                                                      \
    X(hps167s_auto)                                                                                          \
    X(hps167_uart)

#define DECLARE(program)                                                                                     \
    fathom_sensor_t program##_begin(void);                                                                   \
    void program##_use(const fathom_sample_t *sample);
PROGRAMS(DECLARE)
#undef DECLARE

#endif
