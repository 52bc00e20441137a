/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "commands/request/request.h"

static const origin_t origin = {.command = "request"};

/* The time that a broadcast gives the units (MODBUS over Serial Line V1.02, 2.4.1: 100 to 200 ms). */
enum { TURNAROUND_US = 200000, TIMEOUT_US = 1000000 };

/* The options before the frame is known. */
typedef struct {
    sensor_defaults_t line;
    const char *sensor; /* NULL: not given */
    uint32_t timeout_us;
    bool is_json;
    bool is_confirmed;
} request_settings_t;

static const option_t rows[] = {
    {"sensor", "MODEL", "Use the line settings of MODEL, and decode the response for it", KIND_TEXT,
     GROUP_COMMAND, AT(request_settings_t, sensor), .list = model_name},
    {"timeout", "MS", "Wait at most MS for the response (default 1000)", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 600000, .scale = 1000, AT(request_settings_t, timeout_us)},
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(request_settings_t, is_json)},
    {"yes", .help = "Do not ask before a request that can change something", .group = GROUP_COMMAND,
     AT(request_settings_t, is_confirmed)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {port_rows, 0}, {NULL, 0}};

static bool set_line(request_t *request, const request_settings_t *settings)
{
    port_options_t port = {.path = settings->line.path, .keys = settings->line.keys};
    request->line = (fathom_line_settings_t){9600, FATHOM_PARITY_NONE, 1};
    if (settings->sensor != NULL) {
        request->model = model_word(settings->sensor, &origin);
        if (request->model == NULL) return false;
        request->line = request->model->line;
    }
    if (port.path == NULL)
        return reject(&origin,
                      "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
    port_options_take(&port, &port.keys);
    port_options_line(&port, &port.keys, &request->line);
    request->echo = port.echo;
    request->rs485 = settings->line.keys.value[KEY_RS485] != 0;
    request->path = port.path;
    return true;
}

static bool read_options(request_t *request, const arguments_t *arguments)
{
    const request_settings_t *const settings = arguments->settings;
    const uint32_t timeout_us = settings->timeout_us != 0 ? settings->timeout_us : TIMEOUT_US;
    memset(request, 0, sizeof *request);
    if (!request_words(request, arguments->words, arguments->count) || !set_line(request, settings))
        return false;
    request->timeout_us = request_is_broadcast(request) ? TURNAROUND_US : timeout_us;
    request->is_json = settings->is_json;
    request->is_confirmed = settings->is_confirmed;
    return true;
}

/* Sends the request on the open port and reports its outcome. */
static int ask(const request_t *request, port_t *port)
{
    static request_ask_t asked;
    port_counts_t port_counts;
    counters_t counters;
    memset(&counters, 0, sizeof counters);
    counters_begin_port(&port_counts, port);
    request_ask(&asked, request, port);
    (void)counters_take(&counters, &port_counts, port, NULL);
    errno = 0;
    request_print(&asked, port);
    const int error = output_flush();
    request_print_problem(&asked, port, &counters);
    if (error != 0) (void)fprintf(stderr, "fathom: the output cannot be written: %s\n", strerror(error));
    return error == 0 && request_is_good(&asked) ? STATUS_OK : STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static port_t port;
    request_t request;
    memset(&port, 0, sizeof port);
    if (!read_options(&request, arguments)) return STATUS_USAGE;
    if (request_effects(&request) &&
        !confirm(arguments, request.is_confirmed, "This request can change something. Nothing was sent yet."))
        return STATUS_USAGE;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    const port_options_t options = {
        .path = request.path, .line = request.line, .echo = request.echo, .rs485 = request.rs485};
    if (!port_open_now(&port, host, &options)) {
        (void)fprintf(stderr, "fathom: %s\n", port.error_text);
        return STATUS_FAILED;
    }
    const int status = ask(&request, &port);
    port_close(&port);
    return status;
}

const command_t request_command = {
    .name = "request",
    .summary = "Send one Modbus request and print the response",
    .usage = "UNIT 3 REGISTER [COUNT] [OPTIONS]\n"
             "UNIT 6 REGISTER VALUE [OPTIONS]\n"
             "UNIT 16 REGISTER VALUE... [OPTIONS]\n"
             "UNIT FUNCTION [BYTE...] [OPTIONS]",
    .about = "Numbers are decimal, or hex behind 0x; BYTE is hex. REGISTER is the address on\n"
             "the wire, as the datasheets print it (0x0101). VALUE may be negative. The CRC\n"
             "is added. Nothing is repeated. Unit 0 is all units, which do not respond.\n"
             "What can change something is printed first, and must be confirmed: writes,\n"
             "functions other than 1 to 4, units 0 and 255, and reads of 0x0009, which\n"
             "reset an hps167s. Any request stops the automatic output of an A16 or A05.\n",
    .tables = tables,
    .common = "port sensor yes timeout format",
    .examples = "  fathom request 1 3 0x0101 --port /dev/ttyUSB0 --sensor a16\n"
                "  fathom request 7 3 0x0008 4 --port /dev/ttyUSB0 --sensor hps167s\n"
                "  fathom request 1 6 0x0206 2000 --port /dev/ttyUSB0 --yes\n"
                "  fathom request 1 0x2b 0e 01 00 --port /dev/ttyUSB0 --yes\n",
    .status = "Exit status: 0 a response or an echo, or sent to all units; 1 no or a damaged\n"
              "response, or an exception; 2 wrong usage, or not confirmed.\n",
    .topics = "requests, ports",
    .settings_size = sizeof(request_settings_t),
    .start = start,
};
