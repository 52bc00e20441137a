/* SPDX-License-Identifier: MIT */
#include "models/sensor_text.h"

#include <string.h>

#include "shared/command.h"
#include "shared/options.h"

bool sensor_text_parse(sensor_text_t *sensor, const char *command, const char *text)
{
    if (strlen(text) >= sizeof sensor->parts) return model_find(command, text) != NULL;
    memcpy(sensor->parts, text, strlen(text) + 1);
    char *const address = strchr(sensor->parts, ':');
    char *const mode = address != NULL ? strchr(address + 1, ':') : NULL;
    if (address != NULL) *address = '\0';
    if (mode != NULL) *mode = '\0';
    sensor->address = address != NULL ? address + 1 : NULL;
    sensor->mode = mode != NULL ? mode + 1 : NULL;
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
