/* SPDX-License-Identifier: MIT */
/*
 * What the 16 bits of A16 and A05 mean: any facts with meanings that there are, any values of the probes that have come.
 *
 * proves: src/sensor/dyp.c
 */
#include "fathom/sensor/internal/dyp.h"
#include "assumptions.h"
#include "fathom/codec/dyp_stream.h"

/* Values of the probes from `first` to `last`. */
static void probes(uint8_t first, uint8_t last)
{
    static fathom_dyp_measurement_t measurement;
    static uint16_t values[FATHOM_DYP_PROBES];
    static fathom_model_facts_t facts;
    fathom_sample_t sample;
    facts.min_mm = any_16();
    facts.max_mm = any_16();
    facts.value_fffb = any_8();
    facts.value_fffd = any_8();
    facts.value_fffe = any_8();
    facts.value_ffff = any_8();
    facts.value_0 = any_8();
    measurement = (fathom_dyp_measurement_t){0};
    measurement.facts = &facts;
    any_memory(values, sizeof values);
    measurement.model = any_8();
    measurement.address = any_8();
    measurement.first = first;
    measurement.values = values + FATHOM_DYP_PROBES - (last - first + 1);
    if (!fathom_dyp_are_valid(&facts)) return;
    while (any_bool()) {
        if (any_bool()) {
            const unsigned all = (1u << last) - (1u << (first - 1u));
            fathom_dyp_measurement_set(&measurement, (uint8_t)(all & any_8()), any_32());
        }
        (void)fathom_dyp_measurement_next(&measurement, &sample);
    }
}

int main(void)
{
    probes(1, 1);
    probes(1, FATHOM_DYP_PROBES);
    for (uint8_t probe = 2; probe <= FATHOM_DYP_PROBES; probe++) probes(probe, probe);
    return 0;
}
