/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "commands/sim/sim.h"
#include "output/words.h"

enum { MAX_KIND = 24 };

/* A port has no clock that could jump. */
static bool is_offered(uint8_t kind) { return kind != FATHOM_SIM_FAULT_CLOCK_JUMP; }

bool sim_can_have_fault(const sim_sensor_t *sensor, uint8_t kind)
{
    const device_settings_t settings = {.address = FACTORY_ADDRESS};
    device_t device;
    sensor->model->simulate(&device, &settings, sensor->mode->simulated_as);
    return is_offered(kind) && fathom_sim_fault_applies(kind, device.base);
}

bool sim_decimal(const char *text, size_t length, uint32_t places, uint32_t min, uint32_t max,
                 uint32_t *number)
{
    const size_t whole = strspn(text, "0123456789");
    const size_t part = whole < length && text[whole] == '.' ? strspn(text + whole + 1, "0123456789") : 0;
    const size_t read = part != 0 ? whole + 1 + part : whole;
    uint64_t sum = 0;
    if (whole == 0 || read != length || part > places) return false;
    for (size_t i = 0; i != read && sum <= UINT32_MAX; i++)
        if (i != whole) sum = sum * 10 + (uint64_t)(text[i] - '0');
    for (size_t i = part; i != places && sum <= UINT32_MAX; i++) sum *= 10;
    if (sum < min || sum > max) return false;
    *number = (uint32_t)sum;
    return true;
}

/* Reads 0.05 or 5% as millionths. */
static bool parse_chance(const char *text, size_t length, uint32_t *chance_ppm)
{
    const bool is_percent = length != 0 && text[length - 1] == '%';
    return sim_decimal(text, is_percent ? length - 1 : length, is_percent ? 4 : 6, 1,
                       FATHOM_SIM_FAULT_ALWAYS_PPM, chance_ppm);
}

/* Reads P[@N]. */
static bool parse_rest(const char *text, sim_fault_t *fault)
{
    const size_t length = strcspn(text, "@");
    if (!parse_chance(text, length, &fault->chance_ppm)) return false;
    return text[length] == '\0' || number_parse(text + length + 1, 1, UINT32_MAX, &fault->at_frame);
}

static bool reject_kind(const sim_sensor_t *sensor, const char *name, const origin_t *origin)
{
    nearest_t nearest = {.word = name};
    for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++)
        if (sim_can_have_fault(sensor, kind)) nearest_try(&nearest, fathom_sim_fault_name(kind));
    char what[80];
    (void)snprintf(what, sizeof what, "fault of %s in mode %s", sensor->model->name, sensor->mode->name);
    return reject_unknown(origin, what, "", &nearest, true);
}

bool sim_add_fault(sim_sensor_t *sensor, const char *text, const origin_t *origin)
{
    const size_t length = strcspn(text, "=");
    char name[MAX_KIND] = "";
    if (sensor->fault_count == FATHOM_SIM_FAULT_RULES)
        return reject(origin, "a sensor has at most %u faults.", FATHOM_SIM_FAULT_RULES);
    sim_fault_t *const fault = &sensor->faults[sensor->fault_count++];
    (void)snprintf(name, sizeof name, "%.*s", (int)length, text);
    fault->kind = fathom_sim_fault_find(name);
    fault->chance_ppm = FATHOM_SIM_FAULT_ALWAYS_PPM;
    if (fault->kind == 0 || !sim_can_have_fault(sensor, fault->kind))
        return reject_kind(sensor, name, origin);
    if (text[length] == '\0' || parse_rest(text + length + 1, fault)) return true;
    return reject(origin, "fault is '%s'. It takes KIND[=P[@N]], P from 0.000001 to 1 or as 5%%, N from 1.",
                  text);
}

const char *sim_fault_name(size_t n)
{
    return n + 1 < FATHOM_SIM_FAULT_CLOCK_JUMP ? fathom_sim_fault_name((uint8_t)(n + 1)) : NULL;
}

void sim_print_faults(FILE *to)
{
    for (uint8_t kind = 1; kind != FATHOM_SIM_FAULT_END; kind++)
        if (is_offered(kind))
            (void)fprintf(to, "    %-13s  %s\n", fathom_sim_fault_name(kind), fathom_sim_fault_text(kind));
    (void)fputs("A pseudo terminal cannot mark a byte: with parity, framing and break the byte arrives as a\n"
                "terminal without checks delivers it, wrong or 00, and with overrun it is missing.\n",
                to);
}
