/* SPDX-License-Identifier: MIT */
/* What `fathom scan` finds, how long it takes, what it makes of sensors that send automatically, two units with one
 * address, other devices, other protocols and another master, and that it harms no device. */
#include <stdlib.h>
#include <string.h>

#include "commands/scan/scan.h"
#include "sim/fault.h"
#include "tool_bench.h"

/* ---- a line with simulated devices, of which each request is read ---- */

enum { UNITS = 4, RATES = 6 };

static struct {
    fathom_sim_a16_t a16[UNITS];
    fathom_sim_a05_t a05[UNITS];
    fathom_sim_hps167s_t hps167s[UNITS];
    unsigned a16_count, a05_count, hps167s_count;
    fathom_uart_t inner;    /* of the line */
    uint32_t coarse_us;     /* not 0: the main loop runs once in this time */
    uint32_t refused_baud;  /* a rate that the port does not have */
    uint32_t lost_register; /* requests for this register do not reach the line */
    bool is_broken;         /* the port fails when it reads */
    unsigned requests;
    unsigned harmful;  /* requests that a scan may not send */
    uint32_t first_us; /* time from the start of the command to its first request */
    uint32_t start_us;
    unsigned probed[RATES][3]; /* first requests, by rate and parity */
} scans;

static const tool_run_t *last;
static uint32_t stranger_us; /* of the stranger below: time to its response; 0: 5 ms */

static const fathom_line_settings_t dyp_line = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t relatives_line = {115200, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t hps167s_line = {19200, FATHOM_PARITY_EVEN, 1};

/* "Which address has the one unit of the line?" */
static const uint8_t any_unit[8] = {0xFF, 0x03, 0x02, 0x00, 0x00, 0x01, 0x90, 0x6C};

/* A scan may send function 03 of a register other than 0009 to one unit, 55 AA FF 10, "probe 1 of any A05", or any_unit.
 * An A16 and an A05 can have address 0, but no HPS-167S has their registers. */
static bool is_harmless(const uint8_t *bytes, size_t length)
{
    static const uint8_t any[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E}; /* 55 + AA + FF + 10 = 20E */
    if (bytes[0] == 0x55 && bytes[1] == 0xAA) return length == sizeof any && memcmp(bytes, any, length) == 0;
    if (length != 8 || bytes[1] != 0x03) return false;
    if (bytes[0] == 0xFF) return memcmp(bytes, any_unit, sizeof any_unit) == 0;
    return bytes[0] == 0 ? bytes[2] != 0 : bytes[2] != 0x00 || bytes[3] != 0x09;
}

static unsigned rate_index(uint32_t baud)
{
    static const uint32_t rates[RATES] = {9600, 19200, 57600, 115200, 230400, 38400};
    unsigned i = 0;
    while (i != RATES - 1 && rates[i] != baud) i++;
    return i;
}

static int bench_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_line_settings_t *const line = &bench.line.settings;
    if (scans.lost_register != 0 && bytes[3] == scans.lost_register) return (int)length;
    const int n = scans.inner.write(scans.inner.ctx, bytes, length);
    if (n <= 0) return n;
    if (scans.requests++ == 0) scans.first_us = fathom_elapsed_us(bench.clock.now_us, scans.start_us);
    if (!is_harmless(bytes, length)) scans.harmful++;
    /* The first request to an address reads 0001 or 0200. */
    if (bytes[0] != 0xFF &&
        ((bytes[2] == 0x00 && bytes[3] == 0x01) || (bytes[2] == 0x02 && bytes[3] == 0x00)))
        scans.probed[rate_index(line->baud)][line->parity]++;
    return n;
}

static int bench_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return scans.is_broken && scans.requests != 0 ? -1
                                                  : scans.inner.read(scans.inner.ctx, bytes, capacity, rx);
}

static int bench_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    return settings->baud == scans.refused_baud ? -1 : scans.inner.set_line(scans.inner.ctx, settings);
}

static void idle(void *ctx, uint32_t max_us)
{
    if (scans.coarse_us != 0)
        fathom_sim_clock_advance(&bench.clock, scans.coarse_us);
    else
        fathom_sim_clock_idle(&bench.clock, max_us);
}

static void scan_begin(void)
{
    memset(&scans, 0, sizeof scans);
    stranger_us = 0;
    bench_begin();
    scans.inner = bench.tool.uart;
    bench.tool.uart.read = bench_read;
    bench.tool.uart.write = bench_write;
    bench.tool.uart.set_line = bench_set_line;
    bench.tool.idle = idle;
}

EACH_BEGINS(scan_begin())
static const suite_t suite = {.set_up = begins};

/* ---- the sensors ---- */

static fathom_sim_device_t *attach(fathom_sim_device_t *device)
{
    fathom_sim_attach(&bench.line, device, bench.clock.now_us);
    return device;
}

#define ADD(model, set_mode)                                                                                 \
    static fathom_sim_device_t *add_##model(fathom_sim_##model##_config_t config)                            \
    {                                                                                                        \
        assert_true(scans.model##_count < UNITS);                                                            \
        fathom_sim_##model##_t *const unit = &scans.model[scans.model##_count++];                            \
        set_mode;                                                                                            \
        fathom_sim_##model##_init(unit, &config);                                                            \
        return attach(&unit->device);                                                                        \
    }

ADD(a16, if (config.mode == 0) config.mode = FATHOM_SIM_A16_MODBUS)
ADD(a05, if (config.mode == 0) config.mode = FATHOM_SIM_A05_MODBUS)
ADD(hps167s, (void)0)

/* Makes responses of a device fail: a kind of port/sim/fault.h, by chance (in millionths) or at one frame. */
static const fathom_sim_fault_t *add_fault(fathom_sim_device_t *device, uint8_t kind, uint32_t chance_ppm,
                                           uint32_t at_frame, uint32_t seed)
{
    static fathom_sim_fault_t faults[UNITS];
    static unsigned count;
    fathom_sim_fault_t *const fault = &faults[count++ % UNITS];
    fathom_sim_fault_init(fault, seed);
    assert_non_null(fathom_sim_fault_add(fault, kind, chance_ppm, at_frame));
    fathom_sim_fault_attach(fault, &bench.line, device);
    return fault;
}

/* ---- devices that are none of the three sensors; one of each kind at a time ---- */

/* Responds to reads in Modbus. */
typedef struct {
    uint16_t value;    /* of every register, ... */
    uint16_t version;  /* ... except from 0001 on, where an HPS-167S has its interface version (#1) */
    uint16_t address;  /* ... and in 0200 */
    uint16_t only[3];  /* not 0: the only registers to which it responds */
    uint16_t second;   /* not 0: the value of 0101 */
    uint8_t exception; /* not 0: it responds with this exception, ... */
    bool answers_any;  /* at address 255, from its own */
    bool refuses;      /* ... but only to reads of other registers than `only` */
} stranger_t;

static stranger_t stranger;

static uint16_t first_of(const fathom_modbus_message_t *message)
{
    return (uint16_t)(message->head[2] * 256u + message->head[3]);
}

static uint32_t stranger_request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    const uint16_t first = first_of(message);
    const bool is_known = stranger.only[0] == 0 || first == stranger.only[0] || first == stranger.only[1] ||
                          first == stranger.only[2];
    if (!is_known && !stranger.refuses) return FATHOM_NO_DEADLINE;
    if (!is_known || !stranger.refuses) message->exception = stranger.exception;
    return stranger_us != 0 ? stranger_us : 5000;
}

static void stranger_fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    const uint16_t first = first_of(message);
    for (uint8_t i = 0; i != message->head[5]; i++)
        message->values[i] = first == 0x0001 ? stranger.version : stranger.value;
    if (first == 0x0200) message->values[0] = stranger.address;
    if (first == 0x0101 && stranger.second != 0) message->values[0] = stranger.second;
}

static void add_stranger(uint8_t unit, stranger_t with, const fathom_line_settings_t *line)
{
    static const fathom_sim_model_t model = {
        .request = stranger_request, .fill = stranger_fill, .broadcast = FATHOM_LINE_ANY_UNIT};
    static fathom_sim_device_t device;
    stranger = with;
    device = (fathom_sim_device_t){.model = &model,
                                   .settings = *line,
                                   .address = unit,
                                   .listens = true,
                                   .answers_broadcast = with.answers_any,
                                   .protocols = {&fathom_sim_modbus}};
    attach(&device);
}

/* The response of the example in HPS-167S #5; A16 6, the first example: a request to address 1 for 0100 and its
 * response; and bytes of no protocol. */
static const uint8_t hps_response[13] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                         0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
static const uint8_t a16_request[8] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
static const uint8_t a16_response[7] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};
static const uint8_t junk[6] = {0x02, 0x84, 0x31, 0x90, 0x11, 0xE7};

static const uint8_t *speech;
static uint8_t speech_length;

static uint8_t speak(fathom_sim_device_t *device, uint8_t *bytes, uint32_t now_us)
{
    memcpy(bytes, speech, speech_length);
    return speech_length;
}

static bool speaker_hear(fathom_sim_device_t *device, const uint8_t *frame, uint8_t length, uint32_t now_us)
{
    static const fathom_sim_protocol_t reply = {speaker_hear, speak, NULL, 0};
    if (device->address != 0 && frame[0] != device->address) return true;
    device->reply_settings = device->settings;
    fathom_sim_device_reply(device, &reply, 5000);
    return true;
}

/* Sends the same bytes every `period_us`, or (0) as the response to each frame. `address` of the returned device, if it
 * is not 0: only to frames that begin with it. */
static fathom_sim_device_t *add_speaker(const fathom_line_settings_t *line, uint32_t period_us,
                                        const uint8_t *bytes, uint8_t length)
{
    static const fathom_sim_model_t model = {.automatic = speak};
    static const fathom_sim_protocol_t protocol = {speaker_hear, speak, NULL, 0};
    static fathom_sim_device_t device;
    speech = bytes;
    speech_length = length;
    device = (fathom_sim_device_t){.model = &model,
                                   .settings = *line,
                                   .period_us = period_us,
                                   .listens = period_us == 0,
                                   .protocols = {&protocol}};
    return attach(&device);
}

/* ---- the command ---- */

static void assert_unharmed(const fathom_sim_device_t *device)
{
    assert_int_equal(device->counters.writes, 0);
    assert_int_equal(device->counters.resets, 0);
    assert_int_equal(device->counters.resets_refused, 0);
}

/* Runs `fathom scan --port line` with more options. Fails if a request could have changed a device. */
static const tool_run_t *scan(const char *options)
{
    memset(scans.probed, 0, sizeof scans.probed);
    scans.requests = 0;
    scans.start_us = bench.clock.now_us;
    last = tool_run(&bench.tool, "scan --port line %s", options);
    assert_int_equal(scans.harmful, 0);
    for (unsigned i = 0; i != UNITS; i++) {
        assert_unharmed(&scans.a16[i].device);
        assert_unharmed(&scans.a05[i].device);
        assert_unharmed(&scans.hps167s[i].device);
    }
    return last;
}

/* Returns the findings of the last scan, one like "a16 1 9600 8N1", or "? - 9600 8N1" without a name and an address,
 * separated by ", ". */
static const char *scan_found(void)
{
    static char found[8192];
    found[0] = '\0';
    for (const char *line = last->out; *line != '\0'; line = strchr(line, '\n') + 1) {
        char name[9], address[13], settings[12];
        const size_t length = strlen(found);
        assert_int_equal(sscanf(line, "%8s %12c %11[0-9 NEO]", name, address, settings), 3);
        const char *const number = address + (strncmp(address, "address ", 8) == 0 ? 8 : 0);
        (void)snprintf(found + length, sizeof found - length, "%s%s %.*s %.*s", length != 0 ? ", " : "", name,
                       (int)strcspn(number, " "), number, (int)(strrchr(settings, '1') + 1 - settings),
                       settings);
    }
    return found;
}

static const tool_run_t *scan_finds(const char *findings, const char *options)
{
    const tool_run_t *const run = scan(options);
    assert_string_equal(scan_found(), findings);
    return run;
}

/* On one of its two outputs. */
static void assert_says(const tool_run_t *run, const char *text)
{
    if (strstr(run->out, text) == NULL && strstr(run->err, text) == NULL)
        fail_msg("'%s' is not in\n%s%s", text, run->out, run->err);
}

/* A scan of the devices that were added finds these, and prints this text. */
#define FINDS(name, options, findings, text, ...)                                                            \
    TEST(name)                                                                                               \
    {                                                                                                        \
        __VA_ARGS__;                                                                                         \
        assert_says(scan_finds(findings, options), text);                                                    \
    }

#define A16(...)     (void)add_a16((fathom_sim_a16_config_t){__VA_ARGS__})
#define A05(...)     (void)add_a05((fathom_sim_a05_config_t){__VA_ARGS__})
#define HPS167S(...) (void)add_hps167s((fathom_sim_hps167s_config_t){__VA_ARGS__})

/* A device that responds adds at most this time to the estimate. */
enum { FOUND_US = 1500000 };

/* Address 4 is the dead one. */
#define EIGHT                                                                                                \
    "a16 1 9600 8N1, a16 2 9600 8N1, a05 3 9600 8N1, a05 5 9600 8N1, a16 9 9600 8N1, hps167s 6 19200 8E1, "  \
    "hps167s 7 19200 8E1, hps167s 8 19200 8E1"

/* Returns the sensor with address 2 or 7. */
static fathom_sim_device_t *two, *seven;
static void add_eight(void)
{
    scan_begin();
    A16(.address = 1, .seed = 1);
    two = add_a16((fathom_sim_a16_config_t){.address = 2, .seed = 2});
    A16(.address = 9, .seed = 9);
    A05(.address = 3, .seed = 3);
    A05(.address = 5, .seed = 5, .mode = FATHOM_SIM_A05_DYP);
    HPS167S(.address = 6, .seed = 6, .no_termination = true);
    seven = add_hps167s((fathom_sim_hps167s_config_t){.address = 7, .seed = 7});
    HPS167S(.address = 8, .seed = 8);
}

/* Returns the time that --estimate states, in microseconds. */
static uint64_t estimate_us(const char *options)
{
    const tool_run_t *const run = tool_run(&bench.tool, "scan --estimate --format json %s", options);
    const char *const seconds = strstr(run->out, "\"duration_s\":");
    assert_non_null(seconds);
    assert_string_equal(run->err, "");
    return strtoull(seconds + strlen("\"duration_s\":"), NULL, 10) * 1000000u;
}

/* ---- what a scan finds ---- */

TEST(eight_sensors_of_three_models_are_found_and_their_identities_printed)
{
    add_eight();
    const uint64_t said_us = estimate_us("");
    const tool_run_t *run = scan_finds(EIGHT, "");
    assert_int_equal(run->status, 0);
    assert_true(run->took_us <= said_us + 8u * FOUND_US);
    /* HPS-167S #3: the example is version 3.9 of 2019-09-23 */
    assert_says(run,
                "hps167s  address 6    19200 8E1    interface 2.1.0 of 2020-09-27, sensor 3.9 of 2019-09-23, "
                "termination off  ->  fathom read hps167s:6:modbus --port line\n");
    assert_says(run, "termination on  ->  fathom read hps167s:8:modbus --port line\n");
    assert_says(run, "fathom: 2 sensors have their termination resistor on, the factory setting, which "
                     "overloads the line. ");
    assert_says(run, "with 'fathom set hps167s:ADDRESS --port line termination off'.\n");
    assert_says(run, "fathom: sensors found: 8, after ");
    assert_null(strstr(run->out, "twice"));

    add_eight();
    scans.coarse_us = 20000;
    (void)scan_finds(EIGHT, ""); /* by a main loop of 20 ms */

    add_eight();
    bench.line.echo = true;
    assert_null(strstr(scan_finds(EIGHT, "")->err, "another master"));
}

TEST(eight_sensors_are_found_although_one_is_noisy_and_another_damages_half_of_its_responses)
{
    uint32_t flipped = 0;
    for (uint32_t seed = 1; seed != 9; seed++) {
        add_eight();
        const fathom_sim_fault_t *const noise =
            add_fault(two, FATHOM_SIM_FAULT_NOISE, FATHOM_SIM_FAULT_ALWAYS_PPM, 0, seed);
        const fathom_sim_fault_t *const flips = add_fault(seven, FATHOM_SIM_FAULT_FLIP_BIT, 500000, 0, seed);
        (void)scan_finds(EIGHT, "");
        assert_true(noise->frames_hit >= 2);
        flipped += flips->frames_hit;
    }
    assert_true(flipped >= 8);
}

TEST(an_echo_alone_is_no_device_at_any_address)
{
    /* Neither is the echo of the requests to units 83 and 147, which looks like a response. */
    bench.line.echo = true;
    const tool_run_t *const run = scan_finds("", "--address 1-254");
    assert_int_equal(run->status, 1);
    assert_says(run, "only the tool's own request was received");

    scan_begin();
    bench.line.echo = true;
    A16(.address = 83);
    A05(.address = 147);
    (void)scan_finds("a16 83 9600 8N1, a05 147 9600 8N1", "--address 1-254");
}

TEST(a_sensor_at_another_rate_is_found_there_and_other_parities_are_not_tried)
{
    HPS167S(.address = 12, .baud_code = 2);
    assert_says(scan_finds("hps167s 12 57600 8E1", "--baud all --parity all"),
                "fathom read hps167s:12:modbus --port line --baud 57600\n");
    assert_int_equal(scans.probed[2][FATHOM_PARITY_EVEN], 32);
    assert_int_equal(scans.probed[2][FATHOM_PARITY_NONE], 31);
    assert_int_equal(scans.probed[2][FATHOM_PARITY_ODD], 31);
}

/* The time-out is 150 ms. */
FINDS(a_late_response_is_found_while_the_next_address_is_asked, "", "a16 5 9600 8N1, a16 3 9600 8N1",
      "sensors found: 2", A16(.address = 3, .settings_us = 250000), A16(.address = 5))

FINDS(an_a05_with_frames_55_aa_is_found_at_an_address_beyond_the_range, "", "a05 100 9600 8N1",
      "fathom read a05:100:dyp --port line\n", A05(.address = 100, .mode = FATHOM_SIM_A05_DYP))

FINDS(measurements_may_take_longer_than_the_first_response, "", "a16 1 9600 8N1, a05 2 9600 8N1", "found: 2",
      A16(.address = 1, .realtime_us = 290000), A05(.address = 2, .probe_us = 290000))

FINDS(sensors_that_refuse_instead_of_being_silent_are_found, "",
      "a16 1 9600 8N1, a05 2 9600 8N1, hps167s 3 19200 8E1", "found: 3",
      A16(.address = 1, .exceptions = true), A05(.address = 2, .exceptions = true),
      HPS167S(.address = 3, .wrong_length = FATHOM_MODBUS_ILLEGAL_DATA_VALUE))

FINDS(a_rate_that_the_port_does_not_have_is_left_out, "--baud 9600,230400,19200", "hps167s 1 19200 8E1",
      "fathom: this port does not have 230400 8E1, so the scan leaves it out.\n", HPS167S(.address = 1),
      scans.refused_baud = 230400)

TEST(a_port_that_does_not_have_the_settings_of_a_sensor_is_named_as_the_cause)
{
    A16(.address = 1);
    scans.refused_baud = 19200;
    assert_says(tool_run(&bench.tool, "read a16:1:modbus hps167s:7 --port line --count 1"),
                ": the port does not support this, and nothing was sent. Choose other line settings or "
                "another adapter");
}

FINDS(the_result_names_the_settings_that_were_left_out, "--baud 9600,230400,57600", "",
      ". Left out, since the port does not have them: 230400 8E1\n", scans.refused_baud = 230400)

TEST(a_scan_that_left_out_every_setting_has_asked_nothing_and_concludes_nothing)
{
    scans.refused_baud = 230400;
    const tool_run_t *const run = scan_finds("", "--baud 230400 --parity none,even");
    assert_non_null(
        strstr(run->err, "fathom: no request was sent, because the port has none of these settings."));
    assert_null(strstr(run->err, "no sensor was found"));
    assert_null(strstr(run->err, "sensors found"));
    assert_int_equal(run->status, 1);
    assert_int_equal(scans.requests, 0);
}

TEST(an_a16_at_address_0_is_found_and_no_broadcast_is_sent)
{
    A16(.address = 1);
    (void)scan_finds("", "--address 0 --baud 9600");
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 1);
    (void)scan_finds("", "--address 0 --baud 19200");
}

TEST(an_a05_whose_measurement_is_lost_once_is_found)
{
    fathom_sim_device_t *const a05 = add_a05((fathom_sim_a05_config_t){.address = 9});
    const fathom_sim_fault_t *const fault = add_fault(
        a05, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 2, 1); /* the first is that of 0200 */
    (void)scan_finds("a05 9 9600 8N1", "");
    assert_int_equal(fault->frames_hit, 1);
}

TEST(a_line_of_json_has_the_identity_and_the_next_command)
{
    HPS167S(.address = 13);
    assert_string_equal(
        scan("--address 13 --baud 19200 --format json")->out,
        "{\"kind\":\"sensor\",\"model\":\"hps167s\",\"address\":13,\"baud\":19200,\"parity\":\"even\","
        "\"stop_bits\":1,\"mode\":\"modbus\",\"interface_version\":\"2.1.0 of 2020-09-27\","
        "\"sensor_version\":\"3.9 of 2019-09-23\","
        "\"uuid\":\"00390025423457142034383501060705\",\"termination\":true,"
        "\"is_double\":false,\"next\":\"fathom read hps167s:13:modbus --port line\"}\n");
}

/* ---- how long it takes ---- */

TEST(every_address_at_every_rate_and_parity_takes_as_long_as_estimated_and_less_than_10_minutes)
{
    static const char everything[] = "--address 1-254 --baud all --parity all";
    const uint64_t said_us = estimate_us(everything);
    const tool_run_t *const run = scan_finds("", everything);
    assert_true(said_us < UINT64_C(600000000));
    assert_int_equal(
        scans.requests,
        /* one to any A05, two to any A16 or relative, and each address once more at two settings */
        254 * 5 * 3 + 3 + 2 * 254);
    for (unsigned rate = 0; rate != 5; rate++)
        for (unsigned parity = 0; parity != 3; parity++) assert_int_equal(scans.probed[rate][parity], 254);
    /* Simulated time has no late wake-ups, for which the estimate has 5 ms a request. It is a whole number of seconds. */
    assert_true(run->took_us <= said_us);
    assert_true(run->took_us + 254u * 17u * 5000u + 1015000u >= said_us);
    add_eight();
    assert_true(scan_finds(EIGHT, everything)->took_us <= said_us + 8u * FOUND_US);
    assert_true(last->took_us < UINT64_C(600000000));
}

/* Options, and what `scan --estimate` then prints: 8 + 32 * (0.163 + 0.113 + 0.110) + 0.755 + 0.313 is 21.4. */
static void estimates(void **state)
{
    const char *const *const row = *state;
    const tool_run_t *const run = tool_run(&bench.tool, "scan --estimate %s", row[0]);
    assert_int_equal(run->status, 0);
    assert_says(run, row[1]);
}

#define ESTIMATES(name, options, text)                                                                       \
    static const char *const row_##name[] = {options, text};                                                 \
    TEST_ROW(name, estimates, row_##name)

ESTIMATES(the_default_is_32_addresses_at_the_factory_settings_in_22_s, "",
          "addresses 1 to 32 at 9600 8N1, 19200 8E1: about 22 s, and a second for each sensor\n")
ESTIMATES(the_estimate_is_an_object, "--format json", "{\"settings\":2,\"addresses\":32,\"duration_s\":22}\n")
ESTIMATES(a_rate_counts_once_and_keeps_its_place, "--address 7 --baud 57600,9600,57600",
          "address 7 at 57600 8E1, 9600 8N1: about ")
ESTIMATES(each_rate_has_each_parity, "--parity odd,none",
          "at 9600 8N1, 9600 8O1, 19200 8N1, 19200 8O1: about ")
ESTIMATES(the_parity_of_the_factory_comes_first, "--baud 38400 --parity all",
          "at 38400 8E1, 38400 8N1, 38400 8O1: about ")
ESTIMATES(two_stop_bits_replace_the_parity, "--stop-bits 2", "at 9600 8N2, 19200 8N2: about ")
ESTIMATES(two_stop_bits_keep_a_given_parity, "--baud 19200 --parity even,none --stop-bits 2",
          "at 19200 8E2, 19200 8N2: about ")
ESTIMATES(all_rates_are_those_of_the_sensors, "--baud all",
          "at 9600 8N1, 19200 8E1, 57600 8E1, 115200 8E1, 115200 8N1, 230400 8E1: about ")
ESTIMATES(relatives_have_115200_8n1_too, "--baud 115200", "at 115200 8E1, 115200 8N1: about ")
ESTIMATES(relatives_have_one_stop_bit, "--baud 115200 --stop-bits 2", "at 115200 8N2: about ")
ESTIMATES(relatives_have_no_other_parity, "--baud 115200 --parity even", "at 115200 8E1: about ")
ESTIMATES(the_time_out_and_the_listening_count, "--address 5 --baud 19200 --timeout 2000 --listen 4",
          "about 7 s")
ESTIMATES(retries_count, "--address 5 --baud 19200 --timeout 2000 --listen 4 --retries 1", "about 11 s")

TEST(a_silent_address_is_asked_again_as_often_as_the_user_says)
{
    const uint64_t said_us = estimate_us("--retries 2 --address 1-4");
    const tool_run_t *run = scan_finds("", "--retries 2 --address 1-4");
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 4 * 3);
    assert_int_equal(scans.probed[1][FATHOM_PARITY_EVEN], 4 * 3);
    assert_true(run->took_us <= said_us);
    assert_says(run, "fathom: listens for 8 s, and then sends requests to addresses 1 to 4 at 9600 8N1, "
                     "19200 8E1: about 1");
}

TEST(an_address_has_150_ms_on_the_line_of_a16_and_a05_and_100_ms_elsewhere)
{
    /* The request to address 255 and that to address 1, each of 8 bytes of 10 bits, the time-out and as long again, in
     * which the unit may still respond; the same for 0100, with 100 ms; 5 bytes and a time-out for any A05; elsewhere 8
     * bytes of 11 bits and the time-out */
    static const struct {
        const char *options;
        uint32_t us;
    } rows[] = {
        {"--address 1 --baud 9600 --listen 1",
         1000000 + 2 * (8333 + 2 * 150000) + 8333 + 2 * 100000 + 5208 + 300000},
        {"--address 1 --baud 9600 --parity odd --listen 1", 1000000 + 9167 + 100000},
        {"--address 1 --baud 19200 --listen 1", 1000000 + 4583 + 100000},
        {"--address 1 --baud 19200 --listen 1 --timeout 400", 1000000 + 4583 + 400000},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        assert_in_range(scan(rows[i].options)->took_us, rows[i].us, rows[i].us + 10000);
}

/* ---- wrong usage ---- */

REFUSES(a_scan_needs_a_serial_port, "scan", {"", "--port is missing"},
        {"--port /nowhere a16", "accepts options only, not 'a16'"},
        {"--port tcp:127.0.0.1",
         "scan needs a serial port, or a converter that passes raw bytes (rtu-tcp:), not 'tcp:127.0.0.1'."},
        {"--port rtu-tcp:127.0.0.1:1 --baud 9600",
         "rtu-tcp:127.0.0.1:1 has no line settings: the converter has them. Leave --baud, --parity and "
         "--stop-bits out."},
        {"--port /nowhere --port /elsewhere", "--port is given twice"})

#define ADDRESSES "It takes an address from 1 to 254, a range such as 1-32, or 0."
REFUSES(a_wrong_range_of_addresses_is_refused, "scan --port line --address",
        {"0-5", "--address is '0-5'. " ADDRESSES}, {"255", ADDRESSES}, {"00", ADDRESSES},
        {"1-255", ADDRESSES}, {"9-8", ADDRESSES}, {"1-", ADDRESSES}, {"-5", ADDRESSES}, {"1-5-9", ADDRESSES})

REFUSES(a_wrong_list_is_refused, "scan --port line",
        {"--baud 4800", "--baud is '4800'. It takes all, or some of 9600, "},
        {"--baud All", "--baud is 'All'"}, {"--baud 9600,", "--baud is '9600,'"},
        {"--baud ,9600", "--baud is ',9600'"},
        {"--parity mark",
         "--parity is 'mark'. It takes all, or some of none, even and odd with commas between them."},
        {"--parity none,", "--parity is 'none,'"})

REFUSES(a_wrong_number_or_word_is_refused, "scan --port line",
        {"--stop-bits 0", "a whole number from 1 to 2"}, {"--timeout 0", "a whole number from 1 to 10000"},
        {"--retries 10", "a whole number from 0 to 9"}, {"--listen 0", "a whole number from 1 to 60"},
        {"--format csv", "--format is 'csv'. It takes text or json."}, {"--fast", "unknown option '--fast'"})

/* ---- how it ends ---- */

TEST(ctrl_c_ends_the_scan_at_once_and_keeps_what_was_found)
{
    for (uint64_t ms = 1; ms < 18000; ms += 331) {
        add_eight();
        bench.tool.ctrl_c_us = ms * 1000;
        const tool_run_t *const run = scan("");
        /* The signal ends a wait of the bench with the response, of which that to 0100 takes longest (520 ms). */
        assert_in_range(run->took_us, ms * 1000, ms * 1000 + 520000);
        assert_int_equal(run->status, run->out[0] != '\0' ? 0 : 1);
        assert_says(run, "fathom: the scan ended before its last address. Sensors found: ");
    }
}

TEST(a_port_that_fails_ends_the_scan)
{
    const tool_port_t port = {.path = "elsewhere"};
    add_eight();
    scans.is_broken = true;
    const tool_run_t *run = scan_finds("", "");
    assert_int_equal(run->status, 1);
    assert_says(run, "the port did not send the request in time. Check the adapter");
    bench.tool.ports = &port;
    bench.tool.port_count = 1;
    run = scan("");
    assert_int_equal(run->status, 1);
    assert_says(run, "fathom: line: no such device");
}

TEST(a_line_without_a_sound_is_explained)
{
    const tool_run_t *run = scan("--address 1");
    assert_int_equal(run->status, 1);
    assert_says(run, "no sensor was found at line: no byte was received. Check the power, whether A and B");
    assert_says(run, "sensors found: 0");
    assert_null(strstr(run->err, "--baud all")); /* the user chose the range */
    assert_says(scan(""),
                "run 'fathom scan --port line --address 1-254 --baud all --parity all' (about 8 minutes)");
}

TEST(neither_the_reset_nor_a_broadcast_can_be_sent)
{
    static const struct {
        uint16_t first;
        uint8_t count, address;
    } reads[] = {{0x0009, 1, 1},
                 {0x0009, SCAN_REGISTERS, 1},
                 {0x0008, 2, 1},
                 {0x0001, 3, 0}, /* unit 0 */
                 {0x0001, SCAN_REGISTERS + 1, 1} /* more than a response has room for */};
    static scan_t none;
    for (size_t i = 0; i != sizeof reads / sizeof reads[0]; i++) {
        none.read = (scan_read_t){.line = &hps167s_line,
                                  .first = reads[i].first,
                                  .count = reads[i].count,
                                  .address = reads[i].address};
        scan_ask(&none);
        assert_int_equal(none.read.status, FATHOM_ERR_ARGUMENT);
    }
}

/* ---- before the first request ---- */

/* A scan that heard a device and sent nothing. */
static const tool_run_t *hears(const char *finding, const char *text)
{
    const tool_run_t *const run = scan_finds(finding, "--listen 3");
    assert_int_equal(scans.requests, 0);
    assert_int_equal(bench.line.counters.from_host, 0);
    assert_says(run, "fathom: nothing was sent, because ");
    assert_says(run, "--wake");
    assert_says(run, text);
    return run;
}

TEST(a_silent_line_is_listened_to_for_as_long_as_the_user_says)
{
    A16(.address = 1);
    (void)scan_finds("a16 1 9600 8N1", "--listen 3");
    assert_in_range(scans.first_us, 3000000, 3010000);
}

TEST(an_a16_and_an_a05_that_send_automatically_are_named_and_nothing_is_sent)
{
    /* Some values have bytes that look like frames one byte later: 511 mm is FF 01 FF FF. */
    static fathom_sim_fixed_t scenes[] = {{{511, 511, 511, 511}},     {{1000, 2000, 2047, 1339}},
                                          {{-1, -1, -1, -1}},         {{65281, 0, 255, 65535}},
                                          {{1023, 1023, 1023, 1023}}, {{44543, 44543, 44543, 44543}}};
    for (unsigned i = 0; i != 4 * sizeof scenes / sizeof scenes[0]; i++) {
        const fathom_sim_scene_t scene = fathom_sim_fixed(&scenes[i / 4]);
        const tool_run_t *run;
        scan_begin();
        bench.line.full_duplex = true;
        scans.coarse_us = i % 2 != 0 ? 20000 : 0;
        if (i / 2 % 2 == 0) {
            A16(.mode = FATHOM_SIM_A16_AUTO, .scene = scene);
            run = hears("a16 - 9600 8N1",
                        "even a read ends the automatic output of an A16 with RS232, until power-off or ");
            assert_says(run,
                        "sends without requests: an A16 or a relative  ->  fathom read a16 --port line\n");
        } else {
            A05(.mode = FATHOM_SIM_A05_AUTO, .scene = scene);
            run = hears("a05 - 9600 8N1",
                        "even a read ends the automatic output of an A05 with UART, until power-off. ");
            assert_says(run, "sends without requests: an A05  ->  fathom read a05 --port line\n");
        }
        assert_int_equal(run->status, 0);
    }
}

FINDS(a_sensor_that_sends_automatically_is_asked_if_the_user_says_so, "--wake", "a16 7 9600 8N1",
      "the sensor sent automatically until the first request. It sends again after a power cycle, or after "
      "'fathom set a16:ADDRESS --port line automatic-output on'.",
      bench.line.full_duplex = true, A16(.address = 7, .mode = FATHOM_SIM_A16_AUTO))

TEST(a_sensor_that_hears_no_request_and_goes_on_sending_is_named)
{
    bench.line.full_duplex = true;
    A16(.address = 7, .mode = FATHOM_SIM_A16_UART);
    assert_null(strstr(scan_finds("a16 - 9600 8N1", "--wake")->err, "until the scan asked it"));
}

/* At first so often that the bytes at the wrong rate fill any memory, then with a rate that the port does not have. */
TEST(an_hps167s_that_sends_unsolicited_frames_is_found_at_its_rate)
{
    const fathom_line_settings_t fast = {115200, FATHOM_PARITY_EVEN, 1};
    for (unsigned i = 0; i != 2; i++) {
        scan_begin();
        scans.refused_baud = i != 0 ? 57600 : 0;
        (void)add_speaker(&fast, i != 0 ? 180000 : 40000, hps_response, sizeof hps_response);
        assert_says(
            hears("hps167s 1 115200 8E1", "requests would collide with its unsolicited frames"),
            "sends unsolicited responses  ->  fathom read hps167s:1:modbus --port line --baud 115200\n");
    }
}

TEST(a_relative_that_sends_at_115200_is_found_at_its_rate)
{
    static const uint8_t frame[4] = {0xFF, 0x07, 0xA1, 0xA7}; /* 1953 mm */
    (void)add_speaker(&relatives_line, 100000, frame, sizeof frame);
    assert_says(hears("a16 - 115200 8N1", "even a read ends the automatic output"),
                "an A16 or a relative  ->  fathom read a16 --port line --baud 115200\n");
}

/* The example of a public driver: 1753 mm. */
TEST(a_unit_that_speaks_like_an_hps167_is_named_and_no_more)
{
    static const uint8_t frame[15] = {0x0A, 0x0D, 0x01, 0x01, 0x01, 0x06, 0xD9, 0xFC,
                                      0x8C, 0x02, 0x01, 0x00, 0x01, 0x9B, 0x94};
    const fathom_line_settings_t *const lines[] = {&relatives_line, &dyp_line, &hps167s_line};
    const char *const found[] = {"? - 115200 8N1", "? - 9600 8N1", "? - 19200 8E1"};
    for (unsigned i = 0; i != 3; i++) {
        scan_begin();
        (void)add_speaker(lines[i], 100000, frame, sizeof frame);
        const tool_run_t *const run =
            hears(found[i], "a device sends without a request. To send requests anyway, use --wake.");
        assert_says(run, "speaks like an HPS-167; perhaps an HPS-167S of before 2020-09\n");
        assert_int_equal(run->status, 1);
        assert_non_null(strstr(scan("--listen 3 --format json")->out,
                               "{\"kind\":\"hps167\",\"model\":null,\"address\":null,"));
        assert_non_null(strstr(last->out, "\"perhaps\":\"perhaps an HPS-167S of before 2020-09\""));
    }
}

TEST(another_master_is_not_disturbed_and_unknown_bytes_are_a_sender)
{
    (void)add_speaker(&dyp_line, 500000, a16_request, sizeof a16_request);
    const tool_run_t *const run = hears("? 1 9600 8N1", "another master sends requests on this line");
    assert_says(run, "another master sends requests to this address\n");
    assert_int_equal(run->status, 1);

    scan_begin();
    (void)add_speaker(&dyp_line, 1000000, junk, sizeof junk); /* three times in 3 s */
    (void)hears("? - 9600 8N1", "a device sends without a request. An HPS-167S made before 2020-09");

    scan_begin();
    (void)add_speaker(&dyp_line, 2000000, junk, sizeof junk); /* once, which is noise */
    (void)scan_finds("", "--listen 3");
    assert_int_not_equal(scans.requests, 0);
}

/* ---- damaged responses ---- */

TEST(two_units_with_one_address_are_named_and_their_neighbours_found)
{
    for (uint32_t seed = 0; seed != 8; seed++) {
        scan_begin();
        A16(.address = 1, .seed = seed);
        A05(.address = 1, .seed = seed + 100);
        A16(.address = 2);
        HPS167S(.address = 4, .seed = seed);
        HPS167S(.address = 4, .seed = seed + 100);
        HPS167S(.address = 5);
        const tool_run_t *const run =
            scan_finds("a16 2 9600 8N1, ? 1 9600 8N1, hps167s 5 19200 8E1, ? 4 19200 8E1", "");
        assert_says(run, "damaged responses: two sensors with one address?\n");
        assert_says(run,
                    "address 1 at 9600 8N1: the responses are damaged: do two sensors have this address?");
        assert_says(run,
                    "address 4 at 19200 8E1: the responses are damaged: do two sensors have this address?");
    }
}

TEST(two_responses_to_one_request_are_two_units)
{
    /* One unit responds to 0200 after 17.5 to 20 ms, the other after 35 to 40: both responses are whole. */
    A16(.address = 6);
    A16(.address = 6, .settings_us = 40000);
    const tool_run_t *const run = scan_finds("? 6 9600 8N1", "");
    assert_says(run, "responds twice: two sensors with one address?\n");
    assert_says(run, "address 6 at 9600 8N1: a request had two responses: do two sensors have this address?");
}

TEST(one_spike_is_no_device)
{
    /* once, 1.2 s after the scan began to ask */
    const fathom_sim_device_t *const spike = add_speaker(&dyp_line, 2200000, junk, 1);
    const tool_run_t *const run = scan_finds("", "--baud 9600 --address 1-12 --listen 1"); /* 2 s */
    assert_true(spike->counters.automatic != 0);
    assert_says(run, "bytes were received, but no Modbus frame");
}

TEST(responses_that_are_not_modbus_are_one_finding)
{
    (void)add_speaker(&hps167s_line, 0, junk, sizeof junk);
    A16(.address = 3);
    assert_says(scan_finds("a16 3 9600 8N1, ? - 19200 8E1", ""),
                "fathom: 19200 8E1: a device responds, but not in Modbus. An HPS-167S made before 2020-09");
    /* 32 addresses, most of them asked twice and not four times */
    assert_in_range(scans.probed[1][FATHOM_PARITY_EVEN], 64, 80);
}

TEST(junk_from_one_address_of_two_is_damage_and_from_the_only_one_another_protocol)
{
    add_speaker(&dyp_line, 0, junk, sizeof junk)->address = 3;
    assert_says(scan_finds("? - 9600 8N1", "--address 3"), "a response that is not Modbus\n");
    const tool_run_t *const run = scan_finds("? 3 9600 8N1", "--address 3-4");
    assert_says(run, "damaged responses");
    assert_says(run, "fathom: no sensor was found. A sensor that was just switched on may need 5 s\n");
}

/* ---- other Modbus devices ---- */

static void is_other(stranger_t with, const fathom_line_settings_t *line)
{
    scan_begin();
    add_stranger(9, with, line);
    const tool_run_t *const run =
        scan_finds(line == &dyp_line ? "? 9 9600 8N1" : "? 9 19200 8E1", "--address 8-10");
    assert_says(run, "a Modbus device that is none of the known sensors");
    assert_says(run, "fathom: no sensor was found. A sensor that was just switched on may need 5 s\n");
    assert_int_equal(run->status, 1);
}

/* Devices that respond where an A16 has its distances, and refuse other registers or are silent there; and a gripper whose
 * 0200 happens to be its address. */
TEST(false_friends_are_no_sensors_and_are_named)
{
    static const struct {
        stranger_t with;
        const char *perhaps;
    } rows[] = {
        {{.value = 9, .second = 2},
         "probably a soil probe: 0x0100 is its address, and 0x0101 can be its baud code"},
        {{.value = 1, .second = 50},
         "probably a gripper: 0x0100 can be its start, and 0x0101 its force in percent"},
        {{.value = 80, .second = 132},
         "perhaps a solar charger: 0x0100 can be a charge in percent, and 0x0101 a voltage"},
        {{.value = 1530, .second = 1},
         "perhaps a fuel gauge (TENET UL212), a gripper, a charger, or a relative"},
        {{.value = 754, .second = 751}, "probably a relative without an address register"},
    };
    for (unsigned i = 0; i != 4 * sizeof rows / sizeof rows[0]; i++) {
        stranger_t with = rows[i / 4].with;
        char expected[200];
        const bool is_json = i % 2 != 0;
        (void)snprintf(expected, sizeof expected,
                       is_json ? "\"perhaps\":\"%s" : "none of the known sensors; %s", rows[i / 4].perhaps);
        with.only[0] = 0x0100;
        with.only[1] = 0x0101;
        with.refuses = i / 2 % 2 != 0;
        if (with.refuses) with.exception = FATHOM_MODBUS_ILLEGAL_DATA_ADDRESS;
        scan_begin();
        add_stranger(9, with, i % 4 == 0 ? &relatives_line : &dyp_line);
        const tool_run_t *const run =
            scan(is_json ? "--address 9 --format json" : "--address 8-10 --baud 9600,115200");
        assert_int_equal(run->status, 1);
        assert_says(run, expected);
    }
}

/* Of two devices that are silent at 0200: one that responds at 0100 after the time-out, and one beside a sensor. */
TEST(a_false_friend_that_is_silent_at_0200_is_found_between_sensors)
{
    A16(.address = 8);
    A16(.address = 10, .settings_us = 250000);
    add_stranger(9, (stranger_t){.value = 754, .only = {0x0100}}, &dyp_line);
    assert_says(scan_finds("a16 8 9600 8N1, ? 9 9600 8N1, a16 10 9600 8N1", "--address 7-11"),
                "; perhaps a fuel gauge (TENET UL212), ");
    scan_begin();
    stranger_us = 250000;
    add_stranger(9, (stranger_t){.value = 754, .only = {0x0100}}, &dyp_line);
    (void)scan_finds("? 9 9600 8N1", "--address 7-11");
}

/* Returns the finding of a device with these two distances and its address in 0200. */
static const char *with_distances(uint16_t processed, uint16_t real_time, const char *options)
{
    scan_begin();
    add_stranger(
        9,
        (stranger_t){.value = processed, .second = real_time, .address = 9, .only = {0x0100, 0x0101, 0x0200}},
        &dyp_line);
    return scan(options)->out;
}

TEST(an_address_in_0200_and_two_distances_that_agree_are_an_a16_or_a_relative)
{
    static const struct {
        uint16_t processed, real_time;
        const char *says;
    } rows[] = {
        {754, 751, "751 mm, an A16 or a relative with Modbus  ->  fathom read a16:9:modbus --port line\n"},
        {0xFFFD, 0xFFFE, ", an A16 or a relative with Modbus  ->"},
        {15, 16, " 16 mm, an A16 or a relative with Modbus  ->"},
        {752, 1003,
         " 1003 mm, probably an A16 or a relative with Modbus  ->"}, /* 4 * 251 is more than 1003 */
        {753, 1004, " 1004 mm, an A16 or a relative with Modbus  ->"},
        {754, 300, " 300 mm, probably an A16 or a relative with Modbus  ->"}, /* a moving target */
        {0, 300, " 300 mm, probably an A16 or a relative with Modbus  ->"},
        {14, 300, " 300 mm, probably an A16 or a relative with Modbus  ->"},
        {9, 2, "none of the known sensors; probably a soil probe: "},
        {1, 50, "none of the known sensors; probably a gripper: "},
        {14, 14, " 14 mm, probably an A16 or a relative with Modbus  ->"},
        {40000, 40000, "unknown (value 40000), probably an A16 or a relative with Modbus  ->"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        (void)with_distances(rows[i].processed, rows[i].real_time, "--address 9");
        assert_says(last, rows[i].says);
        assert_int_equal(last->status, strstr(rows[i].says, "none") != NULL);
    }
    assert_non_null(strstr(with_distances(754, 751, "--address 9 --format json"), "\"is_certain\":true,"));
    assert_non_null(strstr(with_distances(754, 300, "--address 9 --format json"), "\"is_certain\":false,"));
}

/* ---- the one device of a line ---- */

/* RELATIVES: 01 03 02 00 01 79 84 */
static const uint8_t from_1[7] = {0x01, 0x03, 0x02, 0x00, 0x01, 0x79, 0x84};

TEST(a_unit_that_answers_at_address_255_is_found_first_at_any_address_and_the_walk_goes_on)
{
    A16(.address = 200, .answers_broadcast = true);
    A16(.address = 3);
    const tool_run_t *const run = scan_finds("a16 200 9600 8N1, a16 3 9600 8N1", "");
    assert_says(run,
                "address 200  9600 8N1     no_target (value 65533), an A16 or a relative with Modbus  ->  ");
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 1 + 32);
    /* An address that the user excluded gets no request of its own. */
    assert_says(scan_finds("a16 3 9600 8N1", "--address 1-4"),
                "a frame from address 200 was received, which is");
}

TEST(with_one_the_first_sensor_ends_the_scan)
{
    A16(.address = 200, .answers_broadcast = true);
    A16(.address = 3);
    HPS167S(.address = 1);
    const tool_run_t *run = scan_finds("a16 200 9600 8N1", "--one");
    assert_int_equal(run->status, 0);
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 1);
    assert_int_equal(scans.probed[1][FATHOM_PARITY_EVEN], 0);
    assert_says(run, ". --one ended the scan, and other sensors may be on the line\n");

    scan_begin(); /* those that do not answer at 255 are found by the walk */
    A16(.address = 3);
    A16(.address = 4);
    (void)scan_finds("a16 3 9600 8N1", "--one");
    scan_begin();
    HPS167S(.address = 2);
    HPS167S(.address = 3);
    (void)scan_finds("hps167s 2 19200 8E1", "--one");
    scan_begin();
    A05(.address = 100, .mode = FATHOM_SIM_A05_DYP);
    (void)scan_finds("a05 100 9600 8N1", "--one");
}

TEST(units_that_answer_at_address_255_at_once_are_found_by_the_walk)
{
    for (uint32_t seed = 0; seed != 4; seed++) {
        scan_begin();
        A16(.address = 2, .seed = seed, .answers_broadcast = true);
        A16(.address = 5, .seed = seed + 100, .answers_broadcast = true);
        A05(.address = 7, .seed = seed + 200, .answers_broadcast = true);
        const tool_run_t *const run = scan("");
        assert_says(run, "sensors found: 3");
        assert_null(strstr(run->out, "?"));
        assert_null(strstr(run->err, "no Modbus frame"));
    }
}

/* It answers only there; a device that has none of the registers at its own address is not confirmed. */
TEST(an_answer_at_address_255_that_its_own_address_does_not_confirm_is_no_sensor)
{
    add_speaker(&dyp_line, 0, from_1, sizeof from_1)->address = 0xFF;
    (void)scan_finds("", "--address 1-3");
    scan_begin();
    add_stranger(0xFF, (stranger_t){.exception = 10 /* a gateway's */}, &dyp_line);
    (void)scan_finds("", "--address 1-3");
    scan_begin(); /* a charger that responds with any register; --one does not end with it */
    add_stranger(9, (stranger_t){.value = 80, .second = 132, .address = 9, .answers_any = true}, &dyp_line);
    A16(.address = 11);
    HPS167S(.address = 12);
    assert_says(scan_finds("? 9 9600 8N1, a16 11 9600 8N1", "--one"), "; perhaps a solar charger: ");
}

TEST(a_relative_at_115200_8n1_is_found_where_this_rate_is_asked)
{
    fathom_sim_device_t *const unit =
        add_a16((fathom_sim_a16_config_t){.address = 40, .answers_broadcast = true});
    unit->settings = relatives_line;
    assert_says(scan_finds("a16 40 115200 8N1", "--baud 115200"),
                "fathom read a16:40:modbus --port line --baud 115200\n");
    (void)scan_finds("", "--baud 9600");
    unit->answers_broadcast = false;
    (void)scan_finds("a16 40 115200 8N1", "--baud 115200 --parity none --address 38-41");
}

TEST(a_device_that_responds_to_everything_or_nothing_is_another_modbus_device)
{
    const fathom_line_settings_t *const lines[] = {&dyp_line, &hps167s_line};
    const uint16_t values[] = {0, 9, 0xFFFF, 0xB00B, 0x0909}; /* the last is a date */
    for (unsigned line = 0; line != 2; line++) {
        for (unsigned i = 0; i != sizeof values / sizeof values[0]; i++)
            is_other((stranger_t){.value = values[i], .version = values[i], .address = 9}, lines[line]);
        for (uint8_t exception = 1; exception != 5; exception++)
            is_other((stranger_t){.exception = exception}, lines[line]);
    }
}

TEST(a_device_with_another_address_in_0200_than_its_own_is_no_a16)
{
    stranger_t with = {.value = 754, .address = 9, .only = {0x0200, 0x0101}};
    add_stranger(9, with, &dyp_line);
    (void)scan_finds("a16 9 9600 8N1", "");
    for (with.address = 10; with.address != 12; with.address++) is_other(with, &dyp_line);
    scan_begin();
    with = (stranger_t){.value = 754, .address = 9, .only = {0x0200, 0x0100}};
    add_stranger(9, with, &dyp_line);
    assert_says(scan_finds("a16 9 9600 8N1", ""), " 754 mm, probably an A16 or a relative with Modbus  ->  ");
}

TEST(a_device_without_a_date_in_0001_or_with_zeros_elsewhere_is_no_hps167s)
{
    /* #3 begins with the right byte; in #1 the month is 0, 13 or 32, or the day is 0 */
    const uint16_t versions[] = {0x1400, 0x140D, 0x0020, 0x0009};
    for (unsigned i = 0; i != 4; i++)
        is_other((stranger_t){.value = 0xB000, .version = versions[i]}, &hps167s_line);
    /* #2 has two switches and is the same twice, but so is what the device measures */
    is_other((stranger_t){.version = 0x0909}, &hps167s_line);
}

TEST(a_unit_or_a_master_that_was_not_asked_is_mentioned)
{
    (void)add_speaker(&dyp_line, 0, a16_response, sizeof a16_response);
    const tool_run_t *run = scan_finds("", "--address 2-4");
    assert_says(run, "a frame from address 1 was received, which is not in the scan. Use --address 1.\n");
    assert_null(strstr(run->err, "another master"));

    scan_begin();
    (void)add_speaker(&dyp_line, 0, a16_request, sizeof a16_request);
    run = scan_finds("", "--address 2-4");
    assert_says(run, "another master sends requests on this line (to address 1)");
    assert_null(strstr(run->err, "a frame from address"));
}

/* Each address is asked three times, and twice after four addresses in a row; so is any A05, once. */
TEST(a_line_that_is_never_silent_proves_nothing_about_its_addresses)
{
    (void)add_speaker(&dyp_line, 6000, junk, sizeof junk); /* 6.3 ms long */
    const tool_run_t *const run = scan_finds("? - 9600 8N1", "--wake --baud 9600 --address 1-8 --listen 1");
    assert_says(run, "fathom: 9 addresses were sent no request: ");
    assert_null(strstr(run->err, "nothing was heard"));
    assert_int_equal(scans.probed[0][FATHOM_PARITY_NONE], 4 * 3 + 4 * 2);
}

/* ---- HPS-167S #2 ---- */

/* Table 12 prints no encoding of the rate, and the multiple of 18 of #15 is a rule for what is written. */
TEST(a_configuration_is_accepted_with_any_rate_and_any_reconnect_time)
{
    const uint32_t times_ms[] = {0, 1, 1000, UINT32_MAX};
    const uint8_t codes[] = {0, 5, 0xFF, 19};
    for (unsigned i = 0; i != 4; i++) {
        scan_begin();
        HPS167S(0);
        scans.hps167s[0].reconnect_ms = times_ms[i];
        scans.hps167s[0].baud_code = codes[i];
        assert_says(scan_finds("hps167s 1 19200 8E1", "--baud 19200 --address 1"), ", termination on ");
    }
}

/* 255 mm are 00 FF, two switches; and of a sensor that has failed (table 18) all but the magnitude is FF. */
TEST(an_unsolicited_measurement_is_no_configuration)
{
    static fathom_sim_fixed_t near = {{255, 0, 0, 0}};
    for (uint32_t i = 0; i != 60; i++) {
        scan_begin();
        HPS167S(.unasked_us = 25000 + i * 7000, .scene = fathom_sim_fixed(&near));
        if (i % 2 != 0) fathom_sim_hps167s_lose(&scans.hps167s[0], true, bench.clock.now_us);
        scans.lost_register = 0x02;
        const tool_run_t *const run =
            scan_finds("hps167s 1 19200 8E1", "--wake --baud 19200 --address 1 --listen 1");
        assert_null(strstr(run->out, "termination"));
    }
}
