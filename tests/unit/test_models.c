/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fathom/models.h"

/* The rows of src/models: what must hold for each, and names. Their figures are those of the second simulation, which
 * tests/devices/second/test_second_relatives.c reads with them. */

static const fathom_model_description_t *row;
static const fathom_model_facts_t *facts;

#define EACH_ROW(index) for (uint16_t index = 0; next_row(index); index++)

static bool next_row(uint16_t index)
{
    row = fathom_model_at(index);
    facts = row != NULL ? row->facts : NULL;
    return row != NULL;
}

static void must(bool holds, const char *what)
{
    if (!holds) fail_msg("%s, mode %u: %s", row->name, row->mode, what);
}

/* ---- what holds for each row ---- */

TEST(each_row_has_the_facts_of_its_mode_and_no_others)
{
    EACH_ROW(index)
    {
        const bool is_pulse = row->mode == FATHOM_MODE_PULSE || row->mode == FATHOM_MODE_FREE_PULSE;
        const bool is_controlled = row->mode == FATHOM_MODE_CONTROLLED;
        const bool is_triggered = is_controlled || row->mode == FATHOM_MODE_PULSE;
        const uint8_t start = facts->start;
        must(row->mode > FATHOM_MODE_ANY && row->mode <= FATHOM_MODE_0A, "mode");
        must(row->family >= FATHOM_A16 && row->family <= FATHOM_HPS167S, "family");
        must(facts->min_mm != 0 && facts->min_mm < facts->max_mm && facts->max_mm < 0xFFFB, "range");
        must((facts->line_settings == NULL) == is_pulse, "line settings");
        must((start != FATHOM_STARTS_ALONE) == is_triggered, "start");
        must(start != FATHOM_STARTS_BYTE || is_controlled, "byte");
        must(start != FATHOM_STARTS_HIGH_PULSE || row->mode == FATHOM_MODE_PULSE, "high pulse");
        must(start <= FATHOM_STARTS_HIGH_PULSE, "start");
        must((facts->trigger_us != 0) ==
                 (start == FATHOM_STARTS_FALLING || start == FATHOM_STARTS_HIGH_PULSE),
             "width of the trigger");
        must(facts->trigger_byte == 0 || start == FATHOM_STARTS_BYTE, "byte");
        must((facts->latest_ms != 0) == is_controlled && facts->earliest_ms <= facts->latest_ms, "response");
        must((facts->us_per_dm != 0) == is_pulse && (is_pulse || facts->no_target_ms == 0), "pulse");
        must(facts->registers == 0 || row->mode == FATHOM_MODE_MODBUS, "registers");
        must((facts->registers & ~FATHOM_HAS_TEMPERATURE) == 0, "registers");
    }
}

TEST(a_response_and_a_pulse_end_before_the_next_trigger)
{
    EACH_ROW(index)
    {
        const uint32_t longest_us = (uint32_t)facts->max_mm * facts->us_per_dm / 100;
        if (row->mode == FATHOM_MODE_CONTROLLED) {
            must(facts->period_ms > facts->latest_ms, "period");
            must(facts->trigger_us < 1000uL * facts->period_ms / 2, "trigger");
            /* four characters of ten bits */
            must(facts->earliest_ms <= 1 || facts->earliest_ms >= 40000uL / facts->line_settings->baud,
                 "earliest");
        } else if (facts->us_per_dm != 0) {
            must(1000uL * facts->period_ms > longest_us + facts->trigger_us, "period");
            must(facts->no_target_ms == 0 || 1000uL * facts->no_target_ms > longest_us, "no target");
            must(facts->period_ms > facts->no_target_ms, "period");
        }
    }
}

/* ---- names ---- */

/* Calls `judge` with each name of a list. */
static void each_name(const char *list, void (*judge)(const char *name))
{
    char name[24];
    for (size_t length; *list != '\0'; list += length + strspn(list + length, ", ")) {
        length = strcspn(list, ",");
        assert_in_range(length, 2, sizeof name - 1);
        memcpy(name, list, length);
        name[length] = '\0';
        judge(name);
    }
}

static void is_mine_alone(const char *name)
{
    const fathom_model_description_t *const mine = row;
    assert_int_equal(strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.-"),
                     strlen(name));
    assert_ptr_equal(fathom_model_find(name, mine->mode), mine);
    for (uint16_t index = 0; (row = fathom_model_at(index)) != NULL; index++)
        if (fathom_model_is_called(row, name)) assert_string_equal(row->name, mine->name);
    row = mine;
}

TEST(each_name_finds_its_model_and_no_other)
{
    EACH_ROW(index)
    {
        each_name(row->name, is_mine_alone);
        each_name(row->aliases, is_mine_alone);
    }
    assert_null(fathom_model_at(UINT16_MAX));
}

TEST(a_name_is_found_as_its_owner_writes_it)
{
    static const char *const written[][2] = {
        {"hcsr04", "HC-SR04"},        {"HC SR04", "HC-SR04"},
        {"Hc_Sr04", "HC-SR04"},       {"sen0311", "A02YYUW"},
        {"DYP-A02YYUW", "A02YYUW"},   {"DYP-A02YYUW-V2.0", "A02YYUW"},
        {"dyp-a01-v2.0", "A01ANYUB"}, {"DYP-A01CNYUB-2.1", "A01CNYUB"},
        {"jsn-sr04t", "JSN-SR04T"},   {"JSNSR04TV2.0", "JSN-SR04T-2.0"},
        {"k02", "AJ-SR04M"},          {"A0221AM", "A02YYMW"},
        {"DYP-ME007Y-TX", "ME007TX"}, {"(HC-SR04)", "HC-SR04"},
        {"{hc~sr04}", "HC-SR04"},
    };
    for (unsigned i = 0; i != COUNT(written); i++) {
        row = fathom_model_find(written[i][0], FATHOM_MODE_ANY);
        if (row == NULL) fail_msg("%s is not found", written[i][0]);
        assert_string_equal(row->name, written[i][1]);
    }
}

TEST(what_is_no_name_is_not_found)
{
    static const char *const none[] = {"",         " ",
                                       "DYP",      "DYP-",
                                       "HC",       "HC-SR04-V2",
                                       "A02YYUW2", "DYP-A02YYUW-X",
                                       "A02YYUW,", "A02YYU, SEN0311",
                                       ",",        "DYP-A02YYUW-V2.0b",
                                       "V2.0",     "SEN"};
    for (unsigned i = 0; i != COUNT(none); i++)
        if (fathom_model_find(none[i], FATHOM_MODE_ANY) != NULL) fail_msg("\"%s\" is found", none[i]);
    assert_null(fathom_model_find("HC-SR04", FATHOM_MODE_AUTO));
}

/* The tool reads serial ports, so a module whose mode is selected on its board is first the one that sends. */
TEST(the_first_mode_of_a_name_is_the_one_that_sends)
{
    assert_int_equal(fathom_model_find("JSN-SR04T", FATHOM_MODE_ANY)->mode, FATHOM_MODE_AUTO);
    assert_int_equal(fathom_model_find("AJ-SR04M", FATHOM_MODE_ANY)->mode, FATHOM_MODE_AUTO);
    assert_int_equal(fathom_model_find("A16NY2W", FATHOM_MODE_ANY)->mode, FATHOM_MODE_AUTO);
    assert_ptr_equal(fathom_model_find("sen0311", FATHOM_MODE_ANY)->facts, &fathom_model_a02yyuw);
}
