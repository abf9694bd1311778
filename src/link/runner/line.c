/* SPDX-License-Identifier: MIT */
/* A runner's line, readings and safety: the session's, for every thread. */
#include <string.h>

#include <grobo/core/robot.h>

#include "src/link/runner/runner.h"
#include "src/link/session/session.h"

grobo_session *grobo_runner_session(grobo_runner *runner)
{
    return runner == NULL ? NULL : runner->session;
}

grobo_robot *grobo_runner_robot(grobo_runner *runner)
{
    return runner == NULL ? NULL : runner_robot(runner);
}

/* ---- the line ----------------------------------------------------------------------------- */

static int set_device(void *arg, grobo_runner *runner)
{
    const char *const *device = arg;

    return grobo_session_set_device(runner->session, *device);
}

int grobo_runner_set_device(grobo_runner *runner, const char *device)
{
    return grobo_i_runner_call(runner, set_device, &device);
}

/* The caller's storage, which stays until the loop is done with it: see wait_for() in call.c. */
typedef struct storage {
    void *bytes;
    size_t size;
} storage;

static int get_device(void *arg, grobo_runner *runner)
{
    const storage *to = arg;
    const char *device = grobo_session_device(runner->session);
    size_t length = strlen(device);

    if (length >= to->size) {
        return GROBO_ERR_SPACE;
    }
    memcpy(to->bytes, device, length + 1);
    return (int)length;
}

int grobo_runner_get_device(grobo_runner *runner, char *device, size_t device_bytes)
{
    storage to = {.bytes = device, .size = device_bytes};

    return device == NULL ? GROBO_ERR_ARG : grobo_i_runner_call(runner, get_device, &to);
}

static int open_port(void *arg, grobo_runner *runner)
{
    (void)arg;
    return grobo_session_open(runner->session);
}

int grobo_runner_open(grobo_runner *runner)
{
    return grobo_i_runner_call(runner, open_port, NULL);
}

int grobo_runner_post_exit(grobo_runner *runner, grobo_exit_policy policy)
{
    return runner != NULL ? grobo_session_post_exit(runner->session, policy) : GROBO_ERR_ARG;
}

static int leave_job(grobo_runner *runner, runner_job *job)
{
    bool up = grobo_session_get_state(runner->session) == GROBO_SESSION_UP;

    job->looked = true;
    if (up && grobo_robot_job(runner_robot(runner)) == GROBO_JOB_ESTOP) {
        return GROBO_ERR_STATE; /* to be over first */
    }
    /* A robot that is gone, or has been left, needs nothing. */
    if (!up || runner->skip_exit || grobo_i_runner_has_exited(runner)) {
        return GROBO_OK;
    }
    return grobo_robot_exit(runner_robot(runner), GROBO_EXIT_DEFAULT);
}

int grobo_i_runner_leave(grobo_runner *runner, int64_t timeout_us, bool *looked)
{
    runner_job job = {.start = leave_job, .urgent = true};
    int r = grobo_i_runner_job(runner, &job, timeout_us);

    *looked = job.looked || (r != GROBO_ERR_TIMEOUT && r != GROBO_ERR_FULL);
    if (!*looked && !runner->skip_exit) {
        (void)grobo_runner_post_exit(runner, GROBO_EXIT_DEFAULT);
    }
    return r;
}

static int close_port(void *arg, grobo_runner *runner)
{
    (void)arg;
    grobo_session_close(runner->session);
    grobo_i_runner_down(runner, GROBO_ERR_CLOSED);
    return GROBO_OK;
}

int grobo_runner_close(grobo_runner *runner, int64_t timeout_us)
{
    bool looked;

    if (grobo_i_runner_inside(runner)) {
        return GROBO_ERR_STATE;
    }
    int left = grobo_i_runner_leave(runner, timeout_us, &looked);
    if (!looked) {
        return left; /* held up: still open, and the exit stands */
    }
    int closed = grobo_i_runner_call(runner, close_port, NULL);
    return closed < 0 ? closed : left;
}

static int connect_port(void *arg, grobo_runner *runner)
{
    bool *opened = arg;

    switch (grobo_session_get_state(runner->session)) {
    case GROBO_SESSION_UP:
        return GROBO_OK;
    case GROBO_SESSION_CLOSED:
        if (*opened) {
            return runner->line_error;
        }
        *opened = true;
        int r = grobo_session_open(runner->session);
        return r < 0 ? r : CALL_PENDING;
    case GROBO_SESSION_OPENING:
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_WAITING:
        break;
    }
    *opened = true;
    return CALL_PENDING;
}

int grobo_runner_connect(grobo_runner *runner, int64_t timeout_us)
{
    bool opened = false;

    return grobo_i_runner_wait(runner, connect_port, &opened, timeout_us);
}

bool grobo_runner_is_connected(grobo_runner *runner)
{
    RETURN_LOCKED(runner, bool, false, runner->up);
}

static int get_cause(void *arg, grobo_runner *runner)
{
    grobo_os_cause *cause = arg;

    *cause = *grobo_session_cause(runner->session);
    return GROBO_OK;
}

int grobo_runner_get_cause(grobo_runner *runner, grobo_os_cause *cause)
{
    return cause == NULL ? GROBO_ERR_ARG : grobo_i_runner_call(runner, get_cause, cause);
}

/* ---- readings ----------------------------------------------------------------------------- */

static int sense_job(grobo_runner *runner, runner_job *job)
{
    return grobo_robot_sense(runner_robot(runner), job->joints, job->sense);
}

/* Some of its joints may have been read, however it ended. */
static bool was_read(const runner_job *job, int result)
{
    return job->ended && result != GROBO_ERR_UNPLUGGED && result != GROBO_ERR_CANCELED;
}

/* Reads, and gives the joints that have been read since it began. @return their number, or why. */
static int sense(grobo_runner *runner, grobo_joint_mask joints, grobo_sense_kind kind,
                 grobo_posture *posture, int64_t timeout_us)
{
    runner_job job = {.start = sense_job, .joints = joints, .sense = kind, .direct = true};
    int r = grobo_i_runner_job(runner, &job, timeout_us);
    grobo_posture sensed;

    if (!was_read(&job, r)) {
        return r;
    }
    (void)grobo_robot_posture(runner_robot(runner), grobo_now_us() - job.begun_us, &sensed);
    sensed.set &= joints;
    if (sensed.set == 0 && r < 0) {
        return r;
    }
    *posture = sensed;
    return grobo_joints_count(sensed.set);
}

int grobo_runner_read_posture(grobo_runner *runner, grobo_posture *posture, int64_t timeout_us)
{
    if (runner == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    return sense(runner, GROBO_JOINTS_ALL(grobo_runner_joints(runner)), GROBO_SENSE_FULL, posture,
                 timeout_us);
}

int grobo_runner_read_angle(grobo_runner *runner, int joint, double *angle_rad, int64_t timeout_us)
{
    grobo_joint_info info;

    if (angle_rad == NULL || runner == NULL || joint < 0 || joint >= grobo_runner_joints(runner)) {
        return GROBO_ERR_ARG;
    }
    runner_job job = {.start = sense_job,
                      .joints = GROBO_JOINT_BIT(joint),
                      .sense = GROBO_SENSE_POSITION,
                      .direct = true};
    int r = grobo_i_runner_job(runner, &job, timeout_us);

    if (was_read(&job, r) && grobo_robot_joint(runner_robot(runner), joint, &info) >= 0 &&
        info.angle_age_us <= grobo_now_us() - job.begun_us) {
        *angle_rad = info.state.angle_rad;
        r = GROBO_OK;
    }
    return r;
}

/* ---- safety ------------------------------------------------------------------------------- */

int grobo_runner_estop(grobo_runner *runner)
{
    return runner != NULL ? grobo_session_post_estop(runner->session) : GROBO_ERR_ARG;
}

bool grobo_runner_is_latched(const grobo_runner *runner)
{
    return runner != NULL && grobo_session_is_latched(runner->session);
}

/* Not where an emergency stop came after the call. */
static int reset(void *arg, grobo_runner *runner)
{
    const unsigned *estops = arg;

    return atomic_load(&runner->session->estops) != *estops
               ? GROBO_ERR_STATE
               : grobo_robot_reset(runner_robot(runner));
}

int grobo_runner_reset(grobo_runner *runner)
{
    if (runner == NULL) {
        return GROBO_ERR_ARG;
    }
    unsigned estops = atomic_load(&runner->session->estops);

    return grobo_i_runner_call(runner, reset, &estops);
}

static int exit_job(grobo_runner *runner, runner_job *job)
{
    return grobo_robot_exit(runner_robot(runner), job->policy);
}

int grobo_runner_exit(grobo_runner *runner, grobo_exit_policy policy, int64_t timeout_us)
{
    runner_job job = {.start = exit_job, .policy = policy, .urgent = true};
    int r;

    if (grobo_i_runner_inside(runner)) {
        r = grobo_runner_post_exit(runner, policy);
        return r < 0 ? r : GROBO_ERR_STATE;
    }
    r = grobo_i_runner_job(runner, &job, timeout_us);
    if (job.number == 0 && (r == GROBO_ERR_TIMEOUT || r == GROBO_ERR_FULL)) {
        (void)grobo_runner_post_exit(runner, policy); /* nobody waits, the exit stands */
    }
    return r;
}
