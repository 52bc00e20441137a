/* SPDX-License-Identifier: MIT */
#ifndef DYP_H
#define DYP_H

#include "sensors/driver.h"

/* What the A16 and the A05 share: DYP makes both. */

/* The factory line settings, which cannot be changed. */
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

#define DYP_EFFECT "at once; whether it is kept over power-off is not in the datasheet"

/* Members get and set of a setting that is one register. The address 0 is a value of the address. */
fathom_status_t dyp_get(reader_t *reader, const setting_t *setting, char text[SETTING_TEXT]);
fathom_status_t dyp_set(reader_t *reader, const setting_t *setting, int32_t value);

/* Prints a distance if the status is FATHOM_OK. */
void dyp_print_distance(char text[SETTING_TEXT], fathom_status_t status, const fathom_sample_t *sample);

/* ---- scan ---- */

/* The distance that it has answered with. */
void dyp_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

/* ---- decoding ---- */

/* Members decode and decode_sum of a model: its registers are the rows of its settings. */
void dyp_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request);
void dyp_decode_sum(decode_frame_t *frame, const model_t *model);

#endif
