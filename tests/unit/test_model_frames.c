/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"
#include "fathom/engine/modbus_client.h"
#include "fathom/models.h"
#include "fathom/sensor/a05_dyp.h"
#include "fathom/sensor/a16_auto.h"

/* Public frames and logs of the models, with what their sources say. Others are read where their drivers are tested:
 * 0x0100 and 0x0101 in test_a16_settings.c, 0x0102 in test_model_facts.c, an A05 in test_a05_dyp.c, and the HPS-167 in
 * test_hps167_frames.c. */

static fathom_a16_auto_t automatic;

static void start_auto(const fathom_model_facts_t *model)
{
    const fathom_a16_auto_config_t config = {.model = model};
    rig_start(1000);
    assert_int_equal(fathom_a16_auto_init(&automatic, &rig.line, &config), FATHOM_OK);
    rig.sensor = fathom_a16_auto_sensor(&automatic);
}

TEST(the_public_frames_are_read)
{
    static const struct {
        const fathom_model_facts_t *model;
        uint8_t frame[4];
        fathom_status_t status;
        uint8_t kind;
        uint16_t mm;
    } frames[] = {
        /* DFRobot SEN0311, SEN0312; JSN-SR04T */
        {&fathom_model_a02yyuw, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        {&fathom_model_me007ys, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        {&fathom_model_jsn_sr04t_auto, {0xFF, 0x07, 0xA1, 0xA7}, FATHOM_OK, FATHOM_TARGET, 1953},
        /* a tool for the GL04; an L081 without an echo; an L041 without an echo */
        {&fathom_model_l041mtw, {0xFF, 0x07, 0x5F, 0x65}, FATHOM_OK, FATHOM_TARGET, 1887},
        {&fathom_model_l081mtw, {0xFF, 0xFF, 0xFD, 0xFB}, FATHOM_OK, FATHOM_NO_TARGET, 0},
        {&fathom_model_l041mtw, {0xFF, 0x00, 0x00, 0xFF}, FATHOM_OK, FATHOM_NO_TARGET, 0},
        /* 222 mm of an AJ-SR04M whose sum leaves FF out: no frame of the A16 */
        {&fathom_model_aj_sr04m_auto, {0xFF, 0x00, 0xDE, 0xDE}, FATHOM_PENDING, 0, 0},
        {&fathom_model_aj_sr04m_auto, {0xFF, 0x00, 0xDE, 0xDD}, FATHOM_OK, FATHOM_TARGET, 222},
    };
    for (unsigned i = 0; i != COUNT(frames); i++) {
        start_auto(frames[i].model);
        assert_int_equal(rig_send(frames[i].frame, 4, 500), frames[i].status);
        assert_int_equal(rig.samples, frames[i].status == FATHOM_OK);
        assert_int_equal(rig.sample.kind, frames[i].kind);
        assert_int_equal(rig.sample.distance_mm, frames[i].mm);
    }
}

static fathom_status_t get_distance(void) { return checked_poll(&rig.sensor, &rig.sample); }

/* ---- frames of registers that no command has, and frames of others ---- */

static fathom_modbus_request_t request;
static uint16_t value;

static fathom_status_t run_request(void)
{
    fathom_line_poll(&rig.line);
    return request.transaction.status;
}

/* The baud rate codes are 3 and 9, for 9600 and 115200. Two sheets print a CRC that does not fit: 78 42 and 18 72 do. */
TEST(the_public_frames_of_other_registers_are_read_and_those_with_a_wrong_crc_are_not)
{
    static const struct {
        uint8_t sent[8], response[8], length;
        fathom_status_t status;
        uint16_t value;
    } rows[] = {
        /* address 1 becomes 5, and the response is from the old one */
        {{1, 6, 2, 0, 0, 5, 0x48, 0x71}, {1, 6, 2, 0, 0, 5, 0x48, 0x71}, 8, FATHOM_OK, 0},
        {{5, 6, 2, 1, 0, 1, 0x19, 0xF6}, {5, 6, 2, 1, 0, 1, 0x19, 0xF6}, 8, FATHOM_OK, 0},
        {{1, 6, 2, 1, 0, 1, 0x18, 0x72}, {1, 6, 2, 1, 0, 1, 0x99, 0xB3}, 8, FATHOM_ERR_CHECKSUM, 0},
        {{1, 3, 2, 1, 0, 1, 0xD4, 0x72}, {1, 3, 2, 0, 3, 0xF8, 0x45}, 7, FATHOM_OK, 3},
        {{1, 3, 2, 1, 0, 1, 0xD4, 0x72}, {1, 3, 2, 0, 9, 0xF8, 0x45}, 7, FATHOM_ERR_CHECKSUM, 0},
        {{1, 3, 2, 1, 0, 1, 0xD4, 0x72}, {1, 3, 2, 0, 9, 0x78, 0x42}, 7, FATHOM_OK, 9},
        {{1, 3, 2, 8, 0, 1, 0x04, 0x70}, {1, 3, 2, 0, 2, 0x39, 0x85}, 7, FATHOM_OK, 2},
        /* the address of the one unit */
        {{255, 3, 2, 0, 0, 1, 0x90, 0x6C}, {1, 3, 2, 0, 1, 0x79, 0x84}, 7, FATHOM_OK, 1},
    };
    for (unsigned i = 0; i != COUNT(rows); i++) {
        const uint8_t *const sent = rows[i].sent;
        const uint16_t reg = (uint16_t)(sent[2] << 8 | sent[3]);
        rig_start(1000);
        rig.line_parts.echo = FATHOM_LINE_ECHO_OFF; /* else an acknowledgement may be an echo */
        assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
        const fathom_modbus_t transport = fathom_modbus_client(&rig.line);
        request = (fathom_modbus_request_t){.transaction.timeout_us = 400 * MS};
        value = 0;
        if (sent[1] == 3)
            fathom_modbus_read_holding_registers(&request.message, sent[0], reg, 1, &value);
        else
            fathom_modbus_write_single_register(&request.message, sent[0], reg, sent[5]);
        PENDS(transport.submit(&rig.line, &request));
        assert_int_equal(rig_transaction(run_request, sent, 8, rows[i].response, rows[i].length),
                         rows[i].status);
        assert_int_equal(value, rows[i].value);
        if (rows[i].status == FATHOM_OK) assert_int_equal(request.message.head[0], rows[i].response[0]);
    }
}

/* 202 cm of a URM07, the request to a URM06, and an A21's value over CAN: none is the response of an A05 or A16. */
TEST(the_public_frames_of_near_relatives_are_no_readings)
{
    static const uint8_t sent[] = {0x55, 0xAA, 0x11, 0x01, 0x11};
    static const uint8_t responses[][8] = {{0x55, 0xAA, 0x11, 0x02, 0x02, 0x00, 0xCA, 0xDE},
                                           {0x55, 0xAA, 0x11, 0x02, 0x02, 0x12, 0x34, 0x5A},
                                           {0x01, 0x83, 0x02, 0x02, 0xF2}};
    static fathom_a05_dyp_t a05;
    for (unsigned i = 0; i != COUNT(responses); i++) {
        const fathom_a05_dyp_config_t config = {.modbus.address = 0x11, .modbus.timeout_us = 350 * MS};
        rig_start(1000);
        assert_int_equal(fathom_a05_dyp_init(&a05, &rig.line, &config), FATHOM_OK);
        rig.sensor = fathom_a05_dyp_sensor(&a05);
        assert_true(rig_transaction(get_distance, sent, 5, responses[i], 8) < 0);
    }
}
