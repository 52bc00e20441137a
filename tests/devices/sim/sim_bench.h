/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_SIM_SIM_BENCH_H
#define FATHOM_TESTS_SIM_SIM_BENCH_H

/* What the tests of the simulator share: a bench with a host at the near end of a line, which notes each byte, what its
 * UART says of it and the time of its last bit, and with sensors at the far end. Frames are bytes in hexadecimal, from
 * the datasheets where they print them; no codec has a part in them. */

#include "suite.h"

#include "sim/a05.h"
#include "sim/a16.h"
#include "sim/fault.h"
#include "sim/hps167.h"
#include "sim/hps167s.h"
#include "sim/scene.h"
#include "sim/sim.h"

static const fathom_line_settings_t bench_9600 = {9600, FATHOM_PARITY_NONE, 1};
static const fathom_line_settings_t bench_19200 = {19200, FATHOM_PARITY_EVEN, 1};
static const fathom_line_settings_t bench_115200 = {115200, FATHOM_PARITY_NONE, 1};

/* Where the clock starts: at nothing special; so that it wraps after 65 ms, 1 s, 3 ms; at the sign bit. */
enum { BENCH_STARTS = 5 };
extern const uint32_t bench_starts_us[BENCH_STARTS];
extern uint32_t bench_start_us; /* of this round */

void bench_begin_round(unsigned round);

/* Every test at every start, or at the first two: where what is looked at is no time, or where the test moves the start
 * itself. With FATHOM_LONG in the environment those run at every start as well. */
#define BENCH_ROUNDS     .begin_round = bench_begin_round, .rounds = BENCH_STARTS
#define BENCH_TWO_ROUNDS .begin_round = bench_begin_round, .rounds = 2, .long_rounds = BENCH_STARTS

#define LITERAL(...) (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})

/* a <= span <= b, where span may have wrapped */
#define ASSERT_SPAN(later_us, earlier_us, from_us, to_us)                                                    \
    assert_in_range(fathom_elapsed_us((later_us), (earlier_us)), (from_us), (to_us))

enum { MS = 1000, BENCH_ROOM = 4096 };

typedef fathom_sim_a16_config_t a16_config_t;
typedef fathom_sim_a05_config_t a05_config_t;
typedef fathom_sim_hps167s_config_t hps_config_t;
typedef fathom_sim_hps167_config_t hps167_config_t;

typedef struct {
    fathom_sim_line_t line;
    uint32_t now_us;
    uint32_t asked_us; /* when the last bit left that was said */
    size_t heard;      /* bytes, since they were forgotten or found to be right */
    uint8_t bytes[BENCH_ROOM];
    uint8_t flags[BENCH_ROOM]; /* of FATHOM_RX_PARITY, _FRAMING and _OVERRUN */
    uint32_t end_us[BENCH_ROOM];

    fathom_sim_fixed_t fixed;     /* what there is to measure, ... */
    fathom_sim_fixed_t processed; /* ... and what a sensor makes of it where that is another value */
    fathom_sim_a16_t a16;
    fathom_sim_a05_t a05;
    fathom_sim_hps167s_t hps;
    fathom_sim_hps167_t hps167;
    fathom_sim_device_t *device; /* the one of them that was added last */
    fathom_sim_fault_t fault;    /* of that device, where a test has attached it */
} bench_t;

extern bench_t bench;

#define FIXED(...) ((fathom_sim_fixed_t){{__VA_ARGS__}})
#define PROCESSED  fathom_sim_fixed(&bench.processed)

/* A16 6(4), example 2: its real-time value, 751 mm; and the automatic frame of that, FF + 02 + EF = 1F0. */
#define A16_ASKED    "01 03 01 01 00 01 D4 36"
#define A16_RESPONSE "01 03 02 02 EF F8 A8"
#define A16_FRAME    "FF 02 EF F0"

/* ---- the bench ---- */

/* An empty line at bench_start_us. */
void bench_begin(const fathom_line_settings_t *settings, bool full_duplex);

/* One more on the line. What it measures is bench.fixed unless its config says something else. */
void add_a16(uint8_t mode, a16_config_t config);
void add_a05(uint8_t mode, a05_config_t config);
void add_hps(hps_config_t config);
void add_hps167(hps167_config_t config);

/* Alone on a line that suits it. */
void set_a16(uint8_t mode, int32_t mm, a16_config_t config);
void set_a05(uint8_t mode, fathom_sim_fixed_t mm, a05_config_t config);
void set_hps(int32_t mm, hps_config_t config);
void set_hps167(int32_t mm, hps167_config_t config);

/* Another one than the bench's own. */
void attach(fathom_sim_device_t *device);

/* Off for so long; then, wait_ms later, it has said nothing. */
void cycle_power(uint32_t off_ms, uint32_t wait_ms);

/* The host's settings. */
void at_rate(uint32_t baud, uint8_t parity);

/* ---- what is said and heard ---- */

/* Lets time pass in one jump. */
void wait_us(uint32_t by_us);
static inline void wait_ms(uint32_t by_ms) { wait_us(by_ms * MS); }

/* Says it, and waits until so long after its last bit. */
void say_bytes(const uint8_t *bytes, size_t count);
void ask_bytes(const uint8_t *bytes, size_t count, uint32_t by_us);
void say(const char *hex);
void ask(const char *hex, uint32_t by_ms);

/* What was heard is that and nothing else; "" is silence. The test that fails says which row it was. */
#define expect(hex) bench_expect((hex), "", __FILE__, __LINE__)
#define hear(by_ms, hex)                                                                                     \
    (wait_ms(by_ms), bench_expect((hex), "", __FILE__, __LINE__)) /* when so much time has passed */
#define echoed(asked, by_ms)        transact((asked), (by_ms), (asked))
#define transact(asked, by_ms, hex) (ask((asked), (by_ms)), bench_expect((hex), (asked), __FILE__, __LINE__))

/* The first bytes of it, and the others so long after the last bit of those. */
void ask_in_two(const char *hex, size_t first, uint32_t gap_us);

/* Appends the CRC to the `length` bytes of a request in Modbus, and asks that. */
void ask_sealed(uint8_t *bytes, size_t length, uint32_t by_ms);

/* CRC-16 bit by bit, by MODBUS over Serial Line 6.2.2 and not by the library; 0 over a frame with the right one. */
uint16_t crc_by_bits(const uint8_t *bytes, size_t length);

/* Is that in `bytes`? */
bool is_hex(const uint8_t *bytes, const char *hex);

/* The bytes of `hex`, which may have blanks; returns how many. */
size_t from_hex(const char *hex, uint8_t *bytes, size_t capacity);

/* What was heard, and when, is what was heard then. */
void expect_as(const bench_t *before);

/* It is these bytes and no others. */
void heard_bytes(const uint8_t *bytes, size_t count);

static inline void forget(void) { bench.heard = 0; }

/* The first byte ended so long after what was asked. */
#define ASSERT_ANSWERED_IN(from_us, to_us) ASSERT_SPAN(bench.end_us[0], bench.asked_us, (from_us), (to_us))

void bench_expect(const char *hex, const char *asked, const char *file, int line);

/* ---- what a device has counted ---- */

enum { NONE = 0x7FFFFFFF }; /* 0, of a counter that is looked at */

/* COUNTED(.requests = 2, .answered = NONE): these of the device's counters, and no others. */
#define COUNTED(...) COUNTED_BY(bench.device, __VA_ARGS__)
#define COUNTED_BY(device, ...)                                                                              \
    bench_counted(&(device)->counters, &(fathom_sim_counters_t){__VA_ARGS__}, __FILE__, __LINE__)
void bench_counted(const fathom_sim_counters_t *counters, const fathom_sim_counters_t *expected,
                   const char *file, int line);

/* ---- faults of the device ---- */

/* Attaches them to the device that is there, on the same seed every time. */
void set_faults(uint32_t seed);
#define FAULT(kind, chance_ppm, frame)                                                                       \
    fathom_sim_fault_add(&bench.fault, FATHOM_SIM_FAULT_##kind, (chance_ppm), (frame))
enum { ALWAYS = 1000000 };

#endif
