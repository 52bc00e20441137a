/* SPDX-License-Identifier: MIT */
/* Help, man pages and completion: three printers of the same rows. */
#include <ctype.h>
#include <stdarg.h>
#include <string.h>

#include "cli/command.h"
#include "fathom/version.h"
#include "output/words.h"
#include "sensors/models.h"

enum { WIDTH = 80, LINE = 400 };

/* ---- texts ---- */

/* Prints a part of a line; for man so that roff takes none of it as a request. */
static void print_part(FILE *to, const char *text, size_t length, bool is_man)
{
    if (is_man && length != 0 && (text[0] == '.' || text[0] == '\'')) (void)fputs("\\&", to);
    for (size_t i = 0; i != length; i++) {
        if (is_man && text[i] == '-')
            (void)fputs("\\-", to);
        else if (is_man && text[i] == '\\')
            (void)fputs("\\e", to);
        else
            (void)fputc(text[i], to);
    }
}

/* A line that is too long goes on below the text that begins behind its last two blanks. */
static void print_line(FILE *to, const char *line, size_t length, bool is_man)
{
    size_t indent = 0;
    size_t column = 0;
    for (size_t i = 2; i < length; i++)
        if (line[i] != ' ' && line[i - 1] == ' ' && line[i - 2] == ' ') indent = i;
    while (column + length > WIDTH) {
        size_t end = WIDTH - column;
        while (end > indent - column && line[end] != ' ') end--;
        if (end == indent - column) break;
        print_part(to, line, end, is_man);
        (void)fprintf(to, "\n%*s", (int)indent, "");
        line += end + 1;
        length -= end + 1;
        column = indent;
    }
    print_part(to, line, length, is_man);
    (void)fputc('\n', to);
}

static void print_text(FILE *to, const char *text, bool is_man)
{
    while (text != NULL && *text != '\0') {
        const size_t length = strcspn(text, "\n");
        print_line(to, text, length, is_man);
        text += length + (text[length] == '\n' ? 1 : 0);
    }
}

/* Of an option: "--port PORT", "--stats[=S]". */
static void label_of(const option_t *row, char *label, size_t capacity)
{
    if (row->otherwise != NULL)
        (void)snprintf(label, capacity, "--%s[=%.*s]", row->name, (int)strlen(row->value) - 2,
                       row->value + 1);
    else
        (void)snprintf(label, capacity, "--%s%s%s", row->name, row->value != NULL ? " " : "",
                       row->value != NULL ? row->value : "");
}

static void print_option(FILE *to, const option_t *row, bool is_man)
{
    const char letter = option_letter(row->name);
    char label[80];
    char line[LINE];
    label_of(row, label, sizeof label);
    if (!is_man) {
        char before[] = "    ";
        if (letter != '\0') (void)snprintf(before, sizeof before, "-%c, ", letter);
        (void)snprintf(line, sizeof line, "  %s%-16s  %s", before, label, row->help);
        print_line(to, line, strlen(line), false);
        return;
    }
    (void)fputs(".TP\n.B ", to);
    if (letter != '\0') (void)fprintf(to, "\\-%c, ", letter);
    (void)snprintf(line, sizeof line, "%s\n%s.", label, row->help);
    print_text(to, line, true);
    for (const option_t *key = row->keys; key != NULL && key->name != NULL; key++) {
        (void)snprintf(line, sizeof line, "%s=%s\n%s.", key->name, key->value, key->help);
        (void)fputs(".RS\n.TP\n.B ", to);
        print_text(to, line, true);
        (void)fputs(".RE\n", to);
    }
}

void help_print_keys(FILE *to, const option_t *keys)
{
    for (const option_t *key = keys; key->name != NULL; key++) {
        char label[80];
        (void)snprintf(label, sizeof label, "%s=%s", key->name, key->value);
        (void)fprintf(to, "  %-20s  %s\n", label, key->help);
    }
}

static void print_heading(FILE *to, const char *heading, bool is_man)
{
    (void)fprintf(to, is_man ? ".SS %s\n" : "\n%s:\n", heading);
}

/* First those that the command names as the most common, in this order. */
static void print_options(FILE *to, const command_t *command, bool is_man)
{
    static const char *const headings[GROUPS] = {
        [GROUP_COMMAND] = "Options", [GROUP_SENSOR] = "Sensor",         [GROUP_LINE] = "Line",
        [GROUP_OUTPUT] = "Output",   [GROUP_PROCESSING] = "Processing",
    };
    option_walk_t walk;
    if (command->common != NULL) print_heading(to, "Common options", is_man);
    for (const char *names = command->common; names != NULL;) {
        char name[32];
        names = next_word(names, ' ', name, sizeof name);
        if (option_find(&walk, command->tables, name)) print_option(to, walk.row, is_man);
    }
    for (option_group_t group = GROUP_COMMAND; group != GROUPS; group++) {
        const bool is_own = group == GROUP_COMMAND && command->own_group != NULL;
        bool has_begun = false;
        for (walk = (option_walk_t){.table = command->tables}; option_next(&walk);) {
            uint32_t n = 0;
            if (walk.row->is_hidden || walk.row->group != group ||
                (command->common != NULL && word_find(command->common, walk.row->name, &n)))
                continue;
            if (!has_begun) print_heading(to, is_own ? command->own_group : headings[group], is_man);
            has_begun = true;
            print_option(to, walk.row, is_man);
        }
    }
}

/* ---- help ---- */

void help_print(FILE *to, const command_t *command)
{
    const char *before = "Usage: ";
    for (const char *usage = command->usage; usage != NULL; before = "       ") {
        char line[LINE];
        usage = next_word(usage, '\n', line, sizeof line);
        (void)fprintf(to, "%sfathom %s %s\n", before, command->name, line);
    }
    (void)fprintf(to, "\n%s.\n", command->summary);
    print_text(to, command->about, false);
    print_options(to, command, false);
    if (command->examples != NULL) print_heading(to, "Examples", false);
    print_text(to, command->examples, false);
    if (command->status != NULL) (void)fputc('\n', to);
    print_text(to, command->status, false);
    if (command->topics != NULL) (void)fprintf(to, "More: fathom help %s.\n", command->topics);
}

void help_print_topic(FILE *to, const help_topic_t *topic) { print_text(to, topic->text, false); }

/* ---- man ---- */

static void print_lines(FILE *to, const char *head, const char *lines)
{
    if (lines == NULL) return;
    (void)fprintf(to, ".SH %s\n.nf\n", head);
    print_text(to, lines, true);
    (void)fputs(".fi\n", to);
}

/* name: "-read", or "" for the tool. */
static void print_title(FILE *to, const char *name, const char *summary)
{
    char line[LINE];
    (void)fputs(".TH FATHOM", to);
    for (const char *at = name; *at != '\0'; at++) (void)fputc(toupper((unsigned char)*at), to);
    (void)fprintf(to, " 1 \"\" \"fathom %s\" \"User Commands\"\n.SH NAME\nfathom%s \\- ",
                  FATHOM_VERSION_STRING, name);
    (void)snprintf(line, sizeof line, "%s\n", summary);
    print_text(to, line, true);
    (void)fputs(".SH SYNOPSIS\n", to);
}

void man_print(FILE *to, const command_t *command)
{
    char line[LINE];
    (void)snprintf(line, sizeof line, "-%s", command->name);
    print_title(to, line, command->summary);
    for (const char *usage = command->usage; usage != NULL;) {
        usage = next_word(usage, '\n', line, sizeof line);
        (void)fprintf(to, ".B fathom %s\n", command->name);
        print_text(to, line, true);
        if (usage != NULL) (void)fputs(".br\n", to);
    }
    (void)fprintf(to, ".SH DESCRIPTION\n%s.\n", command->summary);
    print_text(to, command->about, true);
    (void)fputs(".SH OPTIONS\n", to);
    print_options(to, command, true);
    print_lines(to, "EXAMPLES", command->examples);
    print_lines(to, "EXIT STATUS", command->status);
    (void)fputs(".SH SEE ALSO\n.BR fathom (1)\n", to);
}

void man_print_tool(FILE *to, const command_t *const *commands, const help_topic_t *topics,
                    const char *examples)
{
    print_title(to, "", "read and set up the range sensors A16, A05 and HPS-167S");
    (void)fputs(".B fathom\nCOMMAND [ARGUMENTS]\n.br\n.B fathom help\n[COMMAND | TOPIC]\n.SH DESCRIPTION\n"
                "Finds, reads and sets up the range sensors A16, A05 and HPS\\-167S\non serial ports, Modbus "
                "gateways and GPIO lines.\n.SH COMMANDS\n",
                to);
    for (; *commands != NULL; commands++)
        (void)fprintf(to, ".TP\n.BR fathom\\-%s (1)\n%s.\n", (*commands)->name, (*commands)->summary);
    for (; topics->name != NULL; topics++) {
        (void)fprintf(to, ".SH \"%s (fathom help %s)\"\n.nf\n", topics->summary, topics->name);
        print_text(to, topics->text, true);
        (void)fputs(".fi\n", to);
    }
    print_lines(
        to, "EXIT STATUS",
        "0 success\n1 the line, the port or the output failed\n2 wrong usage\n3 an alarm is on (read)\n");
    (void)fputs(".SH FILES\n"
                ".TP\n.I /dev/ttyUSB0\nA serial port. On Debian it belongs to the group dialout.\n"
                ".TP\n.I /dev/serial/by\\-id/\n"
                "The same ports by the names of their adapters,\nwhich stay the same in another socket.\n"
                ".TP\n.I /dev/gpiochip0\nThe GPIO lines of a board.\n",
                to);
    print_lines(to, "EXAMPLES", examples);
    (void)fputs(".SH SEE ALSO\n.BR fathom\\-read (1),\n.BR fathom\\-scan (1)\n", to);
}

/* ---- completion ---- */

/* The word that is completed. What stands before it, such as "--format=", is printed too. */
typedef struct {
    FILE *to;
    const char *word;
    const char *before;
} offer_t;

/* Prints a candidate if it begins like the word. */
__attribute__((format(printf, 3, 4))) static void offer(const offer_t *it, const char *help,
                                                        const char *format, ...)
{
    char name[80];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(name, sizeof name, format, arguments);
    va_end(arguments);
    if (strncmp(name, it->word, strlen(it->word)) == 0)
        (void)fprintf(it->to, "%s%s%s%s\n", it->before, name, help != NULL ? "\t" : "",
                      help != NULL ? help : "");
}

static void offer_words(const offer_t *it, const char *words)
{
    const char *word = NULL;
    size_t length = 0;
    for (size_t n = 0; words != NULL && (length = word_at(words, n, &word)) != 0; n++)
        offer(it, NULL, "%.*s", (int)length, word);
}

const char *model_name(size_t n) { return n < model_count ? models[n].name : NULL; }

static bool takes_mode(operands_t operands, const model_mode_t *mode)
{
    if (operands == OPERANDS_SENSORS) return true;
    if (operands == OPERANDS_SIMULATED) return mode->simulated_as != 0;
    return operands != OPERANDS_RESETTABLE && mode_is_asked(mode);
}

static void offer_sensors(const offer_t *it, operands_t operands)
{
    for (const model_t *model = models; model != models + model_count; model++) {
        if (operands == OPERANDS_RESETTABLE && model->reset_interface == NULL) continue;
        offer(it, model->what, "%s", model->name);
        for (size_t m = 0; m != MODEL_MODES && model->modes[m].name != NULL; m++)
            if (takes_mode(operands, &model->modes[m]))
                offer(it, model->what, "%s:%s", model->name, model->modes[m].name);
    }
}

/* Names of relatives, of which there are many: those that begin like a word. */
static void offer_relatives(const offer_t *it, operands_t operands)
{
    const char *name = NULL;
    for (size_t n = 0; it->word[0] != '\0' && (name = model_relative(n)) != NULL; n++) {
        const model_t *const model =
            strncmp(name, it->word, strcspn(it->word, ":")) == 0 ? model_find(name) : NULL;
        bool is_offered = operands == OPERANDS_MODELS;
        for (size_t m = 0; model != NULL && m != MODEL_MODES && model->modes[m].name != NULL; m++) {
            if (!takes_mode(operands, &model->modes[m])) continue;
            is_offered = true;
            if (operands != OPERANDS_MODELS && model->modes[1].name != NULL)
                offer(it, model->what, "%s:%s", name, model->modes[m].name);
        }
        if (model != NULL && is_offered) offer(it, model->what, "%s", name);
    }
}

/* The settings of the sensor in words[0], or the values of the setting in words[1]. */
static void offer_settings(const offer_t *it, operands_t operands, char **words, int count)
{
    char name[40];
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(words[0], ":@"), words[0]);
    const model_t *const model = model_find(name);
    const setting_t *setting = model != NULL ? model->settings : NULL;
    for (; setting != NULL && setting->name != NULL; setting++) {
        const bool is_it = operands == OPERANDS_SETTING ? setting->read_at != 0 : setting->effect != NULL;
        if (count == 1 && is_it) offer(it, setting->what, "%s", setting->name);
        if (count != 2 || operands == OPERANDS_SETTING || strcmp(setting->name, words[1]) != 0) continue;
        for (const char *const *word = setting->words; word != NULL && *word != NULL; word++)
            offer(it, NULL, "%s", *word);
    }
}

static void offer_operands(const offer_t *it, operands_t operands, char **words, int count)
{
    if (operands == OPERANDS_FILE)
        (void)fputs(":files\n", it->to);
    else if (operands >= OPERANDS_SETTING && count != 0)
        offer_settings(it, operands, words, count);
    else if (operands != OPERANDS_NONE && (operands < OPERANDS_ONE || count == 0)) {
        if (operands != OPERANDS_MODELS) offer_sensors(it, operands);
        offer_relatives(it, operands);
    }
}

static void offer_value(const offer_t *it, const option_t *row)
{
    const char *name = NULL;
    offer_words(it, row->words);
    for (size_t n = 0; row->list != NULL && (name = row->list(n)) != NULL; n++) offer(it, NULL, "%s", name);
    for (const option_t *key = row->keys; key != NULL && key->name != NULL; key++)
        offer(it, key->help, "%s=", key->name);
    if (row->is_path) (void)fputs(":files\n", it->to);
}

/* Returns the row of the option whose value is the next word; NULL: the word is no such option. */
static const option_t *valued(const command_t *command, const char *word)
{
    option_walk_t walk;
    if (word[0] != '-' || !option_find_word(&walk, command->tables, word)) return NULL;
    if (word[1] != '-' && word[2] != '\0') return NULL;
    return walk.row->kind != KIND_FLAG && walk.row->otherwise == NULL ? walk.row : NULL;
}

/* Words behind a command; the last one is completed. */
static void complete_command(offer_t it, const command_t *command, char **words, int count)
{
    const option_t *row = NULL; /* of the option that has the last word as its value */
    char option[40];
    int operand_count = 0;
    for (int i = 0; i != count - 1; i++) {
        const bool is_value = row != NULL;
        row = is_value ? NULL : valued(command, words[i]);
        if (!is_value && words[i][0] != '-') words[operand_count++] = words[i];
    }
    const char *const equals = row == NULL && strncmp(it.word, "--", 2) == 0 ? strchr(it.word, '=') : NULL;
    if (equals != NULL) {
        const int length = (int)(equals - it.word);
        (void)snprintf(option, sizeof option, "%.*s", length, it.word);
        row = valued(command, option);
        (void)snprintf(option, sizeof option, "%.*s=", length, it.word);
        it.before = option;
        it.word = equals + 1;
    }
    if (row != NULL) {
        offer_value(&it, row);
    } else if (equals == NULL && it.word[0] == '-') {
        for (option_walk_t walk = {.table = command->tables}; option_next(&walk);)
            if (!walk.row->is_hidden) offer(&it, walk.row->help, "--%s", walk.row->name);
        offer(&it, "Print the help", "--help");
    } else if (equals == NULL) {
        offer_operands(&it, command->operands, words, operand_count);
    }
}

void complete(FILE *to, const command_t *const *commands, const help_topic_t *topics, char **words, int count)
{
    if (count == 0) return;
    const offer_t it = {.to = to, .word = words[count - 1], .before = ""};
    const bool is_help = count == 2 && strcmp(words[0], "help") == 0;
    for (const command_t *const *command = commands; *command != NULL; command++) {
        if (count == 1 || is_help) offer(&it, (*command)->summary, "%s", (*command)->name);
        if (count > 1 && strcmp(words[0], (*command)->name) == 0)
            complete_command(it, *command, words + 1, count - 1);
    }
    for (const help_topic_t *topic = topics; is_help && topic->name != NULL; topic++)
        offer(&it, topic->summary, "%s", topic->name);
    if (count == 1) offer_words(&it, it.word[0] == '-' ? "--help --version" : "help");
}
