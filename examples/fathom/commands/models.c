/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <string.h>

#include "cli/rows.h"
#include "commands/commands.h"
#include "ports/port.h"
#include "sensors/models.h"

/* fathom models: the rows of src/models, and how to read each. */

/* Is this row one of `wanted`: of this model, or of this family? NULL: every row is. */
static bool is_wanted(const fathom_model_description_t *row, const model_t *wanted)
{
    const bool is_family = wanted >= models && wanted < models + model_count;
    return wanted == NULL || model_find(row->name) == wanted || (is_family && row->family == wanted->id);
}

static void print_row(const fathom_model_description_t *row, const model_t *model, const model_mode_t *mode)
{
    const fathom_line_settings_t *const line = row->facts->line_settings;
    char range[LINE_TEXT];
    char settings[LINE_TEXT] = "GPIO lines";
    if (line != NULL) (void)line_text(line, settings);
    (void)snprintf(range, sizeof range, "%u-%u", row->facts->min_mm, row->facts->max_mm);
    (void)printf("%-15s  %-10s  %-11s  %-11s  %s%s%s\n", model->name, mode->name, range, settings,
                 row->is_certain ? "certain" : "one source",
                 row->aliases[0] == '\0' ? ""
                 : row->is_certain       ? "     "
                                         : "  ",
                 row->aliases);
}

static void print_more(const fathom_model_description_t *row, const model_t *model, const model_mode_t *mode)
{
    char example[PORT_EXAMPLE];
    if (row->maker[0] != '\0') (void)printf("  maker: %s\n", row->maker);
    if (row->note[0] != '\0') (void)printf("  note: %s\n", row->note);
    if (row->facts->start == FATHOM_STARTS_BYTE)
        (void)printf("  trigger: the byte %02X to its RX\n", row->facts->trigger_byte);
    if (row->facts->start == FATHOM_STARTS_FALLING) (void)printf("  trigger: a falling edge at its RX\n");
    if (row->facts->start == FATHOM_STARTS_HIGH_PULSE)
        (void)printf("  trigger: a high pulse at its trigger pin\n");
    (void)printf("  to read it: ");
    if (pins_example(mode, "gpiochip0", example))
        (void)printf("fathom read %s:%s@%s", model->name, mode->name, example);
    else
        read_command_print(stdout, model, mode->name, mode->has_address ? FACTORY_ADDRESS : -1, &model->line,
                           "/dev/ttyUSB0");
    (void)printf("\n");
}

static int start(const host_t *host, const arguments_t *arguments)
{
    const fathom_model_description_t *row = NULL;
    const model_t *wanted = NULL;
    (void)host;
    if (arguments->count > 1) {
        (void)reject(&arguments->origin, "models takes one name.");
        return STATUS_USAGE;
    }
    if (arguments->count == 1) wanted = model_word(arguments->words[0], &arguments->origin);
    if (arguments->count == 1 && wanted == NULL) return STATUS_USAGE;
    (void)printf("%-15s  %-10s  %-11s  %-11s  %-10s  %s\n", "name", "mode", "range in mm", "line", "sources",
                 "also called");
    for (uint16_t i = 0; (row = fathom_model_at(i)) != NULL; i++) {
        const model_t *const model = is_wanted(row, wanted) ? model_find(row->name) : NULL;
        const model_mode_t *const mode = model != NULL ? model_mode_of_row(model, row) : NULL;
        if (mode == NULL) continue;
        print_row(row, model, mode);
        if (wanted != NULL) print_more(row, model, mode);
    }
    (void)printf("\nThe facts are from public sources, and none was tried with a real module.\n");
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static const option_table_t tables[] = {{NULL, 0}};

const command_t models_command = {
    .name = "models",
    .summary = "List the modules that speak as an A16, A05 or HPS-167S does",
    .usage = "[NAME]",
    .about =
        "Each NAME, and each name under which it is also called, is a SENSOR: fathom read a02yyuw. With a "
        "NAME, the trigger, the wiring and the command to read it are printed as well. \"certain\" is a "
        "manual or two sources that agree; one source may be wrong.\n",
    .tables = tables,
    .examples = "  fathom models\n"
                "  fathom models sen0311\n"
                "  fathom models aj-sr04m\n",
    .status = "Exit status: 0 printed, 2 wrong usage.\n",
    .topics = "sensors",
    .operands = OPERANDS_MODELS,
    .settings_size = 1,
    .start = start,
};
