/* SPDX-License-Identifier: MIT */
#include "sim_options.h"

#include <string.h>

#include "command.h"
#include "options.h"
#include "sim/pty.h"

static const char command[] = "sim";

enum { LINK, DISTANCE, SEED, FAULT, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [LINK] = {"link", required_argument, NULL, 256}, [DISTANCE] = {"distance", required_argument, NULL, 256},
    [SEED] = {"seed", required_argument, NULL, 256}, [FAULT] = {"fault", required_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

enum { MAX_DEVICE_TEXT = 40 };

/* SENSOR[:ADDR[:MODE]]; an empty ADDR is the factory's. */
static bool take_device(sim_options_t *options, const char *text)
{
    char parts[MAX_DEVICE_TEXT];
    uint32_t address = FACTORY_ADDRESS;
    if (strlen(text) >= sizeof parts) return sensor_find(command, text) != NULL;
    memcpy(parts, text, strlen(text) + 1);
    char *const address_text = strchr(parts, ':');
    char *const mode_text = address_text != NULL ? strchr(address_text + 1, ':') : NULL;
    if (address_text != NULL) *address_text = '\0';
    if (mode_text != NULL) *mode_text = '\0';
    options->sensor = sensor_find(command, parts);
    if (options->sensor == NULL) return false;
    options->mode = sensor_mode_find(command, options->sensor, mode_text != NULL ? mode_text + 1 : NULL);
    if (options->mode == NULL) return false;
    if (address_text != NULL && address_text[1] != '\0' &&
        !number_parse(address_text + 1, 1, options->sensor->max_address, &address)) {
        (void)usage_error(command, "the address of %s is a number from 1 to %u, not '%s'",
                          options->sensor->name, options->sensor->max_address, address_text + 1);
        return false;
    }
    options->address = (uint8_t)address;
    return true;
}

static void each(void *ctx, int row, const char *value)
{
    if (row == FAULT) sim_faults_note(ctx, value);
}

bool sim_options(sim_options_t *options, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    memset(options, 0, sizeof *options);
    const int rest = options_parse_each(command, argc, argv, table, values, each, &options->faults);
    if (rest < 0) return false;
    options->wants_help = values[HELP] != NULL;
    if (options->wants_help) return true;
    if (rest != argc - 1) {
        (void)usage_error(command, rest == argc ? "which sensor? a16, a05 or hps167s" : "one sensor a line");
        return false;
    }
    if (!take_device(options, argv[rest]) ||
        !option_number(command, "seed", values[SEED], 0, UINT32_MAX, &options->seed) ||
        !sim_faults_parse(&options->faults, command, options->sensor, options->mode))
        return false;
    options->link = values[LINK];
    if (values[DISTANCE] == NULL) {
        scenery_moving(&options->scene, options->sensor, options->seed, fathom_sim_pty_now_us());
        return true;
    }
    return scenery_fixed(&options->scene, command, options->sensor, values[DISTANCE]);
}

void sim_help(FILE *to)
{
    (void)fputs("fathom sim puts a simulated sensor behind a pseudo terminal, which any program can open "
                "like a serial\n"
                "port. It prints the port's path and runs until Ctrl-C.\n\n"
                "usage: fathom sim SENSOR[:ADDRESS[:MODE]] [OPTIONS]\n\n",
                to);
    sensors_print(to);
    (void)fputs(
        "\nThe first mode is the default, the address from the factory is 1.\n\n"
        "  --link PATH       makes a link to the port, for a name that stays; removed at the end\n"
        "  --distance MM     what it measures, 0..65535, which is sent as it is; or no-target, interference "
        "(a16,\n"
        "                    a05) or fault (hps167s). An a05 takes up to four, separated by commas; the last "
        "one\n"
        "                    holds for the probes that are left. Default: something that moves to and fro\n"
        "  --seed N          where the movement begins, the small differences of the answer times, and the "
        "faults;\n"
        "                    default 0\n"
        "  --fault KIND[=P[@N]]\n"
        "                    damages what it sends: each frame with the chance P, such as 0.05 or 5% "
        "(default "
        "1), or\n"
        "                    only the N-th, counted from 1. May be given several times, such as\n"
        "                    --fault silence=10% --fault flip-bit=0.01. The kinds:\n",
        to);
    sim_faults_print(to);
    (void)fputs(
        "\n"
        "It answers only at its own baud rate. Parity cannot be seen through a pseudo terminal.\n"
        "Exit status: 0 after Ctrl-C, 1 when the port or the link cannot be made, 2 for wrong usage.\n\n"
        "examples, each with what reads it:\n"
        "  fathom sim a16 --link ./tank                    fathom read a16 --port ./tank\n"
        "  fathom sim a05::modbus --link ./bumper --distance 1000,2000,1953,no-target\n"
        "                                                  fathom read a05 --mode modbus --port ./bumper\n"
        "  fathom sim hps167s:7 --link ./gate              fathom read hps167s --address 7 --port ./gate\n"
        "  fathom sim hps167s --link ./tof                 mbpoll -m rtu -a 1 -b 19200 -P even -t 4:hex -0 "
        "-r 8 -c 4 -1 ./tof\n",
        to);
}
