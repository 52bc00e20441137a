/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/hps167s_settings.h"

#include <inttypes.h>

#include "fathom/sensor/hps167s_info.h"
#include "output/words.h"
#include "sensors/hps167s.h"

/* The commands of the HPS-167S (3, #1 to #15) except the two that reset: hps167s.c. */

#define KEPT       "kept in flash"
#define NEXT_POWER "from the next power-on; " KEPT

static const char *const off_on[] = {"off", "on", NULL};
static const char *const rates[] = {"19200", "57600", "115200", "230400",
                                    NULL}; /* in the order of their codes */
static const char *const user[] = {"user", NULL};

static fathom_hps167s_t *driver(reader_t *reader) { return &reader->driver.hps167s; }

/* ---- texts ---- */

static void print_version(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_decode_version(registers, &version);
    hps167s_interface_text(text, SETTING_TEXT, &version);
}

static void print_details(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_details_t details;
    fathom_hps167s_decode_details(registers, &details);
    hps167s_sensor_text(text, SETTING_TEXT, &details);
}

static void print_uuid(char text[SETTING_TEXT], const uint16_t *registers)
{
    fathom_hps167s_details_t details;
    fathom_hps167s_decode_details(registers, &details);
    hps167s_uuid_text(text, SETTING_TEXT, &details);
}

static void print_temperature(char text[SETTING_TEXT], const uint16_t *registers)
{
    const int16_t fahrenheit = fathom_hps167s_to_signed(registers[0]);
    decimal_text(text, SETTING_TEXT, fathom_hps167s_temperature_dc(fahrenheit, 1), 1);
}

static void print_baud(char text[SETTING_TEXT], const uint16_t *registers)
{
    const uint8_t code = fathom_hps167s_get_byte(registers, FATHOM_HPS167S_BAUD_BYTE);
    (void)snprintf(text, SETTING_TEXT, "%" PRIu32, fathom_hps167s_baud(code));
}

static void remark_termination(FILE *to, const char *text)
{
    if (text[1] == 'n')
        (void)fputs("the termination resistor is on, as in every sensor from the factory; on a line with "
                    "several, switch it off in all but the last with 'fathom set ... termination off'\n",
                    to);
}

/* ---- notes ---- */

static const char *note_baud_code(int64_t code)
{
    const bool has_rate = fathom_hps167s_baud_code(fathom_hps167s_baud((uint16_t)code)) == code;
    return has_rate ? NULL : "no code of #9: 19200";
}

static const char *note_load(int64_t value)
{
    return value == FATHOM_HPS167S_FACTORY ? "the factory settings" : NULL;
}

static const char *note_filter(int64_t value)
{
    return value < -FATHOM_HPS167S_MAX_FILTER || value > FATHOM_HPS167S_MAX_FILTER
               ? "outside the recommended -100..100"
               : NULL;
}

/* ---- reading and writing ---- */

static fathom_status_t read_command(fathom_hps167s_t *sensor, uint16_t command)
{
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    switch (command) {
    case FATHOM_HPS167S_VERSION:
        return fathom_hps167s_get_interface_version(sensor, &version);
    case FATHOM_HPS167S_CONFIGURATION:
        return fathom_hps167s_get_configuration(sensor, &configuration);
    case FATHOM_HPS167S_DETAILS:
        return fathom_hps167s_get_details(sensor, &details);
    default:
        return fathom_hps167s_get_temperature(sensor, &temperature);
    }
}

static fathom_status_t get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    const fathom_status_t status = read_command(driver(reader), setting->read_at);
    return status == FATHOM_OK ? setting_print(setting, driver(reader)->values, text) : status;
}

/* A code without a rate of its own shows nothing: the unit has the rate at which it responded. */
static fathom_status_t get_baud(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    const fathom_line_settings_t *const line = driver(reader)->unit.line_settings;
    const fathom_status_t status = get(reader, setting, text);
    const uint8_t code = fathom_hps167s_get_byte(driver(reader)->values, FATHOM_HPS167S_BAUD_BYTE);
    if (status == FATHOM_OK && line != NULL && note_baud_code(code) != NULL)
        (void)snprintf(text, SETTING_TEXT, "%" PRIu32, line->baud);
    return status;
}

static fathom_status_t set(reader_t *reader, const setting_t *setting, int32_t value)
{
    fathom_hps167s_t *const sensor = driver(reader);
    switch (setting->write_at) {
    case FATHOM_HPS167S_WARM_UP:
        return fathom_hps167s_set_warm_up_s(sensor, (uint8_t)value);
    case FATHOM_HPS167S_ADDRESS:
        return fathom_hps167s_set_address(sensor, (uint8_t)value);
    case FATHOM_HPS167S_BAUD:
        return fathom_hps167s_set_baud(sensor, fathom_hps167s_baud((uint16_t)(value + setting->first_word)));
    case FATHOM_HPS167S_MEASURES:
        return fathom_hps167s_set_measures_after_power_on(sensor, value != 0);
    case FATHOM_HPS167S_TERMINATION:
        return fathom_hps167s_set_termination(sensor, value != 0);
    case FATHOM_HPS167S_OFFSET:
        return fathom_hps167s_set_distance_offset_mm(sensor, (int16_t)value);
    case FATHOM_HPS167S_LOAD:
        return fathom_hps167s_load_user_settings(sensor);
    case FATHOM_HPS167S_FILTER:
        return fathom_hps167s_set_filter_sensitivity(sensor, (int16_t)value);
    default:
        return fathom_hps167s_set_reconnect_time_ms(sensor, (uint32_t)value);
    }
}

static fathom_status_t set_all(reader_t *reader, const setting_t *setting, int32_t value)
{
    return setting->write_at == FATHOM_HPS167S_MEASURES
               ? fathom_hps167s_broadcast_measures_after_power_on(driver(reader), value != 0)
               : fathom_hps167s_broadcast_termination(driver(reader), value != 0);
}

static bool is_baud_later(const reader_t *reader) { return reader->driver.hps167s.next_baud != 0; }

/* `fathom restore` writes them in this order: the settings that are loaded may have another offset and filter. */
const setting_t hps167s_settings[] = {
    {.name = "interface-version",
     .what = "of the RS485 interface (#1)",
     .read_at = FATHOM_HPS167S_VERSION,
     .kind = SETTING_VERSION,
     .print = print_version,
     .get = get},
    {.name = "sensor-version",
     .what = "of the sensor behind it (#3)",
     .read_at = FATHOM_HPS167S_DETAILS,
     .kind = SETTING_VERSION,
     .print = print_details,
     .get = get},
    {.name = "uuid",
     .what = "the sensor's own number (#3)",
     .read_at = FATHOM_HPS167S_DETAILS,
     .kind = SETTING_IDENTITY,
     .print = print_uuid,
     .get = get},
    {.name = "temperature",
     .what = "of its analog front end, sent in degrees Fahrenheit (#4)",
     .read_at = FATHOM_HPS167S_TEMPERATURE,
     .kind = SETTING_PRESENT,
     .unit = "degC",
     .print = print_temperature,
     .get = get},
    {.name = "address",
     .what = "Modbus address (#8)",
     .write_at = FATHOM_HPS167S_ADDRESS,
     .effect = "at once; " KEPT,
     .least = 1,
     .most = FATHOM_HPS167S_MAX_ADDRESS,
     .moves = true,
     .set = set},
    {.name = "baud",
     .what = "of the line (#9)",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_BAUD,
     .effect = "at once or from the next power-on, the datasheet does not say; " KEPT,
     .words = rates,
     .first_word = 1,
     .note = note_baud_code,
     .moves = true,
     .is_baud = true,
     .print = print_baud,
     .get = get_baud,
     .set = set,
     .is_later = is_baud_later},
    {.name = "baud-code",
     .what = "the rate as #2 has it: 1 to 4 by #9, all others mean 19200",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .byte = FATHOM_HPS167S_BAUD_BYTE,
     .size = 1,
     .kind = SETTING_PRESENT,
     .note = note_baud_code,
     .get = get},
    {.name = "warm-up",
     .what = "time without a response after power-on (#7)",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_WARM_UP,
     .byte = FATHOM_HPS167S_WARM_UP_BYTE,
     .size = 1,
     .unit = "s",
     .effect = KEPT,
     .most = 255,
     .get = get,
     .set = set},
    {.name = "measure-after-power-on",
     .what = "whether it measures continuously, so that a response is ready sooner (#10)",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_MEASURES,
     .byte = FATHOM_HPS167S_MEASURES_BYTE,
     .size = 1,
     .effect = NEXT_POWER,
     .words = off_on,
     .word_step = FATHOM_HPS167S_ON,
     .get = get,
     .set = set,
     .set_all = set_all},
    {.name = "termination",
     .what = "the termination resistor, on in every unit from the factory (#11)",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_TERMINATION,
     .byte = FATHOM_HPS167S_TERMINATION_BYTE,
     .size = 1,
     .effect = NEXT_POWER,
     .words = off_on,
     .word_step = FATHOM_HPS167S_ON,
     .get = get,
     .set = set,
     .set_all = set_all,
     .remark = remark_termination},
    {.name = "reconnect-time",
     .what = "after this time without data from its sensor it sends abnormal packets (#15)",
     .read_at = FATHOM_HPS167S_CONFIGURATION,
     .write_at = FATHOM_HPS167S_RECONNECT,
     .byte = FATHOM_HPS167S_RECONNECT_BYTE,
     .size = 4,
     .unit = "ms",
     .effect = KEPT,
     .most = 2147483646, /* 18 * 119304647 */
     .step = FATHOM_HPS167S_RECONNECT_STEP_MS,
     .get = get,
     .set = set},
    {.name = "load-settings",
     .what = "loads the settings that the user has saved (#13); for those of the factory: fathom reset",
     .write_at = FATHOM_HPS167S_LOAD,
     .effect = "at once; kept over power-off",
     .words = user,
     .note = note_load,
     .set = set},
    {.name = "distance-offset",
     .what = "added to what it measures; whether to an earlier offset too is not in the datasheet (#12)",
     .write_at = FATHOM_HPS167S_OFFSET,
     .unit = "mm",
     .effect = KEPT,
     .least = INT16_MIN,
     .most = INT16_MAX,
     .is_never_blind = true,
     .risk = "a sensor that has an offset already may add the new one to it",
     .set = set},
    {.name = "filter-sensitivity",
     .what = "larger is steadier and slower; 0 from the factory, -100 to 100 is recommended (#14)",
     .write_at = FATHOM_HPS167S_FILTER,
     .effect = KEPT,
     .least = INT16_MIN,
     .most = INT16_MAX,
     .note = note_filter,
     .set = set},
    {.name = NULL},
};
