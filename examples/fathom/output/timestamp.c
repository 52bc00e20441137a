/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): gmtime_r */
#include "output/timestamp.h"

#include <stdio.h>
#include <time.h>

#include "fathom/hal.h"

uint64_t time_extend(uint64_t now_us, uint32_t then_us)
{
    const uint32_t ago_us = fathom_elapsed_us((uint32_t)now_us, then_us);
    return ago_us <= TIME_LONGEST_US ? now_us - ago_us : now_us;
}

const char *utc_text(uint64_t utc_us, char text[UTC_TEXT])
{
    const time_t seconds = (time_t)(utc_us / 1000000u);
    struct tm parts;
    char whole[24] = "";
    if (gmtime_r(&seconds, &parts) != NULL) (void)strftime(whole, sizeof whole, "%Y-%m-%dT%H:%M:%S", &parts);
    (void)snprintf(text, UTC_TEXT, "%s.%06uZ", whole, (unsigned)(utc_us % 1000000u));
    return text;
}
