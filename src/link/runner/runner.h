/* SPDX-License-Identifier: MIT */
/*
 * The inside of a grobo_runner, each file below the next: wake.c the lock and who is in a round,
 * ring.c what is kept for who looks on, play.c what it has the engine do, events.c what the loop is
 * told, call.c its rounds and the calls of threads, state.c, line.c and motion.c the functions,
 * thread.c its life.
 *
 * `lock` guards what several threads touch; it is never held while anything is called that may
 * call back. What is marked 'loop' belongs to the thread that is in a round (`looping`), and goes
 * from one to the next with that mark.
 */
#ifndef GROBO_LINK_THREAD_I_H
#define GROBO_LINK_THREAD_I_H

#include <limits.h>
#include <stdatomic.h>

#include <event2/event.h>

#include <grobo/core/runner.h>

/* What a call's function returns while it is not over. */
#define CALL_PENDING INT_MIN

/* Some more than there are calls, so that nothing keeps a robot from being stopped or left. */
#define RUNNER_SLOTS (GROBO_RUNNER_CALLS_MAX + 4)

typedef enum call_state {
    CALL_FREE = 0,
    CALL_OPEN,    /* handed over, not over */
    CALL_RUNNING, /* its function runs */
    CALL_DONE
} call_state;

/* A job of the engine that a thread waits for, on that thread's stack. */
typedef struct runner_job {
    int (*start)(grobo_runner *runner, struct runner_job *job);
    bool urgent; /* must not be refused because too much is under way */
    int number;  /* 0: not begun */
    bool looked; /* the loop has had its turn */
    bool ended;
    bool direct;             /* reads alone: its caller may make the request */
    int result;              /* where its caller made it */
    struct runner_job *next; /* of those */
    uint64_t seen_losses;    /* of the line, when the call was made */
    int64_t begun_us;
    int64_t end_us;          /* when its caller stops waiting */
    grobo_joint_mask joints; /* what `start` needs */
    grobo_sense_kind sense;
    grobo_exit_policy policy;
    grobo_runner_fn request; /* of the user, where start calls it */
    void *request_arg;
} runner_job;

/* A thread that waits for the loop, or something posted. */
typedef struct runner_slot {
    call_state state;
    uint64_t ticket;    /* the order of the calls */
    grobo_runner_fn fn; /* returns CALL_PENDING to be called again */
    void *arg;
    const runner_job *job; /* arg, where fn waits for a job; NULL */
    int result;
    bool users;     /* fn is the user's */
    bool posted;    /* nobody waits */
    bool impatient; /* the caller wants to know when fn comes back */
} runner_slot;

/* Events of one sort, the oldest first. */
typedef struct runner_ring {
    struct runner_kept *kept; /* capacity of them */
    size_t head, n;
} runner_ring;

/* What is played; asked for: the engine has not taken it yet. */
typedef enum play_stage { PLAY_NONE = 0, PLAY_ASKED, PLAY_BEGUN } play_stage;

struct grobo_runner {
    const grobo_mem *mem;
    grobo_mutex lock;
    grobo_mutex engine;                /* of the session's engine */
    const char *_Atomic engine_thread; /* that has it; NULL: none */
    unsigned engine_depth;             /* under engine: how often */
    const grobo_driver *driver;
    grobo_runner_fn on_svc;
    grobo_session_config user; /* its callbacks */
    int64_t owner_timeout_us;
    int64_t timeout_us; /* where a call is given none */
    bool skip_exit;
    grobo_realtime realtime; /* of the thread that runs the loop for good */
    char name[GROBO_NAME_MAX_BYTES];

    /* under lock: whose turn it is */
    grobo_cond changed; /* a call is over, or the turn is free */
    int sleepers;       /* callers that sleep there */
    runner_slot slot[RUNNER_SLOTS];
    int slots_end;       /* behind the last that is not free */
    runner_job *waiting; /* begun by their callers, which sleep */
    uint64_t tickets;
    bool looping;    /* a thread is in a round */
    bool running;    /* the runner's thread, or somebody in grobo_runner_run() */
    bool ending;     /* it carries out the exit policy */
    bool freeing;    /* what is posted has its last turn */
    uint64_t ends;   /* how often it has ended */
    bool has_thread; /* to be joined */
    int granted;     /* what it asked of the system; CALL_PENDING: not answered */
    grobo_thread thread;

    /* by any thread */
    atomic_bool stopping;       /* its thread shall end; set under lock */
    atomic_int calls;           /* slots that are not free */
    atomic_bool woken;          /* the loop has been woken since it looked at the slots */
    _Atomic(int64_t) called_us; /* when another thread called last, where that counts */
    atomic_bool owner_lost;

    /* under lock: settings and the motion */
    char motion_dir[GROBO_PATH_MAX_BYTES];
    grobo_robot_config robot_config;
    int64_t period_us;
    grobo_motion *motion;

    /* under lock, written on the loop or by who asks */
    bool up;
    uint64_t losses;                             /* times the line was lost or closed */
    grobo_event_job job_ends[GROBO_RUNNER_ENDS]; /* a ring */
    unsigned next_end;
    _Atomic(play_stage) play; /* the loop looks at it without */
    int play_job, play_error;
    grobo_motion *playing; /* what the clip reads */
    grobo_clip clip;
    int motion_result; /* of the last move or motion */

    /* under lock: what is kept for who looks on */
    size_t capacity;            /* of each ring; 0: nothing is kept */
    runner_ring told, readings; /* the others, and JOINT and ROUND */
    uint64_t event_number;      /* of the last event */
    uint64_t taken_number;      /* of the last event taken */
    bool readable;              /* the socket has its byte */
    grobo_socket event_socket[2];

    /* loop */
    struct event_base *base;
    grobo_timer *timer;
    int64_t tick_us;        /* end of the period; GROBO_NEVER_US while nobody needs it */
    bool asked;             /* a call waits for more than the end of a job */
    grobo_session *session; /* set by grobo_runner_new() for good */
    int line_error;         /* of the last event of the line */
    bool exited;            /* the exit policy is carried out */
    uint64_t exit_frames;   /* and nothing was sent since these */
};

static inline grobo_robot *runner_robot(const grobo_runner *runner)
{
    return grobo_session_robot(runner->session);
}

/* ---- wake.c ---- */

/* A round that a thread is in. */
typedef struct round_frame {
    const grobo_runner *runner;
    const struct round_frame *outer;
} round_frame;

/* Around what a thread does in its turn. */
void grobo_i_runner_begin_round(round_frame *frame, const grobo_runner *runner);
void grobo_i_runner_end_round(const round_frame *frame);

/* True on the thread that is in a round of this runner. */
bool grobo_i_runner_inside(const grobo_runner *runner);

/* How other threads use the engine. It is never held while `lock` is taken. */
void grobo_i_runner_share(grobo_runner *runner);

/* Takes the lock, and takes note that somebody is there. */
void grobo_i_runner_lock(grobo_runner *runner);
void grobo_i_runner_unlock(grobo_runner *runner);

/* The whole of a function that returns what it looks up, or does, with the lock; `otherwise` where
 * there is no runner. */
#define RETURN_LOCKED(runner, type, otherwise, value)                                              \
    do {                                                                                           \
        if ((runner) == NULL) {                                                                    \
            return otherwise;                                                                      \
        }                                                                                          \
        grobo_i_runner_lock(runner);                                                               \
        type value_ = (value);                                                                     \
        grobo_i_runner_unlock(runner);                                                             \
        return value_;                                                                             \
    } while (0)

/* Copies with the lock. */
void grobo_i_runner_copy(grobo_runner *runner, void *to, const void *from, size_t size);

/* With the lock: has the loop look at its calls. */
void grobo_i_runner_wake(grobo_runner *runner);

/* With the lock, which is released meanwhile: sleeps until something has changed, or end_us. */
void grobo_i_runner_sleep(grobo_runner *runner, int64_t end_us);

/* With the lock: wakes everybody who sleeps. */
void grobo_i_runner_wake_all(grobo_runner *runner);

/* ---- ring.c ---- */

/* Makes and frees what keeps events. */
int grobo_i_runner_ring_new(grobo_runner *runner, size_t capacity);
void grobo_i_runner_ring_free(grobo_runner *runner);

/* On the loop: keeps an event, where any are. */
void grobo_i_runner_keep(grobo_runner *runner, const grobo_runner_event *event);

/* ---- events.c ---- */

/* The session's callbacks; their ctx is the runner. */
void grobo_i_runner_on_event(void *ctx, grobo_session *session, grobo_session_event event,
                             int error);
void grobo_i_runner_on_robot(void *ctx, const grobo_event *event);
void grobo_i_runner_on_tap(void *ctx, grobo_direction direction, int64_t now_us,
                           const uint8_t *bytes, size_t size);

/* On the loop: the line is down. */
void grobo_i_runner_down(grobo_runner *runner, int error);

/* On the loop: true if the exit policy is carried out and nothing was done since. */
bool grobo_i_runner_has_exited(grobo_runner *runner);

/* ---- play.c ---- */

/* With the lock: how a job has ended for these joints, of which others may have joined it; 0: for
 * all. CALL_PENDING: its end was not told, or is forgotten. */
int grobo_i_runner_end_of_job(const grobo_runner *runner, int number, grobo_joint_mask joints);

/* With the lock: a job has ended. @return true if its caller sleeps until then. */
bool grobo_i_runner_end_job(grobo_runner *runner, const grobo_event_job *ended);

/* Has the engine play the motion that is `playing`. */
int grobo_i_runner_play(grobo_runner *runner, const grobo_play_options *options);

/* On the loop: looks whether what is played is over. */
void grobo_i_runner_look_at_play(grobo_runner *runner);

/* Frees what was played. */
void grobo_i_runner_release_clip(grobo_runner *runner);

/* ---- call.c ---- */

/* A round of the loop, at most until end_us. Whoever calls has `looping`. */
void grobo_i_runner_round(grobo_runner *runner, int64_t end_us);

/* The same for a thread that found nobody in one. With the lock, which is given back meanwhile. */
void grobo_i_runner_take_turn(grobo_runner *runner, int64_t end_us);

/* What was posted and has not had its turn has it; no more is taken. */
void grobo_i_runner_end_calls(grobo_runner *runner);

/* Hands over. */
int grobo_i_runner_call(grobo_runner *runner, grobo_runner_fn fn, void *arg);

/* Hands over and waits; refused in a callback. */
int grobo_i_runner_wait(grobo_runner *runner, grobo_runner_fn fn, void *arg, int64_t timeout_us);

/* Hands over a job, after those before it, and waits for its end. */
int grobo_i_runner_job(grobo_runner *runner, runner_job *job, int64_t timeout_us);

/* ---- state.c ---- */

/* With the lock: the time of postures whose own is 0. */
int64_t grobo_i_runner_default_us(const grobo_runner *runner);

/* ---- line.c ---- */

/*
 * Carries out the exit policy where there is a robot, after an emergency stop that is being carried
 * out. Waits. @param[out] looked false: the loop has had no turn; then the exit is posted.
 */
int grobo_i_runner_leave(grobo_runner *runner, int64_t timeout_us, bool *looked);

#endif
