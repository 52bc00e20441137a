/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* A simulated HPS-167S that sends by itself: it is listened to, and asked meanwhile. */

enum { TARGET_MM = 2083 };

static fathom_hps167s_t *const hps = &s.driver.hps;
static fathom_hps167s_auto_t hears;
static fathom_sensor_t measuring;
static unsigned heard, wrong;

static fathom_hps167s_version_t version;
static fathom_hps167s_details_t details;
static fathom_hps167s_configuration_t is;
static fathom_hps167s_temperature_t temperature;

static fathom_status_t one(void) { return fathom_hps167s_get_interface_version(hps, &version); }
static fathom_status_t two(void) { return fathom_hps167s_get_configuration(hps, &is); }
static fathom_status_t three(void) { return fathom_hps167s_get_details(hps, &details); }
static fathom_status_t four(void) { return fathom_hps167s_get_temperature(hps, &temperature); }
static fathom_status_t six(void) { return fathom_hps167s_restore_factory_settings(hps); }
static fathom_status_t seven(void) { return fathom_hps167s_set_warm_up_s(hps, 9); }
static fathom_status_t eight(void) { return fathom_hps167s_set_address(hps, 5); }
static fathom_status_t ten(void) { return fathom_hps167s_set_measures_after_power_on(hps, false); }
static fathom_status_t eleven(void) { return fathom_hps167s_set_termination(hps, false); }
static fathom_status_t twelve(void) { return fathom_hps167s_set_distance_offset_mm(hps, 0); }
static fathom_status_t thirteen(void) { return fathom_hps167s_load_user_settings(hps); }
static fathom_status_t fourteen(void) { return fathom_hps167s_set_filter_sensitivity(hps, 50); }
static fathom_status_t fifteen(void) { return fathom_hps167s_set_reconnect_time_ms(hps, 360); }

static void begin(uint32_t loop_us, uint32_t unasked_us, bool is_asked)
{
    stage_begin(&bench_19200, false, loop_us);
    bench.fixed = FIXED(TARGET_MM);
    init_driver(&s.driver, HPS, 1, NULL);
    measuring = sensor_of(&s.driver, HPS);
    add_hps((hps_config_t){.unasked_us = unasked_us});
    assert_int_equal(fathom_hps167s_auto_init(&hears, &s.line, NULL), FATHOM_OK);
    if (is_asked) fathom_hps167s_auto_follow(&hears, hps);
    s.sensor = fathom_hps167s_auto_sensor(&hears);
    heard = 0;
    wrong = 0;
}

static void step(bool asks)
{
    const fathom_sensor_t both[] = {s.sensor, measuring};
    const fathom_status_t status = fathom_poll(&s.sensor, &s.sample);
    heard += status == FATHOM_OK;
    wrong += status == FATHOM_OK &&
             (s.sample.distance_mm != bench.fixed.value[0] || s.sample.kind != FATHOM_TARGET);
    pass_until(fathom_due_us(both, asks ? 2 : 1));
}

static fathom_status_t ask_for(fathom_status_t (*command)(void))
{
    const uint32_t start_us = s.clock.now_us;
    for (unsigned steps = 0;; steps++) {
        const fathom_status_t status = command();
        if (status != FATHOM_PENDING) return status;
        assert_true(since_us(start_us) < 30 * SECOND);
        assert_true(steps < 100000); /* to be told to sleep for no time is no progress */
        step(true);
    }
}

static const suite_t suite = {BENCH_ROUNDS};

static fathom_status_t (*const commands[])(void) = {one, two,    three,  four,     seven,    eight,
                                                    ten, eleven, twelve, thirteen, fourteen, fifteen};

/* What the commands have set and told. */
static void assert_carried_out(void)
{
    assert_int_equal(wrong, 0);
    assert_int_equal(version.year, 2020);
    assert_int_equal(details.year, 2019);
    assert_int_equal(temperature.temperature_dc, 250);
    assert_int_equal(bench.device->address, 5);
    assert_int_equal(ask_for(two), FATHOM_OK);
    assert_int_equal(is.baud, 19200);
    assert_int_equal(is.warm_up_s, 9);
    assert_int_equal(is.reconnect_time_ms, 360);
    assert_false(is.termination);
}

/* 54 measurements a second: a request has 11 ms between two frames, and the response the next place that is free. */
TEST(every_command_works_at_once_between_frames_every_18_5_ms)
{
    static const uint32_t replies_us[] = {2500, 500, 1500, 3500};
    for (unsigned n = 0; n != 2 * 4 * 6; n++) {
        begin(n % 2 == 0 ? 0 : 1 * MS, 18500, true);
        s.config.silence_us = FATHOM_T3_5_US(19200, 11);
        bench.hps.reply_us = replies_us[n / 2 % 4];
        while (since_us(bench_start_us) < 65 * MS) step(false); /* as line.h says */
        pass_us(n / 8 * 3 * MS);
        for (unsigned i = 0; i != sizeof commands / sizeof *commands; i++) {
            const fathom_status_t status = ask_for(commands[i]);
            if (status != FATHOM_OK) fail_msg("command %u in run %u: %s", i, n, fathom_status_name(status));
        }
        assert_int_equal(bench.line.counters.collisions, 0);
        assert_carried_out();
    }
}

/* Whatever is measured, and however long it stays: the configuration is the device's or there is none. */
TEST(no_held_distance_passes_for_the_configuration)
{
    /* 00FF is the one distance with the shape of #2; the optics make the rest of the frame fit too: 00FF 0500 0000 B401
     * is what #2 says with these settings but for the termination. */
    static const fathom_sim_optics_t like_2 = {0x0500, 0x00, 0x00, 0xB402};
    unsigned told_it = 0;
    for (uint32_t at_us = 0; at_us < 40 * MS; at_us += 1 * MS) {
        begin(at_us % 2 == 0 ? 0 : 20 * MS, 40 * MS, true);
        bench.hps.optics = &like_2;
        bench.fixed.value[0] = 255;
        while (heard == 0) step(false);
        pass_us(at_us);
        for (unsigned i = 0; i != 5; i++) {
            if (ask_for(two) != FATHOM_OK) continue;
            told_it++;
            assert_true(is.termination);      /* 00FF says that it is off */
            assert_int_equal(is.baud, 19200); /* and B402 says 57600 */
        }
        assert_int_equal(wrong, 0);
    }
    assert_true(told_it > 50);
}

TEST(a_reset_is_done_while_frames_arrive)
{
    for (uint32_t at_us = 0; at_us < 40 * MS; at_us += 5 * MS) {
        begin(0, 40 * MS, true);
        pass_us(at_us);
        const fathom_status_t status = ask_for(six);
        if (status == FATHOM_OK)
            COUNTED(.resets = 1);
        else /* the request has met a frame, or its response has */
            assert_true(status == FATHOM_ERR_UNCONFIRMED || status == FATHOM_ERR_NO_RESPONSE ||
                        status == FATHOM_ERR_MALFORMED);
        assert_true(bench.device->counters.resets <= 1);
        assert_int_equal(wrong, 0);
    }
}
