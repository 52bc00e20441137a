/* SPDX-License-Identifier: MIT */
#include "decode/decode_frame.h"

#include "fathom/dyp_frame.h"
#include "fathom/dyp_protocol.h"

static const char *const probe_names[] = {"probe 1", "probe 2", "probe 3", "probe 4"};

/* Frames that a sensor sends by itself, or when it is triggered. */
static void decode_stream(decode_frame_t *frame)
{
    uint16_t values[FATHOM_DYP_PROBES];
    if (frame->piece->protocol == DECODE_STREAM_ONE) {
        fathom_dyp_frame_decode(frame->bytes, values, 1);
        decode_ultrasonic(decode_mean(frame, "a16", "A16 2(3), 3(4), 5(3)", "automatic or controlled output"),
                          "distance", values[0]);
        return;
    }
    fathom_dyp_frame_decode(frame->bytes, values, FATHOM_DYP_PROBES);
    decode_meaning_t *const meaning = decode_mean(frame, "a05", "A05 1(2)", "automatic output");
    for (uint8_t i = 0; i != FATHOM_DYP_PROBES; i++) decode_ultrasonic(meaning, probe_names[i], values[i]);
}

static void decode_set_address(decode_frame_t *frame)
{
    decode_meaning_t *const meaning = decode_mean(frame, "a05", "A05 2(3)5", "set the address");
    decode_field_t *const field = decode_number(meaning, "new address", frame->unit, "");
    if (frame->unit == 0 || frame->unit == FATHOM_DYP_ANY_ADDRESS) field->note = "not from 1 to 254";
    frame->unit = -1; /* every unit that hears it */
    decode_note(frame, "it has no old address in it: every a05 on the line obeys");
}

static void decode_dyp(decode_frame_t *frame)
{
    const uint8_t command = frame->bytes[3];
    const bool is_answer = frame->piece->direction == DECODE_ANSWER;
    uint16_t values[FATHOM_DYP_PROBES];
    frame->unit = frame->bytes[2];
    frame->code = command;
    frame->code_is = "command";
    if (frame->unit == FATHOM_DYP_ANY_ADDRESS && command != FATHOM_DYP_SET_ADDRESS)
        decode_note(frame, "FF is the broadcast address; whether a unit answers it is not in the datasheet");
    const uint8_t count = fathom_dyp_protocol_values(command);
    if (command == FATHOM_DYP_SET_ADDRESS) {
        decode_set_address(frame);
    } else if (count == 0) {
        (void)decode_mean(frame, "a05", "A05 2(3)2", "no command of it");
    } else if (!is_answer) {
        if (count == 1)
            (void)decode_mean(frame, "a05", "A05 2(3)4", "measure with %s",
                              probe_names[command - FATHOM_DYP_FIRST_PROBE]);
        else
            (void)decode_mean(frame, "a05", "A05 2(3)3", "measure with all probes");
    } else {
        fathom_dyp_protocol_decode(frame->bytes, values);
        decode_meaning_t *const meaning =
            count == 1 ? decode_mean(frame, "a05", "A05 2(3)4", "one probe has measured")
                       : decode_mean(frame, "a05", "A05 2(3)3", "all probes have measured");
        const uint8_t first = count == 1 ? (uint8_t)(command - FATHOM_DYP_FIRST_PROBE) : 0;
        for (uint8_t i = 0; i != count; i++) decode_ultrasonic(meaning, probe_names[first + i], values[i]);
    }
}

void decode_sums(decode_frame_t *frame)
{
    frame->checksum_length = 1;
    frame->checksum[0] = fathom_dyp_sum(frame->bytes, (uint8_t)(frame->piece->length - 1));
    if (frame->piece->protocol == DECODE_DYP)
        decode_dyp(frame);
    else
        decode_stream(frame);
}
