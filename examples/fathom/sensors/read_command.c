/* SPDX-License-Identifier: MIT */
#include "sensors/read_command.h"

#include <string.h>

#include "ports/line_text.h"

static void print_word(FILE *to, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:@%+=,-";
    if (word[0] != '\0' && strspn(word, plain) == strlen(word)) {
        (void)fputs(word, to);
        return;
    }
    (void)fputc('\'', to);
    for (; *word != '\0'; word++) (void)fprintf(to, *word == '\'' ? "'\\''" : "%c", *word);
    (void)fputc('\'', to);
}

void read_command_print(FILE *to, const model_t *model, const char *mode, int address,
                        const fathom_line_settings_t *line, const char *port)
{
    char options[LINE_OPTIONS];
    const bool is_first_mode = strcmp(mode, model->modes[0].name) == 0;
    (void)fprintf(to, "fathom read %s", model->name);
    if (address >= 0) (void)fprintf(to, ":%d:%s", address, mode);
    if (address < 0 && !is_first_mode) (void)fprintf(to, "::%s", mode);
    (void)fputs(" --port ", to);
    print_word(to, port);
    (void)fputs(line_options(line, &model->line, options), to);
}
