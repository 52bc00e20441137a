/* SPDX-License-Identifier: MIT */
#ifndef SESSION_H
#define SESSION_H

#include "diagnosis/advice.h"
#include "output/progress.h"
#include "reading/site.h"
#include "sensors/setting.h"

/* A session with one sensor at a port, for commands that read or change more than distances. */
typedef struct {
    site_t site;
    sensor_t *sensor; /* of the site; a command that takes several sets one after another */
    bool has_begun;   /* host_t.begin was called */
    port_t port;
    port_counts_t port_counts;
    progress_t progress;
    const char *doing; /* shown while the calls of a longer task wait; NULL: each call is a task of its own */
    bool is_json;
} session_t;

/* The settings of the sensor's port. */
const port_options_t *session_port(const session_t *session);

/* The table of the sensor's settings. */
const setting_t *session_settings(const session_t *session);

/* Opens the port of session->sensor, and listens long enough to know what the sensor sends by itself. Returns false after
 * printing why. */
bool session_open(session_t *session, const host_t *host);
void session_close(session_t *session);

/* Asks another sensor on the open port, or the same sensor after its address or its line settings were changed. Cancels
 * the present request. Returns false after printing why. */
bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line);

/* Listens without a request. What is received is added to what the last call received. A signal ends it. */
void session_listen(session_t *session, uint32_t for_us);

/* Calls until the result is not FATHOM_PENDING, and waits between two calls. A signal ends it: FATHOM_ERR_CANCELLED. If
 * the port is lost: FATHOM_ERR_PORT. */
typedef fathom_status_t (*session_call_t)(reader_t *reader, void *ctx);
fathom_status_t session_call(session_t *session, session_call_t call, void *ctx);

/* Shows on a terminal what the next calls do, such as "reading the settings", if that takes longer than two seconds. The
 * end removes the line; it must come before anything is printed. */
void session_begin_task(session_t *session, const char *doing);
void session_end_task(session_t *session);

/* Reads or writes a setting. Repeats a call that failed and wrote nothing, if the failure proves nothing about the
 * sensor. */
fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value);

/* The line settings of the sensor, "9600 8N1". Behind a gateway "Modbus TCP". */
const char *session_line_text(const session_t *session, char text[LINE_TEXT]);

/* Prints why the last call failed and what to try, without a line feed. */
void session_explain(session_t *session, fathom_status_t status);

#endif
