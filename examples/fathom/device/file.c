/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): asprintf, fsync, lstat */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "device/session.h"

static bool fail(const char *path, int error)
{
    if (error == EEXIST)
        (void)fprintf(
            stderr, "fathom: %s exists and is not overwritten. Use another name, or move the file.\n", path);
    else
        (void)fprintf(stderr, "fathom: cannot write %s: %s\n", path, strerror(error));
    return false;
}

bool file_is_free(const char *path)
{
    struct stat is;
    return lstat(path, &is) != 0 || fail(path, EEXIST);
}

/* Writes a new file to the disk. Returns 0, or errno. */
static int write_new(const char *path, file_print_t print, const void *ctx)
{
    FILE *const file = fopen(path, "wx");
    if (file == NULL) return errno;
    errno = 0;
    print(file, ctx);
    const bool is_good = ferror(file) == 0 && fflush(file) == 0 && fsync(fileno(file)) == 0;
    const int error = is_good ? 0 : errno != 0 ? errno : EIO;
    return fclose(file) == 0 || error != 0 ? error : errno;
}

/* Creates the name, which only one program can, before the file is renamed to it. Needs no hard links, which a USB stick
 * does not have. Returns 0, or errno. */
static int set_name(const char *from, const char *to, bool replaces)
{
    FILE *const file = replaces ? NULL : fopen(to, "wx");
    if (file == NULL && !replaces) return errno;
    if (file != NULL) (void)fclose(file);
    if (rename(from, to) == 0) return 0;
    const int error = errno;
    if (!replaces) (void)unlink(to);
    return error;
}

/* The new name is on the disk only when its folder is. Not every file system supports this. */
static void sync_folder(const char *path)
{
    const char *const slash = strrchr(path, '/');
    char *const folder = slash != NULL ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    const int fd = folder != NULL ? open(folder, O_RDONLY) : -1;
    free(folder);
    if (fd < 0) return;
    (void)fsync(fd);
    (void)close(fd);
}

bool file_write(const char *path, bool replaces, file_print_t print, const void *ctx)
{
    char *fresh = NULL;
    if (asprintf(&fresh, "%s.%ld.part", path, (long)getpid()) < 0) return fail(path, ENOMEM);
    int error = write_new(fresh, print, ctx);
    if (error == 0) error = set_name(fresh, path, replaces);
    if (error == 0)
        sync_folder(path);
    else
        (void)unlink(fresh);
    free(fresh);
    return error == 0 || fail(path, error);
}
