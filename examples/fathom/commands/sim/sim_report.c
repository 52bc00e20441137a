/* SPDX-License-Identifier: MIT */
#include <inttypes.h>

#include "commands/commands.h"
#include "commands/sim/sim.h"
#include "output/record.h"
#include "ports/line_text.h"
#include "sensors/read_command.h"

static void print_sensor(FILE *to, const sim_sensor_t *sensor)
{
    char line[LINE_TEXT];
    (void)fprintf(to, "%s, mode %s, address %u, %s", sensor->model->name, sensor->mode->name, sensor->address,
                  line_text(&sensor->line, line));
}

static void print_reader(FILE *to, const sim_sensor_t *sensor, const char *port)
{
    read_command_print(to, sensor->model, sensor->mode->name,
                       sensor->mode->has_address ? sensor->address : -1, &sensor->line, port);
    (void)fputs("\n", to);
}

/* Sensors that disturb each other are mostly intended, but the user should know. */
static void print_clashes(FILE *to, const sim_site_t *site, bool one_by_one)
{
    if (one_by_one) {
        (void)fputs("fathom: each further sensor is connected a second after the sensor before it left its "
                    "address.\n",
                    to);
        return;
    }
    for (uint32_t i = 0; i != site->count; i++) {
        const sim_sensor_t *const one = &site->sensors[i];
        if (!mode_is_asked(one->mode))
            (void)fprintf(to,
                          "fathom: sensor %" PRIu32 " sends automatically, into the frames of the others.\n",
                          i + 1);
        for (uint32_t other = i + 1; other != site->count; other++)
            if (site->sensors[other].address == one->address &&
                site->sensors[other].line.baud == one->line.baud)
                (void)fprintf(to,
                              "fathom: sensors %" PRIu32 " and %" PRIu32
                              " both have address %u, and their responses collide.\n",
                              i + 1, other + 1, one->address);
    }
}

void sim_announce(FILE *to, const sim_site_t *site, bool one_by_one, const char *port)
{
    if (site->count == 1) {
        (void)fprintf(to, "fathom: simulates ");
        print_sensor(to, &site->sensors[0]);
        (void)fprintf(to, ", until Ctrl-C; to read it: ");
        print_reader(to, &site->sensors[0], port);
        return;
    }
    print_clashes(to, site, one_by_one);
    (void)fprintf(to, "fathom: simulates %" PRIu32 " sensors on one line, until Ctrl-C; to read each:\n",
                  site->count);
    for (uint32_t i = 0; i != site->count; i++) {
        (void)fprintf(to, "  %2" PRIu32 "  ", i + 1);
        print_sensor(to, &site->sensors[i]);
        (void)fprintf(to, ": ");
        print_reader(to, &site->sensors[i], port);
    }
}

void sim_print_counters(FILE *to, const sim_site_t *site, uint32_t i, const fathom_sim_device_t *device,
                        const fathom_sim_line_t *line)
{
    const fathom_sim_counters_t *const counters = &device->counters;
    const struct {
        const char *name;
        uint32_t value;
    } fields[] = {
        {"baud", device->settings.baud},
        {"requests", counters->requests},
        {"answered", counters->answered},
        {"exceptions", counters->exceptions},
        {"unserved", counters->unserved},
        {"others", counters->others},
        {"crc_errors", counters->crc_errors},
        {"truncated", counters->truncated},
        {"unheard", counters->unheard},
        {"wrong_settings", counters->wrong_settings},
        {"automatic", counters->automatic},
        {"writes", counters->writes},
        {"writes_refused", counters->writes_refused},
        {"flash_writes", counters->flash_writes},
        {"resets", counters->resets},
        {"resets_refused", counters->resets_refused},
        {"measurements", counters->measurements},
        {"line_collisions", line->counters.collisions},
    };
    json_t json = {.to = to};
    json_begin(&json, NULL, '{');
    json_value(&json, "device", "%" PRIu32, i + 1);
    json_string(&json, "model", site->sensors[i].model->name);
    json_string(&json, "mode", site->sensors[i].mode->name);
    json_value(&json, "address", "%u", device->address);
    for (size_t f = 0; f != sizeof fields / sizeof fields[0]; f++)
        json_value(&json, fields[f].name, "%" PRIu32, fields[f].value);
    json_end(&json, '}');
    (void)fputc('\n', to);
}

void topic_faults(FILE *to)
{
    (void)fputs("'fathom sim' makes a pseudo terminal with up to 64 sensors on one line. At most one\n"
                "of them may send automatically. Sensors with the same address respond at once, as\n"
                "real ones do. SIGUSR1 cuts their power for a second; they keep the settings that real\n"
                "ones keep. --link replaces nothing but a link that a killed 'fathom sim' left behind.\n\n"
                "Write options of one sensor behind it: a05:2,distance=1500,fault=silence=10%.\n"
                "Options without a sensor apply to all sensors that can have them.\n\n"
                "distance: 0 to 65535 mm, or no-target, interference (a16, a05) or fault (hps167s). An\n"
                "a05 takes up to four, with commas between them. Without it, the target moves.\n\n"
                "baud: the rate that an hps167s was set to. Each sensor responds only at its own rate.\n\n"
                "with: a state that was set before, or a behaviour that the datasheets leave open:\n",
                to);
    sim_print_traits(to);
    (void)fputs("\nfault=KIND[=P[@N]]: damages frames that the sensor sends, each with the probability P,\n"
                "such as 0.05 or 5% (default 1), or only frame N, counted from 1:\n",
                to);
    sim_print_faults(to);
}
