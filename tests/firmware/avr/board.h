/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TEST_AVR_BOARD_H
#define FATHOM_TEST_AVR_BOARD_H

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <stdbool.h>
#include <stdint.h>

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167s.h"
#include "sim/pin.h"
#include "sim/scene.h"
#include "sim/uart.h"
#include "usart.h"

/*
 * An ATmega328P at 16 MHz that runs an image on simavr, wired to simulated sensors (port/sim): the UART to a line,
 * pins to the pins of a device. One time for both: the simulation's clock is the processor's cycles divided by 16.
 * What a device does happens at the first instruction after its time, so up to 3 cycles late, as in the hardware.
 *
 *     board_start("auto");                       image of that name
 *     fathom_sim_line_init(&line, &settings, board.clock.now_us);
 *     fathom_sim_attach(...);
 *     board_join_line(&line);
 *     while (board_run(condition, ctx, most_us)) ...
 *     board_end();
 *
 * The image speaks to the test by three registers that have no other use: a byte written to GPIOR0 is one more of a
 * record, GPIOR1 ends the record and says its kind, GPIOR2 ends the program with an exit code (0 is good).
 *
 * Where simavr 1.6 is not the chip it is mended here: usart.h is in the place of its USART; the 4 cycles of interrupt
 * entry, which it leaves out (ATmega328P 7.7.1), are added; of several interrupts that wait none is lost; writing a one
 * to a flag of Timer1 clears that flag alone; a flag that stands interrupts when it is enabled; sei holds interrupts
 * back for one instruction, not two. Left as they are: 4 more cycles out of sleep; external inputs without their
 * synchroniser (2 cycles) and the noise canceller.
 */
enum { BOARD_HZ = 16000000, BOARD_CYCLES_PER_US = 16, BOARD_ENTRY_CYCLES = 4 };
enum { BOARD_RECORD = 40, BOARD_RECORDS = 64, BOARD_BYTES = 4096, BOARD_EDGES = 512, BOARD_LINE = 80 };
enum { BOARD_WATCHES = 8, BOARD_PLANNED = 16 };

/* What the image has reported. */
typedef struct {
    uint8_t kind, length, bytes[BOARD_RECORD];
    uint64_t cycle;
} board_record_t;

/* A byte on the wire. */
typedef struct {
    uint64_t begin_cycle; /* start bit */
    uint64_t end_cycle;   /* end of the stop bit */
    uint8_t byte;
    uint8_t flags;  /* FATHOM_RX_..., of one that came */
    bool from_here; /* the processor's */
} board_byte_t;

typedef struct {
    uint64_t cycle;
    bool high;
} board_edge_t;

/* An output pin that is looked at. */
typedef struct {
    void (*changed)(void *ctx, bool high);
    void *ctx;
    char port;
    uint8_t bit;
    bool idle_high; /* what a resistor makes of it while it is an input */
    bool high;
} board_watch_t;

/* An edge to come at an input. */
typedef struct {
    char port;
    uint8_t bit;
    bool high, waits;
} board_planned_t;

/* One who follows each instruction; see profile.h. */
typedef struct {
    void (*before)(void);
    void (*after)(void);
    void (*interrupt)(uint8_t vector); /* has been entered, at its vector */
} board_observer_t;

/* The one that there is. */
typedef struct {
    avr_t *avr;
    elf_firmware_t image;
    usart_t usart;
    fathom_sim_clock_t clock; /* for the devices' lines and pins; moved by the board alone */

    bool finished; /* by GPIOR2 or by sleeping without interrupts */
    bool crashed;
    uint8_t exit_code;

    /* Read and reset by the test. Beyond their room the last ones are kept. */
    board_record_t records[BOARD_RECORDS];
    uint32_t recorded; /* in all; number n stands at n % BOARD_RECORDS */
    uint32_t taken;
    board_byte_t bytes[BOARD_BYTES];
    uint32_t bytes_seen;
    board_edge_t driver_edges[BOARD_EDGES];
    uint32_t driver_edges_seen;
    uint32_t cut_bytes;     /* sent while the driver was off, at the beginning or before the end */
    uint32_t talked_over;   /* came while the driver was on */
    uint64_t asleep_cycles; /* of all */

    /* inside */
    fathom_sim_line_t *line;
    fathom_line_settings_t settings;
    board_record_t record;
    board_watch_t watches[BOARD_WATCHES];
    board_planned_t planned[BOARD_PLANNED];
    uint8_t watching;
    uint8_t driven[3]; /* inputs that the bench drives, ports B to D */
    uint8_t levels[3];
    const board_observer_t *observer;
    bool has_driver, driver_on;
    uint64_t driver_off_cycle;
    bool in_break;
    struct {
        const uint8_t *bytes;
        const uint8_t *marks;
        uint16_t left;
        uint32_t cycles;
    } fed;
    struct {
        fathom_sim_pins_t *pins;
        char port[2];
        uint8_t bit[2], inputs;
    } joined;
    struct {
        uint32_t seen; /* of `bytes` */
        uint32_t length;
        char line[BOARD_LINE];
    } text;
} board_t;

extern board_t board;

/* The folder of images: FATHOM_IMAGES of the environment, or else of the compiler. Ends the one that runs. */
void board_start_from(const char *folder, const char *name);
static inline void board_start(const char *name) { board_start_from(FATHOM_IMAGES, name); }
void board_end(void);
/* The same, for a suite_t: the image has not crashed. */
int board_stop(void **state);

/* Runs until done(ctx), and says whether that came about: false when most_us are over, or when the program has ended
 * or crashed (with a message) before. done: NULL for never. */
typedef bool (*board_condition_t)(void *ctx);
bool board_run(board_condition_t done, void *ctx, uint64_t most_us);

/* Runs so long, sleep included; false: it ended before. */
bool board_run_us(uint32_t us);

/* Time passes and the processor does nothing: moves what it does next against its timers, cycle by cycle. */
void board_stall(uint64_t cycles);

/* The next record, running until there is one; NULL: none came within most_us. Valid until the next call. */
const board_record_t *board_next_record(uint64_t most_us);

/* The next record of that kind, running until there is one. Fails the test when none comes within most_us. */
const board_record_t *board_await(uint8_t kind, uint64_t most_us);

/* The next line of text that the image sends by its UART, without its end, running until there is one; "": none came
 * within most_us. Valid until the next call. */
const char *board_line(uint64_t most_us);

/* Is this the long run, with FATHOM_LONG in its environment? Then sweeps leave nothing out. */
bool board_has_time(void);

/* ---- wires ---- */

/* The UART to `line`, which is put on the board's clock. Its settings are the USART's registers' from here on; a
 * break on TXD is one. The line is half or full duplex, with or without echo, as the test has set it. */
void board_join_line(fathom_sim_line_t *line);

/* Initialises a line, with the settings of `device`, and puts the device on it. */
void board_attach(fathom_sim_line_t *line, fathom_sim_device_t *device, bool full_duplex);

/* Driver-enable of an RS-485 transceiver, pulled down: bytes that leave while it is low, or whose end it cuts off,
 * do not reach the line; what comes while it is high is garbage. */
void board_join_driver(char port, uint8_t bit);

/* A device's RX to an output pin (pulled up until it is one), and its TX to input pins: up to two, as "B0" and "D2";
 * NULL: none. Once a board. `pins` is initialised with board.clock. */
void board_join_pins(fathom_sim_pins_t *pins, const char *trigger, const char *input, const char *input_too);

/* Puts bytes on RXD without a device or a line, back to back from at_cycle on, each for `cycles` (0: as long as the
 * USART's registers have it). marks: FATHOM_RX_... of each, or NULL. Both arrays outlive the last byte; what was fed
 * before and has not come yet does not come any more. */
void board_feed(const uint8_t *bytes, const uint8_t *marks, uint16_t count, uint64_t at_cycle,
                uint32_t cycles);

/* Drives an input from outside, now, or at a cycle to come (up to BOARD_PLANNED at a time). */
void board_drive(char port, uint8_t bit, bool high);
void board_drive_at(char port, uint8_t bit, bool high, uint64_t cycle);

/* Calls `changed` when an output pin changes. */
board_watch_t *board_watch(char port, uint8_t bit, bool idle_high, void (*changed)(void *ctx, bool high),
                           void *ctx);

/* Ends the test program with a message. */
__attribute__((noreturn, format(printf, 1, 2))) void board_give_up(const char *format, ...);

/* ---- the image's memory ---- */

/* A number of so many bytes, the low one first, as the image has them. */
uint32_t board_number(const uint8_t *bytes, int length);

/* The address of a symbol; of data without the 0x800000 that the linker adds. Ends the test program with a message
 * if there is none. */
uint32_t board_address(const char *symbol);
uint8_t *board_data(const char *symbol);

/* Brings the simulation to the processor's time, as the test's own calls into it need. */
void board_sync(void);
/* To be called after the test has done something to a line or a device. */
void board_plan(void);

#endif
