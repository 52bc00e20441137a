/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fileno */
#include "commands/scan/scan_progress.h"

#include <inttypes.h>
#include <unistd.h>

/* Together with the words it fits 80 columns. */
enum { BAR = 24, EVERY_US = 100000 };

void scan_progress_begin(scan_progress_t *progress, FILE *to, uint64_t total_us)
{
    progress->to = to;
    progress->is_terminal = isatty(fileno(to)) != 0;
    progress->is_shown = false;
    progress->total_us = total_us;
    progress->shown_us = 0;
}

void scan_progress_show(scan_progress_t *progress, uint64_t now_us, uint64_t done_us, const char *what)
{
    const uint64_t total_us = progress->total_us;
    if (!progress->is_terminal || total_us == 0 ||
        (progress->is_shown && now_us - progress->shown_us < EVERY_US))
        return;
    if (done_us > total_us) done_us = total_us;
    const unsigned percent = (unsigned)(done_us * 100 / total_us);
    const unsigned filled = percent * BAR / 100;
    char bar[BAR + 1];
    for (unsigned i = 0; i != BAR; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR] = '\0';
    const uint64_t left_s = (total_us - done_us + 999999u) / 1000000u;
    /* ESC [ K: nothing is left of a longer line before */
    (void)fprintf(progress->to, "\r[%s] %3u %%  %s, %" PRIu64 " s left\033[K", bar, percent, what, left_s);
    (void)fflush(progress->to);
    progress->is_shown = true;
    progress->shown_us = now_us;
}

void scan_progress_clear(scan_progress_t *progress)
{
    if (!progress->is_shown) return;
    (void)fputs("\r\033[K", progress->to);
    (void)fflush(progress->to);
    progress->is_shown = false;
}
