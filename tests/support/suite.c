/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include <stdbool.h>
#include <string.h>

enum { SUITE_TESTS = 256 }; /* of one file at most */

bool suite_ends_at_failure;
bool suite_is_long;

static suite_test_t *first;
static suite_test_t **end = &first;

void suite_add(suite_test_t *node, const suite_t *of, const char *file, const char *name,
               void (*function)(void **state), const void *row)
{
    node->test.name = name;
    node->test.test_func = function;
    node->test.setup_func = of->set_up;
    node->test.teardown_func = of->tear_down;
    memcpy(&node->test.initial_state, &row, sizeof row); /* which no test writes to */
    node->suite = of;
    node->file = file;
    *end = node;
    end = &node->next;
}

/* Without its folder. */
static const char *name_of(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static bool is_file(const char *path, const char *name)
{
    const char *const file = name_of(path);
    const size_t length = strlen(name);
    return strncmp(file, name, length) == 0 && strcmp(file + length, ".c") == 0;
}

static int run_once(const char *file, const struct CMUnitTest *tests, size_t count)
{
    if (!suite_ends_at_failure) return _cmocka_run_group_tests(file, tests, count, NULL, NULL);
    for (size_t i = 0; i != count; i++)
        if (_cmocka_run_group_tests(file, &tests[i], 1, NULL, NULL) != 0) return 1;
    return 0;
}

/* An argument of the program names a file, or is a part of a test's name. */
static bool is_named(const suite_test_t *test, const char *name)
{
    return is_file(test->file, name) || strstr(test->test.name, name) != NULL;
}

static bool is_chosen(const suite_test_t *test, int count, char *const *names)
{
    for (int i = 0; i != count; i++)
        if (is_named(test, names[i])) return true;
    return count == 0;
}

/* Runs the chosen tests of the file that `one` belongs to. At most one of the file's suites has rounds. */
static int run_file(const suite_test_t *one, int name_count, char *const *names)
{
    static struct CMUnitTest tests[SUITE_TESTS];
    const suite_t *rounds = one->suite;
    size_t count = 0;
    int failed = 0;
    for (const suite_test_t *test = first; test != NULL; test = test->next) {
        if (strcmp(test->file, one->file) != 0 || !is_chosen(test, name_count, names)) continue;
        if (count == SUITE_TESTS) return 1;
        tests[count++] = test->test;
        if (test->suite->begin_round != NULL) rounds = test->suite;
    }
    if (count == 0) return 0;
    const unsigned most = suite_is_long && rounds->long_rounds != 0 ? rounds->long_rounds : rounds->rounds;
    for (unsigned round = 0; round == 0 || round < most; round++) {
        if (rounds->begin_round != NULL) rounds->begin_round(round);
        failed += run_once(name_of(one->file), tests, count);
        if (failed != 0 && suite_ends_at_failure) break;
    }
    return failed;
}

/* Returns true if an earlier test belongs to the same file. */
static bool is_known(const suite_test_t *test)
{
    for (const suite_test_t *before = first; before != test; before = before->next)
        if (strcmp(before->file, test->file) == 0) return true;
    return false;
}

static bool is_anywhere(const char *name)
{
    for (const suite_test_t *test = first; test != NULL; test = test->next)
        if (is_named(test, name)) return true;
    return false;
}

int suite_run(int count, char *const *names)
{
    int failed = 0;
    if (first == NULL) {
        print_error("[  FAILED  ] this program has no tests\n");
        return SUITE_HAS_NO_SUCH_TEST;
    }
    for (int i = 0; i != count; i++) {
        if (is_anywhere(names[i])) continue;
        print_error("[  FAILED  ] no file and no test of this program is called %s\n", names[i]);
        return SUITE_HAS_NO_SUCH_TEST;
    }
    for (const suite_test_t *test = first; test != NULL; test = test->next) {
        if (is_known(test)) continue;
        failed += run_file(test, count, names);
        if (failed != 0 && suite_ends_at_failure) break;
    }
    return failed;
}
