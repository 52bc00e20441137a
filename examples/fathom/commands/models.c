/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include <inttypes.h>
#include <stdlib.h>
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

static void print_command(FILE *to, const model_t *model, const model_mode_t *mode)
{
    char example[PORT_EXAMPLE];
    if (pins_example(mode, "gpiochip0", example))
        (void)fprintf(to, "fathom read %s:%s@%s", model->name, mode->name, example);
    else
        read_command_print(to, model, mode->name, mode->has_address ? FACTORY_ADDRESS : -1, &model->line,
                           "/dev/ttyUSB0");
}

static void print_more(const fathom_model_description_t *row, const model_t *model, const model_mode_t *mode)
{
    if (row->maker[0] != '\0') (void)printf("  maker: %s\n", row->maker);
    if (row->note[0] != '\0') (void)printf("  note: %s\n", row->note);
    if (row->facts->start == FATHOM_STARTS_BYTE)
        (void)printf("  trigger: the byte %02X to its RX\n", row->facts->trigger_byte);
    if (row->facts->start == FATHOM_STARTS_FALLING) (void)printf("  trigger: a falling edge at its RX\n");
    if (row->facts->start == FATHOM_STARTS_HIGH_PULSE)
        (void)printf("  trigger: a high pulse at its trigger pin\n");
    if ((mode->takes & READER_TAKES_TEMPERATURE) != 0)
        (void)printf("  temperature: read with --temperature\n");
    (void)printf("  to read it: ");
    print_command(stdout, model, mode);
    (void)printf("\n");
}

static void print_json(const fathom_model_description_t *row, const model_t *model, const model_mode_t *mode)
{
    static const char *const triggers[] = {[FATHOM_STARTS_FALLING] = "falling_edge",
                                           [FATHOM_STARTS_BYTE] = "byte",
                                           [FATHOM_STARTS_HIGH_PULSE] = "high_pulse"};
    const fathom_model_facts_t *const facts = row->facts;
    json_t json = {.to = stdout};
    char text[LINE_TEXT];
    char *next = NULL;
    size_t size = 0;
    FILE *const to = open_memstream(&next, &size);
    if (to == NULL) end_without_memory();
    print_command(to, model, mode);
    if (fclose(to) != 0) end_without_memory();
    json_begin(&json, NULL, '{');
    json_string(&json, "model", model->name);
    json_string(&json, "mode", mode->name);
    json_value(&json, "min_mm", "%u", facts->min_mm);
    json_value(&json, "max_mm", "%u", facts->max_mm);
    json_string(&json, "line", facts->line_settings != NULL ? line_text(facts->line_settings, text) : NULL);
    json_string(&json, "trigger", triggers[facts->start]);
    if (facts->start == FATHOM_STARTS_BYTE) json_value(&json, "trigger_byte", "%u", facts->trigger_byte);
    json_flag(&json, "has_temperature", (mode->takes & READER_TAKES_TEMPERATURE) != 0);
    json_flag(&json, "is_certain", row->is_certain);
    json_string(&json, "aliases", row->aliases);
    json_string(&json, "maker", row->maker);
    json_string(&json, "note", row->note);
    json_string(&json, "next", next);
    json_end(&json, '}');
    (void)fputc('\n', stdout);
    free(next);
}

static int start(const host_t *host, const arguments_t *arguments)
{
    const fathom_model_description_t *row = NULL;
    const model_t *wanted = NULL;
    const bool is_json = ((const session_settings_t *)arguments->settings)->is_json;
    (void)host;
    if (arguments->count > 1) {
        (void)reject(&arguments->origin, "models takes one name.");
        return STATUS_USAGE;
    }
    if (arguments->count == 1) wanted = model_word(arguments->words[0], &arguments->origin);
    if (arguments->count == 1 && wanted == NULL) return STATUS_USAGE;
    if (!is_json)
        (void)printf("%-15s  %-10s  %-11s  %-11s  %-10s  %s\n", "name", "mode", "range in mm", "line",
                     "sources", "also called");
    for (uint16_t i = 0; (row = fathom_model_at(i)) != NULL; i++) {
        const model_t *const model = is_wanted(row, wanted) ? model_find(row->name) : NULL;
        const model_mode_t *const mode = model != NULL ? model_mode_of_row(model, row) : NULL;
        if (mode == NULL) continue;
        if (is_json) print_json(row, model, mode);
        if (!is_json) print_row(row, model, mode);
        if (!is_json && wanted != NULL) print_more(row, model, mode);
    }
    if (!is_json)
        (void)printf("\nThe facts are from public sources, and none was tried with a real module.\n");
    return fflush(stdout) == 0 ? STATUS_OK : STATUS_FAILED;
}

static const option_table_t tables[] = {{session_format_rows, 0}, {NULL, 0}};

const command_t models_command = {
    .name = "models",
    .summary = "List the modules that speak as an A16, A05 or HPS-167S does",
    .usage = "[NAME] [OPTIONS]",
    .about =
        "Each NAME, and each name under which it is also called, is a SENSOR: fathom read a02yyuw. With a "
        "NAME, the trigger, the wiring and the command to read it are printed as well. \"certain\" is a "
        "manual or two sources that agree; one source may be wrong.\n",
    .tables = tables,
    .common = "format",
    .examples = "  fathom models\n"
                "  fathom models sen0311\n"
                "  fathom models aj-sr04m --format json\n",
    .status = "Exit status: 0 printed, 2 wrong usage.\n",
    .topics = "sensors",
    .operands = OPERANDS_MODELS,
    .settings_size = sizeof(session_settings_t),
    .start = start,
};
