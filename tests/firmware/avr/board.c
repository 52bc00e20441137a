/* SPDX-License-Identifier: MIT */
#include "board.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board_inside.h"

enum { GPIOR0 = 0x3E, GPIOR1 = 0x4A, GPIOR2 = 0x4B }; /* ATmega328P 36, in data space */

/* The simulation has to see the time now and then (sim.h). */
static const uint32_t most_ahead_us = UINT32_C(60000000);

/* ---- one time for both ---- */

static void deliver(board_t *board)
{
    uint8_t byte;
    fathom_rx_t rx = {0, 0};
    const uint8_t knows = FATHOM_RX_TIMED | FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN;
    while (fathom_sim_transmit_timed(board->line, board->clock.now_us, &byte, 1, knows, &rx) != 0) {
        board_arrived(board, byte, rx.flags, fathom_elapsed_us(board->clock.now_us, rx.last_us));
        rx.flags = 0;
    }
}

void board_sync(board_t *board)
{
    const uint32_t now_us = (uint32_t)(board->avr->cycle / BOARD_CYCLES_PER_US);
    fathom_sim_clock_advance(&board->clock, fathom_elapsed_us(now_us, board->clock.now_us));
    if (board->line != NULL) deliver(board);
}

static avr_cycle_count_t something_is_due(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr;
    (void)when;
    board_t *const board = (board_t *)param;
    board_sync(board);
    board_plan(board);
    return 0;
}

void board_plan(board_t *board)
{
    const uint64_t cycle = board->avr->cycle;
    uint32_t due_us = most_ahead_us;
    for (fathom_sim_line_t *line = board->clock.lines; line != NULL; line = line->next) {
        const uint32_t line_due_us = fathom_sim_due_us(line, board->clock.now_us);
        if (line_due_us < due_us) due_us = line_due_us;
    }
    const uint64_t due_cycle =
        (cycle / BOARD_CYCLES_PER_US + (due_us != 0 ? due_us : 1)) * BOARD_CYCLES_PER_US;
    avr_cycle_timer_register(board->avr, due_cycle - cycle, something_is_due, board);
}

/* ---- what the image reports ---- */

static void report_byte(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    board_record_t *const record = &((board_t *)param)->record;
    avr->data[address] = value;
    if (record->length < BOARD_RECORD) record->bytes[record->length++] = value;
}

static void report_end(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    board_t *const board = (board_t *)param;
    avr->data[address] = value;
    board->record.kind = value;
    board->record.cycle = avr->cycle;
    board->records[board->recorded++ % BOARD_RECORDS] = board->record;
    board->record.length = 0;
}

static void report_exit(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    board_t *const board = (board_t *)param;
    avr->data[address] = value;
    board->exit_code = value;
    board->finished = true;
}

/* ---- run ---- */

/* At an entry the processor stands at the vector, at a return it does not. */
static void on_interrupt(avr_irq_t *irq, uint32_t vector, void *param)
{
    (void)irq;
    board_t *const board = (board_t *)param;
    if (vector == 0 || board->avr->pc != vector * board->avr->vector_size) return;
    board->avr->cycle += BOARD_ENTRY_CYCLES;
    if (board->observer != NULL) board->observer->interrupt(board->observer->ctx, (uint8_t)vector);
}

static bool step(board_t *board)
{
    avr_t *const avr = board->avr;
    const bool asleep = avr->state == cpu_Sleeping;
    const uint64_t cycle = avr->cycle;
    if (board->observer != NULL) board->observer->before(board->observer->ctx);
    const int state = avr_run(avr);
    if (asleep) board->asleep_cycles += avr->cycle - cycle;
    if (board->observer != NULL) board->observer->after(board->observer->ctx);
    if (state == cpu_Crashed) {
        board->crashed = board->finished = true;
        fprintf(stderr, "the image crashed at 0x%04x, cycle %llu\n", (unsigned)avr->pc,
                (unsigned long long)avr->cycle);
    }
    if (state == cpu_Done) board->finished = true;
    return !board->finished;
}

/* A processor that sleeps wakes at the next timer, if only to see that it is to go on. */
static avr_cycle_count_t nothing(avr_t *avr, avr_cycle_count_t when, void *param)
{
    (void)avr, (void)when, (void)param;
    return 0;
}

bool board_run(board_t *board, board_condition_t done, void *ctx, uint64_t most_us)
{
    bool is_done = false;
    const uint64_t left_cycles = most_us * BOARD_CYCLES_PER_US;
    const uint64_t end_cycle = board->avr->cycle + left_cycles;
    avr_cycle_timer_register(board->avr, left_cycles, nothing, board);
    while (!(is_done = done != NULL && done(ctx)) && !board->finished && board->avr->cycle < end_cycle)
        step(board);
    avr_cycle_timer_cancel(board->avr, nothing, board);
    board_sync(board);
    return is_done;
}

bool board_run_us(board_t *board, uint32_t us)
{
    board_run(board, NULL, NULL, us);
    return !board->finished;
}

void board_stall(board_t *board, uint64_t cycles) { board->avr->cycle += cycles; }

static bool has_record(void *ctx)
{
    const board_t *const board = (const board_t *)ctx;
    return board->recorded != board->taken;
}

const board_record_t *board_next_record(board_t *board, uint64_t most_us)
{
    if (!board_run(board, has_record, board, most_us) && !has_record(board)) return NULL;
    if (board->recorded - board->taken > BOARD_RECORDS) {
        fprintf(stderr, "%u records were lost\n", (unsigned)(board->recorded - board->taken - BOARD_RECORDS));
        exit(EXIT_FAILURE);
    }
    return &board->records[board->taken++ % BOARD_RECORDS];
}

/* ---- begin and end ---- */

/* What simavr says of itself is of no interest; what it complains of is. */
static void complain(avr_t *avr, const int level, const char *format, va_list arguments)
{
    (void)avr;
    if (level == LOG_ERROR) vfprintf(stderr, format, arguments);
}

bool board_start(board_t *board, const char *name)
{
    char path[512];
    memset(board, 0, sizeof *board);
    const char *const images = getenv("FATHOM_IMAGES");
    snprintf(path, sizeof path, "%s/%s.elf", images != NULL ? images : FATHOM_IMAGES, name);
    avr_global_logger_set(complain);
    if (elf_read_firmware(path, &board->image) != 0) {
        fprintf(stderr, "%s cannot be read\n", path);
        return false;
    }
    avr_t *const avr = board->avr = avr_make_mcu_by_name("atmega328p");
    if (avr == NULL) return false;
    avr_init(avr);
    board->image.frequency = BOARD_HZ;
    avr_load_firmware(avr, &board->image);
    fathom_sim_clock_init(&board->clock, 0, 0);
    if (!usart_begin(&board->usart, avr)) {
        fprintf(stderr, "this simavr has no USART0 as expected\n");
        return false;
    }
    board_mend(avr);
    board_wire(board);
    avr_register_io_write(avr, GPIOR0, report_byte, board);
    avr_register_io_write(avr, GPIOR1, report_end, board);
    avr_register_io_write(avr, GPIOR2, report_exit, board);
    avr_irq_register_notify(avr_get_interrupt_irq(avr, AVR_INT_ANY) + AVR_INT_IRQ_RUNNING, on_interrupt,
                            board);
    board_plan(board);
    return true;
}

void board_end(board_t *board)
{
    avr_terminate(board->avr);
    free(board->avr);
    board->avr = NULL;
}

/* ---- memory ---- */

uint32_t board_address(const board_t *board, const char *symbol)
{
    for (uint32_t i = 0; i < board->image.symbolcount; i++)
        if (strcmp(board->image.symbol[i]->symbol, symbol) == 0) return board->image.symbol[i]->addr & 0xFFFF;
    fprintf(stderr, "the image has no symbol %s\n", symbol);
    exit(EXIT_FAILURE);
}

uint8_t *board_data(board_t *board, const char *symbol)
{
    return &board->avr->data[board_address(board, symbol)];
}
