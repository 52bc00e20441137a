/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_settings.h"

/* All that any driver ever sends to unit 0, which every unit on the line obeys (HPS-167S 2.2.1): a list of four. An A05
 * on 55 AA has no unit in its frames; test_a05_dyp.c has what it sends. */

static fathom_a16_modbus_t a16;
static fathom_a05_modbus_t a05;

static union {
    fathom_hps167s_version_t version;
    fathom_hps167s_configuration_t configuration;
    fathom_hps167s_details_t details;
    fathom_hps167s_temperature_t temperature;
    fathom_sample_t sample;
    uint16_t word;
    uint8_t byte;
    fathom_a16_polarity_t polarity;
    fathom_dyp_value_t value;
} out;

/* Behind them `allowed` has what they send to unit 0, in this order. */
#define COMMANDS(X)                                                                                          \
    X(hps_version, fathom_hps167s_get_interface_version(&hps, &out.version))                                 \
    X(hps_configuration, fathom_hps167s_get_configuration(&hps, &out.configuration))                         \
    X(hps_details, fathom_hps167s_get_details(&hps, &out.details))                                           \
    X(hps_temperature, fathom_hps167s_get_temperature(&hps, &out.temperature))                               \
    X(hps_reset, fathom_hps167s_restore_factory_settings(&hps))                                              \
    X(hps_warm_up, fathom_hps167s_set_warm_up_s(&hps, 9))                                                    \
    X(hps_address, fathom_hps167s_set_address(&hps, 5))                                                      \
    X(hps_no_address, fathom_hps167s_set_address(&hps, 0))                                                   \
    X(hps_baud, fathom_hps167s_set_baud(&hps, 115200))                                                       \
    X(hps_measures, fathom_hps167s_set_measures_after_power_on(&hps, false))                                 \
    X(hps_termination, fathom_hps167s_set_termination(&hps, false))                                          \
    X(hps_offset, fathom_hps167s_set_distance_offset_mm(&hps, -15))                                          \
    X(hps_user, fathom_hps167s_load_user_settings(&hps))                                                     \
    X(hps_factory_settings, fathom_hps167s_load_factory_settings(&hps))                                      \
    X(hps_filter, fathom_hps167s_set_filter_sensitivity(&hps, 7))                                            \
    X(hps_reconnect, fathom_hps167s_set_reconnect_time_ms(&hps, 18))                                         \
    X(hps_measures_all, fathom_hps167s_broadcast_measures_after_power_on(&hps, false))                       \
    X(a16_measure, fathom_a16_modbus_measure(&a16, FATHOM_REAL_TIME, &out.sample))                           \
    X(a16_address, fathom_a16_modbus_get_address(&a16, &out.byte))                                           \
    X(hps_measures_all_on, fathom_hps167s_broadcast_measures_after_power_on(&hps, true))                     \
    X(a16_set_address, fathom_a16_modbus_set_address(&a16, 5))                                               \
    X(a16_no_address, fathom_a16_modbus_set_address(&a16, 0))                                                \
    X(a16_mode, fathom_a16_modbus_set_operating_mode(&a16, FATHOM_A16_AUTOMATIC))                            \
    X(a16_polarity, fathom_a16_modbus_get_switch_polarity(&a16, &out.polarity))                              \
    X(hps_termination_all, fathom_hps167s_broadcast_termination(&hps, false))                                \
    X(a16_set_polarity, fathom_a16_modbus_set_switch_polarity(&a16, FATHOM_A16_NEGATIVE))                    \
    X(a16_threshold, fathom_a16_modbus_get_switch_threshold_mm(&a16, &out.word))                             \
    X(a16_set_threshold, fathom_a16_modbus_set_switch_threshold_mm(&a16, 2000))                              \
    X(a16_value, fathom_a16_modbus_get_automatic_value(&a16, &out.value))                                    \
    X(hps_termination_all_on, fathom_hps167s_broadcast_termination(&hps, true))                              \
    X(a16_set_value, fathom_a16_modbus_set_automatic_value(&a16, FATHOM_PROCESSED))                          \
    X(a05_address, fathom_a05_modbus_get_address(&a05, &out.byte))                                           \
    X(a05_set_address, fathom_a05_modbus_set_address(&a05, 5))                                               \
    X(a05_no_address, fathom_a05_modbus_set_address(&a05, 0))

#define DEFINE(name, call)                                                                                   \
    static fathom_status_t name(void) { return call; }
#define NAME(name, call) name,

COMMANDS(DEFINE)
static fathom_status_t (*const commands[])(void) = {desk_poll, COMMANDS(NAME)};

/* #10 and #11 (tables 27 and 29). */
static const uint8_t allowed[4][6] = {
    {0, 6, 0, 0x12, 0, 0x00}, {0, 6, 0, 0x12, 0, 0xFF}, {0, 6, 0, 0x13, 0, 0x00}, {0, 6, 0, 0x13, 0, 0xFF}};

static int set_up(void **state)
{
    hps_set_up(state);
    assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, NULL), FATHOM_OK);
    assert_int_equal(fathom_a05_modbus_init(&a05, &fake.modbus, NULL), FATHOM_OK);
    hps_config.modbus.line_settings = &hps_factory;
    hps_start();
    return 0;
}

static const suite_t suite = {.set_up = set_up};

/* The device at address 1 answers, with the registers of the factory's configuration, and no other does. */
static void device(bool is_there)
{
    static const uint16_t registers[11] = {0xFFFF, 0x0500, 0x0000, 0xB401};
    const uint8_t *const head = fake.request->message.head;
    if (!is_there || head[0] > 1)
        fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
    else if (head[1] == 3)
        fake_modbus_response(&fake, registers, head[5]);
    else
        fake_modbus_acknowledge(&fake);
}

/* Runs the command to its end; what goes to unit 0 has to be the next of the list. */
static void run(fathom_status_t (*command)(void), bool is_there, unsigned *listed)
{
    for (unsigned ms = 0;; ms++) {
        assert_true(ms < 3000);
        fake.now_us += 1000;
        fake.submits = 0;
        if (command() != FATHOM_PENDING) return;
        if (fake.submits == 0) continue;
        if (fake.request->message.head[0] == 0) {
            assert_true(*listed < 4);
            assert_memory_equal(fake.request->message.head, allowed[*listed], 6);
            ++*listed;
        }
        device(is_there);
    }
}

TEST(two_settings_of_the_hps167s_are_all_that_is_ever_sent_to_all_units)
{
    for (unsigned is_there = 0; is_there != 2; is_there++) {
        for (unsigned is_blind = 0; is_blind != 2; is_blind++) {
            unsigned listed = 0;
            for (unsigned i = 0; i != COUNT(commands); i++) {
                set_up(state);
                if (is_blind != 0) {
                    assert_int_equal(fathom_hps167s_write_next_unchecked(&hps), FATHOM_OK);
                    assert_int_equal(fathom_a16_modbus_write_next_unchecked(&a16), FATHOM_OK);
                }
                run(commands[i], is_there != 0, &listed);
            }
            assert_int_equal(listed, 4);
        }
    }
}
