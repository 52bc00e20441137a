/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_INSIDE_H
#define FATHOM_HPS167S_INSIDE_H

#include "fathom/hps167s.h"

/* What the parts of the HPS-167S's driver share. For nobody else. */

enum { FATHOM_HPS167S_CONFIGURATION = 0x0002, FATHOM_HPS167S_FACTORY_WARM_UP_S = 5 };

#define FATHOM_HPS167S_DEFAULT_COMMAND_TIMEOUT_US 1000000ul

static inline uint8_t high(uint16_t value) { return (uint8_t)(value >> 8); }
static inline uint8_t low(uint16_t value) { return (uint8_t)value; }

/* volatile: or compilers make it a call of memcpy, which costs more. */
static inline void copy_4(volatile uint16_t *to, const uint16_t *from)
{
    for (uint8_t i = 4; i != 0; i--) *to++ = *from++;
}

static inline bool same_4(const uint16_t *a, const uint16_t *b)
{
    uint8_t i = 0;
    while (i != 4 && a[i] == b[i]) i++;
    return i == 4;
}

/* #5: "the values of Distance, Ambient, and Precision are all 0xFF and the value of Magnitude is 0x00". */
bool fathom_hps167s_is_abnormal(const uint16_t registers[4]);

/* For so long after an unasked frame another one is to be expected. */
#define FATHOM_HPS167S_UNASKED_US 2000000ul

/* A command that reads `count` registers into sensor->values. */
fathom_status_t fathom_hps167s_command(fathom_hps167s_t *sensor, uint16_t first, uint8_t count);

/* `question` as all commands have it; the caller sets what is its own. */
void fathom_hps167s_describe(const fathom_hps167s_t *sensor, uint16_t first,
                             fathom_modbus_question_t *question);

/* Is this command that reads the last thing that was asked? */
bool fathom_hps167s_has_asked(const fathom_hps167s_t *sensor, uint16_t first);

/* Fills in the defaults; FATHOM_READY or FATHOM_ERR_ARGUMENT. */
fathom_status_t fathom_hps167s_set_limits(fathom_hps167s_limits_t *limits,
                                          const fathom_hps167s_limits_t *wanted);

/* How long after power-on silence is no error. */
void fathom_hps167s_expect_warm_up(fathom_hps167s_t *sensor, uint8_t warm_up_s);

/* The line settings where the device is, or was before the setting that is under way. */
const fathom_line_settings_t *fathom_hps167s_here(const fathom_hps167s_t *sensor);

/* Those with another rate, in that half of `moved` which is not in use here. */
const fathom_line_settings_t *fathom_hps167s_with_baud(fathom_hps167s_t *sensor, uint32_t baud);

#endif
