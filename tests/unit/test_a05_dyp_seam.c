/* SPDX-License-Identifier: MIT */
#include "line_bench.h"

#include "fathom/a05_dyp.h"

/* 55 AA 03 gives its address to every A05 on the line (A05 2(3)5). Whoever has the driver's seam to the line can send
 * it at no time: not before the driver sets an address, not between the calls that set it, and not afterwards. */

static fathom_a05_dyp_t dyp;

static int set_up_driver(void **state)
{
    const fathom_a05_dyp_config_t config = {.line = &bench.line};
    assert_int_equal(set_up(state), 0);
    return fathom_a05_dyp_init(&dyp, &config) == FATHOM_READY ? 0 : -1;
}

static const suite_t suite = {.set_up = set_up_driver};

/* A write of the address register, as a program would send it that has taken the seam for Modbus. */
static void assert_refused(void)
{
    const fathom_modbus_t *const seam = &dyp.client;
    const size_t written = bench.fake.written;
    fathom_modbus_write_single_register(&bench.other.message, 9, 0x0200, 9);
    assert_int_equal(seam->submit(seam->ctx, &bench.other), FATHOM_ERR_UNSUPPORTED);
    assert_false(fathom_line_has(&bench.line, &bench.other.exchange));
    assert_int_equal(bench.fake.written, written);
}

static unsigned sent_with_command_3(void)
{
    unsigned n = 0;
    for (size_t i = 0; i != bench.fake.written; i++)
        if (bench.fake.writes[i].bytes[3] == 0x03) n++;
    return n;
}

/* 55 AA 01 10 and 0x75B mm: 55 + AA + 01 + 10 + 07 + 5B = 172, so that the sum is 72; and at address 7: 78. */
static const uint8_t probe_1_of_1[] = {0x55, 0xAA, 0x01, 0x10, 0x07, 0x5B, 0x72};
static const uint8_t probe_1_of_7[] = {0x55, 0xAA, 0x07, 0x10, 0x07, 0x5B, 0x78};
/* 55 + AA + 07 + 03 = 109 */
static const uint8_t taken_7[] = {0x55, 0xAA, 0x07, 0x03, 0x09};

TEST(a_write_through_the_seam_is_refused_at_every_time)
{
    fathom_status_t status = FATHOM_PENDING;
    size_t seen = 0;
    assert_refused();
    for (unsigned ms = 0; status == FATHOM_PENDING; ms++) {
        assert_true(ms < 10000);
        bench.fake.now_us += 1000;
        status = fathom_a05_dyp_set_every_address(&dyp, 7);
        assert_refused();
        if (bench.fake.written == seen) continue;
        const uint8_t *const last = bench.fake.writes[seen++].bytes;
        if (last[2] == 1) fake_receive(&bench.fake, 70000, probe_1_of_1, sizeof probe_1_of_1);
        if (last[3] == 3) fake_receive(&bench.fake, 10000, taken_7, sizeof taken_7);
        if (sent_with_command_3() == 1 && last[3] == 0x10)
            fake_receive(&bench.fake, 70000, probe_1_of_7, sizeof probe_1_of_7);
    }
    assert_int_equal(status, FATHOM_READY);
    assert_int_equal(sent_with_command_3(), 1);
    assert_refused();
}

TEST(what_was_refused_or_given_up_leaves_the_seam_closed)
{
    assert_int_equal(fathom_a05_dyp_set_every_address(&dyp, 0), FATHOM_ERR_ARGUMENT);
    assert_refused();
    assert_int_equal(fathom_a05_dyp_set_every_address(&dyp, 255), FATHOM_ERR_ARGUMENT);
    assert_refused();
    assert_int_equal(fathom_a05_dyp_set_every_address(&dyp, 7), FATHOM_PENDING);
    fathom_a05_dyp_cancel(&dyp);
    assert_refused();
    assert_int_equal(sent_with_command_3(), 0);
}
