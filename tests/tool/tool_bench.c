/* SPDX-License-Identifier: MIT */
#include "tool_bench.h"

#include <string.h>

tool_bench_t bench;

void bench_begin(void)
{
    const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    memset(&bench, 0, sizeof bench);
    for (int i = 0; i != 4; i++) bench.scene.value[i] = 1234;
    fathom_sim_clock_init(&bench.clock, UINT32_MAX - 1000000, 0);
    fathom_sim_line_init(&bench.line, &settings, bench.clock.now_us);
    fathom_sim_uart_init(&bench.uart, &bench.line, &bench.clock);
    bench.uart.knows = 0; /* as a tty, which says nothing of single bytes */
    bench.tool = (tool_line_t){.uart = fathom_sim_uart(&bench.uart),
                               .clock = fathom_sim_clock(&bench.clock),
                               .idle = fathom_sim_clock_idle,
                               .ctx = &bench.clock};
}

void bench_a16(fathom_sim_a16_config_t config)
{
    if (config.mode == 0) config.mode = FATHOM_SIM_A16_MODBUS;
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.scene);
    fathom_sim_a16_init(&bench.a16, &config);
    fathom_sim_attach(&bench.line, &bench.a16.device, bench.clock.now_us);
}

void bench_a05(fathom_sim_a05_config_t config)
{
    if (config.mode == 0) config.mode = FATHOM_SIM_A05_MODBUS;
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.scene);
    fathom_sim_a05_init(&bench.a05, &config);
    fathom_sim_attach(&bench.line, &bench.a05.device, bench.clock.now_us);
}

void bench_hps167s(fathom_sim_hps167s_config_t config)
{
    if (config.scene.distance == NULL) config.scene = fathom_sim_fixed(&bench.scene);
    fathom_sim_hps167s_init(&bench.hps167s, &config);
    fathom_sim_attach(&bench.line, &bench.hps167s.device, bench.clock.now_us);
}

unsigned count_of(const char *text, const char *part)
{
    unsigned count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part)) count++;
    return count;
}

void assert_refused(const char *line, const char *text)
{
    const tool_run_t *const run = tool_run(&bench.tool, "%s", line);
    const char *const end = strchr(run->err, '\n');
    if (run->status != 2 || run->out[0] != '\0' || strncmp(run->err, "fathom", 6) != 0 ||
        strstr(run->err, text) == NULL || end == NULL || end[1] != '\0')
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
}
