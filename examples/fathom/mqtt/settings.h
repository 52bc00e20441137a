/* SPDX-License-Identifier: MIT */
#ifndef MQTT_SETTINGS_H
#define MQTT_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

/* What the user wants of `fathom publish`, apart from the sensors. */

enum { SETTINGS_NAME = 101, SETTINGS_HOST = 256, SETTINGS_PATH = 1024 };

/* A path is "" if there is none. */
typedef struct {
    char host[SETTINGS_HOST];
    uint16_t port;
    uint16_t keep_alive_s;
    char client_id[SETTINGS_NAME];
    char user[SETTINGS_NAME]; /* "": none */
    char password_file[SETTINGS_PATH];
    /* Lines of the file, for messages about what the broker refuses: of the user, or of the host; of `tls`; of client-id
     * (0: the id comes from the prefix and the site). */
    unsigned line;
    unsigned tls_line;
    unsigned id_line;
    bool has_tls;
    char ca_file[SETTINGS_PATH]; /* "": the system's authorities */
    char certificate_file[SETTINGS_PATH];
    char key_file[SETTINGS_PATH];
} broker_settings_t;

typedef struct {
    char path[SETTINGS_PATH]; /* of the file */
    char site[SETTINGS_NAME];
    unsigned site_line; /* 0: the site is the name of the host */
    char prefix[SETTINGS_NAME];
    char discovery[SETTINGS_NAME]; /* "": off */
    broker_settings_t broker;
    uint32_t queue_messages;
    uint32_t queue_bytes;
} publish_settings_t;

#endif
