/* SPDX-License-Identifier: MIT */
#include "rig.h"

#include <string.h>

#define BIT(kind) FATHOM_SIM_FAULT_BIT(FATHOM_SIM_FAULT_##kind)

enum { DYP_START = 0x55, DYP_ADDRESS = 2, NEIGHBOURS = 4, MAX_OUTCOMES = 64, MAX_IDLE_TURNS = 10000 };

/* Near the wrap of the clock, so that each run goes across it. */
static const uint32_t start_us = 0xFFFFFFFFu - 3000000u;

/* These change what the device says or when, and nothing may be lost by them. */
static const uint32_t harmless =
    BIT(STUCK) | BIT(INTERFERENCE) | BIT(FAULT) | BIT(NO_TARGET) | BIT(DELAY) | BIT(ECHO);
/* Frames may say the same then, or change places. */
static const uint32_t repeating =
    BIT(STUCK) | BIT(INTERFERENCE) | BIT(FAULT) | BIT(NO_TARGET) | BIT(DUPLICATE) | BIT(UNASKED);
/* FD and FE are sent behind FF, which may then pass for the beginning of a frame. */
static const uint32_t full_of_ff = BIT(INTERFERENCE) | BIT(NO_TARGET);
/* These make it another unit's word, or none on distances. */
static const uint32_t disguising = BIT(UNIT) | BIT(FUNCTION) | BIT(EXCEPTION);
/* Two of these in one frame are damage in two places. */
static const uint32_t damaging = BIT(UNIT) | BIT(FUNCTION) | BIT(COUNT) | BIT(EXCEPTION) | BIT(FLIP_BIT) |
                                 BIT(FLIP_BYTE) | BIT(DROP) | BIT(INSERT) | BIT(TRUNCATE) | BIT(TRAILING) |
                                 BIT(PARITY) | BIT(FRAMING) | BIT(OVERRUN) | BIT(SPLIT) | BIT(DUPLICATE) |
                                 BIT(POWER_CYCLE) | BIT(NOISE) | BIT(UNASKED) | BIT(BREAK) | BIT(ECHO);

static bool has_two(uint32_t set) { return (set & (set - 1)) != 0; }

static bool is_later(uint32_t a_us, uint32_t b_us) { return (int32_t)(a_us - b_us) > 0; }

/* ---- between device and faults ---- */

static int32_t look(void *ctx, uint8_t probe, uint32_t now_us)
{
    return truth_look(&((rig_unit_t *)ctx)->truth, probe);
}

static int32_t measured(void *ctx, uint8_t probe, int32_t value)
{
    rig_unit_t *const unit = ctx;
    value = unit->fault.hooks.measured(unit->fault.hooks.ctx, probe, value);
    truth_measured(&unit->truth, probe, value);
    return value;
}

/* How long the frame and what belongs to it keep the line and the device busy. */
static uint32_t busy_us(const rig_unit_t *unit, const fathom_sim_frame_t *frame)
{
    uint32_t us =
        frame->delay_us + frame->off_us + frame->length * (uint32_t)soak_facts[unit->setting].char_us;
    for (uint8_t i = 0; i < frame->paused; i++) us += frame->pauses[i].us;
    return us;
}

static void outgoing(void *ctx, fathom_sim_frame_t *frame)
{
    rig_unit_t *const unit = ctx;
    truth_entry_t *entry = truth_leaves(&unit->truth, frame->now_us);
    unit->fault.hooks.outgoing(unit->fault.hooks.ctx, frame);
    const uint32_t kinds = unit->fault.last_kinds;
    uint32_t end_us = frame->now_us + busy_us(unit, frame);
    /* An overrun is told with the next byte: a stream cannot know then where a frame begins, and the fault ends
     * with that frame. */
    if (!soak_is_asked(unit->setting) && (kinds & BIT(OVERRUN)) != 0)
        end_us += soak_facts[unit->setting].period_us +
                  (uint32_t)soak_facts[unit->setting].length * soak_facts[unit->setting].char_us;
    const bool is_adjacent = soak_facts[unit->setting].proof == SOAK_NO_GAP;
    const uint32_t damage = kinds & damaging;
    if (entry != NULL) {
        entry->is_hit = (kinds & ~harmless) != 0;
        entry->is_twice = (kinds & repeating) != 0;
        /* who streams is asked nothing: its value is as old as what it says */
        if (!soak_is_asked(unit->setting)) entry->measured_us += frame->delay_us;
        if ((kinds & disguising) != 0) truth_forget(entry);
    }
    /* An unsolicited frame was measured just now, as well. */
    entry = truth_leaves(&unit->truth, frame->now_us);
    if (entry != NULL) entry->is_hit = entry->is_twice = true;
    unit->under_way_us = end_us;
    if ((kinds & ~harmless) != 0 && is_later(end_us, unit->trouble_end_us)) unit->trouble_end_us = end_us;
    const bool is_near = is_adjacent && damage != 0 && unit->last_damage != 0;
    const bool is_full = (kinds & full_of_ff) != 0;
    if (has_two(damage) || is_near) unit->totals.joint++;
    if (is_adjacent && ((damage != 0 && (is_full || unit->last_full)) || (is_full && unit->last_damage != 0)))
        unit->totals.joint_full++;
    unit->last_damage = damage;
    unit->last_full = is_full;
    if (!soak_is_asked(unit->setting)) unit->totals.transactions++;
}

/* ---- the port, with the requests noted ---- */

static int port_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    rig_t *const rig = ctx;
    const int n = rig->inner.read(rig->inner.ctx, bytes, capacity, rx);
    const uint8_t marks = rx->flags & (FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN);
    if (n > 0) rig->bytes_read += (uint32_t)n;
    if (marks == FATHOM_RX_OVERRUN) rig->overruns_reported++;
    return n;
}

static int port_write(void *ctx, const uint8_t *bytes, size_t length)
{
    rig_t *const rig = ctx;
    const int n = rig->inner.write(rig->inner.ctx, bytes, length);
    const uint8_t address = bytes[0] == DYP_START ? bytes[DYP_ADDRESS] : bytes[0];
    for (uint8_t i = 0; n > 0 && i < rig->count; i++) {
        rig_unit_t *const unit = &rig->units[i];
        if (unit->address != address) continue;
        unit->requests++;
        unit->totals.transactions++;
        if (!unit->is_open) unit->open_us = rig->clock.now_us;
        unit->is_open = true;
    }
    return n;
}

static bool port_sent(void *ctx)
{
    const rig_t *const rig = ctx;
    return rig->inner.sent(rig->inner.ctx);
}

static uint32_t port_leaves_in_us(void *ctx)
{
    const rig_t *const rig = ctx;
    return rig->inner.leaves_in_us(rig->inner.ctx);
}

static int port_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const rig_t *const rig = ctx;
    return rig->inner.set_line(rig->inner.ctx, settings);
}

/* ---- set-up ---- */

void rig_init(rig_t *rig, uint8_t setting, uint32_t loop_us, uint8_t knows, const soak_options_t *options)
{
    const fathom_line_settings_t slow = {9600, FATHOM_PARITY_NONE, 1};
    const fathom_line_settings_t fast = {19200, FATHOM_PARITY_EVEN, 1};
    const bool is_fast = setting == SOAK_HPS167S;
    memset(rig, 0, sizeof *rig);
    rig->loop_us = loop_us;
    rig->options = *options;
    fathom_sim_clock_init(&rig->clock, start_us, 0);
    fathom_sim_line_init(&rig->wire, is_fast ? &fast : &slow, start_us);
    rig->wire.full_duplex = !soak_is_asked(setting);
    fathom_sim_uart_init(&rig->port, &rig->wire, &rig->clock);
    rig->port.knows = knows;
    rig->inner = fathom_sim_uart(&rig->port);
    rig->uart = (fathom_uart_t){.read = port_read,
                                .write = port_write,
                                .sent = port_sent,
                                .set_line = port_set_line,
                                .leaves_in_us = port_leaves_in_us,
                                .ctx = rig};
    rig->hal_clock = fathom_sim_clock(&rig->clock);
    rig->config = (fathom_line_parts_t){
        .uart = &rig->uart,
        .clock = &rig->hal_clock,
        .frame = rig->frame,
        .frame_size = RIG_FRAME,
        .find_echo = fathom_line_find_echo,
        .marks = fathom_line_marks,
        .senders = &fathom_line_senders,
        .masters = &fathom_line_masters,
        .count = fathom_line_count,
        .counters = rig->counters,
        .echo = options->echo,
        .silence_us = is_fast ? FATHOM_T3_5_US(19200, 11) : FATHOM_T3_5_US(9600, 10),
    };
    (void)fathom_line_init(&rig->line, &rig->config);
    rig->modbus = fathom_modbus_client(&rig->line);
}

rig_unit_t *rig_add(rig_t *rig, uint8_t setting, uint8_t address, uint32_t seed)
{
    rig_unit_t *const unit = &rig->units[rig->count];
    const fathom_sim_scene_t scene = {look, unit};
    unit->rig = rig;
    unit->setting = setting;
    unit->address = address;
    truth_init(&unit->truth, setting, rig->count);
    /* another part of the scene for each seed, the same for all on the line */
    if (rig->count == 0) rig->first_look = seed % 65536 * 127;
    unit->truth.looks = rig->first_look;
    unit->device = soak_device_init(&unit->model, setting, address, &scene, seed);
    fathom_sim_fault_init(&unit->fault, seed);
    unit->fault.clock = &rig->clock;
    fathom_sim_fault_attach(&unit->fault, &rig->wire, unit->device);
    unit->hooks = (fathom_sim_faults_t){.outgoing = outgoing, .measured = measured, .ctx = unit};
    unit->device->faults = &unit->hooks;
    fathom_sim_attach(&rig->wire, unit->device, rig->clock.now_us);
    unit->sensor = soak_driver_init(&unit->driver, setting, address, &rig->line, &rig->modbus, &rig->options);
    unit->wrong_sequence = -1;
    unit->outcome_us = unit->right_us = unit->trouble_end_us = unit->under_way_us = rig->clock.now_us;
    rig->sensors[rig->count++] = unit->sensor;
    return unit;
}

/* ---- what a driver says ---- */

static void judge(rig_unit_t *unit, const fathom_sample_t *sample)
{
    rig_t *const rig = unit->rig;
    const bool is_asked = soak_is_asked(unit->setting);
    const uint32_t now_us = rig->clock.now_us;
    /* A frame in doubt may wait for its successor until the stream is stale, which is counted from the turn of the
     * loop in which the one before was read, and looked at in the turn after it. */
    const soak_facts_t *const facts = &soak_facts[unit->setting];
    const uint32_t age_us =
        facts->timeout_us + facts->period_us + (uint32_t)facts->length * facts->char_us + 2 * rig->loop_us;
    const uint32_t since_us = is_asked ? unit->response_us : now_us - age_us;
    truth_verdict_t verdict = truth_judge(&unit->truth, sample, now_us, since_us, !is_asked);
    if (sample->address != (is_asked ? unit->address : 0)) verdict = TRUTH_DAMAGED;
    for (uint8_t i = 0; verdict == TRUTH_DAMAGED && i < rig->count; i++)
        if (&rig->units[i] != unit && truth_said(&rig->units[i].truth, (uint16_t)sample->raw))
            verdict = TRUTH_FOREIGN;
    unit->totals.verdicts[verdict]++;
    if (verdict == TRUTH_RIGHT) unit->right_us = now_us;
    /* A frame that passes by chance may have an old value in it; nothing else brings one to a stream. */
    const bool is_old = verdict == TRUTH_STALE && is_asked;
    if (is_old) unit->totals.old++;
    if (verdict == TRUTH_RIGHT || is_old || unit->wrong_sequence == sample->sequence) return;
    unit->totals.wrong_responses++;
    unit->wrong_sequence = sample->sequence;
}

/* Was it a fault of the transaction, or of nothing? Something must have been hit between the end of the transaction
 * before and now. */
static void explain(rig_unit_t *unit)
{
    if (!is_later(unit->open_us, unit->trouble_end_us)) return;
    unit->totals.unexplained++;
}

static void outcome(rig_unit_t *unit, fathom_status_t status, bool is_value, const fathom_sample_t *sample)
{
    const bool is_asked = soak_is_asked(unit->setting);
    unit->outcome_us = unit->rig->clock.now_us;
    unit->idle_turns = 0;
    if (status == FATHOM_OK || is_value) {
        if (unit->is_open || !is_asked) unit->response_us = unit->open_us;
        if (unit->is_open) unit->responses++;
        unit->is_open = false;
        unit->samples++;
        unit->timeouts_in_row = 0;
        if (status != FATHOM_OK) {
            unit->totals.errors++;
            unit->refused++;
            return;
        }
        unit->totals.readings++;
        judge(unit, sample);
        return;
    }
    unit->totals.errors++;
    if (!is_asked) return;
    unit->timeouts_in_row =
        status == FATHOM_ERR_NO_RESPONSE || status == FATHOM_ERR_ECHO ? unit->timeouts_in_row + 1 : 0;
    unit->failures++;
    if (!unit->is_open) unit->totals.unaccounted++; /* an outcome of nothing */
    unit->is_open = false;
    explain(unit);
}

/* Streams: frame n and those around it are history. */
static void watch(rig_unit_t *unit)
{
    truth_t *const truth = &unit->truth;
    while (unit->watched + 4 * NEIGHBOURS < truth->count) {
        const uint32_t n = unit->watched++;
        bool is_clean = n >= NEIGHBOURS && !truth_at(truth, n)->is_read && !truth_at(truth, n)->is_twice;
        for (uint32_t i = n - NEIGHBOURS; is_clean && i <= n + NEIGHBOURS; i++)
            is_clean = !truth_at(truth, i)->is_hit;
        if (is_clean) unit->clean_lost++;
    }
}

static void poll_unit(rig_unit_t *unit)
{
    for (uint8_t left = MAX_OUTCOMES;; left--) {
        fathom_sample_t sample;
        memset(&sample, 0xA5, sizeof sample);
        const uint16_t implausible = soak_implausible(&unit->driver, unit->setting);
        const fathom_status_t status = fathom_poll(&unit->sensor, &sample);
        if (status == FATHOM_PENDING) break;
        outcome(unit, status, implausible != soak_implausible(&unit->driver, unit->setting), &sample);
        if (left == 0) {
            unit->totals.stuck++; /* it never comes to an end */
            break;
        }
    }
    if (!soak_is_asked(unit->setting)) watch(unit);
    if (fathom_elapsed_us(unit->rig->clock.now_us, unit->outcome_us) > rig_patience_us(unit)) {
        unit->totals.stuck++;
        unit->outcome_us = unit->rig->clock.now_us;
    }
}

void rig_turn(rig_t *rig)
{
    for (uint8_t i = 0; i < rig->count; i++) poll_unit(&rig->units[i]);
    const uint32_t due_us = fathom_due_us(rig->sensors, rig->count);
    const uint32_t wire_us = fathom_sim_due_us(&rig->wire, rig->clock.now_us);
    uint32_t by_us = due_us < wire_us ? due_us : wire_us;
    if (due_us == FATHOM_NO_DEADLINE) rig->units[0].totals.stuck++;
    if (due_us == 0 && ++rig->units[0].idle_turns > MAX_IDLE_TURNS) {
        rig->units[0].totals.stuck++;
        rig->units[0].idle_turns = 0;
    }
    if (by_us < rig->loop_us || by_us == FATHOM_NO_DEADLINE) by_us = rig->loop_us;
    fathom_sim_clock_advance(&rig->clock, by_us);
}

void rig_run(rig_t *rig, uint32_t us)
{
    const uint32_t begin_us = rig->clock.now_us;
    while (fathom_elapsed_us(rig->clock.now_us, begin_us) < us) rig_turn(rig);
}
