/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fake_modbus.h"
#include "fathom/codec/crc16.h"
#include "fathom/sensor/hps167s_info.h"
#include "vectors.h"

/* The mistakes in the datasheet of the HPS-167S, one test each: what is printed is refused or not followed, what is
 * right is taken. Those of its frames, CRCs and counts are in test_frames.c. */

/* The CRC bit by bit as 2.2.5 describes it: 0xFFFF, 0xA001, the low bit first. */
static uint16_t bitwise(const uint8_t *bytes, size_t count)
{
    unsigned crc = 0xFFFF;
    for (size_t i = 0; i != count; i++) {
        crc ^= bytes[i];
        for (unsigned bit = 0; bit != 8; bit++) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
    }
    return (uint16_t)crc;
}

/* The frame of a section. */
static const vector_t *frame_of(const char *source)
{
    for (unsigned i = 0; i != MODBUS_ROWS; i++)
        if (strcmp(modbus_vectors[i].frame.source, source) == 0) return &modbus_vectors[i].frame;
    fail_msg("%s is not in vectors.c", source);
    return NULL;
}

/* ---- #3, through the driver ---- */

static fathom_modbus_request_t *pending;

static fathom_status_t submit(fathom_line_t *line, fathom_modbus_request_t *request)
{
    (void)line;
    request->transaction.status = FATHOM_PENDING;
    request->transaction.attempts = 1;
    pending = request;
    return FATHOM_PENDING;
}

static void end_with(const uint8_t *frame)
{
    pending->transaction.status = (int8_t)fathom_modbus_rtu_parse_response(&pending->message, frame);
}

static fake_modbus_t bus;
static const fathom_modbus_t modbus = {.line = &bus.line, .submit = submit};

TEST(command_3_says_19_09_27_and_ver_2_1_and_its_bytes_2019_09_23_and_3_9)
{
    const uint8_t *const example = frame_of("HPS command #3")->bytes;
    fathom_hps167s_details_t details;
    fathom_hps167s_t hps;
    assert_int_equal(bitwise(example, 27), 0); /* so the bytes are what the device said */
    fake_modbus_init(&bus);
    assert_int_equal(fathom_hps167s_init(&hps, &modbus, NULL), FATHOM_OK);
    assert_int_equal(fathom_hps167s_get_details(&hps, &details), FATHOM_PENDING);
    end_with(example);
    assert_int_equal(fathom_hps167s_get_details(&hps, &details), FATHOM_OK);
    assert_int_equal(details.year, 2019);
    assert_int_equal(details.month, 9);
    assert_int_equal(details.day, 23); /* 0x17, not 27 */
    assert_int_equal(details.major, 3);
    assert_int_equal(details.minor, 9);
}

/* ---- the CRC ---- */

/* Two bytes take every entry of a table into every other: 65536 of them, bit by bit. */
TEST(our_crc_is_that_of_the_polynomial_for_every_pair_of_bytes)
{
    for (uint32_t i = 0; i != 65536; i++) {
        const uint8_t pair[] = {(uint8_t)(i >> 8), (uint8_t)(i & 0xFF)};
        assert_int_equal(fathom_crc16(pair, 2), bitwise(pair, 2));
    }
}

/* Its main() calls crc16 under "Implementation_1" and CRC16 under "Implementation_2", which are the second and the
 * first in the text above, and prints FF69 BEE5 ... for the former: that is the order on the wire. The register has
 * 69FF. */
TEST(the_appendix_prints_the_results_of_its_implementations_the_wrong_way_round)
{
    static const uint16_t registers[] = {0x69FF, 0xE5BE, 0x617F, 0x4523, 0x8576, 0x0DF4, 0xF102};
    unsigned rows = 0;
    for (unsigned i = 0; i != CRC_ROWS; i++) {
        const crc_vector_t *const row = &crc_vectors[i];
        if (strncmp(row->source, "HPS-167S appendix", 17) != 0) continue;
        assert_int_equal(row->value, registers[rows]);
        assert_int_equal(fathom_crc16(row->bytes, row->length), registers[rows]);
        assert_int_equal(row->wire[0], registers[rows] & 0xFF);
        assert_int_equal(row->wire[1], registers[rows] >> 8);
        rows++;
    }
    assert_int_equal(rows, 7);
}

/* CRC-16/CCITT: 0x1021 and not reflected; of table 17 it is not C5 CB either way round. */
TEST(revision_1_1_calls_it_crc16_ccitt_and_it_is_not)
{
    static const uint8_t request[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04};
    static const unsigned starts[] = {0x0000, 0xFFFF, 0x1D0F};
    assert_int_equal(fathom_crc16(request, 6), 0xCBC5);
    for (unsigned i = 0; i != 3; i++) {
        unsigned crc = starts[i];
        for (unsigned n = 0; n != 6; n++) {
            crc ^= (unsigned)request[n] << 8;
            for (unsigned bit = 0; bit != 8; bit++)
                crc = (crc & 0x8000) != 0 ? (crc << 1 ^ 0x1021) & 0xFFFF : crc << 1;
        }
        assert_int_not_equal(crc, 0xCBC5);
        assert_int_not_equal(crc, 0xC5CB);
    }
}

/* ---- text ---- */

/* Note *2 speaks of more than 20 meters, and the range ends at 18: what lies beyond is believed up to 30 m and no
 * further, so that a unit which does see farther is not called broken. */
TEST(note_2_says_20_meters_where_the_range_ends_at_18)
{
    static const uint16_t believed[] = {18000, 18001, 20001, 30000};
    fathom_sample_t sample;
    for (unsigned i = 0; i != 4; i++) {
        const uint16_t registers[4] = {believed[i], 0xDCB2, 0x0701, 0};
        assert_int_equal(fathom_hps167s_decode(registers, &sample), FATHOM_OK);
        assert_int_equal(sample.kind, FATHOM_TARGET);
        assert_int_equal(sample.distance_mm, believed[i]);
    }
    const uint16_t beyond[4] = {30001, 0xDCB2, 0x0701, 0};
    assert_int_equal(fathom_hps167s_decode(beyond, &sample), FATHOM_ERR_MALFORMED);
}

/* Table 28 is the response to #10 and is called that of the baud rate: its register is 0012, the baud rate's 0011. */
TEST(table_28_is_titled_baud_rate_and_is_the_measurement_mode)
{
    assert_int_equal(frame_of("HPS tables 27 28")->bytes[3], 0x12);
    assert_int_equal(frame_of("HPS tables 25 26")->bytes[3], 0x11);
}
