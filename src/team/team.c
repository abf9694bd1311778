/* SPDX-License-Identifier: MIT */
#include <grobo/core/robot.h>
#include <grobo/core/team.h>

#include "src/base/assert.h"
#include "src/base/memory.h"
#include "src/base/sized.h"

enum { PREPARE_US = 30000000, LEAD_US = 100000 };

typedef struct member {
    grobo_team_member is;
    int job;     /* of its preparation, 0: over, or none */
    bool paused; /* by the team: to be resumed with it */
} member;

struct grobo_team {
    grobo_team_config config; /* defaults filled in */
    member *members;
    int n, room;
    grobo_team_state state;
    int64_t until_us; /* PREPARES: who is not ready then is out */
    int64_t start_us; /* not before; READY: the time told */
    int result;       /* the first that went wrong */
    bool held;        /* paused before the start was told */
    bool ending;      /* the team itself stops its members: they fall out by that */
    int acting;       /* requests of its own are under way: the end is told behind them */
};

/* ---- members --------------------------------------------------------------------------------- */

static bool takes_part(const member *m)
{
    return m->is.state >= GROBO_TEAM_PREPARES && m->is.state <= GROBO_TEAM_PLAYS;
}

static bool is_under_way(const grobo_team *team)
{
    return team->state >= GROBO_TEAM_PREPARES && team->state <= GROBO_TEAM_PLAYS;
}

static int count(const grobo_team *team, grobo_team_state state)
{
    int n = 0;
    for (int i = 0; i < team->n; i++) {
        n += team->members[i].is.state == state;
    }
    return n;
}

static bool anybody(const grobo_team *team)
{
    for (int i = 0; i < team->n; i++) {
        if (takes_part(&team->members[i])) {
            return true;
        }
    }
    return false;
}

static void tell(grobo_team *team, grobo_team_event_kind kind, int i, int result)
{
    const grobo_team_event_info event = {
        .kind = kind, .member = i, .result = result, .at_us = team->start_us};
    if (team->config.on_event) {
        team->config.on_event(team->config.ctx, &event);
    }
}

/* Each that takes part stops smoothly; what they tell then is no news. */
static void stop_all(grobo_team *team)
{
    team->ending = true;
    for (int i = 0; i < team->n; i++) {
        if (takes_part(&team->members[i])) {
            (void)grobo_robot_stop(team->members[i].is.robot, false);
        }
    }
}

/* A start that was told may be paused too. */
static bool pause_one(const grobo_team *team, member *m)
{
    bool begun = team->state != GROBO_TEAM_PREPARES && takes_part(m);
    bool paused = begun && grobo_robot_pause(m->is.robot) >= 0;
    m->paused |= paused;
    return paused;
}

static bool pause_all(grobo_team *team)
{
    bool any = false;
    if (team->state == GROBO_TEAM_PREPARES) {
        any = !team->held;
        team->held = true;
    }
    for (int i = 0; i < team->n; i++) {
        any |= pause_one(team, &team->members[i]);
    }
    return any;
}

/* ---- the end of one, and of all -------------------------------------------------------------- */

static void end_team(grobo_team *team)
{
    if (team->acting == 0 && is_under_way(team) && !anybody(team)) {
        team->state = GROBO_TEAM_ENDED;
        tell(team, GROBO_TEAM_EVENT_ENDED, -1, team->result);
    }
}

static void end_member(grobo_team *team, int i, int result)
{
    member *m = &team->members[i];
    GROBO_ASSERT(takes_part(m));
    m->is.state = GROBO_TEAM_ENDED;
    m->is.result = result;
    m->job = 0;
    m->paused = false;
    if (result < 0) {
        team->result = team->result < 0 ? team->result : result;
    }
}

/*
 * It is out before its end: the policy says what the others do, at once. An engine may tell of what
 * is asked here from within the request.
 */
static void fall_out(grobo_team *team, int i, int result, bool stops)
{
    team->acting++;
    end_member(team, i, result);
    if (stops) {
        (void)grobo_robot_stop(team->members[i].is.robot, false);
    }
    if (!team->ending) {
        if (team->config.policy == GROBO_TEAM_STOP_ALL) {
            stop_all(team);
        }
        bool paused = team->config.policy == GROBO_TEAM_PAUSE_ALL && pause_all(team);
        tell(team, GROBO_TEAM_EVENT_OUT, i, result);
        if (paused) {
            tell(team, GROBO_TEAM_EVENT_PAUSED, i, result);
        }
    }
    team->acting--;
    end_team(team);
}

/* ---- what members tell ----------------------------------------------------------------------- */

static void on_job(grobo_team *team, int i, const grobo_event_job *job)
{
    member *m = &team->members[i];
    if (job->kind != GROBO_JOB_PLAY || job->number != m->job) {
        return;
    }
    m->job = 0;
    if (job->result < 0) {
        fall_out(team, i, job->result, true); /* it may be under way all the same */
    }
}

static void on_play(grobo_team *team, int i, const grobo_event_play *play)
{
    switch (play->to) {
    case GROBO_SEQUENCER_FINISHED:
        end_member(team, i, GROBO_OK);
        end_team(team);
        break;
    case GROBO_SEQUENCER_FAILED:
        fall_out(team, i, play->error < 0 ? play->error : GROBO_ERR_CANCELED, false);
        break;
    case GROBO_SEQUENCER_STOPPING:
    case GROBO_SEQUENCER_IDLE:
        if (team->members[i].job == 0) { /* before that the job's end says why */
            fall_out(team, i, GROBO_ERR_CANCELED, false);
        }
        break;
    case GROBO_SEQUENCER_PLAYING:
        team->members[i].is.state = GROBO_TEAM_PLAYS;
        break;
    case GROBO_SEQUENCER_APPROACHING:
    case GROBO_SEQUENCER_PAUSED:
        break;
    }
}

void grobo_team_event(grobo_team *team, int i, const grobo_event *event)
{
    if (team == NULL || event == NULL || i < 0 || i >= team->n || !takes_part(&team->members[i])) {
        return;
    }
    if (event->kind == GROBO_EVENT_JOB) {
        on_job(team, i, &event->u.job);
    } else if (event->kind == GROBO_EVENT_PLAY) {
        on_play(team, i, &event->u.play);
    } else if (event->kind == GROBO_EVENT_TRIP && event->u.trip.latched) {
        fall_out(team, i, GROBO_ERR_LATCHED, false);
    } else if (event->kind == GROBO_EVENT_LINK_DOWN) {
        fall_out(team, i, GROBO_ERR_UNPLUGGED, false);
    }
}

/* ---- time ------------------------------------------------------------------------------------ */

static void look_who_is_ready(grobo_team *team, int64_t now_us)
{
    for (int i = 0; i < team->n; i++) {
        member *m = &team->members[i];
        grobo_play_progress progress;
        grobo_robot_progress(m->is.robot, &progress);
        if (m->is.state == GROBO_TEAM_PREPARES && m->job == 0 && progress.ready) {
            m->is.state = GROBO_TEAM_READY;
        } else if (m->is.state == GROBO_TEAM_PREPARES && now_us >= team->until_us) {
            fall_out(team, i, GROBO_ERR_TIMEOUT, true);
        }
    }
}

/* One time for all that are there. */
static void tell_start(grobo_team *team, int64_t start_us)
{
    team->start_us = start_us;
    team->acting++;
    for (int i = 0; i < team->n; i++) {
        member *m = &team->members[i];
        int result = GROBO_OK;
        if (m->is.state == GROBO_TEAM_READY) {
            result = grobo_robot_start_at(m->is.robot, start_us);
        }
        if (result < 0) {
            fall_out(team, i, result, true);
        }
    }
    team->acting--;
    if (!team->ending && anybody(team)) {
        tell(team, GROBO_TEAM_EVENT_START, -1, GROBO_OK);
    }
    end_team(team);
}

/* All are there. */
static void be_ready(grobo_team *team, int64_t now_us)
{
    int64_t soon_us = now_us + team->config.lead_us;
    team->state = GROBO_TEAM_READY;
    if (team->start_us == GROBO_START_LATER) {
        tell(team, GROBO_TEAM_EVENT_READY, -1, GROBO_OK);
    } else {
        tell_start(team, team->start_us > soon_us ? team->start_us : soon_us);
    }
}

int grobo_team_start_at(grobo_team *team, int64_t start_us, int64_t now_us)
{
    if (team == NULL || start_us < 0 || start_us >= GROBO_START_LATER) {
        return GROBO_ERR_ARG;
    }
    if (team->state != GROBO_TEAM_READY || team->start_us != GROBO_START_LATER) {
        return GROBO_ERR_STATE;
    }
    if (start_us < now_us) {
        return GROBO_ERR_STALE;
    }
    tell_start(team, start_us);
    return GROBO_OK;
}

static void begin(grobo_team *team)
{
    team->state = GROBO_TEAM_PLAYS;
    for (int i = 0; i < team->n; i++) {
        if (team->members[i].is.state == GROBO_TEAM_READY) {
            team->members[i].is.state = GROBO_TEAM_PLAYS;
        }
    }
}

int64_t grobo_team_step(grobo_team *team, int64_t now_us)
{
    if (team == NULL) {
        return GROBO_NEVER_US;
    }
    if (team->state == GROBO_TEAM_PREPARES) {
        look_who_is_ready(team, now_us);
    }
    bool all = team->state == GROBO_TEAM_PREPARES && !team->ending && !team->held &&
               count(team, GROBO_TEAM_PREPARES) == 0;
    if (all) {
        be_ready(team, now_us);
    }
    if (team->state == GROBO_TEAM_READY && now_us >= team->start_us) {
        begin(team);
    }
    if (team->state == GROBO_TEAM_PREPARES) {
        return now_us + GROBO_TEAM_LOOK_US;
    }
    bool told = team->state == GROBO_TEAM_READY && team->start_us != GROBO_START_LATER;
    return told ? team->start_us : GROBO_NEVER_US;
}

/* ---- requests -------------------------------------------------------------------------------- */

/* What is given has its clips. */
static bool are_there(const grobo_team *team, const grobo_clip *const *clips, bool one_clip)
{
    for (int i = 0; clips != NULL && i < (one_clip ? 1 : team->n); i++) {
        if (clips[i] == NULL) {
            return false;
        }
    }
    return clips != NULL;
}

int grobo_team_play(grobo_team *team, const grobo_clip *const *clips, bool one_clip,
                    const grobo_play_options *options, int64_t now_us)
{
    grobo_play_options how;
    if (team == NULL || !are_there(team, clips, one_clip) ||
        grobo_i_sized_take(&how, sizeof how, options) < 0) {
        return GROBO_ERR_ARG;
    }
    if (team->n == 0) {
        return GROBO_ERR_EMPTY;
    }
    if (is_under_way(team)) {
        return GROBO_ERR_STATE;
    }
    team->start_us = how.start_us;
    team->until_us = now_us + team->config.prepare_us;
    team->result = GROBO_OK;
    team->held = team->ending = false;
    team->state = GROBO_TEAM_PREPARES;
    how.start_us = GROBO_START_LATER;
    for (int i = 0; i < team->n; i++) {
        team->members[i].is.state = GROBO_TEAM_ENDED;
        team->members[i].is.result = GROBO_ERR_CANCELED; /* of who is not asked any more */
    }
    team->acting++;
    for (int i = 0; i < team->n && !team->ending; i++) {
        member *m = &team->members[i];
        m->is.state = GROBO_TEAM_PREPARES;
        m->paused = false;
        m->job = grobo_robot_play(m->is.robot, clips[one_clip ? 0 : i], &how);
        if (m->job < 0) {
            fall_out(team, i, m->job, false);
        }
    }
    team->acting--;
    end_team(team);
    return team->ending || team->state == GROBO_TEAM_ENDED ? team->result : GROBO_OK;
}

int grobo_team_pause(grobo_team *team)
{
    if (team == NULL) {
        return GROBO_ERR_ARG;
    }
    return pause_all(team) ? GROBO_OK : GROBO_ERR_STATE;
}

int grobo_team_resume(grobo_team *team)
{
    if (team == NULL) {
        return GROBO_ERR_ARG;
    }
    bool any = team->held;
    team->held = false;
    for (int i = 0; i < team->n; i++) {
        member *m = &team->members[i];
        if (m->paused) {
            m->paused = false;
            any |= grobo_robot_resume(m->is.robot) >= 0;
        }
    }
    return any ? GROBO_OK : GROBO_ERR_STATE;
}

int grobo_team_stop(grobo_team *team, bool at_once)
{
    bool any = false;
    if (team == NULL) {
        return GROBO_ERR_ARG;
    }
    team->ending = is_under_way(team);
    team->acting++;
    for (int i = 0; i < team->n; i++) {
        any |= grobo_robot_stop(team->members[i].is.robot, at_once) >= 0;
    }
    team->acting--;
    end_team(team);
    return any ? GROBO_OK : GROBO_ERR_STATE;
}

int grobo_team_estop(grobo_team *team)
{
    int result = GROBO_OK;
    if (team == NULL) {
        return GROBO_ERR_ARG;
    }
    team->ending = is_under_way(team);
    team->acting++;
    for (int i = 0; i < team->n; i++) {
        int job = grobo_robot_estop(team->members[i].is.robot);
        result = result == GROBO_OK && job < 0 ? job : result;
    }
    team->acting--;
    end_team(team);
    return result;
}

/* ---- a team --------------------------------------------------------------------------------- */

int grobo_team_new(const grobo_team_config *config, grobo_team **team)
{
    grobo_team_config taken;
    if (team == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
        taken.policy > GROBO_TEAM_CONTINUE || taken.prepare_us < 0 || taken.lead_us < 0) {
        return GROBO_ERR_ARG;
    }
    grobo_team *made = grobo_i_new(taken.mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->config = taken;
    made->config.prepare_us = taken.prepare_us ? taken.prepare_us : PREPARE_US;
    made->config.lead_us = taken.lead_us ? taken.lead_us : LEAD_US;
    *team = made;
    return GROBO_OK;
}

void grobo_team_free(grobo_team *team)
{
    if (team != NULL) {
        const grobo_mem *mem = team->config.mem;
        grobo_i_free(mem, team->members, (size_t)team->room * sizeof *team->members);
        grobo_i_free(mem, team, sizeof *team);
    }
}

static bool make_room(grobo_team *team)
{
    int room = team->room ? 2 * team->room : 8;
    member *more = grobo_i_new(team->config.mem, (size_t)room * sizeof *more);
    if (more == NULL) {
        return false;
    }
    for (int i = 0; i < team->n; i++) {
        more[i] = team->members[i];
    }
    grobo_i_free(team->config.mem, team->members, (size_t)team->room * sizeof *more);
    team->members = more;
    team->room = room;
    return true;
}

int grobo_team_add(grobo_team *team, grobo_robot *robot)
{
    if (team == NULL || robot == NULL) {
        return GROBO_ERR_ARG;
    }
    for (int i = 0; i < team->n; i++) {
        if (team->members[i].is.robot == robot) {
            return GROBO_ERR_ARG;
        }
    }
    if (is_under_way(team)) {
        return GROBO_ERR_STATE;
    }
    if (team->n == GROBO_TEAM_MAX) {
        return GROBO_ERR_FULL;
    }
    if (team->n == team->room && !make_room(team)) {
        return GROBO_ERR_NOMEM;
    }
    team->members[team->n] = (member){.is = {.robot = robot}};
    return team->n++;
}

int grobo_team_get(const grobo_team *team, int i, grobo_team_member *info)
{
    if (team == NULL || info == NULL || i < 0 || i >= team->n) {
        return GROBO_ERR_ARG;
    }
    *info = team->members[i].is;
    return GROBO_OK;
}

grobo_team_state grobo_team_get_state(const grobo_team *team)
{
    return team == NULL ? GROBO_TEAM_IDLE : team->state;
}
