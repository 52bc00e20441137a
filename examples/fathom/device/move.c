/* SPDX-License-Identifier: MIT */
#include "device/move.h"

typedef struct {
    uint8_t address;
    fathom_line_settings_t line;
} place_t;

static bool is_at(const place_t *one, const place_t *other)
{
    return one->address == other->address && one->line.baud == other->line.baud;
}

/* What every unit of the model answers. */
static const setting_t *first_read(const session_t *session)
{
    const setting_t *setting = session_settings(session);
    while (setting->get == NULL || setting->is_of_variant || setting->kind == SETTING_PRESENT) setting++;
    return setting;
}

static bool is_silent(session_t *session, const place_t *place)
{
    enum { TIMES = 2 };
    for (unsigned times = 0; times != TIMES; times++) {
        char text[SETTING_TEXT];
        char line[LINE_TEXT];
        if (!session_move(session, place->address, &place->line)) return false;
        const fathom_status_t status = session_get(session, first_read(session), text);
        const bool is_garbage = status == FATHOM_ERR_CHECKSUM || status == FATHOM_ERR_MALFORMED;
        if (status == FATHOM_ERR_NO_RESPONSE) continue;
        (void)fflush(stdout);
        (void)fprintf(stderr, "fathom: nothing was written: at address %u, %s, ", place->address,
                      session_line_text(session, line));
        if (status == FATHOM_OK || status == FATHOM_ERR_EXCEPTION || is_garbage)
            (void)fputs("a device answers already; two at one address would answer at once", stderr);
        else
            session_explain(session, status);
        (void)fputs("\n", stderr);
        return false;
    }
    return true;
}

bool move_is_free(session_t *session, uint8_t address, uint32_t baud)
{
    station_t *const station = session->station;
    const place_t home = {station->address, station->line};
    place_t places[] = {{address, home.line}, {address, home.line}};
    bool is_free = true;
    places[1].line.baud = baud;
    for (size_t i = 0; i != sizeof places / sizeof places[0] && is_free; i++) {
        const bool is_done = is_at(&places[i], &home) || (i != 0 && is_at(&places[i], &places[0]));
        if (!is_done) is_free = is_silent(session, &places[i]);
    }
    return session_move(session, home.address, &home.line) && is_free;
}

bool move_follow(session_t *session)
{
    const station_t *const station = session->station;
    const fathom_modbus_unit_t *const unit = station->reader.unit;
    const fathom_line_settings_t line = unit->line_settings != NULL ? *unit->line_settings : station->line;
    return session_move(session, unit->address, &line);
}
