/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

const uint8_t modes[3] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON};
const uint32_t pauses_us[3] = {0, 2000, 20000};
const uint32_t steps_us[3] = {100, 1000, 20000};

void in_every_way(void (*test)(const way_t *way))
{
    for (size_t m = 0; m != COUNT_OF(modes); m++)
        for (unsigned seed = BY_BYTE; seed != SEEDS; seed++)
            for (size_t p = 0; p != COUNT_OF(pauses_us); p++)
                for (size_t s = 0; s != COUNT_OF(steps_us); s++)
                    test(&(way_t){modes[m], seed, pauses_us[p], steps_us[s]});
}

void set_up_with(uint8_t echo)
{
    void *state;
    set_up(&state);
    set_up_echo(echo);
}

void run_until_written(size_t written, uint32_t step_us)
{
    for (unsigned i = 0; bench.fake.written < written; i++) {
        assert_true(i < 10000);
        run_in_steps(step_us, step_us);
    }
}

void send_1(uint8_t retries, uint32_t step_us)
{
    const size_t before = bench.fake.written;
    ask_1(retries);
    run_until_written(before + 1, step_us);
}

void come(unsigned seed, uint32_t in_us, const uint8_t *bytes, size_t length)
{
    uint32_t random = seed * 2654435761u;
    for (size_t at = 0; at != length;) {
        size_t piece = 1;
        if (seed != BY_BYTE) {
            random = random * 1664525u + 1013904223u;
            piece += (random >> 24) % 4; /* under GAP_US apart */
        }
        if (piece > length - at) piece = length - at;
        fake_receive(&bench.fake, in_us + (uint32_t)(at + piece) * BYTE_US, bytes + at, piece);
        at += piece;
    }
}

void read_once(bool echoes)
{
    send_1(0, 100);
    if (echoes) come_all(0, ask_1_processed);
    come_all(20000, response_1_754);
    run(60000);
    expect_mm(754);
}

uint8_t known_echo(void) { return fathom_line_get_echo(&bench.line); }

void expect_learned(uint8_t mode, uint8_t echo) { expect_echo(mode == FATHOM_LINE_ECHO_AUTO ? echo : mode); }
