/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "cli/session_options.h"
#include "commands/commands.h"
#include "commands/request/request_report.h"

/* fathom request: one Modbus request, as the user has written it. */

static port_t port;

/* Sends the request on the open port and reports its outcome. */
static int ask(const request_t *request)
{
    static request_ask_t asked;
    port_counts_t port_counts;
    counters_t counters;
    memset(&counters, 0, sizeof counters);
    counters_begin_port(&port_counts, &port);
    request_ask(&asked, request, &port);
    (void)counters_take(&counters, &port_counts, &port, NULL);
    errno = 0;
    request_print(&asked, &port);
    const int error = output_flush();
    request_print_problem(&asked, &port, &counters);
    if (error != 0) (void)fprintf(stderr, "fathom: the output cannot be written: %s\n", strerror(error));
    return error == 0 && request_is_good(&asked) ? STATUS_OK : STATUS_FAILED;
}

int request_start(const host_t *host, const arguments_t *arguments)
{
    request_t request;
    if (!request_options(&request, arguments)) return STATUS_USAGE;
    if (request_effects(&request) &&
        !confirm(arguments, request.is_confirmed, "This request can change something. Nothing was sent yet."))
        return STATUS_USAGE;
    memset(&port, 0, sizeof port);
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    const port_settings_t settings = {
        .path = request.path, .line = request.line, .echo = request.echo, .rs485 = request.rs485};
    if (!port_open_now(&port, host, &settings)) {
        (void)fprintf(stderr, "fathom: %s\n", port_error(&port));
        return STATUS_FAILED;
    }
    const int status = ask(&request);
    port_close(&port);
    return status;
}
