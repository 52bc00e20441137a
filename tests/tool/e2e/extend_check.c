/* SPDX-License-Identifier: MIT */
/* For test_clock.py, built with the tool's timestamp.c: what the tool makes of the library's 32-bit times. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "output/timestamp.h"

/* extend_check NOW THEN ...: a line each */
int main(int argc, char **argv)
{
    for (int i = 1; i + 1 < argc; i += 2)
        (void)printf("%" PRIu64 "\n",
                     time_extend(strtoull(argv[i], NULL, 0), (uint32_t)strtoull(argv[i + 1], NULL, 0)));
    return 0;
}
