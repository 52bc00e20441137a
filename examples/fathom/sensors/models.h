/* SPDX-License-Identifier: MIT */
#ifndef MODELS_H
#define MODELS_H

#include <stdio.h>

#include "fathom/models.h"
#include "fathom/sample.h"
#include "output/record.h"
#include "sensors/reader.h"
#include "sensors/setting.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167.h"
#include "sim/hps167s.h"

/* The sensor models, as rows. */

/* ---- modes ---- */

/* The lines of a GPIO chip to which a sensor is connected instead of a serial line: bits. */
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
    bool is_contact;      /* the sensor sends only a level */
    bool has_pulses;      /* the width of a pulse is the distance */
    bool has_address;     /* in the frames of the sensor */
    bool can_move_others; /* a damaged response can change the address of another sensor of this model */
    uint8_t takes;        /* READER_TAKES_...: which settings of the user have an effect */
    uint8_t pins;         /* MODEL_PIN_...: those that it needs; 0: it has a serial line */
    uint8_t may_pins;     /* and those that it may have beside its serial line */
    uint8_t simulated_as; /* for model_t.simulate; 0: `fathom sim` does not simulate it */
    uint8_t reads;        /* rows of src/models with this fathom_model_mode_t; 0: none */
    const fathom_model_description_t *row; /* of a relative; NULL: the datasheet's sensor */
    /* Initialises the driver through an open port. Returns false if the driver refuses the settings. */
    bool (*read)(reader_t *reader, port_t *port, const reader_settings_t *settings);
    /* As reader_listen_unasked(); NULL: the sensor sends nothing unsolicited. */
    void (*listen_unasked)(reader_t *reader);
} model_mode_t;

/* Returns true if the tool sends requests in this mode, at an address. */
static inline bool mode_is_asked(const model_mode_t *mode) { return mode->protocol != NULL; }

/* Returns true if the sensor sends at its own pace, and not at the user's interval. */
static inline bool mode_is_automatic(const model_mode_t *mode)
{
    return mode->protocol == NULL && !mode->is_triggered && !mode->is_contact;
}

/* Returns true if a byte triggers a measurement, in place of a level. */
static inline bool mode_starts_by_byte(const model_mode_t *mode)
{
    return mode->row != NULL && mode->row->facts->start == FATHOM_STARTS_BYTE;
}

/* Returns true if a high pulse at the sensor's trigger pin triggers a measurement. */
static inline bool mode_idles_low(const model_mode_t *mode)
{
    return mode->row != NULL && mode->row->facts->start == FATHOM_STARTS_HIGH_PULSE;
}

/* ---- a scan ---- */

/* The kind of a device that a scan found. */
typedef enum {
    SCAN_SENSOR = 1, /* one of the models */
    SCAN_OTHER,      /* it responds in Modbus, but is none of the models */
    SCAN_DAMAGED,    /* none of its responses was whole */
    SCAN_NOT_MODBUS, /* it responds at these line settings, but not in Modbus; it has no address */
    SCAN_SENDER,     /* it sends automatically, and is none of the models; it has no address */
    SCAN_ALIKE,      /* it sends automatically, in a protocol that a model may have had; it has no address */
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
    const char *perhaps; /* what an unconfirmed device could be, and how sure that is; NULL: not known */

    /* of an A16 or A05 that responded */
    bool has_value;
    uint16_t value;  /* of its first probe, as it was sent */
    bool is_certain; /* it has what only the sensors of this family have */

    /* of an HPS-167S: #1, #2 and #3; "" is not known */
    char interface_version[SETTING_TEXT];
    char sensor_version[SETTING_TEXT];
    char uuid[SETTING_TEXT];
    char termination[SETTING_TEXT]; /* "on" or "off" */
} scan_finding_t;

/* The reads by which a model identifies a device during a scan. */
typedef struct inquiry inquiry_t;
struct inquiry {
    /* Reads `count` registers and repeats the read after a damaged or unsuitable response, and after silence up to
     * silence_tries times. Returns true if status is FATHOM_OK. */
    bool (*ask)(inquiry_t *inquiry, uint16_t first, uint8_t count, uint32_t timeout_us,
                uint8_t silence_tries);
    fathom_status_t status;  /* of the newest response; at first of that to model_t.scan.first */
    const uint16_t *values;  /* of that response */
    uint16_t own;            /* the register that identified the model: model_t.scan.own or .slow_own */
    scan_finding_t *finding; /* to fill in */
};

/* An A16 responds to 0x0101 in about 120 ms and to 0x0100 in up to 520, an A05 needs about 100 ms a probe. */
enum { INQUIRY_MEASURE_US = 300000, INQUIRY_SLOW_US = 1000000 };

/* ---- simulated sensors ---- */

/* Traits of a simulated sensor; 0: it does not have the trait. commands/sim explains them, and model_t.traits has those
 * that a model can have. */
typedef enum {
    DEVICE_EXCEPTIONS,
    DEVICE_ANSWERS_BROADCAST,
    DEVICE_REAL_TIME,
    DEVICE_ANSWERS_FROM_NEW,
    DEVICE_WARM_UP, /* seconds */
    DEVICE_WARM_UP_REFUSES,
    DEVICE_WARM_UP_ABNORMAL,
    DEVICE_UNASKED, /* microseconds */
    DEVICE_NO_OUTPUT,
    DEVICE_NO_TERMINATION,
    DEVICE_BAUD_LATER,
    DEVICE_OFFSET_ADDS,
    DEVICE_RECONNECT, /* milliseconds */
    DEVICE_NO_BAUD_CODE,
    DEVICE_COUNT_EXCEPTION,
    DEVICE_TRAITS
} device_trait_t;

typedef struct {
    uint8_t address;
    uint32_t baud; /* 0: the factory setting; for sensors with several rates */
    uint32_t seed;
    uint8_t number; /* of the unit among those of its model that have a number of their own */
    uint32_t traits[DEVICE_TRAITS];
    const fathom_model_facts_t *facts; /* of a relative; NULL: the datasheet's */
    fathom_sim_scene_t scene;
} device_settings_t;

/* Any simulated sensor. */
typedef union {
    fathom_sim_device_t base; /* the first member of each */
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps167s;
    fathom_sim_hps167_t hps167;
} device_t;

/* ---- models ---- */

/* The protocols of the sensors, as bits. */
enum {
    DECODE_MODBUS = 1,
    DECODE_DYP = 2,         /* 55 AA */
    DECODE_STREAM_ONE = 4,  /* FF H L SUM */
    DECODE_STREAM_FOUR = 8, /* FF, four distances, SUM */
    DECODE_ALL = 15
};

enum { MODEL_MODES = 5, MODEL_PROBE_REGISTERS = 2 };

struct decode_frame;
typedef struct model model_t;

/* Call these three until the result is not FATHOM_PENDING. value: of a word, its number. */
typedef fathom_status_t model_get_t(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT]);
typedef fathom_status_t model_set_t(reader_t *reader, const setting_t *setting, int32_t value);
typedef fathom_status_t model_reset_t(reader_t *reader);
typedef void model_simulate_t(device_t *device, const device_settings_t *settings, uint8_t simulated_as);
/* request: the request, which is the frame itself or the one before it; NULL: not known. */
typedef void model_decode_t(struct decode_frame *frame, const model_t *model, const uint8_t *request);

/* A member that is NULL or 0 does not apply. */
struct model {
    const char *name;
    const char *what;
    fathom_model_t id;

    /* ---- its line, and how it is read ---- */
    fathom_line_settings_t line; /* with factory settings */
    fathom_line_settings_t
        relatives_line;         /* of relatives that have its registers and frames; baud 0: the same */
    const uint32_t *rates;      /* baud rates that can be set, ended by 0 */
    const char *other_settings; /* the same as options to try */
    const model_mode_t *modes; /* MODEL_MODES; the first one is the default, a row without a name ends them */
    uint8_t max_address;
    bool has_address_zero; /* 0 is an address as well, and all units obey 255 */
    bool has_optics;       /* a measurement has magnitude, ambient light and precision */
    bool may_send_unasked; /* measurements between the responses */
    uint8_t probes;
    uint16_t max_mm;             /* a greater value is no distance */
    uint32_t second_response_us; /* a second unit at the same address responds within this time */
    const char *automatic_again; /* the setting that restarts the automatic output; NULL: none does */

    /* ---- its settings ---- */
    const setting_t *settings;
    const char *offset;             /* name of the setting that corrects its distances */
    model_get_t *get;               /* a setting with `read_at` */
    model_set_t *set;               /* a setting with `effect` */
    model_set_t *set_all;           /* a setting with `has_broadcast`, in all units on the line */
    model_reset_t *reset_interface; /* to the factory settings */
    model_reset_t *reset_sensor;    /* the same of the sensor behind the interface */

    /* ---- what a Modbus request does to it ---- */
    const char *request_ends; /* what its first request ends, and how to start that again; NULL: nothing */
    /* Returns what a read (function 3 or 4) changes, NULL: nothing. */
    const char *(*read_changes)(uint8_t function, uint16_t first, uint16_t count);

    /* ---- its simulation ---- */
    model_simulate_t *simulate;
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
        bool has_any;         /* a unit responds to the first read at address 255, from its real address */
        const char *family;   /* what a device that is found can be */
        uint16_t second;      /* another register with the distance of `own` ... */
        /* ... which this function compares with that. Returns false if the device is none of this family. */
        bool (*confirm)(inquiry_t *inquiry, const model_t *model);
        /* Instead of `own`: identifies it by the response to the first read, and by further reads. */
        bool (*is_it)(inquiry_t *inquiry);
        /* Returns true if the bytes have frames of a protocol that older units may have. `alike` is what the sender
         * can be. */
        bool (*is_alike)(const uint8_t *bytes, uint16_t count);
        const char *alike;
    } scan;

    /* ---- its frames ---- */
    uint8_t protocols;                                                    /* DECODE_... */
    model_decode_t *decode;                                               /* a Modbus frame */
    void (*decode_sum)(struct decode_frame *frame, const model_t *model); /* of another of its protocols */
    uint16_t probe_registers[MODEL_PROBE_REGISTERS]; /* first register of all distances, and the same again */
    const char *register_source;                     /* sections of its datasheet */
    const char *stream_source;
    const char *exception_source;
    const char *(*exception_name)(uint8_t code);
};

/* The models. If a device can be several of them, a scan tries the later one first. A model with its own driver also needs a
 * place in the union of driver.h and in that of device_t. */
extern const model_t models[];
extern const size_t model_count;

enum { FACTORY_ADDRESS = 1 };

/*
 * Returns the model with this name: one of `models`, or a relative of one, which is a name or an alias of src/models. A
 * relative is a copy of its family, with the name, the line and the range of its first row, and a mode for each row that
 * the tool can read. NULL: there is none, or no memory. It stays valid.
 */
const model_t *model_find(const char *name);

/* Returns the mode of the model that reads a row of its name. NULL: the tool has none. */
const model_mode_t *model_mode_of_row(const model_t *model, const fathom_model_description_t *row);

/*
 * Returns form n of the module that this mode reads: another row of its name, or a name that differs in the letter of the
 * output alone, as A02YYTW from A02YYUW. NULL: there are no more.
 */
const fathom_model_description_t *model_form(const model_mode_t *mode, size_t n);

/* Returns why a near relative or a false friend of this name cannot be read. NULL: it is none. */
const char *model_unreadable(const char *name);

/* Returns name n of all relatives and their aliases, in lower case. NULL: there are no more. */
const char *model_relative(size_t n);

/* Returns true if a unit can have this address, or this baud rate. */
bool model_has_address(const model_t *model, uint8_t address);
bool model_has_rate(const model_t *model, uint32_t baud);

/* Returns the least address: 0 or 1. */
uint8_t model_least_address(const model_t *model, const model_mode_t *mode);

/* Returns the mode in which a setting can be read and set; NULL: the mode that uses Modbus. */
const model_mode_t *model_mode_of(const model_t *model, const setting_t *setting);

/* Returns the first model that has one of these protocols (DECODE_...). */
const model_t *model_with(uint8_t protocols);

/* Returns what a value of an A16 or A05 means: "target", "no_target" or "unknown". Stores the distance, or NO_VALUE. */
const char *model_value_status(const model_t *model, uint16_t value, int64_t *distance_mm);

/* Returns true if units of this model, or relatives of them, have these line settings with factory settings. */
bool model_is_at(const model_t *model, const fathom_line_settings_t *line);

/* Reads what other devices have where an A16 has its distances, and stores in inquiry->finding what the device can be. */
void models_name_other(inquiry_t *inquiry);

/* Returns true if no model loses settings by this read. At address 0, which is a broadcast to some models, the register
 * must belong to a model that can have that address. */
bool models_allow_read(uint8_t address, uint16_t first, uint16_t count);

/* ---- texts ---- */

/* A Modbus exception. */
typedef struct {
    const char *name; /* the specification's */
    const char *meaning;
    bool is_other_sensor; /* than the user has named, most likely */
} modbus_exception_t;

modbus_exception_t modbus_exception(uint8_t number);

/* Writes the name of a form of this mode, and what selects it: "a02yytw (T, controlled)". */
void model_form_print(FILE *to, const model_mode_t *mode, const fathom_model_description_t *form);

/* Writes the command that reads a sensor: "fathom read hps167s:7:modbus --port './a port' --baud 57600". address: -1 if
 * the command needs none. The port is quoted for a shell. */
void read_command_print(FILE *to, const model_t *model, const char *mode, int address,
                        const fathom_line_settings_t *line, const char *port);

#endif
