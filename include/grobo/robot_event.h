/* SPDX-License-Identifier: MIT */
/**
 * @file robot_event.h
 * @brief What a robot engine (robot.h) reports: events, and state that may be asked for.
 */
#ifndef GROBO_ROBOT_EVENT_H
#define GROBO_ROBOT_EVENT_H

#include <grobo/callback.h>
#include <grobo/core/bus.h>
#include <grobo/core/driver.h>
#include <grobo/core/sequencer.h>

GROBO_BEGIN_DECLS

/* ---- events --------------------------------------------------------------------------------- */

/** Kinds of job. */
typedef enum grobo_job_kind {
    GROBO_JOB_NONE = 0,
    GROBO_JOB_CHECK,
    GROBO_JOB_SENSE,
    GROBO_JOB_TORQUE,
    GROBO_JOB_MOVE,
    GROBO_JOB_PLAY, /**< the preparation of a play: sensing, torque, the approach is taken */
    GROBO_JOB_RAW,
    GROBO_JOB_REGISTERS,
    GROBO_JOB_COMMAND,
    GROBO_JOB_STORED,
    GROBO_JOB_EXIT,
    GROBO_JOB_ESTOP,
    GROBO_JOB_SETTLE /**< the engine's own, after a motion: its last posture is read back, and
                          repeated where it was lost; any request ends it, and it reports nothing */
} grobo_job_kind;

/** Why the engine stopped by itself. */
typedef enum grobo_trip {
    GROBO_TRIP_NONE = 0,
    GROBO_TRIP_TEMPERATURE,  /**< value: deg C */
    GROBO_TRIP_OVERHEATED,   /**< a servo cut its torque for heat; value: deg C, 0: not told */
    GROBO_TRIP_CURRENT,      /**< value: mA */
    GROBO_TRIP_VOLTAGE,      /**< value: mV */
    GROBO_TRIP_LOST_REPLIES, /**< in motion; value: readings lost in a row; 0: a servo that a goal
                                  wakes was not heard in time to be sent the next one */
    GROBO_TRIP_TORQUE_LOST,  /**< a joint that held has no torque any more (brown-out) */
    GROBO_TRIP_LIMIT,        /**< a played target outside limits; value: degrees. Not latched */
    GROBO_TRIP_NUMBER,       /**< a played target not finite. Not latched */
    GROBO_TRIP_HOST_STALL,   /**< value: ms late. Not latched */
    GROBO_TRIP_ESTOP,        /**< grobo_robot_estop() */
    GROBO_TRIP_APART,   /**< a joint is not where the one that it follows has it; value: degrees
                                  that it is off (grobo_joint.apart_rad) */
    GROBO_TRIP_BLOCKED, /**< a joint stands on its way: a wall, a hand, something that is stuck;
                              value: degrees that its goal is ahead of where its load has it */
    GROBO_TRIP_OVERLOAD /**< a joint sinks or is pushed further from its goal than any weight that
                              it carries has it; value: degrees */
} grobo_trip;

/** Short lower-case name of a trip: "over-temperature". @return static string. Thread safe. */
GROBO_API const char *grobo_trip_name(grobo_trip trip);

/** Kinds of event. */
typedef enum grobo_event_kind {
    GROBO_EVENT_JOB = 0,   /**< a job ended: job */
    GROBO_EVENT_JOINT,     /**< a joint was read, or could not be: joint */
    GROBO_EVENT_ROUND,     /**< the background asked all joints once; in free mode the free ones */
    GROBO_EVENT_PLAY,      /**< the sequencer changed its state: play */
    GROBO_EVENT_TRIP,      /**< stopped for safety: trip */
    GROBO_EVENT_LINK_DOWN, /**< the line is gone */
    GROBO_EVENT_LINK_UP,   /**< the line is there */
    GROBO_EVENT_UNWATCHED, /**< a clip begins that is played unwatched: unwatched */
    GROBO_EVENT_SLOW_CALLBACK, /**< of a session: a callback held the loop too long: slow */
    GROBO_EVENT_HALTED         /**< what was told to stop was read back, or could not be: halted */
} grobo_event_kind;

/** GROBO_EVENT_JOB. */
typedef struct grobo_event_job {
    int number;          /**< what the request returned */
    grobo_job_kind kind; /**< what it was */
    int result;          /**< GROBO_OK or the first error */
    int joint;    /**< joint the error is about, or -1. Of a move that is done: one that still
                                moved 1.5 s after its way was over */
    double value; /**< value at fault (LIMIT: degrees; NAN), else 0. Of a move that is done: how
                                far that joint is beyond its goal, degrees */
    grobo_joint_mask
        failed;          /**< joints for which it failed; the others are done. Of an error that is
                                not one joint's, as GROBO_ERR_CANCELED: all that it had */
    const uint8_t *data; /**< reply of RAW, registers of REGISTERS; valid in the call only */
    size_t size;         /**< bytes at data */
} grobo_event_job;

/** GROBO_EVENT_JOINT: see grobo_robot_joint() for the values. */
typedef struct grobo_event_joint {
    int joint;
    int result; /**< GROBO_OK, or why there is no reading */
} grobo_event_joint;

/** GROBO_EVENT_PLAY: the sequencer took another state. More by grobo_robot_progress(). */
typedef struct grobo_event_play {
    grobo_sequencer_state from;
    grobo_sequencer_state to;
    int error; /**< why FAILED, else 0 */
} grobo_event_play;

/** GROBO_EVENT_TRIP, and grobo_robot_tripped(). */
typedef struct grobo_trip_info {
    grobo_trip trip; /**< why, GROBO_TRIP_NONE if not tripped */
    int joint;       /**< which joint, or -1 */
    double value;    /**< the value at fault, unit as the reason says */
    int64_t at_us;   /**< when */
    bool latched;    /**< until grobo_robot_reset() */
} grobo_trip_info;

/** GROBO_EVENT_UNWATCHED: heat, current and lost torque may stop nothing while it is played. */
typedef struct grobo_event_unwatched {
    uint16_t rate_hz;    /**< at which it is played, 0: by keys */
    uint16_t watched_hz; /**< largest rate at which the joints are watched: grobo_budget */
} grobo_event_unwatched;

/**
 * GROBO_EVENT_HALTED: the end of what a stop, a cancel, a pause or a trip began. Each joint that it
 * halted was read back, and halted again where the frame was lost; until then grobo_robot_moving()
 * is true. It comes some milliseconds after the frame, or 2.5 s where joints do not answer. None
 * comes where nothing moved, or all of it was sent elsewhere since.
 */
typedef struct grobo_event_halted {
    grobo_joint_mask joints; /**< their servos have the goal that stops them, stand, or are limp */
    grobo_joint_mask failed; /**< not read back, or not obeyed: these may move */
} grobo_event_halted;

/** What grobo_robot.on_event gets. Borrowed: valid during the call only. */
typedef struct grobo_event {
    grobo_event_kind kind;
    int64_t now_us; /**< time of the call into the engine that made it */
    union {
        grobo_event_job job;
        grobo_event_joint joint;
        grobo_event_play play;
        grobo_trip_info trip;
        grobo_event_unwatched unwatched;
        grobo_event_slow slow;
        grobo_event_halted halted;
    } u; /**< as kind says */
} grobo_event;

/** The one callback. Requests may be made from within it; the robot must not be deinitialised. */
typedef void (*grobo_event_fn)(void *ctx, const grobo_event *event);

/* ---- state that may be asked for ------------------------------------------------------------- */

/** One joint as the engine knows it. */
typedef struct grobo_joint_info {
    grobo_joint_state state; /**< last values; `valid` says which were ever read */
    int64_t angle_age_us;    /**< age of the angle, GROBO_NEVER_US if never read */
    int64_t full_age_us;     /**< age of the last full reading, GROBO_NEVER_US if never */
    double target_rad;       /**< last angle asked for, if has_target */
    int status;              /**< last reading: GROBO_OK, its error, or GROBO_ERR_EMPTY: none yet */
    bool has_target;         /**< false: nothing was asked of it since the link came up */
    bool torque_known;       /**< state.torque was read back or switched since the link came up */
    bool stands;             /**< it was read to stand since it was told anything: by two positions
                                  0.5 s apart and more, or at the goal that its servo has */
} grobo_joint_info;

/** Monotonic counters since grobo_robot_init(); those of the wire are in grobo_bus_stats. */
typedef struct grobo_robot_counters {
    uint64_t motion_frames; /**< frames that moved joints */
    uint64_t late_frames;   /**< played postures skipped, or sent too late */
    uint64_t clamped;       /**< targets moved to a limit */
    uint64_t stretched;     /**< targets given more time, being too fast for a joint */
    uint64_t stalls;        /**< times the host came later than stall_us */
    uint64_t trips;         /**< safety stops */
    uint64_t estops;        /**< emergency stops asked for */
    uint64_t lost_events;   /**< GROBO_EVENT_JOINT dropped, too many in one call */
} grobo_robot_counters;

/** How late motion frames left, in microseconds: quantiles of a histogram of fixed bins. */
typedef struct grobo_jitter {
    uint64_t frames;
    int64_t p50_us;
    int64_t p99_us;
    int64_t max_us;
} grobo_jitter;

GROBO_END_DECLS

#endif
