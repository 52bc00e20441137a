/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "fathom/crc16.h"
#include "fathom/hps167s_info.h"
#include "fathom/modbus_client.h"
#include "vectors.h"

/* The mistakes in the datasheet of the HPS-167S, one test each: what is printed is refused or not followed, what is
 * right is taken. */

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

static bool crc_is_right(const uint8_t *frame, size_t length)
{
    const uint16_t crc = bitwise(frame, length - 2);
    assert_int_equal(fathom_crc16(frame, (uint8_t)(length - 2)), crc);
    return frame[length - 2] == (crc & 0xFF) && frame[length - 1] == crc >> 8;
}

TEST(the_request_of_the_abnormal_response_has_c5_c8_and_should_have_c5_cb)
{
    static const uint8_t printed[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xC8};
    uint16_t values[4];
    uint8_t frame[8];
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, 1, 0x0008, 4, values);
    assert_int_equal(fathom_modbus_rtu_encode_request(&message, frame), 8);
    assert_memory_equal(frame, printed, 7);
    assert_int_equal(frame[7], 0xCB); /* table 17 */
    assert_true(crc_is_right(frame, 8));
    assert_false(crc_is_right(printed, 8));
}

/* That #4 and #5 have one CRC is no misprint. */
TEST(tables_15_and_17_share_the_crc_c5_cb_and_rightly_so)
{
    static const uint8_t four[] = {0x01, 0x03, 0x00, 0x04, 0x00, 0x01, 0xC5, 0xCB};
    static const uint8_t five[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB};
    assert_true(crc_is_right(four, 8));
    assert_true(crc_is_right(five, 8));
}

/* Address, code, CRC would be 01 02 and two more; its own example has the function with 80 between. */
TEST(table_40_leaves_out_the_function_with_80_which_its_example_has)
{
    static const uint8_t example[] = {0x01, 0x83, 0x02, 0xC0, 0xF1};
    uint8_t printed[4] = {0x01, 0x02, 0, 0};
    uint16_t values[4] = {0xA5A5, 0, 0, 0};
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, 1, 0x0008, 4, values);
    assert_true(crc_is_right(example, 5));
    assert_int_equal(fathom_modbus_rtu_response_length(example, 5), 5);
    assert_int_equal(fathom_modbus_rtu_parse_response(&message, example), FATHOM_ERR_EXCEPTION);
    assert_int_equal(message.exception, 2);
    assert_int_equal(values[0], 0xA5A5);
    printed[2] = (uint8_t)(bitwise(printed, 2) & 0xFF);
    printed[3] = (uint8_t)(bitwise(printed, 2) >> 8);
    assert_int_equal(fathom_modbus_rtu_response_length(printed, 4), 0);
}

/* ---- #3, through the driver ---- */

static fathom_modbus_request_t *pending;
static uint32_t clock_us;

static fathom_status_t submit(void *ctx, fathom_modbus_request_t *request)
{
    (void)ctx;
    request->exchange.status = FATHOM_PENDING;
    request->exchange.attempts = 1;
    pending = request;
    return FATHOM_PENDING;
}

static fathom_status_t poll(void *ctx)
{
    (void)ctx;
    return FATHOM_PENDING;
}

static uint32_t now_us(void *ctx)
{
    (void)ctx;
    return clock_us;
}

static void end_with(const uint8_t *frame)
{
    pending->exchange.status = (int8_t)fathom_modbus_rtu_parse_response(&pending->message, frame);
}

static const fathom_modbus_t modbus = {.submit = submit, .poll = poll};
static const fathom_clock_t clock = {.now_us = now_us};

TEST(command_3_says_19_09_27_and_ver_2_1_and_its_bytes_2019_09_23_and_3_9)
{
    static const uint8_t example[] = {0x01, 0x03, 0x16, 0xB0, 0x00, 0x39, 0x00, 0x25, 0x42,
                                      0x34, 0x57, 0x14, 0x20, 0x34, 0x38, 0x35, 0x01, 0x06,
                                      0x07, 0x05, 0x13, 0x09, 0x17, 0x03, 0x09, 0x1A, 0xDC};
    const fathom_hps167s_config_t config = {.modbus = &modbus, .clock = &clock};
    fathom_hps167s_details_t details;
    fathom_hps167s_t hps;
    assert_true(crc_is_right(example, sizeof example)); /* so the bytes are what the device said */
    assert_int_equal(fathom_hps167s_init(&hps, &config), FATHOM_READY);
    assert_int_equal(fathom_hps167s_details(&hps, &details), FATHOM_PENDING);
    end_with(example);
    assert_int_equal(fathom_hps167s_details(&hps, &details), FATHOM_READY);
    assert_int_equal(details.year, 2019);
    assert_int_equal(details.month, 9);
    assert_int_equal(details.day, 23); /* 0x17, not 27 */
    assert_int_equal(details.major, 3);
    assert_int_equal(details.minor, 9);
}

/* ---- the CRC ---- */

/* The tables name the first of the two "MSB" or "high byte". */
TEST(the_tables_put_the_high_byte_of_the_crc_first_and_every_example_the_low_byte)
{
    unsigned frames = 0;
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const vector_t *const frame = &modbus_vectors[i].frame;
        if (strcmp(frame->sensor, "HPS-167S") != 0) continue;
        const uint16_t crc = bitwise(frame->bytes, frame->length - 2u);
        assert_int_equal(frame->bytes[frame->length - 2], crc & 0xFF);
        assert_int_equal(frame->bytes[frame->length - 1], crc >> 8);
        frames += (crc & 0xFF) != crc >> 8; /* all that can tell the two apart */
    }
    assert_int_equal(frames, 15);
}

TEST(the_appendix_has_197_entries_of_256_in_auchcrchi)
{
    unsigned wrong = 0, first_wrong = 256;
    assert_int_equal(sizeof printed_auchCRCHi, 197);
    for (unsigned i = 0; i != 256; i++) {
        const uint8_t byte = (uint8_t)i;
        unsigned crc = i; /* an entry is what a byte makes of a CRC of 0 */
        for (unsigned bit = 0; bit != 8; bit++) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
        /* what is called Hi there goes first on the wire: the low byte */
        if (i >= sizeof printed_auchCRCHi || printed_auchCRCHi[i] != (crc & 0xFF)) {
            if (wrong++ == 0) first_wrong = i;
        }
        assert_int_equal(fathom_crc16(&byte, 1), bitwise(&byte, 1)); /* ours has all 256 */
    }
    assert_true(wrong >= 256 - 197);
    assert_int_equal(first_wrong, 106); /* the stray C0 */
}

/* Two bytes take every entry of a table into every other: 65536 of them, bit by bit. */
TEST(our_crc_is_that_of_the_polynomial_for_every_pair_of_bytes)
{
    for (uint32_t i = 0; i != 65536; i++) {
        const uint8_t pair[] = {(uint8_t)(i >> 8), (uint8_t)(i & 0xFF)};
        assert_int_equal(fathom_crc16(pair, 2), bitwise(pair, 2));
    }
}

/* Its main() calls crc16 under "Implementation_1" and CRC16 under "Implementation_2", which are the second and the first
 * in the text above, and prints FF69 BEE5 ... for the former: that is the order on the wire. The register has 69FF. */
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

/* ---- counts ---- */

/* 2.2.4.3 has 1..0x78 for the request and 1..0x7B for its answer; the Modbus application protocol has 0x7B. */
TEST(a_write_of_many_takes_1_to_7b_registers_and_not_78)
{
    static uint16_t values[130];
    fathom_modbus_message_t message;
    for (unsigned count = 0; count != 130; count++) {
        fathom_modbus_write_multiple_registers(&message, 1, 0x0020, (uint8_t)count, values);
        assert_int_equal(fathom_modbus_rtu_room(&message), count >= 1 && count <= 0x7B ? 9 + 2 * count : 0);
    }
}

/* Table 4 has 0..252 bytes of data and table 7 0..256; a frame has 256 bytes in all: address, function, 252, CRC. */
TEST(data_are_252_bytes_at_most_and_not_256)
{
    static uint16_t values[130];
    fathom_modbus_message_t message;
    unsigned most = 0;
    for (unsigned count = 0; count != 130; count++) {
        fathom_modbus_write_multiple_registers(&message, 1, 0x0020, (uint8_t)count, values);
        const unsigned data = fathom_modbus_rtu_room(&message);
        if (data > most) most = data;
        fathom_modbus_read_holding_registers(&message, 1, 0x0020, (uint8_t)count, values);
        const unsigned read = fathom_modbus_rtu_room(&message);
        if (read > most) most = read;
    }
    assert_true(most - 4 <= 252);
    assert_int_equal(most - 4, 251); /* 123 registers to write, or 125 to read */
}

/* ---- text ---- */

/* Note *2 speaks of more than 20 meters, and the range ends at 18: what lies beyond is believed up to 30 m and no
 * further, so that a unit which does see farther is not called broken. */
TEST(note_2_says_20_meters_where_the_range_ends_at_18)
{
    static const uint16_t distances[][2] = {{18000, FATHOM_TARGET},
                                            {18001, FATHOM_TARGET},
                                            {20001, FATHOM_TARGET},
                                            {30000, FATHOM_TARGET},
                                            {30001, 0}};
    for (unsigned i = 0; i != 5; i++) {
        const uint16_t registers[4] = {distances[i][0], 0xDCB2, 0x0701, 0};
        fathom_sample_t sample;
        const bool is_good = distances[i][1] != 0;
        assert_int_equal(fathom_hps167s_decode(registers, &sample),
                         is_good ? FATHOM_READY : FATHOM_ERR_MALFORMED);
        if (is_good) assert_int_equal(sample.distance_mm, distances[i][0]);
    }
}

/* Table 28 is the answer to #10 and is called that of the baud rate: its register is 0012, the baud rate's 0011. */
TEST(table_28_is_titled_baud_rate_and_is_the_measurement_mode)
{
    unsigned found = 0;
    for (unsigned i = 0; i != MODBUS_ROWS; i++) {
        const modbus_vector_t *const row = &modbus_vectors[i];
        if (strcmp(row->frame.source, "HPS tables 27 28") == 0) found += row->meaning.address == 0x0012;
        if (strcmp(row->frame.source, "HPS tables 25 26") == 0) found += row->meaning.address == 0x0011;
    }
    assert_int_equal(found, 2);
}
