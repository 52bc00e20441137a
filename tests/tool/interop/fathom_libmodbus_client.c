/* SPDX-License-Identifier: MIT */
/*
 * The library's Modbus transport over libmodbus, as fathom_client is over the termios port:
 *
 *     fathom_libmodbus_client PORT BAUD none|even TIMEOUT_MS STEP ...
 *
 * PORT is a terminal, or tcp:HOST:PORT, which has no use for BAUD and parity. Exit status 0 when every step
 * was tried, 1 when the port does not open, 2 for wrong usage.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fathom_libmodbus.h"
#include "fathom_posix.h"
#include "transport.h"

enum { BITS_OF_8N1 = 10, BITS_OF_8E1 = 11 };

static modbus_t *make(char *path, unsigned baud, bool has_parity)
{
    if (strncmp(path, "tcp:", 4) != 0) return modbus_new_rtu(path, (int)baud, has_parity ? 'E' : 'N', 8, 1);
    char *const colon = strrchr(path, ':');
    if (colon < path + 4) return NULL;
    *colon = '\0';
    return modbus_new_tcp(path + 4, (int)strtol(colon + 1, NULL, 10));
}

int main(int argc, char **argv)
{
    if (argc < 6) return 2;
    const unsigned baud = (unsigned)strtoul(argv[2], NULL, 10);
    const bool has_parity = argv[3][0] == 'e';
    modbus_t *const modbus = make(argv[1], baud, has_parity);
    if (modbus == NULL || modbus_connect(modbus) != 0) {
        (void)fprintf(stderr, "%s: %s\n", argv[1], modbus_strerror(errno));
        modbus_free(modbus);
        return 1;
    }
    const fathom_clock_t clock = fathom_posix_clock();
    const fathom_libmodbus_config_t config = {
        .clock = &clock,
        .silence_us = FATHOM_T3_5_US(baud, has_parity ? BITS_OF_8E1 : BITS_OF_8N1),
    };
    static fathom_libmodbus_t port;
    bool is_usage = fathom_libmodbus_init(&port, modbus, &config) == FATHOM_OK;
    const fathom_modbus_t libmodbus = port.modbus;
    const transport_t transport = {&libmodbus, fathom_libmodbus_wait, &port,
                                   (uint32_t)strtoul(argv[4], NULL, 10) * 1000u};
    is_usage = is_usage && transport_run(&transport, argv + 5);
    modbus_close(modbus);
    modbus_free(modbus);
    return is_usage ? 0 : 2;
}
