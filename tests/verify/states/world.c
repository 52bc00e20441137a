/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <string.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_55aa.h"

options_t options = {.transactions = 15,
                     .retries = {0, 1, 0, 0},
                     .timeout = {3, 3},
                     .silence = 2,
                     .gap = 2,
                     .leave = 1,
                     .poll = 1,
                     .busy = 6,
                     .watched = TRANSACTIONS};
world_t world;
effect_t effect;
fault_t fault;

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx, (void)rx;
    if (fault == READ_FAILS) return -1;
    const size_t length = world.rx_length < capacity ? world.rx_length : capacity;
    memcpy(bytes, world.rx, length);
    world.rx_length = (uint8_t)(world.rx_length - length);
    memmove(world.rx, world.rx + length, world.rx_length);
    return (int)length;
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx, (void)bytes;
    effect.asked_port = true;
    if (fault == WRITE_FAILS) return -1;
    if (fault == WRITE_BUSY || fault == STAYS || (world.leaving != 0 && !options.takes)) return 0;
    effect.sent = (int)((const fathom_modbus_request_t *)world.line.head - world.requests);
    return (int)length;
}

static bool port_sent(void *ctx)
{
    (void)ctx;
    return world.leaving == 0;
}

static int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    (void)ctx, (void)settings;
    effect.set_port = true;
    if (fault == SET_FAILS) return -1;
    return fault != SET_BUSY && world.leaving == 0;
}

static uint32_t port_leaves_in_us(void *ctx)
{
    (void)ctx;
    return world.leaving * (uint32_t)TICK_US;
}

static uint32_t clock_now_us(void *ctx)
{
    (void)ctx;
    return world.now_us;
}

static void count(fathom_line_t *line, uint8_t which, uint8_t by)
{
    (void)line;
    effect.counted[which] = (uint8_t)(effect.counted[which] + by);
}

static void receive(fathom_listener_t *listener, const uint8_t *bytes, uint8_t length, bool after_gap,
                    uint32_t time_us)
{
    (void)listener, (void)bytes, (void)after_gap, (void)time_us;
    effect.heard += length;
}

static const fathom_uart_t uart = {.read = port_read,
                                   .write = port_write,
                                   .sent = port_sent,
                                   .set_line = port_set_line,
                                   .leaves_in_us = port_leaves_in_us};
static const fathom_clock_t line_clock = {.now_us = clock_now_us};
static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_NONE,
                                                1}; /* a slower rate needs 40 ticks */
static fathom_line_parts_t config;
static uint16_t counters[FATHOM_LINE_COUNTERS]; /* required beside `count`, which does without */
static fathom_listener_t listener = {.receive = receive};

void world_begin(void)
{
    config.uart = &uart;
    config.clock = &line_clock;
    config.frame = world.frame;
    config.frame_size = FRAME;
    config.echo = options.echo == 2   ? FATHOM_LINE_ECHO_AUTO
                  : options.echo == 1 ? FATHOM_LINE_ECHO_ON
                                      : FATHOM_LINE_ECHO_OFF;
    config.silence_us = (uint16_t)(options.silence * TICK_US);
    config.gap_us = (uint16_t)(options.gap * TICK_US);
    config.count = count;
    config.counters = counters;
    config.busy_us = (uint32_t)options.busy * TICK_US;
    config.senders = options.senders ? &fathom_line_senders : NULL;
    config.masters = options.masters ? &fathom_line_masters : NULL;
    if (options.echo == 2) config.find_echo = fathom_line_find_echo;
    memset(&world, 0, sizeof world);
    world.now_us = UINT32_MAX; /* the next tick is over the wrap */
    if (fathom_line_init(&world.line, &config) != FATHOM_OK) fprintf(stderr, "no line\n");
    if (options.stream) {
        listener.gap_us = (uint16_t)((options.gap + 1) * TICK_US);
        (void)fathom_line_replace_listener(&world.line, &listener);
    }
    memset(world.requests, 0xA5, sizeof world.requests);
    memset(world.values, 0xA5, sizeof world.values);
    world.due = NEVER;
}

bool is_queued(int transaction)
{
    return fathom_line_is_queued(&world.line, &world.requests[transaction].transaction);
}

bool was_queued(int transaction)
{
    for (int i = 0; i != TRANSACTIONS; i++)
        if (effect.queue[i] == transaction) return true;
    return false;
}

/* Both of a unit ask for the same, so that a response to one has the shape of a response to the other. */
void fill_in(int transaction)
{
    fathom_modbus_request_t *const request = &world.requests[transaction];
    memset(request, 0, sizeof *request);
    world.values[transaction] = 0xDEAD;
    request->transaction.timeout_us = (uint32_t)timeout_of(transaction) * TICK_US;
    request->transaction.retries = (uint8_t)options.retries[transaction];
    if (options.set_line) request->transaction.line_settings = &settings;
    fathom_modbus_read_holding_registers(&request->message, address_of(transaction), 0x0106, 1,
                                         &world.values[transaction]);
}

fathom_status_t world_submit(int transaction)
{
    fill_in(transaction);
    return options.dyp ? fathom_dyp_client_submit(&world.line, &world.requests[transaction])
                       : fathom_modbus_client_submit(&world.line, &world.requests[transaction]);
}

void put(const uint8_t *bytes, uint8_t length)
{
    memcpy(world.rx + world.rx_length, bytes, length);
    world.rx_length = (uint8_t)(world.rx_length + length);
    world.is_news = 1;
    world.quiet = 0;
}

uint8_t response(int ticket, uint8_t *bytes)
{
    const uint8_t address = address_of(world.tickets[ticket].transaction);
    const uint16_t value = (uint16_t)(0x0700 + ticket);
    if (options.dyp) return fathom_dyp_55aa_encode_response(bytes, address, FATHOM_DYP_FIRST_PROBE, &value);
    fathom_modbus_message_t message;
    uint16_t copy = value;
    fathom_modbus_read_holding_registers(&message, address, 0x0106, 1, &copy);
    return fathom_modbus_rtu_encode_response(&message, bytes);
}
