/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "suite.h"

int main(int argc, char **argv)
{
    suite_ends_at_failure = getenv("FATHOM_FIRST_FAILURE") != NULL;
    suite_is_long = getenv("FATHOM_LONG") != NULL;
    const int failed = suite_run(argc - 1, argv + 1);
    return failed == SUITE_HAS_NO_SUCH_TEST ? 2 : failed != 0;
}
