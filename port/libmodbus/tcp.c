/* SPDX-License-Identifier: MIT */
/*
 * The UART functions of the HAL on a modbus_t of TCP. They convert the RTU frames of the line to TCP frames and back,
 * and match responses by their transaction identifier.
 */
#define _DEFAULT_SOURCE 1 /* SO_COOKIE */
#include <string.h>
#include <sys/socket.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "internal/libmodbus_port.h"

/*
 * Both frames contain a unit and a PDU. RTU has a CRC behind them. TCP has a header before them: transaction, protocol
 * (0), and the number of bytes that follow (MODBUS Messaging on TCP/IP V1.0b, 3.1.3).
 */
enum {
    TRANSACTION = 0,
    PROTOCOL = 2,
    LENGTH = 4,
    UNIT = 6, /* the length in the header counts from here */
    FUNCTION = 7,
    EXCEPTION = 8,
    CRC_LENGTH = 2,
    LEAST_LENGTH = 2, /* unit and function */
    MOST_LENGTH = 254,
    EXCEPTION_LENGTH = 3,
    GATEWAY_PATH_UNAVAILABLE = 0x0A,
    GATEWAY_TARGET_SILENT = 0x0B,
    MAX_DROPPED = 16, /* frames in one call */
    MOST_SENT = 0x8000
};

static uint16_t word_at(const uint8_t *bytes) { return (uint16_t)(bytes[0] << 8 | bytes[1]); }

static void put_word(uint8_t *bytes, uint16_t word)
{
    bytes[0] = (uint8_t)(word >> 8);
    bytes[1] = (uint8_t)(word & 0xFF);
}

static void count(uint16_t *counter)
{
    if (*counter != UINT16_MAX) (*counter)++;
}

/* Shuts the connection down, because requests and responses no longer match. */
static int out_of_step(fathom_libmodbus_t *port, fathom_libmodbus_error_t error)
{
    (void)shutdown(modbus_get_socket(port->handle), SHUT_RDWR);
    return fathom_libmodbus_broken(port, error);
}

/* Returns a number that distinguishes two connections with the same descriptor, or 0 if the system cannot. */
static uint64_t connection_of(int fd)
{
    uint64_t number = 0;
    socklen_t size = sizeof number;
    return getsockopt(fd, SOL_SOCKET, SO_COOKIE, &number, &size) == 0 ? number : 0;
}

/* Sets the number of bytes from which poll(2) reports them. Otherwise a loop that waits for the rest of a response
 * would never sleep. */
static void wake_at(int fd, int bytes)
{
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVLOWAT, &bytes, sizeof bytes);
}

/*
 * Returns the length of the next response as far as its beginning shows it, or 0 if it is none. The beginning is taken
 * out of the socket: there it could hold the memory for the following bytes, and the far end would learn of no free
 * space.
 */
static int needed(const fathom_libmodbus_t *port)
{
    if (port->have < UNIT) return UNIT;
    const uint16_t length = word_at(port->adu + LENGTH);
    if (word_at(port->adu + PROTOCOL) != 0 || length < LEAST_LENGTH || length > MOST_LENGTH) return 0;
    return UNIT + length;
}

/* Takes the next response out of the socket. Returns 1; 0 if it has not arrived completely; -1 if the connection is
 * broken. Bytes that are no response stay in adu while the connection exists, so that nothing behind them is read. */
static int take(fathom_libmodbus_t *port)
{
    const int fd = modbus_get_socket(port->handle);
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    if (port->have != 0 && port->connection != connection_of(fd)) port->have = 0;
    int need = needed(port);
    while (port->have != need) {
        if (need == 0) return out_of_step(port, FATHOM_LIBMODBUS_ERR_NONSENSE);
        const ssize_t n = recv(fd, port->adu + port->have, (size_t)(need - port->have), MSG_DONTWAIT);
        if (n == 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_HUNG_UP);
        if (n < 0) {
            const int failed = fathom_libmodbus_failed(port);
            if (port->have != 0) wake_at(fd, need - port->have);
            return failed;
        }
        if (port->have == 0) port->connection = connection_of(fd);
        port->have = (uint16_t)(port->have + n);
        need = needed(port);
    }
    wake_at(fd, 1);
    port->end = port->have;
    port->have = 0;
    fathom_libmodbus_works(port);
    return 1;
}

/* ---- What a response is ---- */

/* Measures how long the server took for the request `back` requests before the newest. */
static void measure(fathom_libmodbus_t *port, uint16_t back)
{
    const uint16_t transaction = (uint16_t)(port->transaction - back);
    if (back < FATHOM_LIBMODBUS_DATED)
        port->response_us =
            fathom_libmodbus_now_us(port) - port->sent_us[transaction % FATHOM_LIBMODBUS_DATED];
}

/* Returns the bit of the request `back` requests before the newest in `used`; 0: it is too old. */
static uint8_t bit_of(const fathom_libmodbus_t *port, uint16_t back)
{
    if (back >= FATHOM_LIBMODBUS_DATED) return 0;
    return (uint8_t)(1u << (uint16_t)(port->transaction - back) % FATHOM_LIBMODBUS_DATED);
}

/* What a received frame is to the line. */
typedef enum { NOTHING, RESPONSE, FINAL_WORD } word_t;

/* Counts the frame in adu, which has another identifier than the newest request. */
static void count_other(fathom_libmodbus_t *port)
{
    const uint16_t back = (uint16_t)(port->transaction - word_at(port->adu + TRANSACTION));
    if (back < port->sent_count && (port->used & bit_of(port, back)) == 0) {
        count(&port->late_responses);
        measure(port, back);
        fathom_libmodbus_note_response(port, false);
        if ((port->adu[FUNCTION] & FATHOM_MODBUS_EXCEPTION) == 0)
            fathom_libmodbus_note_response_of(port, port->adu[UNIT]);
        port->used |= bit_of(port, back);
    } else {
        /* The server makes up identifiers or repeats them, so this is the response to the newest request. */
        count(&port->foreign_responses);
        fathom_libmodbus_note_response(port, true);
        port->used |= bit_of(port, 0);
    }
}

/* Returns what the frame in adu is, and counts it. */
static word_t judge(fathom_libmodbus_t *port)
{
    const uint8_t *const adu = port->adu;
    if (word_at(adu + TRANSACTION) != port->transaction) {
        count_other(port);
        return NOTHING;
    }
    const bool is_exception =
        word_at(adu + LENGTH) == EXCEPTION_LENGTH && (adu[FUNCTION] & FATHOM_MODBUS_EXCEPTION) != 0;
    const bool is_other = adu[UNIT] != port->unit && port->unit != FATHOM_MODBUS_ANY_UNIT;
    const bool is_gateway = adu[UNIT] == 0 || adu[UNIT] == FATHOM_MODBUS_ANY_UNIT;
    if (port->is_response_pending) measure(port, 0);
    fathom_libmodbus_note_response(port, true);
    port->used |= bit_of(port, 0);
    if (is_other) {
        count(&port->other_units);
        port->other_unit = adu[UNIT];
    }
    if (is_exception && ((is_other && is_gateway) || adu[EXCEPTION] == GATEWAY_PATH_UNAVAILABLE ||
                         adu[EXCEPTION] == GATEWAY_TARGET_SILENT)) {
        port->gateway_exception = adu[EXCEPTION];
        port->gateway_unit = port->unit;
        count(&port->gateway_refusals);
        return FINAL_WORD;
    }
    if (is_other) return FINAL_WORD;
    if (port->unit == port->gateway_unit) port->gateway_exception = 0;
    fathom_libmodbus_note_response_of(port, port->unit);
    return RESPONSE;
}

int fathom_libmodbus_tcp_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    fathom_libmodbus_t *const port = ctx;
    for (uint8_t left = MAX_DROPPED; port->at == port->end; left--) {
        const int taken = left != 0 ? take(port) : 0;
        port->at = port->end;
        if (taken <= 0) return taken;
        const word_t word = judge(port);
        if (word == FINAL_WORD) {
            rx->flags |= FATHOM_RX_NO_RESPONSE;
            bytes[0] = port->adu[UNIT];
            return 1;
        }
        if (word == NOTHING) continue;
        const uint16_t crc = fathom_crc16(port->adu + UNIT, (uint8_t)(port->end - UNIT));
        port->adu[port->end++] = (uint8_t)(crc & 0xFF);
        port->adu[port->end++] = (uint8_t)(crc >> 8);
        port->at = UNIT;
    }
    size_t n = (size_t)port->end - port->at;
    if (n > capacity) n = capacity;
    memcpy(bytes, port->adu + port->at, n);
    port->at = (uint16_t)(port->at + n);
    return (int)n;
}

int fathom_libmodbus_tcp_write(void *ctx, const uint8_t *bytes, size_t length)
{
    fathom_libmodbus_t *const port = ctx;
    const int fd = modbus_get_socket(port->handle);
    const uint16_t transaction = (uint16_t)(port->transaction + 1);
    const uint16_t rest = (uint16_t)(length - CRC_LENGTH);
    uint8_t adu[UNIT + FATHOM_MODBUS_MAX_FRAME];
    if (fd < 0) return fathom_libmodbus_broken(port, FATHOM_LIBMODBUS_ERR_NOT_CONNECTED);
    put_word(adu + TRANSACTION, transaction);
    put_word(adu + PROTOCOL, 0);
    put_word(adu + LENGTH, rest);
    memcpy(adu + UNIT, bytes, rest);
    const ssize_t n = send(fd, adu, (size_t)UNIT + rest, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n < 0) return fathom_libmodbus_failed(port);
    if (n != UNIT + rest) return out_of_step(port, FATHOM_LIBMODBUS_ERR_TRUNCATED);
    port->transaction = transaction;
    port->unit = bytes[0];
    fathom_libmodbus_note_request(port, port->unit);
    port->used &= (uint8_t)~bit_of(port, 0);
    if (port->sent_count < MOST_SENT) port->sent_count++;
    fathom_libmodbus_works(port);
    return (int)length;
}

bool fathom_libmodbus_tcp_sent(void *ctx)
{
    (void)ctx;
    return true;
}
