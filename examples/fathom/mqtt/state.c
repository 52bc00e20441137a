/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getentropy, open_memstream */
#include "mqtt/state.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "fathom/version.h"
#include "output/words.h"
#include "reading/fields.h"

void state_boot(char boot[BOOT])
{
    uint64_t number = 0;
    if (getentropy(&number, sizeof number) != 0) number = (uint64_t)time(NULL) << 32 ^ (uint64_t)getpid();
    (void)snprintf(boot, BOOT, "%016" PRIx64, number);
}

/* A stream in memory that is kept, since to open one for each message takes longer than to write the message. */
static struct {
    FILE *to;
    char *text;
    size_t length;
} memory;

static FILE *begin_text(void)
{
    if (memory.to == NULL)
        memory.to = open_memstream(&memory.text, &memory.length);
    else
        rewind(memory.to);
    return memory.to;
}

static void end_text(char *text, size_t capacity)
{
    const size_t length = fflush(memory.to) == 0 && memory.length < capacity ? memory.length : 0;
    memcpy(text, memory.text, length);
    text[length] = '\0';
}

static unsigned columns_of(const sensor_t *sensor, topic_t topic)
{
    if (topic == TOPIC_ALARM) return COLUMNS_ALARM | COLUMNS_DISTANCE;
    if (topic == TOPIC_LEVEL) return COLUMNS_READING | COLUMNS_LEVEL;
    return COLUMNS_READING | COLUMNS_DISTANCE |
           (sensor->settings.temperature_us != 0 ? COLUMNS_TEMPERATURE : 0);
}

void state_begin(const reading_t *reading, topic_t topic, const char *boot, uint64_t seq,
                 char text[QUEUE_TEXT])
{
    json_t json = {.to = begin_text()};
    text[0] = '\0';
    if (json.to == NULL) return;
    json_begin(&json, NULL, '{');
    reading_json(&json, reading, columns_of(reading->sensor, topic));
    json_string(&json, "boot", boot);
    json_value(&json, "seq", "%" PRIu64, seq);
    end_text(text, QUEUE_TEXT);
}

void state_finish(char text[STATE_TEXT], uint64_t age_us, uint64_t dropped)
{
    const size_t length = strlen(text);
    (void)snprintf(text + length, STATE_TEXT - length, ",\"age_ms\":%" PRIu64 ",\"dropped\":%" PRIu64 "}",
                   age_us / 1000, dropped);
}

void state_of_counters(sensor_t *sensor, uint64_t utc_us, const char *boot, char text[COUNTERS_TEXT])
{
    char utc[UTC_TEXT];
    json_t json = {.to = begin_text()};
    text[0] = '\0';
    if (json.to == NULL) return;
    json_begin(&json, NULL, '{');
    json_string(&json, "utc", utc_text(utc_us, utc));
    json_string(&json, "boot", boot);
    stats_json_of_sensor(&json, sensor);
    json_end(&json, '}');
    end_text(text, COUNTERS_TEXT);
}

void state_of_publisher(const publisher_state_t *state, char text[STATE_TEXT])
{
    char utc[UTC_TEXT];
    json_t json = {.to = begin_text()};
    text[0] = '\0';
    if (json.to == NULL) return;
    json_begin(&json, NULL, '{');
    json_string(&json, "utc", utc_text(state->utc_us, utc));
    json_string(&json, "version", FATHOM_VERSION_STRING);
    json_string(&json, "boot", state->boot);
    json_value(&json, "uptime_s", "%" PRIu64, state->uptime_us / 1000000);
    json_value(&json, "sensors", "%zu", state->sensors);
    json_value(&json, "queued", "%" PRIu32, state->queued);
    json_value(&json, "dropped", "%" PRIu64, state->dropped);
    json_end(&json, '}');
    end_text(text, STATE_TEXT);
}
