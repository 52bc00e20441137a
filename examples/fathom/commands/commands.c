/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

#include <stdlib.h>
#include <string.h>

#include "cli/arguments.h"
#include "cli/help.h"
#include "cli/options.h"
#include "fathom/version.h"

static const command_t *const commands[] = {
    &scan_command,    &read_command,  &watch_command,      &publish_command,   &info_command,
    &get_command,     &set_command,   &commission_command, &calibrate_command, &save_command,
    &restore_command, &reset_command, &request_command,    &decode_command,    &sim_command,
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static int no_command(void)
{
    char names[160] = "";
    for (size_t i = 0; i != COMMANDS; i++) {
        list_add(names, sizeof names, commands[i]->name);
    }
    return usage_error("", "a command is missing: %s", names);
}

static void print_help(void)
{
    (void)printf("fathom reads the range sensors A16, A05 and HPS-167S on a serial port.\n\n"
                 "usage: fathom COMMAND [ARGUMENTS]\n\n");
    for (size_t i = 0; i != COMMANDS; i++)
        (void)printf("  %-10s %s\n", commands[i]->name, commands[i]->summary);
    (void)printf("\nfathom COMMAND --help   explains a command, with examples\n"
                 "fathom --version        prints the version\n\n"
                 "Without a sensor at hand, in two terminals:\n\n"
                 "  fathom sim  a16 --link ./tank\n"
                 "  fathom read a16 --port ./tank\n\n"
                 "Exit status: 0 when nothing failed, 1 when the line, the port or the output did, 2 for "
                 "wrong usage,\n3 when `fathom read --until-alarm` was ended by an alarm.\n");
}

static int start(const host_t *host, const command_t *command, int argc, char **argv)
{
    arguments_t arguments;
    int status = STATUS_USAGE;
    if (command->start == NULL) return command->run(host, argc, argv);
    void *const settings = calloc(1, command->settings_size);
    if (settings == NULL) {
        (void)fputs("fathom: there is no memory left.\n", stderr);
        return STATUS_FAILED;
    }
    if (arguments_parse(&arguments, command, argc, argv, settings)) {
        if (arguments.wants_help) help_print(stdout, command);
        status = arguments.wants_help ? (fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED)
                                      : command->start(host, &arguments);
    }
    free(settings);
    return status;
}

int run_command(const host_t *host, int argc, char **argv)
{
    if (argc < 2) return no_command();
    const char *const name = argv[1];
    for (size_t i = 0; i != COMMANDS; i++)
        if (strcmp(name, commands[i]->name) == 0) return start(host, commands[i], argc - 1, argv + 1);
    if (strcmp(name, "--version") == 0) {
        (void)printf("fathom %s\n", FATHOM_VERSION_STRING);
    } else if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        print_help();
    } else {
        return usage_error("", "there is no command '%s'", name);
    }
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}
