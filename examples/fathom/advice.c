/* SPDX-License-Identifier: MIT */
#include "advice.h"

/* MODBUS Application Protocol V1.1b3, 7; the last two are a gateway's. */
static const char *exception_name(uint8_t number)
{
    static const char *const names[] = {
        [1] = "illegal function",
        [2] = "illegal data address",
        [3] = "illegal data value",
        [4] = "device failure",
        [5] = "acknowledge",
        [6] = "device busy",
        [8] = "memory parity error",
        [10] = "gateway path unavailable",
        [11] = "gateway target silent",
    };
    const char *const name = number < sizeof names / sizeof names[0] ? names[number] : NULL;
    return name != NULL ? name : "unknown";
}

static void print_no_answer(FILE *to, const failure_t *failure)
{
    const uint64_t *const line = failure->counts->line;
    char settings[SETTINGS_TEXT];
    (void)settings_text(&failure->channel->port.line, settings);
    (void)fprintf(to, "no answer from address %u: ", failure->address);
    if (line[FATHOM_LINE_LATE_ANSWERS] != 0)
        (void)fputs("it answers, but too late; try a longer --timeout", to);
    else if (line[FATHOM_LINE_STRAYS] != 0)
        (void)fputs(
            "other frames were heard, so the line works; check --address, and that no other master asks", to);
    else if (line[FATHOM_LINE_DROPPED_BYTES] != 0)
        (void)fprintf(
            to, "bytes were heard, but no Modbus frame; check --baud and --parity (now %s), and for noise",
            settings);
    else
        (void)fprintf(
            to,
            "nothing was heard at all; check the supply, A and B (or RX and TX) swapped, --address, and "
            "--baud and --parity (now %s)",
            settings);
}

static void print_stale(FILE *to, const failure_t *failure)
{
    const uint64_t *const stream = failure->counts->stream;
    char settings[SETTINGS_TEXT];
    (void)settings_text(&failure->channel->port.line, settings);
    if (stream[FATHOM_STREAM_BYTES] == 0)
        (void)fputs(
            "nothing was heard at all; check the supply, the wire from the sensor's TX, and that it sends by "
            "itself (if not: --mode modbus)",
            to);
    else if (stream[FATHOM_STREAM_AMBIGUOUS] + stream[FATHOM_STREAM_UNSURE] != 0)
        (void)fprintf(
            to,
            "bytes were heard that look like frames of %s, but not where one begins; check that nothing else "
            "sends on this line, and for noise",
            failure->sensor->name);
    else
        (void)fprintf(
            to,
            "bytes were heard, but no frame of %s; check --baud and --parity (now %s), and that it is one",
            failure->sensor->name, settings);
}

/* Which values were refused: all of a frame that came by itself, one probe's of an answer, or all of it. */
static void print_values(FILE *to, const failure_t *failure)
{
    const reader_t *const reader = failure->reader;
    uint8_t first = 0;
    uint8_t end = reader->value_count;
    if (reader->request != NULL && reader->left != NULL) {
        for (uint8_t left = *reader->left; left != 0; left &= (uint8_t)(left - 1)) end--;
        first = (uint8_t)(end - 1);
        if (failure->sensor->probes > 1) (void)fprintf(to, "probe %u: ", end);
    }
    (void)fputs("a value that cannot be a distance:", to);
    for (uint8_t i = first; i != end; i++) (void)fprintf(to, " %u", reader->values[i]);
    (void)fprintf(to, "; check that the sensor is %s, and for noise", failure->sensor->name);
}

static void print_malformed(FILE *to, const failure_t *failure)
{
    const fathom_modbus_request_t *const request = failure->reader->request;
    if (request != NULL && request->exchange.status == FATHOM_ERR_MALFORMED)
        (void)fprintf(to,
                      "address %u answered something else than was asked; check that it is %s, and alone at "
                      "this address",
                      failure->address, failure->sensor->name);
    else
        print_values(to, failure);
}

void advice_print(FILE *to, const failure_t *failure)
{
    const fathom_modbus_request_t *const request = failure->reader->request;
    switch (failure->status) {
    case FATHOM_ERR_NO_ANSWER:
        print_no_answer(to, failure);
        break;
    case FATHOM_ERR_STALE:
        print_stale(to, failure);
        break;
    case FATHOM_ERR_MALFORMED:
        print_malformed(to, failure);
        break;
    case FATHOM_ERR_CHECKSUM:
        (void)fprintf(
            to,
            "the answer of address %u was damaged; check --parity, the cable and its termination, and that "
            "no other unit has this address",
            failure->address);
        break;
    case FATHOM_ERR_EXCEPTION:
        (void)fprintf(to, "address %u refused: exception %02u (%s); check that it is %s", failure->address,
                      request->message.exception, exception_name(request->message.exception),
                      failure->sensor->name);
        break;
    case FATHOM_ERR_PORT:
        if (fathom_posix_error(&failure->channel->port) == FATHOM_POSIX_ERR_LOST)
            (void)fprintf(to, "%s; connect it again and start again",
                          fathom_posix_error_text(&failure->channel->port));
        else
            (void)fprintf(to, "%s: the port did not send the request; check the adapter",
                          failure->channel->port.path);
        break;
    default:
        (void)fprintf(to, "unexpected status %d", (int)failure->status);
        break;
    }
}
