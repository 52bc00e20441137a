/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "suite.h"

int main(int argc, char **argv)
{
    suite_ends_at_failure = getenv("FATHOM_FIRST_FAILURE") != NULL;
    suite_is_long = getenv("FATHOM_LONG") != NULL;
    return suite_run(argc - 1, argv + 1) != 0;
}
