/* SPDX-License-Identifier: MIT */
#include "commands/request/request_options.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/sensor_options.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"

static const char command[] = "request";

enum { PORT, SENSOR, BAUD, PARITY, STOP_BITS, TIMEOUT, ECHO, RS485, FORMAT, YES, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [PORT] = {"port", required_argument, NULL, OPTION_ONCE},
    [SENSOR] = {"sensor", required_argument, NULL, 256},
    [BAUD] = {"baud", required_argument, NULL, 256},
    [PARITY] = {"parity", required_argument, NULL, 256},
    [STOP_BITS] = {"stop-bits", required_argument, NULL, 256},
    [TIMEOUT] = {"timeout", required_argument, NULL, 256},
    [ECHO] = {"echo", required_argument, NULL, 256},
    [RS485] = {"rs485", no_argument, NULL, 256},
    [FORMAT] = {"format", required_argument, NULL, 256},
    [YES] = {"yes", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

/* As long as a broadcast gives the units (MODBUS over Serial Line V1.02, 2.4.1: 100 to 200 ms). */
enum { TURNAROUND_US = 200000, TIMEOUT_MS = 1000, MAX_TIMEOUT_MS = 600000 };
enum { MAX_BYTES = 251, MAX_FUNCTION = 127, MAX_WORDS = 300, WORD = 16 };

uint16_t request_word(const request_t *request, size_t at) { return decode_get16(request->frame + at); }

bool request_is_read(const request_t *request)
{
    return request->frame[REQUEST_FUNCTION] <= REQUEST_READ_INPUT;
}

bool request_is_broadcast(const request_t *request)
{
    return request->frame[REQUEST_UNIT] == FATHOM_MODBUS_BROADCAST && !request_is_read(request);
}

/* ---- words ---- */

/* Decimal, or hex behind 0x. */
static bool parse(const char *text, uint32_t min, uint32_t max, uint32_t *number)
{
    char *end = NULL;
    if (text[0] != '0' || (text[1] != 'x' && text[1] != 'X')) return number_parse(text, min, max, number);
    if (strspn(text + 2, "0123456789abcdefABCDEF") != strlen(text + 2) || text[2] == '\0') return false;
    const unsigned long long value = strtoull(text + 2, &end, 16);
    if (value < min || value > max) return false;
    *number = (uint32_t)value;
    return true;
}

/* As the user has written it: see hide_minus. */
static const char *as_given(const char *text) { return text + (text[0] == ' ' ? 1 : 0); }

static bool take(const char *name, const char *text, uint32_t min, uint32_t max, uint32_t *number)
{
    if (parse(text, min, max, number)) return true;
    (void)usage_error(command, "%s is from %" PRIu32 " to %" PRIu32 ", in decimal or as 0x in hex, not '%s'",
                      name, min, max, as_given(text));
    return false;
}

/* A negative one is on the wire in two's complement. */
static bool take_value(const char *text, uint32_t *value)
{
    const char *const given = as_given(text);
    uint32_t size = 0;
    if (given[0] == '-' && number_parse(given + 1, 1, -INT16_MIN, &size)) {
        *value = UINT16_MAX + 1u - size;
        return true;
    }
    if (parse(text, 0, UINT16_MAX, value)) return true;
    (void)usage_error(command, "VALUE is from -32768 to 65535, in decimal or as 0x in hex, not '%s'", given);
    return false;
}

static void put(request_t *request, uint32_t byte) { request->frame[request->length++] = (uint8_t)byte; }

static void put16(request_t *request, uint32_t word)
{
    put(request, word >> 8);
    put(request, word & 0xFF);
}

static bool take_first(request_t *request, char **words, int count, uint32_t *first)
{
    if (count == 0) {
        (void)usage_error(command, "which register? such as 0x0101");
        return false;
    }
    if (!take("REGISTER", words[0], 0, UINT16_MAX, first)) return false;
    put16(request, *first);
    return true;
}

static bool take_read(request_t *request, char **words, int count)
{
    uint32_t first = 0;
    uint32_t registers = 1;
    if (!take_first(request, words, count, &first)) return false;
    if (count > 2) {
        (void)usage_error(command, "a read takes a register and how many; '%s' is too much", words[2]);
        return false;
    }
    if (count == 2 && !take("COUNT", words[1], 1, FATHOM_MODBUS_MAX_READ, &registers)) return false;
    if (first + registers > UINT16_MAX + 1u) {
        (void)usage_error(command, "%" PRIu32 " registers from %s on go beyond 0xFFFF", registers, words[0]);
        return false;
    }
    put16(request, registers);
    return true;
}

static bool take_values(request_t *request, char **words, int count)
{
    for (int i = 0; i != count; i++) {
        uint32_t value = 0;
        if (!take_value(words[i], &value)) return false;
        put16(request, value);
    }
    return true;
}

static bool take_write(request_t *request, char **words, int count)
{
    uint32_t first = 0;
    if (!take_first(request, words, count, &first)) return false;
    if (count == 2) return take_values(request, words + 1, 1);
    (void)usage_error(command, "function 6 writes one value (several: function 16), not %d", count - 1);
    return false;
}

static bool take_write_many(request_t *request, char **words, int count)
{
    uint32_t first = 0;
    const int values = count - 1;
    if (!take_first(request, words, count, &first)) return false;
    if (values < 1 || values > FATHOM_MODBUS_MAX_WRITE || first + (uint32_t)values > UINT16_MAX + 1u) {
        (void)usage_error(command,
                          "function 16 writes 1 to 123 values, up to register 0xFFFF; not %d from %s on",
                          values, words[0]);
        return false;
    }
    put16(request, (uint32_t)values);
    put(request, 2 * (uint32_t)values);
    return take_values(request, words + 1, values);
}

static bool take_bytes(request_t *request, char **words, int count)
{
    if (count > MAX_BYTES) {
        (void)usage_error(command, "a request has %d bytes behind its function at most, not %d", MAX_BYTES,
                          count);
        return false;
    }
    for (int i = 0; i != count; i++) {
        const char *const digits = words[i] + (strncmp(words[i], "0x", 2) == 0 ? 2 : 0);
        const size_t length = strlen(digits);
        if (length < 1 || length > 2 || strspn(digits, "0123456789abcdefABCDEF") != length) {
            (void)usage_error(command, "function %u takes bytes in hex, such as 0e, not '%s'",
                              request->frame[REQUEST_FUNCTION], words[i]);
            return false;
        }
        put(request, (uint32_t)strtoul(digits, NULL, 16));
    }
    return true;
}

/* UNIT FUNCTION and what belongs to it, and the CRC. */
static bool take_frame(request_t *request, char **words, int count)
{
    uint32_t unit = 0;
    uint32_t function = 0;
    bool is_taken = false;
    if (count < 2) {
        (void)usage_error(command, count == 0 ? "which unit? and then the function, such as: 1 3 0x0101"
                                              : "which function? 3, 4, 6, 16, or another and its bytes");
        return false;
    }
    if (!take("UNIT", words[0], 0, UINT8_MAX, &unit) ||
        !take("FUNCTION", words[1], 1, MAX_FUNCTION, &function))
        return false;
    put(request, unit);
    put(request, function);
    words += 2;
    count -= 2;
    if (function == REQUEST_READ || function == REQUEST_READ_INPUT)
        is_taken = take_read(request, words, count);
    else if (function == REQUEST_WRITE)
        is_taken = take_write(request, words, count);
    else if (function == REQUEST_WRITE_MANY)
        is_taken = take_write_many(request, words, count);
    else
        is_taken = take_bytes(request, words, count);
    if (!is_taken) return false;
    const uint16_t crc = fathom_crc16(request->frame, request->length);
    put(request, crc & 0xFF);
    put(request, crc >> 8);
    return true;
}

/* ---- options ---- */

/* A negative value is no option: a blank before it keeps getopt from it. */
static bool hide_minus(int argc, char **argv, char *copy[MAX_WORDS + 1], char texts[MAX_WORDS][WORD])
{
    if (argc > MAX_WORDS) {
        (void)usage_error(command, "there are too many words");
        return false;
    }
    for (int i = 0; i != argc; i++) {
        copy[i] = argv[i];
        if (argv[i][0] != '-' || argv[i][1] < '0' || argv[i][1] > '9') continue;
        (void)snprintf(texts[i], WORD, " %s", argv[i]);
        copy[i] = texts[i];
    }
    copy[argc] = NULL;
    return true;
}

static bool take_line(request_t *request, const char *const *values)
{
    const char *const given[SENSOR_OPTIONS] = {[OPTION_BAUD] = values[BAUD],
                                               [OPTION_PARITY] = values[PARITY],
                                               [OPTION_STOP_BITS] = values[STOP_BITS],
                                               [OPTION_ECHO] = values[ECHO]};
    sensor_defaults_t defaults = {.path = NULL};
    if (!values_store(port_rows, given, &defaults, command)) return false;
    port_options_t port = {.path = values[PORT], .keys = defaults.keys};
    port.keys.has[KEY_RS485] = values[RS485] != NULL;
    port.keys.value[KEY_RS485] = values[RS485] != NULL;
    if (!option_port(command, port.path)) return false;
    port_options_take(&port, &port.keys);
    port_options_line(&port, &port.keys, &request->line);
    request->echo = port.echo;
    request->rs485 = port.rs485;
    request->path = port.path;
    return true;
}

static bool take_options(request_t *request, const char *const *values)
{
    uint32_t timeout_ms = TIMEOUT_MS;
    request->line = (fathom_line_settings_t){9600, FATHOM_PARITY_NONE, 1};
    if (values[SENSOR] != NULL) {
        const origin_t origin = {.command = command};
        request->model = model_word(values[SENSOR], &origin);
        if (request->model == NULL) return false;
        request->line = request->model->line;
    }
    if (!take_line(request, values) ||
        !option_number(command, "timeout", values[TIMEOUT], 1, MAX_TIMEOUT_MS, &timeout_ms) ||
        !option_json(command, values[FORMAT], &request->is_json))
        return false;
    request->timeout_us = request_is_broadcast(request) ? TURNAROUND_US : timeout_ms * 1000u;
    request->is_meant = values[YES] != NULL;
    return true;
}

bool request_options(request_t *request, int argc, char **argv, bool *wants_help)
{
    const char *values[OPTIONS] = {NULL};
    char *copy[MAX_WORDS + 1];
    char texts[MAX_WORDS][WORD];
    memset(request, 0, sizeof *request);
    if (!hide_minus(argc, argv, copy, texts)) return false;
    const int rest = options_parse(command, argc, copy, table, values);
    if (rest < 0) return false;
    *wants_help = values[HELP] != NULL;
    if (*wants_help) return true;
    return take_frame(request, copy + rest, argc - rest) && take_options(request, values);
}
