/* SPDX-License-Identifier: MIT */
#include "sensors/models.h"

#include <string.h>

#include "sensors/a05.h"
#include "sensors/a16.h"
#include "sensors/dyp.h"
#include "sensors/hps167s.h"

#define DYP_TRAITS                                                                                           \
    (1u << DEVICE_EXCEPTIONS | 1u << DEVICE_ANSWERS_BROADCAST | 1u << DEVICE_REAL_TIME |                     \
     1u << DEVICE_ANSWERS_FROM_NEW)

/* A module that is at work on a measurement may need longer for the second response (A16 3: 110 ms, A05 2(3): 210 ms). No
 * time of the address register is printed: a module may finish a measurement before it responds. */
enum { DYP_SECOND_RESPONSE_US = 250000, DYP_TIMEOUT_US = 150000 };
/* Within 20 ms, behind an adapter's 16. */
enum { HPS167S_SECOND_RESPONSE_US = 60000 };

/* #9 */
static const uint32_t hps167s_rates[] = {19200, 57600, 115200, 230400, 0};

const model_t models[] = {
    {
        .name = "a16",
        .what = "one ultrasonic probe",
        .id = FATHOM_A16,
        .line = DYP_LINE,
        .modes = {{.name = "auto",
                   .section = "A16 2",
                   .takes = DYP_TAKES | READER_TAKES_VALUE,
                   .read = a16_read_auto,
                   .simulated_as = FATHOM_SIM_A16_AUTO},
                  {.name = "modbus",
                   .section = "A16 6",
                   .protocol = "Modbus",
                   .is_modbus = true,
                   .has_address = true,
                   .takes = DYP_TAKES | READER_TAKES_VALUE,
                   .read = a16_read_modbus,
                   .simulated_as = FATHOM_SIM_A16_MODBUS},
                  {.name = "controlled",
                   .section = "A16 3",
                   .is_triggered = true,
                   .takes = DYP_TAKES,
                   .may_pins = MODEL_PIN_TRIGGER,
                   .read = a16_read_controlled,
                   .simulated_as = FATHOM_SIM_A16_CONTROLLED},
                  {.name = "pwm",
                   .section = "A16 1",
                   .is_triggered = true,
                   .has_pulses = true,
                   .takes = READER_TAKES_WINDOW,
                   .pins = MODEL_PIN_TRIGGER | MODEL_PIN_ECHO,
                   .read = a16_read_pwm},
                  {.name = "switch",
                   .section = "A16 4",
                   .is_contact = true,
                   .pins = MODEL_PIN_IN,
                   .read = a16_read_switch}},
        .max_address = DYP_MAX_ADDRESS,
        .has_address_zero = true,
        .probes = 1,
        .max_mm = FATHOM_A16_MAX_MM,
        .second_response_us = DYP_SECOND_RESPONSE_US,
        .request_ends = "the automatic output of an A16 with RS232, until power-off or `fathom set a16 "
                        "automatic-output on`",
        .automatic_again = ", or when 1 is written to its register 0x0202",
        .settings = a16_settings,
        .simulate = a16_simulate,
        .near_mm = 500,
        .far_mm = 5000,
        .traits = DYP_TRAITS,
        .scan = {.first = DYP_ADDRESS,
                 .count = 1,
                 .frame_length = FATHOM_DYP_A16_LENGTH,
                 .own = FATHOM_A16_REGISTER_REAL_TIME,
                 .slow_own = FATHOM_A16_REGISTER_PROCESSED,
                 .timeout_us = DYP_TIMEOUT_US},
        .describe = dyp_describe,
        .protocols = DECODE_MODBUS | DECODE_STREAM_ONE,
        .decode = dyp_decode,
        .decode_sum = dyp_decode_sum,
        .register_source = "A16 6(3)",
        .stream_source = "A16 2(3), 3(4), 5(3)",
    },
    {
        .name = "a05",
        .what = "four ultrasonic probes",
        .id = FATHOM_A05,
        .line = DYP_LINE,
        .modes = {{.name = "auto",
                   .section = "A05 1",
                   .takes = DYP_TAKES | READER_TAKES_PROBES | READER_TAKES_VALUE,
                   .read = a05_read_auto,
                   .simulated_as = FATHOM_SIM_A05_AUTO},
                  {.name = "modbus",
                   .section = "A05 3",
                   .protocol = "Modbus",
                   .is_modbus = true,
                   .has_address = true,
                   .takes = DYP_TAKES | READER_TAKES_PROBES,
                   .read = a05_read_modbus,
                   .simulated_as = FATHOM_SIM_A05_MODBUS},
                  {.name = "dyp",
                   .section = "A05 2",
                   .protocol = "55 AA",
                   .has_address = true,
                   .can_move_others = true, /* one wrong bit turns a response into the command that sets it */
                   .takes = DYP_TAKES | READER_TAKES_PROBES,
                   .read = a05_read_dyp,
                   .simulated_as = FATHOM_SIM_A05_DYP},
                  {.name = "relay",
                   .section = "A05 4",
                   .is_contact = true,
                   .pins = MODEL_PIN_IN,
                   .read = a05_read_relay}},
        .max_address = DYP_MAX_ADDRESS,
        .has_address_zero = true,
        .probes = FATHOM_DYP_PROBES,
        .max_mm = FATHOM_A05_MAX_MM,
        .second_response_us = DYP_SECOND_RESPONSE_US,
        .request_ends = "the automatic output of an A05 with UART, until power-off",
        .settings = a05_settings,
        .simulate = a05_simulate,
        .near_mm = 250,
        .far_mm = 4500,
        .traits = DYP_TRAITS,
        .scan = {.first = DYP_ADDRESS,
                 .count = 1,
                 .frame_length = FATHOM_DYP_A05_LENGTH,
                 .own = FATHOM_A05_REGISTERS,
                 .timeout_us = DYP_TIMEOUT_US},
        .describe = dyp_describe,
        .protocols = DECODE_MODBUS | DECODE_DYP | DECODE_STREAM_FOUR,
        .decode = dyp_decode,
        .decode_sum = dyp_decode_sum,
        .probe_registers = {FATHOM_A05_REGISTERS, FATHOM_A05_REGISTERS_ALIAS},
        .register_source = "A05 3(3)",
        .stream_source = "A05 1(2)",
    },
    {
        .name = "hps167s",
        .what = "infrared time of flight",
        .id = FATHOM_HPS167S,
        .line = {FATHOM_HPS167S_FACTORY_BAUD, FATHOM_PARITY_EVEN, 1},
        .rates = hps167s_rates,
        .other_settings = "--baud 57600, 115200 or 230400, to which it can be set",
        .modes = {{.name = "modbus",
                   .section = "HPS 3",
                   .protocol = "Modbus",
                   .is_modbus = true,
                   .has_address = true,
                   .takes = READER_TAKES_WINDOW | READER_TAKES_TEMPERATURE,
                   .read = hps167s_read_modbus,
                   .listen_unasked = hps167s_listen_unasked,
                   .simulated_as = HPS167S_SIMULATED_MODBUS},
                  {.name = "auto",
                   .section = "HPS 3 #15",
                   .has_address = true,
                   .takes = READER_TAKES_WINDOW,
                   .read = hps167s_read_auto,
                   .simulated_as = HPS167S_SIMULATED_AUTO}},
        .max_address = FATHOM_HPS167S_MAX_ADDRESS,
        .has_optics = true,
        .may_send_unasked = true,
        .probes = 1,
        .second_response_us = HPS167S_SECOND_RESPONSE_US,
        .settings = hps167s_settings,
        .offset = "distance-offset",
        .reset = {.restore = hps167s_restore, .load = hps167s_load, .is_sent = hps167s_is_sent},
        .read_changes = hps167s_read_changes,
        .simulate = hps167s_simulate,
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
        .exception_name = hps167s_exception_name,
        .exception_source = "HPS table 39",
    },
};
const size_t model_count = sizeof models / sizeof models[0];

bool model_has_address(const model_t *model, uint8_t address)
{
    return model->has_address_zero || (address != 0 && address <= model->max_address);
}

bool model_has_rate(const model_t *model, uint32_t baud)
{
    if (baud == model->line.baud) return true;
    for (const uint32_t *rate = model->rates; rate != NULL && *rate != 0; rate++)
        if (*rate == baud) return true;
    return false;
}

uint8_t model_least_address(const model_t *model, const model_mode_t *mode)
{
    return model->has_address_zero && mode->is_modbus ? 0 : 1;
}

/* Returns true if the register is one of the model's values. */
static bool has_value_at(const model_t *model, uint16_t address)
{
    for (const setting_t *setting = model->settings; setting->name != NULL; setting++)
        if (setting->read_at == address) return true;
    return false;
}

bool models_allow_read(uint8_t address, uint16_t first, uint16_t count)
{
    const uint8_t request[] = {address,
                               FATHOM_MODBUS_READ_HOLDING_REGISTERS,
                               (uint8_t)(first >> 8),
                               (uint8_t)first,
                               (uint8_t)(count >> 8),
                               (uint8_t)count};
    bool is_of_address_zero = false;
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        if (model->read_changes != NULL && model->read_changes(request) != NULL) return false;
        if (model->has_address_zero && has_value_at(model, first)) is_of_address_zero = true;
    }
    return address != 0 || is_of_address_zero;
}

const model_t *model_with(uint8_t protocols)
{
    size_t i = 0;
    while ((models[i].protocols & protocols) == 0) i++;
    return &models[i];
}

const model_mode_t *model_mode_of(const model_t *model, const setting_t *setting)
{
    const model_mode_t *mode = model->modes;
    while (setting != NULL && setting->mode != NULL ? strcmp(mode->name, setting->mode) != 0
                                                    : !mode->is_modbus)
        mode++;
    return mode;
}
