/* SPDX-License-Identifier: MIT */
/*
 * The conformance kit on this port, TX and RX joined: a line for each item, and the number of those that are not kept
 * as the exit status.
 *
 *   qemu-system-arm -M microbit -kernel conformance.elf -display none -monitor none \
 *       -semihosting-config enable=on,target=native -chardev serial,id=a,path=/dev/pts/3 -serial chardev:a
 */
#include "fathom_conformance.h"
#include "nrf51.h"
#include "semihosting.h"
#include "tell.h"

static void report(void *ctx, const fathom_finding_t *finding)
{
    char digits[TELL_DIGITS];
    (void)ctx;
    semihosting_write(finding->name);
    semihosting_write(": ");
    semihosting_write(fathom_verdict_name(finding->verdict));
    semihosting_write(", ");
    semihosting_write(tell_digits(digits, finding->figure));
    semihosting_write(" ");
    semihosting_write(finding->of);
    semihosting_write("\n");
}

int main(void)
{
    static const fathom_conformance_t bench = {
        .uart = &nrf51_uart,
        .clock = &nrf51_clock,
        .line = {19200, FATHOM_PARITY_EVEN, 1},
        .other = {57600, FATHOM_PARITY_NONE, 1},
        .longest = NRF51_LONGEST,
        .marks = FATHOM_RX_PARITY | FATHOM_RX_FRAMING | FATHOM_RX_OVERRUN,
        /* QEMU's far end is a program of an operating system; on a board: 0. */
        .late_us = 100000,
        .report = report,
    };
    nrf51_clock_begin();
    if (!nrf51_uart_begin(24, 25, &bench.line)) return 99;
    return (int)fathom_conformance_run(&bench);
}
