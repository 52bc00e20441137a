/* SPDX-License-Identifier: MIT */
#include "second_why.h"

#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

judge_t judge;

void judge_begin_again(void)
{
    judge.log_begin = second_log_count(&judge.rig->device);
    judge.begin_us = judge.rig->now_us;
    judge.writes_begin = judge.rig->writes;
}

void judge_begin(const char *name)
{
    judge.name = name;
    judge_begin_again();
}

void judge_finding(const char *what, int status)
{
    if (getenv("FATHOM_SEED") != NULL)
        print_message("kind %d seed %u at %u ms: %s: status %d: %s\n", kind(),
                      (unsigned)judge.rig->device.config.seed, (unsigned)(judge.rig->now_us / 1000),
                      judge.name, status, what);
    judge.wrong++;
}

static void count(reason_t reason, fathom_status_t status)
{
    judge.runs++;
    if (reason == BECAUSE_NOTHING) judge_finding("nothing explains it", status);
}

static void good(void)
{
    judge.runs++;
    judge.good++;
}

void judge_read(fathom_status_t status, bool is_right)
{
    if (judge.rig->writes != judge.writes_begin) judge_finding("a read wrote", status);
    if (status == FATHOM_OK && !is_right) judge_finding("it told something else than the device has", status);
    if (status == FATHOM_OK)
        good();
    else
        count(judge_why(status), status);
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
        return judge_is_later(reg) ? d->us.stored_address : d->address;
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
    if (f->settings > 0 && judge_is_later(wanted.reg)) return BECAUSE_LATER;
    if (f->reset && chose(CHOICE_hps_reset_order) == 2) return BECAUSE_LATER;
    if (f->reset && chose(CHOICE_hps_reset_restart) != 0) return BECAUSE_STARTING;
    if (is_hps() && f->settings > 0 && chose(CHOICE_hps_reported) == 1) return BECAUSE_OLD_TOLD;
    if (f->settings > 0 && f->setting->new_value != wanted.value) return BECAUSE_OTHER_VALUE;
    if (f->echoed) return BECAUSE_ECHOED;
    return BECAUSE_NOTHING;
}

void judge_set(fathom_status_t status, bool is_written, wanted_t wanted)
{
    const facts_t f = judge_facts();
    uint32_t writes = judge.rig->writes - judge.writes_begin;
    bool holds = judge_held(wanted.reg) == wanted.value;
    reason_t reason;
    if (writes > 1) judge_finding("written more than once", status);
    if (status != FATHOM_ERR_BUSY && status != FATHOM_PENDING && is_written != (writes > 0))
        judge_finding(is_written ? "'written', and it was not" : "'not written', and it was", status);
    switch (status) {
    case FATHOM_OK:
        if (writes == 0 && !holds) judge_finding("'unchanged', and it is not so", status);
        if (writes > 0 && !holds && !wanted.acknowledged) judge_finding("'made', and it is not so", status);
        if (writes > 0 && f.settings == 0 && !f.echoed && !f.reset)
            judge_finding("'acknowledged', and it was not", status);
        good();
        return;
    case FATHOM_ERR_DIFFERS:
        if (writes == 0) judge_finding("'it reads otherwise', and nothing was written", status);
        reason = why_different(&f, wanted);
        if (reason == BECAUSE_NOTHING && f.settings == 0) reason = judge_why(FATHOM_ERR_NO_RESPONSE);
        break;
    case FATHOM_ERR_UNCONFIRMED:
        if (writes == 0) judge_finding("'not confirmed', and nothing was written", status);
        if (wanted.blind && writes == 1) {
            good();
            return;
        }
        reason = why_different(&f, wanted);
        if (reason == BECAUSE_NOTHING) reason = judge_why(FATHOM_ERR_NO_RESPONSE);
        /* What is only acknowledged is not read back; what a reset has done is. */
        if (reason == BECAUSE_NOTHING && (!wanted.acknowledged || f.reset))
            reason = judge_why(FATHOM_ERR_MALFORMED);
        break;
    case FATHOM_ERR_EXCEPTION:
        if (f.settings > 0) judge_finding("'refused', and it was taken", status);
        reason = judge_why(status);
        break;
    default:
        if (f.settings > 0 && holds && !wanted.acknowledged && !judge_is_later(wanted.reg))
            judge_finding("an error, and it holds", status);
        reason = writes > 0 ? why_different(&f, wanted) : BECAUSE_NOTHING;
        if (reason == BECAUSE_NOTHING) reason = judge_why(status);
        break;
    }
    count(reason, status);
}

/* The status that explains what happened. */
static fathom_status_t explained(void)
{
    static const fathom_status_t statuses[] = {FATHOM_ERR_EXCEPTION, FATHOM_ERR_NO_RESPONSE,
                                               FATHOM_ERR_CHECKSUM,  FATHOM_ERR_MALFORMED,
                                               FATHOM_ERR_STALE,     FATHOM_ERR_LINE_BUSY};
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        if (judge_why(statuses[i]) != BECAUSE_NOTHING) return statuses[i];
    }
    return FATHOM_ERR_NO_RESPONSE;
}

void judge_report(report_t report, wanted_t wanted)
{
    bool wrote = judge.rig->writes != judge.writes_begin;
    bool says = report.not_written || report.not_confirmed || report.otherwise || report.refused;
    fathom_status_t status = report.made            ? FATHOM_OK
                             : report.not_confirmed ? FATHOM_ERR_UNCONFIRMED
                             : report.otherwise     ? FATHOM_ERR_DIFFERS
                             : report.refused       ? FATHOM_ERR_EXCEPTION
                                                    : explained();
    if (!report.made && !says) judge_finding("it does not say what was written", status);
    judge_set(status, report.not_written ? false : says ? true : wrote, wanted);
}

void judge_done(bool is_good, bool is_right)
{
    judge_read(is_good ? FATHOM_OK : explained(), is_right);
    if (!is_right && !is_good) judge_finding("it told something else than the device has", 1);
}

void judge_end(unsigned good_of_100)
{
    print_message("%u commands and measurements, %u came to what was wanted, %u wrong\n", judge.runs,
                  judge.good, judge.wrong);
    assert_int_equal(judge.wrong, 0);
    assert_true(judge.good * 100 >= judge.runs * good_of_100);
}
