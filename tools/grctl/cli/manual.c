/* SPDX-License-Identifier: MIT */
/* The man page grctl(1), made from the tables: one section a command. */
#include <ctype.h>
#include <string.h>

#include "tools/grctl/cli/cli.h"
#include "tools/grctl/lang/lang.h"

/* A blank behind the end of a sentence: roff wants the next one on a line of its own. */
static bool ends_sentence(const char *text, size_t at)
{
    return at > 1 && text[at] == ' ' && strchr(".?!", text[at - 1]) && text[at - 2] != '.';
}

/* Text that roff takes for text: no escapes, no requests, hyphens that can be copied. */
static void put(FILE *to, const char *text, size_t length, bool literal)
{
    bool begins = true;
    for (size_t i = 0; i < length; i++) {
        char c = !literal && ends_sentence(text, i) ? '\n' : text[i];
        if (begins && (c == '.' || c == '\'')) {
            fputs("\\&", to);
        }
        if (c == '\\') {
            fputs("\\e", to);
        } else if (c == '-') {
            fputs("\\-", to);
        } else if (c == '"') {
            fputs("\\(dq", to);
        } else {
            putc(c, to);
        }
        begins = c == '\n';
    }
}

/* A quoted argument of a macro. */
static void put_argument(FILE *to, const char *text)
{
    putc('"', to);
    put(to, text, strlen(text), true);
    putc('"', to);
}

static void put_literal(FILE *to, const char *text, size_t length)
{
    fputs(".Bd -literal -offset indent\n", to);
    put(to, text, length, true);
    fputs(".Ed\n", to);
}

/* The lines of `text` that are, or are not, indented: a table or a sample stays as it is. */
static size_t run_of_lines(const char *text, bool indented)
{
    size_t n = 0;
    while (text[n] && text[n] != '\n' && (text[n] == ' ') == indented) {
        n += strcspn(text + n, "\n");
        n += text[n] == '\n';
    }
    return n;
}

/* Paragraphs, split by empty lines. */
static void put_paragraphs(FILE *to, const char *text)
{
    while (*text) {
        size_t n = run_of_lines(text, *text == ' ');
        if (*text == '\n') {
            text += strspn(text, "\n");
            if (*text && *text != ' ') {
                fputs(".Pp\n", to);
            }
        } else if (*text == ' ') {
            put_literal(to, text, n);
            text += n;
        } else {
            put(to, text, n, false);
            text += n;
        }
    }
}

static void put_options(FILE *to, const cli_option *options, size_t n)
{
    fputs(".Bl -tag -width Ds\n", to);
    for (size_t i = 0; i < n; i++) {
        const cli_option *o = &options[i];
        fputs(".It ", to);
        if (o->letter) {
            fprintf(to, "Fl %c , ", o->letter);
        }
        fputs("Fl \\-", to);
        put(to, o->name, strlen(o->name), true);
        if (o->kind != CLI_FLAG) {
            fputs(o->optional ? " Op Ar " : " Ar ", to);
            put_argument(to, o->value);
        }
        putc('\n', to);
        put(to, _(o->help), strlen(_(o->help)), false);
        putc('\n', to);
    }
    fputs(".El\n", to);
}

static void put_command(FILE *to, const cli_command *command)
{
    fprintf(to, ".Ss %s\n", command->name);
    fprintf(to, ".Nm grctl Cm %s", command->name);
    if (command->n_options) {
        fputs(" Oo Ar OPTIONS Oc", to);
    }
    if (*command->arguments) {
        fputs(" Ar ", to);
        put_argument(to, command->arguments);
    }
    fputs("\n.Pp\n", to);
    const char *summary = _(command->summary);
    putc(toupper((unsigned char)*summary), to);
    put(to, summary + 1, strlen(summary + 1), false);
    fputs(_(".\n.Pp\n"), to);
    put_paragraphs(to, _(command->details));
    if (command->more) {
        put_paragraphs(to, command->more());
    }
    if (command->n_options) {
        put_options(to, command->options, command->n_options);
    }
    if (command->example) {
        fputs(_(".Pp\nExamples:\n"), to);
        put_literal(to, command->example, strlen(command->example));
    }
}

static const char head[] =
    N_(".Dd November 21, 2026\n"
       ".Dt GRCTL 1\n"
       ".Os\n"
       ".Sh NAME\n"
       ".Nm grctl\n"
       ".Nd drive serial command\\-servo robots\n"
       ".Sh SYNOPSIS\n"
       ".Nm grctl\n"
       ".Op Ar GLOBAL OPTIONS\n"
       ".Ar COMMAND\n"
       ".Op Ar OPTIONS\n"
       ".Op Ar ARGUMENTS\n"
       ".Sh DESCRIPTION\n"
       ".Nm grctl\n"
       "drives robots of serial command servos, such as a GR001 humanoid or an SO-101 arm,\n"
       "for people at a terminal and for scripts.\n"
       "Results go to standard output, messages to standard error.\n"
       "Without a terminal, no command asks.\n"
       ".Pp\n"
       "A joint is named by name (R_KNEE_P), by motor (m12) or by joint id (j3);\n"
       "a group by name\n"
       "(all body right_arm left_arm arms right_leg left_leg legs)\n"
       "or by its number 0 to 7.\n"
       "Angles are degrees, times milliseconds.\n"
       ".Pp\n"
       "A long option may be cut short to a beginning that no other has.\n"
       "These options are taken before and after the command:\n");

static const char tail[] = N_(
    ".Sh ENVIRONMENT\n"
    ".Bl -tag -width GRCTL_DEVICE\n"
    ".It Ev GRCTL_DEVICE\n"
    "the device, or the name of a configured robot, where\n"
    ".Fl d\n"
    "does not name one\n"
    ".It Ev GRCTL_GUARD\n"
    "the program that a command which moves the robot starts as\n"
    ".Ql PROGRAM guard\n"
    "to stop the robot when the command is killed (grctl itself); empty: none\n"
    ".It Ev GRCTL_PHYSICS\n"
    "what\n"
    ".Fl -physics\n"
    "is where it is not given: off, on or auto\n"
    ".It Ev GRCTL_ROBOT\n"
    "the robot, by its name or file, where neither\n"
    ".Fl -robot\n"
    "nor the configuration names one\n"
    ".It Ev LC_ALL , LC_MESSAGES , LANG\n"
    "help and messages are in Japanese where the first of these that is set is ja with UTF\\-8;\n"
    "results, files and JSON are the same in every language\n"
    ".It Ev NO_COLOR\n"
    "where it is set and not empty, there are no colours\n"
    ".El\n"
    ".Sh EXIT STATUS\n"
    ".Bl -tag -width Ds\n"
    ".It 0\n"
    "done\n"
    ".It 1\n"
    "the robot or the link failed\n"
    ".It 2\n"
    "the command line is wrong\n"
    ".It 3\n"
    "a file is bad\n"
    ".It 4\n"
    "refused for safety\n"
    ".It 128 + N\n"
    "ended by signal N (SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGALRM, SIGUSR1, SIGUSR2, SIGVTALRM,\n"
    "SIGPROF, SIGXCPU), after the exit policy was carried out; by SIGTSTP (Ctrl-Z), where that\n"
    "stopped a motion\n"
    ".El\n"
    ".Sh SEE ALSO\n"
    ".Xr grctl\\-json 5\n");

void cli_print_manual(FILE *to)
{
    fputs(_(head), to);
    put_options(to, cli_global_options, GLOBAL_COUNT);
    fputs(_(".Sh COMMANDS\n"), to);
    for (size_t i = 0; i < cli_n_commands; i++) {
        put_command(to, cli_commands[i]);
    }
    fputs(_(tail), to);
}
