/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"
#include "output/words.h"
#include "sensors/hps167s/hps167s.h"

/* The commands of the HPS-167S (3, #1 to #15) but for the two that restore the factory's settings: hps167s.c. */

#define KEPT       "kept in flash"
#define NEXT_POWER "from the next power-on; " KEPT

static const char *const off_on[] = {"off", "on", NULL};
/* In the order of their codes. */
static const char *const rates[] = {"19200", "57600", "115200", "230400", NULL};
static const char *const user[] = {"user", NULL};

static fathom_hps167s_t *driver(reader_t *reader) { return &reader->driver.hps167s; }

/* ---- #1, #3, #4: what it is ---- */

static fathom_status_t get_version(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_version_t version;
    const fathom_status_t status = fathom_hps167s_get_interface_version(driver(reader), &version);
    if (status == FATHOM_OK) hps167s_interface_text(text, SETTING_TEXT, &version);
    return status;
}

static fathom_status_t get_details(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_details_t details;
    const fathom_status_t status = fathom_hps167s_get_details(driver(reader), &details);
    if (status == FATHOM_OK) hps167s_sensor_text(text, SETTING_TEXT, &details);
    return status;
}

static fathom_status_t get_uuid(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_details_t details;
    const fathom_status_t status = fathom_hps167s_get_details(driver(reader), &details);
    if (status == FATHOM_OK) hps167s_uuid_text(text, SETTING_TEXT, &details);
    return status;
}

static fathom_status_t get_temperature(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_temperature_t temperature;
    const fathom_status_t status = fathom_hps167s_get_temperature(driver(reader), &temperature);
    if (status == FATHOM_OK) tenths_text(text, SETTING_TEXT, temperature.temperature_dc);
    return status;
}

/* ---- #2 and what it reads back ---- */

static fathom_status_t get_number(reader_t *reader, char text[SETTING_TEXT],
                                  uint32_t (*pick)(const fathom_hps167s_configuration_t *))
{
    fathom_hps167s_configuration_t configuration;
    const fathom_status_t status = fathom_hps167s_get_configuration(driver(reader), &configuration);
    if (status == FATHOM_OK) (void)snprintf(text, SETTING_TEXT, "%" PRIu32, pick(&configuration));
    return status;
}

static uint32_t pick_baud_code(const fathom_hps167s_configuration_t *is) { return is->baud_code; }
static uint32_t pick_warm_up(const fathom_hps167s_configuration_t *is) { return is->warm_up_s; }
static uint32_t pick_reconnect(const fathom_hps167s_configuration_t *is) { return is->reconnect_time_ms; }

/* A code without a rate of its own tells nothing: it is where it has answered. */
static fathom_status_t get_baud(reader_t *reader, char text[SETTING_TEXT])
{
    const fathom_line_settings_t *const line = driver(reader)->unit.line_settings;
    fathom_hps167s_configuration_t is;
    const fathom_status_t status = fathom_hps167s_get_configuration(driver(reader), &is);
    if (status != FATHOM_OK) return status;
    const bool is_told = fathom_hps167s_baud_code(is.baud) == is.baud_code;
    (void)snprintf(text, SETTING_TEXT, "%" PRIu32, is_told || line == NULL ? is.baud : line->baud);
    return status;
}

static fathom_status_t get_baud_code(reader_t *reader, char text[SETTING_TEXT])
{
    return get_number(reader, text, pick_baud_code);
}

static fathom_status_t get_warm_up(reader_t *reader, char text[SETTING_TEXT])
{
    return get_number(reader, text, pick_warm_up);
}

static fathom_status_t get_reconnect(reader_t *reader, char text[SETTING_TEXT])
{
    return get_number(reader, text, pick_reconnect);
}

static fathom_status_t get_termination(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_configuration_t is;
    const fathom_status_t status = fathom_hps167s_get_configuration(driver(reader), &is);
    if (status == FATHOM_OK) (void)snprintf(text, SETTING_TEXT, "%s", off_on[is.termination]);
    return status;
}

static fathom_status_t get_measures(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_hps167s_configuration_t is;
    const fathom_status_t status = fathom_hps167s_get_configuration(driver(reader), &is);
    if (status == FATHOM_OK) (void)snprintf(text, SETTING_TEXT, "%s", off_on[is.measures_after_power_on]);
    return status;
}

static void remark_termination(FILE *to, const char *text)
{
    if (text[1] == 'n')
        (void)fputs("fathom: the termination resistor is on, as in every unit from "
                    "the factory; on a line with several, "
                    "leave it on in the\nfathom: last one only: fathom set ... "
                    "termination off\n",
                    to);
}

/* ---- #7 to #15 ---- */

static fathom_status_t set_address(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_address(driver(reader), (uint8_t)value);
}

static fathom_status_t set_baud(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_baud(driver(reader), fathom_hps167s_baud((uint16_t)(value + 1)));
}

static bool is_baud_later(const reader_t *reader) { return reader->driver.hps167s.next_baud != 0; }

static fathom_status_t set_warm_up(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_warm_up_s(driver(reader), (uint8_t)value);
}

static fathom_status_t set_measures(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_measures_after_power_on(driver(reader), value != 0);
}

static fathom_status_t set_termination(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_termination(driver(reader), value != 0);
}

static fathom_status_t set_measures_of_all(reader_t *reader, int32_t value)
{
    return fathom_hps167s_broadcast_measures_after_power_on(driver(reader), value != 0);
}

static fathom_status_t set_termination_of_all(reader_t *reader, int32_t value)
{
    return fathom_hps167s_broadcast_termination(driver(reader), value != 0);
}

static fathom_status_t set_reconnect(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_reconnect_time_ms(driver(reader), (uint32_t)value);
}

static fathom_status_t set_offset(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_distance_offset_mm(driver(reader), (int16_t)value);
}

static fathom_status_t set_filter(reader_t *reader, int32_t value)
{
    return fathom_hps167s_set_filter_sensitivity(driver(reader), (int16_t)value);
}

static fathom_status_t load_user(reader_t *reader, int32_t value)
{
    (void)value;
    return fathom_hps167s_load_user_settings(driver(reader));
}

/* In the order in which `fathom restore` writes them: what is loaded may have an offset and a filter of its own. */
const setting_t hps167s_settings[] = {
    {.name = "interface-version",
     .what = "of the RS485 interface (#1)",
     .kind = SETTING_VERSION,
     .mode = "modbus",
     .get = get_version},
    {.name = "sensor-version",
     .what = "of the sensor behind it (#3)",
     .kind = SETTING_VERSION,
     .mode = "modbus",
     .get = get_details},
    {.name = "uuid",
     .what = "the sensor's own number (#3)",
     .kind = SETTING_IDENTITY,
     .mode = "modbus",
     .get = get_uuid},
    {.name = "temperature",
     .what = "of its analog front end, told in degrees Fahrenheit (#4)",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .unit = "degC",
     .get = get_temperature},
    {.name = "address",
     .what = "Modbus address (#8)",
     .mode = "modbus",
     .effect = "at once; " KEPT,
     .least = 1,
     .most = FATHOM_HPS167S_MAX_ADDRESS,
     .moves = true,
     .set = set_address},
    {.name = "baud",
     .what = "of the line (#9)",
     .mode = "modbus",
     .effect = "at once or from the next power-on, the datasheet does not say; " KEPT,
     .words = rates,
     .moves = true,
     .is_baud = true,
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_baud,
     .set = set_baud,
     .is_later = is_baud_later},
    {.name = "baud-code",
     .what = "the rate as it tells it (#2): 1 to 4 by #9, all others mean 19200",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_baud_code},
    {.name = "warm-up",
     .what = "how long it is silent after power-on (#7)",
     .mode = "modbus",
     .unit = "s",
     .effect = KEPT,
     .most = 255,
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_warm_up,
     .set = set_warm_up},
    {.name = "measure-after-power-on",
     .what = "whether it measures all the time, so that a response is ready "
             "sooner (#10)",
     .mode = "modbus",
     .effect = NEXT_POWER,
     .words = off_on,
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_measures,
     .set = set_measures,
     .set_all = set_measures_of_all},
    {.name = "termination",
     .what = "the termination resistor, on in every unit from the factory (#11)",
     .mode = "modbus",
     .effect = NEXT_POWER,
     .words = off_on,
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_termination,
     .set = set_termination,
     .set_all = set_termination_of_all,
     .remark = remark_termination},
    {.name = "reconnect-time",
     .what = "without data from its sensor for so long it sends abnormal "
             "packets (#15)",
     .mode = "modbus",
     .unit = "ms",
     .effect = KEPT,
     .most = 2147483646, /* 18 * 119304647 */
     .step = FATHOM_HPS167S_RECONNECT_STEP_MS,
     .shared_command = FATHOM_HPS167S_CONFIGURATION,
     .get = get_reconnect,
     .set = set_reconnect},
    {.name = "load-settings",
     .what = "takes the settings that the user has saved (#13); for the "
             "factory's: fathom reset",
     .mode = "modbus",
     .effect = "at once; kept over power-off",
     .words = user,
     .set = load_user},
    {.name = "distance-offset",
     .what = "added to what it measures; whether to an offset from before too "
             "is not in the datasheet (#12)",
     .mode = "modbus",
     .unit = "mm",
     .effect = KEPT,
     .least = INT16_MIN,
     .most = INT16_MAX,
     .is_never_blind = true,
     .risk = "a unit that has an offset already may get the sum; fathom calibrate finds out",
     .set = set_offset},
    {.name = "filter-sensitivity",
     .what = "larger is steadier and slower; 0 from the factory, within -100 "
             "to 100 is recommended (#14)",
     .mode = "modbus",
     .effect = KEPT,
     .least = INT16_MIN,
     .most = INT16_MAX,
     .set = set_filter},
    {.name = NULL},
};
