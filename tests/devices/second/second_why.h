/* SPDX-License-Identifier: MIT */
/* Inside of the judge: what the log says, and why something did not come to what was wanted. */
#ifndef SECOND_WHY_H
#define SECOND_WHY_H

#include "second_judge.h"

static inline int64_t chose(second_choice_t choice) { return second_choice(&judge.rig->device, choice); }
static inline second_kind_t kind(void) { return judge.rig->device.config.kind; }
static inline bool is_a05(void) { return kind() == SECOND_A05_UART || kind() == SECOND_A05_RS485; }
/* Has the values of an HPS-167S. */
static inline bool is_hps(void) { return kind() == SECOND_HPS167S || kind() == SECOND_HPS167; }

/* What the log says of the time since the command began. */
typedef struct {
    bool exception, silent, echoed, unasked, noise, fault, reset, effect;
    unsigned settings, odd_values;
    uint64_t unasked_us; /* the newest of them */
    const second_event_t *setting;
} facts_t;

facts_t judge_facts(void);

/* Why it did not answer, or not so that it could be understood. */
reason_t judge_why(fathom_status_t status);
/* Does the new value of this register count from the next power-on? */
bool judge_is_later(uint16_t reg);
/* Does a module with PWM serve a trigger that came too early later? */
bool judge_is_queued(void);

/* Something is wrong. */
void judge_finding(const char *what, int status);
void judge_begin_again(void);

#endif
