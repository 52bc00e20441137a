/* SPDX-License-Identifier: MIT */
#include "device/presence.h"

#include <string.h>

#include "device/setting_text.h"

enum {
    READS = 3,
    /* Fewer bytes are no response: an open line may produce them. The shortest frame has 5. */
    LEAST_BYTES = 3
};

static evidence_t evidence_of(const session_t *session)
{
    evidence_t evidence;
    listener_judge(&session->port.listener, session->sensor->address, &evidence);
    return evidence;
}

/* If another sensor sends automatically, its first and last frame may be incomplete. */
static bool is_silent(const session_t *session)
{
    const evidence_t evidence = evidence_of(session);
    const bool is_rest = evidence.rest >= LEAST_BYTES && evidence.foreign == 0;
    return evidence.own == 0 && !is_rest && evidence.streamed_a16 == 0 && evidence.streamed_a05 == 0;
}

/* Reads the UUID. If the model has none, reads the address register, which must match. */
static fathom_status_t read_number(session_t *session, char number[SETTING_TEXT])
{
    const setting_t *const settings = session_settings(session);
    const setting_t *const uuid = setting_of(settings, "uuid");
    const fathom_status_t status =
        session_get(session, uuid != NULL ? uuid : setting_of(settings, "address"), number);
    if (status != FATHOM_OK || uuid != NULL) return status;
    char address[SETTING_TEXT];
    (void)snprintf(address, sizeof address, "%u", session->sensor->address);
    if (strcmp(number, address) != 0) return FATHOM_ERR_MALFORMED;
    (void)snprintf(number, SETTING_TEXT, "-");
    return status;
}

/* A busy line and another master prove nothing about the sensor. */
static bool is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

static bool has_stopped(const session_t *session, fathom_status_t status)
{
    const host_t *const host = session->port.host;
    return status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT || host->has_ended(host->ctx);
}

static present_t find(session_t *session, unsigned times, presence_t *presence)
{
    for (unsigned i = 0; i != times; i++) {
        presence->status = read_number(session, presence->number);
        if (has_stopped(session, presence->status)) return PRESENT_STOPPED;
        if (presence->status == FATHOM_OK) return PRESENT_ONE;
        if (is_of_line(presence->status)) return PRESENT_UNKNOWN;
        if (presence->status != FATHOM_ERR_NO_RESPONSE || !is_silent(session)) return PRESENT_UNCLEAR;
    }
    return PRESENT_NONE;
}

static present_t ask(session_t *session, unsigned times, presence_t *presence)
{
    const uint32_t listen_us = session->sensor->model->second_response_us;
    const present_t found = find(session, times, presence);
    if (found != PRESENT_ONE) return found;
    for (unsigned i = 0; i != READS; i++) {
        char number[SETTING_TEXT];
        if (i != 0) presence->status = read_number(session, number);
        if (has_stopped(session, presence->status)) return PRESENT_STOPPED;
        if (is_of_line(presence->status)) return PRESENT_UNKNOWN;
        if (presence->status != FATHOM_OK) return PRESENT_UNCLEAR;
        session_listen(session, listen_us);
        presence->is_two =
            evidence_of(session).fitting > 1 || (i != 0 && strcmp(number, presence->number) != 0);
        if (presence->is_two) return PRESENT_UNCLEAR;
    }
    return has_stopped(session, FATHOM_OK) ? PRESENT_STOPPED : PRESENT_ONE;
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
        session_explain(session, presence->status);
}

/* ---- moving a sensor ---- */

/* Bytes without a response do not occupy a place: they may be frames of this sensor, heard at another rate. */
static bool is_free_at(session_t *session, uint8_t address, const fathom_line_settings_t *line)
{
    enum { TIMES = 2 };
    presence_t presence = {.what = PRESENT_NONE};
    char text[LINE_TEXT];
    unsigned times = 0;
    do presence = presence_ask(session, address, line, 1);
    while (presence.status == FATHOM_ERR_NO_RESPONSE && ++times != TIMES);
    if (presence.status == FATHOM_ERR_NO_RESPONSE) return true;
    if (presence.status == FATHOM_ERR_ARGUMENT) return false; /* session_move() has printed the reason */
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: nothing was written: at address %u, %s, ", address,
                  session_line_text(session, text));
    if (presence.what == PRESENT_ONE || presence.what == PRESENT_UNCLEAR)
        (void)fputs("a sensor responds already. Two sensors at one address would respond at the same time",
                    stderr);
    else
        session_explain(session, presence.status);
    (void)fputs("\n", stderr);
    return false;
}

bool presence_is_free(session_t *session, uint8_t address, uint32_t baud)
{
    const uint8_t home = session->sensor->address;
    const fathom_line_settings_t home_line = session->sensor->line;
    fathom_line_settings_t line = home_line;
    line.baud = baud;
    const bool is_free = (address == home || is_free_at(session, address, &home_line)) &&
                         (baud == home_line.baud || is_free_at(session, address, &line));
    return session_move(session, home, &home_line) && is_free;
}

bool presence_follow(session_t *session)
{
    const sensor_t *const sensor = session->sensor;
    const reader_facts_t facts = reader_facts(sensor->reader);
    const fathom_line_settings_t line = facts.line != NULL ? *facts.line : sensor->line;
    return session_move(session, facts.address, &line);
}
