/* SPDX-License-Identifier: MIT */
/*
 * Each list of up to two characters of each kind with each such name, and names of each form against the whole table,
 * which has constants alone. Nothing is read behind the end of a text.
 *
 * proves: src/models/models.c src/models/a05_family.c src/models/a16_family.c src/models/hps_family.c
 *         src/models/jsn_family.c
 * with:   src/sensor/factory_line.c
 * options: -eva-precision 0 -eva-auto-loop-unroll 128 -eva-slevel 20000
 */
#include "fathom/models.h"
#include "assumptions.h"

static const char kinds[] = {'\0', ',', '-', 'd', 'V', '1', '~'};
enum { KINDS = sizeof kinds, TEXTS = KINDS * KINDS };

static void set_text(char *text, unsigned number)
{
    text[0] = kinds[number % KINDS];
    text[1] = kinds[number / KINDS];
    text[2] = '\0';
}

static void each_name(unsigned list)
{
    static fathom_model_description_t model;
    static char names[3];
    static char called[3];
    set_text(names, list);
    model.name = "";
    model.aliases = names;
    for (unsigned number = 0; number != TEXTS; number++) {
        set_text(called, number);
        (void)fathom_model_is_called(&model, called);
    }
}

int main(void)
{
    for (unsigned list = 0; list != TEXTS; list++) each_name(list);
    (void)fathom_model_at(any_16());
    (void)fathom_model_find("hc-sr04", FATHOM_MODE_ANY);
    (void)fathom_model_find("DYP-A02YYUW-V2.0", any_8());
    (void)fathom_model_find("", FATHOM_MODE_ANY);
    return 0;
}
