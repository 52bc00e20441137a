/* SPDX-License-Identifier: MIT */
#include "device/session.h"

#include <string.h>

#include "diagnosis/advice.h"
#include "ports/line_text.h"

const port_options_t *session_port(const session_t *session) { return session->sensor->port; }

const setting_t *session_settings(const session_t *session) { return session->sensor->model->settings; }

void session_listen(session_t *session, uint32_t for_us) { port_listen(&session->port, for_us); }

/* Starts the driver of the sensor. */
static bool start(session_t *session)
{
    sensor_t *const sensor = session->sensor;
    reader_settings_t settings = sensor->settings;
    settings.line = &sensor->line;
    settings.backoff_us = READER_BACKOFF_US;
    settings.address = sensor->address;
    if (!sensor_start(sensor, &session->port, &settings)) {
        char text[256];
        sensor_refusal(sensor, text, sizeof text);
        (void)fprintf(stderr, "fathom: %s\n", text);
        return false;
    }
    if (port_has_line(&session->port)) reader_listen_unasked(sensor->reader);
    return true;
}

bool session_open(session_t *session, const host_t *host)
{
    port_settings_t settings = port_options_settings(session_port(session));
    settings.line = session->sensor->line;
    if (!session->has_begun && !host->begin(host->ctx)) return false;
    session->has_begun = true;
    if (!port_open_now(&session->port, host, &settings)) {
        (void)fprintf(stderr, "fathom: %s\n", port_error(&session->port));
        return false;
    }
    progress_init(&session->progress, stderr, host->now_us(host->ctx), 0);
    session->doing = NULL;
    counters_begin_port(&session->port_counts, &session->port);
    if (!start(session)) {
        port_close(&session->port);
        return false;
    }
    if (port_has_line(&session->port)) port_listen(&session->port, PORT_LISTEN_US);
    return true;
}

bool session_move(session_t *session, uint8_t address, const fathom_line_settings_t *line)
{
    sensor_t *const sensor = session->sensor;
    reader_cancel(sensor->reader);
    memset(&sensor->counters, 0, sizeof sensor->counters); /* they prove nothing about another place */
    sensor->address = address;
    sensor->line = *line;
    sensor_set_name(sensor);
    return start(session);
}

void session_close(session_t *session)
{
    session_end_task(session);
    port_close(&session->port);
}

void session_begin_task(session_t *session, const char *doing) { session->doing = doing; }

void session_end_task(session_t *session)
{
    progress_clear(&session->progress);
    session->doing = NULL;
}

/* Waits for the reader, and wakes often enough to show the seconds. */
static fathom_status_t wait_for(session_t *session)
{
    enum { SHOW_US = 500000 };
    progress_t *const progress = &session->progress;
    const host_t *const host = session->port.host;
    const uint32_t due_us = reader_due_us(session->sensor->reader);
    progress_show(progress, host->now_us(host->ctx), 0,
                  session->doing != NULL ? session->doing : "waiting for the sensor");
    return port_wait(&session->port, progress->is_terminal && due_us > SHOW_US ? SHOW_US : due_us);
}

fathom_status_t session_call(session_t *session, session_call_t call, void *ctx)
{
    reader_t *const reader = session->sensor->reader;
    counters_begin_attempt(&session->sensor->counters);
    listener_forget(&session->port.listener);
    fathom_status_t status = call(reader, ctx);
    while (status == FATHOM_PENDING) {
        const fathom_status_t waited = wait_for(session);
        status = waited == FATHOM_OK ? call(reader, ctx) : waited;
    }
    if (session->doing == NULL) progress_clear(&session->progress);
    return status;
}

/* ---- settings ---- */

typedef struct {
    const setting_t *setting;
    char *text;
    int32_t value;
} operand_t;

static fathom_status_t call_get(reader_t *reader, void *ctx)
{
    const operand_t *const operand = ctx;
    return operand->setting->get(reader, operand->setting, operand->text);
}

static fathom_status_t call_set(reader_t *reader, void *ctx)
{
    const operand_t *const operand = ctx;
    return operand->setting->set(reader, operand->setting, operand->value);
}

/*
 * Repeats a call that failed and wrote nothing. A busy line and another master prove nothing about the sensor. If the
 * sensor sends by itself, one of its frames may have collided with the request or the response.
 */
static fathom_status_t call_again(session_t *session, session_call_t call, operand_t *operand)
{
    enum { TIMES = 4 };
    reader_t *const reader = session->sensor->reader;
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned times = 0; times != TIMES; times++) {
        status = session_call(session, call, operand);
        const bool may_have_collided = status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_CHECKSUM ||
                                       status == FATHOM_ERR_MALFORMED;
        const reader_facts_t facts = reader_facts(reader);
        const bool is_of_line = status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
        if (facts.is_written || !(is_of_line || (may_have_collided && facts.has_unasked))) break;
    }
    return status;
}

fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT])
{
    operand_t operand = {.setting = setting, .text = text};
    text[0] = '\0';
    return call_again(session, call_get, &operand);
}

fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value)
{
    operand_t operand = {.setting = setting, .value = value};
    return call_again(session, call_set, &operand);
}

const char *session_line_text(const session_t *session, char text[LINE_TEXT])
{
    return port_line_text(&session->port, &session->sensor->line, text);
}

void session_explain(session_t *session, fathom_status_t status)
{
    sensor_t *const sensor = session->sensor;
    failure_t failure = {.status = status,
                         .model = sensor->model,
                         .mode = sensor->mode,
                         .reader = sensor->reader,
                         .port = &session->port,
                         .counters = &sensor->counters,
                         .line = &sensor->line,
                         .address = sensor->address,
                         .is_setting = true};
    (void)counters_take(&sensor->counters, &session->port_counts, &session->port, sensor->reader);
    listener_judge(&session->port.listener, sensor->address, &failure.evidence);
    advice_print(stderr, &failure);
}
