/* SPDX-License-Identifier: MIT */
#ifndef WORDS_H
#define WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Numbers and lists as text. */

/* All of `text` is a decimal number from min to max, of at most 10 digits. No sign, no space. */
bool number_parse(const char *text, uint32_t min, uint32_t max, uint32_t *number);

/* A number, or two as in "2-9", the first not above the last. */
bool range_parse(const char *text, uint32_t min, uint32_t max, uint32_t *first, uint32_t *last);

/* Tenths as a decimal, such as -0.5. */
void tenths_text(char *text, size_t capacity, int32_t tenths);

/* Adds a word to a list of `capacity` bytes, as in "a16, a05". A word that does not fit is left out in part. */
void list_add(char *list, size_t capacity, const char *word);

/* Copies the next word of a list, cut to `capacity` bytes. Returns the text behind its separator; NULL: it was the last
 * word. */
const char *next_word(const char *list, char separator, char *word, size_t capacity);

/* Returns the length of word n of a list with blanks between them, and its start in *word. 0: there is none. */
size_t word_at(const char *words, size_t n, const char **word);

/* Finds the place of `text` among the words of such a list. */
bool word_find(const char *words, const char *text, uint32_t *n);

#endif
