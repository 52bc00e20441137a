/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "device/session.h"
#include "output/words.h"
#include "sensors/models.h"

/* ---- settings as text ---- */

bool setting_value(const setting_t *setting, const char *text, int32_t *value)
{
    char *end = NULL;
    for (int32_t i = 0; setting->words != NULL && setting->words[i] != NULL; i++) {
        if (strcmp(setting->words[i], text) != 0) continue;
        *value = i;
        return true;
    }
    if (setting->words != NULL || strspn(text, "-0123456789") != strlen(text)) return false;
    const long long number = strtoll(text, &end, 10);
    *value = (int32_t)number;
    return end != text && *end == '\0' && setting_can_be(setting, number);
}

const char *setting_values_text(const setting_t *setting, char text[SETTING_VALUES])
{
    text[0] = '\0';
    if (setting->words != NULL) {
        for (const char *const *word = setting->words; *word != NULL; word++)
            list_add(text, SETTING_VALUES, *word);
        return text;
    }
    const int length =
        snprintf(text, SETTING_VALUES, "%" PRId32 " to %" PRId32, setting->least, setting->most);
    char *const end = text + length;
    const size_t left = SETTING_VALUES - (size_t)length;
    const char *const unit = setting->unit != NULL ? setting->unit : "";
    const char *const blank = unit[0] != '\0' ? " " : "";
    if (setting->step > 1)
        (void)snprintf(end, left, ", a multiple of %" PRId32 "%s%s", setting->step, blank, unit);
    else
        (void)snprintf(end, left, "%s%s", blank, unit);
    return text;
}

void setting_print_value(const setting_t *setting, int32_t value, char text[SETTING_TEXT])
{
    if (setting->words != NULL)
        (void)snprintf(text, SETTING_TEXT, "%s", setting->words[value]);
    else
        (void)snprintf(text, SETTING_TEXT, "%" PRId32, value);
}

const char *setting_with_unit(const setting_t *setting, const char *text, char cell[SETTING_CELL])
{
    const bool has_unit = setting->unit != NULL && strspn(text, "0123456789-., ") == strlen(text);
    (void)snprintf(cell, SETTING_CELL, "%s%s%s", text, has_unit ? " " : "", has_unit ? setting->unit : "");
    return cell;
}

/* Keys and words of JSON have underscores. */
static const char *json_word(const char *text, char word[SETTING_TEXT])
{
    (void)snprintf(word, SETTING_TEXT, "%s", text);
    for (char *at = word; *at != '\0'; at++)
        if (*at == '-' || *at == ' ') *at = '_';
    return word;
}

void setting_json(json_t *json, const char *key, const setting_t *setting, const char *text)
{
    char name[SETTING_TEXT];
    const bool can_be_number = setting->kind != SETTING_VERSION && setting->kind != SETTING_IDENTITY;
    (void)json_word(setting->name, name);
    if (key == NULL) key = name;
    if (text != NULL && (strcmp(text, "on") == 0 || strcmp(text, "off") == 0))
        json_flag(json, key, strcmp(text, "on") == 0);
    else if (text != NULL && text[0] != '\0' && can_be_number && strspn(text, "-0123456789.") == strlen(text))
        json_value(json, key, "%s", text);
    else
        json_string(json, key, text);
}

const char *setting_reason(fathom_status_t status)
{
    switch (status) {
    case FATHOM_ERR_NO_RESPONSE:
        return "no response. Not every variant has it";
    case FATHOM_ERR_EXCEPTION:
        return "refused. Not every variant has it";
    case FATHOM_ERR_MALFORMED:
        return "the response has an impossible value";
    default:
        return NULL;
    }
}

void settings_print(FILE *to, const setting_t *settings)
{
    for (const setting_t *setting = settings; setting->name != NULL; setting++) {
        (void)fprintf(to, "  %s%s\n      %s", setting->name, setting->read_at == 0 ? " (write-only)" : "",
                      setting->what);
        if (setting->effect == NULL) {
            (void)fputs("; cannot be set\n", to);
        } else {
            char values[SETTING_VALUES];
            (void)fprintf(to, ": %s\n      %s\n", setting_values_text(setting, values), setting->effect);
        }
    }
}

/* ---- the outcome of a change ---- */

static const char *const words[] = {[CHANGE_UNCHANGED] = "unchanged",
                                    [CHANGE_DONE] = "written",
                                    [CHANGE_UNCONFIRMED] = "not confirmed",
                                    [CHANGE_DIFFERS] = "differs",
                                    [CHANGE_REFUSED] = "refused",
                                    [CHANGE_NOT_WRITTEN] = "not written",
                                    [CHANGE_SENT] = "sent"};

static reader_facts_t facts_of(const change_t *change)
{
    return reader_facts(change->session->sensor->reader);
}

/* If the setting is read back, CHANGE_DONE is more than an acknowledgement. */
static bool is_read_back(const change_t *change)
{
    const setting_t *const setting = change->setting;
    return !change->is_blind && (setting->read_at != 0 || setting->moves || setting->confirmed != NULL);
}

change_outcome_t change_outcome(const change_t *change, fathom_status_t status)
{
    const reader_facts_t facts = facts_of(change);
    if (!facts.is_written) return status == FATHOM_OK ? CHANGE_UNCHANGED : CHANGE_NOT_WRITTEN;
    if (status == FATHOM_OK) return CHANGE_DONE;
    if (change->is_for_all) return facts.acknowledgement == FATHOM_OK ? CHANGE_SENT : CHANGE_UNCONFIRMED;
    if (status == FATHOM_ERR_EXCEPTION) return CHANGE_REFUSED;
    const bool is_unknown =
        facts.is_setting || status == FATHOM_ERR_UNCONFIRMED || change->setting->confirmed != NULL;
    return is_unknown || !is_read_back(change) ? CHANGE_UNCONFIRMED : CHANGE_DIFFERS;
}

/* Returns where the sensor may be, or what else is unknown. */
enum { UNKNOWN_TEXT = 400 };
static const char *unknown_text(const change_t *change, char text[UNKNOWN_TEXT])
{
    const sensor_t *const sensor = change->session->sensor;
    const setting_t *const setting = change->setting;
    const bool is_readable = setting->read_at != 0 && !change->is_blind;
    char line[LINE_TEXT];
    if (setting->is_baud)
        (void)snprintf(text, UNKNOWN_TEXT,
                       "The sensor is at %" PRIu32 " or at %s baud, perhaps from its next power-on. Run "
                       "'fathom scan --port %s --baud %" PRIu32 ",%s'",
                       sensor->line.baud, change->wanted, sensor->port->path, sensor->line.baud,
                       change->wanted);
    else if (setting->moves)
        (void)snprintf(text, UNKNOWN_TEXT,
                       "The sensor is at address %u or at address %s, %s. Read it at both", sensor->address,
                       change->wanted, session_line_text(change->session, line));
    else
        (void)snprintf(text, UNKNOWN_TEXT, "%s%s",
                       setting->unconfirmed != NULL ? setting->unconfirmed : "The value may be set or not",
                       is_readable ? ". Read it with 'fathom get'" : "");
    return text;
}

/* Returns true after printing that a sensor responds at the wanted address, and none at the present one: the user repeats
 * a command that has moved the sensor. */
static bool explain_moved(const change_t *change)
{
    session_t *const session = change->session;
    const unsigned from = session->sensor->address;
    const fathom_line_settings_t line = session->sensor->line;
    if (!change->setting->moves || change->setting->is_baud) return false;
    if (presence_ask(session, (uint8_t)change->value, &line, 1).what != PRESENT_ONE)
        return !session_move(session, (uint8_t)from, &line);
    return !session_fail(
        session, FATHOM_OK,
        "it responds, and nothing responds at address %u, so nothing was written. Perhaps it is the "
        "same sensor, and has moved to address %s before",
        from, change->wanted);
}

void change_explain(const change_t *change, change_outcome_t outcome, fathom_status_t status)
{
    const reader_facts_t facts = facts_of(change);
    if (outcome == CHANGE_NOT_WRITTEN && status == FATHOM_ERR_NO_RESPONSE && explain_moved(change)) return;
    const bool is_acknowledged = !facts.is_setting && facts.acknowledgement == FATHOM_OK;
    const char *const response =
        is_acknowledged ? "the sensor acknowledged the write" : "no acknowledgement was received";
    char why[2 * UNKNOWN_TEXT] = "";
    if (outcome == CHANGE_UNCONFIRMED) {
        char text[UNKNOWN_TEXT];
        (void)snprintf(why, sizeof why, ": %s. %s", response, unknown_text(change, text));
    } else if (outcome == CHANGE_DIFFERS) {
        (void)snprintf(why, sizeof why,
                       ": %s, but it reads back another value. Perhaps this variant does not have it",
                       response);
    } else if (status == FATHOM_ERR_IN_USE) {
        (void)snprintf(why, sizeof why,
                       ": a sensor responds at address %s already. Two sensors at one address would respond "
                       "at the same time",
                       change->wanted);
    } else if (status == FATHOM_ERR_ARGUMENT || status == FATHOM_ERR_UNSUPPORTED) {
        /* the value is in range, so the driver does not know the settings of the line */
        (void)snprintf(why, sizeof why, ": the settings of this port's line cannot be changed");
    }
    (void)session_fail(change->session, why[0] != '\0' ? FATHOM_OK : status, "%s %s: %s%s",
                       change->setting->name, change->wanted, words[outcome], why);
}

static void print_json(const change_t *change, change_outcome_t outcome)
{
    const bool is_unchanged = outcome == CHANGE_UNCHANGED;
    char status[SETTING_TEXT];
    json_t json = {.to = stdout};
    json_begin(&json, NULL, '{');
    sensor_json(&json, change->session->sensor);
    json_value(&json, "address", "%u", change->is_for_all ? 0u : (unsigned)facts_of(change).address);
    json_string(&json, "setting", change->setting->name);
    setting_json(&json, "value", change->setting, change->wanted);
    setting_json(&json, "was", change->setting, change->was[0] != '\0' ? change->was : NULL);
    json_flag(&json, "written", !is_unchanged && outcome != CHANGE_NOT_WRITTEN);
    json_flag(&json, "confirmed", is_unchanged || (outcome == CHANGE_DONE && is_read_back(change)));
    json_string(&json, "status", json_word(words[outcome], status));
    json_end(&json, '}');
    (void)fputc('\n', stdout);
}

static void print_done(const change_t *change, change_outcome_t outcome)
{
    const setting_t *const setting = change->setting;
    const sensor_t *const sensor = change->session->sensor;
    const reader_facts_t facts = facts_of(change);
    char value[SETTING_CELL];
    (void)setting_with_unit(setting, change->wanted, value);
    if (setting->read_at == 0 && setting->confirmed == NULL && !setting->moves) {
        (void)printf("%s: %s: %s was written and acknowledged; the setting cannot be read back\n",
                     sensor->name, setting->name, value);
        return;
    }
    (void)printf("%s: %s is %s", sensor->name, setting->name, value);
    if (setting->is_baud && reader_facts(sensor->reader).is_later)
        (void)printf(" from the next power-on (%s until then)", change->was);
    else if (outcome == CHANGE_UNCHANGED)
        (void)printf(": %s", words[outcome]);
    else if (setting->read_at != 0)
        (void)printf("%s (was %s)", setting->is_later ? " from the next power-on" : "", change->was);
    else if (setting->confirmed != NULL)
        (void)printf(": %s", setting->confirmed);
    (void)puts("");
    if (outcome == CHANGE_UNCHANGED || !setting->moves) return;
    (void)fputs("from now on: ", stdout);
    read_command_print(stdout, sensor->model, sensor->mode->name, facts.address,
                       facts.line != NULL ? facts.line : &sensor->line, sensor->port->path);
    (void)puts("");
}

bool change_report(const change_t *change, fathom_status_t status)
{
    const change_outcome_t outcome = change_outcome(change, status);
    /* Nothing was read that could confirm the value, so an acknowledgement, or what may be an echo of it, is a success. */
    const int8_t response = facts_of(change).acknowledgement;
    const bool is_blind = outcome == CHANGE_SENT || (change->is_blind && outcome == CHANGE_UNCONFIRMED &&
                                                     (response == FATHOM_OK || response == FATHOM_ERR_ECHO));
    const bool is_done = outcome == CHANGE_UNCHANGED || outcome == CHANGE_DONE || is_blind;
    if (change->session->is_json) print_json(change, outcome);
    if (!is_done)
        change_explain(change, outcome, status);
    else if (is_blind && !change->session->is_json)
        (void)printf("%s: %s %s: %s\n", change->is_for_all ? "all units" : change->session->sensor->name,
                     change->setting->name, change->wanted, words[outcome]);
    else if (!change->session->is_json)
        print_done(change, outcome);
    if (is_output_written()) return is_done;
    (void)fprintf(stderr, "fathom: the setting: %s\n", words[outcome]);
    return false;
}
