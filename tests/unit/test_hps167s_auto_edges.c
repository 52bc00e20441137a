/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/sensor/hps167s_auto.h"

/* hps167s_auto.h: where a frame begins, and when there has been none. */

static fathom_hps167s_auto_t hps;
static fathom_hps167s_auto_config_t config;
static fathom_sensor_t sensor;
static fathom_sample_t sample;

/* The example of #5. Without its first byte, the address, it is no frame. */
static const uint8_t example[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                  0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};

static int begin(void **state)
{
    set_up(state);
    config = (fathom_hps167s_auto_config_t){0};
    memset(&hps, 0x01, sizeof hps);
    assert_int_equal(fathom_hps167s_auto_init(&hps, &bench.line, &config), FATHOM_OK);
    sensor = fathom_hps167s_auto_sensor(&hps);
    assert_int_equal(fathom_poll(&sensor, &sample), FATHOM_PENDING); /* the port is seen empty */
    return 0;
}

static const suite_t suite = {.set_up = begin};

static fathom_status_t poll_after(uint32_t us)
{
    bench.fake.now_us += us;
    return fathom_poll(&sensor, &sample);
}

static fathom_status_t comes(const uint8_t *bytes, size_t length)
{
    receive(bytes, length);
    return poll_after(100);
}

/* A line whose buffer holds no frame is refused. */
TEST(the_buffer_of_the_line_holds_13_bytes)
{
    bench.config.frame_size = 12;
    assert_int_equal(fathom_hps167s_auto_init(&hps, &bench.line, &config), FATHOM_ERR_ARGUMENT);
    bench.config.frame_size = 13;
    assert_int_equal(fathom_hps167s_auto_init(&hps, &bench.line, &config), FATHOM_OK);
}

/* 12 bytes of a frame without the first: none can be in a frame, but the last 01 may begin one; a wrong CRC: 41 for 42.
 * Each byte ends in a frame, is dropped, or is held. */
TEST(dropped_bytes_and_damaged_frames_are_counted)
{
    static const uint8_t wrong[] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                    0x07, 0x01, 0x00, 0x00, 0xFD, 0x42};
    assert_int_equal(comes(example, 13), FATHOM_OK);
    assert_int_equal(hps.dropped_bytes, 0);
    assert_int_equal(comes(example + 1, 12), FATHOM_PENDING);
    assert_int_equal(hps.dropped_bytes, 12);
    assert_int_equal(hps.damaged, 0);
    for (unsigned i = 1; i <= 3; i++) {
        assert_int_equal(comes(wrong, 13), FATHOM_PENDING);
        assert_int_equal(hps.damaged, i);
        assert_int_equal(hps.dropped_bytes, 12 + 13 * i);
    }
    assert_int_equal(comes(example, 5), FATHOM_PENDING);
    assert_int_equal(hps.dropped_bytes, 12 + 13 * 3); /* 5 are held */
    fake_receive_rx(&bench.fake, 0, example, 13, (fathom_rx_t){0, FATHOM_RX_OVERRUN});
    assert_int_equal(poll_after(100), FATHOM_OK);
    assert_int_equal(hps.dropped_bytes, 12 + 13 * 3 + 5);
    hps.dropped_bytes = hps.damaged = UINT16_MAX;
    assert_int_equal(comes(wrong, 13), FATHOM_PENDING);
    assert_int_equal(hps.damaged, UINT16_MAX);
    assert_int_equal(hps.dropped_bytes, UINT16_MAX);
}

/* "stale_us; 0: 2 s". */
TEST(without_a_frame_it_is_stale_after_2_s_by_default)
{
    assert_int_equal(poll_after(1999999), FATHOM_PENDING);
    assert_int_equal(poll_after(1), FATHOM_ERR_STALE);
}
