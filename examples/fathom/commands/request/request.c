/* SPDX-License-Identifier: MIT */
#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "diagnosis/advice.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/modbus_rtu.h"
#include "output/record.h"
#include "sensors/decoding.h"

/* Positions in a request, and in the response to a read. */
enum { UNIT = 0, FUNCTION = 1, FIRST = 2, COUNT = 4, SIZE = 2, DATA = 3, CODE = 2 };

enum { READ_COILS = 1, READ = 3, READ_INPUT = 4, WRITE = 6, WRITE_COILS = 15, WRITE_MANY = 16 };

typedef struct {
    sensor_defaults_t port;
    const char *sensor; /* NULL: not given */
    uint32_t timeout_us;
    bool is_json;
    bool is_confirmed;
} settings_t;

/* A request and its response. */
typedef struct {
    fathom_transaction_t transaction; /* first, so that a pointer to it is one to the request_t */
    const model_t *model;             /* NULL: not given */
    fathom_line_settings_t line;
    uint8_t frame[255]; /* with its CRC */
    uint8_t length;
    /* FATHOM_ERR_ECHO: one copy of the request arrived, which is its acknowledgement or the echo of the adapter. */
    fathom_status_t status;
    uint8_t response[255];   /* with its CRC */
    uint8_t response_length; /* 0: there is no response */
    uint32_t more;           /* further bytes that arrived within 60 ms of the response */
    evidence_t evidence;     /* received since the request */
} request_t;

static uint8_t function_of(const request_t *request) { return request->frame[FUNCTION]; }

/* Returns true for functions 1 to 4, which change nothing by the standard. */
static bool is_read(const request_t *request) { return function_of(request) <= READ_INPUT; }

/* Returns true for the functions that read registers. */
static bool reads_registers(const request_t *request)
{
    return function_of(request) == READ || function_of(request) == READ_INPUT;
}

/* Returns true if no unit responds. A read of unit 0 is no broadcast, since an A16 or A05 can have that address. */
static bool is_broadcast(const request_t *request)
{
    return request->frame[UNIT] == FATHOM_MODBUS_BROADCAST && !is_read(request);
}

/* ---- the words ---- */

static void put(request_t *request, long byte) { request->frame[request->length++] = (uint8_t)byte; }

static void put16(request_t *request, long word)
{
    put(request, word >> 8 & 0xFF);
    put(request, word & 0xFF);
}

/* Reads a number in decimal, or in hex behind 0x. */
static bool read_number(const char *name, const char *text, long min, long max, long *number,
                        const origin_t *origin)
{
    const bool is_hex = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    const char *const digits = text + (is_hex ? 2 : text[0] == '-');
    char *end = NULL;
    *number = strtol(is_hex ? digits : text, &end, is_hex ? 16 : 10);
    if (isxdigit((unsigned char)digits[0]) && *end == '\0' && *number >= min && *number <= max) return true;
    return reject(origin, "%s is from %ld to %ld, in decimal or as 0x in hex, not '%s'.", name, min, max,
                  text);
}

/* Adds a register, and the count of a read or the values of a write. */
static bool add_registers(request_t *request, char **words, int count, const origin_t *origin)
{
    const bool is_many = function_of(request) == WRITE_MANY;
    const int values = count - 1;
    long first = 0;
    long registers = is_many ? values : 1;
    if (count == 0) return reject(origin, "the register is missing, such as 0x0101.");
    if (!read_number("REGISTER", words[0], 0, UINT16_MAX, &first, origin)) return false;
    if (is_read(request) && count > 2)
        return reject(origin, "a read has a register and a count; '%s' is too much.", words[2]);
    if (is_read(request) && count == 2 &&
        !read_number("COUNT", words[1], 1, FATHOM_MODBUS_MAX_READ, &registers, origin))
        return false;
    if (function_of(request) == WRITE && values != 1)
        return reject(origin, "function 6 writes one value, not %d. Function 16 writes several.", values);
    if (is_many && (values < 1 || values > FATHOM_MODBUS_MAX_WRITE))
        return reject(origin, "function 16 writes 1 to %d values, not %d.", FATHOM_MODBUS_MAX_WRITE, values);
    if (first + registers > UINT16_MAX + 1L)
        return reject(origin, "%ld registers from %s on go beyond 0xFFFF.", registers, words[0]);
    put16(request, first);
    if (is_read(request) || is_many) put16(request, registers);
    if (is_many) put(request, 2L * values);
    for (int i = 1; i != count && !is_read(request); i++) {
        long value = 0;
        if (!read_number("VALUE", words[i], INT16_MIN, UINT16_MAX, &value, origin)) return false;
        put16(request, value);
    }
    return true;
}

/* Adds the bytes of another function. */
static bool add_bytes(request_t *request, char **words, int count, const origin_t *origin)
{
    enum { MAX_BYTES = 251 };
    if (count > MAX_BYTES)
        return reject(origin, "a request has at most %d bytes behind its function, not %d.", MAX_BYTES,
                      count);
    for (int i = 0; i != count; i++) {
        const char *const digits = words[i] + (strncmp(words[i], "0x", 2) == 0 ? 2 : 0);
        const size_t length = strlen(digits);
        if (length < 1 || length > 2 || strspn(digits, "0123456789abcdefABCDEF") != length)
            return reject(origin, "function %u takes bytes in hex, such as 0e, not '%s'.",
                          function_of(request), words[i]);
        put(request, strtol(digits, NULL, 16));
    }
    return true;
}

/* Reads UNIT FUNCTION and what belongs to the function, and adds the CRC. */
static bool read_words(request_t *request, const arguments_t *arguments)
{
    enum { MAX_FUNCTION = 127 };
    const origin_t *const origin = &arguments->origin;
    char **const words = arguments->words;
    long unit = 0;
    long function = 0;
    if (arguments->count == 0)
        return reject(origin, "the unit is missing. Write it and then the function, such as: 1 3 0x0101.");
    if (!read_number("UNIT", words[0], 0, UINT8_MAX, &unit, origin)) return false;
    if (arguments->count == 1)
        return reject(origin, "the function is missing. It is 3, 4, 6, 16, or another one and its bytes.");
    if (!read_number("FUNCTION", words[1], 1, MAX_FUNCTION, &function, origin)) return false;
    put(request, unit);
    put(request, function);
    const bool has_registers = reads_registers(request) || function == WRITE || function == WRITE_MANY;
    if (!(has_registers ? add_registers : add_bytes)(request, words + 2, arguments->count - 2, origin))
        return false;
    const uint16_t crc = fathom_crc16(request->frame, request->length);
    put(request, crc & 0xFF);
    put(request, crc >> 8);
    return true;
}

/* ---- what the request can do ---- */

/* Returns true if the request can be for this model. An HPS-167S obeys unit 0, and cannot have address 255. */
static bool can_be(const model_t *model, const request_t *request)
{
    if (request->model != NULL) return model == request->model;
    return model->has_address_zero || request->frame[UNIT] <= model->max_address;
}

/* Decodes the request or its response for the model that the user named, or else for each that can have this address. */
static void decode(decode_frame_t *frame, decode_piece_t *piece, const request_t *request, bool is_response)
{
    *piece = (decode_piece_t){.protocol = DECODE_MODBUS,
                              .direction = is_response ? DECODE_RESPONSE : DECODE_REQUEST,
                              .length = is_response ? request->response_length : request->length};
    memset(frame, 0, sizeof *frame);
    frame->piece = piece;
    frame->bytes = is_response ? request->response : request->frame;
    frame->is_sure = request->model != NULL;
    frame->unit = frame->bytes[UNIT];
    frame->code = frame->bytes[FUNCTION];
    /* The datasheets know no other functions, whose frames may have any shape. */
    if (frame->code != READ && frame->code != WRITE && frame->code != WRITE_MANY) return;
    for (size_t i = 0; i != model_count; i++)
        if (can_be(&models[i], request)) models[i].decode(frame, &models[i], request->frame);
}

/* Returns what a read changes, NULL: nothing. Another model than the named one may be at the address. */
static const char *changes(const request_t *request)
{
    const char *text = NULL;
    for (size_t i = 0; i != model_count && text == NULL && reads_registers(request); i++)
        if (models[i].read_changes != NULL)
            text = models[i].read_changes(request->frame[FUNCTION], decode_get16(request->frame + FIRST),
                                          decode_get16(request->frame + COUNT));
    return text;
}

static bool is_harmless(const request_t *request) { return is_read(request) && changes(request) == NULL; }

static void print_write(const request_t *request)
{
    const uint8_t function = function_of(request);
    decode_frame_t frame;
    decode_piece_t piece;
    if (function == WRITE || function == WRITE_MANY)
        (void)fputs(
            "fathom: the request writes. The unit may store the value in flash, which wears out, and may "
            "change its address or baud rate.\n",
            stderr);
    else
        (void)fprintf(stderr,
                      "fathom: function %u (0x%02X) is in none of the datasheets; its effect is unknown.\n",
                      function, function);
    if (function == 10)
        (void)fputs("fathom: the function 10 that the datasheets print is in hex: 0x10, which is 16.\n",
                    stderr);
    decode(&frame, &piece, request, false);
    for (uint8_t i = 0; i != frame.meanings; i++) {
        (void)fprintf(stderr, "fathom: if it is %s: ", frame.meaning[i].sensor);
        decoding_put_line(stderr, &frame.meaning[i]);
        (void)fputs("\n", stderr);
    }
    for (uint8_t i = 0; i != frame.notes; i++) (void)fprintf(stderr, "fathom: %s\n", frame.note[i]);
}

/* Prints what the request may do, a line for each effect. Returns true if it needs --yes. */
static bool print_effects(const request_t *request)
{
    const uint8_t unit = request->frame[UNIT];
    const char *const changed = changes(request);
    for (size_t i = 0; i != model_count; i++)
        if (models[i].request_ends != NULL && can_be(&models[i], request))
            (void)fprintf(stderr, "fathom: the request ends %s\n", models[i].request_ends);
    if (changed != NULL) (void)fprintf(stderr, "fathom: %s\n", changed);
    if (!is_read(request)) print_write(request);
    if (unit == FATHOM_MODBUS_ANY_UNIT)
        (void)fputs("fathom: unit 255: each A16 and A05 obeys it, whatever its address.\n", stderr);
    else if (unit == FATHOM_MODBUS_BROADCAST)
        (void)fprintf(stderr, "fathom: unit 0 is all units%s\n",
                      is_broadcast(request) ? ": all obey, and none responds"
                                            : ", or an A16 or A05 whose address is 0");
    return !is_harmless(request) || unit == FATHOM_MODBUS_BROADCAST || unit == FATHOM_MODBUS_ANY_UNIT;
}

/* ---- the transaction ---- */

enum { LEAST_LENGTH = 4, EXCEPTION_LENGTH = 5, READ_OVERHEAD = 5, WRITE_LENGTH = 8, MAX_LENGTH = 255 };

static uint8_t encode(const fathom_transaction_t *transaction, uint8_t *frame)
{
    const request_t *const request = (const request_t *)transaction;
    memcpy(frame, request->frame, request->length);
    return request->length;
}

static bool is_request(const fathom_transaction_t *transaction, const uint8_t *frame, uint8_t have)
{
    const request_t *const request = (const request_t *)transaction;
    return memcmp(frame, request->frame, have < request->length ? have : request->length) == 0;
}

static bool may_collide(const fathom_transaction_t *transaction)
{
    return is_harmless((const request_t *)transaction); /* it may be sent while others send */
}

/* Returns true if the first bytes of a response state its length (MODBUS Application Protocol V1.1b3, 6). */
static bool has_known_length(uint8_t function)
{
    return (function >= READ_COILS && function <= WRITE) || function == WRITE_COILS || function == WRITE_MANY;
}

/* Noise has many zeros, so a frame from unit 0 counts only if unit 0 may respond. */
static bool accepts_zero;

static uint8_t known_length(const uint8_t *frame, uint8_t have)
{
    if (frame[UNIT] == 0 && !accepts_zero) return 0;
    if (have <= SIZE) return SIZE + 1;
    const uint8_t function = frame[FUNCTION] & (uint8_t)~FATHOM_MODBUS_EXCEPTION;
    if (!has_known_length(function)) return 0;
    if (function != frame[FUNCTION]) return EXCEPTION_LENGTH;
    if (function > READ_INPUT) return WRITE_LENGTH;
    const uint8_t size = frame[SIZE];
    return size >= 1 && size <= MAX_LENGTH - READ_OVERHEAD ? (uint8_t)(size + READ_OVERHEAD) : 0;
}

/* A response of another function ends where its CRC is right. */
static uint8_t any_length(const uint8_t *frame, uint8_t have)
{
    if (frame[UNIT] == 0 && !accepts_zero) return 0;
    for (uint8_t length = LEAST_LENGTH; length <= have && length != 0; length++)
        if (fathom_crc16(frame, length) == 0) return length;
    if (have < LEAST_LENGTH) return LEAST_LENGTH;
    return have < MAX_LENGTH ? (uint8_t)(have + 1) : 0;
}

/* Returns true if a response of the same function can be that to the request. */
static bool fits(const request_t *request, const uint8_t *response)
{
    const uint8_t *const asked = request->frame;
    const uint16_t count = decode_get16(asked + COUNT);
    if (!has_known_length(asked[FUNCTION])) return true;
    if (!is_read(request)) return memcmp(response + FIRST, asked + FIRST, WRITE_LENGTH - 2 - FIRST) == 0;
    if (reads_registers(request)) return response[SIZE] == 2 * count;
    /* A byte has eight coils. The user may have entered other bytes than those of a request for coils. */
    return request->length != WRITE_LENGTH || response[SIZE] == (count + 7u) / 8u;
}

static fathom_status_t parse_response(fathom_transaction_t *transaction, const uint8_t *frame)
{
    request_t *const request = (request_t *)transaction;
    const uint8_t function = function_of(request);
    const bool is_exception = frame[FUNCTION] == (function | FATHOM_MODBUS_EXCEPTION);
    if (!is_exception && (frame[FUNCTION] != function || !fits(request, frame))) return FATHOM_ERR_MALFORMED;
    request->response_length = transaction->protocol->length(frame, MAX_LENGTH);
    memcpy(request->response, frame, request->response_length);
    return is_exception ? FATHOM_ERR_EXCEPTION : FATHOM_OK;
}

/*
 * Judges one copy of a request, on a line that may echo. An acknowledgement that equals the request ends on a wire after
 * the request, a silence of 3.5 characters and its own characters; an echo arrives at the latest when the adapter
 * releases it.
 */
static fathom_status_t judge_copy(const request_t *request, const port_t *port)
{
    const uint8_t function = function_of(request);
    const uint64_t bits = fathom_character_bits(&request->line);
    const uint64_t wire_us = request->length * bits * 1000000u / request->line.baud;
    const uint64_t silence_us = FATHOM_T3_5_US(request->line.baud, bits);
    const uint64_t took_us = request->evidence.slowest_us;
    /* The acknowledgement of a function that is not known may equal the request, too. */
    if (is_read(request) || function == WRITE_COILS || function == WRITE_MANY) return FATHOM_ERR_NO_RESPONSE;
    if (request->evidence.echoes != 1 || request->evidence.rest != 0) return FATHOM_ERR_NO_RESPONSE;
    if (took_us > wire_us + PORT_RESPONSE_GAP_US) return FATHOM_OK;
    if (port->has_wire && took_us < 2 * wire_us + silence_us) return FATHOM_ERR_NO_RESPONSE;
    return FATHOM_ERR_ECHO;
}

/* Sends the request once on the open port and waits for its outcome. */
static void send_request(request_t *request, port_t *port)
{
    const uint8_t unit = request->frame[UNIT];
    accepts_zero =
        unit == FATHOM_MODBUS_ANY_UNIT || (unit == FATHOM_MODBUS_BROADCAST && !is_broadcast(request));
    const fathom_protocol_t protocol = {.encode = encode,
                                        .length = has_known_length(function_of(request)) ? known_length
                                                                                         : any_length,
                                        .check = fathom_crc16,
                                        .is_request = is_request,
                                        .parse_response = parse_response,
                                        .may_collide = may_collide,
                                        .is_unit_0_ordinary = accepts_zero};
    request->transaction.protocol = &protocol;
    request->transaction.address = unit;
    if (port_has_bytes(port->kind)) port_listen(port, PORT_LISTEN_US);
    listener_forget(&port->listener);
    request->status = fathom_line_submit(&port->line, &request->transaction);
    if (request->status == FATHOM_PENDING) request->status = port_finish(port, &request->transaction);
    if (request->response_length != 0 && port_has_bytes(port->kind)) port_listen(port, PORT_RESPONSE_GAP_US);
    listener_judge(&port->listener, unit, &request->evidence);
    const uint32_t echo = fathom_line_get_echo(&port->line) == FATHOM_LINE_ECHO_ON ? request->length : 0;
    const uint32_t known = request->response_length + echo;
    if (request->response_length != 0 && request->evidence.bytes > known)
        request->more = request->evidence.bytes - known;
    if (request->status == FATHOM_ERR_ECHO) request->status = judge_copy(request, port);
    if (request->status != FATHOM_OK || request->response_length != 0 || is_broadcast(request)) return;
    memcpy(request->response, request->frame, request->length); /* the copy, which is no echo */
    request->response_length = request->length;
}

/* ---- the response ---- */

/* Returns the status in JSON. */
static const char *status_name(const request_t *request)
{
    const size_t kind = counters_failure_kind(request->status, NULL);
    if (request->status == FATHOM_OK) return is_broadcast(request) ? "sent" : "answered";
    if (request->status == FATHOM_ERR_ECHO) return "answered_or_echo";
    if (request->status == FATHOM_ERR_PORT || kind == FAILURE_KINDS - 1) return "failed";
    return status_word_of_failure(kind);
}

/* The functions below write JSON, or text if `json` is NULL. */

static void print_bytes(json_t *json, const char *name, const uint8_t *bytes, size_t count)
{
    if (json != NULL) {
        json_bytes(json, name, bytes, count);
    } else if (count != 0) {
        (void)printf("%-9s", name);
        for (size_t i = 0; i != count; i++) (void)printf(" %02X", bytes[i]);
        (void)puts("");
    }
}

static void print_register(json_t *json, uint16_t at, const uint8_t *bytes)
{
    const uint16_t value = decode_get16(bytes);
    const int with_sign = value > INT16_MAX ? value - UINT16_MAX - 1 : value;
    const bool is_text = isprint(bytes[0]) && isprint(bytes[1]);
    const char text[] = {(char)bytes[0], (char)bytes[1], '\0'};
    if (json == NULL) {
        (void)printf("0x%04X    unsigned %5u  signed %6d  hex %04X", at, value, with_sign, value);
        (void)printf(is_text ? "  ascii \"%s\"\n" : "\n", text);
        return;
    }
    json_begin(json, NULL, '{');
    json_value(json, "register", "\"0x%04X\"", at);
    json_value(json, "unsigned", "%u", value);
    json_value(json, "signed", "%d", with_sign);
    json_value(json, "hex", "\"%04X\"", value);
    json_string(json, "ascii", is_text ? text : NULL);
    json_end(json, '}');
}

static void print_registers(json_t *json, const request_t *request)
{
    const uint16_t first = decode_get16(request->frame + FIRST);
    if (request->status != FATHOM_OK || !reads_registers(request)) return;
    if (json != NULL) json_begin(json, "registers", '[');
    for (uint8_t i = 0; i != request->response[SIZE] / 2u; i++)
        print_register(json, (uint16_t)(first + i), request->response + DATA + (size_t)2 * i);
    if (json != NULL) json_end(json, ']');
}

static void print_frames(json_t *json, const request_t *request, const port_t *port)
{
    const listener_t *const listener = &port->listener;
    if (listener->request_length != 0) print_bytes(json, "sent", request->frame, request->length);
    if (request->response_length != 0)
        print_bytes(json, "received", request->response, request->response_length);
    else if (listener->request_length != 0)
        print_bytes(json, "heard", listener->window, listener->have);
    print_registers(json, request);
}

static void print_text(const request_t *request, const port_t *port, const decode_frame_t *frame)
{
    print_frames(NULL, request, port);
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_text(stdout, &frame->meaning[i]);
}

static void print_json(const request_t *request, const port_t *port, const decode_frame_t *frame)
{
    const uint8_t code = request->response[CODE];
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    json_value(&json, "address", "%u", request->frame[UNIT]);
    json_value(&json, "function", "%u", function_of(request));
    json_string(&json, "status", status_name(request));
    print_frames(&json, request, port);
    if (request->status == FATHOM_ERR_EXCEPTION) {
        json_begin(&json, "exception", '{');
        json_value(&json, "code", "%u", code);
        json_string(&json, "name", modbus_exception(code).name);
        json_end(&json, '}');
    }
    json_begin(&json, "meanings", '[');
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_json(&json, &frame->meaning[i]);
    json_end(&json, ']');
    json_end(&json, '}');
    (void)puts("");
}

static void print_refusal(const request_t *request)
{
    const uint8_t code = request->response[CODE];
    const modbus_exception_t exception = modbus_exception(code);
    const model_t *const model = request->model;
    (void)fprintf(stderr, "unit %u refused: exception %02u (%s): %s", request->response[UNIT], code,
                  exception.name, exception.meaning);
    if (model == NULL) return;
    if (model->exception_name == NULL)
        (void)fprintf(stderr, "; the datasheet of %s has no exceptions", model->name);
    else if (model->exception_name(code) != NULL)
        (void)fprintf(stderr, "; %s: %s", model->exception_source, model->exception_name(code));
}

static void print_advice(const request_t *request, const port_t *port, const counters_t *counters)
{
    failure_t failure = failure_of_request(request->status, port);
    if (request->status == FATHOM_ERR_CANCELLED && port->listener.request_length == 0) {
        (void)fputs("the command ended before the line was silent, and nothing was sent", stderr);
        return;
    }
    if (request->model != NULL) failure.model = request->model;
    failure.counters = counters;
    failure.line = &request->line;
    failure.evidence = request->evidence;
    failure.address = request->frame[UNIT];
    failure.is_request = true;
    advice_print(stderr, &failure);
}

/* Prints what failed, or what else the user has to know. counters: of this attempt. */
static void print_problem(const request_t *request, const port_t *port, const counters_t *counters)
{
    if (request->more != 0)
        (void)fprintf(stderr, "fathom: %" PRIu32 " bytes arrived in addition to the response%s.\n",
                      request->more,
                      request->evidence.own > 1        ? ": two units may have this address"
                      : request->evidence.foreign != 0 ? ": another unit responded also"
                                                       : "");
    if (request->status == FATHOM_OK && !is_broadcast(request)) return;
    (void)fputs("fathom: ", stderr);
    if (request->status == FATHOM_OK)
        (void)fputs("the request was sent to all units. None of them responds, so its effect is unknown",
                    stderr);
    else if (request->status == FATHOM_ERR_EXCEPTION)
        print_refusal(request);
    else if (request->status != FATHOM_ERR_ECHO && request->status != FATHOM_ERR_MALFORMED)
        print_advice(request, port, counters);
    else
        (void)fprintf(
            stderr, "unit %u%s", request->frame[UNIT],
            request->status == FATHOM_ERR_ECHO
                ? " acknowledged the request, unless the adapter returned it: both have the same bytes. "
                  "Read the register back, or use --echo off or on"
                : ": the response does not fit the request. Check that no other unit has this address");
    (void)fputs("\n", stderr);
}

/* ---- the command ---- */

static const option_t rows[] = {
    {"sensor", "MODEL", "Use the line settings of MODEL, and decode the response for it", KIND_TEXT,
     GROUP_COMMAND, AT(settings_t, sensor), .list = model_name},
    {"timeout", "MS", "Wait at most MS for the response (default 1000)", KIND_NUMBER, GROUP_COMMAND, .min = 1,
     .max = 600000, .scale = 1000, AT(settings_t, timeout_us)},
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(settings_t, is_json)},
    {"yes", .help = "Do not ask before a request that can change something", .group = GROUP_COMMAND,
     AT(settings_t, is_confirmed)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {port_rows, 0}, {NULL, 0}};

/* Sends the request on the open port and reports its outcome. Returns the exit status. */
static int ask(request_t *request, port_t *port, bool is_json)
{
    counters_t counters = {0};
    decode_frame_t frame = {.meanings = 0};
    decode_piece_t piece;
    send_request(request, port);
    (void)counters_take(&counters, port, NULL);
    if (request->model != NULL && request->status == FATHOM_OK && request->response_length != 0)
        decode(&frame, &piece, request, true);
    (is_json ? print_json : print_text)(request, port, &frame);
    const bool is_written = is_output_written();
    print_problem(request, port, &counters);
    const bool is_good = request->status == FATHOM_OK || request->status == FATHOM_ERR_ECHO;
    return is_written && is_good ? STATUS_OK : STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    /* The time that a broadcast gives the units (MODBUS over Serial Line V1.02, 2.4.1: 100 to 200 ms). */
    enum { TURNAROUND_US = 200000, TIMEOUT_US = 1000000 };
    static port_t port;
    const settings_t *const settings = arguments->settings;
    port_options_t options = {.path = settings->port.path, .keys = settings->port.keys};
    request_t request = {.line = {9600, FATHOM_PARITY_NONE, 1}};
    memset(&port, 0, sizeof port);
    if (!read_words(&request, arguments)) return STATUS_USAGE;
    if (settings->sensor != NULL) {
        request.model = model_word(settings->sensor, &arguments->origin);
        if (request.model == NULL) return STATUS_USAGE;
        request.line = request.model->line;
    }
    if (options.path == NULL) {
        (void)reject(&arguments->origin,
                     "--port is missing, such as --port /dev/ttyUSB0. 'fathom help ports' explains ports.");
        return STATUS_USAGE;
    }
    if (!line_options_suit(&options.keys, options.path, &arguments->origin)) return STATUS_USAGE;
    port_options_take(&options, &options.keys);
    port_options_line(&options, &request.line);
    options.line = request.line;
    request.transaction.timeout_us = is_broadcast(&request)      ? TURNAROUND_US
                                     : settings->timeout_us != 0 ? settings->timeout_us
                                                                 : TIMEOUT_US;
    if (print_effects(&request) && !confirm(arguments, settings->is_confirmed,
                                            "This request can change something. Nothing was sent yet."))
        return STATUS_USAGE;
    if (!host->begin(host->ctx)) return STATUS_FAILED;
    if (!port_open_now(&port, host, &options)) {
        (void)fprintf(stderr, "fathom: %s\n", port.error_text);
        return STATUS_FAILED;
    }
    advice_print_opening(&port);
    const int status = ask(&request, &port, settings->is_json);
    port_close(&port);
    return status;
}

const command_t request_command = {
    .name = "request",
    .summary = "Send one Modbus request and print the response",
    .usage = "UNIT 3 REGISTER [COUNT] [OPTIONS]\n"
             "UNIT 6 REGISTER VALUE [OPTIONS]\n"
             "UNIT 16 REGISTER VALUE... [OPTIONS]\n"
             "UNIT FUNCTION [BYTE...] [OPTIONS]",
    .about = "Numbers are decimal, or hex behind 0x; BYTE is hex. REGISTER is the address on the wire, as "
             "the datasheets print it (0x0101). VALUE may be negative. The CRC is added. Nothing is "
             "repeated. Unit 0 is all units, which do not respond. What can change something is printed "
             "first, and must be confirmed: writes, functions other than 1 to 4, units 0 and 255, and reads "
             "of 0x0009, which reset an hps167s. Any request stops the automatic output of an A16 or A05.\n",
    .tables = tables,
    .common = "port sensor yes timeout format",
    .examples = "  fathom request 1 3 0x0101 --port /dev/ttyUSB0 --sensor a16\n"
                "  fathom request 7 3 0x0008 4 --port /dev/ttyUSB0 --sensor hps167s\n"
                "  fathom request 1 6 0x0206 2000 --port /dev/ttyUSB0 --yes\n"
                "  fathom request 1 0x2b 0e 01 00 --port /dev/ttyUSB0 --yes\n",
    .status = "Exit status: 0 a response or an echo, or sent to all units; 1 no or a damaged response, or an "
              "exception; 2 wrong usage, or not confirmed.\n",
    .topics = "requests, ports",
    .settings_size = sizeof(settings_t),
    .start = start,
};
