/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"

enum { T3_5_US = 3646, GAP_US = 5000 };

rig_t rig;

static bool get_level(void *ctx)
{
    (void)ctx;
    while (rig.edge != rig.edges && (int32_t)(rig.fake.now_us - rig.edges_us[rig.edge]) >= 0) {
        rig.level = !rig.level;
        rig.edge++;
    }
    return rig.level;
}

void rig_start(uint32_t now_us)
{
    memset(&rig, 0, sizeof rig);
    fake_init(&rig.fake);
    rig.fake.now_us = now_us;
    rig.fake.busy_until_us = now_us;
    rig.pin.get = get_level;
    rig.line_parts = (fathom_line_parts_t){.uart = &rig.fake.uart,
                                           .clock = &rig.fake.clock,
                                           .frame = rig.frame,
                                           .frame_size = sizeof rig.frame,
                                           .echo = FATHOM_LINE_ECHO_AUTO,
                                           .silence_us = T3_5_US,
                                           .gap_us = GAP_US,
                                           .find_echo = fathom_line_find_echo,
                                           .marks = fathom_line_marks,
                                           .senders = &fathom_line_senders};
    assert_int_equal(fathom_line_init(&rig.line, &rig.line_parts), FATHOM_OK);
}

void rig_turn(uint32_t in_us)
{
    assert_true(rig.edges < RIG_EDGES);
    rig.edges_us[rig.edges++] = rig.fake.now_us + in_us;
}

void rig_expect(unsigned samples, uint8_t kind)
{
    assert_int_equal(rig.samples, samples);
    assert_int_equal(rig.sample.kind, kind);
    assert_int_equal(rig.sample.sequence, (uint16_t)samples);
}

fathom_status_t rig_poll(void)
{
    const fathom_status_t status = checked_poll(&rig.sensor, &rig.sample);
    if (status == FATHOM_OK) {
        assert_in_range(rig.sample.probe, 1, 4);
        rig.last[rig.sample.probe - 1] = rig.sample;
        rig.samples++;
    }
    rig.stales += status == FATHOM_ERR_STALE;
    rig.damaged += status == FATHOM_ERR_CHECKSUM;
    rig.malformed += status == FATHOM_ERR_MALFORMED;
    rig.ports += status == FATHOM_ERR_PORT;
    return status;
}

void rig_run(uint32_t for_us, uint32_t step_us)
{
    for (uint32_t passed_us = 0; passed_us < for_us; passed_us += step_us) {
        rig.fake.now_us += step_us;
        fathom_status_t status;
        do status = rig_poll();
        while (status == FATHOM_OK || status == FATHOM_ERR_MALFORMED);
    }
}

fathom_status_t rig_transaction(fathom_status_t (*call)(void), const uint8_t *request, size_t request_length,
                                const uint8_t *response, size_t length)
{
    fathom_status_t status = FATHOM_PENDING;
    const size_t before = rig.fake.written;
    rig.fake.byte_us = RIG_BYTE_US;
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms < 500);
        rig.fake.now_us += 1000;
        status = call();
        if (ms == 300) fake_trickle(&rig.fake, 0, RIG_BYTE_US, response, length);
    }
    assert_int_equal(rig.fake.written, before + 1);
    assert_int_equal(rig.fake.writes[before].length, request_length);
    assert_memory_equal(rig.fake.writes[before].bytes, request, request_length);
    return status;
}

fathom_status_t rig_send(const uint8_t *frame, size_t length, uint32_t step_us)
{
    const uint32_t period_us = RIG_PERIOD_US - rig.silent_us;
    const unsigned samples = rig.samples;
    const unsigned malformed = rig.malformed;
    fake_trickle(&rig.fake, period_us - (uint32_t)length * RIG_BYTE_US, RIG_BYTE_US, frame, length);
    rig.silent_us = RIG_GAP_US;
    rig_run(period_us + RIG_GAP_US, step_us);
    if (rig.samples != samples) return FATHOM_OK;
    return rig.malformed != malformed ? FATHOM_ERR_MALFORMED : FATHOM_PENDING;
}

size_t rig_dyp_stream(uint8_t *frame, const uint16_t *values, unsigned count)
{
    unsigned sum = frame[0] = 0xFF;
    for (unsigned i = 0; i != count; i++) {
        frame[1 + 2 * i] = HIGH(values[i]);
        frame[2 + 2 * i] = LOW(values[i]);
        sum += values[i] / 256u + values[i] % 256u;
    }
    frame[1 + 2 * count] = LOW(sum);
    return 2 + 2 * count;
}

void rig_hps_seal(uint8_t *frame)
{
    unsigned crc = 0xFFFF;
    for (unsigned i = 0; i != RIG_HPS_LENGTH - 2; i++) {
        crc ^= frame[i];
        for (unsigned bit = 0; bit != 8; bit++) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
    }
    frame[RIG_HPS_LENGTH - 2] = LOW(crc);
    frame[RIG_HPS_LENGTH - 1] = HIGH(crc);
}

void rig_hps_frame(uint8_t *frame, uint8_t address, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    const uint16_t values[] = {a, b, c, d};
    frame[0] = address;
    frame[1] = 0x03;
    frame[2] = 0x08;
    for (unsigned i = 0; i != 4; i++) {
        frame[3 + 2 * i] = HIGH(values[i]);
        frame[4 + 2 * i] = LOW(values[i]);
    }
    rig_hps_seal(frame);
}

uint16_t rig_hps167_crc(const uint8_t *bytes, size_t length)
{
    uint32_t crc = 0xFFFF;
    for (size_t i = 0; i != length * 8; i++) {
        crc = crc << 1 ^ ((crc >> 15 ^ bytes[i / 8] >> (7 - i % 8)) % 2 != 0 ? 0x1021u : 0u);
        crc %= 0x10000u;
    }
    return (uint16_t)crc;
}

void rig_hps167_frame(uint8_t *frame, uint16_t a, uint16_t b, uint16_t c, uint16_t d)
{
    const uint8_t bytes[] = {0x0A,    0x0D,   0x01,    0x01,   0x01,    HIGH(a), LOW(a),
                             HIGH(b), LOW(b), HIGH(c), LOW(c), HIGH(d), LOW(d)};
    const uint16_t crc = rig_hps167_crc(bytes + 2, 11);
    memcpy(frame, bytes, sizeof bytes);
    frame[13] = HIGH(crc);
    frame[14] = LOW(crc);
}

controlled_t controlled;

const uint8_t controlled_1953[4] = {0xFF, 0x07, 0xA1, 0xA7};
const uint8_t controlled_511[4] = {0xFF, 0x01, 0xFF, 0xFF};

fathom_status_t controlled_init(void)
{
    return fathom_a16_controlled_init(&controlled.a16, &rig.line, &controlled.trigger, &controlled.config);
}

void controlled_start_at(uint32_t now_us)
{
    rig_start(now_us);
    fake_pin_init(&controlled.pin, &rig.fake);
    memset(&controlled.a16, 0x5A, sizeof controlled.a16);
    assert_int_equal(controlled_init(), FATHOM_OK);
    rig.sensor = fathom_a16_controlled_sensor(&controlled.a16);
}

void controlled_start(void) { controlled_start_at(RIG_START_US); }

int controlled_set_up(void **state)
{
    controlled.model = fathom_a16_controlled_model;
    controlled.config = (fathom_a16_controlled_config_t){.model = &controlled.model};
    controlled.trigger = fathom_output_line_break(&rig.line);
    controlled_start();
    return 0;
}

void controlled_run_to_break(unsigned breaks, uint32_t step_us)
{
    for (unsigned polls = 0; rig.fake.breaks != breaks; polls++) {
        assert_true(polls < 20000);
        rig.fake.now_us += step_us;
        rig_poll();
    }
}

void controlled_response(const uint8_t frame[4], uint32_t after_us)
{
    fake_trickle(&rig.fake, after_us - FRAME_US, RIG_BYTE_US, frame, 4);
}

fathom_status_t controlled_outcome(uint32_t step_us)
{
    const unsigned breaks = rig.fake.breaks;
    for (unsigned polls = 0; polls < 20000; polls++) {
        rig.fake.now_us += step_us;
        const fathom_status_t status = rig_poll();
        if (status != FATHOM_PENDING) return status;
        assert_int_equal(rig.fake.breaks, breaks);
    }
    fail_msg("nothing came of the trigger");
    return FATHOM_PENDING;
}
