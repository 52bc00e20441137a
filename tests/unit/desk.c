/* SPDX-License-Identifier: MIT */
#include "desk.h"

enum { PATIENCE = 100000 };

fake_modbus_t fake;
desk_t desk;

void desk_begin(uint32_t now_us)
{
    fake_modbus_init(&fake);
    fake.now_us = now_us;
    memset(&desk, 0, sizeof desk);
    desk.step_us = 1000;
}

fathom_status_t desk_poll(void) { return checked_poll(&desk.sensor, &desk.sample); }

fathom_status_t desk_poll_after(uint32_t us)
{
    fake.now_us += us;
    return desk_poll();
}

void desk_waits(uint32_t us) { PENDS(desk_poll_after(us)); }

void desk_response(const row_t *row)
{
    assert_non_null(fake.request);
    const fathom_line_settings_t *const settings = fake.request->transaction.line_settings;
    assert_memory_equal(fake.request->message.head, row->head, sizeof row->head);
    assert_int_equal(settings != NULL ? settings->baud : 0, row->baud);
    if (settings != NULL) {
        assert_int_equal(settings->parity, FATHOM_PARITY_EVEN);
        assert_int_equal(settings->stop_bits, 1);
    }
    const bool is_reading = row->head[1] == 3 && (row->head[2] != 0 || row->head[3] != 9); /* HPS-167S #6 */
    assert_int_equal(fake.request->transaction.retries, is_reading ? desk.retries : 0);
    if (desk.timeout_us != 0) assert_int_equal(fake.request->transaction.timeout_us, desk.timeout_us);
    if (row->head[1] == 0x10) assert_memory_equal(fake.request->message.values, row->values, 4);
    if (row->ends == FATHOM_ERR_EXCEPTION)
        fake_modbus_refuse(&fake, (uint8_t)row->values[0]);
    else if (row->ends != FATHOM_OK)
        fake_modbus_fail(&fake, row->ends);
    else if (row->head[1] == 0x03)
        fake_modbus_response(&fake, row->values, row->head[5]);
    else
        fake_modbus_acknowledge(&fake);
}

void desk_says(uint16_t value)
{
    static uint16_t reg;
    reg = value;
    fake_modbus_response(&fake, &reg, 1);
}

void desk_part(fathom_status_t (*command)(void), const row_t *rows, unsigned count)
{
    for (uint32_t i = 0; count != 0; i++) {
        assert_true(i < PATIENCE);
        fake.now_us += desk.step_us;
        PENDS(command());
        if (fake.request == NULL || fake.ends != FATHOM_PENDING) continue;
        desk_response(rows++);
        count--;
        fake.submits = 0;
    }
}

fathom_status_t desk_play(fathom_status_t (*command)(void), const row_t *rows, unsigned count)
{
    desk_part(command, rows, count);
    for (uint32_t i = 0; i != PATIENCE; i++) {
        fake.now_us += desk.step_us;
        const fathom_status_t status = command();
        if (status != FATHOM_PENDING) return status;
        assert_true(fake.request == NULL || fake.ends != FATHOM_PENDING); /* nothing more is asked */
    }
    fail_msg("it does not end");
    return FATHOM_PENDING;
}
