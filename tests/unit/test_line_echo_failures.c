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

/* FATHOM_ERR_CHECKSUM: "a response from the unit was damaged". */
TEST(a_damaged_response_behind_one_copy_is_a_checksum_error)
{
    static const uint8_t damaged[] = {0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x70};
    write_on(state, FATHOM_LINE_ECHO_AUTO);
    come_at_once(set_address_5, sizeof set_address_5);
    come_at_once(damaged, sizeof damaged);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_CHECKSUM);
}

/* FATHOM_ERR_MALFORMED: "the unit sent something else with a right checksum". */
TEST(another_response_behind_one_copy_is_malformed)
{
    write_on(state, FATHOM_LINE_ECHO_AUTO);
    come_at_once(set_address_5, sizeof set_address_5);
    come_at_once(response_1_754, sizeof response_1_754);
    run(TIMEOUT_US);
    assert_int_equal(status_of(&bench.request), FATHOM_ERR_MALFORMED);
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

/* The echo belongs to the transaction: fathom_listener_t takes "the bytes that belong to no transaction", and
 * DROPPED_BYTES counts what "belonged to no frame". */
static unsigned heard;

static void hear(fathom_listener_t *listener, const uint8_t *bytes, uint8_t count, bool after_gap,
                 uint32_t time_us)
{
    (void)listener, (void)bytes, (void)after_gap, (void)time_us;
    heard += count;
}

static void echoed_write(void **state, fathom_listener_t *listener, uint8_t echo)
{
    write_on(state, echo);
    heard = 0;
    (void)fathom_line_replace_listener(&bench.line, listener);
    come_at_once(set_address_5, sizeof set_address_5);
    assert_int_equal(status_of(&bench.request), FATHOM_PENDING);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
    assert_int_equal(heard, 0);
    come_at_once(set_address_5, sizeof set_address_5);
    assert_int_equal(status_of(&bench.request), FATHOM_OK);
    assert_int_equal(counter(FATHOM_LINE_DROPPED_BYTES), 0);
    assert_int_equal(heard, 0);
}

TEST(no_byte_of_a_writes_echo_is_dropped)
{
    echoed_write(state, NULL, FATHOM_LINE_ECHO_AUTO);
    echoed_write(state, NULL, FATHOM_LINE_ECHO_ON);
}

TEST(no_byte_of_a_writes_echo_goes_to_the_listener)
{
    fathom_listener_t listener = {.receive = hear, .gap_us = 2000};
    echoed_write(state, &listener, FATHOM_LINE_ECHO_AUTO);
    echoed_write(state, &listener, FATHOM_LINE_ECHO_ON);
}
