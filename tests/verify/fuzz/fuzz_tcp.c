/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): POLLRDHUP */
#include <errno.h>
#include <poll.h>
#include <sys/socket.h>

#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/hps167s.h"
#include "fathom_libmodbus.h"
#include "fuzz.h"

/*
 * The port over libmodbus on TCP, whose socket is the input: bytes in any pieces, a server that closes or resets the
 * connection, a system that takes a part of a request or nothing. Beside the port stands a second decoder, of what the
 * server has sent: the line gets what that one gives, and nothing else.
 */
enum { STREAM = 1500, HEADER = 6, MOST_ADU = 260, SENT = 320, CALLS = 40 };

static struct {
    uint32_t now_us;
    uint8_t stream[STREAM]; /* what the server has sent, ... */
    size_t sent;
    size_t taken;   /* ... what the port has taken of it, ... */
    size_t decoded; /* ... and the second decoder */
    bool is_closed, is_reset, is_shut, is_full;
    bool has_refused;      /* a request: after a second of that the port counts as broken (line.h) */
    uint8_t part;          /* of the next request, that the system takes; 0: all */
    uint8_t request[SENT]; /* the last one */
    size_t length;
    unsigned requests;
    uint16_t late, refused;
} far;

static uint32_t now_us(void *ctx) { return far.now_us; }
static const fathom_clock_t clock_of_far = {now_us, NULL};

/* ---- the system's calls, for the descriptor of the port (linked with --wrap) ---- */

ssize_t __wrap_recv(int fd, void *bytes, size_t capacity, int flags)
{
    PROMISE((flags & MSG_DONTWAIT) != 0, "hal.h: no function waits");
    if (far.is_reset) {
        errno = ECONNRESET;
        return -1;
    }
    const size_t there = far.sent - far.taken;
    if (there == 0) {
        if (far.is_closed || far.is_shut) return 0;
        errno = EAGAIN;
        return -1;
    }
    const size_t n = there < capacity ? there : capacity;
    memcpy(bytes, far.stream + far.taken, n);
    if ((flags & MSG_PEEK) == 0) far.taken += n;
    return (ssize_t)n;
}

ssize_t __wrap_send(int fd, const void *bytes, size_t length, int flags)
{
    PROMISE((flags & MSG_DONTWAIT) != 0 && (flags & MSG_NOSIGNAL) != 0, "hal.h: no function waits");
    if (far.is_reset || far.is_shut) {
        errno = EPIPE;
        return -1;
    }
    if (far.is_full) {
        far.is_full = false;
        far.has_refused = true;
        errno = EAGAIN;
        return -1;
    }
    const uint8_t *const adu = bytes;
    PROMISE(length >= HEADER + 2 && length <= MOST_ADU, "MODBUS Messaging 4.1: 260 bytes at most");
    PROMISE(fuzz_word_at(adu + 2) == 0 && fuzz_word_at(adu + 4) == length - HEADER,
            "MODBUS Messaging 3.1.3: the header");
    if (far.requests != 0)
        PROMISE(fuzz_word_at(adu) != fuzz_word_at(far.request),
                "fathom_libmodbus.h: a transaction of its own");
    const size_t part = far.part;
    far.part = 0;
    if (part != 0 && part < length) return (ssize_t)part;
    memcpy(far.request, bytes, length);
    far.length = length;
    far.requests++;
    return (ssize_t)length;
}

int __wrap_poll(struct pollfd *entries, nfds_t count, int timeout)
{
    PROMISE(timeout == 0, "hal.h: no function waits");
    entries->revents = far.is_closed || far.is_reset || far.is_shut ? entries->events : 0;
    return entries->revents != 0;
}

int __wrap_shutdown(int fd, int how)
{
    far.is_shut = true;
    return 0;
}

int __wrap_setsockopt(int fd, int level, int name, const void *value, socklen_t size)
{
    PROMISE(*(const int *)value >= 1 && *(const int *)value <= MOST_ADU,
            "SO_RCVLOWAT: no more than a response has");
    return 0;
}

/* ---- the second decoder ---- */

/* The next response for the line: unit and PDU; NULL: none. length 0: no response will come. What is neither is passed
 * over. */
static const uint8_t *decode(const fathom_libmodbus_t *port, size_t *length, bool *is_nonsense)
{
    *is_nonsense = false;
    while (far.sent - far.decoded >= HEADER) {
        const uint8_t *const adu = far.stream + far.decoded;
        *length = fuzz_word_at(adu + 4);
        *is_nonsense = fuzz_word_at(adu + 2) != 0 || *length < 2 || *length > 254;
        if (*is_nonsense || far.sent - far.decoded < HEADER + *length) return NULL;
        far.decoded += HEADER + *length;
        if (fuzz_word_at(adu) != port->transaction) {
            far.late++;
            continue;
        }
        const bool is_other = adu[6] != far.request[6] && far.request[6] != 255;
        const bool is_gateways =
            (is_other && (adu[6] == 0 || adu[6] == 255)) || adu[8] == 0x0A || adu[8] == 0x0B;
        const bool is_word = *length == 3 && adu[7] >= 0x80 && is_gateways;
        if (is_word) far.refused++;
        if (is_word || is_other) *length = 0;
        return adu + HEADER;
    }
    return NULL;
}

static void give(const uint8_t *bytes, size_t count)
{
    if (far.is_closed || far.is_reset || far.is_shut || far.sent + count > STREAM) return;
    memcpy(far.stream + far.sent, bytes, count);
    far.sent += count;
}

/* What the last request asks for; how: bits. */
static void respond(uint8_t how)
{
    uint8_t adu[MOST_ADU + 4];
    size_t length = 12;
    if (far.requests == 0) return;
    memcpy(adu, far.request, 12);
    if ((how & 1) != 0) {
        adu[7] |= 0x80;
        adu[8] = (how & 2) != 0 ? 0x0A + (how >> 2 & 1) : fuzz_byte();
        length = 9;
    } else if (adu[7] == 3) {
        adu[8] = (uint8_t)(2 * far.request[11]);
        length = 9u + adu[8];
        for (size_t i = 9; i < length; i++) adu[i] = fuzz_byte();
    }
    adu[4] = 0;
    adu[5] = (uint8_t)(length - HEADER);
    if ((how & 8) != 0) adu[fuzz_byte() % length] ^= (uint8_t)(1u << (fuzz_byte() & 7));
    const size_t part = (how & 4) != 0 && (how & 1) == 0 ? fuzz_byte() % length : length;
    give(adu, part);
}

static void happen(uint8_t op)
{
    uint8_t bytes[32];
    const uint8_t high = op >> 3;
    switch (op % 8) {
    case 0:
        for (unsigned i = 0; i <= high; i++) bytes[i] = fuzz_byte();
        give(bytes, high + 1u);
        break;
    case 1:
    case 2:
        respond(op % 8 == 1 ? 0 : high);
        break;
    case 3:
        far.now_us += high * 2000u;
        break;
    case 4:
        far.now_us += fuzz_byte() * 20000u;
        break;
    case 5:
        far.is_full = (high & 1) != 0;
        far.part = (high & 2) != 0 ? fuzz_byte() : 0;
        break;
    default:
        if (high == 31) far.is_closed = true;
        if (high == 30) far.is_reset = true;
        break;
    }
}

/* ---- the HAL under the transport ---- */

static void check_reads(fathom_libmodbus_t *port, const fathom_uart_t *uart)
{
    uint8_t bytes[MOST_ADU];
    fathom_rx_t rx = {0, 0};
    for (int calls = 0; calls != CALLS; calls++) {
        const size_t capacity = 1 + fuzz_byte();
        uint8_t *const memory = fuzz_guarded(capacity);
        size_t have = 0;
        rx = (fathom_rx_t){0, 0};
        int n = uart->read(uart->ctx, memory, capacity, &rx);
        size_t length;
        bool is_nonsense;
        if (n > 0) {
            const uint8_t *const should = decode(port, &length, &is_nonsense);
            PROMISE(should != NULL && port->error == FATHOM_LIBMODBUS_OK,
                    "fathom_libmodbus.h: a response that was sent");
            if (length == 0) {
                PROMISE(n == 1 && rx.flags == FATHOM_RX_NO_RESPONSE, "hal.h: no response will arrive");
                free(memory);
                continue;
            }
            for (;;) { /* never part of a response: the rest is there */
                PROMISE(have + (size_t)n <= length + 2, "fathom_libmodbus.h: one response at a time");
                memcpy(bytes + have, memory, (size_t)n);
                have += (size_t)n;
                if (have == length + 2) break;
                n = uart->read(uart->ctx, memory, capacity, &rx);
                PROMISE(n > 0, "fathom_libmodbus.h: read: never part of a TCP response");
            }
            PROMISE(memcmp(bytes, should, length) == 0 && fuzz_crc(bytes, have) == 0,
                    "fathom_libmodbus.h: unit and PDU of the response, with a CRC");
            free(memory);
            continue;
        }
        free(memory);
        const size_t before = far.decoded;
        const bool is_end = decode(port, &length, &is_nonsense) == NULL;
        if (n == 0) {
            /* 16 that are dropped are enough for one call; the next goes on */
            if (far.taken < far.decoded || !is_end) {
                far.decoded = before;
                break;
            }
            PROMISE(!is_nonsense, "fathom_libmodbus.h: what is no Modbus shuts the connection down");
        } else {
            PROMISE(is_end, "fathom_libmodbus.h: all responses come before the end of the connection");
            PROMISE(fathom_libmodbus_error(port) != FATHOM_LIBMODBUS_OK,
                    "fathom_libmodbus.h: why it is broken");
            PROMISE(far.is_closed || far.is_reset || far.is_shut, "fathom_libmodbus.h: < 0: it is broken");
            if (is_nonsense && !far.is_reset)
                PROMISE(far.is_shut, "fathom_libmodbus.h: shut down where it is out of step");
        }
        break;
    }
    PROMISE(port->late_responses <= far.late && port->gateway_refusals <= far.refused,
            "fathom_libmodbus.h: late_responses, gateway_refusals");
}

static void check_write(const fathom_uart_t *uart)
{
    uint8_t frame[8];
    const unsigned before = far.requests;
    for (int i = 0; i != 6; i++) frame[i] = fuzz_byte();
    frame[1] = 3;
    frame[5] %= 126;
    fuzz_seal(frame, 6);
    const bool is_part = far.part != 0;
    const int n = uart->write(uart->ctx, frame, 8);
    PROMISE(n == 8 || n == 0 || n == -1, "hal.h: write: all, none, or broken");
    PROMISE((n == 8) == (far.requests == before + 1), "hal.h: write: it took all");
    if (n == 8)
        PROMISE(memcmp(far.request + HEADER, frame, 6) == 0 && far.length == 12, "the unit and the PDU");
    if (n < 0 && is_part && !far.is_reset)
        PROMISE(far.is_shut, "fathom_libmodbus.h: shut down where a part of a request was taken");
}

static void play_hal(fathom_libmodbus_t *port)
{
    const fathom_uart_t uart = fathom_libmodbus_uart(port);
    while (fuzz_more()) {
        const uint8_t op = fuzz_byte();
        if (op % 8 == 7)
            check_write(&uart);
        else
            happen(op);
        if (op % 8 != 3) check_reads(port, &uart);
    }
}

/* ---- the transport ---- */

static bool was_sent(uint16_t word)
{
    for (size_t i = 0; i + 1 < far.sent; i++)
        if (fuzz_word_at(far.stream + i) == word) return true;
    return false;
}

static void poll_sensors(const fathom_sensor_t *sensors, bool has_ended[2])
{
    for (int i = 0; i != 2; i++) {
        fathom_sample_t sample;
        fathom_status_t status;
        for (int polls = 0; polls != 5; polls++) {
            memset(&sample, FUZZ_GUARD, sizeof sample);
            status = fathom_poll(&sensors[i], &sample);
            if (status != FATHOM_OK)
                PROMISE(fuzz_is_guard(&sample, sizeof sample), "sensor.h: *sample is untouched");
            if (status == FATHOM_PENDING) break;
            has_ended[i] = true;
            if (status != FATHOM_OK) break;
            PROMISE(was_sent((uint16_t)sample.raw), "a reading that was not sent");
        }
        PROMISE(status <= FATHOM_PENDING && status >= FATHOM_ERR_MALFORMED && status != FATHOM_ERR_ARGUMENT,
                "the errors of fathom_poll");
        if (status == FATHOM_ERR_PORT)
            PROMISE(far.is_closed || far.is_reset || far.is_shut || far.has_refused, "PORT: it is broken");
    }
}

static void play_transport(fathom_libmodbus_t *port, uint8_t how)
{
    const fathom_modbus_t transport = port->modbus;
    fathom_hps167s_t hps;
    fathom_a05_modbus_t a05;
    bool has_ended[2] = {false, false};
    const fathom_hps167s_config_t of_hps = {.modbus = {.retries = how >> 1 & 1}};
    const fathom_a05_modbus_config_t of_a05 = {.modbus = {.address = 2}, .probes = how >> 3};
    PROMISE(fathom_hps167s_init(&hps, &transport, &of_hps) == FATHOM_OK, "hps167s.h: init");
    PROMISE(fathom_a05_modbus_init(&a05, &transport, &of_a05) == FATHOM_OK, "a05_modbus.h: init");
    const fathom_sensor_t sensors[2] = {fathom_hps167s_sensor(&hps), fathom_a05_modbus_sensor(&a05)};
    while (fuzz_more()) {
        const uint8_t op = fuzz_byte();
        const uint32_t due_us = fathom_due_us(sensors, 2);
        if (op % 8 != 7)
            happen(op);
        else if (due_us != FATHOM_NO_DEADLINE)
            far.now_us += due_us;
        poll_sensors(sensors, has_ended);
    }
    has_ended[0] = has_ended[1] = false;
    for (int polls = 0; !has_ended[0] || !has_ended[1]; polls++) {
        const uint32_t due_us = fathom_due_us(sensors, 2);
        PROMISE(polls < 1000 && due_us != FATHOM_NO_DEADLINE, "each attempt ends");
        far.now_us += due_us;
        poll_sensors(sensors, has_ended);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static modbus_t *modbus;
    static fathom_libmodbus_t port;
    const fathom_libmodbus_config_t config = {.clock = &clock_of_far};
    fuzz_begin(data, size);
    if (modbus == NULL) {
        modbus = modbus_new_tcp_pi("::1", "1502");
        if (modbus == NULL || modbus_set_socket(modbus, 1000) != 0) abort();
    }
    far.now_us = 0;
    far.sent = far.taken = far.decoded = 0;
    far.is_closed = far.is_reset = far.is_shut = far.is_full = far.has_refused = false;
    far.part = 0;
    far.requests = 0;
    far.late = far.refused = 0;
    const uint8_t how = fuzz_byte();
    PROMISE(fathom_libmodbus_init(&port, modbus, &config) == FATHOM_OK, "fathom_libmodbus.h: init");
    if ((how & 1) != 0)
        play_transport(&port, how & 0x7F);
    else
        play_hal(&port);
    PROMISE(port.at <= port.end && port.end <= sizeof port.adu,
            "what the line has not read yet lies in the ADU");
    return 0;
}
