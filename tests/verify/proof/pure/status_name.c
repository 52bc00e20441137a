/* SPDX-License-Identifier: MIT */
/*
 * "?" for any other number: all that an int8_t can be, and the ends of int. A name lies in the program's constants, and
 * so does the advice. factory_line.c has constants alone.
 *
 * proves: src/status_name.c src/status_advice.c src/sensor/factory_line.c
 * options: -eva-auto-loop-unroll 256 -eva-slevel-function fathom_status_name:400
 */
#include "assumptions.h"
#include "fathom/status.h"

static void name(int status)
{
    const char *const text = fathom_status_name((fathom_status_t)status);
    const char first = *text;
    /*@ assert first != 0; */
    const char *const advice = fathom_status_advice((fathom_status_t)status);
    const char begin = *advice;
    /*@ assert begin != 0; */
}

int main(void)
{
    for (int status = INT8_MIN; status <= INT8_MAX; status++) name(status);
    name(Frama_C_interval(INT_MIN, INT8_MIN));
    name(Frama_C_interval(INT8_MAX, INT_MAX));
    return 0;
}
