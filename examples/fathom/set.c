/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "command.h"
#include "talk.h"

/* fathom set: one setting of one device, confirmed by reading it back where that can be. */

static const char command[] = "set";
static talk_t talk;

static void print_value(const setting_t *setting, const char *text)
{
    const bool has_unit = setting->unit != NULL && setting->words == NULL;
    (void)printf("%s%s%s", text, has_unit ? " " : "", has_unit ? setting->unit : "");
}

/* Where the device is asked from now on. */
static void print_next(const setting_t *setting)
{
    const station_t *const station = talk.station;
    const sensor_t *const sensor = station->sensor;
    const fathom_modbus_unit_t *const unit = station->reader.unit;
    const fathom_line_settings_t *const line = unit->settings != NULL ? unit->settings : &station->line;
    char options[LINE_OPTIONS];
    if (!setting->moves) return;
    (void)printf("from now on: fathom read %s:%u:%s --port %s%s\n", sensor->name, unit->address,
                 station->mode->name, talk.options.port, line_options(line, &sensor->line, options));
}

static bool is_later(const setting_t *setting)
{
    return setting->is_later != NULL && setting->is_later(&talk.station->reader);
}

static void print_done(const setting_t *setting, const char *was, const char *is)
{
    const station_t *const station = talk.station;
    const bool was_so = was[0] != '\0' && strcmp(was, is) == 0;
    if (talk.is_json) {
        (void)printf("{\"sensor\": \"%s\", \"setting\": \"%s\", \"value\": ", station->sensor->name,
                     setting->name);
        talk_print_json(stdout, is);
        (void)fputs(", \"was\": ", stdout);
        if (was[0] != '\0')
            talk_print_json(stdout, was);
        else
            (void)fputs("null", stdout);
        (void)printf(", \"written\": %s, \"confirmed\": %s, \"address\": %u}\n", was_so ? "false" : "true",
                     setting->get != NULL || setting->moves || setting->confirmed != NULL ? "true" : "false",
                     station->reader.unit->address);
        return;
    }
    (void)printf("%s: %s is ", station->name, setting->name);
    print_value(setting, is);
    if (is_later(setting))
        (void)printf(" from the next power-on (%s until then)\n", was);
    else if (was_so)
        (void)puts(" already; nothing was written");
    else if (setting->get != NULL)
        (void)printf(" (was %s)\n", was);
    else if (setting->moves || setting->confirmed != NULL)
        (void)printf("%s%s\n", setting->confirmed != NULL ? ": " : "",
                     setting->confirmed != NULL ? setting->confirmed : "");
    else
        (void)puts(" as far as the device has acknowledged it; it cannot be read back");
    if (!was_so) print_next(setting);
}

/* The two places at which the device may be, or what else is not known. */
static void print_unknown(const setting_t *setting, const char *was, const char *wanted)
{
    const station_t *const station = talk.station;
    if (setting->is_baud) {
        (void)fprintf(
            stderr,
            "it was sent, and then the device could not be read: it is at %s or at %s baud, perhaps "
            "from the next power-on; try fathom scan --port %s --baud %s,%s",
            was, wanted, talk.options.port, was, wanted);
    } else if (setting->moves) {
        char line[SETTINGS_TEXT];
        (void)fprintf(
            stderr,
            "it was sent, and then the device could not be read: it is at address %u or at address %s, "
            "%s; try fathom read with either",
            station->address, wanted, talk_line_text(&talk, line));
    } else if (setting->unconfirmed != NULL) {
        (void)fputs(setting->unconfirmed, stderr);
    } else {
        (void)fputs("it was sent, and could not be read back: it may hold or not; ask for it with fathom get",
                    stderr);
    }
}

static void explain(fathom_status_t status)
{
    talk_explain(&talk, status);
    (void)fputs("; nothing was changed", stderr);
}

static int fail(const setting_t *setting, fathom_status_t status, const char *was, const char *wanted)
{
    (void)fprintf(stderr, "fathom: %s: %s %s: ", talk.station->name, setting->name, wanted);
    switch (status) {
    case FATHOM_ERR_UNCONFIRMED:
        print_unknown(setting, was, wanted);
        break;
    case FATHOM_ERR_ARGUMENT: /* the value was in range: the driver does not know the line's settings */
    case FATHOM_ERR_UNSUPPORTED:
        (void)fputs("not over this port, whose line settings nobody here can change; nothing was changed",
                    stderr);
        break;
    case FATHOM_ERR_IN_USE:
        (void)fprintf(
            stderr,
            "a device answers at address %s already, so nothing was changed; two at one address would "
            "answer at once",
            wanted);
        break;
    case FATHOM_ERR_NO_ANSWER:
        if (was[0] == '\0') {
            explain(status);
            break;
        }
        (void)fputs(
            "the device answers questions, but nothing came to this, and it has the value that it had; not "
            "every variant has it",
            stderr);
        break;
    case FATHOM_ERR_MALFORMED:
        if (talk.station->reader.unit->request.exchange.status == FATHOM_READY) {
            (void)fputs(
                "the device has acknowledged it and tells another value afterwards; perhaps this variant "
                "does not have it",
                stderr);
            break;
        } /* fall through */
    default:
        explain(status);
        break;
    }
    (void)fputs("\n", stderr);
    return STATUS_FAILED;
}

static int set(const setting_t *setting, int32_t value)
{
    char was[SETTING_TEXT] = "";
    char wanted[SETTING_TEXT];
    setting_print_value(setting, value, wanted);
    if (setting->get != NULL) {
        const fathom_status_t status = talk_get(&talk, setting, was);
        if (status != FATHOM_READY) return fail(setting, status, "", wanted);
    }
    const fathom_status_t status = talk_set(&talk, setting, value);
    if (status != FATHOM_READY) return fail(setting, status, was, wanted);
    print_done(setting, was, wanted);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fputs("fathom: the output cannot be written; the setting holds\n", stderr);
        return STATUS_FAILED;
    }
    return STATUS_OK;
}

static void help(FILE *to)
{
    (void)fputs("fathom set changes a setting of a device: it asks for the value, writes it if it is another "
                "one, and "
                "reads it\nback. It follows a device to its new address or baud rate.\n\n"
                "usage: fathom set SENSOR[:ADDRESS[:MODE]] --port PATH SETTING VALUE [OPTIONS]\n\n"
                "`fathom get SENSOR` lists the settings, their values, and when they take effect.\n\n",
                to);
    talk_options_help(to);
    (void)fputs(
        "\nA new address is asked first whether somebody is there. What the device does not tell is written "
        "without a look.\n"
        "Exit status: 0 when it holds (or was acknowledged, where it cannot be read), 1 when not or when "
        "that "
        "is not\nknown, 2 for wrong usage.\n\n"
        "examples:\n"
        "  fathom set hps167s --port /dev/ttyUSB0 address 7\n"
        "  fathom set hps167s:7 --port /dev/ttyUSB0 termination off\n"
        "  fathom set hps167s --port /dev/ttyUSB0 baud 115200\n"
        "  fathom set a16 --port /dev/ttyUSB0 switch-threshold 2000\n"
        "  fathom set hps167s --port /dev/ttyUSB0 distance-offset -15\n",
        to);
}

enum { MAX_WORDS = 64 };

/* A negative value at the end is no option: "--" says so. The words are copied to `copy`, ended by NULL. */
static char **mark_negative(int *argc, char **argv, char *copy[MAX_WORDS])
{
    static char dashes[] = "--";
    const char *const last = argv[*argc - 1];
    bool is_marked = *argc + 2 > MAX_WORDS || last[0] != '-' || last[1] < '0' || last[1] > '9';
    for (int i = 0; i != *argc && !is_marked; i++) is_marked = strcmp(argv[i], dashes) == 0;
    if (is_marked) return argv;
    for (int i = 0; i != *argc; i++) copy[i < *argc - 1 ? i : i + 1] = argv[i];
    copy[*argc - 1] = dashes;
    copy[++*argc] = NULL;
    return copy;
}

static int run(const host_t *host, int argc, char **argv)
{
    char *copy[MAX_WORDS];
    argv = mark_negative(&argc, argv, copy);
    const char *values[TALK_OPTIONS] = {NULL};
    char **words = NULL;
    int count = 0;
    int32_t value = 0;
    bool wants_help = false;
    if (!talk_options(&talk, command, argc, argv, talk_table, values, &words, &count, &wants_help))
        return STATUS_USAGE;
    if (wants_help) {
        help(stdout);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    const char *const sensor = talk.station->sensor->name;
    if (count != 2)
        return usage_error(command,
                           count == 0   ? "which setting? `fathom get %s` lists them"
                           : count == 1 ? "a value is missing; `fathom get %s` lists them"
                                        : "one setting and one value of %s at a time",
                           sensor);
    const setting_t *const setting = setting_find(command, sensor, talk_settings(&talk), words[0]);
    if (setting == NULL) return STATUS_USAGE;
    if (setting->set == NULL)
        return usage_error(command, "%s is told by the device and cannot be set", setting->name);
    if (!setting_parse(command, setting, words[1], &value) ||
        !talk_set_mode(&talk, command, values, setting->mode))
        return STATUS_USAGE;
    if (!talk_open(&talk, host)) return STATUS_FAILED;
    const int status = set(setting, value);
    talk_close(&talk);
    return status;
}

const command_t set_command = {"set", "changes a setting of a device and confirms it", help, run};
