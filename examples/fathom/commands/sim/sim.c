/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): SIGUSR1 */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>

#include "cli/command.h"
#include "commands/commands.h"
#include "commands/sim/sim.h"
#include "ports/host.h"
#include "sim/pty.h"

enum { POWER_OFF_US = 1000000, CONNECT_US = 1000000 };

typedef struct {
    const sim_settings_t *settings;
    sim_site_t site;
    fathom_sim_line_t line;
    fathom_sim_pty_t pty;
    uint32_t connected; /* the first sensors */
    uint32_t left_us;   /* time at which the last connected sensor left its first address */
    bool has_left;      /* `left_us` is valid */
    device_t devices[SIM_SENSORS];
    fathom_sim_fault_t faults[SIM_SENSORS];
} simulation_t;

static void attach_faults(const sim_sensor_t *sensor, fathom_sim_fault_t *fault)
{
    fathom_sim_fault_init(fault, sensor->seed);
    for (uint8_t i = 0; i != sensor->fault_count; i++)
        (void)fathom_sim_fault_add(fault, sensor->faults[i].kind, sensor->faults[i].chance_ppm,
                                   sensor->faults[i].at_frame);
}

static void connect_sensor(simulation_t *simulation, uint32_t i, uint32_t now_us)
{
    const sim_sensor_t *const sensor = &simulation->site.sensors[i];
    device_t *const device = &simulation->devices[i];
    device_settings_t settings = {.address = sensor->address,
                                  .baud = sensor->line.baud,
                                  .seed = sensor->seed,
                                  .scene = sensor->scene.scene};
    for (uint32_t j = 0; j != i; j++)
        if (simulation->site.sensors[j].model == sensor->model) settings.number++;
    memcpy(settings.traits, sensor->traits, sizeof settings.traits);
    sensor->model->simulate(device, &settings, sensor->mode->simulated_as);
    attach_faults(sensor, &simulation->faults[i]);
    fathom_sim_fault_attach(&simulation->faults[i], &simulation->line, device->base);
    fathom_sim_attach(&simulation->line, device->base, now_us);
    simulation->connected++;
}

static bool open_line(simulation_t *simulation)
{
    const sim_site_t *const site = &simulation->site;
    const char *const link = simulation->settings->link;
    const fathom_sim_pty_config_t config = {.link = link};
    const uint32_t now_us = fathom_sim_pty_now_us();
    fathom_sim_line_init(&simulation->line, &site->sensors[0].line, now_us);
    /* A sensor without an address has a wire in each direction; the others share an RS485 pair. */
    simulation->line.full_duplex = site->count == 1 && !site->sensors[0].mode->has_address;
    simulation->line.echo = simulation->settings->has_echo;
    const uint32_t first = simulation->settings->one_by_one ? 1 : site->count;
    for (uint32_t i = 0; i != first; i++) connect_sensor(simulation, i, now_us);
    if (fathom_sim_pty_open(&simulation->pty, &simulation->line, &config) == 0) return true;
    if (link != NULL && errno == EEXIST)
        (void)fprintf(stderr,
                      "fathom: %s exists, and is not the link of a killed fathom sim. "
                      "Choose another --link, or remove it.\n",
                      link);
    else
        (void)fprintf(stderr, "fathom: cannot make the simulated port%s%s: %s\n",
                      link != NULL ? " and its link " : "", link != NULL ? link : "", strerror(errno));
    return false;
}

/* Prints only the path on stdout, for scripts, and what a person may want to know on stderr. */
static bool announce(const simulation_t *simulation)
{
    const char *const path = fathom_sim_pty_path(&simulation->pty);
    const char *const link = simulation->settings->link;
    if (printf("%s\n", path) < 0 || fflush(stdout) != 0) {
        (void)fprintf(stderr, "fathom: cannot write the path of the port: %s\n", strerror(errno));
        return false;
    }
    sim_announce(stderr, &simulation->site, simulation->settings->one_by_one, link != NULL ? link : path);
    return true;
}

/* The sensors of a line mostly share a supply, too. */
static void cycle_power(simulation_t *simulation)
{
    const uint32_t now_us = fathom_sim_pty_now_us();
    for (uint32_t i = 0; i != simulation->connected; i++)
        fathom_sim_power_cycle(&simulation->line, simulation->devices[i].base, POWER_OFF_US, now_us);
    (void)fprintf(stderr, "fathom: power off for a second.\n");
}

/* Connects the next sensor a second after the last one has left its address, as a person would. Returns the time until
 * this function must be called again, at most `due_us`. */
static uint32_t connect_next(simulation_t *simulation, uint32_t due_us)
{
    const uint32_t next = simulation->connected;
    if (next == simulation->site.count) return due_us;
    const uint32_t now_us = fathom_sim_pty_now_us();
    if (simulation->devices[next - 1].base->address == simulation->site.sensors[next - 1].address)
        return due_us;
    if (!simulation->has_left) simulation->left_us = now_us;
    simulation->has_left = true;
    const uint32_t passed_us = fathom_elapsed_us(now_us, simulation->left_us);
    if (passed_us < CONNECT_US) return due_us < CONNECT_US - passed_us ? due_us : CONNECT_US - passed_us;
    simulation->has_left = false;
    connect_sensor(simulation, next, now_us);
    (void)fprintf(stderr, "fathom: sensor %u is connected.\n", (unsigned)next + 1);
    return 0;
}

static int serve(simulation_t *simulation, const host_t *host)
{
    uint32_t due_us = 0;
    while (!host->has_ended(host->ctx)) {
        if (host_had_signal()) cycle_power(simulation);
        if (fathom_sim_pty_pump(&simulation->pty, &due_us) < 0) {
            (void)fprintf(stderr, "fathom: the simulated port failed: %s\n", strerror(errno));
            return STATUS_FAILED;
        }
        due_us = connect_next(simulation, due_us);
        host->wait(host->ctx, fathom_sim_pty_fd(&simulation->pty), POLLIN, due_us, false);
    }
    return STATUS_OK;
}

static void print_counters(const simulation_t *simulation)
{
    for (uint32_t i = 0; i != simulation->connected; i++)
        sim_print_counters(stderr, &simulation->site, i, simulation->devices[i].base, &simulation->line);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static simulation_t simulation;
    memset(&simulation, 0, sizeof simulation);
    simulation.settings = arguments->settings;
    if (!sim_sensors(&simulation.site, arguments)) return STATUS_USAGE;
    if (!host->begin(host->ctx) || !open_line(&simulation)) return STATUS_FAILED;
    host_watch_signal(SIGUSR1); /* before the path is printed, by which the process can be known */
    const int status = announce(&simulation) ? serve(&simulation, host) : STATUS_FAILED;
    if (simulation.settings->has_counters) print_counters(&simulation);
    fathom_sim_pty_close(&simulation.pty);
    return status;
}

const command_t sim_command = {
    .name = "sim",
    .summary = "Simulate sensors behind a serial port until interrupted",
    .usage = "SENSOR[:ADDRESS][:MODE][,KEY=VALUE...]... [OPTIONS]",
    .tables = sim_tables,
    .common = "link distance fault counters",
    .own_group = "Simulation",
    .about = "It prints the path of a pseudo terminal, which any program can open like a\n"
             "serial port. Write an option of one sensor behind it:\n"
             "a05:2,distance=1500,fault=drop=5%. An option without a sensor applies to all\n"
             "sensors that can have it. SIGUSR1 cuts the power of all sensors for a second.\n",
    .examples = "  fathom sim a16 --link ./tank\n"
                "  fathom sim a05::modbus --link ./bumper --distance 1000,2000,1953,no-target\n"
                "  fathom sim a16:1:modbus a05:2:modbus hps167s:7,distance=2083 --link ./bus\n",
    .status = "Exit status: 0 after Ctrl-C, 1 the port cannot be made, 2 wrong usage.\n",
    .topics = "faults, sensors",
    .operands = OPERANDS_SIMULATED,
    .settings_size = sizeof(sim_settings_t),
    .start = start,
};
