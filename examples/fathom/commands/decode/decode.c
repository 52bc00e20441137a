/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "cli/options.h"
#include "cli/sensor_word.h"
#include "commands/commands.h"
#include "commands/decode/decode_print.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

static const char command[] = "decode";

enum { PROTOCOL, SENSOR, FORMAT, RAW, HELP, OPTIONS };

static const struct option table[OPTIONS + 1] = {
    [PROTOCOL] = {"protocol", required_argument, NULL, 256},
    [SENSOR] = {"sensor", required_argument, NULL, 256},
    [FORMAT] = {"format", required_argument, NULL, 256},
    [RAW] = {"raw", no_argument, NULL, 256},
    [HELP] = {"help", no_argument, NULL, 256},
};

typedef struct {
    uint8_t protocols;
    const model_t *only; /* as in decode_context_t */
    const decode_format_t *format;
} settings_t;

static void help(FILE *to)
{
    (void)fputs(
        "fathom decode explains bytes that were seen on the wire of an A16, A05 or HPS-167S: where the "
        "frames\n"
        "are, what each says, and whether its checksum is right.\n\n"
        "usage: fathom decode [OPTIONS] HEX...    bytes in hex: 01 03, 0103, 0x01,0x03\n"
        "       fathom decode [OPTIONS] [FILE]    a file of them, or - or nothing for the standard input; # "
        "and\n"
        "                                         what follows it in a line is left out\n\n"
        "  --protocol NAME   only this one: modbus, dyp (55 AA), or stream (FF ... SUM); default auto: all\n"
        "  --sensor NAME     only this one: a16, a05 or hps167s; default all that the frame fits\n"
        "  --format NAME     text (default) or json, an object a line\n"
        "  --raw             FILE has the bytes themselves\n\n"
        "A response that follows its request is explained by it; alone, by all that it can be. A frame may "
        "go\n"
        "across lines, but where there is doubt one begins with a line. A sum of 8 bits proves little: what\n"
        "begins in the middle of a stream may be read a byte or more out of step.\n\n"
        "Exit status: 0 when every byte is part of a good frame, 1 when one is not or nothing can be read, 2 "
        "for\n"
        "wrong usage and for what is no hex.\n\n"
        "examples:\n"
        "  fathom decode 01 03 01 00 00 01 85 F6  01 03 02 02 F2 38 A1\n"
        "  fathom decode --sensor hps167s 01 03 08 08 23 DC B2 07 01 00 00 FD 41\n"
        "  fathom decode --format json capture.txt\n"
        "  fathom decode --raw capture.bin\n",
        to);
}

typedef struct {
    const char *name;
    uint8_t protocols;
} choice_t;

static const choice_t protocols[] = {{"auto", DECODE_ALL},
                                     {"modbus", DECODE_MODBUS},
                                     {"dyp", DECODE_DYP},
                                     {"stream", DECODE_STREAM_ONE | DECODE_STREAM_FOUR}};
enum { PROTOCOLS = sizeof protocols / sizeof protocols[0] };

/* text NULL: it was not given. */
static bool take_protocol(settings_t *settings, const char *text)
{
    char known[80] = "";
    if (text == NULL) return true;
    for (size_t i = 0; i != PROTOCOLS; i++) {
        if (strcmp(text, protocols[i].name) == 0) {
            settings->protocols &= protocols[i].protocols;
            return true;
        }
        list_add(known, sizeof known, protocols[i].name);
    }
    (void)usage_error(command, "there is no protocol '%s', only %s", text, known);
    return false;
}

/* The same. */
static bool take_model(settings_t *settings, const char *text)
{
    if (text == NULL) return true;
    const origin_t origin = {.command = command};
    const model_t *const named = model_word(text, &origin);
    if (named == NULL) return false;
    settings->only = named;
    settings->protocols &= named->protocols;
    return true;
}

enum { WHY_TEXT = 120 };

/* What bytes of no frame may have been meant to be; "" mostly. */
static void guess(const decode_input_t *input, const decode_piece_t *piece, uint8_t allowed,
                  char why[WHY_TEXT])
{
    const uint8_t *const bytes = input->bytes + piece->offset;
    uint8_t have = 255;
    if (piece->length < have) have = (uint8_t)piece->length;
    const bool has_function = have >= 3 && (bytes[1] == FATHOM_MODBUS_READ_HOLDING_REGISTERS ||
                                            bytes[1] == FATHOM_MODBUS_WRITE_SINGLE_REGISTER ||
                                            bytes[1] == FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS);
    why[0] = '\0';
    if ((allowed & DECODE_MODBUS) != 0 && has_function) {
        const uint8_t response = fathom_modbus_rtu_response_length(bytes, have);
        const uint8_t request = fathom_modbus_rtu_request_length(bytes, have);
        const bool is_known = bytes[1] != FATHOM_MODBUS_WRITE_MULTIPLE_REGISTERS || have > 6;
        if (response > have && request > have && is_known)
            (void)snprintf(why, WHY_TEXT,
                           "begins like a Modbus request of %u or a response of %u bytes, but ends early",
                           request, response);
        else if (response > have)
            (void)snprintf(why, WHY_TEXT, "begins like a Modbus response of %u bytes, but ends early",
                           response);
    }
    if ((allowed & DECODE_DYP) != 0 && have >= 2 && bytes[0] == 0x55 && bytes[1] == 0xAA)
        (void)snprintf(why, WHY_TEXT, "begins like a 55 AA frame, but is none");
    if ((allowed & DECODE_MODBUS) != 0 && have == 4 && fathom_crc16(bytes, have) == 0)
        (void)snprintf(why, WHY_TEXT,
                       "its CRC is right, but it has no function; HPS table 40 leaves it out so");
    const size_t next = piece->offset + piece->length;
    if (have == 1 && bytes[0] == FATHOM_DYP_START && next != input->count &&
        input->bytes[next] == FATHOM_DYP_START)
        (void)snprintf(why, WHY_TEXT, "an FF too many: a frame begins with one, though A16 2(3) prints two");
}

/* Returns the exit status. */
static int explain(const settings_t *settings, const decode_input_t *input, decode_finder_t *finder)
{
    static decode_frame_t frame;
    decode_context_t context = {settings->only, false, {0}};
    decode_piece_t piece;
    char why[WHY_TEXT];
    int status = STATUS_OK;
    while (decode_find_next(finder, &piece)) {
        if (piece.protocol == 0 || piece.is_damaged) status = STATUS_FAILED;
        if (piece.protocol != 0) {
            decode_frame(&frame, &context, input, &piece);
            settings->format->frame(stdout, &frame);
        } else {
            guess(input, &piece, settings->protocols, why);
            settings->format->leftover(stdout, input->bytes + piece.offset, &piece, why);
        }
    }
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return status;
    (void)fprintf(stderr, "fathom: the output cannot be written: %s\n", strerror(errno));
    return STATUS_FAILED;
}

static int decode(const settings_t *settings, const decode_input_t *input)
{
    decode_finder_t finder;
    if (input->count == 0) {
        (void)fprintf(stderr, "fathom: there are no bytes to explain\n");
        return STATUS_FAILED;
    }
    const int status = decode_find_begin(&finder, input, settings->protocols)
                           ? explain(settings, input, &finder)
                           : STATUS_FAILED;
    decode_find_free(&finder);
    return status;
}

static int run(const host_t *host, int argc, char **argv)
{
    const char *values[OPTIONS] = {NULL};
    bool is_json = false;
    settings_t settings = {DECODE_ALL, NULL, NULL};
    decode_input_t input;
    (void)host; /* it opens no port */
    const int rest = options_parse(command, argc, argv, table, values);
    if (rest < 0) return STATUS_USAGE;
    if (values[HELP] != NULL) return command_help(&decode_command);
    if (!take_protocol(&settings, values[PROTOCOL]) || !take_model(&settings, values[SENSOR]) ||
        !option_json(command, values[FORMAT], &is_json))
        return STATUS_USAGE;
    settings.format = is_json ? &decode_json : &decode_text;
    if (settings.protocols == 0)
        return usage_error(command, "%s does not speak %s", values[SENSOR], values[PROTOCOL]);
    int status = decode_input_take(&input, command, argc - rest, argv + rest, values[RAW] != NULL);
    if (status == STATUS_OK) status = decode(&settings, &input);
    decode_input_free(&input);
    return status;
}

const command_t decode_command = {
    .name = "decode", .summary = "explains bytes that were seen on the wire", .help = help, .run = run};
