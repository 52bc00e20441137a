/* SPDX-License-Identifier: MIT */
#include <stdint.h>

#include "suite.h"

#include "fathom/modbus_rtu.h"

/* HPS-167S appendix: Implementation 2 takes an "unsigned char" for the length, and a Modbus frame may have 256 bytes:
 * such a one it would take for 0 bytes. Ours has 8 bits for the length too, so it neither makes nor waits for a longer
 * frame than that can tell. */

static uint16_t values[FATHOM_MODBUS_MAX_READ];

TEST(no_request_or_answer_of_any_count_is_longer_than_8_bits_can_tell)
{
    fathom_modbus_message_t message;
    for (unsigned count = 0; count != 256; count++) {
        /* 3 bytes and a CRC around an answer to a read, but the request has 8 in all; 7 and a CRC around a write */
        const unsigned read = 5 + 2 * count > 8 ? 5 + 2 * count : 8;
        const unsigned write = 9 + 2 * count;
        fathom_modbus_read_holding_registers(&message, 1, 0, (uint8_t)count, values);
        assert_int_equal(fathom_modbus_rtu_room(&message), count != 0 && read <= 255 ? read : 0);
        fathom_modbus_write_multiple_registers(&message, 1, 0, (uint8_t)count, values);
        assert_int_equal(fathom_modbus_rtu_room(&message), count != 0 && write <= 255 ? write : 0);
    }
}

TEST(no_answer_or_request_is_waited_for_that_8_bits_cannot_tell)
{
    for (unsigned size = 0; size != 256; size++) {
        const uint8_t answer[] = {0x01, 0x03, (uint8_t)size};
        const uint8_t request[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, (uint8_t)size};
        const unsigned waited = fathom_modbus_rtu_response_length(answer, sizeof answer);
        assert_true(waited == 0 || waited == 5 + size);
        assert_true(waited != 0 || size == 0 || size % 2 != 0 || 5 + size > 255);
        const unsigned served = fathom_modbus_rtu_request_length(request, sizeof request);
        assert_true(served == 0 || served == 9 + size);
    }
}
