/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fsync, lstat */
#include "device/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ALL_READ_WRITE = 0666 }; /* without the bits of the umask */

static bool fail(const char *path, int error)
{
    if (error == EEXIST)
        (void)fprintf(
            stderr, "fathom: %s exists and is not overwritten. Use another name, or move the file.\n", path);
    else
        (void)fprintf(stderr, "fathom: cannot write %s: %s\n", path, strerror(error));
    return false;
}

bool new_file_is_free(const char *path)
{
    struct stat is;
    return lstat(path, &is) != 0 || fail(path, EEXIST);
}

bool new_file_open(new_file_t *file, const char *path)
{
    const int length = snprintf(file->temporary, sizeof file->temporary, "%s.%ld.part", path, (long)getpid());
    file->path = path;
    file->file = NULL;
    if (length < 0 || (size_t)length >= sizeof file->temporary) return fail(path, ENAMETOOLONG);
    const int fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL, ALL_READ_WRITE);
    if (fd < 0) return fail(file->temporary, errno);
    file->file = fdopen(fd, "w");
    if (file->file != NULL) return true;
    (void)close(fd);
    (void)unlink(file->temporary);
    return fail(path, ENOMEM);
}

/* Writes the file to the disk. Returns 0, or errno. */
static int finish(FILE *file)
{
    errno = 0;
    const bool is_good = ferror(file) == 0 && fflush(file) == 0 && fsync(fileno(file)) == 0;
    const int error = is_good ? 0 : errno != 0 ? errno : EIO;
    return fclose(file) == 0 || error != 0 ? error : errno;
}

/* Creates the name, which only one program can, and renames the file to it. Needs no hard links, which a USB stick does
 * not have. */
static int set_name(const new_file_t *file)
{
    const int fd = open(file->path, O_WRONLY | O_CREAT | O_EXCL, ALL_READ_WRITE);
    if (fd < 0) return errno;
    (void)close(fd);
    if (rename(file->temporary, file->path) == 0) return 0;
    const int error = errno;
    (void)unlink(file->path);
    return error;
}

bool new_file_close(new_file_t *file)
{
    int error = finish(file->file);
    if (error == 0) error = set_name(file);
    if (error == 0) return true;
    (void)unlink(file->temporary);
    return fail(file->path, error);
}
