/* SPDX-License-Identifier: MIT */
/**
 * @file team.h
 * @brief Several robots as one: they begin a motion together, and stop together.
 *
 * A team owns no robot, line, clock or thread. Robots are added to it, and their owner hands it
 * their events and the time:
 * @code
 *   grobo_team_event(team, member, event);     // from the callback of each robot
 *   wake_up_at(grobo_team_step(team, now));    // after any event or request, and at that time
 * @endcode
 * Their clocks must be one: sessions on one loop, or engines that one program pumps.
 *
 * A motion begins by a barrier: each robot approaches its first posture and waits; when all are
 * there, all get the same start time. A robot that trips, loses its line, is stopped by another
 * request or is not there in time is out of the motion; grobo_team_policy says what the others do.
 * The others do not wait for it: they are asked in the call that reported it.
 *
 * Stops go to every member, whether it takes part or not. They are requests of each engine
 * (robot.h), so each is the next frame on the line of its robot.
 *
 * For the thread that pumps the robots. Requests may be made from on_event; a team is not freed
 * there. NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_TEAM_H
#define GROBO_CORE_TEAM_H

#include <grobo/mem.h>
#include <grobo/robot.h>

GROBO_BEGIN_DECLS

/** Robots of a team at most. */
#define GROBO_TEAM_MAX 256
/** How often readiness is looked at while robots approach. */
#define GROBO_TEAM_LOOK_US 5000

/** What the others do when a robot falls out of a motion. */
typedef enum grobo_team_policy {
    GROBO_TEAM_STOP_ALL = 0, /**< they stop smoothly, as soon as one is out */
    GROBO_TEAM_PAUSE_ALL,    /**< they pause; grobo_team_resume() continues without it */
    GROBO_TEAM_CONTINUE      /**< they continue without it */
} grobo_team_policy;

/** Where a team, or a member of it, is. */
typedef enum grobo_team_state {
    GROBO_TEAM_IDLE = 0, /**< takes part in no motion */
    GROBO_TEAM_PREPARES, /**< senses, switches torque on, approaches */
    GROBO_TEAM_READY,    /**< is there; of a team: all are, and the time is set or waited for */
    GROBO_TEAM_PLAYS,    /**< begun */
    GROBO_TEAM_ENDED     /**< over; `result`: how */
} grobo_team_state;

/** What a team reports. */
typedef enum grobo_team_event_kind {
    GROBO_TEAM_EVENT_START = 0, /**< the time is set: at_us; the motion begins then */
    GROBO_TEAM_EVENT_OUT,       /**< a member is out before its end: member, result */
    GROBO_TEAM_EVENT_PAUSED,    /**< the policy paused the others: member, result */
    GROBO_TEAM_EVENT_READY,     /**< all are there, and wait for grobo_team_start_at() */
    GROBO_TEAM_EVENT_ENDED      /**< no member plays any more: result, the first error of all */
} grobo_team_event_kind;

/** What grobo_team_config.on_event gets. Borrowed: valid during the call only. */
typedef struct grobo_team_event_info {
    grobo_team_event_kind kind;
    int member;    /**< its number, or -1 */
    int result;    /**< GROBO_OK or why */
    int64_t at_us; /**< START: when it begins */
} grobo_team_event_info;

/** The callback of a team. */
typedef void (*grobo_team_event_fn)(void *ctx, const grobo_team_event_info *event);

/** What a team is made of. Zero means default. */
typedef struct grobo_team_config {
    size_t size;              /**< GROBO_TEAM_CONFIG_INIT */
    grobo_team_policy policy; /**< when a robot falls out */
    int64_t prepare_us; /**< time for the approaches, 0: 30 s; a robot that is not ready then is
                                        out with GROBO_ERR_TIMEOUT */
    int64_t lead_us;    /**< from the last one ready to the start, 0: 100 ms */
    grobo_team_event_fn on_event; /**< or NULL */
    void *ctx;                    /**< borrowed, handed to on_event */
    const grobo_mem *mem;         /**< borrowed allocator; NULL: the C library's */
} grobo_team_config;
/** Begins an initializer of one. */
#define GROBO_TEAM_CONFIG_INIT GROBO_SIZED(grobo_team_config)

/** How a member is. */
typedef struct grobo_team_member {
    grobo_robot *robot;
    grobo_team_state state;
    int result; /**< ENDED: GROBO_OK, or why it fell out */
} grobo_team_member;

/** Several robots. */
typedef struct grobo_team grobo_team;

/**
 * Makes an empty team.
 * @param[out] team freed with grobo_team_free().
 * @return GROBO_OK, GROBO_ERR_ARG, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_team_new(const grobo_team_config *config, grobo_team **team);

/** Frees it; NULL is fine. Its robots continue with what they do. */
GROBO_API void grobo_team_free(grobo_team *team);

/**
 * Adds a robot.
 * @param robot borrowed until the team is freed.
 * @return its number, from 0 on, or GROBO_ERR_ARG (NULL, or a member already), GROBO_ERR_STATE (a
 *         motion is under way), GROBO_ERR_FULL, GROBO_ERR_NOMEM.
 */
GROBO_API int grobo_team_add(grobo_team *team, grobo_robot *robot);

/**
 * Plays a motion with all members: grobo_robot_play() for each, a barrier, one start.
 * @param clips a clip a member, or the same for all where one_clip; as grobo_robot_play() has it.
 * @param options as there; copied. start_us: not before this; 0: as soon as all are ready;
 *        GROBO_START_LATER: they wait for grobo_team_start_at().
 * @return GROBO_OK, GROBO_ERR_EMPTY (no members), GROBO_ERR_STATE (a motion is under way),
 *         GROBO_ERR_ARG; else what the policy made of the members that refused: with
 *         GROBO_TEAM_CONTINUE the refusal of the last one when none is left, with the others the
 *         first refusal, and then no robot plays.
 */
GROBO_API int grobo_team_play(grobo_team *team, const grobo_clip *const *clips, bool one_clip,
                              const grobo_play_options *options, int64_t now_us);

/**
 * Tells all that are ready when to begin, where grobo_team_play() was given GROBO_START_LATER.
 * @return 0, GROBO_ERR_STATE (not all are ready), GROBO_ERR_ARG, GROBO_ERR_STALE: that time is over
 *         (they continue to wait).
 */
GROBO_API int grobo_team_start_at(grobo_team *team, int64_t start_us, int64_t now_us);

/** grobo_robot_pause() for all that play. @return 0, or GROBO_ERR_STATE where none does. */
GROBO_API int grobo_team_pause(grobo_team *team);
/** grobo_robot_resume() for all that pause. @return as above. */
GROBO_API int grobo_team_resume(grobo_team *team);

/**
 * grobo_robot_stop() for every member, in one call.
 * @return 0, or GROBO_ERR_STATE where nothing moved.
 */
GROBO_API int grobo_team_stop(grobo_team *team, bool at_once);

/**
 * grobo_robot_estop() for every member, in one call: each latches and is read back by itself.
 * @return 0, or the first refusal (GROBO_ERR_CLOSED: latched, carried out when the line is there).
 */
GROBO_API int grobo_team_estop(grobo_team *team);

/** An event of a member's engine; from its callback. Events of idle members are ignored. */
GROBO_API void grobo_team_event(grobo_team *team, int member, const grobo_event *event);

/** Looks at the time. @return when it must be called again at the latest, or GROBO_NEVER_US. */
GROBO_API int64_t grobo_team_step(grobo_team *team, int64_t now_us);

/** How a member is. @return 0, or GROBO_ERR_ARG. */
GROBO_API int grobo_team_get(const grobo_team *team, int member, grobo_team_member *info);

/** Where the whole team is. */
GROBO_API grobo_team_state grobo_team_get_state(const grobo_team *team);

GROBO_END_DECLS

#endif
