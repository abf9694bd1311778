/* SPDX-License-Identifier: MIT */
/* What the original programs' letters and words mean, and the record that they fill. */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/shell/shell.h"

enum { CAPTURE_MS = 100, LONGEST_MS = 3600000, KNOWN_US = 2000000 };

static int usage(shell *s, const char *format, const char *what)
{
    return app_fail(&s->one, EXIT_USAGE, "ARG", format, what);
}

/* A time of 1 ms to an hour. */
static bool take_ms(const char *text, double *ms)
{
    double number;
    if (!cli_read_number(text, &number) || number < 1 || number > LONGEST_MS) {
        return false;
    }
    *ms = number;
    return true;
}

static int run_text(shell *s, int n, const char *const *words)
{
    char *list[SHELL_WORDS_MAX];
    for (int i = 0; i < n; i++) {
        list[i] = (char *)words[i];
    }
    return shell_run(s, n, list);
}

/* ---- the record ----------------------------------------------------------------------------- */

static int keep(shell *s, int error)
{
    return error < 0 ? app_fail_error(&s->one, EXIT_ROBOT, error, "record") : 0;
}

/* An empty record where there is none. */
static int need_record(shell *s)
{
    if (s->record) {
        return 0;
    }
    return keep(
        s, grobo_motion_new(GROBO_MOTION_POSTURES, app_model(&s->one)->n_joints, NULL, &s->record));
}

/* What was read is where joints are: no increment, and no frame at a rate, which has no time. */
static int may_push(shell *s)
{
    const grobo_motion *of = s->record;
    grobo_motion_kind kind = grobo_motion_get_kind(of);
    bool frames = kind == GROBO_MOTION_FRAMES && !grobo_motion_has_frame_times(of);
    if (grobo_motion_size(of) == 0 || (kind != GROBO_MOTION_STEPS && !frames)) {
        return 0;
    }
    return app_fail(&s->one, EXIT_USAGE, "TYPE",
                    frames ? _("record: it holds frames at a rate; 'Clear' it before, or convert "
                               "its file to .pseq")
                           : _("record: it holds increments, not where joints go; 'Clear' it "
                               "before"));
}

/* Those that a hand may move: in free mode the others hold, and are read each second anyway. */
static grobo_joint_mask joints_that_move(conn *c, const shell *s)
{
    grobo_posture known;
    int n = grobo_robot_posture(c->robot, KNOWN_US, &known);
    return s->link.free_joints && n == known.n_joints ? s->link.free_joints
                                                      : GROBO_JOINTS_ALL(known.n_joints);
}

/* Reads the posture and appends it. */
static int push(conn *c, shell *s, double ms)
{
    grobo_posture posture;
    int status = may_push(s);
    if (status) {
        return status;
    }
    int error = conn_sense(c, joints_that_move(c, s), GROBO_SENSE_FULL);
    status = error ? conn_fail(c, error, "record") : need_record(s);
    if (status) {
        return status;
    }
    grobo_robot_posture(c->robot, GROBO_NEVER_US, &posture);
    grobo_posture_set_time_ms(&posture, ms);
    return keep(s, grobo_motion_append(s->record, &posture));
}

static void tell_size(shell *s)
{
    size_t n = s->record ? grobo_motion_size(s->record) : 0;
    app_report(&s->one, json_pack("{s:I}", "postures", (json_int_t)n),
               "%zu posture%s in the record", n, n == 1 ? "" : "s");
}

static int do_push(shell *s, int n, char **words)
{
    conn c;
    double ms = s->time_ms;
    if (n > 1 && !take_ms(words[1], &ms)) {
        return usage(s, "'%s' is not a time of 1 to 3600000 ms", words[1]);
    }
    int status = conn_open(&c, &s->one);
    if (!status) {
        status = push(&c, s, ms);
    }
    if (!status) {
        tell_size(s);
    }
    return conn_close(&c, status);
}

static int do_clear(shell *s, int n, char **words)
{
    (void)n;
    (void)words;
    grobo_motion_free(s->record);
    s->record = NULL;
    tell_size(s);
    return EXIT_DONE;
}

/* Reads a motion by its file or its name, with the extensions that the library tries. */
static int read_motion(shell *s, const char *name, grobo_motion **motion)
{
    char path[GROBO_PATH_MAX_BYTES];
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(&s->one)};
    if (grobo_motion_find(grobo_files_os(), ".", name, path, sizeof path) == 0 ||
        grobo_motion_find(grobo_files_os(), "motions", name, path, sizeof path) == 0) {
        return file_load(&s->one, path, &read, motion);
    }
    return file_load(&s->one, name, &read, motion);
}

static int do_load(shell *s, int n, char **words)
{
    grobo_motion *motion = NULL;
    if (n != 2) {
        return usage(s, "%s needs NAME", words[0]);
    }
    int status = read_motion(s, words[1], &motion);
    if (status) {
        return status;
    }
    grobo_motion_free(s->record);
    s->record = motion;
    tell_size(s);
    return EXIT_DONE;
}

static int do_append(shell *s, int n, char **words)
{
    grobo_motion *motion = NULL;
    double ms;
    if (n < 2 || take_ms(words[1], &ms)) {
        return do_push(s, n, words);
    }
    if (!s->record) {
        return do_load(s, n, words);
    }
    int status = read_motion(s, words[1], &motion);
    if (!status) {
        status = keep(s, grobo_motion_append_motion(s->record, motion));
    }
    grobo_motion_free(motion);
    if (!status) {
        tell_size(s);
    }
    return status;
}

static int do_play(shell *s, int n, char **words)
{
    const char *line[SHELL_WORDS_MAX] = {"play", "@record"};
    int at = 2;
    if (s->reverse) {
        line[at++] = "--reverse";
    }
    for (int i = 1; i < n && at < SHELL_WORDS_MAX; i++) {
        line[at++] = words[i];
    }
    return run_text(s, at, line);
}

static int do_reverse(shell *s, int n, char **words)
{
    (void)n;
    (void)words;
    s->reverse = !s->reverse;
    app_report(&s->one, json_pack("{s:b}", "reverse", s->reverse), "the record plays %s",
               s->reverse ? _("backwards") : _("forwards"));
    return EXIT_DONE;
}

static int do_save(shell *s, int n, char **words)
{
    char path[GROBO_PATH_MAX_BYTES];
    grobo_write_options write = {GROBO_WRITE_OPTIONS_INIT, .model = app_model(&s->one)};
    const char *line[] = {"convert", "@record", n > 1 ? words[1] : ""};
    if (n > 1) {
        return run_text(s, 3, line);
    }
    if (!s->record) {
        return usage(s, "%s: the record is empty", words[0]);
    }
    int error = grobo_motion_save_next(s->record, grobo_files_os(), ".", &write, path, sizeof path);
    if (error < 0) {
        return app_fail_error(&s->one, EXIT_FILE, error, "%s", words[0]);
    }
    app_report(&s->one, json_pack("{s:o}", "output", app_json_text(path)), "saved as %s", path);
    return EXIT_DONE;
}

/* ---- free mode ------------------------------------------------------------------------------ */

static int do_free(shell *s, int n, char **words)
{
    conn c;
    grobo_joint_mask joints;
    int status = joints_parse_all(&s->one, n - 1, (const char *const *)words + 1, &joints);
    if (status) {
        return status;
    }
    status = conn_open_to_move(&c, &s->one);
    if (!status) {
        int error = grobo_robot_free(c.robot, joints, true);
        status = error < 0 ? conn_fail(&c, error, "free") : 0;
        s->link.free_joints |= status ? 0 : joints;
    }
    if (!status) {
        app_note(&s->one, "free: move the joints by hand; 'End' makes them hold");
    }
    return conn_close(&c, status);
}

static int do_end(shell *s, int n, char **words)
{
    const char *line[] = {"stop"};
    conn c;
    (void)n;
    (void)words;
    if (!s->link.free_joints) {
        return run_text(s, 1, line);
    }
    int status = conn_open(&c, &s->one);
    if (!status) {
        int error = conn_wait(&c, grobo_robot_free(c.robot, s->link.free_joints, false));
        status = error < 0 ? conn_fail(&c, error, "end") : 0;
        s->link.free_joints = 0;
    }
    return conn_close(&c, status);
}

/* Captures every so often, for a time or until Ctrl-C, which is no failure here. */
static int capture(conn *c, shell *s, double every_ms, double for_ms)
{
    int64_t begin_us = grobo_now_us(), next_us = begin_us;
    int status = 0;
    while (!status && !c->signal && (double)(next_us - begin_us) <= for_ms * 1000) {
        status = push(c, s, every_ms);
        next_us += (int64_t)(every_ms * 1000);
        if (!status && conn_sleep_until(c, next_us) != GROBO_OK && c->link_error) {
            status = conn_fail(c, c->link_error, "record");
        }
    }
    if (c->signal == os_endings[OS_INTERRUPT]) {
        c->signal = 0;
        status = EXIT_DONE;
    }
    tell_size(s);
    return status;
}

static int do_rec(shell *s, int n, char **words)
{
    conn c;
    double every_ms = CAPTURE_MS, for_ms = LONGEST_MS;
    if ((n > 1 && !take_ms(words[1], &for_ms)) || (n > 2 && !take_ms(words[2], &every_ms))) {
        return usage(s, "'%s' is not a time of 1 to 3600000 ms",
                     n > 2 && take_ms(words[1], &for_ms) ? words[2] : words[1]);
    }
    int status = conn_open(&c, &s->one);
    if (!status) {
        status = capture(&c, s, every_ms, for_ms);
    }
    return conn_close(&c, status);
}

/* ---- the rest ------------------------------------------------------------------------------- */

static int do_quit(shell *s, int n, char **words)
{
    (void)n;
    (void)words;
    s->over = true;
    return EXIT_DONE;
}

static int do_time(shell *s, int n, char **words)
{
    if (n > 1 && !take_ms(words[1], &s->time_ms)) {
        return usage(s, "'%s' is not a time of 1 to 3600000 ms", words[1]);
    }
    app_report(&s->one, json_pack("{s:f}", "time_ms", s->time_ms), "postures and moves take %g ms",
               s->time_ms);
    return EXIT_DONE;
}

static int do_move(shell *s, int n, char **words)
{
    char ms[32];
    const char *line[] = {"move", n > 1 ? words[1] : "", n > 2 ? words[2] : "", ms};
    if (n < 3 || n > 4) {
        return usage(s, "%s needs JOINT DEG [MS]", words[0]);
    }
    snprintf(ms, sizeof ms, "%g", s->time_ms);
    if (n == 4) {
        line[3] = words[3];
    }
    return run_text(s, 4, line);
}

static int do_wait(shell *s, int n, char **words)
{
    conn c;
    double ms;
    if (n != 2 || !take_ms(words[1], &ms)) {
        return usage(s, "%s needs a time of 1 to 3600000 ms", words[0]);
    }
    int status = conn_open(&c, &s->one);
    if (!status) {
        int error = conn_sleep_until(&c, grobo_now_us() + (int64_t)(ms * 1000));
        status = error ? conn_fail(&c, error, "wait") : EXIT_DONE;
    }
    return conn_close(&c, status);
}

static int do_close(shell *s, int n, char **words)
{
    (void)n;
    (void)words;
    s->link.free_joints = 0;
    return conn_link_close(&s->link, s->a, EXIT_DONE);
}

static int do_connect(shell *s, int n, char **words)
{
    conn c;
    int status = do_close(s, 1, words);
    if (status || n > 2) {
        return n > 2 ? usage(s, "'%s' is one argument too many", words[2]) : status;
    }
    if (n == 2 &&
        (size_t)snprintf(s->device, sizeof s->device, "%s", words[1]) >= sizeof s->device) {
        return usage(s, "%s: the name is too long", words[1]);
    }
    if (n == 2) {
        s->a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = s->device};
        s->a->robot = NULL;
        status = config_apply(s->a);
        status = status ? status : robot_choose(s->a);
    }
    if (status) {
        return status;
    }
    s->one.line.global[GLOBAL_DEVICE].given = 0;
    shell_inherit(s);
    status = conn_open(&c, &s->one);
    if (!status) {
        app_note(&s->one, "connected: %s", conn_device(&c));
    }
    return conn_close(&c, status);
}

/* letter, word, arguments, meaning, command or NULL, function or NULL */
static const shell_word table[] = {
    {"q", "quit", "", N_("end the shell; so does Ctrl-D"), NULL, do_quit},
    {"", "exit", "", N_("the same"), NULL, do_quit},
    {"i", "Init", "[--time MS]", N_("go to the initial posture"), "init", NULL},
    {"S", "On", "[JOINT|GROUP]...", N_("torque on"), "servo on", NULL},
    {"s", "Off", "[JOINT|GROUP]...", N_("torque off: hold the robot"), "servo off", NULL},
    {"b", "Break", "[JOINT|GROUP]...", N_("brake"), "servo brake", NULL},
    {"f", "Free", "[JOINT|GROUP]...", N_("free mode: joints follow the hand"), NULL, do_free},
    {"e", "End", "", N_("end free mode, or stop: joints hold"), NULL, do_end},
    {"m", "", "JOINT DEG [MS]", N_("move one joint"), NULL, do_move},
    {"t", "", "[MS]", N_("time of moves and recorded postures (1000)"), NULL, do_time},
    {"p", "", "[JOINT|GROUP]...", N_("print the present posture"), "status", NULL},
    {"C", "", "[JOINT|GROUP]...", N_("print currents and voltages"), "status", NULL},
    {"r", "Push", "[MS]", N_("append the present posture to the record"), NULL, do_push},
    {"", "Rec", "[MS [EVERY]]", N_("append one every 100 ms, for a time or until Ctrl-C"), NULL,
     do_rec},
    {"c", "Clear", "", N_("empty the record"), NULL, do_clear},
    {"R", "DoRecord", "[OPTIONS]", N_("play the record, with the options of play"), NULL, do_play},
    {"", "Start", "[OPTIONS]", N_("the same"), NULL, do_play},
    {"", "Reverse", "", N_("from now on play the record the other way round"), NULL, do_reverse},
    {"", "PrintRecord", "", N_("print the record"), "show @record", NULL},
    {"", "Save", "[FILE]", N_("save the record, without a name as MotionN.m"), NULL, do_save},
    {"l", "", "NAME", N_("load a motion into the record, by file or by name"), NULL, do_load},
    {"a", "", "[MS|NAME]", N_("append the present posture, or a motion, to the record"), NULL,
     do_append},
    {"", "connect", "[DEV]", N_("open the robot, or another one"), NULL, do_connect},
    {"", "close", "", N_("close it; the next command opens it again"), NULL, do_close},
    {"", "wait", "MS", N_("let time pass"), NULL, do_wait},
};

const char shell_details[] = N_(
    "Runs commands, one a line, over one connection that stays open between them: those of\n"
    "grctl without 'grctl', and the letters and words of the original programs below. Words\n"
    "are split at blanks, quotes and backslashes keep them together, # begins a comment.\n"
    "Commands are typed, with history and completion (TAB), or come from FILE or a pipe: then\n"
    "the first command that fails ends the shell with its exit status, and the message names\n"
    "the line. With --json each line of a script ends with {\"line\":N,\"status\":S}, so that a\n"
    "program can control a robot through a pipe (docs/guide/scripts.md). Ctrl-C stops the\n"
    "running command; at the prompt it clears the line. The action of --on-exit is carried\n"
    "out once, at the end.\n"
    "\n"
    "Between two commands an open robot is watched: a lost line, an alarm of a servo, and an\n"
    "emergency stop by another grctl are reported at once. They end a script as a command\n"
    "that fails does, even before its next line has come; a prompt stays.\n"
    "\n"
    "The record is a motion that is built by hand; every command takes it as the file\n"
    "@record.\n");

int shell_word_text(const shell_word *w, char *text, size_t capacity)
{
    return snprintf(text, capacity, "  %-2s %s%s%s\n      %s\n", w->letter, w->word,
                    *w->word && *w->arguments ? " " : "", w->arguments, _(w->help));
}

const char *shell_words(void)
{
    static char text[4096];
    size_t used = 0;
    for (size_t i = 0; i < sizeof table / sizeof table[0] && used < sizeof text; i++) {
        used += (size_t)shell_word_text(&table[i], text + used, sizeof text - used);
    }
    return text;
}

const shell_word *shell_word_row(size_t i)
{
    return i < sizeof table / sizeof table[0] ? &table[i] : NULL;
}

const char *shell_nearest(const char *name)
{
    cli_guess guess = {.name = name, .length = strlen(name)};
    for (size_t i = 0; i < cli_n_commands; i++) {
        cli_guess_try(&guess, cli_commands[i]->name);
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        cli_guess_try(&guess, table[i].word);
    }
    return guess.best;
}

const shell_word *shell_word_find(const char *name)
{
    for (size_t i = 0; *name && i < sizeof table / sizeof table[0]; i++) {
        if (strcmp(table[i].letter, name) == 0 || strcmp(table[i].word, name) == 0) {
            return &table[i];
        }
    }
    return NULL;
}
