/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

const uint8_t modes[3] = {FATHOM_LINE_ECHO_AUTO, FATHOM_LINE_ECHO_OFF, FATHOM_LINE_ECHO_ON};
const uint32_t pauses_us[3] = {0, 2000, 20000};
const uint32_t steps_us[3] = {100, 1000, 20000};

void in_every_way(void **state, case_t test)
{
    for (size_t m = 0; m != COUNT_OF(modes); m++)
        for (unsigned seed = BY_BYTE; seed != SEEDS; seed++)
            for (size_t p = 0; p != COUNT_OF(pauses_us); p++)
                for (size_t s = 0; s != COUNT_OF(steps_us); s++)
                    test(state, modes[m], seed, pauses_us[p], steps_us[s]);
}

void set_up_with(void **state, uint8_t echo)
{
    set_up(state);
    bench.config.echo = echo;
}

void run_until_written(size_t written, uint32_t step_us)
{
    for (unsigned i = 0; bench.fake.written < written; i++) {
        assert_true(i < 10000);
        run_in_steps(step_us, step_us);
    }
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

uint8_t known_echo(void) { return fathom_line_echo(&bench.line); }
