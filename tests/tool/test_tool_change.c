/* SPDX-License-Identifier: MIT */
/* The loop gets another site while it runs: a line with the same text goes on, any other line is opened again. In simulated
 * time. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "cli/rows.h"
#include "reading/loop.h"

enum { WORDS = 4, TEXT = 256, CHANGES = 8 };

/* What was read of a sensor. */
typedef struct {
    uint64_t last_us;
    uint64_t longest_us; /* between two readings */
    unsigned count;
    unsigned failures;
} readings_t;

static struct {
    host_t inner;
    host_t host;
    loop_t loop;
    unsigned opened;
    unsigned closed;
    readings_t gate, door, tank;
    /* What is read from when on. */
    struct {
        const char *words;
        uint64_t at_us;
        bool is_urgent;
    } changes[CHANGES];
    size_t change_count;
    size_t changed;
    uint64_t changed_us; /* the last one */
    site_t next;
    bool is_changing;
    fathom_sim_hps167s_t second;
} rig;

static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    rig.opened++;
    return rig.inner.open(ctx, path, settings, port, uart);
}

static void close_port(void *ctx, fathom_posix_uart_t *port) { rig.closed++; }

static uint64_t now_us(void) { return rig.host.now_us(rig.host.ctx); }

/* ---- what is read ---- */

/* Each line's text is the words of its sensors. */
static void set(site_t *site, const char *text)
{
    char copy[TEXT];
    char *words[WORDS];
    char texts[WORDS][TEXT];
    int count = 0;
    *site = (site_t){.reconnect = true, .persists = true};
    (void)strcpy(copy, text);
    for (char *word = strtok(copy, " "); word != NULL; word = strtok(NULL, " ")) {
        (void)strcpy(texts[count], word);
        words[count++] = word;
    }
    assert_true(sensor_words(site, &(const sensor_defaults_t){.path = NULL}, words, count,
                             &(origin_t){.command = "publish"}));
    for (size_t i = 0; i != site->sensor_count; i++) {
        line_t *line = site->lines;
        while (&line->settings != site->sensors[i]->port) line = line->next;
        line_add_text(line, texts[i]);
        site->sensors[i]->settings.period_us = 100000;
        site->sensors[i]->settings.timeout_us = 1000000;
    }
}

static readings_t *readings_of(const char *name)
{
    return strcmp(name, "gate") == 0 ? &rig.gate : strcmp(name, "door") == 0 ? &rig.door : &rig.tank;
}

static void pass(readings_t *readings)
{
    const uint64_t now = now_us();
    if (now - readings->last_us > readings->longest_us) readings->longest_us = now - readings->last_us;
    readings->last_us = now;
}

static void take_reading(void *ctx, const reading_t *reading)
{
    readings_t *const readings = readings_of(reading->sensor->name);
    pass(readings);
    readings->count += reading->status == FATHOM_OK;
    readings->failures += reading->status != FATHOM_OK;
    assert_ptr_equal(reading->sensor, rig.loop.site.sensors[reading->sensor->number]);
}

static void take_notice(void *ctx, const notice_t *notice) {}

static uint32_t tick(void *ctx)
{
    enum { AGAIN_US = 500 };
    site_t old;
    if (!rig.is_changing && rig.changed != rig.change_count && now_us() >= rig.changes[rig.changed].at_us) {
        set(&rig.next, rig.changes[rig.changed].words);
        rig.is_changing = true;
    }
    if (rig.is_changing && loop_set_site(&rig.loop, &rig.next, rig.changes[rig.changed].is_urgent, &old)) {
        site_free(&old);
        rig.is_changing = false;
        rig.changed++;
        rig.changed_us = now_us();
    }
    return AGAIN_US;
}

static void change(uint64_t at_us, const char *words)
{
    rig.changes[rig.change_count].at_us = at_us;
    rig.changes[rig.change_count++].words = words;
}

static void run(const char *words, uint64_t end_us)
{
    static const sink_t sink = {take_reading, take_notice, tick};
    bench.tool.ctrl_c_us = end_us;
    loop_init(&rig.loop, &rig.host, &sink, NULL);
    set(&rig.loop.site, words);
    assert_true(loop_open(&rig.loop));
    loop_run(&rig.loop);
    loop_close(&rig.loop);
    loop_deinit(&rig.loop);
    assert_int_equal(rig.changed, rig.change_count);
}

/* An A16 at 1, HPS-167S at 7 and 8, on one line. */
static void begin(void)
{
    bench_begin();
    memset(&rig, 0, sizeof rig);
    rig.inner = rig.host = tool_host(&bench.tool);
    rig.host.open = open_port;
    rig.host.close = close_port;
    bench_a16((fathom_sim_a16_config_t){0});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    fathom_sim_hps167s_init(
        &rig.second, &(fathom_sim_hps167s_config_t){.address = 8, .scene = fathom_sim_fixed(&bench.scene)});
    fathom_sim_attach(&bench.line, &rig.second.device, bench.clock.now_us);
}

EACH_BEGINS(begin())

static const suite_t suite = {.set_up = begins};

/* Nothing failed, and the time from one reading to the next was at most longest_us, up to the end. */
static void expect_no_gap(readings_t *readings, uint64_t longest_us)
{
    pass(readings);
    assert_int_equal(readings->failures, 0);
    assert_in_range(readings->longest_us, 0, longest_us);
}

TEST(a_line_with_the_same_text_goes_on_and_stays_open)
{
    for (unsigned i = 0; i != CHANGES; i++)
        change(200000 + 101000 * i, "gate=hps167s:7@line door=hps167s:8@line");
    run("gate=hps167s:7@line door=hps167s:8@line", 1500000);
    expect_no_gap(&rig.gate, 150000);
    expect_no_gap(&rig.door, 150000);
    assert_int_equal(rig.opened, 1);
    assert_int_equal(rig.closed, 1);
}

/* A gap of an interval, and of the request that was pending: the A16 takes 0.5 s. */
TEST(a_line_with_another_sensor_is_opened_again_when_no_request_is_pending)
{
    for (unsigned i = 0; i != 4; i++)
        change(333333 + 1407003 * i,
               i % 2 == 0 ? "gate=hps167s:7@line tank=a16:1:modbus@line" : "gate=hps167s:7@line");
    run("gate=hps167s:7@line", 7000000);
    expect_no_gap(&rig.gate, 800000);
    assert_true(rig.tank.count >= 3);
    assert_int_equal(rig.tank.failures, 0);
    assert_int_equal(rig.opened, 5);
    assert_int_equal(rig.closed, 5);
}

/* The other line is another path to the same simulated port, so that its sensors respond too. */
TEST(a_line_that_is_not_named_any_more_is_closed_when_no_request_is_pending)
{
    change(1000000, "door=hps167s:8@other");
    run("tank=a16:1:modbus@line", 2000000);
    assert_int_equal(rig.opened, 2);
    assert_true(rig.changed_us > 1000000 && rig.changed_us < 1600000);
    assert_int_equal(rig.tank.failures, 0);
    assert_true(rig.door.count >= 3);
}

TEST(an_urgent_change_does_not_wait)
{
    change(1001000, "door=hps167s:8@other");
    rig.changes[0].is_urgent = true;
    run("tank=a16:1:modbus@line", 2000000);
    assert_in_range(rig.changed_us, 1001000, 1003000);
}
