/* SPDX-License-Identifier: MIT */
#include "sensors/hps167s/hps167s.h"

#include <string.h>

#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"

static void listen_unasked(reader_t *reader)
{
    (void)fathom_hps167s_auto_init(&reader->unasked, reader->line, NULL);
    fathom_hps167s_auto_follow(&reader->unasked, &reader->driver.hps167s);
}

/* ---- resetting ---- */

static fathom_status_t restore(reader_t *reader)
{
    return fathom_hps167s_restore_factory_settings(&reader->driver.hps167s);
}

static fathom_status_t load(reader_t *reader)
{
    return fathom_hps167s_load_factory_settings(&reader->driver.hps167s);
}

static bool is_sent(const reader_t *reader) { return fathom_hps167s_is_written(&reader->driver.hps167s); }

/* ---- simulation ---- */

static uint8_t warm_up_says(const uint32_t *traits)
{
    if (traits[DEVICE_WARM_UP_ABNORMAL] != 0) return FATHOM_SIM_HPS167S_ABNORMAL;
    return traits[DEVICE_WARM_UP_REFUSES] != 0 ? FATHOM_SIM_HPS167S_EXCEPTION : FATHOM_SIM_HPS167S_SILENCE;
}

/* model_mode_t.simulated_as: it sends each measurement without a request in mode auto. */
enum { SIMULATED_MODBUS = 1, SIMULATED_AUTO };

static void simulate(device_t *device, const device_settings_t *settings, uint8_t simulated_as)
{
    const uint32_t unasked_us = simulated_as == SIMULATED_AUTO ? FATHOM_HPS167S_MIN_PERIOD_US : 0;
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

/* ---- the model ---- */

/* HPS-167S table 39. */
static const char *exception_name(uint8_t code)
{
    static const char *const names[] = {[1] = "illegal function code",
                                        [2] = "illegal start address or register address",
                                        [3] = "illegal register count",
                                        [4] = "device operation failed"};
    return code != 0 && code < sizeof names / sizeof names[0] ? names[code] : NULL;
}

/* #9 */
static const uint32_t rates[] = {19200, 57600, 115200, 230400, 0};

const model_t model_hps167s = {
    .name = "hps167s",
    .what = "infrared time of flight",
    .id = FATHOM_HPS167S,
    .line = HPS167S_LINE,
    .rates = rates,
    .other_settings = "--baud 57600, 115200 or 230400, to which it can be set",
    .modes = {{.name = "modbus",
               .protocol = "Modbus",
               .is_modbus = true,
               .has_address = true,
               .takes = READER_TAKES_WINDOW | READER_TAKES_TEMPERATURE,
               .read = hps167s_read_modbus,
               .listen_unasked = listen_unasked,
               .simulated_as = SIMULATED_MODBUS},
              {.name = "auto",
               .has_address = true,
               .takes = READER_TAKES_WINDOW,
               .read = hps167s_read_auto,
               .simulated_as = SIMULATED_AUTO}},
    .settings = hps167s_settings,
    .reset = {.restore = restore, .load = load, .is_sent = is_sent},
    .may_send_unasked = true,
    .max_address = FATHOM_HPS167S_MAX_ADDRESS,
    .probes = 1,
    .has_optics = true,
    .simulate = simulate,
    .near_mm = 500,
    .far_mm = 12000,
    .traits = 1u << DEVICE_ANSWERS_FROM_NEW | 1u << DEVICE_WARM_UP | 1u << DEVICE_WARM_UP_REFUSES |
              1u << DEVICE_WARM_UP_ABNORMAL | 1u << DEVICE_UNASKED | 1u << DEVICE_NO_OUTPUT |
              1u << DEVICE_NO_TERMINATION | 1u << DEVICE_BAUD_LATER | 1u << DEVICE_OFFSET_ADDS |
              1u << DEVICE_RECONNECT | 1u << DEVICE_NO_BAUD_CODE | 1u << DEVICE_COUNT_EXCEPTION,
    .scan = {.first = FATHOM_HPS167S_VERSION,
             .count = FATHOM_HPS167S_VERSION_COUNT,
             .is_it = hps167s_identify},
    .describe = hps167s_describe,
    .protocols = DECODE_MODBUS,
    .decode = hps167s_decode,
    .exception_name = exception_name,
    .exception_source = "HPS table 39",
    .read_changes = hps167s_read_changes,
};
