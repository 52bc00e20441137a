/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TRUTH_H
#define FATHOM_TESTS_TRUTH_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "settings.h"

/*
 * What a simulated sensor has truly said, and when: the scene gives another value at each look, and each one is
 * kept with its time before anything can damage its frame. Nothing here comes from the code under test.
 */

enum { TRUTH_ROOM = 64, TRUTH_PROBES = 4, TRUTH_NOTHING = -1 };

typedef struct {
    uint32_t measured_us;
    int32_t values[TRUTH_PROBES]; /* the 16 bits of each probe; TRUTH_NOTHING: not in this frame */
    bool is_hit;                  /* something may have kept it from arriving as it was */
    bool is_twice; /* it may be read more than once: it comes so, or says what another frame says */
    bool is_read;  /* a sample of it was seen */
} truth_entry_t;

typedef struct {
    truth_entry_t log[TRUTH_ROOM]; /* frame n at n % TRUTH_ROOM */
    uint32_t count;                /* frames so far */
    uint32_t newest_read;          /* of them, n + 1; 0: none */
    int32_t current[TRUTH_PROBES]; /* measured for the frame to come */
    bool any;
    uint32_t looks;   /* at the scene */
    uint16_t held_mm; /* the caller's: what it always sees; 0: another distance at each look */
    uint8_t setting;
    uint8_t index; /* of the unit on its line: two never measure the same */
} truth_t;

typedef enum {
    TRUTH_RIGHT,
    TRUTH_DAMAGED,  /* no unit has said that */
    TRUTH_STALE,    /* it has said that, but earlier */
    TRUTH_PERMUTED, /* another probe has said that */
    TRUTH_FOREIGN,  /* another unit has said that */
    TRUTH_VERDICTS
} truth_verdict_t;

void truth_init(truth_t *truth, uint8_t setting, uint8_t index);

/* The scene. */
int32_t truth_look(truth_t *truth, uint8_t probe);

/* The device is about to say this value (0..65535, or FATHOM_SIM_NO_TARGET and so on). */
void truth_measured(truth_t *truth, uint8_t probe, int32_t value);

/* What it has measured since the last call leaves in one frame; NULL when nothing was. */
truth_entry_t *truth_leaves(truth_t *truth, uint32_t now_us);

/* The frame is made into one that does not speak for this device. */
void truth_forget(truth_entry_t *entry);

/* Frame n; it must be one of the last TRUTH_ROOM. */
truth_entry_t *truth_at(truth_t *truth, uint32_t n);

/*
 * Is the sample what the device has said? since_us: not earlier than this. in_order: frames do not come twice,
 * and never after a newer one (streams). Notes what was read.
 */
truth_verdict_t truth_judge(truth_t *truth, const fathom_sample_t *sample, uint32_t now_us, uint32_t since_us,
                            bool in_order);

/* Has it said this value of any probe lately? */
bool truth_said(const truth_t *truth, uint16_t raw);

#endif
