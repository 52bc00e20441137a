/* SPDX-License-Identifier: MIT */
#include "models/models.h"

#include <string.h>

#include "fathom/hps167s_registers.h"
#include "shared/channel.h"
#include "shared/command.h"

static const model_t models[] = {
    {
        "a16",
        "one ultrasonic probe",
        {9600, FATHOM_PARITY_NONE, 1},
        {{"auto", false, reader_a16_auto, device_a16_auto},
         {"modbus", true, reader_a16_modbus, device_a16_modbus},
         {"controlled", false, reader_a16_controlled, device_a16_controlled}},
        .settings = settings_a16,
        .max_address = 254,
        .probes = 1,
        .near_mm = 500,
        .far_mm = 5000,
    },
    {
        "a05",
        "four ultrasonic probes",
        {9600, FATHOM_PARITY_NONE, 1},
        {{"auto", false, reader_a05_auto, device_a05_auto},
         {"modbus", true, reader_a05_modbus, device_a05_modbus},
         {"dyp", true, reader_a05_dyp, device_a05_dyp}},
        .settings = settings_a05,
        .max_address = 254,
        .probes = 4,
        .near_mm = 250,
        .far_mm = 4500,
    },
    {
        "hps167s",
        "infrared time of flight",
        {FATHOM_HPS167S_FACTORY_BAUD, FATHOM_PARITY_EVEN, 1},
        {{"modbus", true, reader_hps167s, device_hps167s}},
        .settings = settings_hps167s,
        .other_settings = "--baud 57600, 115200 or 230400, to which it can be set",
        .max_address = FATHOM_HPS167S_MAX_ADDRESS,
        .probes = 1,
        .has_optics = true,
        .near_mm = 500,
        .far_mm = 12000,
    },
};
enum { MODELS = sizeof models / sizeof models[0] };

/* Adds ", NAME" to a list. */
static void add_name(char *list, size_t capacity, const char *name)
{
    const size_t length = strlen(list);
    (void)snprintf(list + length, capacity - length, "%s%s", length != 0 ? ", " : "", name);
}

const model_t *model_find(const char *command, const char *name)
{
    char known[80] = "";
    for (size_t i = 0; i != MODELS; i++) {
        if (strcmp(name, models[i].name) == 0) return &models[i];
        add_name(known, sizeof known, models[i].name);
    }
    (void)usage_error(command, "there is no sensor '%s', only %s", name, known);
    return NULL;
}

const model_mode_t *model_mode_find(const char *command, const model_t *model, const char *name)
{
    char known[80] = "";
    if (name == NULL) return &model->modes[0];
    for (size_t i = 0; i != MODEL_MODES && model->modes[i].name != NULL; i++) {
        if (strcmp(name, model->modes[i].name) == 0) return &model->modes[i];
        add_name(known, sizeof known, model->modes[i].name);
    }
    (void)usage_error(command, "there is no mode '%s' for %s, only %s", name, model->name, known);
    return NULL;
}

uint8_t model_least_address(const model_t *model, const model_mode_t *mode)
{
    return model->max_address > FATHOM_HPS167S_MAX_ADDRESS && strcmp(mode->name, "modbus") == 0 ? 0 : 1;
}

void models_print(FILE *to)
{
    for (size_t i = 0; i != MODELS; i++) {
        const model_t *const model = &models[i];
        char modes[80] = "";
        char line[SETTINGS_TEXT];
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            add_name(modes, sizeof modes, model->modes[m].name);
        (void)fprintf(to, "  %-8s %-24s %-10s address 1..%-4u modes: %s\n", model->name, model->what,
                      settings_text(&model->line, line), model->max_address, modes);
    }
}
