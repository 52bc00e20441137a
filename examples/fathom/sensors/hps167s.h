/* SPDX-License-Identifier: MIT */
#ifndef HPS167S_H
#define HPS167S_H

#include "sensors/driver.h"

/* What the row of the HPS-167S consists of (models.c). */

extern const setting_t hps167s_settings[];

bool hps167s_read_modbus(reader_t *reader, port_t *port, const reader_settings_t *settings);
bool hps167s_read_auto(reader_t *reader, port_t *port, const reader_settings_t *settings);
void hps167s_listen_unasked(reader_t *reader);

/* Of mode modbus: reads the temperature as well. */
void hps167s_add_temperature(reader_t *reader, const reader_settings_t *settings);

/* "2.1.0 of 2020-09-27", and the UUID as hexadecimal digits. */
void hps167s_interface_text(char *text, size_t capacity, const fathom_hps167s_version_t *version);
void hps167s_sensor_text(char *text, size_t capacity, const fathom_hps167s_details_t *details);
void hps167s_uuid_text(char *text, size_t capacity, const fathom_hps167s_details_t *details);

fathom_status_t hps167s_restore(reader_t *reader);
fathom_status_t hps167s_load(reader_t *reader);
bool hps167s_is_sent(const reader_t *reader);

/* model_mode_t.simulated_as; in mode auto it sends each measurement without a request. */
enum { HPS167S_SIMULATED_MODBUS = 1, HPS167S_SIMULATED_AUTO };
void hps167s_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as);

void hps167s_decode(decode_frame_t *frame, const model_t *model, const uint8_t *request);
const char *hps167s_read_changes(const uint8_t *request);
const char *hps167s_exception_name(uint8_t code);

bool hps167s_identify(inquiry_t *inquiry);
void hps167s_describe(const model_t *model, const scan_finding_t *finding, finding_facts_t *facts);

#endif
