/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include "tool.h"

#include "commands/commission/record.h"
#include "device/session.h"

/*
 * The files that the tool reads again: the settings of a unit (device/session.h) and the record of a commissioning
 * (record.h), with anything in them. What is taken is written as the same, and what is refused is said.
 */
static void check_refusal(bool is_refused)
{
    PROMISE(is_refused == (tool.err_size != 0), "what is wrong is said, and nothing else");
    if (!is_refused) return;
    PROMISE(tool.err[tool.err_size - 1] == '\n' && strncmp(tool.err, "fathom: ", 8) == 0,
            "in a line of the tool's");
}

static int parse_backup(const model_t *model, values_t *backup)
{
    tool_capture();
    const int status = backup_parse("unit", model, false, backup);
    tool_release();
    return status;
}

static void backup(uint8_t how, const uint8_t *bytes, size_t size)
{
    static values_t first;
    static values_t again;
    const model_t *const model = &models[how % model_count];
    tool_file(bytes, size);
    const int status = parse_backup(model, &first);
    PROMISE(status == 0 || status == 1 || status == 2, "session.h: what parse returns");
    PROMISE((status == 1) == (size == 0), "session.h: 1: it cannot be read");
    check_refusal(status != 0);
    if (status != 0) return;
    char *text = NULL;
    size_t length = 0;
    FILE *const to = open_memstream(&text, &length);
    if (to == NULL) abort();
    backup_print(to, &first, "address 1, 9600 8N1", "2026-01-01");
    (void)fclose(to);
    tool_file((const uint8_t *)text, length);
    PROMISE(parse_backup(model, &again) == 0, "session.h: what is printed is read");
    for (size_t i = 0; first.rows[i].setting != NULL; i++) {
        const value_t *const row = &first.rows[i];
        int32_t value = 0;
        PROMISE(row->held == again.rows[i].held && strcmp(row->text, again.rows[i].text) == 0,
                "session.h: what is printed is read as the same");
        if (row->held == HELD_VALUE && row->setting->effect != NULL)
            PROMISE(setting_value(row->setting, row->text, &value), "session.h: a value that can be set");
    }
    free(text);
}

static bool read_record(record_t *record)
{
    tool_capture();
    const bool is_good = record_read(record, "record");
    tool_release();
    return is_good;
}

static bool is_same(const record_unit_t *one, const record_unit_t *other)
{
    return one->model == other->model && strcmp(one->number, other->number) == 0 &&
           strcmp(one->when, other->when) == 0 && one->address == other->address &&
           one->is_done == other->is_done;
}

static void record(const uint8_t *bytes, size_t size)
{
    static record_t first;
    static record_t again;
    tool_file(bytes, size);
    const bool is_good = read_record(&first);
    check_refusal(!is_good);
    if (!is_good) return;
    for (size_t i = 0; i != RECORD_UNITS; i++) {
        const record_unit_t *const unit = &first.units[i];
        if (unit->model == NULL) continue;
        PROMISE(unit->address == i, "record.h: the units stand by address");
        PROMISE(i >= 1 && i <= unit->model->max_address, "record.h: an address that it can have");
    }
    tool_capture();
    const bool is_written = record_write(&first);
    tool_release();
    PROMISE(is_written, "record.h: it is written");
    size_t length;
    const char *const text = tool_written(&length);
    char *const copy = fuzz_copy(text, length);
    tool_file((const uint8_t *)copy, length);
    PROMISE(read_record(&again), "record.h: what is written is read");
    for (size_t i = 0; i != RECORD_UNITS; i++)
        PROMISE(is_same(&first.units[i], &again.units[i]), "record.h: what is written is read as the same");
    free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    const uint8_t how = fuzz_byte();
    size_t length;
    uint8_t *const bytes = fuzz_rest(4000, &length);
    if ((how & 4) == 0)
        backup(how, bytes, length);
    else
        record(bytes, length);
    free(bytes);
    return 0;
}
