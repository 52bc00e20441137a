/* SPDX-License-Identifier: MIT */
#include "reading/site.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

sensor_t *site_add_sensor(site_t *site)
{
    sensor_t **const sensors = realloc(site->sensors, (site->sensor_count + 1) * sizeof(sensor_t *));
    if (sensors == NULL) return NULL;
    site->sensors = sensors;
    sensor_t *const sensor = calloc(1, sizeof *sensor);
    if (sensor != NULL) sensors[site->sensor_count++] = sensor;
    return sensor;
}

line_t *site_add_line(site_t *site, const char *path)
{
    line_t **end = &site->lines;
    while (*end != NULL) end = &(*end)->next;
    line_t *const line = calloc(1, sizeof *line + strlen(path) + 1);
    if (line == NULL) return NULL;
    line->settings.path = strcpy(line->path, path);
    *end = line;
    site->line_count++;
    return line;
}

void line_add(line_t *line, sensor_t *sensor)
{
    sensor_t **end = &line->sensors;
    while (*end != NULL) end = &(*end)->next;
    *end = sensor;
    sensor->next = NULL;
    sensor->port = &line->settings;
    line->settings.station_count++;
}

bool line_add_text(line_t *line, const char *text)
{
    const size_t length = line->text != NULL ? strlen(line->text) : 0;
    char *const longer = realloc(line->text, length + strlen(text) + 1);
    if (longer == NULL) return false;
    memcpy(longer + length, text, strlen(text) + 1);
    line->text = longer;
    return true;
}

void site_free(site_t *site)
{
    for (line_t *line = site->lines, *next; line != NULL; line = next) {
        next = line->next;
        free(line->text);
        free(line);
    }
    for (size_t i = 0; i != site->sensor_count; i++) {
        reader_free(&site->sensors[i]->reader);
        free(site->sensors[i]->own_listener);
        free(site->sensors[i]);
    }
    free(site->sensors);
    *site = (site_t){.lines = NULL};
}

/* ---- a reload ---- */

/* The place of the line of `old` that can go on as `line`; NULL: there is none. */
static line_t **find_same(site_t *old, const line_t *line)
{
    for (line_t **at = &old->lines; *at != NULL; at = &(*at)->next)
        if (!(*at)->is_left && (*at)->text != NULL && line->text != NULL &&
            strcmp((*at)->text, line->text) == 0)
            return at;
    return NULL;
}

static void replace_sensor(site_t *site, const sensor_t *sensor, sensor_t *by)
{
    for (size_t i = 0; i != site->sensor_count; i++)
        if (site->sensors[i] == sensor) site->sensors[i] = by;
}

/* Both have the same text, so their sensors are the same in number and order. */
static void swap_sensors(site_t *site, line_t *line, site_t *old, line_t *kept)
{
    sensor_t *there = kept->sensors;
    for (sensor_t *here = line->sensors; here != NULL && there != NULL; here = here->next) {
        replace_sensor(site, here, there);
        replace_sensor(old, there, here);
        there = there->next;
    }
}

void site_keep(site_t *site, site_t *old)
{
    for (line_t **at = &site->lines; *at != NULL; at = &(*at)->next) {
        line_t *const line = *at;
        line_t **const same = find_same(old, line);
        if (same == NULL) continue;
        line_t *const kept = *same;
        line_t *const behind = kept->next;
        swap_sensors(site, line, old, kept);
        kept->next = line->next;
        *at = kept;
        line->next = behind;
        *same = line;
    }
}

/* ---- one sensor ---- */

void sensor_set_name(sensor_t *sensor)
{
    if (sensor->has_own_name) return;
    (void)snprintf(sensor->name, sizeof sensor->name, sensor->mode->has_address ? "%s:%u" : "%s",
                   sensor->model->name, sensor->address);
}

const char *sensor_label(const sensor_t *sensor)
{
    return sensor->is_named ? sensor->name : sensor->model->name;
}

bool sensor_start(sensor_t *sensor, port_t *port, const reader_settings_t *settings)
{
    return reader_open(&sensor->reader, sensor->mode, port, settings);
}

void sensor_refusal(const sensor_t *sensor, char *text, size_t capacity)
{
    (void)snprintf(text, capacity, "%s: %s", sensor->name, reader_refusal(sensor->reader));
}

bool sensor_is_slower(sensor_t *sensor, char *text, size_t capacity)
{
    const uint32_t interval_us = sensor->settings.period_us;
    const uint32_t period_us = reader_facts(sensor->reader).least_period_us;
    if (interval_us == 0 || interval_us >= period_us || sensor->has_raise_notice) return false;
    sensor->has_raise_notice = true;
    (void)snprintf(text, capacity,
                   "read every %.4g ms, the shortest interval of this sensor (--interval %" PRIu32 ")",
                   period_us / 1000.0, interval_us / 1000);
    return true;
}

void sensor_json(json_t *json, const sensor_t *sensor)
{
    json_string(json, "name", sensor->name);
    json_string(json, "model", sensor->model->name);
    json_string(json, "mode", sensor->mode->name);
}

bool sensor_is_contact(const sensor_t *sensor) { return sensor->mode->is_contact; }

bool sensor_has_probe(const sensor_t *sensor, uint8_t probe)
{
    const uint8_t wanted = sensor->settings.probes;
    if (sensor->model->probes == 1 || sensor_is_contact(sensor)) return probe == 1;
    return probe <= sensor->model->probes && (wanted == 0 || (wanted >> (probe - 1) & 1) != 0);
}
