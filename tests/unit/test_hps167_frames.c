/* SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "auto_rig.h"

#include "fathom/codec/hps167_frames.h"
#include "fathom/codec/hps167s_registers.h"

/* The frames that public programs for the HPS-167 and HPS-166 print. They do not print the three bytes r r r of the
 * measurement, which are 01 here; its CRC fits them. */
enum { LENGTH = FATHOM_HPS167_MEASUREMENT_LENGTH, BYTES = 256 };

static const uint8_t measurement[LENGTH] = {0x0A, 0x0D, 0x01, 0x01, 0x01, 0x06, 0xD9, 0xFC,
                                            0x8C, 0x02, 0x01, 0x00, 0x01, 0x9B, 0x94};
static const uint16_t registers[4] = {0x06D9, 0xFC8C, 0x0201, 0x0001};

TEST(the_crc_has_the_check_value_of_its_catalogue_and_is_that_of_the_definition)
{
    assert_int_equal(fathom_hps167_crc((const uint8_t *)"123456789", 9), 0x29B1);
    assert_int_equal(fathom_hps167_crc(measurement, 0), 0xFFFF);
    for (uint32_t word = 0; word < 65536; word += suite_is_long ? 1 : 251) {
        const uint8_t bytes[] = {HIGH(word), LOW(word), 0x5A};
        assert_int_equal(fathom_hps167_crc(bytes, 3), rig_hps167_crc(bytes, 3));
    }
}

TEST(each_request_is_as_it_is_printed)
{
    static const struct {
        uint8_t command, frame[FATHOM_HPS167_REQUEST_LENGTH];
    } rows[] = {{FATHOM_HPS167_SINGLE, {0x0A, 0x22, 0, 0, 0, 0, 0, 0, 0xAE, 0x57}},
                {FATHOM_HPS167_CONTINUOUS, {0x0A, 0x24, 0, 0, 0, 0, 0, 0, 0x0F, 0x72}},
                {FATHOM_HPS167_STOP, {0x0A, 0x30, 1, 0, 0, 0, 0, 0, 0xBC, 0x6F}},
                {FATHOM_HPS167_TEMPERATURE, {0x0A, 0x3F, 1, 0, 0, 0, 0, 0, 0x36, 0x86}},
                {0x2E, {0x0A, 0x2E, 0, 0, 0, 0, 0, 0, 0xFC, 0x3C}}};
    for (unsigned i = 0; i != COUNT(rows); i++) {
        uint8_t frame[FATHOM_HPS167_REQUEST_LENGTH + 1];
        memset(frame, GUARD, sizeof frame);
        assert_int_equal(fathom_hps167_encode_request(frame, rows[i].command), 10);
        assert_memory_equal(frame, rows[i].frame, 10);
        assert_int_equal(frame[10], GUARD);
        assert_true(fathom_hps167_is_valid(frame, 10));
        assert_int_equal(fathom_hps167_frame_length(frame, 10), 0); /* it is no response */
    }
}

/* One program prints the stop with 00 and this CRC. */
TEST(a_stop_with_00_does_not_fit_its_crc)
{
    static const uint8_t wrong[] = {0x0A, 0x30, 0, 0, 0, 0, 0, 0, 0xBC, 0x6F};
    assert_false(fathom_hps167_is_valid(wrong, sizeof wrong));
}

TEST(the_printed_measurement_is_1753_mm)
{
    uint16_t values[5] = {0, 0, 0, 0, 0xA5A5};
    fathom_sample_t sample;
    assert_int_equal(fathom_hps167_frame_length(measurement, LENGTH), LENGTH);
    assert_true(fathom_hps167_is_valid(measurement, LENGTH));
    fathom_hps167_decode(measurement, values);
    assert_memory_equal(values, registers, sizeof registers);
    assert_int_equal(values[4], 0xA5A5);
    assert_int_equal(fathom_hps167s_decode(values, &sample), FATHOM_OK);
    assert_int_equal(sample.distance_mm, 1753);
    assert_int_equal(sample.magnitude, 258608); /* printed as 25.8608 */
    assert_int_equal(sample.ambient, 1);
    assert_int_equal(sample.precision, 1);
}

/* What r r r mean is not certain. */
TEST(each_of_the_three_unknown_bytes_may_have_any_value)
{
    for (unsigned at = 0; at != 3; at++)
        for (unsigned value = 0; value != BYTES; value++) {
            uint8_t data[11], frame[LENGTH];
            uint16_t values[4];
            memcpy(data, measurement + 2, sizeof data);
            data[at] = (uint8_t)value;
            assert_int_equal(fathom_hps167_encode_response(frame, data, sizeof data), LENGTH);
            assert_true(fathom_hps167_is_valid(frame, LENGTH));
            fathom_hps167_decode(frame, values);
            assert_memory_equal(values, registers, sizeof registers);
        }
}

/* The CRC of 01 is F1D1, that of 00 E1F0, and that of 0B B8 E726, by the definition bit by bit. */
TEST(acknowledgement_and_temperature_are_one_register)
{
    static const uint8_t acknowledged[] = {0x0A, 0x03, 0x01, 0xF1, 0xD1};
    static const uint8_t refused[] = {0x0A, 0x03, 0x00, 0xE1, 0xF0};
    static const uint8_t temperature[] = {0x0A, 0x04, 0x0B, 0xB8, 0xE7, 0x26};
    uint8_t frame[7];
    uint16_t values[2] = {0, 0xA5A5};
    assert_int_equal(fathom_hps167_frame_length(acknowledged, 5), 5);
    assert_true(fathom_hps167_is_valid(acknowledged, 5));
    fathom_hps167_decode(acknowledged, values);
    assert_int_equal(values[0], FATHOM_HPS167_DONE);
    assert_true(fathom_hps167_is_valid(refused, 5));
    fathom_hps167_decode(refused, values);
    assert_int_equal(values[0], FATHOM_HPS167_REFUSED);

    memset(frame, GUARD, sizeof frame);
    assert_int_equal(fathom_hps167_encode_response(frame, temperature + 2, 2), 6);
    assert_memory_equal(frame, temperature, sizeof temperature);
    assert_int_equal(frame[6], GUARD);
    assert_int_equal(fathom_hps167_frame_length(frame, 6), 6);
    assert_true(fathom_hps167_is_valid(frame, 6));
    fathom_hps167_decode(frame, values);
    assert_int_equal(values[0], 3000);
    assert_int_equal(values[1], 0xA5A5);
}

TEST(each_command_has_the_length_of_its_response_and_all_others_none)
{
    for (unsigned command = 0; command != BYTES; command++) {
        const uint8_t length = command == 0x22 || command == 0x24 ? 15
                               : command == 0x3F                  ? 6
                               : command == 0x30                  ? 5
                                                                  : 0;
        assert_int_equal(fathom_hps167_response_length((uint8_t)command), length);
    }
}

/* The buffer is as large as what came, so that the address sanitizer sees a look beyond it. */
TEST(a_response_begins_with_0A_and_one_of_three_lengths)
{
    for (unsigned first = 0; first != BYTES; first++) {
        uint8_t *const alone = malloc(1);
        assert_non_null(alone);
        *alone = (uint8_t)first;
        assert_int_equal(fathom_hps167_frame_length(alone, 1), first == 0x0A ? 2 : 0);
        free(alone);
        /* behind another first byte the second one is not looked at */
        for (unsigned second = 0; second != BYTES; second += first == 0x0A || suite_is_long ? 1 : 64) {
            const uint8_t both[] = {(uint8_t)first, (uint8_t)second};
            const bool is_known = second == 13 || second == 4 || second == 3;
            assert_int_equal(fathom_hps167_frame_length(both, 2), first == 0x0A && is_known ? second + 2 : 0);
        }
    }
}

/* One and two wrong bits of the bytes that the CRC protects, and every run of wrong bits up to 16 long. */
TEST(damaged_measurements_are_refused)
{
    enum { FROM = 16, BITS = 8 * LENGTH };
    for (unsigned first = FROM; first != BITS; first++) {
        uint8_t frame[LENGTH];
        memcpy(frame, measurement, LENGTH);
        frame[first / 8] ^= (uint8_t)(0x80 >> first % 8);
        assert_false(fathom_hps167_is_valid(frame, LENGTH));
        for (unsigned second = first + 1; second != BITS; second++) {
            frame[second / 8] ^= (uint8_t)(0x80 >> second % 8);
            assert_false(fathom_hps167_is_valid(frame, LENGTH));
            frame[second / 8] ^= (uint8_t)(0x80 >> second % 8);
        }
        for (unsigned last = first + 1; last != BITS && last < first + 16; last++) {
            frame[last / 8] ^= (uint8_t)(0x80 >> last % 8);
            assert_false(fathom_hps167_is_valid(frame, LENGTH));
        }
    }
}
