/* SPDX-License-Identifier: MIT */
/**
 * @file robot_config.h
 * @brief What a robot engine (robot.h) is configured with, and what its line leaves room for.
 *
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_ROBOT_CONFIG_H
#define GROBO_ROBOT_CONFIG_H

#include <grobo/core/bus.h>
#include <grobo/core/driver.h>
#include <grobo/core/sequencer.h>

GROBO_BEGIN_DECLS

/* ---- configuration -------------------------------------------------------------------------- */

/** What happens to a target outside a joint's limits. */
typedef enum grobo_limit_policy {
    GROBO_LIMIT_REFUSE = 0, /**< refused with joint and value; a motion being played stops */
    GROBO_LIMIT_CLAMP = 1   /**< moved to the limit and counted */
} grobo_limit_policy;

/** Torque after an emergency stop. */
typedef enum grobo_estop_torque {
    GROBO_ESTOP_BRAKE = 0, /**< damped: a standing robot sinks instead of dropping */
    GROBO_ESTOP_OFF = 1    /**< free */
} grobo_estop_torque;

/**
 * How long moves are sent. Without its host a servo continues to the goal that it received last: a
 * whole goal is reached, a joint that gets segments stops at the end of one. For a humanoid
 * whole goals are safer: half a crouch falls.
 */
typedef enum grobo_goals {
    GROBO_GOALS_DEFAULT = 0, /**< in segments for a driver that is an `arm`, whole for others */
    GROBO_GOALS_WHOLE,       /**< a move is one goal */
    GROBO_GOALS_SEGMENTS     /**< a move is goals of at most GROBO_SEGMENT_US ahead on its way, one
                                  every GROBO_SEGMENT_RENEW_US. Ends as the whole move would. A host
                                  that comes too late to renew one finds the move ended
                                  (GROBO_TRIP_HOST_STALL) */
} grobo_goals;

/** How far ahead a goal in segments goes, down to the unit of the driver's goal time. Without the
 *  host a joint moves for 400 ms at most: for this and the time of a frame that was on the line. */
#define GROBO_SEGMENT_US 380000
/** How often it is renewed; less often on a line that is slow for the joints that move, see
 *  grobo_budget.pace_us. */
#define GROBO_SEGMENT_RENEW_US 100000

/** Sense interval: no reading in the background. */
#define GROBO_SENSE_NEVER (-1)

/** While a motion is played each joint is read in full at least once in this time, unless it is
 *  played unwatched. */
#define GROBO_WATCH_US 2000000

/** Configuration. All zero is the default; a negative number where 0 means a limit: no limit. */
typedef struct grobo_robot_config {
    size_t size;                     /**< GROBO_ROBOT_CONFIG_INIT */
    grobo_limit_policy limit_policy; /**< targets outside limits; default refuse */
    int speed_limit_pct;             /**< 1..100 of each joint's speed; default 100 */
    double approach_dps;             /**< deg/s of the first move, > 0; default the driver's */
    int64_t sense_interval_us;       /**< background: each joint once in this time, while playing in
                                          1 s at most; 1 is as fast as the wire allows; default 1 s;
                                          GROBO_SENSE_NEVER: motions are played unwatched; joints
                                          that a goal switches on are heard all the same */
    bool sense_position_only;        /**< background reads angles only (cheaper): motions are played
                                          unwatched, heat and current stop nothing */
    bool manual_torque;              /**< move and play refuse joints without torque; default: they
                                          switch it on, safely */
    bool readback_correction;        /**< add the driver's read-back corrections */
    bool accept_unknown_raw;         /**< send raw frames the driver cannot check; default refuse */
    int temperature_c;               /**< trip above; default the driver's */
    int current_ma;                  /**< trip above for long; default the driver's */
    int voltage_mv;                  /**< trip below; default the driver's */
    int lost_replies;                /**< trip after so many in a row; default the driver's */
    int64_t stall_us;                /**< host may be late by this, then a motion ends; default
                                          250 ms */
    int64_t default_time_us;         /**< time of postures whose time is 0; default 100 ms */
    int64_t exit_bound_us;           /**< longest an exit may take; GROBO_NEVER_US: as long as it
                                          takes; default 10 s */
    grobo_exit_policy on_exit;       /**< default the driver's */
    grobo_goals goals;               /**< how long moves are sent; default as the driver has it */
    grobo_estop_torque estop_torque; /**< default brake */
    grobo_bus_config bus;            /**< the line's physics; `wiring` is taken from the driver */
    uint32_t timeout_us;             /**< reply timeout; default computed, see bus.h */
    int retries;                     /**< of a lost reply, the last patient where the line was ever
                                          late; default 2; -1 none */
} grobo_robot_config;
/** Begins an initializer of one. */
#define GROBO_ROBOT_CONFIG_INIT GROBO_SIZED(grobo_robot_config)

/* ---- the budget of the line ------------------------------------------------------------------ */

/**
 * What frames cost on a robot's line, and how many a second leave time to watch its joints: between
 * two frames there is room for as many readings as it takes to read every joint in full once in
 * GROBO_WATCH_US. GR001 at 115200 bps: 39 Hz through its board, 80 Hz on a bus.
 */
typedef struct grobo_budget {
    uint32_t motion_us;  /**< wire time of a posture of all joints, all frames of it */
    uint32_t reading_us; /**< wire time of reading one joint in full */
    uint16_t watched_hz; /**< largest such rate; 0: on so slow a line there is none */
    uint16_t default_hz; /**< what grobo_play_options.rate_hz 0 stands for: watched_hz, but at most
                              GROBO_PLAY_RATE_HZ */
    uint32_t
        pace_us; /**< how often all joints can be told more of their trajectories in segments, each
                              read in time: GROBO_SEGMENT_RENEW_US at least; 0: the line is too slow
                              for that, an arm's moves of all joints are refused */
} grobo_budget;

/**
 * Computes the budget of a robot that is not there.
 * @param driver borrowed for the call; its functions get `ctx`.
 * @param line the line's physics, NULL for all defaults; `wiring` is taken from the driver.
 * @return 0, GROBO_ERR_ARG (driver or line), or an error of the driver. Thread safe.
 */
GROBO_API int grobo_budget_init(grobo_budget *budget, const grobo_driver *driver, void *ctx,
                                const grobo_bus_config *line);

GROBO_END_DECLS

#endif
