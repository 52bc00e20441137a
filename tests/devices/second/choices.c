/* SPDX-License-Identifier: MIT */
/* The table of the choices, and what a seed draws. A draw depends on the seed and the name alone. */
#include "second_device.h"

#include <string.h>

#define KIND(name)       (1U << SECOND_##name)
#define K_A16_AUTO       KIND(A16_AUTO)
#define K_A16_CONTROLLED KIND(A16_CONTROLLED)
#define K_A16_RS232      KIND(A16_RS232)
#define K_A16_RS485      KIND(A16_RS485)
#define K_A16_FREE       (K_A16_AUTO | K_A16_RS232)
#define K_A16_FRAMES     (K_A16_FREE | K_A16_CONTROLLED)
#define K_A16_MODBUS     (K_A16_RS232 | K_A16_RS485)
#define K_A16_SLOW       (K_A16_AUTO | K_A16_MODBUS)
#define K_A16            (K_A16_SLOW | K_A16_CONTROLLED)
#define K_A05_UART       KIND(A05_UART)
#define K_A05_RS485      KIND(A05_RS485)
#define K_A05            (K_A05_UART | K_A05_RS485)
#define K_MODBUS         (K_A16_MODBUS | K_A05)
#define K_HPS            KIND(HPS167S)
#define K_HPS167         KIND(HPS167)
#define K_HPS_VALUES     (K_HPS | K_HPS167)
#define K_HEARS          (K_MODBUS | K_HPS_VALUES)
#define K_RESPONSES      (K_HEARS | K_A16_CONTROLLED)
#define K_PAIR           (K_A16_RS485 | K_A05_RS485 | K_HPS)
#define K_ALL            (K_A16 | K_A05 | K_HPS_VALUES)
#define K_PWM            KIND(A16_PWM)
#define K_TRIGGERED      (K_A16_CONTROLLED | K_PWM)
#define K_SWITCH         KIND(A16_SWITCH)
#define K_RELAY          KIND(A05_RELAY)

/* clang-format off */
#define V_SILENCE      {RESPONSE_SILENCE, 1, "silence"}
#define V_EXCEPTION(n) {n, 1, "exception 0" #n}
#define V_TAKEN        {RESPONSE_TAKEN, 1, "taken"}
#define V_ECHOED       {RESPONSE_ECHOED, 1, "echoed, not taken"}
/* clang-format on */

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

#define RANGE(name, kinds, section, says, low, high, usual)
#define LIST(name, kinds, section, says, ...)     static const second_value_t values_##name[] = {__VA_ARGS__};
#define MISPRINT(name, kinds, section, says, ...) static const second_value_t values_##name[] = {__VA_ARGS__};
#include "choice_rows.h"
#undef RANGE
#undef LIST
#undef MISPRINT

#define RANGE(name, kinds, section, says, low, high, usual)                                                  \
    {#name, section, says, kinds, false, NULL, 0, low, high, usual},
#define LIST(name, kinds, section, says, ...)                                                                \
    {#name, section, says, kinds, false, values_##name, COUNT_OF(values_##name), 0, 0, 0},
#define MISPRINT(name, kinds, section, says, ...)                                                            \
    {#name, section, says, kinds, true, values_##name, COUNT_OF(values_##name), 0, 0, 0},
static const second_choice_row_t rows[] = {
#include "choice_rows.h"
};

static uint64_t mix(uint64_t value)
{
    value += 0x9E3779B97F4A7C15U;
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9U;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBU;
    return value ^ (value >> 31);
}

static uint64_t hash(const char *name, uint64_t seed)
{
    uint64_t value = mix(seed);
    for (const char *c = name; *c != '\0'; c++) value = mix(value ^ (uint8_t)*c);
    return value;
}

static int64_t usual(const second_choice_row_t *row)
{
    return row->values != NULL ? row->values[0].value : row->usual;
}

int64_t second_choice_draw(second_choice_t choice, uint64_t seed)
{
    const second_choice_row_t *row = &rows[choice];
    if (seed == 0) return usual(row);
    uint64_t drawn = hash(row->name, seed);
    if (row->values == NULL) {
        switch (drawn % 8) {
        case 0:
            return row->low;
        case 1:
            return row->high;
        case 2:
        case 3:
            return row->usual;
        default:
            return row->low + (int64_t)(mix(drawn) % (uint64_t)(row->high - row->low + 1));
        }
    }
    uint64_t weights = 0;
    for (size_t i = 0; i < row->value_count; i++) weights += row->values[i].weight;
    drawn %= weights;
    for (size_t i = 0; i < row->value_count; i++) {
        if (drawn < row->values[i].weight) return row->values[i].value;
        drawn -= row->values[i].weight;
    }
    return usual(row);
}

bool second_choice_allows(second_choice_t choice, int64_t value)
{
    const second_choice_row_t *row = &rows[choice];
    if (row->values == NULL) return value >= row->low && value <= row->high;
    for (size_t i = 0; i < row->value_count; i++) {
        if (row->values[i].value == value) return true;
    }
    return false;
}

const char *second_choice_meaning(second_choice_t choice, int64_t value)
{
    const second_choice_row_t *row = &rows[choice];
    for (size_t i = 0; i < row->value_count; i++) {
        if (row->values[i].value == value) return row->values[i].meaning;
    }
    return "";
}

static bool force(second_device_t *d, const second_override_t *override)
{
    for (int i = 0; i < CHOICE_COUNT; i++) {
        second_choice_t choice = (second_choice_t)i;
        if (strcmp(rows[i].name, override->name) != 0) continue;
        if (!second_choice_allows(choice, override->value)) return false;
        d->choice[i] = override->value;
        return true;
    }
    return false;
}

static const hooks_t *hooks_of(second_kind_t kind)
{
    switch (kind) {
    case SECOND_A16_AUTO:
    case SECOND_A16_CONTROLLED:
    case SECOND_A16_RS232:
    case SECOND_A16_RS485:
        return &second_a16_hooks;
    case SECOND_A05_UART:
    case SECOND_A05_RS485:
        return &second_a05_hooks;
    case SECOND_HPS167S:
        return &second_hps_hooks;
    case SECOND_HPS167:
        return &second_hps167_hooks;
    case SECOND_A16_PWM:
    case SECOND_A16_SWITCH:
    case SECOND_A05_RELAY:
        return &second_level_hooks;
    case SECOND_RELATIVE:
    case SECOND_RELATIVE_PULSE:
        return &second_relative_hooks;
    case SECOND_KINDS:
        break;
    }
    return NULL;
}

bool second_init(second_device_t *d, const second_config_t *config)
{
    memset(d, 0, sizeof *d);
    d->config = *config;
    d->hooks = hooks_of(config->kind);
    if (d->hooks == NULL) return false;
    for (int i = 0; i < CHOICE_COUNT; i++) {
        second_choice_t choice = (second_choice_t)i;
        d->choice[i] = second_choice_draw(choice, config->seed);
        if (config->no_misprints && rows[i].misprint) d->choice[i] = usual(&rows[i]);
    }
    for (size_t i = 0; i < config->override_count; i++) {
        if (!force(d, &config->overrides[i])) return false;
    }
    d->random = mix(config->seed ^ ((uint64_t)config->kind << 32) ^ ((uint64_t)config->address << 40));
    d->next_address = -1;
    for (int i = 0; i < TIMER_COUNT; i++) d->timer_us[i] = SECOND_NEVER;
    d->scenes[0].scene = config->scene;
    d->scene_count = 1;
    if (d->config.fitted == 0) d->config.fitted = 0x0F;
    if (d->config.address == 0) d->config.address = 0x01;
    bool is_a05 = config->kind == SECOND_A05_UART || config->kind == SECOND_A05_RS485;
    if (!is_a05 && config->kind != SECOND_A05_RELAY) d->config.fitted = 0x01;
    d->hooks->init(d);
    return true;
}

int64_t second_choice(const second_device_t *device, second_choice_t choice)
{
    return device->choice[choice];
}

void second_print_choices(const second_device_t *d, FILE *out)
{
    for (int i = 0; i < CHOICE_COUNT; i++) {
        second_choice_t choice = (second_choice_t)i;
        if ((rows[i].kinds & 1U << d->config.kind) == 0) continue;
        fprintf(out, "%s=%lld %s [%s: %s]\n", rows[i].name, (long long)d->choice[i],
                second_choice_meaning(choice, d->choice[i]), rows[i].section, rows[i].says);
    }
}
