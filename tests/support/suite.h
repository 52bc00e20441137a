/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SUITE_H
#define FATHOM_TESTS_SUITE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka wants those above first */
#include <cmocka.h>

/*
 * A file of tests is a suite. TEST(a_sentence) {...} defines one of its tests and registers it before main() starts.
 * All suites of a folder are linked into one program. PROGRAM [NAME ...] runs the tests of the files with these names
 * (without ".c") and the tests whose own names contain one of these words. Without a NAME the program runs all tests.
 * If FATHOM_FIRST_FAILURE is set in the environment, the program stops after the first test that fails.
 *
 * If the tests of a file share a set-up, the file defines it before them:
 * static const suite_t suite = {.set_up = set_up};
 */
typedef struct {
    int (*set_up)(void **state);    /* before each test; may be NULL */
    int (*tear_down)(void **state); /* after each test; may be NULL */
    /* Called before each of `rounds` runs of all tests, with 0, 1, ...: where the clock starts, how slow the loop
     * is. */
    void (*begin_round)(unsigned round);
    unsigned rounds;      /* 0: one */
    unsigned long_rounds; /* where suite_is_long, if that is more */
} suite_t;

/* The set-up of a file whose tests all begin with that call: .set_up = begins */
#define EACH_BEGINS(call)                                                                                    \
    static int begins(void **state)                                                                          \
    {                                                                                                        \
        call;                                                                                                \
        return 0;                                                                                            \
    }

/* A file of C without a suite of its own has this one. */
#ifndef __cplusplus
static const suite_t suite;
#endif

typedef struct suite_test {
    struct CMUnitTest test;
    const suite_t *suite;
    const char *file; /* its path */
    struct suite_test *next;
} suite_test_t;

/* Adds a test, which runs with `row` in *state; the node is the program's from then on. */
void suite_add(suite_test_t *node, const suite_t *of, const char *file, const char *name,
               void (*function)(void **state), const void *row);

extern bool suite_ends_at_failure; /* false from the start */

/* FATHOM_LONG is in the environment: what is thinned out, because most of it looks at the same again, runs in full. */
extern bool suite_is_long;

enum { SUITE_HAS_NO_SUCH_TEST = -1 };

/* Runs the tests with these names, or all if `count` is 0. Returns the number of tests that failed, or
 * SUITE_HAS_NO_SUCH_TEST if a name stands for none. */
int suite_run(int count, char *const *names);

#define SUITE_ADD(of, name, function, row)                                                                   \
    __attribute__((constructor)) static void add_##name(void)                                                \
    {                                                                                                        \
        static suite_test_t node;                                                                            \
        suite_add(&node, &of, __FILE__, #name, function, row);                                               \
    }

/* A test with another suite_t of its file than `suite`. */
#define TEST_IN(of, name)                                                                                    \
    static void name(void **state);                                                                          \
    SUITE_ADD(of, name, name, NULL)                                                                          \
    static void name(void **state)

#define TEST(name) TEST_IN(suite, name)

/* A test that is this function of a void **state, with `row`, a pointer, in *state. */
#define TEST_ROW(name, function, row) SUITE_ADD(suite, name, function, row)

#endif
