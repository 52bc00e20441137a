/* SPDX-License-Identifier: MIT */
/* Inside of a device; a header only for its size: tests need no heap. For the files of this folder. */
#ifndef SECOND_DEVICE_H
#define SECOND_DEVICE_H

#include "second.h"

enum {
    RESPONSE_SILENCE = 0,
    RESPONSE_OTHER = 7,
    RESPONSE_TAKEN = 8,
    RESPONSE_ECHOED = 9
}; /* 1..4: an exception */

typedef enum { INPUT_POWER, INPUT_START, INPUT_BYTE, INPUT_LEVEL, INPUT_SCENE, INPUT_FAULT } input_kind_t;

typedef struct {
    input_kind_t kind;
    uint64_t time_us, start_us;
    bool on;
    uint8_t value;
    second_line_t line;
    second_scene_t scene;
} input_t;

typedef enum {
    TIMER_ALIVE,
    TIMER_FRAME_END,
    TIMER_JOB,
    TIMER_AFTER, /* what changes when a response is out */
    TIMER_TICK,  /* next unasked frame */
    TIMER_LEVEL,
    TIMER_TRIGGER,
    TIMER_BACK,
    TIMER_COUNT
} timer_slot_t;

/* A request that is being served. */
typedef struct {
    uint8_t bytes[SECOND_FRAME_MAX];
    size_t len;
    uint64_t begin_us, end_us; /* of the request on the wire */
    uint64_t due_us;           /* the response begins */
    bool answered;             /* false: broadcast */
    uint8_t reply_address;
    uint8_t protocol;   /* PROTOCOL_... */
    second_line_t line; /* settings of the response */
    bool bad_crc;       /* HPS-167S: to be refused */
} job_t;
enum { PROTOCOL_MODBUS, PROTOCOL_DYP, PROTOCOL_TRIGGER, PROTOCOL_HPS167 };

typedef struct {
    bool select_low;                          /* A16: the level that RX has long enough */
    uint64_t select_us;                       /* A16: since when */
    uint64_t fall_us, trigger_free_us;        /* A16: last falling edge of RX; T1 is over */
    uint16_t type, polarity, threshold;       /* A16: 0207, 0205, 0206 */
    uint8_t stored_address, stored_type;      /* loaded at power-on */
    uint8_t linger, linger_behind;            /* automatic frames still to come; right behind the response */
    bool level_recorded, low_seen, high_seen; /* A05 */
    uint64_t set_address_us;                  /* A05: the last 55 AA request for an address */
    uint64_t dyp_free_us;                     /* A05: t1 is over */
    uint16_t last_sent[SECOND_PROBES];
} ultrasonic_t;

typedef struct {
    uint8_t id, baud_code, termination, auto_out, warm_s;
    uint32_t reconnect_ms;
    int16_t offset, filter;
} hps_settings_t;

typedef struct {
    hps_settings_t used, set, flash; /* in force; as last set; as loaded at power-on */
    uint64_t warm_since_us, pause_until_us, fault_since_us;
    bool failed, fault_sent, unasked_stopped;
    uint8_t version[6], details[22]; /* what #1 and #3 read */
} hps_t;

/* What has a level in place of bytes. */
typedef struct {
    bool high, near;
    uint64_t fall_us, free_us, changed_us;
    uint8_t nearer, farther; /* in a row */
} levels_t;

/* A kind leaves out what it does nothing of; without `hears` it hears its own line settings. */
struct second_device;
typedef struct {
    void (*init)(struct second_device *device);
    void (*power_on)(struct second_device *device);
    void (*alive)(struct second_device *device);
    void (*byte)(struct second_device *device);  /* one more byte in rx; may take the frame */
    void (*frame)(struct second_device *device); /* silence after the bytes in rx */
    void (*pulse)(struct second_device *device, const input_t *byte);
    void (*job)(struct second_device *device, const job_t *job);
    void (*timer)(struct second_device *device, timer_slot_t slot);
    void (*level)(struct second_device *device, bool low);
    void (*fault)(struct second_device *device, bool failed);
    void (*unasked)(struct second_device *device); /* sends one automatic frame */
    bool (*hears)(const struct second_device *device, second_line_t line);
    uint64_t (*silence_us)(const struct second_device *device);
} hooks_t;

struct second_device {
    second_config_t config;
    int64_t choice[CHOICE_COUNT];
    const hooks_t *hooks;
    uint64_t now_us, random;
    bool powered, alive, automatic, served_real;
    uint64_t power_on_us;
    uint8_t address;
    second_line_t line;
    int32_t next_address; /* taken at TIMER_AFTER; -1: none */
    second_line_t next_line;
    uint32_t flash_writes, lost;

    input_t inputs[SECOND_INPUTS];
    size_t input_first, input_count;
    uint64_t timer_us[TIMER_COUNT];

    uint8_t rx[SECOND_FRAME_MAX];
    size_t rx_len;
    bool rx_bad, level_low;
    uint64_t level_since_us;
    uint64_t rx_begin_us, rx_end_us;
    second_line_t rx_line;

    second_byte_t out[SECOND_OUTPUTS];
    size_t out_first, out_count;
    uint64_t out_begin_us, out_free_us; /* the last block of bytes on the wire */

    job_t jobs[SECOND_JOBS];
    size_t job_count;

    struct {
        uint64_t time_us;
        second_scene_t scene;
    } scenes[SECOND_SCENES];
    uint64_t scene_count;

    ultrasonic_t us;
    hps_t hps;
    levels_t levels;

    second_event_t unsent; /* stands in for the event of a response that is not sent */
    second_event_t log[SECOND_LOG_EVENTS];
    uint64_t log_count;
};

extern const hooks_t second_a16_hooks, second_a05_hooks, second_hps_hooks, second_hps167_hooks,
    second_level_hooks, second_relative_hooks;

/* wire.c */
uint16_t second_wire_crc16(const uint8_t *bytes, size_t len);
uint8_t second_wire_sum8(const uint8_t *bytes, size_t len);
uint64_t second_wire_bits_ns(second_line_t line, uint32_t bits);
uint32_t second_wire_character_bits(second_line_t line);
bool second_wire_same(second_line_t a, second_line_t b);
uint64_t second_wire_length_us(const second_device_t *d, size_t len, second_line_t line);
/* Puts bytes on the wire at at_us, or as soon as it is free. */
void second_wire_send(second_device_t *d, const uint8_t *bytes, size_t len, uint64_t at_us,
                      second_line_t line, second_event_t *event);
void second_wire_input(second_device_t *d, const input_t *input);
void second_wire_drop_rx(second_device_t *d);

/* truth.c */
second_event_t *second_truth_log(second_device_t *d, second_event_kind_t kind);
/* What a probe saw: the scene at from_us, or its mean over the span. */
int32_t second_truth_seen(const second_device_t *d, size_t probe, uint64_t from_us, uint64_t to_us,
                          bool mean);
uint32_t second_truth_random(second_device_t *d, uint32_t below);
/* A span of time between the shortest and the drawn end, as any_response_jitter tells. */
uint64_t second_truth_span(second_device_t *d, uint64_t shortest_us, second_choice_t longest);

/* slave.c: jobs, and what the A16 and the A05 have in common. */
void second_job_add(second_device_t *d, const job_t *job, bool queue);
/* Adds the CRC, sends at once and logs; the caller fills the event. A broadcast's response is neither. */
second_event_t *second_slave_response(second_device_t *d, const job_t *job, uint8_t *frame, size_t len,
                                      second_event_kind_t kind);
second_event_t *second_slave_echo(second_device_t *d, const job_t *job);
void second_slave_refuse(second_device_t *d, const job_t *job, int64_t how); /* silence, exception or echo */
/* Function 03 or 06 of 8 bytes is served; the others are refused. */
typedef void (*serve_t)(second_device_t *d, const job_t *job);
void second_slave_job(second_device_t *d, const job_t *job, serve_t read, serve_t write);
void second_slave_setting(second_device_t *d, uint16_t reg, int64_t old_value, int64_t new_value, bool flash);
/* A Modbus frame in rx: true if the job is to be served. Ends the automatic output. */
bool second_slave_frame(second_device_t *d, job_t *job);
bool second_slave_by_length(const second_device_t *d); /* rx holds a whole request */
uint64_t second_slave_silence_us(const second_device_t *d);
void second_slave_write_address(second_device_t *d, const job_t *job, uint16_t value, int64_t zero);
void second_slave_tick(second_device_t *d, uint64_t period_us);
void second_slave_effect(second_device_t *d); /* next_address and next_line are in force from now */
void second_slave_discard(second_device_t *d);

/* hps167s.c and hps_commands.c */
second_line_t second_hps_line(uint8_t code);
hps_settings_t second_hps_factory(const second_device_t *d);
bool second_hps_warming_up(const second_device_t *d);
bool second_hps_fails(second_device_t *d); /* this measurement, by itself */
/* Writes the 8 bytes of a measurement, and what they stem from. */
void second_hps_fill(second_device_t *d, uint64_t at_us, bool failed, uint8_t *data, second_event_t *seen);
void second_hps_log(second_event_t *event, const second_event_t *seen, const job_t *job);
void second_hps_send(second_device_t *d, const job_t *job, bool failed);
void second_hps_job(second_device_t *d, const job_t *job);

/* hps167.c */
uint16_t second_hps167_crc(const uint8_t *bytes, size_t len);

static inline int64_t chosen(const second_device_t *d, second_choice_t choice) { return d->choice[choice]; }
static inline uint64_t chosen_us(const second_device_t *d, second_choice_t choice)
{
    return (uint64_t)d->choice[choice];
}
static inline uint16_t word_at(const uint8_t *bytes) { return (uint16_t)(bytes[0] << 8 | bytes[1]); }
static inline void put_word(uint8_t *bytes, uint16_t value)
{
    bytes[0] = (uint8_t)(value >> 8);
    bytes[1] = (uint8_t)(value & 0xFF);
}

#endif
