/* SPDX-License-Identifier: MIT */
/* The writer of JSON; JSON, CSV and text from a table of fields; and times. */
#define _DEFAULT_SOURCE 1 /* NOLINT(bugprone-reserved-identifier): open_memstream */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>

#include "output/record.h"
#include "output/words.h"

static char *text;
static size_t size;
static FILE *to;

static FILE *begin(void)
{
    to = open_memstream(&text, &size);
    assert_non_null(to);
    return to;
}

static void expect(const char *expected)
{
    assert_int_equal(fclose(to), 0);
    assert_string_equal(text, expected);
    free(text);
}

TEST(strings_of_json_have_escapes)
{
    json_t json = {.to = begin()};
    json_string(&json, NULL, "tank \"A\" \\ \n\x1b \xC2\xB0");
    expect("\"tank \\\"A\\\" \\\\ \\u000a\\u001b \xC2\xB0\"");
}

TEST(commas_stand_between_members_and_elements_at_any_depth)
{
    static const uint8_t bytes[] = {0x01, 0x83, 0x0A};
    json_t json = {.to = begin()};
    json_begin(&json, NULL, '{');
    json_begin(&json, "empty", '[');
    json_end(&json, ']');
    json_begin(&json, "list", '[');
    json_begin(&json, NULL, '{');
    json_value(&json, "n", "%d", -1);
    json_flag(&json, "on", true);
    json_end(&json, '}');
    json_string(&json, NULL, NULL);
    json_end(&json, ']');
    json_bytes(&json, "bytes", bytes, sizeof bytes);
    json_flag(&json, "off", false);
    json_end(&json, '}');
    expect("{\"empty\":[],\"list\":[{\"n\":-1,\"on\":true},null],\"bytes\":\"01 83 0A\",\"off\":false}");
}

/* ---- records ---- */

enum { EXTRA = 1 };

typedef struct {
    int64_t number, tenths, fine, flag;
    const char *word;
} sample_t;

static const field_t fields[] = {
    {"number_mm", "mm", "A number", FIELD_NUMBER, 0, offsetof(sample_t, number)},
    {"tenths_degc", "degC", "A decimal", FIELD_TENTHS, 0, offsetof(sample_t, tenths)},
    {"fine", "", NULL, FIELD_TEN_THOUSANDTHS, EXTRA, offsetof(sample_t, fine)},
    {"is_on", "", "A flag", FIELD_FLAG, 0, offsetof(sample_t, flag)},
    {"word", "", "A word", FIELD_WORD, 0, offsetof(sample_t, word)},
    {.key = NULL},
};
static const sample_t some = {.number = -7, .tenths = -5, .fine = 7231744, .flag = 1, .word = "a,\"b\""};
static const sample_t none = {NO_VALUE, NO_VALUE, NO_VALUE, NO_VALUE, NULL};

TEST(json_has_the_columns_of_the_record)
{
    record_json_line(begin(), fields, &some, EXTRA);
    record_json_line(to, fields, &none, 0);
    expect(
        "{\"number_mm\":-7,\"tenths_degc\":-0.5,\"fine\":723.1744,\"is_on\":true,\"word\":\"a,\\\"b\\\"\"}\n"
        "{\"number_mm\":null,\"tenths_degc\":null,\"is_on\":null,\"word\":null}\n");
}

TEST(csv_has_the_columns_of_the_table_and_quotes_what_needs_it)
{
    record_csv(begin(), fields, NULL, EXTRA, EXTRA);
    record_csv(to, fields, &some, EXTRA, EXTRA);
    record_csv(to, fields, &some, 0, EXTRA);
    record_csv(to, fields, &none, EXTRA, EXTRA);
    expect("number_mm,tenths_degc,fine,is_on,word\n-7,-0.5,723.1744,true,\"a,\"\"b\"\"\"\n"
           "-7,-0.5,,true,\"a,\"\"b\"\"\"\n,,,,\n");
}

TEST(text_has_a_dash_for_null)
{
    assert_true(record_print(begin(), "", fields, &some, 0, false));
    assert_true(record_print(to, "; ", fields, &none, 0, false));
    expect("number_mm -7, tenths_degc -0.5, is_on true, word a,\"b\"; "
           "number_mm -, tenths_degc -, is_on -, word -");
}

TEST(text_of_counters_leaves_out_those_that_are_0)
{
    static const sample_t counts = {.number = 3, .fine = 2};
    static const field_t counters[] = {
        {"first", "", NULL, FIELD_NUMBER, 0, offsetof(sample_t, number)},
        {"second", "", NULL, FIELD_NUMBER, 0, offsetof(sample_t, tenths)},
        {"third", "", NULL, FIELD_NUMBER, 0, offsetof(sample_t, fine)},
        {.key = NULL},
    };
    static const sample_t zero;
    assert_true(record_print(begin(), "line: ", counters, &counts, 0, true));
    assert_false(record_print(to, "line: ", counters, &zero, 0, true));
    expect("line: first 3, third 2");
}

TEST(help_lists_the_fields_that_have_one)
{
    record_help(begin(), fields);
    expect("  number_mm         mm      A number\n  tenths_degc       degC    A decimal\n"
           "  is_on                     A flag\n  word                      A word\n");
}

/* ---- times ---- */

TEST(a_time_of_32_bits_belongs_to_the_last_71_minutes)
{
    const uint64_t wrap = (uint64_t)1 << 32;
    const uint32_t longest_us = (uint32_t)71 * 60 * 1000000;
    const struct {
        uint64_t now_us;
        uint32_t then_us;
        uint64_t expected_us;
    } rows[] = {
        {5 * wrap + 10, 10, 5 * wrap + 10},
        {5 * wrap + 10, 9, 5 * wrap + 9},
        {5 * wrap + 10, UINT32_MAX, 5 * wrap - 1},
        {5 * wrap, UINT32_MAX, 5 * wrap - 1},
        {5 * wrap, 0, 5 * wrap},
        {5 * wrap + 10, (uint32_t)(wrap + 10 - longest_us), 5 * wrap + 10 - longest_us},
        /* 1 us, and half a minute, ahead */
        {5 * wrap - 1, 0, 5 * wrap - 1},
        {wrap + 5, 30000005, wrap + 5},
    };
    for (size_t i = 0; i != sizeof rows / sizeof rows[0]; i++)
        assert_true(time_extend(rows[i].now_us, rows[i].then_us) == rows[i].expected_us);
}
