/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

static fathom_status_t submit_read(uint8_t unit, uint8_t count, uint16_t *values)
{
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_read_holding_registers(&bench.request.message, unit, 0x0106, count, values);
    return fathom_modbus_client_submit(&bench.line, &bench.request);
}

static const suite_t suite = {.set_up = set_up};

TEST(a_count_out_of_range_is_refused)
{
    uint16_t values[4] = {0};
    assert_int_equal(submit_read(1, 0, values), FATHOM_ERR_ARGUMENT);
    assert_int_equal(submit_read(1, 126, values), FATHOM_ERR_ARGUMENT);
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0, 124, values);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_ERR_ARGUMENT);
    assert_null(bench.line.head);
}

TEST(a_read_from_everybody_is_refused)
{
    uint16_t value = 0;
    assert_int_equal(submit_read(FATHOM_MODBUS_BROADCAST, 1, &value), FATHOM_ERR_ARGUMENT);
}

/* 13 registers are 31 bytes of answer, 14 are 33; the frame has 32. 11 written are 31 bytes, 12 are 33. */
TEST(what_does_not_fit_the_frame_is_refused)
{
    uint16_t values[14] = {0};
    assert_int_equal(submit_read(1, 14, values), FATHOM_ERR_CAPACITY);
    assert_int_equal(submit_read(1, 13, values), FATHOM_PENDING);
    fathom_modbus_client_cancel(&bench.line, &bench.request);
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0, 12, values);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_ERR_CAPACITY);
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0, 11, values);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
}

/* A05 3(4)1 example 3. */
TEST(several_registers_are_read_in_one_exchange)
{
    static const uint8_t request[] = {0x01, 0x03, 0x01, 0x07, 0x00, 0x03, 0xB5, 0xF6};
    uint16_t values[3] = {0};
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0107, 3, values);
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run(20000);
    assert_int_equal(bench.fake.writes[0].length, sizeof request);
    assert_memory_equal(bench.fake.writes[0].bytes, request, sizeof request);
    receive(answer_1_three, sizeof answer_1_three);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(values[0], 250);
    assert_int_equal(values[1], 659);
    assert_int_equal(values[2], 2426);
}

/* HPS-167S table 38: the answer to 01 10 00 20 00 02 04 .. is 01 10 00 20 00 02 40 02. */
TEST(a_write_of_many_is_acknowledged_by_start_and_count)
{
    static const uint8_t answer[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x40, 0x02};
    static const uint8_t head[] = {0x01, 0x10, 0x00, 0x20, 0x00, 0x02, 0x04, 0x00, 0x00, 0x00, 0x24};
    const uint16_t values[] = {0, 36};
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_write_multiple_registers(&bench.request.message, 1, 0x0020, 2, values);
    fathom_modbus_client_submit(&bench.line, &bench.request);
    run(30000);
    assert_int_equal(bench.fake.writes[0].length, sizeof head + 2);
    assert_memory_equal(bench.fake.writes[0].bytes, head, sizeof head);
    receive(answer, sizeof answer);
    run(100);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
}

TEST(every_byte_of_an_acknowledgement_counts)
{
    static const uint8_t answer[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71}; /* A16 6(4) example 3 */
    uint16_t values[5] = {0};
    for (size_t i = 1; i != 6; i++) {
        set_up(state);
        bench.request.exchange.timeout_us = TIMEOUT_US;
        fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
        bench.request.message.head[i] ^=
            i == 1 ? 0x16 : 1; /* asks for something else: function 10, or one bit */
        bench.request.message.values = values;
        fathom_modbus_client_submit(&bench.line, &bench.request);
        run(40000);
        receive(answer, sizeof answer);
        run(200);
        assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
        run(TIMEOUT_US);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_MALFORMED);
    }
}

TEST(the_seam_is_the_same_client)
{
    const fathom_modbus_t modbus = fathom_modbus_client(&bench.line);
    bench.request.exchange.timeout_us = TIMEOUT_US;
    fathom_modbus_read_holding_registers(&bench.request.message, 1, 0x0100, 1, &bench.value);
    assert_int_equal(modbus.submit(modbus.ctx, &bench.request), FATHOM_PENDING);
    assert_int_equal(modbus.submit(modbus.ctx, &bench.request), FATHOM_ERR_BUSY);
    modbus.poll(modbus.ctx);
    assert_int_equal(modbus.due_us(modbus.ctx), T3_5_US);
    run(20000);
    receive(answer_1_754, sizeof answer_1_754);
    modbus.poll(modbus.ctx);
    assert_int_equal(status_of(&bench.request), FATHOM_READY);
    assert_int_equal(bench.request.exchange.link.heard_us, bench.fake.now_us);
    assert_int_equal(bench.value, 754);
    modbus.submit(modbus.ctx, &bench.request);
    modbus.cancel(modbus.ctx, &bench.request);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CANCELLED);
}
