/* SPDX-License-Identifier: MIT */
#include "second_why.h"

static bool is_odd(uint16_t value)
{
    if (is_hps()) return value > 30000 ? value < 65530 || value == 65535 : value == 0;
    return value == 0xFFFF || (value < 0xFFFD && value > (is_a05() ? 6000 : 16350));
}

facts_t judge_facts(void)
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
        case SECOND_EVENT_RESPONSE:
            break;
        }
    }
    return f;
}

static bool is_misprint(fathom_status_t status)
{
    bool is_frame = status == FATHOM_ERR_STALE || status == FATHOM_ERR_MALFORMED ||
                    status == FATHOM_ERR_CHECKSUM || status == FATHOM_ERR_NO_RESPONSE;
    if (kind() == SECOND_A05_UART)
        return chose(CHOICE_a05_uart_parity) != 'N' && status != FATHOM_ERR_EXCEPTION;
    if (kind() == SECOND_A05_RS485 && judge.rig->last[0] == 0x55)
        return chose(CHOICE_a05_all_sum) != 0 || chose(CHOICE_a05_dyp_address_response) != 0;
    return kind() < SECOND_A16_RS485 && chose(CHOICE_a16_start_bytes) != 1 && is_frame;
}

static bool first_only_switches(void)
{
    if (kind() == SECOND_A16_RS232) return chose(CHOICE_a16_first_command) != 0;
    return kind() == SECOND_A05_UART && chose(CHOICE_a05_first_command) != 0;
}

bool judge_is_later(uint16_t reg)
{
    if (reg == 0xAA03) return chose(CHOICE_a05_dyp_address_effect) != 0;
    if (is_hps()) return reg == 0x11 && chose(CHOICE_hps_baud_effect) == 2;
    return reg == 0x0200 && chose(CHOICE_mb_address_effect) != 0;
}

/* 13 characters with their gaps, and 3.5 characters, the request and 3.5 characters again. */
static bool leaves_no_room(void)
{
    int64_t character_us = 573, frame_us = 13 * character_us * (10 + chose(CHOICE_any_byte_gap_tenths)) / 10;
    bool is_on = kind() == SECOND_HPS167S && chose(CHOICE_hps_unasked) != 0;
    return is_on && frame_us + 15 * character_us > chose(CHOICE_hps_unasked_us);
}

bool judge_is_queued(void)
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

reason_t judge_why(fathom_status_t status)
{
    const facts_t f = judge_facts();
    const second_device_t *d = &judge.rig->device;
    bool early = judge.rig->now_us < d->power_on_us + 3500000;
    if (status == FATHOM_ERR_EXCEPTION && f.exception)
        return is_warming_up() ? BECAUSE_WARM_UP : BECAUSE_EXCEPTION;
    if (status == FATHOM_ERR_WARMING_UP) return BECAUSE_WARM_UP;
    if (status == FATHOM_PENDING) return BECAUSE_NOTHING; /* every wait ends */
    if (status == FATHOM_ERR_LINE_BUSY && leaves_no_room()) return BECAUSE_FULL;
    if (status == FATHOM_ERR_LINE_BUSY) return f.unasked && f.noise ? BECAUSE_HIT : BECAUSE_NOTHING;
    if (status == FATHOM_ERR_OTHER_MASTER) return BECAUSE_NOTHING; /* there is none */
    if (judge_is_queued()) return BECAUSE_QUEUED;
    bool is_measured = status == FATHOM_ERR_MALFORMED || (status == FATHOM_ERR_STALE && f.unasked);
    if (is_measured && is_hps() && chose(CHOICE_hps_magnitude_exp) > 16) return BECAUSE_STRENGTH;
    if (is_measured && f.odd_values > 0) return BECAUSE_NO_DISTANCE;
    bool is_temperature = kind() == SECOND_HPS167S && judge.rig->last[3] == 0x04;
    if (status == FATHOM_ERR_MALFORMED && is_temperature &&
        (chose(CHOICE_hps_temperature) & 0x7FFF) % 0x7FFF == 0)
        return BECAUSE_NO_DISTANCE;
    if (status == FATHOM_ERR_MALFORMED && is_a05() && chose(CHOICE_a05_past_end) == 7 &&
        judge.rig->last[2] == 0)
        return BECAUSE_FEWER;
    if (is_misprint(status)) return BECAUSE_MISPRINT;
    bool has_switched = !d->automatic && (kind() == SECOND_A16_RS232 || kind() == SECOND_A05_UART);
    if (status == FATHOM_ERR_STALE && has_switched) return BECAUSE_SWITCHED;
    /* stream.h, rule 5: bytes may have arrived meanwhile, as the first ones of the frame that comes too late. */
    const bool is_stale =
        status == FATHOM_ERR_STALE || (status == FATHOM_ERR_CHECKSUM && kind() != SECOND_HPS167S);
    if (is_stale && (d->automatic || is_hps()) && judge.rig->now_us >= f.unasked_us + 1900000)
        return early ? BECAUSE_STARTING : BECAUSE_RARE;
    if (status == FATHOM_ERR_NO_RESPONSE && (f.silent || is_unanswered())) {
        if (is_warming_up()) return BECAUSE_WARM_UP;
        if (is_hps() && d->hps.failed) return BECAUSE_FAILED;
        return first_only_switches() && f.effect ? BECAUSE_SWITCHED : BECAUSE_SILENT;
    }
    if (status == FATHOM_ERR_EXCEPTION || status == FATHOM_ERR_STALE) return BECAUSE_NOTHING;
    bool is_in_place = is_hps() && status == FATHOM_ERR_MALFORMED;
    if (f.unasked && (f.noise || is_in_place || status == FATHOM_ERR_CHECKSUM)) return BECAUSE_HIT;
    return early ? BECAUSE_STARTING : BECAUSE_NOTHING;
}
