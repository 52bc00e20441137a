/* SPDX-License-Identifier: MIT */
/*
 * A Modbus RTU server by libmodbus, or a Modbus TCP server of one connection after another:
 *
 *     libmodbus_server PORT BAUD none|even UNIT FIRST VALUE ...
 *     libmodbus_server tcp BAUD none|even UNIT FIRST VALUE ...
 *
 * Says "ready" when the port is open, over TCP "ready N" with a port N that the system has chosen on the
 * loopback interface; there it answers for every unit, as libmodbus does. Registers below FIRST or past the
 * last value are exception 02. A value "!N" is a register whose reading and writing are exception N.
 */
#include <errno.h>
#include <modbus.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

enum { WRITE_SINGLE = 0x06, MAX_REGISTERS = 256 };

typedef struct {
    int first, count;
    uint8_t exceptions[MAX_REGISTERS]; /* 0: none */
} refusals_t;

/* The exception of the first register that the request touches and that has one. */
static int refusal(const refusals_t *refusals, const uint8_t *pdu)
{
    const int address = pdu[1] * 256 + pdu[2];
    const int count = pdu[0] == WRITE_SINGLE ? 1 : pdu[3] * 256 + pdu[4];
    for (int i = 0; i != refusals->count; i++) {
        const int at = refusals->first + i;
        if (at >= address && at < address + count && refusals->exceptions[i] != 0)
            return refusals->exceptions[i];
    }
    return 0;
}

static void serve(modbus_t *server, modbus_mapping_t *mapping, const refusals_t *refusals)
{
    uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
    for (;;) {
        const int length = modbus_receive(server, request);
        if (length < 0 && (errno == EIO || errno == ECONNRESET)) return;
        if (length <= 0) continue; /* another unit's, or damaged */
        const int exception = refusal(refusals, request + modbus_get_header_length(server));
        if (exception != 0)
            (void)modbus_reply_exception(server, request, (unsigned)exception);
        else
            (void)modbus_reply(server, request, length, mapping);
    }
}

static void serve_all(modbus_t *server, modbus_mapping_t *mapping, const refusals_t *refusals, int listening)
{
    while (modbus_tcp_accept(server, &listening) >= 0) {
        serve(server, mapping, refusals);
        modbus_close(server);
    }
}

static int port_of(int listening)
{
    struct sockaddr_in address;
    socklen_t length = sizeof address;
    return getsockname(listening, (struct sockaddr *)&address, &length) == 0 ? ntohs(address.sin_port) : 0;
}

int main(int argc, char **argv)
{
    static refusals_t refusals;
    if (argc < 7 || argc - 6 > MAX_REGISTERS) return 2;
    refusals.first = (int)strtol(argv[5], NULL, 0);
    refusals.count = argc - 6;
    const bool is_tcp = strcmp(argv[1], "tcp") == 0;
    modbus_t *const server =
        is_tcp ? modbus_new_tcp("127.0.0.1", 0)
               : modbus_new_rtu(argv[1], (int)strtol(argv[2], NULL, 10), argv[3][0] == 'e' ? 'E' : 'N', 8, 1);
    modbus_mapping_t *const mapping = modbus_mapping_new_start_address(0, 0, 0, 0, (unsigned)refusals.first,
                                                                       (unsigned)refusals.count, 0, 0);
    if (server == NULL || mapping == NULL) return 1;
    for (int i = 0; i != refusals.count; i++) {
        const char *const value = argv[i + 6];
        if (value[0] == '!')
            refusals.exceptions[i] = (uint8_t)strtol(value + 1, NULL, 0);
        else
            mapping->tab_registers[i] = (uint16_t)strtol(value, NULL, 0);
    }
    int listening = -1;
    if (is_tcp) listening = modbus_tcp_listen(server, 1);
    if (modbus_set_slave(server, (int)strtol(argv[4], NULL, 10)) != 0 ||
        (is_tcp ? listening < 0 : modbus_connect(server) != 0)) {
        (void)fprintf(stderr, "%s: %s\n", argv[1], modbus_strerror(errno));
        return 1;
    }
    if (is_tcp)
        (void)printf("ready %d\n", port_of(listening));
    else
        (void)puts("ready");
    (void)fflush(stdout);
    if (is_tcp)
        serve_all(server, mapping, &refusals, listening);
    else
        serve(server, mapping, &refusals);
    return 1;
}
