/* SPDX-License-Identifier: MIT */
#include "fathom/sensor/a16_rs232.h"
#include "sensors/a16.h"
#include "sensors/dyp.h"

/* The registers of the A16 (6(3)). */

static const char *const modes[] = {"controlled", "automatic", NULL};
static const char *const on_only[] = {"on", NULL};
static const char *const polarities[] = {"negative", "positive", NULL};
static const char *const values[] = {"processed", "real-time", NULL};

/* Restarts the automatic output; its first frame is the result. */
static fathom_status_t set_automatic_output(reader_t *reader, const setting_t *setting, int32_t value)
{
    static fathom_a16_auto_t automatic;
    static fathom_a16_rs232_t rs232;
    static bool is_started;
    fathom_sample_t sample;
    (void)setting;
    (void)value;
    if (!is_started) {
        const fathom_a16_auto_config_t config = {.gap_us = PORT_STREAM_GAP_US};
        if (fathom_a16_auto_init(&automatic, reader->line, &config) != FATHOM_OK) return FATHOM_ERR_ARGUMENT;
        fathom_a16_rs232_init(&rs232, &reader->driver.a16_modbus, &automatic);
        is_started = true;
    }
    const fathom_status_t status = fathom_a16_rs232_return_to_automatic(&rs232, &sample);
    is_started = status == FATHOM_PENDING;
    return status;
}

static fathom_status_t get_distance(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT])
{
    const fathom_dyp_value_t value =
        setting->read_at == FATHOM_A16_REGISTER_REAL_TIME ? FATHOM_REAL_TIME : FATHOM_PROCESSED;
    fathom_sample_t sample;
    const fathom_status_t status = fathom_a16_modbus_measure(&reader->driver.a16_modbus, value, &sample);
    dyp_print_distance(text, status, &sample);
    return status;
}

const setting_t a16_settings[] = {
    {.name = "address",
     .what = "Modbus address (register 0x0200)",
     .read_at = DYP_ADDRESS,
     .write_at = DYP_ADDRESS,
     .effect = DYP_EFFECT,
     .least = 1,
     .most = DYP_MAX_ADDRESS,
     .has_zero = true,
     .moves = true,
     .is_never_blind = true,
     .get = dyp_get,
     .set = dyp_set},
    {.name = "operating-mode",
     .what = "the register alone (0x0202); automatic-output restarts the automatic output",
     .write_at = FATHOM_A16_REGISTER_OPERATING_MODE,
     .kind = SETTING_PRESENT,
     .effect = "at once; not kept over power-off. Any further command stops the automatic output again",
     .words = modes,
     .set = dyp_set},
    {.name = "automatic-output",
     .what = "RS232 variant: restarts the output that a Modbus command has stopped (0x0202)",
     .kind = SETTING_PRESENT,
     .effect = "at once; any further Modbus command stops it again",
     .words = on_only,
     .confirmed = "frames are heard",
     .unconfirmed = "no frame was heard in 10 s; only the RS232 variant sends by itself",
     .set = set_automatic_output},
    {.name = "switch-polarity",
     .what = "switch variant: the level when something is nearer than the threshold (0x0205)",
     .read_at = FATHOM_A16_REGISTER_SWITCH_POLARITY,
     .write_at = FATHOM_A16_REGISTER_SWITCH_POLARITY,
     .is_of_variant = true,
     .effect = DYP_EFFECT,
     .words = polarities,
     .get = dyp_get,
     .set = dyp_set},
    {.name = "switch-threshold",
     .what = "switch variant: the distance at which it switches (0x0206)",
     .read_at = FATHOM_A16_REGISTER_SWITCH_THRESHOLD,
     .write_at = FATHOM_A16_REGISTER_SWITCH_THRESHOLD,
     .is_of_variant = true,
     .unit = "mm",
     .effect = DYP_EFFECT,
     .least = 1,
     .most = FATHOM_A16_MAX_MM,
     .get = dyp_get,
     .set = dyp_set},
    {.name = "automatic-value",
     .what = "RS232 variant: the distance that the automatic output sends (0x0207)",
     .read_at = FATHOM_A16_REGISTER_AUTOMATIC_VALUE,
     .write_at = FATHOM_A16_REGISTER_AUTOMATIC_VALUE,
     .is_of_variant = true,
     .effect = DYP_EFFECT,
     .words = values,
     .get = dyp_get,
     .set = dyp_set},
    {.name = "distance",
     .what = "the processed distance (0x0100)",
     .read_at = FATHOM_A16_REGISTER_PROCESSED,
     .kind = SETTING_PRESENT,
     .unit = "mm",
     .get = get_distance},
    {.name = "real-time-distance",
     .what = "the newest measurement (0x0101)",
     .read_at = FATHOM_A16_REGISTER_REAL_TIME,
     .kind = SETTING_PRESENT,
     .unit = "mm",
     .get = get_distance},
    {.name = NULL},
};
