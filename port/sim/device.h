/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_SIM_DEVICE_H
#define FATHOM_SIM_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/codec/modbus_rtu.h"
#include "fathom/hal.h"
#include "wire.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * What every simulated sensor has: a receiver that frames requests by silence, one response at a time, a timer for
 * automatic frames, a scene to measure, counters, and two hooks for faults. a16.h, a05.h and hps167s.h are
 * what an application initialises; sim.h is the line they hang on.
 *
 * Half-duplex truth: while a request is being served and its response leaves, a device hears nothing; on a
 * two-wire line nothing either while it sends an automatic frame. Bytes that it did not hear are counted.
 */
typedef struct fathom_sim_device fathom_sim_device_t;

/* ---- the scene: what there is to measure ---- */

/*
 * What probe `probe` (1..4; 1 where there is one) has before it at `now_us`: 0..65535 is sent as it is, and
 * so one can make a device send any value; below zero is one of these. Called once a probe and measurement,
 * at the moment of the measurement; the times of one line never go back, those of two lines may.
 */
enum {
    FATHOM_SIM_NO_TARGET = -1,    /* A16, A05: 0xFFFD (not in the datasheet); HPS-167S: 65530 (#5, note) */
    FATHOM_SIM_INTERFERENCE = -2, /* A16, A05: 0xFFFE (not in the datasheet); HPS-167S: as no target */
    FATHOM_SIM_FAULT = -3         /* HPS-167S: the abnormal packet (#5); A16, A05: as no target */
};
typedef int32_t (*fathom_sim_distance_t)(void *ctx, uint8_t probe, uint32_t now_us);

/* distance: NULL means that there is never a target. scene.h has two ready-made ones. A16 and A05 have a
 * real-time value and a processed one, and may have a scene for each. */
typedef struct {
    fathom_sim_distance_t distance;
    void *ctx;
} fathom_sim_scene_t;

/* ---- faults: hooks on whole frames, and on what is measured ---- */

/*
 * measured   what probe `probe` has measured for the frame that follows; returns what it sends instead.
 * incoming   a frame that the device has heard, before it checks the CRC. The hook may alter it; length 0
 *            makes the device miss it. delay_us means nothing.
 * outgoing   a frame that is about to leave. The hook may alter the bytes and the length (0: it does not
 *            leave, but the device believes that it has answered), and set delay_us: so much later does the
 *            first bit leave, and the device stays busy until the last one has (up to 30 minutes).
 *            More than the device's own bytes may be there: `after` of those at the end are another device's,
 *            and it listens again before them. Pauses may stand between bytes, and bytes may have a mark.
 * Any may be NULL. They must not call into the line.
 */
/* Protocols; sets of them. */
enum { FATHOM_SIM_STREAM = 1, FATHOM_SIM_MODBUS = 2, FATHOM_SIM_DYP = 4, FATHOM_SIM_HPS167 = 8 };

typedef struct {
    uint8_t *bytes;    /* room for FATHOM_SIM_MAX_FRAME */
    uint8_t length;    /* 0..FATHOM_SIM_MAX_FRAME */
    bool automatic;    /* not requested */
    uint32_t now_us;   /* outgoing: when it would leave; incoming: when the device knew that it had ended */
    uint32_t delay_us; /* outgoing, 0 on entry, as all that follows */
    uint32_t off_us;   /* when the bytes have left, the device loses power for so long */
    uint8_t protocol;  /* FATHOM_SIM_STREAM and so on; 0 incoming */
    uint8_t after;
    uint8_t paused; /* used of `pauses` */
    bool marked;    /* `marks` are set, all of them */
    fathom_sim_pause_t pauses[FATHOM_SIM_PAUSES];
    uint8_t marks[FATHOM_SIM_MAX_FRAME]; /* FATHOM_RX_PARITY, _FRAMING, or _OVERRUN: the byte is lost */
} fathom_sim_frame_t;

typedef struct {
    void (*incoming)(void *ctx, fathom_sim_frame_t *frame);
    void (*outgoing)(void *ctx, fathom_sim_frame_t *frame);
    int32_t (*measured)(void *ctx, uint8_t probe, int32_t value);
    void *ctx;
} fathom_sim_faults_t;

/* ---- counters: read them in place; set them to 0 at will ---- */

typedef struct {
    uint32_t requests;   /* whole, CRC or sum right, to its own address or to all */
    uint32_t answered;   /* responses that left, exceptions among them */
    uint32_t exceptions; /* of these, exceptions */
    /* requests to its address that it let pass in silence: unknown register, function or value, a length that fits no
     * request, warming up */
    uint32_t unserved;
    uint32_t others;         /* frames with a right CRC or sum for another address */
    uint32_t crc_errors;     /* frames with a wrong CRC or sum, or shorter than any frame */
    uint32_t truncated;      /* frames dropped: a gap over t1.5 (HPS-167S 2.2.3), noise in them, too long */
    uint32_t unheard;        /* bytes that came while it was busy, sending or starting up */
    uint32_t wrong_settings; /* bytes at a rate or parity that it does not have */
    uint32_t automatic;      /* frames sent by itself */
    uint32_t writes;         /* obeyed: 06, 10, 55 AA 03 */
    uint32_t writes_refused; /* 06, 10 and 55 AA 03 to it or to all that it did not obey */
    uint32_t flash_writes;   /* times its flash wore: a setting saved, also one that was already so */
    uint32_t resets;         /* to factory settings, carried out: HPS-167S #6, and #13 with FF */
    uint32_t resets_refused; /* requests that touched the address of #6 and were not #6 */
    uint32_t measurements;   /* times the scene was measured */
} fathom_sim_counters_t;

/* ---- inside: for sim.c and the sensors ---- */

enum {
    FATHOM_SIM_ALARM_POWER = 0, /* set: without power until then */
    FATHOM_SIM_ALARM_START,     /* set: still starting or warming up */
    FATHOM_SIM_ALARM_REST,      /* set: the last measurement has been handed out, the next is under way */
    FATHOM_SIM_ALARM_LOST,      /* set: no data from the sensor inside, and not yet for long */
    FATHOM_SIM_ALARM_SILENCE,   /* t3.5 after the last byte: the request is whole */
    FATHOM_SIM_ALARM_RESPONSE,  /* the response is ready */
    FATHOM_SIM_ALARM_AUTOMATIC, /* the next automatic frame */
    FATHOM_SIM_ALARM_PIN,       /* the model's own: something is to happen at its pins */
    FATHOM_SIM_ALARMS
};

typedef struct {
    uint32_t at_us;
    bool set;
} fathom_sim_alarm_t;

enum { FATHOM_SIM_REGISTERS = 11 }; /* of the longest response: HPS-167S #3 */

/* A protocol of requests and responses: modbus.c, dyp.c, hps167.c. */
typedef struct {
    /* A whole frame was heard. False: it is none of this protocol, another one may look at it. */
    bool (*hear)(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us);
    /* The response to the last one is due: write it (up to FATHOM_SIM_MAX_FRAME bytes), return its length. */
    uint8_t (*response)(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us);
    /* The same without a request: all that it measures. */
    uint8_t (*unasked)(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us);
    uint8_t id; /* FATHOM_SIM_MODBUS and so on */
} fathom_sim_protocol_t;

extern const fathom_sim_protocol_t fathom_sim_modbus;
extern const fathom_sim_protocol_t fathom_sim_dyp;
extern const fathom_sim_protocol_t fathom_sim_hps167;

enum { FATHOM_SIM_PROTOCOLS = 2 };

/* In what sensors differ. A NULL function is never called for. */
typedef struct {
    /* A request to this device, or to all. `message` has its head; message->exception is not 0 when the
     * codec found fault with it. Returns the time from the end of the request to the response in us (at least
     * t3.5 is kept), or FATHOM_NO_DEADLINE for silence; may set message->exception. */
    uint32_t (*request)(fathom_sim_device_t *device, fathom_modbus_message_t *message);
    /* The response to a read is due: fill in message->values. */
    void (*fill)(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us);
    /* An automatic frame is due: write it (up to FATHOM_SIM_MAX_FRAME bytes), return its length. */
    uint8_t (*automatic)(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us);
    /* A command of the 55 AA protocol, to this device or to all. Returns as `request` does. */
    uint32_t (*command)(fathom_sim_device_t *device, uint8_t address, uint8_t command);
    /* Power has come: what is not kept is as at the beginning, what acts from the next power-on acts. Sets the level at
     * which its TX pin rests, and takes what it notices at its RX pin; where there is no such function TX rests high,
     * as a UART does. */
    void (*power_on)(fathom_sim_device_t *device, uint32_t now_us);
    /* The level at its RX pin has changed. Not called without power. */
    void (*edge)(fathom_sim_device_t *device, bool high, uint32_t now_us);
    /* FATHOM_SIM_ALARM_PIN, which it has set, is due. */
    void (*alarm)(fathom_sim_device_t *device, uint32_t now_us);
    /* Whose frames it sends by itself where there is no `automatic`: no command ends those. */
    const fathom_sim_protocol_t *unasked;
    bool (*silent)(fathom_sim_device_t *device); /* this time it has none to send */
    uint16_t reading[2];                         /* the Modbus read of all that it measures: address, count */
    uint8_t broadcast;                           /* the address that all obey */
    bool strict_gap;                             /* a silence over t1.5 makes a frame invalid */
    bool deaf_at_start;                          /* hears nothing while FATHOM_SIM_ALARM_START is set */
    bool optical;                                /* sends FATHOM_SIM_FAULT, and no FATHOM_SIM_INTERFERENCE */
} fathom_sim_model_t;

/* What can hold the RX pin of a device low; it is high when nothing does, also where it is not driven. */
enum {
    FATHOM_SIM_HELD_BY_PIN = 1,   /* the host's fathom_pin_t (pin.h) */
    FATHOM_SIM_HELD_BY_BREAK = 2, /* a break of the host's UART */
    FATHOM_SIM_HELD_BY_BYTE = 4   /* a byte of the host: from its start bit to its end, to keep it simple */
};

struct fathom_sim_device {
    const fathom_sim_model_t *model;
    fathom_sim_device_t *next; /* on the line */
    const fathom_sim_faults_t *faults;
    fathom_sim_scene_t scene;     /* real-time values */
    fathom_sim_scene_t processed; /* where these differ */
    fathom_sim_counters_t counters;
    fathom_line_settings_t settings; /* its own */
    uint32_t start_us;               /* from power-on until it is up; 0: at once */
    uint32_t period_us;              /* of automatic frames; 0: none */
    uint32_t linger_us;              /* automatic frames go on for so long after the first command */
    uint32_t random;                 /* state of the generator, from the seed */
    bool listens;                    /* false: takes no commands at all */
    bool answers_broadcast;          /* in Modbus, from its own address */
    bool dyp_silent_broadcast;       /* in 55 AA none answers */
    bool answers_from_new;           /* what changes its address, in Modbus */
    uint8_t address;
    const fathom_sim_protocol_t *protocols[FATHOM_SIM_PROTOCOLS]; /* looked at in this order; NULL: none */

    fathom_sim_alarm_t alarms[FATHOM_SIM_ALARMS];
    fathom_sim_sender_t sender;
    const fathom_sim_protocol_t *protocol; /* of the request that is being served */
    fathom_modbus_message_t message;       /* that request, in Modbus */
    uint8_t command;                       /* that request, in 55 AA and of an HPS-167 */
    fathom_line_settings_t reply_settings;
    uint16_t values[FATHOM_SIM_REGISTERS];
    uint32_t heard_us;      /* end of the last byte */
    uint32_t leave_us;      /* with `leaving`: when automatic output ends */
    uint8_t others_on_wire; /* bytes on the wire now, of others */
    uint8_t length;         /* bytes of the frame that is being heard */
    bool is_invalid;        /* that frame is to be dropped */
    uint16_t own;           /* bytes at the sender that are the device's; the rest is another device's */
    uint32_t off_us;        /* without power for so long when the sender is idle */
    bool busy;              /* between a request and the end of its response */
    bool leaving;
    bool tx_high;    /* the level of its TX pin where no byte is leaving */
    bool tx_is_uart; /* the model's: a TX pin that falls is a break to the host's UART, which is on it too */
    bool off_high;   /* the model's: the level of its TX pin without power */
    bool in_break;   /* that is what it is sending */
    bool is_raised;  /* the response that is due may begin, on a TX pin that rests low */
    uint8_t rx_held; /* FATHOM_SIM_HELD_BY_..., a set */
    /* Who sees the edges of tx_high; set by pin.h. */
    void (*watch)(void *ctx, bool high, uint32_t now_us);
    void *watch_ctx;
    uint8_t frame[FATHOM_SIM_MAX_FRAME];
};

/* What the line calls. Times never go back. */
void fathom_sim_device_power_on(fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_device_power_off(fathom_sim_device_t *device, uint32_t for_us, uint32_t now_us);
void fathom_sim_device_receive_start(fathom_sim_device_t *device, uint32_t now_us);
/* good: false for a byte that collided with another. full_duplex: hearing and sending have a wire each. */
void fathom_sim_device_receive_end(fathom_sim_device_t *device, const fathom_line_settings_t *settings,
                                   uint8_t byte, bool good, bool full_duplex, uint32_t now_us);
/* One of those that hold the RX pin low begins or ceases to; by: FATHOM_SIM_HELD_BY_... */
void fathom_sim_device_hold_rx(fathom_sim_device_t *device, uint8_t by, bool low, uint32_t now_us);
void fathom_sim_device_sent(fathom_sim_device_t *device, uint32_t now_us); /* a byte of it has left */
uint32_t fathom_sim_device_due_us(const fathom_sim_device_t *device, uint32_t now_us);
void fathom_sim_device_act(fathom_sim_device_t *device, uint32_t now_us); /* something is due */

/* What the sensors call. */
int32_t fathom_sim_device_measure(fathom_sim_device_t *device, uint8_t probe, uint32_t now_us);
/* As the ultrasonic ones put it on the wire (not in the datasheets: 0xFFFD no target, 0xFFFE interference). */
uint16_t fathom_sim_device_ultrasonic(fathom_sim_device_t *device, uint8_t probe, bool processed,
                                      uint32_t now_us);
/* `most_us` less a part of it, 0..1/8, that the seed decides: no real device responds to the microsecond. */
uint32_t fathom_sim_device_delay_us(fathom_sim_device_t *device, uint32_t most_us);
void fathom_sim_device_set_alarm(fathom_sim_device_t *device, uint8_t alarm, uint32_t at_us);

/*
 * The level of the TX pin from now on: a pulse, a switch output, a relay's contact. Bytes that leave on the same
 * pin have it while they do. With tx_is_uart a fall reaches the host as a byte 00 with FATHOM_RX_FRAMING, the one
 * after a response too, and so does what stands before a response where the pin rests low.
 */
void fathom_sim_device_set_level(fathom_sim_device_t *device, bool high, uint32_t now_us);
/* What the host can see of the TX pin now: the bits of a byte that is leaving, else the level. */
bool fathom_sim_device_level(const fathom_sim_device_t *device, uint32_t now_us);

uint32_t fathom_sim_device_between_us(fathom_sim_device_t *device, uint32_t least_us, uint32_t most_us);

/* What a trigger has started leaves now, as a response. */
void fathom_sim_device_response(fathom_sim_device_t *device, const uint8_t *bytes, uint8_t length,
                                uint32_t now_us);

/* What the protocols call: the response to the request is due so long after its end. */
void fathom_sim_device_reply(fathom_sim_device_t *device, const fathom_sim_protocol_t *protocol,
                             uint32_t delay_us);

#ifdef __cplusplus
}
#endif

#endif
