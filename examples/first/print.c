/* SPDX-License-Identifier: MIT */
/* board_print() by printf(), for machines that have the memory for sentences. */
#include <stdio.h>

#include "board.h"
#include "fathom/status.h"

void board_print(fathom_status_t status, const fathom_sample_t *sample)
{
    static const char *const words[] = {
        [FATHOM_NO_TARGET] = "nothing in range",
        [FATHOM_FAULT] = "fault",
        [FATHOM_NEAR] = "near",
        [FATHOM_FAR] = "far",
        [FATHOM_UNKNOWN] = "unknown",
    };
    if (status != FATHOM_OK)
        (void)printf("no reading (%s). %s\n", fathom_status_name(status), fathom_status_advice(status));
    else if (sample->kind == FATHOM_TARGET)
        (void)printf("probe %u: %u mm\n", sample->probe, sample->distance_mm);
    else
        (void)printf("probe %u: %s\n", sample->probe, words[sample->kind]);
    (void)fflush(stdout);
}
