/* SPDX-License-Identifier: MIT */
#include "task.h"

#include <stddef.h>

static task_t *current; /* the one that runs; of those that were started, the last */
static fathom_rp2040_idle_t *sleeper;

/* void task_switch(uint32_t **from, uint32_t *to): what a function has to keep goes to the stack, the stack to *from,
 * and all comes back from the other stack: the return is to where that task called it. Ten words, so that a stack stays
 * aligned to 8 (AAPCS 6.2.1.2); an interrupt may come anywhere in between. */
void task_switch(uint32_t **from, uint32_t *to);
__asm__(".syntax unified\n"
        ".text\n"
        ".thumb_func\n"
        ".global task_switch\n"
        ".type task_switch, %function\n"
        "task_switch:\n"
        "    push {r3-r7, lr}\n"
        "    mov r4, r8\n"
        "    mov r5, r9\n"
        "    mov r6, r10\n"
        "    mov r7, r11\n"
        "    push {r4-r7}\n"
        "    mov r2, sp\n"
        "    str r2, [r0]\n"
        "    mov sp, r1\n"
        "    pop {r4-r7}\n"
        "    mov r8, r4\n"
        "    mov r9, r5\n"
        "    mov r10, r6\n"
        "    mov r11, r7\n"
        "    pop {r3-r7, pc}\n"
        ".size task_switch, . - task_switch\n");

enum { SWITCH_WORDS = 10, UNUSED = 0x5AFE5AFE };

void task_start(task_t *task, void (*run)(void))
{
    uint32_t *const end = &task->words[TASK_STACK_WORDS];
    uint32_t *const top = (uintptr_t)end % 8 == 0 ? end : end - 1;
    for (uint32_t *word = task->words; word != top; word++) *word = UNUSED; /* shows how deep it got */
    task->stack = top - SWITCH_WORDS;
    top[-1] = (uint32_t)(uintptr_t)run; /* the pc of the first switch */
    task->semaphore = NULL;
    task->since_us = 0;
    task->max_us = 0;
    if (current == NULL) {
        task->next = task;
    } else {
        task->next = current->next;
        current->next = task;
    }
    current = task;
}

static uint32_t now_us(void) { return fathom_rp2040_clock.now_us(fathom_rp2040_clock.ctx); }

/* How long it will go on waiting; 0: it can run. */
static uint32_t waits_us(const task_t *task)
{
    if (task->semaphore != NULL && task->semaphore->given) return 0;
    if (task->max_us == FATHOM_NO_DEADLINE) return FATHOM_NO_DEADLINE;
    const uint32_t passed_us = fathom_elapsed_us(now_us(), task->since_us);
    return task->max_us > passed_us ? task->max_us - passed_us : 0;
}

/* The next one after the present task that can run; the core sleeps until there is one. */
static task_t *choose(void)
{
    for (;;) {
        uint32_t least_us = FATHOM_NO_DEADLINE;
        task_t *task = current;
        do {
            task = task->next;
            const uint32_t us = waits_us(task);
            if (us == 0) return task;
            if (us < least_us) least_us = us;
        } while (task != current);
        fathom_rp2040_idle(sleeper, least_us); /* at once, if something was given meanwhile */
    }
}

void task_run(fathom_rp2040_idle_t *idle)
{
    uint32_t *start_up; /* never switched back to */
    sleeper = idle;
    current = choose();
    task_switch(&start_up, current->stack);
}

void task_take(void *semaphore, uint32_t max_us)
{
    task_semaphore_t *const wanted = semaphore;
    task_t *const self = current;
    self->semaphore = wanted;
    self->since_us = now_us();
    self->max_us = max_us;
    current = choose();
    if (current != self) task_switch(&self->stack, current->stack);
    if (wanted != NULL) wanted->given = false;
}

void task_give(task_semaphore_t *semaphore)
{
    semaphore->given = true;
    if (sleeper != NULL) sleeper->has_news = true; /* interrupts come before task_run, too */
}
