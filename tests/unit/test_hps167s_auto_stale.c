/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "suite.h"

#include "auto_rig.h"
#include "fathom/hps167s_auto.h"

/* A device that has sent measurements by itself and falls silent: the last value does not live on. */

enum { LENGTH = 13 };

static uint32_t start_us;
static uint32_t loop_us;
static fathom_hps167s_auto_t hps;

/* HPS-167S #5. Then a distance of 7918 = 31000 mm, which is none, and the first frame from unit 2, each with its CRC
 * worked out by the text of 2.2.5. */
static const uint8_t example[LENGTH] = {0x01, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2,
                                        0x07, 0x01, 0x00, 0x00, 0xFD, 0x41};
static uint8_t impossible[LENGTH] = {0x01, 0x03, 0x08, 0x79, 0x18};
static uint8_t of_unit_2[LENGTH] = {0x02, 0x03, 0x08, 0x08, 0x23, 0xDC, 0xB2, 0x07, 0x01};

static void seal(uint8_t *frame)
{
    unsigned crc = 0xFFFF;
    for (unsigned i = 0; i != LENGTH - 2; i++) {
        crc ^= frame[i];
        for (unsigned bit = 0; bit != 8; bit++) crc = (crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1;
    }
    frame[LENGTH - 2] = (uint8_t)(crc & 0xFF);
    frame[LENGTH - 1] = (uint8_t)(crc >> 8);
}

static int set_up(void **state)
{
    rig_start(start_us);
    const fathom_hps167s_auto_config_t config = {.line = &rig.line};
    memset(&hps, 0x5A, sizeof hps);
    assert_int_equal(fathom_hps167s_auto_init(&hps, &config), FATHOM_READY);
    rig.sensor = fathom_hps167s_auto_sensor(&hps);
    return 0;
}

/* In a fine loop and in one that comes round every 20 ms, and across the wrap of the clock. */
static void begin_round(unsigned round)
{
    static const uint32_t starts_us[] = {RIG_START_US, 0xFFFFFFFFu - 50000, 0xFFFFFFFFu - 1000000};
    start_us = starts_us[round / 2];
    loop_us = round % 2 != 0 ? 20000 : 1000;
    if (round != 0) return;
    seal(impossible);
    seal(of_unit_2);
}

static const suite_t suite = {.set_up = set_up, .begin_round = begin_round, .rounds = 6};

TEST(it_is_stale_2_s_after_its_last_frame_and_once_every_2_s)
{
    for (unsigned i = 0; i != 3; i++) rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 3);
    rig_run(1900000, loop_us);
    assert_int_equal(rig.stales, 0);
    rig_run(200000, loop_us);
    assert_int_equal(rig.stales, 1);
    rig_run(4000000, loop_us);
    assert_int_equal(rig.stales, 3);
    assert_int_equal(rig.samples, 3);
}

TEST(a_frame_after_that_begins_the_deadline_anew)
{
    rig_send(example, LENGTH, loop_us);
    rig_run(2100000, loop_us);
    assert_int_equal(rig.stales, 1);
    rig_send(example, LENGTH, loop_us);
    assert_int_equal(rig.samples, 2);
    rig_run(1900000, loop_us);
    assert_int_equal(rig.stales, 1);
    rig_run(200000, loop_us);
    assert_int_equal(rig.stales, 2);
}

TEST(frames_that_are_no_samples_do_not_keep_it_from_turning_stale)
{
    rig_send(example, LENGTH, loop_us);
    for (unsigned i = 0; i != 10; i++) {
        rig_send(impossible, LENGTH, loop_us);
        rig_send(of_unit_2, LENGTH, loop_us);
    }
    /* 20 frames, each 100 ms after the one before, end 2 s after the good one */
    rig_run(100000, loop_us);
    assert_int_equal(rig.samples, 1);
    assert_int_equal(rig.malformed, 10);
    assert_int_equal(rig.stales, 1);
}
