/* SPDX-License-Identifier: MIT */
/*
 * Each driver in zeroed memory, and after an init that was refused: poll and every command return FATHOM_ERR_ARGUMENT,
 * and nothing crashes. A refused init leaves the driver zeroed.
 */
#include "drivers.h"

#include "fathom/engine/modbus_client.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_controlled.h"
#include "fathom/sensor/a16_modbus.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_rs232.h"
#include "fathom/sensor/a16_settings.h"
#include "fathom/sensor/a16_switch.h"
#include "fathom/sensor/hps167_uart.h"
#include "fathom/sensor/hps167s_auto.h"
#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"

static const suite_t suite = {0};

typedef fathom_status_t (*call_t)(void);

enum { CALLS = 24 };

typedef struct {
    void *memory;
    size_t size;
    fathom_sensor_t (*sensor)(void);
    call_t refused_init; /* NULL: init refuses nothing */
    call_t commands[CALLS];
} driver_t;

#define PARAMETERS(...) __VA_ARGS__

/* A driver, with the parameters of its init without which it is refused. */
#define DRIVER(name, parameters)                                                                             \
    static fathom_##name##_t name;                                                                           \
    static fathom_sensor_t name##_sensor(void) { return fathom_##name##_sensor(&name); }                     \
    static fathom_status_t name##_refused(void)                                                              \
    {                                                                                                        \
        static const fathom_##name##_config_t nothing;                                                       \
        return fathom_##name##_init(&name, PARAMETERS parameters, &nothing);                                 \
    }

#define ITSELF(name)                                                                                         \
    .memory = &(name), .size = sizeof(name), .sensor = name##_sensor, .refused_init = name##_refused

#define COMMAND(name, ...)                                                                                   \
    static fathom_status_t name(void) { return __VA_ARGS__; }

static uint8_t byte;
static uint16_t word;
static fathom_sample_t sample;
static fathom_dyp_value_t value;
static fathom_a16_polarity_t polarity;
static fathom_hps167s_version_t version;
static fathom_hps167s_configuration_t configuration;
static fathom_hps167s_details_t details;
static fathom_hps167s_temperature_t temperature;

DRIVER(a05_auto, (NULL))
DRIVER(a05_dyp, (NULL))
DRIVER(a05_modbus, (NULL))
DRIVER(a05_relay, (NULL, NULL))
DRIVER(a16_auto, (NULL))
DRIVER(a16_controlled, (NULL, NULL))
DRIVER(a16_modbus, (NULL))
DRIVER(a16_pwm, (NULL, NULL, NULL))
DRIVER(a16_switch, (NULL, NULL))
DRIVER(hps167_uart, (NULL))
DRIVER(hps167s, (NULL))
DRIVER(hps167s_auto, (NULL))

/* ---- the commands ---- */

COMMAND(a05_auto_choose, fathom_a05_auto_select(&a05_auto, FATHOM_REAL_TIME))
COMMAND(a16_auto_choose, fathom_a16_auto_select(&a16_auto, FATHOM_REAL_TIME))

COMMAND(a05_dyp_every_address, fathom_a05_dyp_broadcast_address(&a05_dyp, 2))

COMMAND(a05_modbus_get_address, fathom_a05_modbus_get_address(&a05_modbus, &byte))
COMMAND(a05_modbus_put_address, fathom_a05_modbus_set_address(&a05_modbus, 2))
COMMAND(a05_modbus_put_0, fathom_a05_modbus_set_address_0(&a05_modbus))

COMMAND(a16_get_address, fathom_a16_modbus_get_address(&a16_modbus, &byte))
COMMAND(a16_put_address, fathom_a16_modbus_set_address(&a16_modbus, 2))
COMMAND(a16_put_0, fathom_a16_modbus_set_address_0(&a16_modbus))
COMMAND(a16_measure, fathom_a16_modbus_measure(&a16_modbus, FATHOM_REAL_TIME, &sample))
COMMAND(a16_blind, fathom_a16_modbus_write_next_unchecked(&a16_modbus))
COMMAND(a16_put_mode, fathom_a16_modbus_set_operating_mode(&a16_modbus, FATHOM_A16_AUTOMATIC))
COMMAND(a16_get_polarity, fathom_a16_modbus_get_switch_polarity(&a16_modbus, &polarity))
COMMAND(a16_put_polarity, fathom_a16_modbus_set_switch_polarity(&a16_modbus, FATHOM_A16_NEGATIVE))
COMMAND(a16_get_threshold, fathom_a16_modbus_get_switch_threshold_mm(&a16_modbus, &word))
COMMAND(a16_put_threshold, fathom_a16_modbus_set_switch_threshold_mm(&a16_modbus, 500))
COMMAND(a16_get_value, fathom_a16_modbus_get_automatic_value(&a16_modbus, &value))
COMMAND(a16_put_value, fathom_a16_modbus_set_automatic_value(&a16_modbus, FATHOM_REAL_TIME))

COMMAND(hps167_stop, fathom_hps167_uart_stop(&hps167_uart))
COMMAND(hps167_temperature, fathom_hps167_uart_get_temperature(&hps167_uart, &word))

COMMAND(hps_version, fathom_hps167s_get_interface_version(&hps167s, &version))
COMMAND(hps_configuration, fathom_hps167s_get_configuration(&hps167s, &configuration))
COMMAND(hps_details, fathom_hps167s_get_details(&hps167s, &details))
COMMAND(hps_temperature, fathom_hps167s_get_temperature(&hps167s, &temperature))
COMMAND(hps_blind, fathom_hps167s_write_next_unchecked(&hps167s))
COMMAND(hps_warm_up, fathom_hps167s_set_warm_up_s(&hps167s, 9))
COMMAND(hps_address, fathom_hps167s_set_address(&hps167s, 2))
COMMAND(hps_baud, fathom_hps167s_set_baud(&hps167s, 57600))
COMMAND(hps_measures, fathom_hps167s_set_measures_after_power_on(&hps167s, false))
COMMAND(hps_termination, fathom_hps167s_set_termination(&hps167s, false))
COMMAND(hps_measures_all, fathom_hps167s_broadcast_measures_after_power_on(&hps167s, false))
COMMAND(hps_termination_all, fathom_hps167s_broadcast_termination(&hps167s, false))
COMMAND(hps_offset, fathom_hps167s_set_distance_offset_mm(&hps167s, 1))
COMMAND(hps_load_user, fathom_hps167s_load_user_settings(&hps167s))
COMMAND(hps_load_factory, fathom_hps167s_load_factory_settings(&hps167s))
COMMAND(hps_filter, fathom_hps167s_set_filter_sensitivity(&hps167s, 1))
COMMAND(hps_reconnect, fathom_hps167s_set_reconnect_time_ms(&hps167s, 360))
COMMAND(hps_restore, fathom_hps167s_restore_factory_settings(&hps167s))

/* ---- the drivers ---- */

static const driver_t of_a05_auto = {ITSELF(a05_auto), .commands = {a05_auto_choose}};
static const driver_t of_a05_dyp = {ITSELF(a05_dyp), .commands = {a05_dyp_every_address}};
static const driver_t of_a05_modbus = {
    ITSELF(a05_modbus), .commands = {a05_modbus_get_address, a05_modbus_put_address, a05_modbus_put_0}};
static const driver_t of_a05_relay = {ITSELF(a05_relay)};
static const driver_t of_a16_auto = {ITSELF(a16_auto), .commands = {a16_auto_choose}};
static const driver_t of_a16_controlled = {ITSELF(a16_controlled)};
static const driver_t of_a16_modbus = {
    ITSELF(a16_modbus), .commands = {a16_get_address, a16_put_address, a16_put_0, a16_measure, a16_blind,
                                     a16_put_mode, a16_get_polarity, a16_put_polarity, a16_get_threshold,
                                     a16_put_threshold, a16_get_value, a16_put_value}};
static const driver_t of_a16_pwm = {ITSELF(a16_pwm)};
static const driver_t of_a16_switch = {ITSELF(a16_switch)};
static const driver_t of_hps167_uart = {ITSELF(hps167_uart), .commands = {hps167_stop, hps167_temperature}};
static const driver_t of_hps167s = {
    ITSELF(hps167s),
    .commands = {hps_version, hps_configuration, hps_details, hps_temperature, hps_blind, hps_warm_up,
                 hps_address, hps_baud, hps_measures, hps_termination, hps_measures_all, hps_termination_all,
                 hps_offset, hps_load_user, hps_load_factory, hps_filter, hps_reconnect, hps_restore}};
static const driver_t of_hps167s_auto = {ITSELF(hps167s_auto)};

static bool is_zeroed(const driver_t *driver)
{
    const uint8_t *const bytes = driver->memory;
    size_t i = 0;
    while (i != driver->size && bytes[i] == 0) i++;
    return i == driver->size;
}

static void refuses_everything(const driver_t *driver)
{
    const fathom_sensor_t sensor = driver->sensor();
    assert_int_equal(fathom_due_us(&sensor, 1), 0); /* The error is due at once. */
    for (unsigned times = 0; times != 2; times++) { /* what was refused changes nothing */
        fathom_sample_t last;
        assert_int_equal(checked_poll(&sensor, &last), FATHOM_ERR_ARGUMENT);
        assert_int_equal(fathom_due_us(&sensor, 1), 0); /* The error is due at once. */
        for (unsigned i = 0; i != CALLS && driver->commands[i] != NULL; i++)
            if (driver->commands[i]() != FATHOM_ERR_ARGUMENT) fail_msg("command %u", i);
    }
}

static void in_zeroed_memory(void **state)
{
    const driver_t *const driver = *state;
    memset(driver->memory, 0, driver->size);
    refuses_everything(driver);
}

static void after_a_refused_init(void **state)
{
    const driver_t *const driver = *state;
    memset(driver->memory, GUARD, driver->size);
    assert_int_equal(driver->refused_init(), FATHOM_ERR_ARGUMENT);
    assert_true(is_zeroed(driver));
    refuses_everything(driver);
}

#define OF(name)                                                                                             \
    TEST_ROW(name##_in_zeroed_memory_refuses_everything, in_zeroed_memory, (void *)&of_##name)               \
    TEST_ROW(name##_after_a_refused_init_is_zeroed_and_refuses_everything, after_a_refused_init,             \
             (void *)&of_##name)

OF(a05_auto)
OF(a05_dyp)
OF(a05_modbus)
OF(a05_relay)
OF(a16_auto)
OF(a16_controlled)
OF(a16_modbus)
OF(a16_pwm)
OF(a16_switch)
OF(hps167_uart)
OF(hps167s)
OF(hps167s_auto)

/* ---- what has no result ---- */

TEST(power_on_cancel_and_deinit_of_a_zeroed_driver_do_nothing)
{
    memset(&a05_dyp, 0, sizeof a05_dyp);
    memset(&a05_modbus, 0, sizeof a05_modbus);
    memset(&a16_modbus, 0, sizeof a16_modbus);
    memset(&hps167_uart, 0, sizeof hps167_uart);
    memset(&hps167s, 0, sizeof hps167s);
    fathom_a05_dyp_power_on(&a05_dyp);
    fathom_a05_dyp_cancel(&a05_dyp);
    fathom_a05_dyp_deinit(&a05_dyp);
    fathom_a05_modbus_power_on(&a05_modbus);
    fathom_a05_modbus_cancel(&a05_modbus);
    fathom_a05_modbus_deinit(&a05_modbus);
    fathom_a16_modbus_power_on(&a16_modbus);
    fathom_a16_modbus_cancel(&a16_modbus);
    fathom_a16_modbus_deinit(&a16_modbus);
    fathom_hps167_uart_power_on(&hps167_uart);
    fathom_hps167_uart_cancel(&hps167_uart);
    fathom_hps167_uart_deinit(&hps167_uart);
    fathom_hps167s_power_on(&hps167s);
    fathom_hps167s_cancel(&hps167s);
    fathom_hps167s_deinit(&hps167s);
    memset(&a16_controlled, 0, sizeof a16_controlled);
    assert_int_equal(fathom_a16_controlled_deinit(&a16_controlled), FATHOM_OK);
    refuses_everything(&of_a05_dyp);
    refuses_everything(&of_a05_modbus);
    refuses_everything(&of_a16_modbus);
    refuses_everything(&of_hps167_uart);
    refuses_everything(&of_hps167s);
}

/* A transport of a line that was not initialised has no clock, and no driver accepts it. */
TEST(a_transport_over_a_zeroed_line_is_refused)
{
    static fathom_line_t line;
    const fathom_modbus_t modbus = fathom_modbus_client(&line);
    assert_int_equal(fathom_hps167s_init(&hps167s, &modbus, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_init(&a16_modbus, &modbus, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a05_modbus_init(&a05_modbus, &modbus, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a05_dyp_init(&a05_dyp, &line, NULL), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_hps167_uart_init(&hps167_uart, &line, NULL), FATHOM_ERR_ARGUMENT);
}
