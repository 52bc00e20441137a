/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_PULSE_RIG_H
#define FATHOM_TESTS_PULSE_RIG_H

#include "drivers.h"
#include "fake_pin.h"
#include "fathom/engine/pulse.h"

/* The times of a meter. */
typedef struct {
    uint32_t cycle_us;
    uint32_t no_target_us;
    uint32_t stuck_us;
    uint16_t low_us;
    uint16_t noise_us;
} pulse_times_t;

/* A meter on fake pins, with what its polls said. */
typedef struct {
    fake_t fake;
    fake_pin_t pin;
    const fathom_capture_t
        *capture; /* this and the next members: the test's to change before it starts anew */
    const fathom_clock_t *clock;
    fathom_output_t trigger;
    pulse_times_t config;
    fathom_pulse_meter_t meter;
    fathom_pulse_reading_t last;
    unsigned readings;
    unsigned no_responses;
    unsigned port_errors;
} pulse_rig_t;

extern pulse_rig_t stand;

/* Initialises the meter as it is, with the members of the rig. */
fathom_status_t init_meter(void);

/* For cmocka: the times of an A16 with a pin, at 1000 us. */
int set_up_meter(void **state);

/* All but the config begins anew, at this time; start_meter: at 1000 us. */
void start_meter_at(uint32_t now_us);
void start_meter(void);

/* The module answers each trigger so long after its edge with so wide a pulse. */
void response_with(uint32_t after_us, uint32_t width_us);

/* One pulse that rises so long from now. */
void pulse_in(uint32_t in_us, uint32_t width_us);

/* Polls once; without a reading none may be written. */
fathom_status_t poll_meter(void);

/* Time goes on with a poll after each step; run_meter: of 100 us; run_to_trigger: to the edge, 2 ms after the start;
 * measure: from a new start, with a pulse so long after the edge, until its cycle is over. */
void run_meter_in_steps(uint32_t for_us, uint32_t step_us);
void run_meter(uint32_t for_us);
void run_to_trigger(void);
void measure(uint32_t after_us, uint32_t width_us);

#define expect_readings(n)     assert_int_equal(stand.readings, n)
#define expect_no_responses(n) assert_int_equal(stand.no_responses, n)
#define expect_falls(n)        assert_int_equal(stand.pin.falls, n)
#define expect_poll(status)    assert_int_equal(poll_meter(), status)
#define expect_due(us)         assert_int_equal(fathom_pulse_due_us(&stand.meter), us)

/* The last reading. */
void expect_last(uint8_t kind, uint32_t width_us);

#endif
