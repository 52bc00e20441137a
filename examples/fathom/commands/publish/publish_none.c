/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/commands.h"

/* What the build did not find: FATHOM_PUBLISH_LACKS, "libmosquitto" for one. */

#ifndef FATHOM_PUBLISH_LACKS
#define FATHOM_PUBLISH_LACKS "libmosquitto or libyaml"
#endif

static void help(FILE *to)
{
    (void)fputs("fathom publish publishes what sensors say to an MQTT broker. This fathom was built "
                "without " FATHOM_PUBLISH_LACKS ", which that needs.\n",
                to);
}

static int run(const host_t *host, int argc, char **argv)
{
    (void)host;
    if (argc > 1 && strcmp(argv[1], "--help") == 0) return command_help(&publish_command);
    return usage_error("publish", "this fathom was built without " FATHOM_PUBLISH_LACKS
                                  "; install the development files and build it again");
}

const command_t publish_command = {.name = "publish",
                                   .summary = "publishes sensors to an MQTT broker (not in this build)",
                                   .help = help,
                                   .run = run};
