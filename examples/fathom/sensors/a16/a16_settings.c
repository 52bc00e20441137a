/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_rs232.h"
#include "sensors/a16/a16.h"
#include "sensors/dyp.h"

/* A16 6(3). */

static const char *const off_words[] = {"controlled", "automatic", NULL};
static const char *const on_only[] = {"on", NULL};
static const char *const polarities[] = {"negative", "positive", NULL};
static const char *const values[] = {"processed", "real-time", NULL};

/* Where no word stands for it nothing is OK: the driver has refused it. */
static void put_word(char text[SETTING_TEXT], fathom_status_t status, const char *const *words,
                     unsigned number)
{
    if (status == FATHOM_OK) (void)snprintf(text, SETTING_TEXT, "%s", words[number]);
}

static fathom_status_t get_address(reader_t *reader, char text[SETTING_TEXT])
{
    uint8_t address = 0;
    const fathom_status_t status = fathom_a16_modbus_get_address(&reader->driver.a16_modbus, &address);
    dyp_put_number(text, status, address);
    return status;
}

static fathom_status_t set_address(reader_t *reader, int32_t value)
{
    fathom_a16_modbus_t *const driver = &reader->driver.a16_modbus;
    return value == 0 ? fathom_a16_modbus_set_address_0(driver)
                      : fathom_a16_modbus_set_address(driver, (uint8_t)value);
}

static fathom_status_t set_mode(reader_t *reader, int32_t value)
{
    return fathom_a16_modbus_set_operating_mode(&reader->driver.a16_modbus,
                                                (fathom_a16_operating_mode_t)value);
}

/* Back to frames that come by themselves; with the first one it is done. */
static fathom_status_t send_again(reader_t *reader, int32_t value)
{
    static fathom_a16_auto_t automatic;
    static fathom_a16_rs232_t rs232;
    static bool is_begun;
    fathom_sample_t sample;
    (void)value;
    if (!is_begun) {
        const fathom_a16_auto_config_t config = {.gap_us = CHANNEL_STREAM_GAP_US};
        if (fathom_a16_auto_init(&automatic, reader->line, &config) != FATHOM_OK) return FATHOM_ERR_ARGUMENT;
        fathom_a16_rs232_init(&rs232, &reader->driver.a16_modbus, &automatic);
        is_begun = true;
    }
    const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&rs232, &sample);
    is_begun = status == FATHOM_PENDING;
    return status;
}

static fathom_status_t get_polarity(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_a16_polarity_t polarity = FATHOM_A16_NEGATIVE;
    const fathom_status_t status =
        fathom_a16_modbus_get_switch_polarity(&reader->driver.a16_modbus, &polarity);
    put_word(text, status, polarities, (unsigned)polarity);
    return status;
}

static fathom_status_t set_polarity(reader_t *reader, int32_t value)
{
    return fathom_a16_modbus_set_switch_polarity(&reader->driver.a16_modbus, (fathom_a16_polarity_t)value);
}

static fathom_status_t get_threshold(reader_t *reader, char text[SETTING_TEXT])
{
    uint16_t threshold_mm = 0;
    const fathom_status_t status =
        fathom_a16_modbus_get_switch_threshold_mm(&reader->driver.a16_modbus, &threshold_mm);
    dyp_put_number(text, status, threshold_mm);
    return status;
}

static fathom_status_t set_threshold(reader_t *reader, int32_t value)
{
    return fathom_a16_modbus_set_switch_threshold_mm(&reader->driver.a16_modbus, (uint16_t)value);
}

static fathom_status_t get_value(reader_t *reader, char text[SETTING_TEXT])
{
    fathom_dyp_value_t value = FATHOM_PROCESSED;
    const fathom_status_t status = fathom_a16_modbus_get_automatic_value(&reader->driver.a16_modbus, &value);
    put_word(text, status, values, (unsigned)value);
    return status;
}

static fathom_status_t set_value(reader_t *reader, int32_t value)
{
    return fathom_a16_modbus_set_automatic_value(&reader->driver.a16_modbus, (fathom_dyp_value_t)value);
}

static fathom_status_t get_distance(reader_t *reader, char text[SETTING_TEXT], fathom_dyp_value_t value)
{
    fathom_sample_t sample;
    const fathom_status_t status = fathom_a16_modbus_measure(&reader->driver.a16_modbus, value, &sample);
    dyp_put_distance(text, status, &sample);
    return status;
}

static fathom_status_t get_processed(reader_t *reader, char text[SETTING_TEXT])
{
    return get_distance(reader, text, FATHOM_PROCESSED);
}

static fathom_status_t get_real_time(reader_t *reader, char text[SETTING_TEXT])
{
    return get_distance(reader, text, FATHOM_REAL_TIME);
}

const setting_t a16_settings[] = {
    {.name = "address",
     .what = "Modbus address (register 0x0200)",
     .mode = "modbus",
     .effect = DYP_KEPT_UNSAID,
     .least = 1,
     .most = 254,
     .has_zero = true,
     .moves = true,
     .is_never_blind = true,
     .get = get_address,
     .set = set_address},
    {.name = "operating-mode",
     .what = "the register by itself (0x0202); to have automatic output back: automatic-output",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .effect = "at once; not kept over power-off. Any further command ends automatic output again",
     .words = off_words,
     .set = set_mode},
    {.name = "automatic-output",
     .what = "RS232 variant: takes up again the output that a Modbus command has ended (0x0202)",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .effect = "at once; any further Modbus command ends it again",
     .words = on_only,
     .confirmed = "frames are heard",
     .unconfirmed = "no frame was heard in 10 s; only the RS232 variant sends by itself",
     .set = send_again},
    {.name = "switch-polarity",
     .what = "switch variant: the level when something is nearer than the threshold (0x0205)",
     .is_of_variant = true,
     .mode = "modbus",
     .effect = DYP_KEPT_UNSAID,
     .words = polarities,
     .get = get_polarity,
     .set = set_polarity},
    {.name = "switch-threshold",
     .what = "switch variant: the distance at which it switches (0x0206)",
     .is_of_variant = true,
     .mode = "modbus",
     .unit = "mm",
     .effect = DYP_KEPT_UNSAID,
     .least = 1,
     .most = FATHOM_A16_MAX_MM,
     .get = get_threshold,
     .set = set_threshold},
    {.name = "automatic-value",
     .what = "RS232 variant: the distance that automatic output sends (0x0207)",
     .is_of_variant = true,
     .mode = "modbus",
     .effect = DYP_KEPT_UNSAID,
     .words = values,
     .get = get_value,
     .set = set_value},
    {.name = "distance",
     .what = "the processed distance (0x0100)",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .unit = "mm",
     .get = get_processed},
    {.name = "real-time-distance",
     .what = "the last measurement (0x0101)",
     .kind = SETTING_PRESENT,
     .mode = "modbus",
     .unit = "mm",
     .get = get_real_time},
    {.name = NULL},
};
