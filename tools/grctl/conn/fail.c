/* SPDX-License-Identifier: MIT */
/*
 * Why something failed, in words: what, where, what to do; with -v the bytes of the failure, with
 * -vv all of them.
 */
#include <string.h>

#include <grobo/core/unit.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/wire.h"
#include "tools/grctl/lang/lang.h"

enum { HEX_BYTES = 1024 };

const char *conn_device(const conn *c)
{
    return grobo_session_device(c->session);
}

const grobo_model *conn_model(const conn *c)
{
    return grobo_robot_driver(c->robot)->model;
}

uint32_t conn_baud(const app *a)
{
    const cli_value *baud = app_global(a, GLOBAL_BAUD);
    return baud->given ? (uint32_t)baud->number : robot_of(a)->baud_bps;
}

/* ---- the bytes of the line ------------------------------------------------------------------ */

/* From -vv on, but not over a full screen. */
static void show_bytes(conn *c, char direction, int64_t at_us, const uint8_t *bytes, size_t size)
{
    char text[HEX_BYTES];
    if (c->a->verbosity < 2 || c->a->hushed || size == 0) {
        return;
    }
    if (!c->shown_us) {
        c->shown_us = at_us;
    }
    grobo_hex(bytes, size, text, sizeof text);
    output_complain("%10.3f  %c  %s\n", (double)(at_us - c->shown_us) / 1e3, direction, text);
}

void conn_show_answer(conn *c)
{
    const last_frame *last = last_frames_newest(&c->last);
    if (last) {
        show_bytes(c, '<', last->got_us, last->got, last->n_got);
    }
}

void conn_note_bytes(conn *c, grobo_direction direction, int64_t now_us, const uint8_t *bytes,
                     size_t size)
{
    if (direction == GROBO_DIR_TX) {
        conn_show_answer(c);
        show_bytes(c, '>', now_us, bytes, size);
    }
    last_frames_note(&c->last, direction, now_us, bytes, size);
}

/* ---- failures -------------------------------------------------------------------------------- */

/* What a trip's value is measured in. */
static const char *trip_unit(grobo_trip trip)
{
    switch (trip) {
    case GROBO_TRIP_TEMPERATURE:
    case GROBO_TRIP_OVERHEATED:
        return " deg C";
    case GROBO_TRIP_CURRENT:
        return " mA";
    case GROBO_TRIP_VOLTAGE:
        return " mV";
    case GROBO_TRIP_LOST_REPLIES:
        return _(" in a row");
    case GROBO_TRIP_LIMIT:
    case GROBO_TRIP_APART:
    case GROBO_TRIP_BLOCKED:
    case GROBO_TRIP_OVERLOAD:
        return " deg";
    case GROBO_TRIP_HOST_STALL:
        return _(" ms late");
    case GROBO_TRIP_NONE:
    case GROBO_TRIP_TORQUE_LOST:
    case GROBO_TRIP_NUMBER:
    case GROBO_TRIP_ESTOP:
        break;
    }
    return "";
}

void conn_trip_value(const grobo_trip_info *t, char *text, size_t text_bytes)
{
    /* A servo that cut its torque may not say how hot it is. One that a goal wakes is not sent the
     * next one where nothing came from it in time, though no reading of it was lost. */
    bool untold = t->value == 0 && t->trip == GROBO_TRIP_OVERHEATED;
    bool unheard = t->value == 0 && t->trip == GROBO_TRIP_LOST_REPLIES;
    text[0] = '\0';
    if (unheard) {
        snprintf(text, text_bytes, "%s", _(" (no answer in time)"));
    } else if (*trip_unit(t->trip) && !untold) {
        snprintf(text, text_bytes, " (%.4g%s)", t->value, trip_unit(t->trip));
    }
}

/* The engine has stopped by itself, c->trip says why. */
static int fail_trip(conn *c, const char *doing)
{
    const grobo_trip_info *t = &c->trip;
    const grobo_model *model = conn_model(c);
    char value[48], servo[JOINTS_SERVO_BYTES];
    conn_trip_value(t, value, sizeof value);
    if (t->joint >= 0 && t->joint < model->n_joints && t->trip == GROBO_TRIP_OVERHEATED) {
        return app_fail_trip(
            c->a, t->trip,
            "%s: stopped for safety: %s%s at motor %d (%s); let it cool down, then "
            "'grctl servo off %s'; if it is reported again, switch the power off "
            "and on",
            doing, _(grobo_trip_name(t->trip)), value, grobo_model_joint(model, t->joint)->motor,
            grobo_model_joint(model, t->joint)->name, joints_servo(c->a, t->joint, "m", servo));
    }
    if (t->joint >= 0 && t->joint < model->n_joints && t->trip == GROBO_TRIP_APART) {
        const grobo_joint *joint = grobo_model_joint(model, t->joint);
        const grobo_joint *first = grobo_model_joint(model, joint->follows);
        return app_fail_trip(
            c->a, t->trip,
            "%s: stopped for safety: %s%s: motor %d (%s) and motor %d (%s) share a shaft; "
            "check horns and gears, and calibrate both",
            doing, _(grobo_trip_name(t->trip)), value, first->motor, first->name, joint->motor,
            joint->name);
    }
    if (t->joint >= 0 && t->joint < model->n_joints && t->trip == GROBO_TRIP_BLOCKED) {
        return app_fail_trip(
            c->a, t->trip,
            "%s: stopped for safety: %s%s at motor %d (%s): it stands on its way; free it, and "
            "check that its payload is not too heavy",
            doing, _(grobo_trip_name(t->trip)), value, grobo_model_joint(model, t->joint)->motor,
            grobo_model_joint(model, t->joint)->name);
    }
    if (t->joint >= 0 && t->joint < model->n_joints && t->trip == GROBO_TRIP_OVERLOAD) {
        return app_fail_trip(
            c->a, t->trip,
            "%s: stopped for safety: %s%s at motor %d (%s): it sinks or was pushed away; take the "
            "payload or the hand away",
            doing, _(grobo_trip_name(t->trip)), value, grobo_model_joint(model, t->joint)->motor,
            grobo_model_joint(model, t->joint)->name);
    }
    if (t->joint >= 0 && t->joint < model->n_joints) {
        return app_fail_trip(c->a, t->trip, "%s: stopped for safety: %s%s at motor %d (%s)", doing,
                             _(grobo_trip_name(t->trip)), value,
                             grobo_model_joint(model, t->joint)->motor,
                             grobo_model_joint(model, t->joint)->name);
    }
    return app_fail_trip(c->a, t->trip, "%s: stopped for safety: %s%s", doing,
                         _(grobo_trip_name(t->trip)), value);
}

bool conn_is_of_reply(int error)
{
    return error == GROBO_ERR_TIMEOUT || error == GROBO_ERR_SHORT || error == GROBO_ERR_CHECKSUM ||
           error == GROBO_ERR_MISMATCH;
}

/* "no reply from WHO in 4.2 ms after 2 retries; ADVICE", and with -v the bytes. */
static int fail_reply(conn *c, int error, int id, const char *prefix, const char *who)
{
    last_try last =
        last_frames_to(&c->last, grobo_robot_driver(c->robot)->protocol, id, grobo_now_us());
    char took[48] = "", bytes[8 * LAST_FRAME_BYTES];
    int status;
    if (last.frame) {
        snprintf(took, sizeof took, _(" in %.1f ms after %d %s"), (double)last.took_us / 1e3,
                 last.attempts - 1, last.attempts == 2 ? _("retry") : _("retries"));
    }
    status =
        app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                 "%s: %s%s from %s%s; is its cable in? see 'grctl doctor'", conn_device(c), prefix,
                 error == GROBO_ERR_TIMEOUT ? _("no reply") : app_error_text(error), who, took);
    if (last.frame) {
        last_frames_text(last.frame, bytes, sizeof bytes);
        app_detail(c->a, "%s", bytes);
    }
    return status;
}

/* Of a register with a wrong value. */
static void setup_of_value(const conn *c, int joint, const grobo_setup_fault *fault, conn_setup *s)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    const int id = grobo_model_joint(driver->model, joint)->motor;
    char servo[JOINTS_SERVO_BYTES];
    const char *name = fault->reg->name;
    const bool calibrates = grobo_model_joint(driver->model, joint)->calibrated;
    const bool is_min = fault->reg->role == GROBO_ROLE_MIN_POSITION;
    const bool is_max = fault->reg->role == GROBO_ROLE_MAX_POSITION;
    const bool wheel = grobo_model_joint(driver->model, joint)->wheel;
    const int wanted = (int)(is_min ? fault->high : fault->low);
    snprintf(s->fact, sizeof s->fact, _("%s is %d, %d%s is wanted"), name, (int)fault->found,
             wanted,
             fault->low == fault->high ? ""
             : is_min                  ? _(" or less")
                                       : _(" or more"));
    snprintf(s->fix, sizeof s->fix, _("'grctl servo-set %s %s %d%s'%s"),
             joints_servo(c->a, joint, "", servo), name, wanted,
             family_servo(driver, id)->table->keeps == GROBO_KEEPS_LIMP ? "" : " --flash",
             calibrates && (is_min || is_max) ? _(" or 'grctl calibrate' sets it")
             : (is_min || is_max) && !wheel   ? _(" sets it, or narrow limits_deg")
             : fault->reg->role == GROBO_ROLE_OFFSET
                 ? _(" sets it, or say 'calibrated: true' in the robot file")
                 : _(" sets it"));
}

bool conn_setup_of(const conn *c, int joint, conn_setup *s)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    grobo_joint_info info;
    const grobo_setup_fault *fault = &info.state.setup;
    *s = (conn_setup){.fact = ""};
    if (grobo_robot_joint(c->robot, joint, &info) < 0 || info.status != GROBO_ERR_SETUP ||
        !fault->reg) {
        return false;
    }
    if (fault->low > fault->high) {
        snprintf(s->fact, sizeof s->fact,
                 _("its servo was never calibrated, %s is %d as from the factory"),
                 fault->reg->name, (int)fault->found);
        snprintf(s->fix, sizeof s->fix, "%s", _("'grctl calibrate' does it"));
    } else if (fault->reg->role == GROBO_ROLE_MODEL) {
        const grobo_servo_model *servo =
            family_servo(driver, grobo_model_joint(driver->model, joint)->motor);
        const grobo_servo_model *other = family_numbered(driver, (uint16_t)fault->found);
        snprintf(s->fact, sizeof s->fact, _("its servo is %s (%d), not %s (%d)"),
                 other ? other->name : _("another"), (int)fault->found, servo->name, servo->number);
        snprintf(s->fix, sizeof s->fix, "%s", _("say so in the robot file"));
    } else {
        setup_of_value(c, joint, fault, s);
    }
    if (fault->more) {
        size_t used = strlen(s->fact);
        snprintf(s->fact + used, sizeof s->fact - used,
                 fault->more == 1 ? _(", and %d more register is wrong")
                                  : _(", and %d more registers are wrong"),
                 fault->more);
    }
    return true;
}

static int fail_setup(conn *c, int joint, const char *prefix, const char *who)
{
    conn_setup s;
    const char *name = grobo_error_name(GROBO_ERR_SETUP);
    if (!conn_setup_of(c, joint, &s)) {
        return app_fail(c->a, app_status_of(GROBO_ERR_SETUP), name, "%s: %s%s: %s", conn_device(c),
                        prefix, who, grobo_error_text(GROBO_ERR_SETUP));
    }
    return app_fail(c->a, app_status_of(GROBO_ERR_SETUP), name, "%s: %s%s: %s; %s", conn_device(c),
                    prefix, who, s.fact, s.fix);
}

/* Where its servo keeps a narrower range than the robot's file, the file is not what was hit. */
static int fail_limit(conn *c, int joint, const char *prefix, const char *who)
{
    grobo_joint_info info;
    if (grobo_robot_joint(c->robot, joint, &info) < 0 || !(info.state.valid & GROBO_FIELD_RANGE)) {
        return app_fail_error(c->a, app_status_of(GROBO_ERR_LIMIT), GROBO_ERR_LIMIT, "%s: %s%s",
                              conn_device(c), prefix, who);
    }
    return app_fail(c->a, app_status_of(GROBO_ERR_LIMIT), grobo_error_name(GROBO_ERR_LIMIT),
                    "%s: %s%s: outside its limits; it was calibrated to go from %.0f to %.0f %s",
                    conn_device(c), prefix, who,
                    grobo_model_value(conn_model(c), joint, info.state.low_rad),
                    grobo_model_value(conn_model(c), joint, info.state.high_rad),
                    grobo_unit_name(grobo_model_unit(conn_model(c), joint)));
}

/* It goes where another program has sent it, or falls. */
static int fail_adrift(conn *c, const char *prefix, const char *who)
{
    return app_fail(c->a, app_status_of(GROBO_ERR_STATE), grobo_error_name(GROBO_ERR_STATE),
                    "%s: %s%s moves, and not by this program: wait, or 'grctl stop'",
                    conn_device(c), prefix, who);
}

int conn_fail_job(conn *c, int error, const char *prefix)
{
    const grobo_driver *driver = grobo_robot_driver(c->robot);
    const grobo_model *model = conn_model(c);
    int rate_bps, joint = c->job.kind == GROBO_JOB_NONE ? -1 : c->job.joint;
    char who[64];
    if (error == GROBO_ERR_UNWATCHED && wire_is_slow(driver, (int)conn_baud(c->a), &rate_bps)) {
        return app_fail(c->a, EXIT_SAFETY, grobo_error_name(error), "%s: %s%s", conn_device(c),
                        prefix, wire_slow_text(driver, (int)conn_baud(c->a), rate_bps));
    }
    if (joint < 0 || joint >= model->n_joints) {
        return app_fail(c->a, app_status_of(error), grobo_error_name(error), "%s: %s%s",
                        conn_device(c), prefix, app_error_text(error));
    }
    snprintf(who, sizeof who, _("motor %d (%s)"), grobo_model_joint(model, joint)->motor,
             grobo_model_joint(model, joint)->name);
    if (conn_is_of_reply(error) && c->job.failed == GROBO_JOINTS_ALL(model->n_joints)) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error),
                        "%s: %sno servo answers; are they powered? see 'grctl doctor'",
                        conn_device(c), prefix);
    }
    if (conn_is_of_reply(error)) {
        return fail_reply(c, error, grobo_model_joint(model, joint)->motor, prefix, who);
    }
    if (error == GROBO_ERR_SETUP) {
        return fail_setup(c, joint, prefix, who);
    }
    if (error == GROBO_ERR_LIMIT) {
        return fail_limit(c, joint, prefix, who);
    }
    if (error == GROBO_ERR_STATE) {
        return fail_adrift(c, prefix, who);
    }
    return app_fail_error(c->a, app_status_of(error), error, "%s: %s%s", conn_device(c), prefix,
                          who);
}

int conn_fail(conn *c, int error, const char *doing)
{
    char prefix[64];
    if (c->signal && !c->a->stops) {
        return EXIT_SIGNAL + c->signal;
    }
    if (c->link_error == GROBO_ERR_STALLED) {
        return app_fail_trip(
            c->a, GROBO_TRIP_HOST_STALL,
            "%s: stopped for safety: host stalled: grctl was stopped or held up, or did not obey "
            "an emergency stop, and the guard stopped the robot",
            doing);
    }
    if (c->link_error) {
        return app_fail(c->a, EXIT_ROBOT, grobo_error_name(error), "%s: %s while busy with %s",
                        conn_device(c), app_error_text(error), doing);
    }
    if (c->trip.trip != GROBO_TRIP_NONE) {
        return fail_trip(c, doing);
    }
    snprintf(prefix, sizeof prefix, "%s: ", doing);
    return conn_fail_job(c, error, conn_is_of_reply(error) ? "" : prefix);
}

int conn_fail_servo(conn *c, int error, int id)
{
    char who[32];
    if ((c->signal && !c->a->stops) || c->link_error) {
        return conn_fail(c, error, "servo");
    }
    snprintf(who, sizeof who, _("servo %d"), id);
    if (conn_is_of_reply(error)) {
        return fail_reply(c, error, id, "", who);
    }
    return app_fail_error(c->a, app_status_of(error), error, "%s: %s", conn_device(c), who);
}

int conn_link_news(conn_link *link, app *a)
{
    conn c = {.a = a, .link = link, .session = link->session, .trip = link->trip};
    int status = EXIT_DONE;
    if (!link->news || !c.session) {
        return EXIT_DONE;
    }
    link->news = false;
    link->trip = (grobo_trip_info){.trip = GROBO_TRIP_NONE};
    c.robot = grobo_session_robot(c.session);
    if (c.trip.trip != GROBO_TRIP_NONE) {
        status = fail_trip(&c, conn_device(&c));
    }
    if (link->link_error) {
        status = app_fail_error(a, EXIT_ROBOT, link->link_error, "%s", conn_device(&c));
    }
    return status;
}
