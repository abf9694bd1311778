/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/estop.h>

#include "tools/grctl/web/serve.h"

/* A reading that was on the line when the stop left tells nothing of it; a frame of all joints
 * takes 10 ms at 115200 bps. */
#define STOPS_ON_ITS_WAY_US INT64_C(20000)
/* A joint that is faster moves; one that is slower, and was not read to stand for so long, too. */
enum { STOPS_SLOW_DPS = 8, STOPS_CREEPS_US = 3000000 };
/* A request that stops before it is whole has this time to bring its name. */
#define STOPS_UNTOLD_US INT64_C(150000)

static const char *word_of(stops_joint joint)
{
    switch (joint) {
    case STOPS_SENT:
        return "sent";
    case STOPS_STOPPED:
        return "stopped";
    case STOPS_MOVING:
        return "moving";
    case STOPS_LIMP:
        return "limp";
    case STOPS_SILENT:
        return "silent";
    }
    return "sent";
}

static bool is_over(stops_joint joint)
{
    return joint == STOPS_STOPPED || joint == STOPS_LIMP;
}

static grobo_joint_mask unconfirmed(const serve *s)
{
    grobo_joint_mask joints = 0;
    for (int j = 0; j < s->model->n_joints; j++) {
        joints |= is_over(s->stops.joints[j]) ? 0 : GROBO_JOINT_BIT(j);
    }
    return joints;
}

static void tell_stop(serve *s)
{
    s->stops.untold = false;
    events_tell(&s->events, "stop", "warning", NULL, "%s by %s",
                s->stops.estop ? "emergency stop" : "stop", s->stops.by);
}

/* What was asked for before the stop is void: each stop, also one that repeats another. */
static void note_stop(serve *s, const char *by, bool estop, bool news)
{
    stops *t = &s->stops;
    const char *name = by ? by : "a request that is not whole";
    based_change(&s->based, grobo_now_us(), "%s by %s", estop ? "emergency stop" : "stop", name);
    if (news) {
        lease_end(&s->lease);
        s->player.epoch++; /* what was asked for and has not begun does not begin */
    }
    if (news || (t->untold && by)) {
        snprintf(t->by, sizeof t->by, "%s", name);
        t->untold = true;
    }
    if (t->untold && by) {
        tell_stop(s);
    }
}

int stops_ask(serve *s, const char *by, bool estop)
{
    stops *t = &s->stops;
    bool news = !t->latched || (estop && !t->estop);
    int result = GROBO_OK;
    s->jogs = s->jog_waits = false;
    if (news) {
        t->latched = true;
        t->estop = estop;
        t->held = false;
        t->at_us = grobo_now_us();
        memset(t->joints, 0, sizeof t->joints);
    }
    if (!s->c.robot) { /* not yet: stops_begin() */
        result = GROBO_OK;
    } else if (estop && (news || !s->ready)) {
        result = grobo_robot_estop(s->c.robot);
    } else if (!t->estop) { /* again: a frame may have been lost */
        (void)grobo_robot_stop(s->c.robot, true);
    }
    note_stop(s, by, estop, news);
    stops_look(s);
    return result;
}

static stops_joint judge(const serve *s, int joint)
{
    grobo_joint_info i;
    if (grobo_robot_joint(s->c.robot, joint, &i) < 0 || i.status != GROBO_OK) {
        return STOPS_SILENT;
    }
    if ((i.torque_known && i.state.torque != GROBO_TORQUE_ON) ||
        (s->limp & GROBO_JOINT_BIT(joint))) {
        return STOPS_LIMP;
    }
    if (i.stands) {
        return STOPS_STOPPED;
    }
    bool turns = (i.state.valid & GROBO_FIELD_SPEED) && abs(i.state.speed_dps) > STOPS_SLOW_DPS;
    return turns || grobo_now_us() - s->stops.at_us > STOPS_CREEPS_US ? STOPS_MOVING : STOPS_SENT;
}

/* A stop of ours, or one of the engine for safety: its joints are read until they stand. */
static bool is_stopped(const serve *s)
{
    grobo_trip_info trip;
    grobo_robot_tripped(s->c.robot, &trip);
    return s->stops.latched || (trip.trip != GROBO_TRIP_NONE && trip.latched);
}

void stops_on_event(serve *s, const grobo_event *event)
{
    stops *t = &s->stops;
    if (event->kind == GROBO_EVENT_JOB && event->u.job.number == t->reading) {
        t->reading = 0;
    }
    if (event->kind == GROBO_EVENT_TRIP && event->u.trip.latched && !t->latched) {
        t->at_us = event->now_us;
        memset(t->joints, 0, sizeof t->joints);
    }
    if (!is_stopped(s)) {
        return;
    }
    if (event->kind == GROBO_EVENT_JOINT && event->now_us - t->at_us > STOPS_ON_ITS_WAY_US) {
        bool was = unconfirmed(s) != 0;
        t->joints[event->u.joint.joint] = judge(s, event->u.joint.joint);
        if (was && unconfirmed(s) == 0) {
            events_tell(&s->events, "stop", "info", NULL, "every joint stands");
        }
    }
    if (event->kind == GROBO_EVENT_LINK_UP) { /* whatever happened meanwhile */
        t->held = false;
        memset(t->joints, 0, sizeof t->joints);
    }
}

void stops_begin(serve *s)
{
    stops *t = &s->stops;
    if (t->latched) {
        t->at_us = grobo_now_us();
        t->held = false;
        (void)(t->estop ? grobo_robot_estop(s->c.robot) : grobo_robot_stop(s->c.robot, true));
    }
}

/* The engine refuses too, from when it stands: once it does, the frame that stops is refused
 * as well where it still waits for the line. */
static void hold(serve *s)
{
    stops *t = &s->stops;
    if (t->latched && !t->held && !t->estop && !grobo_robot_moving(s->c.robot)) {
        t->held = grobo_robot_latch(s->c.robot) == GROBO_OK;
    }
}

void stops_look(serve *s)
{
    stops *t = &s->stops;
    grobo_joint_mask missing = s->ready ? unconfirmed(s) : 0;
    if (t->untold && grobo_now_us() - t->at_us > STOPS_UNTOLD_US) {
        tell_stop(s);
    }
    if (!t->latched || !s->ready || !s->c.up) {
        return;
    }
    hold(s);
    if (missing && !t->reading && grobo_now_us() - t->at_us > STOPS_ON_ITS_WAY_US) {
        int job = grobo_robot_sense(s->c.robot, missing, GROBO_SENSE_GOAL);
        t->reading = job > 0 ? job : 0;
    }
}

bool stops_are_busy(const serve *s)
{
    return s->stops.untold || (is_stopped(s) && unconfirmed(s));
}

int stops_reset(serve *s)
{
    int error = s->c.up ? grobo_robot_reset(s->c.robot) : GROBO_OK;
    if (error) {
        return error;
    }
    memset(&s->stops, 0, sizeof s->stops);
    s->c.trip = (grobo_trip_info){.trip = GROBO_TRIP_NONE, .joint = -1};
    based_change(&s->based, grobo_now_us(), "the stop was released");
    return GROBO_OK;
}

bool stops_is_latched(serve *s)
{
    return s->stops.latched || grobo_session_is_latched(s->c.session) ||
           grobo_estop_stands(conn_device(&s->c));
}

void stops_halt(serve *s)
{
    s->jogs = s->jog_waits = false;
    s->player.epoch++;
    based_change(&s->based, grobo_now_us(), "what moved was halted");
    if (s->c.up) {
        (void)grobo_robot_stop(s->c.robot, false);
    }
}

bool stops_may_move(serve *s, http_request *r, const json_t *body, const char *doing)
{
    if (stops_is_latched(s)) {
        serve_refuse(s, r, GROBO_ERR_LATCHED, "robot");
        return false;
    }
    return serve_is_based(s, r, body, doing);
}

json_t *stops_json(serve *s)
{
    const stops *t = &s->stops;
    grobo_trip_info trip;
    json_t *joints = json_array();
    grobo_robot_tripped(s->c.robot, &trip);
    bool tripped = trip.trip != GROBO_TRIP_NONE && trip.latched;
    bool own = tripped && !t->latched;
    bool stopped = is_stopped(s);
    for (int j = 0; stopped && j < s->model->n_joints; j++) {
        json_array_append_new(joints, json_string(word_of(t->joints[j])));
    }
    const char *kind = t->estop ? "estop" : t->latched ? "stop" : tripped ? "trip" : NULL;
    return json_pack("{s:b,s:s?,s:o?,s:o?,s:o?,s:o?,s:o?,s:b,s:o}", "latched", kind != NULL, "kind",
                     kind, "trip", own ? app_json_code(grobo_trip_name(trip.trip)) : NULL, "joint",
                     own && trip.joint >= 0 ? json_integer(trip.joint) : NULL, "value",
                     own ? app_json_number(trip.value, 3) : NULL, "by",
                     t->latched ? app_json_text(t->by) : NULL, "age_ms",
                     t->latched ? json_integer((grobo_now_us() - t->at_us) / 1000) : NULL,
                     "confirmed", stopped && unconfirmed(s) == 0, "joints", joints);
}
