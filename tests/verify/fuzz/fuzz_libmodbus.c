/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): syscall */
#include <errno.h>
#include <modbus.h>
#include <sys/select.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "fuzz.h"

/*
 * modbus_rtu.h beside libmodbus 3.1.6, which others wrote: both read the same response to the same request, and the
 * same request, and both serve it. Where they differ, `difference` has the reason; anything else is a finding.
 *
 * libmodbus reads from a descriptor, which is a place in memory here: its calls of select, read and write come to this
 * program, since it is a shared library. Behind the last byte the far end has closed the line, so that nothing waits.
 */
enum { LINE = 1000, MOST = 256, READ = 3, WRITE = 6, WRITE_MANY = 16, VALUES = 125 };

static const uint8_t *come;
static size_t left;
static uint8_t gone[MOST + 8];
static size_t sent;

ssize_t read(int fd, void *bytes, size_t capacity)
{
    if (fd != LINE) return syscall(SYS_read, fd, bytes, capacity);
    const size_t n = left < capacity ? left : capacity;
    memcpy(bytes, come, n);
    come += n;
    left -= n;
    return (ssize_t)n;
}

ssize_t write(int fd, const void *bytes, size_t length)
{
    if (fd != LINE) return syscall(SYS_write, fd, bytes, length);
    PROMISE(length <= sizeof gone, "libmodbus sends a frame");
    memcpy(gone, bytes, length);
    sent = length;
    return (ssize_t)length;
}

int select(int count, fd_set *to_read, fd_set *to_write, fd_set *failed, struct timeval *limit)
{
    return 1; /* the end can be read too */
}

static modbus_t *the_modbus(void)
{
    static modbus_t *modbus;
    if (modbus == NULL) {
        modbus = modbus_new_rtu("/dev/null", 9600, 'N', 8, 1);
        if (modbus == NULL || modbus_set_socket(modbus, LINE) != 0) abort();
        (void)modbus_set_response_timeout(modbus, 0, 1);
    }
    return modbus;
}

/* ---- a response ---- */

typedef enum {
    SAME,
    FROM_UNIT_0, /* "Filter on the unit": libmodbus lets a response of unit 0 pass for any unit's */
    ACKNOWLEDGEMENT, /* libmodbus compares neither address nor value of an acknowledged write of one, and of a write of
                         many the count alone */
    UNKNOWN_EXCEPTION /* libmodbus names the codes 1 to 11 (but 9), and calls the others a bad exception */
} difference_t;

/* What our side made of it, and why libmodbus may have made something else of it. */
static difference_t difference(const fathom_modbus_message_t *asked, const uint8_t *frame,
                               fathom_status_t status)
{
    if (frame[0] == 0 && asked->head[0] != 0) return FROM_UNIT_0;
    if (status == FATHOM_ERR_EXCEPTION && (frame[2] == 0 || frame[2] > 11)) return UNKNOWN_EXCEPTION;
    if (status == FATHOM_ERR_MALFORMED && frame[1] == asked->head[1] && frame[1] != READ)
        return ACKNOWLEDGEMENT;
    return SAME;
}

static int ask_libmodbus(const fathom_modbus_message_t *asked, uint16_t *values)
{
    modbus_t *const modbus = the_modbus();
    const int first = fuzz_word_at(asked->head + 2);
    const int operand = fuzz_word_at(asked->head + 4);
    if (modbus_set_slave(modbus, asked->head[0]) != 0) abort();
    sent = 0;
    if (asked->head[1] == READ) return modbus_read_registers(modbus, first, operand, values);
    if (asked->head[1] == WRITE) return modbus_write_register(modbus, first, (uint16_t)operand);
    return modbus_write_registers(modbus, first, operand, asked->values);
}

/* Of the bytes that have come, the frame at their beginning. */
static fathom_status_t ask_fathom(fathom_modbus_message_t *asked, const uint8_t *bytes, size_t have)
{
    uint8_t length = have != 0 ? fathom_modbus_rtu_response_length(bytes, have < 3 ? (uint8_t)have : 3) : 0;
    if (length == 0 || length > have) return FATHOM_ERR_NO_RESPONSE;
    if (fathom_crc16(bytes, length) != 0) return FATHOM_ERR_CHECKSUM;
    return fathom_modbus_rtu_parse_response(asked, bytes);
}

static void response(uint8_t how)
{
    static const uint8_t functions[] = {READ, WRITE, WRITE_MANY};
    uint16_t ours[VALUES];
    uint16_t theirs[VALUES];
    uint16_t written[VALUES] = {0};
    uint8_t frame[MOST];
    fathom_modbus_message_t asked = {.values = ours};
    asked.head[0] = (uint8_t)(1 + fuzz_byte() % 247);
    asked.head[1] = functions[how / 8 % 3];
    for (int i = 2; i != 6; i++) asked.head[i] = fuzz_byte();
    if (asked.head[1] != WRITE) {
        asked.head[4] = 0;
        asked.head[5] = (uint8_t)(1 + asked.head[5] % (asked.head[1] == READ ? 125 : 123));
    }
    const uint8_t count = asked.head[1] == READ ? asked.head[5] : 0;
    size_t have = fuzz_input.left < MOST - 2 ? fuzz_input.left : MOST - 2;
    memcpy(frame, fuzz_input.at, have);
    if ((how & 2) != 0 && have > 6) memcpy(frame, asked.head, 2); /* from the unit, to the function */
    if ((how & 2) != 0 && have > 6 && count != 0) frame[2] = (uint8_t)(2 * count);
    const uint8_t length = have > 2 ? fathom_modbus_rtu_response_length(frame, 3) : 0;
    if ((how & 4) != 0 && length != 0 && length <= MOST - 2) {
        if (have < length) memset(frame + have, 0, length - have);
        have = length;
        fuzz_seal(frame, have - 2);
    }
    fathom_modbus_message_t parsed = asked;
    memset(theirs, FUZZ_GUARD, sizeof theirs);
    const fathom_status_t status = ask_fathom(&parsed, frame, have);
    come = frame;
    left = have;
    asked.values = written;
    errno = 0;
    const int result = ask_libmodbus(&asked, theirs);
    const int error = errno;
    /* the request is the same, byte for byte */
    uint8_t request[MOST];
    const uint8_t size = fathom_modbus_rtu_encode_request(&asked, request);
    PROMISE(sent == size && memcmp(gone, request, size) == 0, "both write the same request");
    const bool is_ready = result >= 0;
    const difference_t why = status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_CHECKSUM
                                 ? SAME
                                 : difference(&asked, frame, status);
    if (why == SAME) {
        PROMISE(is_ready == (status == FATHOM_OK), "both take the same responses");
        if (status == FATHOM_ERR_EXCEPTION)
            PROMISE(error == MODBUS_ENOBASE + parsed.exception, "both see the same exception");
    } else {
        PROMISE(!is_ready || why == FROM_UNIT_0 || why == ACKNOWLEDGEMENT,
                "a difference that has another reason");
    }
    if (is_ready && status == FATHOM_OK)
        PROMISE(memcmp(ours, theirs, 2u * count) == 0, "both read the same values");
}

/* ---- a request ---- */

static void request(uint8_t how)
{
    static modbus_mapping_t *mapping;
    if (mapping == NULL) {
        mapping = modbus_mapping_new_start_address(0, 0, 0, 0, 0, 65535, 0, 0);
        if (mapping == NULL) abort();
        for (int i = 0; i != 65535; i++) mapping->tab_registers[i] = (uint16_t)(i * 40503u);
    }
    uint8_t frame[MOST];
    uint16_t values[VALUES];
    uint8_t answer[MOST];
    uint8_t taken[MODBUS_RTU_MAX_ADU_LENGTH];
    fathom_modbus_message_t message = {.values = values};
    size_t have = fuzz_input.left < MOST - 2 ? fuzz_input.left : MOST - 2;
    if (have < 8) return;
    memcpy(frame, fuzz_input.at, have);
    if ((how & 2) != 0) frame[1] = (how & 8) != 0 ? READ : (how & 16) != 0 ? WRITE : WRITE_MANY;
    if (frame[0] == 0 || frame[0] > 247 || (frame[1] != READ && frame[1] != WRITE && frame[1] != WRITE_MANY))
        return;
    if ((how & 32) != 0 && frame[1] != WRITE) frame[4] = 0;
    if ((how & 64) != 0 && frame[1] == WRITE_MANY) frame[6] = (uint8_t)(2 * frame[5]);
    const uint8_t length = fathom_modbus_rtu_request_length(frame, 8);
    if (length == 0 || length > have) return;
    have = length;
    if ((how & 4) != 0) fuzz_seal(frame, have - 2);
    const bool is_right = fathom_crc16(frame, length) == 0;
    modbus_t *const modbus = the_modbus();
    if (modbus_set_slave(modbus, frame[0]) != 0) abort();
    come = frame;
    left = have;
    const int result = modbus_receive(modbus, taken);
    PROMISE((result == length) == is_right, "both take the same requests");
    if (!is_right) return;
    const fathom_status_t status = fathom_modbus_rtu_parse_request(&message, frame, VALUES);
    const unsigned first = fuzz_word_at(frame + 2);
    const unsigned count = frame[1] == WRITE ? 1 : fuzz_word_at(frame + 4);
    /* Ours tells no exception for registers that are not there; theirs has 65535 of them, from 0. And libmodbus 3.1.6
     * does not compare the byte count of a write of many with its number of registers: ours refuses that. */
    const bool is_byte_count_wrong = frame[1] == WRITE_MANY && frame[6] != 2 * count;
    if (is_byte_count_wrong) {
        PROMISE(status == FATHOM_ERR_EXCEPTION,
                "modbus_rtu.h: a count that the bytes do not have is refused");
        return;
    }
    if (status == FATHOM_OK && first + count > 65535) return;
    if (status == FATHOM_OK && frame[1] == READ)
        for (unsigned i = 0; i != count; i++) values[i] = mapping->tab_registers[first + i];
    const uint8_t size = fathom_modbus_rtu_encode_response(&message, answer);
    sent = 0;
    (void)modbus_reply(modbus, taken, result, mapping);
    PROMISE(sent == size && memcmp(gone, answer, size) == 0, "both answer with the same bytes");
    if (status == FATHOM_OK && frame[1] == WRITE_MANY)
        PROMISE(memcmp(mapping->tab_registers + first, values, 2u * count) == 0, "both read the same values");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint8_t how = fuzz_byte();
    if ((how & 1) == 0)
        response(how);
    else
        request(how);
    return 0;
}
