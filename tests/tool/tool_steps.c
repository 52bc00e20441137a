/* SPDX-License-Identifier: MIT */
#include "tool_steps.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 2048 };

steps_t steps;

static int32_t step_distance(void *ctx, uint8_t probe, uint32_t now_us)
{
    const uint32_t step = fathom_elapsed_us(now_us, UINT32_MAX - 1000000) / 1000000u;
    return steps.distance[step < steps.count ? step : steps.count - 1][probe - 1];
}

static const fathom_sim_scene_t scene = {step_distance, NULL};

static void pass(void *ctx, uint32_t max_us)
{
    const uint32_t began_us = bench.clock.now_us;
    const uint64_t before_us = steps.passed_us;
    fathom_sim_clock_idle(ctx, max_us < 1000 ? max_us : 1000);
    steps.passed_us += bench.clock.now_us - began_us;
    if (before_us < steps.off_us && steps.passed_us >= steps.off_us)
        fathom_sim_detach(&bench.line, steps.device, bench.clock.now_us);
    if (before_us < steps.on_us && steps.passed_us >= steps.on_us)
        fathom_sim_attach(&bench.line, steps.device, bench.clock.now_us);
}

void steps_begin(void)
{
    memset(&steps, 0, sizeof steps);
    bench_begin();
    bench.tool.idle = pass;
}

void steps_a16(uint8_t mode, const int32_t *distances, size_t count)
{
    steps_begin();
    assert_in_range(count, 1, STEPS);
    for (size_t i = 0; i != count; i++) steps.distance[i][0] = distances[i];
    steps.count = count;
    bench_a16((fathom_sim_a16_config_t){.mode = mode, .scene = scene});
    steps.device = &bench.a16.device;
}

void steps_a05(const int32_t rows[][4], size_t count)
{
    steps_begin();
    assert_in_range(count, 1, STEPS);
    memcpy(steps.distance, rows, count * sizeof rows[0]);
    steps.count = count;
    bench_a05((fathom_sim_a05_config_t){.address = 2, .scene = scene});
    steps.device = &bench.a05.device;
}

const tool_run_t *read_steps(const char *sensors, const char *options)
{
    return tool_run(&bench.tool, "read %s --interval 1000 --port line %s", sensors, options);
}

void expect_text(const tool_run_t *run, const char *expected)
{
    char got[TEXT] = "";
    size_t length = 0;
    for (const char *line = run->out; *line != '\0'; line = strchr(line, '\n') + 1) {
        const char *const rest = strstr(line, " s  ") + 4;
        length += (size_t)snprintf(got + length, TEXT - length, "%d %.*s\n", atoi(line),
                                   (int)(strchr(rest, '\n') - rest), rest);
        assert_true(length < TEXT);
    }
    if (strcmp(got, expected) != 0) fail_msg("\n%s\nis not\n%s%s", got, expected, run->err);
}

void expect_err(const tool_run_t *run, const char *text)
{
    if (strstr(run->err, text) == NULL) fail_msg("'%s' is not in\n%s%s", text, run->out, run->err);
}
