/* SPDX-License-Identifier: MIT */
#ifndef RP2040_TASK_H
#define RP2040_TASK_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/hal.h"
#include "fathom_rp2040.h"

/*
 * The least of an RTOS: tasks with stacks of their own that take turns where they wait, and semaphores that interrupts
 * give. It is here to show where an RTOS's own calls go: task_start, task_take, task_give. A task keeps the core until
 * it waits, so what they share needs no lock.
 */

/* What an interrupt tells a task. Zeroed: nothing has been told. */
typedef struct {
    volatile bool given;
} task_semaphore_t;

/* Since tasks and interrupts share the stack, it has room for both. */
enum { TASK_STACK_WORDS = 320 };

typedef struct task task_t;
struct task {
    uint32_t *stack; /* where it stands while it waits */
    task_t *next;    /* in a ring */
    task_semaphore_t *semaphore;
    uint32_t since_us;
    uint32_t max_us; /* FATHOM_NO_DEADLINE: it waits for the semaphore alone */
    uint32_t words[TASK_STACK_WORDS + 1];
};

/* Adds a task, which begins with task_run. `run` does not return. The memory is the task's from now on. */
void task_start(task_t *task, void (*run)(void));

/* Runs the tasks that were started, one at least, and never returns. idle: how the core sleeps when all of them wait;
 * begun by the caller. */
void task_run(fathom_rp2040_idle_t *idle);

/* Waits until the semaphore is given, and takes it, or until max_us have passed. It has the form of fathom_wait's idle
 * hook: semaphore is a task_semaphore_t. For the tasks alone. */
void task_take(void *semaphore, uint32_t max_us);

/* For interrupts and tasks. */
void task_give(task_semaphore_t *semaphore);

#endif
