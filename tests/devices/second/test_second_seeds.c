/* SPDX-License-Identifier: MIT */
/* What holds for all seeds. */
#include "second_host.h"

#include "second_device.h" /* the check codes */

static bool checked_frame(const second_event_t *event, bool odd_sum)
{
    if (event->raw[0] == 0xFF && event->raw_len != 0 && event->function == 0) { /* an automatic frame */
        size_t skip = event->raw[1] == 0xFF && event->raw_len == 5 ? 1 : 0;
        size_t sum = (size_t)event->raw_len - 1;
        return second_wire_sum8(event->raw + skip, sum - skip) == event->raw[sum];
    }
    if (event->raw[0] == 0x55 && event->raw[1] == 0xAA)
        return odd_sum || second_wire_sum8(event->raw, event->raw_len - 1U) == event->raw[event->raw_len - 1];
    return second_wire_crc16(event->raw, event->raw_len) == 0;
}

static const char *request_of(second_kind_t kind)
{
    static const char *const requests[SECOND_KINDS] = {
        [SECOND_A16_RS232] = "01 03 01 01 00 01", [SECOND_A16_RS485] = "01 03 01 00 00 01",
        [SECOND_A05_UART] = "01 03 01 06 00 04",  [SECOND_A05_RS485] = "01 03 01 06 00 04",
        [SECOND_HPS167S] = "01 03 00 08 00 04",
    };
    return requests[kind];
}

static void live(host_t *h, second_kind_t kind, uint64_t seed, uint64_t step_us)
{
    second_config_t config = {
        .kind = kind, .seed = seed, .fitted = (uint8_t)(1 + seed % 15), .scene = {{1500, 2500, 3500, 4500}}};
    host_open(h, &config);
    h->step_us = step_us;
    h->line = second_state(&h->device[0]).line;
    host_power(h, true);
    host_run(h, 9000000);
    second_scene_t scene = {{SECOND_NOTHING, 700, 90000, 40}};
    for (int i = 0; i < 4; i++) {
        if (request_of(kind) != NULL) {
            host_request(h, request_of(kind));
        } else {
            second_rx_level(&h->device[0], true, h->now_us + 10);
            second_rx_level(&h->device[0], false, h->now_us + 2000);
        }
        host_run(h, h->now_us + 600000);
        if (i == 2) second_scene(&h->device[0], &scene, h->now_us);
    }
    host_power(h, false);
    host_run(h, h->now_us + 100000);
}

/* Bytes follow each other, frames carry the right check codes, the log tells what was on the wire. */
TEST(all_seeds_keep_the_wire_in_order)
{
    for (int kind = 0; kind < SECOND_TALKERS; kind++) {
        size_t frames = 0;
        for (uint64_t seed = 1; seed <= 300; seed++) {
            live(&host, (second_kind_t)kind, seed, 0);
            const second_device_t *d = &host.device[0];
            for (size_t i = 1; i < host.got_len; i++) {
                assert_true(host.got[i].start_us >= host.got[i - 1].end_us);
                assert_true(host.got[i].end_us > host.got[i].start_us);
            }
            size_t at = 0;
            bool odd_sum = second_choice(d, CHOICE_a05_all_sum) != 0;
            for (uint64_t i = 0; i < second_log_count(d); i++) {
                const second_event_t *event = second_log_at(d, i);
                bool sent = event->kind == SECOND_EVENT_MEASUREMENT || event->kind == SECOND_EVENT_RESPONSE;
                if (!sent || event->end_us > second_log_at(d, second_log_count(d) - 1)->time_us) continue;
                assert_true(checked_frame(event, odd_sum));
                while (at < host.got_len && host.got[at].start_us < event->start_us) at++;
                for (size_t k = 0; k < event->raw_len; k++)
                    assert_int_equal(host.got[at + k].value, event->raw[k]);
                frames++;
            }
            assert_int_equal(second_state(d).lost, 0);
        }
        assert_true(frames > 300);
    }
}
