/* SPDX-License-Identifier: MIT */
/**
 * @file callback.h
 * @brief Callbacks that hold a loop for too long: what GROBO_EVENT_SLOW_CALLBACK reports.
 *
 * The engine of robot.h measures nothing; sessions and runners do.
 */
#ifndef GROBO_CALLBACK_H
#define GROBO_CALLBACK_H

#include <grobo/types.h>

GROBO_BEGIN_DECLS

/** A callback that takes longer is reported. */
#define GROBO_CALLBACK_SLOW_US 20000

/** The callbacks of a session and of a runner. */
typedef enum grobo_callback {
    GROBO_CALLBACK_EVENT, /**< grobo_session_config.on_event */
    GROBO_CALLBACK_ROBOT, /**< grobo_session_config.on_robot */
    GROBO_CALLBACK_TAP,   /**< grobo_session_config.on_tap */
    GROBO_CALLBACK_SVC,   /**< grobo_runner_config.on_svc */
    GROBO_CALLBACK_CALL   /**< a function of grobo_runner_call() or grobo_runner_post() */
} grobo_callback;

/** GROBO_EVENT_SLOW_CALLBACK: callbacks above GROBO_CALLBACK_SLOW_US since the last such event. */
typedef struct grobo_event_slow {
    grobo_callback callback; /**< the one that took longest */
    int64_t held_us;         /**< how long it took */
    unsigned count;          /**< number of callbacks above the limit */
} grobo_event_slow;

GROBO_END_DECLS

#endif
