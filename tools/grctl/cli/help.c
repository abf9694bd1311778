/* SPDX-License-Identifier: MIT */
/* Help texts, made from the tables. */
#include <stdbool.h>
#include <string.h>

#include "tools/grctl/cli/cli.h"
#include "tools/grctl/lang/lang.h"

enum { COLUMN = 26, WIDTH = 80 };

/*
 * Words of a text up to an empty line, an indented one or its end, in lines of at most WIDTH; the
 * first begins at a column, the others at the indent. Returns what is left of the text.
 */
static const char *print_words(FILE *to, const char *text, int column, int indent)
{
    bool first = true;
    int blank = 0;
    while (*text && *text != '\n' && *text != ' ') {
        size_t n = lang_unit(text);
        int columns = lang_columns(text, n);
        if (!first && column + blank + columns > WIDTH) {
            fprintf(to, "\n%*s", indent, "");
            column = indent;
            blank = 0;
        }
        fprintf(to, "%*s%.*s", blank, "", (int)n, text);
        column += blank + columns;
        first = false;
        text += n;
        blank = *text == ' ' || (*text == '\n' && text[1] != '\0');
        text += blank;
    }
    putc('\n', to);
    return text;
}

/* Paragraphs anew; what is indented stays as it is. */
static void print_details(FILE *to, const char *text)
{
    while (*text) {
        size_t n = strcspn(text, "\n");
        if (*text == ' ' || *text == '\n') {
            fprintf(to, "%.*s\n", (int)n, text);
            text += n + (text[n] == '\n');
        } else {
            text = print_words(to, text, 0, 0);
            text += *text == '\n' && text[1] == '\0';
        }
    }
}

static void print_option(FILE *to, const cli_option *o)
{
    char left[64];
    int n;
    if (o->letter) {
        n = snprintf(left, sizeof left, "-%c, --%s", o->letter, o->name);
    } else {
        n = snprintf(left, sizeof left, "    --%s", o->name);
    }
    if (o->kind != CLI_FLAG && n > 0 && (size_t)n < sizeof left) {
        snprintf(left + n, sizeof left - (size_t)n, o->optional ? " [%s]" : " %s", o->value);
    }
    if (strlen(left) < COLUMN) {
        fprintf(to, "  %-*s  ", COLUMN, left);
    } else {
        fprintf(to, "  %s\n  %-*s  ", left, COLUMN, "");
    }
    print_words(to, _(o->help), COLUMN + 4, COLUMN + 4);
}

static void print_global_options(FILE *to)
{
    fputs(_("\nGlobal options, before or after the command:\n"), to);
    for (size_t i = 0; i < GLOBAL_COUNT; i++) {
        print_option(to, &cli_global_options[i]);
    }
}

/* Their names alone: the overview has the rest. */
static void print_global_names(FILE *to)
{
    char names[512];
    size_t n = 0;
    for (size_t i = 0; i < GLOBAL_COUNT && n < sizeof names; i++) {
        const cli_option *o = &cli_global_options[i];
        int added = o->letter ? snprintf(names + n, sizeof names - n, " -%c", o->letter)
                              : snprintf(names + n, sizeof names - n, " --%s", o->name);
        n += added > 0 ? (size_t)added : 0;
    }
    putc('\n', to);
    print_words(to, _("Global options ('grctl help' explains them):"), 0, 0);
    fputs("  ", to);
    print_words(to, names + 1, 2, 2);
}

void cli_print_overview(FILE *to)
{
    fputs(_("grctl drives robots of serial command servos, such as GR001 or an SO-101 arm.\n\n"
            "usage: grctl [GLOBAL OPTIONS] COMMAND [OPTIONS] [ARGUMENTS]\n"),
          to);
    for (size_t i = 0; i < cli_n_commands; i++) {
        if (cli_commands[i]->heading) {
            fprintf(to, "\n%s:\n", _(cli_commands[i]->heading));
        }
        fprintf(to, "  %-15s%s\n", cli_commands[i]->name, _(cli_commands[i]->summary));
    }
    print_global_options(to);
    putc('\n', to);
    print_details(
        to, _("A joint is named by name (R_KNEE_P), motor (m12) or joint id (j3); a group by name "
              "(all body right_arm left_arm arms right_leg left_leg legs) or by its number 0..7. "
              "Angles are degrees, times milliseconds. See 'grctl help COMMAND' for details.\n"));
}

void cli_print_command(FILE *to, const cli_command *command)
{
    fprintf(to, _("grctl %s - %s\n\nusage: grctl %s%s%s%s\n\n"), command->name, _(command->summary),
            command->name, command->n_options ? " [OPTIONS]" : "", *command->arguments ? " " : "",
            command->arguments);
    print_details(to, _(command->details));
    if (command->more) {
        putc('\n', to);
        print_details(to, command->more());
    }
    if (command->n_options) {
        fputs(_("\nOptions:\n"), to);
        for (size_t i = 0; i < command->n_options; i++) {
            print_option(to, &command->options[i]);
        }
    }
    print_global_names(to);
    if (command->example) {
        fprintf(to, _("\nExamples:\n%s"), command->example);
    }
}
