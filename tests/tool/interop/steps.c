/* SPDX-License-Identifier: MIT */
#include "steps.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Moves *text behind the number and what ends it. */
static bool number(const char **text, char end, uint16_t *value)
{
    char *behind = NULL;
    const unsigned long read = strtoul(*text, &behind, 0);
    if (behind == *text || read > UINT16_MAX || *behind != end) return false;
    *value = (uint16_t)read;
    *text = end == '\0' ? behind : behind + 1;
    return true;
}

static bool list(const char *text, step_t *step)
{
    for (step->count = 0; step->count != STEP_VALUES;) {
        uint16_t *const value = &step->values[step->count++];
        if (number(&text, '\0', value)) return true;
        if (!number(&text, ',', value)) return false;
    }
    return false;
}

static bool rest(const char *text, step_t *step)
{
    switch (step->kind) {
    case STEP_UNIT:
        return number(&text, '\0', &step->first);
    case STEP_RAW:
        return list(text, step);
    case STEP_MANY:
        return number(&text, ':', &step->first) && list(text, step);
    case STEP_WRITE:
        return number(&text, ':', &step->first) && number(&text, '\0', step->values);
    default:
        return number(&text, ':', &step->first) && number(&text, '\0', &step->count) &&
               step->count <= STEP_VALUES;
    }
}

bool step_parse(step_t *step, const char *text)
{
    static const struct {
        const char *name;
        step_kind_t kind;
    } kinds[] = {{"read:", STEP_READ}, {"input:", STEP_INPUT}, {"coils:", STEP_COILS}, {"write:", STEP_WRITE},
                 {"many:", STEP_MANY}, {"raw:", STEP_RAW},     {"unit:", STEP_UNIT}};
    for (size_t i = 0; i != sizeof kinds / sizeof kinds[0]; i++) {
        const size_t length = strlen(kinds[i].name);
        if (strncmp(text, kinds[i].name, length) != 0) continue;
        step->kind = kinds[i].kind;
        if (rest(text + length, step)) return true;
    }
    (void)fprintf(stderr, "no step: %s\n", text);
    return false;
}

void step_print(const uint16_t *values, uint16_t count, int digits)
{
    for (uint16_t i = 0; i != count; i++) (void)printf(i == 0 ? "%0*X" : " %0*X", digits, values[i]);
    (void)puts("");
}
