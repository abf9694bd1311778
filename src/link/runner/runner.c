/* SPDX-License-Identifier: MIT */
/* The life of a runner, and its thread. */
#include <string.h>

#include "src/base/sized.h"
#include "src/link/runner/runner.h"
#include "src/link/serial/loop.h"
#include "src/link/session/session.h"

/* Longest and shortest period. */
#define PERIOD_MIN_US 1000
#define PERIOD_MAX_US 1000000

/* How long the exit policy may take beyond the engine's own bound for it. */
#define EXIT_SPARE_US INT64_C(5000000)
/* That bound where none is configured (robot.h). */
#define EXIT_BOUND_US INT64_C(10000000)

/* ---- its period --------------------------------------------------------------------------- */

/* The exit policy, when nobody has called for too long: who should is gone. */
static void look_for_owner(grobo_runner *runner, int64_t now_us)
{
    bool lost = false;

    if (runner->owner_timeout_us <= 0) {
        return;
    }
    grobo_i_runner_lock(runner);
    if (runner->sleepers > 0) {
        atomic_store(&runner->called_us, now_us); /* who waits is there */
    }
    if (!atomic_load(&runner->owner_lost) &&
        now_us - atomic_load(&runner->called_us) >= runner->owner_timeout_us) {
        lost = true;
        atomic_store(&runner->owner_lost, true);
    }
    grobo_i_runner_unlock(runner);
    if (lost && !grobo_i_runner_has_exited(runner)) {
        (void)grobo_session_post_exit(runner->session, GROBO_EXIT_DEFAULT);
    }
}

static void on_time(void *ctx, grobo_timer *timer, int64_t late_us)
{
    grobo_runner *runner = ctx;
    int64_t now_us = grobo_now_us();

    (void)timer;
    (void)late_us;
    look_for_owner(runner, now_us);
    if (now_us < runner->tick_us) {
        return; /* the end of somebody's patience */
    }
    runner->tick_us += runner->period_us;
    if (runner->tick_us <= now_us) {
        /* Late: skipped, not made up for. */
        runner->tick_us = now_us + runner->period_us;
    }
    if (runner->on_svc != NULL) {
        int64_t since_us = grobo_i_session_enter_callback(runner->session);

        (void)runner->on_svc(runner->user.ctx, runner);
        grobo_i_session_leave_callback(runner->session, GROBO_CALLBACK_SVC, since_us);
    }
}

/* ---- the thread --------------------------------------------------------------------------- */

static int64_t exit_timeout(grobo_runner *runner)
{
    int64_t bound_us;

    grobo_i_runner_copy(runner, &bound_us, &runner->robot_config.exit_bound_us, sizeof bound_us);
    bound_us = bound_us > 0 ? bound_us : EXIT_BOUND_US;
    return bound_us < GROBO_NEVER_US - EXIT_SPARE_US ? bound_us + EXIT_SPARE_US : GROBO_NEVER_US;
}

/* The body of the runner's thread; `running` is set. */
static void run(grobo_runner *runner)
{
    bool looked;

    grobo_mutex_lock(&runner->lock);
    while (runner->looping && !runner->stopping) {
        /* Whoever is in a round gives the turn to us after it. */
        grobo_cond_wait(&runner->changed, &runner->lock, GROBO_NEVER_US);
    }
    if (!runner->looping) {
        runner->looping = true;
        grobo_mutex_unlock(&runner->lock);
        while (!atomic_load(&runner->stopping)) {
            grobo_i_runner_round(runner, GROBO_NEVER_US);
        }
        grobo_mutex_lock(&runner->lock);
        runner->looping = false;
    }
    runner->running = false;
    runner->ending = true;
    grobo_i_runner_wake_all(runner);
    grobo_mutex_unlock(&runner->lock);
    /* Told to nobody: a robot that cannot be left well has been told of by its events. */
    (void)grobo_i_runner_leave(runner, exit_timeout(runner), &looked);
    grobo_mutex_lock(&runner->lock);
    runner->ending = false;
    runner->ends++;
    grobo_i_runner_wake_all(runner);
    grobo_mutex_unlock(&runner->lock);
}

static GROBO_THREAD_FUNC thread_execution(void *arg)
{
    grobo_runner *runner = arg;
    int granted = grobo_thread_realtime(&runner->realtime);

    grobo_mutex_lock(&runner->lock);
    runner->granted = granted;
    grobo_i_runner_wake_all(runner);
    grobo_mutex_unlock(&runner->lock);
    if (granted >= 0) {
        run(runner);
    }
    GROBO_THREAD_RETURN;
}

/* With the lock, which is given back meanwhile: what the system says to the thread's wish. */
static int await_grant(grobo_runner *runner)
{
    const grobo_realtime *how = &runner->realtime;

    if (how->policy == GROBO_REALTIME_NONE && how->cpus == 0 && !how->mlock) {
        return GROBO_OK; /* it asks for nothing */
    }
    while (runner->granted == CALL_PENDING) {
        grobo_cond_wait(&runner->changed, &runner->lock, GROBO_NEVER_US);
    }
    return runner->granted;
}

/* With the lock, which is given back meanwhile: joins a thread that has ended. */
static void join(grobo_runner *runner)
{
    if (runner->has_thread) {
        grobo_thread thread = runner->thread;

        runner->has_thread = false;
        grobo_mutex_unlock(&runner->lock);
        (void)grobo_thread_join(thread);
        grobo_mutex_lock(&runner->lock);
    }
}

int grobo_runner_start(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_runner_lock(runner);
    if (!runner->running && !runner->ending) {
        runner->running = true;
        runner->stopping = false;
        join(runner); /* one that was stopped in a callback */
        runner->granted = CALL_PENDING;
        r = grobo_thread_start(&runner->thread, thread_execution, runner);
        runner->has_thread = r >= 0;
        r = r < 0 ? r : await_grant(runner);
        if (r < 0) {
            runner->running = false;
            grobo_i_runner_wake_all(runner); /* whoever waits for its end already */
            join(runner);
        }
    }
    grobo_i_runner_unlock(runner);
    return r;
}

int grobo_runner_run(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    if (grobo_i_runner_inside(runner)) {
        return GROBO_ERR_STATE;
    }
    grobo_i_runner_lock(runner);
    bool mine = !runner->running && !runner->ending;
    if (mine) {
        runner->running = true;
        runner->stopping = false;
    }
    grobo_i_runner_unlock(runner);
    if (!mine) {
        return GROBO_ERR_STATE;
    }
    int r = grobo_thread_realtime(&runner->realtime);

    if (r >= 0) {
        run(runner);
        return GROBO_OK;
    }
    grobo_i_runner_lock(runner);
    runner->running = false;
    grobo_i_runner_wake_all(runner);
    grobo_i_runner_unlock(runner);
    return r;
}

/* With the lock: waits until the thread has ended; another may have been started by then. */
static void await_end(grobo_runner *runner)
{
    uint64_t ends = runner->ends;

    while ((runner->running || runner->ending) && runner->ends == ends) {
        grobo_i_runner_sleep(runner, GROBO_NEVER_US);
    }
    if (!runner->running && !runner->ending) {
        join(runner);
    }
}

int grobo_runner_stop(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_runner_lock(runner);
    if (runner->running || runner->ending) {
        runner->stopping = true;
        grobo_i_runner_wake_all(runner);
        grobo_i_runner_wake(runner);
        r = GROBO_OK;
        if (!grobo_i_runner_inside(runner)) {
            await_end(runner);
        }
    }
    grobo_i_runner_unlock(runner);
    return r;
}

bool grobo_runner_is_active(grobo_runner *runner)
{
    RETURN_LOCKED(runner, bool, false, runner->running && !runner->stopping);
}

int grobo_runner_thread(grobo_runner *runner, grobo_thread *thread)
{
    if (runner == NULL || thread == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_runner_lock(runner);
    if (runner->has_thread && runner->running) {
        *thread = runner->thread;
        r = GROBO_OK;
    }
    grobo_i_runner_unlock(runner);
    return r;
}

int grobo_runner_svc(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    int64_t end_us = grobo_now_us() + runner->period_us;
    int r = 0;

    if (grobo_i_runner_inside(runner)) {
        return GROBO_ERR_STATE;
    }
    grobo_i_runner_lock(runner);
    while ((runner->looping || runner->running) && grobo_now_us() < end_us) {
        grobo_i_runner_sleep(runner, end_us);
    }
    if (!runner->looping && !runner->running) {
        grobo_i_runner_take_turn(runner, end_us);
        r = 1;
    }
    grobo_i_runner_unlock(runner);
    return r;
}

/* ---- making and freeing ------------------------------------------------------------------- */

static int copy_names(grobo_runner *runner, const grobo_runner_config *config)
{
    const char *name = config->name != NULL ? config->name : runner->driver->name;
    const char *dir = config->motion_dir != NULL ? config->motion_dir : ".";

    if (strlen(name) >= sizeof runner->name || strlen(dir) >= sizeof runner->motion_dir) {
        return GROBO_ERR_CAP;
    }
    memcpy(runner->name, name, strlen(name) + 1);
    memcpy(runner->motion_dir, dir, strlen(dir) + 1);
    return GROBO_OK;
}

static int make_loop(grobo_runner *runner)
{
    runner->base = grobo_loop_new();
    return runner->base == NULL
               ? GROBO_ERR_NOMEM
               : grobo_timer_new(runner->base, on_time, runner, runner->mem, &runner->timer);
}

static int make_session(grobo_runner *runner)
{
    grobo_session_config config = runner->user;
    int r;

    config.base = runner->base;
    config.driver = runner->driver;
    config.robot = &runner->robot_config;
    config.on_event = grobo_i_runner_on_event;
    config.on_robot = grobo_i_runner_on_robot;
    config.on_tap = runner->user.on_tap != NULL ? grobo_i_runner_on_tap : NULL;
    config.ctx = runner;
    r = grobo_session_new(&config, &runner->session);
    if (r >= 0) {
        grobo_i_runner_share(runner);
    }
    return r < 0 ? r : grobo_i_session_listen(runner->session, true);
}

static int make_parts(grobo_runner *runner, const grobo_runner_config *config)
{
    int r = make_loop(runner);

    if (r >= 0) {
        r = make_session(runner); /* checks the driver */
    }
    if (r >= 0) {
        r = copy_names(runner, config);
    }
    if (r >= 0) {
        r = grobo_i_runner_ring_new(runner, config->events);
    }
    if (r >= 0) {
        r = grobo_motion_new(GROBO_MOTION_POSTURES, runner->driver->model->n_joints, runner->mem,
                             &runner->motion);
    }
    return r;
}

static void fill(grobo_runner *runner, const grobo_runner_config *config)
{
    runner->mem = runner->user.mem;
    runner->driver =
        runner->user.driver != NULL ? runner->user.driver : grobo_gr001_driver(GROBO_WIRING_BOARD);
    runner->on_svc = config->on_svc;
    runner->owner_timeout_us = config->owner_timeout_us;
    runner->skip_exit = config->skip_exit;
    runner->realtime = config->realtime;
    runner->timeout_us = config->timeout_us > 0 ? config->timeout_us : GROBO_RUNNER_TIMEOUT_US;
    runner->period_us = config->period_us != 0 ? config->period_us : GROBO_RUNNER_PERIOD_US;
    runner->tick_us = GROBO_NEVER_US;
    atomic_store(&runner->called_us, grobo_now_us());
    runner->event_socket[0] = runner->event_socket[1] = GROBO_SOCKET_NULL;
}

static void destroy(grobo_runner *runner)
{
    grobo_session_free(runner->session);
    grobo_timer_free(runner->timer);
    if (runner->base != NULL) {
        event_base_free(runner->base);
    }
    grobo_i_runner_release_clip(runner);
    grobo_motion_free(runner->motion);
    grobo_i_runner_ring_free(runner);
    grobo_cond_deinit(&runner->changed);
    grobo_mutex_deinit(&runner->lock);
    grobo_mutex_deinit(&runner->engine);
    grobo_i_free(runner->mem, runner, sizeof *runner);
}

static bool is_period(int64_t period_us)
{
    return period_us >= PERIOD_MIN_US && period_us <= PERIOD_MAX_US;
}

static int make_locks(grobo_runner *runner)
{
    if (grobo_mutex_init(&runner->lock) < 0) {
        return GROBO_ERR_NOMEM;
    }
    if (grobo_mutex_init(&runner->engine) >= 0) {
        if (grobo_cond_init(&runner->changed) >= 0) {
            return GROBO_OK;
        }
        grobo_mutex_deinit(&runner->engine);
    }
    grobo_mutex_deinit(&runner->lock);
    return GROBO_ERR_NOMEM;
}

static bool is_sound(const grobo_runner_config *config)
{
    return config->owner_timeout_us >= 0 && config->timeout_us >= 0 &&
           config->events <= GROBO_RUNNER_EVENTS_MAX &&
           (config->period_us == 0 || is_period(config->period_us));
}

int grobo_runner_new(const grobo_runner_config *config, grobo_runner **runner)
{
    grobo_runner_config taken;
    grobo_session_config session;
    grobo_robot_config robot;
    grobo_runner *made;
    int r;

    if (runner == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
        !is_sound(&taken) || grobo_i_sized_take(&session, sizeof session, taken.session) < 0 ||
        session.base != NULL || grobo_i_sized_take(&robot, sizeof robot, session.robot) < 0) {
        return GROBO_ERR_ARG;
    }
    made = grobo_i_new(session.mem, sizeof *made);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    r = make_locks(made);
    if (r < 0) {
        grobo_i_free(session.mem, made, sizeof *made);
        return r;
    }
    config = &taken;
    made->user = session;
    made->robot_config = robot;
    fill(made, config);
    r = make_parts(made, config);
    made->user.device = NULL;
    made->user.robot = NULL;
    made->user.sim = NULL;
    if (r < 0) {
        destroy(made);
        return r;
    }
    *runner = made;
    return GROBO_OK;
}

int grobo_runner_free(grobo_runner *runner)
{
    bool looked;

    if (runner == NULL) {
        return GROBO_OK;
    }
    if (grobo_i_runner_inside(runner)) {
        return GROBO_ERR_STATE;
    }
    (void)grobo_runner_stop(runner);
    grobo_i_runner_lock(runner);
    join(runner); /* one that was stopped in a callback */
    grobo_i_runner_unlock(runner);
    (void)grobo_i_runner_leave(runner, exit_timeout(runner), &looked);
    grobo_i_runner_end_calls(runner);
    destroy(runner);
    return GROBO_OK;
}
