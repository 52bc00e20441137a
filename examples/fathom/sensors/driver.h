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
#include "fathom/sensor/hps167_uart.h"
#include "fathom/sensor/hps167s.h"
#include "fathom/sensor/hps167s_auto.h"
#include "sensors/models.h"

/* The inside of a reader, and the functions of the rows in models.c, for sensors/ alone. */

/* An A05 that waits for a power cycle, at which it samples its RX. */
typedef struct {
    fathom_sensor_t listening; /* the driver's */
    fathom_output_t rx;
    uint32_t heard_us;
    uint8_t value; /* fathom_dyp_value_t */
    bool has_been_off;
} driver_selection_t;

/* Reads the temperature in tenths of a degree Celsius. Call until the result is not FATHOM_PENDING. */
typedef fathom_status_t driver_get_temperature_t(reader_t *reader, int16_t *dc);

/* The measurements and the temperature of a sensor, which take turns. */
typedef enum { TURN_MEASUREMENT, TURN_TEMPERATURE, TURNS, TURN_NONE = TURNS } driver_turn_t;
typedef struct {
    driver_get_temperature_t *get;
    fathom_sensor_t measuring; /* the driver's */
    uint32_t period_us[TURNS]; /* from one start to the next */
    uint32_t began_us[TURNS];  /* clock at the newest start, ... */
    bool has_begun[TURNS];     /* ... if there was one */
    uint8_t turn;              /* driver_turn_t: the request in progress */
    uint8_t last;              /* the newest request, or the one in progress */
    bool is_reported;          /* that the temperature could not be read */
    bool is_known;             /* it was read, ... */
    uint32_t read_us;          /* ... at this clock */
    int16_t dc;                /* tenths of a degree Celsius */
} driver_temperature_t;

/* The check whether a module with a trigger sends without one. */
typedef struct {
    uint32_t period_us; /* between two triggers */
    uint32_t edge_us;   /* the newest trigger */
    uint16_t frames;    /* since that trigger */
    bool has_frames;    /* a frame was received since the reader was opened */
    bool is_held;       /* the present period is longer than period_us, without a trigger */
    bool is_proven;     /* the module was silent while a trigger was held */
    bool is_automatic;  /* the module sends without a trigger */
} driver_check_t;

struct reader {
    const model_mode_t *mode;
    fathom_line_t *line;
    fathom_sensor_t sensor;
    const uint16_t *values; /* the 16-bit values of the newest response */
    uint8_t value_count;
    fathom_dyp_measurement_t *response; /* of A16 and A05; NULL: a response is one sample */
    const fathom_model_facts_t *window; /* the limits of a distance; NULL: the sensor has others */
    uint16_t *sequence;                 /* of the newest response; not NULL once the driver is initialised */
    fathom_dyp_modbus_t *dyp;           /* of an A16 or A05 that receives requests; NULL: of another */
    fathom_modbus_unit_t *unit;         /* NULL: the driver sends no requests */
    const uint32_t *next_baud;          /* its rate from the next power-on, if not 0; NULL: it has one rate */
    uint16_t *frames;                   /* FATHOM_STREAM_COUNTERS of them; NULL: it receives no stream */
    const uint32_t *period_us;          /* at which the driver asks; NULL: it keeps no period */
    fathom_pulse_meter_t *meter;        /* NULL: it measures no pulses */
    const pins_t *pins;                 /* with meter */
    fathom_model_facts_t model;         /* of an A16 or A05: its facts with the settings of the user */
    fathom_line_byte_t trigger_byte;    /* of a relative that starts by a byte */
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
        fathom_hps167_uart_t hps167_uart;
    } driver;
    driver_selection_t selection;
    driver_check_t check;
    driver_temperature_t temperature;
    /* of an HPS-167S */
    fathom_hps167s_auto_t unasked; /* receives unsolicited measurements */
    uint16_t unasked_frames[FATHOM_STREAM_COUNTERS];
    fathom_hps167s_limits_t limits;
};

/* The configuration that all drivers with requests share. A driver refuses address 0 if its sensor cannot have it. */
fathom_modbus_config_t driver_config(const port_t *port, const reader_settings_t *settings);

/* Adds reads of the temperature to a driver that is initialised with no period (temperature.c). */
void driver_add_temperature(reader_t *reader, const reader_settings_t *settings,
                            driver_get_temperature_t *get);

/* The clock of the line. */
uint32_t driver_now_us(const reader_t *reader);

/* ---- the rows and functions of models.c ---- */

/* A16 6(3), A05 3(3). 0x00 is an address, 0xFF is for all units. */
enum { DYP_ADDRESS = 0x0200, DYP_MAX_ADDRESS = 0xFE };

extern const model_mode_t a16_modes[MODEL_MODES], a05_modes[MODEL_MODES], hps167s_modes[MODEL_MODES];
extern const model_mode_t dyp_free_mode, hps167_uart_mode; /* of relatives alone */
extern const setting_t a16_settings[], a05_settings[], hps167s_settings[];

model_get_t a16_get, a05_get, hps167s_get;
model_set_t a16_set, a05_set, hps167s_set, hps167s_set_all;
model_reset_t hps167s_reset_interface, hps167s_reset_sensor;
model_simulate_t a16_simulate, a05_simulate, hps167s_simulate;
model_decode_t dyp_decode, hps167s_decode;

void dyp_decode_sum(struct decode_frame *frame, const model_t *model);
bool dyp_confirm(inquiry_t *inquiry, const model_t *model);
bool hps167s_identify(inquiry_t *inquiry);
bool hps167s_is_alike(const uint8_t *bytes, uint16_t count);
const char *hps167s_read_changes(uint8_t function, uint16_t first, uint16_t count);
const char *hps167s_exception_name(uint8_t code);

#endif
