/* SPDX-License-Identifier: MIT */
/* The relatives: modules that send the frame of an A16, take its trigger, give its pulse or have its registers, and the
 * other forms of an A05 and an HPS-167S. One row is one module in one mode, with what public sources say of it. */
#ifndef SECOND_RELATIVES_H
#define SECOND_RELATIVES_H

#include "second.h"

/* For a pulse: neither a target nor the pulse that means that there is none. */
#define SECOND_NO_PULSE (-2)

typedef enum {
    FORM_AUTO = 1, /* frames by itself */
    FORM_CONTROLLED,
    FORM_PULSE,
    FORM_FREE_PULSE, /* pulses by itself */
    FORM_MODBUS,
    FORM_55AA,
    FORM_0A
} second_form_t;

typedef enum { TRIGGER_NONE, TRIGGER_LOW, TRIGGER_HIGH, TRIGGER_BYTE } second_trigger_t;

/* 0: no source says it. */
struct second_relative {
    const char *name; /* of the module, or of a shop */
    second_kind_t kind;
    second_form_t form;
    uint32_t baud;
    uint16_t min_mm, max_mm;
    uint16_t gap_ms; /* least time between two triggers, or time from one measurement to the next */
    second_trigger_t trigger;
    uint8_t trigger_byte;
    uint16_t least_us, most_us; /* width of the trigger */
    uint16_t from_ms, to_ms;    /* response, to the frame's end at the earliest, to its begin at the latest */
    uint16_t real_ms;           /* Modbus: longest response with the real-time value */
    /* The values 0, FFFB, FFFD and FFFE: n no target, i interference, u no distance, ? not said. NULL: "????". */
    const char *values;
    uint16_t us_per_dm;
    uint8_t none_ms; /* width of the pulse without a target */
    bool has_temperature;
};

extern const second_relative_t second_relatives[];
extern const size_t second_relatives_count;

#endif
