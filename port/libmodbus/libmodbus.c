/* SPDX-License-Identifier: MIT */
/*
 * Initialises a port over a modbus_t, and returns its UART. rtu.c and tcp.c have the UART functions.
 *
 * The port never calls modbus_receive_confirmation(). On RTU that function waits for the number of bytes that the first
 * bytes promise, mistakes noise for them, and discards the response of another unit without reporting its address. On
 * TCP it does not check the length in the header, so one response with a wrong length misaligns all that follow.
 * modbus_send_raw_request() is not used on TCP, because it gives every request the transaction 0: a late response would
 * then look like the response that is due.
 */
#define _GNU_SOURCE 1 /* ppoll */
#include "fathom_libmodbus.h"

#include <poll.h>
#include <string.h>
#include <time.h>

#include "fathom/engine/modbus_client.h"
#include "internal/libmodbus_port.h"

enum {
    RTU_HEADER_LENGTH = 1,
    RTU_GAP_US = 25000,
    /* A TCP response is complete, and no silence is needed. These are the smallest values that the line accepts. */
    TCP_GAP_US = 1000,
    TCP_SILENCE_US = 100,
    /* This is far from the first number of libmodbus for requests of the program, so a late response to such a request
     * is not mistaken for a response to a request of this port. */
    FIRST_TRANSACTION = 0xF000,
    HOLD_US = 5000000
};

/* modbus_set_slave() knows which units are allowed. The call changes the unit that the program has set, so that unit is
 * restored. */
static bool takes_unit(modbus_t *modbus, uint8_t unit)
{
    const int before = modbus_get_slave(modbus);
    const bool is_taken = modbus_set_slave(modbus, unit) == 0;
    (void)modbus_set_slave(modbus, before);
    return is_taken;
}

static fathom_status_t submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    const fathom_libmodbus_t *const port = (const fathom_libmodbus_t *)line; /* its first member */
    if (!takes_unit(port->handle, request->message.head[0])) return FATHOM_ERR_UNSUPPORTED;
    return fathom_modbus_client_submit_with_zero(line, request);
}

static uint32_t monotonic_us(void *ctx)
{
    (void)ctx;
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint32_t)((uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u);
}

fathom_status_t fathom_libmodbus_init(fathom_libmodbus_t *port, modbus_t *modbus,
                                      const fathom_libmodbus_config_t *config)
{
    static const fathom_clock_t monotonic = {.now_us = monotonic_us};
    const fathom_libmodbus_config_t defaults = {0};
    if (config == NULL) config = &defaults;
    if (port == NULL || modbus == NULL || config->hold_us > INT32_MAX) return FATHOM_ERR_ARGUMENT;
    memset(port, 0, sizeof *port);
    port->handle = modbus;
    port->is_tcp = modbus_get_header_length(modbus) != RTU_HEADER_LENGTH;
    if (!port->is_tcp && modbus_rtu_get_rts(modbus) != MODBUS_RTU_RTS_NONE) return FATHOM_ERR_UNSUPPORTED;
    (void)modbus_set_error_recovery(modbus, MODBUS_ERROR_RECOVERY_NONE);
    port->transaction = FIRST_TRANSACTION;
    port->hold_us = config->hold_us != 0 ? config->hold_us : HOLD_US;
    port->busy_us = port->hold_us;
    port->uart = fathom_libmodbus_uart(port);
    port->parts.uart = &port->uart;
    port->parts.clock = config->clock != NULL ? config->clock : &monotonic;
    port->parts.frame = port->frame;
    port->parts.frame_size = sizeof port->frame;
    if (port->is_tcp) {
        port->parts.echo = FATHOM_LINE_ECHO_OFF;
        port->parts.silence_us = TCP_SILENCE_US;
        port->parts.gap_us = TCP_GAP_US;
        port->parts.marks = fathom_line_refusals;
    } else {
        port->parts.echo = config->echo;
        port->parts.silence_us = config->silence_us;
        port->parts.gap_us = config->gap_us != 0 ? config->gap_us : RTU_GAP_US;
        port->parts.senders = &fathom_line_senders;
        port->parts.masters = &fathom_line_masters;
    }
    port->parts.find_echo = fathom_line_find_echo;
    port->parts.count = fathom_line_count;
    port->parts.counters = port->counters;
    port->modbus = (fathom_modbus_t){&port->line, submit};
    const fathom_status_t status = fathom_line_init(&port->line, &port->parts);
    if (port->is_tcp) fathom_libmodbus_hold(port, &port->line); /* status is FATHOM_OK: all of it is there */
    return status;
}

fathom_uart_t fathom_libmodbus_uart(fathom_libmodbus_t *port)
{
    const fathom_uart_t rtu = {.read = fathom_libmodbus_rtu_read,
                               .write = fathom_libmodbus_rtu_write,
                               .sent = fathom_libmodbus_rtu_sent,
                               .ctx = port};
    const fathom_uart_t tcp = {.read = fathom_libmodbus_tcp_read,
                               .write = fathom_libmodbus_tcp_write,
                               .sent = fathom_libmodbus_tcp_sent,
                               .ctx = port};
    return port->is_tcp ? tcp : rtu;
}

void fathom_libmodbus_wait(void *port, uint32_t max_us)
{
    modbus_t *const modbus = ((const fathom_libmodbus_t *)port)->handle;
    const struct timespec limit = {(time_t)(max_us / 1000000u), (long)(max_us % 1000000u) * 1000};
    struct pollfd entry = {modbus_get_socket(modbus), POLLIN, 0};
    if (entry.fd < 0) return;
    (void)ppoll(&entry, 1, max_us == FATHOM_NO_DEADLINE ? NULL : &limit, NULL);
}

fathom_status_t fathom_libmodbus_read(fathom_libmodbus_t *port, fathom_sensor_t sensor,
                                      fathom_sample_t *sample)
{
    return fathom_wait(&sensor, sample, fathom_libmodbus_wait, port);
}
