/* SPDX-License-Identifier: MIT */
#ifndef COMMAND_H
#define COMMAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "output/words.h"
#include "ports/host.h"

/* ---- messages about wrong usage ---- */

/* Where a text stands that the user wrote: on the command line, or in a line of a file. */
typedef struct {
    const char *command; /* NULL: no command is known yet */
    const char *file;    /* NULL: the command line */
    unsigned line;       /* of the file, from 1 */
    const char *within;  /* the option, or the word, whose keys are read; NULL: none */
    bool is_option;      /* `within` is an option */
} origin_t;

/* Prints one message to standard error: where, what is wrong, what to try. Returns false. */
bool reject(const origin_t *origin, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* What stands before the name of a row in messages: "--" for an option, "" for a key. */
const char *origin_mark(const origin_t *origin);

/* The name that is nearest to a word that is none of them. Start with {.word = word}, and try every name. */
enum { NEAREST_KNOWN = 400 };
typedef struct {
    const char *word;
    const char *name; /* NULL: no name is near enough to be meant */
    size_t distance;
    char known[NEAREST_KNOWN]; /* all names: "a16, a05" */
} nearest_t;

void nearest_try(nearest_t *nearest, const char *name);

/* Rejects the word of `nearest`, which is no WHAT ("sensor", "key"): with the nearest name if there is one, else with
 * all names if has_list. `mark` stands before names ("--" or ""). False. */
bool reject_unknown(const origin_t *origin, const char *what, const char *mark, const nearest_t *nearest,
                    bool has_list);

/*
 * ---- rows ----
 *
 * The rows of options and keys. One row defines an option: the parser, the help, the man page, the
 * completion and the reader of configuration files work from it.
 */

/* How the value of an option is written, and what stores it. */
typedef enum {
    KIND_FLAG,   /* bool; the option has no value */
    KIND_NUMBER, /* from `min` to `max`, times `scale` */
    KIND_SIGNED, /* from -`max` to `max` */
    KIND_ONE_OF, /* one of the numbers in `words` */
    KIND_PAIR, /* "500/600" into two members; "500" is both. With the separator '-' a range; the second is not less */
    KIND_CHOICE, /* the place of the word in `words`, from `min` on, or the number at that place of `numbers` */
    KIND_SET,    /* "1,2,4": the bits n - 1 of a uint8_t */
    KIND_TEXT,   /* const char *: the text itself */
    KIND_STRING, /* a copy in an array of characters; `parse` may refuse the text */
    KIND_KEYS,   /* "key=value,key=value" of the rows `keys`, in a structure */
    KIND_CUSTOM, /* what `parse` stores */
    KIND_MAP,    /* of a file only: a map of the rows `keys`, in a structure */
    KIND_NODE    /* of a file only: const void *, the node; its reader is elsewhere */
} option_kind_t;

typedef enum {
    GROUP_COMMAND,
    GROUP_SENSOR,
    GROUP_LINE,
    GROUP_OUTPUT,
    GROUP_PROCESSING,
    GROUPS
} option_group_t;

typedef struct option_row option_t;
struct option_row {
    const char *name;
    const char *value; /* its name in the help, "MS"; "[S]" if it can be left out; NULL: a flag */
    const char *help;  /* an imperative sentence without a full stop; of a key, a noun phrase */
    option_kind_t kind;
    option_group_t group;
    size_t at;   /* the member: its offset in the structure, */
    size_t size; /* and its size; of a pair the first one's */
    size_t has;  /* 1 + the offset of a bool that becomes true when the option is given; 0: there is none */
    uint32_t min;
    uint32_t max;
    uint32_t scale; /* 0: 1 */
    uint16_t fits;  /* SUITS_... of a sensor's mode; 0: every mode */
    char separator;
    bool is_path;                  /* the value is a file: completion offers files */
    const char *words;             /* "text json csv"; of a text, what completion offers */
    const uint8_t *numbers;        /* of `words`; NULL: their places */
    const char *(*list)(size_t n); /* completion: name n; NULL: there are no more */
    const char *otherwise;         /* the value of an option whose value was left out */
    const char *takes; /* what values there are, as an object: "MIN-MAX in mm". NULL: follows from the kind */
    const option_t *keys;
    bool (*parse)(const char *text, void *member);
    /* Of KIND_KEYS and KIND_MAP: are the keys consistent? Rejects what is not. */
    bool (*check)(void *structure, const origin_t *origin);
    const char *needs;   /* another option without which this one has no effect */
    const char *instead; /* of a hidden row that has no effect: the option that the user looks for */
    bool is_required;    /* of a key */
    bool is_once;        /* a second one is an error, and does not replace the first */
    bool is_first;       /* of a key: "value" at the beginning of the list means "key=value" */
    bool is_hidden;      /* an old name that still works */
};

/* Members of a row. NOLINTBEGIN(bugprone-macro-parentheses) */
#define AT(type, member)  .at = offsetof(type, member), .size = sizeof(((type *)0)->member)
#define HAS(type, member) .has = 1 + offsetof(type, member)
/* NOLINTEND(bugprone-macro-parentheses) */

/* Some rows, whose structure is at this offset in the structure of all. A table without rows ends a list of them. */
typedef struct {
    const option_t *rows; /* a row without a name ends them */
    size_t at;
} option_table_t;

/* Walks through all rows of a list of tables. Start with {.table = tables}. */
typedef struct {
    const option_table_t *table;
    const option_t *row; /* the present one */
    size_t number;       /* its number, from 0 */
} option_walk_t;

bool option_next(option_walk_t *walk);
bool option_find(option_walk_t *walk, const option_table_t *tables, const char *name);

/* The letter of an option, such as 'p' of "port"; '\0': it has none. */
char option_letter(const char *name);

/* Finds the option of a word such as "--port" or "-p". */
bool option_find_word(option_walk_t *walk, const option_table_t *tables, const char *word);

/* Where each row was given. */
enum { MOST_OPTIONS = 64 };
typedef struct {
    unsigned line[MOST_OPTIONS]; /* of a file; 1 for the command line; 0: not given */
} option_given_t;

bool option_is_given(const option_given_t *given, const option_table_t *tables, const char *name);

/* Stores the value of a row in its structure. False after rejecting it. `text` may be cut, and what KIND_TEXT stores
 * points into it. */
bool option_set(const option_t *row, char *text, void *structure, const origin_t *origin);

/* Stores the values of "key=value,key=value". `origin` has the option or the word that they belong to. */
bool option_set_keys(const option_t *keys, char *text, void *structure, const origin_t *origin);

/* Was every option given that others need, and every required key? `origin` is that of all. False after rejecting. */
bool option_check_given(const option_table_t *tables, const option_given_t *given, const origin_t *origin);

/* Rejects a name that no row has. */
bool option_reject_unknown(const option_table_t *tables, const char *what, const char *name,
                           const origin_t *origin);

/* Returns what values a row takes, as an object: "a whole number from 1 to 254", "text, json or csv". The next call
 * replaces the text. */
const char *option_takes(const option_t *row);

/* ---- commands ---- */

/* The words between the options of a command, which completion offers. */
typedef enum {
    OPERANDS_NONE,
    OPERANDS_FILE,
    OPERANDS_MODELS,       /* the name of a relative */
    OPERANDS_SENSORS,      /* several sensors */
    OPERANDS_ASKED,        /* several, in modes that send requests */
    OPERANDS_SIMULATED,    /* several, in modes that can be simulated */
    OPERANDS_ONE,          /* one, in a mode that sends requests */
    OPERANDS_RESETTABLE,   /* one that has a reset */
    OPERANDS_SETTING,      /* one, and a setting to read */
    OPERANDS_SETTING_VALUE /* one, a setting to change, and its value */
} operands_t;

/* What a command was given. */
typedef struct command command_t;
typedef struct {
    const command_t *command;
    origin_t origin;      /* of the command line */
    option_given_t given; /* which options */
    void *settings;       /* their values */
    char **words;         /* the words between the options, */
    int count;            /* and how many there are */
    bool wants_help;
} arguments_t;

/* A command of the tool: a row in the table of commands.c. Lines of its texts may be longer than 80 columns. */
struct command {
    const char *name;
    const char *summary; /* a sentence without its full stop */
    const char *usage;   /* behind the name: "SENSOR... [OPTIONS]"; further lines behind line feeds */
    const option_table_t *tables; /* its options */
    const char *common;           /* the names of those that most people need, with blanks between them */
    const char *own_group;        /* the heading of its own options; NULL: "Options" */
    const char *about;            /* lines below the summary; NULL: none */
    const char *examples;         /* lines */
    const char *status;           /* the exit statuses, lines */
    operands_t operands;
    const char *topics;   /* topics to read on, "sensors, ports"; NULL: none */
    size_t settings_size; /* of the structure that the options fill; it is all zeros at first */
    int (*start)(const host_t *host, const arguments_t *arguments); /* returns the exit status */
};

/* A subject of several commands, or what is too long for the help of one. */
typedef struct {
    const char *name;
    const char *summary; /* a line of `fathom help` */
    const char *text;    /* lines, which may be longer than 80 columns */
} help_topic_t;

/* Reads the options of a command from argv, the command's name in argv[0], in any order and between the words. The
 * values are stored in `settings`, the words and what was given in *arguments. False after rejecting one of them. */
bool arguments_parse(arguments_t *arguments, const command_t *command, int argc, char **argv, void *settings);

/* Was --NAME given? */
bool arguments_have(const arguments_t *arguments, const char *name);

/* Hands over what was printed, so that the reader of a pipe sees each line at once. errno is to be 0 before the
 * printing. Returns 0, or errno of what has failed since then. */
int output_flush(void);

/* `fathom COMMAND --help` and `fathom help TOPIC`, in lines of at most 80 columns. */
void help_print(FILE *to, const command_t *command);
void help_print_topic(FILE *to, const help_topic_t *topic);

/* Prints the keys of an option, a line each. */
void help_print_keys(FILE *to, const option_t *keys);

/* The same as pages of man: of a command, and of the tool with all topics. Tables end with NULL and a row without a
 * name. */
void man_print(FILE *to, const command_t *command);
void man_print_tool(FILE *to, const command_t *const *commands, const help_topic_t *topics,
                    const char *examples);

/* `fathom complete WORD...`: prints what can stand in place of the last word, one candidate in a line, with its help
 * behind a tabulator. The line ":files" stands for files. The words are those behind "fathom" on the command line. */
void complete(FILE *to, const command_t *const *commands, const help_topic_t *topics, char **words,
              int count);

/* The names of the models, for option_t.list. */
const char *model_name(size_t n);

#endif
