/* SPDX-License-Identifier: MIT */
#ifndef MODEL_H
#define MODEL_H

#include "fathom/sample.h"
#include "sensors/decoding.h"
#include "sensors/device.h"
#include "sensors/finding.h"
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
    const char *section;  /* of the datasheet; include/README.md names the mode beside it */
    const char *protocol; /* in which the tool sends requests: "Modbus", "55 AA"; NULL: it sends none */
    bool is_modbus;       /* of these: also through a gateway */
    bool is_triggered;    /* a level at the sensor's RX triggers a measurement */
    bool is_contact;      /* a level is all that the sensor sends */
    bool has_pulses;      /* the width of a pulse is the distance */
    bool has_address;     /* in the frames of the sensor */
    bool can_move_others; /* a damaged response can change the address of another sensor of this model */
    uint8_t takes;        /* READER_TAKES_...: which settings of the user have an effect */
    uint8_t pins;         /* MODEL_PIN_...: those that it needs; 0: it has a serial line */
    uint8_t may_pins;     /* and those that it may have beside its serial line */
    uint8_t simulated_as; /* for model_t.simulate; 0: `fathom sim` does not simulate it */
    /* Initialises the driver through an open port. Returns false if the driver refuses the settings. */
    bool (*read)(reader_t *reader, port_t *port, const reader_settings_t *settings);
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

enum { MODEL_MODES = 5, MODEL_PROBE_REGISTERS = 2 };

/* All that the tool knows of a sensor model. A member that is NULL or 0 does not apply. */
typedef struct model model_t;
struct model {
    const char *name; /* NULL ends the table */
    const char *what;
    fathom_model_t id;

    /* ---- its line, and how it is read ---- */

    fathom_line_settings_t line;     /* with factory settings */
    const uint32_t *rates;           /* baud rates that can be set, ended by 0 */
    const char *other_settings;      /* the same as options to try */
    model_mode_t modes[MODEL_MODES]; /* the first one is the default; a row without a name ends them */
    uint8_t max_address;
    bool has_address_zero; /* 0 is an address as well, and all units obey 255 */
    bool has_optics;       /* a measurement has magnitude, ambient light and precision */
    bool may_send_unasked; /* measurements between the responses */
    uint8_t probes;
    uint16_t max_mm;             /* a greater value is no distance */
    uint32_t second_response_us; /* a second unit at the same address responds within this time */
    const char *automatic_again; /* what restarts the automatic output, besides a power cycle */

    /* ---- its settings ---- */

    const setting_t *settings;
    const char *offset; /* name of the setting that corrects its distances */
    struct {
        /* Restore the factory settings of the interface, and of the sensor behind it. Call until they are not
         * FATHOM_PENDING. is_sent: a request that may have reset it has left. */
        fathom_status_t (*restore)(reader_t *reader);
        fathom_status_t (*load)(reader_t *reader);
        bool (*is_sent)(const reader_t *reader);
    } reset;

    /* ---- what a Modbus request does to it ---- */

    const char *request_ends; /* what its first request ends, and how to start that again; NULL: nothing */
    /* Returns what a read (function 3 or 4) changes, NULL: nothing. */
    const char *(*read_changes)(const uint8_t *request);

    /* ---- its simulation ---- */

    void (*simulate)(device_t *device, const device_settings_t *settings, uint8_t simulated_as);
    uint32_t traits;  /* bits 1 << DEVICE_...: those that it can have */
    uint16_t near_mm; /* the target moves between these */
    uint16_t far_mm;

    /* ---- how a scan identifies it; two models may share the first read ---- */

    struct {
        uint16_t first; /* the first read */
        uint8_t count;
        uint8_t frame_length; /* of its automatic output */
        uint16_t own;         /* a register that no other model with the same first read has ... */
        uint16_t slow_own;    /* ... and one for INQUIRY_SLOW_US, if none of them responds to that */
        uint32_t timeout_us;  /* of the first read; 0: the default of a scan */
        /* Instead of `own`: identifies it by the response to the first read, and by further reads. */
        bool (*is_it)(inquiry_t *inquiry);
    } scan;
    /* Fills in what is known. *facts is empty before. */
    void (*describe)(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

    /* ---- its frames ---- */

    uint8_t protocols; /* DECODE_... */
    /* Decodes a Modbus frame. request: the request, which is the frame itself or the one before it; NULL: not known. */
    void (*decode)(decode_frame_t *frame, const model_t *model, const uint8_t *request);
    /* Decodes a frame of another of its protocols. */
    void (*decode_sum)(decode_frame_t *frame, const model_t *model);
    uint16_t probe_registers[MODEL_PROBE_REGISTERS]; /* first register of all distances, and the same again */
    const char *register_source;                     /* sections of its datasheet */
    const char *stream_source;
    const char *exception_source;
    const char *(*exception_name)(uint8_t code);
};

/* Returns true if a unit can have this address, or this baud rate. */
bool model_has_address(const model_t *model, uint8_t address);
bool model_has_rate(const model_t *model, uint32_t baud);

#endif
