/* SPDX-License-Identifier: MIT */
/* What an agent publishes. */
#ifndef GRCTL_FLEET_SAY_H
#define GRCTL_FLEET_SAY_H

#include "tools/grctl/fleet/agent.h"

/* The texts of `connection`, for the will too. */
void say_prepare(agent *g);
/* That it is there, and which robots it has: both retained. */
void say_hello(agent *g);
void say_goodbye(agent *g);
/* The events that waited on disk for the broker. */
void say_kept(agent *g);
/* The broker has taken a message; or it is gone, and what it has not taken waits on disk. */
void say_taken(agent *g, int message);
void say_untaken(agent *g);
/* The state of a robot; also the retained one. */
void say_state(agent *g, const seat *s, bool last_too);
/* Of a robot, or of the agent (NULL). */
void say_event(agent *g, const seat *s, const char *kind, const char *text);
/* That every robot was told to stop; and how each robot obeyed the stop of a group. */
void say_stopping(agent *g, const agent_group *group);
void say_stopped(agent *g, const agent_group *group);
/* The stop of a group that is known here. */
void say_latch(agent *g, const agent_group *group);
/* The end of a motion. */
void say_ended(agent *g, const char *order);
/* To who ordered. Takes the reference of extra, which may be NULL. */
void say_answer(agent *g, const agent_order *order, const char *code, const char *message,
                json_t *extra);
/* What was answered before. */
void say_again(agent *g, const agent_order *order, const char *text);

#endif
