/* SPDX-License-Identifier: MIT */
#ifndef JSON_H
#define JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* A writer of JSON that keeps the commas. A key is NULL for an element of an array and for the outermost value:
 *
 *     json_t json = {.to = stdout};
 *     json_begin(&json, NULL, '{');
 *     json_string(&json, "name", "tank");
 *     json_end(&json, '}');
 */
typedef struct {
    FILE *to;
    bool
        has_member; /* Invariant: true if the innermost object or array has a member, so that a comma comes first. */
} json_t;

/* Opens an object, if the bracket is '{', or an array, if the bracket is '['. */
void json_begin(json_t *json, const char *key, char bracket);

/* Closes the innermost object or array with '}' or ']'. */
void json_end(json_t *json, char bracket);

/* Writes a number, true, false or null, formatted as by printf. */
void json_value(json_t *json, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Writes a number, true, false or null that is text already. */
void json_number(json_t *json, const char *key, const char *digits);

/* Writes true or false. */
void json_flag(json_t *json, const char *key, bool flag);

/* Writes a string with its escapes, or null if `text` is NULL. */
void json_string(json_t *json, const char *key, const char *text);

/* Writes bytes as a string of hexadecimal numbers, "01 03 FF". */
void json_bytes(json_t *json, const char *key, const uint8_t *bytes, size_t count);

#endif
