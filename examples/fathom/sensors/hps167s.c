/* SPDX-License-Identifier: MIT */
#include "sensors/hps167s.h"

#include <string.h>

#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"

void hps167s_listen_unasked(reader_t *reader)
{
    (void)fathom_hps167s_auto_init(&reader->unasked, reader->line, NULL);
    fathom_hps167s_auto_follow(&reader->unasked, &reader->driver.hps167s);
}

/* ---- resetting ---- */

fathom_status_t hps167s_restore(reader_t *reader)
{
    return fathom_hps167s_restore_factory_settings(&reader->driver.hps167s);
}

fathom_status_t hps167s_load(reader_t *reader)
{
    return fathom_hps167s_load_factory_settings(&reader->driver.hps167s);
}

bool hps167s_is_sent(const reader_t *reader) { return fathom_hps167s_is_written(&reader->driver.hps167s); }

/* ---- simulation ---- */

static uint8_t warm_up_says(const uint32_t *traits)
{
    if (traits[DEVICE_WARM_UP_ABNORMAL] != 0) return FATHOM_SIM_HPS167S_ABNORMAL;
    return traits[DEVICE_WARM_UP_REFUSES] != 0 ? FATHOM_SIM_HPS167S_EXCEPTION : FATHOM_SIM_HPS167S_SILENCE;
}

void hps167s_simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t unasked_us = simulated_as == HPS167S_SIMULATED_AUTO ? FATHOM_HPS167S_MIN_PERIOD_US : 0;
    const uint32_t *const traits = settings->traits;
    const fathom_sim_hps167s_config_t config = {
        .address = settings->address,
        .baud_code = fathom_hps167s_baud_code(settings->baud),
        .warm_up_s = (uint8_t)traits[DEVICE_WARM_UP],
        .warm_up_says = warm_up_says(traits),
        .wrong_length = traits[DEVICE_COUNT_EXCEPTION] != 0 ? FATHOM_MODBUS_ILLEGAL_DATA_VALUE : 0,
        .no_termination = traits[DEVICE_NO_TERMINATION] != 0,
        .no_auto_output = traits[DEVICE_NO_OUTPUT] != 0,
        .baud_at_power_on = traits[DEVICE_BAUD_LATER] != 0,
        .offset_adds = traits[DEVICE_OFFSET_ADDS] != 0,
        .reconnect_ms = traits[DEVICE_RECONNECT],
        .no_baud_code = traits[DEVICE_NO_BAUD_CODE] != 0,
        .answers_from_new = traits[DEVICE_ANSWERS_FROM_NEW] != 0,
        .unasked_us = traits[DEVICE_UNASKED] != 0 ? traits[DEVICE_UNASKED] : unasked_us,
        .number = settings->number,
        .seed = settings->seed,
        .scene = settings->scene};
    fathom_sim_hps167s_init(&device->simulator.hps167s, &config);
    device->base = &device->simulator.hps167s.device;
}

/* ---- decoding ---- */

/* HPS-167S table 39. */
const char *hps167s_exception_name(uint8_t code)
{
    static const char *const names[] = {[1] = "illegal function code",
                                        [2] = "illegal start address or register address",
                                        [3] = "illegal register count",
                                        [4] = "device operation failed"};
    return code != 0 && code < sizeof names / sizeof names[0] ? names[code] : NULL;
}
