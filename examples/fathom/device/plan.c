/* SPDX-License-Identifier: MIT */
#include "device/plan.h"

#include <string.h>

/* A setting that moves the sensor is written after the others, and the baud rate last. A write-only setting is written
 * after those that can be read, so that it is not written if one of them fails. */
static unsigned rank(const setting_t *setting, plan_step_t step)
{
    if (setting->is_baud) return 3;
    if (setting->moves) return 2;
    return step == PLAN_WRITE_UNSEEN ? 1 : 0;
}

static plan_step_t step_of(const setting_t *setting, const backup_row_t *file, const backup_row_t *unit,
                           bool may_move)
{
    if (setting->set == NULL || file->held != HELD_VALUE || backup_is_same(setting, file, unit))
        return PLAN_NOTHING;
    if (setting->moves && !may_move) return PLAN_STAYS;
    if (unit->held == HELD_NOT_THERE) return PLAN_IMPOSSIBLE;
    return unit->held == HELD_NOT_READABLE ? PLAN_WRITE_UNSEEN : PLAN_WRITE;
}

void plan_init(plan_t *plan, const backup_t *file, const backup_t *unit, bool moves, bool changes_rate)
{
    enum { RANKS = 4 };
    const setting_t *const settings = unit->model->settings;
    const size_t rows = backup_count(unit->model);
    memset(plan, 0, sizeof *plan);
    plan->file = file;
    plan->unit = unit;
    plan->moves = moves;
    for (size_t i = 0; i != rows; i++) {
        plan->steps[i] =
            step_of(&settings[i], &file->rows[i], &unit->rows[i], settings[i].is_baud ? changes_rate : moves);
        if (plan->steps[i] == PLAN_IMPOSSIBLE) plan->is_impossible = true;
    }
    for (unsigned r = 0; r != RANKS; r++) {
        for (size_t i = 0; i != rows; i++) {
            const plan_step_t step = plan->steps[i];
            const bool is_written = step == PLAN_WRITE || step == PLAN_WRITE_UNSEEN;
            if (is_written && rank(&settings[i], step) == r) plan->order[plan->count++] = i;
        }
    }
}

/* ---- printing ---- */

static const char *text_of(const backup_row_t *row)
{
    const char *const word = backup_word(row->held);
    return word != NULL ? word : row->text;
}

bool plan_print_identity(const backup_t *one, const char *one_is, const backup_t *other, const char *other_is)
{
    bool is_same = true;
    bool is_known = false;
    for (size_t i = 0; i != backup_count(one->model); i++) {
        const setting_t *const setting = &one->model->settings[i];
        const backup_row_t *const a = &one->rows[i];
        const backup_row_t *const b = &other->rows[i];
        const bool is_unit = setting->kind == SETTING_IDENTITY;
        if (setting->set != NULL || a->held == HELD_NOTHING || b->held == HELD_NOTHING) continue;
        (void)printf("%s: %s %s, %s %s: ", setting->name, text_of(a), one_is, text_of(b), other_is);
        if (a->held != HELD_VALUE || b->held != HELD_VALUE) {
            (void)puts("unknown");
            continue;
        }
        const bool same = backup_is_same(setting, a, b);
        if (is_unit) {
            is_known = true;
            is_same = same;
        }
        (void)printf("%s %s\n", same ? "the same" : "another", is_unit ? "sensor" : "version");
    }
    if (!is_known) (void)puts("unknown whether it is the same sensor: it has no number to compare");
    return is_same;
}

enum { CELL = SETTING_TEXT + 16 };

static const char *cell(const setting_t *setting, const backup_row_t *row, char text[CELL])
{
    const char *const word = backup_word(row->held);
    const bool has_unit = word == NULL && setting->unit != NULL && setting->words == NULL;
    (void)snprintf(text, CELL, "%s%s%s", word != NULL && row->held != HELD_NOT_SETTABLE ? word : row->text,
                   has_unit ? " " : "", has_unit ? setting->unit : "");
    return text;
}

static const char *note(const plan_t *plan, plan_step_t step)
{
    switch (step) {
    case PLAN_WRITE_UNSEEN:
        return "  is written without comparison";
    case PLAN_STAYS:
        return plan->moves ? "  stays: the baud rate is the gateway's" : "  stays, without --as-new";
    case PLAN_IMPOSSIBLE:
        return "  this sensor does not have it";
    default:
        return "";
    }
}

void plan_print(const plan_t *plan)
{
    const model_t *const model = plan->unit->model;
    bool has_header = false;
    (void)plan_print_identity(plan->file, "in the file", plan->unit, "in the sensor");
    for (size_t i = 0; i != backup_count(model); i++) {
        const setting_t *const setting = &model->settings[i];
        char is[CELL];
        char to[CELL];
        if (plan->steps[i] == PLAN_NOTHING) continue;
        if (!has_header) (void)printf("%-24s %-14s    %s\n", "setting", "in the sensor", "in the file");
        has_header = true;
        (void)printf("%-24s %-14s -> %s%s\n", setting->name, cell(setting, &plan->unit->rows[i], is),
                     cell(setting, &plan->file->rows[i], to), note(plan, plan->steps[i]));
    }
    if (!has_header) (void)puts("no differences");
    for (size_t i = 0; i != backup_count(model); i++) {
        const char *const risk = model->settings[i].risk;
        if (plan->steps[i] != PLAN_WRITE_UNSEEN || risk == NULL) continue;
        (void)fflush(stdout);
        (void)fprintf(stderr, "fathom: %s: %s\n", model->settings[i].name, risk);
    }
}
