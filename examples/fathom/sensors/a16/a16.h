/* SPDX-License-Identifier: MIT */
#ifndef A16_H
#define A16_H

#include "sensors/driver.h"

extern const model_t model_a16;

/* ---- its parts ---- */

extern const setting_t a16_settings[];

/* The readers of its modes on pins. */
bool a16_read_pwm(reader_t *reader, channel_t *channel, const reader_settings_t *settings);
bool a16_read_switch(reader_t *reader, channel_t *channel, const reader_settings_t *settings);

void a16_decode(decode_frame_t *frame, const uint8_t *request);
void a16_decode_sum(decode_frame_t *frame);

#endif
