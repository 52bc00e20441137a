/* SPDX-License-Identifier: MIT */
/* HPS-167S: what each of the commands #1 to #15 does and responses. */
#include "second_device.h"

#include <string.h>

enum { VERSION = 0x01, CONFIGURATION, DETAILS, TEMPERATURE, MEASURE = 0x08, FACTORY_RESET };
enum {
    WARM_UP = 0x0A,
    SET_ID = 0x10,
    BAUD,
    POWER_ON_MODE,
    TERMINATION,
    OFFSET,
    LOAD,
    FILTER,
    RECONNECT = 0x20
};
enum { READ = 0x03, WRITE = 0x06, WRITE_MANY = 0x10 };

static void put_reconnect(const second_device_t *d, uint8_t *bytes, uint32_t ms)
{
    static const uint8_t shifts[3][4] = {{24, 16, 8, 0}, {0, 8, 16, 24}, {8, 0, 24, 16}};
    const uint8_t *shift = shifts[chosen(d, CHOICE_hps_reconnect_order)];
    for (size_t i = 0; i < 4; i++) bytes[i] = (uint8_t)(ms >> shift[i] & 0xFF);
}

static uint32_t get_reconnect(const second_device_t *d, const uint8_t *bytes)
{
    uint32_t high = word_at(bytes), low = word_at(bytes + 2);
    switch (chosen(d, CHOICE_hps_reconnect_order)) {
    case 0:
        return high << 16 | low;
    case 1:
        return (uint32_t)bytes[3] << 24 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[1] << 8 | bytes[0];
    default:
        return low << 16 | high;
    }
}

/* What follows the response: a new ID, a new rate. */
static void after_response(second_device_t *d, const job_t *job)
{
    if (d->next_address < 0 && d->next_line.baud == 0) return;
    d->timer_us[TIMER_AFTER] = job->answered ? d->out_free_us : d->now_us;
}

static void use_line_of_response(const second_device_t *d, job_t *job)
{
    job->line.baud = d->line.baud;
    job->reply_address = d->address;
}

static void factory_reset(second_device_t *d, job_t job)
{
    hps_settings_t fresh = second_hps_factory(d);
    hps_t *s = &d->hps;
    int64_t order = chosen(d, CHOICE_hps_reset_order);
    if (chosen(d, CHOICE_hps_reset_scope) == 0) {
        fresh.offset = s->flash.offset;
        fresh.filter = s->flash.filter;
    } else {
        s->used.offset = fresh.offset;
        s->used.filter = fresh.filter;
    }
    s->flash = s->set = fresh;
    if (chosen(d, CHOICE_hps_reset_scope) == 0) s->set.filter = s->used.filter;
    d->flash_writes++;
    second_truth_log(d, SECOND_EVENT_RESET)->reg = FACTORY_RESET;
    d->next_address = s->used.id = fresh.id;
    if (order != 2) {
        s->used.baud_code = fresh.baud_code;
        d->next_line = second_hps_line(fresh.baud_code);
    }
    if (order != 0) {
        second_slave_effect(d);
        use_line_of_response(d, &job);
    }
    uint8_t frame[8] = {job.reply_address, READ, 2, 0x00, 0x01};
    second_slave_response(d, &job, frame, 5, SECOND_EVENT_RESPONSE);
    after_response(d, &job);
    uint64_t out_us = job.answered ? d->out_free_us : d->now_us;
    if (chosen(d, CHOICE_hps_reset_restart) != 0) d->timer_us[TIMER_BACK] = out_us + 1;
}

static void single_measurement(second_device_t *d, const job_t *job)
{
    bool failed = d->hps.failed || second_hps_fails(d);
    int64_t how = RESPONSE_TAKEN;
    if (failed) how = chosen(d, CHOICE_hps_fault_single);
    if (second_hps_warming_up(d)) how = chosen(d, CHOICE_hps_warm_measure);
    if (how < RESPONSE_OTHER)
        second_slave_refuse(d, job, how);
    else
        second_hps_send(d, job, how == RESPONSE_OTHER);
}

static void read_registers(second_device_t *d, const job_t *job)
{
    static const uint8_t counts[] = {[VERSION] = 3,     [CONFIGURATION] = 4, [DETAILS] = 11,
                                     [TEMPERATURE] = 1, [MEASURE] = 4,       [FACTORY_RESET] = 1};
    uint16_t reg = word_at(job->bytes + 2), count = word_at(job->bytes + 4);
    uint8_t expected = reg < sizeof counts ? counts[reg] : 0;
    uint8_t frame[32] = {job->reply_address, READ, (uint8_t)(2 * expected)}, *data = frame + 3;
    const hps_settings_t *reported = chosen(d, CHOICE_hps_reported) == 0 ? &d->hps.set : &d->hps.used;
    int64_t how = RESPONSE_TAKEN;
    if (expected == 0)
        how = chosen(d, CHOICE_hps_unknown_register);
    else if (count != expected)
        how = chosen(d, CHOICE_hps_wrong_count);
    else if (d->hps.failed && (reg == DETAILS || reg == TEMPERATURE))
        how = chosen(d, CHOICE_hps_core_in_fault);
    if (!job->answered && (reg != FACTORY_RESET || chosen(d, CHOICE_hps_broadcast_reset) == 0))
        how = RESPONSE_SILENCE;
    if (how != RESPONSE_TAKEN) {
        second_slave_refuse(d, job, how);
        return;
    }
    switch (reg) {
    case VERSION:
        memcpy(data, d->hps.version, 6);
        break;
    case CONFIGURATION:
        data[0] = reported->termination;
        data[1] = reported->auto_out;
        data[2] = reported->warm_s;
        put_reconnect(d, data + 3, reported->reconnect_ms);
        data[7] = reported->baud_code;
        break;
    case DETAILS:
        memcpy(data, d->hps.details, sizeof d->hps.details);
        break;
    case TEMPERATURE:
        put_word(data, (uint16_t)chosen(d, CHOICE_hps_temperature));
        break;
    case MEASURE:
        single_measurement(d, job);
        return;
    default:
        factory_reset(d, *job);
        return;
    }
    second_slave_response(d, job, frame, 3U + 2U * expected, SECOND_EVENT_RESPONSE);
}

/* Loads all that #13 covers. */
static void load(second_device_t *d, const hps_settings_t *source)
{
    hps_t *s = &d->hps;
    int64_t scope = chosen(d, CHOICE_hps_load_scope);
    hps_settings_t loaded = scope == 0 ? s->used : *source;
    loaded.offset = source->offset;
    loaded.filter = source->filter;
    if (scope < 2) {
        loaded.id = s->used.id;
        loaded.baud_code = s->used.baud_code;
    } else if (loaded.id != s->used.id || loaded.baud_code != s->used.baud_code) {
        d->next_address = loaded.id;
        d->next_line = second_hps_line(loaded.baud_code);
    }
    s->used = loaded;
    if (scope != 0) s->set = loaded;
    s->set.offset = loaded.offset;
    s->set.filter = loaded.filter;
}

/* A value that a choice may refuse; true: go on with the value. */
static bool passes(second_device_t *d, const job_t *job, int64_t how)
{
    if (how == RESPONSE_TAKEN || how == RESPONSE_OTHER) return true;
    second_slave_refuse(d, job, how);
    return false;
}

static void write_register(second_device_t *d, job_t job)
{
    hps_t *s = &d->hps;
    uint16_t reg = word_at(job.bytes + 2), value = word_at(job.bytes + 4);
    int16_t number = (int16_t)value;
    int64_t old_value = 0, new_value = value, how = RESPONSE_TAKEN;
    bool flash = true;
    switch (reg) {
    case WARM_UP:
        if (value > 0xFF) how = chosen(d, CHOICE_hps_warm_large);
        if (!passes(d, &job, how)) return;
        old_value = s->set.warm_s;
        new_value = how == RESPONSE_OTHER ? 0xFF : value & 0xFF;
        s->set.warm_s = s->flash.warm_s = (uint8_t)new_value;
        if (chosen(d, CHOICE_hps_warm_effect) != 0) s->used.warm_s = (uint8_t)new_value;
        break;
    case SET_ID:
        if (value < 1 || value > 32) how = chosen(d, CHOICE_hps_id_range);
        if (how == RESPONSE_TAKEN && (value < 1 || value > 247)) how = 3;
        if (!passes(d, &job, how)) return;
        old_value = s->set.id;
        d->next_address = s->used.id = s->set.id = s->flash.id = (uint8_t)value;
        break;
    case BAUD:
        if (value > 0xFF || ((value < 1 || value > 4) && chosen(d, CHOICE_hps_baud_other) != 0))
            new_value = 1;
        old_value = s->set.baud_code;
        flash = chosen(d, CHOICE_hps_baud_kept) != 0 || chosen(d, CHOICE_hps_baud_effect) == 2;
        s->set.baud_code = (uint8_t)new_value;
        if (flash) s->flash.baud_code = (uint8_t)new_value;
        if (chosen(d, CHOICE_hps_baud_effect) == 2) break;
        s->used.baud_code = (uint8_t)new_value;
        d->next_line = second_hps_line((uint8_t)new_value);
        break;
    case POWER_ON_MODE:
    case TERMINATION:
        if (value != 0 && value != 0xFF) how = chosen(d, CHOICE_hps_switch_value);
        if (!passes(d, &job, how)) return;
        new_value = value != 0 ? 0xFF : 0;
        old_value = reg == TERMINATION ? s->set.termination : s->set.auto_out;
        if (reg == TERMINATION)
            s->set.termination = s->flash.termination = (uint8_t)new_value;
        else
            s->set.auto_out = s->flash.auto_out = (uint8_t)new_value;
        break;
    case OFFSET:
        if (number > 1000 || number < -1000) how = chosen(d, CHOICE_hps_offset_large);
        if (!passes(d, &job, how)) return;
        old_value = s->set.offset;
        new_value = number + (chosen(d, CHOICE_hps_offset_sum) != 0 ? old_value : 0);
        if (new_value > INT16_MAX) new_value = INT16_MAX;
        if (new_value < INT16_MIN) new_value = INT16_MIN;
        s->set.offset = s->flash.offset = (int16_t)new_value;
        if (chosen(d, CHOICE_hps_offset_effect) == 0) s->used.offset = (int16_t)new_value;
        break;
    case LOAD:
        if (value != 0 && value != 0xFF) how = chosen(d, CHOICE_hps_load_value);
        if (!passes(d, &job, how)) return;
        if (value != 0) {
            const hps_settings_t fresh = second_hps_factory(d);
            load(d, &fresh);
            hps_settings_t kept = s->flash;
            s->flash = s->set;
            if (chosen(d, CHOICE_hps_load_scope) == 0) {
                s->flash = kept;
                s->flash.offset = fresh.offset;
                s->flash.filter = fresh.filter;
            }
            if (chosen(d, CHOICE_hps_load_scope) == 1) s->flash.baud_code = kept.baud_code;
        } else {
            load(d, &s->flash);
        }
        flash = value != 0;
        break;
    case FILTER:
        if (number > 100 || number < -100) how = chosen(d, CHOICE_hps_filter_range);
        if (!passes(d, &job, how)) return;
        old_value = s->set.filter;
        new_value = how == RESPONSE_OTHER ? (number > 0 ? 100 : -100) : number;
        s->set.filter = s->used.filter = (int16_t)new_value;
        flash = chosen(d, CHOICE_hps_filter_kept) != 0;
        if (flash) s->flash.filter = (int16_t)new_value;
        break;
    default:
        second_slave_refuse(d, &job, chosen(d, CHOICE_hps_unknown_register));
        return;
    }
    second_slave_setting(d, reg, old_value, new_value, flash);
    bool first = (reg == SET_ID && chosen(d, CHOICE_hps_id_response) != 0) ||
                 (reg == BAUD && chosen(d, CHOICE_hps_baud_effect) == 1);
    if (first) {
        second_slave_effect(d);
        use_line_of_response(d, &job);
    }
    second_slave_echo(d, &job);
    after_response(d, &job);
}

static void write_reconnect(second_device_t *d, const job_t *job)
{
    hps_t *s = &d->hps;
    uint16_t reg = word_at(job->bytes + 2), count = word_at(job->bytes + 4);
    if (reg != RECONNECT) {
        second_slave_refuse(d, job, chosen(d, CHOICE_hps_unknown_register));
        return;
    }
    if (count != 2 || job->bytes[6] != 4) {
        int64_t how = chosen(d, CHOICE_hps_wrong_count);
        second_slave_refuse(d, job, how == RESPONSE_TAKEN ? 3 : how);
        return;
    }
    uint32_t ms = get_reconnect(d, job->bytes + 7);
    int64_t how = ms % 18 != 0 ? chosen(d, CHOICE_hps_reconnect_odd) : RESPONSE_TAKEN;
    if (!passes(d, job, how)) return;
    if (how == RESPONSE_OTHER) ms -= ms % 18;
    bool at_power_on = chosen(d, CHOICE_hps_reconnect_effect) != 0;
    bool kept = at_power_on || chosen(d, CHOICE_hps_reconnect_kept) != 0;
    int64_t old_value = s->set.reconnect_ms;
    s->set.reconnect_ms = ms;
    if (!at_power_on) s->used.reconnect_ms = ms;
    if (kept) s->flash.reconnect_ms = ms;
    second_slave_setting(d, RECONNECT, old_value, ms, kept);
    second_slave_echo(d, job);
}

void second_hps_job(second_device_t *d, const job_t *job)
{
    uint8_t function = job->bytes[1];
    size_t len = function == WRITE_MANY && job->len > 7 ? 9U + job->bytes[6] : 8U;
    bool known = function == READ || function == WRITE || function == WRITE_MANY;
    if (job->bad_crc)
        second_slave_refuse(d, job, chosen(d, CHOICE_hps_bad_crc));
    else if (!known)
        second_slave_refuse(d, job, chosen(d, CHOICE_hps_illegal_function));
    else if (job->len != len || (function == WRITE_MANY && len < 10))
        second_slave_refuse(d, job, chosen(d, CHOICE_hps_wrong_length));
    else if (function == READ)
        read_registers(d, job);
    else if (function == WRITE)
        write_register(d, *job);
    else
        write_reconnect(d, job);
}
