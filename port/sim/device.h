/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_DEVICE_H
#define FATHOM_SIM_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom/modbus_rtu.h"
#include "wire.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What every simulated sensor has: an ear that frames requests by silence, one answer at a time, a timer for
 * automatic frames, a scene to measure, counters, and two hooks for faults. a16.h, a05.h and hps167s.h are
 * what an application initialises; sim.h is the line they hang on.
 *
 * Half-duplex truth: while a request is being served and its answer leaves, a device hears nothing; on a
 * two-wire line nothing either while it sends an automatic frame. Bytes that it did not hear are counted.
 */
typedef struct fathom_sim_device fathom_sim_device_t;

/* ---- the scene: what there is to measure ---- */

/*
 * What probe `probe` (1..4; 1 where there is one) has before it at `now_us`: 0..65535 is sent as it is, and
 * so one can make a device say anything; below zero is one of these. Called once a probe and measurement,
 * at the moment of the measurement; the times of one line never go back, those of two lines may.
 */
enum {
    FATHOM_SIM_NO_TARGET = -1,    /* A16, A05: 0xFFFD (not in the datasheet); HPS-167S: 65530 (#5, note) */
    FATHOM_SIM_INTERFERENCE = -2, /* A16, A05: 0xFFFE (not in the datasheet); HPS-167S: as no target */
    FATHOM_SIM_FAULT = -3         /* HPS-167S: the abnormal packet (#5); A16, A05: as no target */
};
typedef int32_t (*fathom_sim_distance_t)(void *ctx, uint8_t probe, uint32_t now_us);

/* distance: NULL means that there is never a target. scene.h has two ready-made ones. */
typedef struct {
    fathom_sim_distance_t distance;
    void *ctx;
} fathom_sim_scene_t;

/* ---- faults: hooks on whole frames ---- */

/*
 * incoming   a frame that the device has heard, before it checks the CRC. The hook may alter it; length 0
 *            makes the device miss it. delay_us means nothing.
 * outgoing   a frame that is about to leave. The hook may alter the bytes and the length (0: it does not
 *            leave, but the device believes that it has answered), and set delay_us: so much later does the
 *            first bit leave, and the device stays busy until the last one has (up to 30 minutes).
 * Either may be NULL. They must not call into the simulator.
 */
typedef struct {
    uint8_t *bytes;    /* room for FATHOM_SIM_MAX_FRAME */
    uint8_t length;    /* 0..FATHOM_SIM_MAX_FRAME */
    bool automatic;    /* nobody asked for it */
    uint32_t now_us;   /* outgoing: when it would leave; incoming: when the device knew that it had ended */
    uint32_t delay_us; /* outgoing, 0 on entry */
} fathom_sim_frame_t;

typedef struct {
    void (*incoming)(void *ctx, fathom_sim_frame_t *frame);
    void (*outgoing)(void *ctx, fathom_sim_frame_t *frame);
    void *ctx;
} fathom_sim_faults_t;

/* ---- counters: read them in place; set them to 0 at will ---- */

typedef struct {
    uint32_t requests;       /* whole, CRC right, to its own address or to all */
    uint32_t answered;       /* answers that left, exceptions among them */
    uint32_t exceptions;     /* of these, exceptions */
    uint32_t unserved;       /* requests to its address that it let pass in silence: unknown register,
                                 function or value, a length that fits no request, warming up */
    uint32_t others;         /* frames with a right CRC for another address */
    uint32_t crc_errors;     /* frames with a wrong CRC, or shorter than any frame */
    uint32_t torn;           /* frames dropped: a gap over t1.5 (HPS-167S 2.2.3), noise in them, too long */
    uint32_t unheard;        /* bytes that came while it was busy, sending or starting up */
    uint32_t wrong_settings; /* bytes at a rate or parity that it does not have */
    uint32_t automatic;      /* frames sent by itself */
    uint32_t writes;         /* settings changed */
    uint32_t resets;         /* factory resets carried out (HPS-167S #6) */
    uint32_t resets_refused; /* requests that touched the reset address with a wrong length */
    uint32_t measurements;   /* times the scene was asked */
} fathom_sim_counters_t;

/* ---- inside: for sim.c and the sensors ---- */

enum {
    FATHOM_SIM_ALARM_START = 0, /* set: still starting or warming up */
    FATHOM_SIM_ALARM_REST,      /* set: the last measurement has been handed out, the next is under way */
    FATHOM_SIM_ALARM_SILENCE,   /* t3.5 after the last byte: the request is whole */
    FATHOM_SIM_ALARM_ANSWER,    /* the answer is ready */
    FATHOM_SIM_ALARM_AUTOMATIC, /* the next automatic frame */
    FATHOM_SIM_ALARMS
};

typedef struct {
    uint32_t at_us;
    bool set;
} fathom_sim_alarm_t;

enum { FATHOM_SIM_REGISTERS = 11 }; /* of the longest answer: HPS-167S #3 */

/* What tells one sensor from another. A NULL function is never called for. */
typedef struct {
    /* A request to this device, or to all. `message` has its head; message->exception is not 0 when the
     * codec found fault with it. Returns the time from the end of the request to the answer in us (at least
     * t3.5 is kept), or FATHOM_NO_DEADLINE for silence; may set message->exception. */
    uint32_t (*request)(fathom_sim_device_t *device, fathom_modbus_message_t *message);
    /* The answer to a read is due: fill in message->values. */
    void (*fill)(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us);
    /* An automatic frame is due: write it (up to FATHOM_SIM_MAX_FRAME bytes), return its length. */
    uint8_t (*automatic)(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us);
    uint8_t broadcast;  /* the address that all obey */
    bool strict_gap;    /* a silence over t1.5 spoils a frame */
    bool deaf_at_start; /* hears nothing while FATHOM_SIM_ALARM_START is set */
} fathom_sim_model_t;

struct fathom_sim_device {
    const fathom_sim_model_t *model;
    fathom_sim_device_t *next; /* on the line */
    const fathom_sim_faults_t *faults;
    fathom_sim_scene_t scene;
    fathom_sim_counters_t counters;
    fathom_line_settings_t settings; /* its own */
    uint32_t start_us;               /* from power-on until it is up; 0: at once */
    uint32_t period_us;              /* of automatic frames; 0: none */
    uint32_t linger_us;              /* automatic frames go on for so long after the first command */
    uint32_t random;                 /* state of the generator, from the seed */
    bool listens;                    /* false: takes no commands at all */
    bool answers_broadcast;          /* from its own address */
    uint8_t unit;

    fathom_sim_alarm_t alarms[FATHOM_SIM_ALARMS];
    fathom_sim_sender_t sender;
    fathom_modbus_message_t message; /* the request that is being served */
    fathom_line_settings_t reply_settings;
    uint16_t values[FATHOM_SIM_REGISTERS];
    uint32_t heard_us; /* end of the last byte */
    uint32_t leave_us; /* with `leaving`: when automatic output ends */
    uint8_t carriers;  /* bytes on the wire now, of others */
    uint8_t length;    /* bytes of the frame that is being heard */
    bool torn;         /* that frame is spoiled */
    bool busy;         /* between a request and the end of its answer */
    bool leaving;
    uint8_t frame[FATHOM_SIM_MAX_FRAME];
};

/* What the line calls. Times never go back. */
void fathom_sim_device_power_on(fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_device_hear_begin(fathom_sim_device_t *device, uint32_t now_us);
/* good: false for a byte that was talked into. full_duplex: hearing and sending have a wire each. */
void fathom_sim_device_hear_end(fathom_sim_device_t *device, const fathom_line_settings_t *settings,
                                uint8_t byte, bool good, bool full_duplex, uint32_t now_us);
void fathom_sim_device_sent(fathom_sim_device_t *device); /* its sender went idle */
uint32_t fathom_sim_device_due_us(const fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_device_act(fathom_sim_device_t *device, uint32_t now_us); /* something is due */

/* What the sensors call. */
int32_t fathom_sim_device_measure(fathom_sim_device_t *device, uint8_t probe, uint32_t now_us);
/* As the ultrasonic ones put it on the wire (SENSORS: 0xFFFD no target, 0xFFFE interference). */
uint16_t fathom_sim_device_ultrasonic(fathom_sim_device_t *device, uint8_t probe, uint32_t now_us);
/* `most_us` less a part of it, 0..1/8, that the seed decides: no real device answers to the microsecond. */
uint32_t fathom_sim_device_delay_us(fathom_sim_device_t *device, uint32_t most_us);
void fathom_sim_device_set_alarm(fathom_sim_device_t *device, uint8_t alarm, uint32_t at_us);

/* modbus.c: a whole frame was heard. */
void fathom_sim_device_serve(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length,
                             uint32_t now_us);

#ifdef __cplusplus
}
#endif

#endif
