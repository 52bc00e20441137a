/* SPDX-License-Identifier: MIT */
#ifndef FATHOM_HPS167S_REGISTERS_H
#define FATHOM_HPS167S_REGISTERS_H

#include <stdbool.h>
#include <stdint.h>

#include "fathom/sample.h"
#include "fathom/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * HPS-167S: where its commands #1 to #15 are, and what their values mean (datasheet, 3 and table 8). Pure functions:
 * no time, no I/O, no state. hps167s.h and its like talk to the device.
 *
 * The registers of a response are handed over as fathom_modbus_message_t has them, first one first, and all of them:
 * FATHOM_HPS167S_..._COUNT, or one. Nothing here checks an address or a length.
 */

/* The address of each command. All are read with function 03 up to #6, and written one at a time (06) from #7 on, but
 * for #15 (10). Two of them LOSE SETTINGS: a read of #6, with any count, and FATHOM_HPS167S_FACTORY written to #13. */
enum {
    FATHOM_HPS167S_VERSION = 0x0001,       /* #1 */
    FATHOM_HPS167S_CONFIGURATION = 0x0002, /* #2 */
    FATHOM_HPS167S_DETAILS = 0x0003,       /* #3 */
    FATHOM_HPS167S_TEMPERATURE = 0x0004,   /* #4 */
    FATHOM_HPS167S_MEASUREMENT = 0x0008,   /* #5 */
    FATHOM_HPS167S_RESET = 0x0009,         /* #6, of the interface; response: _RESET_DONE or an error code */
    FATHOM_HPS167S_WARM_UP = 0x000A,       /* #7: seconds; #2 has 255 at most */
    FATHOM_HPS167S_ADDRESS = 0x0010,       /* #8: 1..FATHOM_HPS167S_MAX_ADDRESS */
    FATHOM_HPS167S_BAUD = 0x0011,          /* #9: fathom_hps167s_baud_code */
    FATHOM_HPS167S_MEASURES = 0x0012,      /* #10: FATHOM_HPS167S_OFF or _ON */
    FATHOM_HPS167S_TERMINATION = 0x0013,   /* #11: the same */
    FATHOM_HPS167S_OFFSET = 0x0014,        /* #12: mm, int16_t */
    FATHOM_HPS167S_LOAD = 0x0015,          /* #13: FATHOM_HPS167S_USER or _FACTORY */
    FATHOM_HPS167S_FILTER = 0x0016,   /* #14: int16_t, FATHOM_HPS167S_MAX_FILTER at most is recommended */
    FATHOM_HPS167S_RECONNECT = 0x0020 /* #15: fathom_hps167s_encode_reconnect_time */
};

/* How many registers a command has, where it is not one. */
enum {
    FATHOM_HPS167S_VERSION_COUNT = 3,
    FATHOM_HPS167S_CONFIGURATION_COUNT = 4,
    FATHOM_HPS167S_DETAILS_COUNT = 11,
    FATHOM_HPS167S_MEASUREMENT_COUNT = 4,
    FATHOM_HPS167S_RECONNECT_COUNT = 2,
    FATHOM_HPS167S_MAX_REGISTERS = FATHOM_HPS167S_DETAILS_COUNT
};

enum {
    FATHOM_HPS167S_MAX_ADDRESS = 32,
    FATHOM_HPS167S_BAUD_CODES = 4, /* from 1 */
    FATHOM_HPS167S_OFF = 0x0000,
    FATHOM_HPS167S_ON = 0x00FF,
    FATHOM_HPS167S_USER = 0x0000,
    FATHOM_HPS167S_FACTORY = 0x00FF,
    FATHOM_HPS167S_RESET_DONE = 0x0001,
    FATHOM_HPS167S_RECONNECT_STEP_MS = 18,
    FATHOM_HPS167S_MAX_FILTER = 100, /* and as much below 0 */
    FATHOM_HPS167S_MAX_EXPONENT = 16,
    FATHOM_HPS167S_FACTORY_WARM_UP_S = 5,
    FATHOM_HPS167S_UUID_LENGTH = 16
};
#define FATHOM_HPS167S_FACTORY_BAUD 19200uL

/* Bytes of a response, for fathom_hps167s_get_byte: of #2, of #3 and of #5. */
enum {
    FATHOM_HPS167S_TERMINATION_BYTE = 0,
    FATHOM_HPS167S_MEASURES_BYTE = 1,
    FATHOM_HPS167S_WARM_UP_BYTE = 2,
    FATHOM_HPS167S_RECONNECT_BYTE = 3, /* and the three behind it */
    FATHOM_HPS167S_BAUD_BYTE = 7,
    FATHOM_HPS167S_ACK_BYTE = 0,
    FATHOM_HPS167S_EXPONENT_BYTE = 4
};

/* Byte n of a response's registers, 0 the first, in the order of the wire. */
static inline uint8_t fathom_hps167s_get_byte(const uint16_t *registers, uint8_t n)
{
    return (uint8_t)(((n % 2u) == 0u) ? (registers[n / 2u] >> 8) : registers[n / 2u]);
}

/* A register that has a sign: #4, #12, #14. */
static inline int16_t fathom_hps167s_to_signed(uint16_t value)
{
    return (int16_t)((value < 0x8000u) ? (int32_t)value : ((int32_t)value - 0x10000));
}

/* #9: the rate of a code, of which all but 1..4 mean 19200; and the code of a rate, 0 where there is none. */
uint32_t fathom_hps167s_baud(uint16_t code);
uint8_t fathom_hps167s_baud_code(uint32_t baud);

/* ---- #1, table 10 ---- */

typedef struct {
    uint16_t year; /* 2000..2255 */
    uint8_t month; /* 1..12, if the device was set right */
    uint8_t day;   /* 1..31 */
    uint8_t major;
    uint8_t minor;
    uint8_t revision;
} fathom_hps167s_version_t;

void fathom_hps167s_decode_version(const uint16_t registers[3], fathom_hps167s_version_t *version);

/* Can this be the date of #1 or of #3? */
bool fathom_hps167s_is_date(uint8_t month, uint8_t day);

/* ---- #2, table 12, and #15 ---- */

/* What takes effect at the next power-on (hps167s_settings.h) reads as it was set. */
typedef struct {
    uint32_t baud;              /* what baud_code means by #9, whose "others are all 19200" */
    uint32_t reconnect_time_ms; /* what #15 sets is a multiple of 18; what is read may be anything */
    uint8_t warm_up_s;
    uint8_t baud_code; /* as it is read; table 12 has no encoding of its own */
    bool termination; /* the resistor; on in every unit from the factory, and eight of them overload a line */
    bool measures_after_power_on;
} fathom_hps167s_configuration_t;

/* low_word_first: of the reconnect time; the datasheet leaves it open. */
void fathom_hps167s_decode_configuration(const uint16_t registers[4], bool low_word_first,
                                         fathom_hps167s_configuration_t *configuration);

/* Can these four registers be a response to #2, and not one to #5, which has the same shape? By their values:
 * the first two bytes are 00 or FF, and it is not the abnormal packet. */
bool fathom_hps167s_may_be_configuration(const uint16_t registers[4]);

/* The reconnect time, ms, in a response to #2. */
uint32_t fathom_hps167s_configured_reconnect_time_ms(const uint16_t registers[4], bool low_word_first);

/* The two registers of #15, and what they mean. The device takes multiples of FATHOM_HPS167S_RECONNECT_STEP_MS. */
void fathom_hps167s_encode_reconnect_time(uint32_t ms, bool low_word_first, uint16_t registers[2]);
uint32_t fathom_hps167s_decode_reconnect_time(uint16_t first, uint16_t second, bool low_word_first);

/* ---- #3, table 14 ---- */

typedef struct {
    uint8_t uuid[FATHOM_HPS167S_UUID_LENGTH]; /* in the order of the wire */
    uint16_t year;                            /* 2000..2255 */
    uint8_t month;
    uint8_t day;
    uint8_t major;
    uint8_t minor;
} fathom_hps167s_details_t;

void fathom_hps167s_decode_details(const uint16_t registers[11], fathom_hps167s_details_t *details);

/* Does it begin with the byte B0? */
bool fathom_hps167s_may_be_details(const uint16_t registers[11]);

/* ---- #4 ---- */

/* The temperature of the analog front end in tenths of a degree Celsius, rounded to the nearest, where the device
 * has so many steps (1..255) to a degree Fahrenheit. */
int32_t fathom_hps167s_temperature_dc(int16_t fahrenheit, uint8_t steps_per_degree);

/* ---- #5, table 18 ---- */

/* What a distance is taken for. The datasheet says "65.53 meters" for over range (#5), two decimals of a figure in mm,
 * and gives a range of 18 m and a note about 20 m; what lies between is no value of this device. */
typedef struct {
    uint16_t max_mm;        /* min_mm..max_mm is a target; 0: 30000 */
    uint16_t over_range_mm; /* from here to 65534 is no target; over max_mm; 0: 65530 */
    uint16_t min_mm;        /* 1..min_mm - 1 is FATHOM_UNKNOWN; up to max_mm; 0: 80 */
} fathom_hps167s_limits_t;

/* Fills in the defaults for what is 0. FATHOM_OK, or FATHOM_ERR_ARGUMENT: over_range_mm that is 65535 or not over
 * max_mm, or min_mm over max_mm. */
fathom_status_t fathom_hps167s_complete_limits(fathom_hps167s_limits_t *limits);

/* "The values of Distance, Ambient, and Precision are all 0xFF and the value of Magnitude is 0x00", whatever the
 * exponent is: the device has failed. */
bool fathom_hps167s_is_abnormal(const uint16_t registers[4]);

/*
 * Reads the four registers of a measurement's response, also one that came unasked. Sets the members of *sample that
 * come from the device: kind, raw, distance_mm, magnitude, ambient, precision, and interference (false). FATHOM_OK,
 * or FATHOM_ERR_MALFORMED, with nothing written: a distance that it cannot mean, or an exponent over 16. decode_within:
 * with other limits, of which none is 0; NULL: with the defaults.
 */
fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample);
fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
