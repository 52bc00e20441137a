/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Every command and setting with other senders: another driver asks the same unit, others fill the queue, 55 AA and
 * Modbus are on one line, an HPS-167S sends unasked. */

/* What one that measures beside it may say. */
static bool is_fair(fathom_status_t status, bool moves)
{
    if (status == FATHOM_OK || status == FATHOM_PENDING) return true;
    return moves && (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_NO_RESPONSE);
}

/* `command` until its end, with two sensors that are read meanwhile. Returns how many readings `beside` had. */
static unsigned with_others(fathom_status_t (*command)(void), fathom_sensor_t beside, fathom_sensor_t other,
                            bool moves, fathom_status_t *status)
{
    const fathom_sensor_t both[] = {beside, other};
    const uint32_t start_us = s.clock.now_us;
    unsigned readings = 0;
    for (;;) {
        const fathom_status_t is_read = fathom_poll(&beside, &s.sample);
        assert_true(is_fair(is_read, moves));
        if (is_read == FATHOM_OK) {
            assert_int_equal(s.sample.distance_mm, bench.fixed.value[s.sample.probe - 1]);
            assert_true(s.sample.address == 1 || s.sample.address == 7);
            readings++;
        }
        *status = command();
        if (*status != FATHOM_PENDING) return readings;
        assert_ends(start_us);
        pass_until(fathom_due_us(both, 2));
    }
}

static void beside_another_driver(const job_t *job, uint32_t loop_us, uint8_t echo)
{
    driver_t other;
    fathom_status_t status;
    set_up_for(job, loop_us, echo);
    init_driver(&other, job->model, job->unit, &s.settings);
    const fathom_sensor_t beside = sensor_of(&other, job->model);
    const unsigned readings = with_others(job->call, beside, s.sensor, job->kind == MOVES, &status);
    if (status != FATHOM_OK)
        fail_msg("%s, loop %u: %s", job->name, (unsigned)loop_us, fathom_status_name(status));
    assert_int_equal(job->has(), job->wanted);
    assert_int_equal(kept_commands(), job->kind == READS ? 0 : 1);
    assert_true(readings != 0 || loop_us == 300 * MS);
    assert_true(recovers());
}

/* Two starts: whose outcome it is does not depend on the time. */
static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(another_driver_of_the_same_unit_takes_no_outcome_away)
{
    for (unsigned j = 0; j != jobs_count; j++)
        for (unsigned l = 0; l != LOOPS; l++)
            for (uint8_t echo = 0; echo != 3; echo++) beside_another_driver(&jobs[j], loops_us[l], echo);
}

TEST(a_queue_that_is_never_empty_delays_and_no_more)
{
    enum { OTHERS = 10 };
    fathom_modbus_request_t others[OTHERS];
    uint16_t values[OTHERS];
    for (unsigned n = 0; n != 3 * jobs_count; n++) {
        const job_t *const job = &jobs[n / 3];
        set_up_for(job, loops_us[n % 3], FATHOM_LINE_ECHO_AUTO);
        memset(others, 0, sizeof others);
        for (unsigned i = 0; i != OTHERS; i++) {
            others[i].transaction.timeout_us = 50 * MS;
            others[i].transaction.retries = (uint8_t)(i % 3);
            others[i].transaction.line_settings = &s.settings;
            fathom_modbus_read_holding_registers(&others[i].message, (uint8_t)(100 + i), 0x0101, 1,
                                                 &values[i]);
            assert_int_equal(fathom_modbus_client_submit(&s.line, &others[i]), FATHOM_PENDING);
        }
        fathom_status_t status;
        const uint32_t start_us = s.clock.now_us;
        while ((status = round_of(job->call)) == FATHOM_PENDING) {
            assert_true(since_us(start_us) < 300 * SECOND);
            for (unsigned i = 0; i != OTHERS; i++) {
                if (others[i].transaction.status == FATHOM_PENDING) continue;
                assert_int_equal(others[i].transaction.status, FATHOM_ERR_NO_RESPONSE);
                assert_int_equal(fathom_modbus_client_submit(&s.line, &others[i]), FATHOM_PENDING);
            }
        }
        if (status != FATHOM_OK)
            fail_msg("%s, loop %u: %s", job->name, (unsigned)s.loop_us, fathom_status_name(status));
        assert_int_equal(job->has(), job->wanted);
        assert_int_equal(kept_commands(), job->kind == READS ? 0 : 1);
    }
}

static fathom_a05_modbus_t second;
static fathom_status_t set_by_dyp(void) { return fathom_a05_dyp_broadcast_address(&s.driver.dyp, 5); }
static fathom_status_t set_by_modbus(void) { return fathom_a05_modbus_set_address(&second, 5); }

TEST(an_address_is_set_in_one_protocol_while_the_other_measures)
{
    for (unsigned n = 0; n != 2 * LOOPS; n++) {
        const bool dyp_sets = n % 2 != 0;
        fathom_status_t status;
        set_up(A05_DYP, 1, loops_us[n / 2], FATHOM_LINE_ECHO_AUTO);
        const fathom_a05_modbus_config_t config = {.modbus.line_settings = &s.settings};
        assert_int_equal(fathom_a05_modbus_init(&second, &s.modbus, &config), FATHOM_OK);
        const fathom_sensor_t modbus = fathom_a05_modbus_sensor(&second);
        const unsigned readings =
            with_others(dyp_sets ? set_by_dyp : set_by_modbus, dyp_sets ? modbus : s.sensor,
                        dyp_sets ? s.sensor : modbus, true, &status);
        assert_int_equal(status, FATHOM_OK);
        assert_int_equal(bench.device->address, 5);
        assert_int_equal(kept_commands(), 1);
        assert_true(readings >= 4);
    }
}

/* ---- an HPS-167S that sends by itself ---- */

static fathom_sensor_t listener;
static unsigned heard;

static void set_up_among(const job_t *job, uint32_t unasked_us, uint32_t loop_us)
{
    static fathom_hps167s_auto_t automatic;
    set_up_for(job, loop_us, FATHOM_LINE_ECHO_AUTO);
    fathom_sim_detach(&bench.line, bench.device, s.clock.now_us);
    add_hps((hps_config_t){.address = job->unit, .unasked_us = unasked_us});
    assert_int_equal(fathom_hps167s_auto_init(&automatic, &s.line, NULL), FATHOM_OK);
    fathom_hps167s_auto_follow(&automatic, &s.driver.hps);
    listener = fathom_hps167s_auto_sensor(&automatic);
    heard = 0;
}

static void listen(void)
{
    if (fathom_poll(&listener, &s.sample) != FATHOM_OK) return;
    assert_int_equal(s.sample.kind, FATHOM_TARGET);
    assert_int_equal(s.sample.distance_mm, bench.fixed.value[0]);
    heard++;
}

/* The command until its end, with the listener alone. */
static fathom_status_t carry_out_among(const job_t *job)
{
    const fathom_sensor_t both[] = {listener, s.sensor};
    const uint32_t start_us = s.clock.now_us;
    for (unsigned steps = 0;; steps++) {
        const fathom_status_t status = job->call();
        if (status != FATHOM_PENDING) return status;
        assert_true(since_us(start_us) < 30 * SECOND);
        assert_true(steps < 100000); /* to be told to sleep for no time is no progress */
        listen();
        pass_until(fathom_due_us(both, 2));
    }
}

/* True: OK. */
static bool among_unasked(const job_t *job, uint32_t unasked_us, uint32_t loop_us)
{
    set_up_among(job, unasked_us, loop_us);
    fathom_status_t status;
    while ((status = round_of(job->call)) == FATHOM_PENDING) listen();
    const uint32_t has = job->has();
    assert_true(kept_commands() <= 1);
    assert_true(has == job->before || has == job->wanted);
    if (status == FATHOM_OK) assert_int_equal(has, job->wanted);
    if (status < 0 && status != FATHOM_ERR_UNCONFIRMED && job->kind != WRITE_ONLY)
        assert_int_equal(has, job->before);
    return status == FATHOM_OK;
}

TEST(unasked_measurements_are_no_responses)
{
    unsigned ready = 0, all = 0;
    for (unsigned j = 0; j != jobs_count; j++)
        for (uint32_t unasked_us = 19 * MS; unasked_us < 300 * MS; unasked_us += 27 * MS)
            for (unsigned l = 0; l != 3 && jobs[j].model == HPS; l++, all++)
                if (among_unasked(&jobs[j], unasked_us, loops_us[l])) ready++;
    assert_true(ready > all / 2); /* they collide with responses and requests, as on a real pair */
}

/* 54 measurements a second: a request has 11 ms between two frames, and the response the next place that is free. */
TEST(every_command_works_at_once_between_frames_every_18_5_ms)
{
    static const uint32_t replies_us[] = {2500, 500, 1500, 3500};
    for (const job_t *job = jobs; job != jobs + jobs_count; job++)
        for (unsigned n = 0; n != 2 * 4 * 6 && job->model == HPS; n++) {
            set_up_among(job, 18500, n % 2 == 0 ? 0 : 1 * MS);
            s.config.silence_us = FATHOM_T3_5_US(19200, 11);
            bench.hps.reply_us = replies_us[n / 2 % 4];
            while (since_us(bench_start_us) < 65 * MS) { /* as line.h says */
                listen();
                pass_until(fathom_due_us(&listener, 1));
            }
            pass_us(n / 8 * 3 * MS);
            const fathom_status_t status = carry_out_among(job);
            if (status != FATHOM_OK) fail_msg("%s in run %u: %s", job->name, n, fathom_status_name(status));
            assert_int_equal(job->has(), job->wanted);
            assert_int_equal(bench.line.counters.collisions, 0);
        }
}

/* Whatever is measured, and however long it stays: the configuration is the device's or there is none. */
TEST(no_held_distance_passes_for_the_configuration)
{
    /* 00FF is the one distance with the shape of #2; the optics make the rest of the frame fit too: 00FF 0500 0000 B401
     * is what #2 says with these settings but for the termination, and B402 says 57600. */
    static const fathom_sim_optics_t like_2 = {0x0500, 0x00, 0x00, 0xB402};
    const job_t *job = jobs;
    while (strcmp(job->name, "HPS #2") != 0) job++; /* which looks at the termination and at the rate */
    unsigned told_it = 0;
    for (uint32_t at_us = 0; at_us < 40 * MS; at_us += 1 * MS) {
        set_up_among(job, 40 * MS, at_us % 2 == 0 ? 0 : 20 * MS);
        bench.hps.optics = &like_2;
        bench.fixed.value[0] = 255;
        for (; heard == 0; pass_until(fathom_due_us(&listener, 1))) listen();
        pass_us(at_us);
        for (unsigned i = 0; i != 5; i++) told_it += carry_out_among(job) == FATHOM_OK;
    }
    assert_true(told_it > 50);
}

static fathom_status_t set_230400(void) { return fathom_hps167s_set_baud(&s.driver.hps, 230400); }

TEST(a_rate_for_the_next_power_on_is_followed_then)
{
    for (unsigned n = 0; n != 2 * LOOPS; n++) {
        set_up(HPS, 1, loops_us[n / 2], FATHOM_LINE_ECHO_AUTO);
        bench.hps.baud_at_power_on = true;
        assert_int_equal(carry_out(set_230400), FATHOM_OK);
        assert_int_equal(s.driver.hps.next_baud, 230400);
        assert_int_equal(bench.device->settings.baud, 19200);
        assert_int_equal(measure(), FATHOM_OK); /* still at the old rate */
        if (n % 2 != 0) fathom_sim_power_cycle(&bench.line, bench.device, 0, s.clock.now_us);
        fathom_hps167s_power_on(&s.driver.hps);
        assert_true(recovers()); /* also where it has not had its power cut after all */
        assert_true(same_place());
        assert_int_equal(kept_commands(), 1);
    }
}
