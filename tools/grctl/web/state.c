/* SPDX-License-Identifier: MIT */
/* The robot as it is, and as it is made. */
#include <math.h>
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/version.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/view/render.h"
#include "tools/grctl/web/pose.h"
#include "tools/grctl/web/serve.h"

/* The poses from which a motion's ZMP is taken are so far apart. */
#define ZMP_STEP_US INT64_C(20000)

/* ---- as it is -------------------------------------------------------------------------------- */

static bool has(const grobo_joint_info *i, grobo_field field)
{
    return (i->state.valid & field) != 0;
}

static json_t *whole_or_null(bool known, long value)
{
    return known ? json_integer(value) : json_null();
}

/* Lists by joint: {"angle_deg": [...], ...}. */
static void add_joints(serve *s, json_t *state)
{
    static const char *const names[] = {"angle_deg",  "target_deg",    "torque",
                                        "current_ma", "temperature_c", "voltage_v",
                                        "speed_dps",  "age_ms",        "status"};
    enum { N = sizeof names / sizeof names[0] };
    json_t *lists[N];
    for (int k = 0; k < N; k++) {
        lists[k] = json_array();
        json_object_set_new(state, names[k], lists[k]);
    }
    for (int j = 0; j < s->model->n_joints; j++) {
        grobo_joint_info i;
        double target_rad;
        grobo_robot_joint(s->c.robot, j, &i);
        bool fresh = i.angle_age_us != GROBO_NEVER_US, targeted = render_target(&i, &target_rad);
        json_t *values[N] = {
            app_json_number(fresh ? grobo_deg_from_rad(i.state.angle_rad) : NAN, 1),
            app_json_number(targeted ? grobo_deg_from_rad(target_rad) : NAN, 1),
            i.torque_known ? json_string(render_torque(&i)) : json_null(),
            whole_or_null(has(&i, GROBO_FIELD_CURRENT), i.state.current_ma),
            whole_or_null(has(&i, GROBO_FIELD_TEMPERATURE), i.state.temperature_c),
            app_json_number(has(&i, GROBO_FIELD_VOLTAGE) ? i.state.voltage_mv / 1e3 : NAN, 2),
            whole_or_null(has(&i, GROBO_FIELD_SPEED), i.state.speed_dps),
            whole_or_null(fresh, fresh ? (long)(i.angle_age_us / 1000) : 0),
            app_json_code(grobo_error_name(i.status))};
        for (int k = 0; k < N; k++) {
            json_array_append_new(lists[k], values[k]);
        }
    }
}

/* Joints that cannot move because of how their servos are set up, each with the reason. */
static json_t *setups_json(serve *s)
{
    json_t *list = json_array();
    for (int j = 0; j < s->model->n_joints; j++) {
        json_t *why = render_setup_json(&s->c, j);
        if (why) {
            json_object_set_new(why, "joint", json_integer(j));
            json_array_append_new(list, why);
        }
    }
    return list;
}

static json_t *line_json(serve *s)
{
    grobo_robot_counters n;
    grobo_jitter jitter;
    uint64_t tx_bytes, rx_bytes;
    json_t *line = conn_link_json(&s->c);
    conn_counters(&s->c, &n);
    grobo_session_bytes(s->c.session, &tx_bytes, &rx_bytes);
    grobo_robot_jitter(s->c.robot, &jitter);
    json_t *more = json_pack(
        "{s:I,s:I,s:I,s:I,s:I,s:I,s:I,s:{s:I,s:I,s:I,s:I},s:o,s:o}", "tx_bytes",
        (json_int_t)tx_bytes, "rx_bytes", (json_int_t)rx_bytes, "motion_frames",
        (json_int_t)n.motion_frames, "late_frames", (json_int_t)n.late_frames, "clamped",
        (json_int_t)n.clamped, "stretched", (json_int_t)n.stretched, "stalls", (json_int_t)n.stalls,
        "jitter_us", "frames", (json_int_t)jitter.frames, "p50", (json_int_t)jitter.p50_us, "p99",
        (json_int_t)jitter.p99_us, "max", (json_int_t)jitter.max_us, "load_pct",
        app_json_number(s->load_pct, 1), "load_hz", app_json_number(s->load_hz, 1));
    json_object_update_new(line, more);
    return line;
}

/* Of the motion that is played: at its angles, on one and the same foot. */
static bool zmp_of_motion(serve *s, const grobo_body_stand *now, double zmp_m[3])
{
    grobo_transform root[3];
    double angles[3][GROBO_JOINTS_MAX];
    const double *const q_rad[3] = {angles[0], angles[1], angles[2]};
    for (int i = 0; i < 3; i++) {
        grobo_posture posture;
        grobo_body_stand stood;
        if (!player_at(s, (i - 1) * ZMP_STEP_US, &posture) || !pose_stand(s->a, &posture, &stood) ||
            stood.foot != now->foot) {
            return false;
        }
        for (int j = 0; j < s->model->n_joints; j++) {
            bool set = (posture.set & GROBO_JOINT_BIT(j)) != 0;
            angles[i][j] = set ? posture.angle_rad[j] : grobo_model_joint(s->model, j)->init_rad;
        }
        root[i] = stood.root;
    }
    return grobo_body_zmp_of_poses(pose_body(s->a), root, q_rad, (double)ZMP_STEP_US / 1e6,
                                   zmp_m) == GROBO_OK;
}

static json_t *body_json(serve *s)
{
    grobo_posture posture;
    grobo_body_stand stood;
    double zmp_m[3];
    grobo_robot_posture(s->c.robot, GROBO_NEVER_US, &posture);
    if (posture.set != GROBO_JOINTS_ALL(s->model->n_joints) ||
        !pose_stand(s->a, &posture, &stood)) {
        return json_null();
    }
    bool tilted = tilt_apply(s, &posture, &stood);
    return pose_stand_json(&stood, !tilted && zmp_of_motion(s, &stood, zmp_m) ? zmp_m : NULL);
}

static json_t *page_json(serve *s, const lease_page *page)
{
    return *page->secret ? json_pack("{s:o,s:s,s:I}", "name", app_json_text(page->name), "id",
                                     page->id, "since_ms", (json_int_t)serve_ms(s, page->since_us))
                         : json_null();
}

static const char *job_word(grobo_job_kind kind)
{
    static const char *const words[] = {NULL,   "check", "sense",     "torque",  "move",
                                        "play", "raw",   "registers", "command", "stored",
                                        "exit", "estop", NULL};
    return words[kind];
}

static const char *link_word(const serve *s)
{
    return s->c.up                                                          ? "up"
           : grobo_session_get_state(s->c.session) == GROBO_SESSION_WAITING ? "lost"
                                                                            : "opening";
}

json_t *serve_state_json(serve *s)
{
    json_t *state = json_pack("{s:I,s:I,s:s}", "sequence", (json_int_t)s->based.sequence, "time_ms",
                              (json_int_t)serve_ms(s, grobo_now_us()), "link", link_word(s));
    const char *job = job_word(grobo_robot_job(s->c.robot));
    add_joints(s, state);
    json_t *more = json_pack(
        "{s:o,s:o,s:b,s:s?,s:o,s:o,s:o,s:o,s:o,s:{s:o,s:o},s:i}", "limp", joints_json(s->limp),
        "setup", setups_json(s), "moving", grobo_robot_moving(s->c.robot), "job", job, "play",
        player_json(s), "stop", stops_json(s), "line", line_json(s), "imu", tilt_json(s), "body",
        body_json(s), "lease", "holder", page_json(s, &s->lease.holder), "asked",
        page_json(s, &s->lease.asker), "clients", http_streams(s->http));
    json_object_update_new(state, more);
    return state;
}

/* ---- as it is made --------------------------------------------------------------------------- */

static json_t *number(double value)
{
    return app_json_number(value, 6);
}

static json_t *joint_json(const grobo_model *model, int j)
{
    const grobo_joint *joint = grobo_model_joint(model, j);
    json_t *row = json_pack(
        "{s:i,s:i,s:s,s:[o,o],s:o,s:o,s:o,s:i,s:i}", "joint", j, "motor", joint->motor, "name",
        joint->name, "limits_deg", app_json_number(grobo_deg_from_rad(joint->min_rad), 3),
        app_json_number(grobo_deg_from_rad(joint->max_rad), 3), "init_deg",
        app_json_number(grobo_deg_from_rad(joint->init_rad), 3), "max_speed_dps",
        app_json_number(grobo_deg_from_rad(joint->max_speed_rad_s), 1), "groups",
        joints_groups_json(model, j), "mirror", joint->mirror, "mirror_sign",
        joint->mirror_sign < 0 ? -1 : 1);
    if (joint->ratio != 0) {
        json_object_set_new(row, "follows", json_integer(joint->follows));
        json_object_set_new(row, "ratio", number(joint->ratio));
    }
    if (joint->wheel) {
        json_object_set_new(row, "wheel", json_true());
    }
    joints_add_scale(row, model, j);
    return row;
}

static json_t *all_joints_json(const grobo_model *model)
{
    json_t *list = json_array();
    for (int j = 0; j < model->n_joints; j++) {
        json_array_append_new(list, joint_json(model, j));
    }
    return list;
}

static json_t *groups_json(const grobo_model *model)
{
    json_t *list = json_array();
    for (int g = 0; g < model->n_groups; g++) {
        json_array_append_new(list, json_pack("{s:s,s:o}", "name", model->groups[g].name, "joints",
                                              joints_json(model->groups[g].joints)));
    }
    return list;
}

static json_t *safety_json(const grobo_safety_limits *l)
{
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o}", "temperature_c", number(l->temperature_c),
                     "current_ma", number(l->current_ma), "current_ms",
                     number((double)l->current_us / 1e3), "voltage_mv", number(l->voltage_mv),
                     "lost_replies", number(l->lost_replies), "approach_dps",
                     number(grobo_deg_from_rad(l->approach_rad_s)));
}

static json_t *budget_json(serve *s)
{
    grobo_budget budget = {0};
    (void)grobo_robot_budget(s->c.robot, &budget);
    return json_pack("{s:i,s:i,s:i}", "default_hz", budget.default_hz, "watched_hz",
                     budget.watched_hz, "max_hz",
                     budget.motion_us ? (int)(1000000 / budget.motion_us) : 0);
}

static const char *wiring_word(const serve *s)
{
    const cli_value *asked = app_global(s->a, GLOBAL_WIRING);
    int wiring = asked->given ? asked->choice : (int)robot_of(s->a)->wiring;
    return wiring == GROBO_WIRING_BUS ? "bus" : "board";
}

static const char *exit_word(const serve *s)
{
    static const char *const words[] = {"hold", "off", "hold", "sit"};
    const cli_value *asked = app_global(s->a, GLOBAL_ON_EXIT);
    return words[asked->given ? asked->choice + GROBO_EXIT_OFF
                              : (int)grobo_robot_driver(s->c.robot)->on_exit];
}

json_t *serve_robot_json(serve *s)
{
    const grobo_robot_def *def = robot_of(s->a);
    const grobo_driver *driver = grobo_robot_driver(s->c.robot);
    json_t *robot =
        json_pack("{s:i,s:s,s:s,s:s,s:s,s:s,s:o,s:b,s:b,s:s,s:i}", "interface", 1, "version",
                  grobo_version(), "name", def->name, "title", def->title, "model", s->model->name,
                  "family", def->family->name, "device", app_json_text(conn_device(&s->c)),
                  "simulator", grobo_session_sim(s->c.session) != NULL, "arm", def->arm, "wiring",
                  wiring_word(s), "baud_bps", (int)conn_baud(s->a));
    json_t *more = json_pack(
        "{s:o,s:o,s:o,s:o,s:o,s:s,s:o,s:i,s:o,s:b,s:{s:i,s:i,s:i,s:i,s:i}}", "joints",
        all_joints_json(s->model), "groups", groups_json(s->model), "links", pose_links_json(s->a),
        "body", pose_feet_json(s->a), "safety", safety_json(&driver->limits), "exit", exit_word(s),
        "budget", budget_json(s), "stop_port", http_stop_port(s->http), "state_hz", number(30),
        "token", http_is_open(s->http), "lease", "heartbeat_ms", SERVE_HEARTBEAT_MS, "jog_lost_ms",
        (int)(SERVE_JOG_LOST_US / 1000), "play_lost_ms", (int)(SERVE_PLAY_LOST_US / 1000), "ask_ms",
        (int)(LEASE_ASK_US / 1000), "stale_ms", (int)(BASED_STALE_US / 1000));
    json_object_update_new(robot, more);
    return robot;
}
