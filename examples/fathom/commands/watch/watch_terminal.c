/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ioctl, tcgetpgrp, fileno */
#include "commands/watch/watch_terminal.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "ports/host.h"

enum { OUTPUT = 65536, MARGIN = 64, STUCK_MS = 200 };

static struct {
    struct termios before;
    bool is_open;
    bool has_input; /* `before` is set */
    bool wants_end;
    fathom_loop_source_t keys;
    picture_t shown;
} terminal;

static const char *environment(const char *name)
{
    const char *const text = getenv(name);
    return text != NULL ? text : "";
}

bool terminal_can_draw(void)
{
    const char *const type = environment("TERM");
    return isatty(fileno(stdout)) == 1 && type[0] != '\0' && strcmp(type, "dumb") != 0;
}

static bool has_colours(void) { return environment("NO_COLOR")[0] == '\0'; }

/* By the name of the locale, which need not be installed. */
static bool is_utf8(void)
{
    static const char *const names[] = {"LC_ALL", "LC_CTYPE", "LANG"};
    for (size_t i = 0; i != sizeof names / sizeof names[0]; i++) {
        const char *const text = environment(names[i]);
        if (text[0] == '\0') continue;
        return strstr(text, "UTF-8") != NULL || strstr(text, "utf8") != NULL ||
               strstr(text, "UTF8") != NULL || strstr(text, "utf-8") != NULL;
    }
    return false;
}

/* Returns true if the terminal accepts nothing, as after Ctrl-S. */
static bool is_stuck(void)
{
    struct pollfd entry = {STDOUT_FILENO, POLLOUT, 0};
    return poll(&entry, 1, STUCK_MS) == 0;
}

/* A signal that ends the command also ends a write to a terminal that is stuck. */
static int write_all(const char *text)
{
    size_t left = strlen(text);
    while (left != 0) {
        if (host_posix.has_ended(NULL) && is_stuck()) return EINTR;
        const ssize_t n = write(STDOUT_FILENO, text, left);
        if (n < 0 && (errno != EINTR || host_posix.has_ended(NULL))) return errno;
        if (n < 0) continue;
        text += n;
        left -= (size_t)n;
    }
    return 0;
}

void terminal_open(void)
{
    /* A program in the background would be stopped for changing it. */
    terminal.has_input =
        tcgetpgrp(STDIN_FILENO) == getpgrp() && tcgetattr(STDIN_FILENO, &terminal.before) == 0;
    if (terminal.has_input) {
        struct termios quiet = terminal.before;
        quiet.c_lflag &= ~(tcflag_t)(ECHO | ICANON);
        quiet.c_cc[VSUSP] = _POSIX_VDISABLE;
        quiet.c_cc[VQUIT] = _POSIX_VDISABLE;
        quiet.c_cc[VMIN] = 0; /* a read does not wait */
        quiet.c_cc[VTIME] = 0;
        (void)tcsetattr(STDIN_FILENO, TCSADRAIN, &quiet);
    }
    terminal.is_open = true;
    terminal.wants_end = false;
    terminal.shown.rows = 0;
    /* Another screen, no cursor, no wrap at the right edge, nothing on the screen. */
    (void)write_all("\x1B[?1049h\x1B[?25l\x1B[?7l\x1B[2J");
}

bool terminal_close(void)
{
    if (!terminal.is_open) return true;
    terminal.is_open = false;
    const bool is_shown = write_all("\x1B[0m\x1B[?7h\x1B[?25h\x1B[?1049l") != EINTR;
    /* What was typed is dropped. TCSAFLUSH would wait for output that a stuck terminal does not accept. */
    if (terminal.has_input) (void)tcsetattr(STDIN_FILENO, is_shown ? TCSAFLUSH : TCSANOW, &terminal.before);
    if (terminal.has_input && !is_shown) (void)tcflush(STDIN_FILENO, TCIFLUSH);
    return is_shown;
}

bool terminal_has_keys(void) { return terminal.is_open && terminal.has_input; }

bool terminal_wants_end(void) { return terminal.wants_end; }

static int keys_fd(const fathom_loop_source_t *source)
{
    (void)source;
    return STDIN_FILENO;
}

static bool poll_keys(fathom_loop_source_t *source)
{
    char keys[64];
    ssize_t n;
    if (!source->is_readable) return true;
    while ((n = read(STDIN_FILENO, keys, sizeof keys)) > 0)
        if (memchr(keys, 'q', (size_t)n) != NULL || memchr(keys, 'Q', (size_t)n) != NULL)
            terminal.wants_end = true;
    return true;
}

void terminal_add_keys(fathom_loop_t *loop)
{
    static const fathom_loop_kind_t kind = {.fd = keys_fd, .poll = poll_keys};
    if (!terminal_has_keys()) return;
    memset(&terminal.keys, 0, sizeof terminal.keys);
    terminal.keys.kind = &kind;
    fathom_loop_add(loop, &terminal.keys);
}

void terminal_size(int *rows, int *columns)
{
    struct winsize size = {0, 0, 0, 0};
    const bool is_known =
        ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row != 0 && size.ws_col != 0;
    *rows = is_known ? size.ws_row : 24;
    *columns = is_known ? size.ws_col : 80;
}

static bool is_same_row(const picture_t *one, const picture_t *other, int row)
{
    return memcmp(one->cells[row], other->cells[row], (size_t)one->columns * sizeof one->cells[row][0]) == 0;
}

/* In one write as a rule, so that no half picture is seen. */
int terminal_show(const picture_t *picture, bool all)
{
    static char text[OUTPUT];
    const bool colours = has_colours();
    const bool utf8 = is_utf8();
    char *at = text;
    int error = 0;
    if (picture->rows != terminal.shown.rows || picture->columns != terminal.shown.columns) all = true;
    if (all) at += snprintf(text, sizeof text, "\x1B[0m\x1B[2J");
    for (int row = 0; row != picture->rows && error == 0; row++) {
        if (!all && is_same_row(picture, &terminal.shown, row)) continue;
        at += snprintf(at, MARGIN, "\x1B[%d;1H", row + 1);
        const int columns = picture_row(picture, row, colours, utf8, at);
        at += strlen(at);
        /* At the right edge this would erase the last character. */
        if (columns != picture->columns) at = strcpy(at, "\x1B[K") + strlen("\x1B[K");
        if (text + sizeof text - at > PICTURE_ROW_TEXT + MARGIN) continue;
        error = write_all(text);
        at = text;
    }
    *at = '\0';
    if (at != text && error == 0) error = write_all(text);
    terminal.shown = *picture;
    return error;
}
