/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include "commands/commands.h"

#include <stdlib.h>
#include <string.h>

#include "cli/config.h"
#include "cli/rows.h"
#include "device/session.h"
#include "fathom/version.h"
#include "ports/port.h"
#include "reading/fields.h"

static const command_t *const commands[] = {
    &scan_command,    &read_command,  &watch_command,      &publish_command,   &info_command,
    &get_command,     &set_command,   &commission_command, &calibrate_command, &save_command,
    &restore_command, &reset_command, &request_command,    &decode_command,    &sim_command,
    &models_command,  NULL,
};

/* ---- tables in topics ---- */

static void print_mode(FILE *to, const model_mode_t *mode)
{
    char asks[64];
    (void)snprintf(asks, sizeof asks, "Send requests (%s)", mode->protocol != NULL ? mode->protocol : "");
    const char *const text = mode_is_asked(mode)  ? asks
                             : mode->is_contact   ? "Read a switch or a relay contact on a GPIO line"
                             : mode->has_pulses   ? "Trigger and measure pulses on GPIO lines"
                             : mode->is_triggered ? "Trigger each measurement by a break or a GPIO line"
                                                  : "Receive what the sensor sends automatically";
    (void)fprintf(to, "  :%-11s %s [%s]\n", mode->name, text, mode->section);
}

static void print_models(FILE *to)
{
    for (const model_t *model = models; model != models + model_count; model++) {
        char line[LINE_TEXT];
        (void)fprintf(to, "%s, %s, %s, addresses 1 to %u\n", model->name, model->what,
                      line_text(&model->line, line), model->max_address);
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            print_mode(to, &model->modes[m]);
    }
}

static void print_settings(FILE *to)
{
    for (const model_t *model = models; model != models + model_count; model++) {
        (void)fprintf(to, "\n%s:\n", model->name);
        settings_print(to, model->settings);
    }
}

/* A line %NAME of topics.txt stands for the keys of an option or of a port, or for what a function prints. */
static void print_table(FILE *to, const char *name)
{
    static const struct {
        const char *name;
        void (*print)(FILE *to);
    } tables[] = {
        {"models", print_models},      {"settings", print_settings},  {"reading", reading_help},
        {"finding", scan_help_fields}, {"config", config_print_keys}, {"traits", sim_print_traits},
        {"faults", sim_print_faults},
    };
    const option_table_t options[] = {{reading_rows, 0}, {result_rows, 0}, {NULL, 0}};
    const option_t *keys = NULL;
    option_walk_t walk;
    if (strcmp(name, "serial-keys") == 0) keys = serial_keys;
    if (strcmp(name, "chip-keys") == 0) keys = chip_keys;
    if (option_find(&walk, options, name)) keys = walk.row->keys;
    if (keys != NULL) help_print_keys(to, keys);
    for (size_t i = 0; i != sizeof tables / sizeof tables[0]; i++)
        if (strcmp(name, tables[i].name) == 0) tables[i].print(to);
}

/* ---- topics ---- */

/* topics.txt, which the build has made a source of. */
extern const char topics_text[];

/* Returns the text with its tables. */
static char *full_text(void)
{
    char *text = NULL;
    size_t size = 0;
    FILE *const to = open_memstream(&text, &size);
    if (to == NULL) end_without_memory();
    for (const char *rest = topics_text; rest != NULL && *rest != '\0';) {
        char line[100];
        rest = next_word(rest, '\n', line, sizeof line);
        if (line[0] == '%')
            print_table(to, line + 1);
        else
            (void)fprintf(to, "%s\n", line);
    }
    (void)fclose(to);
    return text;
}

/* Returns the topics, which a row without a name ends. Each begins with a line "@ NAME SUMMARY". */
static const help_topic_t *topics(void)
{
    enum { MOST_TOPICS = 40 };
    static help_topic_t all[MOST_TOPICS + 1];
    char *rest = all[0].name == NULL ? full_text() : NULL;
    for (size_t i = 0; rest != NULL && i != MOST_TOPICS; i++) {
        rest += strlen("@ ");
        all[i].name = strsep(&rest, " ");
        all[i].summary = strsep(&rest, "\n");
        all[i].text = rest;
        rest = strstr(rest, "\n@ ");
        if (rest != NULL) *++rest = '\0';
    }
    return all;
}

/* ---- help ---- */

static const struct {
    size_t first; /* the first command of the section */
    const char *head;
} sections[] = {{0, "Find and read sensors"}, {4, "Set up sensors"}, {12, "Look closer"}};

static const char first_steps[] =
    "  Find the sensors on a line:   fathom scan --port /dev/ttyUSB0\n"
    "  Log a sensor for a day:       fathom read a16 --port /dev/ttyUSB0\n"
    "                                  --interval 1000 --duration 86400\n"
    "                                  --format csv --output a16.csv --rotate day\n"
    "  Set an address:               fathom set hps167s --port /dev/ttyUSB0 address 7\n"
    "  Publish to a broker:          fathom publish site.yaml (fathom help config)\n"
    "  Find out why nothing responds: fathom help trouble\n"
    "  Try it without a sensor:      fathom sim a16 --link ./tank, and in another\n"
    "                                  terminal fathom read a16 --port ./tank\n";

static void print_overview(void)
{
    size_t section = 0;
    (void)printf("Usage: fathom COMMAND [ARGUMENTS]\n\n"
                 "Read and set up the range sensors A16, A05 and HPS-167S.\n");
    for (size_t i = 0; commands[i] != NULL; i++) {
        if (section != sizeof sections / sizeof sections[0] && sections[section].first == i)
            (void)printf("\n%s:\n", sections[section++].head);
        (void)printf("  %-11s %s\n", commands[i]->name, commands[i]->summary);
    }
    (void)printf("\nFirst steps:\n%s\nHelp:\n"
                 "  fathom COMMAND --help         the options of a command, with examples\n"
                 "  fathom help TOPIC             TOPIC is one of:\n",
                 first_steps);
    for (const help_topic_t *topic = topics(); topic->name != NULL; topic++)
        (void)printf("    %-13s  %s\n", topic->name, topic->summary);
    (void)printf("  fathom --version              the version\n"
                 "\nExit status: 0 success, 1 failure, 2 wrong usage, 3 an alarm is on (read).\n");
}

static const command_t *find(const char *name)
{
    for (size_t i = 0; commands[i] != NULL; i++)
        if (strcmp(name, commands[i]->name) == 0) return commands[i];
    return NULL;
}

static int reject_name(const char *what, const char *name, bool has_topics)
{
    static const origin_t origin;
    nearest_t nearest = {.word = name};
    for (size_t i = 0; commands[i] != NULL; i++) nearest_try(&nearest, commands[i]->name);
    for (const help_topic_t *topic = topics(); has_topics && topic->name != NULL; topic++)
        nearest_try(&nearest, topic->name);
    (void)reject_unknown(&origin, what, "", &nearest, !has_topics);
    return STATUS_USAGE;
}

static int finish(void) { return is_output_written() ? STATUS_OK : STATUS_FAILED; }

/* `fathom help --man [COMMAND]`, for the installation. */
static bool print_installed(int argc, char **argv)
{
    if (argc == 0 || argc > 2 || strcmp(argv[0], "--man") != 0) return false;
    const command_t *const command = argc == 2 ? find(argv[1]) : NULL;
    if (argc == 2 && command == NULL) return false;
    if (command != NULL)
        man_print(stdout, command);
    else
        man_print_tool(stdout, commands, topics(), first_steps);
    return true;
}

/* `fathom help`, `fathom help COMMAND` and `fathom help TOPIC`, argv behind "help". */
static int help(int argc, char **argv)
{
    static const origin_t origin;
    if (print_installed(argc, argv)) return finish();
    if (argc > 1) {
        (void)reject(&origin, "help takes one command or topic.");
        return STATUS_USAGE;
    }
    const command_t *const command = argc == 1 ? find(argv[0]) : NULL;
    const help_topic_t *topic = topics();
    while (argc == 1 && topic->name != NULL && strcmp(topic->name, argv[0]) != 0) topic++;
    if (argc == 0)
        print_overview();
    else if (command != NULL)
        help_print(stdout, command);
    else if (topic->name != NULL)
        help_print_topic(stdout, topic);
    else
        return reject_name("command or topic", argv[0], true);
    return finish();
}

/* ---- commands ---- */

static int start(const host_t *host, const command_t *command, int argc, char **argv)
{
    arguments_t arguments;
    int status = STATUS_USAGE;
    void *const settings = allocate(command->settings_size);
    if (arguments_parse(&arguments, command, argc, argv, settings)) {
        if (arguments.wants_help) help_print(stdout, command);
        status = arguments.wants_help ? finish() : command->start(host, &arguments);
    }
    free(settings);
    return status;
}

int run_command(const host_t *host, int argc, char **argv)
{
    static const origin_t origin;
    if (argc < 2) {
        (void)reject(&origin, "no command is named.");
        return STATUS_USAGE;
    }
    const char *const name = argv[1];
    const command_t *const command = find(name);
    if (command != NULL) return start(host, command, argc - 1, argv + 1);
    if (strcmp(name, "help") == 0) return help(argc - 2, argv + 2);
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return help(0, NULL);
    if (strcmp(name, "--version") == 0 || strcmp(name, "-v") == 0)
        (void)printf("fathom %s\n", FATHOM_VERSION_STRING);
    else if (strcmp(name, "complete") == 0)
        complete(stdout, commands, topics(), argv + 2, argc - 2);
    else
        return reject_name(name[0] == '-' ? "option" : "command", name, false);
    return finish();
}
