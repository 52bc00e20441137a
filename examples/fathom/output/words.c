/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): gmtime_r, stpcpy */
#include "output/words.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fathom/hal.h"

bool is_output_written(void)
{
    /* If an earlier write has failed, errno may since be that of another call. */
    const bool is_flushed = fflush(stdout) == 0;
    if (is_flushed && ferror(stdout) == 0) return true;
    (void)fprintf(stderr, "fathom: cannot write the output%s%s\n", is_flushed ? "" : ": ",
                  is_flushed ? "" : strerror(errno));
    return false;
}

void end_without_memory(void)
{
    (void)fputs("fathom: no memory is left.\n", stderr);
    _Exit(STATUS_FAILED);
}

void *allocate(size_t size)
{
    void *const memory = calloc(1, size);
    if (memory == NULL) end_without_memory();
    return memory;
}

void *reallocate(void *memory, size_t size)
{
    void *const all = realloc(memory, size);
    if (all == NULL) end_without_memory();
    return all;
}

const char *environment(const char *name)
{
    const char *const value = getenv(name); /* NOLINT(concurrency-mt-unsafe): no thread writes it */
    return value != NULL ? value : "";
}

/* ---- numbers and lists ---- */

bool number_parse(const char *text, uint32_t min, uint32_t max, uint32_t *number)
{
    enum { MOST_DIGITS = 10 };
    const size_t length = strlen(text);
    if (length == 0 || length > MOST_DIGITS || strspn(text, "0123456789") != length) return false;
    const uint64_t value = strtoull(text, NULL, 10);
    if (value < min || value > max) return false;
    *number = (uint32_t)value;
    return true;
}

bool range_parse(const char *text, uint32_t min, uint32_t max, uint32_t *first, uint32_t *last)
{
    char word[16];
    const char *const rest = next_word(text, '-', word, sizeof word);
    return number_parse(word, min, max, first) && number_parse(rest != NULL ? rest : word, *first, max, last);
}

size_t word_at(const char *words, size_t n, const char **word)
{
    while (n-- != 0 && *(words += strcspn(words, " ")) != '\0') words++;
    *word = words;
    return strcspn(words, " ");
}

bool word_find(const char *words, const char *text, uint32_t *n)
{
    const char *word = NULL;
    size_t length = 0;
    for (*n = 0; (length = word_at(words, *n, &word)) != 0; ++*n)
        if (length == strlen(text) && strncmp(word, text, length) == 0) return true;
    return false;
}

const char *last_part(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

void list_add(char *list, size_t capacity, const char *word)
{
    const size_t length = strlen(list);
    (void)snprintf(list + length, capacity - length, "%s%s", length != 0 ? ", " : "", word);
}

const char *next_word(const char *list, char separator, char *word, size_t capacity)
{
    const char *const end = strchr(list, separator);
    const size_t length = end != NULL ? (size_t)(end - list) : strlen(list);
    (void)snprintf(word, capacity, "%.*s", (int)length, list);
    return end != NULL ? end + 1 : NULL;
}

/* Without printf, since each reading has a dozen of them. */
void decimal_text(char text[DECIMAL_TEXT], int64_t number, unsigned places)
{
    uint64_t left = number < 0 ? 0 - (uint64_t)number : (uint64_t)number;
    char digits[DECIMAL_TEXT];
    size_t at = sizeof digits - 1;
    digits[at] = '\0';
    for (unsigned place = 0; place <= places || left != 0; place++) {
        if (place == places && places != 0) digits[--at] = '.';
        digits[--at] = (char)('0' + left % 10);
        left /= 10;
    }
    if (number < 0) digits[--at] = '-';
    memcpy(text, digits + at, sizeof digits - at);
}

/* ---- times ---- */

uint64_t time_extend(uint64_t now_us, uint32_t then_us)
{
    const uint32_t longest_us = 4260000000u; /* 71 minutes */
    const uint32_t ago_us = fathom_elapsed_us((uint32_t)now_us, then_us);
    return ago_us <= longest_us ? now_us - ago_us : now_us;
}

uint64_t utc_before(uint64_t utc_us, uint64_t age_us)
{
    return utc_us < UINT64_C(1735689600000000) ? 0 : utc_us - age_us; /* 2025-01-01 */
}

/* Most calls are within the second of the call before, whose text is kept. */
const char *utc_text(uint64_t utc_us, char text[UTC_TEXT])
{
    static char whole[24];
    static time_t whole_s = -1;
    char fraction[DECIMAL_TEXT]; /* seven digits, of which the first becomes the point */
    const time_t seconds = (time_t)(utc_us / 1000000u);
    struct tm parts;
    if (utc_us == 0) return NULL;
    if (seconds != whole_s && gmtime_r(&seconds, &parts) != NULL)
        (void)strftime(whole, sizeof whole, "%Y-%m-%dT%H:%M:%S", &parts);
    whole_s = seconds;
    decimal_text(fraction, (int64_t)(1000000u + utc_us % 1000000u), 0);
    fraction[0] = '.';
    (void)stpcpy(stpcpy(stpcpy(text, whole), fraction), "Z");
    return text;
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
