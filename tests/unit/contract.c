/* SPDX-License-Identifier: MIT */
#include "contract.h"

#include "auto_rig.h"
#include "desk.h"
#include "fathom/sensor/a05_auto.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a05_relay.h"
#include "fathom/sensor/a16_auto.h"
#include "fathom/sensor/a16_pwm.h"
#include "fathom/sensor/a16_settings.h"
#include "fathom/sensor/a16_switch.h"
#include "fathom/sensor/hps167_uart.h"
#include "fathom/sensor/hps167s_auto.h"
#include "fathom/sensor/hps167s_info.h"

uint32_t contract_came_us;
uint32_t contract_slack_us;

/* The parameters of the init functions between the driver and its config. Each prepare function sets those of its driver,
 * and a test may make one NULL. */
static const fathom_modbus_t *transport;
static fathom_line_t *line;
static fathom_output_t output;
static const fathom_output_t *trigger;
static const fathom_capture_t *capture;
static const fathom_clock_t *its_clock;
static const fathom_pin_t *pin;

#define PARAMETERS(...) __VA_ARGS__

/* A driver that takes the facts of a model: its config names a copy of those that NULL selects. */
#define DRIVER_OF_MODEL(name, parameters, prepares, ...)                                                     \
    static fathom_model_facts_t name##_facts;                                                                \
    DRIVER(name, parameters, (name##_facts = fathom_##name##_model, prepares), .model = &name##_facts,       \
           __VA_ARGS__)

/* The driver NAME with the parameters of its init, what prepares these, and the least config that its tests need. */
#define DRIVER(name, parameters, prepares, ...)                                                              \
    static fathom_##name##_t name;                                                                           \
    static fathom_##name##_config_t name##_config;                                                           \
    static void name##_prepare(void)                                                                         \
    {                                                                                                        \
        prepares;                                                                                            \
        name##_config = (fathom_##name##_config_t){__VA_ARGS__};                                             \
    }                                                                                                        \
    static fathom_status_t name##_init_with(const fathom_##name##_config_t *config)                          \
    {                                                                                                        \
        memset(&name, 0x5A, sizeof name);                                                                    \
        return fathom_##name##_init(&name, PARAMETERS parameters, config);                                   \
    }                                                                                                        \
    static fathom_status_t name##_init(void) { return name##_init_with(&name##_config); }                    \
    static fathom_status_t name##_init_without_config(void) { return name##_init_with(NULL); }               \
    static fathom_status_t name##_poll(fathom_sample_t *sample)                                              \
    {                                                                                                        \
        return fathom_##name##_poll(&name, sample);                                                          \
    }                                                                                                        \
    static uint32_t name##_due_us(void) { return fathom_##name##_due_us(&name); }                            \
    static fathom_sensor_t name##_sensor(void) { return fathom_##name##_sensor(&name); }

/* One of its functions, for the table. */
#define CAN(name, verb) CAN_BY(name, verb, fathom_##name##_##verb)
#define CAN_BY(name, verb, function)                                                                         \
    static void name##_##verb(void) { function(&name); }

/* What those that are asked tell of the asking. */
#define TELLS(name)                                                                                          \
    static uint8_t name##_exception(void) { return fathom_##name##_exception(&name); }                       \
    static const fathom_modbus_unit_t *name##_unit(void) { return fathom_##name##_unit(&name); }

#define ITSELF(d, its_kind)                                                                                  \
    .name = #d, .kind = &(its_kind), .prepare = d##_prepare, .init = d##_init,                               \
    .init_without_config = d##_init_without_config, .sensor = d##_sensor, .poll = d##_poll,                  \
    .due_us = d##_due_us, .memory = &(d), .size = sizeof(d), .config = &d##_config,                          \
    .config_size = sizeof d##_config

#define RANGE(d, its, least, most)                                                                           \
    {                                                                                                        \
        .what = #its, .member = &d##_config.its, .from = least, .to = most, .size = sizeof d##_config.its    \
    }
#define IS(d, its, value) RANGE(d, its, value, value)
#define NONE(its)                                                                                            \
    {                                                                                                        \
        .what = #its, .member = &(its), .size = sizeof(its)                                                  \
    }
#define STALE(d)  IS(d, stale_us, 0x80000000), IS(d, stale_us, 0xFFFFFFFE)
#define STREAM(d) STALE(d), IS(d, gap_us, 1), IS(d, gap_us, 1041) /* a character at 9600 8N1: 1041.7 us */

/* A fact of the model that the config names. */
#define FACT(d, its, value)                                                                                  \
    {                                                                                                        \
        .what = #its, .member = &d##_facts.its, .from = value, .to = value, .size = sizeof d##_facts.its,    \
        .is_fact = true                                                                                      \
    }
#define MODEL(d, most)                                                                                       \
    FACT(d, min_mm, most + 1), FACT(d, max_mm, 0), FACT(d, value_fffb, 1), FACT(d, value_fffb, 9),           \
        FACT(d, value_fffd, 5), FACT(d, value_0, 255)

/* ---- on the transport of Modbus ---- */

static fathom_status_t desk_has_said(const contract_driver_t *driver, uint16_t value)
{
    static uint16_t values[4];
    const uint16_t figures[4] = {value, 0xDCB2, 0x0701, 0x0000}; /* as an HPS-167S has them in #5 */
    memcpy(values, figures, sizeof values);
    desk_waits(5000000);
    assert_non_null(fake.request);
    fake.heard_us = contract_came_us = fake.now_us + 700;
    contract_slack_us = 0;
    fake_modbus_response(&fake, values, driver->count);
    fake.submits = 0;
    return desk_poll_after(1000);
}

static void desk_breaks(bool on) { fake.transport = on ? FATHOM_ERR_PORT : FATHOM_PENDING; }
static bool desk_is_used(void) { return fake.submits + fake.polls + fake.cancels != 0; }
static bool desk_is_at_work(void) { return fake.request != NULL; }

static const contract_kind_t on_transport = {desk_begin,   desk_poll,    desk_has_said,
                                             desk_breaks,  desk_is_used, desk_is_at_work,
                                             &desk.sensor, &desk.sample, &fake.now_us};

#define ON_TRANSPORT(d)                                                                                      \
    ITSELF(d, on_transport),                                                                                 \
        .deinit = d##_deinit, .command = d##_command, .cancel = d##_cancel, .exception = d##_exception,      \
        .unit = d##_unit, .address = &d##_config.modbus.address, .retries = &d##_config.modbus.retries,      \
        .period_us = &d##_config.modbus.period_us, .timeout_us = &d##_config.modbus.timeout_us,              \
        .command_timeout_us = &d##_config.modbus.command_timeout_us,                                         \
        .backoff_us = &d##_config.modbus.backoff_us

#define COUNTS(of) .sequence = &(of).sequence, .implausible = &(of).implausible
#define DYP(d, its_response, most, its_model, its_unit)                                                      \
    .facts = &d##_facts, .max_mm = most, .good = 1953, .other = 511, .refused = (most) + 1,                  \
    COUNTS(its_response),                                                                                    \
    .sample = {                                                                                              \
        .raw = 1953, .distance_mm = 1953, .kind = FATHOM_TARGET, .model = its_model, .address = its_unit}

DRIVER_OF_MODEL(a16_modbus, (transport), transport = &fake.modbus, .value = FATHOM_PROCESSED)
CAN(a16_modbus, deinit)
CAN(a16_modbus, power_on)
CAN(a16_modbus, cancel)
TELLS(a16_modbus)
static fathom_status_t a16_modbus_command(void)
{
    uint8_t address;
    return fathom_a16_modbus_get_address(&a16_modbus, &address);
}

const contract_driver_t contract_a16_modbus = {
    ON_TRANSPORT(a16_modbus),
    DYP(a16_modbus, a16_modbus.base.measurement, 16350, FATHOM_A16, 1),
    .first = 0x0100,
    .count = 1,
    .most_address = 254,
    .least_period_us = 120000,
    .default_timeout_us = 1000000,
    .start_us = &a16_modbus_config.start_us,
    .power_on = a16_modbus_power_on,
    .wrong = {NONE(transport), IS(a16_modbus, modbus.address, 255), RANGE(a16_modbus, value, 2, 255),
              MODEL(a16_modbus, 16350)}};

DRIVER_OF_MODEL(a05_modbus, (transport), transport = &fake.modbus, .probes = 1)
CAN(a05_modbus, deinit)
CAN(a05_modbus, power_on)
CAN(a05_modbus, cancel)
TELLS(a05_modbus)
static fathom_status_t a05_modbus_command(void)
{
    uint8_t address;
    return fathom_a05_modbus_get_address(&a05_modbus, &address);
}

const contract_driver_t contract_a05_modbus = {
    ON_TRANSPORT(a05_modbus),
    DYP(a05_modbus, a05_modbus.base.measurement, 6000, FATHOM_A05, 1),
    .first = 0x0106,
    .count = 1,
    .most_address = 254,
    .least_period_us = 100000,
    .default_timeout_us = 300000,
    .start_us = &a05_modbus_config.start_us,
    .power_on = a05_modbus_power_on,
    .wrong = {NONE(transport), IS(a05_modbus, modbus.address, 255), RANGE(a05_modbus, probes, 16, 255),
              MODEL(a05_modbus, 6000), RANGE(a05_modbus, registers, 1, 0x000F),
              RANGE(a05_modbus, registers, 0x0011, 0x0105), RANGE(a05_modbus, registers, 0x0107, 0x0200)}};

DRIVER(hps167s, (transport), transport = &fake.modbus, 0)
CAN(hps167s, deinit)
CAN(hps167s, cancel)
TELLS(hps167s)
static fathom_status_t hps167s_command(void)
{
    fathom_hps167s_version_t version;
    return fathom_hps167s_get_interface_version(&hps167s, &version);
}

/* Command #5: 2.083 m, (DCB2 << 7) / 10000 = 723.1744, ambient 1, precision 0. */
#define HPS_FIGURES                                                                                          \
    .raw = 2083, .distance_mm = 2083, .kind = FATHOM_TARGET, .model = FATHOM_HPS167S, .address = 1,          \
    .ambient = 1, .magnitude = 7231744

const contract_driver_t contract_hps167s = {
    ON_TRANSPORT(hps167s),
    .good = 2083,
    .other = 511,
    .refused = 31000,
    .sample = {HPS_FIGURES},
    COUNTS(hps167s),
    .first = 0x0008,
    .count = 4,
    .most_address = 32,
    .least_period_us = 18519,
    .default_timeout_us = 500000,
    .wrong = {NONE(transport), RANGE(hps167s, modbus.address, 33, 255), IS(hps167s, modbus.address_zero, 1),
              RANGE(hps167s, same_responses, 9, 255)}};

/* ---- on a line ---- */

static void line_begins(uint32_t now_us)
{
    rig_start(now_us);
    fake_pin_init(&controlled.pin, &rig.fake);
}

static void line_breaks(bool on) { rig.fake.read_fails = on; }

static bool line_is_used(void)
{
    return rig.line.listener != NULL ||
           rig.fake.reads + rig.fake.written + rig.fake.breaks + controlled.pin.sets != 0;
}

static bool line_is_at_work(void)
{
    return rig.line.listener != NULL || rig.line.head != NULL || rig.fake.in_break;
}

#define LINE_KIND(says, is_at_work)                                                                          \
    {                                                                                                        \
        line_begins, rig_poll, says, line_breaks, line_is_used, is_at_work, &rig.sensor, &rig.sample,        \
            &rig.fake.now_us                                                                                 \
    }

static size_t a16_frame(uint8_t *frame, uint16_t value) { return rig_dyp_stream(frame, &value, 1); }

/* Probe 1's value; what is not fitted sends what nothing can mean. */
static size_t a05_frame(uint8_t *frame, uint16_t value)
{
    const uint16_t values[] = {value, 0xFFFF, 0xFFFF, 0xFFFF};
    return rig_dyp_stream(frame, values, 4);
}

static size_t hps_frame(uint8_t *frame, uint16_t value)
{
    rig_hps_frame(frame, 1, value, 0xDCB2, 0x0701, 0x0000);
    return RIG_HPS_LENGTH;
}

/* It sends by itself. */
static fathom_status_t has_sent(const contract_driver_t *driver, uint16_t value)
{
    uint8_t frame[RIG_HPS_LENGTH];
    contract_came_us = rig.fake.now_us + RIG_PERIOD_US - rig.silent_us;
    contract_slack_us = 0;
    return rig_send(frame, driver->frame(frame, value), 500);
}

static const contract_kind_t listening = LINE_KIND(has_sent, line_is_at_work);

#define LISTENS(d) ITSELF(d, listening), .deinit = d##_deinit, .stale_us = &d##_config.stale_us

DRIVER_OF_MODEL(a16_auto, (line), line = &rig.line, .value = FATHOM_PROCESSED)
CAN(a16_auto, deinit)

const contract_driver_t contract_a16_auto = {LISTENS(a16_auto), .gap_us = &a16_auto_config.gap_us,
                                             DYP(a16_auto, a16_auto.base.measurement, 16350, FATHOM_A16, 0),
                                             .frame = a16_frame,
                                             .wrong = {NONE(line), STREAM(a16_auto), MODEL(a16_auto, 16350)}};

DRIVER_OF_MODEL(a05_auto, (line), line = &rig.line, .probes = 1)
CAN(a05_auto, deinit)

const contract_driver_t contract_a05_auto = {
    LISTENS(a05_auto), .gap_us = &a05_auto_config.gap_us,
    DYP(a05_auto, a05_auto.base.measurement, 6000, FATHOM_A05, 0), .frame = a05_frame,
    .wrong = {NONE(line), STREAM(a05_auto), RANGE(a05_auto, probes, 16, 255), MODEL(a05_auto, 6000)}};

DRIVER(hps167s_auto, (line), line = &rig.line, 0)
CAN(hps167s_auto, deinit)

const contract_driver_t contract_hps167s_auto = {
    LISTENS(hps167s_auto), .frame = hps_frame,
    .good = 2083,          .other = 511,
    .refused = 31000,      .sample = {HPS_FIGURES},
    COUNTS(hps167s_auto),  .wrong = {NONE(line), STALE(hps167s_auto), RANGE(hps167s_auto, address, 33, 255)}};

/* It is asked with frames of its own; the response is there at once. */
static fathom_status_t is_asked(const contract_driver_t *driver, uint16_t value)
{
    uint8_t frame[RIG_HPS167_LENGTH];
    for (unsigned polls = 0; rig.fake.written == 0; polls++) {
        assert_true(polls < 20000);
        rig.fake.now_us += 200;
        PENDS(rig_poll());
    }
    rig_run(70 * MS, 200);
    rig.fake.written = 0;
    fake_receive(&rig.fake, 0, frame, driver->frame(frame, value));
    contract_came_us = rig.fake.now_us;
    contract_slack_us = 0;
    return rig_poll();
}

/* A05 2(3)4 of probe 1: 55 AA 01 10, and 55 + AA + 01 + 10 = 110. */
static size_t a05_dyp_stream(uint8_t *frame, uint16_t value)
{
    const uint8_t bytes[] = {
        0x55, 0xAA, 0x01, 0x10, HIGH(value), LOW(value), LOW(0x10 + HIGH(value) + LOW(value))};
    memcpy(frame, bytes, sizeof bytes);
    return sizeof bytes;
}

static const contract_kind_t asked_on_line = LINE_KIND(is_asked, line_is_at_work);

DRIVER_OF_MODEL(a05_dyp, (line), line = &rig.line, .probes = 1)
CAN(a05_dyp, deinit)
CAN(a05_dyp, power_on)

const contract_driver_t contract_a05_dyp = {ITSELF(a05_dyp, asked_on_line),
                                            DYP(a05_dyp, a05_dyp.base.measurement, 6000, FATHOM_A05, 1),
                                            .deinit = a05_dyp_deinit,
                                            .power_on = a05_dyp_power_on,
                                            .start_us = &a05_dyp_config.start_us,
                                            .frame = a05_dyp_stream,
                                            .wrong = {NONE(line), IS(a05_dyp, modbus.address, 255),
                                                      IS(a05_dyp, modbus.address_zero, 1),
                                                      RANGE(a05_dyp, probes, 16, 255), MODEL(a05_dyp, 6000)}};

static size_t hps167_frame(uint8_t *frame, uint16_t value)
{
    rig_hps167_frame(frame, value, 0xDCB2, 0x0701, 0x0000);
    return RIG_HPS167_LENGTH;
}

DRIVER(hps167_uart, (line), line = &rig.line, 0)
CAN(hps167_uart, deinit)
CAN(hps167_uart, power_on)

const contract_driver_t contract_hps167_uart = {
    ITSELF(hps167_uart, asked_on_line),
    .good = 2083,
    .other = 511,
    .refused = 31000,
    .sample = {.raw = 2083,
               .distance_mm = 2083,
               .kind = FATHOM_TARGET,
               .model = FATHOM_HPS167S,
               .ambient = 1,
               .magnitude = 7231744},
    COUNTS(hps167_uart),
    .deinit = hps167_uart_deinit,
    .power_on = hps167_uart_power_on,
    .start_us = &hps167_uart_config.start_us,
    .frame = hps167_frame,
    .wrong = {NONE(line), RANGE(hps167_uart, modbus.address, 1, 255), IS(hps167_uart, modbus.address_zero, 1),
              STALE(hps167_uart)}};

/* ---- triggered ---- */

static fathom_status_t is_triggered(const contract_driver_t *driver, uint16_t value)
{
    uint8_t frame[4];
    controlled_run_to_break(rig.fake.breaks + 1, 100);
    contract_came_us = rig.fake.now_us + 100 * MS;
    contract_slack_us = 100;
    driver->frame(frame, value);
    controlled_response(frame, 100 * MS);
    return controlled_outcome(100);
}

static const contract_kind_t triggered = LINE_KIND(is_triggered, line_is_at_work);

static void prepare_break(void)
{
    line = &rig.line;
    output = fathom_output_line_break(&rig.line);
    trigger = &output;
}

DRIVER_OF_MODEL(a16_controlled, (line, trigger), prepare_break(), .period_us = 0)
CAN(a16_controlled, deinit)

const contract_driver_t contract_a16_controlled = {
    ITSELF(a16_controlled, triggered), DYP(a16_controlled, a16_controlled.measurement, 16350, FATHOM_A16, 0),
    .deinit = a16_controlled_deinit, .frame = a16_frame,
    .wrong = {NONE(line), NONE(trigger), NONE(output.set), FACT(a16_controlled, earliest_ms, 131),
              FACT(a16_controlled, latest_ms, 79), FACT(a16_controlled, trigger_us, 60001),
              IS(a16_controlled, period_us, 0x80000000), IS(a16_controlled, gap_us, 1),
              IS(a16_controlled, gap_us, 1041), MODEL(a16_controlled, 16350)}};

/* A pulse so wide, 110 ms after the trigger. */
static fathom_status_t has_pulsed(const contract_driver_t *driver, uint16_t value)
{
    fathom_status_t status = FATHOM_PENDING;
    controlled.pin.response_after_us = 110 * MS;
    controlled.pin.response_width_us = value;
    contract_slack_us = 0;
    for (unsigned polls = 0; status == FATHOM_PENDING; polls++) {
        assert_true(polls < 100);
        contract_came_us = controlled.pin.fall_us + 110 * MS + value;
        rig.fake.now_us += 20 * MS;
        status = rig_poll();
    }
    return status;
}

static bool is_low(void) { return !controlled.pin.level; }

static const contract_kind_t pulsing = LINE_KIND(has_pulsed, is_low);

static void prepare_pulse(void)
{
    capture = &controlled.pin.capture;
    its_clock = &rig.fake.clock;
    output = fathom_output_pin(&controlled.pin.trigger);
    trigger = &output;
}

DRIVER_OF_MODEL(a16_pwm, (capture, its_clock, trigger), prepare_pulse(), .in_air = false)
CAN(a16_pwm, deinit)

const contract_driver_t contract_a16_pwm = {
    ITSELF(a16_pwm, pulsing),
    .deinit = a16_pwm_deinit,
    .good = 10000,
    /* A16 1(4): 173.9 cm */ .other = 20000,
    .sample = {.raw = 10000, .distance_mm = 1739, .kind = FATHOM_TARGET, .model = FATHOM_A16},
    COUNTS(a16_pwm),
    .wrong = {NONE(its_clock), NONE(capture), NONE(trigger), NONE(output.set), FACT(a16_pwm, min_mm, 18001),
              FACT(a16_pwm, max_mm, 0), FACT(a16_pwm, us_per_dm, 0), FACT(a16_pwm, trigger_us, 60001),
              FACT(a16_pwm, no_target_ms, 1), FACT(a16_pwm, no_target_ms, 2),
              FACT(a16_pwm, no_target_ms, 211), IS(a16_pwm, period_us, 0x80000000)}};

/* ---- contacts ---- */

static fathom_status_t has_turned(const contract_driver_t *driver, uint16_t value)
{
    fathom_status_t status = FATHOM_PENDING;
    rig.level = value != 0;
    contract_came_us = rig.fake.now_us + 1000;
    contract_slack_us = 0;
    for (unsigned ms = 0; status == FATHOM_PENDING && ms != 200; ms++) {
        rig.fake.now_us += 1000;
        status = rig_poll();
    }
    return status;
}

static bool pin_is_used(void) { return false; }

static const contract_kind_t contact = {.begin = rig_start,
                                        .poll = rig_poll,
                                        .says = has_turned,
                                        .is_used = pin_is_used,
                                        .sensor = &rig.sensor,
                                        .sample = &rig.sample,
                                        .now_us = &rig.fake.now_us};

static void prepare_pin(void)
{
    pin = &rig.pin;
    its_clock = &rig.fake.clock;
}

DRIVER(a16_switch, (pin, its_clock), prepare_pin(), .address = 5)

const contract_driver_t contract_a16_switch = {
    ITSELF(a16_switch, contact), .good = 1,
    .sample = {.raw = 1, .kind = FATHOM_NEAR, .model = FATHOM_A16, .address = 5},
    .timing = &a16_switch_config.timing, .wrong = {NONE(pin), NONE(its_clock)}};

DRIVER(a05_relay, (pin, its_clock), prepare_pin(), .level = 0)

const contract_driver_t contract_a05_relay = {
    ITSELF(a05_relay, contact), .good = 1, .sample = {.raw = 1, .kind = FATHOM_FAR, .model = FATHOM_A05},
    .timing = &a05_relay_config.timing,
    .wrong = {NONE(pin), NONE(its_clock), IS(a05_relay, wiring, 3), IS(a05_relay, level, 3)}};
