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

static int32_t distance_of(const char *word)
{
    if (strncmp(word, "none", 4) == 0) return FATHOM_SIM_NO_TARGET;
    return strncmp(word, "fault", 5) == 0 ? FATHOM_SIM_FAULT : (int32_t)atoi(word);
}

static void add_step(const char *word)
{
    int32_t *const probes = steps.distance[steps.count++];
    for (size_t p = 0; p != 4; p++) {
        probes[p] = distance_of(word);
        if (strchr(word, ',') != NULL) word = strchr(word, ',') + 1;
    }
}

void steps_see(const char *sees, const char *words)
{
    char text[256];
    steps_begin();
    (void)strcpy(text, sees);
    for (const char *word = strtok(text, " "); word != NULL; word = strtok(NULL, " ")) {
        assert_in_range(steps.count, 0, STEPS - 1);
        if (word[0] != '@') add_step(word);
        if (word[0] != '@') continue;
        steps.off_us = strtoul(word + 1, NULL, 10) * 1000;
        steps.on_us = strtoul(strchr(word, '-') + 1, NULL, 10) * 1000;
    }
    if (steps.count == 0) return;
    if (strchr(sees, ',') != NULL) {
        bench_a05((fathom_sim_a05_config_t){.address = 2, .scene = scene});
        if (strncmp(words, "a16:1 ", 6) == 0) bench_a16((fathom_sim_a16_config_t){.address = 1});
        steps.device = &bench.a05.device;
    } else if (strncmp(words, "a16", 3) == 0) {
        const bool is_automatic = strncmp(words, "a16 ", 4) == 0;
        bench_a16((fathom_sim_a16_config_t){
            .mode = is_automatic ? FATHOM_SIM_A16_AUTO : FATHOM_SIM_A16_MODBUS, .scene = scene});
        steps.device = &bench.a16.device;
    } else {
        bench_hps167s((fathom_sim_hps167s_config_t){.scene = scene});
        steps.device = &bench.hps167s.device;
    }
}

const tool_run_t *read_steps(const char *words)
{
    return tool_run(&bench.tool, "read %s --port line %s", words,
                    strstr(words, "--interval") == NULL ? "--interval 1000" : "");
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
