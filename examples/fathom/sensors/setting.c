/* SPDX-License-Identifier: MIT */
#include "sensors/setting.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "fathom/codec/hps167s_registers.h"

const setting_t *setting_of(const setting_t *settings, const char *name)
{
    for (const setting_t *setting = settings; setting->name != NULL; setting++)
        if (strcmp(setting->name, name) == 0) return setting;
    return NULL;
}

int64_t setting_decode(const setting_t *setting, const uint16_t *registers)
{
    const uint8_t size = setting->size != 0 ? setting->size : 2;
    uint32_t value = 0;
    for (unsigned i = setting->byte; i != (unsigned)setting->byte + size; i++)
        value = value << 8 | fathom_hps167s_get_byte(registers, (uint8_t)i);
    const bool is_negative = setting->least < 0 && size == 2 && value >= 0x8000u;
    return is_negative ? (int64_t)value - 0x10000 : value;
}

int32_t setting_word(const setting_t *setting, int64_t value)
{
    const int64_t step = setting->word_step != 0 ? setting->word_step : 1;
    for (int32_t i = 0; setting->words[i] != NULL; i++)
        if (value == setting->first_word + i * step) return i;
    return -1;
}

bool setting_can_be(const setting_t *setting, int64_t value)
{
    if (setting->words != NULL) return setting_word(setting, value) >= 0;
    if (setting->most == 0 || (setting->has_zero && value == 0)) return true;
    return value >= setting->least && value <= setting->most &&
           (setting->step <= 1 || value % setting->step == 0);
}

fathom_status_t setting_print(const setting_t *setting, const uint16_t *registers, char text[SETTING_TEXT])
{
    const int64_t value = setting_decode(setting, registers);
    if (setting->print != NULL) {
        setting->print(text, registers);
    } else if (setting->words != NULL) {
        const int32_t word = setting_word(setting, value);
        if (word < 0) return FATHOM_ERR_MALFORMED;
        (void)snprintf(text, SETTING_TEXT, "%s", setting->words[word]);
    } else {
        (void)snprintf(text, SETTING_TEXT, "%" PRId64, value);
    }
    return FATHOM_OK;
}
