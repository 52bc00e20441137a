/* SPDX-License-Identifier: MIT */
/* Readings. */
#include "second_damage.h"
#include "second_why.h"

bool judge_was_sent(uint16_t value)
{
    for (uint64_t i = judge.log_begin; i < second_log_count(&judge.rig->device); i++) {
        const second_event_t *e = second_log_at(&judge.rig->device, i);
        for (size_t p = 0; e != NULL && e->kind == SECOND_EVENT_MEASUREMENT && p < SECOND_PROBES; p++) {
            if ((e->probes >> p & 1U) != 0 && e->sent[p] == value) return true;
        }
    }
    return false;
}

/* Returns the frame that arrived at the time of the sample with its value. A damaged frame counts only if the checksum
 * does not show the damage. */
static const second_event_t *source(const fathom_sample_t *sample, frame_state_t *state)
{
    const rig_t *rig = judge.rig;
    uint32_t slack_us = rig->has_stamps ? 2 : rig->loop == RIG_EVERY_1_MS ? 3000 : 45000;
    for (uint64_t i = second_log_count(&rig->device); i-- > 0;) {
        const second_event_t *e = second_log_at(&rig->device, i);
        if (e == NULL || e->time_us + 20000000 < rig->now_us) return NULL;
        if (e->kind != SECOND_EVENT_MEASUREMENT || (e->probes >> (sample->probe - 1) & 1U) == 0) continue;
        uint32_t later_us = fathom_elapsed_us(sample->time_us + 2, rig_clock_us(rig, e->end_us));
        if (later_us > slack_us + 2) continue;
        uint8_t bytes[SECOND_FRAME_MAX];
        *state = rig->damage == RIG_UNHARMED && rig->zeros_until_us == 0 ? FRAME_CLEAN : damage_of(e, bytes);
        if (*state == FRAME_UNSEEN && damage_value(bytes, sample->probe) == sample->raw) return e;
        if (*state == FRAME_CLEAN && e->sent[sample->probe - 1] == sample->raw) return e;
    }
    return NULL;
}

static const char *wrong_ultrasonic(const fathom_sample_t *s, const second_event_t *e)
{
    size_t p = s->probe - 1U;
    int32_t mm = e->true_mm[p];
    if ((e->fitted >> p & 1U) == 0) return "a probe that is not fitted";
    switch ((int)s->kind) {
    case FATHOM_TARGET:
        if (s->distance_mm != s->raw) return "another distance than was sent";
        if (mm == s->distance_mm) return NULL;
        /* the value for nothing may look like a distance */
        return mm != SECOND_NOTHING && !e->not_ready ? "another distance than is true" : NULL;
    case FATHOM_NO_TARGET:
        if (s->raw != 0xFFFD && s->raw != 0xFFFE) return "no target, and the device does not say so";
        return mm == SECOND_NOTHING || e->not_ready ? NULL : "no target, and there is one";
    case FATHOM_UNKNOWN:
        return s->raw == 0 ? NULL : "unknown, and it is not";
    default:
        return "no such kind";
    }
}

static const char *wrong_hps(const fathom_sample_t *s, const second_event_t *e)
{
    int64_t off = chose(CHOICE_hps_deviation_mm) + judge.rig->device.hps.used.offset;
    switch ((int)s->kind) {
    case FATHOM_TARGET:
        if (s->distance_mm != s->raw) return "another distance than was sent";
        if (e->fault || e->no_target) return "a distance, and there is none";
        if (e->true_mm[0] + off == s->distance_mm) return NULL;
        return e->true_mm[0] < 80 && s->distance_mm == 80 ? NULL : "another distance than is true";
    case FATHOM_NO_TARGET:
        if (!e->no_target && e->true_mm[0] + off >= 0) return "no target, and there is one";
        return e->fault ? "no target, and it has failed" : NULL;
    case FATHOM_FAULT: /* the abnormal packet, or its very bytes */
        for (size_t i = 0; i < 8; i++) {
            uint8_t expected = i == 2 || i == 3 ? 0x00 : 0xFF;
            if (i != 4 && e->raw[(kind() == SECOND_HPS167 ? 5 : 3) + i] != expected)
                return "'failed', and the device does not say so";
        }
        return NULL;
    case FATHOM_UNKNOWN:
        return s->raw >= 1 && s->raw < 80 ? NULL : "unknown, and it is not";
    default:
        return "no such kind";
    }
}

/* A level says what the device's own level is; a pulse was as wide, and what it means is so within 0.1 %, by which the
 * datasheet's two formulas differ. */
static const char *wrong_level(const fathom_sample_t *s)
{
    const second_device_t *d = &judge.rig->device;
    if (kind() != SECOND_A16_PWM)
        return s->kind == (second_output(d) ? FATHOM_NEAR : FATHOM_FAR) ? NULL
                                                                        : "another level than is there";
    for (uint64_t i = second_log_count(d); i-- > 0;) {
        const second_event_t *e = second_log_at(d, i);
        if (e == NULL || e->time_us + 1000000 < judge.rig->now_us) break;
        if (e->kind != SECOND_EVENT_MEASUREMENT || rig_clock_us(judge.rig, e->end_us) != s->time_us) continue;
        int32_t off_mm = (int32_t)s->distance_mm - e->true_mm[0];
        if (e->new_value != s->raw) return "another width than it was";
        if (e->no_target) return s->kind == FATHOM_NO_TARGET ? NULL : "nothing is there";
        if (s->kind != FATHOM_TARGET) return "a target is there";
        return off_mm * 1000 <= e->true_mm[0] + 1000 && off_mm * 1000 >= -e->true_mm[0] - 1000
                   ? NULL
                   : "another distance";
    }
    bool is_early = judge.rig->now_us < d->power_on_us + 3500000; /* it measures once by itself */
    if (s->kind == FATHOM_FAULT && s->raw == 0 && second_output(d) && (judge_is_queued() || is_early))
        return NULL;
    return "a pulse that was not sent";
}

void judge_sample(const fathom_sample_t *sample)
{
    if (kind() >= SECOND_TALKERS) {
        const char *wrong = wrong_level(sample);
        if (wrong != NULL) judge_finding(wrong, (int)sample->raw);
        return;
    }
    frame_state_t state;
    const second_event_t *e = source(sample, &state);
    if (e == NULL) {
        judge_finding("a reading that was not sent", (int)sample->raw);
        return;
    }
    if (state == FRAME_UNSEEN) {
        damage_heard.unseen_readings++;
        return;
    }
    const char *wrong = is_hps() ? wrong_hps(sample, e) : wrong_ultrasonic(sample, e);
    if (wrong != NULL) judge_finding(wrong, (int)sample->raw);
}

void judge_measured(fathom_status_t status, const fathom_sample_t *sample)
{
    if (status == FATHOM_OK) judge_sample(sample);
    judge_read(status, true);
}

unsigned judge_poll(const char *name, const fathom_sensor_t *sensor, unsigned outcomes, uint64_t for_us)
{
    unsigned readings = 0;
    uint64_t end_us = judge.rig->now_us + for_us;
    judge_begin(name);
    while (outcomes > 0 && judge.rig->now_us < end_us) {
        fathom_sample_t sample;
        fathom_status_t status = fathom_poll(sensor, &sample);
        if (status == FATHOM_PENDING) {
            rig_pass(judge.rig, fathom_due_us(sensor, 1));
            continue;
        }
        outcomes--;
        if (status == FATHOM_OK) {
            judge_sample(&sample);
            readings++;
        }
        judge_read(status, true);
        judge_begin_again();
    }
    return readings;
}
