/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

enum { PATIENCE = 100000 };

desk_t desk;

static uint32_t start_us;
static uint32_t loop_us;

int desk_set_up(void **state)
{
    memset(&desk, 0x5A, sizeof desk);
    fake_modbus_init(&desk.fake);
    desk.fake.now_us = start_us;
    desk.step_us = loop_us;
    memset(&desk.config, 0, sizeof desk.config);
    desk.config.modbus = &desk.fake.modbus;
    desk.config.clock = &desk.fake.clock;
    return 0;
}

void desk_start(void)
{
    assert_int_equal(fathom_hps167s_init(&desk.hps, &desk.config), FATHOM_READY);
    desk.sensor = fathom_hps167s_sensor(&desk.hps);
}

static void answer(const row_t *row)
{
    const fathom_modbus_request_t *const request = desk.fake.request;
    const fathom_line_settings_t *const settings = request->exchange.settings;
    assert_memory_equal(request->message.head, row->head, sizeof row->head);
    assert_int_equal(settings != NULL ? settings->baud : 0, row->baud);
    if (settings != NULL) {
        assert_int_equal(settings->parity, FATHOM_PARITY_EVEN);
        assert_int_equal(settings->stop_bits, 1);
    }
    if (row->head[1] == 0x10) assert_memory_equal(request->message.values, row->values, 4);
    if (row->ends == FATHOM_ERR_EXCEPTION)
        fake_modbus_refuse(&desk.fake, (uint8_t)row->values[0]);
    else if (row->ends != FATHOM_READY)
        fake_modbus_fail(&desk.fake, row->ends);
    else if (row->head[1] == 0x03)
        fake_modbus_answer(&desk.fake, row->values, row->head[5]);
    else
        fake_modbus_acknowledge(&desk.fake);
}

fathom_status_t desk_play(fathom_status_t (*command)(void), const row_t *rows, unsigned count)
{
    unsigned asked = 0;
    for (uint32_t i = 0; i != PATIENCE; i++) {
        desk.fake.now_us += desk.step_us;
        const fathom_status_t status = command();
        if (status != FATHOM_PENDING) {
            assert_int_equal(asked, count);
            return status;
        }
        if (desk.fake.request == NULL || desk.fake.ends != FATHOM_PENDING) continue;
        assert_in_range(asked, 0, count - 1);
        answer(&rows[asked++]);
        desk.fake.submits = 0;
    }
    fail_msg("it does not end");
    return FATHOM_PENDING;
}

fathom_status_t desk_poll(void)
{
    memset(&desk.sample, DESK_GUARD, sizeof desk.sample);
    return fathom_poll(&desk.sensor, &desk.sample);
}

void desk_start_at(uint8_t address, const fathom_line_settings_t *settings)
{
    desk_set_up(NULL);
    desk.config.address = address;
    desk.config.settings = settings;
    desk_start();
}

void desk_asks(uint8_t unit, uint32_t baud)
{
    desk.fake.now_us += 3000000;
    assert_int_equal(desk_poll(), FATHOM_PENDING);
    assert_non_null(desk.fake.request);
    fake_modbus_assert_asked(&desk.fake, desk.fake.submits, unit, 0x0008, 4);
    const fathom_line_settings_t *const settings = desk.fake.request->exchange.settings;
    assert_int_equal(settings != NULL ? settings->baud : 0, baud);
}

void desk_answers(void)
{
    static const uint16_t measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};
    fake_modbus_answer(&desk.fake, measured, 4);
    assert_int_equal(desk_poll(), FATHOM_READY);
    assert_int_equal(desk.sample.distance_mm, 2083);
}

void desk_is_silent(fathom_status_t as)
{
    fake_modbus_fail(&desk.fake, FATHOM_ERR_NO_ANSWER);
    assert_int_equal(desk_poll(), as);
}

void desk_assert_guard(const void *object, size_t size)
{
    for (size_t i = 0; i != size; i++) assert_int_equal(((const uint8_t *)object)[i], DESK_GUARD);
}

void desk_begin_round(unsigned round)
{
    start_us = round / 2 != 0 ? 0xFFFFF000u : 5000;
    loop_us = round % 2 != 0 ? 20000 : 1000;
}
