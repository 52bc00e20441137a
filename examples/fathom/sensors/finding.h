/* SPDX-License-Identifier: MIT */
#ifndef FINDING_H
#define FINDING_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/codec/hps167s_registers.h"
#include "fathom/hal.h"
#include "fathom/status.h"
#include "output/record.h"

struct model;

/* The kind of a device that a scan found. */
typedef enum {
    SCAN_SENSOR = 1, /* one of the models */
    SCAN_OTHER,      /* it responds in Modbus, but is none of the models */
    SCAN_DAMAGED,    /* none of its responses was whole */
    SCAN_NOT_MODBUS, /* it responds at these line settings, but not in Modbus; it has no address */
    SCAN_SENDER,     /* it sends automatically, and is none of the models; it has no address */
    SCAN_MASTER      /* another master sends requests to this address */
} scan_kind_t;

/* How to read a sensor. */
typedef enum { SCAN_MODBUS = 1, SCAN_AUTO, SCAN_DYP } scan_mode_t;

typedef struct {
    fathom_line_settings_t line;
    const struct model *model; /* of a sensor */
    uint8_t kind;              /* scan_kind_t */
    uint8_t mode;              /* scan_mode_t, of a sensor */
    uint8_t address;           /* 0: none */
    bool is_double;            /* two responses to one request were received */

    /* of an A16 or A05 that responded */
    bool has_value;
    uint16_t value; /* of its first probe, as it was sent */

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

/* The reads by which a model identifies a device during a scan. */
typedef struct inquiry inquiry_t;
struct inquiry {
    /* Reads `count` registers and repeats the read after a damaged or unsuitable response, and after silence up to
     * silence_tries times. Returns true if status is FATHOM_OK. */
    bool (*ask)(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us,
                uint8_t silence_tries);
    fathom_status_t status;  /* of the newest response; at first of that to model_t.scan.first */
    const uint16_t *values;  /* of that response */
    scan_finding_t *finding; /* to fill in */
};

/* An A16 responds to 0x0101 in about 120 ms and to 0x0100 in up to 520, an A05 needs about 100 ms a probe. */
enum { INQUIRY_MEASURE_US = 300000, INQUIRY_SLOW_US = 1000000 };

#endif
