/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "commands/request/request.h"
#include "fathom/codec/crc16.h"

static const origin_t origin = {.command = "request"};

enum { MAX_BYTES = 251, MAX_FUNCTION = 127 };

uint16_t request_word(const request_t *request, size_t at) { return decode_get16(request->frame + at); }

bool request_is_read(const request_t *request)
{
    return request->frame[REQUEST_FUNCTION] <= REQUEST_READ_INPUT;
}

bool request_is_broadcast(const request_t *request)
{
    return request->frame[REQUEST_UNIT] == FATHOM_MODBUS_BROADCAST && !request_is_read(request);
}

static void put(request_t *request, long byte) { request->frame[request->length++] = (uint8_t)byte; }

static void put16(request_t *request, long word)
{
    put(request, word >> 8 & 0xFF);
    put(request, word & 0xFF);
}

/* Reads a number in decimal, or in hex behind 0x. */
static bool read_number(const char *name, const char *text, long min, long max, long *number)
{
    const bool is_hex = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    const char *const digits = text + (is_hex ? 2 : text[0] == '-');
    char *end = NULL;
    *number = strtol(is_hex ? digits : text, &end, is_hex ? 16 : 10);
    if (isxdigit((unsigned char)digits[0]) && *end == '\0' && *number >= min && *number <= max) return true;
    return reject(&origin, "%s is from %ld to %ld, in decimal or as 0x in hex, not '%s'.", name, min, max,
                  text);
}

/* Adds a register, and the count of a read or the values of a write. */
static bool add_registers(request_t *request, char **words, int count)
{
    const uint8_t function = request->frame[REQUEST_FUNCTION];
    const bool is_read = request_is_read(request);
    const bool is_many = function == REQUEST_WRITE_MANY;
    const int values = count - 1;
    long first = 0;
    long registers = is_many ? values : 1;
    if (count == 0) return reject(&origin, "the register is missing, such as 0x0101.");
    if (!read_number("REGISTER", words[0], 0, UINT16_MAX, &first)) return false;
    if (is_read && count > 2)
        return reject(&origin, "a read has a register and a count; '%s' is too much.", words[2]);
    if (is_read && count == 2 && !read_number("COUNT", words[1], 1, FATHOM_MODBUS_MAX_READ, &registers))
        return false;
    if (function == REQUEST_WRITE && values != 1)
        return reject(&origin, "function 6 writes one value, not %d. Function 16 writes several.", values);
    if (is_many && (values < 1 || values > FATHOM_MODBUS_MAX_WRITE))
        return reject(&origin, "function 16 writes 1 to %d values, not %d.", FATHOM_MODBUS_MAX_WRITE, values);
    if (first + registers > UINT16_MAX + 1L)
        return reject(&origin, "%ld registers from %s on go beyond 0xFFFF.", registers, words[0]);
    put16(request, first);
    if (is_read || is_many) put16(request, registers);
    if (is_many) put(request, 2L * values);
    for (int i = 1; i != count && !is_read; i++) {
        long value = 0;
        if (!read_number("VALUE", words[i], INT16_MIN, UINT16_MAX, &value)) return false;
        put16(request, value);
    }
    return true;
}

/* Adds the bytes of another function. */
static bool add_bytes(request_t *request, char **words, int count)
{
    if (count > MAX_BYTES)
        return reject(&origin, "a request has at most %d bytes behind its function, not %d.", MAX_BYTES,
                      count);
    for (int i = 0; i != count; i++) {
        const char *const digits = words[i] + (strncmp(words[i], "0x", 2) == 0 ? 2 : 0);
        const size_t length = strlen(digits);
        if (length < 1 || length > 2 || strspn(digits, "0123456789abcdefABCDEF") != length)
            return reject(&origin, "function %u takes bytes in hex, such as 0e, not '%s'.",
                          request->frame[REQUEST_FUNCTION], words[i]);
        put(request, strtol(digits, NULL, 16));
    }
    return true;
}

bool request_words(request_t *request, char **words, int count)
{
    long unit = 0;
    long function = 0;
    if (count == 0)
        return reject(&origin, "the unit is missing. Write it and then the function, such as: 1 3 0x0101.");
    if (count == 1)
        return reject(&origin, "the function is missing. It is 3, 4, 6, 16, or another one and its bytes.");
    if (!read_number("UNIT", words[0], 0, UINT8_MAX, &unit) ||
        !read_number("FUNCTION", words[1], 1, MAX_FUNCTION, &function))
        return false;
    put(request, unit);
    put(request, function);
    const bool has_registers = function == REQUEST_READ || function == REQUEST_READ_INPUT ||
                               function == REQUEST_WRITE || function == REQUEST_WRITE_MANY;
    if (!(has_registers ? add_registers : add_bytes)(request, words + 2, count - 2)) return false;
    const uint16_t crc = fathom_crc16(request->frame, request->length);
    put(request, crc & 0xFF);
    put(request, crc >> 8);
    return true;
}
