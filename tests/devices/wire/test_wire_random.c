/* SPDX-License-Identifier: MIT */
/*
 * Everything at once, by chance: bytes at random times, random times of polling, random answers of the port,
 * another master, pauses, cancelled and restarted drivers. Every driver has an outcome within its bound, and no
 * reading is of another time or unit than the wire knows (user_poll() fails otherwise).
 */
#include <stdlib.h>

#include "wire_phases.h"
#include "wire_users.h"

enum {
    SECOND_US = 1000000,
    LONGEST_TURN_US = 60000,
    REQUESTS = 2,
    REQUEST_TIMEOUT_US = 150000,
    LONGEST_TIMEOUT_US = 300000
};

/* Drivers that share a line. */
typedef struct {
    user_kind_t kinds[3];
    unsigned count;
    /* False: the line is the driver's own, whose trigger is a break. It cannot know more than when it was polled. */
    bool is_shared;
    /* False: the line speaks two protocols, and recognises foreign requests of the newest request's protocol
     * alone. */
    bool knows_masters;
} site_t;

static const site_t sites[] = {
    {{USER_HPS167S}, 1, true, true},                     /* HPS-167S */
    {{USER_HPS167S, USER_HPS167S}, 2, true, true},       /* two HPS-167S */
    {{USER_HPS167S, USER_HPS167S_AUTO}, 2, true, true},  /* HPS-167S, another one that sends by itself */
    {{USER_A16_MODBUS, USER_A05_MODBUS}, 2, true, true}, /* A16 and A05 Modbus */
    {{USER_A05_DYP}, 1, true, true},                     /* A05 55 AA */
    {{USER_A05_DYP, USER_A16_MODBUS}, 2, true, true},    /* A05 55 AA and Modbus */
    {{USER_A16_AUTO}, 1, true, true},                    /* A16 auto */
    {{USER_A05_AUTO}, 1, true, true},                    /* A05 auto */
    {{USER_A16_AUTO, USER_A16_MODBUS}, 2, true, true},   /* A16 auto beside Modbus */
    {{USER_A16_CONTROLLED}, 1, false, true},             /* A16 controlled */
    {{USER_HPS167S_AUTO}, 1, true, true},                /* HPS-167S auto */
};
enum { SITES = sizeof sites / sizeof *sites };

static const site_t *site;
static desk_request_t requests[REQUESTS];
static bool is_queued[REQUESTS];
static bool is_noisy, has_master, is_shaky; /* what this run has */

static const fathom_line_settings_t settings = {.baud = 9600, .parity = FATHOM_PARITY_NONE, .stop_bits = 1};
static const fathom_line_settings_t impossible = {.baud = 0, .parity = FATHOM_PARITY_NONE, .stop_bits = 1};

/* ---- The other master ---- */

enum { FORMS = 4 };

static uint8_t forms[FORMS][WIRE_FRAME], lengths[FORMS];

static void choose_forms(void)
{
    static const char *const modbus[] = {"01 03 01 00 00 01", "01 10 02 05 00 02 04 00 01 00 02",
                                         "02 03 01 08 00 01", "01 06 02 05 00 02"};
    static const char *const hps[] = {"01 03 00 01 00 03", "01 10 00 20 00 02 04 00 00 00 B4",
                                      "02 03 00 02 00 04", "01 06 00 0A 00 05"};
    const char *const *const chosen = wire.byte_us == WIRE_BYTE_9600_US ? modbus : hps;
    for (unsigned i = 0; i != FORMS; i++) lengths[i] = wire_frame_of(chosen[i], forms[i]);
    wire.master = (wire_master_t){.forms = (const uint8_t(*)[WIRE_FRAME])forms,
                                  .lengths = lengths,
                                  .form_count = FORMS,
                                  .next_us = WIRE_NEVER};
}

/* Slower than the units: a master that sends two requests before one response is not covered. */
static void start_master(void)
{
    wire.master.period_us = 300000 + wire_random(700000);
    wire.master.spread_us = 100000;
    wire.master.next_us = wire.now_us + wire_random(300000);
}

/* ---- Begin ---- */

static void begin(unsigned run)
{
    site = &sites[run % SITES];
    users_forget();
    wire_open(user_byte_us(site->kinds[0]), run);
    wire.loses_bytes_when_broken = wire_one_in(2);
    wire.has_time_stamps = wire_one_in(4);
    wire.ring_size = wire_one_in(2) ? 64 : 0;
    is_noisy = wire_one_in(2);
    has_master = wire_one_in(2) && site->knows_masters;
    is_shaky = wire_one_in(2);
    if (has_master) wire.ring_size = 0;
    const unsigned echo = wire_random(4); /* Known off, known on, or to be found out. */
    wire.echoes = echo == 1 || echo == 2;
    desk_open((desk_parts_t)((has_master ? DESK_MASTERS : 0) | (wire_one_in(2) ? DESK_SENDERS : 0)), 5000,
              500);
    desk.config.echo = (uint8_t[]){FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON, FATHOM_LINE_ECHO_AUTO,
                                   FATHOM_LINE_ECHO_AUTO}[echo];
    desk.config.find_echo = fathom_line_find_echo;
    desk.config.count = phases_count;
    desk_init_line();
    phases_watch();
    desk.longest_turn_us = LONGEST_TURN_US;
    desk.request_count = REQUESTS;
    desk.request_retries = 2;
    for (unsigned i = 0; i != site->count; i++) {
        user_t *const user = user_add(site->kinds[i], (uint8_t)(i + 1), (uint8_t)wire_random(3));
        if (has_master && wire_one_in(2)) user->unit->when_busy = WIRE_TAKES_NEWER;
        if (user->kind != USER_HPS167S || wire_one_in(2)) continue;
        user->unit->period_us = 18519;
        user->unit->next_frame_us = wire.now_us;
    }
    choose_forms();
    memset(requests, 0, sizeof requests);
    memset(is_queued, 0, sizeof is_queued);
}

/* ---- What happens by chance ---- */

static void change_turns(void)
{
    static const wire_us_t turns_us[] = {200, 500, 1000, 2000, 5000, 10000, 20000, 30000, 50000};
    desk.turn_us = turns_us[wire_random(sizeof turns_us / sizeof *turns_us)];
    desk.jitter_us = wire_one_in(2) ? 0 : desk.turn_us / 10;
}

static void pause_program(void)
{
    const wire_us_t pause_us = !site->is_shared ? wire_random(FATHOM_LINE_LATE_US)
                               : wire_one_in(8) ? 60u * SECOND_US
                                                : 1000 + wire_random(3 * SECOND_US);
    users_slept(pause_us);
    for (unsigned i = 0; i != REQUESTS; i++) requests[i].begin_us += pause_us;
    wire_run(pause_us);
}

/* The port misbehaves, or works again. */
static void change_port(void)
{
    bool *const faults[] = {&wire.takes_no_bytes, &wire.fails_to_write,   &wire.fails_to_read,
                            &wire.never_sends,    &wire.refuses_settings, &wire.refuses_break};
    enum { FAULTS = sizeof faults / sizeof *faults };
    for (unsigned i = 0; i != FAULTS; i++) *faults[i] = false;
    if (wire_one_in(2)) *faults[wire_random(FAULTS)] = true;
    if (has_master)
        wire.fails_to_read = false; /* a request of another master that is lost is not covered (line.h) */
}

static void change_units(void)
{
    for (unsigned i = 0; i != user_count; i++) {
        wire_unit_t *const unit = users[i].unit;
        unit->lost_one_in = wire_one_in(3) ? 3 : 0;
        unit->cuts = wire_one_in(4) ? (uint8_t)(1 + wire_random(6)) : 0;
        unit->is_dead = wire_one_in(5);
        /* Later than the time-out, and earlier than twice the time-out. With another master: in time (line.h). */
        unit->late_one_in = has_master || !wire_one_in(3) ? 0 : 3;
        unit->late_us = users[i].timeout_us - unit->spread_us - 20000;
    }
}

static void change_noise(void)
{
    static const wire_us_t periods_us[] = {600, 1500, 4000, 20000, 70000, 300000};
    wire.noise.period_us = periods_us[wire_random(6)];
    wire.noise.spread_us = wire_one_in(2) ? 0 : wire.noise.period_us;
    wire.noise.is_constant = wire_one_in(4);
    wire.noise.next_us = wire_one_in(2) ? wire.now_us : WIRE_NEVER;
}

/* The program holds TX low for some turns. The queue waits meanwhile. */
static void hold_break(void)
{
    const wire_us_t begin_us = wire.now_us;
    (void)fathom_line_poll(&desk.line);
    const wire_us_t end_us = wire.now_us + 1000 + wire_random(100000);
    while (wire.now_us < end_us && fathom_line_break(&desk.line, true) != FATHOM_OK) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
    while (wire.now_us < end_us) {
        desk_turn();
        (void)fathom_line_poll(&desk.line);
    }
    wire.refuses_break = wire_one_in(2);
    while (fathom_line_break(&desk.line, false) != FATHOM_OK) {
        if (wire_one_in(20)) (void)fathom_line_break(&desk.line, true);
        phases_sample();
        desk_turn();
        (void)fathom_line_poll(&desk.line);
        if (wire.now_us > end_us + 3 * SECOND_US || wire_one_in(100))
            wire.refuses_break = wire.fails_to_write = false;
    }
    users_slept(wire.now_us - begin_us);
    for (unsigned i = 0; i != REQUESTS; i++) requests[i].begin_us += wire.now_us - begin_us;
}

/* A request beside the drivers', to a unit that may not exist. */
static void change_request(unsigned which)
{
    desk_request_t *const request = &requests[which];
    fathom_transaction_t *const transaction = &request->request.transaction;
    phases_sample();
    if (is_queued[which]) {
        fathom_line_cancel(&desk.line, transaction);
        is_queued[which] = false;
        if (wire_one_in(4)) hold_break(); /* perhaps while the request still leaves */
        return;
    }
    const uint8_t unit = (uint8_t)(1 + wire_random(4));
    if (wire_one_in(4))
        fathom_modbus_write_single_register(&request->request.message, wire_one_in(4) ? 0 : unit, 0x0030, 1);
    else
        fathom_modbus_read_holding_registers(&request->request.message, unit, 0x0030, 1, request->values);
    transaction->retries = (uint8_t)wire_random(3);
    transaction->timeout_us = REQUEST_TIMEOUT_US;
    transaction->line_settings = wire_one_in(3) ? &settings : wire_one_in(20) ? &impossible : NULL;
    request->begin_us = wire.now_us;
    is_queued[which] = fathom_modbus_client_submit(&desk.line, &request->request) == FATHOM_PENDING;
}

static void check_request(unsigned which)
{
    const desk_request_t *const request = &requests[which];
    if (!is_queued[which]) return;
    const wire_us_t bound_us =
        desk_bound_us(2 * REQUEST_TIMEOUT_US, desk.request_retries, REQUESTS - 1 + site->count);
    is_queued[which] = desk_status(request) == FATHOM_PENDING;
    if (!is_queued[which] || wire.now_us - request->begin_us <= bound_us) return;
    print_message("request: no outcome for %.3f s\n", (double)(wire.now_us - request->begin_us) / 1e6);
    fail_msg("no outcome within the bound");
}

static void restart(void)
{
    phases_sample();
    if (wire_one_in(4)) { /* the whole program */
        for (unsigned i = 0; i != user_count; i++) user_deinit(&users[i]);
        for (unsigned i = 0; i != REQUESTS; i++) {
            if (is_queued[i]) fathom_line_cancel(&desk.line, &requests[i].request.transaction);
            is_queued[i] = false;
        }
        phases_sample();
        /* A line that is initialised does not know that a response is due to a request before. */
        users_slept(2 * LONGEST_TIMEOUT_US);
        wire_run(2 * LONGEST_TIMEOUT_US);
        desk_init_line();
        phases_watch();
        /* The request of another master is perhaps among the bytes that the line has just dropped. */
        if (has_master) desk_run(LONGEST_TIMEOUT_US);
        for (unsigned i = 0; i != user_count; i++) user_init(&users[i]);
        return;
    }
    user_t *const user = &users[wire_random(user_count)];
    user_deinit(user);
    user_init(user);
}

static void happen(void)
{
    phases_sample();
    if (wire_one_in(200)) change_turns();
    if (wire_one_in(2000)) pause_program();
    if (wire_one_in(is_shaky ? 100 : 5000)) change_port();
    if (wire_one_in(500)) change_units();
    if (is_noisy && wire_one_in(500)) change_noise();
    if (has_master && wire_one_in(2000)) start_master();
    if (has_master && wire_one_in(4000)) wire.master.next_us = WIRE_NEVER;
    if (site->is_shared && wire_one_in(1000)) hold_break();
    if (site->is_shared && wire_one_in(60)) change_request(wire_random(REQUESTS));
    if (wire_one_in(3000)) restart();
    if (wire_one_in(3000)) wire.skew_us -= wire_random(50000);
    if (!has_master && wire_one_in(3000)) fathom_line_flush(&desk.line);
}

/* ---- The test ---- */

static void run_program(unsigned run, unsigned polls)
{
    begin(run);
    for (unsigned poll = 0; poll != polls; poll++) {
        happen();
        desk_turn();
        for (unsigned i = 0; i != user_count; i++) (void)user_poll(&users[i]);
        for (unsigned i = 0; i != REQUESTS; i++) check_request(i);
    }
}

TEST(by_chance_every_driver_has_outcomes_and_no_reading_is_wrong)
{
    /* 22 000 000 polls in full */
    enum { PROGRAMS = SITES * 100, POLLS = 20000, SHARE_PROGRAMS = SITES * 12, SHARE_POLLS = 6000 };
    unsigned ready[SITES] = {0};
    /* FATHOM_SEED=7 runs one program alone. */
    const char *const seed = getenv("FATHOM_SEED");
    const unsigned first = seed != NULL ? (unsigned)strtoul(seed, NULL, 10) : 0;
    const unsigned count = seed != NULL ? 1 : (unsigned)DESK_SHARE(PROGRAMS, SHARE_PROGRAMS);
    for (unsigned run = first; run != first + count; run++) {
        run_program(run, DESK_SHARE(POLLS, SHARE_POLLS));
        for (unsigned i = 0; i != user_count; i++) ready[run % SITES] += users[i].ready;
    }
    for (unsigned i = 0; i != SITES; i++) assert_true(ready[i] != 0 || seed != NULL);
}

TEST(the_phases_of_the_line_change_as_the_table_of_the_engine_states) { phases_expect_table(); }
