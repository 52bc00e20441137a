/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fathom/codec/hps167s_registers.h"

/* The commands and figures of the datasheet, section 3. */

/* The requests of tables 9 to 19: initial address and number of registers. */
TEST(the_commands_that_read_are_where_their_tables_say)
{
    static const uint16_t printed[][4] = {
        {FATHOM_HPS167S_VERSION, 0x0001, FATHOM_HPS167S_VERSION_COUNT, 3},
        {FATHOM_HPS167S_CONFIGURATION, 0x0002, FATHOM_HPS167S_CONFIGURATION_COUNT, 4},
        {FATHOM_HPS167S_DETAILS, 0x0003, FATHOM_HPS167S_DETAILS_COUNT, 0x0B},
        {FATHOM_HPS167S_TEMPERATURE, 0x0004, 1, 1},
        {FATHOM_HPS167S_MEASUREMENT, 0x0008, FATHOM_HPS167S_MEASUREMENT_COUNT, 4},
        {FATHOM_HPS167S_RESET, 0x0009, 1, 1},
    };
    for (unsigned i = 0; i != COUNT(printed); i++) {
        assert_int_equal(printed[i][0], printed[i][1]);
        assert_int_equal(printed[i][2], printed[i][3]);
    }
    assert_int_equal(FATHOM_HPS167S_MAX_REGISTERS, 11);
}

/* The requests of tables 21 to 37. */
TEST(the_commands_that_write_are_where_their_tables_say)
{
    static const uint16_t printed[][2] = {
        {FATHOM_HPS167S_WARM_UP, 0x000A},     {FATHOM_HPS167S_ADDRESS, 0x0010},
        {FATHOM_HPS167S_BAUD, 0x0011},        {FATHOM_HPS167S_MEASURES, 0x0012},
        {FATHOM_HPS167S_TERMINATION, 0x0013}, {FATHOM_HPS167S_OFFSET, 0x0014},
        {FATHOM_HPS167S_LOAD, 0x0015},        {FATHOM_HPS167S_FILTER, 0x0016},
        {FATHOM_HPS167S_RECONNECT, 0x0020},   {FATHOM_HPS167S_RECONNECT_COUNT, 2},
    };
    for (unsigned i = 0; i != COUNT(printed); i++) assert_int_equal(printed[i][0], printed[i][1]);
}

/* #10, #11: "0x00 means not enabled and 0xFF means enabled"; #13; table 20; #7: 5 seconds; 2.2.1: 1 to 32. */
TEST(the_values_that_have_names_are_those_of_the_datasheet)
{
    assert_int_equal(FATHOM_HPS167S_OFF, 0x00);
    assert_int_equal(FATHOM_HPS167S_ON, 0xFF);
    assert_int_equal(FATHOM_HPS167S_USER, 0x00);
    assert_int_equal(FATHOM_HPS167S_FACTORY, 0xFF);
    assert_int_equal(FATHOM_HPS167S_RESET_DONE, 0x01);
    assert_int_equal(FATHOM_HPS167S_FACTORY_WARM_UP_S, 5);
    assert_int_equal(FATHOM_HPS167S_MAX_ADDRESS, 32);
}

/* Table 10. */
TEST(the_version_is_read_byte_by_byte)
{
    static const uint16_t registers[3] = {0x1409, 0x1B02, 0x01FF};
    fathom_hps167s_version_t version;
    memset(&version, GUARD, sizeof version);
    fathom_hps167s_decode_version(registers, &version);
    assert_int_equal(version.year, 2020);
    assert_int_equal(version.month, 9);
    assert_int_equal(version.day, 27);
    assert_int_equal(version.major, 2);
    assert_int_equal(version.minor, 1);
    assert_int_equal(version.revision, 255);
}

TEST(a_date_has_a_month_of_12_and_a_day_of_31)
{
    for (unsigned month = 0; month != 256; month++)
        for (unsigned day = 0; day != 256; day++)
            assert_int_equal(fathom_hps167s_is_date((uint8_t)month, (uint8_t)day),
                             month - 1 < 12 && day - 1 < 31);
}

/* Table 12: FF, FF, 5 s, 01 02 03 04, code 3. */
TEST(the_configuration_is_read_byte_by_byte)
{
    static const uint16_t registers[4] = {0xFF00, 0x0501, 0x0203, 0x0403};
    fathom_hps167s_configuration_t is;
    memset(&is, GUARD, sizeof is);
    fathom_hps167s_decode_configuration(registers, false, &is);
    assert_true(is.termination);
    assert_false(is.measures_after_power_on);
    assert_int_equal(is.warm_up_s, 5);
    assert_int_equal(is.reconnect_time_ms, 0x01020304);
    assert_int_equal(is.baud_code, 3);
    assert_int_equal(is.baud, 115200);
    fathom_hps167s_decode_configuration(registers, true, &is);
    assert_int_equal(is.reconnect_time_ms, 0x03040102);
}

/* Table 12: each is 00 or FF. #5: the exponent of the abnormal packet is not named; what differs from it in one of the
 * figures that are is none. */
TEST(a_response_to_2_has_two_switches_and_is_not_the_abnormal_packet)
{
    static const struct {
        uint16_t registers[4];
        bool is_abnormal, may_be_configuration;
    } rows[] = {
        {{0xFFFF, 0x0000, 0x07FF, 0xFFFF}, true, false},  {{0xFFFF, 0x0000, 0xFFFF, 0xFFFF}, true, false},
        {{0x00FF, 0x0000, 0x07FF, 0xFFFF}, false, true},  {{0xFFFF, 0x0001, 0x07FF, 0xFFFF}, false, true},
        {{0xFFFF, 0x0000, 0x07FE, 0xFFFF}, false, true},  {{0xFFFF, 0x0000, 0x07FF, 0xFFFE}, false, true},
        {{0xFF00, 0x0500, 0x0000, 0xB401}, false, true},  {{0x01FF, 0x0500, 0x0000, 0xB401}, false, false},
        {{0xFF01, 0x0500, 0x0000, 0xB401}, false, false}, {{0x0823, 0xDCB2, 0x0701, 0x0000}, false, false},
    };
    for (unsigned i = 0; i != COUNT(rows); i++) {
        assert_int_equal(fathom_hps167s_is_abnormal(rows[i].registers), rows[i].is_abnormal);
        assert_int_equal(fathom_hps167s_may_be_configuration(rows[i].registers),
                         rows[i].may_be_configuration);
    }
}

/* #15: 180 ms are B4; a word of its own each. */
TEST(the_reconnect_time_goes_as_two_words_either_way_round)
{
    uint16_t words[2];
    fathom_hps167s_encode_reconnect_time(180, false, words);
    assert_int_equal(words[0], 0x0000);
    assert_int_equal(words[1], 0x00B4);
    fathom_hps167s_encode_reconnect_time(0x00010012, false, words);
    assert_int_equal(words[0], 0x0001);
    assert_int_equal(words[1], 0x0012);
    assert_int_equal(fathom_hps167s_decode_reconnect_time(words[0], words[1], false), 0x00010012);
    fathom_hps167s_encode_reconnect_time(0x00010012, true, words);
    assert_int_equal(words[0], 0x0012);
    assert_int_equal(words[1], 0x0001);
    assert_int_equal(fathom_hps167s_decode_reconnect_time(words[0], words[1], true), 0x00010012);
}

/* The example of #3: B0, the UUID, 13 09 17, 03 09, which it reads as "19/09/27" and "Ver. 2.1"; the bytes say 2019-09-23
 * and 3.9. */
TEST(the_details_are_those_of_the_example)
{
    static const uint8_t uuid[] = {0x00, 0x39, 0x00, 0x25, 0x42, 0x34, 0x57, 0x14,
                                   0x20, 0x34, 0x38, 0x35, 0x01, 0x06, 0x07, 0x05};
    uint16_t registers[11] = {0xB000, 0x3900, 0x2542, 0x3457, 0x1420, 0x3438,
                              0x3501, 0x0607, 0x0513, 0x0917, 0x0309};
    fathom_hps167s_details_t details;
    memset(&details, GUARD, sizeof details);
    fathom_hps167s_decode_details(registers, &details);
    assert_memory_equal(details.uuid, uuid, sizeof uuid);
    assert_int_equal(details.year, 2019);
    assert_int_equal(details.month, 9);
    assert_int_equal(details.day, 23);
    assert_int_equal(details.major, 3);
    assert_int_equal(details.minor, 9);
    assert_true(fathom_hps167s_may_be_details(registers));
    registers[0] = 0xB100;
    assert_false(fathom_hps167s_may_be_details(registers));
}

TEST(a_register_with_a_sign_is_int16)
{
    assert_int_equal(fathom_hps167s_to_signed(0xFFF1), -15); /* the example of #12 */
    assert_int_equal(fathom_hps167s_to_signed(0x7FFF), 32767);
    assert_int_equal(fathom_hps167s_to_signed(0x8000), -32768);
    assert_int_equal(fathom_hps167s_to_signed(0), 0);
}

TEST(limits_that_are_out_of_order_are_refused)
{
    fathom_hps167s_limits_t wrong[] = {{0, 65535, 0}, {0, 30000, 0}, {65530, 0, 0},
                                       {100, 100, 0}, {0, 0, 30001}, {79, 0, 0}};
    for (unsigned i = 0; i != COUNT(wrong); i++)
        assert_int_equal(fathom_hps167s_complete_limits(&wrong[i]), FATHOM_ERR_ARGUMENT);
}

/* ---- #5 ---- */

static fathom_sample_t sample;

/* Command #5: 08 23, DC B2, 07, 01, 00 00. */
static const uint16_t measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};

/* The rule, stated apart: 80..30000 a distance, below that it is below its range, 65530..65534 nothing in range; else,
 * and these are figures of no abnormal packet, it cannot be. */
static int kind_of(uint32_t raw)
{
    if (raw == 65535) return 0;
    if (raw / 10 == 6553) return FATHOM_NO_TARGET; /* 65530..65534, 65535 is gone */
    if (raw == 0) return 0;
    if (raw < 80) return FATHOM_UNKNOWN;
    return raw <= 30000 ? FATHOM_TARGET : 0;
}

TEST(every_distance_is_what_the_rule_says)
{
    unsigned counted[7] = {0};
    for (uint32_t raw = 0; raw != 65536; raw++) {
        const uint16_t registers[4] = {(uint16_t)raw, 0xDCB2, 0x0742, 0x1234};
        const int kind = kind_of(raw);
        memset(&sample, GUARD, sizeof sample);
        counted[kind]++;
        assert_int_equal(fathom_hps167s_decode(registers, &sample),
                         kind == 0 ? FATHOM_ERR_MALFORMED : FATHOM_OK);
        if (kind == 0) {
            assert_guard(&sample, sizeof sample);
            continue;
        }
        assert_int_equal(sample.kind, kind);
        assert_int_equal(sample.raw, raw);
        assert_int_equal(sample.distance_mm, kind == FATHOM_TARGET ? raw : 0);
        assert_int_equal(sample.ambient, 0x42);
        assert_int_equal(sample.precision, 0x1234);
        assert_false(sample.interference);
        assert_int_equal(sample.magnitude, 7231744);
    }
    assert_int_equal(counted[FATHOM_TARGET], 29921);
    assert_int_equal(counted[FATHOM_UNKNOWN], 79);
    assert_int_equal(counted[FATHOM_NO_TARGET], 5);
}

TEST(decode_leaves_the_members_that_are_not_the_devices)
{
    memset(&sample, GUARD, sizeof sample);
    assert_int_equal(fathom_hps167s_decode(measured, &sample), FATHOM_OK);
    assert_int_equal(sample.time_us, 0xA5A5A5A5);
    assert_int_equal(sample.sequence, 0xA5A5);
    assert_int_equal(sample.model, GUARD);
    assert_int_equal(sample.address, GUARD);
    assert_int_equal(sample.probe, GUARD);
}

TEST(the_magnitude_is_exact_up_to_an_exponent_of_16_and_refused_beyond)
{
    for (unsigned exponent = 0; exponent != 256; exponent++) {
        const uint16_t registers[4] = {2083, 0xFFFF, (uint16_t)(exponent * 256), 0};
        const uint16_t over_range[4] = {65530, 0, (uint16_t)(exponent * 256), 0};
        const fathom_status_t expected = exponent <= 16 ? FATHOM_OK : FATHOM_ERR_MALFORMED;
        uint32_t magnitude = 65535;
        for (unsigned i = 0; i != exponent && i != 16; i++) magnitude *= 2;
        memset(&sample, GUARD, sizeof sample);
        assert_int_equal(fathom_hps167s_decode(registers, &sample), expected);
        if (exponent <= 16)
            assert_true(sample.magnitude == magnitude);
        else
            assert_guard(&sample, sizeof sample);
        assert_int_equal(fathom_hps167s_decode(over_range, &sample), expected);
    }
}
