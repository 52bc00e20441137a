/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* the tty's flags, and what Linux has besides */
#include "guest.h"

#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/wait.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { CASE_MOST_S = 15, CASE_FAILED = 1 };

static const char *running;

void guest_fail(const char *file, int line, const char *format, ...)
{
    const char *const name = strrchr(file, '/');
    va_list arguments;
    printf("FAILED %s: %s:%d: ", running, name != NULL ? name + 1 : file, line);
    va_start(arguments, format);
    (void)vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
    exit(CASE_FAILED);
}

void guest_check_int(const char *file, int line, const char *what, long got, long expected)
{
    if (got != expected) guest_fail(file, line, "%s is %ld, not %ld", what, got, expected);
}

void guest_check_says(const char *file, int line, const char *text, const char *part)
{
    if (strstr(text, part) == NULL) guest_fail(file, line, "\"%s\" does not say \"%s\"", text, part);
}

void guest_check_within(const char *file, int line, const char *what, long got, long low, long high)
{
    if (got < low || got > high)
        guest_fail(file, line, "%s is %ld, not within %ld and %ld", what, got, low, high);
}

long guest_ask(const char *format, ...)
{
    char answer[500];
    size_t length = 0;
    va_list arguments;
    printf("ask ");
    va_start(arguments, format);
    (void)vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
    for (char one; read(STDIN_FILENO, &one, 1) == 1 && one != '\n';)
        if (length + 1 < sizeof answer) answer[length++] = one;
    answer[length] = 0;
    if (strncmp(answer, "failed", 6) == 0) guest_fail(__FILE__, __LINE__, "%s: %s", format, answer);
    return strtol(answer, NULL, 0);
}

void guest_sleep_ms(unsigned ms)
{
    struct timespec left = {ms / 1000, (long)(ms % 1000) * 1000000};
    while (nanosleep(&left, &left) != 0 && errno == EINTR) continue;
}

int guest_other_process(unsigned user, int (*run)(void *ctx), void *ctx)
{
    int status = 0;
    const pid_t child = fork();
    if (child == 0) {
        if (user != 0 && (setgid(user) != 0 || setuid(user) != 0)) _exit(255);
        _exit(run(ctx));
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status));
    return WEXITSTATUS(status);
}

int guest_tool(const char *words, char *out, size_t size)
{
    char copy[200];
    char *arguments[32] = {"fathom"};
    size_t count = 1;
    size_t length = 0;
    int ends[2];
    int status = 0;
    (void)snprintf(copy, sizeof copy, "%s", words);
    for (char *word = strtok(copy, " "); word != NULL; word = strtok(NULL, " ")) arguments[count++] = word;
    CHECK_INT(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        (void)dup2(ends[1], STDOUT_FILENO);
        (void)dup2(ends[1], STDERR_FILENO);
        (void)close(ends[0]);
        (void)close(ends[1]);
        (void)execv("/fathom", arguments);
        _exit(127);
    }
    (void)close(ends[1]);
    for (ssize_t n = 1; n > 0 && length + 1 < size; length += (size_t)(n > 0 ? n : 0))
        n = read(ends[0], out + length, size - 1 - length);
    out[length] = 0;
    (void)close(ends[0]);
    CHECK(child > 0 && waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status));
    printf("fathom %s: %d\n%s\n", words, WEXITSTATUS(status), out);
    return WEXITSTATUS(status);
}

static void run_case(const guest_case_t *one)
{
    int status = 0;
    running = one->name;
    const pid_t child = fork();
    if (child == 0) {
        (void)setpgid(0, 0);
        (void)alarm(CASE_MOST_S); /* one that hangs is ended by its signal */
        one->run();
        exit(0);
    }
    (void)waitpid(child, &status, 0);
    (void)kill(-child, SIGKILL); /* what it has left behind, which may hold a port until it is gone */
    while (waitpid(-child, NULL, 0) > 0) continue;
    if (WIFSIGNALED(status))
        printf("FAILED %s: ended by signal %d%s\n", one->name, WTERMSIG(status),
               WTERMSIG(status) == SIGALRM ? ", it took too long" : "");
    else if (WEXITSTATUS(status) == 0)
        printf("ok %s\n", one->name);
    else if (WEXITSTATUS(status) != CASE_FAILED)
        printf("FAILED %s: ended with %d\n", one->name, WEXITSTATUS(status));
}

static guest_case_t *cases;
static guest_case_t **last = &cases;

void guest_add(guest_case_t *one)
{
    *last = one;
    last = &one->next;
}

int main(void)
{
    struct termios console;
    (void)mount("dev", "/dev", "devtmpfs", 0, NULL); /* it may be there */
    (void)mount("proc", "/proc", "proc", 0, NULL);
    (void)mount("sys", "/sys", "sysfs", 0, NULL);
    (void)setvbuf(stdout, NULL, _IOLBF, 0);
    if (tcgetattr(STDIN_FILENO, &console) == 0) {
        console.c_lflag &= ~(tcflag_t)ECHO;
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &console);
    }
    for (const guest_case_t *one = cases; one != NULL; one = one->next) run_case(one);
    printf("end\n");
    (void)tcdrain(STDOUT_FILENO);
    (void)reboot(RB_POWER_OFF);
    for (;;) (void)pause();
}
