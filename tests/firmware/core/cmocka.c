/* SPDX-License-Identifier: MIT */
#include <cmocka.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* What this target leaves out, each as "FILE.CASE ", without ".c". */
static const char left_out[] = FATHOM_LEFT_OUT;

static jmp_buf failed;
static int is_running; /* a test, its set-up or what comes after it: there is somewhere to go */

void print_error(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
}

static void stop(const char *file, int line)
{
    printf("\n[   LINE   ] --- %s:%d: error: Failure!\n", file, line);
    if (is_running) longjmp(failed, 1);
}

void stand_in_true(int holds, const char *what, const char *file, int line)
{
    if (holds) return;
    printf("[  ERROR   ] --- %s", what);
    stop(file, line);
}

/* In hexadecimal, by halves: not every printf knows 64 bits. */
static void print_number(const char *before, uintmax_t number)
{
    const unsigned long high = (unsigned long)((number >> 32) & 0xFFFFFFFF);
    const unsigned long low = (unsigned long)(number & 0xFFFFFFFF);
    printf("%s0x", before);
    if (high != 0) printf("%lx", high);
    printf(high != 0 ? "%08lx" : "%lx", low);
}

void stand_in_equal(uintmax_t a, uintmax_t b, int wanted, const char *what, const char *file, int line)
{
    if ((a == b) == wanted) return;
    printf("[  ERROR   ] --- %s", what);
    print_number(": ", a);
    print_number(", ", b);
    stop(file, line);
}

void stand_in_range(uintmax_t a, uintmax_t least, uintmax_t most, const char *what, const char *file,
                    int line)
{
    if (a >= least && a <= most) return;
    printf("[  ERROR   ] --- %s", what);
    print_number(": ", a);
    print_number(" is not within ", least);
    print_number(" and ", most);
    stop(file, line);
}

void stand_in_memory(const void *a, const void *b, size_t size, int wanted, const char *file, int line)
{
    const unsigned char *const left = a, *const right = b;
    size_t at = 0;
    while (at != size && left[at] == right[at]) at++;
    if ((at == size) == wanted) return;
    printf("[  ERROR   ] --- the same up to byte %u of %u", (unsigned)at, (unsigned)size);
    if (at != size) printf(": 0x%02x, 0x%02x", left[at], right[at]);
    stop(file, line);
}

void stand_in_string(const char *a, const char *b, const char *file, int line)
{
    if (strcmp(a, b) == 0) return;
    printf("[  ERROR   ] --- \"%s\" is not \"%s\"", a, b);
    stop(file, line);
}

/* True when it passed. volatile: changed after setjmp, read after longjmp. */
static int passes(const struct CMUnitTest *test)
{
    void *volatile state = test->initial_state;
    volatile int is_set_up = 0;
    volatile int good = 0;
    is_running = 1;
    if (setjmp(failed) == 0) {
        void *now = state;
        is_set_up = test->setup_func == NULL || test->setup_func(&now) == 0;
        state = now;
        if (is_set_up) test->test_func(&now);
        state = now;
        good = is_set_up;
    }
    if (is_set_up && test->teardown_func != NULL) {
        void *now = state;
        if (setjmp(failed) != 0 || test->teardown_func(&now) != 0) good = 0;
    }
    is_running = 0;
    return good;
}

/* Whether "FILE.NAME " is among those to leave out, of a file as suite.c names it, with ".c". */
static int is_left_out(const char *file, const char *name)
{
    const size_t before = strlen(file) - 1; /* with the point */
    const size_t length = strlen(name);
    for (const char *at = strstr(left_out, name); at != NULL; at = strstr(at + 1, name))
        if (at[length] == ' ' && (size_t)(at - left_out) >= before && strncmp(at - before, file, before) == 0)
            return 1;
    return 0;
}

/* How many of that file are. */
static unsigned count_left_out(const char *file)
{
    unsigned count = 0;
    const size_t length = strlen(file) - 1; /* with the point */
    for (const char *at = left_out; at != NULL && *at != '\0'; at = strchr(at, ' ') + 1)
        count += strncmp(at, file, length) == 0;
    return count;
}

int _cmocka_run_group_tests(const char *file, const struct CMUnitTest *tests, size_t count,
                            int (*set_up)(void **state), int (*tear_down)(void **state))
{
    unsigned run = 0, passed = 0, to_leave_out = count_left_out(file);
    printf("[==========] Running %u test(s).\n", (unsigned)count);
    for (size_t i = 0; i != count; i++) {
        if (is_left_out(file, tests[i].name)) {
            to_leave_out--;
            printf("[ LEFT OUT ] %s\n", tests[i].name);
            continue;
        }
        printf("[ RUN      ] %s\n", tests[i].name);
        const int good = passes(&tests[i]);
        printf("[  %s ] %s\n", good ? "     OK" : "FAILED ", tests[i].name);
        run++;
        passed += good != 0;
    }
    if (to_leave_out != 0) print_error("[  FAILED  ] to leave out what is not there: %s\n", left_out);
    printf("[==========] %u test(s) run.\n", run);
    printf("[  PASSED  ] %u test(s).\n", passed);
    if (passed != run) printf("[  FAILED  ] %u test(s).\n", run - passed);
    return (int)(run - passed) + (to_leave_out != 0);
}
