/* SPDX-License-Identifier: MIT */
#ifndef READER_H
#define READER_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/stream.h"
#include "fathom/sensor/internal/dyp.h"
#include "ports/port.h"

/* Settings of the user that only some sensors have, or only in some modes. */
enum {
    READER_TAKES_PROBES = 1,
    READER_TAKES_MEANINGS = 2,
    READER_TAKES_WINDOW = 4,
    READER_TAKES_VALUE = 8,
    READER_TAKES_TEMPERATURE = 32
};

/* The limits and meanings of values of the user, in place of those of the model. */
typedef struct {
    uint16_t min_mm, max_mm;
    uint8_t value_fffd, value_fffe, value_ffff, value_0; /* fathom_meaning_t */
} reader_window_t;

/* The settings of the user. A member that is 0 selects the driver's default. */
typedef struct {
    uint32_t timeout_us; /* of a response; without requests: until the readings are stale */
    uint32_t period_us;  /* between two requests */
    uint32_t repeat_us;  /* of a contact without a period: between two samples of one state; 0: 35 minutes */
    const fathom_line_settings_t *line; /* of each request; NULL: the settings of the port */
    uint32_t backoff_us;                /* longest pause after requests without a response */
    reader_window_t window;             /* limits and meanings of values */
    uint32_t temperature_us;            /* between two reads of the temperature; 0: it is not read */
    uint8_t probes;                     /* bit probe - 1 */
    uint8_t value;                      /* fathom_dyp_value_t if has_value; otherwise RX is not driven */
    bool has_value;
    uint8_t address;
    uint8_t retries;
} reader_settings_t;

/* Of the only sensor on a line: less than any period. A sensor that does not respond gets as many requests as one that
 * does, because its user may be looking for a loose wire. */
enum { READER_BACKOFF_US = 1 };

/* Of one of several sensors: the greatest, which is the driver's default. */
#define READER_BACKOFF_SHARED_US 0x7FFFFFFFu

/* A sensor that is read through a port: any driver of the library. Each function accepts NULL, a sensor that was never
 * opened: it has no sample, no remark and no facts. */
typedef struct reader reader_t;
struct model_mode;

/*
 * Starts to read through an open port, which must stay valid. *reader is NULL before the first call. A later call
 * starts again, for example after the port was lost, and continues the sequence numbers. Returns false if the port or
 * the driver refuses the settings; reader_refusal() has the reason.
 */
bool reader_open(reader_t **reader, const struct model_mode *mode, port_t *port,
                 const reader_settings_t *settings);
const char *reader_refusal(const reader_t *reader);

/* Restores the sensor and the port, for example a TX that was held low. Call until it is not FATHOM_PENDING. */
fathom_status_t reader_close(reader_t *reader);

/* Frees the memory and sets *reader to NULL. */
void reader_free(reader_t **reader);

/* As fathom_poll() and fathom_due_us() of the library. */
fathom_status_t reader_poll(reader_t *reader, fathom_sample_t *sample);
uint32_t reader_due_us(const reader_t *reader);

/* Returns true if the newest response has more samples: poll again before anything else. */
bool reader_has_more(const reader_t *reader);

/* Gives up the request in progress. */
void reader_cancel(reader_t *reader);

/* The next setting is written once, without a read before or after it (modbus_setting.h). */
void reader_write_next_unchecked(reader_t *reader);

/* Receives the measurements that the sensor sends without a request, between the requests. */
void reader_listen_unasked(reader_t *reader);

/* Returns a message for the user, once; NULL: none. */
const char *reader_remark(reader_t *reader);

/* Returns true if the transaction is a request of this sensor. */
bool reader_has_sent(const reader_t *reader, const fathom_transaction_t *transaction);

/* What the driver has counted since the last call. */
typedef struct {
    uint16_t stream[FATHOM_STREAM_COUNTERS];
    uint16_t responses;
    uint16_t failures;
    uint32_t noises;      /* pulses that were too short */
    uint32_t missed;      /* edges without an event */
    uint32_t lost_events; /* that did not fit into the kernel's queue */
} reader_counters_t;
void reader_take_counters(reader_t *reader, reader_counters_t *counters);

/* What the common interface of the library does not show. */
typedef struct {
    uint32_t least_period_us; /* at which the driver asks at most; 0: it does not keep a period */

    /* Why an attempt failed. */
    const uint16_t *values; /* the 16-bit values of the newest response */
    uint8_t value_count;
    bool is_unexpected;    /* with FATHOM_ERR_MALFORMED: the response does not fit the request */
    uint8_t refused_probe; /* with FATHOM_ERR_MALFORMED: the probe whose value was refused; 0: none */
    uint16_t refused_raw;
    uint16_t min_mm; /* the limits of a distance */
    uint16_t max_mm;
    uint8_t exception;   /* the newest of Modbus; 0: none */
    bool has_unasked;    /* the sensor has sent a measurement without a request */
    bool is_automatic;   /* a sensor with a trigger sends without one */
    bool is_in_progress; /* a request was sent, and its response is pending */
    unsigned timeouts_in_row;
    uint32_t backoff_left_us; /* until the next request, because of them */

    /* The setting that was written last. */
    bool is_written;                    /* a request that changes the sensor has left */
    bool is_setting;                    /* the driver has not finished it */
    bool is_later;                      /* the baud rate changes at the next power-on */
    int8_t acknowledgement;             /* the status of that request */
    uint8_t address;                    /* at which the driver now sends requests, ... */
    const fathom_line_settings_t *line; /* ... and at which line settings; NULL: those of the port */

    bool has_temperature;
    int16_t temperature_dc; /* tenths of a degree Celsius */
} reader_facts_t;
reader_facts_t reader_facts(const reader_t *reader);

#endif
