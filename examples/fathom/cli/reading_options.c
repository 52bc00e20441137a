/* SPDX-License-Identifier: MIT */
#include "cli/reading_options.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/command.h"
#include "cli/options.h"
#include "fathom/sensor/a05_modbus.h"

enum { MAX_WORD = 24, MAX_LIST = 200 };

/* ---- what takes an option ---- */

/* "a16 (auto, modbus), a05 (auto)" */
static void takers(uint8_t takes, char list[MAX_LIST])
{
    list[0] = '\0';
    for (size_t i = 0; i != MODELS; i++) {
        const model_t *const model = models[i];
        char modes[MAX_LIST / 4] = "";
        char text[MAX_LIST / 2];
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            if ((model->modes[m].takes & takes) != 0) list_add(modes, sizeof modes, model->modes[m].name);
        if (modes[0] == '\0') continue;
        (void)snprintf(text, sizeof text, "%s (%s)", model->name, modes);
        list_add(list, MAX_LIST, text);
    }
}

bool reading_option_suits(station_t *const *stations, size_t count, const char *command, const char *name,
                          uint8_t takes)
{
    char list[MAX_LIST];
    for (size_t i = 0; i != count; i++)
        if ((stations[i]->mode->takes & takes) != 0) return true;
    takers(takes, list);
    (void)usage_error(command, "--%s is for %s; it has no effect on %s (%s)", name, list,
                      stations[0]->model->name, stations[0]->mode->name);
    return false;
}

/* ---- each of them; text: what was given ---- */

static bool take_probes(reader_settings_t *settings, const char *command, const char *text)
{
    for (const char *at = text; at != NULL;) {
        char word[MAX_WORD];
        uint32_t probe = 0;
        at = next_word(at, ',', word, sizeof word);
        if (!number_parse(word, 1, FATHOM_DYP_PROBES, &probe) || (settings->probes >> (probe - 1) & 1) != 0) {
            (void)usage_error(command, "--probes takes some of 1,2,3,4, each once, not '%s'", text);
            return false;
        }
        settings->probes |= (uint8_t)(1u << (probe - 1));
    }
    return true;
}

static const struct {
    const char *name;
    uint8_t meaning;
} meanings[] = {
    {"unknown", FATHOM_MEANS_UNKNOWN},
    {"no-target", FATHOM_MEANS_NO_TARGET},
    {"interference", FATHOM_MEANS_INTERFERENCE},
    {"too-near", FATHOM_MEANS_TOO_NEAR},
    {"fault", FATHOM_MEANS_FAULT},
    {"refused", FATHOM_MEANS_REFUSED},
};

/* "0", "fffd" ...: where its meaning stands; NULL: it is none of the four. */
static uint8_t *place_of(fathom_dyp_window_t *window, const char *value)
{
    if (strcmp(value, "0") == 0) return &window->value_0;
    if (strcasecmp(value, "fffd") == 0) return &window->value_fffd;
    if (strcasecmp(value, "fffe") == 0) return &window->value_fffe;
    return strcasecmp(value, "ffff") == 0 ? &window->value_ffff : NULL;
}

/* VALUE=MEANING */
static bool take_meaning(fathom_dyp_window_t *window, const char *pair)
{
    char value[MAX_WORD];
    const char *const name = next_word(pair, '=', value, sizeof value);
    uint8_t *const place = place_of(window, value);
    for (size_t i = 0; place != NULL && name != NULL && i != sizeof meanings / sizeof meanings[0]; i++) {
        if (strcmp(name, meanings[i].name) != 0) continue;
        *place = meanings[i].meaning;
        return true;
    }
    return false;
}

static bool take_means(reader_settings_t *settings, const char *command, const char *text)
{
    for (const char *at = text; at != NULL;) {
        char pair[MAX_WORD];
        at = next_word(at, ',', pair, sizeof pair);
        if (take_meaning(&settings->window, pair)) continue;
        (void)usage_error(command,
                          "--means takes 0, fffd, fffe or ffff, each with =unknown, no-target, interference, "
                          "too-near, fault or refused, such as 0=no-target,ffff=unknown, not '%s'",
                          text);
        return false;
    }
    return true;
}

/* MIN-MAX, in mm. Beyond MOST the values of all three have other meanings (FFFD, HPS-167S #5). */
static bool take_window(reader_settings_t *settings, const char *command, const char *text)
{
    enum { MOST = 65529 };
    char word[MAX_WORD];
    uint32_t min_mm = 0;
    uint32_t max_mm = 0;
    const char *const max = next_word(text, '-', word, sizeof word);
    if (max == NULL || !number_parse(word, 1, MOST, &min_mm) || !number_parse(max, min_mm, MOST, &max_mm)) {
        (void)usage_error(command,
                          "--window takes the least and the greatest distance in mm, from 1 to %d, such as "
                          "300-5000, not '%s'",
                          MOST, text);
        return false;
    }
    settings->window.min_mm = (uint16_t)min_mm;
    settings->window.max_mm = (uint16_t)max_mm;
    return true;
}

static bool take_value(reader_settings_t *settings, const char *command, const char *text)
{
    const bool is_real_time = strcmp(text, "real-time") == 0;
    if (!is_real_time && strcmp(text, "processed") != 0) {
        (void)usage_error(command, "--value takes processed or real-time, not '%s'", text);
        return false;
    }
    settings->value = is_real_time ? FATHOM_REAL_TIME : FATHOM_PROCESSED;
    settings->has_value = true;
    return true;
}

static bool take_first_register(reader_settings_t *settings, const char *command, const char *text)
{
    static const uint16_t places[] = {FATHOM_A05_REGISTERS, FATHOM_A05_REGISTERS_ALIAS};
    char *end = NULL;
    const bool is_hex = strncasecmp(text, "0x", 2) == 0 && strlen(text) <= MAX_WORD;
    const unsigned long number = is_hex ? strtoul(text + 2, &end, 16) : 0;
    for (size_t i = 0; is_hex && *end == '\0' && i != sizeof places / sizeof places[0]; i++) {
        if (number != places[i]) continue;
        settings->registers = places[i];
        return true;
    }
    (void)usage_error(command, "--first-register takes 0x0106 or 0x0010, not '%s'", text);
    return false;
}

static const struct {
    const char *name;
    int row;
    uint8_t takes;
    bool (*take)(reader_settings_t *settings, const char *command, const char *text);
} readings[] = {
    {"probes", OPTION_PROBES, READER_TAKES_PROBES, take_probes},
    {"means", OPTION_MEANS, READER_TAKES_MEANINGS, take_means},
    {"window", OPTION_WINDOW, READER_TAKES_WINDOW, take_window},
    {"value", OPTION_VALUE, READER_TAKES_VALUE, take_value},
    {"first-register", OPTION_FIRST_REGISTER, READER_TAKES_REGISTERS, take_first_register},
};

bool reading_options(station_t *const *stations, size_t count, const char *command, const char *const *values)
{
    for (size_t i = 0; i != sizeof readings / sizeof readings[0]; i++) {
        const char *const text = values[readings[i].row];
        if (text == NULL) continue;
        if (!reading_option_suits(stations, count, command, readings[i].name, readings[i].takes))
            return false;
        for (size_t n = 0; n != count; n++)
            if (!readings[i].take(&stations[n]->settings, command, text)) return false;
    }
    return true;
}

bool temperature_option(station_t *const *stations, size_t count, const char *command, const char *text)
{
    enum { DEFAULT_S = 10, MAX_S = 1000 };
    uint32_t seconds = DEFAULT_S;
    if (text == NULL) return true;
    if (!reading_option_suits(stations, count, command, "temperature", READER_TAKES_TEMPERATURE) ||
        !option_number(command, "temperature", text[0] != '\0' ? text : NULL, 1, MAX_S, &seconds))
        return false;
    for (size_t i = 0; i != count; i++) stations[i]->settings.temperature_us = seconds * 1000000u;
    return true;
}

void reading_options_help(FILE *to)
{
    (void)fputs(
        "  --value VALUE     of a16 (auto, modbus) and a05 (auto): processed (steady, slow to follow) or "
        "real-time (the\n"
        "                    last measurement). Default: processed in mode modbus, else what the sensor "
        "has.\n"
        "                    Modbus asks for it. Else the level at the sensor's RX selects: the port's TX, "
        "which is held\n"
        "                    low (a break) for real-time, so a serial port that can do that; high again at "
        "the "
        "end. An a16\n"
        "                    of the variant UART automatic follows in 0.5 s to real-time, in 2.5 to 7.5 s "
        "back; "
        "an RS232\n"
        "                    one does not: fathom set a16 automatic-value. An a05 looks at RX when it is "
        "switched on: the\n"
        "                    tool says when to do that, and prints nothing before\n"
        "  --probes LIST     of an a05: those that are fitted or wanted, such as 1,2,4; default: all four. "
        "In "
        "mode dyp a\n"
        "                    single one is measured alone, in 0.1 s instead of 0.25 s\n"
        "  --first-register R  of an a05 (modbus): where probe 1 is read, 0x0106 (default) or 0x0010, where "
        "the "
        "same stands\n"
        "  --window MIN-MAX  the distances in mm that are believed, such as 300-5000; default 1-16350 (a16), "
        "1-6000 (a05),\n"
        "                    80-30000 (hps167s). Others are refused; of an hps167s what is nearer is "
        "unknown\n"
        "  --means LIST      of a16 and a05: what a value is that is no distance, such as "
        "0=no-target,ffff=unknown; 0,\n"
        "                    fffd, fffe or ffff = unknown, no-target, interference, too-near, fault or "
        "refused.\n"
        "                    Default: 0=unknown,fffd=no-target,fffe=interference,ffff=refused\n",
        to);
}
