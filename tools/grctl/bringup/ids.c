/* SPDX-License-Identifier: MIT */
/* Gives new servos their ids, one servo on the line at a time; goes on where it was ended. */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/bringup/ask.h"
#include "tools/grctl/bringup/ids.h"
#include "tools/grctl/conn/change.h"
#include "tools/grctl/conn/eeprom.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/servos.h"
#include "tools/grctl/lang/lang.h"

enum { IDS_TRIES = 8 };

typedef struct giving {
    app *a;
    const grobo_robot_def *def;
    grobo_joint_mask done; /* joints whose servos have their ids */
    found_servos found;
} giving;

static int canceled(const giving *g)
{
    int status = ask_signal() ? EXIT_SIGNAL + ask_signal() : EXIT_USAGE;
    return app_fail(g->a, status, "CANCELED",
                    "setup: ended; servos that have their ids keep them, and setup goes on there");
}

/* ---- one servo ------------------------------------------------------------------------------- */

/* Writes a register that is kept over power-off, and reads it back. */
static int put(conn *c, int id, const grobo_servo_model *servo, const grobo_servo_register *reg,
               int32_t value)
{
    const servo_change what = {id, servo, reg, value, true};
    int32_t is = 0;
    int error = change_write(c, &what);
    if (!error) {
        error = change_keep(c, &what);
    }
    if (!error) {
        error = servos_get(c, change_id(&what), servo, reg, &is);
    }
    if (error) {
        return conn_fail_servo(c, error, change_id(&what));
    }
    return is == value
               ? EXIT_DONE
               : app_fail(c->a, EXIT_ROBOT, "MISMATCH", "servo %d: %s is %d, not %d, after writing",
                          change_id(&what), reg->name, is, value);
}

/* A servo that holds would jump or restart: it is limp after its power was off. */
static int expect_limp(conn *c, const found_servo *one)
{
    int32_t torque = GROBO_TORQUE_OFF;
    int error = servos_torque(c, one->id, one->servo, &torque);
    if (error && error != GROBO_ERR_UNSUPPORTED) {
        return conn_fail_servo(c, error, one->id);
    }
    return torque == GROBO_TORQUE_OFF
               ? EXIT_DONE
               : app_fail(c->a, EXIT_SAFETY, "STATE",
                          "setup: servo %d holds; switch its power off and on, and run setup again",
                          one->id);
}

static int give_id(conn *c, const found_servo *one, int id)
{
    const grobo_servo_register *reg = grobo_servo_register_of(one->servo, GROBO_ROLE_ID);
    return one->id == id || !reg ? EXIT_DONE : put(c, one->id, one->servo, reg, id);
}

/* Its rate comes last: from then on it is at another one than the line. */
static int give_rate(conn *c, const found_servo *one, int id, int baud_bps)
{
    const grobo_servo_register *reg = grobo_servo_register_of(one->servo, GROBO_ROLE_BAUD);
    int code = grobo_servo_baud_code(one->servo, baud_bps);
    int32_t is = 0;
    if (one->baud_bps == baud_bps || !reg) {
        return EXIT_DONE;
    }
    if (code < 0) {
        return app_fail(c->a, EXIT_ROBOT, "UNSUPPORTED", "setup: a %s has no rate of %d bps",
                        one->servo->name, baud_bps);
    }
    const servo_change what = {id, one->servo, reg, code, true};
    int at_bps = change_rate(c, &what, one->baud_bps, &is);
    if (at_bps < 0) {
        return conn_fail_servo(c, at_bps, id);
    }
    return at_bps == baud_bps && is == code
               ? EXIT_DONE
               : app_fail(c->a, EXIT_ROBOT, "MISMATCH",
                          "servo %d answers at %d bps, not %d, after writing; see 'grctl scan "
                          "--all-baud'",
                          id, at_bps, baud_bps);
}

/* A change that was cut off may have left what is kept open. */
static int close_lock(conn *c, const found_servo *one, int id)
{
    const grobo_servo_register *reg = grobo_servo_register_of(one->servo, GROBO_ROLE_LOCK);
    int32_t closed = 1;
    if (one->servo->table->keeps != GROBO_KEEPS_LOCK || !reg) {
        return EXIT_DONE;
    }
    int error = servos_get(c, id, one->servo, reg, &closed);
    if (!error && closed == 0) {
        error = servos_put(c, id, one->servo, reg, 1);
        app_note(c->a, "servo %d: its lock was open, from a change that was cut off: closed", id);
    }
    return error ? conn_fail_servo(c, error, id) : EXIT_DONE;
}

/* All that a servo lacks, over a line of its own. */
static int equip(const giving *g, const found_servo *one, int joint)
{
    conn c;
    app alone = *g->a;
    char path[EEPROM_PATH_BYTES] = "";
    int id = grobo_model_joint(g->def->model, joint)->motor, baud_bps = (int)g->def->baud_bps;
    bool differs = one->id != id || one->baud_bps != baud_bps;
    alone.robot = NULL;
    alone.driver = family_driver(one->family);
    alone.line.global[GLOBAL_BAUD] = (cli_value){.given = 1, .number = one->baud_bps};
    int status = conn_open_unchecked(&c, &alone);
    if (!status) {
        int error = servos_wait(&c, one->baud_bps, FAMILY_PIECE_BYTES, SERVOS_PATIENT_US, 0, NULL);
        status = error ? conn_fail_servo(&c, error, one->id) : expect_limp(&c, one);
    }
    if (!status && differs) {
        status = eeprom_save(&c, one->id, one->servo, path, sizeof path);
    }
    if (!status) {
        status = close_lock(&c, one, one->id);
    }
    if (!status) {
        status = give_id(&c, one, id);
    }
    if (!status) {
        status = give_rate(&c, one, id, baud_bps);
    }
    status = conn_close(&c, status);
    if (!status && differs) {
        app_note(g->a, "%s: id %d -> %d at %d bps, kept; what it kept before: %s",
                 grobo_model_joint(g->def->model, joint)->name, one->id, id, baud_bps, path);
    } else if (!status) {
        app_note(g->a, "%s: has the id %d at %d bps already",
                 grobo_model_joint(g->def->model, joint)->name, id, baud_bps);
    }
    return status;
}

/* ---- one joint ------------------------------------------------------------------------------- */

/* Whether who answers is one servo that may be this joint's; else says why not. */
static bool is_right(const giving *g, int joint)
{
    const grobo_model *model = g->def->model;
    const found_servo *one = &g->found.servo[0];
    const grobo_servo_model *wanted = NULL;
    for (size_t i = 0; g->def->family->tables[i] && !wanted; i++) {
        wanted = grobo_servo_model_numbered(g->def->family->tables[i],
                                            grobo_model_joint(model, joint)->servo_model);
    }
    if (!g->found.sure) {
        app_note(g->a, "replies came broken: is more than one servo plugged in?");
    } else if (g->found.n == 0) {
        app_note(g->a, "no servo answers: has it power, is its plug in?");
    } else if (g->found.n > 1) {
        app_note(g->a, "%d servos answer: plug in that of %s alone", g->found.n,
                 grobo_model_joint(model, joint)->name);
    } else if (one->told && wanted && one->servo->number != wanted->number) {
        app_note(g->a, "that is a %s; %s has a %s", one->servo->name,
                 grobo_model_joint(model, joint)->name, wanted->name);
    } else {
        return true;
    }
    return false;
}

/* A servo that has the id of another joint: of this run, or perhaps of one before. */
static bool is_anothers(const giving *g, int joint)
{
    char question[APP_LINE_BYTES];
    const grobo_model *model = g->def->model;
    int id = g->found.servo[0].id, other = grobo_model_joint_of_motor(model, id);
    const grobo_servo_register *reg =
        grobo_servo_register_of(g->found.servo[0].servo, GROBO_ROLE_ID);
    if (other < 0 || other == joint) {
        return false;
    }
    if (g->done & GROBO_JOINT_BIT(other)) {
        app_note(g->a, "that is the servo of %s, which has its id already; plug in that of %s",
                 grobo_model_joint(model, other)->name, grobo_model_joint(model, joint)->name);
        return true;
    }
    if (reg && id == reg->factory) {
        return false; /* as it left the factory */
    }
    snprintf(question, sizeof question,
             _("this servo has the id %d, of %s. Is it really that of %s?"), id,
             grobo_model_joint(model, other)->name, grobo_model_joint(model, joint)->name);
    return !ask_yes(g->a, question);
}

static int give_one(giving *g, int joint)
{
    char question[APP_LINE_BYTES], answer[ASK_BYTES];
    const char *name = grobo_model_joint(g->def->model, joint)->name;
    snprintf(question, sizeof question,
             _("plug in the servo of %s alone, with power, and press enter (skip: it has its id)"),
             name);
    for (int i = 0; i < IDS_TRIES; i++) {
        if (!ask_line(g->a, question, "enter", answer)) {
            return canceled(g);
        }
        if (strcmp(answer, "skip") == 0) {
            return EXIT_DONE;
        }
        int status = found_look(g->a, g->def->family->name, &g->found);
        if (!status && is_right(g, joint) && !is_anothers(g, joint)) {
            status = equip(g, &g->found.servo[0], joint);
            g->done |= status ? 0 : GROBO_JOINT_BIT(joint);
            return status;
        }
        if (status) {
            return status;
        }
    }
    return app_fail(g->a, EXIT_ROBOT, "NOTFOUND",
                    "setup: the servo of %s was not found; 'grctl doctor' looks at the line", name);
}

/* ---- all of them ----------------------------------------------------------------------------- */

static void name_missing(const giving *g, const found_servos *all)
{
    const grobo_model *model = g->def->model;
    for (int j = 0; j < model->n_joints; j++) {
        bool there = false;
        for (int i = 0; i < all->n; i++) {
            there |= all->servo[i].id == grobo_model_joint(model, j)->motor;
        }
        if (!there) {
            app_note(g->a, "%s (id %d) does not answer", grobo_model_joint(model, j)->name,
                     grobo_model_joint(model, j)->motor);
        }
    }
}

int ids_give(app *a, const grobo_robot_def *def, found_servos *all)
{
    static giving g;
    char answer[ASK_BYTES];
    int status = EXIT_DONE;
    g.a = a;
    g.def = def;
    g.done = 0;
    for (int joint = def->model->n_joints - 1; joint >= 0 && !status; joint--) {
        status = give_one(&g, joint);
    }
    for (int i = 0; i < IDS_TRIES && !status; i++) {
        if (!ask_line(a, "plug in all of them, with power, and press enter", "enter", answer)) {
            return canceled(&g);
        }
        status = found_look(a, def->family->name, all);
        if (!status) {
            found_choose(a, all);
            if (found_fits(all, def)) {
                return EXIT_DONE;
            }
            name_missing(&g, all);
        }
    }
    return status ? status
                  : app_fail(a, EXIT_ROBOT, "NOTFOUND",
                             "setup: not all servos of %s answer together; 'grctl doctor' says "
                             "which",
                             def->name);
}
