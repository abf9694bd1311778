/* SPDX-License-Identifier: MIT */
/*
 * follow: an arm that a hand moves leads another one.
 *
 * Both robots are on one loop. The leader is limp, and the background reads its angles once a
 * period. Once a period the follower is sent what it is to be, through its gate: a posture of our
 * own that goes towards the leader's, slowly until it is there, and no faster than its joints can
 * after that.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/wheel.h>

#include "tools/grctl/cli/realtime.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/lang/lang.h"

enum { OPT_RATE, OPT_FOR, OPT_REALTIME };
enum {
    LOST_US = 200000,
    ALL_US = 1000000,
    RATE_HZ = 100,
    MAX_HZ = 200,
    LATE_BIN_US = 20,
    LATE_BINS = 1000
};

/* The follower is there where all joints are as near; left so far behind it comes softly again. */
static const double there_deg = 1.5, behind_deg = 20;

static const cli_option options[] = {
    [OPT_RATE] = OPTION_WHOLE("rate", 'r', "HZ", 5, MAX_HZ, "targets a second (100)"),
    [OPT_FOR] = OPTION_REAL("for", 0, "S", 0.1, 86400, "end after this time"),
    [OPT_REALTIME] = REALTIME_OPTION,
};

typedef enum following {
    IS_LOST,    /* the leader is not read, or not yet known to be limp */
    APPROACHES, /* the follower goes to the leader, slowly */
    FOLLOWS
} following;

/* One of the two: its own command line as far as the robot goes. */
typedef struct side {
    app a;
    conn c;
    char robot[256];
    bool is_open;
} side;

typedef struct pair {
    app *a;
    side leader, follower;
    int of[GROBO_JOINTS_MAX]; /* the leader's joint for each of the follower's, -1: none */
    grobo_joint_mask joints;  /* of the follower, that have one */
    grobo_posture now;        /* what the follower is to be */
    int64_t moved_us[GROBO_JOINTS_MAX]; /* when that last was another angle */
    int64_t all_us;                     /* when all of it was sent */
    following state;
    int limp_job; /* switches the leader's torque off, 0: none is under way */
    bool limp;    /* it is off, as was read back since the leader was there */
    int64_t period_us, began_us, due_us, end_us;
    int error; /* of a target */
    uint64_t sent, clamped;
    uint32_t late[LATE_BINS]; /* how late periods began, in bins of LATE_BIN_US */
    uint64_t periods;
    int64_t late_max_us;
} pair;

/* ---- what is said ---------------------------------------------------------------------------- */

static void say_state(const pair *p)
{
    static const char *const names[] = {"lost", "approach", "follow"};
    static const char *const texts[] = {N_("the leader is lost: the follower holds"),
                                        N_("the follower goes to the leader"),
                                        N_("the follower follows")};
    if (p->a->json) {
        app_print_json(json_pack("{s:s,s:I}", "state", names[p->state], "t_ms",
                                 (json_int_t)((grobo_now_us() - p->began_us) / 1000)));
    } else {
        app_note(p->a, "%s", _(texts[p->state]));
    }
}

static void become(pair *p, following state)
{
    if (p->state != state) {
        p->state = state;
        say_state(p);
    }
}

/* What so many of a hundred periods were late at most. */
static int64_t late_us(const pair *p, unsigned percent)
{
    uint64_t n = 0;
    for (int i = 0; i < LATE_BINS; i++) {
        n += p->late[i];
        if (n * 100 >= p->periods * percent) {
            int64_t us = (int64_t)(i + 1) * LATE_BIN_US;
            return us < p->late_max_us ? us : p->late_max_us;
        }
    }
    return p->late_max_us;
}

static void report(const pair *p)
{
    double s = (double)(grobo_now_us() - p->began_us) / 1e6;
    double rate_hz = s > 0 ? (double)p->periods / s : 0;
    int64_t p50 = late_us(p, 50), p99 = late_us(p, 99);
    if (p->a->json) {
        app_print_json(json_pack("{s:b,s:I,s:I,s:o,s:{s:I,s:I,s:I}}", "done", 1, "targets",
                                 (json_int_t)p->sent, "clamped", (json_int_t)p->clamped, "rate_hz",
                                 app_json_number(rate_hz, 1), "late_us", "p50", (json_int_t)p50,
                                 "p99", (json_int_t)p99, "max", (json_int_t)p->late_max_us));
    } else {
        app_note(p->a,
                 "%llu targets at %.1f Hz; late by %lld us (median), %lld us (99 %%), %lld us "
                 "at most; %llu beyond the follower's limits",
                 (unsigned long long)p->sent, rate_hz, (long long)p50, (long long)p99,
                 (long long)p->late_max_us, (unsigned long long)p->clamped);
    }
}

/* ---- one period ------------------------------------------------------------------------------ */

/* Where the leader is, in the follower's joints and limits. False: its readings are too old. */
static bool read_leader(pair *p, grobo_posture *wanted)
{
    grobo_posture leader, within;
    const grobo_model *model = conn_model(&p->follower.c);
    grobo_robot_posture(p->leader.c.robot, LOST_US, &leader);
    grobo_posture_init(wanted, model->n_joints);
    for (int j = 0; j < model->n_joints; j++) {
        if (p->of[j] >= 0 && (leader.set & GROBO_JOINT_BIT(p->of[j]))) {
            grobo_posture_set_rad(wanted, j, leader.angle_rad[p->of[j]]);
        }
    }
    within = *wanted;
    p->clamped += grobo_posture_clamp(&within, model) > 0;
    *wanted = within;
    return p->leader.c.up && wanted->set == p->joints;
}

/* Goes on towards the leader. Returns how far it is from there, in degrees. */
static double go_on(pair *p, const grobo_posture *wanted)
{
    const grobo_driver *driver = grobo_robot_driver(p->follower.c.robot);
    double most_rad = 0;
    for (int j = 0; j < driver->model->n_joints; j++) {
        double dps = grobo_model_joint(driver->model, j)->max_speed_rad_s;
        if (!(p->joints & GROBO_JOINT_BIT(j))) {
            continue;
        }
        if (p->state == APPROACHES) {
            dps = fmin(dps, driver->limits.approach_rad_s);
        }
        double step_rad = dps * (double)p->period_us / 1e6;
        double rest_rad = wanted->angle_rad[j] - p->now.angle_rad[j];
        if (rest_rad != 0) {
            p->now.angle_rad[j] += fmax(-step_rad, fmin(step_rad, rest_rad));
            p->moved_us[j] = grobo_now_us();
        }
        most_rad = fmax(most_rad, fabs(wanted->angle_rad[j] - p->now.angle_rad[j]));
    }
    return grobo_deg_from_rad(most_rad);
}

/*
 * A servo that is told a speed would take the last bit of its way at none if it were told where it
 * is to be again. So a joint that rests is told once more, and with all others from time to time: a
 * frame may be lost.
 */
static int send_moved(pair *p)
{
    grobo_posture target = p->now;
    int64_t now_us = grobo_now_us();
    bool all = now_us - p->all_us >= ALL_US;
    for (int j = 0; j < target.n_joints; j++) {
        int64_t rests_us = now_us - p->moved_us[j];
        if (rests_us > 3 * p->period_us / 2 && !(all && rests_us >= ALL_US / 2)) {
            target.set &= ~GROBO_JOINT_BIT(j);
        }
    }
    if (target.set == 0) {
        return 0;
    }
    p->all_us = all ? now_us : p->all_us;
    target.time_us = 2 * p->period_us;
    int error = grobo_robot_send(p->follower.c.robot, &target);
    p->sent += error >= 0;
    return error;
}

static void follow(pair *p, const grobo_posture *wanted)
{
    if (p->state == IS_LOST) {
        become(p, APPROACHES);
    }
    double rest_deg = go_on(p, wanted);
    if (p->state == APPROACHES && rest_deg < there_deg) {
        become(p, FOLLOWS);
    } else if (rest_deg > behind_deg) {
        become(p, APPROACHES);
    }
    p->error = send_moved(p);
}

/* A leader that was away may come back with torque. */
static void let_limp(pair *p)
{
    if (p->leader.c.up && !p->limp && !p->limp_job) {
        grobo_joint_mask all = GROBO_JOINTS_ALL(conn_model(&p->leader.c)->n_joints);
        int job = grobo_robot_torque(p->leader.c.robot, all, GROBO_TORQUE_OFF);
        p->limp_job = job > 0 ? job : 0;
    }
}

static void on_leader(conn *c, const grobo_event *event)
{
    pair *p = c->ctx;
    if (event->kind == GROBO_EVENT_JOB && p->limp_job && event->u.job.number == p->limp_job) {
        p->limp_job = 0;
        p->limp = event->u.job.result >= 0;
    }
}

static void note_late(pair *p)
{
    int64_t now_us = grobo_now_us();
    int64_t us = now_us > p->due_us ? now_us - p->due_us : 0;
    int64_t bin = us / LATE_BIN_US;
    p->late[bin < LATE_BINS ? bin : LATE_BINS - 1]++;
    p->late_max_us = us > p->late_max_us ? us : p->late_max_us;
    p->periods++;
    p->due_us += p->period_us;
    if (p->due_us < now_us) { /* what was missed is not made up for */
        p->due_us = now_us;
    }
}

static void on_period(evutil_socket_t fd, short what, void *ctx)
{
    pair *p = ctx;
    grobo_posture wanted;
    (void)fd;
    (void)what;
    if (p->error || p->follower.c.trip.trip != GROBO_TRIP_NONE || p->follower.c.signal) {
        return;
    }
    note_late(p);
    bool there = read_leader(p, &wanted);
    if (!there) {
        p->limp = false;
        become(p, IS_LOST);
        return;
    }
    let_limp(p);
    if (p->limp) {
        follow(p, &wanted);
    }
}

static bool is_over(conn *c)
{
    const pair *p = c->ctx;
    return p->error || c->trip.trip != GROBO_TRIP_NONE ||
           p->leader.c.trip.trip != GROBO_TRIP_NONE || (p->end_us && grobo_now_us() >= p->end_us);
}

static int lead(pair *p)
{
    conn *c = &p->follower.c;
    double s = app_number(p->a, OPT_FOR, 0);
    p->began_us = grobo_now_us();
    p->due_us = p->began_us + p->period_us;
    p->end_us = s > 0 ? p->began_us + (int64_t)(s * 1e6) : 0;
    struct event *timer = conn_every(c->base, p->period_us, on_period, p);
    int error = timer ? conn_wait_until(c, is_over) : GROBO_ERR_NOMEM;
    conn_forget(timer);
    report(p);
    if (!error && p->leader.c.trip.trip != GROBO_TRIP_NONE) {
        return conn_fail(&p->leader.c, GROBO_ERR_LATCHED, "follow: leader");
    }
    if (!error && c->trip.trip != GROBO_TRIP_NONE) {
        error = GROBO_ERR_LATCHED;
    }
    error = error ? error : p->error;
    c->moving = error < 0;
    return error ? conn_fail(c, error, "follow") : EXIT_DONE;
}

/* ---- before ---------------------------------------------------------------------------------- */

/* "so101@/dev/ttyACM1", or a device alone, which is of --robot. */
static int choose(side *s, const app *a, const char *word)
{
    const char *at = strchr(word, '@');
    s->a = *a;
    s->a.line.global[GLOBAL_DEVICE] = (cli_value){.given = 1, .text = at ? at + 1 : word};
    if (at && (size_t)(at - word) < sizeof s->robot) {
        memcpy(s->robot, word, (size_t)(at - word));
        s->a.line.global[GLOBAL_ROBOT] = (cli_value){.given = 1, .text = s->robot};
    }
    return robot_choose(&s->a);
}

/* Joints that have the same name and are no wheels; the others stay as they are. */
static int match(pair *p)
{
    const grobo_model *leader = app_model(&p->leader.a), *follower = app_model(&p->follower.a);
    for (int j = 0; j < follower->n_joints; j++) {
        const char *name = follower->joints[j].name;
        int joint = grobo_model_find_joint(leader, name, strlen(name));
        if ((grobo_model_wheels(follower) & GROBO_JOINT_BIT(j)) != 0 ||
            (joint >= 0 && (grobo_model_wheels(leader) & GROBO_JOINT_BIT(joint)) != 0)) {
            joint = -1;
        }
        p->of[j] = joint >= 0 ? joint : -1;
        p->joints |= joint >= 0 ? GROBO_JOINT_BIT(j) : 0;
    }
    int n = grobo_joints_count(p->joints);
    if (n == 0) {
        return app_fail(p->a, EXIT_USAGE, "NOTFOUND",
                        "follow: no joint of %s has the name of one of %s", leader->name,
                        follower->name);
    }
    if (n < follower->n_joints || n < leader->n_joints) {
        app_note(p->a, "%d joint%s of %s follow%s %s; others stay as they are", n,
                 n == 1 ? "" : "s", follower->name, n == 1 ? "s" : "", leader->name);
    }
    return 0;
}

static int open_follower(pair *p)
{
    conn *c = &p->follower.c;
    p->follower.is_open = true;
    int status = conn_open_to_move(c, &p->follower.a);
    if (status) {
        return status;
    }
    c->ctx = p;
    int error = conn_sense(c, p->joints, GROBO_SENSE_ALL);
    return error ? conn_fail(c, error, "follow") : 0;
}

/* Its angles alone are read: a limp arm has no heat, and lost readings are no reason to stop. */
static int open_leader(pair *p)
{
    conn *c = &p->leader.c;
    grobo_joint_mask all = GROBO_JOINTS_ALL(app_model(&p->leader.a)->n_joints);
    p->leader.a.reconnects = true;
    p->leader.is_open = true;
    int status = conn_open_beside(c, &p->leader.a, p->follower.c.link);
    if (status) {
        return status;
    }
    c->ctx = p;
    app_note(p->a, "torque of the leader goes off: hold it; what is raised falls");
    int error = conn_sense(c, all, GROBO_SENSE_ALL);
    if (!error) {
        error = conn_wait(c, grobo_robot_torque(c->robot, all, GROBO_TORQUE_OFF));
    }
    if (error) {
        return conn_fail(c, error, "follow: leader");
    }
    grobo_robot_config config = conn_robot_config(&p->leader.a);
    config.bus.baud_bps = conn_baud(&p->leader.a);
    config.sense_interval_us = p->period_us;
    config.sense_position_only = true;
    config.lost_replies = -1;
    (void)grobo_session_configure(c->session, &config);
    p->limp = true;
    c->on_event = on_leader;
    return 0;
}

/* Each joint holds where it is. */
static int hold(pair *p)
{
    conn *c = &p->follower.c;
    c->moving = true;
    int error = conn_wait(c, grobo_robot_torque(c->robot, p->joints, GROBO_TORQUE_ON));
    if (error) {
        return conn_fail(c, error, "follow");
    }
    grobo_robot_posture(c->robot, GROBO_NEVER_US, &p->now);
    p->now.set &= p->joints;
    grobo_posture_clamp(&p->now, conn_model(&p->follower.c));
    return 0;
}

static int close_both(pair *p, int status)
{
    int failed = EXIT_DONE;
    if (p->leader.is_open) {
        p->leader.c.moving = true; /* so that it is left by its own policy */
        p->leader.c.signal = 0;
        p->leader.a.line.global[GLOBAL_ON_EXIT].given = 0;
        failed = conn_close(&p->leader.c, status ? status : EXIT_SIGNAL);
        failed = failed == EXIT_SIGNAL ? EXIT_DONE : failed;
    }
    if (p->follower.is_open) {
        status = conn_close(&p->follower.c, status ? status : failed);
        p->a->traced = p->follower.a.traced;
    }
    return status;
}

static int run(app *a)
{
    static pair p;
    memset(&p, 0, sizeof p);
    p.a = a;
    p.period_us = (int64_t)(1e6 / app_number(a, OPT_RATE, RATE_HZ));
    if (a->link) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "follow: a shell has one robot; use 'grctl follow' by itself");
    }
    int status = realtime_begin(a, OPT_REALTIME);
    if (!status) {
        status = choose(&p.leader, a, a->line.argument[0]);
    }
    if (!status) {
        status = choose(&p.follower, a, a->line.argument[1]);
    }
    if (!status) {
        status = match(&p);
    }
    p.leader.a.line.global[GLOBAL_TRACE] = (cli_value){.text = NULL}; /* it is the follower's */
    if (!status) {
        status = open_follower(&p);
    }
    if (!status) {
        status = open_leader(&p);
    }
    if (!status) {
        status = hold(&p);
    }
    return close_both(&p, status ? status : lead(&p));
}

const cli_command cmd_follow = {
    .name = "follow",
    COMMAND_ARGUMENTS("LEADER FOLLOWER", 2, 2, CLI_ARG_DEVICE),
    .summary = "let one arm follow another that a hand moves",
    .details =
        "LEADER and FOLLOWER are ROBOT@DEVICE, such as so101-leader@/dev/ttyACM0; a device alone\n"
        "is one of --robot. Joints go by their names; those without a partner stay as they\n"
        "are.\n"
        "\n"
        "The torque of the leader goes off. The follower goes softly to where the leader is,\n"
        "then it is sent where to be a hundred times a second: within its own limits, and no\n"
        "faster than its joints can. A leader that is suddenly somewhere else is approached\n"
        "softly again. While nothing was read of the leader for 0.2 s the follower holds; the\n"
        "leader may be unplugged and plugged in again. A safety stop of the follower ends it.\n"
        "Ctrl-C ends it, and leaves both by their exit policies.\n",
    .example = "  grctl follow so101-leader@/dev/ttyACM0 so101@/dev/ttyACM1\n"
               "  grctl follow so101-leader@sim so101@sim --for 5\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
