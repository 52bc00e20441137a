/* SPDX-License-Identifier: MIT */
#ifndef WORDS_H
#define WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The exit statuses of every command. */
enum {
    STATUS_OK = 0,
    STATUS_FAILED = 1, /* the line, the port or the output failed */
    STATUS_USAGE = 2,
    STATUS_ALARM = 3 /* `fathom read --until-alarm` alone: an alarm is on */
};

/* Returns true if all that was printed on stdout is written. Otherwise prints that it is not. */
bool is_output_written(void);

/* Returns `size` bytes of zeros, or the bytes of `memory` in another size, for free(). If no memory is left, prints that
 * and ends the tool. */
void *allocate(size_t size);
void *reallocate(void *memory, size_t size);
void end_without_memory(void) __attribute__((noreturn));

/* Returns the value of a variable of the environment; "": it is not set. */
const char *environment(const char *name);

/* ---- numbers and lists ---- */

/* All of `text` is a decimal number from min to max, of at most 10 digits. No sign, no space. */
bool number_parse(const char *text, uint32_t min, uint32_t max, uint32_t *number);

/* A number, or two as in "2-9", the first not above the last. */
bool range_parse(const char *text, uint32_t min, uint32_t max, uint32_t *first, uint32_t *last);

/* Returns the part of a path behind its last slash. */
const char *last_part(const char *path);

/* Prints a number with `places` decimal places: -5 with one is -0.5. */
enum { DECIMAL_TEXT = 32 };
void decimal_text(char text[DECIMAL_TEXT], int64_t number, unsigned places);

/* Adds a word to a list of `capacity` bytes, as in "a16, a05". A word that does not fit is left out in part. */
void list_add(char *list, size_t capacity, const char *word);

/* Copies the next word of a list, cut to `capacity` bytes. Returns the text behind its separator; NULL: it was the last
 * word. */
const char *next_word(const char *list, char separator, char *word, size_t capacity);

/* Returns the length of word n of a list with blanks between them, and its start in *word. 0: there is none. */
size_t word_at(const char *words, size_t n, const char **word);

/* Finds the place of `text` among the words of such a list. */
bool word_find(const char *words, const char *text, uint32_t *n);

/* ---- times ---- */

/* The clock's 64 bits at a moment of which it gave the lower 32, in the last 71 minutes. What is up to half a minute in the
 * future, by another clock's stamp, is now. */
uint64_t time_extend(uint64_t now_us, uint32_t then_us);

/* Returns the moment that is age_us before utc_us, which a clock gave; 0: the clock was not set. A machine without a battery
 * for its clock starts in 1970; a clock that is before 2025 is older than this program. */
uint64_t utc_before(uint64_t utc_us, uint64_t age_us);

/* Writes "2025-11-21T09:43:12.123456Z", and returns it. NULL: utc_us is 0. */
enum { UTC_TEXT = 48 };
const char *utc_text(uint64_t utc_us, char text[UTC_TEXT]);

/* Writes "12 s" or "7 min 2 s", and returns it. */
enum { DURATION_TEXT = 32 };
const char *duration_text(uint64_t us, char text[DURATION_TEXT]);

#endif
