/* SPDX-License-Identifier: MIT */
#include "cli/config_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- the file ---- */

/* libyaml counts lines from 0. */
static unsigned line_of(const yaml_mark_t *mark) { return (unsigned)mark->line + 1; }

origin_t config_file_at(const config_file_t *file, const yaml_node_t *node)
{
    origin_t origin = file->origin;
    origin.line = line_of(&node->start_mark);
    return origin;
}

static bool reject_yaml(const config_file_t *file, const yaml_parser_t *parser)
{
    origin_t origin = file->origin;
    origin.line = line_of(parser->error == YAML_READER_ERROR ? &parser->mark : &parser->problem_mark);
    return reject(&origin, "this is no YAML: %s%s%s.",
                  parser->problem != NULL ? parser->problem : "no memory", parser->context != NULL ? " " : "",
                  parser->context != NULL ? parser->context : "");
}

/* A second document in the same file would be ignored silently. */
static bool is_last(const config_file_t *file, yaml_parser_t *parser)
{
    yaml_document_t more;
    origin_t origin = file->origin;
    if (!yaml_parser_load(parser, &more)) return reject_yaml(file, parser);
    const bool is_there = yaml_document_get_root_node(&more) != NULL;
    origin.line = line_of(&more.start_mark);
    yaml_document_delete(&more);
    return !is_there ||
           reject(&origin, "a second document begins. Write all into one, without a line of ---.");
}

/* In UTF-8, which libyaml has checked: C0, DEL, and C1, U+0080 to U+009F. */
static bool is_printable(const unsigned char *text, size_t length)
{
    for (size_t i = 0; i != length; i++)
        if (text[i] < ' ' || text[i] == 0x7F || (text[i] == 0xC2 && text[i + 1] < 0xA0)) return false;
    return true;
}

/* Messages print texts of the file, which may not drive a terminal. */
static bool are_printable(const config_file_t *file)
{
    for (const yaml_node_t *node = file->document.nodes.start; node != file->document.nodes.top; node++) {
        if (node->type != YAML_SCALAR_NODE || is_printable(node->data.scalar.value, node->data.scalar.length))
            continue;
        const origin_t origin = config_file_at(file, node);
        return reject(&origin, "a text has a character that cannot be printed, such as a tab. Leave it out.");
    }
    return true;
}

static bool load(config_file_t *file, yaml_parser_t *parser)
{
    if (!yaml_parser_load(parser, &file->document)) return reject_yaml(file, parser);
    if (config_file_top(file) == NULL || (is_last(file, parser) && are_printable(file))) return true;
    yaml_document_delete(&file->document);
    return false;
}

bool config_file_load(config_file_t *file, const char *command, const char *path)
{
    yaml_parser_t parser;
    const origin_t origin = {.command = command};
    FILE *const stream = fopen(path, "rb");
    if (stream == NULL) return reject(&origin, "cannot read %s: %s.", path, strerror(errno));
    file->origin = (origin_t){.command = command, .file = path, .line = 1};
    bool is_good = yaml_parser_initialize(&parser) != 0;
    if (is_good) {
        yaml_parser_set_input_file(&parser, stream);
        is_good = load(file, &parser);
        yaml_parser_delete(&parser);
    }
    (void)fclose(stream);
    return is_good;
}

void config_file_free(config_file_t *file) { yaml_document_delete(&file->document); }

const yaml_node_t *config_file_top(config_file_t *file)
{
    return yaml_document_get_root_node(&file->document);
}

const yaml_node_t *config_file_node(config_file_t *file, int number)
{
    return yaml_document_get_node(&file->document, number);
}

/* ---- nodes ---- */

/* NULL: the node is no text, or an empty one without quotes. */
static char *text_of(const yaml_node_t *node)
{
    if (node->type != YAML_SCALAR_NODE) return NULL;
    if (node->data.scalar.length == 0 && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE) return NULL;
    return (char *)node->data.scalar.value;
}

static const char *shape_of(const yaml_node_t *node)
{
    if (node->type == YAML_SEQUENCE_NODE) return "a list";
    if (node->type == YAML_MAPPING_NODE) return "a map";
    return text_of(node) != NULL ? "a text" : "empty";
}

const yaml_node_t *config_file_find(config_file_t *file, const yaml_node_t *map, const char *key)
{
    if (map->type != YAML_MAPPING_NODE) return NULL;
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++) {
        const char *const text = text_of(config_file_node(file, pair->key));
        if (text != NULL && strcmp(text, key) == 0) return config_file_node(file, pair->value);
    }
    return NULL;
}

static bool append(char *text, size_t size, const char *more)
{
    const size_t length = strlen(text);
    return snprintf(text + length, size - length, "%s", more) < (int)(size - length);
}

/* NOLINTNEXTLINE(misc-no-recursion): libyaml limits the depth of a file */
bool config_file_print(config_file_t *file, const yaml_node_t *node, char *text, size_t size)
{
    if (node->type == YAML_SCALAR_NODE) return append(text, size, (const char *)node->data.scalar.value);
    if (node->type != YAML_MAPPING_NODE) return true;
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair != node->data.mapping.pairs.top;
         pair++)
        if (!config_file_print(file, config_file_node(file, pair->key), text, size) ||
            !append(text, size, "=") ||
            !config_file_print(file, config_file_node(file, pair->value), text, size) ||
            !append(text, size, ";"))
            return false;
    return true;
}

/* ---- maps by rows ---- */

static bool reject_shape(const option_t *row, const yaml_node_t *node, const origin_t *origin)
{
    return reject(origin, "%s is %s. It takes %s.", row->name, shape_of(node), option_takes(row));
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static bool read_map(config_file_t *file, const option_t *row, const yaml_node_t *node, char *structure)
{
    const option_table_t tables[] = {{row->keys, 0}, {NULL, 0}};
    option_given_t given = {{0}};
    origin_t origin = config_file_at(file, node);
    origin.within = row->name;
    if (!config_file_read(file, node, tables, structure + row->at, row->name, &given)) return false;
    if (row->has != 0) *(bool *)(structure + row->has - 1) = true;
    return row->check == NULL || row->check(structure + row->at, &origin);
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static bool read_value(config_file_t *file, const option_t *row, const yaml_node_t *node, char *structure,
                       const origin_t *origin)
{
    const bool is_map = node->type == YAML_MAPPING_NODE;
    char *const text = text_of(node);
    if (row->kind == KIND_NODE) {
        const void *const found = node;
        memcpy(structure + row->at, &found, sizeof found);
        return node->type == YAML_SEQUENCE_NODE || reject_shape(row, node, origin);
    }
    if (is_map && (row->kind == KIND_MAP || row->kind == KIND_KEYS))
        return read_map(file, row, node, structure);
    if (text == NULL || row->kind == KIND_MAP) return reject_shape(row, node, origin);
    if (!option_set(row, text, structure, origin)) return false;
    if (!row->is_path || access(text, R_OK) == 0) return true;
    return reject(origin, "%s: cannot read %s: %s.", row->name, text, strerror(errno));
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
static bool read_pair(config_file_t *file, const yaml_node_pair_t *pair, const option_table_t *tables,
                      char *structure, const char *within, option_given_t *given)
{
    const yaml_node_t *const key = config_file_node(file, pair->key);
    const char *const name = text_of(key);
    origin_t origin = config_file_at(file, key);
    option_walk_t walk;
    origin.within = within;
    if (name == NULL) return reject(&origin, "a key is %s. It takes a word.", shape_of(key));
    if (within != NULL && strcmp(within, "broker") == 0 && strcmp(name, "password") == 0)
        return reject(&origin,
                      "a password does not belong in this file. Write it to a file that only this user "
                      "can read, and here password-file: /etc/fathom/password.");
    if (!option_find(&walk, tables, name)) return option_reject_unknown(tables, "key", name, &origin);
    unsigned *const line = &given->line[walk.number];
    if (*line != 0) return reject(&origin, "%s is given twice, in line %u too.", name, *line);
    *line = origin.line;
    return read_value(file, walk.row, config_file_node(file, pair->value), structure + walk.table->at,
                      &origin);
}

/* NOLINTNEXTLINE(misc-no-recursion): as deep as the rows */
bool config_file_read(config_file_t *file, const yaml_node_t *map, const option_table_t *tables,
                      void *structure, const char *within, option_given_t *given)
{
    origin_t origin = config_file_at(file, map);
    origin.within = within;
    if (map->type != YAML_MAPPING_NODE)
        return reject(&origin, "this is %s. It takes a map, with a line for each key.", shape_of(map));
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair != map->data.mapping.pairs.top;
         pair++)
        if (!read_pair(file, pair, tables, structure, within, given)) return false;
    return option_check_given(tables, given, &origin);
}
