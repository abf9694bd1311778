/* SPDX-License-Identifier: MIT */
/**
 * @file static.h
 * @brief The engine in storage of one's own, pumped by oneself: for firmware and for loops that
 * are not libevent's.
 *
 * The sizes below change from version to version: link such a program statically (libgrobo-core.a,
 * libgrobo.a). A shared library of another version makes grobo_robot_init() refuse the engine.
 *
 * The owner of the line pumps the engine, when bytes came, a request was made or the deadline is
 * reached, always in this order:
 * @code
 *   grobo_robot_rx(&robot, bytes, n, now);                // what has arrived, first
 *   grobo_robot_step(&robot, now);                        // timeouts, frames that are due
 *   n = grobo_robot_tx(&robot, buf, sizeof buf, now);     // > 0: write buf, all of it
 *   wake_up_at(grobo_robot_deadline(&robot, now));        // <= now: again at once
 * @endcode
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_STATIC_H
#define GROBO_CORE_STATIC_H

#include <grobo/core/bus.h>
#include <grobo/core/imu.h>
#include <grobo/core/robot.h>
#include <grobo/core/sequencer.h>

GROBO_BEGIN_DECLS

/* ---- what is in an engine ------------------------------------------------------------------- */

/** Frames that the engine may have under way at a time: some families need one for each joint. */
#ifndef GROBO_ROBOT_SLOTS
#define GROBO_ROBOT_SLOTS (GROBO_JOINTS_MAX > 20 ? 3 * GROBO_JOINTS_MAX + 8 : 12)
#endif
/** Bytes of these frames, each as long as it is. Three of the longest are kept for halts. */
#ifndef GROBO_ROBOT_FRAMES_BYTES
#define GROBO_ROBOT_FRAMES_BYTES (8 * GROBO_FRAME_MAX_BYTES)
#endif
/** Events that may wait for the callback at a time. */
#define GROBO_ROBOT_EVENTS 32
/** Bins of the jitter histogram: four an octave, from 1 us to 65 ms. */
#define GROBO_ROBOT_JITTER_BINS 64

/**
 * The pump of an engine, as the engine sees it. A function that is NULL is not called. What they
 * call of the engine is grobo_robot_deadline() at most, and from `wake` the pump.
 */
typedef struct grobo_robot_host {
    /** The time of requests and questions, by the pump's clock. NULL: that of its last call. */
    int64_t (*clock)(void *ctx);
    /** A request was made: there may be a frame to send, an event to report or a sooner deadline.
     *  Where it is set no request reports events, only the pump does. Called without the lock. */
    void (*wake)(void *ctx);
    /** Was an emergency stop asked for that the pump has not carried out? Then what moves is
     *  refused as behind one that was. Called with the lock. */
    bool (*is_stopped)(void *ctx);
    /** May a latched stop be cleared? @return 0, or the error of grobo_robot_reset(). */
    int (*may_reset)(void *ctx);
    /** Where several threads use the engine: held during every call, but not during callbacks. A
     *  thread that has it may take it again. */
    void (*lock)(void *ctx);
    void (*unlock)(void *ctx);
    void *ctx; /**< handed to them */
} grobo_robot_host;

/** A step of a job. Private. */
typedef int (*grobo_robot_step_fn)(struct grobo_robot *robot);

/** What a frame does to joints, judged at the moment it leaves. Private. */
typedef struct grobo_robot_order {
    /* private */
    grobo_joint_mask joints; /* that it moves, switches, or leaves unknown */
    uint32_t number;         /* of its target, see grobo_robot_axis.next */
    int64_t asked_us;        /* a halt, torque: when it was asked for */
    uint8_t kind;            /* what it does; 0: nothing to any joint */
    uint8_t torque;          /* the grobo_torque that it switches to */
    uint8_t part;            /* which of the driver's frames for one joint */
    bool each;               /* more time only for joints that need it, not for all alike */
    bool soft;               /* slow, whenever it leaves: asked for as the first move */
    bool single;             /* from a stream of the caller's own */
    bool moves;              /* a stop must cancel it */
    bool stops;              /* leaves after a latched stop as well */
    bool rests;              /* ends a motion: joints come to rest near where they are by then */
    bool owed;               /* a halt from before a latch that sends nothing */
    bool stands;             /* its frame is of the goal as it was asked for */
} grobo_robot_order;

/** A frame under way. Private. */
typedef struct grobo_robot_slot {
    /* private */
    grobo_txn txn;
    grobo_robot_order order;
    struct grobo_robot *robot;
    int64_t due_us;   /* when it should leave; GROBO_NEVER_US: as soon as may be */
    int64_t given_us; /* when the bus got it */
    int64_t asked_us; /* when its first attempt left */
    int job;          /* number of the job whose step made it; 0: none */
#if GROBO_LINES_MAX > 1
    uint8_t line; /* that it is for */
#endif
    bool refused; /* at the moment it would have left */
    bool reads;   /* it asks where this joint is */
    bool many;    /* it asks where several are */
    bool fast;    /* which answer with one packet */
    uint8_t use;  /* 0: free */
    uint8_t joint;
    uint8_t kind, part;      /* of a reading: grobo_sense_kind, exchanges before this one */
    uint16_t room;           /* bytes of grobo_robot.frames that are its */
    grobo_joint_mask unread; /* of a reading of many joints, those that have not answered */
} grobo_robot_slot;

/** A move of a joint, straight in time. Private. */
typedef struct grobo_robot_trajectory {
    /* private */
    double from_rad, to_rad;
    int64_t from_us, to_us;
} grobo_robot_trajectory;

/** What is known of a joint. Private. */
typedef struct grobo_robot_axis {
    /* private */
    grobo_joint_state state;
    int64_t goal_us;                   /* when its goal was read back */
    int64_t own_until_us;              /* when the move that the servo told of is over */
    int64_t angle_us, full_us;         /* when read; GROBO_NEVER_US: never */
    int64_t torque_us;                 /* when its torque was, if that is known */
    int64_t gave_way_us;               /* in free mode: when a hand pushed or turned it last */
    int64_t current_since_us;          /* above its limit since; GROBO_NEVER_US: it is not */
    int64_t told_us;                   /* when a frame that moves or switches it left last */
    int64_t heard_us;                  /* its servo, with torque, answered what it was asked then */
    grobo_robot_trajectory trajectory; /* the move that the last frame sent it on */
    uint32_t last;                     /* number of the target that left last; 0: what had none */
    uint32_t next;                     /* number of the target that waits for the line; 0: none */
    double next_rad;                   /* that target */
    double seen_rad;      /* where it was, by a reading asked for since it was told last */
    int64_t seen_us;      /* when that was asked for */
    double away_rad;      /* in free mode: how far from its goal when it was read last */
    int64_t next_time_us; /* and its time, so far */
    int status;           /* of the last reading */
    uint16_t lost;        /* readings lost in a row */
    int16_t seen_dps;     /* how fast it turned at seen_us; INT16_MIN: not known */
    int64_t told_to_us;   /* in segments: until when on its trajectory the servo was told to go */
    uint8_t phase;        /* what moves it, as far as is known (src/robot/state.h) */
    bool torque_known;
    bool wants_torque; /* we switched it on: to be without is a fault */
    bool goal_is_read; /* its goal was read since it was told last */
    double still_rad;  /* the first of the positions that show that it stands */
    int64_t still_us;  /* when that came; GROBO_NEVER_US: none since it was told last */
    int64_t stood_us;  /* when the last of them was asked for */
    double load_rad;   /* goal less angle where it stood last: the error that carries its weight */
    bool load_is_sure; /* it was seen to stand so; else it may creep, and not by this program */
    uint8_t n_apart;   /* of one that follows: so often in a row it was read to be elsewhere */
    double before_rad; /* the angle read before, of a robot with joints that follow others */
    int64_t before_us; /* and when; GROBO_NEVER_US: there is none */
#if !GROBO_DRIVERS_PLAIN
    double block_rad, block_set_rad; /* where it was found to stand, and its set point then; */
    double block_load_rad;           /* its error, where that set point stood */
    double block_turned_rad;         /* grobo_robot.turned_rad then */
    double carried_rad;              /* the largest error that it was seen to stand with */
    double looked_rad;               /* where it was judged last */
    int64_t block_us;   /* when that was there last; GROBO_NEVER_US: nothing is known of it */
    double over_rad;    /* nearest to its set point since it is further away than weight has it, */
    int64_t over_us;    /* and when; GROBO_NEVER_US: it is not */
    int64_t looked_us;  /* when it was judged last */
    bool was_near;      /* it was seen nearer than that since it is */
    double apart_rad;   /* goal less angle of one that its servo tells no speed of, where it was */
    int64_t apart_us;   /* sent nowhere, and since when that is the same; 0: it was sent */
    double asked_rad_s; /* of a wheel: the speed asked for, */
    int64_t asked_until_us; /* and until when that holds */
    double told_rad_s;      /* the speed that a frame told it last, */
    int64_t told_speed_us;  /* and when that left */
    int64_t stalled_us;     /* it turns far too slowly since then; GROBO_NEVER_US: it does not */
#endif
} grobo_robot_axis;

/** A job that runs. Private. */
typedef struct grobo_robot_task {
    /* private */
    const grobo_robot_step_fn *script;
    int number;
    grobo_job_kind kind;
    unsigned at;             /* step of the script that comes next */
    uint8_t activity;        /* what the step before began */
    int result;              /* first error */
    int joint;               /* and its joint */
    double value;            /* and its value */
    grobo_joint_mask joints; /* asked for, and not superseded */
    grobo_joint_mask superseded;
    grobo_joint_mask todo;    /* of the activity */
    grobo_joint_mask pending; /* not yet as it was asked for */
    grobo_joint_mask failed;
    grobo_sense_kind sense; /* of the activity */
    grobo_torque torque;
    grobo_priority priority;
    grobo_posture target;
    int32_t joint_time_us[GROBO_JOINTS_MAX]; /* of a move joint by joint: as asked for each */
    grobo_clip clip;
    grobo_play_options options;
    grobo_robot_order order; /* of the frame that it asks with */
    int64_t settle_us;       /* silence that is needed after it */
    int64_t leave_by_us;     /* after that it does not leave; 0: always */
    int64_t sent_us;         /* when its target was given to the line last */
    int part;
    int rounds;      /* of repeating what was not taken */
    int restarts;    /* of all of it */
    uint32_t motion; /* number of the target that is read back */
    size_t reply_bytes;
    int64_t begun_us; /* when it started */
    int64_t until_us; /* end of waiting */
    int64_t bound_us; /* end of patience */
    bool lets_go;     /* by then its joints were told to be without torque */
    bool sits;        /* is on the trajectory down: halted where the bound is over */
    bool singly;      /* a move asked for joint by joint: each has its time, and fails alone */
    grobo_joint_mask turned; /* of such a move, joints that were given another target: sent next */
    grobo_joint_mask out;    /* of such a move, joints that have failed for good, */
    int out_result;          /* the first of them so, */
    int out_joint;           /* at this joint, */
    double out_value;        /* with this value */
} grobo_robot_task;

/** A move, a reading or torque on that waits for its turn. Private. */
typedef struct grobo_robot_request {
    /* private */
    int number;
    grobo_job_kind kind;
    grobo_joint_mask joints;
    grobo_sense_kind sense;
    int64_t begin_by_us;
    grobo_posture target;
    int32_t joint_time_us[GROBO_JOINTS_MAX]; /* of moves of single joints */
    bool singly;                             /* it is of such */
} grobo_robot_request;

#if GROBO_LINES_MAX > 1
/** A line of an engine behind the first one. Private. */
typedef struct grobo_robot_line {
    /* private */
    grobo_bus bus;
    int64_t left_us; /* when its last frame was given out */
    bool answered;   /* that was */
} grobo_robot_line;
#endif

/** A robot engine. Caller storage; read it through the functions below. */
struct grobo_robot {
    /* private */
    const grobo_driver *driver;
    void *driver_ctx;
    int (*leave)(grobo_robot_slot *slot); /* a frame would leave: judges it */
    void (*over)(grobo_robot_slot *slot, int result, const grobo_packet *reply); /* it is over */
    void (*each)(grobo_robot_slot *slot, const grobo_packet *reply); /* one of several replies */
    grobo_robot_host host;
    grobo_robot_config config; /* defaults filled in */
    grobo_event_fn on_event;
    void *event_ctx;
    grobo_bus bus;
    grobo_sequencer sequencer;
    grobo_sequencer_state told_state;             /* of the sequencer, to the callback */
    grobo_robot_task jobs[GROBO_ROBOT_JOBS];      /* where one runs, the first does */
    grobo_robot_task *job;                        /* of jobs: whose step runs, else the first */
    grobo_robot_request queue[GROBO_ROBOT_QUEUE]; /* the first is the oldest */
    unsigned queued;
    int slots_end; /* from here on all slots are free */
    grobo_robot_slot slots[GROBO_ROBOT_SLOTS];
    grobo_event events[GROBO_ROBOT_EVENTS]; /* ring */
    unsigned events_head, events_n;
    grobo_robot_counters counters;
    grobo_trip_info trip;
    uint64_t late_bins[GROBO_ROBOT_JITTER_BINS];
    int64_t late_max_us;
    int64_t now_us;         /* of the call that runs */
    int64_t left_us;        /* when the last frame was given out */
    int64_t soft_us;        /* grobo_robot_send(): when its first target is reached */
    int64_t sense_us;       /* when the background reads next */
    uint32_t motion;        /* number of the last target */
    int64_t renewed_us;     /* when the trajectories in segments were told further */
    int32_t renew_us;       /* how often they are: what the line can do, for these joints; */
    int32_t read_us;        /* how long a reading may have the line meanwhile */
    grobo_joint_mask paced; /* 0: not found yet */
    int64_t halt_us;        /* when the halts that are owed were asked for */
    int64_t hear_us;        /* joints that were not heard for long are not asked before */
    uint32_t told_item;     /* clip of the sequencer of which it was said that none watches it */
    uint32_t motion_us;     /* wire time of the last motion frames */
    grobo_joint_mask round; /* joints still to be read in this background round */
    grobo_joint_mask followers; /* joints that follow others */
    grobo_joint_mask free_joints;
    grobo_joint_mask clip_joints;   /* of the motion that is played, and those behind it */
    grobo_joint_mask played_joints; /* sent where they go by the sequencer */
    grobo_joint_mask other_round;   /* in free mode: of the joints that are not free */
    grobo_joint_mask renews_owed;   /* to be told more of their trajectories at once */
    grobo_joint_mask halts_owed;    /* to halt, and to be read before: their place is unknown */
    grobo_joint_mask heard_round;   /* of the joints that were not heard for long */
    grobo_joint_mask halted;        /* whose halt has left and was not read back yet */
    grobo_joint_mask halted_all;    /* and those of which it was, by the same stop */
    grobo_joint_mask halted_round;  /* of those that are read for it one by one */
    int64_t halted_us;              /* they are not asked before */
    int64_t halted_by_us;           /* nor after that */
    bool halted_read;               /* the last reading was for that */
#if !GROBO_DRIVERS_PLAIN
    grobo_joint_mask strained; /* further from their set point than their load explains */
    double turned_rad;         /* by all joints together, of those that are judged */
    int64_t line_us; /* in which all joints are read with half of the line's time; 0: not found */
    grobo_joint_mask wheels;
    grobo_joint_mask wheels_owed; /* turned when the line was lost */
    int64_t wheels_us;            /* when wheels that turn are told their speeds next, */
    int64_t wheels_told_us;       /* and were last */
    grobo_imu imu;                /* the latest reading, */
    int64_t imu_us;               /* when it was given */
    bool has_imu;
#endif
    int64_t stop_us; /* when the last exit or emergency stop was asked for; 0: none was */
    uint8_t reply[GROBO_FRAME_MAX_BYTES];
    grobo_exchange built;                     /* the frame that is being made */
    grobo_exchange asked;                     /* of the request that begins, */
    int asked_by;                             /* whose job has this number */
    uint8_t frames[GROBO_ROBOT_FRAMES_BYTES]; /* of the slots, one behind the other */
    size_t frames_used;
    double fault_deg;
    int fault_joint;
    int last_number;
    unsigned low_readings; /* of the voltage, in a row */
    unsigned depth;        /* calls into the engine, one inside another */
    int acting;            /* number of the job whose step runs; 0: none */
    bool other_read;       /* in free mode: the last reading was of a joint that is not free */
    uint8_t fast_lost;     /* readings of all in one packet that failed since one did not */
    bool fast_forgotten;   /* servos are asked again whether they answer so */
    bool heard_read;       /* the last reading was of a joint that was not heard for long */
    bool link;
    bool answered;      /* the last frame given out was: none of it waits any more */
    bool queue_may_go;  /* a job has ended since the queue was looked at */
    bool settling;      /* a motion is over, its end not yet looked at */
    bool soft;          /* the next move is the first from a sensed posture */
    bool stop_owed;     /* an emergency stop that no line has carried yet */
    bool holds_at_stop; /* the driver switches no torque: an emergency stop halts */
    bool in_segments;   /* a joint may be: whoever looks for one need not where none is */
#if GROBO_LINES_MAX > 1
    const struct grobo_lines *lines; /* NULL: there is one */
    uint8_t lines_gone;              /* bits of those that are down while others are there */
    uint8_t check_line;              /* that the check asks */
    uint8_t asked_line;              /* of `asked` */
    grobo_robot_line more[GROBO_LINES_MAX - 1];
#endif
    /* The last member: where the library makes an engine there are as many as its robot has joints
     * (grobo_i_robot_bytes()). */
    grobo_robot_axis axes[GROBO_JOINTS_MAX];
};

/* ---- its life and its pump ------------------------------------------------------------------ */

/**
 * Makes an engine in the caller's storage. The link counts as down until grobo_robot_link_up().
 * @param driver borrowed, checked with grobo_driver_check().
 * @param driver_ctx handed to the driver's functions; may be NULL.
 * @param config copied; NULL for all defaults.
 * @return 0, or GROBO_ERR_ARG (driver or a field of config out of its range; an engine of another
 *         size than the library's).
 */
#define grobo_robot_init(robot, driver, driver_ctx, config, now_us)                                \
    grobo_robot_init_sized(robot, sizeof(grobo_robot), driver, driver_ctx, config, now_us)
/** Of grobo_robot_init(). */
GROBO_API int grobo_robot_init_sized(grobo_robot *robot, size_t robot_bytes,
                                     const grobo_driver *driver, void *driver_ctx,
                                     const grobo_robot_config *config, int64_t now_us);

/** Sets the pump; copied, NULL: none. Before any request or question. */
GROBO_API void grobo_robot_set_host(grobo_robot *robot, const grobo_robot_host *host);

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
 * grobo_robot_rx() and grobo_robot_step() at once, for bytes that are all that had come by now_us.
 * Events are reported behind both, so that no callback keeps time from passing at now_us.
 */
GROBO_API void grobo_robot_rx_step(grobo_robot *robot, const uint8_t *bytes, size_t size,
                                   int64_t now_us);

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

GROBO_END_DECLS

#endif
