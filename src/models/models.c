/* SPDX-License-Identifier: MIT */
#include "fathom/models.h"

#include <stddef.h>

#include "models_internal.h"

/* All tables of models as one, and names as their owners write them. */

static bool is_digit(char character) { return (character >= '0') && (character <= '9'); }

/* Returns the character in upper case if it is a digit or a letter, else 0. */
static char plain(char character)
{
    if ((character >= 'a') && (character <= 'z')) return (char)(character - ('a' - 'A'));
    return (is_digit(character) || ((character >= 'A') && (character <= 'Z'))) ? character : '\0';
}

/* Skips what separates the parts of a name. A comma ends a name in a list. */
static const char *skip(const char *text)
{
    while ((*text != '\0') && (*text != ',') && (plain(*text) == '\0')) text++;
    return text;
}

/* Returns the rest of `name` behind the first name of `list`, or NULL if it does not begin with that. */
static const char *behind(const char *list, const char *name)
{
    for (list = skip(list); plain(*list) != '\0'; list = skip(list + 1)) {
        name = skip(name);
        if (plain(*list) != plain(*name)) return NULL;
        name++;
    }
    return skip(name);
}

/* Returns true if the text is the version behind a name of DYP, as in DYP-A02YYUW-V2.0. */
static bool is_version(const char *text)
{
    if (plain(*text) == 'V') text = skip(text + 1);
    while (is_digit(*text)) text = skip(text + 1);
    return *text == '\0';
}

/* Returns true if one name of `list`, which has commas between them, is `name`. */
static bool has_name(const char *list, const char *name)
{
    const char *const without_maker = behind("DYP", name);
    while (*list != '\0') {
        const char *rest = behind(list, name);
        if ((rest != NULL) && (*rest == '\0')) return true;
        rest = (without_maker != NULL) ? behind(list, without_maker) : NULL;
        if ((rest != NULL) && is_version(rest)) return true;
        while ((*list != '\0') && (*list != ',')) list++;
        if (*list == ',') list++;
    }
    return false;
}

const fathom_model_description_t *fathom_model_at(uint16_t index)
{
    static const fathom_model_table_t *const tables[4] = {&fathom_models_a16, &fathom_models_jsn,
                                                          &fathom_models_a05, &fathom_models_hps};
    for (uint8_t table = 0; table != (sizeof(tables) / sizeof(tables[0])); table++) {
        if (index < tables[table]->count) return &tables[table]->rows[index];
        index = (uint16_t)(index - tables[table]->count);
    }
    return NULL;
}

bool fathom_model_is_called(const fathom_model_description_t *model, const char *name)
{
    return has_name(model->name, name) || has_name(model->aliases, name);
}

const fathom_model_description_t *fathom_model_find(const char *name, uint8_t mode)
{
    const fathom_model_description_t *model = fathom_model_at(0);
    for (uint16_t index = 1; model != NULL; index++) {
        const bool is_mode = (mode == FATHOM_MODE_ANY) || (model->mode == mode);
        if (is_mode && fathom_model_is_called(model, name)) break;
        model = fathom_model_at(index);
    }
    return model;
}
