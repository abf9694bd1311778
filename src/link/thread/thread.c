/* SPDX-License-Identifier: MIT */
/* The life of a control, and its thread. */
#include <string.h>

#include "src/base/sized.h"
#include "src/link/serial/loop.h"
#include "src/link/session/session.h"
#include "src/link/thread/thread.h"

/* Longest and shortest control period. */
#define PERIOD_MIN_US 1000
#define PERIOD_MAX_US 1000000

/* How long the exit policy may take beyond the engine's own bound for it. */
#define EXIT_SPARE_US INT64_C(5000000)
/* That bound where none is configured (robot.h). */
#define EXIT_BOUND_US INT64_C(10000000)

/* ---- its period --------------------------------------------------------------------------- */

/* The exit policy, when nobody has called for too long: who should is gone. */
static void look_for_owner(grobo_control *control, int64_t now_us)
{
    bool lost = false;

    if (control->owner_timeout_us <= 0) {
        return;
    }
    grobo_i_control_lock(control);
    if (control->sleepers > 0) {
        control->called_us = now_us; /* who waits is there */
    }
    if (!control->owner_lost && now_us - control->called_us >= control->owner_timeout_us) {
        control->owner_lost = lost = true;
    }
    grobo_i_control_unlock(control);
    if (lost && !grobo_i_control_has_exited(control)) {
        (void)grobo_session_post_exit(control->session, GROBO_EXIT_DEFAULT);
    }
}

static void on_time(void *ctx, grobo_timer *timer, int64_t late_us)
{
    grobo_control *control = ctx;
    int64_t now_us = grobo_now_us();

    (void)timer;
    (void)late_us;
    if (now_us < control->tick_us) {
        return; /* the end of somebody's patience */
    }
    control->tick_us += grobo_control_get_period_us(control);
    if (control->tick_us <= now_us) {
        /* Late: skipped, not made up for. */
        control->tick_us = now_us + grobo_control_get_period_us(control);
    }
    look_for_owner(control, now_us);
    if (control->on_svc != NULL) {
        int64_t since_us = grobo_i_session_enter_callback(control->session);

        (void)control->on_svc(control->user.ctx, control);
        grobo_i_session_leave_callback(control->session, GROBO_CALLBACK_SVC, since_us);
    }
}

/* ---- the thread --------------------------------------------------------------------------- */

static int64_t exit_timeout(grobo_control *control)
{
    int64_t bound_us;

    grobo_i_control_copy(control, &bound_us, &control->robot_config.exit_bound_us, sizeof bound_us);
    bound_us = bound_us > 0 ? bound_us : EXIT_BOUND_US;
    return bound_us < GROBO_NEVER_US - EXIT_SPARE_US ? bound_us + EXIT_SPARE_US : GROBO_NEVER_US;
}

/* The body of the control thread; `running` is set. */
static void run(grobo_control *control)
{
    bool looked;

    grobo_mutex_lock(&control->lock);
    while (control->looping && !control->stopping) {
        /* Whoever is in a round gives the turn to us after it. */
        grobo_cond_wait(&control->changed, &control->lock, GROBO_NEVER_US);
    }
    if (!control->looping) {
        control->looping = true;
        while (!control->stopping) {
            grobo_mutex_unlock(&control->lock);
            grobo_i_control_round(control, GROBO_NEVER_US);
            grobo_mutex_lock(&control->lock);
        }
        control->looping = false;
    }
    control->running = false;
    control->ending = true;
    grobo_i_control_wake_all(control);
    grobo_mutex_unlock(&control->lock);
    /* Told to nobody: a robot that cannot be left well has been told of by its events. */
    (void)grobo_i_control_leave(control, exit_timeout(control), &looked);
    grobo_mutex_lock(&control->lock);
    control->ending = false;
    control->ends++;
    grobo_i_control_wake_all(control);
    grobo_mutex_unlock(&control->lock);
}

static GROBO_THREAD_FUNC thread_execution(void *arg)
{
    run(arg);
    GROBO_THREAD_RETURN;
}

/* With the lock, which is given back meanwhile: joins a thread that has ended. */
static void join(grobo_control *control)
{
    if (control->has_thread) {
        grobo_thread thread = control->thread;

        control->has_thread = false;
        grobo_mutex_unlock(&control->lock);
        (void)grobo_thread_join(thread);
        grobo_mutex_lock(&control->lock);
    }
}

int grobo_control_start_thread(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_control_lock(control);
    if (!control->running && !control->ending) {
        control->running = true;
        control->stopping = false;
        join(control); /* one that was stopped in a callback */
        r = grobo_thread_start(&control->thread, thread_execution, control);
        control->has_thread = r >= 0;
        control->running = r >= 0;
        if (r < 0) {
            grobo_i_control_wake_all(control); /* whoever waits for its end already */
        }
    }
    grobo_i_control_unlock(control);
    return r;
}

int grobo_control_run(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    if (grobo_i_control_inside(control)) {
        return GROBO_ERR_STATE;
    }
    grobo_i_control_lock(control);
    bool mine = !control->running && !control->ending;
    if (mine) {
        control->running = true;
        control->stopping = false;
    }
    grobo_i_control_unlock(control);
    if (mine) {
        run(control);
    }
    return mine ? GROBO_OK : GROBO_ERR_STATE;
}

/* With the lock: waits until the thread has ended; another may have been started by then. */
static void await_end(grobo_control *control)
{
    uint64_t ends = control->ends;

    while ((control->running || control->ending) && control->ends == ends) {
        grobo_i_control_sleep(control, GROBO_NEVER_US);
    }
    if (!control->running && !control->ending) {
        join(control);
    }
}

int grobo_control_stop_thread(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_control_lock(control);
    if (control->running || control->ending) {
        control->stopping = true;
        grobo_i_control_wake_all(control);
        grobo_i_control_wake(control);
        r = GROBO_OK;
        if (!grobo_i_control_inside(control)) {
            await_end(control);
        }
    }
    grobo_i_control_unlock(control);
    return r;
}

bool grobo_control_is_active(grobo_control *control)
{
    RETURN_LOCKED(control, bool, false, control->running && !control->stopping);
}

int grobo_control_thread(grobo_control *control, grobo_thread *thread)
{
    if (control == NULL || thread == NULL) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_STATE;

    grobo_i_control_lock(control);
    if (control->has_thread && control->running) {
        *thread = control->thread;
        r = GROBO_OK;
    }
    grobo_i_control_unlock(control);
    return r;
}

int grobo_control_svc(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    int64_t end_us = grobo_now_us() + grobo_control_get_period_us(control);
    int r = 0;

    if (grobo_i_control_inside(control)) {
        return GROBO_ERR_STATE;
    }
    grobo_i_control_lock(control);
    while ((control->looping || control->running) && grobo_now_us() < end_us) {
        grobo_i_control_sleep(control, end_us);
    }
    if (!control->looping && !control->running) {
        grobo_i_control_take_turn(control, end_us);
        r = 1;
    }
    grobo_i_control_unlock(control);
    return r;
}

/* ---- making and freeing ------------------------------------------------------------------- */

static int copy_names(grobo_control *control, const grobo_control_config *config)
{
    const char *name = config->name != NULL ? config->name : control->driver->name;
    const char *dir = config->motion_dir != NULL ? config->motion_dir : ".";

    if (strlen(name) >= sizeof control->name || strlen(dir) >= sizeof control->motion_dir) {
        return GROBO_ERR_CAP;
    }
    memcpy(control->name, name, strlen(name) + 1);
    memcpy(control->motion_dir, dir, strlen(dir) + 1);
    return GROBO_OK;
}

/* The initial posture: all joints at 0, or at the limit that is nearest. */
static void set_postures(grobo_control *control)
{
    const grobo_model *model = control->driver->model;

    /* Cannot fail: the model's number of joints was checked with the driver. */
    (void)grobo_posture_init(&control->target, model->n_joints);
    control->target.time_us = 0;
    control->init = control->target;
    control->init.set = GROBO_JOINTS_ALL(model->n_joints);
    (void)grobo_posture_clamp(&control->init, model);
}

static int make_loop(grobo_control *control)
{
    control->base = grobo_loop_new();
    return control->base == NULL
               ? GROBO_ERR_NOMEM
               : grobo_timer_new(control->base, on_time, control, control->mem, &control->timer);
}

static int make_session(grobo_control *control)
{
    grobo_session_config config = control->user;
    int r;

    config.base = control->base;
    config.driver = control->driver;
    config.robot = &control->robot_config;
    config.on_event = grobo_i_control_on_event;
    config.on_robot = grobo_i_control_on_robot;
    config.on_tap = grobo_i_control_on_tap;
    config.ctx = control;
    r = grobo_session_new(&config, &control->session);
    if (r >= 0) {
        grobo_i_control_share(control);
    }
    return r < 0 ? r : grobo_i_session_listen(control->session, true);
}

static int make_parts(grobo_control *control, const grobo_control_config *config)
{
    int r = make_loop(control);

    if (r >= 0) {
        r = make_session(control); /* checks the driver */
    }
    if (r >= 0) {
        r = copy_names(control, config);
    }
    if (r >= 0) {
        r = grobo_i_control_ring_new(control, config->events);
    }
    if (r >= 0) {
        set_postures(control);
        r = grobo_motion_new(GROBO_MOTION_POSTURES, control->driver->model->n_joints, control->mem,
                             &control->motion);
    }
    return r;
}

static void fill(grobo_control *control, const grobo_control_config *config)
{
    control->mem = control->user.mem;
    control->driver = control->user.driver != NULL ? control->user.driver
                                                   : grobo_gr001_driver(GROBO_WIRING_BOARD);
    control->on_svc = config->on_svc;
    control->owner_timeout_us = config->owner_timeout_us;
    control->skip_exit = config->skip_exit;
    control->timeout_us = config->timeout_us > 0 ? config->timeout_us : GROBO_CONTROL_TIMEOUT_US;
    control->period_us =
        config->control_period_us != 0 ? config->control_period_us : GROBO_CONTROL_PERIOD_US;
    control->tick_us = GROBO_NEVER_US;
    control->called_us = grobo_now_us();
    control->event_socket[0] = control->event_socket[1] = GROBO_SOCKET_NULL;
}

static void destroy(grobo_control *control)
{
    grobo_session_free(control->session);
    grobo_timer_free(control->timer);
    if (control->base != NULL) {
        event_base_free(control->base);
    }
    grobo_i_control_release_clip(control);
    grobo_motion_free(control->motion);
    grobo_i_control_ring_free(control);
    grobo_cond_deinit(&control->changed);
    grobo_mutex_deinit(&control->lock);
    grobo_mutex_deinit(&control->engine);
    grobo_i_free(control->mem, control, sizeof *control);
}

static bool is_period(int64_t period_us)
{
    return period_us >= PERIOD_MIN_US && period_us <= PERIOD_MAX_US;
}

static int make_locks(grobo_control *control)
{
    if (grobo_mutex_init(&control->lock) < 0) {
        return GROBO_ERR_NOMEM;
    }
    if (grobo_mutex_init(&control->engine) >= 0) {
        if (grobo_cond_init(&control->changed) >= 0) {
            return GROBO_OK;
        }
        grobo_mutex_deinit(&control->engine);
    }
    grobo_mutex_deinit(&control->lock);
    return GROBO_ERR_NOMEM;
}

static bool is_sound(const grobo_control_config *config)
{
    return config->owner_timeout_us >= 0 && config->timeout_us >= 0 &&
           config->events <= GROBO_CONTROL_EVENTS_MAX &&
           (config->control_period_us == 0 || is_period(config->control_period_us));
}

int grobo_control_new(const grobo_control_config *config, grobo_control **control)
{
    grobo_control_config taken;
    grobo_session_config session;
    grobo_robot_config robot;
    grobo_control *made;
    int r;

    if (control == NULL || grobo_i_sized_take(&taken, sizeof taken, config) < 0 ||
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
    *control = made;
    return GROBO_OK;
}

int grobo_control_free(grobo_control *control)
{
    bool looked;

    if (control == NULL) {
        return GROBO_OK;
    }
    if (grobo_i_control_inside(control)) {
        return GROBO_ERR_STATE;
    }
    (void)grobo_control_stop_thread(control);
    grobo_i_control_lock(control);
    join(control); /* one that was stopped in a callback */
    grobo_i_control_unlock(control);
    (void)grobo_i_control_leave(control, exit_timeout(control), &looked);
    grobo_i_control_end_calls(control);
    destroy(control);
    return GROBO_OK;
}

int grobo_control_set_period_us(grobo_control *control, int64_t period_us)
{
    if (control == NULL || !is_period(period_us)) {
        return GROBO_ERR_ARG;
    }
    grobo_i_control_copy(control, &control->period_us, &period_us, sizeof period_us);
    return GROBO_OK;
}
