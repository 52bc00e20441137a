/* SPDX-License-Identifier: MIT */
/*
 * Fathom's Modbus client on the termios port or over libmodbus, for functions that no command of the tool has:
 *
 *     fathom_client posix|libmodbus PORT BAUD none|even TIMEOUT_MS STEP ...
 *
 * PORT is a terminal, or for libmodbus also tcp:HOST:PORT, which has no use for BAUD and parity. Exit status 0
 * when every step was tried, 1 when the port does not open, 2 for wrong usage. On the termios port a read finds
 * out whether the line has an echo: a write needs one before it.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fathom/engine/modbus_client.h"
#include "fathom_libmodbus.h"
#include "fathom_posix.h"
#include "steps.h"

enum { BITS_OF_8N1 = 10, BITS_OF_8E1 = 11, BEHIND_AN_OS_US = 25000 };

typedef struct {
    fathom_modbus_t modbus;
    void (*wait)(void *port, uint32_t max_us);
    void *port;
    uint32_t timeout_us;
} transport_t;

/* ---- steps ---- */

static void print_outcome(const fathom_modbus_request_t *request, const step_t *step)
{
    switch (request->transaction.status) {
    case FATHOM_OK:
        if (step->kind == STEP_READ)
            step_print(step->values, step->count, 4);
        else
            (void)puts("done");
        break;
    case FATHOM_ERR_EXCEPTION:
        (void)printf("exception %u\n", request->message.exception);
        break;
    case FATHOM_ERR_NO_RESPONSE:
        (void)puts("no response");
        break;
    default:
        (void)printf("%s\n", fathom_status_name((fathom_status_t)request->transaction.status));
        break;
    }
}

static bool run(const transport_t *transport, step_t *step, uint8_t unit)
{
    fathom_line_t *const line = transport->modbus.line;
    fathom_modbus_request_t request = {.transaction = {.timeout_us = transport->timeout_us}};
    switch (step->kind) {
    case STEP_READ:
        fathom_modbus_read_holding_registers(&request.message, unit, step->first, (uint8_t)step->count,
                                             step->values);
        break;
    case STEP_WRITE:
        fathom_modbus_write_single_register(&request.message, unit, step->first, step->values[0]);
        break;
    case STEP_MANY:
        fathom_modbus_write_multiple_registers(&request.message, unit, step->first, (uint8_t)step->count,
                                               step->values);
        break;
    default:
        return false;
    }
    const fathom_status_t status = transport->modbus.submit(line, &request);
    if (status != FATHOM_PENDING) {
        (void)printf("not sent, %s\n", fathom_status_name(status));
        return true;
    }
    for (;;) {
        (void)fathom_line_poll(line);
        if (request.transaction.status != FATHOM_PENDING) break;
        transport->wait(transport->port, fathom_line_due_us(line));
    }
    print_outcome(&request, step);
    (void)fflush(stdout);
    return true;
}

/* Returns false if a step has no meaning, or none for this client. */
static bool run_all(const transport_t *transport, char **steps)
{
    uint8_t unit = 1;
    for (; *steps != NULL; steps++) {
        step_t step;
        if (!step_parse(&step, *steps)) return false;
        if (step.kind == STEP_UNIT)
            unit = (uint8_t)step.first;
        else if (!run(transport, &step, unit))
            return false;
    }
    return true;
}

/* ---- transports ---- */

static bool open_posix(transport_t *transport, const char *path, uint32_t baud, bool has_parity)
{
    static fathom_posix_uart_t port;
    static fathom_uart_t uart;
    static fathom_clock_t clock;
    static uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
    static fathom_line_t line;
    static fathom_line_parts_t parts; /* which the line keeps */
    const fathom_line_settings_t settings = {baud, has_parity ? FATHOM_PARITY_EVEN : FATHOM_PARITY_NONE, 1};
    if (fathom_posix_open(&port, path, &settings) != FATHOM_POSIX_OK) {
        (void)fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
        return false;
    }
    uart = fathom_posix_uart(&port);
    clock = fathom_posix_clock();
    parts = (fathom_line_parts_t){
        .uart = &uart,
        .clock = &clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .find_echo = fathom_line_find_echo,
        .marks = fathom_line_marks,
        .silence_us = FATHOM_T3_5_US(baud, has_parity ? BITS_OF_8E1 : BITS_OF_8N1),
        .gap_us = BEHIND_AN_OS_US,
    };
    if (fathom_line_init(&line, &parts) != FATHOM_OK) return false;
    transport->modbus = fathom_modbus_client_with_zero(&line);
    transport->wait = fathom_posix_wait;
    transport->port = &port;
    return true;
}

static modbus_t *make(char *path, uint32_t baud, bool has_parity)
{
    if (strncmp(path, "tcp:", 4) != 0) return modbus_new_rtu(path, (int)baud, has_parity ? 'E' : 'N', 8, 1);
    char *const colon = strrchr(path, ':');
    if (colon < path + 4) return NULL;
    *colon = '\0';
    return modbus_new_tcp(path + 4, (int)strtol(colon + 1, NULL, 10));
}

static bool open_libmodbus(transport_t *transport, char *path, uint32_t baud, bool has_parity)
{
    static fathom_libmodbus_t port;
    static fathom_clock_t clock;
    modbus_t *const modbus = make(path, baud, has_parity);
    if (modbus == NULL || modbus_connect(modbus) != 0) {
        (void)fprintf(stderr, "%s: %s\n", path, modbus_strerror(errno));
        modbus_free(modbus);
        return false;
    }
    clock = fathom_posix_clock();
    const fathom_libmodbus_config_t config = {
        .clock = &clock,
        .silence_us = FATHOM_T3_5_US(baud, has_parity ? BITS_OF_8E1 : BITS_OF_8N1),
    };
    if (fathom_libmodbus_init(&port, modbus, &config) != FATHOM_OK) return false;
    transport->modbus = port.modbus;
    transport->wait = fathom_libmodbus_wait;
    transport->port = &port;
    return true;
}

int main(int argc, char **argv)
{
    if (argc < 7) return 2;
    const uint32_t baud = (uint32_t)strtoul(argv[3], NULL, 10);
    const bool has_parity = argv[4][0] == 'e';
    transport_t transport = {.timeout_us = (uint32_t)strtoul(argv[5], NULL, 10) * 1000u};
    const bool is_open = strcmp(argv[1], "posix") == 0
                             ? open_posix(&transport, argv[2], baud, has_parity)
                             : open_libmodbus(&transport, argv[2], baud, has_parity);
    if (!is_open) return 1;
    return run_all(&transport, argv + 6) ? 0 : 2; /* the system closes the port */
}
