/* SPDX-License-Identifier: MIT */
#include <grobo/core/robot.h>
#include <grobo/core/serial.h>
#include <grobo/core/sim.h>

#include "tools/grctl/conn/change.h"
#include "tools/grctl/conn/servos.h"

static bool keeps_as(const servo_change *what, grobo_keeps keeps)
{
    return what->servo->table->keeps == keeps;
}

bool change_is_kept(const servo_change *what)
{
    return (what->reg->flags & GROBO_REGISTER_KEPT) != 0 &&
           (what->flash || keeps_as(what, GROBO_KEEPS_LIMP));
}

bool change_needs_command(const servo_change *what)
{
    return what->flash && keeps_as(what, GROBO_KEEPS_COMMAND);
}

int change_bps(const servo_change *what)
{
    return grobo_servo_baud_bps(what->servo, what->value);
}

int change_id(const servo_change *what)
{
    return what->reg->role == GROBO_ROLE_ID ? (int)what->value : what->id;
}

/* Opens or closes what survives power-off, where the servo has a lock for that. */
static int set_lock(conn *c, const servo_change *what, int id, int closed)
{
    bool locks = what->flash && keeps_as(what, GROBO_KEEPS_LOCK);
    return locks ? servos_put(c, id, what->servo,
                              grobo_servo_register_of(what->servo, GROBO_ROLE_LOCK), closed)
                 : GROBO_OK;
}

/* Some servos answer from their new id or at their new rate: that is read back. */
int change_write(conn *c, const servo_change *what)
{
    bool moves = what->reg->role == GROBO_ROLE_ID || what->reg->role == GROBO_ROLE_BAUD;
    int error = set_lock(c, what, what->id, 0);
    if (error) {
        return error;
    }
    error = servos_put(c, what->id, what->servo, what->reg, what->value);
    if (moves && conn_is_of_reply(error)) {
        return GROBO_OK;
    }
    if (error) {
        (void)set_lock(c, what, what->id, 1);
    }
    return error;
}

static int command(conn *c, int id, grobo_servo_command what, const char *doing)
{
    return conn_wait_shown(c, grobo_robot_command(c->robot, id, what), doing, 0);
}

int change_keep(conn *c, const servo_change *what)
{
    return change_needs_command(what) ? command(c, change_id(what), GROBO_SERVO_FLASH, "flash")
                                      : set_lock(c, what, change_id(what), 1);
}

int change_tune(conn *c, int baud_bps)
{
    grobo_sim *sim = grobo_session_sim(c->session);
    int error = sim ? grobo_sim_set_line_bps(sim, (uint32_t)baud_bps)
                    : grobo_serial_set_baud(grobo_session_serial(c->session), baud_bps);
    return error < 0 ? error : servos_wait(c, baud_bps, 1, SERVOS_PATIENT_US, 0, NULL);
}

int change_find(conn *c, const servo_change *what, int first_bps, int second_bps, int32_t *code)
{
    const int rates_bps[] = {first_bps, second_bps};
    int error = GROBO_OK;
    for (int i = 0; i < 2; i++) {
        error = change_tune(c, rates_bps[i]);
        if (!error) {
            error = servos_get(c, what->id, what->servo, what->reg, code);
        }
        if (!error) {
            return rates_bps[i];
        }
        if (!conn_is_of_reply(error)) {
            break;
        }
    }
    return error;
}

int change_rate(conn *c, const servo_change *what, int old_bps, int32_t *code)
{
    int error = change_write(c, what);
    if (error) {
        return error;
    }
    int at_bps = change_find(c, what, old_bps, change_bps(what), code);
    if (at_bps < 0 || *code != what->value) {
        return at_bps;
    }
    error = change_keep(c, what);
    if (!error && change_needs_command(what)) {
        error = command(c, what->id, GROBO_SERVO_REBOOT, "restart");
        at_bps = error ? error : change_find(c, what, change_bps(what), old_bps, code);
    }
    return error ? error : at_bps;
}
