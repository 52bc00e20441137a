/* SPDX-License-Identifier: MIT */
#ifndef CONFIG_FILE_H
#define CONFIG_FILE_H

#include <yaml.h>

#include "cli/option.h"

/* A YAML file in memory. */
typedef struct {
    origin_t origin; /* its command and path; the line is that of the last message */
    yaml_document_t document;
} config_file_t;

/* False after rejecting the file; then there is nothing to free. A text that cannot be printed is wrong. `path` is not
 * copied. */
bool config_file_load(config_file_t *file, const char *command, const char *path);
void config_file_free(config_file_t *file);

/* Reads a map by rows: each key stores its value in the structure. `within` names the map in messages; NULL: the file.
 * given: the lines of the keys. False after rejecting what is wrong. */
bool config_file_read(config_file_t *file, const yaml_node_t *map, const option_table_t *tables,
                      void *structure, const char *within, option_given_t *given);

/* The value of a key of a map; NULL: there is none. */
const yaml_node_t *config_file_find(config_file_t *file, const yaml_node_t *map, const char *key);

const yaml_node_t *config_file_top(config_file_t *file); /* NULL: the file is empty */
const yaml_node_t *config_file_node(config_file_t *file, int number);

/* Where a node stands. */
origin_t config_file_at(const config_file_t *file, const yaml_node_t *node);

/* Appends the text of a node, as one line, to `text` of `size` bytes. False: it is too long. */
bool config_file_print(config_file_t *file, const yaml_node_t *node, char *text, size_t size);

#endif
