/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* The readings of an A16, an A05 and an HPS-167S on one pair with fair_share.h, by their simulated times: 520 ms at
 * most for a processed value of the A16 and 120 for a real-time one, 400 for the A05's four probes, 18.5 from one
 * request of the HPS-167S to the next. The frames and the silence of 9600 baud are 20 to 30 ms more, and 16 of the
 * 18.5. The shares of the line and the longest waits: unit/test_fair_share.c. */

enum { SECONDS = 60, IS_A16 = 0, IS_A05, IS_HPS, SENSORS };

typedef struct {
    uint32_t hps_period_us; /* 0: as fast as it can */
    uint32_t loop_us;       /* 0: the loop sleeps as long as it may */
    uint8_t absent, dead;   /* bit: is not asked; is asked and has no power */
    fathom_dyp_value_t value;
    bool is_fair;
    /* In SECONDS: at least, at most. */
    uint32_t readings[SENSORS][2], failures[SENSORS][2];
} share_row_t;

static void shares(void **state)
{
    static const fathom_line_settings_t *const settings[SENSORS] = {&bench_9600, &bench_9600, &bench_19200};
    static fathom_a16_modbus_t a16;
    static fathom_a05_modbus_t a05;
    static fathom_hps167s_t hps;
    static fathom_fair_share_t share;
    const share_row_t *const row = *state;
    stage_begin(&bench_9600, false, row->loop_us);
    s.config.silence_us = FATHOM_T3_5_US(9600, 10);
    s.config.gap_us = 25 * MS;
    set_echo(FATHOM_LINE_ECHO_OFF);
    if (row->is_fair) fathom_fair_share(&share, &s.line);
    bench.fixed = FIXED(1000, 2000, 1953, 3562);
    add_a16(FATHOM_SIM_A16_MODBUS, (a16_config_t){.address = 1});
    add_a05(FATHOM_SIM_A05_MODBUS, (a05_config_t){.address = 2});
    add_hps((hps_config_t){.address = 7});
    fathom_sim_device_t *const devices[SENSORS] = {&bench.a16.device, &bench.a05.device, &bench.hps.device};
    const fathom_a16_modbus_config_t a16_config = {
        .modbus = {.line_settings = settings[IS_A16], .address = 1}, .value = (uint8_t)row->value};
    const fathom_a05_modbus_config_t a05_config = {
        .modbus = {.line_settings = settings[IS_A05], .address = 2}};
    const fathom_hps167s_config_t hps_config = {
        .modbus = {.line_settings = settings[IS_HPS], .address = 7, .period_us = row->hps_period_us}};
    assert_int_equal(fathom_a16_modbus_init(&a16, &s.modbus, &a16_config), FATHOM_OK);
    assert_int_equal(fathom_a05_modbus_init(&a05, &s.modbus, &a05_config), FATHOM_OK);
    assert_int_equal(fathom_hps167s_init(&hps, &s.modbus, &hps_config), FATHOM_OK);
    const fathom_sensor_t all[SENSORS] = {fathom_a16_modbus_sensor(&a16), fathom_a05_modbus_sensor(&a05),
                                          fathom_hps167s_sensor(&hps)};
    fathom_sensor_t asked[SENSORS];
    unsigned which[SENSORS], count = 0;
    uint32_t readings[SENSORS] = {0}, failures[SENSORS] = {0};
    for (unsigned i = 0; i != SENSORS; i++) {
        if ((row->dead >> i & 1) != 0) fathom_sim_detach(&bench.line, devices[i], s.clock.now_us);
        which[count] = i;
        if ((row->absent >> i & 1) == 0) asked[count++] = all[i];
    }
    for (const uint32_t start_us = s.clock.now_us; since_us(start_us) < SECONDS * SECOND;) {
        bool is_idle = true;
        for (unsigned i = 0; i != count; i++) {
            const fathom_status_t status = fathom_poll(&asked[i], &s.sample);
            if (status != FATHOM_PENDING) is_idle = false;
            failures[which[i]] += status < 0;
            readings[which[i]] += status == FATHOM_OK && s.sample.probe == 1;
        }
        if (is_idle || row->loop_us != 0) pass_until(fathom_due_us(asked, count));
    }
    for (unsigned i = 0; i != SENSORS; i++) {
        assert_in_range(readings[i], row->readings[i][0], row->readings[i][1]);
        assert_in_range(failures[i], row->failures[i][0], row->failures[i][1]);
    }
}

#define SHARE(promise, ...)                                                                                  \
    static const share_row_t promise = {__VA_ARGS__};                                                        \
    TEST_ROW(promise, shares, &promise)

static const suite_t suite = {.set_up = NULL};

/* A request takes the A16 480 to 545 ms for a processed value and 130 to 145 for a real-time one, the A05 378 to 430. */
SHARE(in_turns_the_fast_one_is_asked_once_for_each_request_of_the_others,
      .readings = {{60, 69}, {60, 69}, {60, 70}})

/* A third of the time is 31 to 36 % of it, and 18 readings a second of the HPS-167S. */
SHARE(by_a_fair_share_each_has_a_third_of_the_time, .is_fair = true,
      .readings = {{34, 45}, {43, 57}, {16 * SECONDS, 19 * SECONDS}})

/* A loop of 5 ms sees the HPS-167S's response up to 5 ms late, and asks it up to 5 later: 28.5 ms at most instead of
 * 18.5. */
SHARE(in_a_slower_loop_too, .is_fair = true, .loop_us = 5 * MS,
      .readings = {{34, 45}, {43, 57}, {11 * SECONDS, 18 * SECONDS}})

SHARE(a_real_time_a16_is_read_more_often_in_its_third, .is_fair = true, .value = FATHOM_REAL_TIME,
      .readings = {{2 * SECONDS, 3 * SECONDS}, {43, 57}, {16 * SECONDS, 19 * SECONDS}})

SHARE(alone_it_is_as_fast_as_without, .is_fair = true, .absent = 1 << IS_A16 | 1 << IS_A05,
      .readings = {[IS_HPS] = {53 * SECONDS, 55 * SECONDS}})

/* With nothing that asks as soon again, nothing is held back: each of the others has 45 to 50 %. */
SHARE(for_one_that_is_asked_five_times_a_second_the_line_is_never_idle, .is_fair = true,
      .hps_period_us = 200 * MS, .readings = {{49, 63}, {62, 80}, {2 * SECONDS, 5 * SECONDS}})

/* Of the time that a dead one leaves, since it is asked less and less often, each has its half: 40 to 46 %. */
SHARE(a_dead_one_takes_no_more_than_its_back_off_allows, .is_fair = true, .value = FATHOM_REAL_TIME,
      .dead = 1 << IS_A05, .failures = {[IS_A05] = {8, 15}},
      .readings = {{165, 213}, {0, 0}, {22 * SECONDS, 26 * SECONDS}})
