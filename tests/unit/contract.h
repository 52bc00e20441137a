/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CONTRACT_H
#define FATHOM_TESTS_CONTRACT_H

#include "drivers.h"
#include "fathom/engine/contact.h"
#include "fathom/engine/internal/modbus_unit.h"
#include "fathom/sensor/internal/dyp.h"

/* What test_driver_contract.c has to know of a driver, and of the way in which its device speaks. */

typedef struct contract_driver contract_driver_t;

/* Asked on the transport of Modbus, or on a line; listening to frames; triggered; or looking at a contact. */
typedef struct {
    void (*begin)(uint32_t now_us); /* all begins anew, at this time */
    fathom_status_t (*poll)(void);  /* checked */
    /* The device says this next; returns what comes of it. contract_came_us is when it had said it, and the driver
     * tells that at most contract_slack_us too late. */
    fathom_status_t (*says)(const contract_driver_t *driver, uint16_t value);
    void (*breaks)(bool on);  /* the port */
    bool (*is_used)(void);    /* anything was done with the port */
    bool (*is_at_work)(void); /* a driver listens there, or something of it is under way */
    fathom_sensor_t *sensor;
    const fathom_sample_t *sample;
    uint32_t *now_us;
} contract_kind_t;

extern uint32_t contract_came_us;
extern uint32_t contract_slack_us;

/* A config that is refused: the member, or the fact of its model, has any value from..to. */
typedef struct {
    const char *what;
    void *member;
    uint32_t from, to;
    uint8_t size;
    bool is_fact;
} contract_wrong_t;

struct contract_driver {
    const char *name;
    const contract_kind_t *kind;
    void (*prepare)(void); /* the default config */
    fathom_status_t (*init)(void);
    fathom_status_t (*init_without_config)(void);
    fathom_sensor_t (*sensor)(void);
    fathom_status_t (*poll)(fathom_sample_t *sample); /* without a sensor; due_us too */
    uint32_t (*due_us)(void);
    void *memory, *config;
    size_t size, config_size;
    void (*deinit)(void);
    size_t (*frame)(uint8_t *frame, uint16_t value);

    /* Values, what the first one is as the first sample but for its time, and one that is refused. */
    uint16_t good, other, refused;
    fathom_sample_t sample;
    uint16_t *sequence, *implausible;

    /* Members of the config. */
    uint8_t *address, *retries;
    uint32_t *period_us, *timeout_us, *command_timeout_us, *backoff_us, *start_us, *stale_us;
    fathom_model_facts_t *facts; /* of the config: a copy of the default */
    fathom_contact_timing_t *timing;
    uint16_t *gap_us;
    contract_wrong_t wrong[20];

    /* Of those that are asked: which registers, and the defaults. */
    uint16_t first;
    uint8_t count, most_address;
    uint32_t least_period_us, default_timeout_us;
    uint16_t max_mm;
    fathom_status_t (*command)(void);
    void (*cancel)(void);
    uint8_t (*exception)(void);
    const fathom_modbus_unit_t *(*unit)(void);
    void (*power_on)(void);
};

extern const contract_driver_t contract_a05_auto, contract_a05_dyp, contract_a05_modbus, contract_a05_relay,
    contract_a16_auto, contract_a16_controlled, contract_a16_modbus, contract_a16_pwm, contract_a16_switch,
    contract_hps167_uart, contract_hps167s, contract_hps167s_auto;

#endif
