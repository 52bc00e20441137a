/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_DYP_55AA_H
#define FATHOM_DYP_55AA_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The "DYP protocol" of the A05 on RS-485 (A05 2), in both directions. Pure functions: no time, no I/O, no
 * state.
 *
 *   request                55 AA ADDRESS COMMAND SUM                                    5 bytes
 *   response, all probes   55 AA ADDRESS 01 1H 1L 2H 2L 3H 3L 4H 4L SUM                13 bytes
 *   response, one probe    55 AA ADDRESS 10..13 H L SUM                                 7 bytes
 *   response, set address  55 AA ADDRESS 03 SUM                                         5 bytes
 *
 * H and L are the high and the low byte of a distance in mm; SUM is the low byte of the sum of all before it.
 * Where the datasheet's tables and its examples differ the examples are right: the sum of its response with four
 * distances is 62 (printed: 60), and the command that sets the address is 03 with a response of 5 bytes
 * (printed: 10 and 7).
 *
 * What it cannot do: a sum of 8 bits lets one in 256 of the frames pass that are damaged in more than one
 * byte. Setting the address is a command to every unit that hears it, with the new address where others have the
 * old one, and its response is the same bytes again: a05_dyp.h and line.h have what follows from that.
 */
enum {
    FATHOM_DYP_ALL_PROBES = 0x01,
    FATHOM_DYP_SET_ADDRESS = 0x03,
    FATHOM_DYP_FIRST_PROBE = 0x10 /* the next three are the other probes */
};

enum {
    FATHOM_DYP_ANY_ADDRESS = 0xFF, /* all units obey; whether one responds is not in the datasheet */
    FATHOM_DYP_REQUEST_LENGTH = 5,
    FATHOM_DYP_MAX_RESPONSE = 13
};

/* Bytes of the response to a command: 13, 7 or 5; 0: there is no such command. */
uint8_t fathom_dyp_55aa_response_length(uint8_t command);

/* How many distances the response to a command carries: 4, 1 or 0. */
uint8_t fathom_dyp_55aa_value_count(uint8_t command);

/* Writes the request of 5 bytes to `frame` and returns 5. address: 1..254, FATHOM_DYP_ANY_ADDRESS, or the new
 * one with FATHOM_DYP_SET_ADDRESS. */
uint8_t fathom_dyp_55aa_encode_request(uint8_t *frame, uint8_t address, uint8_t command);

/*
 * The length of the response that begins with these `have` (>= 1) bytes, as far as they tell:
 *   0          no response begins like this: drop the first byte and look again
 *   > have     so many bytes are needed to know more (4 until the command is there)
 *   <= have    the response is here, with its sum still to be checked
 */
uint8_t fathom_dyp_55aa_frame_length(const uint8_t *bytes, uint8_t have);

/* Do these `length` (>= 1) bytes end in the sum of those before? */
bool fathom_dyp_55aa_is_valid(const uint8_t *frame, uint8_t length);

/* Copies the distances out of a valid response, as they were sent: 4, 1 or none. */
void fathom_dyp_55aa_decode(const uint8_t *frame, uint16_t *values);

/* The device's side: writes the response to `command` to `frame` and returns its length. `values`: as many as
 * the command needs. The command exists. */
uint8_t fathom_dyp_55aa_encode_response(uint8_t *frame, uint8_t address, uint8_t command,
                                        const uint16_t *values);

#ifdef __cplusplus
}
#endif

#endif
