/* SPDX-License-Identifier: MIT */
#include "fathom/codec/hps167s_registers.h"
#include "fuzz.h"

/* hps167s_registers.h: any registers, any limits. */

static uint8_t byte_of(const uint16_t *registers, int n)
{
    return (uint8_t)(n % 2 == 0 ? registers[n / 2] >> 8 : registers[n / 2] & 0xFF);
}

/* HPS-167S #5 and table 18, and the abnormal packet. */
static fathom_status_t kind_of(const uint16_t *registers, const fathom_hps167s_limits_t *limits,
                               uint8_t *kind)
{
    const uint16_t mm = registers[0];
    const bool is_abnormal =
        mm == 0xFFFF && registers[1] == 0 && byte_of(registers, 5) == 0xFF && registers[3] == 0xFFFF;
    PROMISE(fathom_hps167s_is_abnormal(registers) == is_abnormal, "hps167s_registers.h: the abnormal packet");
    *kind = FATHOM_FAULT;
    if (is_abnormal) return FATHOM_OK;
    if (byte_of(registers, 4) > 16) return FATHOM_ERR_MALFORMED;
    *kind = FATHOM_UNKNOWN;
    if (mm >= 1 && mm < limits->min_mm) return FATHOM_OK;
    *kind = FATHOM_TARGET;
    if (mm >= limits->min_mm && mm <= limits->max_mm) return FATHOM_OK;
    *kind = FATHOM_NO_TARGET;
    return mm >= limits->over_range_mm && mm != 0xFFFF ? FATHOM_OK : FATHOM_ERR_MALFORMED;
}

static void check_measurement(const uint16_t *registers)
{
    fathom_hps167s_limits_t limits = {fuzz_word(), fuzz_word(), fuzz_word()};
    fathom_hps167s_limits_t whole = {limits.max_mm != 0 ? limits.max_mm : 30000,
                                     limits.over_range_mm != 0 ? limits.over_range_mm : 65530,
                                     limits.min_mm != 0 ? limits.min_mm : 80};
    const bool is_good =
        whole.over_range_mm != 65535 && whole.over_range_mm > whole.max_mm && whole.min_mm <= whole.max_mm;
    PROMISE(fathom_hps167s_complete_limits(&limits) == (is_good ? FATHOM_OK : FATHOM_ERR_ARGUMENT),
            "hps167s_registers.h: which limits are refused");
    if (!is_good) whole = (fathom_hps167s_limits_t){30000, 65530, 80};
    fathom_sample_t sample;
    memset(&sample, FUZZ_GUARD, sizeof sample);
    uint8_t kind;
    const fathom_status_t should = kind_of(registers, &whole, &kind);
    const fathom_status_t status = fathom_hps167s_decode_within(is_good ? &whole : NULL, registers, &sample);
    PROMISE(status == should, "hps167s_registers.h: which distance means something");
    if (status != FATHOM_OK) {
        PROMISE(fuzz_is_guard(&sample, sizeof sample), "hps167s_registers.h: MALFORMED, nothing written");
        return;
    }
    PROMISE(sample.kind == kind && sample.raw == registers[0] &&
                sample.distance_mm == (kind == FATHOM_TARGET ? registers[0] : 0) && !sample.interference,
            "hps167s_registers.h: the distance");
    PROMISE(sample.ambient == byte_of(registers, 5) && sample.precision == registers[3],
            "hps167s_registers.h: ambient and precision");
    const uint8_t exponent = byte_of(registers, 4);
    if (kind != FATHOM_FAULT)
        PROMISE(sample.magnitude == (uint32_t)registers[1] << exponent, "hps167s_registers.h: the magnitude");
    PROMISE(fuzz_is_guard(&sample.time_us, sizeof sample.time_us) && sample.model == FUZZ_GUARD &&
                sample.address == FUZZ_GUARD && sample.probe == FUZZ_GUARD,
            "hps167s_registers.h: it sets the members that come from the device");
}

static void check_configuration(const uint16_t *registers, bool low_word_first)
{
    fathom_hps167s_configuration_t is;
    fathom_hps167s_decode_configuration(registers, low_word_first, &is);
    const uint8_t first = byte_of(registers, 0);
    const uint8_t second = byte_of(registers, 1);
    const uint32_t high = (uint32_t)byte_of(registers, 3) << 8 | byte_of(registers, 4);
    const uint32_t low = (uint32_t)byte_of(registers, 5) << 8 | byte_of(registers, 6);
    const uint32_t ms = low_word_first ? low << 16 | high : high << 16 | low;
    PROMISE(is.termination == (first != 0) && is.measures_after_power_on == (second != 0) &&
                is.warm_up_s == byte_of(registers, 2) && is.reconnect_time_ms == ms &&
                is.baud_code == byte_of(registers, 7),
            "hps167s_registers.h: #2, table 12");
    PROMISE(fathom_hps167s_configured_reconnect_time_ms(registers, low_word_first) == ms,
            "hps167s_registers.h: #2");
    PROMISE(fathom_hps167s_may_be_configuration(registers) ==
                ((first == 0 || first == 255) && (second == 0 || second == 255) &&
                 !fathom_hps167s_is_abnormal(registers)),
            "hps167s_registers.h: the first two bytes are 00 or FF, and it is not the abnormal packet");
    uint16_t words[2];
    fathom_hps167s_encode_reconnect_time(ms, low_word_first, words);
    PROMISE(fathom_hps167s_decode_reconnect_time(words[0], words[1], low_word_first) == ms,
            "hps167s_registers.h: #15 there and back");
}

static void check_rest(const uint16_t *registers)
{
    static const uint32_t rates[] = {19200, 57600, 115200, 230400}; /* tables 25, 26 */
    fathom_hps167s_details_t details;
    fathom_hps167s_version_t version;
    const uint16_t code = registers[0];
    PROMISE(fathom_hps167s_baud(code) == rates[code >= 1 && code <= 4 ? code - 1 : 0],
            "hps167s_registers.h: all codes but 1..4 mean 19200");
    const uint8_t back =
        fathom_hps167s_baud_code(registers[1] % 2 == 0 ? registers[2] : rates[registers[2] % 4]);
    PROMISE(registers[1] % 2 == 0 ? back == (registers[2] == 19200   ? 1
                                             : registers[2] == 57600 ? 2
                                                                     : 0)
                                  : back == registers[2] % 4 + 1,
            "hps167s_registers.h: the code of a rate, 0 where there is none");
    fathom_hps167s_decode_details(registers, &details);
    for (int i = 0; i != 16; i++)
        PROMISE(details.uuid[i] == byte_of(registers, i + 1), "hps167s_registers.h: #3, the UUID");
    PROMISE(details.year == 2000 + byte_of(registers, 17) && details.month == byte_of(registers, 18) &&
                details.day == byte_of(registers, 19) && details.major == byte_of(registers, 20) &&
                details.minor == byte_of(registers, 21),
            "hps167s_registers.h: #3, table 14");
    PROMISE(fathom_hps167s_may_be_details(registers) == (byte_of(registers, 0) == 0xB0),
            "hps167s_registers.h: #3");
    fathom_hps167s_decode_version(registers, &version);
    PROMISE(version.year == 2000 + byte_of(registers, 0) && version.month == byte_of(registers, 1) &&
                version.day == byte_of(registers, 2) && version.major == byte_of(registers, 3) &&
                version.minor == byte_of(registers, 4) && version.revision == byte_of(registers, 5),
            "hps167s_registers.h: #1, table 10");
    PROMISE(fathom_hps167s_is_date(version.month, version.day) ==
                (version.month >= 1 && version.month <= 12 && version.day >= 1 && version.day <= 31),
            "hps167s_registers.h: a date");
}

/* (F - 32) * 5 / 9 in tenths, of F in steps: 10 * 5 * (f - 32 s) / (9 s); it is off by half a tenth at most. */
static void check_temperature(int16_t fahrenheit, uint8_t steps)
{
    if (steps == 0) return;
    const int32_t dc = fathom_hps167s_temperature_dc(fahrenheit, steps);
    const int64_t off = (int64_t)dc * 9 * steps - (int64_t)50 * (fahrenheit - 32 * steps);
    PROMISE(2 * off <= 9 * steps && 2 * off >= -9 * steps, "hps167s_registers.h: rounded to the nearest");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_begin(data, size);
    uint16_t registers[11];
    const uint8_t part = fuzz_byte();
    for (int i = 0; i != 11; i++) registers[i] = fuzz_word();
    uint16_t *const four = fuzz_copy(registers, 8);
    check_measurement(four);
    check_configuration(four, (part & 1) != 0);
    check_rest(registers);
    check_temperature(fathom_hps167s_to_signed(registers[0]), part);
    const int32_t is = fathom_hps167s_to_signed(registers[0]);
    PROMISE((uint16_t)is == registers[0] && is >= -32768 && is <= 32767, "hps167s_registers.h: a sign");
    free(four);
    return 0;
}
