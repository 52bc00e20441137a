/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board.h"
#include "crcs.h"
#include "profile.h"

/*
 * What the port and the library cost on an ATmega328P at 16 MHz, as lines "figure NAME VALUE UNIT" for figures.py.
 * Cycles of interrupts go from the vector to the end of reti, without the 4 of their entry.
 */
enum { GPIOR0 = 0x3E, READINGS = 200 };

static fathom_sim_line_t line;
static fathom_sim_fixed_t scene = {{1000, 1000, 1000, 1000}};
static fathom_sim_hps167s_t hps;
static fathom_sim_a05_t a05;

static void figure(const char *name, double value, const char *unit)
{
    printf(strcmp(unit, "%") == 0 ? "figure avr_%s %.2f %s\n" : "figure avr_%s %.0f %s\n", name, value, unit);
}

/* `option`: what the image finds in GPIOR0. The HPS-167S is a new one. */
static void start(const char *image, uint8_t option)
{
    board_start(image);
    fathom_sim_hps167s_init(&hps, &(fathom_sim_hps167s_config_t){.scene = fathom_sim_fixed(&scene)});
    board.avr->data[GPIOR0] = option;
}

/* A device, as `settings` have it, behind a transceiver. */
static void join(fathom_sim_device_t *device, const fathom_line_settings_t *settings)
{
    fathom_sim_line_init(&line, settings, board.clock.now_us);
    fathom_sim_attach(&line, device, board.clock.now_us);
    device->settings = *settings; /* also one that it cannot be set to */
    board_join_line(&line);
    board_join_driver('D', 3);
}

/* So many records of kind 1, and none of any other. */
static void run_readings(int count)
{
    while (count-- != 0) {
        const board_record_t *const record = board_next_record(1000000);
        if (record == NULL || record->kind != 1) board_give_up("a reading failed");
    }
}

/* ---- interrupts ---- */

static uint32_t longest[PROFILE_VECTORS];

static void note_interrupts(void)
{
    for (int i = 0; i < PROFILE_VECTORS; i++)
        if (profile.interrupts[i].longest_cycles > longest[i])
            longest[i] = profile.interrupts[i].longest_cycles;
}

static void show_interrupts(void)
{
    figure("receive_interrupt", longest[PROFILE_USART_RECEIVE], "cycles");
    figure("empty_interrupt", longest[PROFILE_USART_EMPTY], "cycles");
    figure("transmit_interrupt", longest[PROFILE_USART_TRANSMIT], "cycles");
    figure("overflow_interrupt", longest[PROFILE_TIMER1_OVERFLOW], "cycles");
    figure("sleep_interrupt", longest[PROFILE_TIMER1_COMPARE_B], "cycles");
    figure("capture_interrupt", longest[PROFILE_TIMER1_CAPTURE], "cycles");
    figure("int0_interrupt", longest[PROFILE_INT0], "cycles");
}

/* Pulses by both ways at once, with an edge just before the overflow of the timer, and glitches. */
static void measure_pulses(void)
{
    enum { US = BOARD_CYCLES_PER_US, PERIOD = 65536 * 8 };
    start("pulses", 0);
    profile_begin();
    board_run_us(1000);
    for (uint64_t i = 1; i < 200; i++) {
        const uint64_t from = board.avr->cycle / PERIOD * PERIOD + 2 * PERIOD + 1000 + 10 * i;
        const uint64_t width = i % 2 != 0 ? 3000 * US : i * US / 2;
        for (int high = 1; high >= 0; high--) {
            board_drive_at('B', 0, high != 0, high != 0 ? from : from + width);
            board_drive_at('D', 2, high != 0, high != 0 ? from : from + width);
        }
        board_run_us(80000);
        usart_arrive(&board.usart, 0x55, 0);
    }
    note_interrupts();
}

/* ---- polling an HPS-167S at its pace ---- */

static void measure_share(bool is_fast, bool gathers)
{
    const fathom_line_settings_t settings = {is_fast ? 115200 : 9600, FATHOM_PARITY_EVEN, 1};
    start("measure_hps167s", (uint8_t)((is_fast ? 1 : 0) | (gathers ? 2 : 0)));
    join(&hps.device, &settings);
    run_readings(2);
    profile_begin();
    const profile_cost_t *const poll = profile_function("fathom_line_poll");
    const uint64_t begin_cycle = board.avr->cycle;
    run_readings(READINGS);
    const double cycles = (double)(board.avr->cycle - begin_cycle);
    const double awake = (double)profile_awake_cycles();
    if (awake + (double)profile.asleep_cycles != cycles) board_give_up("cycles were lost");
    char name[32];
    snprintf(name, sizeof name, "share%s_%lu", gathers ? "_gathering" : "", (unsigned long)settings.baud);
    figure(name, 100 * awake / cycles, "%");
    printf("%.1f readings a second, %.0f cycles awake for each\n", (double)READINGS * BOARD_HZ / cycles,
           awake / READINGS);
    if (is_fast && !gathers) {
        figure("poll_shortest", poll->shortest_cycles, "cycles");
        figure("poll_longest", poll->longest_cycles, "cycles");
    }
    note_interrupts();
}

/* ---- bus time ---- */

static double character_us(const fathom_line_settings_t *settings)
{
    return (settings->parity == FATHOM_PARITY_NONE ? 10 : 11) * 1e6 / settings->baud;
}

/* t3.5 as the specification has it (MODBUS over Serial Line 2.5.1.1). */
static double silence_us(const fathom_line_settings_t *settings)
{
    return settings->baud > 19200 ? 1750 : 3.5 * character_us(settings);
}

/*
 * From the first start bit of a request to that of the next, against what the line allows. That is the request at
 * this chip's rate; t3.5, in which the device learns that it has ended, and the device's own time; the response; and
 * t3.5. The worst of them, in us and in percent.
 */
typedef struct {
    double over_us, over_percent;
} bus_t;

static bus_t bus_time(const fathom_line_settings_t *settings, uint8_t response)
{
    enum { REQUEST = 8 };
    const double us = BOARD_CYCLES_PER_US;
    const uint32_t per_transaction = REQUEST + response;
    bus_t worst = {-1000, -100};
    fathom_line_settings_t chip = *settings;
    chip.baud = usart_settings(&board.usart).baud;
    if (board.bytes_seen > BOARD_BYTES) board_give_up("more bytes on the wire than are kept");
    /* The first request finds a measurement that has waited for it: the pace begins with the third. */
    for (uint32_t n = 2 * per_transaction; n + per_transaction < board.bytes_seen; n += per_transaction) {
        const board_byte_t *const b = &board.bytes[n];
        if (!b[0].from_here || !b[REQUEST - 1].from_here || b[REQUEST].from_here ||
            b[per_transaction - 1].from_here || !b[per_transaction].from_here)
            board_give_up("the bytes on the wire are not as expected");
        const double device = (double)(b[REQUEST].begin_cycle - b[REQUEST - 1].end_cycle) / us;
        const double answered = (double)(b[per_transaction - 1].end_cycle - b[REQUEST].begin_cycle) / us;
        const double silent =
            (double)(b[per_transaction].begin_cycle - b[per_transaction - 1].end_cycle) / us;
        const double allowed = REQUEST * character_us(&chip) + device + answered + silence_us(settings);
        const double over = (double)(b[per_transaction].begin_cycle - b[0].begin_cycle) / us - allowed;
        if (silent < silence_us(settings)) board_give_up("t3.5 was not kept");
        if (over > worst.over_us) worst.over_us = over;
        if (100 * over / allowed > worst.over_percent) worst.over_percent = 100 * over / allowed;
    }
    return worst;
}

/* The device's own time is its datasheet's: an HPS-167S has a measurement 54 times a second, a probe of an A05 takes
 * about 100 ms. The image is a bare modbus_client that asks again at once, with no driver and no pace of one. */
static bus_t measure_bus(uint8_t rate, bool is_a05)
{
    static const uint32_t rates[] = {9600, 19200, 57600, 115200};
    const fathom_line_settings_t settings = {rates[rate], is_a05 ? FATHOM_PARITY_NONE : FATHOM_PARITY_EVEN,
                                             1};
    start("measure_client", (uint8_t)(rate | (is_a05 ? 4 : 0)));
    fathom_sim_a05_init(
        &a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_MODBUS, .scene = fathom_sim_fixed(&scene)});
    join(is_a05 ? &a05.device : &hps.device, &settings);
    profile_begin();
    run_readings(60);
    const bus_t bus = bus_time(&settings, is_a05 ? 7 : 13);
    char name[32];
    snprintf(name, sizeof name, "bus_%s_%lu", is_a05 ? "a05" : "hps167s", (unsigned long)rates[rate]);
    figure(name, bus.over_percent, "%");
    note_interrupts();
    return bus;
}

static void measure_all_buses(void)
{
    double over_us = 0;
    for (uint8_t i = 0; i < 8; i++) {
        const bus_t bus = measure_bus(i % 4, i >= 4);
        if (bus.over_us > over_us) over_us = bus.over_us;
    }
    figure("bus_over", over_us, "us");
}

/* ---- CRC ---- */

static double crc_cycles(const char *function, uint8_t length)
{
    start("crcs", 0);
    profile_begin();
    const profile_cost_t *const cost = profile_function(function);
    board_run_us(1000); /* its memory has been cleared */
    crcs_t *const asked = (crcs_t *)(void *)board_data("asked");
    asked->length = length;
    asked->go = 1;
    if (board_next_record(100000) == NULL) board_give_up("no CRC");
    const double cycles = cost->longest_cycles;
    return cycles;
}

static void measure_crcs(void)
{
    figure("crc_byte", (crc_cycles("crc_without_table", 60) - crc_cycles("crc_without_table", 10)) / 50,
           "cycles");
    figure("crc_table_byte", (crc_cycles("crc_by_table", 60) - crc_cycles("crc_by_table", 10)) / 50,
           "cycles");
}

/* ---- stack ---- */

/* With a device on the line, a driver-enable pin at PD2, or the device's pins; for so long. */
static void measure_stack(const char *image, fathom_sim_device_t *device, bool driver, bool by_pins,
                          uint32_t us)
{
    static fathom_sim_pins_t pins;
    char name[32];
    start(image, 0);
    profile_begin();
    board_attach(&line, device, !driver && !by_pins);
    if (by_pins) {
        fathom_sim_pins_init(&pins, device, &line, &board.clock);
        board_join_pins(&pins, "B1", "B0", NULL);
    } else {
        board_join_line(&line);
    }
    if (driver) board_join_driver('D', 2);
    board_run_us(us);
    snprintf(name, sizeof name, "stack_%s", image);
    figure(name, profile_deepest_stack(), "B");
}

static void measure_stacks(void)
{
    static fathom_sim_a16_t a16;
    measure_stack("hps167s_rs485", &hps.device, true, false, 2000000);
    fathom_sim_a16_init(
        &a16, &(fathom_sim_a16_config_t){.mode = FATHOM_SIM_A16_PWM, .scene = fathom_sim_fixed(&scene)});
    measure_stack("a16_pulse", &a16.device, false, true, 3000000);
    fathom_sim_a05_init(
        &a05, &(fathom_sim_a05_config_t){.mode = FATHOM_SIM_A05_AUTO, .scene = fathom_sim_fixed(&scene)});
    measure_stack("a16_a05_auto", &a05.device, false, false, 9000000);
}

int main(void)
{
    measure_pulses();
    measure_share(false, false);
    measure_share(true, false);
    measure_share(true, true);
    measure_all_buses();
    measure_crcs();
    show_interrupts();
    measure_stacks();
    return EXIT_SUCCESS;
}
