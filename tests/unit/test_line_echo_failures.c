/* SPDX-License-Identifier: MIT */
#include "echo_bench.h"

/* line.h, local echo, where something goes wrong besides. The request is a write whose response equals it (A16
 * 6(5)). */

static const suite_t suite = {.set_up = set_up};

/* The write has just left. */
static void write_on(void **state, uint8_t echo)
{
    set_up_with(echo);
    fathom_modbus_write_single_register(&bench.request.message, 1, 0x0200, 5);
    bench.request.transaction.timeout_us = TIMEOUT_US;
    bench.request.transaction.retries = 0;
    assert_int_equal(fathom_modbus_client_submit(&bench.line, &bench.request), FATHOM_PENDING);
    run_until_written(1, 100);
    run(8 * BYTE_US);
}

static void come_at_once(const uint8_t *bytes, size_t length)
{
    receive(bytes, length);
    run(100);
}

/* FATHOM_ERR_ECHO: "one copy of the request came, and the line does not know yet whether it echoes". Bytes that the
 * port marked before it do not tell. */
TEST(one_copy_behind_marked_bytes_is_no_acknowledgement)
{
    static const uint8_t flags[] = {FATHOM_RX_PARITY, FATHOM_RX_FRAMING};
    static const uint8_t marked[] = {0x00, 0xFE};
    for (unsigned i = 0; i != COUNT_OF(flags); i++) {
        write_on(state, FATHOM_LINE_ECHO_AUTO);
        fake_receive_rx(&bench.fake, 0, marked, sizeof marked, (fathom_rx_t){0, flags[i]});
        run(100);
        come_at_once(set_address_5, sizeof set_address_5);
        run(TIMEOUT_US);
        assert_int_equal(status_of(&bench.request), FATHOM_ERR_ECHO);
    }
}

TEST(one_copy_behind_an_overrun_is_no_acknowledgement)
{
    write_on(state, FATHOM_LINE_ECHO_AUTO);
    fake_receive_rx(&bench.fake, 0, set_address_5, sizeof set_address_5, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    run(TIMEOUT_US + 100);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_ECHO);
}
