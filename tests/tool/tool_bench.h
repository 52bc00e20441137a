/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TOOL_BENCH_H
#define FATHOM_TESTS_TOOL_BENCH_H

#include <stdio.h>

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"
#include "tool_run.h"

/* Simulated sensors on a line, and the tool at its other end. */
typedef struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t line;
    fathom_sim_uart_t uart;
    fathom_sim_fixed_t scene; /* what all of them see; 1234 mm at first */
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps167s;
    tool_line_t tool; /* for tool_run */
} tool_bench_t;

extern tool_bench_t bench;

/* An empty two-wire line; the clock wraps a second later. */
void bench_begin(void);

/* Hangs one on the line. A scene that is not given is bench.scene, a mode that is not given is Modbus. */
void bench_a16(fathom_sim_a16_config_t config);
void bench_a05(fathom_sim_a05_config_t config);
void bench_hps167s(fathom_sim_hps167s_config_t config);

/* Runs a command at bench.tool, which ends with this exit status. */
#define ASSERT_RUN(exit_status, ...)                                                                         \
    do {                                                                                                     \
        const tool_run_t *const asserted = tool_run(&bench.tool, __VA_ARGS__);                               \
        if (asserted->status != (exit_status))                                                               \
            fail_msg("exit status %d\n%s%s", asserted->status, asserted->out, asserted->err);                \
    } while (0)

/* Returns how often this part is in the text. */
unsigned count_of(const char *text, const char *part);

/* Runs a command that is refused: exit status 2, and one line on standard error, which has this text. */
void assert_refused(const char *line, const char *text);

/* A test of several of them: {line, text}, ... */
typedef struct {
    const char *line;
    const char *text;
} refused_t;

#define REFUSES(name, command, ...)                                                                          \
    TEST(name)                                                                                               \
    {                                                                                                        \
        const refused_t rows[] = {__VA_ARGS__};                                                              \
        for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {                                         \
            char line[1024];                                                                                 \
            (void)snprintf(line, sizeof line, "%s %s", command, rows[i].line);                               \
            assert_refused(line, rows[i].text);                                                              \
        }                                                                                                    \
    }

#endif
