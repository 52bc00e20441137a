/* SPDX-License-Identifier: MIT */
#include "hps_desk.h"

fathom_hps167s_config_t hps_config;
const fathom_modbus_t *hps_transport;
fathom_hps167s_t hps;

const fathom_line_settings_t hps_factory = {19200, FATHOM_PARITY_EVEN, 1};
const uint16_t hps_measured[4] = {0x0823, 0xDCB2, 0x0701, 0x0000};
const uint16_t hps_abnormal[4] = {0xFFFF, 0x0000, 0x00FF, 0xFFFF};

static uint32_t start_us = 5000;
static uint32_t loop_us = 1000;

int hps_set_up(void **state)
{
    desk_begin(start_us);
    desk.step_us = loop_us;
    hps_config = (fathom_hps167s_config_t){0};
    hps_transport = &fake.modbus;
    memset(&hps, 0x5A, sizeof hps);
    hps_start();
    return 0;
}

void hps_start(void)
{
    assert_int_equal(fathom_hps167s_init(&hps, hps_transport, &hps_config), FATHOM_OK);
    desk.sensor = fathom_hps167s_sensor(&hps);
}

void hps_start_at(uint8_t address, const fathom_line_settings_t *settings)
{
    hps_set_up(NULL);
    hps_config.modbus.address = address;
    hps_config.modbus.line_settings = settings;
    hps_start();
}

void hps_asks(uint8_t unit, uint32_t baud)
{
    desk_waits(3000000);
    fake_modbus_assert_asked(&fake, fake.submits, unit, 0x0008, 4);
    const fathom_line_settings_t *const settings = fake.request->transaction.line_settings;
    assert_int_equal(settings != NULL ? settings->baud : 0, baud);
}

void hps_answers(void)
{
    fake_modbus_response(&fake, hps_measured, 4);
    assert_int_equal(desk_poll(), FATHOM_OK);
    assert_int_equal(desk.sample.distance_mm, 2083);
}

void hps_is_silent(fathom_status_t as)
{
    fake_modbus_fail(&fake, FATHOM_ERR_NO_RESPONSE);
    assert_int_equal(desk_poll(), as);
}

void hps_begin_round(unsigned round)
{
    start_us = round / 2 != 0 ? 0xFFFFF000u : 5000;
    loop_us = round % 2 != 0 ? 20000 : 1000;
}
