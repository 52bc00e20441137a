/* SPDX-License-Identifier: MIT */
#include "board.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "suite.h"

#include "board_inside.h"

enum { GPIOR0 = 0x3E, GPIOR1 = 0x4A, GPIOR2 = 0x4B }; /* ATmega328P 36, in data space */

board_t board;

/* The simulation has to see the time now and then (sim.h). */
static const uint32_t most_ahead_us = UINT32_C(60000000);

void board_give_up(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    exit(EXIT_FAILURE);
}

/* ---- one time for both ---- */

static void deliver(void)
{
    uint8_t byte;
    fathom_rx_t rx = {0, 0};
    const uint8_t knows = FATHOM_RX_TIMED | FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN;
    while (fathom_sim_transmit_timed(board.line, board.clock.now_us, &byte, 1, knows, &rx) != 0) {
        board_arrived(byte, rx.flags, fathom_elapsed_us(board.clock.now_us, rx.last_us));
        rx.flags = 0;
    }
}

void board_sync(void)
{
    const uint32_t now_us = (uint32_t)(board.avr->cycle / BOARD_CYCLES_PER_US);
    fathom_sim_clock_advance(&board.clock, fathom_elapsed_us(now_us, board.clock.now_us));
    if (board.line != NULL) deliver();
}

static avr_cycle_count_t something_is_due(avr_t *avr, avr_cycle_count_t when, void *param)
{
    board_sync();
    board_plan();
    return 0;
}

void board_plan(void)
{
    const uint64_t cycle = board.avr->cycle;
    uint32_t due_us = most_ahead_us;
    for (fathom_sim_line_t *line = board.clock.lines; line != NULL; line = line->next) {
        const uint32_t line_due_us = fathom_sim_due_us(line, board.clock.now_us);
        if (line_due_us < due_us) due_us = line_due_us;
    }
    const uint64_t due_cycle =
        (cycle / BOARD_CYCLES_PER_US + (due_us != 0 ? due_us : 1)) * BOARD_CYCLES_PER_US;
    avr_cycle_timer_register(board.avr, due_cycle - cycle, something_is_due, NULL);
}

/* ---- what the image reports ---- */

static void report_byte(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    board_record_t *const record = &board.record;
    avr->data[address] = value;
    if (record->length < BOARD_RECORD) record->bytes[record->length++] = value;
}

static void report_end(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    avr->data[address] = value;
    board.record.kind = value;
    board.record.cycle = avr->cycle;
    board.records[board.recorded++ % BOARD_RECORDS] = board.record;
    board.record.length = 0;
}

static void report_exit(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    avr->data[address] = value;
    board.exit_code = value;
    board.finished = true;
}

/* ---- run ---- */

/* At an entry the processor stands at the vector, at a return it does not. */
static void on_interrupt(avr_irq_t *irq, uint32_t vector, void *param)
{
    if (vector == 0 || board.avr->pc != vector * board.avr->vector_size) return;
    board.avr->cycle += BOARD_ENTRY_CYCLES;
    if (board.observer != NULL) board.observer->interrupt((uint8_t)vector);
}

static bool step(void)
{
    avr_t *const avr = board.avr;
    const bool asleep = avr->state == cpu_Sleeping;
    const uint64_t cycle = avr->cycle;
    if (board.observer != NULL) board.observer->before();
    const int state = avr_run(avr);
    if (asleep) board.asleep_cycles += avr->cycle - cycle;
    if (board.observer != NULL) board.observer->after();
    if (state == cpu_Crashed) {
        board.crashed = board.finished = true;
        fprintf(stderr, "the image crashed at 0x%04x, cycle %llu\n", (unsigned)avr->pc,
                (unsigned long long)avr->cycle);
    }
    if (state == cpu_Done) board.finished = true;
    return !board.finished;
}

/* A processor that sleeps wakes at the next timer, if only to see that it is to go on. */
static avr_cycle_count_t nothing(avr_t *avr, avr_cycle_count_t when, void *param) { return 0; }

bool board_run(board_condition_t done, void *ctx, uint64_t most_us)
{
    bool is_done = false;
    const uint64_t left_cycles = most_us * BOARD_CYCLES_PER_US;
    const uint64_t end_cycle = board.avr->cycle + left_cycles;
    avr_cycle_timer_register(board.avr, left_cycles, nothing, NULL);
    while (!(is_done = done != NULL && done(ctx)) && !board.finished && board.avr->cycle < end_cycle) step();
    avr_cycle_timer_cancel(board.avr, nothing, NULL);
    board_sync();
    return is_done;
}

bool board_run_us(uint32_t us)
{
    board_run(NULL, NULL, us);
    return !board.finished;
}

void board_stall(uint64_t cycles) { board.avr->cycle += cycles; }

static bool has_record(void *ctx) { return board.recorded != board.taken; }

const board_record_t *board_next_record(uint64_t most_us)
{
    if (!board_run(has_record, NULL, most_us) && !has_record(NULL)) return NULL;
    if (board.recorded - board.taken > BOARD_RECORDS) board_give_up("records were lost");
    return &board.records[board.taken++ % BOARD_RECORDS];
}

const board_record_t *board_await(uint8_t kind, uint64_t most_us)
{
    const board_record_t *record;
    do assert_non_null(record = board_next_record(most_us));
    while (record->kind != kind);
    return record;
}

/* ---- text ---- */

/* Takes what has been sent; true at the end of a line. */
static bool has_line(void *ctx)
{
    while (board.text.seen != board.bytes_seen) {
        const board_byte_t *const byte = &board.bytes[board.text.seen++ % BOARD_BYTES];
        if (!byte->from_here || byte->byte == '\r') continue;
        if (byte->byte == '\n') return true;
        if (board.text.length < BOARD_LINE - 1) board.text.line[board.text.length++] = (char)byte->byte;
    }
    return false;
}

const char *board_line(uint64_t most_us)
{
    board.text.length = 0;
    if (!board_run(has_line, NULL, most_us)) return "";
    board.text.line[board.text.length] = '\0';
    return board.text.line;
}

/* ---- begin and end ---- */

/* What simavr says of itself is of no interest; what it complains of is. */
static void complain(avr_t *avr, const int level, const char *format, va_list arguments)
{
    if (level == LOG_ERROR) vfprintf(stderr, format, arguments);
}

bool board_has_time(void) { return getenv("FATHOM_LONG") != NULL; }

void board_start_from(const char *folder, const char *name)
{
    char path[512];
    if (board.avr != NULL) board_end();
    memset(&board, 0, sizeof board);
    const char *const images = getenv("FATHOM_IMAGES");
    snprintf(path, sizeof path, "%s/%s.elf", images != NULL ? images : folder, name);
    avr_global_logger_set(complain);
    if (elf_read_firmware(path, &board.image) != 0) board_give_up("%s cannot be read", path);
    avr_t *const avr = board.avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL) board_give_up("this simavr has no ATmega328P");
    avr_init(avr);
    board.image.frequency = BOARD_HZ;
    avr_load_firmware(avr, &board.image);
    fathom_sim_clock_init(&board.clock, 0, 0);
    if (!usart_begin(&board.usart, avr)) board_give_up("this simavr has no USART0 as expected");
    board_mend(avr);
    board_wire();
    avr_register_io_write(avr, GPIOR0, report_byte, NULL);
    avr_register_io_write(avr, GPIOR1, report_end, NULL);
    avr_register_io_write(avr, GPIOR2, report_exit, NULL);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, AVR_INT_ANY) + AVR_INT_IRQ_RUNNING, on_interrupt,
                            NULL);
    board_plan();
}

void board_end(void)
{
    avr_terminate(board.avr);
    free(board.avr);
    board.avr = NULL;
}

int board_stop(void **state)
{
    const bool has_crashed = board.crashed;
    board_end();
    return has_crashed;
}

/* ---- memory ---- */

uint32_t board_number(const uint8_t *bytes, int length)
{
    uint32_t number = 0;
    while (length-- != 0) number = number << 8 | bytes[length];
    return number;
}

uint32_t board_address(const char *symbol)
{
    for (uint32_t i = 0; i < board.image.symbolcount; i++)
        if (strcmp(board.image.symbol[i]->symbol, symbol) == 0) return board.image.symbol[i]->addr & 0xFFFF;
    board_give_up("the image has no symbol %s", symbol);
}

uint8_t *board_data(const char *symbol) { return &board.avr->data[board_address(symbol)]; }
