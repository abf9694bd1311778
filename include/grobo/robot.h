/* SPDX-License-Identifier: MIT */
/**
 * @file robot.h
 * @brief The robot engine: bytes and the time go in, bytes and the next deadline come out.
 *
 * No descriptor, clock, thread or allocation in here. Whoever owns the line pumps the engine,
 * whenever bytes came, a request was made or the deadline is reached, always in this order:
 * @code
 *   grobo_robot_rx(&robot, bytes, n, now);                // what has arrived, first
 *   grobo_robot_step(&robot, now);                        // timeouts, frames that are due
 *   n = grobo_robot_tx(&robot, buf, sizeof buf, now);     // > 0: write buf, all of it
 *   wake_up_at(grobo_robot_deadline(&robot, now));        // <= now: again at once
 * @endcode
 * session.h does that on an event_base, a test in virtual time.
 *
 * What the engine does is asked for by requests and told by one callback, grobo_event. Requests
 * return at once. Most are jobs: one runs at a time (a second is refused with GROBO_ERR_STATE),
 * each has a number > 0, and each ends with exactly one GROBO_EVENT_JOB of that number.
 * Playing is not a job: grobo_robot_play() prepares as a job, then the sequencer runs beside the
 * jobs until GROBO_EVENT_PLAY tells its end.
 *
 * Safety, on every path, judged as the bytes leave, by grobo_robot_tx():
 * - Every target is finite and within the joint's limits (refused, or clamped if so configured).
 * - No joint is asked to move faster than its limit: times are stretched, and counted.
 * - Nothing moves a joint whose posture was not sensed; the first move from there is slow, and so
 *   is the first after torque came on: a hand may have moved the joint.
 * - Before torque comes on, the goal is set to the present angle, and torque is read back after.
 * - Heat, current, low voltage, lost replies, torque lost in motion: stop, latched until
 *   grobo_robot_reset().
 * - While anything moves, each joint is read at least every GROBO_WATCH_US: a rate of frames that
 *   leaves no time for that is refused, and a reading that has waited too long goes first.
 * - A stalled host skips what is late; after a long stall the motion ends (GROBO_TRIP_HOST_STALL).
 * - grobo_robot_estop() is ahead of everything, read back joint by joint, latched.
 *
 * Not thread safe: one thread at a time per robot. Requests may be made from the callback.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_ROBOT_H
#define GROBO_ROBOT_H

#include <grobo/robot_config.h>
#include <grobo/robot_event.h>

GROBO_BEGIN_DECLS

/* ---- the engine ------------------------------------------------------------------------------ */

/** Frames that the engine may have under way at a time. */
#define GROBO_ROBOT_SLOTS 12
/** Events that may wait for the callback at a time. */
#define GROBO_ROBOT_EVENTS 32
/** Bins of the jitter histogram: four an octave, from 1 us to 65 ms. */
#define GROBO_ROBOT_JITTER_BINS 64

struct grobo_robot;

/** A step of a job. Private. */
typedef int (*grobo_robot_step_fn)(struct grobo_robot *robot);

/** What a frame does to joints, judged at the moment it leaves. Private. */
typedef struct grobo_robot_order {
    /* private */
    grobo_joint_mask joints; /* that it moves, switches, or leaves unknown */
    uint32_t number;         /* of its target, see grobo_robot_axis.next */
    int64_t asked_us;        /* a halt, torque: when it was asked for */
    uint8_t deed;            /* what it does; 0: nothing to any joint */
    uint8_t torque;          /* the grobo_torque that it switches to */
    uint8_t part;            /* which of the driver's frames for one joint */
    bool each;               /* more time only for joints that need it, not for all alike */
    bool soft;               /* slow, whenever it leaves: asked for as the first move */
    bool single;             /* from a stream of the caller's own */
    bool moves;              /* a stop must cancel it */
    bool stops;              /* leaves after a latched stop as well */
    bool rests;              /* ends a motion: joints come to rest near where they are by then */
} grobo_robot_order;

/** A frame under way. Private. */
typedef struct grobo_robot_slot {
    /* private */
    grobo_txn txn;
    grobo_exchange exchange;
    grobo_robot_order order;
    struct grobo_robot *robot;
    int64_t due_us;   /* when it should leave; GROBO_NEVER_US: as soon as may be */
    int64_t given_us; /* when the bus got it */
    int64_t asked_us; /* when its first attempt left */
    int job;          /* number of the job whose step made it; 0: none */
    bool refused;     /* at the moment it would have left */
    bool reads;       /* it asks where this joint is */
    bool many;        /* it asks where several are */
    uint8_t use;      /* 0: free */
    uint8_t joint;
    grobo_joint_mask unread; /* of a reading of many joints, those that have not answered */
} grobo_robot_slot;

/** A move of a joint, straight in time. Private. */
typedef struct grobo_robot_way {
    /* private */
    double from_rad, to_rad;
    int64_t from_us, to_us;
} grobo_robot_way;

/** What is known of a joint. Private. */
typedef struct grobo_robot_axis {
    /* private */
    grobo_joint_state state;
    int64_t goal_us;           /* when its goal was read back */
    int64_t own_until_us;      /* when the move that the servo told of is over */
    int64_t angle_us, full_us; /* when read; GROBO_NEVER_US: never */
    int64_t gave_way_us;       /* in free mode: when a hand pushed or turned it last */
    int64_t current_since_us;  /* above its limit since; GROBO_NEVER_US: it is not */
    int64_t told_us;           /* when a frame that moves or switches it left last */
    grobo_robot_way way;       /* the move that the last frame sent it on */
    uint32_t last;             /* number of the target that left last; 0: what had none */
    uint32_t next;             /* number of the target that waits for the line; 0: none */
    double next_rad;           /* that target */
    double away_rad;           /* in free mode: how far from its goal when it was read last */
    int64_t next_time_us;      /* and its time, so far */
    int status;                /* of the last reading */
    uint16_t lost;             /* readings lost in a row */
    int64_t told_to_us;        /* in segments: until when on its way the servo was told to go */
    bool in_segments;          /* it is told its way in parts */
    bool sensed;               /* since the link came up */
    bool has_target;           /* sent somewhere since then */
    bool torque_known;
    bool wants_torque; /* we switched it on: to be without is a fault */
    bool held;         /* goal read back to be the present angle: torque may come on */
    bool off_way;      /* read to be elsewhere: it lost the frame of its way */
    bool adrift;       /* moves though we sent it nowhere, and did not tell where to */
} grobo_robot_axis;

/** The job that runs. Private. */
typedef struct grobo_robot_task {
    /* private */
    const grobo_robot_step_fn *script;
    int number;
    grobo_job_kind kind;
    unsigned at;              /* step of the script that comes next */
    uint8_t activity;         /* what the step before began */
    int result;               /* first error */
    int joint;                /* and its joint */
    double value;             /* and its value */
    grobo_joint_mask joints;  /* asked for */
    grobo_joint_mask todo;    /* of the activity */
    grobo_joint_mask pending; /* not yet as it was asked for */
    grobo_joint_mask failed;
    grobo_sense_kind sense; /* of the activity */
    grobo_torque torque;
    grobo_priority priority;
    grobo_posture target;
    grobo_clip clip;
    grobo_play_options options;
    grobo_exchange exchange;
    grobo_robot_order order; /* of the exchange */
    int64_t leave_by_us;     /* after that it does not leave; 0: always */
    int part;
    int rounds;      /* of repeating what was not taken */
    int restarts;    /* of all of it */
    uint32_t motion; /* number of the target that is read back */
    size_t reply_bytes;
    int64_t begun_us; /* when it started */
    int64_t until_us; /* end of waiting */
    int64_t bound_us; /* end of patience */
} grobo_robot_task;

/** A robot engine. Caller storage; read it through the functions below. */
typedef struct grobo_robot {
    /* private */
    const grobo_driver *driver;
    void *driver_ctx;
    int (*leave)(grobo_robot_slot *slot); /* a frame would leave: judges it */
    void (*over)(grobo_robot_slot *slot, int result, const grobo_packet *reply); /* it is over */
    void (*each)(grobo_robot_slot *slot, const grobo_packet *reply); /* one of several replies */
    grobo_robot_config config;                                       /* defaults filled in */
    grobo_event_fn on_event;
    void *event_ctx;
    grobo_bus bus;
    grobo_sequencer sequencer;
    grobo_sequencer_state told_state; /* of the sequencer, to the callback */
    grobo_robot_task job;
    grobo_robot_axis axes[GROBO_JOINTS_MAX];
    grobo_robot_slot slots[GROBO_ROBOT_SLOTS];
    grobo_event events[GROBO_ROBOT_EVENTS]; /* ring */
    unsigned events_head, events_n;
    grobo_robot_counters counters;
    grobo_trip_info trip;
    uint64_t late_bins[GROBO_ROBOT_JITTER_BINS];
    int64_t late_max_us;
    int64_t now_us;         /* of the call that runs */
    int64_t soft_us;        /* grobo_robot_send(): when its first target is reached */
    int64_t sense_us;       /* when the background reads next */
    uint32_t motion;        /* number of the last target */
    int64_t renewed_us;     /* when the ways in segments were told further */
    uint32_t told_item;     /* clip of the sequencer of which it was said that none watches it */
    uint32_t motion_us;     /* wire time of the last motion frames */
    grobo_joint_mask round; /* joints still to be read in this background round */
    grobo_joint_mask free_joints;
    grobo_joint_mask played_joints; /* sent where they go by the sequencer */
    grobo_joint_mask other_round;   /* in free mode: of the joints that are not free */
    uint8_t reply[GROBO_FRAME_MAX_BYTES];
    double fault_deg;
    int fault_joint;
    int last_number;
    unsigned low_readings; /* of the voltage, in a row */
    unsigned depth;        /* calls into the engine, one inside another */
    int acting;            /* number of the job whose step runs; 0: none */
    bool other_read;       /* in free mode: the last reading was of a joint that is not free */
    bool link;
    bool settling;      /* a motion is over, its end not yet looked at */
    bool soft;          /* the next move is the first from a sensed posture */
    bool stop_owed;     /* an emergency stop that no line has carried yet */
    bool holds_at_stop; /* the driver switches no torque: an emergency stop halts */
} grobo_robot;

/**
 * Makes an engine in the caller's storage. The link counts as down until grobo_robot_link_up().
 * @param driver borrowed, checked with grobo_driver_check().
 * @param driver_ctx handed to the driver's functions; may be NULL.
 * @param config copied; NULL for all defaults.
 * @return 0, or GROBO_ERR_ARG (driver or a field of config out of its range).
 */
GROBO_API int grobo_robot_init(grobo_robot *robot, const grobo_driver *driver, void *driver_ctx,
                               const grobo_robot_config *config, int64_t now_us);

/** Who is told of events; on_event may be NULL. */
GROBO_API void grobo_robot_on_event(grobo_robot *robot, grobo_event_fn on_event, void *ctx);

/**
 * Changes the configuration (copied; NULL: all defaults); what is under way goes on under the new
 * one, and the line's physics stay as they are.
 * @return 0 or GROBO_ERR_ARG, then nothing changed.
 */
GROBO_API int grobo_robot_configure(grobo_robot *robot, const grobo_robot_config *config);

/** Bytes came from the line. */
GROBO_API void grobo_robot_rx(grobo_robot *robot, const uint8_t *bytes, size_t size,
                              int64_t now_us);

/**
 * Takes the next frame for the line, whole; it counts as sent at now_us, so take it only when the
 * line can take all of it and nothing waits before it. Frames are judged here: one that must not
 * leave any more is dropped and the next one is given. Calls nothing back; what that ends is told
 * by the next grobo_robot_step(), which grobo_robot_deadline() wants at once then.
 * @param capacity GROBO_FRAME_MAX_BYTES is always enough.
 * @return number of bytes, 0 for nothing now, GROBO_ERR_SPACE.
 */
GROBO_API int grobo_robot_tx(grobo_robot *robot, uint8_t *buf, size_t capacity, int64_t now_us);

/** Lets time pass: timeouts, frames that are due, sensing. Call at grobo_robot_deadline(). */
GROBO_API void grobo_robot_step(grobo_robot *robot, int64_t now_us);

/**
 * True if a frame that stops the robot (a halt, an emergency stop) could leave now, as far as the
 * wire is concerned. Where the line still holds bytes of an earlier frame back they are late, and
 * the owner of the line should drop them if it can.
 */
GROBO_API bool grobo_robot_stops(const grobo_robot *robot, int64_t now_us);

/**
 * When grobo_robot_step() and then grobo_robot_tx() are next wanted; GROBO_NEVER_US for not before
 * something else happens. After every call that may change anything, ask again.
 */
GROBO_API int64_t grobo_robot_deadline(const grobo_robot *robot, int64_t now_us);

/** The line is open: nothing moves; after a link_down the posture is sensed again. */
GROBO_API void grobo_robot_link_up(grobo_robot *robot, int64_t now_us);

/** The line is gone: the job ends with GROBO_ERR_UNPLUGGED, a motion fails with it too. */
GROBO_API void grobo_robot_link_down(grobo_robot *robot, int64_t now_us);

/* ---- requests --------------------------------------------------------------------------------
 * All return a job number > 0 or an error: GROBO_ERR_CLOSED (link down), GROBO_ERR_STATE (a job
 * is running), GROBO_ERR_LATCHED (tripped, for what would move or switch torque on),
 * GROBO_ERR_UNSUPPORTED (not in the driver), and what is said at each. */

/** Is the robot there? Result GROBO_ERR_TIMEOUT if nothing answers. */
GROBO_API int grobo_robot_check(grobo_robot *robot, int64_t now_us);

/** Reads joints; those that stay silent are in `failed`, the others are delivered. */
GROBO_API int grobo_robot_sense(grobo_robot *robot, grobo_joint_mask joints, grobo_sense_kind kind,
                                int64_t now_us);

/**
 * Switches torque and reads it back. ON: senses first, sets goal := present, then switches; a
 * joint that cannot be sensed stays as it is and is in `failed`.
 */
GROBO_API int grobo_robot_torque(grobo_robot *robot, grobo_joint_mask joints, grobo_torque mode,
                                 int64_t now_us);

/**
 * Moves the joints that `target` sets, in target->time_us or as much longer as is safe, then reads
 * them. Ends when they are there. Errors at once: GROBO_ERR_LIMIT, GROBO_ERR_NAN (see
 * grobo_robot_fault()), GROBO_ERR_ARG; later GROBO_ERR_SPEED: the wire has no time that is long
 * enough; also GROBO_ERR_STATE while a motion is played.
 */
GROBO_API int grobo_robot_move(grobo_robot *robot, const grobo_posture *target, int64_t now_us);

/**
 * Gives the move under way another target, which leaves next: the job ends when the joints are at
 * the target given last. For targets that come one after the other, each before the one before is
 * reached. What this target sets must include what the one before set; joints that it sets besides
 * must have been sensed and hold, as for grobo_robot_send().
 * @return the number of that job, or an error, and then the move is as it was: GROBO_ERR_STATE
 *         where no move is under way, or none that may be redirected yet: its first target waits to
 *         leave, or is the slow first one and was not read back. Others as grobo_robot_move().
 */
GROBO_API int grobo_robot_retarget(grobo_robot *robot, const grobo_posture *target, int64_t now_us);

/**
 * Sends a target once and lets go: no job, no event, nothing read before or after. For a control
 * loop of the caller's own, which calls it once a period; a target that still waits for the line
 * is replaced. The first ones go there at the approach speed. Joints must have been sensed and
 * hold (a sense and a torque job, once). The target is checked and timed as any other.
 * @return 0, or an error: GROBO_ERR_STATE while something else moves the robot (such as a move
 *         from before the line was there), a joint has no torque or is in free mode,
 *         GROBO_ERR_STALE for a joint not sensed, and those of grobo_robot_move().
 */
GROBO_API int grobo_robot_send(grobo_robot *robot, const grobo_posture *target, int64_t now_us);

/**
 * Sends a frame of the caller's as it is and waits for the reply it calls for, if any. The driver
 * reads its meaning first and it is checked as any other target, now and again when it leaves: by
 * then the job may end with GROBO_ERR_SPEED, _STALE, _STATE or _LATCHED, and nothing was sent. A
 * stop ends it with GROBO_ERR_CANCELED, if it moves. A joint in free mode is refused
 * (GROBO_ERR_STATE); what the driver cannot read is refused with GROBO_ERR_UNSUPPORTED unless
 * accept_unknown_raw: other motors than the model's, ids, directions, limits, flash and restarts,
 * motions of the board's own. After one that was accepted all joints must be read anew.
 */
GROBO_API int grobo_robot_raw(grobo_robot *robot, const uint8_t *frame, size_t size,
                              int64_t now_us);
/**
 * The same for who waits until until_us only: no attempt leaves after that; the job ends with
 * GROBO_ERR_STALE then.
 */
GROBO_API int grobo_robot_raw_until(grobo_robot *robot, const uint8_t *frame, size_t size,
                                    int64_t until_us, int64_t now_us);

/**
 * Reads (data NULL) or writes registers of a servo. Goal and torque registers are refused, and id,
 * direction and limits where the servo would jump: GROBO_ERR_STATE for a joint that holds,
 * GROBO_ERR_STALE for one not sensed.
 */
GROBO_API int grobo_robot_registers(grobo_robot *robot, const grobo_register_io *io,
                                    int64_t now_us);

/**
 * Flash, reboot or factory reset of one servo, with the silence it needs afterwards: nothing is
 * read in the background, and GROBO_ERR_STATE while anything moves.
 */
GROBO_API int grobo_robot_command(grobo_robot *robot, int id, grobo_servo_command command,
                                  int64_t now_us);

/** Starts a motion kept in the robot. Its targets are the robot's own: nothing checks them. Ends
 *  free mode; GROBO_ERR_STATE while anything moves. */
GROBO_API int grobo_robot_stored(grobo_robot *robot, grobo_stored_kind kind, int number,
                                 int64_t now_us);

/**
 * What servos do when a program ends: stops a motion, carries the policy out and reads it back,
 * within exit_bound_us. Takes the place of a job that runs (that one ends with
 * GROBO_ERR_CANCELED). Works when tripped; then GROBO_EXIT_SIT is carried out as GROBO_EXIT_HOLD.
 * @param policy GROBO_EXIT_DEFAULT: the configuration's.
 */
GROBO_API int grobo_robot_exit(grobo_robot *robot, grobo_exit_policy policy, int64_t now_us);

/**
 * Emergency stop: drops everything that waits, sends torque off or brake ahead of all else, reads
 * every joint back and repeats what did not take, for at most 10 s. Where the driver has no
 * `torque`, or that fails, all joints are halted and hold instead. Latched until
 * grobo_robot_reset(). Never refused but for GROBO_ERR_CLOSED, where it is latched all the same,
 * and carried out as soon as the line is there: so is one that the line was lost under.
 */
GROBO_API int grobo_robot_estop(grobo_robot *robot, int64_t now_us);

/**
 * Latches as grobo_robot_estop() does, and sends nothing: for a robot that another program has
 * stopped. @return 0, or GROBO_ERR_STATE while a move or a motion runs.
 */
GROBO_API int grobo_robot_latch(grobo_robot *robot, int64_t now_us);

/**
 * Takes back a latched stop. Nothing moves; the next move or play senses first.
 * @return 0, or GROBO_ERR_STATE while the emergency stop is still being carried out.
 */
GROBO_API int grobo_robot_reset(grobo_robot *robot, int64_t now_us);

/**
 * Ends the job with GROBO_ERR_CANCELED; a move stops where it is. An emergency stop cannot be
 * canceled. @return 0, or GROBO_ERR_STATE.
 */
GROBO_API int grobo_robot_cancel(grobo_robot *robot, int64_t now_us);

/* ---- playing --------------------------------------------------------------------------------- */

/**
 * Plays a clip: senses, switches torque on (unless manual_torque), goes softly to its first
 * posture, plays. The job GROBO_JOB_PLAY ends when the servos are known to be on their way there,
 * or could not be brought on it.
 * @param clip copied; what its ctx points to must live until GROBO_EVENT_PLAY tells the end.
 * @param options copied; NULL for all defaults. approach_deg_s 0 is the configuration's, rate_hz 0
 *        that of grobo_robot_budget(). A rate above watched_hz is refused with
 *        GROBO_ERR_UNWATCHED unless `unwatched`; then GROBO_EVENT_UNWATCHED comes when it begins.
 */
GROBO_API int grobo_robot_play(grobo_robot *robot, const grobo_clip *clip,
                               const grobo_play_options *options, int64_t now_us);

/**
 * Puts a clip behind the one being played; see grobo_sequencer_enqueue().
 * @return clips that wait, its errors, GROBO_ERR_UNWATCHED, or GROBO_ERR_STATE where the clip moves
 *         a joint that was not read or has no torque: name such joints in grobo_play_options.also
 *         of the first one.
 */
GROBO_API int grobo_robot_enqueue(grobo_robot *robot, const grobo_clip *clip,
                                  const grobo_play_options *options, int64_t now_us);

/** @name While playing: return 0, or GROBO_ERR_STATE if there is nothing to do that to. */
/**@{*/
GROBO_API int grobo_robot_pause(grobo_robot *robot, int64_t now_us);
GROBO_API int grobo_robot_resume(grobo_robot *robot, int64_t now_us);
/** Ends the motion: smoothly, or at the present posture at once. Also a move, what was only sent,
 *  and a raw frame that moves: their jobs end with GROBO_ERR_CANCELED. */
GROBO_API int grobo_robot_stop(grobo_robot *robot, bool at_once, int64_t now_us);
GROBO_API int grobo_robot_seek(grobo_robot *robot, int64_t clip_us, int64_t now_us);
/** @param speed_pct 1..1000 */
GROBO_API int grobo_robot_speed(grobo_robot *robot, int speed_pct, int64_t now_us);
/**@}*/

/* ---- free (teaching) mode ----------------------------------------------------------------------
 * A person moves the joints: after each reading a joint whose current is above its
 * grobo_joint.free_current_ma is braked, or one that turns at 8 deg/s and more while it holds and
 * is more than 2 degrees from its goal; one slower than 8 deg/s for 0.1 s holds again (protocol 5,
 * but for the second; there it is one reading, which for 20 joints is 0.15 s). Free joints are read
 * as often as the line allows, the others in sense_interval_us (a second where that is
 * GROBO_SENSE_NEVER), but not twice before a free one: their heat and voltage are watched. */

/**
 * Puts joints into free mode, or back: off is a job that makes them hold where they are.
 * @return 0 for on, a job number for off, or an error as for requests.
 */
GROBO_API int grobo_robot_free(grobo_robot *robot, grobo_joint_mask joints, bool on,
                               int64_t now_us);

/* ---- queries ------------------------------------------------------------------------------- */

/** What is known of a joint. @return 0 or GROBO_ERR_ARG. */
GROBO_API int grobo_robot_joint(const grobo_robot *robot, int joint, int64_t now_us,
                                grobo_joint_info *info);

/**
 * The posture sensed last; joints whose angle is older than max_age_us are not set.
 * @param max_age_us GROBO_NEVER_US: any age.
 * @return number of joints set.
 */
GROBO_API int grobo_robot_posture(const grobo_robot *robot, int64_t now_us, int64_t max_age_us,
                                  grobo_posture *posture);

/** The posture asked for last; joints never asked for are not set. @return joints set. */
GROBO_API int grobo_robot_target(const grobo_robot *robot, grobo_posture *posture);

/** True from the request that starts a motion until its last posture's time is over. */
GROBO_API bool grobo_robot_moving(const grobo_robot *robot, int64_t now_us);

/**
 * True from a motion's end until its last posture has been read back, and repeated where it was
 * lost. Any request ends that: wait for it where the robot has to be where it was sent.
 */
GROBO_API bool grobo_robot_settling(const grobo_robot *robot);

/** Kind of the job that runs, GROBO_JOB_NONE for none. */
GROBO_API grobo_job_kind grobo_robot_job(const grobo_robot *robot);

/** The latched stop, or trip GROBO_TRIP_NONE. */
GROBO_API void grobo_robot_tripped(const grobo_robot *robot, grobo_trip_info *info);

/** Joint and value that made the last request fail with LIMIT or NAN. @return joint or -1. */
GROBO_API int grobo_robot_fault(const grobo_robot *robot, double *value_deg);

/** The engine's counters. Borrowed, lives with the robot. */
GROBO_API const grobo_robot_counters *grobo_robot_get_counters(const grobo_robot *robot);

/** The wire's counters. Borrowed, lives with the robot. */
GROBO_API const grobo_bus_stats *grobo_robot_get_bus_stats(const grobo_robot *robot);

/** State of the sequencer. */
GROBO_API grobo_sequencer_state grobo_robot_play_state(const grobo_robot *robot);

/** True while a motion is under way: approached, played, paused or being stopped. */
GROBO_API bool grobo_robot_is_playing(const grobo_robot *robot);

/** True when no frame waits for the line and no reply is awaited. */
GROBO_API bool grobo_robot_is_quiet(const grobo_robot *robot);

/** Where the motion is. */
GROBO_API void grobo_robot_progress(const grobo_robot *robot, int64_t now_us,
                                    grobo_play_progress *progress);

/** The budget of its line. @return 0, or an error of the driver. */
GROBO_API int grobo_robot_budget(const grobo_robot *robot, grobo_budget *budget);

/** Lateness of motion frames since the last play began. */
GROBO_API void grobo_robot_jitter(const grobo_robot *robot, grobo_jitter *jitter);

/** The driver, and through it the model. */
GROBO_API const grobo_driver *grobo_robot_driver(const grobo_robot *robot);

GROBO_END_DECLS

#endif
