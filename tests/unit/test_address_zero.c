/* SPDX-License-Identifier: MIT */
#include "desk.h"
#include "fathom/sensor/a05_modbus.h"
#include "fathom/sensor/a16_settings.h"
#include "line_bench.h"

/* Addresses 00 and FF of A16 and A05: "0x00~0xFE", and "0xFF is the broadcast address" (A16 6(3), A05 3(3)). */

static const suite_t suite = {.set_up = set_up};

/* ---- on the line ---- */

TEST(a_frame_of_unit_0_is_noise_where_it_has_not_been_asked)
{
    ask_1_and_send(0);
    deliver_response(0, 111);
    run(GAP_US);
    expect_count(FATHOM_LINE_STRAYS, 0);
    expect_count(FATHOM_LINE_DROPPED_BYTES, 7);
}

TEST(a_unit_0_that_does_not_answer_is_quarantined_and_asked_again)
{
    ask(&bench.request, 0, &bench.value, 1);
    run(REQUEST_US + TIMEOUT_US);
    expect_written(1);
    run(TIMEOUT_US + REQUEST_US);
    expect_written(2);
    deliver_response(0, 333);
    expect_mm(333);
}

/* ---- the one device on a line ---- */

static fathom_dyp_modbus_find_t sought;
static uint8_t address;
static fathom_modbus_t client;

static int set_up_find(void **state)
{
    (void)set_up(state);
    memset(&sought, 0, sizeof sought);
    client = fathom_modbus_client_with_zero(&bench.line);
    address = 0xA5;
    return 0;
}

static const suite_t finding = {.set_up = set_up_find};

static fathom_status_t find(void) { return fathom_dyp_modbus_find(&sought, &client, &address); }

static fathom_status_t find_after(uint32_t us)
{
    bench.fake.now_us += us;
    return find();
}

/* Asks: FF 03 02 00 00 01 and its CRC, which is a read. */
static void seek(unsigned before)
{
    static const uint8_t head[] = {0xFF, 0x03, 0x02, 0x00, 0x00, 0x01};
    assert_int_equal(find(), FATHOM_PENDING);
    run(REQUEST_US);
    expect_written(before + 1);
    assert_memory_equal(bench.fake.writes[before].bytes, head, sizeof head);
    assert_int_equal(find(), FATHOM_PENDING);
}

TEST_IN(finding, the_one_device_on_a_line_is_found_at_any_address)
{
    for (unsigned from = 0; from != 255; from++) {
        set_up_find(state);
        seek(0);
        receive_response((uint8_t)from, 0xFFFF); /* what it says is not looked at */
        assert_int_equal(find_after(100), FATHOM_OK);
        assert_int_equal(address, from);
    }
}

TEST_IN(finding, one_that_answers_from_255_says_where_it_is)
{
    static const struct {
        uint16_t says;
        fathom_status_t status;
    } rows[] = {{7, FATHOM_OK},
                {0, FATHOM_OK},
                {254, FATHOM_OK},
                {255, FATHOM_ERR_MALFORMED},
                {256, FATHOM_ERR_MALFORMED}};
    for (unsigned i = 0; i != COUNT_OF(rows); i++) {
        set_up_find(state);
        seek(0);
        receive_response(255, rows[i].says);
        assert_int_equal(find_after(100), rows[i].status);
        assert_int_equal(address, rows[i].status == FATHOM_OK ? rows[i].says : 0xA5);
    }
}

TEST_IN(finding, each_outcome_of_finding_comes_once)
{
    seek(0);
    run(1000000 + 1000);
    assert_int_equal(find(), FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(find(), FATHOM_PENDING); /* asked anew, once no unit is quarantined */
    run(1000000);
    expect_written(2);
    fathom_dyp_modbus_find_cancel(&sought, &client);
    assert_null(bench.line.head);
    client.line = NULL; /* there is nothing to cancel */
    fathom_dyp_modbus_find_cancel(&sought, &client);
    client.line = &bench.line;
    assert_int_equal(find(), FATHOM_PENDING);
    bench.fake.read_fails = true;
    assert_int_equal(find_after(100), FATHOM_ERR_PORT);
    assert_int_equal(address, 0xA5);
}

TEST_IN(finding, a_line_that_is_initialised_again_ends_it)
{
    seek(0);
    assert_int_equal(fathom_line_init(&bench.line, &bench.config), FATHOM_OK);
    assert_int_equal(find(), FATHOM_ERR_CANCELLED);
    assert_int_equal(address, 0xA5);
    show_empty_port();
    seek(1);
    receive_response(7, 0xFFFF);
    assert_int_equal(find_after(100), FATHOM_OK);
    assert_int_equal(address, 7);
}

TEST_IN(finding, what_the_transport_refuses_is_said)
{
    bench.line.parts = &(const fathom_line_parts_t){
        .uart = &bench.fake.uart, .clock = &bench.fake.clock, .frame = bench.frame, .frame_size = 7};
    assert_int_equal(find(), FATHOM_ERR_CAPACITY);
    assert_false(sought.is_asked);
}

/* ---- the drivers ---- */

enum { OK = FATHOM_OK, SILENT = FATHOM_ERR_NO_RESPONSE };

static fathom_a16_modbus_t a16;
static fathom_a05_modbus_t a05;

static int set_up_drivers(void **state)
{
    desk_begin(5000);
    assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, NULL), FATHOM_OK);
    const fathom_a05_modbus_config_t its = {.probes = 1};
    assert_int_equal(fathom_a05_modbus_init(&a05, &fake.modbus, &its), FATHOM_OK);
    desk.sensor = fathom_a16_modbus_sensor(&a16);
    return 0;
}

static const suite_t driving = {.set_up = set_up_drivers};

static uint8_t read_address;
static fathom_status_t get_a16(void) { return fathom_a16_modbus_get_address(&a16, &read_address); }
static fathom_status_t move_a16(void) { return fathom_a16_modbus_set_address_0(&a16); }
static fathom_status_t move_a05(void) { return fathom_a05_modbus_set_address_0(&a05); }

TEST_IN(driving, a_sensor_at_address_0_is_read_and_never_written)
{
    read_address = 0xA5;
    fathom_a16_modbus_config_t config = {.modbus.address_zero = true};
    assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, &config), FATHOM_OK);
    PLAY(desk_poll, OK, READ(0, 0x0100, OK, 754));
    assert_int_equal(desk.sample.address, 0);
    assert_int_equal(desk.sample.distance_mm, 754);
    assert_int_equal(fathom_a16_modbus_set_address(&a16, 5), FATHOM_ERR_ARGUMENT);
    assert_int_equal(fathom_a16_modbus_set_switch_threshold_mm(&a16, 500), FATHOM_ERR_ARGUMENT);
    assert_int_equal(move_a16(), FATHOM_ERR_ARGUMENT);
    assert_null(fake.request);
    PLAY(get_a16, OK, READ(0, 0x0200, OK, 0));
    assert_int_equal(read_address, 0);

    config.modbus.address = 1;
    assert_int_equal(fathom_a16_modbus_init(&a16, &fake.modbus, &config), FATHOM_ERR_ARGUMENT);
    const fathom_a05_modbus_config_t its = {.probes = 1, .modbus.address_zero = true};
    assert_int_equal(fathom_a05_modbus_init(&a05, &fake.modbus, &its), FATHOM_OK);
    desk.sensor = fathom_a05_modbus_sensor(&a05);
    PLAY(desk_poll, OK, READ(0, 0x0106, OK, 1000));
}

TEST_IN(driving, the_address_is_set_to_0_by_a_function_that_says_what_may_come_of_it)
{
    assert_int_equal(fathom_a16_modbus_set_address(&a16, 0), FATHOM_ERR_ARGUMENT);
    PLAY(move_a16, OK, READ(1, 0x0200, OK, 1), READ(0, 0x0200, SILENT, 0), WRITE(1, 0x0200, 0, OK),
         READ(0, 0x0200, OK, 0));
    PLAY(desk_poll, OK, READ(0, 0x0100, OK, 754));
    PLAY(move_a05, FATHOM_ERR_UNCONFIRMED, READ(1, 0x0200, OK, 1), READ(0, 0x0200, SILENT, 0),
         WRITE(1, 0x0200, 0, OK), READ(0, 0x0200, SILENT, 0), READ(1, 0x0200, SILENT, 0));
    PLAY(move_a05, FATHOM_ERR_IN_USE, READ(1, 0x0200, OK, 1), READ(0, 0x0200, OK, 0));
}
