/* SPDX-License-Identifier: MIT */
#include <grobo/core/robot.h>
#include <grobo/estop.h>

#include "tools/grctl/play/keys.h"

enum { SPEED_STEP_PCT = 10 };

static void toggle_pause(conn *c)
{
    if (grobo_robot_play_state(c->robot) == GROBO_SEQUENCER_PAUSED) {
        grobo_robot_resume(c->robot);
    } else {
        grobo_robot_pause(c->robot);
    }
}

/* Kept only where there is something to change the speed of. */
static void change_speed(play_keys *k, int by_pct)
{
    int speed_pct = k->speed_pct + by_pct;
    if (speed_pct < SPEED_STEP_PCT) {
        speed_pct = SPEED_STEP_PCT;
    }
    if (speed_pct > GROBO_PLAY_SPEED_MAX_PCT) {
        speed_pct = GROBO_PLAY_SPEED_MAX_PCT;
    }
    if (grobo_robot_speed(k->c->robot, speed_pct) == GROBO_OK) {
        k->speed_pct = speed_pct;
    }
}

/* The mark is set first, as `grctl estop` does; the engine latches even when the line is down. */
void play_keys_estop(play_keys *k)
{
    k->estop = true;
    grobo_os_cause cause;
    if (grobo_estop_set(conn_device(k->c), NULL, &cause) < 0) {
        app_note(k->c->a, "the emergency stop is not kept for other programs: %s", cause.text);
    }
    grobo_robot_estop(k->c->robot);
}

bool play_keys_take(play_keys *k, int key)
{
    switch (key) {
    case ' ':
        toggle_pause(k->c);
        return true;
    case '+':
    case '=':
        change_speed(k, SPEED_STEP_PCT);
        return true;
    case '-':
        change_speed(k, -SPEED_STEP_PCT);
        return true;
    case 's':
    case 'q':
        k->stopped |= grobo_robot_stop(k->c->robot, false) == GROBO_OK;
        return true;
    case 'e':
        play_keys_estop(k);
        return true;
    }
    return false;
}
