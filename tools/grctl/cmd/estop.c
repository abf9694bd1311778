/* SPDX-License-Identifier: MIT */
/*
 * estop: the emergency stop, which believes nobody.
 *
 * The device is marked first. Then either the port can be had, and the joints are stopped and read
 * back from here; or another program has it, which is asked until it has confirmed the stop. Who
 * exits while it is asked releases the port: then the first way is taken. From a program that does
 * not obey its guard takes the port; where it has none, it is ended. What was done and what was not
 * is said in one line; only a verified stop under a mark that was written is a success.
 */
#include <stdarg.h>
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/estop.h>
#include <grobo/guard.h>

#include "tools/grctl/cli/config.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_RESET };
/*
 * How often the port is tried and its holder asked, and how long: until it answers (a program that
 * is just starting or leaving is not registered), until it has verified (the engine's bound is
 * 10 s).
 */
enum { AGAIN_US = 20000, SILENT_US = 3000000, HEARD_US = 12000000 };
/* When the guard of a program is turned to that has the port and does not obey, and how long that
 * takes at most; the same of the program itself, where no session of this library has the port. */
enum { GUARD_AFTER_US = 1000000, GUARD_US = GROBO_GUARD_BOUND_US + 500000 };
enum { END_AFTER_US = 1000000, END_US = 3000000 };
enum { ROBOTS = 8 };

static const cli_option estop_options[] = {
    [OPT_RESET] = OPTION_FLAG("reset", 0, "clear the emergency stop; nothing moves"),
};

/* A device that is to be stopped. */
typedef struct target {
    app *a;
    char device[GROBO_DEVICE_MAX_BYTES];
    grobo_estop stop;
    int marked; /* GROBO_OK, or why the mark could not be written */
    grobo_os_cause cause;
    grobo_estop_holder holder; /* who has the port, and what it says */
    bool spared;               /* nobody named it: what has its port may be no robot's program */
    int forced;                /* the means that come next, see force() */
    bool guarded, ended;       /* its guard was asked last; it got SIGTERM */
    int64_t waited_us;         /* since it was asked */
    int64_t forced_until_us;   /* so long what was done last may take */
    bool is_line;              /* of several: the device is as it was asked for */
    char said[APP_LINE_BYTES]; /* why the port cannot be had */
} target;

static void mark(target *t, app *a, const char *device)
{
    memset(t, 0, sizeof *t);
    t->a = a;
    snprintf(t->device, sizeof t->device, "%s", device);
    t->marked = grobo_estop_set(t->device, &t->stop, &t->cause);
}

/* ---- what is said ---------------------------------------------------------------------------- */

/* What was not done is followed by what became of the mark. */
static int fail(const target *t, int error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int fail(const target *t, int error, const char *format, ...)
{
    char text[APP_LINE_BYTES];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, lang_text(format), list);
    va_end(list);
    if (t->marked < 0) {
        return app_fail(t->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s; the mark could not be written (%s): other programs may move the robot",
                        text, t->cause.text);
    }
    return app_fail(t->a, EXIT_ROBOT, grobo_error_name(error),
                    "%s; programs refuse to move it until 'grctl estop --reset'", text);
}

/* The joints are stopped. */
static int succeed(const target *t, const char *by)
{
    char text[APP_LINE_BYTES];
    if (t->marked < 0) {
        return fail(t, t->marked, "%s: stopped%s and verified, but not kept so", t->device, by);
    }
    snprintf(text, sizeof text, _("stopped%s and verified; 'grctl estop --reset' releases it"), by);
    app_done(t->a, text);
    return EXIT_DONE;
}

/* Sent, and not seen to be stopped. */
static int fail_verify(const target *t, const char *by, int error)
{
    return fail(t, error,
                "%s: the stop was sent%s, but not every joint is seen to be stopped: %s; switch "
                "the robot off",
                t->device, by, app_error_text(error));
}

static int fail_silent(const target *t)
{
    const grobo_estop_holder *h = &t->holder;
    if (h->stopped && !h->resumed) {
        return fail(t, GROBO_ERR_BUSY,
                    "%s: NOT stopped: process %d has the port, is stopped itself, and was not "
                    "resumed, because it would continue to move the robot; switch the robot off",
                    t->device, h->pid);
    }
    return fail(t, GROBO_ERR_BUSY,
                "%s: NOT stopped: process %d has the port%s and has not answered in %d s; end it "
                "('kill -9 %d') and repeat, or switch the robot off",
                t->device, h->pid, h->resumed ? _(", was resumed") : "",
                (int)(t->waited_us / 1000000), h->pid);
}

/* The port cannot be had: what its holder says. */
static int report_holder(const target *t, int error)
{
    const grobo_estop_holder *h = &t->holder;
    char by[96];
    snprintf(by, sizeof by, _(" by process %d, which has the port,"), h->pid);
    switch (h->answer) {
    case GROBO_ESTOP_DONE:
        return succeed(t, by);
    case GROBO_ESTOP_FAILED:
        return fail_verify(t, by, h->result);
    case GROBO_ESTOP_HEARD:
        return fail(t, GROBO_ERR_TIMEOUT,
                    "%s: NOT verified: process %d has the port, sends nothing else, and stops the "
                    "joints as soon as its line allows; switch the robot off",
                    t->device, h->pid);
    case GROBO_ESTOP_SILENT:
        return fail_silent(t);
    case GROBO_ESTOP_NOBODY:
        break;
    }
    if (error == GROBO_ERR_BUSY && t->ended) {
        return fail(t, error,
                    "%s; NOT stopped, nothing was sent: that program has not ended on SIGTERM; "
                    "switch the robot off",
                    t->said);
    }
    if (error == GROBO_ERR_BUSY) {
        return fail(t, error,
                    "%s; NOT stopped, nothing was sent: no program of this user that obeys has the "
                    "port; end that program and repeat, or switch the robot off",
                    t->said);
    }
    if (error == GROBO_ERR_UNPLUGGED) { /* the stop may have been on its way */
        return fail(t, error, "%s; NOT verified; switch the robot off", t->said);
    }
    return fail(t, error ? error : GROBO_ERR_IO, "%s; NOT stopped, nothing was sent", t->said);
}

/* ---- stopping -------------------------------------------------------------------------------- */

static bool is_over(grobo_estop_answer answer)
{
    return answer == GROBO_ESTOP_DONE || answer == GROBO_ESTOP_FAILED;
}

/* How long to wait, for what is known of the holder. */
static int64_t patience_us(const target *t, const conn *c)
{
    if (t->holder.answer == GROBO_ESTOP_HEARD) {
        return HEARD_US;
    }
    return t->holder.answer == GROBO_ESTOP_SILENT || c->open_error == GROBO_ERR_BUSY ? SILENT_US
                                                                                     : 0;
}

/* How long a program may be silent before a means is due. */
static int64_t due_us(const target *t, grobo_estop_means means)
{
    if (t->marked < 0) {
        return 0; /* it cannot know */
    }
    return means == GROBO_ESTOP_BY_GUARD            ? GUARD_AFTER_US
           : t->holder.answer == GROBO_ESTOP_SILENT ? SILENT_US
                                                    : END_AFTER_US;
}

/* Turns to a program that has the port and does not obey: one means after the other. */
static void force(target *t, const conn *c)
{
    grobo_estop_means means = (grobo_estop_means)t->forced;
    if (c->open_error != GROBO_ERR_BUSY || t->holder.answer == GROBO_ESTOP_HEARD ||
        means > GROBO_ESTOP_BY_SIGTERM || t->waited_us < due_us(t, means) ||
        grobo_now_us() < t->forced_until_us || (means == GROBO_ESTOP_BY_SIGTERM && t->spared)) {
        return;
    }
    t->forced++;
    if (grobo_estop_force(t->device, means) > 0) {
        bool by_guard = means == GROBO_ESTOP_BY_GUARD;
        t->forced_until_us = grobo_now_us() + (by_guard ? GUARD_US : END_US);
        t->guarded = by_guard;
        t->ended = !by_guard;
    }
}

/* Who is there is not asked: it is to be stopped. False: the holder's answer is all there is. */
static bool take_port(conn *c, target *t)
{
    int64_t begin_us = grobo_now_us();
    for (;;) {
        t->a->hushed = t->said;
        int status = conn_open_unchecked(c, t->a);
        t->a->hushed = NULL;
        if (!status) {
            return true;
        }
        grobo_estop_ask(t->device, &t->stop, &t->holder);
        c->link_error = 0;
        t->waited_us = grobo_now_us() - begin_us;
        if (!is_over(t->holder.answer)) {
            force(t, c);
        }
        if (is_over(t->holder.answer) ||
            (t->waited_us >= patience_us(t, c) && grobo_now_us() >= t->forced_until_us) ||
            conn_sleep_until(c, grobo_now_us() + AGAIN_US) < 0) {
            return false;
        }
        char again[APP_LINE_BYTES]; /* of a trace: the last attempt says it */
        t->a->hushed = again;
        conn_close(c, status);
        t->a->hushed = NULL;
    }
}

/* With the port: the session may have carried it out when it was opened. */
static int stop_here(conn *c, const target *t)
{
    const char *by = t->ended     ? _(", after the end (SIGTERM) of a program that did not obey,")
                     : t->guarded ? _(", by the guard of a program that did not obey,")
                                  : "";
    int error = c->estop_ended ? c->estop_result
                               : conn_wait_shown(c, grobo_robot_estop(c->robot), "estop", 0);
    return error ? fail_verify(t, by, error) : succeed(t, by);
}

static int stop_marked(target *t)
{
    conn c;
    if (!t->is_line) {
        t->a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = t->device};
    }
    bool taken = take_port(&c, t);
    return conn_close(&c, taken ? stop_here(&c, t) : report_holder(t, c.open_error));
}

/* ---- which devices --------------------------------------------------------------------------- */

typedef struct busy_ports {
    app *a;
    target *t;
    int n;
    bool all; /* not only those that a program has which obeys */
} busy_ports;

static int mark_busy(void *ctx, const grobo_port_info *info)
{
    busy_ports *busy = ctx;
    grobo_estop_holder holder;
    if (info->open_result != GROBO_ERR_BUSY || busy->n == ROBOTS) {
        return 0;
    }
    grobo_estop_ask(info->path, NULL, &holder);
    if (busy->all || holder.answer != GROBO_ESTOP_NOBODY) {
        mark(&busy->t[busy->n], busy->a, info->path);
        busy->t[busy->n++].spared = holder.answer == GROBO_ESTOP_NOBODY;
    }
    return 0;
}

enum { NONE = -1 };

/* All are marked before one is waited for. */
static int stop_busy(app *a, bool all, int otherwise)
{
    static target targets[ROBOTS];
    busy_ports busy = {.a = a, .t = targets, .all = all};
    int status = EXIT_DONE;
    grobo_port_list(mark_busy, &busy);
    for (int i = 0; i < busy.n; i++) {
        int its = stop_marked(&targets[i]);
        status = its ? its : status;
    }
    return busy.n > 0 ? status : otherwise;
}

/*
 * `auto`: robots that a program of this user has, of which one may move; else the one that answers;
 * else any port in use.
 */
static int stop_any(app *a)
{
    static target t;
    conn c;
    int status = stop_busy(a, false, NONE);
    if (status != NONE) {
        return status;
    }
    t.a = a;
    a->hushed = t.said;
    status = conn_open(&c, a);
    a->hushed = NULL;
    if (!status) {
        mark(&t, a, conn_device(&c));
        return conn_close(&c, stop_here(&c, &t));
    }
    int error = c.open_error;
    status = conn_close(&c, status);
    if (error == GROBO_ERR_NOTFOUND) {
        int busy = stop_busy(a, true, NONE);
        if (busy != NONE) {
            return busy;
        }
    }
    app_fail(a, status, grobo_error_name(error), "%s; NOT stopped, nothing was sent", t.said);
    return status;
}

/* A name that leads to no device: robots that programs of this user have are stopped instead. */
static int stop_unknown(app *a, const char *name, const char *why)
{
    bool others = stop_busy(a, false, NONE) != NONE;
    return app_fail(a, EXIT_ROBOT, grobo_error_name(GROBO_ERR_NOENT), "%s: %s; NOT stopped, %s",
                    name, why,
                    others ? _("but for the robots that programs of this user have")
                           : _("nothing was sent; see 'grctl ports'"));
}

static const char *unknown_name(const app *a)
{
    static char text[3 * CONFIG_NAME_BYTES];
    snprintf(text, sizeof text, _("no robot of the configuration, no device%s%s%s"),
             a->nearest_device ? _(" (did you mean '") : "",
             a->nearest_device ? a->nearest_device : "", a->nearest_device ? _("'?)") : "");
    return text;
}

/* The device that is meant: that of the shell, or as given. NULL, or why there is none. */
static const char *find_device(const app *a, char *device)
{
    static grobo_os_cause cause;
    const char *asked = conn_requested(a);
    const conn_link *link = a->link;
    if (link && link->session) {
        snprintf(device, GROBO_DEVICE_MAX_BYTES, "%s", grobo_session_device(link->session));
        return NULL;
    }
    if (config_is_unknown_name(a, asked)) {
        return unknown_name(a);
    }
    int error = grobo_port_resolve(asked, device, GROBO_DEVICE_MAX_BYTES, &cause);
    if (error) {
        return *cause.text ? cause.text : app_error_text(error);
    }
    return NULL;
}

/* ---- clearing -------------------------------------------------------------------------------- */

static int report_reset(app *a, const char *device, int error, const char *cause)
{
    if (error) {
        return app_fail(a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: cannot release the emergency stop: %s", device,
                        cause && *cause ? cause : app_error_text(error));
    }
    app_done(a, "emergency stop released; torque is unchanged");
    return EXIT_DONE;
}

/* A mark needs no port to be cleared: the device may be missing, or in use. */
static int reset(app *a, const char *device)
{
    conn c;
    bool shell = a->link && a->link->session;
    if (!shell && grobo_estop_stands(device)) {
        grobo_os_cause cause = {0};
        grobo_estop_holder holder;
        int error = grobo_estop_clear(device, &cause);
        int cleared = report_reset(a, device, error, cause.text);
        if (!error && grobo_estop_ask(device, NULL, &holder) == GROBO_OK && holder.pid != 0) {
            app_note(a,
                     "process %d, which has the port, stays stopped until it is reset or restarted",
                     holder.pid);
        }
        return cleared;
    }
    int status = conn_open_named(&c, a);
    if (!status) {
        int error = grobo_robot_reset(c.robot);
        status = report_reset(a, conn_device(&c), error, NULL);
    }
    return conn_close(&c, status);
}

/* ---- a robot of several lines ---------------------------------------------------------------- */

/* The port of a line, by NAME=PORT of what was asked for, or as the robot's file has it. False: it
 * has none. */
static bool find_port(const app *a, int line, char *device)
{
    const grobo_robot_file_line *own = &robot_of(a)->lines[line];
    const char *item = conn_requested(a), *port = own->port;
    size_t size = port ? strlen(port) : 0, length = strlen(own->name);
    for (; *item; item += strcspn(item, ","), item += *item == ',') {
        if (strncmp(item, own->name, length) == 0 && item[length] == '=') {
            port = item + length + 1;
            size = strcspn(port, ",");
        }
    }
    if (!size || size >= GROBO_DEVICE_MAX_BYTES) {
        return false;
    }
    memcpy(device, port, size);
    device[size] = '\0';
    return true;
}

/* The devices of all lines are marked before one is waited for, and released together. */
static int estop_lines(app *a, bool resets)
{
    static target targets[GROBO_LINES_MAX];
    const grobo_robot_def *def = robot_of(a);
    const char *fault = robot_lines_fault(a, conn_requested(a));
    int error = GROBO_OK;
    if (fault) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s; NOT stopped, nothing was sent", fault);
    }
    for (int i = 0; i < def->n_lines; i++) {
        char device[GROBO_DEVICE_MAX_BYTES];
        grobo_os_cause cause = {0};
        if (!find_port(a, i, device)) {
            return app_fail(a, EXIT_ROBOT, "NOENT",
                            "line %s has no port: -d %s=PORT or 'port' in the robot's file",
                            def->lines[i].name, def->lines[i].name);
        }
        if (resets && grobo_estop_stands(device)) {
            int cleared = grobo_estop_clear(device, &cause);
            error = error ? error : cleared;
        } else if (!resets) {
            mark(&targets[i], a, device);
            targets[i].is_line = true;
        }
    }
    return resets ? report_reset(a, conn_requested(a), error, NULL) : stop_marked(&targets[0]);
}

static int run_estop(app *a)
{
    static target t;
    char device[GROBO_DEVICE_MAX_BYTES];
    bool resets = app_option(a, OPT_RESET)->given > 0;
    if (resets && a->mistaken) {
        return EXIT_DONE; /* only a stop goes before what is wrong */
    }
    bool shell = a->link && a->link->session;
    if (robot_of(a)->n_lines > 0 && !shell && strcmp(conn_requested(a), GROBO_DEVICE_SIM) != 0) {
        return estop_lines(a, resets);
    }
    const char *why = find_device(a, device);
    if (why && resets) {
        return app_fail(a, EXIT_ROBOT, grobo_error_name(GROBO_ERR_NOENT), "%s: %s",
                        conn_requested(a), why);
    }
    if (why) {
        return stop_unknown(a, conn_requested(a), why);
    }
    if (resets) {
        return reset(a, device);
    }
    if (strcmp(device, GROBO_DEVICE_AUTO) == 0) {
        return stop_any(a);
    }
    mark(&t, a, device);
    return stop_marked(&t);
}

const cli_command cmd_estop = {
    .name = "estop",
    .arguments = "",
    .summary = "stop all joints at once, and verify it",
    .details =
        "Marks the device first: from then on every program of this library and this user\n"
        "refuses to move the robot (grctl with exit status 4), until --reset. Then brakes\n"
        "every joint ahead of all else, reads each one back, and repeats what did not take.\n"
        "Where another program has the port, that one stops the robot and confirms it; if it\n"
        "is stopped itself (Ctrl-Z), it is resumed. If it does not obey, its guard stops the\n"
        "robot; if it has none, it gets SIGTERM. The stop of root reaches the programs of all\n"
        "users. Exit status 0 only when the stop is verified; else the message says what was\n"
        "done and what was not. A robot that stands may sink: hold it.\n"
        "\n"
        "A mistake on the command line, a bad configuration and a trace that cannot be written\n"
        "are reported after the stop, with their exit status. Signals wait for it.\n",
    .example = "  grctl estop\n  grctl estop --reset\n",
    COMMAND_OPTIONS(estop_options),
    .stops = true,
    .group = CLI_GROUP_EACH,
    .run = run_estop,
};
