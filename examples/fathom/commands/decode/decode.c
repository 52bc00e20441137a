/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "cli/command.h"
#include "cli/sensor_words.h"
#include "commands/commands.h"
#include "commands/decode/decode.h"
#include "fathom/codec/crc16.h"
#include "fathom/codec/dyp_stream.h"
#include "fathom/codec/modbus_rtu.h"

typedef struct {
    const char *sensor; /* NULL: not given */
    uint8_t protocol;   /* its place in protocols[] */
    bool is_json;
    bool is_raw;
    uint8_t protocols;   /* DECODE_... */
    const model_t *only; /* as in decode_context_t */
    const decode_format_t *format;
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

static bool set_up(settings_t *settings, const origin_t *origin)
{
    static const uint8_t protocols[] = {DECODE_ALL, DECODE_MODBUS, DECODE_DYP,
                                        DECODE_STREAM_ONE | DECODE_STREAM_FOUR};
    settings->protocols = protocols[settings->protocol];
    settings->format = settings->is_json ? &decode_json : &decode_text;
    if (settings->sensor == NULL) return true;
    const model_t *const model = model_word(settings->sensor, origin);
    if (model == NULL) return false;
    settings->only = model;
    settings->protocols &= model->protocols;
    if (settings->protocols != 0) return true;
    return reject(origin, "%s has no frames of this --protocol.", model->name);
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
        (void)fprintf(stderr, "fathom: there are no bytes to explain.\n");
        return STATUS_FAILED;
    }
    const int status = decode_find_begin(&finder, input, settings->protocols)
                           ? explain(settings, input, &finder)
                           : STATUS_FAILED;
    decode_find_free(&finder);
    return status;
}

static int start(const host_t *host, const arguments_t *arguments)
{
    settings_t *const settings = arguments->settings;
    const origin_t origin = {.command = arguments->command->name};
    decode_input_t input;
    (void)host; /* it opens no port */
    if (!set_up(settings, &origin)) return STATUS_USAGE;
    int status = decode_input_read(&input, &origin, arguments->count, arguments->words, settings->is_raw);
    if (status == STATUS_OK) status = decode(settings, &input);
    decode_input_free(&input);
    return status;
}

const command_t decode_command = {
    .name = "decode",
    .summary = "Explain bytes that were seen on the wire",
    .usage = "[OPTIONS] HEX...\n[OPTIONS] [FILE]",
    .about = "HEX is bytes such as 01 03, 0103 or 0x01,0x03. FILE has such bytes; without\n"
             "FILE, or with -, they are read from standard input. A # begins a comment. A\n"
             "response behind its request is explained by it. A sum of 8 bits proves little:\n"
             "a stream that begins inside a frame may be read out of step.\n",
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
