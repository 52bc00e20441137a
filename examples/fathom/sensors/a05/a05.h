/* SPDX-License-Identifier: MIT */
#ifndef A05_H
#define A05_H

#include "sensors/driver.h"

extern const model_t model_a05;

/* ---- its parts ---- */

extern const setting_t a05_settings[];

/* The reader of mode auto: reads these values from the next power-on on, which it waits for. False, with a refusal:
 * the port cannot do that. */
bool a05_select(reader_t *reader, channel_t *channel, uint8_t value);

void a05_decode(decode_frame_t *frame, const uint8_t *request);
void a05_decode_sum(decode_frame_t *frame);

#endif
