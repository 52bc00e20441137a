/* SPDX-License-Identifier: MIT */
#include "cli/arguments.h"

#include <stdlib.h>
#include <string.h>

/* The long options that have a short one, in every command that has them. */
static const char *const lettered[] = {"help", "port", "quiet"};
enum { LETTERED = sizeof lettered / sizeof lettered[0] };

char argument_letter(const char *name)
{
    for (size_t i = 0; i != LETTERED; i++)
        if (strcmp(name, lettered[i]) == 0) return name[0];
    return '\0';
}

bool arguments_have(const arguments_t *arguments, const char *name)
{
    return option_is_given(&arguments->given, arguments->command->tables, name);
}

/* A word such as -15 is a number. */
static bool is_option(const char *word)
{
    return word[0] == '-' && word[1] != '\0' && !(word[1] >= '0' && word[1] <= '9');
}

/* Finds the row of an option, and the value that is in the same word, which is cut there; NULL: none is. */
static bool find(option_walk_t *walk, const option_table_t *tables, char *word, char **value)
{
    *value = NULL;
    if (word[1] == '-') {
        char *const equals = strchr(word, '=');
        if (equals != NULL) {
            *value = equals + 1;
            *equals = '\0';
        }
        return option_find(walk, tables, word + 2, strlen(word + 2));
    }
    for (*walk = (option_walk_t){.table = tables}; option_next(walk);) {
        if (argument_letter(walk->row->name) != word[1]) continue;
        if (word[2] != '\0') *value = word + 2;
        return true;
    }
    return false;
}

static bool reject_option(const option_table_t *tables, const char *word, const origin_t *origin)
{
    if (word[1] != '-') return reject(origin, "unknown option '%.2s'.", word);
    return option_reject_unknown(tables, "option", word + 2, origin);
}

/* Reads the option in argv[*i], and its value in the next word if it needs one. */
static bool read_option(arguments_t *arguments, int argc, char **argv, int *i, void *settings)
{
    const option_table_t *const tables = arguments->command->tables;
    const origin_t origin = {.command = arguments->command->name};
    option_walk_t walk;
    char *value = NULL;
    char otherwise[8] = "";
    if (!find(&walk, tables, argv[*i], &value)) return reject_option(tables, argv[*i], &origin);
    const option_t *const row = walk.row;
    if (row->instead != NULL)
        return reject(&origin, "unknown option '--%s'. Did you mean --%s?", row->name, row->instead);
    if (row->kind == KIND_FLAG && value != NULL) return reject(&origin, "--%s takes no value.", row->name);
    if (row->kind != KIND_FLAG && value == NULL && row->otherwise == NULL) {
        if (*i + 1 == argc) return reject(&origin, "--%s needs a value: %s.", row->name, row->value);
        value = argv[++*i];
    } else if (row->kind != KIND_FLAG && value == NULL) {
        value = strncpy(otherwise, row->otherwise, sizeof otherwise - 1);
    }
    if (row->is_once && arguments->given.line[walk.number] != 0)
        return reject(&origin, "--%s is given twice. Write the port behind a sensor instead: a16@PORT.",
                      row->name);
    arguments->given.line[walk.number] = 1;
    if (value == otherwise && value[0] == '\0') {
        *(bool *)((char *)settings + walk.table->at + row->has - 1) = true;
        return true;
    }
    return option_set(row, value, (char *)settings + walk.table->at, &origin);
}

/* FATHOM_PORT stands for --port. */
static bool read_environment(arguments_t *arguments, void *settings)
{
    const origin_t origin = {.command = arguments->command->name};
    option_walk_t walk;
    char *const port = getenv("FATHOM_PORT"); /* NOLINT(concurrency-mt-unsafe): one thread */
    if (port == NULL || port[0] == '\0' || !option_find(&walk, arguments->command->tables, "port", 4) ||
        arguments->given.line[walk.number] != 0)
        return true;
    return option_set(walk.row, port, (char *)settings + walk.table->at, &origin);
}

bool arguments_parse(arguments_t *arguments, const command_t *command, int argc, char **argv, void *settings)
{
    const origin_t origin = {.command = command->name};
    bool is_over = false;
    *arguments = (arguments_t){.command = command, .settings = settings, .words = argv};
    for (int i = 1; i != argc; i++) {
        if (is_over || !is_option(argv[i])) {
            argv[arguments->count++] = argv[i];
            continue;
        }
        if (strcmp(argv[i], "--") == 0) {
            is_over = true;
            continue;
        }
        arguments->wants_help = strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0;
        if (arguments->wants_help) return true;
        if (!read_option(arguments, argc, argv, &i, settings)) return false;
    }
    return option_check_given(command->tables, &arguments->given, &origin) &&
           read_environment(arguments, settings);
}
