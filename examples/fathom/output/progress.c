/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): fileno */
#include "output/progress.h"

#include <inttypes.h>
#include <unistd.h>

/* With the words the bar fits 80 columns. */
enum { BAR = 24, EVERY_US = 100000, PATIENCE_US = 2000000 };

void progress_init(progress_t *progress, FILE *to, uint64_t now_us, uint64_t total_us)
{
    *progress = (progress_t){
        .to = to, .is_terminal = isatty(fileno(to)) != 0, .start_us = now_us, .total_us = total_us};
}

static void print_bar(FILE *to, uint64_t done_us, uint64_t total_us, const char *doing)
{
    static const char full[] = "########################";
    static const char empty[] = "........................";
    if (done_us > total_us) done_us = total_us;
    const int percent = (int)(done_us * 100 / total_us);
    const int filled = percent * BAR / 100;
    const uint64_t left_s = (total_us - done_us + 999999u) / 1000000u;
    (void)fprintf(to, "\r[%.*s%.*s] %3d %%  %s, %" PRIu64 " s left", filled, full, BAR - filled, empty,
                  percent, doing, left_s);
}

void progress_show(progress_t *progress, uint64_t now_us, uint64_t done_us, const char *doing)
{
    const uint64_t passed_us = now_us - progress->start_us;
    if (!progress->is_terminal || (progress->is_shown && now_us - progress->shown_us < EVERY_US)) return;
    if (progress->total_us == 0 && passed_us < PATIENCE_US) return;
    if (progress->total_us != 0)
        print_bar(progress->to, done_us, progress->total_us, doing);
    else
        (void)fprintf(progress->to, "\r%s, %" PRIu64 " s", doing, passed_us / 1000000u);
    (void)fputs("\033[K", progress->to); /* removes the rest of a longer line */
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
