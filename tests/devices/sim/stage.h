/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_STAGE_H
#define FATHOM_TESTS_SIM_STAGE_H

/* The drivers at the sensors on the bench (sim_bench.h): the host's half of it, with a loop that sleeps as long as it
 * may, or that comes round so often. */

#include <stdio.h>

#include "fathom/fathom.h"
#include "sim/pin.h"
#include "sim/uart.h"
#include "sim_bench.h"

enum { SECOND = 1000000, LOOPS = 4 };
static const uint32_t loops_us[LOOPS] = {0, 20 * MS, 1 * MS, 300 * MS}; /* 0: it sleeps as long as it may */

typedef enum { A16, A05, A05_DYP, HPS, ADDRESSED, HPS167 = ADDRESSED, MODELS } model_t;

typedef union {
    fathom_a16_modbus_t a16;
    fathom_a05_modbus_t a05;
    fathom_a05_dyp_t dyp;
    fathom_hps167s_t hps;
    fathom_hps167_uart_t hps167;
} driver_t;

typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_uart_t port;
    fathom_sim_pins_t pins; /* of the bench's device, where a test has taken them */
    fathom_uart_t inner;
    fathom_uart_t uart; /* the same, and it can break */
    int broken;         /* what read and write return; 0: it works */
    fathom_clock_t hal_clock;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_parts_t config;
    fathom_line_settings_t settings;
    uint8_t frame[64];
    fathom_line_t line;
    fathom_modbus_t modbus;
    model_t model;
    driver_t driver;
    fathom_sensor_t sensor; /* of that driver, or the test's */
    fathom_sample_t sample;
    uint32_t loop_us;
} stage_t;

extern stage_t s;

/* A line with a host that knows nothing of an echo, and no device. */
void stage_begin(const fathom_line_settings_t *settings, bool full_duplex, uint32_t loop_us);

/* A driver for the device of that model at that address; settings: that every request names, or NULL. */
void init_driver(driver_t *driver, model_t model, uint8_t unit, const fathom_line_settings_t *settings);
fathom_sensor_t sensor_of(driver_t *driver, model_t model);

/* 1234 mm, 2000, 1953 and 3562, one device with faults (none yet) and its driver. echo: FATHOM_LINE_ECHO_... */
void set_up(model_t model, uint8_t unit, uint32_t loop_us, uint8_t echo);

/* The line of the stage anew, told this of its echo; FATHOM_LINE_ECHO_AUTO: it finds out. Its listener stays. */
void set_echo(uint8_t echo);

/* For the driver of the stage. */
fathom_modbus_unit_t *unit_of(void);
void cancel(void);
void power_on(void);

/* Time passes: until it is due, or once round the loop. */
static inline void pass_until(uint32_t due_us)
{
    if (s.loop_us != 0)
        fathom_sim_clock_advance(&s.clock, s.loop_us);
    else
        fathom_sim_clock_idle(&s.clock, due_us);
    bench.now_us = s.clock.now_us;
}
static inline void pass(void) { pass_until(fathom_due_us(&s.sensor, 1)); }

static inline void pass_us(uint32_t by_us)
{
    fathom_sim_clock_advance(&s.clock, by_us);
    bench.now_us = s.clock.now_us;
}

static inline uint32_t since_us(uint32_t start_us) { return fathom_elapsed_us(s.clock.now_us, start_us); }

/* What takes a minute never ends. */
static inline void assert_ends(uint32_t start_us) { assert_true(since_us(start_us) <= 60 * SECOND); }

/* The next outcome of the sensor; its sample is s.sample. */
fathom_status_t measure(void);

/* Until it measures again; false: it did not in a minute. */
bool recovers(void);

/* Lets late responses and dead times pass, with nothing asked. */
void rest(uint32_t by_us);

/* Are device and driver at one address and rate? */
bool same_place(void);

/* How often the device was told something that it keeps, or was reset (by #6, which is a read; #13 is both). */
uint32_t kept_commands(void);

/* Something that is to be carried out, while an application measures in the same loop: until it has ended. */
fathom_status_t carry_out(fathom_status_t (*command)(void));
fathom_status_t round_of(fathom_status_t (*command)(void)); /* once round that loop */

/* ---- everything that can be set or asked ---- */

/* One thing to set or to ask. Whatever befalls one of them befalls all. */
typedef enum { KEPT, WRITE_ONLY, MOVES, READS } kind_t;
typedef struct {
    const char *name;
    fathom_status_t (*call)(void);
    uint32_t (*has)(void); /* what the device has */
    uint32_t before, wanted;
    model_t model;
    kind_t kind;
    uint8_t unit; /* of the device, at first */
} job_t;

extern const job_t jobs[];
extern const unsigned jobs_count;

static inline void set_up_for(const job_t *job, uint32_t loop_us, uint8_t echo)
{
    set_up(job->model, job->unit, loop_us, echo);
}

#endif
