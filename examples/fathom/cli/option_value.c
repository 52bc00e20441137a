/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "cli/option.h"
#include "output/words.h"

/* ---- values ---- */

/* Stores a number in a member of `size` bytes; a negative one in two's complement. */
static void store(void *member, size_t size, int64_t number)
{
    if (size == sizeof(uint8_t))
        *(uint8_t *)member = (uint8_t)number;
    else if (size == sizeof(uint16_t))
        *(uint16_t *)member = (uint16_t)number;
    else if (size == sizeof(uint32_t))
        *(uint32_t *)member = (uint32_t)number;
    else
        *(uint64_t *)member = (uint64_t)number;
}

static bool set_number(const option_t *row, const char *text, char *member)
{
    uint32_t number = 0;
    const uint32_t scale = row->scale != 0 ? row->scale : 1;
    if (!number_parse(text, row->min, row->max, &number)) return false;
    store(member, row->size, (int64_t)number * scale);
    return true;
}

static bool set_signed(const option_t *row, const char *text, char *member)
{
    uint32_t number = 0;
    const bool is_negative = text[0] == '-';
    if (!number_parse(text + (is_negative ? 1 : 0), 0, row->max, &number)) return false;
    store(member, row->size, is_negative ? -(int64_t)number : (int64_t)number);
    return true;
}

static bool set_one_of(const option_t *row, const char *text, char *member)
{
    uint32_t n = 0;
    uint32_t number = 0;
    if (!word_find(row->words, text, &n) || !number_parse(text, 0, UINT32_MAX, &number)) return false;
    store(member, row->size, number);
    return true;
}

static bool set_pair(const option_t *row, const char *text, char *member)
{
    char word[16];
    const char separator = row->separator != '\0' ? row->separator : '/';
    const bool is_range = separator == '-';
    option_t second = *row;
    uint32_t first = 0;
    const char *const rest = next_word(text, separator, word, sizeof word);
    if ((is_range && rest == NULL) || !number_parse(word, row->min, row->max, &first)) return false;
    if (is_range) second.min = first;
    return set_number(row, word, member) &&
           set_number(&second, rest != NULL ? rest : word, member + row->size);
}

static bool set_choice(const option_t *row, const char *text, char *member)
{
    uint32_t n = 0;
    if (!word_find(row->words, text, &n)) return false;
    store(member, row->size, (int64_t)n + row->min);
    return true;
}

static bool set_bits(const option_t *row, const char *text, char *member)
{
    uint8_t bits = 0;
    while (text != NULL) {
        char word[16];
        uint32_t n = 0;
        text = next_word(text, ',', word, sizeof word);
        if (!number_parse(word, row->min, row->max, &n) || (bits >> (n - 1) & 1) != 0) return false;
        bits |= (uint8_t)(1u << (n - 1));
    }
    store(member, row->size, bits);
    return true;
}

static bool set_string(const option_t *row, const char *text, char *member)
{
    const size_t length = strlen(text);
    if (length == 0 || length >= row->size) return false;
    memcpy(member, text, length + 1);
    return true;
}

static bool set_value(const option_t *row, char *text, char *member)
{
    switch (row->kind) {
    case KIND_FLAG:
        *(bool *)member = true;
        return true;
    case KIND_TEXT:
        memcpy(member, &text, sizeof text);
        return true;
    case KIND_NUMBER:
        return set_number(row, text, member);
    case KIND_SIGNED:
        return set_signed(row, text, member);
    case KIND_ONE_OF:
        return set_one_of(row, text, member);
    case KIND_PAIR:
        return set_pair(row, text, member);
    case KIND_CHOICE:
        return set_choice(row, text, member);
    case KIND_SET:
        return set_bits(row, text, member);
    case KIND_STRING:
        return set_string(row, text, member);
    case KIND_CUSTOM:
        return row->parse(text, member);
    default:
        return false;
    }
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
bool option_set(const option_t *row, char *text, void *structure, const origin_t *origin)
{
    char takes[OPTION_TAKES];
    char *const member = (char *)structure + row->at;
    const bool is_option = origin->within == NULL && origin->file == NULL;
    if (row->kind == KIND_KEYS) {
        origin_t its = *origin;
        its.within = row->name;
        its.is_option = true;
        if (!option_set_keys(row->keys, text, member, &its)) return false;
        if (row->check != NULL && !row->check(member, &its)) return false;
    } else if (!set_value(row, text, member)) {
        option_takes(row, takes);
        return reject(origin, "%s%s is '%.80s%s'. It takes %s.", is_option ? "--" : "", row->name, text,
                      strlen(text) > 80 ? "..." : "", takes);
    }
    if (row->has != 0) *(bool *)((char *)structure + row->has - 1) = true;
    return true;
}

bool option_check_given(const option_table_t *tables, const option_given_t *given, const origin_t *origin)
{
    const char *const mark = origin->within == NULL && origin->file == NULL ? "--" : "";
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        const option_t *const row = walk.row;
        const unsigned line = given->line[walk.number];
        if (line == 0 && row->is_required) {
            char takes[OPTION_TAKES];
            option_takes(row, takes);
            return reject(origin, "%s%s is missing. It takes %s.", mark, row->name, takes);
        }
        if (line == 0 || row->needs == NULL || option_is_given(given, tables, row->needs)) continue;
        origin_t its = *origin;
        if (its.file != NULL) its.line = line;
        return reject(&its, "%s%s has no effect without %s%s.", mark, row->name, mark, row->needs);
    }
    return true;
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
bool option_set_keys(const option_t *keys, char *text, void *structure, const origin_t *origin)
{
    const option_table_t tables[] = {{keys, 0}, {NULL, 0}};
    option_given_t given = {{0}};
    for (char *part = text, *next = NULL; part != NULL; part = next) {
        option_walk_t key = {.row = keys};
        next = strchr(part, ',');
        if (next != NULL) *next++ = '\0';
        char *const equals = strchr(part, '=');
        const bool is_first = part == text && equals == NULL && keys->is_first;
        if (equals != NULL) *equals = '\0';
        if (!is_first && !option_find(&key, tables, part, strlen(part)))
            return option_reject_unknown(tables, "key", part, origin);
        if (!is_first && equals == NULL) return reject(origin, "%s has no value.", part);
        if (given.line[key.number] != 0) return reject(origin, "%s is given twice.", key.row->name);
        given.line[key.number] = 1;
        if (!option_set(key.row, is_first ? part : equals + 1, structure, origin)) return false;
    }
    return option_check_given(tables, &given, origin);
}

/* ---- what values there are ---- */

static void takes_words(const char *words, char text[OPTION_TAKES])
{
    const char *word = NULL;
    size_t length = 0;
    size_t at = 0;
    for (size_t n = 0; (length = word_at(words, n, &word)) != 0 && at < OPTION_TAKES; n++)
        at += (size_t)snprintf(text + at, OPTION_TAKES - at, "%s%.*s",
                               n == 0 ? "" : (word[length] == '\0' ? " or " : ", "), (int)length, word);
}

/* The unit of a number, which the name of its value states; "": none. */
static const char *unit_of(const option_t *row)
{
    static const char *const units[][2] = {{"MS", " ms"}, {"S", " s"}, {"[S]", " s"}, {"MM", " mm"}};
    for (size_t i = 0; row->value != NULL && i != sizeof units / sizeof units[0]; i++)
        if (strcmp(row->value, units[i][0]) == 0) return units[i][1];
    return "";
}

void option_takes(const option_t *row, char text[OPTION_TAKES])
{
    const char *const value = row->value != NULL ? row->value : "no value";
    (void)snprintf(text, OPTION_TAKES, "%s", row->takes != NULL ? row->takes : value);
    if (row->takes != NULL) return;
    if (row->kind == KIND_NUMBER)
        (void)snprintf(text, OPTION_TAKES, "a whole number from %" PRIu32 " to %" PRIu32 "%s", row->min,
                       row->max, unit_of(row));
    else if (row->kind == KIND_SIGNED)
        (void)snprintf(text, OPTION_TAKES, "a whole number from -%" PRIu32 " to %" PRIu32 "%s", row->max,
                       row->max, unit_of(row));
    else if (row->kind == KIND_PAIR)
        (void)snprintf(text, OPTION_TAKES, "%s, from %" PRIu32 " to %" PRIu32, value, row->min, row->max);
    else if (row->kind == KIND_SET)
        (void)snprintf(text, OPTION_TAKES, "numbers from %" PRIu32 " to %" PRIu32 ", each once, such as 1,2",
                       row->min, row->max);
    else if (row->kind == KIND_STRING)
        (void)snprintf(text, OPTION_TAKES, "%s of 1 to %zu characters", value, row->size - 1);
    else if (row->words != NULL)
        takes_words(row->words, text);
}
