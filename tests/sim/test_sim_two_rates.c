/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/sim.h"
#include "sim/uart.h"

/* An A16 (9600 8N1), an A05 asked with 55 AA (9600 8N1) and an HPS-167S (19200 8E1) on one pair, in one loop. */
enum { MS = 1000, A16_MM = 1234, HPS_MM = 5678, SENSORS = 3 };

static const fathom_line_settings_t slow = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t fast = {19200, FATHOM_PARITY_EVEN, 1};
static const uint16_t a05_mm[] = {1000, 2000, 1953, 3562};

typedef struct {
    fathom_sim_clock_t sim_clock;
    fathom_sim_line_t sim_line;
    fathom_sim_uart_t sim_uart;
    fathom_sim_fixed_t scenes[SENSORS];
    fathom_sim_a16_t sim_a16;
    fathom_sim_a05_t sim_a05;
    fathom_sim_hps167s_t sim_hps;

    fathom_uart_t uart;
    fathom_clock_t clock;
    uint8_t frame[32];
    fathom_line_config_t config;
    fathom_line_t line;
    fathom_modbus_t modbus;
    fathom_a16_modbus_t a16;
    fathom_a05_dyp_t a05;
    fathom_hps167s_t hps;
    fathom_sensor_t sensors[SENSORS];
} pair_t;

static pair_t pair;

static void begin(const fathom_line_settings_t *for_slow, const fathom_line_settings_t *for_fast, bool echo)
{
    memset(&pair, 0, sizeof pair);
    fathom_sim_clock_init(&pair.sim_clock, 0xFFF00000u, 0); /* the clock wraps after a second */
    fathom_sim_line_init(&pair.sim_line, &slow, pair.sim_clock.now_us);
    pair.sim_line.echo = echo;
    fathom_sim_uart_init(&pair.sim_uart, &pair.sim_line, &pair.sim_clock);
    pair.scenes[0].value[0] = A16_MM;
    for (unsigned i = 0; i != 4; i++) pair.scenes[1].value[i] = a05_mm[i];
    pair.scenes[2].value[0] = HPS_MM;
    fathom_sim_a16_init(&pair.sim_a16,
                        &(fathom_sim_a16_config_t){.unit = 1,
                                                   .mode = FATHOM_SIM_A16_MODBUS,
                                                   .scene = fathom_sim_fixed(&pair.scenes[0])});
    fathom_sim_a05_init(&pair.sim_a05,
                        &(fathom_sim_a05_config_t){.unit = 2,
                                                   .mode = FATHOM_SIM_A05_DYP,
                                                   .scene = fathom_sim_fixed(&pair.scenes[1])});
    fathom_sim_hps167s_init(
        &pair.sim_hps, &(fathom_sim_hps167s_config_t){.unit = 3, .scene = fathom_sim_fixed(&pair.scenes[2])});
    fathom_sim_attach(&pair.sim_line, &pair.sim_a16.device, pair.sim_clock.now_us);
    fathom_sim_attach(&pair.sim_line, &pair.sim_a05.device, pair.sim_clock.now_us);
    fathom_sim_attach(&pair.sim_line, &pair.sim_hps.device, pair.sim_clock.now_us);

    pair.uart = fathom_sim_uart(&pair.sim_uart);
    pair.clock = fathom_sim_clock(&pair.sim_clock);
    pair.config = (fathom_line_config_t){.uart = &pair.uart,
                                         .clock = &pair.clock,
                                         .frame = pair.frame,
                                         .frame_size = sizeof pair.frame,
                                         .silence_us = FATHOM_T3_5_US(9600, 10)};
    assert_int_equal(fathom_line_init(&pair.line, &pair.config), FATHOM_READY);
    pair.modbus = fathom_modbus_client(&pair.line);
    assert_int_equal(
        fathom_a16_modbus_init(&pair.a16, &(fathom_a16_modbus_config_t){.modbus = &pair.modbus,
                                                                        .clock = &pair.clock,
                                                                        .settings = for_slow,
                                                                        .value = FATHOM_A16_REAL_TIME}),
        FATHOM_READY);
    assert_int_equal(
        fathom_a05_dyp_init(
            &pair.a05, &(fathom_a05_dyp_config_t){.line = &pair.line, .settings = for_slow, .address = 2}),
        FATHOM_READY);
    assert_int_equal(fathom_hps167s_init(&pair.hps, &(fathom_hps167s_config_t){.modbus = &pair.modbus,
                                                                               .clock = &pair.clock,
                                                                               .settings = for_fast,
                                                                               .period_us = 100 * MS,
                                                                               .address = 3}),
                     FATHOM_READY);
    pair.sensors[0] = fathom_a16_modbus_sensor(&pair.a16);
    pair.sensors[1] = fathom_a05_dyp_sensor(&pair.a05);
    pair.sensors[2] = fathom_hps167s_sensor(&pair.hps);
}

typedef struct {
    unsigned readings[SENSORS];
    unsigned errors[SENSORS];
} tally_t;

static uint16_t right_mm(unsigned sensor, uint8_t probe)
{
    if (sensor == 1) return a05_mm[probe - 1];
    return sensor == 0 ? A16_MM : HPS_MM;
}

static tally_t run(uint32_t for_us)
{
    tally_t tally = {{0}, {0}};
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += MS) {
        for (unsigned i = 0; i != SENSORS; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&pair.sensors[i], &sample);
            if (status < 0) tally.errors[i]++;
            if (status != FATHOM_READY) continue;
            assert_int_equal(sample.distance_mm, right_mm(i, sample.probe));
            tally.readings[i]++;
        }
        fathom_sim_clock_advance(&pair.sim_clock, MS);
    }
    return tally;
}

TEST(sensors_with_different_settings_are_read_on_one_pair)
{
    for (int echo = 0; echo != 2; echo++) {
        begin(&slow, &fast, echo != 0);
        const tally_t tally = run(20000 * MS);
        for (unsigned i = 0; i != SENSORS; i++) assert_int_equal(tally.errors[i], 0);
        /* A round takes up to 120 + 210 + 40 ms of the sensors' own time and the frames: 50 rounds at least. */
        assert_true(tally.readings[0] >= 45);
        assert_true(tally.readings[1] >= 4 * 45);
        assert_true(tally.readings[2] >= 45);
        assert_int_equal(fathom_line_echo(&pair.line),
                         echo != 0 ? FATHOM_LINE_ECHO_ON : FATHOM_LINE_ECHO_OFF);
    }
}

/* Without it, whoever has other settings hears noise and stays silent. */
TEST(without_their_settings_only_those_of_the_line_answer)
{
    begin(NULL, NULL, false);
    const tally_t tally = run(20000 * MS);
    assert_true(tally.readings[0] > 0 && tally.readings[1] > 0);
    assert_int_equal(tally.errors[0] + tally.errors[1], 0);
    assert_int_equal(tally.readings[2], 0);
    assert_true(tally.errors[2] > 0);
    assert_true(pair.sim_hps.device.counters.wrong_settings > 0);
}
