/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_FILE_H
#define CONFIG_FILE_H

#include <stdbool.h>
#include <yaml.h>

/* A file of YAML in memory, and what is wrong with it: each message has the file and the line, and says what to write
 * instead. */

typedef struct {
    const char *path;
    yaml_document_t document;
} config_file_t;

/* False after saying why; then there is nothing to free. A text that cannot be printed is wrong. path stays where it is. */
bool config_file_load(config_file_t *file, const char *command, const char *path);
void config_file_free(config_file_t *file);

/* What stands at the top: of an empty file NULL. */
const yaml_node_t *config_file_top(config_file_t *file);

const yaml_node_t *config_file_node(config_file_t *file, int number);
unsigned config_file_line(const yaml_node_t *node);

/* Its text, which can be printed; NULL: it is none. */
const char *config_file_text(const yaml_node_t *node);

/* From now on wrong usage stands where this node does. */
void config_file_at(const config_file_t *file, const yaml_node_t *node);

#endif
