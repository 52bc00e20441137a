/* SPDX-License-Identifier: MIT */
/* A16 with PWM and with switch output, A05 with a relay: a level in place of bytes. */
#include "second_device.h"

enum {
    THRESHOLD_MM = 1000,
    NEARER_IN_A_ROW = 3,
    FARTHER_IN_A_ROW = 5,
    SWITCH_PERIOD_US = 500000,
    HOLD_US = 1000000
};
typedef enum {
    VERDICT_NONE,
    VERDICT_NEARER,
    VERDICT_FARTHER,
    VERDICT_SKIP
} verdict_t; /* as a16_switch_nothing has it */

bool second_output(const second_device_t *d) { return d->levels.high; }

static second_event_t *put_out(second_device_t *d, bool high)
{
    d->levels.high = high;
    second_event_t *event = second_truth_log(d, SECOND_EVENT_EFFECT);
    event->new_value = high;
    return event;
}

/* PWM. */
static void start(second_device_t *d, uint64_t at_us)
{
    levels_t *l = &d->levels;
    int64_t early = chosen(d, CHOICE_a16_early_trigger);
    if (at_us < l->free_us && (early == 0 || (early == 1 && l->high))) { /* a pulse is never cut */
        second_truth_log(d, SECOND_EVENT_REFUSED);
        return;
    }
    if (at_us < l->free_us && early == 2) at_us = l->free_us;
    l->free_us = at_us + chosen_us(d, CHOICE_a16_pwm_cycle_us);
    l->fall_us = at_us;
    d->timer_us[TIMER_TICK] = at_us + chosen_us(d, CHOICE_a16_pwm_rise_us);
}

static void pulse_begins(second_device_t *d)
{
    int32_t mm = second_truth_seen(d, 0, d->now_us, d->now_us, false);
    uint64_t width_us = chosen_us(d, CHOICE_a16_pwm_nothing_us);
    if (mm != SECOND_NOTHING) {
        width_us = (uint64_t)mm * 575 / 100;
        if (chosen(d, CHOICE_a16_pwm_speed) == 574) width_us = (uint64_t)mm * 2000 / 348;
    }
    put_out(d, true);
    second_event_t *event = second_truth_log(d, SECOND_EVENT_MEASUREMENT);
    event->asked = true;
    event->probes = 0x01;
    event->true_mm[0] = mm;
    event->no_target = mm == SECOND_NOTHING;
    event->new_value = (int64_t)width_us;
    event->start_us = d->now_us;
    event->end_us = d->now_us + width_us;
    d->timer_us[TIMER_BACK] = event->end_us;
}

static void on_level(second_device_t *d, bool low)
{
    uint64_t width_us = chosen_us(d, CHOICE_a16_trigger_width_us);
    bool at_end = chosen(d, CHOICE_a16_trigger_edge) != 0;
    if (d->config.kind != SECOND_A16_PWM || !d->alive) return;
    if (low) {
        d->us.fall_us = d->now_us;
        if (!at_end) d->timer_us[TIMER_TRIGGER] = d->now_us + width_us;
    } else {
        d->timer_us[TIMER_TRIGGER] = SECOND_NEVER;
        if (at_end && d->now_us >= d->us.fall_us + width_us) start(d, d->now_us);
    }
}

/* Switch: every 500 ms. */
static void switch_measures(second_device_t *d)
{
    levels_t *l = &d->levels;
    int32_t mm = second_truth_seen(d, 0, d->now_us, d->now_us, false);
    verdict_t verdict = mm < THRESHOLD_MM ? VERDICT_NEARER : VERDICT_FARTHER;
    if (mm == THRESHOLD_MM) verdict = (verdict_t)chosen(d, CHOICE_a16_switch_equal);
    if (mm == SECOND_NOTHING) verdict = (verdict_t)chosen(d, CHOICE_a16_switch_nothing);
    d->timer_us[TIMER_TICK] = d->now_us + SWITCH_PERIOD_US;
    if (verdict == VERDICT_SKIP) return;
    l->nearer = verdict == VERDICT_NEARER ? (uint8_t)(l->nearer + (l->nearer < 255)) : 0;
    l->farther = verdict == VERDICT_FARTHER ? (uint8_t)(l->farther + (l->farther < 255)) : 0;
    if (l->nearer >= NEARER_IN_A_ROW && !l->high) put_out(d, true);
    if (l->farther >= FARTHER_IN_A_ROW && l->high) put_out(d, false);
}

static void relay_measures(second_device_t *d)
{
    levels_t *l = &d->levels;
    bool near = false;
    for (size_t probe = 0; probe < SECOND_PROBES; probe++) {
        int32_t mm = second_truth_seen(d, probe, d->now_us, d->now_us, false);
        if (((unsigned)d->config.fitted >> probe & 1U) == 0 || mm == SECOND_NOTHING) continue;
        near |= mm < THRESHOLD_MM || (mm == THRESHOLD_MM && chosen(d, CHOICE_a05_relay_equal) != 0);
    }
    d->timer_us[TIMER_TICK] = d->now_us + chosen_us(d, CHOICE_a05_relay_period_us);
    bool waits = chosen(d, CHOICE_a05_relay_hold) != 0;
    if (near != l->near && waits) l->changed_us = d->now_us;
    l->near = near;
    if (near == l->high || d->now_us < l->changed_us + HOLD_US) return;
    put_out(d, near);
    l->changed_us = d->now_us;
}

static void on_init(second_device_t *d)
{
    d->address = d->config.address;
    d->line = (second_line_t){9600, 'N', 1};
}

static void on_power_on(second_device_t *d)
{
    d->levels = (levels_t){.changed_us = d->now_us};
    d->us.fall_us = 0;
}

static void on_alive(second_device_t *d)
{
    int64_t at_power_on = chosen(d, CHOICE_a16_trigger_at_power_on);
    bool low_counts = at_power_on == 1 && d->level_low;
    if (d->config.kind == SECOND_A16_PWM && (at_power_on == 2 || low_counts)) start(d, d->now_us);
    if (d->config.kind == SECOND_A16_SWITCH && chosen(d, CHOICE_a16_switch_first) != 0) put_out(d, true);
    if (d->config.kind != SECOND_A16_PWM) d->timer_us[TIMER_TICK] = d->now_us;
}

static void on_timer(second_device_t *d, timer_slot_t slot)
{
    if (slot == TIMER_TRIGGER) start(d, d->us.fall_us);
    if (slot == TIMER_BACK) put_out(d, false);
    if (slot != TIMER_TICK) return;
    if (d->config.kind == SECOND_A16_PWM)
        pulse_begins(d);
    else if (d->config.kind == SECOND_A16_SWITCH)
        switch_measures(d);
    else
        relay_measures(d);
}

const hooks_t second_level_hooks = {
    .init = on_init, .power_on = on_power_on, .alive = on_alive, .timer = on_timer, .level = on_level};
