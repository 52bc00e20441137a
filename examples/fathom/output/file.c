/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open, dup2 */
#include "output/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "output/words.h"

/* The day stands before the last dot of the name, or at its end. */
static void name_of(const output_file_t *file, uint64_t utc_us, char name[OUTPUT_FILE_NAME])
{
    enum { DAY = 10 }; /* "2026-11-23" of what utc_text makes */
    const char *const slash = strrchr(file->path, '/');
    const char *const base = slash != NULL ? slash + 1 : file->path;
    const char *const dot = strrchr(base, '.');
    const size_t stem = dot != NULL && dot != base ? (size_t)(dot - file->path) : strlen(file->path);
    char utc[UTC_TEXT] = "";
    if (file->is_by_day) (void)utc_text(utc_us, utc);
    (void)snprintf(name, OUTPUT_FILE_NAME, "%.*s%s%.*s%s", (int)stem, file->path, file->is_by_day ? "-" : "",
                   (int)DAY, utc, file->path + stem);
}

output_file_turn_t output_file_turn(output_file_t *file, uint64_t utc_us)
{
    char name[OUTPUT_FILE_NAME];
    if (file->path == NULL) return OUTPUT_FILE_SAME;
    name_of(file, utc_us, name);
    if (strcmp(name, file->name) == 0) return OUTPUT_FILE_SAME;
    const int fd = open(name, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) return OUTPUT_FILE_FAILED;
    const bool is_empty = lseek(fd, 0, SEEK_END) <= 0; /* -1: a pipe, which has nothing yet */
    const bool is_done = dup2(fd, STDOUT_FILENO) == STDOUT_FILENO;
    const int error = errno;
    (void)close(fd);
    errno = error;
    if (!is_done) return OUTPUT_FILE_FAILED;
    memcpy(file->name, name, sizeof name);
    return is_empty ? OUTPUT_FILE_EMPTY : OUTPUT_FILE_FILLED;
}

bool output_file_begins(const output_file_t *file, const char *text, size_t length)
{
    struct stat about;
    bool is_same = true;
    /* To open a pipe or a device would wait. */
    if (stat(file->name, &about) != 0 || !S_ISREG(about.st_mode)) return false;
    FILE *const from = fopen(file->name, "r");
    if (from == NULL) return false;
    for (size_t i = 0; i != length && is_same; i++) is_same = fgetc(from) == (unsigned char)text[i];
    (void)fclose(from);
    return is_same;
}
