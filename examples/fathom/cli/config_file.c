/* SPDX-License-Identifier: MIT */
#include "cli/config_file.h"

#include <errno.h>
#include <string.h>

#include "cli/command.h"

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

/* Of UTF-8, which libyaml has made sure of: C0, DEL, and C1, U+0080 to U+009F. */
static bool is_printable(const unsigned char *text, size_t length)
{
    for (size_t i = 0; i != length; i++)
        if (text[i] < ' ' || text[i] == 0x7F || (text[i] == 0xC2 && text[i + 1] < 0xA0)) return false;
    return true;
}

/* What is wrong is printed, and what is right is explained: neither may drive a terminal. */
static bool are_printable(const config_file_t *file, const char *command)
{
    for (const yaml_node_t *node = file->document.nodes.start; node != file->document.nodes.top; node++) {
        if (node->type != YAML_SCALAR_NODE || is_printable(node->data.scalar.value, node->data.scalar.length))
            continue;
        config_file_at(file, node);
        (void)usage_error(command,
                          "a text has a character that cannot be printed, such as a tab; leave it out");
        usage_at(NULL);
        return false;
    }
    return true;
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
        if (is_good && config_file_top(file) != NULL &&
            (!is_last(&parser, command, path) || !are_printable(file, command))) {
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
    return node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

void config_file_at(const config_file_t *file, const yaml_node_t *node)
{
    usage_at_line(file->path, config_file_line(node));
}
