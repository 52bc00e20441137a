/* SPDX-License-Identifier: MIT */
#include "commands/sim/sim_faults.h"

#include <string.h>

#include "cli/command.h"
#include "cli/options.h"

enum { KINDS_TEXT = 400, MAX_KIND = 16 };

void sim_faults_note(sim_faults_t *faults, const char *text)
{
    if (faults->count < FATHOM_SIM_FAULT_RULES) faults->texts[faults->count] = text;
    faults->count++;
}

/* A port has no clock that could jump. */
static bool is_offered(uint8_t kind) { return kind != FATHOM_SIM_FAULT_CLOCK_JUMP; }

static bool applies(uint8_t kind, const model_mode_t *mode)
{
    const device_settings_t settings = {.address = FACTORY_ADDRESS};
    device_t device;
    mode->simulate(&device, &settings);
    return is_offered(kind) && fathom_sim_fault_applies(kind, device.base);
}

/* Decimal digits with `places` of them after the point, as a whole number; nothing is rounded. */
static bool parse_decimal(const char *text, size_t length, uint32_t places, uint32_t *number)
{
    uint64_t sum = 0;
    uint32_t after = 0;
    bool point = false;
    bool digit = false;
    for (size_t i = 0; i != length; i++) {
        if (text[i] == '.' && !point) {
            point = true;
            continue;
        }
        if (text[i] < '0' || text[i] > '9' || after == places || sum > UINT32_MAX) return false;
        sum = sum * 10 + (uint64_t)(text[i] - '0');
        if (point) after++;
        digit = true;
    }
    for (; after != places; after++) sum *= 10;
    if (!digit || sum > UINT32_MAX) return false;
    *number = (uint32_t)sum;
    return true;
}

/* 0.05 or 5%, in millionths. */
static bool parse_chance(const char *text, size_t length, uint32_t *chance_ppm)
{
    const bool percent = length != 0 && text[length - 1] == '%';
    if (!parse_decimal(text, percent ? length - 1 : length, percent ? 4 : 6, chance_ppm)) return false;
    return *chance_ppm >= 1 && *chance_ppm <= FATHOM_SIM_FAULT_ALWAYS_PPM;
}

/* What follows the name. */
static bool parse_rest(const char *text, sim_fault_t *fault)
{
    fault->chance_ppm = FATHOM_SIM_FAULT_ALWAYS_PPM;
    if (*text == '\0') return true;
    text++;
    const size_t length = strcspn(text, "@");
    if (!parse_chance(text, length, &fault->chance_ppm)) return false;
    return text[length] == '\0' || number_parse(text + length + 1, 1, UINT32_MAX, &fault->at_frame);
}

static bool parse_one(const char *command, const model_t *model, const model_mode_t *mode, const char *text,
                      sim_fault_t *fault)
{
    const size_t length = strcspn(text, "=");
    char name[MAX_KIND] = "";
    if (length < sizeof name) memcpy(name, text, length);
    fault->kind = fathom_sim_fault_find(name);
    if (fault->kind == 0 || !applies(fault->kind, mode)) {
        char known[KINDS_TEXT] = "";
        for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++)
            if (applies(kind, mode)) list_add(known, sizeof known, fathom_sim_fault_name(kind));
        (void)usage_error(command, "there is no fault '%.*s' for %s in mode %s, only %s", (int)length, text,
                          model->name, mode->name, known);
        return false;
    }
    if (!parse_rest(text + length, fault)) {
        (void)usage_error(
            command, "--fault takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%%, N from 1, not '%s'", text);
        return false;
    }
    return true;
}

bool sim_faults_parse(sim_faults_t *faults, const char *command, const model_t *model,
                      const model_mode_t *mode)
{
    if (faults->count > FATHOM_SIM_FAULT_RULES) {
        (void)usage_error(command, "--fault may be given up to %u times", FATHOM_SIM_FAULT_RULES);
        return false;
    }
    for (uint32_t i = 0; i != faults->count; i++)
        if (!parse_one(command, model, mode, faults->texts[i], &faults->list[i])) return false;
    return true;
}

void sim_faults_begin(const sim_faults_t *faults, fathom_sim_fault_t *fault, uint32_t seed)
{
    fathom_sim_fault_init(fault, seed);
    for (uint32_t i = 0; i != faults->count; i++)
        (void)fathom_sim_fault_add(fault, faults->list[i].kind, faults->list[i].chance_ppm,
                                   faults->list[i].at_frame);
}

void sim_faults_print(FILE *to)
{
    bool second = false;
    for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++) {
        if (!is_offered(kind)) continue;
        (void)fprintf(to, second ? "%-12s  %s\n" : "    %-12s  %-41s  ", fathom_sim_fault_name(kind),
                      fathom_sim_fault_text(kind));
        second = !second;
    }
    if (second) (void)fputc('\n', to);
    (void)fputs("A pseudo terminal cannot mark a byte: with parity, framing and break it comes as a terminal "
                "without\nchecks delivers it, wrong or 00, and with overrun it is missing.\n",
                to);
}
