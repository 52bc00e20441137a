/* SPDX-License-Identifier: MIT */
#include "commands/commission/presence.h"

#include <string.h>

#include "device/setting_text.h"

enum {
    READS = 3,
    /* Fewer bytes than this are no response: the line's own, where it is held by nothing. The shortest frame has 5. */
    LEAST_BYTES = 3,
    /* In which the response of a second unit comes, of an HPS-167S within 20 ms behind an adapter's 16. A module that
     * is at work on a measurement may need longer (A16 3: 110 ms, A05 2(3): 210 ms). */
    SECOND_RESPONSE_US = 250000,
    SECOND_RESPONSE_HPS167S_US = 60000
};

static evidence_t evidence_of(const session_t *session)
{
    evidence_t evidence;
    listener_judge(&session->channel.listener, session->station->address, &evidence);
    return evidence;
}

/* Where another unit sends by itself, its first and its last frame may be cut off. */
static bool is_silent(const session_t *session)
{
    const evidence_t evidence = evidence_of(session);
    const bool is_rest = evidence.rest >= LEAST_BYTES && evidence.foreign == 0;
    return evidence.own == 0 && !is_rest && evidence.streamed_a16 == 0 && evidence.streamed_a05 == 0;
}

/* What is asked for: the number, or where the model has none its address, which is what it was asked at. */
static fathom_status_t ask_number(session_t *session, char number[SETTING_TEXT])
{
    const setting_t *const settings = session_settings(session);
    const setting_t *const uuid = setting_of(settings, "uuid");
    const fathom_status_t status =
        session_get(session, uuid != NULL ? uuid : setting_of(settings, "address"), number);
    if (status != FATHOM_OK || uuid != NULL) return status;
    char address[SETTING_TEXT];
    (void)snprintf(address, sizeof address, "%u", session->station->address);
    if (strcmp(number, address) != 0) return FATHOM_ERR_MALFORMED;
    (void)snprintf(number, SETTING_TEXT, "-");
    return status;
}

/* The line was busy, or another master asked the same unit: that proves nothing about the unit. */
static bool is_of_line(fathom_status_t status)
{
    return status == FATHOM_ERR_LINE_BUSY || status == FATHOM_ERR_OTHER_MASTER;
}

static bool has_stopped(const session_t *session, fathom_status_t status)
{
    const host_t *const host = session->channel.host;
    return status == FATHOM_ERR_CANCELLED || status == FATHOM_ERR_PORT || host->has_ended(host->ctx);
}

/* The first read, which may find nothing. */
static present_t find(session_t *session, unsigned times, presence_t *presence)
{
    for (unsigned i = 0; i != times; i++) {
        presence->status = ask_number(session, presence->number);
        if (has_stopped(session, presence->status)) return PRESENT_STOPPED;
        if (presence->status == FATHOM_OK) return PRESENT_ONE;
        if (is_of_line(presence->status)) return PRESENT_UNKNOWN;
        if (presence->status != FATHOM_ERR_NO_RESPONSE || !is_silent(session)) return PRESENT_UNCLEAR;
    }
    return PRESENT_NONE;
}

static present_t ask(session_t *session, unsigned times, presence_t *presence)
{
    const uint32_t listen_us =
        session->station->model->is_dyp ? SECOND_RESPONSE_US : SECOND_RESPONSE_HPS167S_US;
    const present_t found = find(session, times, presence);
    if (found != PRESENT_ONE) return found;
    for (unsigned i = 0; i != READS; i++) {
        char number[SETTING_TEXT];
        if (i != 0) presence->status = ask_number(session, number);
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

presence_t presence_ask(session_t *session, uint8_t address, unsigned times)
{
    presence_t presence = {.what = PRESENT_STOPPED, .status = FATHOM_ERR_ARGUMENT};
    const fathom_line_settings_t line = session->station->line;
    if (session_move(session, address, &line)) presence.what = ask(session, times, &presence);
    return presence;
}

void presence_explain(session_t *session, const presence_t *presence)
{
    if (presence->is_two)
        (void)fprintf(stderr, "two units answer at address %u", session->station->address);
    else
        session_explain(session, presence->status);
}
