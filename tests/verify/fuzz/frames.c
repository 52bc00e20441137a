/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "../../unit/vectors.h"

/* Prints the frames of the datasheets, a line each: "KIND HEX", for seeds.py. KIND: stream, dyp, request, response. */

static void put(const char *kind, const vector_t *vector) { (void)printf("%s %s\n", kind, vector->hex); }

static void put_modbus(const vector_t *vector)
{
    if ((vector->direction & VECTOR_REQUEST) != 0) put("request", vector);
    if ((vector->direction & VECTOR_RESPONSE) != 0) put("response", vector);
}

int main(void)
{
    for (int i = 0; i != AUTO_ROWS; i++) put("stream", &auto_vectors[i].frame);
    for (int i = 0; i != DYP_ROWS; i++) put("dyp", &dyp_vectors[i].frame);
    for (int i = 0; i != MODBUS_ROWS; i++) put_modbus(&modbus_vectors[i].frame);
    return 0;
}
