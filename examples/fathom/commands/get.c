/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "device/session.h"
#include "ports/port_options.h"

/* fathom info prints everything that a sensor reports, fathom get one setting or all. */

static session_t session;
static json_t json;

/* Selects the values to print. */
typedef enum { SHOW_ALL, SHOW_SETTINGS, SHOW_ONE } show_t;

/* The progress through the values of one sensor. */
typedef struct {
    const setting_t *settings; /* with SHOW_ONE: this one */
    show_t show;
    bool is_known;       /* the sensor has responded to at least one request */
    unsigned count;      /* values to read */
    unsigned read_count; /* values that were read */
    uint16_t
        failed_read; /* the read that failed last. Its other values are not requested: that takes seconds */
    fathom_status_t failure; /* of that read */
    const char *remark;      /* about one of the values, which follows the table; NULL: none */
} values_t;

/* Returns the next value to print behind `last`, or the first one if `last` is NULL. NULL: there is none. */
static const setting_t *next_value(const values_t *progress, const setting_t *last)
{
    const setting_t *setting = last != NULL ? last + 1 : progress->settings;
    if (progress->show == SHOW_ONE) return last == NULL ? setting : NULL;
    for (; setting->name != NULL; setting++) {
        const bool is_shown = progress->show == SHOW_ALL ? setting->read_at != 0 : setting->effect != NULL;
        if (is_shown && model_mode_of(session.sensor->model, setting) == session.sensor->mode) return setting;
    }
    return NULL;
}

/* The address is known without a request for it: the sensor responds there. */
static bool is_address(const setting_t *setting) { return strcmp(setting->name, "address") == 0; }

/* Messages name the sensor if there are several, or if the user named it. */
static bool has_name(void) { return session.site.sensor_count > 1 || session.sensor->has_own_name; }

/* The start of a message on stderr. */
static void print_start(void)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s%s", has_name() ? session.sensor->name : "", has_name() ? ": " : "");
}

/* `address` is the value that the sensor reports, or the address of the requests if the sensor cannot report it. */
static void begin_json(const values_t *progress, const char *line)
{
    bool has_address = false;
    for (const setting_t *setting = NULL; (setting = next_value(progress, setting)) != NULL;)
        if (is_address(setting)) has_address = true;
    json = (json_t){.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, session.sensor);
    if (!has_address) json_value(&json, "address", "%u", session.sensor->address);
    json_string(&json, "line", line);
}

static void begin(const values_t *progress)
{
    const sensor_t *const sensor = session.sensor;
    char line[LINE_TEXT];
    (void)session_line_text(&session, line);
    if (session.is_json)
        begin_json(progress, line);
    else
        (void)printf("%s%s%s%s, %s, asked at address %u, %s\n", sensor != session.site.sensors[0] ? "\n" : "",
                     has_name() ? sensor->name : "", has_name() ? ": " : "", sensor->model->name,
                     sensor->model->what, sensor->address, line);
}

static void print_value(const setting_t *setting, fathom_status_t status, const char *text)
{
    const bool has_unit = setting->unit != NULL && strspn(text, "0123456789-., ") == strlen(text);
    if (session.is_json && setting->read_at == 0 && status != FATHOM_OK) return; /* write-only */
    if (session.is_json)
        setting_json(&json, NULL, setting, status == FATHOM_OK ? text : NULL);
    else if (status == FATHOM_OK)
        (void)printf("%-26s %s%s%s\n", setting->name, text, has_unit ? " " : "",
                     has_unit ? setting->unit : "");
    else
        (void)printf("%-26s - (%s)\n", setting->name,
                     setting->read_at != 0 ? setting_reason(status) : "write-only");
}

static fathom_status_t read_value(const setting_t *setting, values_t *progress, char text[SETTING_TEXT])
{
    text[0] = '\0';
    if (setting->read_at == 0) {
        if (!is_address(setting)) return FATHOM_ERR_UNSUPPORTED;
        (void)snprintf(text, SETTING_TEXT, "%u", session.sensor->address); /* it responds there */
        return FATHOM_OK;
    }
    if (setting->read_at != 0 && setting->read_at == progress->failed_read) return progress->failure;
    const fathom_status_t status = session_get(&session, setting, text);
    if (status == FATHOM_OK) return status;
    progress->failed_read = setting->read_at;
    progress->failure = status;
    return status;
}

static bool fail(const setting_t *setting, fathom_status_t status)
{
    print_start();
    (void)fprintf(stderr, "%s: ", setting->name);
    session_explain(&session, status);
    (void)fputs("\n", stderr);
    return false;
}

/* Returns false after printing why no other value can be read either. */
static bool show_value(const setting_t *setting, values_t *progress)
{
    char text[SETTING_TEXT];
    const fathom_status_t status = read_value(setting, progress, text);
    const bool is_read = status == FATHOM_OK || setting->read_at == 0;
    if (!is_read && (!progress->is_known || setting_reason(status) == NULL)) return fail(setting, status);
    if (!progress->is_known) begin(progress);
    progress->is_known = true;
    if (is_read) progress->read_count++;
    print_value(setting, status, text);
    if (setting->remark != NULL && strcmp(text, setting->words[1]) == 0) progress->remark = setting->remark;
    return true;
}

/* A setting that is write-only does not show that the sensor is there, so one that can be read comes first. */
static bool responds(void)
{
    const values_t all = {.settings = session.sensor->model->settings, .show = SHOW_ALL};
    const setting_t *setting = NULL;
    char text[SETTING_TEXT];
    do setting = next_value(&all, setting);
    while (setting != NULL && setting->read_at == 0);
    if (setting == NULL) return true;
    const fathom_status_t status = session_get(&session, setting, text);
    return status == FATHOM_OK || fail(setting, status);
}

/* Prints the values of the sensor on the open port. Returns false if one of them could not be read. */
static bool show_values(const setting_t *settings, show_t show)
{
    values_t progress = {.settings = settings, .show = show};
    const bool is_unsure = show == SHOW_SETTINGS || (show == SHOW_ONE && settings->read_at == 0);
    bool is_good = !is_unsure || responds();
    for (const setting_t *setting = NULL; (setting = next_value(&progress, setting)) != NULL;) {
        if (is_good) is_good = show_value(setting, &progress);
        progress.count++;
    }
    if (progress.is_known && session.is_json) {
        json_end(&json, '}');
        (void)fputc('\n', stdout);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fputs("fathom: cannot write the output.\n", stderr);
        return false;
    }
    if (progress.remark != NULL) {
        print_start();
        (void)fprintf(stderr, "%s\n", progress.remark);
    }
    if (progress.is_known && progress.read_count != progress.count) {
        print_start();
        (void)fprintf(stderr, "%u of %u values could not be read\n", progress.count - progress.read_count,
                      progress.count);
    }
    return is_good && progress.read_count == progress.count;
}

static bool show_on_port(const host_t *host, const setting_t *settings, show_t show)
{
    if (!session_open(&session, host)) return false;
    const bool is_good = show_values(settings, show);
    session_close(&session);
    return is_good;
}

/* Lists the settings of a sensor without a port. */
static int list(const char *word, const origin_t *origin)
{
    char name[16];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(word, ":"), word);
    const model_t *const model = model_word(name, origin);
    if (model == NULL) return STATUS_USAGE;
    (void)printf("%s, %s, has these settings. Add --port PORT to read their values.\n\n", model->name,
                 model->what);
    settings_print(stdout, model->settings);
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

/* A sensor that fails keeps none of the others from being read. */
static int start_info(const host_t *host, const arguments_t *arguments)
{
    const site_t *const site = &session.site;
    int status = STATUS_OK;
    if (!session_read(&session, arguments, INT_MAX, 0)) return STATUS_USAGE;
    for (size_t i = 0; i != site->sensor_count; i++) {
        if (i != 0 && host->has_ended(host->ctx)) return STATUS_FAILED;
        session.sensor = site->sensors[i];
        if (!show_on_port(host, session.sensor->model->settings, SHOW_ALL)) status = STATUS_FAILED;
    }
    return status;
}

static int start_get(const host_t *host, const arguments_t *arguments)
{
    const session_settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    if (arguments->count == 1 && settings->sensors.defaults.path == NULL &&
        strchr(arguments->words[0], '@') == NULL)
        return list(arguments->words[0], &origin);
    if (!session_read(&session, arguments, 1, 1)) return STATUS_USAGE;
    if (arguments->count == 1)
        return show_on_port(host, session.sensor->model->settings, SHOW_SETTINGS) ? STATUS_OK : STATUS_FAILED;
    const setting_t *const setting = setting_named(&session, arguments->words[1], arguments);
    if (setting == NULL) return STATUS_USAGE;
    if (setting->read_at == 0 && !is_address(setting)) {
        (void)reject(&origin, "%s is write-only. The sensor does not report it.", setting->name);
        return STATUS_USAGE;
    }
    if (!session_set_mode(&session, arguments, model_mode_of(session.sensor->model, setting)))
        return STATUS_USAGE;
    return show_on_port(host, setting, SHOW_ONE) ? STATUS_OK : STATUS_FAILED;
}

static const option_table_t tables[] = {SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

const command_t info_command = {
    .name = "info",
    .summary = "Print all versions, settings and values of sensors",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = tables,
    .common = "port address mode baud format",
    .examples = "  fathom info hps167s:7 --port /dev/ttyUSB0\n"
                "  fathom info a05 --port /dev/ttyUSB0 --format json\n"
                "  fathom info tank=a16@/dev/ttyUSB0 gate=hps167s:7@/dev/ttyUSB1,baud=57600\n",
    .status = "Exit status: 0 all was read, 1 a part was not, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = OPERANDS_ASKED,
    .settings_size = sizeof(session_settings_t),
    .start = start_info,
};

const command_t get_command = {
    .name = "get",
    .summary = "Print a setting of a sensor, or all of them",
    .usage = "SENSOR[:ADDRESS][:MODE][@PORT] [SETTING] [OPTIONS]",
    .about = "Without a port, the settings and their possible values are listed.\n",
    .tables = tables,
    .common = "port address mode baud format",
    .examples = "  fathom get hps167s\n"
                "  fathom get hps167s:7 --port /dev/ttyUSB0\n"
                "  fathom get hps167s:7 --port /dev/ttyUSB0 termination\n",
    .status = "Exit status: 0 all was read, 1 a part was not, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = OPERANDS_SETTING,
    .settings_size = sizeof(session_settings_t),
    .start = start_get,
};
