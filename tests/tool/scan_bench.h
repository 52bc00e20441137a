/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_TOOL_SCAN_BENCH_H
#define FATHOM_TESTS_TOOL_SCAN_BENCH_H

#include "sim/fault.h"
#include "tool_bench.h"

/* `fathom scan` at simulated devices on one pair. The bench reads each request that leaves. */
enum { SCAN_BENCH_UNITS = 4, SCAN_BENCH_RATES = 6 };

typedef struct {
    fathom_sim_a16_t a16[SCAN_BENCH_UNITS];
    fathom_sim_a05_t a05[SCAN_BENCH_UNITS];
    fathom_sim_hps167s_t hps167s[SCAN_BENCH_UNITS];
    unsigned a16_count, a05_count, hps167s_count;
    fathom_uart_t inner;    /* of the line */
    uint32_t coarse_us;     /* not 0: the main loop runs once in this time */
    uint32_t refused_baud;  /* a rate that the port does not have */
    uint32_t lost_register; /* requests for this register do not reach the line */
    bool is_broken;         /* the port fails when it reads */
    unsigned requests;
    unsigned harmful;  /* requests that a scan may not send */
    uint32_t first_us; /* time from the start of the command to its first request */
    uint32_t start_us;
    unsigned probed[SCAN_BENCH_RATES][3]; /* first requests, by rate and parity */
} scan_bench_t;

extern scan_bench_t scans;

/* Makes an empty line. */
void scan_begin(void);
int scan_set_up(void **state);

fathom_sim_device_t *add_a16(fathom_sim_a16_config_t config);
fathom_sim_device_t *add_a05(fathom_sim_a05_config_t config);
fathom_sim_device_t *add_hps167s(fathom_sim_hps167s_config_t config);

/* Makes responses of a device fail: a kind of port/sim/fault.h, by chance (in millionths) or at one frame. */
const fathom_sim_fault_t *add_fault(fathom_sim_device_t *device, uint8_t kind, uint32_t chance_ppm,
                                    uint32_t at_frame, uint32_t seed);

/* Runs `fathom scan --port line` with more options. Fails if a request could have changed a device. */
const tool_run_t *scan(const char *options);

/* Returns the findings of the last scan, one like "a16 1 9600 8N1", or "? - 9600 8N1" without a name and an address,
 * separated by ", ". */
const char *scan_found(void);

/* Runs a scan, whose findings are these. */
const tool_run_t *scan_finds(const char *findings, const char *options);

void assert_says(const tool_run_t *run, const char *text); /* on one of its two outputs */

/* ---- devices that are none of the three sensors; one of each kind at a time ---- */

/* Responds to reads in Modbus. */
typedef struct {
    uint16_t value;    /* of every register, ... */
    uint16_t version;  /* ... except from 0001 on, where an HPS-167S has its interface version (#1) */
    uint16_t address;  /* ... and in 0200 */
    uint16_t only[2];  /* not 0: the only registers to which it responds */
    uint8_t exception; /* not 0: it responds with this exception */
} stranger_t;
void add_stranger(uint8_t unit, stranger_t stranger, const fathom_line_settings_t *line);

/* Sends the same bytes every `period_us`, or (0) as the response to each frame. `address` of the returned device, if it
 * is not 0: only to frames that begin with it. */
fathom_sim_device_t *add_speaker(const fathom_line_settings_t *line, uint32_t period_us, const uint8_t *bytes,
                                 uint8_t length);

extern const fathom_line_settings_t dyp_line;     /* 9600 8N1 */
extern const fathom_line_settings_t hps167s_line; /* 19200 8E1 */

/* The response of the example in HPS-167S #5; A16 6, the first example: a request to address 1 for 0100 and its
 * response; and bytes of no protocol. */
extern const uint8_t hps_response[13];
extern const uint8_t a16_request[8];
extern const uint8_t a16_response[7];
extern const uint8_t junk[6];

#endif
