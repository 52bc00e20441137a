/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <poll.h>
#include <string.h>

#include "command.h"
#include "events.h"
#include "options.h"
#include "sim/pty.h"
#include "sim_options.h"

typedef struct {
    sim_options_t options;
    fathom_sim_line_t line;
    fathom_sim_pty_t pty;
    device_t device;
    fathom_sim_fault_t fault;
} session_t;

static bool open_line(session_t *session)
{
    const sim_options_t *const options = &session->options;
    const fathom_sim_pty_config_t config = {.link = options->link};
    const device_settings_t settings = {
        .address = options->address, .seed = options->seed, .scene = options->scene.scene};
    const uint32_t now_us = fathom_sim_pty_now_us();
    fathom_sim_line_init(&session->line, &options->sensor->line, now_us);
    session->line.full_duplex = !options->mode->is_asked; /* what sends by itself has a wire each way */
    options->mode->simulate(&session->device, &settings);
    sim_faults_begin(&options->faults, &session->fault, options->seed);
    fathom_sim_fault_attach(&session->fault, &session->line, session->device.base);
    fathom_sim_attach(&session->line, session->device.base, now_us);
    if (fathom_sim_pty_open(&session->pty, &session->line, &config) == 0) return true;
    if (options->link != NULL && errno == EEXIST)
        (void)fprintf(stderr, "fathom: %s is there already and is no link; choose another --link\n",
                      options->link);
    else
        (void)fprintf(stderr, "fathom: the simulated port%s%s: %s\n",
                      options->link != NULL ? " and its link " : "",
                      options->link != NULL ? options->link : "", strerror(errno));
    return false;
}

/* The path alone on stdout, for scripts; what a person may want to know on stderr. */
static bool announce(const session_t *session)
{
    const sim_options_t *const options = &session->options;
    const char *const path = fathom_sim_pty_path(&session->pty);
    char line[SETTINGS_TEXT];
    if (printf("%s\n", path) < 0 || fflush(stdout) != 0) {
        (void)fprintf(stderr, "fathom: the path of the port cannot be written: %s\n", strerror(errno));
        return false;
    }
    (void)fprintf(stderr,
                  "fathom: simulates %s, mode %s, address %u, %s, until Ctrl-C; to read it: fathom read %s",
                  options->sensor->name, options->mode->name, options->address,
                  settings_text(&options->sensor->line, line), options->sensor->name);
    if (options->mode != &options->sensor->modes[0]) (void)fprintf(stderr, " --mode %s", options->mode->name);
    if (options->mode->is_asked && options->address != FACTORY_ADDRESS)
        (void)fprintf(stderr, " --address %u", options->address);
    (void)fprintf(stderr, " --port %s\n", options->link != NULL ? options->link : path);
    return true;
}

static int serve(session_t *session)
{
    uint32_t due_us = 0;
    while (!events_ended()) {
        if (fathom_sim_pty_pump(&session->pty, &due_us) < 0) {
            (void)fprintf(stderr, "fathom: the simulated port has failed: %s\n", strerror(errno));
            return STATUS_FAILED;
        }
        events_wait(fathom_sim_pty_fd(&session->pty), POLLIN, due_us, false);
    }
    return STATUS_OK;
}

static int run(int argc, char **argv)
{
    static session_t session;
    if (!sim_options(&session.options, argc, argv)) return STATUS_USAGE;
    if (session.options.wants_help) {
        sim_help(stdout);
        return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
    }
    if (!events_begin() || !open_line(&session)) return STATUS_FAILED;
    const int status = announce(&session) ? serve(&session) : STATUS_FAILED;
    fathom_sim_pty_close(&session.pty);
    return status;
}

const command_t sim_command = {"sim", "puts a simulated sensor behind a serial port", sim_help, run};
