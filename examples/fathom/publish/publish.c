/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands.h"
#include "publish/explain.h"
#include "shared/options.h"

static const char command[] = "publish";

enum { CHECK, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [CHECK] = {"check", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

static void help(FILE *to)
{
    (void)fputs(
        "fathom publish reads all sensors of a site and publishes what they say to an MQTT broker.\n\n"
        "usage: fathom publish [--check] FILE\n\n",
        to);
    config_keys_help(to);
}

static int run(const host_t *host, int argc, char **argv)
{
    static config_t config;
    static config_results_t results;
    const char *values[OPTIONS] = {NULL};
    const int rest = options_parse(command, argc, argv, table, values);
    (void)host;
    if (rest < 0) return STATUS_USAGE;
    if (values[HELP] != NULL) return command_help(&publish_command);
    if (argc - rest != 1)
        return usage_error(command, "which configuration file? One, such as /etc/fathom/site.yaml");
    if (!config_load(&config, results, command, argv[rest])) return STATUS_USAGE;
    if (values[CHECK] != NULL) {
        explain(&config, results, stdout);
        config_free(&config);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    return STATUS_OK;
}

const command_t publish_command = {"publish", "publishes sensors to an MQTT broker", help, run};
