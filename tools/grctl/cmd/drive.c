/* SPDX-License-Identifier: MIT */
/*
 * drive: wheels turn at speeds for a time. Torque comes on first. Every 100 ms the speeds are asked
 * for again; then 0 leads the wheels to rest, and they are read until they stand. Whatever ends it
 * sooner leaves them by the exit policy, which stops them.
 */
#include <math.h>
#include <string.h>

#include <grobo/core/wheel.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/conn/conn.h"

enum { OPT_FOR };
enum { PERIOD_US = 100000, STAND_US = 5000000 };

static const cli_option options[] = {
    [OPT_FOR] = OPTION_REAL("for", 0, "S", 0.1, 3600, "for so long (1)"),
};

typedef struct drive {
    conn c;
    grobo_joint_mask wheels;
    double rad_s[GROBO_JOINTS_MAX], seen_dps[GROBO_JOINTS_MAX];
    int64_t end_us; /* they are led to rest then */
    int error;
} drive;

/* ---- what is asked for ----------------------------------------------------------------------- */

static int refuse_joint(app *a, int joint)
{
    const grobo_model *model = app_model(a);
    return grobo_model_wheels(model) == 0
               ? app_fail(a, EXIT_USAGE, "ARG",
                          "drive: %s has no wheels; 'type: wheel' in its file makes a joint one",
                          model->name)
               : app_fail(a, EXIT_USAGE, "ARG", "drive: %s is not a wheel; use 'grctl move'",
                          grobo_model_joint(model, joint)->name);
}

static int take_joint(drive *d, app *a, int joint, double dps)
{
    const grobo_joint *wheel = grobo_model_joint(app_model(a), joint);
    double most_dps = grobo_deg_from_rad(wheel->max_speed_rad_s);
    if ((grobo_model_wheels(app_model(a)) & GROBO_JOINT_BIT(joint)) == 0) {
        return refuse_joint(a, joint);
    }
    if (d->wheels & GROBO_JOINT_BIT(joint)) {
        return app_fail(a, EXIT_USAGE, "ARG", "drive: %s is there twice", wheel->name);
    }
    if (fabs(dps) > most_dps * (1 + 1e-9)) {
        return app_fail(a, EXIT_SAFETY, "LIMIT",
                        "drive: %s at %.1f deg/s is above its limit of %.1f deg/s", wheel->name,
                        dps, most_dps);
    }
    d->wheels |= GROBO_JOINT_BIT(joint);
    d->rad_s[joint] = grobo_rad_from_deg(dps);
    return 0;
}

/* "left=90", "wheels=-45" */
static int take_word(drive *d, app *a, const char *word)
{
    char name[GROBO_NAME_MAX_BYTES];
    const char *names[] = {name};
    size_t length = strcspn(word, "=");
    grobo_joint_mask joints;
    double dps;
    if (word[length] != '=' || length >= sizeof name || !cli_read_number(word + length + 1, &dps)) {
        return app_fail(a, EXIT_USAGE, "ARG", "drive: '%s' is not WHEEL=DEG/S", word);
    }
    memcpy(name, word, length);
    name[length] = '\0';
    int status = joints_parse_all(a, 1, names, &joints);
    for (int j = 0; !status && j < app_model(a)->n_joints; j++) {
        status = joints & GROBO_JOINT_BIT(j) ? take_joint(d, a, j, dps) : 0;
    }
    return status;
}

/* ---- turning --------------------------------------------------------------------------------- */

static void ask(drive *d)
{
    static const double still[GROBO_JOINTS_MAX];
    bool over = grobo_now_us() >= d->end_us;
    int error = grobo_robot_drive(d->c.robot, d->wheels, over ? still : d->rad_s);
    d->error = d->error ? d->error : error;
    for (int j = 0; !over && j < conn_model(&d->c)->n_joints; j++) {
        grobo_joint_info info;
        if ((d->wheels & GROBO_JOINT_BIT(j)) && grobo_robot_joint(d->c.robot, j, &info) >= 0) {
            d->seen_dps[j] = info.state.speed_dps;
        }
    }
}

static void on_period(evutil_socket_t fd, short what, void *ctx)
{
    drive *d = ctx;
    (void)fd;
    (void)what;
    if (!d->error && d->c.trip.trip == GROBO_TRIP_NONE && !d->c.signal) {
        ask(d);
    }
}

static grobo_joint_mask standing(const drive *d)
{
    grobo_joint_mask stand = 0;
    for (int j = 0; j < conn_model(&d->c)->n_joints; j++) {
        grobo_wheel_info info;
        bool is = (d->wheels & GROBO_JOINT_BIT(j)) &&
                  grobo_robot_wheel(d->c.robot, j, &info) >= 0 && info.stands;
        stand |= is ? GROBO_JOINT_BIT(j) : 0;
    }
    return stand;
}

static bool is_over(conn *c)
{
    const drive *d = c->ctx;
    int64_t over_us = grobo_now_us() - d->end_us;
    return d->error || c->trip.trip != GROBO_TRIP_NONE ||
           (over_us > 0 && (standing(d) == d->wheels || over_us > STAND_US));
}

/* ---- what is said ---------------------------------------------------------------------------- */

static void report_json(const drive *d, double s, grobo_joint_mask stand)
{
    json_t *list = json_array();
    for (int j = 0; j < conn_model(&d->c)->n_joints; j++) {
        if (d->wheels & GROBO_JOINT_BIT(j)) {
            json_array_append_new(
                list, json_pack("{s:i,s:s,s:o,s:o,s:b}", "joint", j, "name",
                                grobo_model_joint(conn_model(&d->c), j)->name, "speed_dps",
                                app_json_number(grobo_deg_from_rad(d->rad_s[j]), 1), "read_dps",
                                app_json_number(d->seen_dps[j], 0), "stands",
                                (stand & GROBO_JOINT_BIT(j)) != 0));
        }
    }
    app_print_json(json_pack("{s:o,s:o}", "wheels", list, "for_s", app_json_number(s, 2)));
}

static int report(const drive *d, double s)
{
    app *a = d->c.a;
    grobo_joint_mask stand = standing(d);
    if (a->json) {
        report_json(d, s, stand);
    }
    for (int j = 0; j < conn_model(&d->c)->n_joints; j++) {
        const char *name = grobo_model_joint(conn_model(&d->c), j)->name;
        if (!(d->wheels & GROBO_JOINT_BIT(j))) {
            continue;
        }
        if (!(stand & GROBO_JOINT_BIT(j))) {
            return app_fail(a, EXIT_SAFETY, "TIMEOUT",
                            "drive: %s was not read to stand; 'grctl stop' tells it again", name);
        }
        if (!a->json) {
            app_note(a, "%s: %.1f deg/s for %.1f s, read at %.0f; it stands", name,
                     grobo_deg_from_rad(d->rad_s[j]), s, d->seen_dps[j]);
        }
    }
    return EXIT_DONE;
}

/* ---- the command ----------------------------------------------------------------------------- */

static int fail_wheel(drive *d, int error)
{
    double dps;
    int joint = grobo_robot_fault(d->c.robot, &dps);
    d->c.job.kind = GROBO_JOB_NONE;
    if (error == GROBO_ERR_STATE && joint >= 0) {
        return app_fail(d->c.a, EXIT_SAFETY, "STATE", "drive: %s has no torque",
                        grobo_model_joint(conn_model(&d->c), joint)->name);
    }
    return conn_fail(&d->c, error, "drive");
}

static int turn(drive *d, app *a)
{
    conn *c = &d->c;
    double s = app_number(a, OPT_FOR, 1);
    c->ctx = d;
    c->moving = true;
    int error = conn_wait(c, grobo_robot_torque(c->robot, d->wheels, GROBO_TORQUE_ON));
    if (error) {
        return conn_fail(c, error, "drive");
    }
    d->end_us = grobo_now_us() + (int64_t)(s * 1e6);
    ask(d);
    struct event *timer = conn_every(c->base, PERIOD_US, on_period, d);
    error = timer ? conn_wait_until(c, is_over) : GROBO_ERR_NOMEM;
    conn_forget(timer);
    error = error ? error : c->trip.trip != GROBO_TRIP_NONE ? GROBO_ERR_LATCHED : 0;
    if (error || d->error) {
        return error ? conn_fail(c, error, "drive") : fail_wheel(d, d->error);
    }
    int status = report(d, s);
    c->moving = status != EXIT_DONE;
    return status;
}

static int run(app *a)
{
    drive d;
    int status = 0;
    memset(&d, 0, sizeof d);
    for (int i = 0; i < a->line.n_arguments && !status; i++) {
        status = take_word(&d, a, a->line.argument[i]);
    }
    if (status) {
        return status;
    }
    status = conn_open_to_move(&d.c, a);
    return conn_close(&d.c, status ? status : turn(&d, a));
}

const cli_command cmd_drive = {
    .name = "drive",
    COMMAND_ARGUMENTS("WHEEL|GROUP=DEG/S...", 1, -1, CLI_ARG_JOINT),
    .summary = "turn wheels at speeds for a time",
    .details =
        "Turns wheels (joints with 'type: wheel' in the robot's file) at speeds in degrees a\n"
        "second, negative ones backwards, for 1 s or the time given, and leads them to rest.\n"
        "Torque comes on where it is off, at speed 0. A speed changes no faster than\n"
        "accel_deg_s2 of the wheel allows; one above speed_deg_s is refused with exit status 4.\n"
        "The command ends when the wheels were read to stand. Ctrl-C stops them at once, and so\n"
        "does the end of the program, however it comes.\n",
    .example = "  grctl --robot ./rover.yaml drive left=90 right=90 --for 2\n"
               "  grctl --robot ./rover.yaml drive wheels=-45\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
