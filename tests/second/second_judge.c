/* SPDX-License-Identifier: MIT */
#include "second_judge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "suite.h"

judge_t judge;

static const char *const wording[REASONS] = {
    [BECAUSE_EXCEPTION] = "it answers with an exception",
    [BECAUSE_SILENT] = "it does not answer such a request",
    [BECAUSE_WARM_UP] = "it does not measure while it warms up",
    [BECAUSE_STARTING] = "it has just got power",
    [BECAUSE_SWITCHED] = "its first command only ends the automatic output",
    [BECAUSE_LATER] = "the new value counts from the next power-on",
    [BECAUSE_ECHOED] = "it acknowledges a value and does not take it",
    [BECAUSE_OTHER_VALUE] = "it takes another value than the one that was sent",
    [BECAUSE_OLD_TOLD] = "it tells the value in use and not the one that was set",
    [BECAUSE_HIT] = "a frame that nobody asked for ran into the request, or came for the answer",
    [BECAUSE_NO_DISTANCE] = "its value is no distance, or no temperature",
    [BECAUSE_RARE] = "its frames are farther apart than the deadline",
    [BECAUSE_FAILED] = "it has failed",
    [BECAUSE_STRENGTH] = "its strength of light has an exponent over 16",
    [BECAUSE_FEWER] = "it answers with fewer values than were asked for",
    [BECAUSE_FULL] = "what it sends unasked leaves no room for a request",
    [BECAUSE_QUEUED] = "it serves a trigger that came too early when its cycle is over",
    [BECAUSE_MISPRINT] = "it does what is most likely a misprint",
    [BECAUSE_NOTHING] = "UNEXPLAINED",
};

static int64_t chose(second_choice_t choice) { return second_choice(&judge.rig->device, choice); }
static second_kind_t kind(void) { return judge.rig->device.config.kind; }
static bool is_a05(void) { return kind() == SECOND_A05_UART || kind() == SECOND_A05_RS485; }
static bool is_hps(void) { return kind() == SECOND_HPS167S; }

static judge_row_t *row(void)
{
    for (size_t i = 0; i < judge.row_count; i++) {
        if (strcmp(judge.rows[i].name, judge.name) == 0) return &judge.rows[i];
    }
    assert_true(judge.row_count < JUDGE_ROWS);
    judge.rows[judge.row_count].name = judge.name;
    return &judge.rows[judge.row_count++];
}

static void begin_again(void)
{
    judge.log_begin = second_log_count(&judge.rig->device);
    judge.begin_us = judge.rig->now_us;
    judge.writes_begin = judge.rig->writes;
}

void judge_begin(const char *name)
{
    judge.name = name;
    begin_again();
}

static bool is_table(void) { return getenv("FATHOM_TABLE") != NULL; }

static void finding(const char *what, int status)
{
    if (is_table())
        print_message("kind %d seed %u at %u ms: %s: status %d: %s\n", kind(),
                      (unsigned)judge.rig->device.config.seed, (unsigned)(judge.rig->now_us / 1000),
                      judge.name, status, what);
    judge.wrong++;
}

/* What the log says of the time since the command began. */
typedef struct {
    bool exception, silent, echoed, unasked, noise, fault, reset, effect;
    unsigned settings, odd_values;
    uint64_t unasked_us; /* the newest of them */
    const second_event_t *setting;
} facts_t;

static bool is_odd(uint16_t value)
{
    if (is_hps()) return value > 30000 ? value < 65530 || value == 65535 : value == 0;
    return value == 0xFFFF || (value < 0xFFFD && value > (is_a05() ? 6000 : 16350));
}

static facts_t facts(void)
{
    const second_device_t *d = &judge.rig->device;
    facts_t f = {0};
    uint64_t from = judge.log_begin;
    for (; from > 0; from--) { /* frames that were on their way */
        const second_event_t *e = second_log_at(d, from - 1);
        if (e == NULL || e->time_us + 1000000 < judge.begin_us) break;
    }
    for (uint64_t i = from; i < second_log_count(d); i++) {
        const second_event_t *e = second_log_at(d, i);
        if (e == NULL) continue;
        bool since = i >= judge.log_begin;
        switch (e->kind) {
        case SECOND_EVENT_MEASUREMENT:
            f.unasked |= !e->asked;
            if (!e->asked && e->end_us + 100000 <= judge.rig->now_us) f.unasked_us = e->end_us;
            f.fault |= e->fault;
            for (size_t p = 0; p < SECOND_PROBES; p++)
                f.odd_values += (e->probes >> p & 1U) != 0 && is_odd(e->sent[p]) ? 1U : 0U;
            break;
        case SECOND_EVENT_SETTING:
            if (!since) break;
            f.settings++;
            f.setting = e;
            break;
        case SECOND_EVENT_REFUSED:
            if (!since) break;
            f.exception |= e->exception >= 1 && e->exception <= 4;
            f.silent |= e->exception == 0;
            f.echoed |= e->exception == 9;
            break;
        case SECOND_EVENT_NOISE:
        case SECOND_EVENT_DISCARDED:
            f.noise = true;
            break;
        case SECOND_EVENT_RESET:
            f.reset |= since;
            break;
        case SECOND_EVENT_EFFECT:
            f.effect |= since;
            break;
        case SECOND_EVENT_POWER:
        case SECOND_EVENT_ANSWER:
            break;
        }
    }
    return f;
}

static bool is_misprint(fathom_status_t status)
{
    bool is_frame = status == FATHOM_ERR_STALE || status == FATHOM_ERR_MALFORMED ||
                    status == FATHOM_ERR_CHECKSUM || status == FATHOM_ERR_NO_ANSWER;
    if (kind() == SECOND_A05_UART)
        return chose(CHOICE_a05_uart_parity) != 'N' && status != FATHOM_ERR_EXCEPTION;
    if (kind() == SECOND_A05_RS485 && judge.rig->last[0] == 0x55)
        return chose(CHOICE_a05_all_sum) != 0 || chose(CHOICE_a05_dyp_address_answer) != 0;
    return kind() < SECOND_A16_RS485 && chose(CHOICE_a16_start_bytes) != 1 && is_frame;
}

static bool first_only_switches(void)
{
    if (kind() == SECOND_A16_RS232) return chose(CHOICE_a16_first_command) != 0;
    return kind() == SECOND_A05_UART && chose(CHOICE_a05_first_command) != 0;
}

static bool is_later(uint16_t reg)
{
    if (reg == 0xAA03) return chose(CHOICE_a05_dyp_address_effect) != 0;
    if (is_hps()) return reg == 0x11 && chose(CHOICE_hps_baud_effect) == 2;
    return reg == 0x0200 && chose(CHOICE_mb_address_effect) != 0;
}

/* 13 characters with their gaps, and 3.5 characters, the request and 3.5 characters again. */
static bool leaves_no_room(void)
{
    int64_t character_us = 573, frame_us = 13 * character_us * (10 + chose(CHOICE_any_byte_gap_tenths)) / 10;
    bool is_on = is_hps() && chose(CHOICE_hps_unasked) != 0;
    return is_on && frame_us + 15 * character_us > chose(CHOICE_hps_unasked_us);
}

static bool is_queued(void)
{
    return kind() == SECOND_A16_PWM && chose(CHOICE_a16_early_trigger) == 2 &&
           chose(CHOICE_a16_trigger_at_power_on) != 0;
}

/* What was asked last went to an address at which it answers nothing. */
static bool is_unanswered(void)
{
    const uint8_t *last = judge.rig->last;
    if (is_hps()) return false;
    if (last[0] == 0x55) return last[2] == 0xFF && chose(CHOICE_a05_dyp_ff) == 0;
    if (last[0] == 0xFF) return chose(CHOICE_mb_ff_read) == 0;
    int64_t zero = chose(is_a05() ? CHOICE_a05_address_zero : CHOICE_a16_address_zero);
    return judge.rig->device.address == 0 && zero == 7;
}

static bool is_warming_up(void) { return is_hps() && second_hps_warming_up(&judge.rig->device); }

/* Why it did not answer, or not so that it could be understood. */
static reason_t why(fathom_status_t status)
{
    const facts_t f = facts();
    const second_device_t *d = &judge.rig->device;
    bool early = judge.rig->now_us < d->power_on_us + 3500000;
    if (status == FATHOM_ERR_EXCEPTION && f.exception)
        return is_warming_up() ? BECAUSE_WARM_UP : BECAUSE_EXCEPTION;
    if (status == FATHOM_ERR_WARMING_UP) return BECAUSE_WARM_UP;
    if (status == FATHOM_PENDING) return leaves_no_room() ? BECAUSE_FULL : BECAUSE_NOTHING;
    if (is_queued()) return BECAUSE_QUEUED;
    bool is_measured = status == FATHOM_ERR_MALFORMED || (status == FATHOM_ERR_STALE && f.unasked);
    if (is_measured && is_hps() && chose(CHOICE_hps_magnitude_exp) > 16) return BECAUSE_STRENGTH;
    if (is_measured && f.odd_values > 0) return BECAUSE_NO_DISTANCE;
    bool is_temperature = is_hps() && judge.rig->last[3] == 0x04;
    if (status == FATHOM_ERR_MALFORMED && is_temperature &&
        (chose(CHOICE_hps_temperature) & 0x7FFF) % 0x7FFF == 0)
        return BECAUSE_NO_DISTANCE;
    if (status == FATHOM_ERR_MALFORMED && is_a05() && chose(CHOICE_a05_past_end) == 7 &&
        judge.rig->last[2] == 0)
        return BECAUSE_FEWER;
    if (is_misprint(status)) return BECAUSE_MISPRINT;
    bool has_switched = !d->automatic && (kind() == SECOND_A16_RS232 || kind() == SECOND_A05_UART);
    if (status == FATHOM_ERR_STALE && has_switched) return BECAUSE_SWITCHED;
    if (status == FATHOM_ERR_STALE && (d->automatic || is_hps()) &&
        judge.rig->now_us >= f.unasked_us + 1900000)
        return early ? BECAUSE_STARTING : BECAUSE_RARE;
    if (status == FATHOM_ERR_NO_ANSWER && (f.silent || is_unanswered())) {
        if (is_warming_up()) return BECAUSE_WARM_UP;
        if (is_hps() && d->hps.failed) return BECAUSE_FAILED;
        return first_only_switches() && f.effect ? BECAUSE_SWITCHED : BECAUSE_SILENT;
    }
    if (status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_STALE) return BECAUSE_NOTHING;
    bool is_in_place = is_hps() && status == FATHOM_ERR_MALFORMED;
    if (f.unasked && (f.noise || is_in_place || status == FATHOM_ERR_CHECKSUM)) return BECAUSE_HIT;
    return early ? BECAUSE_STARTING : BECAUSE_NOTHING;
}

static void count(reason_t reason, fathom_status_t status)
{
    row()->runs++;
    row()->because[reason]++;
    if (reason == BECAUSE_NOTHING) finding("nothing explains it", status);
}

static void good(void)
{
    row()->runs++;
    row()->good++;
}

void judge_read(fathom_status_t status, bool is_right)
{
    if (judge.rig->writes != judge.writes_begin) finding("a read wrote", status);
    if (status == FATHOM_READY && !is_right) finding("it told something else than the device has", status);
    if (status == FATHOM_READY)
        good();
    else
        count(why(status), status);
}

static int64_t held(uint16_t reg, const hps_settings_t *set)
{
    const second_device_t *d = &judge.rig->device;
    switch (reg) {
    case 0x0A:
        return set->warm_s;
    case 0x10:
        return d->address;
    case 0x11:
        return set->baud_code >= 1 && set->baud_code <= 4 ? set->baud_code : 1;
    case 0x12:
        return set->auto_out;
    case 0x13:
        return set->termination;
    case 0x14:
        return set->offset;
    case 0x16:
        return set->filter;
    case 0x20:
        return set->reconnect_ms;
    case 0x0200:
    case 0xAA03:
        return is_later(reg) ? d->us.stored_address : d->address;
    case 0x0202:
        return d->automatic;
    case 0x0205:
        return d->us.polarity;
    case 0x0206:
        return d->us.threshold;
    case 0x0207:
        return d->us.type;
    default:
        return -1;
    }
}

int64_t judge_held(uint16_t reg) { return held(reg, &judge.rig->device.hps.set); }

int64_t judge_told_value(uint16_t reg)
{
    const hps_t *hps = &judge.rig->device.hps;
    return held(reg, chose(CHOICE_hps_reported) == 0 ? &hps->set : &hps->used);
}

/* Why the device says, or is, something else than what was written. */
static reason_t why_different(const facts_t *f, wanted_t wanted)
{
    if (f->settings > 0 && is_later(wanted.reg)) return BECAUSE_LATER;
    if (f->reset && chose(CHOICE_hps_reset_order) == 2) return BECAUSE_LATER;
    if (f->reset && chose(CHOICE_hps_reset_restart) != 0) return BECAUSE_STARTING;
    if (is_hps() && f->settings > 0 && chose(CHOICE_hps_reported) == 1) return BECAUSE_OLD_TOLD;
    if (f->settings > 0 && f->setting->new_value != wanted.value) return BECAUSE_OTHER_VALUE;
    if (f->echoed) return BECAUSE_ECHOED;
    return BECAUSE_NOTHING;
}

void judge_set(fathom_status_t status, bool is_written, wanted_t wanted)
{
    const facts_t f = facts();
    uint32_t writes = judge.rig->writes - judge.writes_begin;
    bool holds = judge_held(wanted.reg) == wanted.value;
    reason_t reason;
    if (writes > 1) finding("written more than once", status);
    if (status != FATHOM_ERR_BUSY && status != FATHOM_PENDING && is_written != (writes > 0))
        finding(is_written ? "'written', and it was not" : "'not written', and it was", status);
    switch (status) {
    case FATHOM_READY:
        if (writes == 0 && !holds) finding("'unchanged', and it is not so", status);
        if (writes > 0 && !holds && !wanted.acknowledged) finding("'made', and it is not so", status);
        if (writes > 0 && f.settings == 0 && !f.echoed && !f.reset)
            finding("'acknowledged', and it was not", status);
        good();
        return;
    case FATHOM_ERR_DIFFERS:
        if (writes == 0) finding("'it reads otherwise', and nothing was written", status);
        reason = why_different(&f, wanted);
        if (reason == BECAUSE_NOTHING && f.settings == 0) reason = why(FATHOM_ERR_NO_ANSWER);
        break;
    case FATHOM_ERR_UNCONFIRMED:
        if (writes == 0) finding("'not confirmed', and nothing was written", status);
        if (wanted.blind && writes == 1) {
            good();
            return;
        }
        reason = why_different(&f, wanted);
        if (reason == BECAUSE_NOTHING) reason = why(FATHOM_ERR_NO_ANSWER);
        if (reason == BECAUSE_NOTHING && !wanted.acknowledged) reason = why(FATHOM_ERR_MALFORMED);
        break;
    case FATHOM_ERR_EXCEPTION:
        if (f.settings > 0) finding("'refused', and it was taken", status);
        reason = why(status);
        break;
    default:
        if (f.settings > 0 && holds && !wanted.acknowledged && !is_later(wanted.reg))
            finding("an error, and it holds", status);
        reason = writes > 0 ? why_different(&f, wanted) : BECAUSE_NOTHING;
        if (reason == BECAUSE_NOTHING) reason = why(status);
        break;
    }
    count(reason, status);
}

/* The status that explains what happened. */
static fathom_status_t explained(void)
{
    static const fathom_status_t statuses[] = {FATHOM_ERR_EXCEPTION, FATHOM_ERR_NO_ANSWER,
                                               FATHOM_ERR_CHECKSUM,  FATHOM_ERR_MALFORMED,
                                               FATHOM_ERR_STALE,     FATHOM_PENDING};
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        if (why(statuses[i]) != BECAUSE_NOTHING) return statuses[i];
    }
    return FATHOM_ERR_NO_ANSWER;
}

void judge_told(told_t told, wanted_t wanted)
{
    bool wrote = judge.rig->writes != judge.writes_begin;
    bool says = told.not_written || told.not_confirmed || told.otherwise || told.refused;
    fathom_status_t status = told.made            ? FATHOM_READY
                             : told.not_confirmed ? FATHOM_ERR_UNCONFIRMED
                             : told.otherwise     ? FATHOM_ERR_DIFFERS
                             : told.refused       ? FATHOM_ERR_EXCEPTION
                                                  : explained();
    if (!told.made && !says) finding("it does not say what was written", status);
    judge_set(status, told.not_written ? false : says ? true : wrote, wanted);
}

void judge_done(bool is_good, bool is_right)
{
    judge_read(is_good ? FATHOM_READY : explained(), is_right);
    if (!is_right && !is_good) finding("it told something else than the device has", 1);
}

bool judge_was_sent(uint16_t value)
{
    for (uint64_t i = judge.log_begin; i < second_log_count(&judge.rig->device); i++) {
        const second_event_t *e = second_log_at(&judge.rig->device, i);
        for (size_t p = 0; e != NULL && e->kind == SECOND_EVENT_MEASUREMENT && p < SECOND_PROBES; p++) {
            if ((e->probes >> p & 1U) != 0 && e->sent[p] == value) return true;
        }
    }
    return false;
}

/* Is this the value of that probe in a frame which came at that time? */
static const second_event_t *source(const fathom_sample_t *sample)
{
    const rig_t *rig = judge.rig;
    uint32_t slack_us = rig->loop == RIG_WOKEN ? 2 : rig->loop == RIG_EVERY_1_MS ? 3000 : 45000;
    for (uint64_t i = second_log_count(&rig->device); i-- > 0;) {
        const second_event_t *e = second_log_at(&rig->device, i);
        if (e == NULL || e->time_us + 20000000 < rig->now_us) return NULL;
        if (e->kind != SECOND_EVENT_MEASUREMENT || (e->probes >> (sample->probe - 1) & 1U) == 0) continue;
        uint32_t later_us = fathom_elapsed_us(sample->time_us + 2, rig_clock_us(rig, e->end_us));
        if (later_us <= slack_us + 2 && e->sent[sample->probe - 1] == sample->raw) return e;
    }
    return NULL;
}

static const char *wrong_ultrasonic(const fathom_sample_t *s, const second_event_t *e)
{
    size_t p = s->probe - 1U;
    int32_t mm = e->true_mm[p];
    if ((e->fitted >> p & 1U) == 0) return "a probe that is not fitted";
    switch ((int)s->kind) {
    case FATHOM_TARGET:
        if (s->distance_mm != s->raw) return "another distance than was sent";
        if (mm == s->distance_mm) return NULL;
        if (mm != SECOND_NOTHING && !e->not_ready) return "another distance than is true";
        judge.from_device++; /* the value for nothing looks like a distance */
        return NULL;
    case FATHOM_NO_TARGET:
        if (s->raw != 0xFFFD && s->raw != 0xFFFE) return "no target, and nobody says so";
        return mm == SECOND_NOTHING || e->not_ready ? NULL : "no target, and there is one";
    case FATHOM_UNKNOWN:
        return s->raw == 0 ? NULL : "unknown, and it is not";
    default:
        return "no such kind";
    }
}

static const char *wrong_hps(const fathom_sample_t *s, const second_event_t *e)
{
    int64_t off = chose(CHOICE_hps_deviation_mm) + judge.rig->device.hps.used.offset;
    switch ((int)s->kind) {
    case FATHOM_TARGET:
        if (s->distance_mm != s->raw) return "another distance than was sent";
        if (e->fault || e->no_target) return "a distance, and there is none";
        if (e->true_mm[0] + off == s->distance_mm) return NULL;
        return e->true_mm[0] < 80 && s->distance_mm == 80 ? NULL : "another distance than is true";
    case FATHOM_NO_TARGET:
        if (!e->no_target && e->true_mm[0] + off >= 0) return "no target, and there is one";
        return e->fault ? "no target, and it has failed" : NULL;
    case FATHOM_FAULT: /* the abnormal packet, or its very bytes */
        for (size_t i = 3; i < 11; i++) {
            uint8_t expected = i == 5 || i == 6 ? 0x00 : 0xFF;
            if (i != 7 && e->raw[i] != expected) return "'failed', and nobody says so";
        }
        return NULL;
    case FATHOM_UNKNOWN:
        return s->raw >= 1 && s->raw < 80 ? NULL : "unknown, and it is not";
    default:
        return "no such kind";
    }
}

/* A level says what the device's own level is; a pulse was as wide, and what it means is so within 0.1 %, by which the
 * datasheet's two formulas differ. */
static const char *wrong_level(const fathom_sample_t *s)
{
    const second_device_t *d = &judge.rig->device;
    if (kind() != SECOND_A16_PWM)
        return s->kind == (second_output(d) ? FATHOM_NEAR : FATHOM_FAR) ? NULL
                                                                        : "another level than is there";
    for (uint64_t i = second_log_count(d); i-- > 0;) {
        const second_event_t *e = second_log_at(d, i);
        if (e == NULL || e->time_us + 1000000 < judge.rig->now_us) break;
        if (e->kind != SECOND_EVENT_MEASUREMENT || rig_clock_us(judge.rig, e->end_us) != s->time_us) continue;
        int32_t off_mm = (int32_t)s->distance_mm - e->true_mm[0];
        if (e->new_value != s->raw) return "another width than it was";
        if (e->no_target) return s->kind == FATHOM_NO_TARGET ? NULL : "nothing is there";
        if (s->kind != FATHOM_TARGET) return "a target is there";
        return off_mm * 1000 <= e->true_mm[0] + 1000 && off_mm * 1000 >= -e->true_mm[0] - 1000
                   ? NULL
                   : "another distance";
    }
    bool is_early = judge.rig->now_us < d->power_on_us + 3500000; /* it measures once by itself */
    if (s->kind == FATHOM_FAULT && s->raw == 0 && second_output(d) && (is_queued() || is_early)) return NULL;
    return "a pulse that was not sent";
}

void judge_sample(const fathom_sample_t *sample)
{
    judge.readings++;
    if (kind() >= SECOND_TALKERS) {
        const char *wrong = wrong_level(sample);
        if (wrong != NULL) finding(wrong, (int)sample->raw);
        return;
    }
    const second_event_t *e = source(sample);
    if (e == NULL) {
        finding("a reading that was not sent", (int)sample->raw);
        return;
    }
    const char *wrong = is_hps() ? wrong_hps(sample, e) : wrong_ultrasonic(sample, e);
    if (wrong != NULL) finding(wrong, (int)sample->raw);
}

void judge_measured(fathom_status_t status, const fathom_sample_t *sample)
{
    if (status == FATHOM_READY) judge_sample(sample);
    judge_read(status, true);
}

unsigned judge_poll(const char *name, const fathom_sensor_t *sensor, unsigned outcomes, uint64_t for_us)
{
    unsigned readings = 0;
    uint64_t end_us = judge.rig->now_us + for_us;
    judge_begin(name);
    while (outcomes > 0 && judge.rig->now_us < end_us) {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(sensor, &sample);
        if (status == FATHOM_PENDING) {
            rig_pass(judge.rig, fathom_due_us(sensor, 1));
            continue;
        }
        outcomes--;
        if (status == FATHOM_READY) {
            judge_sample(&sample);
            readings++;
        }
        judge_read(status, true);
        begin_again();
    }
    return readings;
}

static void print(void)
{
    for (int r = 0; r < REASONS; r++) print_message("%2d %s\n", r, wording[r]);
    print_message("%-34s %8s %8s", "command", "runs", "good");
    for (int r = 0; r < REASONS; r++) print_message(" %6d", r);
    print_message("\n");
    for (size_t i = 0; i < judge.row_count; i++) {
        const judge_row_t *at = &judge.rows[i];
        print_message("%-34s %8u %8u", at->name, at->runs, at->good);
        for (int r = 0; r < REASONS; r++) print_message(" %6u", at->because[r]);
        print_message("\n");
    }
    print_message("%u readings, %u with what the device itself calls a distance, %u findings\n",
                  judge.readings, judge.from_device, judge.wrong);
}

void judge_end(unsigned good_of_100)
{
    unsigned runs = 0, goods = 0;
    if (is_table()) print();
    for (size_t i = 0; i < judge.row_count; i++) {
        runs += judge.rows[i].runs;
        goods += judge.rows[i].good;
    }
    print_message("%u commands and measurements, %u came to what was wanted, %u wrong\n", runs, goods,
                  judge.wrong);
    assert_int_equal(judge.wrong, 0);
    assert_true(goods * 100 >= runs * good_of_100);
}
