/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ftruncate */
#include "cli/command.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- messages ---- */

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

const char *origin_mark(const origin_t *origin)
{
    return origin->within == NULL && origin->file == NULL ? "--" : "";
}

/* Returns true if the names have the same number of digits, but others: another number is another thing, not a
 * misspelt one. */
static bool has_other_digits(const char *one, const char *other)
{
    bool differs = false;
    for (;;) {
        one += strcspn(one, "0123456789");
        other += strcspn(other, "0123456789");
        if (*one == '\0' || *other == '\0') return differs && *one == *other;
        if (*one++ != *other++) differs = true;
    }
}

static size_t difference(char one, char other)
{
    return tolower((unsigned char)one) != tolower((unsigned char)other);
}

static size_t least(size_t one, size_t other) { return one < other ? one : other; }

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
            d[i][j] = least(d[i][j], least(d[i - 1][j], d[i][j - 1]) + 1);
            if (i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1])
                d[i][j] = least(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[n][m];
}

/* Suggests a name that contains the word, or one in which about a third of the letters differs at most. */
void nearest_try(nearest_t *nearest, const char *name)
{
    const size_t length = strlen(nearest->word);
    const bool is_begin = length > 1 && strncmp(nearest->word, name, length) == 0;
    const bool is_part = length > 3 && strstr(name, nearest->word) != NULL;
    const size_t this_distance = is_begin ? 1 : is_part ? 2 : distance(nearest->word, name);
    const size_t limit = nearest->name != NULL ? nearest->distance : (length + 1) / 3 + 1;
    list_add(nearest->known, sizeof nearest->known, name);
    if (this_distance >= limit || this_distance >= strlen(name)) return;
    if (has_other_digits(nearest->word, name)) return;
    nearest->name = name;
    nearest->distance = this_distance;
}

bool reject_unknown(const origin_t *origin, const char *what, const char *mark, const nearest_t *nearest,
                    bool has_list)
{
    if (nearest->name != NULL)
        return reject(origin, "unknown %s '%s%s'. Did you mean %s%s?", what, mark, nearest->word, mark,
                      nearest->name);
    if (has_list)
        return reject(origin, "unknown %s '%s%s'. It is one of %s.", what, mark, nearest->word,
                      nearest->known);
    return reject(origin, "unknown %s '%s%s'.", what, mark, nearest->word);
}

/* ---- rows ---- */

bool option_next(option_walk_t *walk)
{
    if (walk->row == NULL) {
        walk->row = walk->table->rows;
    } else {
        walk->row++;
        walk->number++;
    }
    while (walk->row != NULL && walk->row->name == NULL) walk->row = (++walk->table)->rows;
    return walk->row != NULL;
}

bool option_find(option_walk_t *walk, const option_table_t *tables, const char *name)
{
    *walk = (option_walk_t){.table = tables};
    while (option_next(walk))
        if (strcmp(walk->row->name, name) == 0) return true;
    return false;
}

char option_letter(const char *name)
{
    uint32_t n = 0;
    return word_find("help port quiet", name, &n) ? name[0] : '\0';
}

bool option_find_word(option_walk_t *walk, const option_table_t *tables, const char *word)
{
    if (word[1] == '-') return option_find(walk, tables, word + 2);
    *walk = (option_walk_t){.table = tables};
    while (option_next(walk))
        if (word[1] == option_letter(walk->row->name) && word[1] != '\0') return true;
    return false;
}

bool option_is_given(const option_given_t *given, const option_table_t *tables, const char *name)
{
    option_walk_t walk;
    return option_find(&walk, tables, name) && given->line[walk.number] != 0;
}

bool option_reject_unknown(const option_table_t *tables, const char *what, const char *name,
                           const origin_t *origin)
{
    nearest_t nearest = {.word = name};
    const char *const mark = origin_mark(origin);
    for (option_walk_t walk = {.table = tables}; option_next(&walk);)
        if (!walk.row->is_hidden) nearest_try(&nearest, walk.row->name);
    return reject_unknown(origin, what, mark, &nearest, mark[0] == '\0');
}

/* ---- values ---- */

/* Stores a number in a member of `size` bytes; a negative one in two's complement. */
static bool store(void *member, size_t size, int64_t number)
{
    if (size == sizeof(uint8_t))
        *(uint8_t *)member = (uint8_t)number;
    else if (size == sizeof(uint16_t))
        *(uint16_t *)member = (uint16_t)number;
    else if (size == sizeof(uint32_t))
        *(uint32_t *)member = (uint32_t)number;
    else
        *(uint64_t *)member = (uint64_t)number;
    return true;
}

static bool set_number(const option_t *row, const char *text, uint32_t min, char *member)
{
    uint32_t number = 0;
    const bool is_negative = row->kind == KIND_SIGNED && text[0] == '-';
    const int64_t scale = row->scale != 0 ? row->scale : 1;
    return number_parse(text + (is_negative ? 1 : 0), min, row->max, &number) &&
           store(member, row->size, (is_negative ? -scale : scale) * number);
}

static bool set_pair(const option_t *row, const char *text, char *member)
{
    char word[16];
    const char separator = row->separator != '\0' ? row->separator : '/';
    const bool is_range = separator == '-';
    uint32_t first = 0;
    const char *const rest = next_word(text, separator, word, sizeof word);
    if ((is_range && rest == NULL) || !number_parse(word, row->min, row->max, &first)) return false;
    return set_number(row, word, row->min, member) &&
           set_number(row, rest != NULL ? rest : word, is_range ? first : row->min, member + row->size);
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
    return store(member, row->size, bits);
}

static bool set_value(const option_t *row, char *text, char *member)
{
    uint32_t number = 0;
    const size_t length = strlen(text);
    switch (row->kind) {
    case KIND_FLAG:
        return store(member, row->size, true);
    case KIND_TEXT:
        memcpy(member, &text, sizeof text);
        return true;
    case KIND_NUMBER:
    case KIND_SIGNED:
        return set_number(row, text, row->min, member);
    case KIND_ONE_OF:
        return word_find(row->words, text, &number) && number_parse(text, 0, UINT32_MAX, &number) &&
               store(member, row->size, number);
    case KIND_PAIR:
        return set_pair(row, text, member);
    case KIND_CHOICE:
        return word_find(row->words, text, &number) &&
               store(member, row->size,
                     row->numbers != NULL ? row->numbers[number] : (int64_t)number + row->min);
    case KIND_SET:
        return set_bits(row, text, member);
    case KIND_STRING:
        if (length == 0 || length >= row->size || (row->parse != NULL && !row->parse(text, member)))
            return false;
        memcpy(member, text, length + 1);
        return true;
    case KIND_CUSTOM:
        return row->parse(text, member);
    default:
        return false;
    }
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
bool option_set(const option_t *row, char *text, void *structure, const origin_t *origin)
{
    char *const member = (char *)structure + row->at;
    if (row->kind == KIND_KEYS) {
        origin_t its = *origin;
        its.within = row->name;
        its.is_option = true;
        if (!option_set_keys(row->keys, text, member, &its)) return false;
        if (row->check != NULL && !row->check(member, &its)) return false;
    } else if (!set_value(row, text, member)) {
        return reject(origin, "%s%s is '%.80s%s'. It takes %s.", origin_mark(origin), row->name, text,
                      strlen(text) > 80 ? "..." : "", option_takes(row));
    }
    if (row->has != 0) *(bool *)((char *)structure + row->has - 1) = true;
    return true;
}

/* Names all that is missing at once. False after rejecting it. */
static bool check_required(const option_table_t *tables, const option_given_t *given, const origin_t *origin)
{
    const char *const mark = origin_mark(origin);
    const option_t *missing = NULL;
    char others[160] = "";
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        if (!walk.row->is_required || given->line[walk.number] != 0) continue;
        const size_t length = strlen(others);
        if (missing == NULL)
            missing = walk.row;
        else
            (void)snprintf(others + length, sizeof others - length, " %s%s is missing too.", mark,
                           walk.row->name);
    }
    return missing == NULL || reject(origin, "%s%s is missing. It takes %s.%s", mark, missing->name,
                                     option_takes(missing), others);
}

bool option_check_given(const option_table_t *tables, const option_given_t *given, const origin_t *origin)
{
    const char *const mark = origin_mark(origin);
    if (!check_required(tables, given, origin)) return false;
    for (option_walk_t walk = {.table = tables}; option_next(&walk);) {
        const option_t *const row = walk.row;
        const unsigned line = given->line[walk.number];
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
        if (!is_first && !option_find(&key, tables, part))
            return option_reject_unknown(tables, "key", part, origin);
        if (!is_first && equals == NULL) return reject(origin, "%s has no value.", part);
        if (given.line[key.number] != 0) return reject(origin, "%s is given twice.", key.row->name);
        given.line[key.number] = 1;
        if (!option_set(key.row, is_first ? part : equals + 1, structure, origin)) return false;
    }
    return option_check_given(tables, &given, origin);
}

/* ---- what values there are ---- */

static void takes_words(const char *words, char *text, size_t capacity)
{
    const char *word = NULL;
    size_t length = 0;
    size_t at = 0;
    for (size_t n = 0; (length = word_at(words, n, &word)) != 0 && at < capacity; n++)
        at += (size_t)snprintf(text + at, capacity - at, "%s%.*s",
                               n == 0 ? "" : (word[length] == '\0' ? " or " : ", "), (int)length, word);
}

/* The unit of a number, which the name of its value states; "": none. */
static const char *unit_of(const char *value)
{
    static const char *const units[][2] = {{"MS", " ms"}, {"S", " s"}, {"[S]", " s"}, {"MM", " mm"}};
    for (size_t i = 0; i != sizeof units / sizeof units[0]; i++)
        if (strcmp(value, units[i][0]) == 0) return units[i][1];
    return "";
}

const char *option_takes(const option_t *row)
{
    static char text[200];
    const char *const value = row->value != NULL ? row->value : "no value";
    const bool is_signed = row->kind == KIND_SIGNED;
    if (row->takes != NULL) return row->takes;
    (void)snprintf(text, sizeof text, "%s", value);
    if (row->kind == KIND_NUMBER || is_signed)
        (void)snprintf(text, sizeof text, "a whole number from %s%" PRIu32 " to %" PRIu32 "%s",
                       is_signed ? "-" : "", is_signed ? row->max : row->min, row->max, unit_of(value));
    else if (row->kind == KIND_PAIR)
        (void)snprintf(text, sizeof text, "%s, from %" PRIu32 " to %" PRIu32, value, row->min, row->max);
    else if (row->kind == KIND_SET)
        (void)snprintf(text, sizeof text, "numbers from %" PRIu32 " to %" PRIu32 ", each once, such as 1,2",
                       row->min, row->max);
    else if (row->kind == KIND_STRING)
        (void)snprintf(text, sizeof text, "%s of 1 to %zu characters", value, row->size - 1);
    else if (row->words != NULL)
        takes_words(row->words, text, sizeof text);
    return text;
}

/* ---- the options of a command ---- */

bool arguments_have(const arguments_t *arguments, const char *name)
{
    return option_is_given(&arguments->given, arguments->command->tables, name);
}

/* Stores the value of the option that `walk` has found; NULL: it was left out. */
static bool set(arguments_t *arguments, const option_walk_t *walk, char *value)
{
    const option_t *const row = walk->row;
    char *const structure = (char *)arguments->settings + walk->table->at;
    char otherwise[8] = "";
    if (value == NULL && row->otherwise != NULL) {
        if (row->otherwise[0] == '\0') return *(bool *)(structure + row->has - 1) = true;
        value = strncpy(otherwise, row->otherwise, sizeof otherwise - 1);
    }
    return option_set(row, value != NULL ? value : otherwise, structure, &arguments->origin);
}

/* Reads the option in argv[*i], and its value behind it in the same word or, if it needs one, in the next. */
static bool read_option(arguments_t *arguments, int argc, char **argv, int *i)
{
    const option_table_t *const tables = arguments->command->tables;
    const origin_t *const origin = &arguments->origin;
    char *const word = argv[*i];
    const bool is_long = word[1] == '-';
    char *value = is_long ? strchr(word, '=') : NULL;
    option_walk_t walk;
    if (value != NULL) *value++ = '\0';
    if (!is_long && word[2] != '\0') value = word + 2;
    if (!option_find_word(&walk, tables, word))
        return is_long ? option_reject_unknown(tables, "option", word + 2, origin)
                       : reject(origin, "unknown option '%.2s'.", word);
    const option_t *const row = walk.row;
    if (row->instead != NULL)
        return reject(origin, "unknown option '--%s'. Did you mean --%s?", row->name, row->instead);
    if (row->kind == KIND_FLAG && value != NULL) return reject(origin, "--%s takes no value.", row->name);
    if (row->kind != KIND_FLAG && value == NULL && row->otherwise == NULL) {
        if (*i + 1 == argc) return reject(origin, "--%s needs a value: %s.", row->name, row->value);
        value = argv[++*i];
    }
    if (row->is_once && arguments->given.line[walk.number] != 0)
        return reject(origin, "--%s is given twice. Write the port behind a sensor instead: a16@PORT.",
                      row->name);
    arguments->given.line[walk.number] = 1;
    return set(arguments, &walk, value);
}

/* FATHOM_PORT stands for --port. */
static bool read_environment(const arguments_t *arguments)
{
    option_walk_t walk;
    char *const port = getenv("FATHOM_PORT"); /* NOLINT(concurrency-mt-unsafe): one thread */
    if (port == NULL || port[0] == '\0' || !option_find(&walk, arguments->command->tables, "port") ||
        arguments->given.line[walk.number] != 0)
        return true;
    return option_set(walk.row, port, (char *)arguments->settings + walk.table->at, &arguments->origin);
}

/* A word such as -15 is a number. */
static bool is_option(const char *word)
{
    return word[0] == '-' && word[1] != '\0' && !(word[1] >= '0' && word[1] <= '9');
}

bool arguments_parse(arguments_t *arguments, const command_t *command, int argc, char **argv, void *settings)
{
    bool is_over = false;
    *arguments = (arguments_t){
        .command = command, .origin = {.command = command->name}, .settings = settings, .words = argv};
    for (int i = 1; i != argc; i++) {
        if (is_over || !is_option(argv[i])) {
            argv[arguments->count++] = argv[i];
        } else if (strcmp(argv[i], "--") == 0) {
            is_over = true;
        } else {
            arguments->wants_help = strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0;
            if (arguments->wants_help) return true;
            if (!read_option(arguments, argc, argv, &i)) return false;
        }
    }
    return option_check_given(command->tables, &arguments->given, &arguments->origin) &&
           read_environment(arguments);
}

/* ---- standard output ---- */

/* Of a file: where it ends. */
static off_t end_of_output(void)
{
    struct stat is;
    return fstat(STDOUT_FILENO, &is) == 0 && S_ISREG(is.st_mode) ? is.st_size : -1;
}

int output_flush(void)
{
    const off_t length = (off_t)__fpending(stdout);
    const off_t before = end_of_output();
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return 0;
    const int error = errno != 0 ? errno : EIO;
    /* A disk that is full takes a part of a row. It is taken back, unless another program has added to the file since. */
    const off_t now = end_of_output();
    const bool has_grown = before >= 0 && now > before && now - before < length;
    __fpurge(stdout); /* the other part */
    return has_grown && ftruncate(STDOUT_FILENO, before) != 0 ? errno : error;
}
