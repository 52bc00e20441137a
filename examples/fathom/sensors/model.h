/* SPDX-License-Identifier: MIT */
#ifndef MODEL_H
#define MODEL_H

#include "fathom/sample.h"
#include "sensors/decoding.h"
#include "sensors/device.h"
#include "sensors/inquiry.h"
#include "sensors/setting.h"

/* The lines of a GPIO chip on which a sensor hangs instead of a serial line: bits. */
enum {
    MODEL_PIN_TRIGGER = 1, /* to its RX */
    MODEL_PIN_ECHO = 2,    /* pulses, from its TX */
    MODEL_PIN_IN = 4       /* a level: a switch, or a relay's contact */
};

/* One way in which a sensor can be read and simulated. */
typedef struct model_mode {
    const char *name;
    const char *protocol; /* in which the tool sends requests: "Modbus", "55 AA"; NULL: it sends none */
    bool is_modbus;       /* of these: also through a gateway */
    bool is_triggered;    /* a level at the sensor's RX triggers a measurement */
    bool is_contact;      /* a level is all that the sensor sends */
    bool has_pulses;      /* the width of a pulse is the distance */
    bool has_address;     /* in the frames of the sensor */
    bool can_move_others; /* a damaged response can change the address of another sensor of this model */
    uint8_t takes;        /* READER_TAKES_...: which settings of the user have an effect */
    uint8_t pins;         /* MODEL_PIN_...: those that it needs; 0: it has a serial line */
    uint8_t may_pins;     /* and that it may have as well */
    uint8_t simulated_as; /* for model_t.simulate; 0: `fathom sim` does not simulate it */
    /* Initialises the driver through an open channel. Returns false if the driver refuses the settings. */
    bool (*read)(reader_t *reader, channel_t *channel, const reader_settings_t *settings);
    void (*listen_unasked)(
        reader_t *reader); /* reader_listen_unasked; NULL: the sensor sends nothing unasked */
} model_mode_t;

/* Returns true if the tool sends requests in this mode, at an address. */
static inline bool mode_is_asked(const model_mode_t *mode) { return mode->protocol != NULL; }

/* Returns true if the sensor sends at its own pace, and not at the user's interval. */
static inline bool mode_is_automatic(const model_mode_t *mode)
{
    return mode->protocol == NULL && !mode->is_triggered && !mode->is_contact;
}

enum { MODEL_MODES = 5 };

/* All that the tool knows of a sensor model. What is NULL or 0 it has not. */
typedef struct model model_t;
struct model {
    const char *name;
    const char *what;
    fathom_model_t id;

    /* ---- its line and how it is read; the first mode is the default, the line is the factory's ---- */

    fathom_line_settings_t line;
    const uint32_t *rates;           /* to which it can be set, ended by 0 */
    const char *other_settings;      /* the same as options to try */
    model_mode_t modes[MODEL_MODES]; /* rows without a name end it */
    uint8_t max_address;
    /* An A16 or A05: address 0 is one too, 0xFF is all units, and values can be given a meaning. */
    bool is_dyp;
    bool has_optics; /* magnitude, ambient light and precision, and it can report a fault */
    uint8_t probes;
    uint16_t max_mm;       /* beyond this a value is no distance */
    bool may_send_unasked; /* measurements between the responses */

    const char *automatic_again; /* what makes it send by itself again after a request, besides power-off */

    /* ---- its settings ---- */

    const setting_t *settings;
    /* Its factory settings: of its interface, and of the sensor behind it. To be called until they are not
     * FATHOM_PENDING. is_sent: has a request left that may have reset it? */
    struct {
        fathom_status_t (*restore)(reader_t *reader);
        fathom_status_t (*load)(reader_t *reader);
        bool (*is_sent)(const reader_t *reader);
    } reset;

    /* ---- as it is simulated ---- */

    void (*simulate)(device_t *device, const device_settings_t *settings, uint8_t simulated_as);
    uint32_t traits;  /* bits 1 << DEVICE_...: those that it can have */
    uint16_t near_mm; /* between these the target moves if nothing else is asked for */
    uint16_t far_mm;

    /* ---- how a scan knows it; two models may have the first read in common ---- */

    struct {
        uint16_t first; /* the read by which it is looked for */
        uint8_t count;
        uint8_t frame_length; /* of what it sends by itself */
        uint16_t own;         /* a register that only it has, of those with the same first read, ... */
        uint16_t slow_own; /* ... and one to ask for within INQUIRY_SLOW_US if none of them responses that */
        /* Instead of `own`: decides by the response to the first read, and what it asks besides. */
        bool (*is_it)(inquiry_t *inquiry);
    } scan;
    /* Fills in what is known. *facts is empty before. */
    void (*describe)(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

    /* ---- what its frames say ---- */

    uint8_t protocols; /* DECODE_... */
    /* A Modbus frame. A response to a read may have no request (NULL); the bytes of a request are those of the
     * frame. */
    void (*decode)(decode_frame_t *frame, const uint8_t *request);
    void (*decode_sum)(decode_frame_t *frame); /* of another of its protocols */
    const char *(*exception_name)(uint8_t code);
    const char *exception_source; /* section of its datasheet */

    /* ---- what a Modbus request does to it ---- */

    const char *request_ends; /* what its first request ends, and how to start that again; NULL: nothing */
    /* Returns what a read (function 3 or 4) changes, NULL: nothing. */
    const char *(*read_changes)(const uint8_t *request);
};

/* Can it have this address? */
bool model_has_address(const model_t *model, uint8_t address);

/* Can it have this rate? */
bool model_has_rate(const model_t *model, uint32_t baud);

#endif
