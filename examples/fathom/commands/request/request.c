/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "cli/options.h"
#include "commands/commands.h"
#include "commands/request/request_report.h"

/* fathom request: one Modbus request, as the user has written it. */

static port_t port;

static void help(FILE *to)
{
    (void)fputs(
        "fathom request sends one Modbus request with a right CRC, once, and shows what comes back.\n\n"
        "usage: fathom request UNIT 3 REGISTER [COUNT] --port PATH [OPTIONS]      reads registers, as does "
        "4\n"
        "       fathom request UNIT 6 REGISTER VALUE --port PATH --yes            writes one\n"
        "       fathom request UNIT 16 REGISTER VALUE... --port PATH --yes        writes several\n"
        "       fathom request UNIT FUNCTION [BYTE...] --port PATH [OPTIONS]      another function, bytes in "
        "hex\n\n"
        "UNIT, FUNCTION, REGISTER, COUNT and VALUE are decimal, or hex behind 0x; REGISTER is the address on "
        "the wire,\nas the datasheets print it (0x0101), not one more. A VALUE may be negative.\n\n"
        "  --port PATH       the serial port: /dev/ttyUSB0, or the link of `fathom sim`; or "
        "tcp:HOST[:PORT]\n" OPTIONS_PORT_HELP
        "  --sensor MODEL    a16, a05 or hps167s: its line settings, and what the response means\n"
        "  --baud N          if not the sensor's, or 9600: 19200, 38400, 57600, 115200 or 230400\n"
        "  --parity P        if not the sensor's, or none: even or odd\n"
        "  --stop-bits N     if not 1: 2, which means no parity too unless --parity is given\n"
        "  --timeout MS      how long to wait for the response; default 1000\n"
        "  --echo ECHO       does the adapter return what it sends? auto (default: found out), on or off. "
        "The "
        "response\n"
        "                    to 5 or 6 equals its request: only on or off tells it from an echo for sure\n"
        "  --rs485           the kernel's driver drives the transceiver: RTS is on while bytes leave\n"
        "  --format FORMAT   text (default) or json, an object\n"
        "  --yes             sends it although it writes, has a function but 1 to 4, goes to unit 0 or 255, "
        "or "
        "reads\n"
        "                    0x0009\n\n"
        "JSON has unit, function, status (answered, answered_or_echo, sent, exception, unexpected, damaged, "
        "no_response,\n"
        "failed), the bytes as sent and received, or heard where no response is certain; of a read "
        "registers, "
        "of "
        "an exception\n"
        "its code and name, and meanings, empty without --sensor.\n\n"
        "What the request may do is said before it is sent; without --yes what is dangerous is not sent. Any "
        "request\nends the automatic output of an A16 with RS232 or an A05 with UART. A read of 0x0009 "
        "resets "
        "an HPS-167S.\nNothing is repeated. Unit 0 is all units: none answers, and none is waited for (a "
        "read "
        "waits: an A16 or\nA05 may have that address).\n"
        "Exit status: 0 when it was answered, also where that may be an echo (answered_or_echo), or sent to "
        "all\n"
        "units; 1 when not, when the unit refused it or the response was damaged; 2 for wrong usage, or "
        "without --yes.\n\n"
        "examples:\n"
        "  fathom request 1 3 0x0101 --port /dev/ttyUSB0 --sensor a16\n"
        "  fathom request 7 3 0x0008 4 --port /dev/ttyUSB0 --sensor hps167s\n"
        "  fathom request 1 6 0x0206 2000 --port /dev/ttyUSB0 --yes\n"
        "  fathom request 1 16 0x0020 0 180 --port /dev/ttyUSB0 --sensor hps167s --yes\n"
        "  fathom request 1 0x2b 0e 01 00 --port /dev/ttyUSB0 --yes\n",
        to);
}

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

static int run(const host_t *host, int argc, char **argv)
{
    request_t request;
    bool wants_help = false;
    if (!request_options(&request, argc, argv, &wants_help)) return STATUS_USAGE;
    if (wants_help) return command_help(&request_command);
    if (request_effects(&request) && !request.is_meant)
        return usage_error("request", "nothing was sent; --yes sends it all the same");
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

const command_t request_command = {.name = "request",
                                   .summary = "sends one Modbus request and shows the response",
                                   .help = help,
                                   .run = run};
