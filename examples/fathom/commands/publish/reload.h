/* SPDX-License-Identifier: MIT */
#ifndef RELOAD_H
#define RELOAD_H

#include "mqtt/publisher.h"
#include "reading/poll_loop.h"

/* Reads the configuration file anew while its sensors are read: what has not changed goes on as if nothing had happened. */

typedef struct {
    config_t *config;          /* that holds now */
    results_config_t *configs; /* by slot */
    results_t *results;
    poll_loop_t *loop;
    publisher_t *publisher;
    config_t next;
    bool is_waiting; /* for a port that is in the middle of a request */
    uint64_t since_us;
} reload_t;

/* Reads the file. False after saying what is wrong with it: what holds now goes on. */
bool reload_begin(reload_t *reload, const char *command);

/* From outside of the loop's steps, before each sleep. True: what the file says holds now. */
bool reload_tick(reload_t *reload);

#endif
