/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): mkdtemp */
#include "backup_desk.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char folder[64];

void desk_begin(void)
{
    (void)snprintf(folder, sizeof folder, "/tmp/fathom-backup-XXXXXX");
    assert_non_null(mkdtemp(folder));
}

static unsigned each(void (*visit)(const char *name))
{
    unsigned count = 0;
    DIR *const all = opendir(folder);
    assert_non_null(all);
    for (const struct dirent *entry; (entry = readdir(all)) != NULL;) {
        if (entry->d_name[0] == '.') continue;
        if (visit != NULL) visit(entry->d_name);
        count++;
    }
    (void)closedir(all);
    return count;
}

int desk_end(void **state)
{
    (void)each(desk_remove);
    assert_int_equal(rmdir(folder), 0);
    return 0;
}

const char *desk_path(const char *name)
{
    static char paths[2][128];
    static unsigned turn;
    char *const path = paths[turn++ % 2];
    assert_in_range(snprintf(path, sizeof paths[0], "%s/%s", folder, name), 1, sizeof paths[0] - 1);
    return path;
}

void desk_write(const char *name, const char *text)
{
    FILE *const file = fopen(desk_path(name), "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

const char *desk_read(const char *name, char text[DESK_TEXT])
{
    FILE *const file = fopen(desk_path(name), "r");
    assert_non_null(file);
    const size_t length = fread(text, 1, DESK_TEXT - 1, file);
    assert_true(length < DESK_TEXT - 1);
    text[length] = '\0';
    (void)fclose(file);
    return text;
}

void desk_remove(const char *name) { assert_int_equal(remove(desk_path(name)), 0); }

unsigned desk_count(void) { return each(NULL); }
