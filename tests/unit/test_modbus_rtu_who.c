/* SPDX-License-Identifier: MIT */
#include "suite.h"

#include "fathom/codec/modbus_rtu.h"

/* modbus_rtu.h, FATHOM_MODBUS_ANY_UNIT: "where one answers, message.head[0] becomes its address". */

TEST(after_a_refusal_or_another_response_it_is_still_a_request_to_any_unit)
{
    static const uint8_t exception[] = {0x05, 0x83, 0x02, 0x81, 0x30};
    static const uint8_t two[] = {0x05, 0x03, 0x04, 0x02, 0xF2, 0x02, 0xF2, 0x00, 0x00};
    uint16_t value = 0;
    fathom_modbus_message_t message;
    fathom_modbus_read_holding_registers(&message, FATHOM_MODBUS_ANY_UNIT, 0x0100, 1, &value);
    assert_int_equal(fathom_modbus_rtu_parse_response(&message, exception), FATHOM_ERR_EXCEPTION);
    assert_int_equal(message.head[0], 255);
    assert_int_equal(fathom_modbus_rtu_parse_response(&message, two), FATHOM_ERR_MALFORMED);
    assert_int_equal(message.head[0], 255);
}
