/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "fathom_loop.h"
#include "fathom_posix.h"

/* The port is there with its two headers: it says that this is no serial port. */
int main(void)
{
    static fathom_posix_uart_t port;
    const fathom_line_settings_t settings = {9600, FATHOM_PARITY_NONE, 1};
    if (fathom_posix_open(&port, "/dev/null", &settings) != FATHOM_POSIX_ERR_NOT_A_TTY) return 1;
    printf("%.*s\n", (int)strcspn(fathom_posix_error_text(&port), ";"), fathom_posix_error_text(&port));
    return fathom_loop_init == NULL;
}
