/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/setup/ask.h"

static int ended_by;

int ask_signal(void)
{
    return ended_by;
}

bool ask_can(app *a, const char *instead, int *status)
{
    if (a->tty_in || app_global(a, GLOBAL_YES)->given) {
        setvbuf(stdin, NULL, _IONBF, 0); /* what is buffered cannot be waited for */
        return true;
    }
    *status = app_fail(a, EXIT_USAGE, "ARG",
                       "%s asks a person at a terminal; without one: %s, or --yes with an answer a "
                       "line on standard input",
                       a->line.command->name, _(instead));
    return false;
}

bool ask_line(const app *a, const char *question, const char *usual, char *answer)
{
    bool came = false;
    if (!ended_by) {
        output_flush();
        output_complain("%s [%s] ", _(question), usual);
        ended_by = os_wait_to_read();
        came = !ended_by && fgets(answer, ASK_BYTES, stdin) != NULL;
    }
    if (came && !strchr(answer, '\n')) { /* longer than any answer */
        for (int c = getchar(); c != '\n' && c != EOF;) {
            c = getchar();
        }
    }
    if (came) {
        answer[strcspn(answer, "\r\n")] = '\0';
    }
    if (!a->tty_in || !came) {
        output_complain("%s\n", came ? answer : "");
    }
    if (!came || !*answer) {
        snprintf(answer, ASK_BYTES, "%s", usual);
    }
    return came || (!a->tty_in && !ended_by);
}

bool ask_yes(const app *a, const char *question)
{
    char answer[ASK_BYTES];
    return ask_line(a, question, "n", answer) && (answer[0] == 'y' || answer[0] == 'Y');
}
