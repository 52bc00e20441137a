/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

/* What each kind does to the bytes of a known frame. The fault is in the second of three frames; the others
 * must come as if there were none. */

enum { SEEDS = 150 };

static uint8_t frame[16]; /* of the setting */
static size_t length;     /* of it */

static void second_frame(setting_t setting, uint8_t kind, uint8_t code, uint32_t seed)
{
    length = from_hex(golden[setting].frame, frame, sizeof frame);
    set_faulty(setting, seed);
    fathom_sim_fault_rule_t *const rule = fathom_sim_fault_add(&bench.fault, kind, ALWAYS, 2);
    assert_non_null(rule);
    rule->code = code;
    next_is_golden(setting);
    assert_int_equal(bench.fault.last_kinds, 0);
    next(setting);
    assert_int_equal(bench.fault.frames, 2);
    assert_int_equal(bench.fault.last_kinds, FATHOM_SIM_FAULT_BIT(kind));
    assert_int_equal(bench.fault.counters[kind], 1);
    assert_int_equal(bench.fault.frames_hit, 1);
}

static void third_frame_is_good(setting_t setting, uint8_t kind)
{
    next_is_golden(setting);
    assert_int_equal(bench.fault.last_kinds, 0);
    assert_int_equal(bench.fault.counters[kind], 1);
    assert_int_equal(fathom_sim_fault_take(&bench.fault), FATHOM_SIM_FAULT_BIT(kind));
    assert_int_equal(fathom_sim_fault_take(&bench.fault), 0);
}

/* Of what does the damage is right and where it is: as a set of places. 0: it is wrong. */
static unsigned bits; /* all that were flipped */

static uint32_t of_a_byte(void)
{
    uint32_t places = 0;
    assert_int_equal(bench.heard, length);
    for (size_t i = 0; i < length; i++) {
        const unsigned mask = bench.bytes[i] ^ frame[i];
        bits |= mask;
        if (mask == 0) continue;
        assert_int_equal(places, 0); /* one byte differs */
        assert_int_equal(bench.flags[i], 0);
        places = UINT32_C(1) << i;
    }
    return places;
}

static uint32_t of_a_bit(void)
{
    const uint32_t place = of_a_byte();
    for (size_t i = 0; i < length; i++) {
        const unsigned mask = bench.bytes[i] ^ frame[i];
        assert_int_equal(mask & (mask - 1), 0);
    }
    return place;
}

/* Where `shorter` can be `longer` without a byte. */
static uint32_t missing(const uint8_t *shorter, const uint8_t *longer, size_t longer_length)
{
    uint32_t places = 0;
    for (size_t at = 0; at < longer_length; at++)
        if (memcmp(shorter, longer, at) == 0 &&
            memcmp(shorter + at, longer + at + 1, longer_length - at - 1) == 0)
            places |= UINT32_C(1) << at;
    return places;
}

static uint32_t of_a_byte_less(void)
{
    assert_int_equal(bench.heard, length - 1);
    return missing(bench.bytes, frame, length);
}

static uint32_t of_a_byte_more(void)
{
    assert_int_equal(bench.heard, length + 1);
    assert_int_equal(bench.bytes[0], frame[0]);
    assert_int_equal(bench.bytes[length], frame[length - 1]);
    return missing(frame, bench.bytes, length + 1) & ((UINT32_C(1) << length) - 2);
}

static uint32_t of_an_early_end(void)
{
    assert_in_range(bench.heard, 1, length - 1);
    assert_memory_equal(bench.bytes, frame, bench.heard);
    return UINT32_C(1) << bench.heard;
}

static uint32_t of_a_late_end(void)
{
    assert_in_range(bench.heard, length + 1, length + 4);
    assert_memory_equal(bench.bytes, frame, length);
    assert_in_range(fathom_elapsed_us(bench.end_us[length], bench.end_us[length - 1]), 572, 1042);
    return UINT32_C(1) << (bench.heard - length);
}

/* Under some seed each place is hit from the first on: up to the last, or to the end of the frame where that is 0. */
static void damage(uint8_t kind, uint32_t (*where)(void), size_t first, size_t last)
{
    for (setting_t setting = 0; setting < SETTINGS; setting++) {
        uint32_t places = 0;
        bits = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            second_frame(setting, kind, 0, seed);
            const uint32_t here = where();
            assert_int_not_equal(here, 0);
            places |= here;
            third_frame_is_good(setting, kind);
        }
        const size_t end = last != 0 ? last : length - 1;
        assert_int_equal(places, (UINT32_C(2) << end) - (UINT32_C(1) << first));
        if (where == of_a_bit || where == of_a_byte) assert_int_equal(bits, 0xFF);
    }
}

static const suite_t suite = {BENCH_TWO_ROUNDS};

TEST(flip_bit_changes_one_bit_of_any_byte) { damage(FATHOM_SIM_FAULT_FLIP_BIT, of_a_bit, 0, 0); }

TEST(flip_byte_changes_one_byte_to_any_other_value) { damage(FATHOM_SIM_FAULT_FLIP_BYTE, of_a_byte, 0, 0); }

TEST(drop_takes_one_byte_away_wherever_it_stands) { damage(FATHOM_SIM_FAULT_DROP, of_a_byte_less, 0, 0); }

TEST(insert_puts_one_byte_between_two_others) { damage(FATHOM_SIM_FAULT_INSERT, of_a_byte_more, 1, 0); }

TEST(truncate_leaves_the_beginning) { damage(FATHOM_SIM_FAULT_TRUNCATE, of_an_early_end, 1, 0); }

TEST(trailing_adds_one_to_four_bytes_without_a_gap)
{
    damage(FATHOM_SIM_FAULT_TRAILING, of_a_late_end, 1, 4);
}

/* Kinds that change one byte before the end. */
static void replaced(setting_t setting, uint8_t kind, size_t at, uint8_t least, uint8_t most)
{
    uint8_t first = 0;
    bool varies = false;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        second_frame(setting, kind, 0, seed);
        const size_t end = length - (setting == A05_DYP ? 1 : 2);
        assert_int_equal(bench.heard, length);
        assert_true(setting == A05_DYP ? sum_is_right() : crc_is_right());
        assert_int_not_equal(bench.bytes[at], frame[at]);
        assert_in_range(bench.bytes[at], least, most);
        assert_memory_equal(bench.bytes, frame, at);
        assert_memory_equal(bench.bytes + at + 1, frame + at + 1, end - at - 1);
        varies = varies || (seed != 0 && bench.bytes[at] != first);
        first = bench.bytes[at];
        third_frame_is_good(setting, kind);
    }
    assert_true(varies);
}

TEST(unit_answers_from_another_address)
{
    replaced(A16_MODBUS, FATHOM_SIM_FAULT_UNIT, 0, 1, 254);
    replaced(HPS167S, FATHOM_SIM_FAULT_UNIT, 0, 1, 254);
    replaced(A05_DYP, FATHOM_SIM_FAULT_UNIT, 2, 1, 254);
}

TEST(function_answers_to_another_function_or_command)
{
    replaced(A16_MODBUS, FATHOM_SIM_FAULT_FUNCTION, 1, 1, 127);
    replaced(HPS167S, FATHOM_SIM_FAULT_FUNCTION, 1, 1, 127);
    replaced(A05_DYP, FATHOM_SIM_FAULT_FUNCTION, 3, 0, 255);
}

/* What was heard begins with that, is so long and ends in a right CRC. */
static void expect_sealed(const char *hex, size_t count)
{
    assert_int_equal(bench.heard, count);
    assert_true(is_hex(bench.bytes, hex) && crc_is_right());
    forget();
}

TEST(count_is_one_less_or_more_where_there_is_one)
{
    second_frame(A16_AUTO, FATHOM_SIM_FAULT_COUNT, 0, 0);
    expect("FF 02 EF 02 EF E1"); /* FF + 02 + EF + 02 + EF = 2E1 */
    second_frame(A05_AUTO, FATHOM_SIM_FAULT_COUNT, 0, 0);
    expect("FF 03 E8 07 D0 07 A1 69"); /* 60 - 0D - EA = 69 */
    second_frame(A05_DYP, FATHOM_SIM_FAULT_COUNT, 0, 0);
    expect("55 AA 01 01 03 E8 07 D0 07 A1 6B"); /* 62 - 0D - EA */
    second_frame(A16_MODBUS, FATHOM_SIM_FAULT_COUNT, 0, 0);
    expect_sealed("01 03 04 02 EF 02 EF", 9);
    third_frame_is_good(A16_MODBUS, FATHOM_SIM_FAULT_COUNT);

    /* four probes asked, three answered, as in A05 3(4)1 example 3 */
    set_faulty(A05_MODBUS, 0);
    bench.fixed = FIXED(250, 659, 2426, 316);
    FAULT(COUNT, ALWAYS, 0);
    transact("01 03 01 06 00 04 A5 F4", 450, "01 03 06 00 FA 02 93 09 7A 8F 47");
    transact("01 03 01 06 00 02 25 F6", 450, "01 03 02 00 FA 38 07"); /* two asked, one answered */
    ask("01 06 02 00 00 05 48 71", 50);
    expect_sealed("01 06 02 00 00 05 00", 9); /* what has no values gets a byte more */
    set_faulty(A05_DYP, 0);
    FAULT(COUNT, ALWAYS, 0);
    transact("55 AA 05 03 07", 50, "55 AA 05 03 00 07");
}

TEST(exception_is_of_the_code_given_or_any)
{
    uint8_t least = 255, most = 0;
    second_frame(A16_MODBUS, FATHOM_SIM_FAULT_EXCEPTION, 2, 0);
    expect("01 83 02 C0 F1"); /* HPS-167S, abnormal response */
    third_frame_is_good(A16_MODBUS, FATHOM_SIM_FAULT_EXCEPTION);
    for (uint32_t seed = 0; seed < 2000; seed++) {
        second_frame(HPS167S, FATHOM_SIM_FAULT_EXCEPTION, 0, seed);
        const uint8_t code = bench.bytes[2];
        expect_sealed("01 83", 5);
        if (code < least) least = code;
        if (code > most) most = code;
    }
    assert_int_equal(least, 1);
    assert_int_equal(most, 255);
}

TEST(what_does_not_fit_a_frame_leaves_it_alone_and_is_not_counted)
{
    static const struct {
        setting_t setting;
        uint8_t kind;
    } rows[] = {
        {A16_AUTO, FATHOM_SIM_FAULT_UNIT},        {A16_AUTO, FATHOM_SIM_FAULT_FUNCTION},
        {A16_AUTO, FATHOM_SIM_FAULT_EXCEPTION},   {A16_AUTO, FATHOM_SIM_FAULT_ECHO},
        {A05_DYP, FATHOM_SIM_FAULT_EXCEPTION},    {A05_DYP, FATHOM_SIM_FAULT_FAULT},
        {HPS167S, FATHOM_SIM_FAULT_INTERFERENCE}, {HPS167S, FATHOM_SIM_FAULT_CLOCK_JUMP}, /* no clock */
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        set_faulty(rows[i].setting, 1);
        assert_non_null(fathom_sim_fault_add(&bench.fault, rows[i].kind, ALWAYS, 0));
        for (int n = 0; n < 5; n++) next_is_golden(rows[i].setting);
        assert_int_equal(bench.fault.frames, 5);
        assert_int_equal(bench.fault.frames_hit, 0);
        assert_int_equal(bench.fault.counters[rows[i].kind], 0);
    }
}
