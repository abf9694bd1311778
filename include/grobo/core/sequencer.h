/* SPDX-License-Identifier: MIT */
/**
 * @file sequencer.h
 * @brief Plays clips: the time goes in, target postures and the next deadline come out.
 *
 * No clock, no memory, no I/O. A caller asks grobo_sequencer_deadline(), waits for it in its own
 * way, and takes what is due:
 *
 *     while ((r = grobo_sequencer_next(&seq, now_us, &frame)) > 0) send(&frame);
 *
 * Deadlines are absolute. A caller that comes late gets the posture of the present, once; what it
 * missed is counted and never sent after it.
 *
 * Two ways to play. By keys: one frame a key posture, given when the move to it begins; the
 * servos make the way in the frame's time. At a rate: frame i leaves at start + i/rate and carries
 * the posture of that instant, to be reached within one period.
 *
 * Before the first posture of a clip, of a repetition and after a seek lies an approach: one frame
 * whose time lets no joint move faster than the approach speed. It always gets its full time.
 *
 * A position counts in motion time from the beginning of one pass in playing direction, so that
 * 0 is where a reversed clip starts as well; real time is that divided by speed_pct/100. A
 * sequencer belongs to one thread at a time.
 * NULL where something must be is GROBO_ERR_ARG (error.h).
 */
#ifndef GROBO_CORE_SEQUENCER_H
#define GROBO_CORE_SEQUENCER_H

#include <grobo/clip.h>

GROBO_BEGIN_DECLS

/** Default of grobo_play_options.rate_hz; of a robot, where its line allows it: grobo_budget. */
#define GROBO_PLAY_RATE_HZ 50
/** Largest grobo_play_options.rate_hz. */
#define GROBO_PLAY_RATE_MAX_HZ 1000
/** Largest speed_pct. */
#define GROBO_PLAY_SPEED_MAX_PCT 1000
/** Default of grobo_play_options.approach_deg_s: a tenth of what the servos can do. */
#define GROBO_PLAY_APPROACH_DEG_S 60
/** How far a joint is taken to be from its goal when its place is unknown. */
#define GROBO_PLAY_UNKNOWN_DEG 180
/** Default of grobo_play_options.stop_us. */
#define GROBO_PLAY_STOP_US 200000
/** Default of grobo_play_options.late_us. */
#define GROBO_PLAY_LATE_US 5000
/** Unit of a frame's time: register No.32-33 counts 10 ms (protocol 4). */
#define GROBO_PLAY_TIME_UNIT_US 10000
/** Longest time of a frame: 16383 units (protocol 4). A longer move is made in this time. */
#define GROBO_PLAY_TIME_MAX_US (16383LL * GROBO_PLAY_TIME_UNIT_US)

/** Longest clip that is played, 115 days: times at any speed and rate fit into 64 bits. */
#define GROBO_PLAY_LENGTH_MAX_US INT64_C(10000000000000)

/** What a sequencer is doing. */
typedef enum grobo_sequencer_state {
    GROBO_SEQUENCER_IDLE = 0,    /**< nothing to play, or stopped */
    GROBO_SEQUENCER_APPROACHING, /**< on the way to where playing begins */
    GROBO_SEQUENCER_PLAYING,     /**< in the motion */
    GROBO_SEQUENCER_PAUSED,      /**< holding, may continue */
    GROBO_SEQUENCER_STOPPING,    /**< on the way to standstill, then IDLE */
    GROBO_SEQUENCER_FINISHED,    /**< the last posture of the last clip is reached */
    GROBO_SEQUENCER_FAILED       /**< a clip failed or grobo_sequencer_fail() was called */
} grobo_sequencer_state;

/** Number of states; they count from 0. */
#define GROBO_SEQUENCER_STATES 7

/** How a clip is turned into frames. */
typedef enum grobo_play_mode {
    GROBO_PLAY_KEY = 0, /**< a frame a key posture */
    GROBO_PLAY_RATE = 1 /**< frames at a fixed rate */
} grobo_play_mode;

/** grobo_play_options.start_us of a motion whose start is set after its approach. */
#define GROBO_START_LATER (GROBO_NEVER_US / 2)

/** How to play a clip. Zero: once, by keys, forward, at its own speed. A sequencer does not look at
 *  `size`; grobo_robot_play() and whatever plays by it do. */
typedef struct grobo_play_options {
    size_t size; /**< GROBO_PLAY_OPTIONS_INIT */
    grobo_play_mode mode;
    bool reverse;            /**< from the last posture to the first */
    bool mirror;             /**< left for right, by the model's table */
    int32_t repeat;          /**< passes: 0 and 1 one, n > 1 n, negative -n in reverse */
    uint16_t speed_pct;      /**< 1..1000, 0: 100 */
    uint16_t rate_hz;        /**< RATE: 1..1000, 0: 50, or for a robot what its line allows */
    uint16_t approach_deg_s; /**< speed of approaches, 0: 60 */
    int64_t from_us;         /**< position at which the first pass begins, 0..total */
    int64_t start_us;        /**< when it begins, on the clock of the caller: what has approached
                                  sooner waits, what is late begins at once. 0: at once. So several
                                  robots on one clock begin together. GROBO_START_LATER: it waits
                                  for grobo_robot_start_at() */
    int64_t default_time_us; /**< KEY: time of keys that give none, 0: 100 ms */
    int64_t stop_us;         /**< time for pausing and stopping smoothly, 0: 200 ms */
    int64_t late_us;         /**< a frame taken later than this after its time is late, 0: 5 ms */
    grobo_joint_mask also;   /**< grobo_robot_play(): joints of clips to be queued behind this one,
                                  read and switched on with its own */
    bool unwatched;          /**< for a robot: a rate above grobo_budget.watched_hz is accepted, and
                                  no reading goes before a frame. Heat, current and lost torque
                                  may then stop nothing before the motion ends */
} grobo_play_options;
/** Begins an initializer of one. */
#define GROBO_PLAY_OPTIONS_INIT GROBO_SIZED(grobo_play_options)

/** How often grobo_play_options.repeat plays a clip: at least once. Thread safe. */
GROBO_API int32_t grobo_play_passes(int32_t repeat);

/** What is to be sent now. */
typedef struct grobo_play_frame {
    grobo_posture posture;       /**< joints the clip has set so far, and the time to get there:
                                      a multiple of the unit except for rates, never 0 */
    int64_t due_us;              /**< when it should have been taken; it never runs backwards */
    uint32_t skipped;            /**< frames skipped just before this one; then the way may be
                                      too long for the time: an owner with limits stretches it */
    grobo_sequencer_state phase; /**< APPROACHING, PLAYING, or PAUSED and STOPPING for a hold */
} grobo_play_frame;

/** Where a sequencer is. */
typedef struct grobo_play_progress {
    grobo_sequencer_state state;
    int error;        /**< why FAILED, else 0 */
    uint32_t item;    /**< clips started since grobo_sequencer_init(), the present one included */
    int32_t pass;     /**< 1..passes */
    int32_t passes;   /**< of the present clip */
    int64_t t_us;     /**< position in this pass */
    int64_t total_us; /**< length of a pass */
    uint64_t step;    /**< frames of this pass given or skipped */
    uint64_t steps;   /**< frames of a whole pass: keys, or frames at the rate */
    unsigned queued;  /**< clips that wait */
    bool ready;       /**< grobo_robot_progress(), of GROBO_START_LATER: it has approached, and
                           waits for its start */
} grobo_play_progress;

/** Counters; monotonic, wrap. */
typedef struct grobo_play_stats {
    uint32_t frames;         /**< given */
    uint32_t late_frames;    /**< given late, or skipped */
    uint32_t skipped_frames; /**< never given: their time had passed */
    int64_t max_late_us;     /**< worst lateness of a frame given */
} grobo_play_stats;

/** A clip with its options, as it waits. */
typedef struct grobo_play_item {
    /* private */
    grobo_play_options options; /* defaults filled in */
    int64_t span_us;            /* length of a pass */
    int64_t first_key_us;       /* KEY: time of key 0 in the clip */
    const grobo_model *model;   /* that of the sequencer */
    grobo_clip clip;
} grobo_play_item;

/** Where among its keys a clip is. */
typedef struct grobo_play_key {
    /* private */
    size_t i;        /* key */
    size_t defaults; /* keys 0..i without a time of their own */
    int64_t at_us;   /* its time in the clip, times of keys without one added */
    bool is_empty;   /* it sets no joint */
} grobo_play_key;

/** A sequencer. Caller storage; read it through the functions below. */
typedef struct grobo_sequencer {
    /* private; small members first, where a Cortex-M0 reaches them in one instruction */
    grobo_sequencer_state state;
    bool waits;                  /* a frame of the present move is still to be given */
    bool late;                   /* that frame is being taken late */
    bool silent;                 /* KEY: the present move sets no joint, there is no frame */
    uint8_t queue_head, queue_n; /* GROBO_QUEUE_MAX is below 256 */
    int error;
    uint32_t skipped;
    int64_t now_us;                   /* of the call that is running */
    int64_t from_us, to_us;           /* real times at which the present move begins and ends */
    int64_t due_us;                   /* of the frame that waits */
    int64_t anchor_us, anchor_pos_us; /* a real time and the position that belongs to it */
    int64_t grid_us;                  /* RATE: of the frame behind the one that waits */
    uint32_t grid_rest; /* RATE: part of a microsecond that grid_us lacks, x rate_hz */
    int32_t pass;
    grobo_play_item item; /* being played */
    const grobo_model *model;
    uint32_t n_items;
    grobo_play_key key; /* KEY: what `to` stands for, or where it lies behind */
    grobo_play_stats stats;
    grobo_posture from;                     /* where the move began: all joints that are known */
    grobo_posture to;                       /* where it ends: joints the clip has set so far */
    grobo_posture base;                     /* where a relative clip starts */
    grobo_play_item queue[GROBO_QUEUE_MAX]; /* ring */
} grobo_sequencer;

/**
 * Makes an idle sequencer.
 * @param model table of the robot, borrowed; NULL: any number of joints, but no mirror.
 */
GROBO_API void grobo_sequencer_init(grobo_sequencer *seq, const grobo_model *model);

/**
 * Starts a clip; from IDLE and FINISHED. By keys it goes through all of them once, so that a clip
 * with a bad key never starts.
 * @param clip copied; its ctx is borrowed until the clip is over. In RATE mode a relative clip's
 *        sample() gives the way from where it starts.
 * @param options NULL: all defaults
 * @param start where the robot is, for the approach and for relative clips, copied. Joints not in
 *        it are taken to be GROBO_PLAY_UNKNOWN_DEG away. NULL: no approach, the first posture
 *        is taken in its own time.
 * @return 0, GROBO_ERR_STATE, GROBO_ERR_EMPTY (no keys, or a relative clip without start),
 *         GROBO_ERR_ARG (an option out of range, numbers of joints that differ, times that do not
 *         rise), GROBO_ERR_UNSUPPORTED (RATE without sample, mirror without model),
 *         GROBO_ERR_NAN, GROBO_ERR_CAP (longer than GROBO_PLAY_LENGTH_MAX_US), or what the clip
 *         said. On error nothing has changed.
 */
GROBO_API int grobo_sequencer_play(grobo_sequencer *seq, const grobo_clip *clip,
                                   const grobo_play_options *options, const grobo_posture *start,
                                   int64_t now_us);

/**
 * Puts a clip behind what is being played, with an approach between; while APPROACHING, PLAYING
 * or PAUSED. A relative clip starts where the one before ended.
 * @return clips that now wait, GROBO_ERR_STATE, GROBO_ERR_FULL, or as grobo_sequencer_play().
 */
GROBO_API int grobo_sequencer_enqueue(grobo_sequencer *seq, const grobo_clip *clip,
                                      const grobo_play_options *options);

/**
 * Holds: one frame brings the robot to rest a little further on its way within stop_us; playing
 * continues from there. While APPROACHING or PLAYING.
 * @return 0, GROBO_ERR_STATE, or the error of the clip (then FAILED).
 */
GROBO_API int grobo_sequencer_pause(grobo_sequencer *seq, int64_t now_us);

/** Continues after a pause. @return 0, GROBO_ERR_STATE, or the error of the clip (then FAILED). */
GROBO_API int grobo_sequencer_resume(grobo_sequencer *seq, int64_t now_us);

/**
 * Ends playing and empties the queue; while APPROACHING, PLAYING, PAUSED or STOPPING.
 * @param at_once false: as grobo_sequencer_pause(), over within stop_us. true: hold at the present
 *        posture within one time unit.
 * @return 0, GROBO_ERR_STATE, or the error of the clip (then FAILED).
 */
GROBO_API int grobo_sequencer_stop(grobo_sequencer *seq, bool at_once, int64_t now_us);

/**
 * Moves to a position of the present pass, softly; PAUSED stays PAUSED until resumed.
 * @param pos_us 0..total. While APPROACHING, PLAYING or PAUSED.
 * @return 0, GROBO_ERR_STATE, GROBO_ERR_ARG, or the error of the clip (then FAILED).
 */
GROBO_API int grobo_sequencer_seek(grobo_sequencer *seq, int64_t pos_us, int64_t now_us);

/**
 * Sets the speed of the present clip from now on; while APPROACHING, PLAYING or PAUSED.
 * Approaches keep their speed.
 * @return 0, GROBO_ERR_STATE, GROBO_ERR_ARG, or the error of the clip (then FAILED).
 */
GROBO_API int grobo_sequencer_set_speed(grobo_sequencer *seq, int speed_pct, int64_t now_us);

/** True while a motion with GROBO_START_LATER has approached, and waits for its start. */
GROBO_API bool grobo_sequencer_is_ready(const grobo_sequencer *seq);

/**
 * Tells such a motion when to begin.
 * @return 0, GROBO_ERR_ARG, GROBO_ERR_STATE (it is not ready), or GROBO_ERR_STALE: that time is
 *         over, and it keeps waiting.
 */
GROBO_API int grobo_sequencer_start_at(grobo_sequencer *seq, int64_t start_us, int64_t now_us);

/** Gives up with a reason < 0: a frame was refused, the link is gone. Not from IDLE. */
GROBO_API int grobo_sequencer_fail(grobo_sequencer *seq, int error);

/** Forgets everything but the counters; IDLE from any state. No frame is given. */
GROBO_API void grobo_sequencer_reset(grobo_sequencer *seq);

/**
 * Gives what is due at now_us. Call again until it returns 0.
 * @param[out] frame untouched unless 1 is returned
 * @return 1 a frame, 0 nothing due, or the error of the clip, once, on the way to FAILED.
 */
GROBO_API int grobo_sequencer_next(grobo_sequencer *seq, int64_t now_us, grobo_play_frame *frame);

/** When grobo_sequencer_next() has something to do; GROBO_NEVER_US when it waits for a command. */
GROBO_API int64_t grobo_sequencer_deadline(const grobo_sequencer *seq);

/** State. */
GROBO_API grobo_sequencer_state grobo_sequencer_get_state(const grobo_sequencer *seq);
/** Name of a state, lower case: "playing". Static. */
GROBO_API const char *grobo_sequencer_state_name(grobo_sequencer_state state);
/** True if a sequencer may go from one state to another (staying is no transition). */
GROBO_API bool grobo_sequencer_may_go(grobo_sequencer_state from, grobo_sequencer_state to);
/** Where it is at now_us. */
GROBO_API void grobo_sequencer_progress(const grobo_sequencer *seq, int64_t now_us,
                                        grobo_play_progress *progress);
/** Counters since grobo_sequencer_init(). Borrowed, lives with the sequencer. */
GROBO_API const grobo_play_stats *grobo_sequencer_stats(const grobo_sequencer *seq);

GROBO_END_DECLS

#endif
