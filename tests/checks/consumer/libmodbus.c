/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "fathom_libmodbus.h"

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return 0;
}

/* The port over libmodbus is installed: its header and libmodbus's are found, and both are linked. */
int main(void)
{
    static fathom_libmodbus_t port;
    const fathom_clock_t clock = {now_us, NULL};
    const fathom_libmodbus_config_t config = {.clock = &clock};
    modbus_t *const modbus = modbus_new_tcp("127.0.0.1", 502);
    const fathom_status_t status = fathom_libmodbus_init(&port, modbus, &config);
    modbus_free(modbus);
    printf("over libmodbus it %s\n", status == FATHOM_OK ? "works" : "fails");
    return 0;
}
