/* SPDX-License-Identifier: MIT */
#include "auto_rig.h"

enum { T3_5_US = 3646, GAP_US = 5000 };

rig_t rig;

void rig_start(uint32_t now_us)
{
    memset(&rig, 0, sizeof rig);
    fake_init(&rig.fake);
    rig.fake.now_us = now_us;
    rig.fake.busy_until_us = now_us;
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
