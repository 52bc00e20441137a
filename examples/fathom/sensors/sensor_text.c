/* SPDX-License-Identifier: MIT */
#include "sensors/sensor_text.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

static bool is_letter(char character)
{
    return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
}

bool sensor_text_parse(sensor_text_t *sensor, const char *command, const char *text, size_t length)
{
    const bool fits = length < sizeof sensor->parts; /* no sensor has so long a name */
    memset(sensor, 0, sizeof *sensor);
    memcpy(sensor->parts, text, fits ? length : sizeof sensor->parts - 1);
    char *const first = fits ? strchr(sensor->parts, ':') : NULL;
    if (first != NULL) {
        char *const second = is_letter(first[1]) ? first : strchr(first + 1, ':');
        if (second != first) sensor->address = first + 1;
        if (second != NULL) {
            sensor->mode = second + 1;
            *second = '\0';
        }
        *first = '\0';
    }
    sensor->model = model_find(command, sensor->parts);
    return sensor->model != NULL;
}

bool sensor_text_address(const sensor_text_t *sensor, const char *command, const model_mode_t *mode,
                         uint8_t *address)
{
    const model_t *const model = sensor->model;
    const uint8_t least = model_least_address(model, mode);
    uint32_t number = *address;
    if (sensor->address == NULL || sensor->address[0] == '\0') return true;
    if (number_parse(sensor->address, least, model->max_address, &number)) {
        *address = (uint8_t)number;
        return true;
    }
    (void)usage_error(command, "the address of %s is a number from %u to %u, not '%s'", model->name, least,
                      model->max_address, sensor->address);
    return false;
}
