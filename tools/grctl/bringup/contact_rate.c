/* SPDX-License-Identifier: MIT */
/*
 * First contact, another baud rate and back: docs/simulator.md assumes that servos take one at
 * once, and RS30x when they restart. A servo is limp meanwhile, signals wait until it is back at
 * its old rate, and how a servo that is lost is found again is said before anything is written.
 */
#include <string.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/bringup/contact_rate.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/conn/change.h"
#include "tools/grctl/conn/eeprom.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"

enum { TRIES = 5 /* a reply may be lost */ };

/* What became of it. */
typedef struct outcome {
    int32_t before; /* the register */
    int there_bps;  /* where it answered after it was written, or an error */
    int back_bps;   /* and after it was written back */
} outcome;

/* The next lower rate that servo and line have, else the next higher one: its code; -1: none. */
static int32_t another_rate(const servo_change *what, int old_bps)
{
    int32_t best = -1;
    int best_bps = 0;
    for (int32_t code = what->reg->min; code <= what->reg->max; code++) {
        int bps = grobo_servo_baud_bps(what->servo, code);
        bool lower = bps < old_bps;
        bool better = best < 0 || (lower && (best_bps > old_bps || bps > best_bps)) ||
                      (!lower && best_bps > old_bps && bps < best_bps);
        if (bps > 0 && bps != old_bps && better) {
            best = code;
            best_bps = bps;
        }
    }
    return best;
}

static bool keeps_by_command(const servo_change *what)
{
    return what->servo->table->keeps == GROBO_KEEPS_COMMAND;
}

static void say_how_to_find(const contact *k, const servo_change *what, int old_bps)
{
    app_note(k->a,
             "if the servo is lost: switch its power off and on; then 'grctl -d %s scan --all-baud "
             "--first %d --last %d' finds it, and 'grctl -d %s -b RATE servo-set %d baud %d "
             "--flash' restores its rate",
             conn_requested(k->a), what->id, what->id, conn_requested(k->a), what->id, old_bps);
}

/* A joint that was not read since its last setting is written nothing. */
static int change(contact *k, const servo_change *what, int line_bps, int32_t *code)
{
    grobo_joint_info is;
    int error = contact_sense(k, &is);
    return error ? error : change_rate(&k->c, what, line_bps, code);
}

/* There and back, at the line of old_bps. The way back is tried whatever has happened. */
static int change_and_back(contact *k, const servo_change *there, int old_bps, outcome *is)
{
    conn *c = &k->c;
    servo_change back = *there;
    int32_t code = 0;
    int error = servos_get(c, there->id, there->servo, there->reg, &is->before);
    if (error) {
        return error;
    }
    back.value = is->before;
    int at_bps = is->there_bps = change(k, there, old_bps, &code);
    for (int i = 0; i < TRIES && !c->link_error; i++) {
        at_bps =
            i || at_bps < 0 ? change_find(c, there, change_bps(there), old_bps, &code) : at_bps;
        if (at_bps == old_bps && code == is->before) {
            break;
        }
        at_bps = at_bps < 0 ? at_bps : change(k, &back, at_bps, &code);
    }
    is->back_bps = at_bps == old_bps && code != is->before ? GROBO_ERR_MISMATCH : at_bps;
    error = change_tune(c, old_bps);
    return c->link_error ? c->link_error : error;
}

static int judge(contact *k, const char *name, const servo_change *there, int old_bps,
                 const outcome *is)
{
    int assumed_bps = there->flash || !keeps_by_command(there) ? change_bps(there) : old_bps;
    if (is->there_bps < 0 && is->back_bps == old_bps) {
        contact_note(k, name, NOT_AS_ASSUMED, "servo %d, set to %d bps: %s; it is back at %d",
                     there->id, change_bps(there), app_error_text(is->there_bps), old_bps);
        return EXIT_DONE;
    }
    if (is->back_bps != old_bps) {
        say_how_to_find(k, there, old_bps);
        contact_note(k, name, NOT_AS_ASSUMED, "servo %d is not back at %d bps: %s", there->id,
                     old_bps, is->back_bps < 0 ? app_error_text(is->back_bps) : "?");
        return EXIT_ROBOT;
    }
    contact_note(k, name, is->there_bps == assumed_bps ? AS_ASSUMED : NOT_AS_ASSUMED,
                 "servo %d, set to %d bps, answers at %d, and again at %d", there->id,
                 change_bps(there), is->there_bps, is->back_bps);
    return EXIT_DONE;
}

static bool is_limp(contact *k, int *error)
{
    grobo_joint_info is;
    *error = contact_sense(k, &is);
    return !*error && (is.state.valid & GROBO_FIELD_TORQUE) != 0 &&
           is.state.torque == GROBO_TORQUE_OFF;
}

/* The line is open. */
static int try_rate(contact *k, const char *name, const servo_change *there, int old_bps)
{
    outcome is = {0};
    char servo[JOINTS_SERVO_BYTES];
    int error;
    bool limp = is_limp(k, &error);
    if (error) {
        return conn_fail_servo(&k->c, error, there->id);
    }
    if (!limp) {
        contact_note(k, name, NOT_DONE, "the joint holds; first: grctl servo off %s",
                     joints_servo_of(k->a, there->id, "m", servo));
        return EXIT_DONE;
    }
    error = change_tune(&k->c, change_bps(there));
    int back = change_tune(&k->c, old_bps);
    if (error || back) {
        contact_note(k, name, NOT_DONE, "the line at %d bps: %s", change_bps(there),
                     app_error_text(error ? error : back));
        return EXIT_DONE;
    }
    char path[EEPROM_PATH_BYTES];
    int status = eeprom_save(&k->c, there->id, there->servo, path, sizeof path);
    if (status) {
        return status;
    }
    k->c.leaving = true; /* signals wait */
    error = change_and_back(k, there, old_bps, &is);
    k->c.leaving = false;
    if (error) {
        say_how_to_find(k, there, old_bps);
    }
    return error ? conn_fail_servo(&k->c, error, there->id) : judge(k, name, there, old_bps, &is);
}

static int ask_and_try(contact *k, const char *name, const servo_change *there, int old_bps)
{
    char question[APP_LINE_BYTES];
    const char *joint = grobo_model_joint(app_model(k->a), k->joint)->name;
    say_how_to_find(k, there, old_bps);
    snprintf(question, sizeof question,
             there->flash
                 ? _("keep the power on. Set %s from %d to %d bps in its flash, restart it, "
                     "and back?")
                 : _("keep the power on. Set %s from %d to %d bps and back?"),
             joint, old_bps, change_bps(there));
    if (!ask_yes(k->a, question)) {
        contact_note(k, name, NOT_DONE, "the person declined");
        return EXIT_DONE;
    }
    int status = contact_open(k, name, false);
    if (!status) {
        status = try_rate(k, name, there, old_bps);
    }
    return contact_close(k, status);
}

int contact_try_rates(contact *k)
{
    const grobo_driver *driver = app_driver(k->a);
    int old_bps = (int)conn_baud(k->a);
    servo_change there = {.id = grobo_model_joint(driver->model, k->joint)->motor};
    there.servo = family_servo(driver, there.id);
    there.reg = there.servo ? grobo_servo_register_of(there.servo, GROBO_ROLE_BAUD) : NULL;
    bool remote = strncmp(conn_requested(k->a), "tcp:", 4) == 0;
    if (driver->protocol->relay || remote || !there.reg) {
        contact_note(k, "rate", NOT_DONE,
                     remote      ? "the rate of a line behind TCP is not set from here"
                     : there.reg ? "a servo behind the board has the board's rate"
                                 : "its servos have one rate");
        return EXIT_DONE;
    }
    there.value = another_rate(&there, old_bps);
    if (there.value < 0) {
        contact_note(k, "rate", NOT_DONE, "its servos have one rate");
        return EXIT_DONE;
    }
    int status = ask_and_try(k, "rate", &there, old_bps);
    if (!status && keeps_by_command(&there)) {
        there.flash = true;
        status = ask_and_try(k, "rate_restart", &there, old_bps);
    }
    return status;
}
