/* SPDX-License-Identifier: MIT */
#include "drivers.h"
#include "fathom/models.h"

/* The rows of src/models: what must hold for each, the figures of well-known modules, and names. */

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

/* ---- figures ---- */

/* From the sources, not from the rows. Times of a response that were seen have to be inside the window; a period may be
 * longer than the printed one. 0: no source has it. */
static const struct {
    const char *name;
    uint8_t mode;
    uint32_t baud;
    uint16_t min_mm, max_mm;
    uint16_t period_ms; /* the printed one */
    uint8_t start, byte;
    uint8_t from_ms, to_ms; /* responses that were seen */
    uint16_t trigger_us;    /* the printed least one */
    uint16_t us_per_dm;
    uint8_t no_target_ms;
} printed[] = {
    {"SEN0311", FATHOM_MODE_AUTO, 9600, 30, 4500, 100, 0, 0, 0, 0, 0, 0, 0},
    {"a0221at", FATHOM_MODE_CONTROLLED, 9600, 30, 4500, 0, FATHOM_STARTS_FALLING, 0, 60, 60, 0, 0, 0},
    {"DYP-A02YYMW-V2.0", FATHOM_MODE_PULSE, 0, 30, 4500, 0, FATHOM_STARTS_FALLING, 0, 0, 0, 5000, 575, 40},
    {"SEN0313", FATHOM_MODE_AUTO, 9600, 280, 7500, 0, 0, 0, 0, 0, 0, 0, 0},
    {"SEN0312", FATHOM_MODE_AUTO, 9600, 280, 4500, 100, 0, 0, 0, 0, 0, 0, 0},
    {"A16NYTW", FATHOM_MODE_CONTROLLED, 9600, 500, 15000, 121, FATHOM_STARTS_FALLING, 0, 90, 114, 0, 0, 0},
    {"A16NYMW", FATHOM_MODE_PULSE, 0, 500, 15000, 221, FATHOM_STARTS_FALLING, 0, 0, 0, 0, 575, 94},
    {"SEN0207", FATHOM_MODE_AUTO, 9600, 230, 5000, 100, 0, 0, 0, 0, 0, 0, 0},
    {"JSN-SR04T-V3.3", FATHOM_MODE_CONTROLLED, 9600, 230, 5000, 61, FATHOM_STARTS_BYTE, 0x55, 5, 99, 0, 0, 0},
    {"jsn sr04t", FATHOM_MODE_PULSE, 0, 230, 5000, 0, FATHOM_STARTS_HIGH_PULSE, 0, 0, 0, 10, 588, 60},
    {"JSN-SR04T", FATHOM_MODE_FREE_PULSE, 0, 230, 5000, 200, 0, 0, 0, 0, 0, 588, 60},
    {"JSN-SR04T-V2.0", FATHOM_MODE_AUTO, 9600, 200, 6000, 100, 0, 0, 0, 0, 0, 0, 0},
    {"AJ-SR04M", FATHOM_MODE_AUTO, 9600, 200, 8000, 0, 0, 0, 0, 0, 0, 0, 0},
    {"AJ-SR04M", FATHOM_MODE_CONTROLLED, 9600, 200, 8000, 0, FATHOM_STARTS_BYTE, 0x01, 5, 120, 0, 0, 0},
    {"AJ-SR04M", FATHOM_MODE_PULSE, 0, 200, 8000, 50, FATHOM_STARTS_HIGH_PULSE, 0, 0, 0, 1000, 580, 0},
    {"HC-SR04", FATHOM_MODE_PULSE, 0, 20, 4000, 50, FATHOM_STARTS_HIGH_PULSE, 0, 0, 0, 10, 580, 38},
    {"SEN0151", FATHOM_MODE_PULSE, 0, 200, 10000, 100, FATHOM_STARTS_FALLING, 0, 0, 0, 51, 100, 15},
    {"A21AYYTW", FATHOM_MODE_CONTROLLED, 115200, 30, 5000, 150, FATHOM_STARTS_FALLING, 0, 8, 140, 0, 0, 0},
    {"SEN0599", FATHOM_MODE_CONTROLLED, 115200, 50, 6000, 19, FATHOM_STARTS_FALLING, 0, 13, 14, 0, 0, 0},
    {"SEN0598", FATHOM_MODE_CONTROLLED, 115200, 20, 3000, 19, FATHOM_STARTS_FALLING, 0, 9, 13, 0, 0, 0},
    {"L081MTW", FATHOM_MODE_CONTROLLED, 115200, 50, 2000, 34, FATHOM_STARTS_BYTE, 0x01, 5, 18, 0, 0, 0},
    {"L08B50TW", FATHOM_MODE_CONTROLLED, 115200, 80, 3000, 1000, FATHOM_STARTS_FALLING, 0, 1, 200, 100, 0, 0},
    {"SEN0591", FATHOM_MODE_MODBUS, 115200, 20, 3000, 120, 0, 0, 0, 0, 0, 0, 0},
    {"101991041", FATHOM_MODE_MODBUS, 9600, 280, 7500, 120, 0, 0, 0, 0, 0, 0, 0},
    {"A05LYU", FATHOM_MODE_AUTO, 9600, 250, 4500, 0, 0, 0, 0, 0, 0, 0, 0},
    {"hps167s", FATHOM_MODE_MODBUS, 19200, 80, 18000, 0, 0, 0, 0, 0, 0, 0, 0},
    {"hps167", FATHOM_MODE_0A, 115200, 80, 18000, 20, 0, 0, 0, 0, 0, 0, 0},
};

TEST(a_known_module_has_the_figures_of_its_sources)
{
    for (unsigned i = 0; i != COUNT(printed); i++) {
        row = fathom_model_find(printed[i].name, printed[i].mode);
        if (row == NULL) fail_msg("%s is not found", printed[i].name);
        facts = row->facts;
        must((facts->line_settings != NULL ? facts->line_settings->baud : 0) == printed[i].baud, "baud rate");
        must(facts->min_mm == printed[i].min_mm && facts->max_mm == printed[i].max_mm, "range");
        must(facts->period_ms >= printed[i].period_ms, "period");
        must(facts->start == printed[i].start && facts->trigger_byte == printed[i].byte, "start");
        must(printed[i].from_ms == 0 || facts->earliest_ms <= printed[i].from_ms, "earliest response");
        must(facts->latest_ms >= printed[i].to_ms, "latest response");
        must(facts->trigger_us >= printed[i].trigger_us, "width of the trigger");
        must(facts->us_per_dm == printed[i].us_per_dm, "scale");
        must(facts->no_target_ms == printed[i].no_target_ms, "pulse without a target");
    }
}

TEST(a_value_has_the_meaning_that_the_sources_have_seen)
{
    EACH_ROW(index)
    {
        const bool is_0 = fathom_model_is_called(row, "L041MTW") || fathom_model_is_called(row, "L042MTW") ||
                          (fathom_model_is_called(row, "AJ-SR04M") && row->mode == FATHOM_MODE_CONTROLLED);
        const bool is_fffb =
            fathom_model_is_called(row, "L081MTW") || fathom_model_is_called(row, "L08-RS485");
        must(facts->value_0 == (is_0 ? FATHOM_MEANS_NO_TARGET : FATHOM_MEANS_DEFAULT), "0");
        must(facts->value_fffb == (is_fffb ? FATHOM_MEANS_UNKNOWN : FATHOM_MEANS_DEFAULT), "FFFB");
        must(facts->value_fffd == FATHOM_MEANS_DEFAULT && facts->value_fffe == FATHOM_MEANS_DEFAULT, "FFFD");
        must(facts->value_ffff == FATHOM_MEANS_DEFAULT, "FFFF");
    }
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
