/* SPDX-License-Identifier: MIT */
#ifndef GUEST_H
#define GUEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The first program of a machine in QEMU: it runs cases, each in a process of its own, tells on the console what came
 * of them, and turns the machine off. guest.py is at the other end of the console.
 */
typedef struct guest_case {
    const char *name;
    void (*run)(void);
    struct guest_case *next;
} guest_case_t;
void guest_add(guest_case_t *one);

/* GUEST_CASE(a_sentence) {...} defines a case. They run in the order of the files and in these; what is printed besides is
 * for the log. */
#define GUEST_CASE(its_name)                                                                                 \
    static void its_name(void);                                                                              \
    __attribute__((constructor)) static void add_##its_name(void)                                            \
    {                                                                                                        \
        static guest_case_t one = {.name = #its_name, .run = (its_name)};                                    \
        guest_add(&one);                                                                                     \
    }                                                                                                        \
    static void its_name(void)

/* Ends the case. */
void guest_fail(const char *file, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4), noreturn));

#define CHECK(condition) ((condition) ? (void)0 : guest_fail(__FILE__, __LINE__, "%s", #condition))

#define CHECK_INT(got, expected) guest_check_int(__FILE__, __LINE__, #got, (long)(got), (long)(expected))
void guest_check_int(const char *file, int line, const char *what, long got, long expected);

/* `text` has `part` in it. */
#define CHECK_SAYS(text, part) guest_check_says(__FILE__, __LINE__, (text), (part))
void guest_check_says(const char *file, int line, const char *text, const char *part);

/* low <= got <= high */
#define CHECK_WITHIN(got, low, high)                                                                         \
    guest_check_within(__FILE__, __LINE__, #got, (long)(got), (long)(low), (long)(high))
void guest_check_within(const char *file, int line, const char *what, long got, long low, long high);

/* Has the world outside do something (guest.py, do_...), and returns the number that it answers with, 0 if none. */
long guest_ask(const char *format, ...) __attribute__((format(printf, 1, 2)));

void guest_sleep_ms(unsigned ms);

/* Runs the tool with these words, and returns its exit status; `out` is what it printed, to both. */
int guest_tool(const char *words, char *out, size_t size);

/* Runs it in another process, as that user; returns what it returns (0..255). */
int guest_other_process(unsigned user, int (*run)(void *ctx), void *ctx);

#endif
