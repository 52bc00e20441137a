/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/codec/modbus_rtu.h"
#include "fathom/sensor/a05_dyp.h"

/* An A05 that answers the frames 55 AA (A05 2), over a line on the fake UART. SUM is the low byte of the sum of all
 * before it, and 55 + AA = FF. test_driver_contract.c has one probe alone. */
enum { STEP_US = 250, REQUEST_US = 5 * RIG_BYTE_US };

/* A05 2(3)3 with the sum put right, and 2(3)4. */
static const uint8_t ask_all[] = {0x55, 0xAA, 0x01, 0x01, 0x01};
static const uint8_t four[] = {0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x0D, 0xEA, 0x62};
static const uint16_t four_mm[] = {1000, 2000, 1953, 3562};

static fathom_a05_dyp_config_t config;
static fathom_a05_dyp_t a05;
static uint16_t counters[FATHOM_LINE_COUNTERS];

static void set_up_at(uint32_t now_us)
{
    rig_start(now_us);
    rig.line_parts.echo = FATHOM_LINE_ECHO_OFF;
    rig.line_parts.count = fathom_line_count;
    rig.line_parts.counters = counters;
    memset(counters, 0, sizeof counters);
    rig.fake.byte_us = RIG_BYTE_US;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    config = (fathom_a05_dyp_config_t){0};
    memset(&a05, 0x5A, sizeof a05);
}

static void start(void)
{
    assert_int_equal(fathom_a05_dyp_init(&a05, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a05_dyp_sensor(&a05);
}

/* With the defaults but for these. */
static void start_with(uint8_t probes, uint32_t period_us, uint32_t timeout_us)
{
    set_up_at(RIG_START_US);
    config.probes = probes;
    config.modbus.period_us = period_us;
    config.modbus.timeout_us = timeout_us;
    start();
}

static int set_up(void **state)
{
    start_with(0, 0, 0);
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* The status that comes next, within `us`. */
static fathom_status_t next_within(uint32_t us, fathom_status_t (*call)(void))
{
    fathom_status_t status = FATHOM_PENDING;
    for (uint32_t passed_us = 0; passed_us < us && status == FATHOM_PENDING; passed_us += STEP_US) {
        rig.fake.now_us += STEP_US;
        status = call();
    }
    return status;
}

static void nothing_for(uint32_t us) { assert_int_equal(next_within(us, rig_poll), FATHOM_PENDING); }

/* Goes on until the request after `written` others is on its way; returns when that was. */
static uint32_t until_written(size_t written)
{
    for (uint32_t i = 0; rig.fake.written <= written; i++) {
        assert_true(i < 100000);
        nothing_for(STEP_US);
    }
    return rig.fake.writes[written].at_us;
}

static void receive(const uint8_t *bytes, size_t length) { fake_receive(&rig.fake, 0, bytes, length); }

/* It is asked for all, and responses. */
static void tell(size_t written, const uint8_t *bytes, size_t length)
{
    until_written(written);
    assert_int_equal(rig.fake.writes[written].length, sizeof ask_all);
    assert_memory_equal(rig.fake.writes[written].bytes, ask_all, sizeof ask_all);
    nothing_for(205000);
    receive(bytes, length);
}

static void takes(unsigned probe)
{
    assert_int_equal(rig_poll(), FATHOM_OK);
    assert_int_equal(rig.sample.probe, probe);
    assert_int_equal(rig.sample.distance_mm, four_mm[probe - 1]);
}

/* ---- probes ---- */

TEST(four_samples_share_sequence_and_time)
{
    for (uint16_t response = 1; response <= 3; response++) {
        tell(response - 1u, four, sizeof four);
        const uint32_t heard_us = rig.fake.now_us;
        for (uint8_t probe = 1; probe <= 4; probe++) {
            if (probe != 1) assert_int_equal(fathom_due_us(&rig.sensor, 1), 0);
            takes(probe);
            assert_sample(&rig.sample, (fathom_sample_t){.time_us = heard_us,
                                                         .raw = four_mm[probe - 1],
                                                         .sequence = response,
                                                         .distance_mm = four_mm[probe - 1],
                                                         .kind = FATHOM_TARGET,
                                                         .model = FATHOM_A05,
                                                         .address = 1,
                                                         .probe = probe});
            rig.fake.now_us += STEP_US;
        }
        nothing_for(1000);
    }
}

TEST(every_choice_of_several_probes_measures_all_and_hands_over_the_wanted)
{
    for (uint8_t probes = 1; probes != 16; probes++) {
        if ((probes & (probes - 1)) == 0) continue;
        start_with(probes, 0, 0);
        tell(0, four, sizeof four);
        for (uint8_t probe = 1; probe <= 4; probe++)
            if ((probes >> (probe - 1) & 1) != 0) takes(probe);
        nothing_for(1000);
    }
}

TEST(one_probe_is_measured_alone)
{
    for (uint8_t probe = 1; probe <= 4; probe++) {
        const uint8_t command = (uint8_t)(0x0F + probe);
        const uint8_t request[] = {0x55, 0xAA, 0x01, command, command}; /* FF + 01 = 100 */
        const uint8_t response[] = {0x55, 0xAA, 0x01, command, 0x07, 0xA1, (uint8_t)(0xA8 + command)};
        start_with((uint8_t)(1u << (probe - 1)), 0, 0);
        until_written(0);
        assert_int_equal(rig.fake.writes[0].length, sizeof request);
        assert_memory_equal(rig.fake.writes[0].bytes, request, sizeof request);
        nothing_for(70000);
        receive(response, sizeof response);
        assert_int_equal(rig_poll(), FATHOM_OK);
        assert_int_equal(rig.sample.probe, probe);
        assert_int_equal(rig.sample.distance_mm, 1953);
        nothing_for(1000);
    }
}

/* Each probe's value for itself: FFFD is no object, FFFE interference of sister models (dyp.h), 0 unknown; 6001 is
 * outside. FF + 01 + 01 = 101; FF + FD = 1FC; FF + FE = 1FD; 0; 17 + 71 = 88: 01 + FC + FD + 88 =
 * 282. */
TEST(a_value_that_cannot_be_is_refused_alone)
{
    static const uint8_t odd[] = {0x55, 0xAA, 0x01, 0x01, 0xFF, 0xFD, 0xFF,
                                  0xFE, 0x00, 0x00, 0x17, 0x71, 0x82};
    tell(0, odd, sizeof odd);
    for (unsigned i = 0; i != 3; i++) {
        assert_int_equal(rig_poll(), FATHOM_OK);
        assert_int_equal(rig.sample.kind, i != 2 ? FATHOM_NO_TARGET : FATHOM_UNKNOWN);
        assert_int_equal(rig.sample.interference, i == 1);
    }
    assert_int_equal(rig_poll(), FATHOM_ERR_MALFORMED);
    assert_int_equal(a05.base.measurement.implausible, 1);
    nothing_for(1000);
    static const fathom_model_facts_t model = {.min_mm = 1001, .max_mm = 2000};
    config.model = &model;
    start();
    tell(1, four, sizeof four);
    assert_int_equal(rig_poll(), FATHOM_ERR_MALFORMED);
    takes(2);
    takes(3);
    assert_int_equal(rig_poll(), FATHOM_ERR_MALFORMED);
    nothing_for(1000);
}

/* ---- time: time-outs and paces, by default and as the config says, to the microsecond ---- */

static fathom_status_t after(uint32_t us, fathom_status_t (*call)(void))
{
    rig.fake.now_us += us;
    return call();
}

/* Runs until the next request is on the wire, and then until it has left. */
static void is_sent(fathom_status_t (*call)(void))
{
    const size_t before = rig.fake.written;
    for (unsigned i = 0; rig.fake.written == before; i++) {
        assert_true(i < 20000);
        PENDS(after(100, call));
    }
    PENDS(after(REQUEST_US, call));
}

/* It fails so long after it has left, and not before. */
static void is_silent_for(uint32_t us, fathom_status_t (*call)(void))
{
    PENDS(after(us - 1, call));
    assert_int_equal(after(1, call), FATHOM_ERR_NO_RESPONSE);
}

static fathom_status_t set_7(void) { return fathom_a05_dyp_broadcast_address(&a05, 7); }

/* "timeout_us; 0: 500 ms for all probes, 200 ms for one"; "command_timeout_us: of whatever else is asked; 0: 1 s". The
 * first request of a setting is one. */
TEST(all_probes_have_500_ms_and_one_has_200_and_a_command_has_1_s_or_as_the_config_says)
{
    static const struct {
        uint8_t probes;
        uint32_t timeout_us, command_timeout_us, is_us;
    } rows[] = {{0, 0, 345678, 500000}, {4, 0, 345678, 200000}, {0, 123456, 0, 123456}};
    for (unsigned i = 0; i != COUNT(rows); i++)
        for (unsigned is_command = 0; is_command != 2; is_command++) {
            start_with(rows[i].probes, 0, rows[i].timeout_us);
            config.modbus.command_timeout_us = rows[i].command_timeout_us;
            start();
            is_sent(is_command != 0 ? set_7 : rig_poll);
            if (is_command != 0)
                is_silent_for(i == 2 ? 1000000 : 345678, set_7);
            else
                is_silent_for(rows[i].is_us, rig_poll);
        }
}

/* 1953 mm of probe 1: FF + 01 + 10 + 07 + A1 = 1B8. */
static const uint8_t first_1953[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0xA1, 0xB8};

/* fathom_a05_dyp_model: "the least time from one command to the next", and no longer.
 * The pace counts from the poll in which the request went out. */
TEST(all_probes_are_asked_every_250_ms_and_one_every_100)
{
    for (uint8_t probes = 0; probes != 2; probes++) {
        start_with(probes, 0, 0);
        is_sent(rig_poll);
        receive(probes == 0 ? four : first_1953, probes == 0 ? sizeof four : sizeof first_1953);
        assert_int_equal(rig_poll(), FATHOM_OK);
        while (rig_poll() == FATHOM_OK) {
        }
        /* what one call submits the line sends in the next */
        PENDS(after((probes == 0 ? 250000 : 100000) - REQUEST_US - 1, rig_poll));
        PENDS(rig_poll());
        assert_int_equal(rig.fake.written, 1);
        PENDS(after(1, rig_poll));
        PENDS(rig_poll());
        assert_int_equal(rig.fake.written, 2);
    }
}

/* The command itself is acknowledged at once or not at all: the time of one probe is enough. Address 1 answers with
 * 1953 mm, 7 does not, and then 7 is set. FF + 07 + 03 = 109. */
TEST(setting_the_address_is_waited_for_as_one_probe_is)
{
    static const uint8_t set_to_7[] = {0x55, 0xAA, 0x07, 0x03, 0x09};
    config.modbus.command_timeout_us = 300000;
    start();
    is_sent(set_7);
    receive(first_1953, sizeof first_1953);
    is_sent(set_7); /* 7 is asked */
    PENDS(after(300000, set_7));
    is_sent(set_7);
    assert_memory_equal(rig.fake.writes[2].bytes, set_to_7, sizeof set_to_7);
    PENDS(after(199999, set_7));
    assert_int_equal(counters[FATHOM_LINE_NO_RESPONSES], 1);
    PENDS(after(1, set_7));
    assert_int_equal(counters[FATHOM_LINE_NO_RESPONSES], 2);
}

/* 1.5 s, or as the config says, and then a time-out and a quarantine. */
TEST(after_power_on_silence_is_warming_up)
{
    static const uint32_t starts_us[][2] = {{0, 1500000}, {700000, 700000}};
    for (unsigned i = 0; i != 2; i++) {
        fathom_status_t status = FATHOM_ERR_WARMING_UP;
        set_up_at(RIG_START_US);
        config.start_us = starts_us[i][0];
        start();
        fathom_a05_dyp_power_on(&a05);
        while (status == FATHOM_ERR_WARMING_UP) status = next_within(2000000, rig_poll);
        assert_int_equal(status, FATHOM_ERR_NO_RESPONSE);
        assert_in_range(rig.fake.now_us - RIG_START_US, starts_us[i][1], starts_us[i][1] + 1600000);
    }
}

/* ---- which address has the one A05 on this line? ---- */

static const uint8_t ask_any[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E}; /* FF + FF + 10 = 20E */
/* 1953 mm from 5: FF + 05 + 10 + 07 + A1 = 1BC; from 254: FF + FE + 10 + 07 + A1 = 2B5. */
static const uint8_t from_5[] = {0x55, 0xAA, 0x05, 0x10, 0x07, 0xA1, 0xBC};
static const uint8_t from_254[] = {0x55, 0xAA, 0xFE, 0x10, 0x07, 0xA1, 0xB5};

static fathom_a05_dyp_find_t sought;
static uint8_t address;

static int set_up_find(void **state)
{
    set_up(state);
    memset(&sought, 0, sizeof sought);
    address = GUARD;
    return 0;
}

static const suite_t finding = {.set_up = set_up_find};

static fathom_status_t find(void) { return fathom_a05_dyp_find(&sought, &rig.line, &address); }
static void finds_within(uint32_t us, fathom_status_t status)
{
    assert_int_equal(next_within(us, find), status);
}

static void until_asked(size_t written)
{
    for (unsigned i = 0; rig.fake.written != written; i++) {
        assert_true(i < 5000);
        finds_within(STEP_US, FATHOM_PENDING);
    }
    assert_int_equal(rig.fake.writes[written - 1].length, sizeof ask_any);
    assert_memory_equal(rig.fake.writes[written - 1].bytes, ask_any, sizeof ask_any);
    finds_within(70000, FATHOM_PENDING);
    assert_int_equal(rig.fake.written, written);
}

static void finds(size_t written, const uint8_t *response, uint8_t where)
{
    until_asked(written);
    receive(response, sizeof from_5);
    finds_within(STEP_US, FATHOM_OK);
    assert_int_equal(address, where);
}

TEST_IN(finding, of_two_responses_the_first_is_taken)
{
    uint8_t glued[sizeof from_5 + sizeof from_254];
    memcpy(glued, from_254, sizeof from_254);
    memcpy(glued + sizeof from_254, from_5, sizeof from_5);
    until_asked(1);
    receive(glued, sizeof glued);
    finds_within(STEP_US, FATHOM_OK);
    assert_int_equal(address, 254);
    assert_int_equal(sought.value, 1953);
}

TEST_IN(finding, on_an_echoing_line_the_echo_is_no_device)
{
    rig.line_parts.echo = FATHOM_LINE_ECHO_AUTO;
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    while (rig.fake.written == 0) finds_within(STEP_US, FATHOM_PENDING);
    fake_trickle(&rig.fake, 0, RIG_BYTE_US, ask_any, sizeof ask_any);
    fake_trickle(&rig.fake, 70000, RIG_BYTE_US, from_5, sizeof from_5);
    finds_within(100000, FATHOM_OK);
    assert_int_equal(address, 5);
    assert_int_equal(fathom_line_get_echo(&rig.line), FATHOM_LINE_ECHO_ON);
}

TEST_IN(finding, it_can_be_given_up)
{
    until_asked(1);
    for (unsigned i = 0; i != 2; i++) { /* the second time there is nothing to give up */
        fathom_a05_dyp_find_cancel(&sought, &rig.line);
        assert_null(rig.line.head);
    }
    finds_within(2 * 200000 - 75000, FATHOM_PENDING);
    assert_int_equal(rig.fake.written, 1); /* all are quarantined */
    finds(2, from_5, 5);
}

TEST_IN(finding, it_ends_if_the_line_is_initialised_again)
{
    is_sent(find);
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
    assert_int_equal(find(), FATHOM_ERR_CANCELLED);
    is_sent(find); /* again */
    is_silent_for(200000, find);
}

TEST_IN(finding, a_broken_port_ends_it)
{
    until_asked(1);
    rig.fake.read_fails = true;
    finds_within(STEP_US, FATHOM_ERR_PORT);
    assert_int_equal(address, GUARD);
}

TEST_IN(finding, a_line_without_room_says_so)
{
    rig.line_parts.frame_size = 12;
    for (unsigned i = 0; i != 2; i++) finds_within(STEP_US, FATHOM_ERR_CAPACITY);
    assert_null(rig.line.head);
}

/* ---- 55 AA 03 gives its address to every A05 on the line (A05 2(3)5). Who has the driver's transport to the line can
 * send it at no time: not before the driver sets an address, not between the calls that set it, and not afterwards
 * ---- */

/* A write of the address register, as a program would send it that has taken the transport for Modbus. */
static void assert_refused(void)
{
    static fathom_modbus_request_t other;
    const fathom_modbus_t *const transport = &a05.base.unit.transport;
    const size_t written = rig.fake.written;
    fathom_modbus_write_single_register(&other.message, 9, 0x0200, 9);
    assert_int_equal(transport->submit(transport->line, &other), FATHOM_ERR_UNSUPPORTED);
    assert_false(fathom_line_is_queued(&rig.line, &other.transaction));
    assert_int_equal(rig.fake.written, written);
}

/* 55 AA 01 10 and 0x75B mm: 55 + AA + 01 + 10 + 07 + 5B = 172, so that the sum is 72; and at address 7: 78. 55 + AA +
 * 07 + 03 = 109. */
static const struct {
    uint8_t address, command, length, response[7];
} steps[] = {{0x01, 0x10, 7, {0x55, 0xAA, 0x01, 0x10, 0x07, 0x5B, 0x72}},
             {0x07, 0x10, 0, {0}}, /* is a device there? */
             {0x07, 0x03, 5, {0x55, 0xAA, 0x07, 0x03, 0x09}},
             {0x07, 0x10, 7, {0x55, 0xAA, 0x07, 0x10, 0x07, 0x5B, 0x78}}};

TEST(a_write_through_the_transport_is_refused_at_every_time)
{
    fathom_status_t status = FATHOM_PENDING;
    size_t seen = 0;
    assert_refused();
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms < 10000);
        rig.fake.now_us += 1000;
        status = set_7();
        assert_refused();
        if (rig.fake.written == seen) continue;
        assert_true(seen < COUNT(steps));
        assert_int_equal(rig.fake.writes[seen].bytes[2], steps[seen].address);
        assert_int_equal(rig.fake.writes[seen].bytes[3], steps[seen].command);
        if (steps[seen].length != 0) fake_receive(&rig.fake, 70000, steps[seen].response, steps[seen].length);
        seen++;
    }
    assert_int_equal(status, FATHOM_OK);
    assert_true(fathom_a05_dyp_is_written(&a05));
    assert_int_equal(seen, COUNT(steps));
    assert_refused();
}

TEST(what_was_refused_or_given_up_leaves_the_transport_closed)
{
    assert_int_equal(fathom_a05_dyp_broadcast_address(&a05, 0), FATHOM_ERR_ARGUMENT);
    assert_refused();
    assert_int_equal(fathom_a05_dyp_broadcast_address(&a05, 255), FATHOM_ERR_ARGUMENT);
    assert_refused();
    assert_int_equal(fathom_modbus_write_next_unchecked(&a05.base.unit), FATHOM_OK); /* an address never is */
    assert_int_equal(set_7(), FATHOM_ERR_ARGUMENT);
    assert_refused();
    assert_int_equal(fathom_modbus_write_next_unchecked(&a05.base.unit), FATHOM_OK);
    assert_int_equal(fathom_a05_dyp_broadcast_address(&a05, 0), FATHOM_ERR_ARGUMENT);
    assert_int_equal(set_7(), FATHOM_PENDING); /* the refused ones were the blind ones */
    assert_false(fathom_a05_dyp_is_written(&a05));
    fathom_a05_dyp_cancel(&a05);
    assert_refused();
    assert_int_equal(rig.fake.written, 0);
}

TEST(its_responses_are_counted_by_its_unit)
{
    assert_int_equal(fathom_modbus_unit_responses(fathom_a05_dyp_unit(&a05)), 0);
    tell(0, four, sizeof four);
    takes(1);
    assert_int_equal(fathom_modbus_unit_responses(fathom_a05_dyp_unit(&a05)), 1);
}
