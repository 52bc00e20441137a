/* SPDX-License-Identifier: MIT */
#include "fathom_posix.h"
#include "fathom_serial.h"
#include "sim/uart.h"

/* The ports are installed with the library: their headers are found and their code links. */
int main(void) { return fathom_posix_wait == NULL || fathom_sim_clock_idle == NULL; }
