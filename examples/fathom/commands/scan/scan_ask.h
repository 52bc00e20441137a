/* SPDX-License-Identifier: MIT */
#ifndef SCAN_ASK_H
#define SCAN_ASK_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/engine/line.h"
#include "ports/listener.h"

/* A line with an listener on it, and a way to wait: what a scan needs of the world. */
typedef struct {
    fathom_line_t *line;
    listener_t *listener;
    const fathom_clock_t *clock;
    /* Sleeps until bytes come, but no longer than max_us. False: the scan is to end. */
    bool (*wait)(void *ctx, uint32_t max_us);
    void *ctx;
} scan_wire_t;

enum { SCAN_REGISTERS = 11 }; /* of the longest response: HPS-167S #3 */

/* A read: the only thing that a scan can ask. */
typedef struct {
    const fathom_line_settings_t *line;
    uint32_t timeout_us;
    uint32_t linger_us; /* after a response it goes on listening for so long: a second one may come */
    uint16_t first;     /* register */
    uint8_t count;
    uint8_t address;
    bool is_dyp; /* by 55 AA; first and count as dyp_client.h has them */
} scan_request_t;

typedef struct {
    /* As fathom_transaction_t.status. FATHOM_ERR_CANCELLED: the scan is to end. FATHOM_ERR_ARGUMENT: a request that may
     * not be asked. */
    fathom_status_t status;
    uint8_t address; /* of FATHOM_OK: who answered */
    uint16_t values[SCAN_REGISTERS];
    evidence_t evidence; /* what was heard since the request */
} scan_response_t;

/*
 * Asks, and comes back with the response.
 *
 * Nothing that changes a device is ever sent: there is no write among the requests, register 0x0009, the factory
 * reset of an HPS-167S (#6), is refused here whatever the count is, and so is unit 0, the broadcast.
 */
void scan_ask(const scan_wire_t *wire, const scan_request_t *request, scan_response_t *response);

/* A device has answered, whatever it was. */
bool scan_is_answered(fathom_status_t status);

/* Sets the line, asks nothing, and listens for so long; what came is in wire->listener and with the line's listener.
 * `each`, unless NULL, is called after every poll. FATHOM_OK; FATHOM_ERR_CANCELLED, _PORT, _UNSUPPORTED. */
fathom_status_t scan_hear(const scan_wire_t *wire, const fathom_line_settings_t *line, uint32_t us,
                          void (*each)(void *ctx), void *ctx);

#endif
