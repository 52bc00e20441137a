/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <string.h>

#include "device/session.h"

/* ---- messages ---- */

void session_begin_task(session_t *session, const char *doing) { session->doing = doing; }

void session_end_task(session_t *session)
{
    progress_clear(&session->progress);
    session->doing = NULL;
}

const char *session_line_text(const session_t *session, char text[LINE_TEXT])
{
    if (port_has_settings(session->port.kind)) return line_text(&session->sensor->line, text);
    return port_has_bytes(session->port.kind) ? "RTU over TCP" : "Modbus TCP";
}

/* Prints why the last call failed and what to try. */
static void explain(session_t *session, fathom_status_t status)
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
    (void)counters_take(&sensor->counters, &session->port, sensor->reader);
    listener_judge(&session->port.listener, sensor->address, &failure.evidence);
    advice_print(stderr, &failure);
}

bool session_fail(session_t *session, fathom_status_t status, const char *format, ...)
{
    va_list arguments;
    session_end_task(session);
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: ", session->sensor->name);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    if (status != FATHOM_OK) {
        (void)fputs(": ", stderr);
        explain(session, status);
    }
    (void)fputs("\n", stderr);
    return false;
}

/* ---- opening and closing ---- */

/* Starts the driver of the sensor. */
static bool start(session_t *session)
{
    sensor_t *const sensor = session->sensor;
    reader_settings_t settings = sensor->settings;
    settings.line = &sensor->line;
    settings.backoff_us = READER_BACKOFF_US;
    settings.address = sensor->address;
    if (!reader_open(&sensor->reader, sensor->mode, &session->port, &settings))
        return session_fail(session, FATHOM_OK, "%s", reader_refusal(sensor->reader));
    if (port_has_bytes(session->port.kind)) reader_listen_unasked(sensor->reader);
    return true;
}

bool session_open(session_t *session, const host_t *host)
{
    port_options_t options = *session->sensor->port;
    options.line = session->sensor->line;
    const bool is_first = !session->has_begun;
    if (is_first && !host->begin(host->ctx)) return false;
    session->has_begun = true;
    if (!port_open_now(&session->port, host, &options)) {
        (void)fprintf(stderr, "fathom: %s\n", session->port.error_text);
        return false;
    }
    if (is_first) advice_print_opening(&session->port);
    progress_init(&session->progress, stderr, host->now_us(host->ctx), 0);
    session->doing = NULL;
    if (!start(session)) {
        port_close(&session->port);
        return false;
    }
    if (port_has_bytes(session->port.kind)) port_listen(&session->port, PORT_LISTEN_US);
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

/* ---- calls ---- */

fathom_status_t session_call(session_t *session, session_call_t call, void *ctx)
{
    enum { SHOW_US = 500000 }; /* on a terminal, the wait ends often enough to show the seconds */
    reader_t *const reader = session->sensor->reader;
    progress_t *const progress = &session->progress;
    const host_t *const host = session->port.host;
    const char *const doing = session->doing != NULL ? session->doing : "waiting for the sensor";
    counters_begin_attempt(&session->sensor->counters);
    listener_forget(&session->port.listener);
    fathom_status_t status = call(reader, ctx);
    while (status == FATHOM_PENDING) {
        const uint32_t due_us = reader_due_us(reader);
        progress_show(progress, host->now_us(host->ctx), 0, doing);
        status = port_wait(&session->port, progress->is_terminal && due_us > SHOW_US ? SHOW_US : due_us);
        if (status == FATHOM_OK) status = call(reader, ctx);
    }
    if (session->doing == NULL) progress_clear(progress);
    return status;
}

typedef struct {
    const model_t *model;
    const setting_t *setting;
    char *text; /* NULL: the setting is written */
    int32_t value;
} operand_t;

static fathom_status_t call_setting(reader_t *reader, void *ctx)
{
    const operand_t *const operand = ctx;
    const setting_t *const setting = operand->setting;
    return operand->text != NULL ? operand->model->get(reader, setting, operand->text)
                                 : operand->model->set(reader, setting, operand->value);
}

/* Returns true if the status proves nothing about the sensor. */
static bool is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

/* Repeats a call that failed and wrote nothing. If the sensor sends automatically, one of its frames may have collided
 * with the request or the response. */
static fathom_status_t call_again(session_t *session, operand_t operand)
{
    enum { TIMES = 4 };
    fathom_status_t status = FATHOM_PENDING;
    for (unsigned times = 0; times != TIMES; times++) {
        status = session_call(session, call_setting, &operand);
        const bool may_have_collided = status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_CHECKSUM ||
                                       status == FATHOM_ERR_MALFORMED;
        const reader_facts_t facts = reader_facts(session->sensor->reader);
        if (facts.is_written || !(is_of_line(status) || (may_have_collided && facts.has_unasked))) break;
    }
    return status;
}

fathom_status_t session_get(session_t *session, const setting_t *setting, char text[SETTING_TEXT])
{
    text[0] = '\0';
    return call_again(session, (operand_t){session->sensor->model, setting, .text = text});
}

fathom_status_t session_set(session_t *session, const setting_t *setting, int32_t value)
{
    return call_again(session, (operand_t){session->sensor->model, setting, .value = value});
}

static fathom_status_t call_measure(reader_t *reader, void *ctx)
{
    fathom_sample_t *const sample = ctx;
    return reader_poll(reader, sample);
}

fathom_status_t session_measure(session_t *session, fathom_sample_t *sample)
{
    return session_call(session, call_measure, sample);
}

/* ---- which sensor responds at an address ---- */

static evidence_t evidence_of(const session_t *session)
{
    evidence_t evidence;
    listener_judge(&session->port.listener, session->sensor->address, &evidence);
    return evidence;
}

/* If another sensor sends automatically, its first and last frame may be incomplete. Fewer than 3 bytes are no response:
 * an open line may produce them. The shortest frame has 5. */
static bool is_silent(const session_t *session)
{
    const evidence_t evidence = evidence_of(session);
    const bool is_rest = evidence.rest >= 3 && evidence.foreign == 0;
    return evidence.own == 0 && !is_rest && evidence.streamed_a16 == 0 && evidence.streamed_a05 == 0;
}

/* Reads the UUID. If the model has none, reads the address register, which must match. */
static fathom_status_t read_number(session_t *session, char number[SETTING_TEXT])
{
    const setting_t *const settings = session->sensor->model->settings;
    const setting_t *const uuid = setting_of(settings, "uuid");
    char address[SETTING_TEXT];
    const fathom_status_t status =
        session_get(session, uuid != NULL ? uuid : setting_of(settings, "address"), number);
    if (status != FATHOM_OK || uuid != NULL) return status;
    (void)snprintf(address, sizeof address, "%u", session->sensor->address);
    if (strcmp(number, address) != 0) return FATHOM_ERR_MALFORMED;
    (void)snprintf(number, SETTING_TEXT, "-");
    return status;
}

/* Reads until the sensor has reported one number three times, or has not responded to `times` requests. */
static present_t ask(session_t *session, unsigned times, presence_t *presence)
{
    enum { READS = 3 };
    const host_t *const host = session->port.host;
    unsigned reads = 0;
    unsigned no_responses = 0;
    while (reads != READS && no_responses != times) {
        char number[SETTING_TEXT];
        const fathom_status_t status = read_number(session, number);
        presence->status = status;
        if (status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT || host->has_ended(host->ctx))
            return PRESENT_STOPPED;
        if (is_of_line(status)) return PRESENT_UNKNOWN;
        if (reads == 0 && status == FATHOM_ERR_NO_RESPONSE && is_silent(session)) {
            no_responses++;
            continue;
        }
        if (status != FATHOM_OK) return PRESENT_UNCLEAR;
        port_listen(&session->port, session->sensor->model->second_response_us);
        if (reads++ == 0) memcpy(presence->number, number, sizeof number);
        presence->is_two = evidence_of(session).fitting > 1 || strcmp(number, presence->number) != 0;
        if (presence->is_two) return PRESENT_UNCLEAR;
    }
    if (host->has_ended(host->ctx)) return PRESENT_STOPPED;
    return reads == READS ? PRESENT_ONE : PRESENT_NONE;
}

presence_t presence_ask(session_t *session, uint8_t address, const fathom_line_settings_t *line,
                        unsigned times)
{
    presence_t presence = {.what = PRESENT_STOPPED, .status = FATHOM_ERR_ARGUMENT};
    const fathom_line_settings_t copy = *line; /* session_move() writes the sensor's, which *line may be */
    if (session_move(session, address, &copy)) presence.what = ask(session, times, &presence);
    return presence;
}

void presence_explain(session_t *session, const presence_t *presence)
{
    if (presence->is_two)
        (void)fprintf(stderr, "two sensors respond at address %u", session->sensor->address);
    else
        explain(session, presence->status);
}
