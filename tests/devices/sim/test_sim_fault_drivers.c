/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* Every driver that asks, with each kind of fault.h in three of ten frames, and with all of them at once: no reading is
 * wrong or old, each request ends, and the driver recovers. The scene changes after each outcome, so a reading of an
 * earlier request has another distance. Listening drivers: ../second/test_second_damage.c. */

enum { REQUESTS = 60, OFTEN_PPM = 300000, SELDOM_PPM = 20000, PROBES = 4, MOST_PASSED = 2 };

static const suite_t suite = {BENCH_TWO_ROUNDS};

/* line.h, "What cannot be told apart": responses later than twice the time-out, and unsolicited frames of the same
 * shape. A stuck sensor repeats its old distance. */
static bool may_be_old(uint8_t kind)
{
    return kind == FATHOM_SIM_FAULT_LATE || kind == FATHOM_SIM_FAULT_UNASKED ||
           kind == FATHOM_SIM_FAULT_STUCK;
}

static struct {
    uint32_t readings, wrong;
} seen;

/* One request with a distance that no request before it had. */
static void request_once(void)
{
    static int32_t distance_mm;
    distance_mm = 500 + (distance_mm + 37) % 5000;
    for (int32_t probe = 0; probe != PROBES; probe++) bench.fixed.value[probe] = distance_mm + 7 * probe;
    do {
        if (measure() != FATHOM_OK) return;
        seen.readings++;
        if (s.sample.kind == FATHOM_TARGET)
            seen.wrong += s.sample.distance_mm != bench.fixed.value[s.sample.probe - 1];
    } while (s.model >= A05 && s.model <= A05_DYP && s.sample.probe != PROBES);
}

static void expect_recovery(void)
{
    fathom_sim_fault_enable(&bench.fault, false);
    rest(5 * SECOND);
    assert_true(recovers());
    request_once(); /* the other probes of that reading */
    seen.readings = seen.wrong = 0;
    for (unsigned i = 0; i != 10; i++) request_once();
    assert_int_equal(seen.wrong, 0);
    assert_true(seen.readings >= 10);
}

/* A sum of 8 bits passes one of 256 damaged frames, a CRC one of 65536. */
static void expect_readings(const char *name, bool is_old_allowed)
{
    const uint32_t most = s.model == A05_DYP ? MOST_PASSED : 0;
    seen.readings = seen.wrong = 0;
    for (unsigned i = 0; i != REQUESTS; i++) request_once();
    if (seen.readings == 0 || (seen.wrong > most && !is_old_allowed))
        fail_msg("%s, model %u: %u of %u readings are wrong", name, (unsigned)s.model, (unsigned)seen.wrong,
                 (unsigned)seen.readings);
    expect_recovery();
}

TEST(no_kind_of_fault_makes_a_wrong_or_old_reading_and_each_driver_recovers)
{
    for (model_t model = 0; model != MODELS; model++) {
        for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++) {
            set_up(model, 1, loops_us[kind % LOOPS], FATHOM_LINE_ECHO_AUTO);
            if (!fathom_sim_fault_applies(kind, bench.device)) continue;
            assert_non_null(fathom_sim_fault_add(&bench.fault, kind, OFTEN_PPM, 0));
            expect_readings(fathom_sim_fault_name(kind), may_be_old(kind));
        }
    }
}

TEST(all_kinds_at_once_make_no_wrong_or_old_reading_and_each_driver_recovers)
{
    for (model_t model = 0; model != MODELS; model++) {
        set_up(model, 1, loops_us[model % LOOPS], FATHOM_LINE_ECHO_AUTO);
        for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++)
            if (!may_be_old(kind)) (void)fathom_sim_fault_add(&bench.fault, kind, SELDOM_PPM, 0);
        expect_readings("all kinds", false);
    }
}
