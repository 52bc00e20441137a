/* SPDX-License-Identifier: MIT */
/* Sensors that come and go while others are read: the poll loop changes to other options, in simulated time. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "cli/sensor_words.h"
#include "reading/poll_change.h"
#include "reading/poll_loop.h"

enum { WORDS = 4, TEXT = 256, OUTCOMES = 400, CHANGES = 8 };

/* A reading, or a failure. */
typedef struct {
    char name[16];
    uint64_t time_us;
    fathom_status_t status;
} outcome_t;

static struct {
    host_t host;
    poll_loop_t loop;
    uint32_t last_us;
    uint64_t now_us;
    uint64_t end_us;
    unsigned opened;
    unsigned closed;
    outcome_t outcomes[OUTCOMES];
    size_t outcome_count;
    /* What is to be read from when on. */
    struct {
        const char *words;
        uint64_t at_us;
        bool is_urgent;
    } changes[CHANGES];
    size_t change_count;
    size_t changed;
    uint64_t changed_us; /* the last one */
    sensor_options_t next;
    bool is_next; /* it waits */
    fathom_sim_hps167s_t second;
} site;

/* ---- the machine ---- */

static uint64_t now_us(void *ctx)
{
    site.now_us += fathom_elapsed_us(bench.clock.now_us, site.last_us);
    site.last_us = bench.clock.now_us;
    return site.now_us;
}

static bool open_port(void *ctx, const char *path, const fathom_line_settings_t *settings,
                      fathom_posix_uart_t *port, fathom_uart_t *uart)
{
    uint8_t bytes[64];
    fathom_rx_t rx;
    memset(port, 0, sizeof *port);
    port->fd = -1;
    *uart = fathom_sim_uart(&bench.uart);
    site.opened++;
    assert_true(uart->set_line(uart->ctx, settings) >= 0);
    do memset(&rx, 0, sizeof rx);
    while (uart->read(uart->ctx, bytes, sizeof bytes, &rx) > 0);
    return true;
}

static void close_port(void *ctx, fathom_posix_uart_t *port) { site.closed++; }
static bool has_ended(void *ctx) { return now_us(ctx) >= site.end_us; }
static bool is_output_gone(void *ctx) { return false; }
static void attend(void *ctx, fathom_loop_t *loop) {}

static void sleep_for(void *ctx, fathom_loop_t *loop, uint32_t max_us)
{
    fathom_sim_clock_idle(&bench.clock, max_us != 0 ? max_us : 1);
    for (fathom_loop_source_t *source = loop->sources; source != NULL; source = source->next)
        fathom_loop_wake(source);
}

static void wait_for(void *ctx, int fd, short events, uint32_t max_us, bool watch_output)
{
    fathom_sim_clock_idle(&bench.clock, max_us != 0 ? max_us : 1);
}

/* ---- what is read ---- */

static void take(sensor_options_t *options, const sensor_options_t *beside, const char *text)
{
    static char copies[2][TEXT];
    static unsigned turn;
    static const sensor_defaults_t defaults;
    origin_t origins[WORDS];
    char *const copy = copies[turn++ % 2];
    char *words[WORDS];
    int count = 0;
    memset(options, 0, sizeof *options);
    options->beside = beside;
    (void)strcpy(copy, text);
    for (char *word = strtok(copy, " "); word != NULL; word = strtok(NULL, " ")) words[count++] = word;
    for (int i = 0; i != count; i++) origins[i] = (origin_t){.command = "publish"};
    assert_true(sensor_words(options, &defaults, words, count, origins));
    for (size_t i = 0; i != options->station_count; i++) {
        options->stations[i]->settings.period_us = 100000;
        options->stations[i]->settings.timeout_us = 1000000;
    }
    options->reconnect = true;
    options->persists = true;
}

static void note(const station_t *station, fathom_status_t status)
{
    if (site.outcome_count == OUTCOMES) return;
    outcome_t *const outcome = &site.outcomes[site.outcome_count++];
    (void)snprintf(outcome->name, sizeof outcome->name, "%.15s", station->name);
    outcome->time_us = now_us(NULL);
    outcome->status = status;
}

static bool take_sample(void *ctx, const station_t *station, const fathom_sample_t *sample)
{
    note(station, FATHOM_OK);
    return true;
}

static void take_failure(void *ctx, const failure_t *failure, const station_t *station)
{
    note(station, failure->status);
}

static void take_absence(void *ctx, const station_t *station) { note(station, FATHOM_ERR_PORT); }
static void take_remark(void *ctx, const station_t *station, const char *text) {}
static void take_port(void *ctx, const char *text, poll_port_state_t state) {}
static bool is_over(const void *ctx) { return false; }

static uint32_t tick(void *ctx)
{
    enum { AGAIN_US = 500 };
    if (!site.is_next && site.changed != site.change_count &&
        now_us(NULL) >= site.changes[site.changed].at_us) {
        take(&site.next, &site.loop.options, site.changes[site.changed].words);
        site.is_next = true;
    }
    if (site.is_next && poll_loop_change(&site.loop, &site.next, site.changes[site.changed].is_urgent)) {
        site.is_next = false;
        site.changed++;
        site.changed_us = now_us(NULL);
    }
    return AGAIN_US;
}

static void change(uint64_t at_us, const char *words)
{
    site.changes[site.change_count].at_us = at_us;
    site.changes[site.change_count++].words = words;
}

static void run(const char *words, uint64_t end_us)
{
    static const poll_loop_user_t user = {take_sample, take_failure, take_absence, take_remark,
                                          take_port,   tick,         is_over};
    site.end_us = end_us;
    poll_loop_begin(&site.loop, &site.host, &user, NULL);
    take(&site.loop.options, NULL, words);
    assert_true(poll_loop_open(&site.loop));
    poll_loop_run(&site.loop);
    poll_loop_close(&site.loop);
    assert_int_equal(site.changed, site.change_count);
}

/* An A16 at 1, HPS-167S at 7 and 8, on one line. */
static void begin(void)
{
    bench_begin();
    memset(&site, 0, sizeof site);
    site.last_us = bench.clock.now_us;
    site.host = (host_t){.open = open_port,
                         .close = close_port,
                         .now_us = now_us,
                         .has_ended = has_ended,
                         .is_output_gone = is_output_gone,
                         .wait = wait_for,
                         .loop = {.now_us = now_us, .sleep = sleep_for},
                         .attend = attend};
    bench_a16((fathom_sim_a16_config_t){0});
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 7});
    fathom_sim_hps167s_init(
        &site.second, &(fathom_sim_hps167s_config_t){.address = 8, .scene = fathom_sim_fixed(&bench.scene)});
    fathom_sim_attach(&bench.line, &site.second.device, bench.clock.now_us);
}

EACH_BEGINS(begin())

static const suite_t suite = {.set_up = begins};

/* ---- what came ---- */

static size_t count_of(const char *name, fathom_status_t status)
{
    size_t count = 0;
    for (size_t i = 0; i != site.outcome_count; i++)
        if (strcmp(site.outcomes[i].name, name) == 0 && site.outcomes[i].status == status) count++;
    return count;
}

/* Nothing has failed, and from one reading to the next there was no more than this. */
static void expect_no_gap(const char *name, uint64_t longest_us)
{
    uint64_t before_us = 0;
    for (size_t i = 0; i != site.outcome_count; i++) {
        const outcome_t *const outcome = &site.outcomes[i];
        if (strcmp(outcome->name, name) != 0) continue;
        if (outcome->status != FATHOM_OK || outcome->time_us - before_us > longest_us)
            fail_msg("%s: status %d after %u us", name, outcome->status,
                     (unsigned)(outcome->time_us - before_us));
        before_us = outcome->time_us;
    }
    assert_true(site.end_us - before_us <= longest_us);
}

/* An HPS-167S is asked each 100 ms and takes 20 at most; a request of the other one may be before it. */
TEST(a_sensor_that_stays_is_read_in_time_and_its_line_stays_open)
{
    for (unsigned i = 0; i != CHANGES; i++)
        change(333333 + 107003 * i,
               i % 2 == 0 ? "gate=hps167s:7@line door=hps167s:8@line" : "gate=hps167s:7@line");
    run("gate=hps167s:7@line", 2000000);
    expect_no_gap("gate", 150000);
    assert_in_range(count_of("gate", FATHOM_OK), 19, 21);
    assert_true(count_of("door", FATHOM_OK) >= 4);
    assert_int_equal(count_of("door", FATHOM_ERR_NO_RESPONSE), 0);
    assert_int_equal(site.opened, 1);
}

/* The A16 takes half a second, in which the other one waits. */
TEST(one_at_other_line_settings_comes_and_goes_in_the_middle_of_a_request)
{
    for (unsigned i = 0; i != CHANGES; i++)
        change(333333 + 707003 * i,
               i % 2 == 0 ? "gate=hps167s:7@line tank=a16:1:modbus@line" : "gate=hps167s:7@line");
    run("gate=hps167s:7@line", 7000000);
    expect_no_gap("gate", 700000);
    assert_true(count_of("tank", FATHOM_OK) >= 4);
    assert_int_equal(count_of("tank", FATHOM_ERR_NO_RESPONSE), 0);
    assert_int_equal(site.opened, 1);
}

/* It is another station then, and the response to the one before is not taken for its own. */
TEST(one_that_is_asked_otherwise_begins_anew_and_the_others_go_on)
{
    change(520000, "gate=hps167s:7@line tank=a16:1:modbus@line");
    change(2520000, "gate=hps167s:7@line pit=a16:1:modbus@line");
    run("gate=hps167s:7@line", 5000000);
    expect_no_gap("gate", 700000);
    assert_true(count_of("tank", FATHOM_OK) >= 2);
    assert_true(count_of("pit", FATHOM_OK) >= 2);
    assert_int_equal(count_of("pit", FATHOM_ERR_NO_RESPONSE), 0);
    assert_int_equal(site.opened, 1);
}

TEST(a_port_that_is_named_no_more_is_closed_when_no_request_is_under_way)
{
    change(1000000, "door=hps167s:8@other");
    run("tank=a16:1:modbus@line", 2000000);
    assert_int_equal(site.opened, 2);
    /* The A16 takes half a second at each. */
    assert_true(site.changed_us > 1000000 && site.changed_us < 1600000);
    assert_int_equal(count_of("tank", FATHOM_ERR_NO_RESPONSE), 0);
    assert_true(count_of("door", FATHOM_OK) >= 3);
}

TEST(an_urgent_change_does_not_wait)
{
    change(1001000, "door=hps167s:8@other");
    site.changes[0].is_urgent = true;
    run("tank=a16:1:modbus@line", 2000000);
    assert_in_range(site.changed_us, 1001000, 1003000);
}

TEST(nothing_that_is_the_same_is_touched)
{
    for (unsigned i = 0; i != CHANGES; i++)
        change(200000 + 101000 * i, "gate=hps167s:7@line door=hps167s:8@line");
    run("gate=hps167s:7@line door=hps167s:8@line", 1500000);
    expect_no_gap("gate", 150000);
    expect_no_gap("door", 150000);
    assert_int_equal(site.opened, 1);
    assert_int_equal(site.closed, 1);
}
