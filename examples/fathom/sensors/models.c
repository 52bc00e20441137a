/* SPDX-License-Identifier: MIT */
#include "sensors/models.h"

#include <string.h>

#include "output/words.h"
#include "ports/line_text.h"
#include "sensors/a05/a05.h"
#include "sensors/a16/a16.h"
#include "sensors/hps167s/hps167s.h"

const model_t *const models[MODELS] = {&model_a16, &model_a05, &model_hps167s};

const model_t *model_of(uint8_t id)
{
    size_t i = MODELS - 1;
    while (i != 0 && models[i]->id != id) i--;
    return models[i];
}

bool model_has_address(const model_t *model, uint8_t address)
{
    return model->is_dyp || (address != 0 && address <= model->max_address);
}

bool model_has_rate(const model_t *model, uint32_t baud)
{
    if (baud == model->line.baud) return true;
    for (const uint32_t *rate = model->rates; rate != NULL && *rate != 0; rate++)
        if (*rate == baud) return true;
    return false;
}

uint8_t model_least_address(const model_t *model, const model_mode_t *mode)
{
    return model->is_dyp && strcmp(mode->name, "modbus") == 0 ? 0 : 1;
}

void models_print(FILE *to)
{
    for (size_t i = 0; i != MODELS; i++) {
        const model_t *const model = models[i];
        char modes[80] = "";
        char line[LINE_TEXT];
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            list_add(modes, sizeof modes, model->modes[m].name);
        (void)fprintf(to, "  %-8s %-24s %-10s address 1..%-4u modes: %s\n", model->name, model->what,
                      line_text(&model->line, line), model->max_address, modes);
    }
}
