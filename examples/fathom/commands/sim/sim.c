/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): SIGUSR1 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>

#include "commands/commands.h"
#include "commands/sim/sim_help.h"
#include "commands/sim/sim_options.h"
#include "commands/sim/sim_report.h"
#include "ports/events.h"
#include "sim/pty.h"

enum { POWER_OFF_US = 1000000, CONNECT_US = 1000000 };

typedef struct {
    sim_options_t options;
    fathom_sim_line_t line;
    fathom_sim_pty_t pty;
    uint32_t connected; /* devices, the first ones */
    uint32_t left_us;   /* when the last of them left the address that it came with, ... */
    bool has_left;      /* ... if it has */
    device_t devices[SIM_DEVICES];
    fathom_sim_fault_t faults[SIM_DEVICES];
} simulation_t;

static void hang_device(simulation_t *simulation, uint32_t i, uint32_t now_us)
{
    const sim_device_t *const asked = &simulation->options.devices[i];
    uint8_t number = 0;
    for (uint32_t j = 0; j != i; j++)
        if (simulation->options.devices[j].model == asked->model) number++;
    device_settings_t settings = {.address = asked->address,
                                  .number = number,
                                  .baud = asked->line.baud,
                                  .seed = asked->seed,
                                  .scene = asked->scene.scene};
    device_t *const device = &simulation->devices[i];
    memcpy(settings.traits, asked->traits, sizeof settings.traits);
    asked->mode->simulate(device, &settings);
    sim_faults_begin(&asked->faults, &simulation->faults[i], asked->seed);
    fathom_sim_fault_attach(&simulation->faults[i], &simulation->line, device->base);
    fathom_sim_attach(&simulation->line, device->base, now_us);
    simulation->connected++;
}

static bool open_line(simulation_t *simulation)
{
    const sim_options_t *const options = &simulation->options;
    const fathom_sim_pty_config_t config = {.link = options->link};
    const uint32_t now_us = fathom_sim_pty_now_us();
    fathom_sim_line_init(&simulation->line, &options->devices[0].line, now_us);
    /* What has no address has a wire each way; the others share an RS485 pair. */
    simulation->line.full_duplex = options->count == 1 && !options->devices[0].mode->has_address;
    simulation->line.echo = options->echo;
    const uint32_t first = options->one_by_one ? 1 : options->count;
    for (uint32_t i = 0; i != first; i++) hang_device(simulation, i, now_us);
    if (fathom_sim_pty_open(&simulation->pty, &simulation->line, &config) == 0) return true;
    if (options->link != NULL && errno == EEXIST)
        (void)fprintf(stderr,
                      "fathom: %s is there already, and is no link that a killed fathom sim has left behind; "
                      "choose another --link, or remove it first\n",
                      options->link);
    else
        (void)fprintf(stderr, "fathom: the simulated port%s%s: %s\n",
                      options->link != NULL ? " and its link " : "",
                      options->link != NULL ? options->link : "", strerror(errno));
    return false;
}

/* The path alone on stdout, for scripts; what a person may want to know on stderr. */
static bool announce(const simulation_t *simulation)
{
    const char *const path = fathom_sim_pty_path(&simulation->pty);
    if (printf("%s\n", path) < 0 || fflush(stdout) != 0) {
        (void)fprintf(stderr, "fathom: the path of the port cannot be written: %s\n", strerror(errno));
        return false;
    }
    sim_announce(stderr, &simulation->options,
                 simulation->options.link != NULL ? simulation->options.link : path);
    return true;
}

/* Of all: what hangs on one line hangs on one supply, most often. */
static void cycle_power(simulation_t *simulation)
{
    const uint32_t now_us = fathom_sim_pty_now_us();
    for (uint32_t i = 0; i != simulation->connected; i++)
        fathom_sim_power_cycle(&simulation->line, simulation->devices[i].base, POWER_OFF_US, now_us);
    (void)fprintf(stderr, "fathom: power off for a second\n");
}

/* Connects the next one a second after the last one has left its address, as a person would. Returns how long it
 * may be until then at most. */
static uint32_t connect_next(simulation_t *simulation, uint32_t due_us)
{
    const uint32_t next = simulation->connected;
    if (next == simulation->options.count) return due_us;
    const uint32_t now_us = fathom_sim_pty_now_us();
    if (simulation->devices[next - 1].base->address == simulation->options.devices[next - 1].address)
        return due_us;
    if (!simulation->has_left) simulation->left_us = now_us;
    simulation->has_left = true;
    const uint32_t passed_us = fathom_elapsed_us(now_us, simulation->left_us);
    if (passed_us < CONNECT_US) return due_us < CONNECT_US - passed_us ? due_us : CONNECT_US - passed_us;
    simulation->has_left = false;
    hang_device(simulation, next, now_us);
    (void)fprintf(stderr, "fathom: device %u is connected\n", (unsigned)next + 1);
    return 0;
}

static int serve(simulation_t *simulation)
{
    uint32_t due_us = 0;
    while (!events_ended()) {
        if (events_noted()) cycle_power(simulation);
        if (fathom_sim_pty_pump(&simulation->pty, &due_us) < 0) {
            (void)fprintf(stderr, "fathom: the simulated port has failed: %s\n", strerror(errno));
            return STATUS_FAILED;
        }
        due_us = connect_next(simulation, due_us);
        events_wait(fathom_sim_pty_fd(&simulation->pty), POLLIN, due_us, false);
    }
    return STATUS_OK;
}

static void print_counters(const simulation_t *simulation)
{
    for (uint32_t i = 0; i != simulation->connected; i++)
        sim_print_counters(stderr, &simulation->options, i, simulation->devices[i].base, &simulation->line);
}

static int run(const host_t *host, int argc, char **argv)
{
    static simulation_t simulation;
    (void)host; /* it runs in real time, on a pseudo terminal */
    if (!sim_options(&simulation.options, argc, argv)) return STATUS_USAGE;
    if (simulation.options.wants_help) return command_help(&sim_command);
    if (!events_begin() || !open_line(&simulation)) return STATUS_FAILED;
    events_note(SIGUSR1); /* before the path is printed, by which the process can be known */
    const int status = announce(&simulation) ? serve(&simulation) : STATUS_FAILED;
    if (simulation.options.counters) print_counters(&simulation);
    fathom_sim_pty_close(&simulation.pty);
    return status;
}

const command_t sim_command = {"sim", "puts simulated sensors behind a serial port", sim_help, run};
