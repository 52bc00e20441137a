/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): getpid */
/* Wherever fathom commission is interrupted, no two sensors have the same address, the record shows where each is, and
 * every write was announced. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "sim/fault.h"

/* ---- units with factory settings, each with its own UUID and its own response times ---- */

enum { UNITS = 8, MOMENTS = 200, MS = 1000, SECOND = 1000000 };

#define TITLE "# fathom commission: which unit has which address, or is to have it\n"
#define FIRST "00390025423457142034383501060705" /* the UUID of the datasheet's example of #3 */

/* The units in the order in which they are connected: each when the one before has left address 1. */
static struct {
    union {
        fathom_sim_hps167s_t hps;
        fathom_sim_a16_t a16;
        fathom_sim_a05_t a05;
    } unit[UNITS];
    fathom_sim_device_t *device[UNITS];
    size_t count;
    size_t connected;
    void (*watch)(void); /* what else befalls the units: called whenever time has passed */
    uint32_t hand_us;    /* how long it takes to connect the next one */
    uint32_t left_us;    /* when the last one that is connected was at address 1 last */
    unsigned announced;  /* writes, in all runs */
    char record[64];
    uint32_t begin_us;
    uint32_t asked_us[MOMENTS]; /* when requests left, since begin_us */
    size_t asked;
} site;

static void connect_next(void)
{
    fathom_sim_attach(&bench.line, site.device[site.connected++], bench.clock.now_us);
}

/* No hand is faster than the acknowledgement of the one before, which at its old address is byte for byte what sets the
 * address of the next one. */
static void idle(void *ctx, uint32_t max_us)
{
    fathom_sim_clock_idle(ctx, max_us);
    if (site.watch != NULL) site.watch();
    const bool is_due =
        site.connected != 0 && site.connected < site.count && site.device[site.connected - 1]->address != 1;
    if (!is_due) site.left_us = bench.clock.now_us;
    if (is_due && fathom_elapsed_us(bench.clock.now_us, site.left_us) > site.hand_us) connect_next();
}

static int write_and_note(void *ctx, const uint8_t *bytes, size_t length)
{
    const fathom_uart_t uart = fathom_sim_uart(ctx);
    if (site.asked != MOMENTS)
        site.asked_us[site.asked++] = fathom_elapsed_us(bench.clock.now_us, site.begin_us);
    return uart.write(ctx, bytes, length);
}

static void site_begin(void)
{
    bench_begin();
    bench.tool.idle = idle;
    bench.tool.uart.write = write_and_note;
    memset(&site, 0, sizeof site);
    site.hand_us = 100 * MS;
    site.left_us = bench.clock.now_us;
    site.begin_us = bench.clock.now_us;
    (void)snprintf(site.record, sizeof site.record, "%s/fathom-commission-%d.txt",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", (int)getpid());
    (void)unlink(site.record);
}

EACH_BEGINS(site_begin())

static int site_tear_down(void **state)
{
    (void)unlink(site.record);
    return 0;
}

/* ---- units ---- */

static void add_hps(fathom_sim_hps167s_config_t config)
{
    fathom_sim_hps167s_t *const hps = &site.unit[site.count].hps;
    config.scene = fathom_sim_fixed(&bench.scene);
    config.number = (uint8_t)site.count;
    config.seed = (uint32_t)site.count;
    fathom_sim_hps167s_init(hps, &config);
    site.device[site.count++] = &hps->device;
}

static void add_hps_units(size_t count)
{
    while (site.count != count) add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
}

#define ADD_UNITS(name, model, MODEL)                                                                        \
    static void name(size_t count)                                                                           \
    {                                                                                                        \
        for (; site.count != count; site.count++) {                                                          \
            fathom_sim_##model##_t *const unit = &site.unit[site.count].model;                               \
            const fathom_sim_##model##_config_t config = {.mode = FATHOM_SIM_##MODEL##_MODBUS,               \
                                                          .seed = (uint32_t)site.count,                      \
                                                          .scene = fathom_sim_fixed(&bench.scene)};          \
            fathom_sim_##model##_init(unit, &config);                                                        \
            site.device[site.count] = &unit->device;                                                         \
        }                                                                                                    \
        connect_next();                                                                                      \
    }

ADD_UNITS(add_a16_units, a16, A16)
ADD_UNITS(add_a05_units, a05, A05)

/* ---- runs ---- */

/* Runs the command with the record. `more`: sensor, addresses, options. After each run no two of the connected units have
 * the same address, and no more was written than was announced. */
static const tool_run_t *commission(const char *more)
{
    const tool_run_t *const done =
        tool_run(&bench.tool, "commission %s --port line --record %s", more, site.record);
    unsigned written = 0;
    site.announced += count_of(done->out, "  writes ") + count_of(done->err, "  writes ");
    for (size_t i = 0; i != site.connected; i++) {
        const fathom_sim_device_t *const one = site.device[i];
        written += one->counters.writes;
        for (size_t j = 0; j != i; j++)
            if (site.device[j]->address == one->address)
                fail_msg("two units have address %u\n%s%s", one->address, done->out, done->err);
    }
    if (written > site.announced)
        fail_msg("%u writes, %u announced\n%s%s", written, site.announced, done->out, done->err);
    return done;
}

static void expect(const tool_run_t *done, int status, const char *text)
{
    if (done->status != status || (strstr(done->out, text) == NULL && strstr(done->err, text) == NULL))
        fail_msg("exit status %d, not %d with '%s'\n%s%s", done->status, status, text, done->out, done->err);
}

static const char *record_text(void)
{
    static char text[2048];
    FILE *const file = fopen(site.record, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    (void)fclose(file);
    return text;
}

static void write_record(const char *text)
{
    FILE *const file = fopen(site.record, "w");
    assert_non_null(file);
    (void)fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static unsigned writes(void)
{
    unsigned sum = 0;
    for (size_t i = 0; i != site.count; i++) sum += site.device[i]->counters.writes;
    return sum;
}

static const suite_t suite = {.set_up = begins, .tear_down = site_tear_down};

/* ---- all goes well ---- */

/* Each unit has its address, its termination and its number of writes to flash. */
static void expect_units(const uint8_t *addresses, const char *terminations, const char *flash_writes)
{
    for (size_t i = 0; addresses[i] != 0; i++) {
        const fathom_sim_hps167s_t *const hps = &site.unit[i].hps;
        assert_int_equal(hps->device.address, addresses[i]);
        assert_int_equal(hps->termination, terminations[i] == '1');
        assert_int_equal(hps->device.counters.flash_writes, flash_writes[i] - '0');
    }
}

static const uint8_t from_2_to_9[] = {2, 3, 4, 5, 6, 7, 8, 9, 0};

TEST(eight_units_from_the_factory_get_the_addresses_from_2_to_9)
{
    add_hps_units(8);
    const tool_run_t *done = commission("hps167s --addresses 2-9");
    expect_units(from_2_to_9, "00000001", "22222221");
    assert_true(site.asked_us[0] > SECOND); /* what came late of a run before has been heard */
    assert_int_equal(site.announced, 15);   /* an address each, and the termination of seven */
    expect(done, 0,
           "hps167s at address 1, UUID " FIRST ": gets address 2\n"
           "  writes termination off (#11)\n"
           "  writes address 2 (#8)\n"
           "  address 2 is done: termination off from the next power-on, 1234 mm\n");
    expect(done, 0,
           "  writes address 9 (#8)\n  address 9 is done: termination on, 1234 mm\n8 of 8 addresses");
    /* tool_run's clock begins on 2025-11-24 at 16:00 */
    assert_int_equal(strncmp(record_text(), TITLE, strlen(TITLE)), 0);
    assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " done 2025-11-24T16:00:"));
    assert_int_equal(count_of(record_text(), " done "), 8);
    expect(commission("hps167s --addresses 2-9"), 0, "8 of 8 addresses are assigned and verified\n");
    expect_units(from_2_to_9, "00000001", "22222221"); /* a second run writes nothing */
}

/* The new units are terminated, or none of them is. */
TEST(a_value_that_the_sensor_already_has_is_not_written)
{
    static const struct {
        const char *more;
        bool no_termination;
        uint8_t addresses[4];
        const char *terminations;
        const char *flash_writes;
    } rows[] = {
        {"hps167s --addresses 2-4 --terminated 3", false, {2, 3, 4}, "010", "212"},
        {"hps167s --addresses 7,1 --terminated none", false, {7, 1}, "00", "21"},
        {"hps167s --addresses 2,3", true, {2, 3}, "01", "12"},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        site_begin();
        for (size_t unit = 0; rows[i].addresses[unit] != 0; unit++)
            add_hps((fathom_sim_hps167s_config_t){.no_termination = rows[i].no_termination});
        connect_next();
        expect(commission(rows[i].more), 0, " addresses are assigned and verified\n");
        expect_units(rows[i].addresses, rows[i].terminations, rows[i].flash_writes);
    }
}

TEST(sensors_that_send_unsolicited_frames_are_commissioned)
{
    static const uint32_t unasked_us[] = {18500, 26419, 34338, 50176, 66014, 100000, 152000, 192718};
    for (size_t i = 0; i != sizeof unasked_us / sizeof unasked_us[0]; i++) {
        site_begin();
        add_hps((fathom_sim_hps167s_config_t){.unasked_us = unasked_us[i]});
        connect_next();
        expect(commission("hps167s --addresses 2 --wait 60"), 0, "1 of 1");
        assert_int_equal(site.device[0]->address, 2);
    }
}

TEST(json_has_an_object_for_each_sensor)
{
    add_hps_units(1);
    const tool_run_t *const done = commission("hps167s --addresses 2 --format json");
    assert_int_equal(done->status, 0);
    assert_int_equal(strncmp(done->out,
                             "{\"model\":\"hps167s\",\"address\":2,\"uuid\":\"" FIRST "\","
                             "\"termination\":true,\"distance_mm\":1234,\"status\":\"done\","
                             "\"utc\":\"2025-11-24T16:00:",
                             148),
                     0);
    assert_int_equal(count_of(done->out, "\n"), 1);
    assert_non_null(strstr(done->err, "  writes address 2 (#8)\n"));
}

/* ---- interrupted and resumed ---- */

/* What two units are to have come to. */
typedef struct {
    void (*add)(size_t count);
    const char *more;
    uint8_t addresses[2];
    uint8_t writes[2];
} pair_t;

/* The first run is ended so long after its begin. False: it was done before. */
static bool is_ended_after(const pair_t *pair, uint64_t us)
{
    site_begin();
    pair->add(2);
    bench.tool.ctrl_c_us = us;
    const bool is_done = commission(pair->more)->status == 0;
    bench.tool.ctrl_c_us = 0;
    expect(commission(pair->more), 0, "2 of 2 addresses");
    for (size_t i = 0; i != 2; i++) {
        assert_int_equal(site.device[i]->address, pair->addresses[i]);
        assert_int_equal(site.device[i]->counters.writes, pair->writes[i]);
    }
    return !is_done;
}

/* Every 200 ms; and with each request of a run that is not ended: as it leaves, in its middle, while the device works
 * on it, in the middle of the response (of 8 bytes: 4.6 ms at 19200 8E1, 8.3 ms at 9600 8N1) and behind it. */
static void end_at_any_moment(void **state)
{
    static const uint32_t after_us[] = {0, 3 * MS, 6 * MS, 10 * MS, 16 * MS, 25 * MS};
    const pair_t *const pair = *state;
    static uint32_t asked_us[MOMENTS];
    uint64_t us = 0;
    site_begin();
    pair->add(2);
    expect(commission(pair->more), 0, "2 of 2 addresses");
    const size_t count = site.asked;
    assert_in_range(count, 20, MOMENTS - 1);
    memcpy(asked_us, site.asked_us, sizeof asked_us);
    while (is_ended_after(pair, us += 200 * MS)) {
    }
    assert_in_range(us, 5 * SECOND, 30 * SECOND);
    for (size_t i = 0; i != count; i++)
        for (size_t j = 0; j != sizeof after_us / sizeof after_us[0]; j++)
            assert_true(is_ended_after(pair, asked_us[i] + after_us[j]));
}

#define ENDED(name, ...)                                                                                     \
    static const pair_t pair_##name = {__VA_ARGS__};                                                         \
    TEST_ROW(interrupted_at_any_moment_it_resumes_with_##name, end_at_any_moment, &pair_##name)

ENDED(an_hps167s, add_hps_units, "hps167s --addresses 2,3 --wait 60", {2, 3}, {2, 1})
ENDED(an_a16, add_a16_units, "a16 --addresses 2,3 --wait 60", {2, 3}, {1, 1})
ENDED(an_a05_that_keeps_address_1, add_a05_units, "a05 --addresses 9,1 --wait 60", {9, 1}, {1, 0})

TEST(interrupted_again_and_again_it_finishes)
{
    for (uint64_t step = 0; step != 20; step++) {
        unsigned runs = 1;
        site_begin();
        add_hps_units(8);
        bench.tool.ctrl_c_us = 10 * SECOND + step * 97 * MS; /* to take up one unit takes less */
        while (commission("hps167s --addresses 2-9")->status != 0) assert_true(++runs < 40);
        assert_in_range(runs, 3, 40);
        expect_units(from_2_to_9, "00000001", "22222221");
    }
}

/* ---- silent, missing, another sensor, a late termination ---- */

static fathom_sim_fault_t faults;

/* The unit says nothing from its n-th frame on, for `run` frames. */
static void silence(size_t i, uint32_t frame, uint32_t run)
{
    fathom_sim_fault_init(&faults, 1);
    fathom_sim_fault_attach(&faults, &bench.line, site.device[i]);
    fathom_sim_fault_rule_t *const rule =
        fathom_sim_fault_add(&faults, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, frame);
    assert_non_null(rule);
    rule->run = run;
}

/* Wherever a sensor falls silent for a while, the cause is printed, and the next run finishes. */
TEST(a_sensor_that_falls_silent_is_where_the_record_has_it)
{
    unsigned unconfirmed = 0;
    for (uint32_t frame = 1; frame != 25; frame++) {
        site_begin();
        add_hps_units(1);
        silence(0, frame, 12);
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 60");
        if (done->status != 0) {
            const bool is_told =
                strstr(done->err, "The sensor is at address 1 or at address 2, 19200 8E1") != NULL;
            unconfirmed += is_told;
            assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " planned "));
            assert_true(site.device[0]->address == 1 || is_told || strstr(done->err, "hps167s:2: ") != NULL);
            assert_non_null(strstr(done->out, "To continue, run the same command again\n"));
        }
        fathom_sim_fault_init(&faults, 1);
        expect(commission("hps167s --addresses 2 --terminated none --wait 60"), 0, "1 of 1");
        assert_int_equal(site.device[0]->address, 2);
        assert_in_range(site.device[0]->counters.flash_writes, 2, 3);
    }
    assert_true(unconfirmed != 0);
}

/* Interrupted, and its unit taken off: the others get the other addresses. */
TEST(the_address_of_a_missing_sensor_stays_reserved)
{
    add_hps_units(3);
    write_record(TITLE "hps167s 2 ffffffffffffffffffffffffffffffff planned 2026-01-01T00:00:00Z\n");
    const tool_run_t *const done = commission("hps167s --addresses 2-4 --wait 60");
    expect(done, 1, "address 2 stays reserved: its sensor ffffffffffffffffffffffffffffffff was not found\n");
    expect(done, 1,
           "address 2 is not done: the sensor with UUID ffffffffffffffffffffffffffffffff is at this ");
    expect(done, 1, "2 of 3 addresses are assigned and verified. To continue, run the same command again\n");
    assert_int_equal(site.device[0]->address, 3);
    assert_int_equal(site.device[1]->address, 4);
    assert_int_equal(site.device[2]->address, 1);
    assert_int_equal(site.device[2]->counters.writes, 0);
}

/* On a bench: what was moved without being heard, and connected again while others were at work. */
TEST(a_missing_sensor_is_finished_by_a_later_run)
{
    add_hps((fathom_sim_hps167s_config_t){.address = 2});
    add_hps((fathom_sim_hps167s_config_t){.address = 1});
    connect_next();
    write_record(TITLE "hps167s 2 " FIRST " planned 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 2,3"), 0, "hps167s at address 2, UUID " FIRST ": verifying\n");
    assert_int_equal(site.device[0]->counters.flash_writes, 1);
    assert_int_equal(site.device[1]->address, 3);
}

TEST(a_sensor_in_the_record_gets_its_own_address_again)
{
    add_hps_units(2);
    write_record(TITLE "hps167s 7 00390025423457142034383501060706 done 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 5,6 --wait 20"), 1,
           "the sensor at address 1 was at address 7 and gets this address again");
    assert_int_equal(site.device[0]->address, 5);
    assert_int_equal(site.device[1]->address, 7);
}

TEST(two_units_with_one_number_do_not_get_one_address)
{
    add_hps_units(2);
    site.unit[1].hps.number = 0;
    expect(commission("hps167s --addresses 2,3 --wait 20"), 1,
           "a sensor with the UUID of address 2 responds at address 1 too");
    assert_int_equal(site.device[1]->counters.writes, 0);
}

TEST(sensors_without_a_uuid_have_to_stay_connected)
{
    add_a16_units(3);
    site.hand_us = 20 * SECOND; /* the second one comes later */
    bench.tool.ctrl_c_us = 12 * SECOND;
    expect(commission("a16 --addresses 2-4"), 1, "1 of 3");
    bench.tool.ctrl_c_us = 0;
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    const unsigned before = writes();
    expect(commission("a16 --addresses 2-4 --wait 20"), 1,
           "fathom: nothing was written: address 2 is done in the record, but no sensor responds there. "
           "Connect it and switch it on. If you took it away, remove its line from the record and its "
           "address from --addresses\n");
    assert_int_equal(writes(), before);
    write_record(TITLE);
    expect(commission("a16 --addresses 3,4 --wait 60"), 0, "2 of 2");
}

/* It may have address 2 already, and be in a box. */
TEST(an_interrupted_sensor_that_is_absent_keeps_its_address_reserved)
{
    add_a16_units(3);
    write_record(TITLE "a16 2 - planned 2026-01-01T00:00:00Z\n");
    fathom_sim_detach(&bench.line, site.device[0], bench.clock.now_us);
    site.device[0]->address = 2;
    site.hand_us = 10 * SECOND;
    expect(commission("a16 --addresses 2-4 --wait 20"), 1,
           "address 2 stays reserved: its sensor was not found\n");
    assert_int_equal(site.device[1]->address, 3);
    assert_int_equal(site.device[2]->address, 4);
}

TEST(a_sensor_that_reports_a_fault_is_not_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_FAULT;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s:2: the address is set, but the sensor reports a fault\n");
    assert_non_null(strstr(record_text(), " planned 2"));
}

TEST(a_sensor_without_a_target_is_done)
{
    add_hps_units(1);
    bench.scene.value[0] = FATHOM_SIM_NO_TARGET;
    expect(commission("hps167s --addresses 2"), 0, "  address 2 is done: termination on, no_target\n");
}

TEST(commission_waits_for_a_sensor_that_warms_up)
{
    add_hps((fathom_sim_hps167s_config_t){.warm_up_s = 12});
    connect_next();
    expect(commission("hps167s --addresses 2"), 0, "1 of 1");
}

/* ---- what befalls a unit in the middle of its work ---- */

static void become_another(void)
{
    if (site.device[0]->address != 1) site.unit[0].hps.number = 9;
}

TEST(a_sensor_with_another_uuid_at_the_new_address_is_not_accepted)
{
    add_hps_units(1);
    site.watch = become_another;
    expect(commission("hps167s --addresses 2 --wait 20"), 1,
           "fathom: hps167s:2: a sensor with another UUID responds");
    assert_non_null(strstr(record_text(), " planned 2"));
}

static void be_replaced(void)
{
    if (site.asked == 4) site.unit[0].hps.number = 9; /* three reads, and the new address was asked */
}

TEST(a_sensor_replaced_before_the_write_is_found_again)
{
    add_hps_units(1);
    site.watch = be_replaced;
    expect(commission("hps167s --addresses 2 --wait 20"), 0, "1 of 1");
    assert_null(strstr(record_text(), FIRST));
    assert_non_null(strstr(record_text(), "hps167s 2 0039002542345714203438350106070e done ")); /* 05 + 9 */
}

/* #2 reports the termination that acts now. #11 changes it at the next power-on. */
static void report_late(void) { site.unit[0].hps.termination = true; }

TEST(a_termination_that_reads_late_is_done_after_the_power_on)
{
    add_hps_units(1);
    site.watch = report_late;
    for (unsigned i = 0; i != 2; i++) {
        const tool_run_t *const done = commission("hps167s --addresses 2 --terminated none --wait 20");
        expect(done, 1,
               "  address 2 is set, but the termination reads on until the next power-on. Switch the sensor "
               "off and on, and run the command again\n");
        assert_non_null(strstr(record_text(), "\nhps167s 2 " FIRST " planned "));
        assert_int_equal(site.device[0]->counters.flash_writes, 2 + i); /* the termination once a run */
    }
    site.watch = NULL;
    site.unit[0].hps.termination = false;
    expect(commission("hps167s --addresses 2 --terminated none --wait 20"), 0, "1 of 1");
    assert_int_equal(site.device[0]->counters.flash_writes, 3);
}

/* Three reads when it is found, three before it is written; it falls silent at the next one. */
TEST(a_sensor_without_a_uuid_that_was_not_written_counts_as_new)
{
    add_a16_units(1);
    silence(0, 7, 3);
    const tool_run_t *const done = commission("a16 --addresses 2,3 --wait 20");
    expect(done, 1, "not written: no response");
    expect(done, 1, "1 of 2");
    assert_int_equal(site.device[0]->address, 2);
}

/* ---- what it refuses ---- */

TEST(of_two_units_at_address_1_none_is_written)
{
    static const struct {
        const char *more;
        void (*add)(size_t count);
        uint32_t reply_us; /* of the second one; the response of the first one takes 15.5 ms */
        const char *says;
    } rows[] = {
        {"hps167s --addresses 2,3 --wait 20", add_hps_units, 0, "or a loose wire: a damaged response."},
        {"hps167s --addresses 2,3 --wait 20", add_hps_units, 40 * MS,
         "two responses to one request. Connect"},
        {"a16 --addresses 2,3 --wait 20", add_a16_units, 0, "two sensors at address 1, or a loose wire: "},
        {"a05 --addresses 2,3 --wait 20", add_a05_units, 0, "two sensors at address 1, or a loose wire: "},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        site_begin();
        rows[i].add(2);
        if (rows[i].reply_us != 0) site.unit[1].hps.reply_us = rows[i].reply_us;
        connect_next();
        const tool_run_t *const done =
            tool_run(&bench.tool, "commission %s --port line --record %s", rows[i].more, site.record);
        expect(done, 1, rows[i].says);
        assert_int_equal(writes(), 0);
        assert_int_equal(count_of(record_text(), " planned 2"), 0);
        fathom_sim_detach(&bench.line, site.device[1], bench.clock.now_us);
        site.connected--; /* the idle hook connects it again */
        expect(commission(rows[i].more), 0, "2 of 2");
    }
}

TEST(nothing_is_written_if_the_new_address_is_in_use)
{
    for (int is_a16 = 0; is_a16 != 2; is_a16++) {
        site_begin();
        (is_a16 ? add_a16_units : add_hps_units)(2);
        site.device[0]->address = 2;
        connect_next();
        expect(
            commission(is_a16 ? "a16 --addresses 2,3 --wait 20" : "hps167s --addresses 2 --wait 20"), 1,
            "nothing was written: a sensor responds at address 2, which the sensor at address 1 is to get");
        assert_int_equal(writes(), 0);
        assert_int_equal(count_of(record_text(), " planned 2"), 0);
    }
}

TEST(with_a_damaged_record_nothing_is_sent)
{
    static const struct {
        const char *text;
        const char *says;
    } rows[] = {
        {"", " is empty. Remove the file"},
        {"hello\n", ":1: this file is no record of fathom commission"},
        {TITLE "hps167s 2 " FIRST " done\n", ":2: a line has five words"},
        {TITLE "hps167s 2 " FIRST " done now and\n", ":2: a line has five words"},
        {TITLE "hps167s 2 " FIRST " done now", ":2: the end of the line is missing"},
        {TITLE "hps168s 2 " FIRST " done now\n", ":2: unknown sensor"},
        {TITLE "hps167s 33 " FIRST " done now\n", ":2: this sensor cannot have this address"},
        {TITLE "hps167s 0 " FIRST " done now\n", ":2: this sensor cannot have this address"},
        {TITLE "hps167s 2 - done now\n", ":2: invalid UUID"},
        {TITLE "hps167s 2 " FIRST "0 done now\n", ":2: invalid UUID"},
        {TITLE "a16 2 " FIRST " done now\n", ":2: invalid UUID"},
        {TITLE "hps167s 2 " FIRST " Done now\n", ":2: the state is neither planned nor done"},
        {TITLE "hps167s 2 " FIRST " planned \x1b[2J\n", ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned \x9b"
               "2J\n",
         ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned x\",\"y\n", ":2: invalid time"},
        {TITLE "hps167s 2 " FIRST " planned x\\\n", ":2: invalid time"},
        {TITLE "#\na16 2 - done now\na05 2 - done now\n", ":4: this address is in the record twice"},
        {TITLE "hps167s 2 " FIRST " done now\nhps167s 3 " FIRST " done now\n",
         ":3: this UUID is in the record twice"},
    };
    add_hps_units(1);
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++) {
        write_record(rows[i].text);
        const tool_run_t *const done = commission("hps167s --addresses 2-4 --wait 9");
        expect(done, 1, rows[i].says);
        assert_string_equal(done->out, "");
        assert_string_equal(record_text(), rows[i].text);
        assert_int_equal(bench.line.counters.from_host, 0);
    }
}

TEST(with_a_record_that_cannot_be_written_nothing_is_sent)
{
    add_hps_units(1);
    (void)snprintf(site.record, sizeof site.record, "/tmp/fathom-no-such-folder/record.txt");
    expect(commission("hps167s --addresses 2"), 1,
           "fathom: cannot write /tmp/fathom-no-such-folder/record.txt: No such file or directory\n");
    assert_int_equal(bench.line.counters.from_host, 0);
}

TEST(wrong_words_are_usage_errors)
{
    static const struct {
        const char *more;
        const char *says;
    } rows[] = {
        {"hps167s", "--addresses is missing. It takes addresses and ranges"},
        {"hps167s --addresses 2-33", "from 1 to 32"},
        {"hps167s --addresses 5-2", "such as 2-9"},
        {"hps167s --addresses 2,,3", "such as 2-9"},
        {"hps167s --addresses 1-8", "has address 1 before its end."},
        {"hps167s --addresses 2-4,3", "--addresses has address 3 twice."},
        {"hps167s --addresses 2-4 --terminated 5",
         "--terminated is '5'. It takes one of --addresses, or none."},
        {"a16 --addresses 2-4 --terminated 4", "--terminated has no effect on a16"},
        {"hps167s:3 --addresses 2", "new sensors have address 1. Leave address 3 out."},
        {"hps167s a16 --addresses 2", "'a16' is one word too many."},
        {"a05 --mode dyp --addresses 2", "--mode is dyp, but this needs mode modbus."},
        {"hps167s --addresses 2 --wait 0", "--wait is '0'. It takes a whole number from 1 to 86400 s."},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        expect(commission(rows[i].more), 2, rows[i].says);
    expect(tool_run(&bench.tool, "commission hps167s --port line --addresses 2"), 2, "--record is missing");
    expect(tool_run(&bench.tool, "commission hps167s --port tcp:localhost --addresses 2 --record r"), 2,
           "tcp:localhost is no serial port.");
    write_record(TITLE "a16 2 - done now\n");
    expect(commission("hps167s --addresses 2-4"), 2, "address 2 belongs to an a16 in the record");
    write_record(TITLE "a16 1 - done now\n");
    expect(commission("a16 --addresses 2-4"), 2, "a sensor keeps address 1 in the record");
}

TEST(address_1_is_not_given_while_another_is_open)
{
    add_hps_units(1);
    write_record(TITLE "hps167s 3 ffffffffffffffffffffffffffffffff planned 2026-01-01T00:00:00Z\n");
    expect(commission("hps167s --addresses 3,1 --wait 20"), 1, "0 of 2 addresses");
    assert_int_equal(count_of(record_text(), "hps167s 1 "), 0);
}
