/* SPDX-License-Identifier: MIT */
/*
 * Holds what a driver says against what the device logged: no wrong reading, no false statement, and a reason that a
 * reader of the datasheet accepts for all that is not made. What each device is asked is in second_lives.h.
 */
#ifndef SECOND_JUDGE_H
#define SECOND_JUDGE_H

#include "second_rig.h"

#include "second_device.h"

#define FATHOM_UNKNOWN 6

/* Why a command, or a measurement, did not come to what was wanted. */
typedef enum {
    BECAUSE_EXCEPTION,
    BECAUSE_SILENT,
    BECAUSE_WARM_UP,
    BECAUSE_STARTING,
    BECAUSE_SWITCHED,
    BECAUSE_LATER,
    BECAUSE_ECHOED,
    BECAUSE_OTHER_VALUE,
    BECAUSE_OLD_TOLD,
    BECAUSE_HIT,
    BECAUSE_NO_DISTANCE,
    BECAUSE_RARE,
    BECAUSE_FAILED,
    BECAUSE_STRENGTH,
    BECAUSE_FEWER,
    BECAUSE_FULL,
    BECAUSE_QUEUED,
    BECAUSE_MISPRINT,
    BECAUSE_NOTHING /* none of these: the driver is wrong */
} reason_t;

typedef struct {
    rig_t *rig;
    const char *name;
    uint64_t log_begin; /* of the command */
    uint64_t begin_us;
    uint32_t writes_begin;
    unsigned runs, good, wrong;
} judge_t;

extern judge_t judge;

void judge_begin(const char *name);
/* A command that changes nothing: is_right, where it says FATHOM_OK. */
void judge_read(fathom_status_t status, bool is_right);

/* A reading, and a command that gives one. */
void judge_sample(const fathom_sample_t *sample);
void judge_measured(fathom_status_t status, const fathom_sample_t *sample);

/* What a setting is to come to: it holds; or it is acknowledged, which is all that can be known; or it is sent, which
 * is FATHOM_ERR_UNCONFIRMED. */
typedef struct {
    uint16_t reg;
    int64_t value;
    bool acknowledged, blind;
} wanted_t;
#define HOLDS(reg, value)        ((wanted_t){(reg), (value), false, false})
#define ACKNOWLEDGED(reg, value) ((wanted_t){(reg), (value), true, false})
#define SENT(reg, value)         ((wanted_t){(reg), (value), false, true})
void judge_set(fathom_status_t status, bool is_written, wanted_t wanted);

/* The same of a program that tells it in words. */
typedef struct {
    bool made, not_written, not_confirmed, otherwise, refused;
} report_t;
void judge_report(report_t report, wanted_t wanted);
/* ... and of one that tells whether all went well, and what it was told. */
void judge_done(bool is_good, bool is_right);
/* Was this sent as a measured value since the command began? */
bool judge_was_sent(uint16_t value);

/* The value that the device has for a register. */
int64_t judge_held(uint16_t reg);
/* ... and the one that it tells (HPS-167S #2). */
int64_t judge_told_value(uint16_t reg);

/* Polls a sensor until it has said so many things, or so long; judges each. Returns how many readings there were. */
unsigned judge_poll(const char *name, const fathom_sensor_t *sensor, unsigned outcomes, uint64_t for_us);

/* Calls it until it is not pending. */
#define JUDGE_RUN(status, sensor, call)                                                                      \
    do {                                                                                                     \
        uint64_t end_us = judge.rig->now_us + 120000000;                                                     \
        while (((status) = (call)) == FATHOM_PENDING && judge.rig->now_us < end_us)                          \
            rig_pass(judge.rig, fathom_due_us(&(sensor), 1));                                                \
    } while (0)

#define JUDGE_READ(name, sensor, call, is_right)                                                             \
    do {                                                                                                     \
        fathom_status_t read_status;                                                                         \
        judge_begin(name);                                                                                   \
        JUDGE_RUN(read_status, sensor, call);                                                                \
        judge_read(read_status, is_right);                                                                   \
    } while (0)
#define JUDGE_SET(name, sensor, call, is_written, wanted)                                                    \
    do {                                                                                                     \
        fathom_status_t set_status;                                                                          \
        judge_begin(name);                                                                                   \
        JUDGE_RUN(set_status, sensor, call);                                                                 \
        judge_set(set_status, is_written, wanted);                                                           \
    } while (0)

/* Asserts that nothing was wrong, and that so many in a hundred came to what was wanted. */
void judge_end(unsigned good_of_100);

#endif
