/* SPDX-License-Identifier: MIT */
#include "scan_bench.h"

#include <stdio.h>
#include <string.h>

scan_bench_t scans;
static const tool_run_t *last;

const fathom_line_settings_t dyp_line = {9600, FATHOM_PARITY_NONE, 1};
const fathom_line_settings_t hps167s_line = {19200, FATHOM_PARITY_EVEN, 1};

/* ---- the line ---- */

/* A scan may send function 03 of a register other than 0009 to one unit, or 55 AA FF 10, "probe 1 of any A05". An A16
 * and an A05 can have address 0, but no HPS-167S has their registers. */
static bool is_harmless(const uint8_t *bytes, size_t length)
{
    static const uint8_t any[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E}; /* 55 + AA + FF + 10 = 20E */
    if (bytes[0] == 0x55 && bytes[1] == 0xAA) return length == sizeof any && memcmp(bytes, any, length) == 0;
    if (length != 8 || bytes[1] != 0x03 || bytes[0] == 0xFF) return false;
    return bytes[0] == 0 ? bytes[2] != 0 : bytes[2] != 0x00 || bytes[3] != 0x09;
}

static unsigned rate_index(uint32_t baud)
{
    static const uint32_t rates[SCAN_BENCH_RATES] = {9600, 19200, 57600, 115200, 230400, 38400};
    unsigned i = 0;
    while (i != SCAN_BENCH_RATES - 1 && rates[i] != baud) i++;
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
    if ((bytes[2] == 0x00 && bytes[3] == 0x01) || (bytes[2] == 0x02 && bytes[3] == 0x00))
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

void scan_begin(void)
{
    memset(&scans, 0, sizeof scans);
    bench_begin();
    scans.inner = bench.tool.uart;
    bench.tool.uart.read = bench_read;
    bench.tool.uart.write = bench_write;
    bench.tool.uart.set_line = bench_set_line;
    bench.tool.idle = idle;
}

int scan_set_up(void **state)
{
    scan_begin();
    return 0;
}

/* ---- the sensors ---- */

static fathom_sim_device_t *attach(fathom_sim_device_t *device)
{
    fathom_sim_attach(&bench.line, device, bench.clock.now_us);
    return device;
}

fathom_sim_device_t *add_a16(fathom_sim_a16_config_t config)
{
    assert_true(scans.a16_count < SCAN_BENCH_UNITS);
    fathom_sim_a16_t *const a16 = &scans.a16[scans.a16_count++];
    if (config.mode == 0) config.mode = FATHOM_SIM_A16_MODBUS;
    fathom_sim_a16_init(a16, &config);
    return attach(&a16->device);
}

fathom_sim_device_t *add_a05(fathom_sim_a05_config_t config)
{
    assert_true(scans.a05_count < SCAN_BENCH_UNITS);
    fathom_sim_a05_t *const a05 = &scans.a05[scans.a05_count++];
    if (config.mode == 0) config.mode = FATHOM_SIM_A05_MODBUS;
    fathom_sim_a05_init(a05, &config);
    return attach(&a05->device);
}

fathom_sim_device_t *add_hps167s(fathom_sim_hps167s_config_t config)
{
    assert_true(scans.hps167s_count < SCAN_BENCH_UNITS);
    fathom_sim_hps167s_t *const hps167s = &scans.hps167s[scans.hps167s_count++];
    fathom_sim_hps167s_init(hps167s, &config);
    return attach(&hps167s->device);
}

const fathom_sim_fault_t *add_fault(fathom_sim_device_t *device, uint8_t kind, uint32_t chance_ppm,
                                    uint32_t at_frame, uint32_t seed)
{
    static fathom_sim_fault_t faults[SCAN_BENCH_UNITS];
    static unsigned count;
    fathom_sim_fault_t *const fault = &faults[count++ % SCAN_BENCH_UNITS];
    fathom_sim_fault_init(fault, seed);
    assert_non_null(fathom_sim_fault_add(fault, kind, chance_ppm, at_frame));
    fathom_sim_fault_attach(fault, &bench.line, device);
    return fault;
}

/* ---- other devices ---- */

static stranger_t stranger;

static uint16_t first_of(const fathom_modbus_message_t *message)
{
    return (uint16_t)(message->head[2] * 256u + message->head[3]);
}

static uint32_t stranger_request(fathom_sim_device_t *device, fathom_modbus_message_t *message)
{
    const uint16_t first = first_of(message);
    if (stranger.only[0] != 0 && first != stranger.only[0] && first != stranger.only[1])
        return FATHOM_NO_DEADLINE;
    message->exception = stranger.exception;
    return 5000;
}

static void stranger_fill(fathom_sim_device_t *device, fathom_modbus_message_t *message, uint32_t now_us)
{
    const uint16_t first = first_of(message);
    for (uint8_t i = 0; i != message->head[5]; i++)
        message->values[i] = first == 0x0001 ? stranger.version : stranger.value;
    if (first == 0x0200) message->values[0] = stranger.address;
}

void add_stranger(uint8_t unit, stranger_t with, const fathom_line_settings_t *line)
{
    static const fathom_sim_model_t model = {.request = stranger_request, .fill = stranger_fill};
    static fathom_sim_device_t device;
    stranger = with;
    device = (fathom_sim_device_t){.model = &model,
                                   .settings = *line,
                                   .address = unit,
                                   .listens = true,
                                   .protocols = {&fathom_sim_modbus}};
    attach(&device);
}

const uint8_t hps_response[13] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                  0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
const uint8_t a16_request[8] = {0x01, 0x03, 0x01, 0x00, 0x00, 0x01, 0x85, 0xF6};
const uint8_t a16_response[7] = {0x01, 0x03, 0x02, 0x02, 0xF2, 0x38, 0xA1};
const uint8_t junk[6] = {0x02, 0x84, 0x31, 0x90, 0x11, 0xE7};

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

fathom_sim_device_t *add_speaker(const fathom_line_settings_t *line, uint32_t period_us, const uint8_t *bytes,
                                 uint8_t length)
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

const tool_run_t *scan(const char *options)
{
    memset(scans.probed, 0, sizeof scans.probed);
    scans.requests = 0;
    scans.start_us = bench.clock.now_us;
    last = tool_run(&bench.tool, "scan --port line %s", options);
    assert_int_equal(scans.harmful, 0);
    for (unsigned i = 0; i != SCAN_BENCH_UNITS; i++) {
        assert_unharmed(&scans.a16[i].device);
        assert_unharmed(&scans.a05[i].device);
        assert_unharmed(&scans.hps167s[i].device);
    }
    return last;
}

const char *scan_found(void)
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

const tool_run_t *scan_finds(const char *findings, const char *options)
{
    const tool_run_t *const run = scan(options);
    assert_string_equal(scan_found(), findings);
    return run;
}

void assert_says(const tool_run_t *run, const char *text)
{
    if (strstr(run->out, text) == NULL && strstr(run->err, text) == NULL)
        fail_msg("'%s' is not in\n%s%s", text, run->out, run->err);
}
