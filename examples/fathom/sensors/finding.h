/* SPDX-License-Identifier: MIT */
#ifndef FINDING_H
#define FINDING_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/hal.h"
#include "output/record.h"

struct model;

/* What a scan finds. */
typedef enum {
    SCAN_SENSOR = 1, /* one of the three */
    SCAN_OTHER,      /* responses in Modbus, but is none of the three */
    SCAN_DAMAGED,    /* whatever is at this address, none of its responses was whole */
    SCAN_NOT_MODBUS, /* answers at these line settings, but not in Modbus; no address */
    SCAN_SENDER,     /* sends by itself, and is none of the three; no address */
    SCAN_MASTER      /* requests of another master, which asks this address */
} scan_kind_t;

/* How a sensor is to be read. */
typedef enum { SCAN_MODBUS = 1, SCAN_AUTO, SCAN_DYP } scan_mode_t;

typedef struct {
    fathom_line_settings_t line;
    const struct model *model; /* of a sensor */
    uint8_t kind;              /* scan_kind_t */
    uint8_t mode;              /* scan_mode_t, of a sensor */
    uint8_t address;           /* 0: none */
    bool is_double;            /* two responses came to one request */

    /* of an A16 or A05 that was asked */
    bool has_value;
    uint16_t value; /* of its only or its first probe, as it was sent */

    /* of an HPS-167S: #1, #2 and #3 */
    bool has_interface;
    bool has_config;
    bool has_details;
    bool has_termination; /* with has_config: the resistor is on */
    fathom_hps167s_version_t interface;
    fathom_hps167s_details_t details;
} scan_finding_t;

/* What a sensor has reported to a scan, for text and JSON. Words that are not known are "" or NULL, numbers NO_VALUE. */
typedef struct {
    char interface_version[32];
    char sensor_version[32];
    char uuid[2 * FATHOM_HPS167S_UUID_LENGTH + 1];
    int64_t termination; /* 1: the resistor is on */
    const char *status;  /* of the value, a word of status_word.h */
    int64_t distance_mm;
    int64_t raw;
} finding_facts_t;

#endif
