/* SPDX-License-Identifier: MIT */
#include "cli/origin.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool reject(const origin_t *origin, const char *format, ...)
{
    va_list arguments;
    const char *const command = origin->command != NULL ? origin->command : "";
    const char *const gap = command[0] != '\0' ? " " : "";
    (void)fflush(stdout);
    (void)fprintf(stderr, "fathom%s%s: ", gap, command);
    if (origin->file != NULL) (void)fprintf(stderr, "%s:%u: ", origin->file, origin->line);
    if (origin->within != NULL)
        (void)fprintf(stderr, "%s%s: ", origin->is_option && origin->file == NULL ? "--" : "",
                      origin->within);
    va_start(arguments, format);
    (void)vfprintf(stderr, format, arguments);
    va_end(arguments);
    if (origin->file == NULL) (void)fprintf(stderr, " See 'fathom%s%s --help'.", gap, command);
    (void)fputc('\n', stderr);
    return false;
}

/* Another number is another thing, not a misspelt one, so a digit differs by two letters. */
static size_t difference(char one, char other)
{
    if (tolower((unsigned char)one) == tolower((unsigned char)other)) return 0;
    return isdigit((unsigned char)one) && isdigit((unsigned char)other) ? 2 : 1;
}

/* The number of letters to insert, delete, replace or swap to make `other` from `one`. */
static size_t distance(const char *one, const char *other)
{
    enum { LONGEST = 32 };
    size_t d[LONGEST + 1][LONGEST + 1];
    const size_t n = strlen(one);
    const size_t m = strlen(other);
    if (n > LONGEST || m > LONGEST) return LONGEST;
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= m; j++) {
            d[i][j] = i + j;
            if (i == 0 || j == 0) continue;
            d[i][j] = d[i - 1][j - 1] + difference(one[i - 1], other[j - 1]);
            if (d[i - 1][j] + 1 < d[i][j]) d[i][j] = d[i - 1][j] + 1;
            if (d[i][j - 1] + 1 < d[i][j]) d[i][j] = d[i][j - 1] + 1;
            if (i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1] &&
                d[i - 2][j - 2] + 1 < d[i][j])
                d[i][j] = d[i - 2][j - 2] + 1;
        }
    return d[n][m];
}

/* Suggests a name if about a third of the letters differs at most. */
void nearest_try(nearest_t *nearest, const char *name)
{
    const size_t length = strlen(nearest->word);
    const bool is_begin = length > 1 && strncmp(nearest->word, name, length) == 0;
    const size_t this_distance = is_begin ? 1 : distance(nearest->word, name);
    const size_t limit = nearest->name != NULL ? nearest->distance : (length + 1) / 3 + 1;
    if (this_distance >= limit || this_distance >= strlen(name)) return;
    nearest->name = name;
    nearest->distance = this_distance;
}

bool reject_unknown(const origin_t *origin, const char *what, const char *mark, const nearest_t *nearest,
                    const char *known)
{
    if (nearest->name != NULL)
        return reject(origin, "unknown %s '%s%s'. Did you mean %s%s?", what, mark, nearest->word, mark,
                      nearest->name);
    if (known != NULL)
        return reject(origin, "unknown %s '%s%s'. It is one of %s.", what, mark, nearest->word, known);
    return reject(origin, "unknown %s '%s%s'.", what, mark, nearest->word);
}
