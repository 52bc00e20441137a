/* SPDX-License-Identifier: MIT */
#ifndef READER_H
#define READER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line_pins.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_controlled.h"
#include "fathom/sensor/a16_modbus.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_switch.h"
#include "fathom/sensor/hps167s.h"
#include "fathom/sensor/hps167s_auto.h"
#include "ports/channel.h"

/* Those of the user's settings that only some sensors have, or only in some modes. */
enum {
    READER_TAKES_PROBES = 1,
    READER_TAKES_MEANINGS = 2,
    READER_TAKES_WINDOW = 4,
    READER_TAKES_VALUE = 8,
    READER_TAKES_REGISTERS = 16,
    READER_TAKES_TEMPERATURE = 32
};

/* What the user may set; 0: the driver's default. */
typedef struct {
    uint32_t timeout_us; /* of a response; of a sensor that sends by itself: until it is stale */
    uint32_t period_us;  /* between two requests */
    uint32_t repeat_us;  /* of a contact without a period: between two samples of one state; 0: 35 minutes */
    const fathom_line_settings_t *line; /* for each request; NULL: the line's own */
    uint32_t backoff_us;                /* how long a unit that does not answer is left alone at last */
    fathom_dyp_window_t window;         /* of A16 and A05; of an HPS-167S its ends */
    uint32_t temperature_us; /* of an HPS-167S: from one reading of it to the next; 0: it is not read */
    uint16_t registers;      /* of an A05: where the first probe's distance is */
    uint8_t probes;          /* of an A05: bit probe - 1 */
    uint8_t value;           /* fathom_dyp_value_t, if has_value; else RX is left alone */
    bool has_value;
    uint8_t address;
    uint8_t retries;
} reader_settings_t;

/* For the only sensor on a line: less than any period, so that one that does not answer is asked as often as one that
 * does: its user may be looking for the loose wire. */
enum { READER_BACKOFF_US = 1 };

/* For one of several: the longest that there is, which is the driver's default. */
#define READER_BACKOFF_SHARED_US 0x7FFFFFFFu

/* A temperature that is read between measurements. */
typedef struct {
    fathom_sensor_t measuring; /* the driver's */
    uint32_t period_us;        /* of reading it */
    uint32_t interval_us;      /* of measuring */
    uint32_t asked_us;         /* when it was asked for, ... */
    uint32_t read_us;          /* ... when it was read, if it is known, ... */
    uint32_t measured_us;      /* ... and when the last measurement began */
    uint8_t state;
    bool was_asked; /* once */
    bool has_measured;
    bool was_last; /* asked for, after the last measurement */
    bool is_told;  /* that it could not be read */
    bool is_known;
    int16_t dc; /* tenths of a degree Celsius */
} reader_temperature_t;

/* An A05 that is to be switched off and on, so that it looks at its RX. */
typedef struct {
    fathom_sensor_t listening; /* the driver's */
    fathom_output_t rx;
    uint32_t heard_us;
    uint8_t value; /* fathom_dyp_value_t */
    bool has_been_off;
} reader_selection_t;

/* Any driver, with what the library's common interface does not show: the causes of an error. */
typedef struct reader reader_t;
struct reader {
    fathom_sensor_t sensor;
    const uint16_t *values;                   /* the 16-bit values of the last response, ... */
    uint8_t value_count;                      /* ... and how many there are */
    const fathom_dyp_measurement_t *response; /* of A16 and A05; NULL: a response is one sample */
    uint16_t *sequence;                       /* of the last response */
    fathom_modbus_unit_t *unit;               /* NULL: it sends by itself */
    uint16_t *frames;                         /* FATHOM_STREAM_COUNTERS of them; NULL: it is asked */
    const char *protocol;                     /* with which it is asked */
    bool is_paced;                            /* it keeps the user's interval by itself */
    const uint32_t *period_us;                /* the one that it keeps then, or longer: its least */
    fathom_pulse_meter_t *meter;              /* of pulses; NULL: it sends none */
    const pins_t *pins;                       /* NULL: it has none */
    fathom_line_t *line;
    const char *refusal; /* what a reader_init_t that returned false has to say; NULL: nothing */
    const char *remark;  /* what the user is to be told now; who tells it makes it NULL */
    /* Leaves the device and the port as they were before; to be called until it is not FATHOM_PENDING. NULL: they
     * are. */
    fathom_status_t (*end)(reader_t *reader);
    union {
        fathom_a16_auto_t a16_auto;
        fathom_a16_modbus_t a16_modbus;
        fathom_a16_controlled_t a16_controlled;
        fathom_a16_pwm_t a16_pwm;
        fathom_a16_switch_t a16_switch;
        fathom_a05_auto_t a05_auto;
        fathom_a05_modbus_t a05_modbus;
        fathom_a05_dyp_t a05_dyp;
        fathom_a05_relay_t a05_relay;
        fathom_hps167s_t hps167s;
    } driver;
    reader_selection_t selection;
    /* of an HPS-167S */
    fathom_hps167s_auto_t unasked; /* listens to the measurements that it sends unasked */
    uint16_t unasked_frames[FATHOM_STREAM_COUNTERS];
    fathom_hps167s_limits_t limits;
    reader_temperature_t temperature;
};

/* Begins to read through an open channel. False: settings that the driver does not take. */
typedef bool (*reader_init_t)(reader_t *reader, channel_t *channel, const reader_settings_t *settings);

/* An empty one, for reader_init_t to fill. */
void reader_begin(reader_t *reader, channel_t *channel);

/* A level at the module's RX, which a break of the port holds low. False, with a refusal: the port cannot do that. */
bool reader_has_break(reader_t *reader, const channel_t *channel);

/* That level is high, whatever held it low before. */
void reader_end_break(channel_t *channel);

/* What all that are asked have in common. Address 0 is the driver's to refuse, where the device cannot be there. */
fathom_modbus_config_t reader_config(const channel_t *channel, const reader_settings_t *settings);

/* What all contacts have in common: how often they are looked at, and the last step of a reader_init_t, when the driver
 * has been begun. True. */
fathom_contact_timing_t reader_contact_timing(const channel_t *channel, const reader_settings_t *settings);
bool reader_begin_contact(reader_t *reader, const channel_t *channel, fathom_contact_t *contact,
                          fathom_sensor_t sensor);

/* reader_t.protocol. */
extern const char reader_modbus[];

/* Of an attempt that has ended with FATHOM_ERR_MALFORMED: was it the response that did not fit, and not a value in
 * it? */
bool reader_got_unexpected_response(const reader_t *reader);

/* The same, where a value of A16 or A05 was refused: of which probe? 0: it was not that. */
uint8_t reader_refused_probe(const reader_t *reader);

/* Has the last response more samples? Then poll again before anything else. */
bool reader_has_more(const reader_t *reader);

#endif
