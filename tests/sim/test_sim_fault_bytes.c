/* SPDX-License-Identifier: MIT */
#include "fault_bench.h"

/* What each kind does to the bytes of a known frame. The fault is in the second of three frames; the others
 * must come as if there were none. */

enum { SEEDS = 150 };

static const setting_t settings[] = {A16_AUTO, A16_MODBUS, A05_AUTO, A05_DYP, HPS167S};
enum { SETTINGS = sizeof settings / sizeof settings[0] };

/* Leaves the damaged frame on the stage. */
static void second_frame(stage_t *s, setting_t setting, uint8_t kind, uint8_t code, uint32_t seed)
{
    stage_set(s, setting, seed);
    fathom_sim_fault_rule_t *const rule = fathom_sim_fault_add(&s->fault, kind, ALWAYS, 2);
    assert_non_null(rule);
    rule->code = code;
    stage_next(s, setting);
    expect_golden(s, setting);
    assert_int_equal(s->fault.last_kinds, 0);
    stage_next(s, setting);
    assert_int_equal(s->fault.frames, 2);
    assert_int_equal(s->fault.last_kinds, FATHOM_SIM_FAULT_BIT(kind));
    assert_int_equal(s->fault.counters[kind], 1);
    assert_int_equal(s->fault.frames_hit, 1);
}

static void third_frame_is_good(stage_t *s, setting_t setting, uint8_t kind)
{
    stage_next(s, setting);
    expect_golden(s, setting);
    assert_int_equal(s->fault.last_kinds, 0);
    assert_int_equal(s->fault.counters[kind], 1);
    assert_int_equal(fathom_sim_fault_take(&s->fault), FATHOM_SIM_FAULT_BIT(kind));
    assert_int_equal(fathom_sim_fault_take(&s->fault), 0);
}

static int bits_of(unsigned value)
{
    int bits = 0;
    for (; value != 0; value >>= 1) bits += (int)(value & 1);
    return bits;
}

/* One byte differs; returns where. */
static size_t only_difference(const stage_t *s, setting_t setting)
{
    size_t at = SIZE_MAX;
    assert_int_equal(s->count, golden[setting].length);
    for (size_t i = 0; i < s->count; i++) {
        if (s->bytes[i] == golden[setting].frame[i]) continue;
        assert_int_equal(at, SIZE_MAX);
        at = i;
    }
    assert_true(at < s->count);
    return at;
}

/* Every byte of the frame is hit under some seed, and, for one bit, every bit. */
static void flips(uint8_t kind, bool one_bit)
{
    for (size_t n = 0; n < SETTINGS; n++) {
        stage_t s;
        uint32_t places = 0;
        unsigned bits = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            second_frame(&s, settings[n], kind, 0, seed);
            const size_t at = only_difference(&s, settings[n]);
            const unsigned mask = s.bytes[at] ^ golden[settings[n]].frame[at];
            places |= UINT32_C(1) << at;
            bits |= mask;
            if (one_bit) assert_int_equal(bits_of(mask), 1);
            assert_int_equal(s.flags[at], 0);
            third_frame_is_good(&s, settings[n], kind);
        }
        assert_int_equal(places, (UINT32_C(1) << golden[settings[n]].length) - 1);
        assert_int_equal(bits, 0xFF);
    }
}

static const suite_t suite = {BENCH_ROUNDS};

TEST(flip_bit_changes_one_bit_of_any_byte) { flips(FATHOM_SIM_FAULT_FLIP_BIT, true); }

TEST(flip_byte_changes_one_byte_to_any_other_value) { flips(FATHOM_SIM_FAULT_FLIP_BYTE, false); }

/* `shorter` is `longer` without the byte at `at`. */
static bool is_without(const uint8_t *shorter, const uint8_t *longer, size_t length, size_t at)
{
    return memcmp(shorter, longer, at) == 0 && memcmp(shorter + at, longer + at + 1, length - at - 1) == 0;
}

TEST(drop_takes_one_byte_away_wherever_it_stands)
{
    for (size_t n = 0; n < SETTINGS; n++) {
        stage_t s;
        const size_t length = golden[settings[n]].length;
        uint32_t places = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            bool found = false;
            second_frame(&s, settings[n], FATHOM_SIM_FAULT_DROP, 0, seed);
            assert_int_equal(s.count, length - 1);
            for (size_t at = 0; at < length; at++) {
                if (!is_without(s.bytes, golden[settings[n]].frame, length, at)) continue;
                found = true;
                places |= UINT32_C(1) << at;
            }
            assert_true(found);
            third_frame_is_good(&s, settings[n], FATHOM_SIM_FAULT_DROP);
        }
        assert_int_equal(places, (UINT32_C(1) << length) - 1);
    }
}

TEST(insert_puts_one_byte_between_two_others)
{
    for (size_t n = 0; n < SETTINGS; n++) {
        stage_t s;
        const size_t length = golden[settings[n]].length;
        uint32_t places = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            bool found = false;
            second_frame(&s, settings[n], FATHOM_SIM_FAULT_INSERT, 0, seed);
            assert_int_equal(s.count, length + 1);
            assert_int_equal(s.bytes[0], golden[settings[n]].frame[0]);
            assert_int_equal(s.bytes[length], golden[settings[n]].frame[length - 1]);
            for (size_t at = 1; at < length; at++) {
                if (!is_without(golden[settings[n]].frame, s.bytes, length + 1, at)) continue;
                found = true;
                places |= UINT32_C(1) << at;
            }
            assert_true(found);
            third_frame_is_good(&s, settings[n], FATHOM_SIM_FAULT_INSERT);
        }
        assert_int_equal(places, (UINT32_C(1) << length) - 2);
    }
}

TEST(truncate_leaves_the_beginning)
{
    for (size_t n = 0; n < SETTINGS; n++) {
        stage_t s;
        const size_t length = golden[settings[n]].length;
        uint32_t lengths = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            second_frame(&s, settings[n], FATHOM_SIM_FAULT_TRUNCATE, 0, seed);
            assert_in_range(s.count, 1, length - 1);
            assert_memory_equal(s.bytes, golden[settings[n]].frame, s.count);
            lengths |= UINT32_C(1) << s.count;
            third_frame_is_good(&s, settings[n], FATHOM_SIM_FAULT_TRUNCATE);
        }
        assert_int_equal(lengths, (UINT32_C(1) << length) - 2);
    }
}

TEST(trailing_adds_one_to_four_bytes_without_a_gap)
{
    for (size_t n = 0; n < SETTINGS; n++) {
        stage_t s;
        const size_t length = golden[settings[n]].length;
        uint32_t more = 0;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            second_frame(&s, settings[n], FATHOM_SIM_FAULT_TRAILING, 0, seed);
            assert_in_range(s.count, length + 1, length + 4);
            assert_memory_equal(s.bytes, golden[settings[n]].frame, length);
            assert_in_range(fathom_elapsed_us(s.end_us[length], s.end_us[length - 1]), 572, 1042);
            more |= UINT32_C(1) << (s.count - length);
            third_frame_is_good(&s, settings[n], FATHOM_SIM_FAULT_TRAILING);
        }
        assert_int_equal(more, 0x1E);
    }
}

/* ---- with a right checksum ---- */

static bool ends_right(const stage_t *s, setting_t setting)
{
    return setting == A16_MODBUS || setting == HPS167S ? crc_is_right(s->bytes, s->count)
                                                       : sum_is_right(s->bytes, s->count);
}

/* Kinds that change one byte before the end. */
static void replaced(setting_t setting, uint8_t kind, size_t at, uint8_t least, uint8_t most)
{
    stage_t s;
    uint8_t first = 0;
    bool varies = false;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        const size_t end = golden[setting].length - (size_t)(setting == A05_DYP ? 1 : 2);
        second_frame(&s, setting, kind, 0, seed);
        assert_int_equal(s.count, golden[setting].length);
        assert_true(ends_right(&s, setting));
        assert_int_not_equal(s.bytes[at], golden[setting].frame[at]);
        assert_in_range(s.bytes[at], least, most);
        assert_memory_equal(s.bytes, golden[setting].frame, at);
        assert_memory_equal(s.bytes + at + 1, golden[setting].frame + at + 1, end - at - 1);
        varies = varies || (seed != 0 && s.bytes[at] != first);
        first = s.bytes[at];
        third_frame_is_good(&s, setting, kind);
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

TEST(count_is_one_less_or_more_where_there_is_one)
{
    stage_t s;
    second_frame(&s, A16_AUTO, FATHOM_SIM_FAULT_COUNT, 0, 0);
    EXPECT_BYTES(&s, 0xFF, 0x02, 0xEF, 0x02, 0xEF, 0xE1); /* FF + 02 + EF + 02 + EF = 2E1 */
    second_frame(&s, A05_AUTO, FATHOM_SIM_FAULT_COUNT, 0, 0);
    EXPECT_BYTES(&s, 0xFF, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x69); /* 60 - 0D - EA = 69 */
    second_frame(&s, A05_DYP, FATHOM_SIM_FAULT_COUNT, 0, 0);
    EXPECT_BYTES(&s, 0x55, 0xAA, 0x01, 0x01, 0x03, 0xE8, 0x07, 0xD0, 0x07, 0xA1, 0x6B); /* 62 - 0D - EA */
    second_frame(&s, A16_MODBUS, FATHOM_SIM_FAULT_COUNT, 0, 0);
    assert_int_equal(s.count, 9);
    assert_memory_equal(s.bytes, ((const uint8_t[]){0x01, 0x03, 0x04, 0x02, 0xEF, 0x02, 0xEF}), 7);
    assert_true(crc_is_right(s.bytes, 9));
    third_frame_is_good(&s, A16_MODBUS, FATHOM_SIM_FAULT_COUNT);

    /* four probes asked, three answered, as in A05 3(4)1 example 3 */
    stage_set(&s, A05_MODBUS, 0);
    s.fixed = (fathom_sim_fixed_t){{250, 659, 2426, 316}};
    ADD(&s, COUNT, ALWAYS, 0);
    stage_ask(&s, LITERAL(0x01, 0x03, 0x01, 0x06, 0x00, 0x04, 0xA5, 0xF4), 450 * MS);
    EXPECT_BYTES(&s, 0x01, 0x03, 0x06, 0x00, 0xFA, 0x02, 0x93, 0x09, 0x7A, 0x8F, 0x47);
    /* two asked, one answered */
    stage_ask(&s, LITERAL(0x01, 0x03, 0x01, 0x06, 0x00, 0x02, 0x25, 0xF6), 450 * MS);
    EXPECT_BYTES(&s, 0x01, 0x03, 0x02, 0x00, 0xFA, 0x38, 0x07);
    /* what has no values gets a byte more */
    stage_ask(&s, LITERAL(0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x48, 0x71), 50 * MS);
    assert_int_equal(s.count, 9);
    assert_memory_equal(s.bytes, ((const uint8_t[]){0x01, 0x06, 0x02, 0x00, 0x00, 0x05, 0x00}), 7);
    assert_true(crc_is_right(s.bytes, 9));
    stage_set(&s, A05_DYP, 0);
    ADD(&s, COUNT, ALWAYS, 0);
    stage_ask(&s, LITERAL(0x55, 0xAA, 0x05, 0x03, 0x07), 50 * MS);
    EXPECT_BYTES(&s, 0x55, 0xAA, 0x05, 0x03, 0x00, 0x07);
}

TEST(exception_is_of_the_code_given_or_any)
{
    stage_t s;
    uint8_t least = 255;
    uint8_t most = 0;
    second_frame(&s, A16_MODBUS, FATHOM_SIM_FAULT_EXCEPTION, 2, 0);
    EXPECT_BYTES(&s, 0x01, 0x83, 0x02, 0xC0, 0xF1); /* HPS-167S, abnormal response */
    third_frame_is_good(&s, A16_MODBUS, FATHOM_SIM_FAULT_EXCEPTION);
    for (uint32_t seed = 0; seed < 2000; seed++) {
        second_frame(&s, HPS167S, FATHOM_SIM_FAULT_EXCEPTION, 0, seed);
        assert_int_equal(s.count, 5);
        assert_memory_equal(s.bytes, ((const uint8_t[]){0x01, 0x83}), 2);
        assert_int_not_equal(s.bytes[2], 0);
        assert_true(crc_is_right(s.bytes, 5));
        if (s.bytes[2] < least) least = s.bytes[2];
        if (s.bytes[2] > most) most = s.bytes[2];
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
        stage_t s;
        stage_set(&s, rows[i].setting, 1);
        assert_non_null(fathom_sim_fault_add(&s.fault, rows[i].kind, ALWAYS, 0));
        for (int n = 0; n < 5; n++) {
            stage_next(&s, rows[i].setting);
            expect_golden(&s, rows[i].setting);
        }
        assert_int_equal(s.fault.frames, 5);
        assert_int_equal(s.fault.frames_hit, 0);
        assert_int_equal(s.fault.counters[rows[i].kind], 0);
    }
}
