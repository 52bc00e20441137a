/* SPDX-License-Identifier: MIT */
#include "reading/site.h"

#include <stdlib.h>
#include <string.h>

#include "output/words.h"

sensor_t *site_add_sensor(site_t *site)
{
    sensor_t *const sensor = allocate(sizeof *sensor);
    site->sensors = reallocate(site->sensors, (site->sensor_count + 1) * sizeof(sensor_t *));
    sensor->number = site->sensor_count++;
    site->sensors[sensor->number] = sensor;
    return sensor;
}

line_t *site_add_line(site_t *site, const char *path)
{
    line_t **end = &site->lines;
    while (*end != NULL) end = &(*end)->next;
    line_t *const line = allocate(sizeof *line + strlen(path) + 1);
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

void line_add_text(line_t *line, const char *text)
{
    const size_t length = line->text != NULL ? strlen(line->text) : 0;
    line->text = reallocate(line->text, length + strlen(text) + 1);
    (void)strcpy(line->text + length, text);
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

/* Returns the place of the line of `site` that has this text, or NULL. */
static line_t **find_line(site_t *site, const char *text)
{
    for (line_t **at = &site->lines; *at != NULL && text != NULL; at = &(*at)->next)
        if ((*at)->state != LINE_LEFT && (*at)->text != NULL && strcmp((*at)->text, text) == 0) return at;
    return NULL;
}

/* Both lines have the same text, so their sensors are the same in number and order. */
static void swap_sensors(site_t *site, sensor_t *sensor, site_t *old, sensor_t *other)
{
    for (; sensor != NULL; sensor = sensor->next, other = other->next) {
        const size_t number = sensor->number;
        site->sensors[number] = other;
        old->sensors[other->number] = sensor;
        sensor->number = other->number;
        other->number = number;
    }
}

void site_keep(site_t *site, site_t *old)
{
    for (line_t **at = &site->lines; *at != NULL; at = &(*at)->next) {
        line_t *const line = *at;
        line_t *const behind = line->next;
        line_t **const same = line->state != LINE_LEFT ? find_line(old, line->text) : NULL;
        if (same == NULL) continue;
        swap_sensors(site, line->sensors, old, (*same)->sensors);
        *at = *same;
        *same = line;
        line->next = (*at)->next;
        (*at)->next = behind;
    }
}

/* ---- one sensor ---- */

void sensor_set_name(sensor_t *sensor)
{
    if (sensor->has_own_name) return;
    (void)snprintf(sensor->name, sizeof sensor->name, sensor->mode->has_address ? "%s:%u" : "%s",
                   sensor->model->name, sensor->address);
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

void results_config_copy(results_config_t *to, const results_config_t *from)
{
    *to = *from;
    if (from->tank.points != NULL) to->tank.points = to->points;
}
