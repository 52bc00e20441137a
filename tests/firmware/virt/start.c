/* SPDX-License-Identifier: MIT */
#include "start.h"

#include <stdint.h>

#define MCAUSE_TIMER    0x80000007u
#define MCAUSE_EXTERNAL 0x8000000Bu
#define MSTATUS_MIE     8u

/* QEMU's device for the end of a test. */
#define TEST_FINISHER (*(volatile uint32_t *)0x00100000u)
enum { FINISHER_FAIL = 0x3333, FINISHER_PASS = 0x5555 };

#define OR_FAULT __attribute__((weak, alias("start_unexpected")))

extern uint32_t start_bss[], start_bss_end[];
int main(void);
void start_main(void);
void start_reset(void);
void start_trap(void);
void start_unexpected(void);
void external_interrupt(void) OR_FAULT;
void timer_interrupt(void) OR_FAULT;

static void end(int status)
{
    TEST_FINISHER = status == 0 ? FINISHER_PASS : (uint32_t)status << 16 | FINISHER_FAIL;
    for (;;) {
    }
}

void start_unexpected(void) { end(START_FAULT); }

__attribute__((interrupt("machine"), aligned(4))) void start_trap(void)
{
    uint32_t cause;
    __asm__ volatile("csrr %0, mcause" : "=r"(cause));
    if (cause == MCAUSE_EXTERNAL)
        external_interrupt();
    else if (cause == MCAUSE_TIMER)
        timer_interrupt();
    else
        start_unexpected();
}

void start_main(void)
{
    for (volatile uint32_t *word = start_bss; word != start_bss_end; word++) *word = 0;
    __asm__ volatile("csrw mtvec, %0" ::"r"(start_trap));
    __asm__ volatile("csrs mstatus, %0" ::"r"(MSTATUS_MIE));
    end(main());
}

__attribute__((naked, section(".reset"))) void start_reset(void)
{
    __asm__ volatile(".option push\n\t.option norelax\n\tla gp, start_pointer\n\t.option pop\n\t"
                     "la sp, start_stack\n\tj start_main");
}
