/* SPDX-License-Identifier: MIT */
#ifndef HPS167S_H
#define HPS167S_H

#include "sensors/driver.h"

/* From the factory. */
#define HPS167S_LINE                                                                                         \
    {                                                                                                        \
        FATHOM_HPS167S_FACTORY_BAUD, FATHOM_PARITY_EVEN, 1                                                   \
    }

extern const model_t model_hps167s;

/* ---- its parts ---- */

extern const setting_t hps167s_settings[];

bool hps167s_read_modbus(reader_t *reader, channel_t *channel, const reader_settings_t *settings);
bool hps167s_read_auto(reader_t *reader, channel_t *channel, const reader_settings_t *settings);

/* The reader of mode modbus: from now on it reads the temperature too. */
void hps167s_begin_temperature(reader_t *reader, const reader_settings_t *settings);

/* "2.1.0 of 2020-09-27", and the UUID as hexadecimal digits. */
void hps167s_interface_text(char *text, size_t capacity, const fathom_hps167s_version_t *version);
void hps167s_sensor_text(char *text, size_t capacity, const fathom_hps167s_details_t *details);
void hps167s_uuid_text(char *text, size_t capacity, const fathom_hps167s_details_t *details);

void hps167s_decode(decode_frame_t *frame, const uint8_t *request);

/* model_t.read_changes */
const char *hps167s_read_changes(const uint8_t *request);

bool hps167s_identify(inquiry_t *inquiry);
void hps167s_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

#endif
