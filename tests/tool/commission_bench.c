/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getpid */
#include "commission_bench.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

site_t site;

void connect_next(void) { fathom_sim_attach(&bench.line, site.device[site.connected++], bench.clock.now_us); }

/* No hand is faster than the acknowledgement of the one before, which at its old address is byte for byte what sets the
 * address of the next one. */
static void idle(void *ctx, uint32_t max_us)
{
    fathom_sim_clock_idle(ctx, max_us);
    if (site.watch != NULL) site.watch();
    const bool is_due =
        site.connected != 0 && site.connected < site.count && site.device[site.connected - 1]->address != 1;
    if (!is_due) site.left_us = bench.clock.now_us;
    if (is_due && fathom_elapsed_us(bench.clock.now_us, site.left_us) > site.hand_us) connect_next();
}

static int write_and_note(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    if (site.asked != MOMENTS)
        site.asked_us[site.asked++] = fathom_elapsed_us(bench.clock.now_us, site.begin_us);
    return uart.write(ctx, bytes, length);
}

void site_begin(void)
{
    bench_begin();
    bench.tool.idle = idle;
    bench.tool.uart.write = write_and_note;
    memset(&site, 0, sizeof site);
    site.hand_us = 100 * MS;
    site.left_us = bench.clock.now_us;
    site.begin_us = bench.clock.now_us;
    (void)snprintf(site.record, sizeof site.record, "%s/fathom-commission-%d.txt",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", (int)getpid());
    (void)unlink(site.record);
}

int site_set_up(void **state)
{
    site_begin();
    return 0;
}

int site_tear_down(void **state)
{
    (void)unlink(site.record);
    return 0;
}

/* ---- units ---- */

void add_hps(fathom_sim_hps167s_config_t config)
{
    fathom_sim_hps167s_t *const hps = &site.unit[site.count].hps;
    config.scene = fathom_sim_fixed(&bench.scene);
    config.number = (uint8_t)site.count;
    config.seed = (uint32_t)site.count;
    fathom_sim_hps167s_init(hps, &config);
    site.device[site.count++] = &hps->device;
}

void add_hps_units(size_t count)
{
    while (site.count != count) add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
}

void add_a16_units(size_t count)
{
    while (site.count != count) {
        const fathom_sim_a16_config_t config = {.mode = FATHOM_SIM_A16_MODBUS,
                                                .seed = (uint32_t)site.count,
                                                .scene = fathom_sim_fixed(&bench.scene)};
        fathom_sim_a16_init(&site.unit[site.count].a16, &config);
        site.device[site.count] = &site.unit[site.count].a16.device;
        site.count++;
    }
    connect_next();
}

void add_a05_units(size_t count)
{
    while (site.count != count) {
        const fathom_sim_a05_config_t config = {.mode = FATHOM_SIM_A05_MODBUS,
                                                .seed = (uint32_t)site.count,
                                                .scene = fathom_sim_fixed(&bench.scene)};
        fathom_sim_a05_init(&site.unit[site.count].a05, &config);
        site.device[site.count] = &site.unit[site.count].a05.device;
        site.count++;
    }
    connect_next();
}

/* ---- runs ---- */

unsigned count_of(const char *text, const char *what)
{
    unsigned count = 0;
    for (const char *at = strstr(text, what); at != NULL; at = strstr(at + 1, what)) count++;
    return count;
}

const tool_run_t *commission(const char *more)
{
    const tool_run_t *const done =
        tool_run(&bench.tool, "commission %s --port line --record %s", more, site.record);
    unsigned written = 0;
    site.announced += count_of(done->out, "  writes ") + count_of(done->err, "  writes ");
    for (size_t i = 0; i != site.connected; i++) {
        const fathom_sim_device_t *const one = site.device[i];
        written += one->counters.writes;
        for (size_t j = 0; j != i; j++)
            if (site.device[j]->address == one->address)
                fail_msg("two units have address %u\n%s%s", one->address, done->out, done->err);
    }
    if (written > site.announced)
        fail_msg("%u writes, %u announced\n%s%s", written, site.announced, done->out, done->err);
    return done;
}

void expect(const tool_run_t *done, int status, const char *text)
{
    if (done->status != status || (strstr(done->out, text) == NULL && strstr(done->err, text) == NULL))
        fail_msg("exit status %d, not %d with '%s'\n%s%s", done->status, status, text, done->out, done->err);
}

const char *record_text(void)
{
    static char text[2048];
    FILE *const file = fopen(site.record, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    return text;
}

void write_record(const char *text)
{
    FILE *const file = fopen(site.record, "w");
    assert_non_null(file);
    (void)fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

unsigned writes(void)
{
    unsigned sum = 0;
    for (size_t i = 0; i != site.count; i++) sum += site.device[i]->counters.writes;
    return sum;
}
