/* SPDX-License-Identifier: MIT */
#include "commands/read/fields.h"

#include <inttypes.h>

#include "cli/options.h"
#include "diagnosis/status_word.h"
#include "output/timestamp.h"

typedef struct {
    const char *name;
    const char *unit;
    const char *what;                                                /* and when it is null */
    bool is_string;                                                  /* quoted in JSON */
    bool is_measured;                                                /* null where an attempt has failed */
    uint8_t needs;                                                   /* COLUMNS_...; 0: it is always there */
    void (*format)(const reading_t *reading, char text[VALUE_TEXT]); /* leaves text empty for null */
} field_t;

static void put_number(char text[VALUE_TEXT], uint64_t number)
{
    (void)snprintf(text, VALUE_TEXT, "%" PRIu64, number);
}

static void put_string(char text[VALUE_TEXT], const char *string)
{
    (void)snprintf(text, VALUE_TEXT, "%s", string);
}

bool fields_is_contact(const reading_t *reading) { return (reading->mode->pins & MODEL_PIN_IN) != 0; }

bool fields_has_probe(const reading_t *reading)
{
    return !fields_is_contact(reading) || reading->model->probes == 1;
}

static void put_name(const reading_t *reading, char text[VALUE_TEXT]) { put_string(text, reading->name); }

static void put_sensor(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->model->name);
}

static void put_mode(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->mode->name);
}

static void put_address(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->mode->has_address) put_number(text, reading->sample->address);
}

static void put_probe(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->sample->probe != 0 && fields_has_probe(reading)) put_number(text, reading->sample->probe);
}

static void put_sequence(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->sequence);
}

static void put_time(const reading_t *reading, char text[VALUE_TEXT]) { put_number(text, reading->time_us); }

static void put_utc(const reading_t *reading, char text[VALUE_TEXT])
{
    (void)utc_text(reading->utc_us, text);
}

static void put_status(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->failure != NULL ? reading->failure
                                              : status_word(reading->mode, reading->sample->kind));
}

static void put_interference(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->sample->interference ? "true" : "false");
}

static void put_distance(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->sample->kind == FATHOM_TARGET) put_number(text, reading->sample->distance_mm);
}

static void put_raw(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->raw);
}

/* The sample has it times 10000, so four decimals are all of it. */
void fields_magnitude(const fathom_sample_t *sample, char text[VALUE_TEXT])
{
    const uint32_t magnitude = sample->magnitude;
    (void)snprintf(text, VALUE_TEXT, "%" PRIu32 ".%04" PRIu32, magnitude / 10000, magnitude % 10000);
}

static void put_magnitude(const reading_t *reading, char text[VALUE_TEXT])
{
    fields_magnitude(reading->sample, text);
}

static void put_ambient(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->ambient);
}

static void put_precision(const reading_t *reading, char text[VALUE_TEXT])
{
    put_number(text, reading->sample->precision);
}

void fields_temperature(const reader_t *reader, char text[VALUE_TEXT])
{
    text[0] = '\0';
    if (reader->temperature.is_known) tenths_text(text, VALUE_TEXT, reader->temperature.dc);
}

static void put_temperature(const reading_t *reading, char text[VALUE_TEXT])
{
    fields_temperature(reading->reader, text);
}

static void put_alarm(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, alarm_word(reading->result->alarm));
}

static void put_is_on(const reading_t *reading, char text[VALUE_TEXT])
{
    put_string(text, reading->result->is_on ? "true" : "false");
}

static void put_level(const reading_t *reading, char text[VALUE_TEXT])
{
    const result_t *const result = reading->result;
    if (result->has_level) (void)snprintf(text, VALUE_TEXT, "%" PRId32, result->level.level_mm);
}

static void put_per_mille(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->result->has_level) put_number(text, reading->result->level.per_mille);
}

static void put_volume(const reading_t *reading, char text[VALUE_TEXT])
{
    if (reading->result->has_level) put_number(text, reading->result->level.volume);
}

static const field_t fields[] = {
    {"name", "", "of the sensor, as the user has given it, else such as a16:1", true, false, 0, put_name},
    {"sensor", "", "its model: a16, a05 or hps167s", true, false, 0, put_sensor},
    {"mode", "", "how it is read, such as auto or modbus", true, false, 0, put_mode},
    {"address", "", "null in a mode without addresses", false, false, 0, put_address},
    {"probe", "", "from 1; null where a failure is not of one probe alone", false, false, 0, put_probe},
    {"sequence", "", "of the response, the same for all its probes; null if it failed", false, true,
     COLUMNS_READING, put_sequence},
    {"time_us", "us", "since the start of the program", false, false, 0, put_time},
    {"utc", "", "the same as a time of day", true, false, 0, put_utc},
    {"alarm", "", "with --alarm: on, off, unknown or no_response", true, false, COLUMNS_ALARM, put_alarm},
    {"is_on", "", "with --alarm: is it on; true or false in the last two as well", false, false,
     COLUMNS_ALARM, put_is_on},
    {"status", "", "what came, see below", true, false, COLUMNS_READING, put_status},
    {"interference", "", "no target because of interference: true or false; null if it failed", false, true,
     COLUMNS_READING, put_interference},
    {"distance_mm", "mm", "null where status is not target", false, true, 0, put_distance},
    {"raw", "", "the value that the sensor sent; null if it failed", false, true, COLUMNS_READING, put_raw},
    {"magnitude", "", "of an hps167s: how strong the light came back; null if it failed", false, true,
     COLUMNS_OPTICS, put_magnitude},
    {"ambient", "", "of an hps167s: other infrared light; null if it failed", false, true, COLUMNS_OPTICS,
     put_ambient},
    {"precision", "", "of an hps167s: less is better; null if it failed", false, true, COLUMNS_OPTICS,
     put_precision},
    {"temperature_degc", "degC",
     "with --temperature; null if not known, older than three of its periods, or it failed", false, true,
     COLUMNS_TEMPERATURE, put_temperature},
    {"level_mm", "mm", "with --level; null where there is no distance", false, true, COLUMNS_LEVEL,
     put_level},
    {"level_per_mille", "1/1000", "with --level: of the height; null where there is no distance", false, true,
     COLUMNS_LEVEL, put_per_mille},
    {"volume", "", "with --level: in the unit of the capacity; null where there is no distance", false, true,
     COLUMNS_LEVEL, put_volume},
};
enum { FIELDS = sizeof fields / sizeof fields[0] };

static bool is_in(const field_t *field, uint8_t columns) { return (field->needs & columns) == field->needs; }

/* Left empty for null, and where this sensor has no such field. */
static void format_field(const field_t *field, const reading_t *reading, char text[VALUE_TEXT])
{
    text[0] = '\0';
    if (is_in(field, reading->own) && !(field->is_measured && reading->failure != NULL))
        field->format(reading, text);
}

void fields_json(FILE *to, const reading_t *reading)
{
    for (size_t i = 0; i != FIELDS; i++) {
        char text[VALUE_TEXT];
        if (!is_in(&fields[i], reading->own)) continue;
        format_field(&fields[i], reading, text);
        const char *const quote = fields[i].is_string ? "\"" : "";
        (void)fprintf(to, "%s\"%s\":%s%s%s", i == 0 ? "{" : ",", fields[i].name, quote,
                      text[0] != '\0' ? text : "null", quote);
    }
    (void)fputs("}\n", to);
}

void fields_begin_csv(FILE *to, uint8_t columns)
{
    for (size_t i = 0; i != FIELDS; i++)
        if (is_in(&fields[i], columns)) (void)fprintf(to, "%s%s", i == 0 ? "" : ",", fields[i].name);
    (void)fputs("\n", to);
}

/* No value holds a comma or a quotation mark. */
void fields_csv(FILE *to, const reading_t *reading)
{
    for (size_t i = 0; i != FIELDS; i++) {
        char text[VALUE_TEXT];
        if (!is_in(&fields[i], reading->columns)) continue;
        format_field(&fields[i], reading, text);
        (void)fprintf(to, "%s%s", i == 0 ? "" : ",", text);
    }
    (void)fputs("\n", to);
}

/* ---- what they are ---- */

void fields_help(FILE *to)
{
    (void)fputs("\nfields of json and csv, in this order, and their units; null is empty in csv:\n", to);
    for (size_t i = 0; i != FIELDS; i++)
        (void)fprintf(to, "  %-17s %-6s  %s\n", fields[i].name, fields[i].unit, fields[i].what);
    (void)fputs("\nstatus of a reading, and of an attempt that has failed:\n", to);
    status_words_help(to);
}
