/* SPDX-License-Identifier: MIT */
/*
 * A second simulation of the A16, the A05 and the HPS-167S, written from the datasheets' text alone. It knows
 * neither the library nor the first simulation. What the text leaves open is a choice (choice_rows.h) that a
 * seed draws; a test can force single choices by name.
 *
 * Time is simulated, in microseconds, and never goes back. Inputs may be handed over ahead of their time, in
 * the order of their times; they count when second_run() reaches them. Hand a byte over before running the
 * device past the byte's start: else a silence that the byte ends would already have ended a frame.
 */
#ifndef SECOND_H
#define SECOND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SECOND_PROBES     4
#define SECOND_NOTHING    (-1) /* no object in front of the probe */
#define SECOND_NEVER      UINT64_MAX
#define SECOND_LOG_EVENTS 4096
#define SECOND_FRAME_MAX  64
#define SECOND_INPUTS     1024
#define SECOND_OUTPUTS    512
#define SECOND_SCENES     64
#define SECOND_JOBS       4

typedef enum {
    SECOND_A16_AUTO,       /* UART automatic; RX selects processed (high) or real time (low) */
    SECOND_A16_CONTROLLED, /* UART controlled; a falling edge of RX starts a measurement */
    SECOND_A16_RS232,      /* automatic until a Modbus command comes */
    SECOND_A16_RS485,      /* Modbus */
    SECOND_A05_UART,       /* automatic until a Modbus command comes */
    SECOND_A05_RS485,      /* 55 AA frames and Modbus */
    SECOND_HPS167S,
    SECOND_HPS167,   /* UART, frames of its own */
    SECOND_RELATIVE, /* frames, or Modbus, as a row of relatives.h says */
    SECOND_TALKERS,  /* the ones before it send bytes, those from here on a level */
    SECOND_A16_PWM = SECOND_TALKERS,
    SECOND_A16_SWITCH,
    SECOND_A05_RELAY,
    SECOND_RELATIVE_PULSE,
    SECOND_KINDS
} second_kind_t;

typedef struct {
    uint32_t baud;
    char parity; /* 'N', 'E' or 'O' */
    uint8_t stop_bits;
} second_line_t;

/* Distance of the object in front of each probe, or SECOND_NOTHING. All but the A05 use mm[0]. */
typedef struct {
    int32_t mm[SECOND_PROBES];
} second_scene_t;

typedef struct {
    const char *name;
    int64_t value;
} second_override_t;

typedef struct second_relative second_relative_t;

typedef struct {
    second_kind_t kind;
    uint64_t seed;   /* 0 draws nothing: every choice takes its usual value */
    uint8_t address; /* the address set in the sensor before; 0: the factory's 0x01 */
    uint8_t fitted;  /* A05: bit n is probe n + 1; 0: all four */
    second_scene_t scene;
    bool no_misprints; /* choices that stem from a likely misprint keep their usual value */
    const second_override_t *overrides;
    size_t override_count;
    const second_relative_t *relative; /* of a relative */
    bool is_late;                      /* a relative gives the later of two answers */
} second_config_t;

/* A byte that the device sent, handed out when its last stop bit is over. */
typedef struct {
    uint8_t value;
    uint64_t start_us, end_us;
    second_line_t line;
} second_byte_t;

typedef void (*second_sink_t)(void *context, const second_byte_t *byte);

typedef enum {
    SECOND_EVENT_POWER, /* new_value: 1 on, 0 off; off: old_value counts the sent bytes that were cut off */
    SECOND_EVENT_MEASUREMENT, /* a measurement was sent: raw, sent, true_mm */
    SECOND_EVENT_RESPONSE,    /* another response was sent: raw */
    SECOND_EVENT_SETTING,     /* a setting was taken: reg, old_value, new_value, flash_writes */
    SECOND_EVENT_EFFECT, /* address, line, mode or data type changed: see the fields of every event; of a level
                                 new_value: 1 high or closed */
    SECOND_EVENT_REFUSED,  /* raw: the request; exception 0: silence, 9: echoed, not taken */
    SECOND_EVENT_RESET,    /* factory reset */
    SECOND_EVENT_NOISE,    /* a byte that was not understood: raw[0]; new_value: 1 taken in, 0 dropped */
    SECOND_EVENT_DISCARDED /* bytes that made no frame: raw, old_value their number */
} second_event_kind_t;

typedef struct {
    second_event_kind_t kind;
    uint64_t time_us; /* when it happened; a frame's bytes are on the wire from start_us to end_us */
    uint64_t start_us, end_us;
    /* In force at time_us. */
    second_line_t line;
    uint8_t address;
    bool automatic;   /* sends unasked */
    bool served_real; /* real-time values in automatic output */
    /* Measurements. */
    bool asked;
    bool fault;                        /* an abnormal packet */
    bool no_target;                    /* at least one fitted probe of those asked for saw nothing */
    bool not_ready;                    /* the value before the first response time is over */
    uint8_t probes;                    /* bit n: probe n + 1 is in the frame */
    uint8_t fitted;                    /* bit n: probe n + 1 is fitted */
    uint64_t seen_from_us, seen_to_us; /* the values stem from the scene between these times */
    int32_t true_mm[SECOND_PROBES];    /* what the probe saw: the distance, or SECOND_NOTHING */
    uint16_t sent[SECOND_PROBES];      /* the value as sent */
    /* Settings and refusals. */
    uint8_t function, exception;
    uint16_t reg; /* Modbus register, or 0xAA00 + command of a 55 AA frame */
    int64_t old_value, new_value;
    uint32_t flash_writes; /* so far */
    uint8_t raw[SECOND_FRAME_MAX];
    uint8_t raw_len;
} second_event_t;

#define RANGE(name, ...)    CHOICE_##name,
#define LIST(name, ...)     CHOICE_##name,
#define MISPRINT(name, ...) CHOICE_##name,
typedef enum {
#include "choice_rows.h"
    CHOICE_COUNT
} second_choice_t;
#undef RANGE
#undef LIST
#undef MISPRINT

typedef struct {
    int64_t value;
    uint16_t weight; /* 0: only by override */
    const char *meaning;
} second_value_t;

typedef struct {
    const char *name, *section, *says;
    uint32_t kinds; /* bit: 1 << second_kind_t */
    bool misprint;
    const second_value_t *values; /* NULL: a range from low to high */
    size_t value_count;
    int64_t low, high, usual;
} second_choice_row_t;

/* choices.c: what a seed draws. */
int64_t second_choice_draw(second_choice_t choice, uint64_t seed);
bool second_choice_allows(second_choice_t choice, int64_t value);
const char *second_choice_meaning(second_choice_t choice, int64_t value);

typedef struct second_device second_device_t;

/* false: an override names no choice, or a value that the choice does not have. */
bool second_init(second_device_t *device, const second_config_t *config);
int64_t second_choice(const second_device_t *device, second_choice_t choice);
void second_print_choices(const second_device_t *device, FILE *out);

/* Inputs. */
void second_power(second_device_t *device, bool on, uint64_t at_us);
void second_host_byte(second_device_t *device, uint8_t value, uint64_t start_us, uint64_t end_us,
                      second_line_t line);
void second_rx_level(second_device_t *device, bool low, uint64_t at_us); /* also begin and end of a break */
void second_scene(second_device_t *device, const second_scene_t *scene, uint64_t at_us);
void second_fault(second_device_t *device, bool failed, uint64_t at_us); /* HPS-167S: the sensor fails */

/* The next time at which the device has to run, or SECOND_NEVER. */
uint64_t second_next_us(const second_device_t *device);
/* Runs it up to and including until_us. */
void second_run(second_device_t *device, uint64_t until_us, second_sink_t sink, void *context);

/* TX of an A16 with PWM or switch output is high; the contact of the A05's relay is closed. */
bool second_output(const second_device_t *device);

/* The device's own truth. Events are counted from 0; NULL: not there yet, or no longer in the ring. */
uint64_t second_log_count(const second_device_t *device);
const second_event_t *second_log_at(const second_device_t *device, uint64_t index);

typedef struct {
    bool powered, alive, automatic, served_real;
    uint8_t address;
    second_line_t line;
    uint32_t flash_writes;
    uint32_t lost; /* inputs or bytes that found a full queue; stays 0 in a sound test */
} second_state_t;
second_state_t second_state(const second_device_t *device);

#endif
