/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): ftruncate */
#include "cli/command.h"

#include <errno.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- options ---- */

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
    char *value = is_long ? strchr(word, '=') : word + 2;
    option_walk_t walk;
    if (is_long && value != NULL) *value++ = '\0';
    if (!is_long && *value == '\0') value = NULL;
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
