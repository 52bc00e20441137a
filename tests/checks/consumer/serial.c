/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom_serial.h"

/* The header for ports to microcontrollers is there: a byte goes through its ring. */
int main(void)
{
    static fathom_serial_t serial;
    uint8_t request[8], byte = 0;
    fathom_rx_t rx = {0, 0};
    fathom_serial_init(&serial, request, sizeof request);
    fathom_serial_put(&serial, 0x55, 0);
    const int count = fathom_serial_read(&serial, &byte, 1, &rx);
    printf("%d byte, %02X\n", count, (unsigned)byte);
    return 0;
}
