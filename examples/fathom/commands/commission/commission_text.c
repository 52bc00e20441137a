/* SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <string.h>

#include "commands/commission/commission.h"

/* What the user is told to do, and wishes. */

FILE *commission_text(const commission_t *run) { return run->session.is_json ? stderr : stdout; }

void commission_tell(commission_t *run, const char *format, ...)
{
    char text[sizeof run->last_told];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (strcmp(text, run->last_told) == 0) return;
    memcpy(run->last_told, text, sizeof text);
    (void)fprintf(commission_text(run), "%s\n", text);
    (void)fflush(commission_text(run));
}

bool commission_has_ended(const commission_t *run)
{
    const host_t *const host = run->session.channel.host;
    return host->has_ended(host->ctx);
}
