/* SPDX-License-Identifier: MIT */
#include "second_lives.h"

#include "suite.h"

enum { SECOND_US = 1000000, SETTLED_US = 8000000 };

static const second_scene_t there[] = {{{1000, 2000, 1953, 3562}},
                                       {{511, 511, 511, 511}},
                                       {{SECOND_NOTHING, 2331, SECOND_NOTHING, 250}},
                                       {{300, 255, 4500, 65}}};
enum { THERE = sizeof there / sizeof there[0] };

static void show(rig_t *rig, size_t i) { second_scene(&rig->device, &there[i % THERE], rig->now_us); }

static fathom_sensor_t begin_modbus(rig_t *rig, fathom_a05_modbus_t *sensor, uint8_t probes,
                                    uint16_t registers)
{
    fathom_a05_modbus_config_t config = {
        .modbus.address = rig->device.address, .probes = probes, .registers = registers};
    config.modbus.retries = rig->device.config.seed % 5 == 0 ? 2 : 0;
    assert_int_equal(fathom_a05_modbus_init(sensor, &rig->modbus, &config), FATHOM_OK);
    return fathom_a05_modbus_sensor(sensor);
}

static void commands(rig_t *rig, fathom_a05_modbus_t *sensor)
{
    fathom_sensor_t any = fathom_a05_modbus_sensor(sensor);
    uint8_t address = 0, wanted = rig->device.address == 7 ? 1 : 7;
    JUDGE_READ("a05_modbus_address", any, fathom_a05_modbus_get_address(sensor, &address),
               address == rig->device.address);
    JUDGE_SET("a05_modbus_set_address", any, fathom_a05_modbus_set_address(sensor, wanted),
              fathom_a05_modbus_is_written(sensor), HOLDS(0x0200, wanted));
}

/* Measures with all ways to choose probes: those that are fitted, one of them, by either registers. */
static void measure(rig_t *rig)
{
    fathom_a05_modbus_t sensor;
    uint8_t fitted = rig->device.config.fitted;
    const struct {
        uint8_t probes;
        uint16_t registers;
    } ways[] = {{fitted, 0}, {(uint8_t)(fitted & -fitted), 0}, {fitted, FATHOM_A05_REGISTERS_ALIAS}};
    for (size_t i = 0; i < 3; i++) {
        fathom_sensor_t any = begin_modbus(rig, &sensor, ways[i].probes, ways[i].registers);
        show(rig, i + 1);
        judge_poll(i == 2 ? "a05_modbus alias" : "a05_modbus", &any, 8, SETTLED_US);
        fathom_a05_modbus_deinit(&sensor);
    }
}

void life_a05_uart(rig_t *rig)
{
    fathom_a05_auto_t automatic;
    fathom_a05_modbus_t sensor;
    fathom_a05_auto_config_t config = {.gap_us = rig->line_parts.gap_us};
    config.select = fathom_output_line_break(&rig->line);
    config.probes = rig->device.config.fitted;
    config.stale_us = rig->device.config.seed % 2 == 0 ? 0 : 4 * SECOND_US;
    assert_int_equal(fathom_a05_auto_init(&automatic, &rig->line, &config), FATHOM_OK);
    fathom_sensor_t by_itself = fathom_a05_auto_sensor(&automatic);
    JUDGE_READ("a05_auto_power_on", by_itself,
               fathom_a05_auto_select(&automatic, (fathom_dyp_value_t)(rig->device.config.seed / 2 % 2)),
               true);
    rig_power(rig, true);
    for (size_t i = 0; i < THERE; i++) {
        show(rig, i);
        judge_poll("a05_auto", &by_itself, i == 0 ? 400 : 20, i == 0 ? 3 * SECOND_US : SETTLED_US);
    }
    measure(rig);
    begin_modbus(rig, &sensor, config.probes, 0);
    commands(rig, &sensor);
    fathom_a05_modbus_deinit(&sensor);
    fathom_sensor_t any = begin_modbus(rig, &sensor, config.probes, 0); /* where it is now */
    judge_poll("a05_modbus", &any, 4, SETTLED_US);
    fathom_a05_modbus_deinit(&sensor);
    fathom_a05_auto_deinit(&automatic);
}

void life_a05_rs485(rig_t *rig)
{
    fathom_a05_modbus_t sensor;
    fathom_sensor_t any = begin_modbus(rig, &sensor, rig->device.config.fitted, 0);
    show(rig, 0);
    rig_power(rig, true);
    fathom_a05_modbus_power_on(&sensor);
    judge_poll("a05_modbus", &any, 12, SETTLED_US);
    commands(rig, &sensor);
    judge_poll("a05_modbus", &any, 4, SETTLED_US);
    fathom_a05_modbus_deinit(&sensor);
    measure(rig);
    rig_restart(rig, SECOND_US, 3 * SECOND_US);
    measure(rig);
    any = begin_modbus(rig, &sensor, rig->device.config.fitted, 0);
    find_by_modbus(rig, &any);
    JUDGE_SET("a05_modbus_set_address_to_0", any, fathom_a05_modbus_set_address_0(&sensor),
              fathom_a05_modbus_is_written(&sensor), HOLDS(0x0200, 0));
    judge_poll("a05_modbus", &any, 3, SETTLED_US);
    fathom_a05_modbus_deinit(&sensor);
}

static fathom_sensor_t begin_dyp(rig_t *rig, fathom_a05_dyp_t *sensor, uint8_t probes)
{
    fathom_a05_dyp_config_t config = {.modbus.address = rig->device.address, .probes = probes};
    assert_int_equal(fathom_a05_dyp_init(sensor, &rig->line, &config), FATHOM_OK);
    return fathom_a05_dyp_sensor(sensor);
}

void life_a05_dyp(rig_t *rig)
{
    fathom_a05_dyp_t sensor;
    fathom_a05_dyp_find_t find = {0};
    uint8_t fitted = rig->device.config.fitted, found = 0;
    fathom_sensor_t any = begin_dyp(rig, &sensor, fitted);
    show(rig, 0);
    rig_power(rig, true);
    fathom_a05_dyp_power_on(&sensor);
    judge_poll("a05_dyp", &any, 12, SETTLED_US);
    fathom_a05_dyp_deinit(&sensor);
    any = begin_dyp(rig, &sensor, (uint8_t)(fitted & -fitted));
    show(rig, 2);
    judge_poll("a05_dyp one probe", &any, 6, SETTLED_US);
    JUDGE_READ("a05_dyp_find", any, fathom_a05_dyp_find(&find, &rig->line, &found),
               found == rig->device.address || found == 255);
    JUDGE_SET("a05_dyp_set_every_address", any, fathom_a05_dyp_broadcast_address(&sensor, 9),
              fathom_a05_dyp_is_written(&sensor), HOLDS(0xAA03, 9));
    fathom_a05_dyp_deinit(&sensor);
    rig_restart(rig, SECOND_US, 3 * SECOND_US);
    any = begin_dyp(rig, &sensor, fitted);
    judge_poll("a05_dyp", &any, 4, SETTLED_US);
    fathom_a05_dyp_deinit(&sensor);
}
