/* SPDX-License-Identifier: MIT */
#include "stage.h"

/* The simulated HPS-167 with a UART and its driver in both modes. The frames are those that public programs print
 * (tests/unit/test_hps167_frames.c), with 01 for the three bytes that they do not. */
#define SINGLE      "0A 22 00 00 00 00 00 00 AE 57"
#define CONTINUOUS  "0A 24 00 00 00 00 00 00 0F 72"
#define STOP        "0A 30 01 00 00 00 00 00 BC 6F"
#define TEMPERATURE "0A 3F 01 00 00 00 00 00 36 86"
#define MEASUREMENT "0A 0D 01 01 01 06 D9 FC 8C 02 01 00 01 9B 94"
#define GREETING    "48 79 70 65 72 73 65 6E"
enum { PERIOD_US = 18519, FRAME = 15 };

static const uint8_t ones[] = {1, 1, 1};
static const fathom_sim_optics_t printed = {0xFC8C, 0x02, 0x01, 0x0001};

static const suite_t suite = {BENCH_TWO_ROUNDS};

/* ---- the device ---- */

static void set_printed(void)
{
    set_hps167(1753, (hps167_config_t){.unknown = ones, .optics = &printed, .temperature = 3000});
    hear(25, GREETING);
}

TEST(it_responds_as_the_printed_frames_do)
{
    set_printed();
    transact(SINGLE, 25, MEASUREMENT);
    transact(TEMPERATURE, 10, "0A 04 0B B8 E7 26");
    transact(STOP, 10, "0A 03 01 F1 D1");
    hear(1000, "");
    COUNTED(.requests = 3, .answered = 3, .automatic = 1, .measurements = 1);
}

TEST(it_sends_continuously_until_it_is_stopped_or_has_no_power)
{
    set_printed();
    ask(CONTINUOUS, 0);
    for (unsigned i = 0; i != 50; i++) wait_ms(20);
    assert_in_range(bench.heard, 53 * FRAME, 54 * FRAME);
    for (size_t i = 0; i != bench.heard; i += FRAME) assert_true(is_hex(bench.bytes + i, MEASUREMENT));
    forget();
    ask(STOP, 20);
    assert_true(is_hex(bench.bytes + bench.heard % FRAME, "0A 03") || bench.heard % FRAME == 5);
    forget();
    hear(1000, "");
    ask(CONTINUOUS, 100);
    forget();
    fathom_sim_power_cycle(&bench.line, bench.device, 50 * MS, bench.now_us);
    hear(1000, GREETING);
}

TEST(it_does_not_respond_to_a_wrong_crc_and_to_what_is_not_known)
{
    set_printed();
    transact("0A 30 00 00 00 00 00 00 BC 6F", 100, ""); /* as one program prints the stop */
    transact("0A 22 00 00 00 00 00 00 AE 56", 100, "");
    COUNTED(.crc_errors = 2, .automatic = 1);
    transact("0A 2E 00 00 00 00 00 00 FC 3C", 100, "");
    transact("0A 30 00 00 00 00 00 00 F9 CF", 100, "");
    COUNTED(.crc_errors = 2, .automatic = 1, .requests = 2, .unserved = 2);
}

TEST(its_unknown_bytes_differ_from_frame_to_frame)
{
    uint32_t different = 0;
    set_hps167(1753, (hps167_config_t){.is_silent = true, .seed = 7});
    ask(CONTINUOUS, 0);
    for (unsigned i = 0; i != 50; i++) wait_ms(20);
    for (size_t i = 2 * FRAME; i + FRAME <= bench.heard; i += FRAME)
        different += memcmp(bench.bytes + i + 2, bench.bytes + i + 2 - FRAME, 3) != 0;
    assert_true(different > 45);
}

/* ---- the driver in continuous mode ---- */

static uint32_t readings, wrong, stales;

static void begin_continuous(uint32_t loop_us)
{
    const fathom_hps167_uart_config_t config = {.continuous = true};
    stage_begin(&bench_115200, true, loop_us);
    bench.fixed = FIXED(1000);
    set_echo(FATHOM_LINE_ECHO_OFF);
    s.model = HPS167;
    assert_int_equal(fathom_hps167_uart_init(&s.driver.hps167, &s.line, &config), FATHOM_OK);
    s.sensor = fathom_hps167_uart_sensor(&s.driver.hps167);
    add_hps167((hps167_config_t){.seed = 1});
    set_faults(1);
    readings = wrong = stales = 0;
}

/* The scene moves on each 250 ms. A reading has the distance of its time, or the one before if it began before. */
static void run_for(uint32_t us)
{
    const uint32_t begin_us = s.clock.now_us;
    uint32_t moved_us = begin_us;
    int32_t before_mm = bench.fixed.value[0];
    while (since_us(begin_us) < us) {
        const uint32_t due_us = fathom_due_us(&s.sensor, 1);
        pass_until(due_us != 0 ? due_us : 1);
        fathom_status_t status;
        while ((status = fathom_poll(&s.sensor, &s.sample)) == FATHOM_OK) {
            const bool may_be_before = (int32_t)(s.sample.time_us - moved_us) < 2 * PERIOD_US;
            readings++;
            wrong += s.sample.kind == FATHOM_TARGET && s.sample.distance_mm != bench.fixed.value[0] &&
                     !(may_be_before && s.sample.distance_mm == before_mm);
        }
        stales += status == FATHOM_ERR_STALE || status == FATHOM_ERR_CHECKSUM;
        if (since_us(moved_us) < 250 * MS) continue;
        moved_us = s.clock.now_us;
        before_mm = bench.fixed.value[0];
        bench.fixed.value[0] = 1000 + (before_mm + 37) % 5000;
    }
}

TEST(the_driver_reads_each_frame_of_the_output)
{
    for (unsigned i = 0; i != 2; i++) {
        begin_continuous(i == 0 ? 0 : 1 * MS);
        run_for(10 * SECOND);
        assert_int_equal(wrong, 0);
        assert_in_range(readings, 530, 541);
        assert_int_equal(s.driver.hps167.missed, 0);
        assert_int_equal(bench.device->counters.requests, 1);
    }
}

TEST(the_driver_starts_the_output_again_after_a_power_cycle)
{
    begin_continuous(1 * MS);
    run_for(SECOND);
    fathom_sim_power_cycle(&bench.line, bench.device, SECOND, s.clock.now_us);
    run_for(6 * SECOND);
    assert_int_equal(stales, 1);
    readings = 0;
    run_for(SECOND);
    assert_in_range(readings, 50, 55);
    assert_int_equal(wrong, 0);
}

TEST(stop_and_deinit_end_the_output)
{
    for (unsigned is_stopped = 0; is_stopped != 2; is_stopped++) {
        fathom_status_t status = FATHOM_PENDING;
        begin_continuous(1 * MS);
        run_for(SECOND);
        while (is_stopped != 0 && status == FATHOM_PENDING) {
            pass_until(1 * MS);
            status = fathom_hps167_uart_stop(&s.driver.hps167);
        }
        assert_int_equal(status, is_stopped != 0 ? FATHOM_OK : FATHOM_PENDING);
        fathom_hps167_uart_deinit(&s.driver.hps167);
        fathom_sim_clock_advance(&s.clock, 100 * MS);
        const uint32_t sent = bench.device->counters.automatic;
        fathom_sim_clock_advance(&s.clock, SECOND);
        assert_int_equal(bench.device->counters.automatic, sent);
    }
}

/* Each kind of damage in three of ten frames. */
TEST(no_damage_makes_a_wrong_or_old_reading_of_the_output_and_the_driver_recovers)
{
    for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++) {
        const bool is_old = kind == FATHOM_SIM_FAULT_STUCK || kind == FATHOM_SIM_FAULT_LATE;
        begin_continuous(loops_us[kind % 3]);
        if (!fathom_sim_fault_applies(kind, bench.device) || is_old) continue;
        assert_non_null(fathom_sim_fault_add(&bench.fault, kind, 300000, 0));
        run_for(20 * SECOND);
        if (wrong != 0) fail_msg("%s: %u wrong", fathom_sim_fault_name(kind), (unsigned)wrong);
        fathom_sim_fault_enable(&bench.fault, false);
        run_for(15 * SECOND);
        readings = 0;
        run_for(SECOND);
        assert_in_range(readings, 45, 55);
        assert_int_equal(wrong, 0);
    }
}
