/* SPDX-License-Identifier: MIT */
/* record: a motion taught by hand. */
#include <math.h>
#include <string.h>

#include <grobo/motion_io.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/os/keys.h"

enum { OPT_OUT, OPT_RATE, OPT_KEY, OPT_MOVED, OPT_TIME };
enum { KEY_MS = 1000, PAUSE_US = 1000000, LIVE_US = 100000 };

/* The original's: a look each 250 ms, a posture when a joint moved by 10 degrees. */
static const double seed_rate_hz = 4, seed_moved_deg = 10;

static const cli_option options[] = {
    [OPT_OUT] = {.name = "out",
                 .letter = 'o',
                 .kind = CLI_TEXT,
                 .value = "FILE",
                 .help = ".m, .pseq, .mseq or .yaml (the first free MotionN.m)"},
    [OPT_RATE] = {.name = "rate",
                  .letter = 'r',
                  .kind = CLI_NUMBER,
                  .value = "HZ",
                  .help = "look so many times a second (4)",
                  .min = 0.1,
                  .max = 50,
                  .real = true},
    [OPT_KEY] = {.name = "key",
                 .letter = 'k',
                 .kind = CLI_FLAG,
                 .help = "a posture a key press: space"},
    [OPT_MOVED] = {.name = "moved",
                   .letter = 'm',
                   .kind = CLI_NUMBER,
                   .value = "DEG",
                   .help = "keep a posture when a joint moved by so much (10); 0: every one",
                   .min = 0,
                   .max = 180,
                   .real = true},
    [OPT_TIME] = {.name = "time",
                  .letter = 't',
                  .kind = CLI_NUMBER,
                  .value = "MS",
                  .help = "with --key: time to reach a posture (1000)",
                  .min = 10,
                  .max = 9990},
};

typedef struct recorder {
    conn c;
    keys input;
    struct event *look, *live;
    grobo_motion *motion;
    grobo_joint_mask joints; /* in the hand */
    grobo_posture last;      /* kept last */
    int64_t last_us;         /* when */
    progress line;
    double moved_deg;
    int last_moved; /* joint, -1 none */
    bool by_key, over;
    int error;
} recorder;

/* ---- postures -------------------------------------------------------------------------------- */

/* The joint that is furthest from the posture kept last, and how far. */
static double furthest(const recorder *r, const grobo_posture *now, int *joint)
{
    double most_rad = 0;
    *joint = -1;
    for (int j = 0; j < now->n_joints; j++) {
        double moved_rad = fabs(now->angle_rad[j] - r->last.angle_rad[j]);
        if ((now->set & r->last.set & r->joints & GROBO_JOINT_BIT(j)) && moved_rad >= most_rad) {
            most_rad = moved_rad;
            *joint = j;
        }
    }
    return grobo_deg_from_rad(most_rad);
}

static void keep(recorder *r, grobo_posture *now)
{
    int64_t now_us = grobo_now_us();
    size_t n = grobo_motion_size(r->motion);
    int64_t took_us = n == 0 ? 0 : now_us - r->last_us;
    if (r->by_key)
        now->time_us = (int64_t)app_number(r->c.a, OPT_TIME, KEY_MS) * 1000;
    else
        now->time_us = n == 0 ? KEY_MS * 1000 : took_us < PAUSE_US ? took_us : PAUSE_US;
    grobo_posture_clamp(now, grobo_robot_driver(r->c.robot)->model);
    r->error = grobo_motion_append(r->motion, now);
    r->over |= r->error < 0;
    r->last = *now;
    r->last_us = now_us;
}

static void look(recorder *r, bool anyway)
{
    grobo_posture now;
    int n = grobo_robot_posture(r->c.robot, grobo_now_us(), GROBO_NEVER_US, &now);
    if (n < now.n_joints) /* a first round is still under way */
        return;
    if (anyway || grobo_motion_size(r->motion) == 0 ||
        furthest(r, &now, &r->last_moved) >= r->moved_deg)
        keep(r, &now);
}

static void drop_last(recorder *r)
{
    size_t n = grobo_motion_size(r->motion);
    if (n == 0)
        return;
    grobo_motion_delete(r->motion, n - 1);
    if (n > 1)
        grobo_motion_get(r->motion, n - 2, &r->last);
}

/* ---- what is seen ---------------------------------------------------------------------------- */

static size_t add_angle(const recorder *r, const grobo_posture *now, int joint, char *text,
                        size_t capacity)
{
    const grobo_model *model = grobo_robot_driver(r->c.robot)->model;
    int n = snprintf(text, capacity, "  %s %.1f", model->joints[joint].name,
                     grobo_deg_from_rad(now->angle_rad[joint]));
    return n > 0 && (size_t)n < capacity ? (size_t)n : 0;
}

/* The joint that moves first, then the others as far as the line goes. */
static void draw(recorder *r)
{
    char text[512];
    grobo_posture now;
    int joint;
    size_t at;
    if (!r->line.shown)
        return;
    grobo_robot_posture(r->c.robot, grobo_now_us(), GROBO_NEVER_US, &now);
    at = (size_t)snprintf(text, sizeof text, "%zu kept", grobo_motion_size(r->motion));
    furthest(r, &now, &joint);
    if (joint >= 0)
        at += add_angle(r, &now, joint, text + at, sizeof text - at);
    for (int j = 0; j < now.n_joints && at < sizeof text - 1; j++)
        if (j != joint && (r->joints & now.set & GROBO_JOINT_BIT(j)))
            at += add_angle(r, &now, j, text + at, sizeof text - at);
    progress_draw(&r->line, -1, text);
}

/* ---- what comes from the loop ---------------------------------------------------------------- */

static void on_look(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    look(ctx, false);
}

static void on_live(evutil_socket_t fd, short what, void *ctx)
{
    (void)fd;
    (void)what;
    draw(ctx);
}

static void on_key(void *ctx, int key)
{
    recorder *r = ctx;
    if (key == ' ')
        look(r, true);
    else if (key == 'd')
        drop_last(r);
    else if (key == 's' || key == 'q' || (key == KEYS_END && r->by_key))
        r->over = true;
}

static bool is_over(conn *c)
{
    const recorder *r = c->ctx;
    return r->over || c->trip.trip != GROBO_TRIP_NONE;
}

static struct event *every(recorder *r, int64_t period_us, event_callback_fn fn)
{
    struct timeval period = {(int)(period_us / 1000000), (int)(period_us % 1000000)};
    struct event *timer = event_new(r->c.base, -1, EV_PERSIST, fn, r);
    if (timer)
        event_add(timer, &period);
    return timer;
}

/* ---- from the beginning to the end ----------------------------------------------------------- */

static void say_how(const recorder *r, bool hears)
{
    int n = grobo_joints_count(r->joints);
    double rate_hz = app_number(r->c.a, OPT_RATE, seed_rate_hz);
    double line_hz = wire_taught_hz(grobo_robot_driver(r->c.robot), (int)conn_baud(r->c.a), n);
    app_note(r->c.a,
             "joints are in your hands: each gives way when you turn it, holds when let go");
    if (!r->by_key && rate_hz > line_hz)
        app_note(r->c.a, "the line reads %s %.3g times a second: a higher --rate sees nothing more",
                 n == 1 ? "the joint" : "each joint", line_hz);
    if (hears)
        app_note(r->c.a, "space: keep a posture   d: drop the last   s: save and end");
    else
        app_note(r->c.a, "Ctrl-C saves and ends");
}

/* Until somebody says so. Returns why it ended before, or 0. */
static int teach(recorder *r)
{
    conn *c = &r->c;
    grobo_joint_mask all = GROBO_JOINTS_ALL(grobo_robot_driver(c->robot)->model->n_joints);
    int error = conn_wait(c, grobo_session_sense(c->session, all, GROBO_SENSE_ALL));
    bool hears;
    if (!error)
        error = conn_wait(c, grobo_session_torque(c->session, r->joints, GROBO_TORQUE_ON));
    if (!error)
        error = grobo_session_free_mode(c->session, r->joints, true);
    if (error < 0)
        return error;
    hears = keys_start(&r->input, c->base, true, on_key, r);
    say_how(r, hears);
    progress_start(&r->line, c->a);
    if (!r->by_key) {
        double rate_hz = app_number(c->a, OPT_RATE, seed_rate_hz);
        look(r, true);
        r->look = every(r, (int64_t)(1e6 / rate_hz), on_look);
    }
    r->live = every(r, LIVE_US, on_live);
    error = conn_wait_until(c, is_over);
    keys_stop(&r->input);
    progress_clear(&r->line);
    for (int i = 0; i < 2; i++) {
        struct event *timer = i ? r->live : r->look;
        if (timer)
            event_free(timer);
    }
    if (!error) /* out of the hands: they hold where they are */
        error = conn_wait(c, grobo_session_free_mode(c->session, r->joints, false));
    return error ? error : r->error;
}

static int fail_to_write(app *a, int error)
{
    const char *out = app_option(a, OPT_OUT)->text;
    if (out && error == GROBO_ERR_EXISTS)
        return app_fail(
            a, EXIT_FILE, grobo_error_name(error),
            "%s: holds something other than a motion of its format; choose another name", out);
    return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: cannot write: %s",
                    out ? out : "MotionN.m", file_write_error_text(error));
}

/* Whether the file will be writable: better known before somebody has taught for an hour. */
static int try_to_write(app *a)
{
    const grobo_files *files = grobo_files_os();
    const char *out = app_option(a, OPT_OUT)->text;
    grobo_file file;
    int error =
        out ? grobo_motion_may_save(files, out, grobo_motion_format_of_path(out)) : GROBO_OK;
    if (error == GROBO_OK)
        error = files->create(&file, out ? out : "./Motion.m", false);
    if (error < 0)
        return fail_to_write(a, error);
    files->discard(&file);
    return 0;
}

static int save(recorder *r)
{
    app *a = r->c.a;
    const char *out = app_option(a, OPT_OUT)->text;
    grobo_write_options how = {.model = &grobo_gr001_model};
    char path[GROBO_PATH_MAX_BYTES];
    const char *name = path + 2; /* behind ./ */
    size_t n = grobo_motion_size(r->motion);
    double length_s = (double)grobo_motion_length_us(r->motion, GROBO_MOTION_DEFAULT_US) / 1e6;
    int error;
    if (n == 0) {
        app_note(a, "nothing was recorded; no file is written");
        return EXIT_DONE;
    }
    error = out ? grobo_motion_save(r->motion, grobo_files_os(), out, &how, NULL) : GROBO_OK;
    if (error == GROBO_ERR_EXISTS) { /* it was not there when teaching began */
        app_note(a, "%s holds something other than a motion of its format now", out);
        out = NULL;
    }
    if (!out)
        error = grobo_motion_save_next(r->motion, grobo_files_os(), ".", &how, path, sizeof path);
    if (error < 0)
        return fail_to_write(a, error);
    if (a->json)
        app_print_json(json_pack("{s:o,s:I,s:o}", "file", app_json_text(out ? out : name),
                                 "postures", (json_int_t)n, "length_ms",
                                 json_integer((json_int_t)(length_s * 1e3 + 0.5))));
    else
        app_print("%s\n", out ? out : name);
    app_note(a, "%zu posture%s, %.1f s", n, n == 1 ? "" : "s", length_s);
    return EXIT_DONE;
}

/* Whatever ended it, what was recorded is kept. */
static int record(recorder *r)
{
    conn *c = &r->c;
    int error, status, saved;
    c->ctx = r;
    error = teach(r);
    status = error ? conn_fail(c, error, "record") : EXIT_DONE;
    saved = save(r);
    return status ? status : saved;
}

static int prepare(recorder *r, app *a)
{
    const char *out = app_option(a, OPT_OUT)->text;
    int status = 0;
    r->by_key = app_option(a, OPT_KEY)->given > 0;
    r->moved_deg = app_number(a, OPT_MOVED, seed_moved_deg);
    r->last_moved = -1;
    if (out && grobo_motion_format_of_path(out) == GROBO_FORMAT_AUTO)
        return app_fail(a, EXIT_USAGE, "ARG",
                        "record: -o %s: its name tells no format; .m, .pseq, .mseq or .yaml", out);
    for (int i = 0; i < a->line.n_arguments && !status; i++)
        status = joints_parse(a, a->line.argument[i], &r->joints);
    if (!status)
        status = try_to_write(a);
    if (status)
        return status;
    if (!r->joints)
        r->joints = GROBO_JOINTS_ALL(grobo_gr001_model.n_joints);
    if (grobo_motion_new(&r->motion, GROBO_MOTION_POSTURES, grobo_gr001_model.n_joints, NULL) < 0)
        return app_fail(a, EXIT_ROBOT, "NOMEM", "record: %s", grobo_error_text(GROBO_ERR_NOMEM));
    return 0;
}

static int run(app *a)
{
    static recorder r;
    int status;
    memset(&r, 0, sizeof r);
    status = prepare(&r, a);
    if (!status) {
        status = conn_open_to_move(&r.c, a);
        if (!status)
            status = record(&r);
        status = conn_close(&r.c, status);
    }
    grobo_motion_free(r.motion);
    return status;
}

const cli_command cmd_record = {
    .name = "record",
    .arguments = "[JOINT|GROUP]...",
    .summary = "record a motion that a hand shows",
    .details =
        "All joints, or those named, give way to a hand that turns them and hold when it lets go.\n"
        "Postures are kept when a joint has moved by --moved degrees, looked at --rate times a\n"
        "second; with --key only at the press of a key. Pauses are cut to a second.\n"
        "\n"
        "At 115200 bps each of all joints is read 6 times a second, of the 3 of an arm 40 times,\n"
        "a single one 120 times: a higher --rate sees nothing more. The joints that are not\n"
        "taught are watched meanwhile, once a second.\n"
        "\n"
        "Keys, of a terminal or a pipe:\n"
        "\n"
        "  space   keep the posture as it is now\n"
        "  d       drop the last one\n"
        "  s, q    save and end\n"
        "\n"
        "Ctrl-C, or a lost line, keeps what was recorded too. The name of the file is printed.\n",
    .example = "  grctl record\n  grctl record --key -o wave.pseq right_arm\n",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .max_arguments = -1,
    .argument = CLI_ARG_JOINT,
    .run = run,
};
