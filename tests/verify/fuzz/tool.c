/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream, fmemopen */
#include "tool.h"

#include <dirent.h>
#include <errno.h>
#include <netdb.h>
#include <sys/stat.h>

#include "commands/commands.h"

tool_t tool;

static FILE *own_out;
static FILE *own_err;
static const uint8_t *file;
static size_t file_size;
static char *written;
static size_t written_size;
static uint64_t time_us;

/* ---- the system ---- */

static FILE *empty(void) { return fmemopen((void *)(uintptr_t) "", 1, "r"); }

/* libFuzzer, which is linked with the same, has the real ones. */
static bool is_inside;

#define REAL(result, name, ...) result __real_##name(__VA_ARGS__)
REAL(FILE *, fopen, const char *, const char *);
REAL(int, open, const char *, int, ...);
REAL(int, stat, const char *, struct stat *);
REAL(int, lstat, const char *, struct stat *);
REAL(int, rename, const char *, const char *);
REAL(int, remove, const char *);
REAL(int, unlink, const char *);
REAL(char *, realpath, const char *, char *);
REAL(DIR *, opendir, const char *);

FILE *__wrap_fopen(const char *path, const char *mode)
{
    if (!is_inside) return __real_fopen(path, mode);
    if (mode[0] == 'w') {
        free(written);
        written = NULL;
        return open_memstream(&written, &written_size);
    }
    if (file != NULL && file_size != 0) return fmemopen((void *)(uintptr_t)file, file_size, "r");
    errno = ENOENT;
    return NULL;
}

int __wrap_open(const char *path, int flags, int mode)
{
    if (!is_inside) return __real_open(path, flags, mode);
    errno = EACCES;
    return -1;
}

/* Nothing else is there. */
static int none(void)
{
    errno = ENOENT;
    return -1;
}

int __wrap_stat(const char *path, struct stat *is) { return is_inside ? none() : __real_stat(path, is); }
int __wrap_lstat(const char *path, struct stat *is) { return is_inside ? none() : __real_lstat(path, is); }
int __wrap_rename(const char *from, const char *to) { return is_inside ? 0 : __real_rename(from, to); }
int __wrap_remove(const char *path) { return is_inside ? 0 : __real_remove(path); }
int __wrap_unlink(const char *path) { return is_inside ? 0 : __real_unlink(path); }

char *__wrap_realpath(const char *path, char *to)
{
    if (!is_inside) return __real_realpath(path, to);
    (void)none();
    return NULL;
}

DIR *__wrap_opendir(const char *path)
{
    if (!is_inside) return __real_opendir(path);
    (void)none();
    return NULL;
}

int __wrap_fsync(int fd) { return 0; }
int __wrap_getaddrinfo(const char *name, const char *service, const void *hints, void *list)
{
    return EAI_NONAME;
}
int __wrap_fathom_sim_pty_open(void *pty, void *line, const void *how) { return none(); }

/* ---- the host ---- */

static bool refuse(fathom_posix_uart_t *port, const char *path)
{
    memset(port, 0, sizeof *port);
    port->fd = -1;
    (void)snprintf(port->path, sizeof port->path, "%s", path);
    port->error = FATHOM_POSIX_ERR_NOT_FOUND;
    (void)snprintf(port->text, sizeof port->text, "%s: not here", port->path);
    tool.opens++;
    return false;
}

static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    PROMISE(settings->baud != 0 && settings->parity <= FATHOM_PARITY_ODD && settings->stop_bits >= 1 &&
                settings->stop_bits <= 2,
            "hal.h: the settings of a line");
    return refuse(port, path);
}

static bool open_pins(void *ctx, const char *path, const pin_options_t *wanted, pins_t *pins)
{
    memset(pins, 0, sizeof *pins);
    pins->fd = -1;
    pins->lines[0].error = FATHOM_GPIO_ERR_NOT_FOUND;
    (void)snprintf(pins->lines[0].text, sizeof pins->lines[0].text, "%.100s: not here", path);
    tool.opens++;
    return false;
}

static void close_port(void *ctx, fathom_posix_uart_t *port) {}
static void close_pins(void *ctx, pins_t *pins) {}
static uint64_t now_us(void *ctx) { return time_us; }
static uint64_t utc_us(void *ctx) { return UINT64_C(1764000000000000) + time_us; }
static bool begin(void *ctx) { return true; }
static bool has_ended(void *ctx) { return time_us > 3000000; }
static bool is_output_gone(void *ctx) { return false; }
static void wait_for(void *ctx, int fd, short events, uint32_t max_us, bool watch_output)
{
    time_us += max_us < 1000000 ? max_us + 1 : 1000000;
}
static void sleep_for(void *ctx, fathom_loop_t *loop, uint32_t max_us)
{
    wait_for(ctx, -1, 0, max_us, true);
    for (fathom_loop_source_t *source = loop->sources; source != NULL; source = source->next)
        fathom_loop_wake(source);
}
static void attend(void *ctx, fathom_loop_t *loop) {}

static const host_t host = {.open = open_port,
                            .close = close_port,
                            .open_pins = open_pins,
                            .close_pins = close_pins,
                            .now_us = now_us,
                            .utc_us = utc_us,
                            .begin = begin,
                            .has_ended = has_ended,
                            .is_output_gone = is_output_gone,
                            .wait = wait_for,
                            .loop = {.now_us = now_us, .sleep = sleep_for},
                            .attend = attend};

/* ---- for the targets ---- */

void tool_file(const uint8_t *bytes, size_t size)
{
    file = bytes;
    file_size = size;
    free(written);
    written = NULL;
    written_size = 0;
}

const char *tool_written(size_t *size)
{
    *size = written_size;
    return written;
}

void tool_capture(void)
{
    free(tool.out);
    free(tool.err);
    own_out = stdout;
    own_err = stderr;
    stdout = open_memstream(&tool.out, &tool.out_size);
    stderr = open_memstream(&tool.err, &tool.err_size);
    if (stdout == NULL || stderr == NULL) abort();
    time_us = 0;
    tool.opens = 0;
    is_inside = true;
}

void tool_release(void)
{
    is_inside = false;
    (void)fclose(stdout);
    (void)fclose(stderr);
    stdout = own_out;
    stderr = own_err;
}

void tool_run(int argc, char **argv)
{
    FILE *const own_in = stdin;
    stdin = file_size != 0 ? fmemopen((void *)(uintptr_t)file, file_size, "r") : empty();
    if (stdin == NULL) abort();
    tool_capture();
    tool.status = run_command(&host, argc, argv);
    tool_release();
    (void)fclose(stdin);
    stdin = own_in;
}
