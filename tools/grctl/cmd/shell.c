/* SPDX-License-Identifier: MIT */
/* shell: many commands over one connection. */
#include <errno.h>
#include <signal.h>
#include <string.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/guard.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/shell/shell.h"

enum { OPT_KEEP_GOING };

static const cli_option options[] = {
    [OPT_KEEP_GOING] = OPTION_FLAG("keep-going", 'k',
                                   "continue after a command that fails; its exit status stays"),
};

/* While no command has the robot, a signal is only noted: it ends the shell, or a script. */
static void on_signal(int number)
{
    shell_noted = number;
}

/* ---- one line ------------------------------------------------------------------------------- */

/* A letter or word of the original programs that is a command: its words, then the line's. */
static int run_command_of(shell *s, const shell_word *w, int n, char **words)
{
    char text[64];
    char *all[SHELL_WORDS_MAX];
    snprintf(text, sizeof text, "%s", w->command);
    int m = shell_split(text, all, 4);
    for (int i = 1; i < n && m < SHELL_WORDS_MAX; i++) {
        all[m++] = words[i];
    }
    return shell_run(s, m, all);
}

static int refuse(shell *s, const char *why)
{
    shell_begin(s);
    shell_inherit(s);
    app_settle(&s->one);
    return app_fail(&s->one, EXIT_USAGE, "ARG", "%s", lang_text(why));
}

static int run_words(shell *s, int n, char **words)
{
    const shell_word *w = shell_word_find(words[0]);
    const char *nearest = shell_nearest(words[0]);
    char why[128];
    if (!w && nearest && !cli_find_command(nearest)) {
        snprintf(why, sizeof why, _("no command '%.40s'; did you mean '%s'?"), words[0], nearest);
        return refuse(s, why);
    }
    if (!w) {
        return shell_run(s, n, words);
    }
    if (w->command) {
        return run_command_of(s, w, n, words);
    }
    shell_begin(s);
    shell_inherit(s);
    app_settle(&s->one);
    s->one.tty_in = s->one.tty_in && !s->file;
    return w->run(s, n, words);
}

static int run_text(shell *s, char *line)
{
    char *words[SHELL_WORDS_MAX];
    int n = shell_split(line, words, SHELL_WORDS_MAX - 4);
    if (n < 0) {
        return refuse(s, n == SHELL_TOO_MANY ? "too many words" : "a quote is not closed");
    }
    if (n == 0) {
        return EXIT_DONE;
    }
    int status = run_words(s, n, words);
    output_flush();
    return status;
}

/* ---- many lines ----------------------------------------------------------------------------- */

static bool ends(const shell *s, int status)
{
    bool ended = s->over;
    for (int i = 0; i < os_n_endings; i++) {
        ended |= i != OS_INTERRUPT && status == EXIT_SIGNAL + os_endings[i];
    }
    return ended;
}

/* A line of a script, or what happened while it was waited for. */
static int run_next(shell *s, shell_script *in, int next)
{
    if (next == LINE_NEWS) {
        return conn_link_news(&s->link, s->a);
    }
    s->line++;
    next = in->wrong ? refuse(s, in->wrong) : run_text(s, in->line);
    if (s->a->json) { /* the mark by which a program knows that the command has ended */
        app_print_json(json_pack("{s:i,s:i}", "line", s->line, "status", next));
    }
    return next;
}

static int run_script(shell *s, shell_script *in)
{
    bool go_on = app_option(s->a, OPT_KEEP_GOING)->given > 0;
    int first = EXIT_DONE, status = EXIT_DONE;
    while (!ends(s, status) && !shell_noted && (!status || go_on)) {
        int next = shell_script_next(s, in);
        if (next == LINE_END || next == LINE_INTERRUPTED) {
            break;
        }
        status = run_next(s, in, next);
        if (status && !first) {
            first = status;
        }
        if (status == EXIT_SIGNAL + os_endings[OS_INTERRUPT]) {
            break;
        }
    }
    if (in->file && ferror(in->file)) { /* where nothing ran, the reason is still known */
        first = s->line ? app_fail(s->a, EXIT_FILE, "IO", "%s: it could not be read to its end",
                                   s->file)
                        : app_fail_cause(s->a, EXIT_FILE, errno, "%s", s->file);
    }
    return shell_noted ? EXIT_SIGNAL + (int)shell_noted : first;
}

static void tell_news(void *ctx)
{
    shell *s = ctx;
    conn_link_news(&s->link, s->a);
}

static int run_prompt(shell *s)
{
    char line[SHELL_LINE_BYTES];
    line_owner owner = {s, s->link.base, shell_wait, tell_news, shell_complete};
    line_reader *reader = line_open(&owner);
    int status = EXIT_DONE;
    if (!reader) {
        return app_fail_error(s->a, EXIT_ROBOT, GROBO_ERR_NOMEM, "shell");
    }
    while (!ends(s, status)) {
        conn_link_idle(&s->link, s->a);
        output_flush(); /* what was printed stands before the prompt */
        int n = line_read(reader, "grctl> ", line, sizeof line);
        if (n == LINE_END) {
            break;
        }
        if (n == LINE_INTERRUPTED && s->link.signal == os_endings[OS_INTERRUPT]) {
            s->link.signal = 0;
            continue;
        }
        if (n == LINE_INTERRUPTED) {
            break;
        }
        shell_noted = 0;
        status = n == LINE_TOO_LONG ? refuse(s, "the line is too long") : run_text(s, line);
        if (status == EXIT_SIGNAL + os_endings[OS_INTERRUPT]) {
            output_complain("\n"); /* behind the terminal's ^C */
        }
        if (shell_noted && shell_noted != os_endings[OS_INTERRUPT]) {
            status = EXIT_SIGNAL + (int)shell_noted;
        }
    }
    line_close(reader);
    return ends(s, status) && !s->over ? status : EXIT_DONE;
}

static int run_shell(shell *s)
{
    static shell_script in;
    const char *path = s->a->line.n_arguments ? s->a->line.argument[0] : NULL;
    FILE *from = NULL;
    if (!path && s->a->tty_in) {
        return run_prompt(s);
    }
    memset(&in, 0, sizeof in);
    s->file = path ? path : "standard input";
    if (path && !(from = fopen(path, "r"))) {
        return app_fail_cause(s->a, EXIT_FILE, os_is_folder(path) ? EISDIR : errno, "%s", path);
    }
    in.file = from && !os_input_take(from) ? from : NULL;
    int status = run_script(s, &in);
    if (from) {
        fclose(from);
    }
    return status;
}

static int run(app *a)
{
    static shell s;
    int status;
    memset(&s, 0, sizeof s);
    s.a = a;
    s.time_ms = 1000;
    s.link.kept = true;
    s.link.owner = a;
    a->link = &s.link;
    os_catch_endings(on_signal);
    a->moves = true;
    guard_start(a, conn_requested(a), &s.link.guard);
    if (conn_link_init(&s.link) != GROBO_OK) {
        status = app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "shell");
    } else {
        status = run_shell(&s);
    }
    status = conn_link_close(&s.link, a, status);
    conn_link_deinit(&s.link);
    grobo_motion_free(s.record);
    return status;
}

const cli_command cmd_shell = {
    .name = "shell",
    COMMAND_ARGUMENTS("[FILE]", 0, 1, CLI_ARG_FILE),
    .summary = "run many commands over one connection, typed or from a script",
    .details = shell_details,
    .more = shell_words,
    .example = "  grctl shell\n  printf 'init\\nm R_ELBOW_P -45\\n' | grctl -d sim shell\n"
               "  grctl shell -k morning.txt\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
