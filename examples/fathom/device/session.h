/* SPDX-License-Identifier: MIT */
#ifndef SESSION_H
#define SESSION_H

#include "diagnosis/advice.h"
#include "reading/site.h"
#include "sensors/setting.h"

/* A session with one sensor at a port: what all commands share that ask for, or change, more than distances. */
typedef struct {
    site_t site;
    sensor_t *station; /* the only one, or one after another */
    bool has_begun;    /* the host */
    port_t port;
    port_counts_t port_counts;
    bool is_json;
} session_t;

/* Its port. */
const port_options_t *session_port(const session_t *session);

/* The table of the sensor's settings. */
const setting_t *session_settings(const session_t *session);

/* For session->station, which may be another one than before. False after saying why. */
bool session_open(session_t *session, const host_t *host);
void session_close(session_t *session);

/* On the open port from now on the sensor is asked at this address, at these line settings: another one, or the same
 * one that has been moved. What was under way is given up. False after saying why. */
bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line);

/* Asks nothing for so long; what is heard is added to what the last call has heard. A signal ends it. */
void session_listen(session_t *session, uint32_t for_us);

/* Calls until it is not FATHOM_PENDING, waiting as long as it may. A signal ends it: FATHOM_ERR_CANCELLED. */
typedef fathom_status_t (*session_call_t)(reader_t *reader, void *ctx);
fathom_status_t session_call(session_t *session, session_call_t call, void *ctx);
fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value);

/* "9600 8N1", at which the sensor is asked; of a connection "Modbus TCP". */
const char *session_line_text(const session_t *session, char text[LINE_TEXT]);

/* What has gone wrong with the last call, and what to try, without a line feed. A response that cannot be what was
 * asked for is no distance here. */
void session_explain(session_t *session, fathom_status_t status);

#endif
