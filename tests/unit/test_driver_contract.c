/* SPDX-License-Identifier: MIT */
#include "contract.h"

#include "auto_rig.h"
#include "desk.h"
#include "fake_modbus.h"

/* What every polled driver promises, as far as its kind goes: one test a promise and driver. */

enum { START_US = 1000, TRIES = 5 };

static const contract_driver_t *driver;
static const contract_kind_t *kind;

static void begin_at(uint32_t now_us)
{
    kind->begin(now_us);
    driver->prepare();
}

static void start(void)
{
    assert_int_equal(driver->init(), FATHOM_OK);
    *kind->sensor = driver->sensor();
}

static int set_up(void **state)
{
    driver = *state;
    kind = driver->kind;
    begin_at(START_US);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

#define OF(promise, name)  TEST_ROW(promise##_of_##name, promise, &contract_##name)
#define TRANSPORT(promise) OF(promise, a05_modbus) OF(promise, a16_modbus) OF(promise, hps167s)
#define LISTENERS(promise) OF(promise, a05_auto) OF(promise, a16_auto) OF(promise, hps167s_auto)
#define CONTACTS(promise)  OF(promise, a05_relay) OF(promise, a16_switch)
#define DYP_VALUES(promise)                                                                                  \
    OF(promise, a05_auto)                                                                                    \
    OF(promise, a05_dyp)                                                                                     \
    OF(promise, a05_modbus) OF(promise, a16_auto) OF(promise, a16_controlled) OF(promise, a16_modbus)
#define MEASURING(promise)                                                                                   \
    TRANSPORT(promise)                                                                                       \
    LISTENERS(promise)                                                                                       \
    OF(promise, a05_dyp) OF(promise, hps167_uart) OF(promise, a16_controlled) OF(promise, a16_pwm)
#define ALL(promise) MEASURING(promise) CONTACTS(promise)

#define CONTRACT(promise, drivers)                                                                           \
    static void promise(void **state);                                                                       \
    drivers(promise) static void promise(void **state)

static fathom_status_t says(uint16_t value) { return kind->says(driver, value); }

static void reads(uint16_t value) { assert_int_equal(says(value), FATHOM_OK); }
static void refuses(uint16_t value) { assert_int_equal(says(value), FATHOM_ERR_MALFORMED); }

static fathom_status_t poll_after(uint32_t us)
{
    *kind->now_us += us;
    return kind->poll();
}

/* ---- setting up ---- */

static void put(void *member, size_t size, uint32_t value)
{
    if (value == 0)
        memset(member, 0, size); /* a pointer, or a number of any size */
    else if (size == sizeof(uint8_t))
        *(uint8_t *)member = (uint8_t)value;
    else if (size == sizeof(uint16_t))
        memcpy(member, &(uint16_t){(uint16_t)value}, size);
    else
        memcpy(member, &value, size);
}

static void assert_zeroed(void)
{
    const uint8_t *at = driver->memory;
    for (size_t left = driver->size; left != 0; left--) assert_int_equal(*at++, 0);
}

/* FNV-1a of the driver's memory; a copy would need more RAM than an AVR has. */
static uint32_t hash_of_driver(void)
{
    const uint8_t *at = driver->memory;
    uint32_t hash = 2166136261u;
    for (size_t left = driver->size; left != 0; left--) hash = (hash ^ *at++) * 16777619u;
    return hash;
}

CONTRACT(each_wrong_argument_is_refused_and_the_port_is_not_used, ALL)
{
    for (const contract_wrong_t *wrong = driver->wrong; wrong->what != NULL; wrong++) {
        for (uint32_t value = wrong->from; value <= wrong->to; value++) {
            begin_at(START_US);
            put(wrong->member, wrong->size, value);
            if (driver->init() != FATHOM_ERR_ARGUMENT) fail_msg("%s %lu", wrong->what, (unsigned long)value);
            assert_zeroed();
            assert_false(kind->is_used());
        }
    }
    begin_at(START_US);
    start();
}

CONTRACT(without_a_config_the_driver_is_that_of_a_zeroed_config, ALL)
{
    memset(driver->config, 0, driver->config_size);
    start();
    const uint32_t hash = hash_of_driver();
    begin_at(START_US);
    memset(driver->config, 0x5A, driver->config_size);
    assert_int_equal(driver->init_without_config(), FATHOM_OK);
    assert_int_equal(hash_of_driver(), hash);
}

CONTRACT(without_a_config_the_parameters_are_needed_all_the_same, ALL)
{
    for (const contract_wrong_t *wrong = driver->wrong; wrong->what != NULL; wrong++) {
        const uint8_t *const member = wrong->member;
        const uint8_t *const config = driver->config;
        if (wrong->is_fact) continue;
        if (member >= config && member < config + driver->config_size) continue;
        begin_at(START_US);
        put(wrong->member, wrong->size, wrong->from);
        assert_int_equal(driver->init_without_config(), FATHOM_ERR_ARGUMENT);
        assert_zeroed();
        assert_false(kind->is_used());
    }
}

static void until_at_work(void)
{
    for (unsigned polls = 0; !kind->is_at_work(); polls++) {
        assert_true(polls < 20000);
        PENDS(poll_after(200));
    }
}

CONTRACT(deinit_gives_up_what_is_under_way_once, MEASURING)
{
    start();
    until_at_work();
    driver->deinit();
    assert_false(kind->is_at_work());
    driver->deinit();
    assert_false(kind->is_at_work());
    start();
    reads(driver->good);
}

/* ---- samples ---- */

static void assert_reading(uint16_t sequence)
{
    fathom_sample_t should = driver->sample;
    should.time_us = kind->sample->time_us;
    assert_in_range(should.time_us - contract_came_us, 0, contract_slack_us);
    should.sequence = sequence;
    should.probe = 1;
    assert_sample(kind->sample, should);
}

CONTRACT(a_sample_has_all_its_members, ALL)
{
    start();
    reads(driver->good);
    assert_reading(1);
    PENDS(kind->poll());
}

/* ---- polling without a sensor ---- */

static fathom_status_t poll_directly(void *ctx, fathom_sample_t *sample)
{
    (void)ctx;
    return driver->poll(sample);
}

static uint32_t due_us_directly(void *ctx)
{
    const fathom_sensor_t sensor = driver->sensor();
    (void)ctx;
    const uint32_t due_us = driver->due_us();
    assert_int_equal(due_us, fathom_due_us(&sensor, 1));
    return due_us;
}

CONTRACT(a_poll_of_the_driver_is_that_of_its_sensor, ALL)
{
    start();
    *kind->sensor = (fathom_sensor_t){poll_directly, due_us_directly, NULL};
    (void)fathom_due_us(kind->sensor, 1);
    reads(driver->good);
    assert_reading(1);
    (void)fathom_due_us(kind->sensor, 1);
    PENDS(kind->poll());
    (void)fathom_due_us(kind->sensor, 1);
}

CONTRACT(a_poll_of_a_driver_in_zeroed_memory_is_an_error_and_due_at_once, ALL)
{
    fathom_sample_t sample;
    memset(driver->memory, 0, driver->size);
    assert_int_equal(driver->poll(&sample), FATHOM_ERR_ARGUMENT);
    assert_int_equal(driver->due_us(), 0);
}

CONTRACT(the_sequence_counts_samples_and_wraps, MEASURING)
{
    start();
    for (uint16_t i = 1; i <= 3; i++) {
        reads(driver->good);
        assert_reading(i);
    }
    *driver->sequence = UINT16_MAX - 1;
    for (unsigned i = 0; i != 3; i++) {
        reads(i % 2 != 0 ? driver->good : driver->other);
        assert_int_equal(kind->sample->sequence, (uint16_t)(UINT16_MAX + i));
    }
}

static unsigned kind_of(uint16_t value)
{
    reads(value);
    assert_int_equal(kind->sample->raw, value);
    assert_int_equal(kind->sample->distance_mm, kind->sample->kind == FATHOM_TARGET ? value : 0);
    assert_int_equal(kind->sample->interference, value == 0xFFFE && kind->sample->kind == FATHOM_NO_TARGET);
    return kind->sample->kind;
}

/* First contact 4: nothing says what 0 is. dyp.h: FFFD is no target, FFFE is interference. */
CONTRACT(values_are_target_no_target_unknown_or_refused, DYP_VALUES)
{
    start();
    assert_int_equal(kind_of(1), FATHOM_TARGET);
    assert_int_equal(kind_of(driver->max_mm), FATHOM_TARGET);
    assert_int_equal(kind_of(0), FATHOM_UNKNOWN);
    assert_int_equal(kind_of(0xFFFD), FATHOM_NO_TARGET);
    assert_int_equal(kind_of(0xFFFE), FATHOM_NO_TARGET);
    assert_int_equal(kind->sample->sequence, 5);
    refuses(driver->refused);
    refuses(0xFFFC);
    refuses(0xFFFF);
    assert_int_equal(*driver->implausible, 3);
    assert_int_equal(kind_of(driver->good), FATHOM_TARGET);
    assert_int_equal(kind->sample->sequence, 9);
}

CONTRACT(a_window_of_the_users_own_is_kept, DYP_VALUES)
{
    driver->facts->min_mm = 500;
    driver->facts->max_mm = 1500;
    start();
    refuses(499);
    refuses(1501);
    assert_int_equal(kind_of(500), FATHOM_TARGET);
    assert_int_equal(kind_of(1500), FATHOM_TARGET);
}

CONTRACT(each_of_the_four_values_means_what_the_user_says, DYP_VALUES)
{
    driver->facts->value_0 = FATHOM_MEANS_TOO_NEAR;
    driver->facts->value_fffd = FATHOM_MEANS_REFUSED;
    driver->facts->value_fffe = FATHOM_MEANS_NO_TARGET;
    driver->facts->value_ffff = FATHOM_MEANS_FAULT;
    start();
    assert_int_equal(kind_of(0), FATHOM_NEAR);
    refuses(0xFFFD);
    reads(0xFFFE);
    assert_int_equal(kind->sample->kind, FATHOM_NO_TARGET);
    assert_false(kind->sample->interference);
    assert_int_equal(kind_of(0xFFFF), FATHOM_FAULT);
}

#define REFUSING(promise)                                                                                    \
    TRANSPORT(promise) LISTENERS(promise) OF(promise, a05_dyp) OF(promise, a16_controlled)

CONTRACT(refused_values_are_counted_and_the_count_stops_at_65535, REFUSING)
{
    start();
    refuses(driver->refused);
    assert_int_equal(*driver->implausible, 1);
    *driver->implausible = 65534;
    for (unsigned i = 0; i != 3; i++) {
        refuses(driver->refused);
        assert_int_equal(*driver->implausible, 65535);
    }
    reads(driver->good);
    assert_int_equal(kind->sample->sequence, driver->facts != NULL ? 5 : 1);
}

/* ---- the port ---- */

CONTRACT(a_broken_port_is_said_by_every_poll_until_it_works_again, REFUSING)
{
    fathom_status_t status = FATHOM_PENDING;
    start();
    reads(driver->good);
    kind->breaks(true);
    for (unsigned i = 0; i != 5; i++) assert_int_equal(poll_after(100 * MS), FATHOM_ERR_PORT);
    kind->breaks(false);
    for (unsigned tries = 0; status != FATHOM_OK; tries++) {
        assert_true(tries < TRIES);
        status = says(driver->other); /* an error may be of what was under way */
    }
    assert_int_equal(kind->sample->sequence, 2);
}

/* ---- asking ---- */

static void assert_asked(unsigned submits, uint8_t unit)
{
    fake_modbus_assert_asked(&fake, submits, unit, driver->first, driver->count);
}

CONTRACT(by_default_it_asks_unit_1_without_retries, TRANSPORT)
{
    start();
    PENDS(kind->poll());
    assert_asked(1, 1);
    assert_int_equal(fake.request->transaction.timeout_us, driver->default_timeout_us);
    assert_int_equal(fake.request->transaction.retries, 0);
    assert_null(fake.request->transaction.line_settings);
}

CONTRACT(the_config_is_asked_as_it_says_and_read_by_init_only, TRANSPORT)
{
    *driver->address = driver->most_address;
    *driver->timeout_us = 77000;
    *driver->retries = 3;
    start();
    *driver->address = 7;
    *driver->timeout_us = 88000;
    *driver->retries = 4;
    for (unsigned i = 1; i <= 2; i++) {
        PENDS(poll_after(2000000));
        assert_asked(1, driver->most_address);
        assert_int_equal(fake.request->transaction.timeout_us, 77000);
        assert_int_equal(fake.request->transaction.retries, 3);
        reads(driver->good);
        assert_int_equal(kind->sample->address, driver->most_address);
    }
}

CONTRACT(the_pace_is_the_period_but_no_faster_than_the_device, TRANSPORT)
{
    const uint32_t least_us = driver->least_period_us;
    const uint32_t periods_us[] = {0, 1, least_us - 1, least_us + 1, 5000000};
    for (unsigned i = 0; i != COUNT(periods_us); i++) {
        const uint32_t pace_us = periods_us[i] > least_us ? periods_us[i] : least_us;
        begin_at(START_US);
        *driver->period_us = periods_us[i];
        start();
        reads(driver->good); /* it left in the same poll */
        assert_int_equal(fathom_due_us(kind->sensor, 1), pace_us);
        PENDS(poll_after(pace_us - 1));
        assert_int_equal(fake.submits, 0);
        assert_int_equal(fathom_due_us(kind->sensor, 1), 1);
        PENDS(poll_after(1));
        assert_int_equal(fake.submits, 1);
    }
}

CONTRACT(every_error_passes_through_and_leaves_the_sample_alone, TRANSPORT)
{
    /* No response comes last: after three of them the unit is left alone for a while. */
    static const fathom_status_t errors[] = {FATHOM_ERR_CHECKSUM,  FATHOM_ERR_EXCEPTION,
                                             FATHOM_ERR_MALFORMED, FATHOM_ERR_PORT,
                                             FATHOM_ERR_CANCELLED, FATHOM_ERR_NO_RESPONSE};
    start();
    for (unsigned i = 0; i != COUNT(errors); i++) {
        PENDS(poll_after(500000));
        fake.exception = (uint8_t)(2 + i);
        fake_modbus_fail(&fake, errors[i]);
        assert_int_equal(poll_after(1000), errors[i]);
        assert_int_equal(driver->exception(), errors[i] == FATHOM_ERR_EXCEPTION ? 3 : 0);
        assert_int_equal(fathom_modbus_unit_failures(driver->unit()), i + 1);
        PENDS(kind->poll());
    }
    fake.refuses = FATHOM_ERR_CAPACITY;
    assert_int_equal(poll_after(500000), FATHOM_ERR_CAPACITY);
    fake.refuses = FATHOM_PENDING;
    reads(driver->good);
    assert_reading(1);
    assert_int_equal(fathom_modbus_unit_responses(driver->unit()), 1);
}

CONTRACT(a_command_has_its_own_time_out_and_can_be_cancelled, TRANSPORT)
{
    static const uint32_t timeouts_us[][2] = {{0, 1000000}, {123456, 123456}};
    for (unsigned i = 0; i != 2; i++) {
        begin_at(START_US);
        *driver->command_timeout_us = timeouts_us[i][0];
        *driver->retries = 3;
        start();
        PENDS(driver->command());
        assert_int_equal(fake.request->transaction.timeout_us, timeouts_us[i][1]);
        assert_int_equal(fake.request->transaction.retries, 3);
        driver->cancel();
        driver->cancel();
        assert_int_equal(fake.cancels, 1);
        PENDS(poll_after(driver->least_period_us));
        assert_asked(2, 1);
    }
}

/* Four silences, each 2 s after its request: the pause is two time-outs then, or what the config says. */
CONTRACT(a_dead_device_is_left_alone_no_longer_than_its_config_says, TRANSPORT)
{
    *driver->backoff_us = 123456;
    start();
    for (unsigned n = 0; n != 4; n++) {
        if (n != 0) *kind->now_us += fathom_due_us(kind->sensor, 1);
        PENDS(kind->poll());
        fake_modbus_send(&fake);
        PENDS(kind->poll());
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(poll_after(2000000), FATHOM_ERR_NO_RESPONSE);
    }
    assert_int_equal(fathom_due_us(kind->sensor, 1), 123456);
}

#define STARTED(promise) OF(promise, a05_modbus) OF(promise, a16_modbus)

/* What was under way is forgotten; silence is no error for 1.5 s, or as long as the config says. */
CONTRACT(after_power_on_silence_is_warming_up_for_start_us, STARTED)
{
    static const uint32_t starts_us[][2] = {{0, 1500000}, {700000, 700000}};
    for (unsigned i = 0; i != 4; i++) {
        const bool is_late = i % 2 != 0;
        begin_at(START_US);
        *driver->start_us = starts_us[i / 2][0];
        start();
        PENDS(kind->poll());
        driver->power_on();
        assert_false(kind->is_at_work());
        PENDS(poll_after(driver->least_period_us));
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
        assert_int_equal(poll_after(starts_us[i / 2][1] - driver->least_period_us - !is_late),
                         is_late ? FATHOM_ERR_NO_RESPONSE : FATHOM_ERR_WARMING_UP);
    }
}

/* ---- listening ---- */

CONTRACT(every_frame_is_one_sample_in_loops_from_100_us_to_20_ms, LISTENERS)
{
    static const uint32_t steps_us[] = {100, 521, 1042, 3333, 10000, 20000};
    for (unsigned i = 0; i != COUNT(steps_us); i++) {
        begin_at(START_US);
        start();
        for (unsigned n = 1; n <= 20; n++) {
            const uint16_t value = n % 2 != 0 ? driver->good : driver->other;
            uint8_t frame[RIG_HPS_LENGTH];
            rig_send(frame, driver->frame(frame, value), steps_us[i]);
            rig_run(steps_us[i], steps_us[i]); /* the last byte may have come after the last poll */
            assert_int_equal(rig.samples, n);
            assert_int_equal(rig.sample.sequence, n);
            assert_int_equal(rig.sample.distance_mm, value);
        }
        assert_int_equal(rig.stales + rig.malformed + rig.ports, 0);
    }
}

CONTRACT(it_works_across_the_wrap_of_the_clock, LISTENERS)
{
    for (uint32_t before_us = 0; before_us <= 300000; before_us += 30000) {
        begin_at(UINT32_MAX - before_us);
        start();
        for (uint16_t n = 1; n <= 3; n++) {
            reads(driver->good);
            assert_reading(n);
        }
        assert_int_equal(rig.stales, 0);
    }
}

/* stream.h, rule 5; hps167s_auto.h: FATHOM_ERR_CHECKSUM if bytes arrived. Zeros are in no frame. */
CONTRACT(zeros_for_8_s_are_damage_and_silence_is_stale, LISTENERS)
{
    static const uint8_t zeros[10];
    start();
    rig_poll(); /* the port is seen empty */
    for (unsigned ms = 0; ms != 8000; ms += 10) {
        fake_receive(&rig.fake, 0, zeros, sizeof zeros);
        rig.fake.now_us += 10 * MS;
        rig_poll();
    }
    assert_int_equal(rig.damaged, 4); /* once each 2 s */
    assert_int_equal(rig.stales, 0);
    rig_run(2000 * MS, 5000); /* nothing */
    assert_int_equal(rig.stales, 1);
    reads(driver->good);
    rig_run(2000 * MS, 5000);
    assert_int_equal(rig.stales, 2);
}

/* line.h, rule 14: what waited in the port in a pause may be as old as the pause. */
CONTRACT(a_frame_that_waited_in_the_port_for_300_s_is_no_sample, LISTENERS)
{
    uint8_t frame[RIG_HPS_LENGTH];
    const size_t length = driver->frame(frame, driver->good);
    for (unsigned is_initialised_again = 0; is_initialised_again != 2; is_initialised_again++) {
        begin_at(START_US);
        start();
        reads(driver->good);
        fake_receive(&rig.fake, 0, frame, length);
        rig.fake.now_us += 300000000;
        if (is_initialised_again != 0) start();
        assert_int_equal(kind->poll(), is_initialised_again != 0 ? FATHOM_PENDING : FATHOM_ERR_STALE);
        rig_run(20000, 1000);
        assert_int_equal(rig.samples, 1);
        rig.silent_us = 0;
        reads(driver->other);
        assert_int_equal(rig.sample.time_us, contract_came_us);
    }
}

/* stream.h, rule 6: the same in the driver, where another user of the line has polled the line meanwhile. */
CONTRACT(a_frame_that_waited_in_the_driver_is_a_sample_until_2500_ms, LISTENERS)
{
    uint8_t frame[RIG_HPS_LENGTH];
    const size_t length = driver->frame(frame, driver->good);
    for (uint32_t waits_us = 2500 * MS; waits_us <= 2510 * MS; waits_us += 10 * MS) {
        begin_at(START_US);
        start();
        rig_run(20000, 1000);
        fake_receive(&rig.fake, 0, frame, length);
        (void)fathom_line_poll(&rig.line);
        for (uint32_t us = 0; us < waits_us; us += 10 * MS) {
            rig.fake.now_us += 10 * MS;
            (void)fathom_line_poll(&rig.line);
        }
        assert_int_equal(kind->poll(), waits_us == 2500 * MS ? FATHOM_OK : FATHOM_ERR_STALE);
    }
}

CONTRACT(it_is_stale_in_time_or_as_the_config_says_and_once_each_time, LISTENERS)
{
    static const uint32_t starts_us[] = {START_US, UINT32_MAX - 50000, UINT32_MAX - 1000000};
    static const uint32_t deadlines_us[][2] = {{0, 2000000}, {700000, 700000}};
    for (unsigned i = 0; i != 2 * COUNT(starts_us); i++) {
        const uint32_t step_us = i % 2 != 0 ? 20000 : 5000;
        const uint32_t stale_us = deadlines_us[i % 2][1];
        begin_at(starts_us[i / 2]);
        *driver->stale_us = deadlines_us[i % 2][0];
        start();
        for (unsigned n = 1; n <= 3; n++) {
            rig_run(stale_us - step_us, step_us);
            assert_int_equal(rig.stales, n - 1);
            assert_int_equal(fathom_due_us(kind->sensor, 1), step_us);
            rig_run(step_us, step_us);
            assert_int_equal(rig.stales, n);
        }
        reads(driver->good); /* begins the deadline anew */
        rig_run(stale_us - 100000, step_us);
        assert_int_equal(rig.stales, 3);
        rig_run(100000, step_us);
        assert_int_equal(rig.stales, 4);
        assert_int_equal(rig.samples, 1);
    }
}

#define LISTENING(promise) LISTENERS(promise) OF(promise, a16_controlled)

CONTRACT(it_listens_until_deinit_or_until_it_is_replaced, LISTENING)
{
    fathom_listener_t other = {.receive = NULL};
    start();
    assert_true(rig.line.listener != NULL && rig.line.listener != &other);
    (void)fathom_line_replace_listener(&rig.line, &other);
    driver->deinit();
    assert_ptr_equal(rig.line.listener, &other);
    (void)fathom_line_replace_listener(&rig.line, NULL);
    start();
    assert_non_null(rig.line.listener);
    start(); /* the same listener again */
    driver->deinit();
    assert_null(rig.line.listener);
}

CONTRACT(init_refuses_a_line_with_another_listener_and_does_not_use_the_port, LISTENING)
{
    fathom_listener_t other = {.receive = NULL};
    (void)fathom_line_replace_listener(&rig.line, &other);
    assert_int_equal(driver->init(), FATHOM_ERR_BUSY);
    assert_ptr_equal(rig.line.listener, &other);
    (void)fathom_line_replace_listener(&rig.line, NULL);
    assert_false(kind->is_used());
}

#define BY_SUM(promise) OF(promise, a05_auto) OF(promise, a16_auto)

CONTRACT(the_gap_that_counts_is_the_configs, BY_SUM)
{
    for (uint16_t gap_us = 0; gap_us <= 25000; gap_us += 25000) {
        begin_at(START_US);
        *driver->gap_us = gap_us;
        start();
        assert_int_equal(rig.line.listener->gap_us, gap_us != 0 ? 25000 : 5000);
    }
}

/* It shows that the module sends. */
CONTRACT(a_refused_frame_begins_the_deadline_too, BY_SUM)
{
    *driver->stale_us = 300000;
    start();
    reads(driver->good);
    rig_run(150000, 500);
    refuses(driver->refused);
    rig_run(290000, 500);
    assert_int_equal(rig.stales, 0);
    rig_run(10000, 500);
    assert_int_equal(rig.stales, 1);
}

/* ---- contacts ---- */

CONTRACT(the_times_are_options, CONTACTS)
{
    *driver->timing = (fathom_contact_timing_t){30000, 400000, 3000, 60000};
    rig.level = true;
    start();
    assert_int_equal(fathom_due_us(&rig.sensor, 1), 3000);
    rig_run(29 * MS, 1000);
    assert_int_equal(rig.samples, 0);
    rig_run(1 * MS, 1000);
    assert_int_equal(rig.samples, 1);
    rig_run(399 * MS, 1000);
    assert_int_equal(rig.samples, 1);
    rig_run(1 * MS, 1000);
    rig_expect(2, driver->sample.kind);
    for (uint32_t i = 0; i != 100; i++) rig_turn((i + 1) * MS);
    rig_run(60 * MS, 1000);
    assert_int_equal(rig.stales, 0);
    rig_run(1 * MS, 1000);
    assert_int_equal(rig.stales, 1);
}
