/* SPDX-License-Identifier: MIT */
#include "second_lives.h"

#include "suite.h"

enum { SECOND_US = 1000000, SETTLED_US = 8000000 };

static const int32_t there_mm[] = {2083, 255, 17900, SECOND_NOTHING, 80, 40, 1200};
enum { THERE = sizeof there_mm / sizeof there_mm[0] };

typedef struct {
    fathom_hps167s_t sensor;
    fathom_line_settings_t settings;
    fathom_sensor_t any;
} hps_driver_t;

static hps_driver_t h;

static void begin(rig_t *rig)
{
    h.settings = (fathom_line_settings_t){rig->device.line.baud, FATHOM_PARITY_EVEN, 1};
    fathom_hps167s_config_t config = {.modbus.line_settings = &h.settings,
                                      .modbus.address = rig->device.address,
                                      .modbus.retries = 2,
                                      .warm_up_s = rig->device.hps.flash.warm_s};
    config.no_warm_up = config.warm_up_s == 0;
    config.low_word_first = second_choice(&rig->device, CHOICE_hps_reconnect_order) == 2;
    assert_int_equal(fathom_hps167s_init(&h.sensor, &rig->modbus, &config), FATHOM_OK);
    h.any = fathom_hps167s_sensor(&h.sensor);
}

/* The driver goes where the device is, as its user would have to find out. */
static void find(rig_t *rig)
{
    fathom_hps167s_deinit(&h.sensor);
    begin(rig);
}

#define READ(name, call, is_right)                                                                           \
    do {                                                                                                     \
        fathom_status_t status;                                                                              \
        judge_begin(name);                                                                                   \
        JUDGE_RUN(status, h.any, call);                                                                      \
        if (status == FATHOM_PENDING) fathom_hps167s_cancel(&h.sensor);                                      \
        judge_read(status, is_right);                                                                        \
    } while (0)

static void info(rig_t *rig)
{
    fathom_hps167s_version_t version = {0};
    fathom_hps167s_configuration_t c = {0};
    fathom_hps167s_details_t details = {0};
    fathom_hps167s_temperature_t t = {0};
    const hps_t *d = &rig->device.hps;
    static const uint32_t rates[] = {19200, 19200, 57600, 115200, 230400};
    READ("hps167s_interface_version", fathom_hps167s_get_interface_version(&h.sensor, &version),
         version.year == 2000 + d->version[0] && version.month == d->version[1] &&
             version.day == d->version[2] && version.major == d->version[3] &&
             version.minor == d->version[4] && version.revision == d->version[5]);
    const hps_settings_t *reported =
        second_choice(&rig->device, CHOICE_hps_reported) == 0 ? &d->set : &d->used;
    uint32_t ms = reported->reconnect_ms;
    if (second_choice(&rig->device, CHOICE_hps_reconnect_order) == 1) ms = __builtin_bswap32(ms);
    READ("hps167s_configuration", fathom_hps167s_get_configuration(&h.sensor, &c),
         c.baud == rates[reported->baud_code < 5 ? reported->baud_code : 0] &&
             c.warm_up_s == reported->warm_s && c.termination == (reported->termination != 0) &&
             c.reconnect_time_ms == ms && c.measures_after_power_on == (reported->auto_out != 0));
    READ("hps167s_details", fathom_hps167s_get_details(&h.sensor, &details),
         details.uuid[0] == d->details[1] && details.uuid[15] == d->details[16] &&
             details.year == 2000 + d->details[17]);
    READ("hps167s_temperature", fathom_hps167s_get_temperature(&h.sensor, &t),
         t.fahrenheit == (int16_t)second_choice(&rig->device, CHOICE_hps_temperature));
}

#define SET(name, call, wanted)                                                                              \
    do {                                                                                                     \
        judge_begin(name);                                                                                   \
        JUDGE_RUN(status, h.any, call);                                                                      \
        judge_set(status, fathom_hps167s_is_written(&h.sensor), wanted);                                     \
        if (status == FATHOM_PENDING) fathom_hps167s_cancel(&h.sensor);                                      \
    } while (0)

static void set_all(rig_t *rig)
{
    fathom_status_t status;
    fathom_hps167s_t *s = &h.sensor;
    uint32_t ms = 360;
    bool is_swapped = second_choice(&rig->device, CHOICE_hps_reconnect_order) == 1;
    for (int on = 0; on < 2; on++) {
        SET("hps167s_set_warm_up_s", fathom_hps167s_set_warm_up_s(s, (uint8_t)(3 + on)), HOLDS(0x0A, 3 + on));
        SET("hps167s_set_measures_after_power_on", fathom_hps167s_set_measures_after_power_on(s, on != 0),
            HOLDS(0x12, on != 0 ? 0xFF : 0));
        SET("hps167s_set_termination", fathom_hps167s_set_termination(s, on != 0),
            HOLDS(0x13, on != 0 ? 0xFF : 0));
    }
    SET("hps167s_set_reconnect_time_ms", fathom_hps167s_set_reconnect_time_ms(s, ms),
        HOLDS(0x20, is_swapped ? __builtin_bswap32(ms) : ms));
    SET("hps167s_set_distance_offset_mm", fathom_hps167s_set_distance_offset_mm(s, -15),
        ACKNOWLEDGED(0x14, -15));
    SET("hps167s_set_filter_sensitivity", fathom_hps167s_set_filter_sensitivity(s, 20),
        ACKNOWLEDGED(0x16, 20));
    judge_poll("hps167s", &h.any, 6, SETTLED_US);
    SET("hps167s_load_user_settings", fathom_hps167s_load_user_settings(s), ACKNOWLEDGED(0x15, 0));
    find(rig);
    SET("hps167s_load_factory_settings", fathom_hps167s_load_factory_settings(s), ACKNOWLEDGED(0x15, 0xFF));
    rig_wait(rig, 20000);
    find(rig);
    assert_int_equal(fathom_hps167s_write_next_unchecked(s), FATHOM_OK);
    SET("hps167s_next_is_blind", fathom_hps167s_set_termination(s, false), SENT(0x13, 0));
    SET("hps167s_set_termination_of_all_units", fathom_hps167s_broadcast_termination(s, true),
        SENT(0x13, 0xFF));
    SET("hps167s_set_measures_..._of_all_units", fathom_hps167s_broadcast_measures_after_power_on(s, true),
        SENT(0x12, 0xFF));
    SET("hps167s_set_address", fathom_hps167s_set_address(s, 12), HOLDS(0x10, 12));
    if (status != FATHOM_OK) find(rig);
    judge_poll("hps167s", &h.any, 4, SETTLED_US);
    SET("hps167s_set_baud", fathom_hps167s_set_baud(s, 115200), HOLDS(0x11, 3));
    if (status != FATHOM_OK) find(rig);
    judge_poll("hps167s", &h.any, 4, SETTLED_US);
}

static void restart(rig_t *rig)
{
    rig_power(rig, false);
    rig_wait(rig, SECOND_US);
    rig_power(rig, true);
    find(rig);
    fathom_hps167s_power_on(&h.sensor);
}

void life_hps167s(rig_t *rig)
{
    begin(rig);
    rig_power(rig, true);
    fathom_hps167s_power_on(&h.sensor);
    rig_wait(rig, rig->device.config.seed % 2 * 9 * SECOND_US);
    for (size_t i = 0; i < THERE; i++) {
        rig_scene(rig, there_mm[i], 0, 0, 0);
        judge_poll("hps167s", &h.any, i == 0 ? 60 : 10, SETTLED_US);
    }
    info(rig);
    set_all(rig);
    restart(rig);
    judge_poll("hps167s", &h.any, 60, 12000000);
    info(rig);
    second_fault(&rig->device, true, rig->now_us);
    judge_poll("hps167s failed", &h.any, 10, SETTLED_US);
    info(rig);
    second_fault(&rig->device, false, rig->now_us);
    JUDGE_SET("hps167s_restore_factory_settings", h.any, fathom_hps167s_restore_factory_settings(&h.sensor),
              fathom_hps167s_is_written(&h.sensor), HOLDS(0x10, 1));
    fathom_hps167s_deinit(&h.sensor);
}

/* Listens to what comes unasked, beside a driver that asks now and then. */
void life_hps167s_auto(rig_t *rig)
{
    fathom_hps167s_auto_t listener;
    begin(rig);
    assert_int_equal(fathom_hps167s_auto_init(&listener, &rig->line, NULL), FATHOM_OK);
    fathom_hps167s_auto_follow(&listener, &h.sensor);
    fathom_sensor_t any = fathom_hps167s_auto_sensor(&listener);
    rig_power(rig, true);
    for (size_t i = 0; i < THERE; i++) {
        rig_scene(rig, there_mm[i], 0, 0, 0);
        judge_poll("hps167s_auto", &any, 20, SETTLED_US);
        if (i == 3) info(rig);
    }
    fathom_hps167s_auto_deinit(&listener);
    fathom_hps167s_deinit(&h.sensor);
}

/* ---- HPS-167 with a UART ---- */

static fathom_hps167_uart_t uart;

#define READ_UART(name, call, is_right)                                                                      \
    do {                                                                                                     \
        fathom_status_t status;                                                                              \
        judge_begin(name);                                                                                   \
        JUDGE_RUN(status, any, call);                                                                        \
        judge_read(status, is_right);                                                                        \
    } while (0)

static void live_uart(rig_t *rig, bool is_continuous, const char *name)
{
    const fathom_hps167_uart_config_t config = {.modbus.retries = 2, .continuous = is_continuous};
    uint16_t temperature = 0;
    assert_int_equal(fathom_hps167_uart_init(&uart, &rig->line, &config), FATHOM_OK);
    const fathom_sensor_t any = fathom_hps167_uart_sensor(&uart);
    rig_power(rig, true);
    for (size_t i = 0; i < 2 * THERE; i++) {
        rig_scene(rig, there_mm[i % THERE], 0, 0, 0);
        judge_poll(name, &any, 20, SETTLED_US);
        if (i % 4 == 3)
            READ_UART("hps167_temperature", fathom_hps167_uart_get_temperature(&uart, &temperature),
                      temperature == second_choice(&rig->device, CHOICE_hps167_temperature));
        if (i == 4) rig_restart(rig, SECOND_US / 2, 0);
        if (i == 9) READ_UART("hps167_stop", fathom_hps167_uart_stop(&uart), !rig->device.automatic);
    }
    fathom_hps167_uart_deinit(&uart);
    rig_wait(rig, SECOND_US);
    assert_false(rig->device.automatic);
}

void life_hps167(rig_t *rig) { live_uart(rig, false, "hps167"); }
void life_hps167_continuous(rig_t *rig) { live_uart(rig, true, "hps167_continuous"); }
