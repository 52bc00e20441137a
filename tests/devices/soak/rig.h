/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_RIG_H
#define FATHOM_TESTS_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "settings.h"
#include "sim/fault.h"
#include "sim/uart.h"
#include "truth.h"

/* Sensors on one simulated line with their drivers, the faults between them, and the book that is kept of what
 * was asked, said and read. Time is simulated; a turn of the loop is loop_us or, where nothing can happen, as long
 * as fathom_due_us and the simulator allow. */

enum { RIG_UNITS = 8, RIG_FRAME = 32 };

/* What the rules look at. All but the maxima are sums. */
typedef struct {
    uint64_t transactions;             /* requests that left; of streams: frames that the device sent */
    uint64_t readings;                 /* samples */
    uint64_t errors;                   /* outcomes without one */
    uint64_t lost;                     /* transactions without a reading */
    uint64_t verdicts[TRUTH_VERDICTS]; /* samples */
    uint64_t old;                      /* of them, old values of sensors that are asked */
    uint64_t wrong_responses;          /* responses and frames with a wrong sample of any other kind */
    uint64_t stuck;                    /* no outcome in the longest time, no deadline, or no progress */
    uint64_t unaccounted;              /* books that do not balance; see account.c */
    uint64_t unexplained;              /* failures that no fault explains */
    uint64_t hits[FATHOM_SIM_FAULT_END];
    uint64_t joint;      /* frames that were damaged in two ways or, without gaps, after a damaged one */
    uint64_t joint_full; /* without gaps: damaged frames beside one with FF in the place of a value */
} rig_totals_t;

typedef struct {
    soak_device_t model;
    soak_driver_t driver;
    fathom_sim_device_t *device;
    fathom_sim_fault_t fault;
    fathom_sim_faults_t hooks; /* the truth first, then the faults */
    fathom_sensor_t sensor;
    truth_t truth;
    struct rig *rig;
    uint8_t setting, address;
    /* asked: the transaction that is open, and the response that is being handed over */
    bool is_open;
    uint32_t open_us, response_us;
    uint32_t requests;        /* written */
    uint32_t responses;       /* outcomes with samples */
    uint32_t failures;        /* outcomes without */
    uint32_t samples;         /* handed over or refused for their value */
    uint32_t refused;         /* of these, the latter */
    uint32_t outcome_us;      /* when the last one came */
    uint32_t right_us;        /* when the last right reading came */
    uint32_t timeouts_in_row; /* outcomes in a row without any response */
    uint32_t trouble_end_us;  /* until then what a fault has begun goes on */
    uint32_t watched;         /* streams: frames that were looked at for their loss */
    uint32_t clean_lost;      /* of them, not read though neither they nor their neighbours were hit */
    uint32_t under_way_us;    /* until then what left last is on its way */
    uint32_t last_damage;     /* kinds of the frame before */
    bool last_full;
    int32_t wrong_sequence; /* of the last wrong sample; -1: none yet */
    uint32_t idle_turns;    /* in a row with due_us 0 and nothing coming of it */
    rig_totals_t totals;
} rig_unit_t;

typedef struct rig {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_sim_uart_t port;
    fathom_uart_t inner; /* of the port */
    fathom_uart_t uart;  /* the same, with the requests noted */
    fathom_clock_t hal_clock;
    uint16_t counters[FATHOM_LINE_COUNTERS];
    fathom_line_parts_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    uint8_t frame[RIG_FRAME];
    rig_unit_t units[RIG_UNITS];
    fathom_sensor_t sensors[RIG_UNITS];
    uint8_t count;
    uint32_t loop_us;
    soak_options_t options;
    uint32_t first_look;        /* at the scene */
    uint32_t bytes_read;        /* from the port */
    uint32_t overruns_reported; /* by the port, with bytes that are good */
} rig_t;

/* An empty line for sensors like `setting`. knows: fathom_sim_uart_t.knows. */
void rig_init(rig_t *rig, uint8_t setting, uint32_t loop_us, uint8_t knows, const soak_options_t *options);

/* One more sensor; add rules to its `fault` then. */
rig_unit_t *rig_add(rig_t *rig, uint8_t setting, uint8_t address, uint32_t seed);

/* One turn of the loop. */
void rig_turn(rig_t *rig);

/* Turns for so long. */
void rig_run(rig_t *rig, uint32_t us);

/* The longest time between two outcomes by the headers. */
uint32_t rig_patience_us(const rig_unit_t *unit);

/* From the end of all faults to the next right reading, at most, by the headers, as things stand now. */
uint32_t rig_recovery_us(const rig_unit_t *unit);

/* Closes the books of a unit: fills in what its totals still lack. */
void rig_account(rig_unit_t *unit);

/* b's figures on top of a's. */
void rig_totals_add(rig_totals_t *a, const rig_totals_t *b);

#endif
