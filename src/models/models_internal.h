/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_MODELS_INTERNAL_H
#define FATHOM_MODELS_INTERNAL_H

#include "fathom/models.h"

/* A table of models, and what a row becomes: facts, which a program names one by one, and a description. */

/* Certainty of a row: a maker's or a seller's manual, or two sources that agree (H); one good source (M). */
enum { M = 0, H = 1 };

typedef struct {
    const fathom_model_description_t *rows;
    uint8_t count;
} fathom_model_table_t;

extern const fathom_model_table_t fathom_models_a05;
extern const fathom_model_table_t fathom_models_a16;
extern const fathom_model_table_t fathom_models_hps;
extern const fathom_model_table_t fathom_models_jsn;

/* The parameters of a row, and behind them its facts as designated initialisers. */
#define MODEL_FACTS(id, family, mode, certainty, name, aliases, maker, note, ...)                            \
    const fathom_model_facts_t fathom_model_##id = {__VA_ARGS__};
#define MODEL_DESCRIPTION(id, family, mode, certainty, name, aliases, maker, note, ...)                      \
    {(name),          (aliases),          (maker),         (note), &fathom_model_##id,                       \
     FATHOM_##family, FATHOM_MODE_##mode, (certainty) == H},
#define MODEL_TABLE(descriptions)                                                                            \
    {                                                                                                        \
        (descriptions), (uint8_t)(sizeof(descriptions) / sizeof((descriptions)[0]))                          \
    }

/* Facts that many rows have. */
#define RANGE(min, max)          .min_mm = (min), .max_mm = (max)
#define WINDOW(earliest, latest) .earliest_ms = (earliest), .latest_ms = (latest)
#define FALLING(us)              .start = FATHOM_STARTS_FALLING, .trigger_us = (us)
#define BYTE(value)              .start = FATHOM_STARTS_BYTE, .trigger_byte = (value)
#define HIGH_PULSE(us)           .start = FATHOM_STARTS_HIGH_PULSE, .trigger_us = (us)
#define SLOW                     .line_settings = (&fathom_a16_factory_line)

#endif
