/* SPDX-License-Identifier: MIT */
/* A line of the shell, run as a command line of grctl over the shell's connection. */
#include <string.h>

#include "tools/grctl/cli/run.h"
#include "tools/grctl/shell/shell.h"

void shell_inherit(shell *s)
{
    for (int i = 0; i < GLOBAL_COUNT; i++) {
        bool own = i == GLOBAL_ON_EXIT || i == GLOBAL_TRACE || i == GLOBAL_HELP ||
                   i == GLOBAL_VERSION || s->one.line.global[i].given;
        if (!own) {
            s->one.line.global[i] = s->a->line.global[i];
        }
    }
    s->one.robot = s->a->robot;
    s->one.def = s->a->def;
    s->one.def_name = s->a->def_name;
    s->one.driver = s->a->driver;
    s->one.nearest_device = s->a->nearest_device;
    s->one.moves = true;
    s->one.tty_in = s->a->tty_in && !s->file;
}

void shell_begin(shell *s)
{
    memset(&s->one, 0, sizeof s->one);
    s->one.link = &s->link;
    s->one.record = s->record;
    s->one.json = s->a->json;
    if (s->file) {
        snprintf(s->one.place, sizeof s->one.place, "%s:%d: ", s->file, s->line);
    }
}

static int prepare(void *ctx, app *a)
{
    static const int lines[] = {GLOBAL_DEVICE, GLOBAL_ROBOT, GLOBAL_BAUD, GLOBAL_WIRING, GLOBAL_ECHO};
    shell *s = ctx;
    bool touches = false;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        touches |= app_global(a, lines[i])->given > 0;
    }
    shell_inherit(s);
    app_settle(a);
    a->tty_in = a->tty_in && !s->file;
    if (touches) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "a shell has one line; 'connect DEV' takes another device");
    }
    if (a->line.command == s->a->line.command) {
        return app_fail(a, EXIT_USAGE, "ARG", "this is a shell already");
    }
    return 0;
}

int shell_run(shell *s, int n, char **words)
{
    char *argv[SHELL_WORDS_MAX + 1] = {"grctl"};
    shell_begin(s);
    for (int i = 0; i < n && i < SHELL_WORDS_MAX; i++) {
        argv[i + 1] = words[i];
    }
    return run_line(&s->one, n + 1, argv, prepare, s);
}
