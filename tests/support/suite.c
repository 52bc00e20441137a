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

/* All tests of the file that this one is of. Of its suites at most one has rounds. */
static int run_file(const suite_test_t *one)
{
    static struct CMUnitTest tests[SUITE_TESTS];
    const suite_t *rounds = one->suite;
    size_t count = 0;
    int failed = 0;
    for (const suite_test_t *test = first; test != NULL; test = test->next) {
        if (strcmp(test->file, one->file) != 0) continue;
        if (count == SUITE_TESTS) return 1;
        tests[count++] = test->test;
        if (test->suite->begin_round != NULL) rounds = test->suite;
    }
    const unsigned most = suite_is_long && rounds->long_rounds != 0 ? rounds->long_rounds : rounds->rounds;
    for (unsigned round = 0; round == 0 || round < most; round++) {
        if (rounds->begin_round != NULL) rounds->begin_round(round);
        failed += run_once(name_of(one->file), tests, count);
        if (failed != 0 && suite_ends_at_failure) break;
    }
    return failed;
}

/* Whether an earlier test is of the same file. */
static bool is_known(const suite_test_t *test)
{
    for (const suite_test_t *before = first; before != test; before = before->next)
        if (strcmp(before->file, test->file) == 0) return true;
    return false;
}

int suite_run(int count, char *const *names)
{
    int failed = 0;
    for (int i = 0; i == 0 || i < count; i++) {
        bool is_there = false;
        for (const suite_test_t *test = first; test != NULL; test = test->next) {
            if (is_known(test) || (count != 0 && !is_file(test->file, names[i]))) continue;
            is_there = true;
            failed += run_file(test);
            if (failed != 0 && suite_ends_at_failure) return failed;
        }
        if (is_there) continue;
        print_error("[  FAILED  ] there are no tests in %s\n", count != 0 ? names[i] : "this program");
        failed++;
    }
    return failed;
}
