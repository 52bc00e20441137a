/* SPDX-License-Identifier: MIT */
#ifndef A05_H
#define A05_H

#include "models/model.h"

extern const model_t model_a05;

/* ---- its parts ---- */

extern const setting_t a05_settings[];

void a05_decode(decode_frame_t *frame, const uint8_t *request);
void a05_decode_sum(decode_frame_t *frame);

#endif
