/* SPDX-License-Identifier: MIT */
/*
 * Frames of 55 AA, any bytes, exactly as many as are said to be there.
 *
 * proves: src/codec/dyp_55aa.c
 * with: src/codec/dyp_stream.c
 */
#include "fathom/codec/dyp_55aa.h"
#include "assumptions.h"
#include "fathom/codec/dyp_stream.h"

static void prefix(void)
{
    uint8_t bytes[FATHOM_DYP_MAX_RESPONSE];
    for (uint8_t have = 1; have <= FATHOM_DYP_MAX_RESPONSE; have++) {
        any_bytes(bytes, have);
        const uint8_t length = fathom_dyp_55aa_frame_length(bytes, have);
        /*@ assert length <= FATHOM_DYP_MAX_RESPONSE; */
        (void)fathom_dyp_55aa_is_valid(bytes, have);
    }
}

/* A response is as long as its command says, and so are the values. */
static void response(uint8_t command)
{
    uint8_t frame[FATHOM_DYP_MAX_RESPONSE];
    uint16_t values[FATHOM_DYP_PROBES];
    for (uint8_t i = 0; i != fathom_dyp_55aa_value_count(command); i++) values[i] = any_16();
    const uint8_t length = fathom_dyp_55aa_encode_response(frame, any_8(), command, values);
    /*@ assert length <= FATHOM_DYP_MAX_RESPONSE; */
    const uint8_t expected = fathom_dyp_55aa_response_length(command);
    /*@ assert length == expected; */
    any_bytes(frame, length);
    frame[3] = command;
    fathom_dyp_55aa_decode(frame, values);
}

int main(void)
{
    uint8_t frame[FATHOM_DYP_REQUEST_LENGTH];
    (void)fathom_dyp_55aa_encode_request(frame, any_8(), any_8());
    prefix();
    response(FATHOM_DYP_ALL_PROBES);
    response(FATHOM_DYP_SET_ADDRESS);
    for (uint8_t probe = 0; probe != FATHOM_DYP_PROBES; probe++)
        response((uint8_t)(FATHOM_DYP_FIRST_PROBE + probe));
    return 0;
}
