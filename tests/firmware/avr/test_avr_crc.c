/* SPDX-License-Identifier: MIT */
/* The two CRCs of port/avr, with its table in program memory and without, against the definition. */
#include "suite.h"

#include "board.h"
#include "crcs.h"

static int start(void **state)
{
    board_start("crcs");
    assert_true(board_run_us(1000)); /* its memory has been cleared */
    return 0;
}

static const suite_t suite = {.set_up = start, .tear_down = board_stop};

/* MODBUS over Serial Line V1.02, 6.2.2 */
static uint16_t defined(const uint8_t *bytes, uint8_t length)
{
    uint16_t crc = 0xFFFF;
    while (length-- != 0) {
        crc ^= *bytes++;
        for (int bit = 0; bit < 8; bit++) crc = (uint16_t)((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
    return crc;
}

static void assert_crc(const uint8_t *bytes, uint8_t length, uint16_t expected)
{
    crcs_t *const asked = (crcs_t *)(void *)board_data("asked");
    memcpy(asked->bytes, bytes, length);
    asked->length = length;
    asked->go = 1;
    const board_record_t *const record = board_next_record(100000);
    assert_non_null(record);
    assert_int_equal(record->kind, CRCS_RECORD);
    assert_int_equal(record->length, 4);
    assert_int_equal(board_number(record->bytes, 2), expected);     /* without a table */
    assert_int_equal(board_number(record->bytes + 2, 2), expected); /* by the table */
}

TEST(the_examples_of_the_datasheets_have_their_crc)
{
    static const uint8_t a16[] = {0x01, 0x03, 0x01, 0x01,
                                  0x00, 0x01, 0xD4, 0x36}; /* A16 6(4), the low byte first */
    static const uint8_t hps[] = {0x01, 0x03, 0x00, 0x08, 0x00, 0x04, 0xC5, 0xCB}; /* HPS-167S #5 */
    assert_crc(a16, 6, 0x36D4);
    assert_crc(a16, 8, 0);
    assert_crc(hps, 6, 0xCBC5);
    assert_crc(hps, 8, 0);
}

TEST(every_byte_alone_and_none)
{
    assert_crc((const uint8_t *)"", 0, 0xFFFF);
    for (int i = 0; i < 256; i++) {
        const uint8_t byte = (uint8_t)i;
        assert_crc(&byte, 1, defined(&byte, 1));
    }
}

TEST(frames_of_every_length)
{
    uint8_t bytes[CRCS_BYTES];
    uint32_t random = 1;
    for (uint8_t length = 0; length <= CRCS_BYTES; length++) {
        for (uint8_t i = 0; i < length; i++)
            bytes[i] = (uint8_t)((random = random * 1103515245u + 12345u) >> 16);
        assert_crc(bytes, length, defined(bytes, length));
    }
}
