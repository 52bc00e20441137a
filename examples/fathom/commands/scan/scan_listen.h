/* SPDX-License-Identifier: MIT */
#ifndef SCAN_LISTEN_H
#define SCAN_LISTEN_H

#include "commands/scan/scan_ask.h"
#include "sensors/finding.h"

/* Who was heard without being asked. */
typedef struct {
    bool is_heard;
    scan_finding_t finding; /* with is_heard: a sensor that sends by itself, SCAN_SENDER or SCAN_MASTER */
} scan_unasked_t;

/*
 * Listens, and sends nothing: even a read would end the automatic output of an A16 RS232 or an A05 UART.
 *
 * First at 9600 8N1 for listen_us, which is where these two send. What is heard there and not understood may come at
 * another rate, so that each that an HPS-167S can have is listened to as well, for a second. Fewer bytes than two
 * frames of an A16 have are taken for noise.
 *
 * FATHOM_OK: *unasked is set. FATHOM_ERR_CANCELLED, FATHOM_ERR_PORT.
 */
fathom_status_t scan_listen(const scan_wire_t *wire, uint32_t listen_us, scan_unasked_t *unasked);

#endif
