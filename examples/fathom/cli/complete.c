/* SPDX-License-Identifier: MIT */
#include "cli/complete.h"

#include <string.h>

#include "cli/arguments.h"
#include "output/words.h"
#include "sensors/models.h"
#include "sensors/setting.h"

/* ---- candidates ---- */

/* Prints a candidate if it begins like the word. What stands before it in the word, such as "--format=", too. */
typedef struct {
    FILE *to;
    const char *word;
    const char *before;
} offer_t;

static void offer(const offer_t *offer, const char *name, size_t length, const char *help)
{
    if (strlen(offer->word) > length || strncmp(name, offer->word, strlen(offer->word)) != 0) return;
    (void)fprintf(offer->to, "%s%.*s%s%s\n", offer->before, (int)length, name, help != NULL ? "\t" : "",
                  help != NULL ? help : "");
}

static void offer_words(const offer_t *to, const char *words)
{
    const char *word = NULL;
    size_t length = 0;
    for (size_t n = 0; words != NULL && (length = word_at(words, n, &word)) != 0; n++)
        offer(to, word, length, NULL);
}

/* ---- operands ---- */

static void print_models(FILE *to, bool only_asked, bool only_resettable)
{
    for (size_t i = 0; i != model_count; i++) {
        const model_t *const model = &models[i];
        if (only_resettable && model->reset.restore == NULL) continue;
        (void)fprintf(to, "%s\t%s\n", model->name, model->what);
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL && !only_resettable; m++)
            if (!only_asked || mode_is_asked(&model->modes[m]))
                (void)fprintf(to, "%s:%s\t%s\n", model->name, model->modes[m].name, model->what);
    }
}

void operands_sensors(FILE *to, char **words, int count)
{
    (void)words, (void)count;
    print_models(to, false, false);
}

void operands_asked(FILE *to, char **words, int count)
{
    (void)words, (void)count;
    print_models(to, true, false);
}

void operands_simulated(FILE *to, char **words, int count)
{
    (void)words, (void)count;
    for (size_t i = 0; i != model_count; i++) {
        (void)fprintf(to, "%s\t%s\n", models[i].name, models[i].what);
        for (size_t m = 0; m != MODEL_MODES && models[i].modes[m].name != NULL; m++)
            if (models[i].modes[m].simulated_as != 0)
                (void)fprintf(to, "%s:%s\t%s\n", models[i].name, models[i].modes[m].name, models[i].what);
    }
}

void operands_one(FILE *to, char **words, int count)
{
    (void)words;
    if (count == 0) print_models(to, true, false);
}

void operands_resettable(FILE *to, char **words, int count)
{
    (void)words;
    if (count == 0) print_models(to, true, true);
}

void operands_file(FILE *to, char **words, int count)
{
    (void)words, (void)count;
    (void)fputs(":files\n", to);
}

static const setting_t *settings_of(const char *sensor)
{
    const size_t length = strcspn(sensor, ":@");
    for (size_t i = 0; i != model_count; i++)
        if (strlen(models[i].name) == length && strncmp(models[i].name, sensor, length) == 0)
            return models[i].settings;
    return NULL;
}

static void print_settings(FILE *to, const char *sensor, bool is_set)
{
    for (const setting_t *setting = settings_of(sensor); setting != NULL && setting->name != NULL; setting++)
        if (is_set ? setting->set != NULL : setting->get != NULL)
            (void)fprintf(to, "%s\t%s\n", setting->name, setting->what);
}

void operands_setting(FILE *to, char **words, int count)
{
    if (count == 1)
        print_settings(to, words[0], false);
    else
        operands_one(to, words, count);
}

void operands_setting_value(FILE *to, char **words, int count)
{
    if (count == 1) print_settings(to, words[0], true);
    if (count < 2) operands_one(to, words, count);
    for (const setting_t *row = count == 2 ? settings_of(words[0]) : NULL; row != NULL && row->name != NULL;
         row++)
        for (const char *const *word = row->words;
             strcmp(row->name, words[1]) == 0 && word != NULL && *word != NULL; word++)
            (void)fprintf(to, "%s\n", *word);
}

const char *model_name(size_t n) { return n < model_count ? models[n].name : NULL; }

/* Prints what operands() prints, as far as it begins like the word. */
static void offer_operands(const offer_t *to, const command_t *command, char **words, int count)
{
    char line[400];
    FILE *const all = tmpfile();
    if (all == NULL || command->operands == NULL) return;
    command->operands(all, words, count);
    rewind(all);
    while (fgets(line, sizeof line, all) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        char *const tab = strchr(line, '\t');
        if (tab != NULL) *tab = '\0';
        if (line[0] == ':')
            (void)fprintf(to->to, "%s\n", line);
        else
            offer(to, line, strlen(line), tab != NULL ? tab + 1 : NULL);
    }
    (void)fclose(all);
}

/* ---- values ---- */

static void offer_value(const offer_t *to, const option_t *row)
{
    const char *name = NULL;
    offer_words(to, row->words);
    for (size_t n = 0; row->list != NULL && (name = row->list(n)) != NULL; n++)
        offer(to, name, strlen(name), NULL);
    for (const option_t *key = row->keys; key != NULL && key->name != NULL; key++) {
        char text[40];
        (void)snprintf(text, sizeof text, "%s=", key->name);
        offer(to, text, strlen(text), key->help);
    }
    if (row->is_path) (void)fputs(":files\n", to->to);
}

static void offer_options(const offer_t *to, const command_t *command)
{
    const char *const word = to->word;
    for (option_walk_t walk = {.table = command->tables}; option_next(&walk);) {
        char text[40];
        (void)snprintf(text, sizeof text, "--%s", walk.row->name);
        if (!walk.row->is_hidden) offer(to, text, strlen(text), walk.row->help);
    }
    if (strlen(word) <= strlen("--help")) offer(to, "--help", strlen("--help"), "Print the help");
}

/* The row of the option whose value is the next word; NULL: none is. */
static const option_t *valued(const command_t *command, const char *word)
{
    for (option_walk_t walk = {.table = command->tables}; word[0] == '-' && option_next(&walk);) {
        const option_t *const row = walk.row;
        const bool is_it = word[1] == '-' ? strcmp(word + 2, row->name) == 0
                                          : word[1] == argument_letter(row->name) && word[2] == '\0';
        if (is_it) return row->kind != KIND_FLAG && row->otherwise == NULL ? row : NULL;
    }
    return NULL;
}

/* Words behind a command; the last one is completed. */
static void complete_command(FILE *to, const command_t *command, char **words, int count)
{
    const char *const word = words[count - 1];
    offer_t it = {.to = to, .word = word, .before = ""};
    const option_t *row = NULL;
    int operand_count = 0;
    for (int i = 0; i != count - 1; i++) {
        row = valued(command, words[i]);
        if (row != NULL && i + 1 != count - 1) i++;
        if (row == NULL && words[i][0] != '-') words[operand_count++] = words[i];
    }
    row = count > 1 ? valued(command, words[count - 2]) : NULL;
    char *const equals = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
    if (row == NULL && equals != NULL) {
        char option[40];
        (void)snprintf(option, sizeof option, "%.*s", (int)(equals - word), word);
        row = valued(command, option);
        char before[48];
        (void)snprintf(before, sizeof before, "%s=", option);
        it.before = before;
        it.word = equals + 1;
        if (row != NULL) offer_value(&it, row);
        return;
    }
    if (row != NULL)
        offer_value(&it, row);
    else if (word[0] == '-')
        offer_options(&it, command);
    else
        offer_operands(&it, command, words, operand_count);
}

void complete(FILE *to, const command_t *const *commands, const help_topic_t *topics, char **words, int count)
{
    if (count == 0) return;
    const offer_t it = {.to = to, .word = words[count - 1], .before = ""};
    const bool is_help = count == 2 && strcmp(words[0], "help") == 0;
    for (const command_t *const *command = commands; *command != NULL; command++) {
        if (count == 1 || is_help)
            offer(&it, (*command)->name, strlen((*command)->name), (*command)->summary);
        if (count > 1 && strcmp(words[0], (*command)->name) == 0)
            complete_command(to, *command, words + 1, count - 1);
    }
    for (const help_topic_t *topic = topics; is_help && topic->name != NULL; topic++)
        offer(&it, topic->name, strlen(topic->name), topic->summary);
    if (count == 1) offer_words(&it, it.word[0] == '-' ? "--help --version" : "help");
}

/* ---- the scripts of the shells ---- */

bool complete_script(FILE *to, const char *shell)
{
    static const char bash[] =
        "_fathom() {\n"
        "    local cur prev words cword line\n"
        "    _init_completion -n := || return\n"
        "    COMPREPLY=()\n"
        "    while IFS= read -r line; do\n"
        "        case $line in\n"
        "        :files) [[ $cur == --*=* ]] && cur=${cur#*=}; _filedir ;;\n"
        "        *)\n"
        "            [[ $cur == --*=* ]] && line=${line#*=} # bash keeps what stands before =\n"
        "            COMPREPLY+=(\"${line%%$'\\t'*}\")\n"
        "            ;;\n"
        "        esac\n"
        "    done < <(fathom complete \"${words[@]:1:cword}\" 2>/dev/null)\n"
        "    [[ ${COMPREPLY-} == *= ]] && compopt -o nospace\n"
        "    __ltrim_colon_completions \"$cur\"\n"
        "} && complete -F _fathom fathom\n";
    static const char zsh[] =
        "#compdef fathom\n"
        "local line\n"
        "local -a names helps\n"
        "for line in \"${(@f)$(fathom complete \"${(@)words[2,CURRENT]}\" 2>/dev/null)}\"; do\n"
        "    case $line in\n"
        "    '') ;;\n"
        "    :files) [[ -prefix --*= ]] && compset -P 1 '*='; _files; return ;;\n"
        "    *)\n"
        "        [[ $PREFIX == --*=* ]] && line=${line#*=}\n"
        "        names+=(\"${line%%$'\\t'*}\"); helps+=(\"${line/$'\\t'/ -- }\")\n"
        "        ;;\n"
        "    esac\n"
        "done\n"
        "[[ -prefix --*= ]] && compset -P 1 '*='\n"
        "compadd -l -d helps -S '' -q -a names\n";
    static const char fish[] =
        "function __fathom\n"
        "    set -l words (commandline -opc) (commandline -ct)\n"
        "    for line in (fathom complete $words[2..-1] 2>/dev/null)\n"
        "        switch $line\n"
        "            case :files\n"
        "                set -l parts (string match -r -- '^(--[^=]*=)?(.*)$' (commandline -ct))\n"
        "                for path in (__fish_complete_path $parts[-1])\n"
        "                    test (count $parts) -eq 3; and echo $parts[2]$path; or echo $path\n"
        "                end\n"
        "            case '*'\n"
        "                echo $line\n"
        "        end\n"
        "    end\n"
        "end\n"
        "complete -c fathom -f -a '(__fathom)'\n";
    const char *const text = strcmp(shell, "bash") == 0   ? bash
                             : strcmp(shell, "zsh") == 0  ? zsh
                             : strcmp(shell, "fish") == 0 ? fish
                                                          : NULL;
    if (text != NULL) (void)fputs(text, to);
    return text != NULL;
}
