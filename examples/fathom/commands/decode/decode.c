/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getline */
#include "commands/decode/decode.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command.h"
#include "cli/rows.h"
#include "commands/commands.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

/* ---- the input ---- */

#define SEPARATORS " \t\r\n\v\f,;:{}"
#define DIGITS     "0123456789abcdefABCDEF"

/* Where bytes go and come from. */
typedef struct {
    decode_input_t *input;
    const origin_t *origin;
    const char *hint; /* of an error in hex */
    char place[256];  /* "capture.txt: line 2" */
} source_t;

/* Adds a byte. Returns the exit status. */
static int add_byte(const source_t *source, uint8_t byte, bool starts_line)
{
    decode_input_t *const input = source->input;
    if (input->count == DECODE_MAX_BYTES) {
        (void)fprintf(stderr, "fathom: %s: there are more than the %d bytes that are decoded at a time.\n",
                      source->place, DECODE_MAX_BYTES);
        return STATUS_FAILED;
    }
    input->bytes[input->count] = byte;
    input->line_starts[input->count++] = starts_line;
    return STATUS_OK;
}

static int reject_text(const source_t *source, size_t at, const char *what)
{
    (void)reject(source->origin, "%s, character %zu: %s%s.", source->place, at + 1, what, source->hint);
    return STATUS_USAGE;
}

static int reject_digit(const source_t *source, size_t at, char digit)
{
    char what[] = "'?' is no hex digit";
    if (digit > ' ' && digit < '\x7f') what[1] = digit;
    return reject_text(source, at, what);
}

/* Adds the bytes of a word of hex digits, with or without 0x. Returns the exit status. */
static int add_word(const source_t *source, const char *line, size_t at, size_t length, bool starts_line)
{
    const char *const word = line + at;
    const bool has_prefix = length > 2 && word[0] == '0' && (word[1] == 'x' || word[1] == 'X');
    const size_t first = has_prefix ? 2 : 0;
    const size_t last = first + strspn(word + first, DIGITS);
    int status = STATUS_OK;
    if (last != length) return reject_digit(source, at + last, word[last]);
    if (length % 2 != 0) return reject_text(source, at, "a byte has two hex digits");
    for (size_t i = first; i != length && status == STATUS_OK; i += 2) {
        const char digits[] = {word[i], word[i + 1], '\0'};
        status = add_byte(source, (uint8_t)strtoul(digits, NULL, 16), starts_line && i == first);
    }
    return status;
}

/* Adds the bytes of a line; a comment goes from # to its end. Returns the exit status. */
static int add_line(const source_t *source, const char *line, bool starts_line)
{
    int status = STATUS_OK;
    for (size_t at = strspn(line, SEPARATORS); line[at] != '\0' && line[at] != '#' && status == STATUS_OK;) {
        const size_t length = strcspn(line + at, SEPARATORS "#");
        status = add_word(source, line, at, length, starts_line);
        starts_line = false;
        at += length;
        at += strspn(line + at, SEPARATORS);
    }
    return status;
}

static int read_arguments(source_t *source, int count, char **arguments)
{
    enum { WHOLE_FRAME = 8 }; /* an argument of this many characters is a frame rather than a byte of one */
    int status = STATUS_OK;
    for (int i = 0; i != count && status == STATUS_OK; i++) {
        (void)snprintf(source->place, sizeof source->place, "argument %d", i + 1);
        status = add_line(source, arguments[i], strlen(arguments[i]) >= WHOLE_FRAME);
    }
    return status;
}

static int read_text(source_t *source, const char *name, FILE *file)
{
    char *line = NULL;
    size_t size = 0;
    ssize_t length = 0;
    int status = STATUS_OK;
    for (unsigned number = 1; status == STATUS_OK && (length = getline(&line, &size, file)) >= 0; number++) {
        (void)snprintf(source->place, sizeof source->place, "%.200s: line %u", name, number);
        status = add_line(source, line, true);
        if (status == STATUS_OK && strlen(line) != (size_t)length)
            status = reject_digit(source, strlen(line), '\0');
    }
    free(line);
    return status;
}

static int read_file(source_t *source, const char *name, FILE *file, bool is_raw)
{
    int status = STATUS_OK;
    errno = 0;
    if (!is_raw) {
        source->hint = ". For a file of bytes instead of hex, add --raw";
        status = read_text(source, name, file);
    } else {
        (void)snprintf(source->place, sizeof source->place, "%.200s", name);
        for (int byte = 0; status == STATUS_OK && (byte = getc(file)) != EOF;)
            status = add_byte(source, (uint8_t)byte, false);
    }
    if (ferror(file) == 0) return status;
    (void)fprintf(stderr, "fathom: %s: %s\n", name, strerror(errno));
    return STATUS_FAILED;
}

/* Reads bytes in hex from the arguments. A single argument that is no hex names a file; without an argument, or with "-",
 * the bytes are those of the standard input. is_raw: the file has the bytes themselves. Returns the exit status. */
static int read_input(decode_input_t *input, const arguments_t *arguments, bool is_raw)
{
    source_t source = {.input = input, .origin = &arguments->origin, .hint = ""};
    const int count = arguments->count;
    const char *const name = count == 1 ? arguments->words[0] : "";
    const bool is_name = name[strspn(name, DIGITS "xX" SEPARATORS)] != '\0';
    if (count == 0 || strcmp(name, "-") == 0) return read_file(&source, "the standard input", stdin, is_raw);
    if (is_name || (is_raw && count == 1)) {
        FILE *const file = fopen(name, "rbe");
        if (file != NULL) {
            const int status = read_file(&source, name, file, is_raw);
            (void)fclose(file);
            return status;
        }
        if (is_raw || errno != ENOENT) {
            (void)fprintf(stderr, "fathom: %s: %s\n", name, strerror(errno));
            return STATUS_FAILED;
        }
        source.hint = ", and there is no file of that name";
    }
    if (!is_raw) return read_arguments(&source, count, arguments->words);
    (void)reject(source.origin, "--raw takes one file.");
    return STATUS_USAGE;
}

/* ---- the meaning of a frame ---- */

enum { UNIT = 0, HEAD = 6, ALL_UNITS = 0xFF };
enum { READ = FATHOM_MODBUS_READ_HOLDING_REGISTERS, EXCEPTION = FATHOM_MODBUS_EXCEPTION };

/* What is kept from frame to frame: a read that has no response yet. */
typedef struct {
    const model_t *only; /* the sensor; NULL: any model */
    bool is_asked;
    uint8_t head[HEAD]; /* of the last good Modbus request, as on the wire */
} context_t;

static const char *function_name(uint8_t function)
{
    switch (function & (uint8_t)~EXCEPTION) {
    case FATHOM_MODBUS_READ_HOLDING_REGISTERS:
        return "read holding registers";
    case FATHOM_MODBUS_WRITE_SINGLE_REGISTER:
        return "write single register";
    case FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS:
        return "write multiple registers";
    default:
        return "do what none of these sensors can";
    }
}

static void decode_exception(decode_frame_t *frame, const context_t *context)
{
    const uint8_t code = frame->bytes[DECODE_AT_SIZE];
    bool has_none = false;
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "the request is refused");
    decode_remark(decode_number(meaning, "exception", code, ""), "%s", modbus_exception(code).name);
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        if (context->only != NULL && context->only != model) continue;
        if (model->exception_name == NULL)
            has_none = true;
        else if (model->exception_name(code) != NULL)
            (void)decode_mean(frame, model->name, model->exception_source, "%s", model->exception_name(code));
    }
    if (has_none) decode_note(frame, "no exceptions are in the datasheets of a16 and a05");
}

/* Adds what each sensor that can have the address means by the frame, or the registers that no sensor knows. */
static void decode_meanings(decode_frame_t *frame, const context_t *context, const uint8_t *request)
{
    const uint8_t *const bytes = frame->bytes;
    const bool is_write = bytes[DECODE_AT_FUNCTION] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER;
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        const bool is_beyond = !model->has_address_zero && frame->unit > model->max_address;
        if (context->only != NULL ? context->only == model : !is_beyond) model->decode(frame, model, request);
    }
    if (frame->meanings != 0) return;
    if (bytes[DECODE_AT_FUNCTION] == READ && frame->piece->direction == DECODE_RESPONSE) {
        (void)decode_mean(frame, "", "", "%u registers", bytes[DECODE_AT_SIZE] / 2u);
        return;
    }
    decode_meaning_t *const meaning = decode_mean(frame, "", "", "none of these sensors knows this");
    decode_string(meaning, "address", "0x%04X", decode_get16(bytes + DECODE_AT_FIRST));
    decode_number(meaning, is_write ? "value" : "registers", decode_get16(bytes + DECODE_AT_COUNT), "");
}

/* Returns true if the frame is the response to the request before. */
static bool responds(const decode_frame_t *frame, const context_t *context)
{
    const uint8_t *const bytes = frame->bytes;
    const uint8_t *const head = context->head;
    if (!context->is_asked || (frame->piece->direction & DECODE_RESPONSE) == 0) return false;
    if (bytes[UNIT] != head[UNIT] && head[UNIT] != ALL_UNITS) return false;
    if ((bytes[DECODE_AT_FUNCTION] & (uint8_t)~EXCEPTION) != head[DECODE_AT_FUNCTION]) return false;
    if ((bytes[DECODE_AT_FUNCTION] & EXCEPTION) != 0) return true;
    if (bytes[DECODE_AT_FUNCTION] == READ)
        return bytes[DECODE_AT_SIZE] == 2 * decode_get16(head + DECODE_AT_COUNT);
    return memcmp(bytes + DECODE_AT_FIRST, head + DECODE_AT_FIRST, HEAD - DECODE_AT_FIRST) == 0;
}

static void decode_modbus(decode_frame_t *frame, context_t *context)
{
    const decode_piece_t *const piece = frame->piece;
    const uint8_t *const bytes = frame->bytes;
    const uint8_t *const crc = bytes + piece->length - 2;
    const uint16_t right = fathom_crc16(bytes, (uint8_t)(piece->length - 2));
    const uint8_t function = bytes[DECODE_AT_FUNCTION];
    const bool is_response = responds(frame, context);
    frame->unit = bytes[UNIT];
    frame->code = function;
    frame->code_is = "function";
    (void)snprintf(frame->what, sizeof frame->what, "%s%s", (function & EXCEPTION) != 0 ? "refuses to " : "",
                   function_name(function));
    frame->checksum_length = 2;
    frame->checksum[0] = (uint8_t)right;
    frame->checksum[1] = (uint8_t)(right >> 8);
    if (piece->is_damaged && crc[0] == frame->checksum[1] && crc[1] == frame->checksum[0])
        decode_note(frame, "the two bytes of the CRC are swapped: the low one goes first");
    if (frame->unit == FATHOM_MODBUS_BROADCAST)
        decode_note(frame, "0 is the broadcast address: all obey, none answers");
    if (frame->unit == ALL_UNITS) decode_note(frame, "FF is the broadcast address of a16 and a05");
    if ((function & EXCEPTION) != 0) {
        decode_exception(frame, context);
        if (is_response) decode_note(frame, "refuses the request before");
    } else if (piece->direction == DECODE_RESPONSE && function == READ) {
        decode_meanings(frame, context, is_response ? context->head : NULL);
        if (!is_response) decode_note(frame, "its request is not here; what it answers hangs on that");
    } else {
        decode_meanings(frame, context, bytes);
        if (is_response)
            decode_note(frame, "acknowledges the request before%s",
                        piece->direction == DECODE_BOTH ? ", or is its echo" : "");
    }
    if (is_response && !piece->is_damaged) context->is_asked = false;
    if (is_response || piece->direction == DECODE_RESPONSE || piece->is_damaged) return;
    memcpy(context->head, bytes, HEAD);
    context->is_asked = true;
}

static void decode_frame(decode_frame_t *frame, context_t *context, const decode_finder_t *finder,
                         const decode_piece_t *piece)
{
    frame->piece = piece;
    frame->bytes = finder->input->bytes + piece->offset;
    frame->unit = frame->code = -1;
    frame->code_is = "";
    frame->what[0] = '\0';
    frame->is_sure = context->only != NULL;
    frame->meanings = frame->notes = 0;
    if (piece->protocol == 0) {
        char why[DECODE_TEXT];
        const char *const text = decode_guess(finder, piece, why);
        if (text[0] != '\0') decode_note(frame, "%s", text);
    } else if (piece->protocol == DECODE_MODBUS) {
        decode_modbus(frame, context);
    } else {
        frame->checksum_length = 1;
        frame->checksum[0] = fathom_dyp_checksum(frame->bytes, (uint8_t)(piece->length - 1));
        for (size_t i = 0; i != model_count; i++)
            if ((models[i].protocols & piece->protocol) != 0) models[i].decode_sum(frame, &models[i]);
    }
    if (piece->is_damaged)
        decode_note(frame, "a receiver drops the frame; which of its bytes are wrong is unknown");
}

/* ---- the output ---- */

/* The words in JSON and in text. */
typedef struct {
    const char *name;
    const char *text;
} words_t;

static const words_t protocols[] = {
    [DECODE_MODBUS] = {"modbus", "Modbus RTU"},
    [DECODE_DYP] = {"dyp", "55 AA protocol"},
    [DECODE_STREAM_ONE] = {"stream", "FF frame of one distance"},
    [DECODE_STREAM_FOUR] = {"stream", "FF frame of four distances"},
};

static const words_t directions[] = {
    [DECODE_REQUEST] = {"request", "request"},
    [DECODE_RESPONSE] = {"response", "response"},
    [DECODE_BOTH] = {"both", "request or response, which are the same bytes"},
};

static void print_json(const decode_frame_t *frame)
{
    const decode_piece_t *const piece = frame->piece;
    const size_t length = frame->checksum_length;
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    json_value(&json, "offset", "%zu", piece->offset);
    json_value(&json, "length", "%zu", piece->length);
    json_bytes(&json, "bytes", frame->bytes, piece->length);
    json_string(&json, "protocol", protocols[piece->protocol].name);
    if (piece->protocol != 0) {
        json_string(&json, "direction", directions[piece->direction].name);
        if (frame->unit >= 0) json_value(&json, "address", "%d", frame->unit);
        if (frame->code >= 0) json_value(&json, frame->code_is, "%d", frame->code);
        if (frame->what[0] != '\0') json_string(&json, "name", frame->what);
        json_begin(&json, "checksum", '{');
        json_flag(&json, "right", !piece->is_damaged);
        json_bytes(&json, "found", frame->bytes + piece->length - length, length);
        json_bytes(&json, "expected", frame->checksum, length);
        json_end(&json, '}');
        json_begin(&json, "meanings", '[');
        for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_json(&json, &frame->meaning[i]);
        json_end(&json, ']');
    }
    json_begin(&json, "notes", '[');
    for (uint8_t i = 0; i != frame->notes; i++) json_string(&json, NULL, frame->note[i]);
    json_end(&json, ']');
    json_end(&json, '}');
    (void)puts("");
}

static void print_frame(const decode_frame_t *frame)
{
    const decode_piece_t *const piece = frame->piece;
    const uint8_t *const found = frame->bytes + piece->length - frame->checksum_length;
    const bool is_crc = frame->checksum_length == 2;
    (void)printf("        %s", protocols[piece->protocol].text);
    if ((piece->protocol & (DECODE_MODBUS | DECODE_DYP)) != 0)
        (void)printf(", %s", directions[piece->direction].text);
    if (frame->unit >= 0) (void)printf(", address %d", frame->unit);
    if (frame->code >= 0) (void)printf(", %s %02X", frame->code_is, (unsigned)frame->code);
    if (frame->what[0] != '\0') (void)printf(" %s", frame->what);
    (void)puts("");
    for (uint8_t i = 0; i != frame->meanings; i++) decoding_put_text(stdout, &frame->meaning[i]);
    (void)printf("        %s %02X", is_crc ? "CRC" : "sum", found[0]);
    if (is_crc) (void)printf(" %02X", found[1]);
    if (piece->is_damaged) (void)printf(" WRONG, it should be %02X", frame->checksum[0]);
    if (piece->is_damaged && is_crc) (void)printf(" %02X", frame->checksum[1]);
    (void)puts(piece->is_damaged ? "" : " right");
    for (uint8_t i = 0; i != frame->notes; i++) (void)printf("        note: %s\n", frame->note[i]);
}

static void print_text(const decode_frame_t *frame)
{
    enum { BYTES_A_LINE = 20 };
    const decode_piece_t *const piece = frame->piece;
    for (size_t i = 0; i != piece->length; i++) {
        if (i % BYTES_A_LINE == 0) (void)printf("%s%06zu ", i != 0 ? "\n" : "", piece->offset + i);
        (void)printf(" %02X", frame->bytes[i]);
    }
    (void)puts("");
    if (piece->protocol != 0)
        print_frame(frame);
    else
        (void)printf("        NO FRAME%s%s\n", frame->notes != 0 ? ": " : "",
                     frame->notes != 0 ? frame->note[0] : "");
}

/* ---- the command ---- */

typedef struct {
    uint8_t protocol; /* its place among the words of the option */
    const char *sensor;
    bool is_json;
    bool is_raw;
} settings_t;

static const option_t rows[] = {
    {"protocol", "NAME", "Look for frames of one protocol: auto, modbus, dyp or stream", KIND_CHOICE,
     GROUP_COMMAND, .words = "auto modbus dyp stream", AT(settings_t, protocol)},
    {"sensor", "MODEL", "Decode frames for one sensor: a16, a05 or hps167s", KIND_TEXT, GROUP_COMMAND,
     AT(settings_t, sensor), .list = model_name},
    {"raw", .help = "Read FILE as bytes instead of hex", .group = GROUP_COMMAND, AT(settings_t, is_raw)},
    {"format", "FORMAT", "Print text or json (default text)", KIND_CHOICE, GROUP_OUTPUT, .words = "text json",
     AT(settings_t, is_json)},
    {.name = NULL},
};

static const option_table_t tables[] = {{rows, 0}, {NULL, 0}};

/* Returns the exit status. */
static int explain(const decode_input_t *input, uint8_t wanted, const model_t *only, bool is_json)
{
    static decode_frame_t frame;
    decode_finder_t finder;
    context_t context = {.only = only};
    decode_piece_t piece;
    int status = STATUS_OK;
    decode_find_begin(&finder, input, wanted);
    while (decode_find_next(&finder, &piece)) {
        if (piece.protocol == 0 || piece.is_damaged) status = STATUS_FAILED;
        decode_frame(&frame, &context, &finder, &piece);
        (is_json ? print_json : print_text)(&frame);
    }
    free(finder.choices);
    return is_output_written() ? status : STATUS_FAILED;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    static const uint8_t sets[] = {DECODE_ALL, DECODE_MODBUS, DECODE_DYP,
                                   DECODE_STREAM_ONE | DECODE_STREAM_FOUR};
    static decode_input_t input;
    const settings_t *const settings = arguments->settings;
    const model_t *const only =
        settings->sensor != NULL ? model_word(settings->sensor, &arguments->origin) : NULL;
    const uint8_t wanted = sets[settings->protocol] & (only != NULL ? only->protocols : DECODE_ALL);
    (void)host; /* it opens no port */
    if (settings->sensor != NULL && only == NULL) return STATUS_USAGE;
    if (only != NULL && wanted == 0) {
        (void)reject(&arguments->origin, "%s has no frames of this --protocol.", only->name);
        return STATUS_USAGE;
    }
    input.count = 0;
    int status = read_input(&input, arguments, settings->is_raw);
    if (status == STATUS_OK && input.count == 0) {
        (void)fputs("fathom: there are no bytes to explain.\n", stderr);
        status = STATUS_FAILED;
    }
    return status == STATUS_OK ? explain(&input, wanted, only, settings->is_json) : status;
}

const command_t decode_command = {
    .name = "decode",
    .summary = "Explain bytes that were seen on the wire",
    .usage = "[OPTIONS] HEX...\n[OPTIONS] [FILE]",
    .about =
        "HEX is bytes such as 01 03, 0103 or 0x01,0x03. FILE has such bytes; without FILE, or with -, they "
        "are read from standard input. A # begins a comment. A response behind its request is explained by "
        "it. A sum of 8 bits proves little: a stream that begins inside a frame may be read out of step.\n",
    .tables = tables,
    .common = "sensor protocol format raw",
    .examples = "  fathom decode 01 03 01 00 00 01 85 F6  01 03 02 02 F2 38 A1\n"
                "  fathom decode --sensor hps167s 01 03 08 08 23 DC B2 07 01 00 00 FD 41\n"
                "  fathom decode --format json capture.txt\n",
    .status = "Exit status: 0 every byte is part of a good frame, 1 not, 2 wrong usage or hex.\n",
    .operands = OPERANDS_FILE,
    .settings_size = sizeof(settings_t),
    .start = start,
};
