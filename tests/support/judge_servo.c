/* SPDX-License-Identifier: MIT */
/* What servos do with the frames that reach them, by where their shafts are. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "src/sim/servo/shaft.h"
#include "tests/support/judge.h"
#include "tests/support/test.h"

/* A frame that its servo has not taken after this time is lost: the longest takes 19 ms through
 * the board, and may wait for another one. */
#define FLIGHT_US 60000
/* Torque may come on so far from the goal: what the engine takes for holding, and what a joint
 * outside its limits is drawn in by. */
#define HOLD_DEG 3.6
/* A joint so near to the goal it was sent to is where the engine takes it to be. */
#define MET_DEG 1.0
/* Rounding of the wire, at both ends of a way. */
#define ROUNDING_DEG 0.3
/* Frames are on their way for 1 to 19 ms, and the engine takes them to be there at once: a joint
 * that moves is elsewhere by what it does meanwhile. */
#define LAG_S 0.02
/* A goal that its servo takes this much after it was due was held back: by a board that waits for
 * the rest of a frame whose length was hit, or for a servo that is silent. The joint was not on
 * that way meanwhile. */
#define LATE_US 1000

const char *judge_name(const judge *w, int joint)
{
    return w->rig->driver->model->joints[joint].name;
}

/* In a world with weight the shaft sags and lags behind the place that a servo with torque has it
 * at: what a goal may ask for counts from that place. */
grobo_sim_view judge_view(judge *w, int joint)
{
    const grobo_sim *sim = &w->rig->sim;
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&w->rig->sim, joint, &view), 0);
    if (sim->config.physics != NULL && view.torque == GROBO_TORQUE_ON) {
        view.angle_mdeg =
            (int32_t)lround(grobo_i_sim_planned_mdeg(&sim->servo[joint], sim->now_us));
    }
    return view;
}

/* ---- goals ----------------------------------------------------------------------------------- */

static void drop_flying(judge_axis *axis, unsigned n)
{
    axis->n_flying -= n;
    memmove(axis->flying, axis->flying + n, axis->n_flying * sizeof axis->flying[0]);
}

/* Those that should have arrived by now are lost. */
static void lose_overdue(judge *w, judge_axis *axis)
{
    while (axis->n_flying > 0 && w->rig->now_us - axis->flying[0].left_us > FLIGHT_US) {
        drop_flying(axis, 1);
        axis->parted = true;
    }
}

bool judge_excused(judge *w, int joint)
{
    lose_overdue(w, &w->axes[joint]);
    bool excused = w->axes[joint].parted ||
                   (w->rig->witness.misled & GROBO_JOINT_BIT(joint)) != 0 ||
                   w->rig->witness.settings_hit;
    w->excused += excused;
    return excused;
}

void judge_lost_all(judge *w)
{
    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        w->axes[j].parted |= w->axes[j].n_flying > 0;
        w->axes[j].n_flying = 0;
    }
}

/* Where a joint is that was given all that left for it. */
static double along_deg(const judge_axis *axis, int64_t now_us)
{
    if (now_us >= axis->to_us || axis->to_us <= axis->from_us) {
        return axis->to_deg;
    }
    double part = (double)(now_us - axis->from_us) / (double)(axis->to_us - axis->from_us);
    return axis->from_deg + (axis->to_deg - axis->from_deg) * part;
}

void judge_goal_left(judge *w, int joint, int32_t ddeg, int32_t time_cs)
{
    judge_axis *axis = &w->axes[joint];
    lose_overdue(w, axis);
    if (axis->n_flying == JUDGE_FLYING) {
        drop_flying(axis, 1);
    }
    double before_deg = along_deg(axis, w->rig->now_us);
    axis->flying[axis->n_flying++] =
        (judge_goal){w->rig->now_us, ddeg,
                     time_cs,        judge_view(w, joint).angle_mdeg / 1000.0,
                     before_deg,     w->rig->now_us + w->wire_us};
    axis->from_deg = before_deg;
    axis->to_deg = ddeg / 10.0;
    axis->sent = true;
    axis->from_us = w->rig->now_us;
    axis->to_us = w->rig->now_us + (time_cs > 0 ? time_cs : 0) * 10000LL;
}

/* Takes a goal out of those under way. What left before it and was not taken is lost; what was held
 * back comes too late for the joint to be on its way. A joint that is where all that left before it
 * should have brought it is parted no more.
 * @return by what the joint may be elsewhere, in degrees, because it moved lately. */
static double match_flying(judge *w, const grobo_sim_event *event, double here_deg)
{
    judge_axis *axis = &w->axes[event->servo];
    double most_rad_s = w->rig->driver->model->joints[event->servo].max_speed_rad_s;
    for (unsigned i = 0; i < axis->n_flying; i++) {
        const judge_goal *goal = &axis->flying[i];
        if (goal->ddeg == event->value && (goal->time_cs < 0 || goal->time_cs == event->value2)) {
            double gone_deg = fabs(here_deg - goal->at_deg);
            bool moved = gone_deg > 0 || fabs(axis->goal_deg - here_deg) > ROUNDING_DEG;
            bool apart = fabs(here_deg - goal->before_deg) > MET_DEG + gone_deg;
            bool late = event->time_us > goal->due_us + LATE_US;
            axis->parted = i > 0 || late || (axis->parted && apart);
            drop_flying(axis, i + 1);
            return moved ? gone_deg + grobo_deg_from_rad(most_rad_s) * LAG_S : 0;
        }
    }
    lose_overdue(w, axis);
    return 0;
}

static void take_goal(judge *w, const grobo_sim_event *event)
{
    int joint = event->servo;
    judge_axis *axis = &w->axes[joint];
    grobo_sim_view view = judge_view(w, joint);
    double here_deg = view.angle_mdeg / 1000.0;
    double behind_deg = match_flying(w, event, here_deg);
    axis->goal_deg = event->value / 10.0;
    if (view.torque != GROBO_TORQUE_ON) {
        return;
    }
    double most_dps = grobo_deg_from_rad(w->rig->driver->model->joints[joint].max_speed_rad_s);
    double way_deg = fabs(axis->goal_deg - here_deg) - ROUNDING_DEG - behind_deg;
    double time_s = event->value2 / 100.0;
    if (way_deg > 1.02 * most_dps * time_s && !judge_excused(w, joint)) {
        fail_msg("%s takes a goal too fast for it: from %.1f to %.1f deg in %.0f ms, %.0f of %.0f "
                 "deg/s",
                 judge_name(w, joint), here_deg, axis->goal_deg, time_s * 1000, way_deg / time_s,
                 most_dps);
    }
}

/* ---- torque ---------------------------------------------------------------------------------- */

/* Whether a hand has turned a joint since the engine's last reading of it was said. */
static bool is_turned(const judge *w, int joint)
{
    return w->rig->witness.said_us[joint] < w->axes[joint].turned_us;
}

/* What a hand did since the engine looked last, or a limp joint that its weight turns, nobody can
 * know. */
double judge_hold_deg(judge *w, int joint)
{
    double gone_deg = fabs(rig_angle_deg(w->rig, joint) - w->axes[joint].read_deg);
    bool falls = w->rig->sim.config.physics != NULL;
    return HOLD_DEG + (is_turned(w, joint) || falls ? gone_deg : 0);
}

static void take_torque(judge *w, const grobo_sim_event *event)
{
    int joint = event->servo;
    judge_axis *axis = &w->axes[joint];
    double here_deg = judge_view(w, joint).angle_mdeg / 1000.0;
    if (event->value != GROBO_TORQUE_ON) {
        return;
    }
    double apart_deg = fabs(axis->goal_deg - here_deg);
    bool is_far = apart_deg > judge_hold_deg(w, joint);
    bool restarted = witness_restarted(&w->rig->witness, joint);
    axis->parted |= is_turned(w, joint) || (is_far && restarted); /* then it jumps, unseen */
    if (is_far && !restarted && !judge_excused(w, joint)) {
        fail_msg("torque of %s comes on %.1f deg from its goal, %.1f deg; it jumps there or "
                 "forgets it",
                 judge_name(w, joint), apart_deg, axis->goal_deg);
    }
    if (!w->rig->sim.config.jump_on_torque) {
        axis->goal_deg = here_deg;
    }
}

void judge_servo(judge *w, const grobo_sim_event *event)
{
    if (event->servo < 0) {
        return;
    }
    if (event->kind == GROBO_SIM_GOAL) {
        take_goal(w, event);
    } else if (event->kind == GROBO_SIM_TORQUE) {
        take_torque(w, event);
    } else if (event->kind == GROBO_SIM_REBOOT) {
        w->axes[event->servo].goal_deg = 0;
    }
}
