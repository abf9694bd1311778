/* SPDX-License-Identifier: MIT */
/* stop and estop. */
#include <grobo/port.h>

#include "commands.h"
#include "latch.h"
#include "render.h"

enum { OPT_RESET };
/* How long a port in use is waited for, and how often it is tried. */
enum { PATIENCE_US = 3000000, AGAIN_US = 50000 };

static const cli_option estop_options[] = {
    [OPT_RESET] = {.name = "reset",
                   .kind = CLI_FLAG,
                   .help = "take the emergency stop back; nothing moves"},
};

static void report(const conn *c, const char *text)
{
    if (c->a->json)
        app_print_json(json_pack("{s:b}", "done", 1));
    else
        app_note(c->a, "%s", text);
}

static int run_stop(app *a)
{
    conn c;
    int status = conn_open(&c, a);
    if (!status) {
        int error = conn_wait(&c, grobo_session_exit(c.session, GROBO_EXIT_HOLD));
        if (error)
            status = conn_fail(&c, error, "stop");
        else
            report(&c, "stopped; joints with torque hold where they are");
    }
    return conn_close(&c, status);
}

static int reset(conn *c)
{
    grobo_trip_info trip;
    int error = latch_clear(conn_device(c));
    grobo_robot_tripped(c->robot, &trip);
    if (!error && trip.trip != GROBO_TRIP_NONE) /* in a shell the engine itself is stopped */
        error = grobo_session_reset(c->session);
    if (error)
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: cannot take the emergency stop back: %s", conn_device(c),
                        grobo_error_text(error));
    report(c, "emergency stop taken back; torque stays as it is");
    return EXIT_DONE;
}

/* The latch is set first: whatever happens here, nothing else moves the robot until the reset. */
static int stop_now(conn *c)
{
    int latched = latch_set(conn_device(c));
    int error = conn_wait(c, grobo_session_estop(c->session));
    if (error && !c->signal)
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: the stop was sent, but not every joint is seen to be stopped: %s; "
                        "switch the robot off",
                        conn_device(c), grobo_error_text(error));
    if (error)
        return EXIT_SIGNAL + c->signal;
    if (latched < 0)
        app_note(c->a, "stopped, but other commands cannot be told: %s", grobo_error_text(latched));
    report(c, "stopped and verified; 'grctl estop --reset' takes it back");
    return EXIT_DONE;
}

/* ---- where another program has the port ------------------------------------------------------ */

typedef struct busy_ports {
    char first[GROBO_DEVICE_MAX_BYTES]; /* "": none */
} busy_ports;

static int mark_busy(void *ctx, const grobo_port_info *info)
{
    busy_ports *busy = ctx;
    if (info->open_result != GROBO_ERR_BUSY)
        return 0;
    if (!*busy->first)
        snprintf(busy->first, sizeof busy->first, "%s", info->path);
    latch_set(info->path);
    return 0;
}

/* `auto` finds no robot on a port that is in use: all such ports are meant. */
static bool find_busy(app *a)
{
    static busy_ports busy;
    busy.first[0] = '\0';
    grobo_port_list(mark_busy, &busy);
    if (*busy.first)
        a->line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = busy.first};
    return *busy.first != '\0';
}

/* Who is there is not asked first, unless it decides which port is taken. */
static int open_unasked(conn *c, app *a)
{
    return conn_is_auto(a) ? conn_open(c, a) : conn_open_unchecked(c, a);
}

/*
 * A grctl that has the port sees the mark and stops the robot; when it has left the port, the stop
 * is verified from here.
 */
static int open_to_stop(conn *c, app *a)
{
    char said[APP_LINE_BYTES] = "";
    int64_t until_us = grobo_now_us() + PATIENCE_US;
    bool busy = false;
    int status;
    for (;;) {
        a->hushed = said;
        status = open_unasked(c, a);
        a->hushed = NULL;
        busy = c->open_error == GROBO_ERR_BUSY;
        if (busy)
            latch_set(conn_device(c));
        else if (c->open_error != GROBO_ERR_NOTFOUND || !find_busy(a))
            break;
        c->link_error = 0;
        if (grobo_now_us() >= until_us || conn_sleep_until(c, grobo_now_us() + AGAIN_US) < 0)
            break;
        conn_close(c, status);
    }
    if (status && !c->signal)
        app_fail(a, status, grobo_error_name(c->open_error), "%s%s", said,
                 busy ? "; a grctl stops the robot now, any other program must be ended" : "");
    return status;
}

static int run_estop(app *a)
{
    conn c;
    bool resets = app_option(a, OPT_RESET)->given > 0;
    int status = resets ? open_unasked(&c, a) : open_to_stop(&c, a);
    if (!status)
        status = resets ? reset(&c) : stop_now(&c);
    return conn_close(&c, status);
}

const cli_command cmd_stop = {
    .name = "stop",
    .arguments = "",
    .summary = "stop smoothly and hold",
    .details = "Makes every joint that has torque hold where it is. A motion that another grctl\n"
               "plays is stopped by a signal to it (Ctrl-C): it has the port.\n",
    .run = run_stop,
};

const cli_command cmd_estop = {
    .name = "estop",
    .arguments = "",
    .summary = "emergency stop, verified",
    .details = "Brakes every joint ahead of all else, reads each one back, and repeats what did\n"
               "not take. From then on grctl refuses to move this robot with exit status 4, until\n"
               "--reset. Another grctl that has the port stops the robot too. A robot that stands\n"
               "may sink: hold it.\n",
    .example = "  grctl estop\n  grctl estop --reset\n",
    .options = estop_options,
    .n_options = sizeof estop_options / sizeof estop_options[0],
    .run = run_estop,
};
