/* SPDX-License-Identifier: MIT */
/*
 * record, teach: a motion taught by hand.
 *
 * A joint that is taught is held or limp. A held one is in free mode: the engine reads it all the
 * time. A limp one has no torque: this reads it when a posture is looked at, and for what is shown.
 * Keys and timers only note what is due; the loop in mind() does one thing after the other, so that
 * a key waits for a reading or for what is being played.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/motion_io.h>
#include <grobo/core/wheel.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/journal.h"
#include "tools/grctl/cli/progress.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/fall.h"
#include "tools/grctl/conn/imu.h"
#include "tools/grctl/conn/imu_rows.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/keys.h"

/* The first ones are those of teach. */
enum {
    OPT_OUT,
    OPT_TIME,
    OPT_IMU,
    TEACH_OPTIONS,
    OPT_RATE = TEACH_OPTIONS,
    OPT_KEY,
    OPT_MOVED,
    OPT_LIMP
};
enum { KEY_MS = 1000, PAUSE_US = 1000000, LIVE_US = 100000, KEYS_MAX = 32 };
/* An older reading of an IMU is not that of a posture. */
enum { TILT_US = 500000 };

/* The original's: a look each 250 ms, a posture when a joint moved by 10 degrees. */
static const double seed_rate_hz = 4, seed_moved_deg = 10;

static const cli_option options[] = {
    [OPT_OUT] =
        OPTION_TEXT("out", 'o', "FILE", ".m, .pseq, .mseq or .yaml (the first free MotionN.m)"),
    [OPT_TIME] = OPTION_WHOLE("time", 't', "MS", 10, 9990,
                              "time to reach a posture kept by a key press (1000)"),
    [OPT_IMU] = IMU_OPTION,
    [OPT_RATE] = OPTION_REAL("rate", 'r', "HZ", 0.1, 50, "checks per second (4)"),
    [OPT_KEY] = OPTION_FLAG("key", 'k', "keep a posture only at a key press: space"),
    [OPT_MOVED] = OPTION_REAL("moved", 'm', "DEG", 0, 180,
                              "keep a posture when a joint moved by so much (10); 0: every one"),
    [OPT_LIMP] = OPTION_FLAG("limp", 0, "switch torque off; the default where it is off"),
};

typedef struct recorder {
    conn c;
    keys input;
    play_keys playing; /* its conn is NULL while nothing is played */
    struct event *look, *live;
    grobo_motion *motion;
    journal kept;            /* the same, on disk as it comes */
    grobo_motion *played;    /* a copy that is or was played; the robot may read it until the end */
    grobo_clip clip;         /* of that */
    grobo_joint_mask joints; /* that are taught: */
    grobo_joint_mask held;   /* in free mode */
    grobo_joint_mask limp;   /* without torque */
    grobo_posture last;      /* kept last */
    int64_t last_us;         /* when */
    int key[KEYS_MAX], n_keys;     /* that wait, the first one first */
    bool look_is_due, live_is_due; /* by the timers */
    progress line;
    imu imu;
    imu_rows tilts; /* one a posture, with --imu */
    double moved_deg;
    int last_moved; /* joint, -1 none */
    bool teaches, by_key, over;
} recorder;

static const char *name_of(const recorder *r)
{
    return r->teaches ? "teach" : "record";
}

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

/* How the base stands now, where an IMU has said so of late. */
static int keep_tilt(recorder *r, int64_t time_us)
{
    grobo_imu reading;
    int64_t age_us;
    bool known = grobo_robot_imu(r->c.robot, &reading, &age_us) == GROBO_OK && age_us <= TILT_US;
    return app_option(r->c.a, OPT_IMU)->given
               ? imu_rows_add(&r->tilts, time_us, known ? &reading : NULL)
               : GROBO_OK;
}

static void say_unwritten(const recorder *r, const char *path, int error)
{
    if (error) {
        app_note(r->c.a, "%s: cannot write: %s; what is kept from now on is in memory alone", path,
                 app_cause_text(error));
    }
}

/* A full disk ends no recording: it may have room at the end, or another one may. */
static void write_down(recorder *r)
{
    char path[sizeof r->kept.path];
    snprintf(path, sizeof path, "%s", r->kept.path);
    say_unwritten(r, path, journal_add(&r->kept, &r->last, conn_model(&r->c)));
}

static int keep(recorder *r, grobo_posture *now)
{
    int64_t now_us = grobo_now_us();
    size_t n = grobo_motion_size(r->motion);
    int64_t took_us = n == 0 ? 0 : now_us - r->last_us;
    if (r->by_key) {
        now->time_us = (int64_t)app_number(r->c.a, OPT_TIME, KEY_MS) * 1000;
    } else {
        now->time_us = n == 0 ? KEY_MS * 1000 : took_us < PAUSE_US ? took_us : PAUSE_US;
    }
    grobo_posture_clamp(now, conn_model(&r->c));
    r->last = *now;
    r->last_us = now_us;
    int error = keep_tilt(r, now->time_us);
    if (error >= 0) {
        error = grobo_motion_append(r->motion, now);
    }
    if (error >= 0) {
        write_down(r);
    }
    return error;
}

/* Limp joints are read now. A reply that was lost is no reason to end; *read is false then. */
static int read_limp(recorder *r, bool *read)
{
    conn *c = &r->c;
    int error = GROBO_OK;
    *read = true;
    if (r->limp) {
        error = conn_sense(c, r->limp, GROBO_SENSE_POSITION);
    }
    if (conn_is_of_reply(error)) {
        *read = false;
        error = GROBO_OK;
    }
    return error;
}

/* Keeps the posture read last where that is asked for, or where it is another one. */
static int take(recorder *r, bool anyway)
{
    grobo_posture now;
    int n = grobo_robot_posture(r->c.robot, GROBO_NEVER_US, &now);
    if (n < now.n_joints) { /* a first round is still under way */
        return 0;
    }
    if (anyway || grobo_motion_size(r->motion) == 0 ||
        furthest(r, &now, &r->last_moved) >= r->moved_deg) {
        return keep(r, &now);
    }
    return 0;
}

static int look(recorder *r, bool anyway)
{
    bool read;
    int error = read_limp(r, &read);
    if (!error && read) {
        return take(r, anyway);
    }
    if (!error && anyway) {
        app_note(r->c.a, "not kept: a servo did not answer; try again");
    }
    return error;
}

static int drop_last(recorder *r)
{
    size_t n = grobo_motion_size(r->motion);
    if (n > 0) {
        grobo_motion_delete(r->motion, n - 1);
        imu_rows_drop(&r->tilts);
        journal_drop_last(&r->kept);
    }
    if (n > 1) {
        grobo_motion_get(r->motion, n - 2, &r->last);
    }
    return 0;
}

/* ---- what is seen ---------------------------------------------------------------------------- */

static size_t add_angle(const recorder *r, const grobo_posture *now, int joint, char *text,
                        size_t capacity)
{
    const grobo_model *model = conn_model(&r->c);
    grobo_unit unit = grobo_model_unit(model, joint);
    int n = snprintf(text, capacity, "  %s %.1f%s", grobo_model_joint(model, joint)->name,
                     grobo_model_value(model, joint, now->angle_rad[joint]),
                     unit == GROBO_UNIT_DEG ? "" : grobo_unit_name(unit));
    return n > 0 && (size_t)n < capacity ? (size_t)n : 0;
}

/* The joint that moves first, then the others as far as the line goes. */
static void draw(recorder *r)
{
    char text[512];
    grobo_posture now;
    int joint;
    if (!r->line.shown) {
        return;
    }
    grobo_robot_posture(r->c.robot, GROBO_NEVER_US, &now);
    size_t at = (size_t)snprintf(text, sizeof text, _("%zu kept"), grobo_motion_size(r->motion));
    furthest(r, &now, &joint);
    if (joint >= 0) {
        at += add_angle(r, &now, joint, text + at, sizeof text - at);
    }
    for (int j = 0; j < now.n_joints && at < sizeof text - 1; j++) {
        if (j != joint && (r->joints & now.set & GROBO_JOINT_BIT(j))) {
            at += add_angle(r, &now, j, text + at, sizeof text - at);
        }
    }
    progress_draw(&r->line, -1, text);
}

/* ---- playing what is kept -------------------------------------------------------------------- */

static void free_played(recorder *r)
{
    if (r->played) {
        grobo_motion_clip_free(&r->clip);
    }
    grobo_motion_free(r->played);
    r->played = NULL;
}

/* A copy with the joints that are taught alone: no other one is switched on, or moves. */
static int copy_taught(const recorder *r, grobo_motion *copy)
{
    grobo_posture posture;
    int error = 0;
    for (size_t i = 0; i < grobo_motion_size(r->motion) && error >= 0; i++) {
        error = grobo_motion_get(r->motion, i, &posture);
        posture.set &= r->joints;
        if (error >= 0) {
            error = grobo_motion_append(copy, &posture);
        }
    }
    return error < 0 ? error : 0;
}

static bool has_played(conn *c)
{
    return c->trip.trip != GROBO_TRIP_NONE ||
           (!grobo_robot_is_playing(c->robot) && !grobo_robot_settling(c->robot));
}

static int make_clip(recorder *r)
{
    grobo_motion *copy;
    int error =
        grobo_motion_new(GROBO_MOTION_POSTURES, grobo_motion_joints(r->motion), NULL, &copy);
    if (error < 0) {
        return error;
    }
    error = copy_taught(r, copy);
    if (error >= 0) {
        error = grobo_motion_clip(copy, NULL, &r->clip);
    }
    if (error < 0) {
        grobo_motion_free(copy);
    } else {
        r->played = copy;
    }
    return error < 0 ? error : 0;
}

/* From where each joint is: torque comes on there, and the first posture is reached slowly. */
static int play(recorder *r)
{
    conn *c = &r->c;
    grobo_play_progress end = {0};
    r->playing = (play_keys){.c = c, .speed_pct = 100};
    c->moving = true;
    int error = conn_wait(c, grobo_robot_play(c->robot, &r->clip, NULL));
    if (!error) {
        error = conn_wait_until(c, has_played);
    }
    if (!error && r->playing.estop) {
        error = conn_end_estop(c);
    }
    if (!error) {
        grobo_robot_progress(c->robot, &end);
        error = c->trip.trip != GROBO_TRIP_NONE ? GROBO_ERR_LATCHED : end.error;
    }
    c->moving = error < 0;
    r->playing.c = NULL;
    return error;
}

/* Switches torque off, after a warning. */
static int let_fall(recorder *r, grobo_joint_mask joints)
{
    conn *c = &r->c;
    int n = grobo_joints_count(joints);
    app_note(c->a, "torque of %d joint%s goes off: hold the robot; what is raised falls", n,
             n == 1 ? "" : "s");
    (void)fall_note(c, joints);
    return conn_wait(c, grobo_robot_torque(c->robot, joints, GROBO_TORQUE_OFF));
}

static int play_kept(recorder *r)
{
    size_t n = grobo_motion_size(r->motion);
    if (n == 0) {
        app_note(r->c.a, "nothing is kept yet: space keeps a posture");
        return 0;
    }
    progress_clear(&r->line);
    app_note(r->c.a, "torque comes on, %zu posture%s: space: pause   s: stop   e: EMERGENCY STOP",
             n, n == 1 ? "" : "s");
    free_played(r);
    int error = make_clip(r);
    if (!error) {
        error = play(r);
    }
    if (error == GROBO_ERR_LIMIT || conn_is_of_reply(error)) { /* the next try may do better */
        (void)conn_fail(&r->c, error, name_of(r));
        r->c.moving = false;
        return let_fall(r, r->joints);
    }
    if (!error) {
        error = let_fall(r, r->joints);
    }
    if (!error) {
        app_note(r->c.a, "played; space: keep a posture   enter, p: play them   s: save and end");
    }
    return error;
}

/* ---- what comes from the loop ---------------------------------------------------------------- */

/* While it plays, keys are for that. A key too many is lost: nobody has pressed it. */
static void on_key(void *ctx, int key)
{
    recorder *r = ctx;
    if (r->playing.c && key != KEYS_END) {
        (void)play_keys_take(&r->playing, key);
    } else if (r->n_keys < KEYS_MAX) {
        r->key[r->n_keys++] = key;
    }
}

/* Without a line, so that a program that writes the keys can wait for a posture. */
static int tell_kept(const recorder *r, int error)
{
    if (!error && !r->line.shown) {
        app_note(r->c.a, _("%zu kept"), grobo_motion_size(r->motion));
    }
    return error;
}

static int take_key(recorder *r)
{
    int key = r->key[0];
    memmove(r->key, r->key + 1, (size_t)--r->n_keys * sizeof r->key[0]);
    if (key == ' ') {
        return tell_kept(r, look(r, true));
    }
    if (key == 'd') {
        return tell_kept(r, drop_last(r));
    }
    if (r->teaches && (key == 'p' || key == '\n' || key == '\r')) {
        return play_kept(r);
    }
    if (key == 's' || key == 'q' || (key == KEYS_END && r->by_key)) {
        r->over = true;
    }
    return 0;
}

static bool is_due(conn *c)
{
    const recorder *r = c->ctx;
    return r->n_keys > 0 || r->look_is_due || r->live_is_due || c->trip.trip != GROBO_TRIP_NONE;
}

/* A posture by time, or a line that shows one: with --rate the looks alone read limp joints. */
static int take_time(recorder *r)
{
    bool read, looks = r->look_is_due;
    int error = 0;
    r->look_is_due = r->live_is_due = false;
    if (looks) {
        error = look(r, false);
    } else if (r->by_key && r->line.shown) {
        error = read_limp(r, &read);
    }
    draw(r);
    return error;
}

/* Until somebody says so. */
static int mind(recorder *r)
{
    int error = 0;
    while (!error && !r->over) {
        error = conn_wait_until(&r->c, is_due);
        if (!error && r->c.trip.trip != GROBO_TRIP_NONE) {
            error = GROBO_ERR_LATCHED;
        }
        if (!error) {
            error = r->n_keys > 0 ? take_key(r) : take_time(r);
        }
    }
    return error;
}

/* ---- from the beginning to the end ----------------------------------------------------------- */

static void say_rate(const recorder *r)
{
    int n = grobo_joints_count(r->joints);
    double rate_hz = app_number(r->c.a, OPT_RATE, seed_rate_hz);
    double line_hz = wire_taught_hz(grobo_robot_driver(r->c.robot), (int)conn_baud(r->c.a), n);
    if (rate_hz > line_hz) {
        app_note(r->c.a, "the line reads %s %.3g times a second: a higher --rate sees nothing more",
                 n == 1 ? _("the joint") : _("each joint"), line_hz);
    }
}

static void say_how(const recorder *r, bool hears)
{
    if (r->held) {
        app_note(r->c.a,
                 "joints follow your hands: each turns with your hand and holds when released");
    }
    if (r->limp) {
        app_note(r->c.a, "%d joint%s limp: move by hand; a released joint does not hold",
                 grobo_joints_count(r->limp), grobo_joints_count(r->limp) == 1 ? " is" : "s are");
    }
    if (!r->by_key) {
        say_rate(r);
    }
    if (!hears) {
        app_note(r->c.a, "Ctrl-C saves and ends");
    } else {
        app_note(r->c.a, "space: keep a posture   d: drop the last   %ss: save and end",
                 r->teaches ? _("enter, p: play them   ") : "");
    }
}

/* Those of the joints that hold, and those that are not limp: braked ones too. */
static void look_at_torque(const recorder *r, grobo_joint_mask *hold, grobo_joint_mask *switched)
{
    *hold = *switched = 0;
    for (int j = 0; j < conn_model(&r->c)->n_joints; j++) {
        grobo_joint_info info;
        if (!(r->joints & GROBO_JOINT_BIT(j)) || grobo_robot_joint(r->c.robot, j, &info) < 0) {
            continue;
        }
        *hold |= info.state.torque == GROBO_TORQUE_ON ? GROBO_JOINT_BIT(j) : 0;
        *switched |= info.state.torque != GROBO_TORQUE_OFF ? GROBO_JOINT_BIT(j) : 0;
    }
}

/* Gives the joints into the hands. What is off stays off. */
static int give(recorder *r)
{
    conn *c = &r->c;
    grobo_joint_mask all = GROBO_JOINTS_ALL(conn_model(c)->n_joints);
    grobo_joint_mask hold, switched;
    int error = conn_sense(c, all, GROBO_SENSE_ALL);
    if (error < 0) {
        return error;
    }
    look_at_torque(r, &hold, &switched);
    if (r->teaches || app_option(c->a, OPT_LIMP)->given > 0) {
        error = switched ? let_fall(r, switched) : 0;
        hold = 0;
    }
    r->held = hold;
    r->limp = r->joints & ~hold;
    return hold ? grobo_robot_free(c->robot, hold, true) : error;
}

/* Until somebody says so. Returns why it ended before, or 0. */
static int teach(recorder *r)
{
    conn *c = &r->c;
    int error = give(r);
    if (error < 0) {
        return error;
    }
    if (!r->by_key) {
        error = take(r, true);
    }
    bool hears = keys_start(&r->input, c->base, true, on_key, r);
    if (!hears && r->by_key && !error) { /* keys could come, and nothing else would end it well */
        error = GROBO_ERR_NOMEM;
    }
    if (!error) {
        say_how(r, hears);
    }
    progress_start(&r->line, c->a);
    if (!r->by_key) {
        double rate_hz = app_number(c->a, OPT_RATE, seed_rate_hz);
        r->look = conn_every(c->base, (int64_t)(1e6 / rate_hz), conn_note, &r->look_is_due);
    }
    r->live = conn_every(c->base, LIVE_US, conn_note, &r->live_is_due);
    if (!error) {
        error = mind(r);
    }
    keys_stop(&r->input);
    progress_clear(&r->line);
    conn_forget(r->look);
    conn_forget(r->live);
    if (r->held) { /* out of the hands, whatever ended it: they hold where they are */
        int held = conn_wait(c, grobo_robot_free(c->robot, r->held, false));
        error = error ? error : held;
    }
    return error;
}

static int fail_to_write(app *a, int error)
{
    const char *out = app_option(a, OPT_OUT)->text;
    if (out && error == GROBO_ERR_EXISTS) {
        return app_fail(
            a, EXIT_FILE, grobo_error_name(error),
            "%s: holds something other than a motion of its format; choose another name", out);
    }
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
    if (error == GROBO_OK) {
        error = files->create(&file, out ? out : "./Motion.m", false);
    }
    if (error < 0) {
        return fail_to_write(a, error);
    }
    files->discard(&file);
    return 0;
}

static int write_file(recorder *r)
{
    app *a = r->c.a;
    const char *out = app_option(a, OPT_OUT)->text;
    grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .model = app_model(a)};
    char path[GROBO_PATH_MAX_BYTES];
    const char *name = path + 2; /* behind ./ */
    size_t n = grobo_motion_size(r->motion);
    double length_s = (double)grobo_motion_length_us(r->motion, GROBO_MOTION_DEFAULT_US) / 1e6;
    if (n == 0) {
        app_note(a, "nothing was recorded; no file is written");
        return EXIT_DONE;
    }
    int error = out ? grobo_motion_save(r->motion, grobo_files_os(), out, &how, NULL) : GROBO_OK;
    if (error == GROBO_ERR_EXISTS) { /* it was not there when teaching began */
        app_note(a, "%s holds something other than a motion of its format now", out);
        out = NULL;
    }
    if (!out) {
        error = grobo_motion_save_next(r->motion, grobo_files_os(), ".", &how, path, sizeof path);
    }
    if (error < 0) {
        return fail_to_write(a, error);
    }
    if (a->json) {
        app_print_json(json_pack("{s:o,s:I,s:o}", "file", app_json_text(out ? out : name),
                                 "postures", (json_int_t)n, "length_ms",
                                 json_integer((json_int_t)(length_s * 1e3 + 0.5))));
    } else {
        app_print("%s\n", out ? out : name);
    }
    app_note(a, "%zu posture%s, %.1f s", n, n == 1 ? "" : "s", length_s);
    return app_option(a, OPT_IMU)->given ? imu_rows_save(&r->tilts, a, out ? out : name)
                                         : EXIT_DONE;
}

/* What was written as it came stays where the file could not be written. */
static int save(recorder *r)
{
    char path[sizeof r->kept.path];
    size_t n = journal_size(&r->kept);
    int status = write_file(r);
    snprintf(path, sizeof path, "%s", r->kept.path);
    journal_end(&r->kept, status != EXIT_DONE);
    if (status && n > 0) {
        app_note(r->c.a, "%s has %zu posture%s of it", path, n, n == 1 ? "" : "s");
    }
    return status;
}

/* Where it cannot be, as beside a pipe, what is recorded is in memory until it ends. */
static void begin_journal(recorder *r)
{
    const char *out = app_option(r->c.a, OPT_OUT)->text;
    const char *target = out ? out : "Motion";
    say_unwritten(r, r->kept.path, journal_begin(&r->kept, target));
    if (r->kept.left) {
        app_note(r->c.a,
                 "%s.part.m has what a recording kept that did not end: rename or delete it",
                 target);
    }
}

/* Whatever ended it, what was recorded is kept. */
static int record(recorder *r)
{
    conn *c = &r->c;
    const cli_value *port = app_option(c->a, OPT_IMU);
    c->ctx = r;
    int status = port->given ? imu_open(&r->imu, c, port->text) : EXIT_DONE;
    if (status) {
        return status;
    }
    begin_journal(r);
    int error = teach(r);
    status = error ? conn_fail(c, error, name_of(r)) : EXIT_DONE;
    imu_close(&r->imu);
    int saved = save(r);
    return status ? status : saved;
}

static int prepare(recorder *r, app *a)
{
    const char *out = app_option(a, OPT_OUT)->text;
    r->by_key = r->teaches || app_option(a, OPT_KEY)->given > 0;
    r->moved_deg = r->teaches ? 0 : app_number(a, OPT_MOVED, seed_moved_deg);
    r->last_moved = -1;
    if (out && grobo_motion_format_of_path(out) == GROBO_FORMAT_AUTO) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        "%s: -o %s: unknown file type; use .m, .pseq, .mseq or .yaml", name_of(r),
                        out);
    }
    int status = joints_parse_all(a, a->line.n_arguments, a->line.argument, &r->joints);
    if (!status) {
        status = try_to_write(a);
    }
    if (status) {
        return status;
    }
    if (r->joints & grobo_model_wheels(app_model(a))) {
        app_note(a, "wheels are left out: a motion has angles, and a wheel has none");
        r->joints &= ~grobo_model_wheels(app_model(a));
    }
    if (grobo_motion_new(GROBO_MOTION_POSTURES, app_model(a)->n_joints, NULL, &r->motion) < 0) {
        return app_fail_error(a, EXIT_ROBOT, GROBO_ERR_NOMEM, "%s", name_of(r));
    }
    return 0;
}

/* Before a joint goes limp: what only a key ends must have keys. */
static int refuse_deaf(const recorder *r)
{
    if (!r->by_key || keys_can_come()) {
        return 0;
    }
    return app_fail(r->c.a, EXIT_USAGE, "ARG",
                    "%s: no key can come: standard input is neither this terminal nor an open "
                    "pipe; run it on a terminal",
                    name_of(r));
}

static int run(app *a, bool teaches)
{
    static recorder r;
    memset(&r, 0, sizeof r);
    r.teaches = teaches;
    int status = prepare(&r, a);
    if (!status) {
        status = conn_open_to_move(&r.c, a);
        if (!status) {
            status = refuse_deaf(&r);
            status = status ? status : record(&r);
        }
        status = conn_close(&r.c, status);
    }
    free_played(&r);
    imu_close(&r.imu);
    imu_rows_free(&r.tilts);
    grobo_motion_free(r.motion);
    return status;
}

static int run_record(app *a)
{
    return run(a, false);
}

static int run_teach(app *a)
{
    return run(a, true);
}

#define ENDS_HELP                                                                                  \
    "Ctrl-C, or a lost line, keeps what was recorded too. The name of the file is printed.\n"

const cli_command cmd_record = {
    .name = "record",
    COMMAND_ARGUMENTS("[JOINT|GROUP]...", 0, -1, CLI_ARG_JOINT),
    .summary = "record a motion by moving the robot by hand",
    .details =
        "All joints, or those named, follow a hand that turns them and hold when released.\n"
        "A joint without torque stays so: it is limp and nothing is switched on. --limp switches\n"
        "off the torque of the joints that are taught: hold the robot, an arm falls. The others\n"
        "stay as they are.\n"
        "\n"
        "Postures are kept when a joint has moved by --moved degrees, checked --rate times a\n"
        "second; with --key only at the press of a key. Pauses are cut to a second.\n"
        "\n"
        "At 115200 bps each of all joints is read 6 times a second, each of the 3 of an arm 40\n"
        "times, a single one 120 times: a higher --rate has no effect. The joints that are not\n"
        "taught are watched meanwhile, once a second.\n"
        "\n"
        "Keys, from a terminal or a pipe:\n"
        "\n"
        "  space   keep the posture as it is now\n"
        "  d       drop the last one\n"
        "  s, q    save and end\n"
        "\n"
        "Of a group (-d stage) the first robot leads: its motion is recorded.\n"
        "\n" ENDS_HELP,
    .example = "  grctl record\n  grctl record --key -o wave.pseq right_arm\n"
               "  grctl record --limp arms\n",
    COMMAND_OPTIONS(options),
    .group = CLI_GROUP_FIRST,
    .run = run_record,
};

const cli_command cmd_teach = {
    .name = "teach",
    COMMAND_ARGUMENTS("[JOINT|GROUP]...", 0, -1, CLI_ARG_JOINT),
    .summary = "record postures of limp joints, and play them at once",
    .details =
        "Switches off the torque of all joints, or of those named: hold the robot, an arm falls.\n"
        "Joints that are not taught stay as they are: those that hold continue to hold.\n"
        "\n"
        "Keys, from a terminal or a pipe:\n"
        "\n"
        "  space      keep the posture as it is now\n"
        "  d          drop the last one\n"
        "  enter, p   play what is kept; the joints are limp again at its end\n"
        "  s, q       save and end; the joints stay limp\n"
        "\n"
        "To play, torque comes on where each joint is, and the first posture is reached slowly.\n"
        "While it plays, the keys are those of 'grctl play':\n"
        "\n" PLAY_KEYS_HELP "\n" ENDS_HELP,
    .example = "  grctl teach\n  grctl teach -o wave.pseq right_arm\n",
    .options = options,
    .n_options = TEACH_OPTIONS,
    .group = CLI_GROUP_FIRST,
    .run = run_teach,
};
