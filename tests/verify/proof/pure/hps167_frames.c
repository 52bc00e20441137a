/* SPDX-License-Identifier: MIT */
/*
 * Frames of an HPS-167, any bytes, exactly as many as are said to be there.
 *
 * proves: src/codec/hps167_frames.c
 */
#include "fathom/codec/hps167_frames.h"
#include "assumptions.h"

enum { REGISTERS = 4, OVERHEAD = 4, DATA = FATHOM_HPS167_MEASUREMENT_LENGTH - OVERHEAD };

static void prefix(void)
{
    uint8_t bytes[FATHOM_HPS167_MEASUREMENT_LENGTH];
    for (uint8_t have = 1; have <= FATHOM_HPS167_MEASUREMENT_LENGTH; have++) {
        any_bytes(bytes, have);
        const uint8_t length = fathom_hps167_frame_length(bytes, have);
        /*@ assert length <= FATHOM_HPS167_MEASUREMENT_LENGTH; */
        if (have >= OVERHEAD) (void)fathom_hps167_is_valid(bytes, have);
    }
}

/* A response is as long as its command says, and so are the registers. */
static void response(uint8_t command)
{
    uint8_t frame[FATHOM_HPS167_MEASUREMENT_LENGTH];
    uint8_t data[DATA];
    uint16_t values[REGISTERS];
    const uint8_t expected = fathom_hps167_response_length(command);
    any_bytes(data, (uint8_t)(expected - OVERHEAD));
    const uint8_t length = fathom_hps167_encode_response(frame, data, (uint8_t)(expected - OVERHEAD));
    /*@ assert length == expected; */
    fathom_hps167_decode(frame, values);
}

int main(void)
{
    uint8_t frame[FATHOM_HPS167_REQUEST_LENGTH];
    (void)fathom_hps167_encode_request(frame, any_8());
    (void)fathom_hps167_response_length(any_8());
    prefix();
    response(FATHOM_HPS167_SINGLE);
    response(FATHOM_HPS167_STOP);
    response(FATHOM_HPS167_TEMPERATURE);
    return 0;
}
