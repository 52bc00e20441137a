/* SPDX-License-Identifier: MIT */
#include "mix.h"

#include <string.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/sim.h"
#include "sim/uart.h"

static const fathom_line_settings_t ultrasonic = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t infrared = {19200, FATHOM_PARITY_EVEN, 1};

/* What is seen of each sensor from outside: when its driver asks, and what goes over the wire. */
static struct {
    fathom_sim_clock_t clock;
    fathom_sim_line_t wire;
    fathom_uart_t port;
    fathom_modbus_t modbus;
    mix_share_t *shares;
    uint32_t asked_us[MIX_SENSORS];
    uint32_t sent_us;
    uint32_t heard_us;
    int asked; /* whose request was the last one */
} seen;

static int sensor_at(uint8_t unit) { return unit == 7 ? MIX_HPS : unit - 1; }

static void end_turn(void)
{
    const uint32_t end_us = seen.heard_us != seen.sent_us ? seen.heard_us : seen.clock.now_us;
    if (seen.asked >= 0) seen.shares[seen.asked].line_us += end_us - seen.sent_us;
}

static int write(void *ctx, const uint8_t *bytes, size_t count)
{
    const int n = seen.port.write(ctx, bytes, count);
    if (n <= 0) return n;
    end_turn();
    seen.asked = sensor_at(bytes[0]);
    seen.sent_us = seen.heard_us = seen.clock.now_us;
    mix_share_t *const share = &seen.shares[seen.asked];
    const uint32_t wait_us = seen.sent_us - seen.asked_us[seen.asked];
    if (wait_us > share->longest_wait_us) share->longest_wait_us = wait_us;
    return n;
}

static int read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    const int n = seen.port.read(ctx, bytes, capacity, rx);
    if (n > 0) seen.heard_us = seen.clock.now_us;
    return n;
}

static fathom_status_t submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    seen.asked_us[sensor_at(request->message.head[0])] = seen.clock.now_us;
    return seen.modbus.submit(line, request);
}

void mix_run(const mix_t *mix, uint32_t seconds, mix_share_t shares[MIX_SENSORS])
{
    static fathom_sim_a16_t sim_a16;
    static fathom_sim_a05_t sim_a05;
    static fathom_sim_hps167s_t sim_hps;
    static fathom_a16_modbus_t a16;
    static fathom_a05_modbus_t a05;
    static fathom_hps167s_t hps;
    static fathom_line_t line;
    static fathom_fair_share_t share;
    fathom_sim_fixed_t scene = {{1000, 2000, 1953, 3562}};
    fathom_sim_uart_t end;
    uint8_t frame[32];

    memset(&seen, 0, sizeof seen);
    memset(shares, 0, MIX_SENSORS * sizeof *shares);
    seen.shares = shares;
    seen.asked = -1;
    fathom_sim_clock_init(&seen.clock, 0, 0);
    fathom_sim_line_init(&seen.wire, &ultrasonic, seen.clock.now_us);
    const fathom_sim_a16_config_t a16_is = {
        .address = 1, .mode = FATHOM_SIM_A16_MODBUS, .scene = fathom_sim_fixed(&scene)};
    const fathom_sim_a05_config_t a05_is = {
        .address = 2, .mode = FATHOM_SIM_A05_MODBUS, .scene = fathom_sim_fixed(&scene)};
    const fathom_sim_hps167s_config_t hps_is = {.address = 7, .scene = fathom_sim_fixed(&scene)};
    fathom_sim_a16_init(&sim_a16, &a16_is);
    fathom_sim_a05_init(&sim_a05, &a05_is);
    fathom_sim_hps167s_init(&sim_hps, &hps_is);
    fathom_sim_device_t *const devices[MIX_SENSORS] = {&sim_a16.device, &sim_a05.device, &sim_hps.device};
    for (int i = 0; i != MIX_SENSORS; i++)
        if ((mix->dead >> i & 1) == 0) fathom_sim_attach(&seen.wire, devices[i], seen.clock.now_us);
    fathom_sim_uart_init(&end, &seen.wire, &seen.clock);
    seen.port = fathom_sim_uart(&end);
    fathom_uart_t uart = seen.port;
    uart.write = write;
    uart.read = read;

    const fathom_clock_t clock = fathom_sim_clock(&seen.clock);
    const fathom_line_parts_t config = {.uart = &uart,
                                        .senders = &fathom_line_senders,
                                        .clock = &clock,
                                        .frame = frame,
                                        .frame_size = sizeof frame,
                                        .echo = FATHOM_LINE_ECHO_OFF,
                                        .silence_us = FATHOM_T3_5_US(9600, 10),
                                        .gap_us = 25000};
    (void)fathom_line_init(&line, &config);
    if (mix->fair) fathom_fair_share(&share, &line);
    seen.modbus = fathom_modbus_client(&line);
    fathom_modbus_t modbus = seen.modbus;
    modbus.submit = submit;
    const fathom_a16_modbus_config_t a16_config = {.modbus = {.line_settings = &ultrasonic, .address = 1},
                                                   .value =
                                                       mix->processed ? FATHOM_PROCESSED : FATHOM_REAL_TIME};
    const fathom_a05_modbus_config_t a05_config = {.modbus = {.line_settings = &ultrasonic, .address = 2}};
    const fathom_hps167s_config_t hps_config = {
        .modbus = {.line_settings = &infrared, .address = 7, .period_us = mix->hps_period_us}};
    (void)fathom_a16_modbus_init(&a16, &modbus, &a16_config);
    (void)fathom_a05_modbus_init(&a05, &modbus, &a05_config);
    (void)fathom_hps167s_init(&hps, &modbus, &hps_config);

    const fathom_sensor_t all[MIX_SENSORS] = {fathom_a16_modbus_sensor(&a16), fathom_a05_modbus_sensor(&a05),
                                              fathom_hps167s_sensor(&hps)};
    fathom_sensor_t sensors[MIX_SENSORS];
    int which[MIX_SENSORS];
    size_t count = 0;
    for (int i = 0; i != MIX_SENSORS; i++) {
        if ((mix->absent >> i & 1) != 0) continue;
        which[count] = i;
        sensors[count++] = all[i];
    }
    while (seen.clock.now_us < seconds * 1000000u) {
        bool is_idle = true;
        for (size_t i = 0; i != count; i++) {
            fathom_sample_t sample;
            const fathom_status_t status = fathom_poll(&sensors[i], &sample);
            if (status == FATHOM_PENDING) continue;
            is_idle = false;
            if (status < 0)
                shares[which[i]].failures++;
            else if (sample.probe == 1)
                shares[which[i]].responses++;
        }
        if (mix->loop_us != 0)
            fathom_sim_clock_advance(&seen.clock, mix->loop_us);
        else if (is_idle)
            fathom_sim_clock_idle(&seen.clock, fathom_due_us(sensors, count));
    }
    end_turn();
}
