/* SPDX-License-Identifier: MIT */
/*
 * A Modbus RTU server by libmodbus, for test_modbus.py:
 *
 *     modbus_server PORT BAUD UNIT FIRST VALUE ...
 *
 * Says "ready" when the port is open. Registers below FIRST or past the last value are exception 02.
 */
#include <errno.h>
#include <modbus.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    uint8_t request[MODBUS_RTU_MAX_ADU_LENGTH];
    if (argc < 6) return 2;
    modbus_t *const server = modbus_new_rtu(argv[1], atoi(argv[2]), 'N', 8, 1);
    modbus_mapping_t *const mapping = modbus_mapping_new_start_address(
        0, 0, 0, 0, (unsigned)strtol(argv[4], NULL, 0), (unsigned)(argc - 5), 0, 0);
    if (server == NULL || mapping == NULL) return 1;
    for (int i = 5; i != argc; i++) mapping->tab_registers[i - 5] = (uint16_t)strtol(argv[i], NULL, 0);
    if (modbus_set_slave(server, atoi(argv[3])) != 0 || modbus_connect(server) != 0) return 1;
    puts("ready");
    fflush(stdout);
    for (;;) {
        const int length = modbus_receive(server, request);
        if (length > 0) (void)modbus_reply(server, request, length, mapping);
        if (length < 0 && errno == EIO) return 1;
    }
}
