/* SPDX-License-Identifier: MIT */
#ifndef SCAN_IDENTIFY_H
#define SCAN_IDENTIFY_H

#include "commands/scan/scan_ask.h"
#include "sensors/finding.h"

/*
 * The first request to an address: model_t.scan.first of the model that is most likely there.
 *
 * At the rates of an HPS-167S and its addresses 1..32: #1, the interface version (03 @0x0001 x3), which it answers in
 * a few milliseconds. Elsewhere the address register of A16 and A05 (03 @0x0200 x1), which takes no measurement.
 * A device of another kind responses either with a value, an exception or silence.
 */
void scan_first_request(const fathom_line_settings_t *line, uint8_t address, scan_request_t *request);

/*
 * Who is it that has answered the first request? Asks for what only one model has:
 *
 *   HPS-167S  #1 has a date, #3 begins with the acknowledge byte B0, #2 has two switches and is the same before and
 *             after a measurement
 *   A05       0x0200 is its address, 0x0106 (probe 1) is answered, 0x0101 is not
 *   A16       0x0200 is its address, 0x0101 or 0x0100 (distance) is answered, 0x0106 is not
 *
 * A device that answers all of these, or none, is another Modbus device. timeout_us: of the first request; the others
 * wait at least 300 ms, since an ultrasonic one has to measure.
 *
 * FATHOM_OK: *finding is set. FATHOM_ERR_CANCELLED, FATHOM_ERR_PORT: it could not be asked to the end.
 */
fathom_status_t scan_identify(const scan_wire_t *wire, const scan_request_t *request,
                              const scan_response_t *first, scan_finding_t *finding);

#endif
