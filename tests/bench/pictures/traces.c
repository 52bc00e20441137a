/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "fathom/fathom.h"
#include "sim/a05.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/uart.h"

/*
 * Real traces for the pictures: drivers of the library at simulated sensors, in simulated time.
 *
 *     picture_traces quarantine     two HPS-167S on one line, one of which answers after the response time-out
 *     picture_traces resync-SCENE   an A05 that sends by itself, a byte of which is lost. SCENE: silence, none,
 * repeated
 *
 * A line of what it prints is BEGIN_US,END_US,WHAT,TEXT. WHAT is `sent` or `came`, a byte on the wire; else what the
 * library made of it, at the time when the program was told.
 */
static fathom_sim_clock_t now;
static fathom_sim_line_t wire;
static fathom_sim_uart_t far_end;
static fathom_sim_fixed_t scene;
static fathom_sim_fault_t fault;
static fathom_uart_t inner; /* the simulator's, beneath the one that keeps a record */
static fathom_uart_t uart;
static fathom_clock_t hal_clock;
static uint8_t frame[16];
static uint16_t counters[FATHOM_LINE_COUNTERS];
static fathom_line_parts_t config;
static fathom_line_t line;

static void tell(uint32_t begin_us, uint32_t end_us, const char *what, const char *text)
{
    printf("%lu,%lu,%s,%s\n", (unsigned long)begin_us, (unsigned long)end_us, what, text);
}

static void tell_now(const char *what, const char *text) { tell(now.now_us, now.now_us, what, text); }

static void tell_byte(uint32_t begin_us, uint32_t end_us, const char *what, uint8_t byte)
{
    char text[4];
    snprintf(text, sizeof text, "%02X", byte);
    tell(begin_us, end_us, what, text);
}

/* ---- the wire ---- */

/* A byte at a time, so that each has its own time. */
static int read_one(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    (void)ctx;
    const int count = inner.read(inner.ctx, bytes, capacity < 1 ? capacity : 1, rx);
    if (count == 1)
        tell_byte(rx->last_us - fathom_sim_span_us(&wire.settings, 1), rx->last_us, "came", *bytes);
    return count;
}

static int write_all(void *ctx, const uint8_t *bytes, size_t length)
{
    (void)ctx;
    const int count = inner.write(inner.ctx, bytes, length);
    for (uint16_t i = 0; i < count; i++)
        tell_byte(now.now_us + fathom_sim_span_us(&wire.settings, i),
                  now.now_us + fathom_sim_span_us(&wire.settings, (uint16_t)(i + 1)), "sent", bytes[i]);
    return count;
}

static void begin_wire(const fathom_line_settings_t *settings)
{
    fathom_sim_clock_init(&now, 0, 0);
    fathom_sim_line_init(&wire, settings, 0);
    fathom_sim_uart_init(&far_end, &wire, &now);
    inner = uart = fathom_sim_uart(&far_end);
    uart.read = read_one;
    uart.write = write_all;
    hal_clock = fathom_sim_clock(&now);
    config = (fathom_line_parts_t){.uart = &uart,
                                   .clock = &hal_clock,
                                   .frame = frame,
                                   .frame_size = sizeof frame,
                                   .echo = FATHOM_LINE_ECHO_OFF,
                                   .marks = fathom_line_marks,
                                   .count = fathom_line_count,
                                   .counters = counters};
}

/* ---- a late response ---- */

enum { UNITS = 2, TIMEOUT_US = 30000, LATE_US = 45000, QUARANTINE_END_US = 159500 };

static fathom_sim_hps167s_t devices[UNITS];
static fathom_hps167s_t drivers[UNITS];
static fathom_sensor_t sensors[UNITS];

static void begin_quarantine(void)
{
    static const fathom_line_settings_t settings = {19200, FATHOM_PARITY_EVEN, 1};
    static fathom_modbus_t transport;
    begin_wire(&settings);
    config.silence_us = FATHOM_T3_5_US(19200, 11);
    scene.value[0] = 3000;
    fathom_line_init(&line, &config);
    transport = fathom_modbus_client(&line);
    for (uint8_t i = 0; i < UNITS; i++) {
        const uint8_t unit = (uint8_t)(i + 1);
        fathom_sim_hps167s_init(
            &devices[i], &(fathom_sim_hps167s_config_t){.address = unit, .scene = fathom_sim_fixed(&scene)});
        fathom_sim_attach(&wire, &devices[i].device, now.now_us);
        fathom_hps167s_init(&drivers[i], &transport,
                            &(fathom_hps167s_config_t){.modbus.address = unit,
                                                       .modbus.timeout_us = TIMEOUT_US,
                                                       .modbus.period_us = 40000});
        sensors[i] = fathom_hps167s_sensor(&drivers[i]);
    }
    fathom_sim_fault_init(&fault, 1);
    fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_LATE, FATHOM_SIM_FAULT_ALWAYS_PPM, 3)->us = LATE_US;
    fathom_sim_fault_attach(&fault, &wire, &devices[0].device);
}

static void poll_unit(uint8_t i)
{
    fathom_sample_t sample;
    char text[32];
    const fathom_status_t status = fathom_poll(&sensors[i], &sample);
    if (status == FATHOM_PENDING) return;
    if (status == FATHOM_OK)
        snprintf(text, sizeof text, "unit %u reading %u mm", i + 1U, sample.distance_mm);
    else
        snprintf(text, sizeof text, "unit %u %s", i + 1U,
                 status == FATHOM_ERR_NO_RESPONSE ? "time-out" : "error");
    tell_now("outcome", text);
}

static void quarantine(void)
{
    bool was_in = false;
    uint16_t late = 0;
    begin_quarantine();
    while (now.now_us < QUARANTINE_END_US) {
        for (uint8_t i = 0; i < UNITS; i++) poll_unit(i);
        if (counters[FATHOM_LINE_LATE_RESPONSES] != late) {
            late = counters[FATHOM_LINE_LATE_RESPONSES];
            tell_now("late", "counted and dropped");
        }
        const bool is_in = fathom_line_is_quarantined(&line, 1);
        if (is_in != was_in) tell_now("quarantine", is_in ? "begins" : "ends");
        was_in = is_in;
        fathom_sim_clock_idle(&now, fathom_due_us(sensors, UNITS));
    }
}

/* ---- a lost byte ---- */

enum { DAMAGED_FRAME = 6, LAST_FRAME = 11, SEED = 6 }; /* which loses the fifth byte */

typedef struct {
    const char *name;
    uint32_t period_us; /* a frame takes 10417 */
    uint16_t values[4];
} resync_t;

static const resync_t scenes[] = {
    {"resync-silence", 30000, {1000, 2000, 2047, 1339}},
    {"resync-none", 10417, {1000, 2000, 1953, 3562}},
    {"resync-repeated", 10417, {1000, 2000, 2047, 1339}},
};

static fathom_sim_a05_t a05;
static fathom_a05_auto_t bumper;

static void begin_resync(const resync_t *with)
{
    static const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    begin_wire(&settings);
    for (uint8_t i = 0; i < 4; i++) scene.value[i] = with->values[i];
    fathom_sim_a05_init(&a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO,
                                                         .scene = fathom_sim_fixed(&scene),
                                                         .period_us = with->period_us});
    wire.full_duplex = true;
    fathom_sim_fault_init(&fault, SEED);
    fathom_sim_fault_add(&fault, FATHOM_SIM_FAULT_DROP, FATHOM_SIM_FAULT_ALWAYS_PPM, DAMAGED_FRAME);
    fathom_sim_fault_attach(&fault, &wire, &a05.device);
    fathom_sim_attach(&wire, &a05.device, now.now_us);
    fathom_line_init_listening(&line, &config);
    fathom_a05_auto_init(&bumper, &line, NULL);
}

static void tell_reading(const fathom_sensor_t *sensor)
{
    fathom_sample_t sample;
    char text[40] = "";
    uint32_t time_us = now.now_us;
    while (fathom_poll(sensor, &sample) == FATHOM_OK) {
        const size_t at = strlen(text);
        snprintf(text + at, sizeof text - at, at == 0 ? "%u" : " %u", sample.distance_mm);
        time_us = sample.time_us;
    }
    if (text[0] != '\0') tell(time_us, now.now_us, "reading", text);
}

static void resync(const resync_t *with)
{
    begin_resync(with);
    const fathom_sensor_t sensor = fathom_a05_auto_sensor(&bumper);
    uint16_t unsure = 0;
    uint16_t ambiguous = 0;
    while (now.now_us < LAST_FRAME * with->period_us) {
        const uint16_t *const counted = bumper.base.stream.counters;
        tell_reading(&sensor);
        if (counted[FATHOM_STREAM_UNSURE] != unsure) tell_now("refused", "unsure");
        if (counted[FATHOM_STREAM_AMBIGUOUS] != ambiguous) tell_now("refused", "ambiguous");
        unsure = counted[FATHOM_STREAM_UNSURE];
        ambiguous = counted[FATHOM_STREAM_AMBIGUOUS];
        fathom_sim_clock_idle(&now, fathom_due_us(&sensor, 1));
    }
}

int main(int argc, char **argv)
{
    const char *const name = argc == 2 ? argv[1] : "";
    if (strcmp(name, "quarantine") == 0) {
        quarantine();
        return 0;
    }
    for (unsigned i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        if (strcmp(name, scenes[i].name) != 0) continue;
        resync(&scenes[i]);
        return 0;
    }
    fputs("usage: picture_traces quarantine | resync-silence | resync-none | resync-repeated\n", stderr);
    return 2;
}
