/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_AUTO_RIG_H
#define FATHOM_TESTS_AUTO_RIG_H

#include "drivers.h"
#include "fake_pin.h"
#include "fathom/engine/line_pins.h"
#include "fathom/sensor/a16_controlled.h"

/* A fake UART, a real line on it, a pin, and a driver that listens there, with what its polls said. At 9600 8N1. */
enum {
    RIG_BYTE_US = 1042,
    RIG_PERIOD_US = 100000,
    RIG_GAP_US = 5000,
    RIG_START_US = 1000,
    RIG_HPS_LENGTH = 13,
    RIG_EDGES = 128,
    FRAME_US = 4 * RIG_BYTE_US /* of an A16 */
};

typedef struct {
    fake_t fake;
    uint8_t frame[27]; /* holds the longest response */
    fathom_line_parts_t line_parts;
    fathom_line_t line;
    fathom_pin_t pin;             /* a contact */
    bool level;                   /* of it, which the test sets or plans */
    uint32_t edges_us[RIG_EDGES]; /* planned, in the order of time */
    unsigned edges;
    unsigned edge;           /* the next one */
    fathom_sensor_t sensor;  /* the test's, after it has started the line */
    fathom_sample_t sample;  /* the last one */
    fathom_sample_t last[4]; /* the last one of each probe */
    uint32_t silent_us;      /* of the next period, which rig_send has used up */
    unsigned samples;
    unsigned stales;
    unsigned damaged; /* FATHOM_ERR_CHECKSUM */
    unsigned malformed;
    unsigned ports;
} rig_t;

extern rig_t rig;

/* All begins anew, with a line that has just been made at this time, and the pin low. */
void rig_start(uint32_t now_us);

/* The level turns in_us from now. */
void rig_turn(uint32_t in_us);

/* So many samples so far, the last with this kind and number. */
void rig_expect(unsigned samples, uint8_t kind);

/* Polls the driver once, checked. */
fathom_status_t rig_poll(void);

/* Time goes on in steps; after each the driver is polled until it has nothing more to say, as its header
 * advises. */
void rig_run(uint32_t for_us, uint32_t step_us);

/* Calls a driver in a loop of 1 ms until it has ended: it sends exactly this request, and the response comes after 300
 * ms. */
fathom_status_t rig_transaction(fathom_status_t (*call)(void), const uint8_t *request, size_t request_length,
                                const uint8_t *response, size_t length);

/* One period of 100 ms: silence, with a frame at its end, byte by byte; and the first 5 ms of the next one, which end
 * the frame. Returns what comes of it: FATHOM_OK, FATHOM_ERR_MALFORMED, or FATHOM_PENDING. */
fathom_status_t rig_send(const uint8_t *frame, size_t length, uint32_t step_us);

/* FF, each value high byte first, the low byte of the sum of all before it (A16 2(3), A05 1(2)). Returns the length. */
size_t rig_dyp_stream(uint8_t *frame, const uint16_t *values, unsigned count);

/* The response to #5 with these registers, and its CRC bit by bit, from the text of HPS-167S 2.2.5. */
void rig_hps_frame(uint8_t *frame, uint8_t address, uint16_t a, uint16_t b, uint16_t c, uint16_t d);
void rig_hps_seal(uint8_t *frame);

/* A measurement of an HPS-167 with these registers, 01 for each of the three unknown bytes, and its CRC bit by bit, from
 * the definition of CRC-16/CCITT-FALSE. */
enum { RIG_HPS167_LENGTH = 15 };
void rig_hps167_frame(uint8_t *frame, uint16_t a, uint16_t b, uint16_t c, uint16_t d);
uint16_t rig_hps167_crc(const uint8_t *bytes, size_t length);

/* ---- an A16 that is triggered, by the fake UART's break unless the config names the pin ---- */

typedef struct {
    fathom_output_t
        trigger; /* this, the config and the model are the test's to change before it starts anew */
    fathom_a16_controlled_config_t config; /* names `model` */
    fathom_model_facts_t model;
    fathom_a16_controlled_t a16;
    fake_pin_t pin;
} controlled_t;

extern controlled_t controlled;

extern const uint8_t controlled_1953[4]; /* A16 3(5) */
extern const uint8_t controlled_511[4];  /* FF + 01 + FF = 1FF */

/* For cmocka: the default config. */
int controlled_set_up(void **state);

/* Initialises the driver as it is. */
fathom_status_t controlled_init(void);

/* All but the trigger and the config begins anew. */
void controlled_start(void);
void controlled_start_at(uint32_t now_us);

/* Until so many breaks have begun since the start. */
void controlled_run_to_break(unsigned breaks, uint32_t step_us);

/* A frame whose last byte comes so long after now. */
void controlled_response(const uint8_t frame[4], uint32_t after_us);

/* Polls until something comes of the trigger, and no other trigger may before. */
fathom_status_t controlled_outcome(uint32_t step_us);

#endif
