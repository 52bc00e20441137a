/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_TESTS_HPS_DESK_H
#define FATHOM_TESTS_HPS_DESK_H

#include "desk.h"
#include "fathom/sensor/hps167s_info.h"
#include "fathom/sensor/hps167s_settings.h"

/* desk.h with an HPS-167S. */
extern const fathom_modbus_t *hps_transport; /* as hps_config */
extern fathom_hps167s_config_t hps_config;
extern fathom_hps167s_t hps;

extern const fathom_line_settings_t hps_factory; /* 19200 8E1 */
extern const uint16_t hps_measured[4];           /* command #5: 2.083 m */
extern const uint16_t hps_abnormal[4];           /* the same: "abnormal packet" */

/* Before each test: a driver with the default config. hps_start: init anew, on the memory as it is. hps_start_at: all
 * anew, at this address and with these settings of the line. */
int hps_set_up(void **state);
void hps_start(void);
void hps_start_at(uint8_t address, const fathom_line_settings_t *settings);

/* The next measurement is asked of this unit at this rate, 3 s later; 0: no settings are named. Then it is answered
 * with the example of command #5, or not at all, which fathom_poll tells like this. */
void hps_asks(uint8_t unit, uint32_t baud);
void hps_answers(void);
void hps_is_silent(fathom_status_t as);

/* Requests of commands #1, #2, #5 and #6 (tables 9, 11, 17, 19), for rows of desk.h. */
#define HPS_1(unit, ends, baud)                                                                              \
    {                                                                                                        \
        {unit, 3, 0, 1, 0, 3}, ends, {0x1409, 0x1B02, 0x0100, 0}, baud                                       \
    }
#define HPS_2(unit, ends, baud, ...)                                                                         \
    {                                                                                                        \
        {unit, 3, 0, 2, 0, 4}, ends, {__VA_ARGS__}, baud                                                     \
    }
#define HPS_5(ends, ...)                                                                                     \
    {                                                                                                        \
        {1, 3, 0, 8, 0, 4}, ends, {__VA_ARGS__}, 0                                                           \
    }
#define HPS_6(unit, ends, says, baud)                                                                        \
    {                                                                                                        \
        {unit, 3, 0, 9, 0, 1}, ends, {says}, baud                                                            \
    }
/* A write of one register whose address has no high byte. */
#define HPS_WRITE(unit, address, value, ends, baud)                                                          \
    {                                                                                                        \
        {unit, 6, 0, address, HIGH(value), LOW(value)}, ends, {2}, baud                                      \
    }
/* A response to #2 whose rate has this code; and two that agree. */
#define TWO(unit, ends, code, baud) HPS_2(unit, ends, baud, 0xFFFF, 0x0500, 0x0000, 0xB400 + code)
#define IS(unit, code, baud)        TWO(unit, FATHOM_OK, code, baud), TWO(unit, FATHOM_OK, code, baud)
/* Two of unit 1 with these registers; table 12: termination FF, automatic FF, warm-up 5 s, reconnect 180 ms, rate 1. */
#define TELLS(...) HPS_2(1, OK, 0, __VA_ARGS__), HPS_2(1, OK, 0, __VA_ARGS__)
#define FACTORY    TELLS(0xFFFF, 0x0500, 0x0000, 0xB401)

/* With a driver of its own, whose command has this argument. */
#define PLAY_AT(unit, settings, its_argument, command, status, ...)                                          \
    do {                                                                                                     \
        hps_start_at(unit, settings);                                                                        \
        desk.argument = its_argument;                                                                        \
        PLAY(command, status, __VA_ARGS__);                                                                  \
    } while (0)

/* A test that is this, and where the next measurement is asked. */
#define FOLLOWS(promise, then_unit, then_baud, ...)                                                          \
    TEST(promise)                                                                                            \
    {                                                                                                        \
        PLAY_AT(__VA_ARGS__);                                                                                \
        hps_asks(then_unit, then_baud);                                                                      \
    }

#define OK     FATHOM_OK
#define SILENT FATHOM_ERR_NO_RESPONSE

/* In a fine loop and in one that comes round every 20 ms, and across the wrap of the clock. */
enum { HPS_ROUNDS = 4 };
void hps_begin_round(unsigned round);

#define HPS_SUITE                                                                                            \
    static const suite_t suite = {.set_up = hps_set_up, .begin_round = hps_begin_round, .rounds = HPS_ROUNDS}

#endif
