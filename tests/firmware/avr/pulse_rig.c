/* SPDX-License-Identifier: MIT */
#include "pulse_rig.h"

#include <stdlib.h>

#include "suite.h"

#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>

enum { BY_ICP1 = 1, BY_INT0 = 2, TOLD_BYTES = 9 };
enum { TCCR1B = 0x81, ICES1 = 0x40 }; /* ATmega328P 36, 16.11.2 */
enum { READY_US = 1000, PATIENCE_US = 40000 };

static void drive(pulse_rig_t *rig, bool high)
{
    /* Off; or on again since the last instruction, after which one more comes first; or another waits. */
    const avr_t *const avr = rig->board.avr;
    if (avr->sreg[S_I] == 0 || avr->interrupt_state != 0) rig->masked = true;
    board_drive(&rig->board, 'B', 0, high);
    board_drive(&rig->board, 'D', 2, high);
}

static avr_cycle_count_t fall(avr_t *avr, avr_cycle_count_t when, void *param)
{
    pulse_rig_t *const rig = param;
    (void)when;
    rig->fall_cycle = avr->cycle;
    drive(rig, false);
    return 0;
}

static avr_cycle_count_t rise(avr_t *avr, avr_cycle_count_t when, void *param)
{
    pulse_rig_t *const rig = param;
    (void)when;
    rig->rise_cycle = avr->cycle;
    rig->masked = false;
    drive(rig, true);
    const uint64_t at = rig->fall_at_cycle;
    avr_cycle_timer_register(avr, at > avr->cycle ? at - avr->cycle : 1, fall, rig);
    return 0;
}

static avr_cycle_count_t byte_comes(avr_t *avr, avr_cycle_count_t when, void *param)
{
    pulse_rig_t *const rig = param;
    (void)avr;
    usart_arrive(&rig->board.usart, rig->byte++, 0);
    return when + rig->byte_cycles;
}

static void overflow(struct avr_irq_t *irq, uint32_t value, void *param)
{
    pulse_rig_t *const rig = param;
    (void)irq;
    if (value != 0) rig->overflow_cycle = rig->board.avr->cycle;
}

/* The capture's flag may rise when its edge is changed (ATmega328P 16.6.3): here it always does. */
static void control_written(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param)
{
    pulse_rig_t *const rig = param;
    (void)address;
    const bool was_rising = rig->is_rising;
    rig->is_rising = (value & ICES1) != 0;
    if (rig->is_rising == was_rising) return;
    for (uint8_t i = 0; i < avr->interrupts.vector_count; i++)
        if (avr->interrupts.vector[i]->vector == PROFILE_TIMER1_CAPTURE)
            avr_raise_interrupt(avr, avr->interrupts.vector[i]);
}

void pulse_rig_start(pulse_rig_t *rig)
{
    assert_true(board_start(&rig->board, "pulses"));
    profile_begin(&rig->profile, &rig->board);
    avr_irq_t *const irq = avr_get_interrupt_irq(rig->board.avr, PROFILE_TIMER1_OVERFLOW);
    assert_non_null(irq);
    avr_irq_register_notify(irq + AVR_INT_IRQ_PENDING, overflow, rig);
    rig->is_rising = false;
    avr_register_io_write(rig->board.avr, TCCR1B, control_written, rig);
    board_drive(&rig->board, 'B', 0, false);
    board_drive(&rig->board, 'D', 2, false);
    assert_true(board_run_us(&rig->board, READY_US));
}

void pulse_rig_end(pulse_rig_t *rig)
{
    assert_false(rig->board.crashed);
    board_end(&rig->board);
}

void pulse_rig_traffic(pulse_rig_t *rig, uint32_t byte_cycles)
{
    avr_cycle_timer_cancel(rig->board.avr, byte_comes, rig);
    rig->byte_cycles = byte_cycles;
    if (byte_cycles != 0) avr_cycle_timer_register(rig->board.avr, byte_cycles, byte_comes, rig);
}

static uint32_t number(const uint8_t *low_first)
{
    return (uint32_t)low_first[0] | (uint32_t)low_first[1] << 8 | (uint32_t)low_first[2] << 16 |
           (uint32_t)low_first[3] << 24;
}

pulse_told_t pulse_rig_pulse(pulse_rig_t *rig, uint64_t at_cycle, uint64_t width_cycles)
{
    avr_t *const avr = rig->board.avr;
    const uint64_t begin = at_cycle > avr->cycle ? at_cycle : avr->cycle + 1;
    rig->fall_at_cycle = begin + width_cycles;
    avr_cycle_timer_register(avr, begin - avr->cycle, rise, rig);

    pulse_told_t told = {0};
    bool by_icp1 = false;
    bool by_int0 = false;
    const uint64_t us = (rig->fall_at_cycle - avr->cycle) / BOARD_CYCLES_PER_US + PATIENCE_US;
    while (!by_icp1 || !by_int0) {
        const board_record_t *const record = board_next_record(&rig->board, us);
        assert_non_null(record);
        assert_int_equal(record->length, TOLD_BYTES);
        if (number(record->bytes) < rig->passed_over_us) continue;
        if (record->kind == BY_ICP1) {
            assert_false(by_icp1);
            by_icp1 = true;
            told.icp1_us = number(record->bytes);
            told.icp1_end_us = number(record->bytes + 4);
        } else {
            assert_int_equal(record->kind, BY_INT0);
            assert_false(by_int0);
            by_int0 = true;
            told.int0_us = number(record->bytes);
            told.int0_end_us = number(record->bytes + 4);
        }
        told.missed = (uint8_t)(told.missed + record->bytes[8]);
    }
    rig->passed_over_us = 0;
    return told;
}

void pulse_rig_glitch(pulse_rig_t *rig, uint64_t at_cycle, uint64_t width_cycles)
{
    board_drive_at(&rig->board, 'B', 0, true, at_cycle);
    board_drive_at(&rig->board, 'D', 2, true, at_cycle);
    board_drive_at(&rig->board, 'B', 0, false, at_cycle + width_cycles);
    board_drive_at(&rig->board, 'D', 2, false, at_cycle + width_cycles);
    rig->passed_over_us = PULSE_RIG_GLITCH_US;
}

int64_t pulse_rig_error(const pulse_rig_t *rig, uint32_t told_us)
{
    return (int64_t)told_us * BOARD_CYCLES_PER_US - (int64_t)(rig->fall_cycle - rig->rise_cycle);
}

uint32_t pulse_rig_longest_cycles(const pulse_rig_t *rig)
{
    uint32_t longest = 0;
    for (int i = 0; i < PROFILE_VECTORS; i++) {
        const uint32_t cycles = rig->profile.interrupts[i].longest_cycles;
        if (i != PROFILE_INT0 && cycles > longest) longest = cycles;
    }
    return longest + BOARD_ENTRY_CYCLES;
}
