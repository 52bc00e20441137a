/* SPDX-License-Identifier: MIT */
/* The bench against the ATmega328P's datasheet, with an image of which every cycle is known (images/bench.c). */
#include <stdio.h>

#include "suite.h"

#include "profile.h"

static int start(void **state)
{
    board_start("bench");
    for (uint8_t bit = 2; bit <= 4; bit++) board_drive('D', bit, false);
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

/* Runs until it reports a record of that kind. */
static board_record_t reported(char kind) { return *board_await((uint8_t)kind, 1000000); }

static void assert_cost(const profile_cost_t *cost, uint32_t calls, uint32_t cycles, uint16_t stack)
{
    assert_int_equal(cost->calls, calls);
    assert_int_equal(cost->longest_cycles, cycles);
    assert_int_equal(cost->shortest_cycles, cycles);
    assert_int_equal(cost->total_cycles, calls * cycles);
    assert_int_equal(cost->stack, stack);
}

TEST(functions_cost_what_the_instruction_set_says)
{
    profile_begin();
    const profile_cost_t *const forty = profile_function("forty_cycles");
    const profile_cost_t *const pushes = profile_function("three_pushes");
    reported('2');
    assert_cost(forty, 10, 40, 2);
    assert_cost(pushes, 5, 59, 7);
    assert_int_equal(profile_awake_cycles(), board.avr->cycle);
    assert_int_equal(profile.asleep_cycles, 0);
    assert_true(profile_deepest_stack() >= 2 + 7); /* main's return address */
    assert_true(profile_deepest_stack() < 30);
}

/* Between the reports 1 and 2 the functions run, after 2 come 400 nops. */
TEST(interrupts_are_no_cycles_and_no_stack_of_the_function_that_they_interrupt)
{
    reported('1');
    profile_begin();
    const profile_cost_t *const forty = profile_function("forty_cycles");
    for (int i = 0; i < 8; i++) board_drive_at('D', 2, i % 2 == 0, board.avr->cycle + 20 + 53 * (uint64_t)i);
    reported('2');
    assert_int_equal(profile.interrupts[PROFILE_INT0].calls, 8);
    assert_cost(forty, 10, 40, 2);
    assert_int_equal(profile_deepest_stack(),
                     2 + 7 + 2); /* main's return address, three_pushes, the interrupt's */
}

static uint64_t cycles_to_the_first_byte(void)
{
    const uint64_t cycle = reported('2').cycle;
    return reported('d').cycle - cycle;
}

TEST(an_interrupt_costs_its_cycles_and_four_of_entry)
{
    const uint64_t without = cycles_to_the_first_byte();
    start(state);
    reported('2');
    const uint64_t begin_cycle = board.avr->cycle;
    profile_begin();
    board_drive_at('D', 2, true, begin_cycle + 30);
    board_drive_at('D', 2, false, begin_cycle + 100);
    assert_int_equal(reported('d').cycle - begin_cycle + 1, without + 2 * (18 + 4));
    assert_cost(&profile.interrupts[PROFILE_INT0], 2, 18, 2);
    assert_int_equal(profile.entries, 2);
}

TEST(an_interrupt_that_is_interrupted_is_charged_its_own_cycles)
{
    reported('2');
    const uint64_t begin_cycle = board.avr->cycle;
    profile_begin();
    board_drive_at('D', 3, true, begin_cycle + 30);
    board_drive_at('D', 2, true, begin_cycle + 60);
    reported('d');
    assert_int_equal(profile.interrupts[PROFILE_INT0].calls, 1);
    assert_int_equal(profile.interrupts[PROFILE_INT0].longest_cycles, 18);
    assert_int_equal(profile.interrupts[2].calls, 1);
    assert_int_equal(profile.interrupts[2].longest_cycles, 48);
    assert_int_equal(profile.main_cycles + 18 + 48 + 8, board.avr->cycle - begin_cycle);
}

/* ATmega328P 20.6: the second byte is taken while the first leaves, the third one character later, and transmit
 * complete comes once, behind the third. */
TEST(the_transmitter_has_a_second_buffer)
{
    const uint32_t character = 10 * 104 * 16; /* UBRR 103, 8N1 */
    const uint64_t first = reported('d').cycle;
    const uint64_t second = reported('d').cycle;
    const uint64_t third = reported('d').cycle;
    const uint64_t complete = reported('t').cycle;
    assert_true(second - first < 30);
    assert_in_range(third, first + character - 20, first + character + 20);
    assert_int_equal(board.bytes_seen, 3);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(board.bytes[i].byte, 0x41 + i);
        assert_int_equal(board.bytes[i].end_cycle - board.bytes[i].begin_cycle, character);
        if (i != 0) assert_int_equal(board.bytes[i].begin_cycle, board.bytes[i - 1].end_cycle);
    }
    assert_in_range(complete, board.bytes[2].end_cycle, board.bytes[2].end_cycle + 20);
}

/* 20.7.3 and 20.7.4: two are buffered, one waits in the shift register; the next one's start bit throws that out, and
 * the first that is buffered after the loss has DOR0. */
TEST(the_receiver_keeps_three_bytes_and_tells_what_was_lost)
{
    static const uint8_t bytes[] = {1, 2, 3, 4, 5};
    static const uint8_t marks[] = {0, FATHOM_RX_FRAMING, 0, 0, FATHOM_RX_FRAMING | FATHOM_RX_PARITY};
    reported('3');
    board_feed(bytes, marks, sizeof bytes, board.avr->cycle, 0);
    board_run_us(6000);
    board_drive('D', 4, true);
    const board_record_t record = reported('b');
    /* RXC0 0x80, TXC0 0x40, UDRE0 0x20, FE0 0x10, DOR0 0x08; no UPE0, as there is no parity in 8N1 */
    static const uint8_t expected[] = {0xE0, 1, 0xF0, 2, 0xF8, 5};
    assert_int_equal(record.length, sizeof expected);
    assert_memory_equal(record.bytes, expected, sizeof expected);
    assert_int_equal(board.usart.overruns, 2);
}

TEST(receive_complete_interrupts_as_long_as_a_byte_waits)
{
    static const uint8_t byte = 0x77;
    reported('3');
    board_drive('D', 4, true);
    reported('b');
    board_run_us(10);
    profile_begin();
    board_feed(&byte, NULL, 1, board.avr->cycle, 0);
    const board_record_t record = reported('r');
    static const uint8_t expected[] = {0xE0, 0x77};
    assert_memory_equal(record.bytes, expected, sizeof expected);
    board_run_us(1000);
    assert_int_equal(profile.interrupts[PROFILE_USART_RECEIVE].calls, 3);
}

/* A16 1: S[cm] = T[us] / 57.5, so 1739 mm are 9999 us. The loop of the image sees an edge within 40 cycles. */
TEST(a_device_on_the_pins_answers_the_trigger_with_its_pulse)
{
    fathom_sim_a16_t a16;
    fathom_sim_line_t line;
    fathom_sim_pins_t pins;
    fathom_sim_fixed_t target = {{1739, 0, 0, 0}};
    const fathom_sim_a16_config_t config = {.mode = FATHOM_SIM_A16_PWM, .scene = fathom_sim_fixed(&target)};
    fathom_sim_a16_init(&a16, &config);
    board_attach(&line, &a16.device, true);
    fathom_sim_pins_init(&pins, &a16.device, &line, &board.clock);
    board_join_pins(&pins, "B1", "B0", "D2");
    board_drive('D', 4, true);
    reported('b');
    assert_int_equal(reported('p').bytes[0], 0);
    const board_record_t high = reported('p');
    const board_record_t low = reported('p');
    assert_int_equal(high.bytes[0], 0x05); /* B0 and D2 */
    assert_int_equal(low.bytes[0], 0);
    const uint64_t width = low.cycle - high.cycle;
    assert_in_range(width, 9999 * BOARD_CYCLES_PER_US - 40, 9999 * BOARD_CYCLES_PER_US + 40);
    assert_int_equal(a16.device.counters.measurements, 1);
}

TEST(a_program_that_sleeps_is_charged_nothing_and_ends_with_its_code)
{
    board_drive('D', 4, true);
    reported('b');
    board_run_us(3000);
    board_drive('D', 4, false);
    board_run_us(10);
    assert_int_equal(board.avr->state, cpu_Sleeping);
    profile_begin();
    const uint64_t begin_cycle = board.avr->cycle;
    board_run_us(1000000);
    assert_in_range(profile.asleep_cycles, 1000000 * BOARD_CYCLES_PER_US - 2000,
                    1000000 * BOARD_CYCLES_PER_US + 2000);
    assert_int_equal(profile_awake_cycles(), 0);
    assert_false(board.finished);
    board_drive('D', 2, true);
    board_run_us(10);
    assert_int_equal(profile.interrupts[PROFILE_INT0].calls, 1);
    assert_int_equal(profile_awake_cycles() + profile.asleep_cycles, board.avr->cycle - begin_cycle);
    assert_true(board.finished);
    assert_int_equal(board.exit_code, 7);
}
