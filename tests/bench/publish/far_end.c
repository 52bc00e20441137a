/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include "../lines/lines.h"

/* bench_far_end COUNT: the far ends of so many lines, for publish.py; prints their ports, and ends when the standard input
 * does. */
int main(int argc, char **argv)
{
    static char paths[LINES_MOST][LINES_PATH];
    const long count = argc == 2 ? strtol(argv[1], NULL, 10) : 0;
    if (count < 1 || count > LINES_MOST) {
        (void)fputs("usage: bench_far_end COUNT\n", stderr);
        return 2;
    }
    if (!lines_begin_far_end((unsigned)count, paths)) return EXIT_FAILURE;
    for (long i = 0; i != count; i++) (void)puts(paths[i]);
    (void)fflush(stdout);
    while (getchar() != EOF) continue;
    return EXIT_SUCCESS;
}
