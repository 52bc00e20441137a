/* SPDX-License-Identifier: MIT */
#include <limits.h>
#include <string.h>

#include "cli/session_options.h"
#include "commands/commands.h"
#include "device/setting_text.h"
#include "ports/line_text.h"

/* fathom info and fathom get: all that a device tells, or some of it. */

static session_t session;
static json_t json;

static void print_text(const setting_t *setting, fathom_status_t status, const char *text)
{
    const bool has_unit = setting->unit != NULL && strspn(text, "0123456789-., ") == strlen(text);
    if (status == FATHOM_OK)
        (void)printf("%-26s %s%s%s\n", setting->name, text, has_unit ? " " : "",
                     has_unit ? setting->unit : "");
    else
        (void)printf("%-26s - (%s)\n", setting->name, setting_reason(status));
}

/* Does each tell whose it is? */
static bool has_name(void) { return session.site.sensor_count > 1 || session.station->has_own_name; }

static bool can_be_printed(const setting_t *setting)
{
    return setting->get != NULL && model_mode_of(session.station->model, setting) == session.station->mode;
}

/* `address` is the value of a sensor that can report it, and else the address that the requests have. */
static void begin_json(const setting_t *settings, size_t count, const char *line)
{
    bool has_address = false;
    for (size_t i = 0; i != count && settings[i].name != NULL; i++)
        if (can_be_printed(&settings[i]) && strcmp(settings[i].name, "address") == 0) has_address = true;
    json = (json_t){.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, session.station);
    if (!has_address) json_value(&json, "address", "%u", session.station->address);
    json_string(&json, "line", line);
}

static void begin_text(const char *line)
{
    const sensor_t *const station = session.station;
    (void)printf("%s%s%s%s, %s, asked at address %u, %s\n", station != session.site.sensors[0] ? "\n" : "",
                 has_name() ? station->name : "", has_name() ? ": " : "", station->model->name,
                 station->model->what, station->address, line);
}

static void begin(const setting_t *settings, size_t count)
{
    char line[LINE_TEXT];
    (void)session_line_text(&session, line);
    if (session.is_json)
        begin_json(settings, count, line);
    else
        begin_text(line);
}

/* Before what is said on the standard error. */
static void say_whose(void)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s%s", has_name() ? session.station->name : "", has_name() ? ": " : "");
}

static void tell_remark(const setting_t *setting, const char *text)
{
    if (has_name()) {
        say_whose();
        (void)fprintf(stderr, "%s is %s\n", setting->name, text);
    }
    setting->remark(stderr, text);
}

/* The progress of `tell` through the values of one device. */
typedef struct {
    const setting_t *settings;
    size_t count;
    bool is_known;    /* The device has sent a response to at least one request. */
    unsigned printed; /* Number of values that were read. */
    /* The read that failed last and its error. Its other values are not requested again: one failure can take several
     * seconds. */
    uint16_t failed_read;
    fathom_status_t failure;
} progress_t;

static fathom_status_t get_one(const setting_t *setting, progress_t *progress, char text[SETTING_TEXT])
{
    if (setting->read_at != 0 && setting->read_at == progress->failed_read) return progress->failure;
    const fathom_status_t status = session_get(&session, setting, text);
    if (status != FATHOM_OK) {
        progress->failed_read = setting->read_at;
        progress->failure = status;
    }
    return status;
}

/* False: nothing further can be told, for a reason that was said. */
static bool print_one(const setting_t *setting, progress_t *progress)
{
    char text[SETTING_TEXT];
    const fathom_status_t status = get_one(setting, progress, text);
    if (status != FATHOM_OK && (!progress->is_known || setting_reason(status) == NULL)) {
        say_whose();
        (void)fprintf(stderr, "%s: ", setting->name);
        session_explain(&session, status);
        (void)fputs("\n", stderr);
        return false;
    }
    if (!progress->is_known) begin(progress->settings, progress->count);
    progress->is_known = true;
    progress->printed += status == FATHOM_OK;
    if (session.is_json)
        setting_json(&json, NULL, setting, status == FATHOM_OK ? text : NULL);
    else
        print_text(setting, status, text);
    if (setting->remark != NULL && status == FATHOM_OK) tell_remark(setting, text);
    return true;
}

static int tell(const setting_t *settings, size_t count)
{
    progress_t progress = {.settings = settings, .count = count};
    bool is_good = true;
    unsigned all = 0;
    for (size_t i = 0; i != count && settings[i].name != NULL; i++) {
        if (!can_be_printed(&settings[i])) continue;
        if (is_good) is_good = print_one(&settings[i], &progress);
        all++;
    }
    if (progress.is_known && session.is_json) {
        json_end(&json, '}');
        (void)fputc('\n', stdout);
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        (void)fputs("fathom: the output cannot be written\n", stderr);
        is_good = false;
    }
    if (progress.is_known && progress.printed != all) {
        say_whose();
        (void)fprintf(stderr, "%u of %u values could not be read\n", all - progress.printed, all);
    }
    return is_good && progress.printed == all ? STATUS_OK : STATUS_FAILED;
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

static int tell_on_port(const host_t *host, const setting_t *settings, size_t count)
{
    if (!session_open(&session, host)) return STATUS_FAILED;
    const int status = tell(settings, count);
    session_close(&session);
    return status;
}

/* A sensor that fails keeps none of the others from being read. */
static int start_info(const host_t *host, const arguments_t *arguments)
{
    const site_t *const site = &session.site;
    int status = STATUS_OK;
    if (!session_read(&session, arguments, INT_MAX, 0)) return STATUS_USAGE;
    for (size_t i = 0; i != site->sensor_count; i++) {
        if (i != 0 && host->has_ended(host->ctx)) return STATUS_FAILED;
        session.station = site->sensors[i];
        if (tell_on_port(host, session_settings(&session), SIZE_MAX) != STATUS_OK) status = STATUS_FAILED;
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
    if (arguments->count == 1) return tell_on_port(host, session_settings(&session), SIZE_MAX);
    const setting_t *const setting = setting_named(&session, arguments->words[1], arguments);
    if (setting == NULL) return STATUS_USAGE;
    if (setting->get == NULL) {
        (void)reject(&origin, "%s is write-only. The sensor does not report it.", setting->name);
        return STATUS_USAGE;
    }
    if (!session_set_mode(&session, arguments, model_mode_of(session.station->model, setting))) return STATUS_USAGE;
    return tell_on_port(host, setting, 1);
}

static const option_table_t tables[] = {SESSION_TABLES, {session_format_rows, 0}, {NULL, 0}};

const command_t info_command = {
    .name = "info",
    .summary = "Print everything that sensors report: versions, settings and values",
    .usage = "[NAME=]SENSOR[:ADDRESS][:MODE][@PORT]... [OPTIONS]",
    .tables = tables,
    .common = "port address mode baud format",
    .examples = "  fathom info hps167s:7 --port /dev/ttyUSB0\n"
                "  fathom info a05 --port /dev/ttyUSB0 --format json\n"
                "  fathom info tank=a16@/dev/ttyUSB0 gate=hps167s:7@/dev/ttyUSB1,baud=57600\n",
    .status = "Exit status: 0 all was read, 1 a part was not, 2 wrong usage.\n",
    .topics = "settings, sensors, ports",
    .operands = operands_asked,
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
    .operands = operands_setting,
    .settings_size = sizeof(session_settings_t),
    .start = start_get,
};
