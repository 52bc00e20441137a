/* SPDX-License-Identifier: MIT */
#include "commands/request/request_options.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/complete.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "output/words.h"

static const origin_t origin = {.command = "request"};

/* As long as a broadcast gives the units (MODBUS over Serial Line V1.02, 2.4.1: 100 to 200 ms). */
enum { TURNAROUND_US = 200000, TIMEOUT_US = 1000000 };
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

static bool take(const char *name, const char *text, uint32_t min, uint32_t max, uint32_t *number)
{
    if (parse(text, min, max, number)) return true;
    (void)reject(&origin, "%s is from %" PRIu32 " to %" PRIu32 ", in decimal or as 0x in hex, not '%s'.",
                 name, min, max, text);
    return false;
}

/* A negative one is on the wire in two's complement. */
static bool take_value(const char *text, uint32_t *value)
{
    uint32_t size = 0;
    if (text[0] == '-' && number_parse(text + 1, 1, -INT16_MIN, &size)) {
        *value = UINT16_MAX + 1u - size;
        return true;
    }
    if (parse(text, 0, UINT16_MAX, value)) return true;
    (void)reject(&origin, "VALUE is from -32768 to 65535, in decimal or as 0x in hex, not '%s'.", text);
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
        (void)reject(&origin, "which register? such as 0x0101.");
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
        (void)reject(&origin, "a read takes a register and how many; '%s' is too much.", words[2]);
        return false;
    }
    if (count == 2 && !take("COUNT", words[1], 1, FATHOM_MODBUS_MAX_READ, &registers)) return false;
    if (first + registers > UINT16_MAX + 1u) {
        (void)reject(&origin, "%" PRIu32 " registers from %s on go beyond 0xFFFF.", registers, words[0]);
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
    (void)reject(&origin, "function 6 writes one value (several: function 16), not %d.", count - 1);
    return false;
}

static bool take_write_many(request_t *request, char **words, int count)
{
    uint32_t first = 0;
    const int values = count - 1;
    if (!take_first(request, words, count, &first)) return false;
    if (values < 1 || values > FATHOM_MODBUS_MAX_WRITE || first + (uint32_t)values > UINT16_MAX + 1u) {
        (void)reject(&origin, "function 16 writes 1 to 123 values, up to register 0xFFFF; not %d from %s on.",
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
        (void)reject(&origin, "a request has %d bytes behind its function at most, not %d.", MAX_BYTES,
                     count);
        return false;
    }
    for (int i = 0; i != count; i++) {
        const char *const digits = words[i] + (strncmp(words[i], "0x", 2) == 0 ? 2 : 0);
        const size_t length = strlen(digits);
        if (length < 1 || length > 2 || strspn(digits, "0123456789abcdefABCDEF") != length) {
            (void)reject(&origin, "function %u takes bytes in hex, such as 0e, not '%s'.",
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
        (void)reject(&origin, "the %s",
                     count == 0 ? "unit is missing. Write it and then the function, such as: 1 3 0x0101."
                                : "function is missing. It is 3, 4, 6, 16, or another one and its bytes.");
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

/* The options before the frame is known. */
typedef struct {
    sensor_defaults_t line;
    const char *sensor; /* NULL: not given */
    uint32_t timeout_us;
    bool is_json;
    bool is_confirmed;
} request_settings_t;

static const option_t rows[] = {
    {"sensor", "MODEL", "Use the line settings of MODEL, and decode the response for it", KIND_TEXT,
     GROUP_COMMAND, AT(request_settings_t, sensor), .list = model_name},
    {"timeout", "MS", "Wait at most MS for the response (default 1000)", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 600000, .scale = 1000, AT(request_settings_t, timeout_us)},
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(request_settings_t, is_json)},
    {"yes", .help = "Do not ask before a request that can change something", .group = GROUP_COMMAND,
     AT(request_settings_t, is_confirmed)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {port_rows, 0}, {NULL, 0}};

static bool set_line(request_t *request, const request_settings_t *settings)
{
    port_options_t port = {.path = settings->line.path, .keys = settings->line.keys};
    request->line = (fathom_line_settings_t){9600, FATHOM_PARITY_NONE, 1};
    if (settings->sensor != NULL) {
        request->model = model_word(settings->sensor, &origin);
        if (request->model == NULL) return false;
        request->line = request->model->line;
    }
    if (port.path == NULL)
        return reject(&origin,
                      "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
    port_options_take(&port, &port.keys);
    port_options_line(&port, &port.keys, &request->line);
    request->echo = port.echo;
    request->rs485 = settings->line.rs485;
    request->path = port.path;
    return true;
}

bool request_options(request_t *request, const arguments_t *arguments)
{
    const request_settings_t *const settings = arguments->settings;
    const uint32_t timeout_us = settings->timeout_us != 0 ? settings->timeout_us : TIMEOUT_US;
    memset(request, 0, sizeof *request);
    if (!take_frame(request, arguments->words, arguments->count) || !set_line(request, settings))
        return false;
    request->timeout_us = request_is_broadcast(request) ? TURNAROUND_US : timeout_us;
    request->is_json = settings->is_json;
    request->is_confirmed = settings->is_confirmed;
    return true;
}

const command_t request_command = {
    .name = "request",
    .summary = "Send one Modbus request and print the response",
    .usage = "UNIT 3 REGISTER [COUNT] [OPTIONS]\n"
             "UNIT 6 REGISTER VALUE [OPTIONS]\n"
             "UNIT 16 REGISTER VALUE... [OPTIONS]\n"
             "UNIT FUNCTION [BYTE...] [OPTIONS]",
    .about = "Numbers are decimal, or hex behind 0x; BYTE is hex. REGISTER is the address on\n"
             "the wire, as the datasheets print it (0x0101). VALUE may be negative. The CRC\n"
             "is added. Nothing is repeated. Unit 0 is all units, which do not respond.\n"
             "What can change something is printed first, and must be confirmed: writes,\n"
             "functions other than 1 to 4, units 0 and 255, and reads of 0x0009, which\n"
             "reset an hps167s. Any request stops the automatic output of an A16 or A05.\n",
    .tables = tables,
    .common = "port sensor yes timeout format",
    .examples = "  fathom request 1 3 0x0101 --port /dev/ttyUSB0 --sensor a16\n"
                "  fathom request 7 3 0x0008 4 --port /dev/ttyUSB0 --sensor hps167s\n"
                "  fathom request 1 6 0x0206 2000 --port /dev/ttyUSB0 --yes\n"
                "  fathom request 1 0x2b 0e 01 00 --port /dev/ttyUSB0 --yes\n",
    .status = "Exit status: 0 a response or an echo, or sent to all units; 1 no or a damaged\n"
              "response, or an exception; 2 wrong usage, or not confirmed.\n",
    .topics = "ports",
    .settings_size = sizeof(request_settings_t),
    .start = request_start,
};
