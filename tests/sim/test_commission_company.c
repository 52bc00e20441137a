/* SPDX-License-Identifier: MIT */
#include "commission_stage.h"

/* Every command and setting in company: another driver asks the same unit, others fill the queue, 55 AA and Modbus are
 * on one line, an HPS-167S sends what nobody asked for. */

static const uint32_t loops_us[] = {0, 1 * MS, 20 * MS, 300 * MS};

/* ---- a second driver of the same unit ---- */

static bool is_fair(fathom_status_t status, bool moves)
{
    if (status == FATHOM_READY || status == FATHOM_PENDING) return true;
    return moves && (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_NO_ANSWER);
}

static void beside_another_driver(const job_t *job, uint32_t loop_us, uint8_t echo)
{
    static commission_t s;
    static commission_t other; /* its driver alone is used, on the first one's line */
    fathom_sample_t sample;
    unsigned readings = 0;
    set_up(&s, job->model, job->unit, loop_us, echo);
    set_up(&other, job->model, job->unit, loop_us, echo);
    other.modbus = s.modbus;
    if (job->model == A05_DYP) {
        const fathom_a05_dyp_config_t config = {.line = &s.line, .settings = &s.settings};
        assert_int_equal(fathom_a05_dyp_init(&other.driver.dyp, &config), FATHOM_READY);
    } else {
        other.hal_clock = s.hal_clock;
    }
    const fathom_sensor_t beside = sensor_of(&other);
    const bool moves = job->kind == MOVES;
    const uint32_t start_us = s.clock.now_us;
    fathom_status_t status = FATHOM_PENDING;
    while (status == FATHOM_PENDING) {
        const fathom_status_t is_read = fathom_poll(&beside, &sample);
        assert_true(is_fair(is_read, moves));
        if (is_read == FATHOM_READY) {
            assert_int_equal(sample.distance_mm, sample.probe == 1 ? 1234 : s.fixed.value[sample.probe - 1]);
            readings++;
        }
        status = job->call(&s);
        if (status != FATHOM_PENDING) break;
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 60 * SECOND);
        const fathom_sensor_t both[] = {beside, sensor_of(&s)};
        if (loop_us != 0)
            fathom_sim_clock_advance(&s.clock, loop_us);
        else
            fathom_sim_clock_idle(&s.clock, fathom_due_us(both, 2));
    }
    if (status != FATHOM_READY) fail_msg("%s, loop %u: %d", job->name, (unsigned)loop_us, (int)status);
    assert_int_equal(job->has(&s), job->wanted);
    assert_int_equal(told(&s), job->kind == READS ? 0 : 1);
    assert_true(readings != 0 || loop_us == 300 * MS);
    assert_true(recovers(&s));
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(another_driver_of_the_same_unit_takes_no_outcome_away)
{
    for (unsigned j = 0; j != jobs_count; j++)
        for (unsigned l = 0; l != 4; l++)
            for (uint8_t echo = 0; echo != 3; echo++) beside_another_driver(&jobs[j], loops_us[l], echo);
}

/* ---- a queue full of others ---- */

enum { OTHERS = 10 };

static void behind_others(const job_t *job, uint32_t loop_us)
{
    static commission_t s;
    fathom_modbus_request_t others[OTHERS];
    uint16_t values[OTHERS];
    set_up(&s, job->model, job->unit, loop_us, FATHOM_LINE_ECHO_AUTO);
    memset(others, 0, sizeof others);
    for (unsigned i = 0; i != OTHERS; i++) {
        others[i].exchange.timeout_us = 50 * MS;
        others[i].exchange.retries = (uint8_t)(i % 3);
        others[i].exchange.settings = &s.settings;
        fathom_modbus_read_holding_registers(&others[i].message, (uint8_t)(100 + i), 0x0101, 1, &values[i]);
        assert_int_equal(fathom_modbus_client_submit(&s.line, &others[i]), FATHOM_PENDING);
    }
    fathom_status_t status;
    const uint32_t start_us = s.clock.now_us;
    while ((status = round_of(&s, job)) == FATHOM_PENDING) {
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 300 * SECOND);
        for (unsigned i = 0; i != OTHERS; i++) {
            if (others[i].exchange.status == FATHOM_PENDING) continue;
            assert_int_equal(others[i].exchange.status, FATHOM_ERR_NO_ANSWER);
            assert_int_equal(fathom_modbus_client_submit(&s.line, &others[i]), FATHOM_PENDING);
        }
    }
    if (status != FATHOM_READY) fail_msg("%s, loop %u: %d", job->name, (unsigned)loop_us, (int)status);
    assert_int_equal(job->has(&s), job->wanted);
    assert_int_equal(told(&s), job->kind == READS ? 0 : 1);
}

TEST(a_queue_that_is_never_empty_delays_and_no_more)
{
    for (unsigned j = 0; j != jobs_count; j++)
        for (unsigned l = 0; l != 3; l++) behind_others(&jobs[j], loops_us[l]);
}

/* ---- 55 AA and Modbus on one line ---- */

static void both_protocols(bool dyp_sets, uint32_t loop_us)
{
    static commission_t s;
    fathom_a05_modbus_t second;
    fathom_sample_t sample;
    unsigned readings = 0;
    set_up(&s, A05_DYP, 1, loop_us, FATHOM_LINE_ECHO_AUTO);
    const fathom_a05_modbus_config_t config = {
        .modbus = &s.modbus, .clock = &s.hal_clock, .settings = &s.settings};
    assert_int_equal(fathom_a05_modbus_init(&second, &config), FATHOM_READY);
    const fathom_sensor_t dyp = sensor_of(&s);
    const fathom_sensor_t modbus = fathom_a05_modbus_sensor(&second);
    const uint32_t start_us = s.clock.now_us;
    fathom_status_t status = FATHOM_PENDING;
    while (status == FATHOM_PENDING) {
        const fathom_status_t is_read = fathom_poll(dyp_sets ? &modbus : &dyp, &sample);
        assert_true(is_fair(is_read, true));
        if (is_read == FATHOM_READY) {
            assert_int_equal(sample.distance_mm, s.fixed.value[sample.probe - 1]);
            assert_int_equal(sample.unit, 1);
            readings++;
        }
        status = dyp_sets ? fathom_a05_dyp_set_every_address(&s.driver.dyp, 5)
                          : fathom_a05_modbus_set_address(&second, 5);
        assert_true(fathom_elapsed_us(s.clock.now_us, start_us) < 60 * SECOND);
        const fathom_sensor_t both[] = {dyp, modbus};
        if (loop_us != 0)
            fathom_sim_clock_advance(&s.clock, loop_us);
        else
            fathom_sim_clock_idle(&s.clock, fathom_due_us(both, 2));
    }
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(device_of(&s, 0)->unit, 5);
    assert_int_equal(told(&s), 1);
    assert_true(readings >= 4);
}

TEST(an_address_is_set_in_one_protocol_while_the_other_measures)
{
    for (unsigned l = 0; l != 4; l++) {
        both_protocols(false, loops_us[l]);
        both_protocols(true, loops_us[l]);
    }
}

/* ---- an HPS-167S that sends what nobody asked for ---- */

/* True: READY. */
static bool among_unasked(const job_t *job, uint32_t unasked_us, uint32_t loop_us)
{
    static commission_t s;
    fathom_hps167s_auto_t listener;
    fathom_sample_t sample;
    set_up(&s, HPS, job->unit, loop_us, FATHOM_LINE_ECHO_AUTO);
    fathom_sim_detach(&s.wire, device_of(&s, 0), s.clock.now_us);
    const fathom_sim_hps167s_config_t device = {
        .unit = job->unit, .scene = fathom_sim_fixed(&s.fixed), .unasked_us = unasked_us};
    fathom_sim_hps167s_init(&s.device[0].hps, &device);
    fathom_sim_attach(&s.wire, device_of(&s, 0), s.clock.now_us);
    const fathom_hps167s_auto_config_t config = {.line = &s.line, .asking = &s.driver.hps};
    assert_int_equal(fathom_hps167s_auto_init(&listener, &config), FATHOM_READY);
    const fathom_sensor_t heard = fathom_hps167s_auto_sensor(&listener);
    fathom_status_t status;
    while ((status = round_of(&s, job)) == FATHOM_PENDING)
        if (fathom_poll(&heard, &sample) == FATHOM_READY) assert_int_equal(sample.distance_mm, 1234);
    const uint32_t has = job->has(&s);
    assert_true(told(&s) <= 1);
    assert_true(has == job->before || has == job->wanted);
    if (status == FATHOM_READY) assert_int_equal(has, job->wanted);
    if (status < 0 && status != FATHOM_ERR_UNCONFIRMED && job->kind != WRITE_ONLY)
        assert_int_equal(has, job->before);
    return status == FATHOM_READY;
}

TEST(unasked_measurements_are_no_answers)
{
    unsigned ready = 0;
    unsigned all = 0;
    for (unsigned j = 0; j != jobs_count; j++)
        for (uint32_t unasked_us = 19 * MS; unasked_us < 300 * MS; unasked_us += 27 * MS)
            for (unsigned l = 0; l != 3 && jobs[j].model == HPS; l++, all++)
                if (among_unasked(&jobs[j], unasked_us, loops_us[l])) ready++;
    assert_true(ready > all / 2); /* they collide with answers and requests, as on a real pair */
}

/* ---- a rate that holds from the next power-on ---- */

TEST(a_rate_for_the_next_power_on_is_followed_then)
{
    static commission_t s;
    fathom_sample_t sample;
    for (unsigned l = 0; l != 4; l++)
        for (unsigned cut = 0; cut != 2; cut++) {
            set_up(&s, HPS, 1, loops_us[l], FATHOM_LINE_ECHO_AUTO);
            s.device[0].hps.baud_at_power_on = true;
            fathom_status_t status;
            while ((status = fathom_hps167s_set_baud(&s.driver.hps, 230400)) == FATHOM_PENDING) pass(&s);
            assert_int_equal(status, FATHOM_READY);
            assert_int_equal(s.driver.hps.next_baud, 230400);
            assert_int_equal(measure(&s, &sample), FATHOM_READY); /* still at the old rate */
            if (cut != 0) fathom_sim_power_cycle(&s.wire, device_of(&s, 0), 0, s.clock.now_us);
            fathom_hps167s_power_on(&s.driver.hps);
            assert_true(recovers(&s)); /* also where it has not had its power cut after all */
            assert_true(same_place(&s));
            assert_int_equal(told(&s), 1);
        }
}
