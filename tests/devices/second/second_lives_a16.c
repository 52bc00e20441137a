/* SPDX-License-Identifier: MIT */
#include "second_lives.h"

#include "suite.h"

enum { SECOND_US = 1000000, SETTLED_US = 16000000 };

static const int32_t there_mm[] = {754, 1953, 3000, 511, SECOND_NOTHING, 16000, 4660};
enum { THERE = sizeof there_mm / sizeof there_mm[0] };

/* 511 mm held still, FF 01 FF FF, cannot be placed by a loop that sees no silence (stream.h). */
static void show(rig_t *rig, size_t i)
{
    int32_t mm = there_mm[i % THERE];
    rig_scene(rig, mm == 511 && rig->loop == RIG_EVERY_20_MS ? 512 : mm, 0, 0, 0);
}

/* What a program knows of its module: no frame is later than this. */
static uint32_t stale_us(const rig_t *rig) { return rig->device.config.seed % 2 == 0 ? 0 : 4 * SECOND_US; }

void life_a16_auto(rig_t *rig)
{
    fathom_a16_auto_t sensor;
    fathom_a16_auto_config_t config = {.stale_us = stale_us(rig), .gap_us = rig->line_parts.gap_us};
    config.select = fathom_output_line_break(&rig->line);
    config.value = rig->device.config.seed % 4 >= 2 ? FATHOM_REAL_TIME : FATHOM_PROCESSED;
    rig_power(rig, true);
    assert_int_equal(fathom_a16_auto_init(&sensor, &rig->line, &config), FATHOM_OK);
    fathom_sensor_t any = fathom_a16_auto_sensor(&sensor);
    for (size_t i = 0; i < 5; i++) {
        show(rig, i);
        judge_poll("a16_auto", &any, 12, SETTLED_US);
        if (i != 2) continue;
        judge_begin("a16_auto select");
        fathom_status_t status;
        const fathom_dyp_value_t other =
            config.value == FATHOM_PROCESSED ? FATHOM_REAL_TIME : FATHOM_PROCESSED;
        JUDGE_RUN(status, any, fathom_a16_auto_select(&sensor, other));
        judge_read(status, rig->in_break == (other == FATHOM_REAL_TIME));
    }
    fathom_a16_auto_deinit(&sensor);
}

void life_a16_controlled(rig_t *rig)
{
    fathom_a16_controlled_t sensor;
    const fathom_output_t trigger = fathom_output_line_break(&rig->line);
    fathom_a16_controlled_config_t config = {.gap_us = rig->line_parts.gap_us};
    rig_power(rig, true);
    assert_int_equal(fathom_a16_controlled_init(&sensor, &rig->line, &trigger, &config), FATHOM_OK);
    fathom_sensor_t any = fathom_a16_controlled_sensor(&sensor);
    for (size_t i = 0; i < 5; i++) {
        show(rig, i);
        judge_poll("a16_controlled", &any, i == 0 ? 30 : 8, SETTLED_US);
    }
    fathom_a16_controlled_deinit(&sensor);
}

static fathom_sensor_t begin_modbus(rig_t *rig, fathom_a16_modbus_t *sensor, uint8_t value)
{
    fathom_a16_modbus_config_t config = {.modbus.address = rig->device.address, .value = value};
    config.modbus.retries = rig->device.config.seed % 5 == 0 ? 2 : 0;
    assert_int_equal(fathom_a16_modbus_init(sensor, &rig->modbus, &config), FATHOM_OK);
    return fathom_a16_modbus_sensor(sensor);
}

static void ask_all(rig_t *rig, fathom_a16_modbus_t *sensor)
{
    fathom_sensor_t any = fathom_a16_modbus_sensor(sensor);
    fathom_status_t status;
    fathom_sample_t sample;
    uint8_t address = 0;
    fathom_a16_polarity_t polarity = FATHOM_A16_NEGATIVE;
    uint16_t threshold_mm = 0;
    fathom_dyp_value_t value = FATHOM_PROCESSED;
    (void)rig;
    for (int v = FATHOM_PROCESSED; v <= FATHOM_REAL_TIME; v++) {
        judge_begin(v != 0 ? "a16_measure real time" : "a16_measure processed");
        JUDGE_RUN(status, any, fathom_a16_modbus_measure(sensor, (fathom_dyp_value_t)v, &sample));
        judge_measured(status, &sample);
    }
    JUDGE_READ("a16_address", any, fathom_a16_modbus_get_address(sensor, &address),
               address == rig->device.address);
    JUDGE_READ("a16_switch_polarity", any, fathom_a16_modbus_get_switch_polarity(sensor, &polarity),
               polarity == judge_held(0x0205));
    JUDGE_READ("a16_switch_threshold_mm", any,
               fathom_a16_modbus_get_switch_threshold_mm(sensor, &threshold_mm),
               threshold_mm == judge_held(0x0206));
    JUDGE_READ("a16_automatic_value", any, fathom_a16_modbus_get_automatic_value(sensor, &value),
               value == judge_held(0x0207));
}

static void set_all(rig_t *rig, fathom_a16_modbus_t *sensor)
{
    fathom_sensor_t any = fathom_a16_modbus_sensor(sensor);
    uint8_t address = rig->device.address == 5 ? 1 : 5;
    for (uint16_t v = 0; v < 2; v++) {
        JUDGE_SET("a16_set_switch_polarity", any,
                  fathom_a16_modbus_set_switch_polarity(sensor, (fathom_a16_polarity_t)v),
                  fathom_a16_modbus_is_written(sensor), HOLDS(0x0205, v));
        JUDGE_SET("a16_set_switch_threshold_mm", any, fathom_a16_modbus_set_switch_threshold_mm(sensor, 2000),
                  fathom_a16_modbus_is_written(sensor), HOLDS(0x0206, 2000));
        JUDGE_SET("a16_set_automatic_value", any,
                  fathom_a16_modbus_set_automatic_value(sensor, (fathom_dyp_value_t)v),
                  fathom_a16_modbus_is_written(sensor), HOLDS(0x0207, v));
    }
    JUDGE_SET("a16_set_address", any, fathom_a16_modbus_set_address(sensor, address),
              fathom_a16_modbus_is_written(sensor), HOLDS(0x0200, address));
}

void find_by_modbus(rig_t *rig, const fathom_sensor_t *any)
{
    fathom_dyp_modbus_find_t find = {0};
    uint8_t address = 0;
    JUDGE_READ("dyp_modbus_find", *any, fathom_dyp_modbus_find(&find, &rig->modbus, &address),
               address == rig->device.address);
}

void life_a16_rs485(rig_t *rig)
{
    fathom_a16_modbus_t sensor;
    fathom_sensor_t any = begin_modbus(rig, &sensor, rig->device.config.seed % 2);
    rig_power(rig, true);
    fathom_a16_modbus_power_on(&sensor);
    for (size_t i = 0; i < 3; i++) {
        show(rig, i + 2);
        judge_poll("a16_modbus", &any, 8, SETTLED_US);
    }
    ask_all(rig, &sensor);
    set_all(rig, &sensor);
    judge_poll("a16_modbus", &any, 4, SETTLED_US);
    JUDGE_SET("a16_set_operating_mode", any,
              fathom_a16_modbus_set_operating_mode(&sensor, FATHOM_A16_AUTOMATIC),
              fathom_a16_modbus_is_written(&sensor), ACKNOWLEDGED(0x0202, 1));
    fathom_a16_modbus_deinit(&sensor);
    rig_restart(rig, SECOND_US, 3 * SECOND_US);
    any = begin_modbus(rig, &sensor, 0); /* where it is now */
    judge_poll("a16_modbus", &any, 4, SETTLED_US);
    ask_all(rig, &sensor);
    find_by_modbus(rig, &any);
    JUDGE_SET("a16_set_address_to_0", any, fathom_a16_modbus_set_address_0(&sensor),
              fathom_a16_modbus_is_written(&sensor), HOLDS(0x0200, 0));
    judge_poll("a16_modbus", &any, 3, SETTLED_US);
    fathom_a16_modbus_deinit(&sensor);
}

void life_a16_rs232(rig_t *rig)
{
    fathom_a16_modbus_t sensor;
    fathom_a16_auto_t automatic;
    fathom_a16_rs232_t rs232;
    fathom_sample_t sample;
    fathom_status_t status;
    fathom_a16_auto_config_t config = {.stale_us = stale_us(rig), .gap_us = rig->line_parts.gap_us};
    rig_power(rig, true);
    assert_int_equal(fathom_a16_auto_init(&automatic, &rig->line, &config), FATHOM_OK);
    fathom_sensor_t by_itself = fathom_a16_auto_sensor(&automatic);
    judge_poll("a16_auto RS232", &by_itself, 8, SETTLED_US);
    fathom_sensor_t any = begin_modbus(rig, &sensor, 0);
    judge_poll("a16_modbus RS232", &any, 8, SETTLED_US);
    ask_all(rig, &sensor);
    set_all(rig, &sensor);
    fathom_a16_modbus_deinit(&sensor);
    any = begin_modbus(rig, &sensor, 1);
    show(rig, 1);
    judge_poll("a16_modbus RS232", &any, 4, SETTLED_US);
    fathom_a16_rs232_init(&rs232, &sensor, &automatic);
    judge_begin("a16_rs232_return_to_automatic");
    while ((status = fathom_a16_rs232_return_to_automatic(&rs232, &sample)) == FATHOM_PENDING)
        rig_pass(rig, fathom_a16_rs232_due_us(&rs232));
    if (status == FATHOM_OK) judge_sample(&sample);
    judge_set(status, fathom_a16_modbus_is_written(&sensor), ACKNOWLEDGED(0x0202, 1));
    judge_poll("a16_auto RS232 returned", &by_itself, 6, SETTLED_US);
    fathom_a16_auto_deinit(&automatic);
    fathom_a16_modbus_deinit(&sensor);
}
