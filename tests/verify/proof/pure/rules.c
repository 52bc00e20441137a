/* SPDX-License-Identifier: MIT */
/*
 * What is made of samples without a clock of its own: the rule of the switch, that of the relay, the alarm. Any config,
 * any samples at any times, also where init has refused the config.
 *
 * proves: src/processing/debounce.c src/sensor/a05_relay_rule.c src/processing/alarm.c
 * options: -eva-slevel-function debounce:1,relay_rule:1,alarm:1
 */
#include "any_sample.h"
#include "fathom/processing/alarm.h"
#include "fathom/sensor/a05_relay_rule.h"

static void debounce(void)
{
    static fathom_debounce_t debounce;
    fathom_debounce_config_t config;
    config.hold_us = any_32();
    config.unknown_us = any_32();
    config.threshold_mm = any_16();
    config.near_count = any_8();
    config.far_count = any_8();
    config.equal = any_8();
    (void)fathom_debounce_init(&debounce, &config);
    while (any_bool()) {
        const fathom_sample_t sample = any_sample();
        (void)fathom_debounce_add_sample(&debounce, &sample);
        if (any_bool()) (void)fathom_debounce_add_verdict(&debounce, any_8(), any_32());
        if (any_bool()) (void)fathom_debounce_add_distance(&debounce, any_16(), any_32());
        if (any_bool()) (void)fathom_debounce_advance(&debounce, any_32());
        (void)fathom_debounce_compare(&debounce, any_16());
    }
}

static void relay_rule(void)
{
    static fathom_a05_relay_rule_t rule;
    fathom_a05_relay_rule_config_t config;
    config.hold_us = any_32();
    config.unknown_us = any_32();
    config.threshold_mm = any_16();
    config.probes = any_8();
    config.equal = any_8();
    if (fathom_a05_relay_rule_init(&rule, &config) != FATHOM_OK) return;
    while (any_bool()) {
        const fathom_sample_t sample = any_sample();
        (void)fathom_a05_relay_rule_add_sample(&rule, &sample);
        if (any_bool()) (void)fathom_debounce_advance(&rule.debounce, any_32());
    }
}

static void alarm(void)
{
    static fathom_alarm_t alarm;
    fathom_alarm_config_t config;
    config.on_hold_us = any_32();
    config.off_hold_us = any_32();
    config.unknown_us = any_32();
    config.on_mm = any_16();
    config.off_mm = any_16();
    config.when = any_8();
    config.if_unknown = any_8();
    config.if_no_response = any_8();
    config.no_target_is_unknown = any_bool();
    (void)fathom_alarm_init(&alarm, &config);
    while (any_bool()) {
        const fathom_sample_t sample = any_sample();
        if (any_bool()) (void)fathom_alarm_add_sample(&alarm, &sample);
        if (any_bool())
            (void)fathom_alarm_add_status(
                &alarm, (fathom_status_t)Frama_C_interval(FATHOM_ERR_OTHER_MASTER, FATHOM_PENDING), any_32());
        (void)fathom_alarm_is_on(&alarm);
    }
}

int main(void)
{
    debounce();
    relay_rule();
    alarm();
    return 0;
}
