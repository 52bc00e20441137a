/* SPDX-License-Identifier: MIT */
/* Characters of 11 bits without parity (HPS-167S 2.2.2): two stop bits. */
#include "tool_bench.h"

#include <string.h>

static unsigned set_to_two; /* so often the port was set to two stop bits */
static unsigned set_to_one;

static int set_line(void *ctx, const fathom_line_settings_t *settings)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    if (settings->stop_bits == 2)
        set_to_two++;
    else
        set_to_one++;
    return uart.set_line(ctx, settings);
}

/* An HPS-167S at 8N2. */
static int set_up(void **state)
{
    set_to_two = set_to_one = 0;
    bench_begin();
    bench_hps167s((fathom_sim_hps167s_config_t){.address = 3});
    bench.hps167s.device.settings = (fathom_line_settings_t){19200, FATHOM_PARITY_NONE, 2};
    assert_ptr_equal(bench.tool.uart.ctx, &bench.uart);
    bench.tool.uart.set_line = set_line;
    return 0;
}

static const suite_t suite = {.set_up = set_up};

static void expect_line(uint32_t baud, uint8_t parity, uint8_t stop_bits)
{
    assert_int_equal(bench.line.settings.baud, baud);
    assert_int_equal(bench.line.settings.parity, parity);
    assert_int_equal(bench.line.settings.stop_bits, stop_bits);
}

static void run_at_8n2(void **state)
{
    const char *const command = *state;
    ASSERT_RUN(1, "get hps167s:3 baud --port line"); /* 8E1 is another parity */
    set_to_one = 0;
    ASSERT_RUN(0, "%s --stop-bits 2 --port line", command);
    assert_int_equal(set_to_one, 0);
    expect_line(19200, FATHOM_PARITY_NONE, 2);
}

TEST_ROW(read_does_8n2, run_at_8n2, "read hps167s:3 --count 3")
TEST_ROW(watch_does_8n2, run_at_8n2, "watch hps167s:3 --duration 2")
TEST_ROW(info_does_8n2, run_at_8n2, "info hps167s:3")
TEST_ROW(get_does_8n2, run_at_8n2, "get hps167s:3 termination")
TEST_ROW(set_does_8n2, run_at_8n2, "set hps167s:3 termination off")
TEST_ROW(reset_does_8n2, run_at_8n2, "reset hps167s:3 --yes-load-factory-sensor-settings")

TEST(two_stop_bits_go_with_the_parity_that_is_asked_for)
{
    ASSERT_RUN(1, "read hps167s:3 --parity even --stop-bits 2 --count 1 --timeout 100 --port line");
    expect_line(19200, FATHOM_PARITY_EVEN, 2);
    ASSERT_RUN(0, "read hps167s:3 --stop-bits 1 --parity none --count 1 --port line");
    expect_line(19200, FATHOM_PARITY_NONE, 1);
}

TEST(a_device_that_has_moved_is_told_with_its_two_stop_bits)
{
    const tool_run_t *run = tool_run(&bench.tool, "set hps167s:3 address 7 --stop-bits 2 --port line");
    assert_int_equal(run->status, 0);
    assert_non_null(strstr(
        run->out, "\nfrom now on: fathom read hps167s:7:modbus --port line --parity none --stop-bits 2\n"));
    run = tool_run(&bench.tool, "set hps167s:7 baud 57600 --stop-bits 2 --port line");
    assert_non_null(strstr(run->out, " --port line --baud 57600 --parity none --stop-bits 2\n"));
    expect_line(57600, FATHOM_PARITY_NONE, 2);
    assert_int_equal(run->status, 0);
    ASSERT_RUN(0, "read hps167s:7:modbus --count 1 --port line --baud 57600 --parity none --stop-bits 2");
}

TEST(scan_asks_with_two_stop_bits_only_when_told)
{
    const char *const next = "fathom read hps167s:3:modbus --port line --parity none --stop-bits 2\n";
    ASSERT_RUN(0, "scan --address 1-4 --baud all --parity all --port line");
    assert_int_equal(set_to_two, 0);
    const tool_run_t *const run = tool_run(&bench.tool, "scan --address 1-4 --stop-bits 2 --port line");
    assert_int_equal(run->status, 0);
    expect_line(19200, FATHOM_PARITY_NONE, 2);
    assert_non_null(strstr(run->out, "hps167s  address 3    19200 8N2 "));
    assert_non_null(strstr(run->out, next));
    const tool_run_t *const json =
        tool_run(&bench.tool, "scan --address 3 --stop-bits 2 --format json --port line");
    assert_non_null(strstr(json->out, "\"baud\":19200,\"parity\":\"none\",\"stop_bits\":2,"));
}
