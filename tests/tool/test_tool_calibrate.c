/* SPDX-License-Identifier: MIT */
/* After fathom calibrate the device is right, or the report is true; without a measurement nothing is written. */
#include "tool_bench.h"

#include <stdio.h>
#include <string.h>

#include "sim/fault.h"

/* What happens to the device and its frames. Its writes are counted from 1. */
typedef struct {
    bool adds;
    int16_t before_mm; /* the offset */
    uint8_t lost_write;
    bool is_taken;     /* the request of the lost write arrives, and only its acknowledgement is lost */
    uint8_t exception; /* the response in place of the acknowledgement; 0: none */
    bool is_deaf;      /* to #1, which the driver reads before it writes #12 */
    uint8_t silent;    /* responses that are lost, from the third one on */
} fate_t;

static fate_t fate;
static unsigned requests; /* of writes */

static void incoming(void *ctx, fathom_sim_frame_t *frame)
{
    if (fate.is_deaf && frame->length != 0 && frame->bytes[1] == 3 && frame->bytes[3] == 1) frame->length = 0;
    if (frame->length == 0 || frame->bytes[1] != 6) return;
    if (++requests == fate.lost_write && !fate.is_taken) frame->length = 0;
}

static void outgoing(void *ctx, fathom_sim_frame_t *frame)
{
    static const uint8_t refused[5] = {1, 0x86, 3, 0x02, 0x61};
    static const uint8_t gateway[5] = {1, 0x86, 11, 0x03, 0xA7};
    if (frame->length == 0 || frame->bytes[1] != 6 || requests != fate.lost_write) return;
    frame->length = fate.exception != 0 ? 5 : 0;
    memcpy(frame->bytes, fate.exception == 3 ? refused : gateway, frame->length);
}

static const fathom_sim_faults_t faults = {.incoming = incoming, .outgoing = outgoing};

/* ---- what it sees ---- */

static struct {
    uint32_t begin_us;
    int32_t amount; /* of the row */
    uint32_t calls;
    int32_t used; /* the offset in force, perhaps in 1/1000 mm */
} scene;

/* Up and down around 2015 by `amount`, evenly. */
static int32_t noisy(void *ctx, uint8_t probe, uint32_t now_us)
{
    return 2015 - scene.amount + (int32_t)(scene.calls++ * 5 % (2u * (uint32_t)scene.amount + 1));
}

static int32_t moving(void *ctx, uint8_t probe, uint32_t now_us)
{
    return 2015 + (int32_t)((now_us - scene.begin_us) / 100000); /* 10 mm a second */
}

/* After a write the first measurement is one from before. */
static int32_t stale(void *ctx, uint8_t probe, uint32_t now_us)
{
    const int32_t offset_mm = bench.hps167s.sensor.offset_mm;
    const int32_t mm = 2015 - offset_mm + scene.used;
    scene.used = offset_mm;
    return mm;
}

/* 3 mm up and down, in the first second. */
static int32_t noisy_at_first(void *ctx, uint8_t probe, uint32_t now_us)
{
    return now_us - scene.begin_us > 1000000 ? 2000 : 1997 + (int32_t)(scene.calls++ * 5 % 7);
}

/* There in every second batch, which takes 0.46 s; 2 s are between two. */
static int32_t at_times(void *ctx, uint8_t probe, uint32_t now_us)
{
    return (now_us - scene.begin_us) % 4480000 < 1000000 ? FATHOM_SIM_NO_TARGET : 2000;
}

/* Each measurement comes 1/100 nearer to the offset, so that it takes 1.85 s to 63 %. */
static int32_t filtered(void *ctx, uint8_t probe, uint32_t now_us)
{
    const int32_t offset_mm = bench.hps167s.sensor.offset_mm;
    scene.used += (offset_mm * 1000 - scene.used) / 100;
    return 2015 - offset_mm + (scene.used < 0 ? scene.used - 500 : scene.used + 500) / 1000;
}

static int32_t late_target(void *ctx, uint8_t probe, uint32_t now_us)
{
    return scene.calls++ == 0 ? FATHOM_SIM_NO_TARGET : 2000;
}

static int32_t fixed(void *ctx, uint8_t probe, uint32_t now_us) { return scene.amount; }

/* ---- the runs ---- */

#define FAR   "hps167s:1: measured 2015 mm (median of 25, spread 0 mm), known 2000 mm: 15 mm too far\n"
#define THERE "hps167s:1: measured 2000 mm (median of 25, spread 0 mm), known 2000 mm\n"
#define ONE   "hps167s:1: writing offset -15 mm to flash (write 1 of at most 2)\n"
#define RIGHT "hps167s:1: right within 2 mm: measured 2000 mm, known 2000 mm; "
#define NOW   "the offset is now, or from the next power-on: "
#define NONE  "\nfathom: hps167s:1: nothing was written.\n"
#define AGAIN                                                                                                \
    "fathom: before you calibrate again, switch the power off and on, and measure.\n"                        \
    "fathom: if the sensor then measures as before, set distance-offset to 0, switch the power off and on, " \
    "and calibrate again.\n"                                                                                 \
    "fathom: if it measures another wrong distance X, #12 replaces the old offset, and the right offset is " \
    "1985 - X.\n" /* 2000 - 15 */

typedef struct {
    const char *name;
    const char *options;
    int32_t (*look)(void *ctx, uint8_t probe, uint32_t now_us);
    int32_t amount;
    fate_t fate;
    uint64_t ctrl_c_us;
    int status;
    unsigned writes;      /* to the device, whether they arrive or not */
    int16_t offset_mm[2]; /* from and to which the offset is afterwards */
    const char *out;      /* the whole output; NULL: any */
    const char *err;
    const char *says[2]; /* parts of either */
} row_t;

static const row_t runs[] = {
    {"no old offset", "", fixed, 2015, .writes = 1, .offset_mm = {-15, -15}, .err = "",
     .out = FAR ONE THERE RIGHT "offset: -15 mm or the old offset minus 15 mm; flash writes: 1\n"},
    {"it adds", "", fixed, 2010, .fate = {.adds = true, .before_mm = 5}, .writes = 1, .offset_mm = {-10, -10},
     .err = "", .says = {RIGHT "offset: -15 mm or the old offset minus 15 mm; flash writes: 1\n"}},
    /* 10 mm off without an offset: with -15 it is 5 too near, and -15 + 5 is right */
    {"it replaces", "", fixed, 2010, .fate = {.before_mm = 5}, .writes = 2, .offset_mm = {-10, -10},
     .err = "",
     .out = FAR ONE "hps167s:1: measured 1995 mm (median of 25, spread 0 mm), known 2000 mm: 5 mm too near\n"
                    "hps167s:1: writing offset -10 mm to flash (write 2 of at most 2)\n" THERE RIGHT
                    "offset: -10 mm; flash writes: 2; #12 replaces the old offset\n"},
    {"it is right", "", fixed, 2000, .out = THERE RIGHT "nothing was written\n", .err = ""},
    {"a dry run", "--dry-run", fixed, 2015, .status = 1, .err = "",
     .out = FAR "hps167s:1: nothing was written; without --dry-run, offset -15 mm would be\n"},
    {"a dry run in JSON", "--dry-run --format json", fixed, 2015, .status = 1, .err = "",
     .says = {"\"status\":\"dry_run\"", "\"written_mm\":[],\"would_write_mm\":-15,"}},
    {"JSON", "--format json", fixed, 2015, .writes = 1, .offset_mm = {-15, -15}, .err = "fathom: " ONE,
     .out = "{\"name\":\"hps167s:1\",\"model\":\"hps167s\",\"mode\":\"modbus\",\"address\":1,\"status\":"
            "\"right\","
            "\"known_mm\":2000,\"measured_mm\":[2015,2000],\"spread_mm\":0,\"tolerance_mm\":2,\"written_mm\":"
            "[-15],"
            "\"offsets\":[{\"offset_mm\":-15,\"is_added\":false},{\"offset_mm\":-15,\"is_added\":true}]}\n"},

    /* a write that is lost: the distance shows whether the offset was accepted */
    {"the write is lost", "", fixed, 2015, .fate = {.lost_write = 1}, .status = 1, .writes = 1,
     .out = FAR ONE FAR,
     .err = "fathom: hps167s:1: offset -15 mm was not acknowledged, and the sensor still measures 2015 mm\n"
            "fathom: hps167s:1: flash writes: 1; " NOW
            "-15 mm, the old offset minus 15 mm or the old offset\n" AGAIN},
    {"the second write is lost", "", fixed, 2010, .fate = {.before_mm = 5, .lost_write = 2}, .status = 1,
     .writes = 2, .offset_mm = {-15, -15},
     .err = "fathom: hps167s:1: offset -10 mm was not acknowledged, and the sensor still measures 1995 mm\n"
            "fathom: hps167s:1: flash writes: 2; " NOW "-10 mm or -15 mm\n"
            "fathom: #12 replaces the old offset, so you can calibrate again.\n"},
    {"the acknowledgement is lost", "", fixed, 2015, .fate = {.lost_write = 1, .is_taken = true}, .writes = 1,
     .offset_mm = {-15, -15}, .err = ""},
    {"it is lost where #12 adds", "", fixed, 2010,
     .fate = {.adds = true, .before_mm = 5, .lost_write = 1, .is_taken = true}, .writes = 1,
     .offset_mm = {-10, -10}, .err = ""},
    {"it is lost where #12 replaces", "", fixed, 2010,
     .fate = {.before_mm = 5, .lost_write = 1, .is_taken = true}, .writes = 2, .offset_mm = {-10, -10},
     .err = ""},
    {"the second one is lost", "", fixed, 2010, .fate = {.before_mm = 5, .lost_write = 2, .is_taken = true},
     .writes = 2, .offset_mm = {-10, -10}, .err = ""},
    /* 11: the gateway received nothing from the device, which may have accepted the write */
    {"a gateway responds", "", fixed, 2015, .fate = {.lost_write = 1, .is_taken = true, .exception = 11},
     .writes = 1, .offset_mm = {-15, -15}, .err = ""},
    /* the sensor reports the refusal, whatever it has done */
    {"the write is refused", "", fixed, 2015, .fate = {.lost_write = 1, .is_taken = true, .exception = 3},
     .status = 1, .writes = 1, .offset_mm = {-15, -15}, .out = FAR ONE,
     .says = {"fathom: hps167s:1: offset -15 mm was not written: ", NONE}},
    {"the write is not sent", "", fixed, 2015, .fate = {.is_deaf = true}, .status = 1, .out = FAR ONE,
     .says = {"fathom: hps167s:1: offset -15 mm was not written: no response", NONE}},
    {"it has this offset already", "", fixed, 2030, .fate = {.before_mm = -15}, .status = 1, .writes = 1,
     .offset_mm = {-15, -15}, .out = FAR ONE FAR,
     .err = "fathom: hps167s:1: offset -15 mm was acknowledged, but the sensor still measures 2015 mm. The "
            "offset takes effect at the next power-on, or the sensor had this offset already, or it did not "
            "accept it\n"
            "fathom: hps167s:1: flash writes: 1; " NOW
            "-15 mm, the old offset minus 15 mm or the old offset\n" AGAIN},
    /* the first measurement takes 3 s, the second one 4 s */
    {"Ctrl-C", "", fixed, 2015, .ctrl_c_us = 5000000, .status = 1, .writes = 1, .offset_mm = {-15, -15},
     .out = FAR ONE, .says = {NOW "-15 mm or the old offset minus 15 mm\n"}},

    /* samples */
    {"they differ too much", "", noisy, 11, .status = 1, .out = "",
     .says = {"the samples differ by 22 mm, more than --spread 20. Hold the sensor and the target still",
              NONE}},
    {"they differ a little", "", noisy, 3, .writes = 1, .offset_mm = {-18, -12}, .err = "",
     .says = {"right within 3 mm"}},
    {"the distance moves", "", moving, .status = 1, .out = "", .says = {"the median does not settle", NONE}},
    {"the first one after a write is old", "", stale, .writes = 1, .offset_mm = {-15, -15}, .err = "",
     .says = {"right within 2 mm"}},
    {"the larger spread of two batches counts", "", noisy_at_first, .err = "",
     .says = {"spread 6 mm)", "right within 3 mm"}},
    {"the target comes and goes", "", at_times, .status = 1, .out = "", .says = {"no target in range", NONE}},
    {"a slow filter", "", filtered, .writes = 1, .offset_mm = {-17, -13}, .err = ""},
    {"four responses are lost", "", fixed, 2000, .fate = {.silent = 4}, .err = "",
     .says = {RIGHT "nothing was written"}},
    {"five responses are lost", "", fixed, 2000, .fate = {.silent = 5}, .status = 1, .out = "",
     .says = {"cannot measure: no response", NONE}},
    {"no target", "", fixed, FATHOM_SIM_NO_TARGET, .status = 1, .out = "",
     .says = {"no target in range. Aim the sensor at a flat, light target", NONE}},
    {"a fault", "", fixed, FATHOM_SIM_FAULT, .status = 1, .out = "",
     .says = {"the sensor reports a fault", NONE}},
    {"too near", "", fixed, 79, .status = 1, .out = "",
     .says = {"the distance is below the range, 80 mm", NONE}},
    {"one sample without a target", "", late_target, .err = "", .says = {RIGHT "nothing was written"}},
};

static void begin(const row_t *row)
{
    static fathom_sim_fault_t silence;
    fate = row->fate;
    requests = 0;
    bench_begin();
    memset(&scene, 0, sizeof scene);
    scene.amount = row->amount;
    scene.begin_us = bench.clock.now_us;
    bench_hps167s((fathom_sim_hps167s_config_t){
        .offset_adds = fate.adds, .faults = &faults, .scene = {row->look, NULL}});
    bench.hps167s.sensor.offset_mm = bench.hps167s.user.offset_mm = fate.before_mm;
    bench.tool.ctrl_c_us = row->ctrl_c_us;
    if (fate.silent == 0) return;
    fathom_sim_fault_init(&silence, 1);
    fathom_sim_fault_add(&silence, FATHOM_SIM_FAULT_SILENCE, FATHOM_SIM_FAULT_ALWAYS_PPM, 3)->run =
        fate.silent;
    fathom_sim_fault_attach(&silence, &bench.line, &bench.hps167s.device);
}

#define CALIBRATE "calibrate hps167s --port line --known 2000 "

TEST(the_device_is_right_afterwards_or_the_report_is_true)
{
    for (const row_t *row = runs; row != runs + sizeof runs / sizeof runs[0]; row++) {
        begin(row);
        const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE "%s", row->options);
        const int16_t offset_mm = bench.hps167s.sensor.offset_mm;
        bool is_right = run->status == row->status && requests == row->writes;
        if (offset_mm < row->offset_mm[0] || offset_mm > row->offset_mm[1]) is_right = false;
        if (row->out != NULL && strcmp(run->out, row->out) != 0) is_right = false;
        if (row->err != NULL && strcmp(run->err, row->err) != 0) is_right = false;
        for (size_t i = 0; i != 2 && row->says[i] != NULL; i++)
            if (strstr(run->out, row->says[i]) == NULL && strstr(run->err, row->says[i]) == NULL)
                is_right = false;
        if (!is_right)
            fail_msg("%s: exit status %d, %u writes, offset %d\n%s%s", row->name, run->status, requests,
                     offset_mm, run->out, run->err);
    }
}

/* Half the spread is 11 mm, and d = -15 within twice that. */
TEST(a_large_spread_may_be_ambiguous_but_never_wrong)
{
    begin(&(row_t){.look = noisy, .amount = 11});
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE "--spread 22");
    const int off_mm = 15 + bench.hps167s.sensor.offset_mm;
    assert_true(run->status != 0 || (off_mm >= -11 && off_mm <= 11));
}

/* As the advice states. */
TEST(an_offset_of_0_removes_the_old_offset)
{
    begin(&(row_t){.look = fixed, .amount = 2030, .fate = {.before_mm = -15}});
    ASSERT_RUN(1, CALIBRATE);
    ASSERT_RUN(0, "set hps167s --port line distance-offset 0");
    ASSERT_RUN(0, CALIBRATE);
    assert_int_equal(bench.hps167s.sensor.offset_mm, -30);
}

TEST(without_a_sensor_the_cause_is_printed)
{
    bench_begin();
    const tool_run_t *const run = tool_run(&bench.tool, CALIBRATE);
    assert_int_equal(run->status, 1);
    assert_non_null(strstr(run->err, "cannot measure: no response"));
}

REFUSES(wrong_usage, "calibrate",
        {"a16 --port line --known 2000", "a16 has no distance offset. Only an hps167s"},
        {"hps167s --port line", "--known is missing"}, {"hps167s --port line --known 79", "from 80 to 18000"},
        {"hps167s --port line --known 18001", "from 80 to 18000"},
        {"hps167s --port line --known 2000 --samples 4", "from 5 to 200"},
        {"hps167s --port line --known 2000 --samples 201", "from 5 to 200"},
        {"hps167s --port line --known 2000 2000", "'2000' is one word too many."},
        {"hps167s --known 2000", "--port is missing"})
