/* SPDX-License-Identifier: MIT */
#include "wire_users.h"

#include "fathom/engine/line_pins.h"

enum { STALE_US = 2000000, BACKOFF_US = 1000000, SECOND_US = 1000000, GAP_US = 5000 };

user_t users[USERS];
unsigned user_count;

static union {
    fathom_hps167s_t hps;
    fathom_a16_modbus_t a16;
    fathom_a05_modbus_t a05;
    fathom_a05_dyp_t dyp;
    fathom_hps167s_auto_t hps_auto;
    fathom_a16_auto_t a16_auto;
    fathom_a05_auto_t a05_auto;
    fathom_a16_controlled_t controlled;
} drivers[USERS];

/* What a kind needs. `reg` is the register of its first probe. */
static const struct {
    const char *name;
    wire_kind_t unit;
    uint32_t byte_us;
    wire_us_t period_us, answer_us, spread_us; /* of the unit */
    wire_us_t timeout_us, driver_us;           /* of the driver; its period */
    uint16_t reg;
    bool is_stream;
} kinds[USER_KINDS] = {
    [USER_HPS167S] = {"HPS-167S", WIRE_HPS167S, WIRE_BYTE_19200_US, 0, 2000, 18519, 200000, 18519,
                      WIRE_MEASUREMENT, false},
    [USER_A16_MODBUS] = {"A16 Modbus", WIRE_DYP_MODBUS, WIRE_BYTE_9600_US, 0, 60000, 60000, 200000, 120000,
                         0x0101, false},
    [USER_A05_MODBUS] = {"A05 Modbus", WIRE_DYP_MODBUS, WIRE_BYTE_9600_US, 0, 60000, 60000, 200000, 400000,
                         0x0106, false},
    [USER_A05_DYP] = {"A05 55 AA", WIRE_DYP_55AA, WIRE_BYTE_9600_US, 0, 100000, 50000, 300000, 250000, 0x0106,
                      false},
    [USER_HPS167S_AUTO] = {"HPS-167S auto", WIRE_HPS167S, WIRE_BYTE_19200_US, 18519, 2000, 18519, 0, 0,
                           WIRE_MEASUREMENT, true},
    [USER_A16_AUTO] = {"A16 auto", WIRE_A16_STREAM, WIRE_BYTE_9600_US, 100000, 0, 0, 0, 0, 0x0106, true},
    [USER_A05_AUTO] = {"A05 auto", WIRE_A05_STREAM, WIRE_BYTE_9600_US, 100000, 0, 0, 0, 0, 0x0106, true},
    /* 90 to 110 ms after the edge; the frame is the response up to 130 ms after it */
    [USER_A16_CONTROLLED] = {"A16 controlled", WIRE_A16_STREAM, WIRE_BYTE_9600_US, 0, 90000, 20000, 130000,
                             121000, 0x0106, true},
};

const char *user_name(user_kind_t kind) { return kinds[kind].name; }
bool user_is_stream(user_kind_t kind) { return kinds[kind].is_stream; }
uint32_t user_byte_us(user_kind_t kind) { return kinds[kind].byte_us; }

static fathom_modbus_config_t modbus_config(const user_t *user)
{
    return (fathom_modbus_config_t){.timeout_us = (uint32_t)user->timeout_us,
                                    .command_timeout_us = (uint32_t)user->timeout_us,
                                    .backoff_us = BACKOFF_US,
                                    .address = user->unit->address,
                                    .retries = user->retries};
}

static size_t index_of(const user_t *user) { return (size_t)(user - users); }

static fathom_status_t init_requests(user_t *user)
{
    const size_t i = index_of(user);
    switch (user->kind) {
    case USER_HPS167S: {
        const fathom_hps167s_config_t config = {.modbus = modbus_config(user)};
        user->sensor = fathom_hps167s_sensor(&drivers[i].hps);
        return fathom_hps167s_init(&drivers[i].hps, &desk.modbus, &config);
    }
    case USER_A16_MODBUS: {
        const fathom_a16_modbus_config_t config = {.modbus = modbus_config(user), .value = FATHOM_REAL_TIME};
        user->sensor = fathom_a16_modbus_sensor(&drivers[i].a16);
        return fathom_a16_modbus_init(&drivers[i].a16, &desk.modbus, &config);
    }
    case USER_A05_MODBUS: {
        const fathom_a05_modbus_config_t config = {.modbus = modbus_config(user)};
        user->sensor = fathom_a05_modbus_sensor(&drivers[i].a05);
        return fathom_a05_modbus_init(&drivers[i].a05, &desk.modbus, &config);
    }
    default: {
        const fathom_a05_dyp_config_t config = {.modbus = modbus_config(user)};
        user->sensor = fathom_a05_dyp_sensor(&drivers[i].dyp);
        return fathom_a05_dyp_init(&drivers[i].dyp, &desk.line, &config);
    }
    }
}

static fathom_status_t init_stream(user_t *user)
{
    const size_t i = index_of(user);
    switch (user->kind) {
    case USER_HPS167S_AUTO: {
        const fathom_hps167s_auto_config_t config = {.stale_us = STALE_US, .address = user->unit->address};
        user->sensor = fathom_hps167s_auto_sensor(&drivers[i].hps_auto);
        return fathom_hps167s_auto_init(&drivers[i].hps_auto, &desk.line, &config);
    }
    case USER_A16_AUTO: {
        const fathom_a16_auto_config_t config = {.stale_us = STALE_US};
        user->sensor = fathom_a16_auto_sensor(&drivers[i].a16_auto);
        return fathom_a16_auto_init(&drivers[i].a16_auto, &desk.line, &config);
    }
    case USER_A05_AUTO: {
        const fathom_a05_auto_config_t config = {.stale_us = STALE_US};
        user->sensor = fathom_a05_auto_sensor(&drivers[i].a05_auto);
        return fathom_a05_auto_init(&drivers[i].a05_auto, &desk.line, &config);
    }
    default: {
        const fathom_output_t trigger = fathom_output_line_break(&desk.line);
        user->sensor = fathom_a16_controlled_sensor(&drivers[i].controlled);
        return fathom_a16_controlled_init(&drivers[i].controlled, &desk.line, &trigger, NULL);
    }
    }
}

void user_init(user_t *user)
{
    const fathom_status_t status = user->is_stream ? init_stream(user) : init_requests(user);
    assert_int_equal(status, FATHOM_OK);
    user->since_us = wire.now_us;
    user->slack_us = 0;
}

void user_deinit(user_t *user)
{
    const size_t i = index_of(user);
    switch (user->kind) {
    case USER_HPS167S:
        fathom_hps167s_deinit(&drivers[i].hps);
        break;
    case USER_A16_MODBUS:
        fathom_a16_modbus_deinit(&drivers[i].a16);
        break;
    case USER_A05_MODBUS:
        fathom_a05_modbus_deinit(&drivers[i].a05);
        break;
    case USER_A05_DYP:
        fathom_a05_dyp_deinit(&drivers[i].dyp);
        break;
    case USER_HPS167S_AUTO:
        fathom_hps167s_auto_deinit(&drivers[i].hps_auto);
        break;
    case USER_A16_AUTO:
        (void)fathom_a16_auto_deinit(&drivers[i].a16_auto);
        break;
    case USER_A05_AUTO:
        (void)fathom_a05_auto_deinit(&drivers[i].a05_auto);
        break;
    default:
        (void)fathom_a16_controlled_deinit(&drivers[i].controlled);
        break;
    }
}

user_t *user_add(user_kind_t kind, uint8_t address, uint8_t retries)
{
    assert_true(user_count != USERS);
    user_t *const user = &users[user_count++];
    memset(user, 0, sizeof *user);
    user->kind = kind;
    user->retries = retries;
    user->is_stream = kinds[kind].is_stream;
    user->timeout_us = kinds[kind].timeout_us;
    user->rest_us = kinds[kind].driver_us + (user->is_stream ? STALE_US : BACKOFF_US);
    if (kind == USER_A16_CONTROLLED) user->rest_us = kinds[kind].driver_us;
    user->unit = wire_add(&(wire_unit_t){.kind = kinds[kind].unit,
                                         .address = address,
                                         .period_us = kinds[kind].period_us,
                                         .answer_us = kinds[kind].answer_us,
                                         .spread_us = kinds[kind].spread_us});
    user_init(user);
    return user;
}

void users_forget(void)
{
    memset(users, 0, sizeof users);
    memset(drivers, 0, sizeof drivers);
    user_count = 0;
}

void users_slept(wire_us_t for_us)
{
    for (unsigned i = 0; i != user_count; i++) users[i].slack_us += for_us;
}

wire_us_t user_bound_us(const user_t *user)
{
    enum { TURNS = 8 };
    const wire_us_t turns_us = TURNS * desk_longest_turn_us();
    wire_us_t timeout_us = 0;
    unsigned retries = desk.request_retries, others = desk.request_count;
    if (user->kind ==
        USER_A16_CONTROLLED) /* a port may refuse the break for a second; the frame ends at a gap */
        return user->rest_us + user->timeout_us + SECOND_US + GAP_US + turns_us;
    if (user->is_stream) return user->rest_us + GAP_US + turns_us;
    for (unsigned i = 0; i != user_count; i++) {
        if (users[i].is_stream) continue;
        if (timeout_us < users[i].timeout_us) timeout_us = users[i].timeout_us;
        if (retries < users[i].retries) retries = users[i].retries;
        others += &users[i] != user;
    }
    return desk_bound_us(timeout_us, retries, others) + user->rest_us + turns_us;
}

unsigned user_frames(const user_t *user)
{
    const size_t i = index_of(user);
    const fathom_dyp_auto_t *const base =
        user->kind == USER_A16_AUTO ? &drivers[i].a16_auto.base : &drivers[i].a05_auto.base;
    return base->stream.counters[FATHOM_STREAM_FRAMES];
}

/* ---- The judge ---- */

/* Was this distance measured by this unit and probe, for us, within the bound? */
static bool is_right(const user_t *user, const fathom_sample_t *sample)
{
    const wire_issue_t *const issue = wire_issue_of(sample->distance_mm);
    const wire_us_t age_us = issue != NULL ? wire.now_us - issue->at_us : 0;
    if (issue == NULL || &wire.units[issue->unit] != user->unit) return false;
    if (issue->reg != kinds[user->kind].reg + sample->probe - 1) return false;
    /* Another master's response is right if it is the value that we would have got. */
    if (user->is_stream && issue->asker == WIRE_MASTER && user->kind != USER_HPS167S_AUTO) return false;
    const wire_us_t limit_us =
        user->is_stream ? user->rest_us + FATHOM_LINE_LATE_US + user->timeout_us : user_bound_us(user);
    /* `time_us` is honest: between the measurement and now, and at most the limit after the measurement. A clock
     * that was set back since then is less than 100 ms off. */
    enum { SET_BACK_US = 100000 };
    const uint32_t now_us = (uint32_t)((int64_t)wire.now_us + wire.skew_us);
    const uint32_t ago_us = now_us - sample->time_us > INT32_MAX ? 0 : now_us - sample->time_us;
    const wire_us_t set_back_us = wire.skew_us != 0 ? SET_BACK_US : 0;
    return ago_us <= age_us && age_us - ago_us <= limit_us + set_back_us + 4 * desk_longest_turn_us();
}

static void judge(user_t *user, const fathom_sample_t *sample)
{
    user->ready++;
    if (sample->kind == FATHOM_TARGET && is_right(user, sample)) return;
    if (wire_has_chance_of((uint16_t)sample->raw)) {
        user->chances++;
        return;
    }
    const wire_issue_t *const issue = wire_issue_of(sample->distance_mm);
    wire_print();
    print_message("%s: %u mm of probe %u, kind %u, time %u", kinds[user->kind].name, sample->distance_mm,
                  sample->probe, sample->kind, sample->time_us);
    if (issue != NULL)
        print_message("; sent by unit %u, register %04x, asker %u, %.3f s ago", issue->unit, issue->reg,
                      issue->asker, (double)(wire.now_us - issue->at_us) / 1e6);
    print_message("\n");
    fail_msg("a wrong reading");
}

fathom_status_t user_poll(user_t *user)
{
    fathom_sample_t sample;
    memset(&sample, 0, sizeof sample);
    const fathom_status_t status = fathom_poll(&user->sensor, &sample);
    const wire_us_t waited_us = wire.now_us - user->since_us;
    if (status == FATHOM_PENDING) {
        if (waited_us <= user->slack_us + user_bound_us(user)) return status;
        wire_print();
        print_message("%s: no outcome for %.3f s, bound %.3f s, slept %.3f s; line: phase %u\n",
                      kinds[user->kind].name, (double)waited_us / 1e6, (double)user_bound_us(user) / 1e6,
                      (double)user->slack_us / 1e6, desk.line.phase);
        fail_msg("no outcome within the bound");
    }
    user->since_us = wire.now_us;
    user->slack_us = 0;
    if (status == FATHOM_OK) judge(user, &sample);
    return status;
}
