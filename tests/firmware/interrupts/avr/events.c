/* SPDX-License-Identifier: MIT */
#include "host.h"

#include <simavr/avr_timer.h>
#include <string.h>

#include "profile.h"

const char *const event_names[EVENTS] = {"none", "byte", "flawed", "behind",  "left",
                                         "late", "int0", "icp1",   "overflow"};

truth_t truth;

/* Timer1 in normal mode, its clock divided by 8 (ATmega328P 16.9.1, 16.11.2). */
enum { PERIOD_CYCLES = 65536 * 8 };

void truth_begin(uint32_t zero_us)
{
    memset(&truth, 0, sizeof truth);
    for (avr_io_t *io = board.avr->io_port; io != NULL; io = io->next) {
        const avr_timer_t *const timer = (const avr_timer_t *)io;
        if (strcmp(io->kind, "timer") == 0 && timer->name == '1') truth.zero_cycle = timer->tov_base;
    }
    truth.zero_us = zero_us;
    uint8_t *const periods_us = board_data("periods_us");
    for (int i = 0; i < 4; i++) periods_us[i] = (uint8_t)(zero_us >> 8 * i);
}

uint32_t truth_us(uint64_t cycle)
{
    return (uint32_t)(truth.zero_us + (cycle - truth.zero_cycle) / BOARD_CYCLES_PER_US);
}

uint64_t truth_overflow_cycle(void)
{
    const uint64_t since = board.avr->cycle - truth.zero_cycle;
    return truth.zero_cycle + (since / PERIOD_CYCLES + 1) * PERIOD_CYCLES;
}

void event_byte(uint8_t byte, uint8_t flags)
{
    if (truth.count == MOST_BYTES) board_give_up("more bytes than there is room for");
    truth.bytes[truth.count] = byte;
    truth.flags[truth.count++] = flags;
    usart_arrive(&board.usart, byte, flags);
}

void event_edge(uint8_t which)
{
    if (truth.edges[which] == MOST_EDGES) board_give_up("more edges than there is room for");
    truth.edge_cycles[which][truth.edges[which]++] = board.avr->cycle;
    board_drive(which == 0 ? 'D' : 'B', which == 0 ? 2 : 0, truth.edges[which] % 2 != 0);
}

/* The shortest character: 10 bits of 8 cycles, at 2 Mbaud (ATmega328P 20.3.1). None that began later has left. */
static bool may_leave(void) { return board.avr->cycle - board.usart.begin_cycle >= 80; }

static bool in_empty_interrupt(void)
{
    const avr_int_table_t *const table = &board.avr->interrupts;
    return table->running_ptr != 0 && table->running[table->running_ptr - 1]->vector == PROFILE_USART_EMPTY;
}

bool event_raise(event_t event, uint8_t number)
{
    static const uint8_t bytes[2] = {0xA1, 0x5C};
    switch (event) {
    case EVENT_BYTE:
        event_byte(bytes[number], 0);
        return true;
    case EVENT_FLAWED:
        event_byte((uint8_t)~bytes[number], FATHOM_RX_PARITY | FATHOM_RX_FRAMING);
        return true;
    case EVENT_BEHIND:
        event_byte((uint8_t)(bytes[number] + 1), FATHOM_RX_OVERRUN);
        return true;
    case EVENT_LEFT:
        return may_leave() && usart_hurry(&board.usart);
    case EVENT_LATE: /* of the byte that the interrupt has just written there is no talk */
        return !in_empty_interrupt() && may_leave() && usart_hurry(&board.usart) && usart_hurry(&board.usart);
    case EVENT_INT0:
        event_edge(0);
        return true;
    case EVENT_ICP1:
        event_edge(1);
        return true;
    default:
        board_give_up("%s is not raised", event_names[event]);
    }
}

bool event_has_vector(event_t event, uint8_t vector)
{
    switch (event) {
    case EVENT_BYTE:
    case EVENT_FLAWED:
    case EVENT_BEHIND:
        return vector == PROFILE_USART_RECEIVE;
    case EVENT_LEFT:
    case EVENT_LATE:
        return vector == PROFILE_USART_EMPTY || vector == PROFILE_USART_TRANSMIT;
    case EVENT_INT0:
        return vector == PROFILE_INT0;
    case EVENT_ICP1:
        return vector == PROFILE_TIMER1_CAPTURE;
    default:
        return vector == PROFILE_TIMER1_OVERFLOW;
    }
}
