/* SPDX-License-Identifier: MIT */
#include "device/backup.h"

#include <string.h>

#include "device/setting_text.h"

size_t backup_count(const model_t *model)
{
    size_t count = 0;
    while (count != BACKUP_ROWS && model->settings[count].name != NULL) count++;
    return count;
}

bool backup_has(const setting_t *setting)
{
    return setting->kind != SETTING_PRESENT && setting->mode == NULL;
}

const char *backup_word(held_t held)
{
    static const char *const words[] = {[HELD_NOTHING] = NULL,
                                        [HELD_VALUE] = NULL,
                                        [HELD_NOT_READABLE] = "not readable",
                                        [HELD_NOT_THERE] = "not there",
                                        [HELD_NOT_SETTABLE] = "not settable"};
    return words[held];
}

bool backup_value(const setting_t *setting, const char *text, int32_t *value)
{
    const bool is_zero = setting->has_zero && strcmp(text, "0") == 0;
    if (!is_zero) return setting_value(setting, text, value);
    *value = 0;
    return true;
}

bool backup_is_same(const setting_t *setting, const backup_row_t *one, const backup_row_t *other)
{
    if (one->held != HELD_VALUE || other->held != HELD_VALUE) return false;
    return setting->set != NULL ? one->value == other->value : strcmp(one->text, other->text) == 0;
}

/* One response may be lost, and a backup without this value, or with "not there", would be wrong. */
static fathom_status_t read_repeatedly(session_t *session, const setting_t *setting, char text[SETTING_TEXT])
{
    enum { TIMES = 3 };
    fathom_status_t status = FATHOM_ERR_NO_RESPONSE;
    for (unsigned times = 0; times != TIMES; times++) {
        status = session_get(session, setting, text);
        if (setting_reason(status) == NULL && status != FATHOM_ERR_CHECKSUM &&
            status != FATHOM_ERR_LINE_BUSY && status != FATHOM_ERR_OTHER_MASTER)
            break;
    }
    return status;
}

static fathom_status_t read_row(session_t *session, const setting_t *setting, backup_row_t *row)
{
    row->held = HELD_VALUE;
    if (setting->get == NULL && !setting->moves) {
        row->held = HELD_NOT_READABLE;
    } else if (setting->get == NULL) { /* the address at which the sensor responds */
        row->value = session->sensor->address;
        setting_print_value(setting, row->value, row->text);
    } else {
        row->status = read_repeatedly(session, setting, row->text);
        const bool may_be_missing = setting->is_of_variant || setting->set == NULL;
        if (row->status != FATHOM_OK && (!may_be_missing || setting_reason(row->status) == NULL))
            return row->status;
        if (row->status != FATHOM_OK)
            row->held = HELD_NOT_THERE;
        else if (setting->set != NULL && !backup_value(setting, row->text, &row->value))
            row->held = HELD_NOT_SETTABLE;
    }
    return FATHOM_OK;
}

static bool fail(session_t *session, const setting_t *setting, fathom_status_t status)
{
    session_end_task(session);
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom: %s: %s: ", session->sensor->name, setting->name);
    session_explain(session, status);
    (void)fputs("\n", stderr);
    return false;
}

static bool read_all(session_t *session, backup_t *unit)
{
    const setting_t *const settings = session_settings(session);
    const setting_t *known = NULL; /* the first setting that was read */
    const setting_t *missing = NULL;
    memset(unit, 0, sizeof *unit);
    unit->model = session->sensor->model;
    for (size_t i = 0; i != backup_count(unit->model); i++) {
        backup_row_t *const row = &unit->rows[i];
        if (!backup_has(&settings[i])) continue;
        const fathom_status_t status = read_row(session, &settings[i], row);
        if (status != FATHOM_OK) return fail(session, &settings[i], status);
        if (row->held == HELD_NOT_THERE) missing = &settings[i];
        if (known == NULL && settings[i].get != NULL && row->held != HELD_NOT_THERE) known = &settings[i];
    }
    if (missing == NULL) return true;
    if (known == NULL) return fail(session, missing, FATHOM_ERR_NO_RESPONSE);
    /* A setting is missing only if the sensor still responds. */
    char text[SETTING_TEXT];
    const fathom_status_t status = read_repeatedly(session, known, text);
    return status == FATHOM_OK || fail(session, known, status);
}

bool backup_read(session_t *session, backup_t *unit)
{
    session_begin_task(session, "reading the settings");
    const bool is_read = read_all(session, unit);
    session_end_task(session);
    return is_read;
}
