/* SPDX-License-Identifier: MIT */
#ifndef DRIVER_H
#define DRIVER_H

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
#include "sensors/model.h"

/* The inside of a reader, for sensors/ alone. */

/* The temperature, which is read between measurements. */
typedef struct {
    fathom_sensor_t measuring; /* the driver's */
    uint32_t period_us;        /* of reading it */
    uint32_t interval_us;      /* of measuring */
    uint32_t asked_us;         /* clock at its newest request, ... */
    uint32_t read_us;          /* ... at its newest value, if it is known, ... */
    uint32_t measured_us;      /* ... and at the start of the newest measurement */
    uint8_t state;
    bool was_asked; /* once */
    bool has_measured;
    bool was_last;    /* it was requested after the newest measurement */
    bool is_reported; /* that it could not be read */
    bool is_known;
    int16_t dc; /* tenths of a degree Celsius */
} driver_temperature_t;

/* An A05 that waits for a power cycle, at which it samples its RX. */
typedef struct {
    fathom_sensor_t listening; /* the driver's */
    fathom_output_t rx;
    uint32_t heard_us;
    uint8_t value; /* fathom_dyp_value_t */
    bool has_been_off;
} driver_selection_t;

struct reader {
    const model_mode_t *mode;
    fathom_line_t *line;
    fathom_sensor_t sensor;
    const uint16_t *values; /* the 16-bit values of the newest response */
    uint8_t value_count;
    fathom_dyp_measurement_t *response; /* of A16 and A05; NULL: a response is one sample */
    const fathom_dyp_window_t *window;  /* the limits of a distance; NULL: the sensor has others */
    uint16_t *sequence;                 /* of the newest response; not NULL once the driver is initialised */
    fathom_dyp_modbus_t *dyp;           /* of an A16 or A05 that receives requests; NULL: of another */
    fathom_modbus_unit_t *unit;         /* NULL: the driver sends no requests */
    uint16_t *frames;                   /* FATHOM_STREAM_COUNTERS of them; NULL: it receives no stream */
    const uint32_t *period_us;          /* at which the driver asks; NULL: it keeps no period */
    fathom_pulse_meter_t *meter;        /* NULL: it measures no pulses */
    const pins_t *pins;                 /* with meter */
    const char *refusal;                /* why the reader could not be opened; NULL: the driver's */
    const char *remark;                 /* for the user, once */
    fathom_status_t (*end)(reader_t *reader); /* reader_close; NULL: there is nothing to restore */
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
    driver_selection_t selection;
    /* of an HPS-167S */
    fathom_hps167s_auto_t unasked; /* receives the measurements that come without a request */
    uint16_t unasked_frames[FATHOM_STREAM_COUNTERS];
    fathom_hps167s_limits_t limits;
    driver_temperature_t temperature;
};

/* Returns true if the port can hold its TX low (a break). Otherwise the reader has a refusal. */
bool driver_has_break(reader_t *reader, const port_t *port);

/* Lets TX go high. */
void driver_end_break(port_t *port);

/* The configuration that all drivers with requests share. A driver refuses address 0 if its sensor cannot have it. */
fathom_modbus_config_t driver_config(const port_t *port, const reader_settings_t *settings);

/* The configuration that all contacts share, and the last step of opening one. Returns true. */
fathom_contact_timing_t driver_contact_timing(const port_t *port, const reader_settings_t *settings);
bool driver_open_contact(reader_t *reader, fathom_contact_t *contact, fathom_sensor_t sensor);

/* The clock of the line. */
uint32_t driver_now_us(const reader_t *reader);

#endif
