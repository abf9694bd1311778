/* SPDX-License-Identifier: MIT */
/*
 * What every command has at hand: the parsed command line and the one way to speak, as text or
 * as JSON. Results go to standard output, everything said to a person to standard error.
 */
#ifndef GRCTL_APP_H
#define GRCTL_APP_H

#include <jansson.h>

#include <grobo/core/driver.h>
#include <grobo/robot_event.h>

#include "tools/grctl/cli/cli.h"

enum { APP_LINE_BYTES = 1024 };

struct config_robot;
struct config_group;
struct grobo_robot_def;
struct conn_link;

typedef struct app {
    cli_line line;
    struct conn_link *link;   /* the shell's, NULL: every command opens and closes its own */
    struct conn_link *beside; /* the link whose loop this command uses too, or NULL */
    const struct grobo_motion *record; /* the shell's @record, or NULL */
    const struct config_robot *robot;  /* the configured one, or NULL */
    const struct config_group *group;  /* the robots that the line names, or NULL: one */
    const struct grobo_robot_def *def; /* see robot.h; NULL: not chosen yet, GR001 */
    const grobo_driver *driver;        /* its; NULL: GR001's */
    grobo_driver made;                 /* that of a robot that is not GR001 */
    const char *def_name;              /* what names it */
    const char *on_line;               /* the line of several that it has; NULL: the whole robot */
    bool unasked;                      /* and nobody has asked for its device */
    const char *portless;              /* line of --line whose port nobody names */
    const char *nearest_device;        /* to a name that no robot has: a robot or word, or NULL */
    char place[128];                   /* "FILE:LINE: " of a script, for messages */
    bool json;
    int verbosity; /* -1 quiet, 0, 1, 2 */
    bool color_out, color_err;
    bool tty_in, tty_out, tty_err;
    bool screen_out, screen_err; /* a terminal that takes escape sequences */
    bool moves;                  /* the command may move the robot: it gets a guard */
    bool stops;      /* the command stops the robot: no signal or trace keeps it from that */
    bool mistaken;   /* it does so though its line has a mistake, or nobody knows which robot is
                        meant; that is told later */
    bool reconnects; /* a lost line is opened again, and is no failure */
    bool traced;     /* --trace was begun, or could not be; else there was no line to trace */
    bool clamps;     /* targets outside limits go to the limit, and are no failure */
    char *hushed;    /* not NULL: app_fail() puts its line here, APP_LINE_BYTES, and says nothing */
    char failed[32]; /* the code of the last app_fail() */
} app;

/* Sets what follows from the parsed line: verbosity, colours, terminals. */
void app_settle(app *a);

/* The value of the command's own option number i; of a global option. */
const cli_value *app_option(const app *a, int i);
const cli_value *app_global(const app *a, int i);
/*
 * The robot of this command: what it talks to is this driver's, through the wiring of the options.
 * Not NULL; for the life of the process.
 */
const grobo_driver *app_driver(const app *a);
const grobo_model *app_model(const app *a);
/* Number of an option, or `otherwise` when it was not given. */
double app_number(const app *a, int i, double otherwise);

/*
 * Says one line of what went wrong ("grctl: ...") and returns the exit status it was given. With
 * --json the same goes to standard output as {"error": {"code": ..., "message": ...}}.
 * code: as grobo_error_name() gives it, and nothing else; JSON has it in small letters.
 */
int app_fail(app *a, int status, const char *code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* From now on nothing is said: what app_fail() says goes to `text`, of APP_LINE_BYTES. */
void app_hush(app *a, char *text);
/* The same for an error of the library; its text stands behind a colon. */
int app_fail_error(app *a, int status, int error, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* So where the robot stopped for safety: EXIT_SAFETY; JSON has the trip as a word too. */
int app_fail_trip(app *a, grobo_trip trip, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The exit status that fits a library error. */
int app_status_of(int error);

/* A result: with --json the object, else a line as app_note() says it. Takes the reference. */
void app_report(const app *a, json_t *object, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Says that a command which moves nothing more is done: {"done": true}, or the text. */
void app_done(const app *a, const char *text);

/* A line for a person on standard error, unless quiet; only from -v on. */
/* output_attach(), and says what was dropped. */
void app_attach(const app *a);

/*
 * The end of the program: `status`, or, when what was printed could not all be written,
 * EXIT_ROBOT with a line of complaint. A reader that left is not complained about: that is
 * EXIT_SIGNAL + OS_BROKEN_PIPE, as without a handler.
 */
int app_finish(app *a, int status);

/* What an error of the library, and what errno says of a file, for a person: in the language. */
const char *app_error_text(int error);
const char *app_cause_text(int number);
/* The same behind a colon, with that error's name. */
int app_fail_cause(app *a, int status, int number, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* A file name may hold anything; what is said of it stays one line without control characters. */
void app_make_one_line(char *text);
void app_note(const app *a, const char *format, ...) __attribute__((format(printf, 2, 3)));
void app_detail(const app *a, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints on standard output as printf() does, see output.h; a while later, or by output_flush(). */
void app_print(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* A screen is cleared for the next table; elsewhere tables follow each other. */
void app_print_home(const app *a);
/* As app_print() of a whole line with texts of others: app_make_one_line(). */
void app_print_line(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* One JSON object on a line of its own; takes the reference. */
void app_print_json(json_t *object);
/* Every object gets a key "line" from here on, until NULL; the name is borrowed. */
void app_json_line(const char *name);
/* A JSON string of bytes that may be no UTF-8. */
json_t *app_json_text(const char *text);
/* A stable word, as every code is spelled: in small letters, with _ between words. */
json_t *app_json_code(const char *name);
/* A JSON string of what a function prints. */
json_t *app_json_printed(void (*print)(FILE *to));
/* A JSON number rounded to so many decimals. */
json_t *app_json_number(double number, int decimals);

#endif
