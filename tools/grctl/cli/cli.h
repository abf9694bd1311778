/* SPDX-License-Identifier: MIT */
/*
 * The command line as data: one table of commands and one of options make the parser, the help
 * and whatever else must agree with them.
 */
#ifndef GRCTL_CLI_H
#define GRCTL_CLI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Exit statuses promised to users. */
enum {
    EXIT_DONE = 0,
    EXIT_ROBOT = 1,   /* the robot or the link failed */
    EXIT_USAGE = 2,   /* the command line is wrong */
    EXIT_FILE = 3,    /* a file is bad */
    EXIT_SAFETY = 4,  /* refused for safety */
    EXIT_SIGNAL = 128 /* plus the number of the signal */
};

enum { CLI_OPTIONS_MAX = 24, CLI_ARGUMENTS_MAX = 256 };

typedef enum cli_kind {
    CLI_FLAG,   /* no value; may be counted (-vv) */
    CLI_NUMBER, /* a number within min..max; whole numbers unless `real` */
    CLI_TEXT,   /* any text */
    CLI_CHOICE  /* one of the words of `value`, split by | */
} cli_kind;

typedef struct cli_option {
    const char *name; /* "time": --time */
    char letter;      /* 't': -t, 0 for none */
    cli_kind kind;
    const char *value; /* name of the value in help, or the words of a choice */
    const char *help;
    double min, max; /* of a number, both included */
    bool real;       /* a number may have a fraction */
    bool optional;   /* the word of a choice may be missing: taken if the next word is one */
    bool whole;      /* not known by its beginning alone, which is an option of other commands */
} cli_option;

/* Rows of a table of options; letter 0: none. */
#define OPTION_FLAG(name_, letter_, help_)                                                         \
    {                                                                                              \
        .name = (name_), .letter = (letter_), .kind = CLI_FLAG, .help = (help_)                    \
    }
#define OPTION_TEXT(name_, letter_, value_, help_)                                                 \
    {                                                                                              \
        .name = (name_), .letter = (letter_), .kind = CLI_TEXT, .value = (value_), .help = (help_) \
    }
#define OPTION_CHOICE(name_, letter_, words_, help_)                                               \
    {                                                                                              \
        .name = (name_), .letter = (letter_), .kind = CLI_CHOICE, .value = (words_),               \
        .help = (help_)                                                                            \
    }
#define OPTION_NUMBER(name_, letter_, value_, min_, max_, real_, help_)                            \
    {                                                                                              \
        .name = (name_), .letter = (letter_), .kind = CLI_NUMBER, .value = (value_),               \
        .help = (help_), .min = (min_), .max = (max_), .real = (real_)                             \
    }
#define OPTION_WHOLE(name, letter, value, min, max, help)                                          \
    OPTION_NUMBER(name, letter, value, min, max, false, help)
#define OPTION_REAL(name, letter, value, min, max, help)                                           \
    OPTION_NUMBER(name, letter, value, min, max, true, help)

typedef struct cli_value {
    int given;        /* how often */
    const char *text; /* as typed */
    double number;
    int choice; /* index of the word; 0 where an optional one is missing */
} cli_value;

/* What the arguments of a command are: for completion and manual. */
typedef enum cli_argument {
    CLI_ARG_NONE,
    CLI_ARG_COMMAND,
    CLI_ARG_JOINT,
    CLI_ARG_FILE,
    CLI_ARG_WORD,
    CLI_ARG_DEVICE,
    CLI_ARG_ROBOT
} cli_argument;

/* Its arguments: as help has them, how many (-1: any number), and what they are. */
#define COMMAND_ARGUMENTS(words, least, most, kind)                                                \
    .arguments = (words), .min_arguments = (least), .max_arguments = (most), .argument = (kind)
/* A command's table of options. */
#define COMMAND_OPTIONS(table) .options = (table), .n_options = sizeof(table) / sizeof(table)[0]

struct app;
/* What a command does where -d names a group of robots. */
typedef enum cli_group {
    CLI_GROUP_NEVER = 0, /* it has one robot */
    CLI_GROUP_FIRST,     /* with the first one, which leads the others */
    CLI_GROUP_EACH,      /* each robot has a grctl of its own, all at the same time */
    CLI_GROUP_TOGETHER   /* it looks at app.group itself */
} cli_group;

/* What a command does where the robot has several lines, and --line names none of them. */
typedef enum cli_lines {
    CLI_LINES_WHOLE = 0, /* it has the whole robot */
    CLI_LINES_EACH,      /* it runs for each line, one after the other */
    CLI_LINES_SERVO,     /* its first argument is a servo: for the line of that */
    CLI_LINES_ONE        /* it needs --line */
} cli_lines;

typedef struct cli_command {
    const char *name;
    const char *heading;       /* of the group that it begins in the overview, or NULL */
    const char *arguments;     /* "JOINT DEG [MS]" */
    const char *summary;       /* one line, no full stop */
    const char *details;       /* paragraphs for help and manual */
    const char *(*more)(void); /* an indented paragraph behind them, or NULL */
    const char *example;       /* one command line a line, or NULL */
    const cli_option *options;
    size_t n_options;
    int min_arguments, max_arguments;
    cli_argument argument;
    bool stops; /* it stops the robot: done first, and mistakes are reported after it */
    cli_group group;
    cli_lines lines;
    /* CLI_GROUP_EACH: does this line go on until it is ended? Then it looks at app.group itself. */
    bool (*goes_on)(const struct app *app);
    int (*run)(struct app *app);
} cli_command;

/* Global options, in the order of cli_global_options[]. */
enum {
    GLOBAL_DEVICE,
    GLOBAL_ROBOT,
    GLOBAL_LINE,
    GLOBAL_BAUD,
    GLOBAL_WIRING,
    GLOBAL_ECHO,
    GLOBAL_PHYSICS,
    GLOBAL_JSON,
    GLOBAL_QUIET,
    GLOBAL_VERBOSE,
    GLOBAL_TRACE,
    GLOBAL_TIMEOUT,
    GLOBAL_RETRIES,
    GLOBAL_ON_EXIT,
    GLOBAL_YES,
    GLOBAL_COLOR,
    GLOBAL_HELP,
    GLOBAL_VERSION,
    GLOBAL_COUNT
};
extern const cli_option cli_global_options[GLOBAL_COUNT];

/* Every command, set by main() before anything else runs. */
extern const cli_command *const *cli_commands;
extern size_t cli_n_commands;

typedef struct cli_line {
    const cli_command *command; /* NULL: none was given */
    cli_value global[GLOBAL_COUNT];
    cli_value option[CLI_OPTIONS_MAX]; /* in the order of the command's own table */
    const char *argument[CLI_ARGUMENTS_MAX];
    int n_arguments;
} cli_line;

/*
 * Parses a command line. Strings of argv are borrowed.
 * Returns true, or false with one line of complaint (no newline) in `complaint`: on the first
 * mistake. The line has the command and all that is right, behind a mistake too.
 */
bool cli_parse(cli_line *line, int argc, char *const *argv, char *complaint, size_t capacity);

/* The command of that name, or NULL. */
const cli_command *cli_find_command(const char *name);

/* A mistyped name, and the known one that is nearest to it: NULL while none is near. */
typedef struct cli_guess {
    const char *name;
    size_t length;
    const char *best;
    int edits;
} cli_guess;

void cli_guess_try(cli_guess *guess, const char *candidate);

/* The command that is nearest to a mistyped name, or NULL if none is near. */
const char *cli_nearest_command(const char *name);

/* Takes the value of an option as the parser does. False with a line of complaint. */
bool cli_take_value(const cli_option *option, cli_value *value, const char *text, char *complaint,
                    size_t capacity);

/* Reads a whole text as a finite number; false if it is none. Knows no locale. */
bool cli_read_number(const char *text, double *number);

/* ---- completion ----------------------------------------------------------------------------- */

/* Takes what may stand in the place of a word that begins with `prefix`; help may be "". */
typedef struct cli_offer {
    const char *prefix;
    const struct grobo_model *model; /* whose joints and groups */
    void (*found)(void *ctx, const char *word, const char *help);
    void *ctx;
} cli_offer;

void cli_offer_word(const cli_offer *to, const char *word, const char *help);
/* Words of that kind; files are the caller's. */
void cli_offer_kind(const cli_offer *to, cli_argument kind);

/* What is known at the end of a command line that is not complete. */
typedef struct cli_place {
    const cli_command *command; /* NULL: none yet */
    const cli_option *option;   /* that waits for its value, or NULL */
    int n_arguments;
    bool unknown; /* the command does not exist */
} cli_place;

/* Behind these words; where `command` is NULL, the first that is no option names it. */
cli_place cli_find_place(const cli_command *command, int n, char *const *words);

/* Offers what may stand there. CLI_ARG_FILE and CLI_ARG_DEVICE: a name of a file may, too. */
cli_argument cli_offer_at(const cli_offer *to, const cli_place *place);

/*
 * For a shell of the system: what may stand in the place of the last of the words behind "grctl",
 * one a line, with a tab and its help; ":files" where it may be the name of a file.
 */
void cli_print_completions(FILE *to, const struct grobo_model *model, int n, char *const *words);

/* ---- texts made from the tables ------------------------------------------------------------- */

void cli_print_overview(FILE *to);
void cli_print_command(FILE *to, const cli_command *command);
/* The man page grctl(1), in mdoc. */
void cli_print_manual(FILE *to);

#endif
