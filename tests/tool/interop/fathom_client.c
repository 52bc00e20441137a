/* SPDX-License-Identifier: MIT */
/*
 * Fathom's Modbus client on the termios port, for functions that no command of the tool has:
 *
 *     fathom_client PORT BAUD none|even TIMEOUT_MS STEP ...
 *
 * Exit status 0 when every step was tried, 1 when the port does not open, 2 for wrong usage. Whether the line
 * has an echo is found out by a read: a write needs one before it.
 */
#include <stdio.h>
#include <stdlib.h>

#include "fathom/engine/modbus_client.h"
#include "fathom_posix.h"
#include "transport.h"

enum { BITS_OF_8N1 = 10, BITS_OF_8E1 = 11, BEHIND_AN_OS_US = 25000 };

int main(int argc, char **argv)
{
    if (argc < 6) return 2;
    const bool has_parity = argv[3][0] == 'e';
    const fathom_line_settings_t settings = {(uint32_t)strtoul(argv[2], NULL, 10),
                                             has_parity ? FATHOM_PARITY_EVEN : FATHOM_PARITY_NONE, 1};
    static fathom_posix_uart_t port;
    if (fathom_posix_open(&port, argv[1], &settings) != FATHOM_POSIX_OK) {
        (void)fprintf(stderr, "%s\n", fathom_posix_error_text(&port));
        return 1;
    }
    static uint8_t frame[FATHOM_MODBUS_MAX_FRAME];
    const fathom_uart_t uart = fathom_posix_uart(&port);
    const fathom_clock_t clock = fathom_posix_clock();
    const fathom_line_parts_t config = {
        .uart = &uart,
        .clock = &clock,
        .frame = frame,
        .frame_size = sizeof frame,
        .find_echo = fathom_line_find_echo,
        .marks = fathom_line_marks,
        .silence_us = FATHOM_T3_5_US(settings.baud, has_parity ? BITS_OF_8E1 : BITS_OF_8N1),
        .gap_us = BEHIND_AN_OS_US,
    };
    fathom_line_t line;
    bool is_usage = fathom_line_init(&line, &config) == FATHOM_OK;
    const fathom_modbus_t modbus = fathom_modbus_client_with_zero(&line);
    const transport_t transport = {&modbus, fathom_posix_wait, &port,
                                   (uint32_t)strtoul(argv[4], NULL, 10) * 1000u};
    is_usage = is_usage && transport_run(&transport, argv + 5);
    fathom_posix_close(&port);
    return is_usage ? 0 : 2;
}
