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

/**
 * @file
 * @brief The commands of the HPS-167S and the meaning of their registers (datasheet 3, tables 8 to 38).
 *
 * The functions decode the registers of a response and encode those of a request. They are pure: they have no time, no
 * I/O and no state. They check neither addresses nor lengths, and they do not send anything: hps167s.h,
 * hps167s_info.h and hps167s_settings.h do. include/COST.md has the flash of all of them (`hps167s_registers`).
 *
 * @code
 * uint16_t registers[FATHOM_HPS167S_MEASUREMENT_COUNT] = {0x0823, 0xDCB2, 0x0701, 0x0000};
 * fathom_sample_t measured;
 * if (fathom_hps167s_decode(registers, &measured) == FATHOM_OK) use(measured.distance_mm);   // 2083 mm
 * @endcode
 *
 * Registers are passed in the order of the response, as fathom_modbus_message_t has them. All registers of the command
 * must be there: FATHOM_HPS167S_..._COUNT, or one. All pointers are used only during the call.
 */

/**
 * @brief Address of each command.
 *
 * #1 to #6 are read with function 03, each with its own number of registers. #7 to #14 are written with function 06,
 * and #15 with function 10.
 *
 * @warning Two commands LOSE SETTINGS: a read of #6, with any number of registers, and FATHOM_HPS167S_FACTORY written
 * to #13.
 */
enum {
    FATHOM_HPS167S_VERSION = 0x0001,       /**< #1: version of the interface firmware (table 9). */
    FATHOM_HPS167S_CONFIGURATION = 0x0002, /**< #2: configuration of the interface (table 11). */
    FATHOM_HPS167S_DETAILS = 0x0003,       /**< #3: details of the sensor (table 13). */
    FATHOM_HPS167S_TEMPERATURE = 0x0004,   /**< #4: temperature of the analog front end (table 15). */
    FATHOM_HPS167S_MEASUREMENT = 0x0008,   /**< #5: a measurement (table 17). */
    /** #6: RESETS the settings of the interface (table 19). Response: FATHOM_HPS167S_RESET_DONE or an error code. */
    FATHOM_HPS167S_RESET = 0x0009,
    FATHOM_HPS167S_WARM_UP = 0x000A,     /**< #7: warm-up time in s. #2 reports at most 255 (table 21). */
    FATHOM_HPS167S_ADDRESS = 0x0010,     /**< #8: address, 1 to FATHOM_HPS167S_MAX_ADDRESS (table 23). */
    FATHOM_HPS167S_BAUD = 0x0011,        /**< #9: fathom_hps167s_baud_code() of the rate (table 25). */
    FATHOM_HPS167S_MEASURES = 0x0012,    /**< #10: measures after power-on; _OFF or _ON (table 27). */
    FATHOM_HPS167S_TERMINATION = 0x0013, /**< #11: termination resistor; _OFF or _ON (table 29). */
    FATHOM_HPS167S_OFFSET = 0x0014,      /**< #12: distance offset in mm, an int16_t (table 31). */
    FATHOM_HPS167S_LOAD = 0x0015,        /**< #13: FATHOM_HPS167S_USER or _FACTORY (table 33). */
    FATHOM_HPS167S_FILTER = 0x0016,      /**< #14: filter sensitivity, an int16_t (table 35). */
    FATHOM_HPS167S_RECONNECT = 0x0020    /**< #15: fathom_hps167s_encode_reconnect_time() (table 37). */
};

/** @brief Number of registers of a command. Commands that are not listed have one. */
enum {
    FATHOM_HPS167S_VERSION_COUNT = 3,                           /**< #1. */
    FATHOM_HPS167S_CONFIGURATION_COUNT = 4,                     /**< #2. */
    FATHOM_HPS167S_DETAILS_COUNT = 11,                          /**< #3. */
    FATHOM_HPS167S_MEASUREMENT_COUNT = 4,                       /**< #5. */
    FATHOM_HPS167S_RECONNECT_COUNT = 2,                         /**< #15. */
    FATHOM_HPS167S_MAX_REGISTERS = FATHOM_HPS167S_DETAILS_COUNT /**< The most that a command has. */
};

/** @brief Values and limits. */
enum {
    FATHOM_HPS167S_MAX_ADDRESS = 32,       /**< Greatest address (2.2.1). */
    FATHOM_HPS167S_BAUD_CODES = 4,         /**< Greatest baud code of #9; the least is 1. */
    FATHOM_HPS167S_OFF = 0x0000,           /**< #10, #11: not enabled. */
    FATHOM_HPS167S_ON = 0x00FF,            /**< #10, #11: enabled. */
    FATHOM_HPS167S_USER = 0x0000,          /**< #13: the settings of the user. */
    FATHOM_HPS167S_FACTORY = 0x00FF,       /**< #13: the factory settings. LOSES those of the user. */
    FATHOM_HPS167S_RESET_DONE = 0x0001,    /**< #6: response of a reset that succeeded (table 20). */
    FATHOM_HPS167S_RECONNECT_STEP_MS = 18, /**< #15: the time is a multiple of this, in ms. */
    FATHOM_HPS167S_MAX_FILTER = 100,       /**< #14: greatest recommended value; the least is -100. */
    FATHOM_HPS167S_MAX_EXPONENT = 16,      /**< #5: greatest exponent that the decoder accepts. */
    FATHOM_HPS167S_FACTORY_WARM_UP_S = 5,  /**< #7: factory setting in s. */
    FATHOM_HPS167S_UUID_LENGTH = 16        /**< #3: bytes of the UUID. */
};

/** @brief Baud rate with factory settings, in bits per second (table 6). */
#define FATHOM_HPS167S_FACTORY_BAUD 19200uL

/** @brief Positions of bytes in a response, for fathom_hps167s_get_byte(). */
enum {
    FATHOM_HPS167S_TERMINATION_BYTE = 0, /**< #2: termination resistor, 00 or FF. */
    FATHOM_HPS167S_MEASURES_BYTE = 1,    /**< #2: measures after power-on, 00 or FF. */
    FATHOM_HPS167S_WARM_UP_BYTE = 2,     /**< #2: warm-up time in s. */
    FATHOM_HPS167S_RECONNECT_BYTE = 3,   /**< #2: first of the four bytes of the reconnect time. */
    FATHOM_HPS167S_BAUD_BYTE = 7,        /**< #2: baud code. */
    FATHOM_HPS167S_ACK_BYTE = 0,         /**< #3: always B0. */
    FATHOM_HPS167S_EXPONENT_BYTE = 4     /**< #5: exponent of the magnitude. */
};

/**
 * @brief Returns one byte of a response.
 *
 * @param registers  The registers of the response.
 * @param n          Position of the byte in the order of the wire; 0 is the first.
 */
static inline uint8_t fathom_hps167s_get_byte(const uint16_t *registers, uint8_t n)
{
    return (uint8_t)(((n % 2u) == 0u) ? (registers[n / 2u] >> 8) : registers[n / 2u]);
}

/** @brief Returns the value of a signed register (#4, #12, #14). */
static inline int16_t fathom_hps167s_to_signed(uint16_t value)
{
    return (int16_t)((value < 0x8000u) ? (int32_t)value : ((int32_t)value - 0x10000));
}

/** @brief Returns the rate of a baud code (#9): 57600, 115200, 230400 for 2, 3, 4, and 19200 for all others. */
uint32_t fathom_hps167s_baud(uint16_t code);

/** @brief Returns the baud code of a rate (#9), 1 to 4. Returns 0 if the sensor does not have this rate. */
uint8_t fathom_hps167s_baud_code(uint32_t baud);

/* ---- #1, table 10 ---- */

/** @brief Date and version of the interface firmware (#1). */
typedef struct {
    uint16_t year;    /**< 2000 to 2255. */
    uint8_t month;    /**< 1 to 12, if the maker has set it: see fathom_hps167s_is_date(). */
    uint8_t day;      /**< 1 to 31, if the maker has set it. */
    uint8_t major;    /**< Major version. */
    uint8_t minor;    /**< Minor version. */
    uint8_t revision; /**< Revision. */
} fathom_hps167s_version_t;

/**
 * @brief Decodes the response to #1.
 *
 * @param registers  The 3 registers.
 * @param version    Written always.
 */
void fathom_hps167s_decode_version(const uint16_t registers[3], fathom_hps167s_version_t *version);

/**
 * @brief Returns true if a date of #1 or #3 can be a date.
 *
 * @param month  1 to 12 can be a month.
 * @param day    1 to 31 can be a day. The length of the month is not checked.
 */
bool fathom_hps167s_is_date(uint8_t month, uint8_t day);

/* ---- #2, table 12, and #15 ---- */

/**
 * @brief Configuration of the interface (#2).
 *
 * A setting that takes effect at the next power-on (hps167s_settings.h) reads as it was set.
 */
typedef struct {
    uint32_t baud;                /**< Rate that #9 gives to `baud_code`, in bits per second. */
    uint32_t reconnect_time_ms;   /**< In ms. #15 sets multiples of 18; a sensor may report any value. */
    uint8_t warm_up_s;            /**< Warm-up time in s. */
    uint8_t baud_code;            /**< As sent. Table 12 has no code of its own, so that of #9 is assumed. */
    bool termination;             /**< True if the termination resistor is on, as in every new unit. */
    bool measures_after_power_on; /**< True if the sensor measures continuously after power-on. */
} fathom_hps167s_configuration_t;

/**
 * @brief Decodes the response to #2.
 *
 * @param registers       The 4 registers.
 * @param low_word_first  True if the low word of the reconnect time comes first. The datasheet leaves this open.
 * @param configuration   Written always.
 */
void fathom_hps167s_decode_configuration(const uint16_t registers[4], bool low_word_first,
                                         fathom_hps167s_configuration_t *configuration);

/**
 * @brief Returns true if four registers can be a response to #2, judged by their values.
 *
 * A response to #5 has the same shape. The first two bytes of #2 are 00 or FF, and #2 is never the abnormal packet.
 */
bool fathom_hps167s_may_be_configuration(const uint16_t registers[4]);

/**
 * @brief Returns the reconnect time in a response to #2, in ms.
 *
 * @param registers       The 4 registers.
 * @param low_word_first  As in fathom_hps167s_decode_configuration().
 */
uint32_t fathom_hps167s_configured_reconnect_time_ms(const uint16_t registers[4], bool low_word_first);

/**
 * @brief Encodes the two registers of #15.
 *
 * @param ms              Reconnect time in ms: a multiple of FATHOM_HPS167S_RECONNECT_STEP_MS, which is not checked.
 * @param low_word_first  As in fathom_hps167s_decode_configuration().
 * @param registers       Written always.
 */
void fathom_hps167s_encode_reconnect_time(uint32_t ms, bool low_word_first, uint16_t registers[2]);

/**
 * @brief Returns the reconnect time of two registers of #15, in ms.
 *
 * @param first           The first register.
 * @param second          The second register.
 * @param low_word_first  As in fathom_hps167s_decode_configuration().
 */
uint32_t fathom_hps167s_decode_reconnect_time(uint16_t first, uint16_t second, bool low_word_first);

/* ---- #3, table 14 ---- */

/** @brief Details of the sensor (#3). */
typedef struct {
    uint8_t uuid[FATHOM_HPS167S_UUID_LENGTH]; /**< Unique number, in the order of the wire. */
    uint16_t year;                            /**< 2000 to 2255. */
    uint8_t month;                            /**< 1 to 12, if the maker has set it. */
    uint8_t day;                              /**< 1 to 31, if the maker has set it. */
    uint8_t major;                            /**< Major version. */
    uint8_t minor;                            /**< Minor version. */
} fathom_hps167s_details_t;

/**
 * @brief Decodes the response to #3.
 *
 * @param registers  The 11 registers.
 * @param details    Written always.
 */
void fathom_hps167s_decode_details(const uint16_t registers[11], fathom_hps167s_details_t *details);

/** @brief Returns true if a response to #3 begins with the byte B0, as table 14 requires. */
bool fathom_hps167s_may_be_details(const uint16_t registers[11]);

/* ---- #4, table 16 ---- */

/**
 * @brief Returns the temperature of the analog front end in tenths of a degree Celsius, rounded to the nearest.
 *
 * @param fahrenheit        The register of #4, signed.
 * @param steps_per_degree  Steps in a degree Fahrenheit, 1 to 255: 1 for whole degrees, 10 for tenths.
 */
int32_t fathom_hps167s_temperature_dc(int16_t fahrenheit, uint8_t steps_per_degree);

/* ---- #5, table 18 ---- */

/**
 * @brief Limits between the kinds of a distance (#5).
 *
 * The datasheet states a range of 80 mm to 18 m (table 1), has a note about 20 m, and gives over range as "65.53
 * meters", with two decimals. Values between `max_mm` and `over_range_mm`, and 0, are no values of this sensor. They
 * are refused.
 *
 *     0          min_mm             max_mm            over_range_mm        65534   65535
 *     | UNKNOWN  | TARGET ........... | refused ....... | NO_TARGET ......... |    refused
 */
typedef struct {
    uint16_t max_mm; /**< Greatest distance of a target in mm. 0 selects 30000. */
    uint16_t
        over_range_mm; /**< Least value that is no target, above `max_mm`, up to 65534. 0 selects 65530. */
    uint16_t min_mm;   /**< Least distance of a target in mm, 1 to `max_mm`. 0 selects 80. */
} fathom_hps167s_limits_t;

/**
 * @brief Sets members of `*limits` that are 0 to their defaults.
 *
 * @retval FATHOM_OK            The limits can be used.
 * @retval FATHOM_ERR_ARGUMENT  `over_range_mm` is 65535 or not above `max_mm`, or `min_mm` is above `max_mm`.
 */
fathom_status_t fathom_hps167s_complete_limits(fathom_hps167s_limits_t *limits);

/**
 * @brief Returns true if four registers are the abnormal packet of #5: the sensor reports a failure.
 *
 * All bits of distance, ambient light and precision are 1, and the magnitude is 0. The exponent may have any value.
 */
bool fathom_hps167s_is_abnormal(const uint16_t registers[4]);

/**
 * @brief Decodes a measurement with the default limits. See fathom_hps167s_decode_within().
 *
 * @param registers  The 4 registers.
 * @param sample     Written with FATHOM_OK only.
 * @retval FATHOM_OK             The registers are a measurement, or the abnormal packet.
 * @retval FATHOM_ERR_MALFORMED  The distance cannot be one, or the exponent is above FATHOM_HPS167S_MAX_EXPONENT.
 */
fathom_status_t fathom_hps167s_decode(const uint16_t registers[4], fathom_sample_t *sample);

/**
 * @brief Decodes a measurement: the registers of a response to #5, or of an unsolicited frame of that shape.
 *
 * The function sets `kind`, `raw`, `distance_mm`, `magnitude`, `ambient`, `precision` and `interference` (false) of the
 * sample, and no other member. The magnitude is the number that the sensor sends, shifted by the exponent: 7231744 is
 * 723.1744.
 *
 * @param limits     The limits, of which no member is 0 (fathom_hps167s_complete_limits()); NULL: the defaults.
 * @param registers  The 4 registers.
 * @param sample     Written with FATHOM_OK only.
 * @return As fathom_hps167s_decode().
 */
fathom_status_t fathom_hps167s_decode_within(const fathom_hps167s_limits_t *limits,
                                             const uint16_t registers[4], fathom_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
