/* SPDX-License-Identifier: MIT */
#include "publish/config_file.h"

#include <errno.h>
#include <string.h>

#include "shared/command.h"

/* libyaml counts lines from 0. */
static unsigned line_of(const yaml_mark_t *mark) { return (unsigned)mark->line + 1; }

static bool tell_wrong(const char *command, const char *path, const yaml_parser_t *parser)
{
    const bool is_bytes = parser->error == YAML_READER_ERROR;
    usage_at_line(path, is_bytes ? line_of(&parser->mark) : line_of(&parser->problem_mark));
    (void)usage_error(command, "this is no YAML: %s%s%s",
                      parser->problem != NULL ? parser->problem : "no memory",
                      parser->context != NULL ? " " : "", parser->context != NULL ? parser->context : "");
    usage_at(NULL);
    return false;
}

/* A second document in the same file would be dropped silently. */
static bool is_last(yaml_parser_t *parser, const char *command, const char *path)
{
    yaml_document_t more;
    if (!yaml_parser_load(parser, &more)) return tell_wrong(command, path, parser);
    const bool is_there = yaml_document_get_root_node(&more) != NULL;
    const unsigned line = line_of(&more.start_mark);
    yaml_document_delete(&more);
    if (!is_there) return true;
    usage_at_line(path, line);
    (void)usage_error(command, "a second document begins; put all into one, without a line of ---");
    usage_at(NULL);
    return false;
}

bool config_file_load(config_file_t *file, const char *command, const char *path)
{
    yaml_parser_t parser;
    FILE *const stream = fopen(path, "rb");
    if (stream == NULL) {
        (void)usage_error(command, "%s cannot be read: %s", path, strerror(errno));
        return false;
    }
    file->path = path;
    bool is_good = yaml_parser_initialize(&parser) != 0;
    if (is_good) {
        yaml_parser_set_input_file(&parser, stream);
        is_good = yaml_parser_load(&parser, &file->document) != 0 || tell_wrong(command, path, &parser);
        if (is_good && config_file_top(file) != NULL && !is_last(&parser, command, path)) {
            yaml_document_delete(&file->document);
            is_good = false;
        }
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

unsigned config_file_line(const yaml_node_t *node) { return line_of(&node->start_mark); }

const char *config_file_text(const yaml_node_t *node)
{
    if (node->type != YAML_SCALAR_NODE) return NULL;
    const char *const text = (const char *)node->data.scalar.value;
    return strlen(text) == node->data.scalar.length ? text : NULL;
}

void config_file_at(const config_file_t *file, const yaml_node_t *node)
{
    usage_at_line(file->path, config_file_line(node));
}
