/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_CMOCKA_H
#define FATHOM_TESTS_CMOCKA_H

#include <stddef.h>
#include <stdint.h>

/*
 * What our tests use of cmocka, for targets that it is not built for: the same names, arguments and comparisons, and
 * the lines that tests/checks/count.py counts. It needs setjmp and a stdout, and no heap. cmocka compares numbers as
 * uintmax_t, and so does this: -1 of an int16_t and -1 of an int are equal.
 */
struct CMUnitTest {
    const char *name;
    void (*test_func)(void **state);
    int (*setup_func)(void **state);
    int (*teardown_func)(void **state);
    void *initial_state;
};

/* Runs the tests of a file in order, but for those to leave out, and prints how many passed. Returns how many did not,
 * and one more when not all that are to be left out are there. A set-up that fails, with an assertion or by what it
 * returns, fails its test, which is then not run. A set-up of the group there is none. */
int _cmocka_run_group_tests(const char *file, const struct CMUnitTest *tests, size_t count,
                            int (*set_up)(void **state), int (*tear_down)(void **state));

/* The first that does not hold ends its test. */
#define assert_int_equal(a, b)                                                                               \
    stand_in_equal((uintmax_t)(a), (uintmax_t)(b), 1, #a " == " #b, __FILE__, __LINE__)
#define assert_int_not_equal(a, b)                                                                           \
    stand_in_equal((uintmax_t)(a), (uintmax_t)(b), 0, #a " != " #b, __FILE__, __LINE__)
#define assert_true(a)     stand_in_true(!!(a), #a, __FILE__, __LINE__)
#define assert_false(a)    stand_in_true(!(a), "!(" #a ")", __FILE__, __LINE__)
#define assert_non_null(a) stand_in_true((a) != NULL, #a " != NULL", __FILE__, __LINE__)
#define assert_null(a)     stand_in_true((a) == NULL, #a " == NULL", __FILE__, __LINE__)
#define assert_ptr_equal(a, b)                                                                               \
    stand_in_true((const void *)(a) == (const void *)(b), #a " == " #b, __FILE__, __LINE__)
#define assert_in_range(a, least, most)                                                                      \
    stand_in_range((uintmax_t)(a), (uintmax_t)(least), (uintmax_t)(most), #a, __FILE__, __LINE__)
#define assert_memory_equal(a, b, size)                                                                      \
    stand_in_memory((const void *)(a), (const void *)(b), size, 1, __FILE__, __LINE__)
#define assert_memory_not_equal(a, b, size)                                                                  \
    stand_in_memory((const void *)(a), (const void *)(b), size, 0, __FILE__, __LINE__)
#define assert_string_equal(a, b) stand_in_string(a, b, __FILE__, __LINE__)
#define fail()                    stand_in_true(0, "fail()", __FILE__, __LINE__)
#define fail_msg(...)             (print_error(__VA_ARGS__), print_error("\n"), fail())

void stand_in_equal(uintmax_t a, uintmax_t b, int wanted, const char *what, const char *file, int line);
void stand_in_true(int holds, const char *what, const char *file, int line);
void stand_in_range(uintmax_t a, uintmax_t least, uintmax_t most, const char *what, const char *file,
                    int line);
void stand_in_memory(const void *a, const void *b, size_t size, int wanted, const char *file, int line);
void stand_in_string(const char *a, const char *b, const char *file, int line);

__attribute__((format(printf, 1, 2))) void print_error(const char *format, ...);
#define print_message print_error

#endif
