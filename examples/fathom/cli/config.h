/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_H
#define CONFIG_H

#include <stdio.h>

#include "cli/config_keys.h"
#include "cli/result_options.h"

/* What a configuration file says. */

enum { CONFIG_NAME = 101, CONFIG_HOST = 256, CONFIG_PATH = 1024 };

/* Each path is "" where there is none. */
typedef struct {
    char host[CONFIG_HOST];
    uint16_t port;
    char client_id[CONFIG_NAME];
    char user[CONFIG_NAME]; /* "": none */
    char password_file[CONFIG_PATH];
    unsigned line;     /* of the file, for what the broker refuses: user: and the like, */
    unsigned tls_line; /* and tls: */
    uint16_t keep_alive_s;
    bool has_tls;
    char ca_file[CONFIG_PATH]; /* "": the system's authorities */
    char certificate_file[CONFIG_PATH];
    char key_file[CONFIG_PATH];
} broker_config_t;

typedef struct {
    char path[CONFIG_PATH]; /* of the file */
    char site[CONFIG_NAME];
    char prefix[CONFIG_NAME];
    char discovery[CONFIG_NAME]; /* "": off */
    broker_config_t broker;
    uint32_t queue_messages;
    uint32_t queue_bytes;
    sensor_options_t sensors;  /* each has a name of its own */
    char *words[MAX_STATIONS]; /* in which paths of their ports stand */
    size_t word_count;
} config_t;

/* What is made of the readings of each station, by its slot; of stations that are read meanwhile it stays as it is. */
typedef results_config_t config_results_t[STATION_SLOTS];

/* Reads a file; config->sensors.beside is set, all else is cleared. False after saying what is wrong; then there is nothing
 * to free. The ports' options may not be used after config_free. */
bool config_load(config_t *config, config_results_t results, const char *command, const char *path);
void config_free(config_t *config);

/* ---- for config.c ---- */

/* A text of these characters into a buffer of CONFIG_NAME; slashes: also between others. */
bool config_name(char text[CONFIG_NAME], const char *value, bool slashes);

/* Reads lines: and below into config->sensors. top: the values there. */
bool config_sensors(config_t *config, config_results_t results, config_file_t *file, const char *command,
                    const config_values_t *top);

#endif
