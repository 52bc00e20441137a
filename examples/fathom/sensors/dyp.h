/* SPDX-License-Identifier: MIT */
#ifndef DYP_H
#define DYP_H

#include "sensors/driver.h"

/* What the A16 and the A05 have in common: DYP makes both. */

/* The line settings from the factory, which cannot be changed. */
#define DYP_LINE                                                                                             \
    {                                                                                                        \
        9600, FATHOM_PARITY_NONE, 1                                                                          \
    }

/* A16 6(3), A05 3(3). 0x00 is an address, 0xFF is for all units. */
enum { DYP_ADDRESS = 0x0200, DYP_MAX_ADDRESS = 0xFE };

/* ---- reading ---- */

enum { DYP_TAKES = READER_TAKES_MEANINGS | READER_TAKES_WINDOW };

/* The last step of model_mode_t.read, after the driver is initialised. Returns true. */
bool dyp_open_stream(reader_t *reader, fathom_dyp_auto_t *base, fathom_sensor_t sensor);
bool dyp_open_asked(reader_t *reader, fathom_dyp_modbus_t *base, fathom_sensor_t sensor);

/* ---- settings ---- */

#define DYP_KEPT_UNSAID "at once; whether it is kept over power-off is not in the datasheet"

/* Into `text` if the status is OK, else nothing is done. */
void dyp_put_number(char text[SETTING_TEXT], fathom_status_t status, uint32_t number);
void dyp_put_distance(char text[SETTING_TEXT], fathom_status_t status, const fathom_sample_t *sample);

/* ---- scan ---- */

/* The distance that it has answered with. */
void dyp_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

/* ---- decoding ---- */

/* Has the frame the values of registers in it, not where they are? */
bool dyp_is_read_response(const decode_frame_t *frame);

/* Is it a distance that a sensor of that range sends, or one of its family's words for no target? */
bool dyp_is_likely(uint16_t value, uint16_t far_mm);

/* A distance, and the address, as fields. */
void dyp_decode_distance(decode_meaning_t *meaning, const char *name, uint16_t value);
void dyp_decode_address(decode_meaning_t *meaning, uint16_t value);

#endif
