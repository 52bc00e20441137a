/* SPDX-License-Identifier: MIT */
#include "request_far_end.h"

#include <stdio.h>
#include <string.h>

far_end_t far_end;

static uint32_t far_now(void *ctx) { return far_end.now_us; }

static void come(uint8_t byte, uint32_t at_us)
{
    far_end.at_us[far_end.count] = at_us;
    far_end.coming[far_end.count++] = byte;
}

static int far_write(void *ctx, const uint8_t *bytes, size_t length)
{
    memcpy(far_end.sent + far_end.sent_length, bytes, length);
    far_end.sent_length += length;
    far_end.writes++;
    for (uint32_t i = 0; i != length && far_end.echoes; i++)
        come(bytes[i], far_end.now_us + (i + 1) * CHARACTER_US);
    far_end.leaves_us = far_end.now_us + (uint32_t)length * CHARACTER_US;
    for (uint32_t i = 0; i != far_end.length; i++)
        come(far_end.answer[i], far_end.leaves_us + far_end.delay_us + (i + 1) * CHARACTER_US);
    return (int)length;
}

static int far_read(void *ctx, uint8_t *bytes, size_t capacity, fathom_rx_t *rx)
{
    size_t n = 0;
    if (far_end.babbles && far_end.now_us / 2000 != far_end.babbled) {
        far_end.babbled = far_end.now_us / 2000;
        bytes[n++] = 0x55;
    }
    for (; n != capacity && far_end.taken != far_end.count && far_end.at_us[far_end.taken] <= far_end.now_us;
         n++)
        bytes[n] = far_end.coming[far_end.taken++];
    return (int)n;
}

static bool far_sent(void *ctx) { return far_end.now_us >= far_end.leaves_us; }

static int far_set_line(void *ctx, const fathom_line_settings_t *settings) { return 1; }

static void far_idle(void *ctx, uint32_t max_us)
{
    const uint32_t most_us = far_end.babbles ? 2000 : 10000;
    uint32_t by_us = max_us < most_us ? max_us : most_us;
    if (far_end.taken != far_end.count && far_end.at_us[far_end.taken] - far_end.now_us < by_us)
        by_us = far_end.at_us[far_end.taken] - far_end.now_us;
    far_end.now_us += by_us != 0 ? by_us : 1;
}

/* Bytes in hex, as a test writes them. */
static size_t bytes_of(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned byte;
    for (; sscanf(text, "%2x", &byte) == 1; text += text[2] == ' ' ? 3 : 2) bytes[count++] = (uint8_t)byte;
    return count;
}

void far_answers(const char *answer)
{
    memset(&far_end, 0, sizeof far_end);
    far_end.delay_us = 20000;
    far_end.length = bytes_of(answer, far_end.answer);
    far_end.tool = (tool_line_t){
        .uart = {.read = far_read, .write = far_write, .sent = far_sent, .set_line = far_set_line},
        .clock = {far_now, NULL},
        .idle = far_idle};
}

void far_expect_sent(const char *bytes)
{
    uint8_t expected[MOST];
    const size_t length = bytes_of(bytes, expected);
    assert_int_equal(far_end.sent_length, length);
    assert_memory_equal(far_end.sent, expected, length);
}

void far_run(int status, const char *out, const char *err, const char *line)
{
    const tool_run_t *const run = tool_run(&far_end.tool, "request %s --port line", line);
    if (run->status != status || strstr(run->out, out) == NULL || strstr(run->err, err) == NULL)
        fail_msg("%s: exit status %d\n%s%s", line, run->status, run->out, run->err);
    assert_in_range(far_end.writes, 0, 1);
}
