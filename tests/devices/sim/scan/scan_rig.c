/* SPDX-License-Identifier: MIT */
#include "scan_rig.h"

rig_t rig;

/* What a scan may send: function 03 of some other register than 0009 to one unit, or 55 AA FF 10, "probe 1 of any
 * A05". The bytes are looked at here as they are; no code of the tool's takes part. */
static void expect_harmless(const uint8_t *bytes, size_t length)
{
    if (bytes[0] == 0x55 && bytes[1] == 0xAA) {
        const uint8_t any[] = {0x55, 0xAA, 0xFF, 0x10, 0x0E}; /* 55 + AA + FF + 10 = 20E */
        assert_int_equal(length, sizeof any);
        assert_memory_equal(bytes, any, sizeof any);
        return;
    }
    assert_int_equal(length, 8);
    assert_int_equal(bytes[1], 0x03);
    assert_true(bytes[0] != 0 && bytes[0] != 0xFF);
    assert_false(bytes[2] == 0x00 && bytes[3] == 0x09);
}

static int rate_index(uint32_t baud)
{
    const uint32_t rates[] = {9600, 19200, 57600, 115200, 230400, 38400};
    for (int i = 0; i != SCAN_RATES; i++)
        if (rates[i] == baud) return i;
    fail_msg("a rate that no plan has");
    return 0;
}

static int rig_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    return rig.is_broken ? -1 : rig.inner.read(rig.inner.ctx, bytes, capacity, rx);
}

static int rig_write(void *ctx, const uint8_t *bytes, size_t length)
{
    const int n = rig.inner.write(rig.inner.ctx, bytes, length);
    if (n <= 0) return n;
    expect_harmless(bytes, length);
    rig.requests++;
    /* 0001 and 0200 are the first requests */
    if ((bytes[2] == 0x00 && bytes[3] == 0x01) || (bytes[2] == 0x02 && bytes[3] == 0x00))
        rig.probed[rate_index(rig.sim_line.settings.baud)][rig.sim_line.settings.parity]++;
    return n;
}

static int rig_set_line(void *ctx, const fathom_line_settings_t *settings)
{
    if (settings->baud == rig.refused_baud) return -1;
    return rig.inner.set_line(rig.inner.ctx, settings);
}

static bool rig_wait(void *ctx, uint32_t max_us)
{
    const uint32_t before_us = rig.sim_clock.now_us;
    if (rig.waits_left == 0) return false;
    rig.waits_left--;
    if (rig.coarse_us != 0)
        fathom_sim_clock_advance(&rig.sim_clock, rig.coarse_us);
    else
        fathom_sim_clock_idle(&rig.sim_clock, max_us != 0 ? max_us : 1);
    rig.passed_us += fathom_elapsed_us(rig.sim_clock.now_us, before_us);
    return true;
}

static void note_found(void *ctx, const scan_finding_t *finding)
{
    assert_true(rig.found < RIG_FINDINGS);
    rig.findings[rig.found++] = *finding;
}

static void note_progress(void *ctx, uint64_t done_us, const fathom_line_settings_t *line, uint8_t address)
{
    assert_true(done_us >= rig.progress_us);
    assert_true(line->baud >= 9600);
    assert_in_range(address, rig.plan.first, rig.plan.last);
    rig.progress_us = done_us;
}

static void note_unsupported(void *ctx, const fathom_line_settings_t *line)
{
    assert_int_equal(line->baud, rig.refused_baud);
    rig.unsupported++;
}

void rig_begin(uint32_t start_us)
{
    memset(&rig, 0, sizeof rig);
    rig.waits_left = UINT32_MAX;
    rig.plan.settings[0] = scan_dyp_line;
    rig.plan.settings[1] = scan_hps167s_line;
    rig.plan.setting_count = 2;
    rig.plan.first = 1;
    rig.plan.last = 32;
    rig.plan.listen_us = 3000000;
    fathom_sim_clock_init(&rig.sim_clock, start_us, 0);
    fathom_sim_line_init(&rig.sim_line, &scan_dyp_line, rig.sim_clock.now_us);
    fathom_sim_uart_init(&rig.sim_uart, &rig.sim_line, &rig.sim_clock);
    rig.sim_uart.knows = 0; /* as a tty, which says nothing of single bytes */
    rig.inner = fathom_sim_uart(&rig.sim_uart);
    rig.uart = rig.inner;
    rig.uart.read = rig_read;
    rig.uart.write = rig_write;
    rig.uart.set_line = rig_set_line;
    rig.clock = fathom_sim_clock(&rig.sim_clock);
    listener_begin(&rig.listener, &rig.uart, &rig.clock);
    rig.config = (fathom_line_parts_t){.uart = &rig.uart,
                                       .clock = &rig.clock,
                                       .frame = rig.frame,
                                       .frame_size = sizeof rig.frame,
                                       .find_echo = fathom_line_find_echo,
                                       .marks = fathom_line_marks,
                                       .senders = &fathom_line_senders,
                                       .masters = &fathom_line_masters,
                                       .gap_us = 60000};
    rig.config.silence_us = scan_silence_us(&rig.plan);
    assert_int_equal(fathom_line_init(&rig.line, &rig.config), FATHOM_OK);
    rig.wire =
        (scan_wire_t){.line = &rig.line, .listener = &rig.listener, .clock = &rig.clock, .wait = rig_wait};
    rig.tell = (scan_tell_t){.found = note_found, .progress = note_progress, .unsupported = note_unsupported};
    rig.walk = (scan_walk_t){.wire = &rig.wire, .plan = &rig.plan, .tell = &rig.tell};
}

void rig_attach(fathom_sim_device_t *device)
{
    fathom_sim_attach(&rig.sim_line, device, rig.sim_clock.now_us);
}

void rig_a16(a16_config_t config)
{
    if (config.mode == 0) config.mode = FATHOM_SIM_A16_MODBUS;
    fathom_sim_a16_init(&rig.a16[rig.a16s], &config);
    rig_attach(&rig.a16[rig.a16s++].device);
}

void rig_a05(a05_config_t config)
{
    if (config.mode == 0) config.mode = FATHOM_SIM_A05_MODBUS;
    fathom_sim_a05_init(&rig.a05[rig.a05s], &config);
    rig_attach(&rig.a05[rig.a05s++].device);
}

void rig_hps(hps_config_t config)
{
    fathom_sim_hps167s_init(&rig.hps[rig.hpss], &config);
    rig_attach(&rig.hps[rig.hpss++].device);
}

void rig_plan_everything(void)
{
    const uint32_t rates[] = {9600, 19200, 57600, 115200, 230400};
    rig.plan.setting_count = 0;
    for (unsigned i = 0; i != 5; i++)
        for (unsigned parity = 0; parity != 3; parity++)
            rig.plan.settings[rig.plan.setting_count++] =
                (fathom_line_settings_t){rates[i], (uint8_t)parity, 1};
    rig.plan.first = 1;
    rig.plan.last = 254;
    rig.config.silence_us = scan_silence_us(&rig.plan);
}

void rig_walk(void) { assert_int_equal(scan_walk(&rig.walk), FATHOM_OK); }

void rig_finds(uint16_t count)
{
    rig_walk();
    assert_int_equal(rig.found, count);
}

const scan_finding_t *rig_find(uint8_t address)
{
    const scan_finding_t *found = NULL;
    for (uint16_t i = 0; i != rig.found; i++) {
        if (rig.findings[i].address != address) continue;
        assert_null(found);
        found = &rig.findings[i];
    }
    return found;
}

void rig_expect_sensor(uint8_t address, fathom_model_t model, scan_mode_t mode,
                       const fathom_line_settings_t *line)
{
    const scan_finding_t *const finding = rig_find(address);
    assert_non_null(finding);
    assert_int_equal(finding->kind, SCAN_SENSOR);
    assert_int_equal(finding->model, model);
    assert_int_equal(finding->mode, mode);
    assert_int_equal(finding->line.baud, line->baud);
    assert_int_equal(finding->line.parity, line->parity);
    assert_int_equal(finding->line.stop_bits, 1);
}

void rig_expect(uint8_t address, fathom_model_t model)
{
    rig_expect_sensor(address, model, SCAN_MODBUS,
                      model == FATHOM_HPS167S ? &scan_hps167s_line : &scan_dyp_line);
}

static void expect_unharmed(const fathom_sim_device_t *device)
{
    assert_int_equal(device->counters.writes, 0);
    assert_int_equal(device->counters.resets, 0);
    assert_int_equal(device->counters.resets_refused, 0);
}

void rig_expect_unharmed(void)
{
    for (uint8_t i = 0; i != RIG_DEVICES; i++) {
        expect_unharmed(&rig.a16[i].device);
        expect_unharmed(&rig.a05[i].device);
        expect_unharmed(&rig.hps[i].device);
    }
}
