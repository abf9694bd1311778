/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

static int ended_by;

int ask_signal(void)
{
    return ended_by;
}

static bool no_questions(const app *a)
{
    return app_global(a, GLOBAL_YES)->given;
}

bool ask_can(app *a, const char *instead, int *status)
{
    if (a->tty_in || no_questions(a)) {
        setvbuf(stdin, NULL, _IONBF, 0); /* what is buffered cannot be waited for */
        return true;
    }
    *status = app_fail(a, EXIT_USAGE, "ARG",
                       "%s asks a person at a terminal; without one: %s, or --yes with an answer a "
                       "line on standard input",
                       a->line.command->name, _(instead));
    return false;
}

/* A line of standard input, without its end. False: there is none. */
static bool read_line(char *answer)
{
    ended_by = os_wait_to_read();
    if (ended_by || !fgets(answer, ASK_BYTES, stdin)) {
        return false;
    }
    if (!strchr(answer, '\n')) { /* longer than any answer */
        for (int c = getchar(); c != '\n' && c != EOF;) {
            c = getchar();
        }
    }
    answer[strcspn(answer, "\r\n")] = '\0';
    return true;
}

bool ask_line(const app *a, const char *question, const char *usual, char *answer)
{
    bool person = a->tty_in && !no_questions(a), came = false;
    if (!ended_by) {
        output_flush();
        output_complain(*usual ? "%s [%s] " : "%s ", _(question), usual);
        came = (person || !a->tty_in) && read_line(answer);
    }
    if (!person || !came) {
        output_complain("%s\n", came ? answer : "");
    }
    if (!came || !*answer) {
        snprintf(answer, ASK_BYTES, "%s", usual);
    }
    return came || (!person && !ended_by);
}

bool ask_yes(const app *a, const char *question)
{
    char answer[ASK_BYTES];
    return ask_line(a, question, "n", answer) && (answer[0] == 'y' || answer[0] == 'Y');
}
