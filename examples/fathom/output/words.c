/* SPDX-License-Identifier: MIT */
#include "output/words.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

bool number_parse(const char *text, uint32_t min, uint32_t max, uint32_t *number)
{
    enum { MOST_DIGITS = 10 };
    uint64_t sum = 0;
    const size_t length = strlen(text);
    if (length == 0 || length > MOST_DIGITS || strspn(text, "0123456789") != length) return false;
    for (; *text != '\0'; text++) sum = sum * 10 + (uint64_t)(*text - '0');
    if (sum < min || sum > max) return false;
    *number = (uint32_t)sum;
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

void tenths_text(char *text, size_t capacity, int32_t tenths)
{
    const uint32_t size = tenths < 0 ? (uint32_t)-tenths : (uint32_t)tenths;
    (void)snprintf(text, capacity, "%s%" PRIu32 ".%" PRIu32, tenths < 0 ? "-" : "", size / 10, size % 10);
}
