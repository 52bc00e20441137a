/* SPDX-License-Identifier: MIT */
/* The functions of a shared library that fake_modbus.c replaces: the next ones of this name behind the program's. */
#define _GNU_SOURCE 1 /* RTLD_NEXT */
#include <dlfcn.h>

#include "fathom/engine/line.h"

#define REAL(type, name, parameters, call)                                                                   \
    type __real_##name parameters;                                                                           \
    type __real_##name parameters                                                                            \
    {                                                                                                        \
        type(*real) parameters;                                                                              \
        *(void **)&real = dlsym(RTLD_NEXT, #name);                                                           \
        call;                                                                                                \
    }

REAL(void, fathom_line_cancel, (fathom_line_t * line, fathom_transaction_t *transaction),
     real(line, transaction))
REAL(void, fathom_line_cancel_unit, (fathom_line_t * line, uint8_t address), real(line, address))
REAL(bool, fathom_line_was_polled, (const fathom_line_t *line, uint32_t since_us),
     return real(line, since_us))
REAL(fathom_status_t, fathom_line_poll, (fathom_line_t * line), return real(line))
REAL(uint32_t, fathom_line_due_us, (const fathom_line_t *line), return real(line))
REAL(bool, fathom_line_is_queued, (const fathom_line_t *line, const fathom_transaction_t *transaction),
     return real(line, transaction))
REAL(fathom_status_t, fathom_line_submit, (fathom_line_t * line, fathom_transaction_t *transaction),
     return real(line, transaction))
