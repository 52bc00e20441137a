/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static fathom_status_t submitted(void) { return fathom_modbus_client_submit(&bench.line, &bench.request); }

static fathom_status_t submit_read(uint8_t unit, uint8_t count, uint16_t *values)
{
    fathom_modbus_read_holding_registers(&bench.request.message, unit, 0x0106, count, values);
    return submitted();
}

static fathom_status_t submit_write_of_many(uint8_t count, const uint16_t *values)
{
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0, count, values);
    return submitted();
}

static const suite_t suite = {.set_up = set_up};

TEST(a_count_out_of_range_is_refused)
{
    uint16_t values[4] = {0};
    assert_int_equal(submit_read(1, 0, values), FATHOM_ERR_ARGUMENT);
    assert_int_equal(submit_read(1, 126, values), FATHOM_ERR_ARGUMENT);
    assert_int_equal(submit_write_of_many(124, values), FATHOM_ERR_ARGUMENT);
    assert_null(bench.line.head);
}

TEST(every_byte_of_an_acknowledgement_counts)
{
    uint16_t values[5] = {0};
    for (size_t i = 1; i != 6; i++) {
        set_up(state);
        fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
        bench.request.message.head[i] ^=
            i == 1 ? 0x16 : 1; /* asks for something else: function 10, or one bit */
        bench.request.message.values = values;
        submit(&bench.request);
        run(40000);
        receive_all(set_address_5);
        expect_after(200, FATHOM_PENDING);
        expect_after(TIMEOUT_US, FATHOM_ERR_MALFORMED);
    }
}
