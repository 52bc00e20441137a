/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getentropy */
#include "mqtt/state.h"

#include <inttypes.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli/options.h"
#include "diagnosis/status_word.h"
#include "fathom/version.h"
#include "mqtt/text.h"
#include "output/timestamp.h"

void state_boot(char boot[BOOT])
{
    uint64_t number = 0;
    if (getentropy(&number, sizeof number) != 0) number = (uint64_t)time(NULL) << 32 ^ (uint64_t)getpid();
    (void)snprintf(boot, BOOT, "%016" PRIx64, number);
}

/* ---- the first part ---- */

static const char *status_of(const state_t *state)
{
    return state->failure != NULL ? state->failure
                                  : status_word(state->station->mode, state->result->sample.kind);
}

#define ADD(text, ...) text_add(text, QUEUE_TEXT, __VA_ARGS__)

static void add_distance(char *text, const state_t *state)
{
    if (state->failure == NULL && state->result->sample.kind == FATHOM_TARGET)
        ADD(text, ",\"distance_mm\":%u", state->result->sample.distance_mm);
    else
        ADD(text, ",\"distance_mm\":null");
}

static void add_temperature(char *text, const state_t *state)
{
    const reader_temperature_t *const temperature = &state->station->reader.temperature;
    char value[16];
    if (state->station->settings.temperature_us == 0) return;
    tenths_text(value, sizeof value, temperature->dc);
    ADD(text, ",\"temperature_degc\":%s", temperature->is_known && state->failure == NULL ? value : "null");
}

static void add_level(char *text, const state_t *state)
{
    const fathom_level_t *const level = &state->result->level;
    if (state->failure == NULL && state->result->has_level)
        ADD(text, ",\"level_mm\":%" PRId32 ",\"level_per_mille\":%u,\"volume\":%" PRIu32, level->level_mm,
            level->per_mille, level->volume);
    else
        ADD(text, ",\"level_mm\":null,\"level_per_mille\":null,\"volume\":null");
}

uint32_t state_begin(const state_t *state, topic_t topic, char text[QUEUE_TEXT])
{
    char utc[UTC_TEXT];
    text[0] = '\0';
    ADD(text, "{\"time\":\"%s\"", utc_text(state->utc_us, utc));
    if (topic == TOPIC_ALARM)
        ADD(text, ",\"alarm\":\"%s\",\"is_on\":%s", alarm_word(state->result->alarm),
            state->result->is_on ? "true" : "false");
    else
        ADD(text, ",\"status\":\"%s\"", status_of(state));
    if (topic == TOPIC_LEVEL) add_level(text, state);
    if (topic != TOPIC_LEVEL) add_distance(text, state);
    if (topic == TOPIC_STATE) add_temperature(text, state);
    ADD(text, ",\"boot\":\"%s\",\"seq\":%" PRIu64, state->boot, state->seq);
    return (uint32_t)strlen(text);
}

/* ---- the second part ---- */

void state_finish(char text[STATE_TEXT], uint64_t age_us, uint64_t dropped)
{
    const size_t length = strlen(text);
    (void)snprintf(text + length, STATE_TEXT - length, ",\"age_ms\":%" PRIu64 ",\"dropped\":%" PRIu64 "}",
                   age_us / 1000, dropped);
}

void state_of_publisher(const publisher_state_t *state, char text[STATE_TEXT])
{
    char utc[UTC_TEXT];
    (void)snprintf(text, STATE_TEXT,
                   "{\"time\":\"%s\",\"version\":\"" FATHOM_VERSION_STRING
                   "\",\"boot\":\"%s\",\"uptime_s\":%" PRIu64 ",\"sensors\":%zu,\"queued\":%" PRIu32
                   ",\"dropped\":%" PRIu64 "}",
                   utc_text(state->utc_us, utc), state->boot, state->uptime_us / 1000000, state->sensors,
                   state->queued, state->dropped);
}
