/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fileno */
#include "output/progress.h"

#include <inttypes.h>
#include <unistd.h>

/* With the words the bar fits 80 columns. */
enum { BAR = 24, EVERY_US = 100000, PATIENCE_US = 2000000 };

void progress_init(progress_t *progress, FILE *to, uint64_t total_us)
{
    progress->to = to;
    progress->is_terminal = isatty(fileno(to)) != 0;
    progress->is_shown = false;
    progress->total_us = total_us;
    progress->shown_us = 0;
}

void progress_show(progress_t *progress, uint64_t now_us, uint64_t done_us, const char *doing)
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
    /* ESC [ K removes the rest of a longer line. */
    (void)fprintf(progress->to, "\r[%s] %3u %%  %s, %" PRIu64 " s left\033[K", bar, percent, doing, left_s);
    (void)fflush(progress->to);
    progress->is_shown = true;
    progress->shown_us = now_us;
}

void progress_start_wait(progress_t *progress, FILE *to, uint64_t now_us)
{
    progress_init(progress, to, 0);
    progress->start_us = now_us;
}

void progress_show_wait(progress_t *progress, uint64_t now_us, const char *doing)
{
    const uint64_t passed_us = now_us - progress->start_us;
    if (!progress->is_terminal || passed_us < PATIENCE_US || now_us - progress->shown_us < EVERY_US) return;
    (void)fprintf(progress->to, "\r%s, %" PRIu64 " s\033[K", doing, passed_us / 1000000u);
    (void)fflush(progress->to);
    progress->is_shown = true;
    progress->shown_us = now_us;
}

void progress_clear(progress_t *progress)
{
    if (!progress->is_shown) return;
    (void)fputs("\r\033[K", progress->to);
    (void)fflush(progress->to);
    progress->is_shown = false;
}

const char *duration_text(uint64_t us, char text[DURATION_TEXT])
{
    const uint64_t s = (us + 999999u) / 1000000u;
    if (s < 60)
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " s", s);
    else
        (void)snprintf(text, DURATION_TEXT, "%" PRIu64 " min %" PRIu64 " s", s / 60, s % 60);
    return text;
}
