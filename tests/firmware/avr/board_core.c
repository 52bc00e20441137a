/* SPDX-License-Identifier: MIT */
/* The processor's turn: simavr 1.6's own loop, but for its interrupts and their flags. */
#include <simavr/avr_extint.h>
#include <simavr/sim_core.h>

#include "board_inside.h"

/* ATmega328P 36, in data space. */
enum { TIFR1 = 0x36, EIFR = 0x3C, EIMSK = 0x3D, TIMSK1 = 0x6F };

/* ---- interrupts ---- */

/*
 * avr_service_interrupts takes one of those that wait out of its queue and puts the first one in that place, by an
 * expression in which the compiler may take either first; where it is the wrong one, another interrupt is lost for
 * ever. So the queue never has more than the one whose turn it is.
 */
static void serve(avr_t *avr)
{
    avr_int_pending_t *const queue = &avr->interrupts.pending;
    if ((queue->write + avr_int_pending_fifo_size - queue->read) % avr_int_pending_fifo_size < 2) {
        avr_service_interrupts(avr);
        return;
    }
    avr_int_vector_t *first = NULL;
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *const vector = avr->interrupts.vector[i];
        if (vector->pending && (first == NULL || vector->vector < first->vector)) first = vector;
    }
    queue->read = queue->write = 0;
    if (first != NULL) queue->buffer[queue->write++] = first;
    avr_service_interrupts(avr);
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *const vector = avr->interrupts.vector[i];
        if (vector->pending && vector != first) queue->buffer[queue->write++] = vector;
    }
    if (avr->sreg[S_I] && avr->interrupt_state == 0) avr->interrupt_state = queue->read != queue->write;
}

static void run(avr_t *avr)
{
    const bool asleep = avr->state == cpu_Sleeping;
    avr_flashaddr_t next = avr->pc;
    if (avr->state == cpu_Running) next = avr_run_one(avr);
    const avr_cycle_count_t left_cycles = avr_cycle_timer_process(avr);
    avr->pc = next;
    if (avr->state == cpu_Sleeping && !avr->sreg[S_I]) avr->state = cpu_Done;
    if (avr->state != cpu_Running && avr->state != cpu_Sleeping) return;
    if (asleep && avr->state == cpu_Sleeping) avr->cycle += left_cycles != 0 ? left_cycles : 1;
    /* After sei and reti one instruction is carried out before any interrupt (ATmega328P 7.7); in simavr two, so that
     * "sei, sleep, cli" would never let one in. */
    const bool waited = avr->interrupt_state < 0;
    if (avr->interrupt_state != 0) serve(avr);
    if (waited && avr->interrupt_state > 0) serve(avr);
}

/* ---- flags ---- */

/* A flag is cleared by a one and by nothing else (ATmega328P 16.11.9, 13.2.3); simavr clears all of a timer. */
static void write_flags(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *const vector = avr->interrupts.vector[i];
        if (vector->raised.reg == address && (value >> vector->raised.bit & 1) != 0)
            avr_clear_interrupt(avr, vector);
    }
}

/* An interrupt whose flag stands comes when it is enabled; in simavr only if it was when the flag rose. */
static void write_mask(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    avr->data[address] = value;
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *const vector = avr->interrupts.vector[i];
        if (vector->enable.reg != address || !avr_regbit_get(avr, vector->enable)) continue;
        if (avr_regbit_get(avr, vector->raised)) avr_raise_interrupt(avr, vector);
    }
}

static void own(avr_t *avr, uint8_t address, avr_io_write_t write)
{
    avr->io[AVR_DATA_TO_IO(address)].w.c = write;
    avr->io[AVR_DATA_TO_IO(address)].w.param = NULL;
}

void board_mend(avr_t *avr)
{
    avr->run = run;
    own(avr, TIFR1, write_flags);
    own(avr, EIFR, write_flags);
    own(avr, TIMSK1, write_mask);
    own(avr, EIMSK, write_mask);
    /* A pin that was low once before its interrupt was set to edges would interrupt for ever. */
    avr_extint_set_strict_lvl_trig(avr, 0, 0);
    avr_extint_set_strict_lvl_trig(avr, 1, 0);
}
