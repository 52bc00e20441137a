/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_VECTORS_H
#define FATHOM_TESTS_VECTORS_H

#include <stddef.h>
#include <stdint.h>

/*
 * Every frame that the datasheets print, as it must be on the wire. Where they misprint one, it stands here
 * corrected and the name says so. The bytes and what they mean are copied from the datasheets, nothing here was
 * computed by Fathom. Sections: A16 6(4) ex 1 is section 6, subsection (4), example 1.
 */
enum { VECTOR_REQUEST = 1, VECTOR_RESPONSE = 2, VECTOR_BOTH = VECTOR_REQUEST | VECTOR_RESPONSE };

enum { VECTOR_BYTES = 27, VECTOR_VALUES = 11 };

/* How many rows there are: none can be lost unseen. */
enum { AUTO_ROWS = 2, MODBUS_ROWS = 31, DYP_ROWS = 5, CRC_ROWS = 8 };

typedef struct {
    const char *source;
    const char *name; /* source, what it is, and which way it goes */
    uint8_t direction;
    const char *hex;
    uint8_t length; /* of what `hex` says, and its bytes: filled in before main() */
    uint8_t bytes[VECTOR_BYTES];
} vector_t;

/* FF .. SUM frames that a sensor sends by itself. */
typedef struct {
    vector_t frame;
    uint8_t probes;
    uint16_t values[4];
} auto_vector_t;

/* A 55 AA frame of the A05 (A05 2(3)) and its meaning. */
typedef struct {
    vector_t frame;
    uint8_t address;
    uint8_t command;
    uint16_t values[4];
} dyp_vector_t;

/* A Modbus frame and its meaning; with a response stands the request that it answers. */
typedef struct {
    uint8_t unit;
    uint8_t function;
    uint16_t address;
    uint16_t operand;               /* the count of registers, or the value of a write to one */
    uint16_t values[VECTOR_VALUES]; /* registers of a read's response */
    uint8_t exception;
} modbus_meaning_t;

typedef struct {
    vector_t frame;
    modbus_meaning_t meaning;
} modbus_vector_t;

typedef struct {
    const char *source;
    const char *hex;
    uint16_t value;
    uint8_t wire[2];
    uint8_t length;
    uint8_t bytes[VECTOR_VALUES];
} crc_vector_t;

extern auto_vector_t auto_vectors[AUTO_ROWS];
extern dyp_vector_t dyp_vectors[DYP_ROWS];
extern modbus_vector_t modbus_vectors[MODBUS_ROWS];
extern crc_vector_t crc_vectors[CRC_ROWS];

#endif
