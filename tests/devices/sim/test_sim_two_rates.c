/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* An A16 (9600 8N1), an A05 asked with 55 AA (9600 8N1) and an HPS-167S (19200 8E1) on one pair, in one loop. */
enum { A16_MM = 1234, HPS_MM = 5678, SENSORS = 3 };

static const fathom_sim_fixed_t probes = {{1000, 2000, 1953, 3562}};
static driver_t drivers[SENSORS];
static fathom_sensor_t sensors[SENSORS];
static unsigned readings[SENSORS], errors[SENSORS];

static void begin(const fathom_line_settings_t *slow, const fathom_line_settings_t *fast, bool echo)
{
    static const model_t models[SENSORS] = {A16, A05_DYP, HPS};
    static fathom_sim_fixed_t scenes[SENSORS];
    bench_start_us = UINT32_C(0xFFF00000); /* the clock wraps after a second */
    stage_begin(&bench_9600, false, 0);
    s.config.silence_us = FATHOM_T3_5_US(9600, 10);
    bench.line.echo = echo;
    scenes[0] = FIXED(A16_MM);
    scenes[1] = probes;
    scenes[2] = FIXED(HPS_MM);
    add_a16(FATHOM_SIM_A16_MODBUS, (a16_config_t){.scene = fathom_sim_fixed(&scenes[0])});
    add_a05(FATHOM_SIM_A05_DYP, (a05_config_t){.address = 2, .scene = fathom_sim_fixed(&scenes[1])});
    add_hps((hps_config_t){.address = 3, .scene = fathom_sim_fixed(&scenes[2])});
    const fathom_a16_modbus_config_t a16 = {.modbus.line_settings = slow, .value = FATHOM_REAL_TIME};
    const fathom_hps167s_config_t hps = {
        .modbus.line_settings = fast, .modbus.period_us = 100 * MS, .modbus.address = 3};
    assert_int_equal(fathom_a16_modbus_init(&drivers[0].a16, &s.modbus, &a16), FATHOM_OK);
    init_driver(&drivers[1], A05_DYP, 2, slow);
    assert_int_equal(fathom_hps167s_init(&drivers[2].hps, &s.modbus, &hps), FATHOM_OK);
    for (unsigned i = 0; i != SENSORS; i++) {
        sensors[i] = sensor_of(&drivers[i], models[i]);
        readings[i] = errors[i] = 0;
    }
}

static void run(uint32_t for_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += MS) {
        for (unsigned i = 0; i != SENSORS; i++) {
            const fathom_status_t status = fathom_poll(&sensors[i], &s.sample);
            if (status < 0) errors[i]++;
            if (status != FATHOM_OK) continue;
            const int32_t right_mm[] = {A16_MM, i == 1 ? probes.value[s.sample.probe - 1] : 0, HPS_MM};
            assert_int_equal(s.sample.distance_mm, right_mm[i]);
            readings[i]++;
        }
        pass_us(MS);
    }
}

TEST(sensors_with_different_settings_are_read_on_one_pair)
{
    for (int echo = 0; echo != 2; echo++) {
        begin(&bench_9600, &bench_19200, echo != 0);
        run(20 * SECOND);
        for (unsigned i = 0; i != SENSORS; i++) assert_int_equal(errors[i], 0);
        /* A round takes up to 120 + 210 + 40 ms of the sensors' own time and the frames: 50 rounds at least. */
        assert_true(readings[0] >= 45);
        assert_true(readings[1] >= 4 * 45);
        assert_true(readings[2] >= 45);
        assert_int_equal(fathom_line_get_echo(&s.line),
                         echo != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
    }
}

/* Without them a device with other settings hears noise and stays silent. */
TEST(without_their_settings_only_those_of_the_line_answer)
{
    begin(NULL, NULL, false);
    run(20 * SECOND);
    assert_true(readings[0] > 0 && readings[1] > 0);
    assert_int_equal(errors[0] + errors[1], 0);
    assert_int_equal(readings[2], 0);
    assert_true(errors[2] > 0);
    assert_true(bench.hps.device.counters.wrong_settings > 0);
}
