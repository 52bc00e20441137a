/* SPDX-License-Identifier: MIT */
#include "sensors/models.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "output/words.h"
#include "ports/port.h"
#include "sensors/driver.h"

/* ---- the models ---- */

/* What the sensors of DYP share. A module that is at work on a measurement may need longer for the second response (A16 3:
 * 110 ms, A05 2(3): 210 ms). No time of the address register is printed: a module may finish a measurement before it
 * responds. */
#define DYP                                                                                                  \
    .line = {9600, FATHOM_PARITY_NONE, 1}, .relatives_line = {115200, FATHOM_PARITY_NONE, 1},                \
    .max_address = DYP_MAX_ADDRESS, .has_address_zero = true, .second_response_us = 250000,                  \
    .decode = dyp_decode, .decode_sum = dyp_decode_sum,                                                      \
    .traits = 1u << DEVICE_EXCEPTIONS | 1u << DEVICE_ANSWERS_BROADCAST | 1u << DEVICE_REAL_TIME |            \
              1u << DEVICE_ANSWERS_FROM_NEW
#define DYP_SCAN                                                                                             \
    .first = DYP_ADDRESS, .count = 1, .timeout_us = 150000, .has_any = true, .confirm = dyp_confirm

/* #9 */
static const uint32_t hps167s_rates[] = {19200, 57600, 115200, 230400, 0};

const model_t models[] = {
    {"a16", "one ultrasonic probe", FATHOM_A16, DYP, .modes = a16_modes, .settings = a16_settings,
     .get = a16_get, .set = a16_set, .simulate = a16_simulate, .probes = 1, .max_mm = FATHOM_A16_MAX_MM,
     .near_mm = 500, .far_mm = 5000,
     .request_ends = "the automatic output of an A16 with RS232, until power-off or `fathom set a16 "
                     "automatic-output on`",
     .automatic_again = "automatic-output on",
     .scan = {DYP_SCAN, .frame_length = FATHOM_DYP_A16_LENGTH, .own = FATHOM_A16_REGISTER_REAL_TIME,
              .slow_own = FATHOM_A16_REGISTER_PROCESSED, .second = FATHOM_A16_REGISTER_PROCESSED,
              .family = "an A16 or a relative"},
     .protocols = DECODE_MODBUS | DECODE_STREAM_ONE, .register_source = "A16 6(3)",
     .stream_source = "A16 2(3), 3(4), 5(3)"},
    {"a05", "four ultrasonic probes", FATHOM_A05, DYP, .modes = a05_modes, .settings = a05_settings,
     .get = a05_get, .set = a05_set, .simulate = a05_simulate, .probes = FATHOM_DYP_PROBES,
     .max_mm = FATHOM_A05_MAX_MM, .near_mm = 250, .far_mm = 4500,
     .request_ends = "the automatic output of an A05 with UART, until power-off",
     .scan = {DYP_SCAN, .frame_length = FATHOM_DYP_A05_LENGTH, .own = FATHOM_A05_REGISTERS,
              .second = FATHOM_A05_REGISTERS_ALIAS, .family = "an A05"},
     .protocols = DECODE_MODBUS | DECODE_DYP | DECODE_STREAM_FOUR, .register_source = "A05 3(3)",
     .stream_source = "A05 1(2)", .probe_registers = {FATHOM_A05_REGISTERS, FATHOM_A05_REGISTERS_ALIAS}},
    {"hps167s",
     "infrared time of flight",
     FATHOM_HPS167S,
     .line = {FATHOM_HPS167S_FACTORY_BAUD, FATHOM_PARITY_EVEN, 1},
     .rates = hps167s_rates,
     .other_settings = "--baud 57600, 115200 or 230400, to which it can be set",
     .modes = hps167s_modes,
     .max_address = FATHOM_HPS167S_MAX_ADDRESS,
     .has_optics = true,
     .may_send_unasked = true,
     .probes = 1,
     .second_response_us = 60000, /* within 20 ms, behind an adapter's 16 */
     .settings = hps167s_settings,
     .offset = "distance-offset",
     .get = hps167s_get,
     .set = hps167s_set,
     .set_all = hps167s_set_all,
     .reset_interface = hps167s_reset_interface,
     .reset_sensor = hps167s_reset_sensor,
     .read_changes = hps167s_read_changes,
     .simulate = hps167s_simulate,
     .near_mm = 500,
     .far_mm = 12000,
     .traits = 1u << DEVICE_ANSWERS_FROM_NEW | 1u << DEVICE_WARM_UP | 1u << DEVICE_WARM_UP_REFUSES |
               1u << DEVICE_WARM_UP_ABNORMAL | 1u << DEVICE_UNASKED | 1u << DEVICE_NO_OUTPUT |
               1u << DEVICE_NO_TERMINATION | 1u << DEVICE_BAUD_LATER | 1u << DEVICE_OFFSET_ADDS |
               1u << DEVICE_RECONNECT | 1u << DEVICE_NO_BAUD_CODE | 1u << DEVICE_COUNT_EXCEPTION,
     .scan = {.first = FATHOM_HPS167S_VERSION,
              .count = FATHOM_HPS167S_VERSION_COUNT,
              .is_it = hps167s_identify,
              .is_alike = hps167s_is_alike,
              .alike = "perhaps an HPS-167S of before 2020-09"},
     .protocols = DECODE_MODBUS,
     .decode = hps167s_decode,
     .exception_name = hps167s_exception_name,
     .exception_source = "HPS table 39"},
};
const size_t model_count = sizeof models / sizeof models[0];

/* ---- relatives ---- */

enum { NAME_TEXT = 32 };

/* A relative that was named, one of a list that lives as long as the program. */
typedef struct relative {
    model_t model;
    model_mode_t modes[MODEL_MODES + 1];
    char name[NAME_TEXT];
    const struct relative *next;
} relative_t;

static const model_mode_t *mode_that_reads(const model_t *family, uint8_t mode)
{
    for (const model_mode_t *its = family->modes; its != family->modes + MODEL_MODES; its++)
        if (its->reads == mode) return its;
    return mode == FATHOM_MODE_FREE_PULSE ? &dyp_free_mode
           : mode == FATHOM_MODE_0A       ? &hps167_uart_mode
                                          : NULL;
}

/* Adds the row as a mode. The line is that of the first row that has one. */
static void add_mode(relative_t *relative, const model_t *family, const fathom_model_description_t *row)
{
    const model_mode_t *const its = mode_that_reads(family, row->mode);
    const fathom_line_settings_t *const line = row->facts->line_settings;
    model_mode_t *mode = relative->modes;
    bool has_line = false;
    if (its == NULL) return;
    for (; mode->name != NULL && mode != relative->modes + MODEL_MODES; mode++)
        has_line = has_line || mode->row->facts->line_settings != NULL;
    if (mode == relative->modes + MODEL_MODES) return;
    *mode = *its;
    mode->row = row;
    if (mode_starts_by_byte(mode)) mode->may_pins = 0;
    if ((row->facts->registers & FATHOM_HAS_TEMPERATURE) != 0) mode->takes |= READER_TAKES_TEMPERATURE;
    if (line != NULL && !has_line) relative->model.line = *line;
}

static const model_t *new_relative(relative_t *relative, const fathom_model_description_t *first)
{
    const model_t *family = models;
    const fathom_model_description_t *row = NULL;
    while (family->id != first->family) family++;
    relative->model = *family;
    relative->model.name = relative->name;
    relative->model.modes = relative->modes;
    relative->model.max_mm = relative->model.far_mm = first->facts->max_mm;
    relative->model.near_mm = first->facts->min_mm;
    relative->model.rates = NULL;
    relative->model.other_settings = NULL;
    relative->model.may_send_unasked = false;
    if (first->mode == FATHOM_MODE_0A) relative->model.traits = 0;
    for (size_t i = 0; first->name[i] != '\0' && i != NAME_TEXT - 1; i++)
        relative->name[i] = (char)tolower((unsigned char)first->name[i]);
    for (uint16_t i = 0; (row = fathom_model_at(i)) != NULL; i++)
        if (strcmp(row->name, first->name) == 0) add_mode(relative, family, row);
    return &relative->model;
}

static bool is_base(const model_t *model) { return model >= models && model < models + model_count; }

const model_t *model_find(const char *name)
{
    static const relative_t *known;
    const fathom_model_description_t *const first = fathom_model_find(name, FATHOM_MODE_ANY);
    for (const model_t *model = models; model != models + model_count; model++)
        if (strcmp(name, model->name) == 0 || (first != NULL && fathom_model_is_called(first, model->name)))
            return model;
    if (first == NULL) return NULL;
    for (const relative_t *relative = known; relative != NULL; relative = relative->next)
        if (relative->modes[0].row == first) return &relative->model;
    relative_t *const relative = calloc(1, sizeof *relative);
    if (relative == NULL) return NULL;
    relative->next = known;
    known = relative;
    return new_relative(relative, first);
}

const model_mode_t *model_mode_of_row(const model_t *model, const fathom_model_description_t *row)
{
    for (const model_mode_t *mode = model->modes; mode != model->modes + MODEL_MODES; mode++)
        if (mode->row == row || (mode->row == NULL && mode->reads == row->mode)) return mode;
    return NULL;
}

/* Returns the letter of the output in a name such as A02YYUW: before a W or B, or the last one. NULL: there is none. */
static const char *letter_of(const char *name)
{
    size_t length = strlen(name);
    while (length > 1 && strchr("WB", name[length - 1]) != NULL) length--;
    return strchr("UTM24", name[length - 1]) != NULL ? name + length - 1 : NULL;
}

static bool is_form(const fathom_model_description_t *row, const fathom_model_description_t *other)
{
    const char *const letter = letter_of(row->name);
    const size_t length = letter != NULL ? (size_t)(letter - row->name) : 0;
    if (strcmp(row->name, other->name) == 0) return other != row;
    return length != 0 && strncmp(row->name, other->name, length) == 0 &&
           letter_of(other->name) == other->name + length &&
           fathom_model_find(other->name, FATHOM_MODE_ANY) == other;
}

const fathom_model_description_t *model_form(const model_mode_t *mode, size_t n)
{
    const fathom_model_description_t *row = NULL;
    for (uint16_t i = 0; mode->row != NULL && (row = fathom_model_at(i)) != NULL; i++)
        if (is_form(mode->row, row) && n-- == 0) return row;
    return NULL;
}

/* src/models/README.md has more of them. */
const char *model_unreadable(const char *name)
{
    static const fathom_model_description_t others[] = {
        {"US-100", "", "", "on a UART it sends two bytes without header and sum", NULL, 0, 0, false},
        {"SEN0301", "", "", "its frames have 7 bytes, with an address and a temperature", NULL, 0, 0, false},
        {"URM06", "URM07, SEN0149, SEN0150, SEN0153", "", "its frames 55 AA have a length byte", NULL, 0, 0,
         false},
        {"SEN0590", "A22YYCW, R01CW, SEN0304", "", "it has I2C, and no UART", NULL, 0, 0, false},
        {"RCWL-1601", "RCWL-1605, RCWL-1670", "",
         "its range is not known. Public notes liken it to an rcwl-1655, so read it as that, with --window",
         NULL, 0, 0, false},
        {"SEN0600", "SEN0601", "", "it is a soil probe that has another value at register 0100", NULL, 0, 0,
         false},
        {"UL212", "", "", "it is a fuel gauge with a height in other units", NULL, 0, 0, false},
        {"URM12", "URM13, URM14, SEN0492", "", "its distance is in another register", NULL, 0, 0, false},
        {"GY-US42", "URM37, TF-Luna, TFmini", "", "its frames are others", NULL, 0, 0, false},
        {"SEN0307", "", "", "its output is a voltage", NULL, 0, 0, false},
    };
    for (size_t i = 0; i != sizeof others / sizeof others[0]; i++)
        if (fathom_model_is_called(&others[i], name)) return others[i].note;
    return NULL;
}

/* Adds the names of a list with ", " between them to `names`, from name `count` on. Returns how many there are then. */
static size_t add_names(char (*names)[NAME_TEXT], size_t count, size_t most, const char *list)
{
    for (const char *rest = list; rest != NULL && *rest != '\0' && count != most; count++) {
        rest = next_word(rest, ',', names[count], NAME_TEXT);
        for (char *at = names[count]; *at != '\0'; at++) *at = (char)tolower((unsigned char)*at);
        if (rest != NULL) rest += strspn(rest, " ");
    }
    return count;
}

const char *model_relative(size_t n)
{
    enum { MOST_NAMES = 400 };
    static char names[MOST_NAMES][NAME_TEXT];
    static size_t count;
    const fathom_model_description_t *row = NULL;
    for (uint16_t i = 0; count == 0 || i != 0; i++) {
        row = fathom_model_at(i);
        if (row == NULL) break;
        if (fathom_model_find(row->name, FATHOM_MODE_ANY) != row || is_base(model_find(row->name)))
            continue; /* another mode */
        count = add_names(names, count, MOST_NAMES, row->name);
        count = add_names(names, count, MOST_NAMES, row->aliases);
    }
    return n < count ? names[n] : NULL;
}

bool model_has_address(const model_t *model, uint8_t address)
{
    return model->has_address_zero || (address != 0 && address <= model->max_address);
}

bool model_has_rate(const model_t *model, uint32_t baud)
{
    if (baud == model->line.baud) return true;
    for (const uint32_t *rate = model->rates; rate != NULL && *rate != 0; rate++)
        if (*rate == baud) return true;
    return false;
}

bool model_is_at(const model_t *model, const fathom_line_settings_t *line)
{
    const fathom_line_settings_t *const other = &model->relatives_line;
    return (line->baud == model->line.baud && line->parity == model->line.parity) ||
           (line->baud == other->baud && line->parity == other->parity &&
            line->stop_bits == other->stop_bits);
}

uint8_t model_least_address(const model_t *model, const model_mode_t *mode)
{
    return model->has_address_zero && mode->is_modbus ? 0 : 1;
}

const model_mode_t *model_mode_of(const model_t *model, const setting_t *setting)
{
    const char *const name = setting != NULL ? setting->mode : NULL;
    const model_mode_t *mode = model->modes;
    while (mode->name != NULL && (name != NULL ? strcmp(mode->name, name) != 0 : !mode->is_modbus)) mode++;
    return mode;
}

const model_t *model_with(uint8_t protocols)
{
    const model_t *model = models;
    while ((model->protocols & protocols) == 0) model++;
    return model;
}

/* Returns true if the register is one of the model's values. */
static bool has_value_at(const model_t *model, uint16_t address)
{
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++)
        if (setting->read_at == address) return true;
    return false;
}

bool models_allow_read(uint8_t address, uint16_t first, uint16_t count)
{
    bool is_of_address_zero = false;
    for (const model_t *model = models; model != models + model_count; model++) {
        if (model->read_changes != NULL &&
            model->read_changes(FATHOM_MODBUS_READ_HOLDING_REGISTERS, first, count) != NULL)
            return false;
        if (model->has_address_zero && has_value_at(model, first)) is_of_address_zero = true;
    }
    return address != 0 || is_of_address_zero;
}

/* ---- texts ---- */

/* MODBUS Application Protocol V1.1b3, 7; the last two are a gateway's. */
modbus_exception_t modbus_exception(uint8_t number)
{
    static const modbus_exception_t texts[] = {
        [1] = {"illegal function", "the sensor does not support this function", true},
        [2] = {"illegal data address", "the sensor has no such register", true},
        [3] = {"illegal data value", "the sensor refuses this value or this number of registers", true},
        [4] = {"server device failure", "the sensor has failed. Switch its supply off and on", false},
        [5] = {"acknowledge", "the sensor is still busy. Try a longer --interval", false},
        [6] = {"server device busy", "the sensor is busy. Try --retries 2 or a longer --interval", false},
        [8] = {"memory parity error", "the sensor's memory is damaged. Switch its supply off and on", false},
        [10] = {"gateway path unavailable", "a gateway cannot reach the sensor. Check the gateway", false},
        [11] = {"gateway target device failed to respond",
                "a gateway receives no response of the sensor. Check the wires there", false},
    };
    static const modbus_exception_t unknown = {"unknown", "the Modbus standard has no such code", true};
    return number < sizeof texts / sizeof texts[0] && texts[number].name != NULL ? texts[number] : unknown;
}

static void print_word(FILE *to, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:@%+=,-";
    if (word[0] != '\0' && strspn(word, plain) == strlen(word)) {
        (void)fputs(word, to);
        return;
    }
    (void)fputc('\'', to);
    for (; *word != '\0'; word++) (void)fprintf(to, *word == '\'' ? "'\\''" : "%c", *word);
    (void)fputc('\'', to);
}

void model_form_print(FILE *to, const model_mode_t *mode, const fathom_model_description_t *form)
{
    const model_t *const model = model_find(form->name);
    const model_mode_t *const its = model != NULL ? model_mode_of_row(model, form) : NULL;
    if (its == NULL) return; /* no memory */
    if (strcmp(form->name, mode->row->name) != 0)
        (void)fprintf(to, "%s (%c, %s)", model->name, *letter_of(form->name), its->name);
    else
        (void)fprintf(to, "%s::%s%s%s%s", model->name, its->name, form->note[0] != 0 ? " (" : "", form->note,
                      form->note[0] != 0 ? ")" : "");
}

void read_command_print(FILE *to, const model_t *model, const char *mode, int address,
                        const fathom_line_settings_t *line, const char *port)
{
    const bool is_first_mode = strcmp(mode, model->modes[0].name) == 0;
    (void)fprintf(to, "fathom read %s", model->name);
    if (address >= 0) (void)fprintf(to, ":%d:%s", address, mode);
    if (address < 0 && !is_first_mode) (void)fprintf(to, "::%s", mode);
    (void)fputs(" --port ", to);
    print_word(to, port);
    if (line->baud != model->line.baud) (void)fprintf(to, " --baud %" PRIu32, line->baud);
    if (line->parity != model->line.parity) (void)fprintf(to, " --parity %s", parity_name(line->parity));
    if (line->stop_bits != model->line.stop_bits) (void)fprintf(to, " --stop-bits %u", line->stop_bits);
}
