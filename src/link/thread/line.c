/* SPDX-License-Identifier: MIT */
/* A control's line, servos, readings, raw commands and safety: the session's, for every thread. */
#include <string.h>

#include "src/link/session/session.h"
#include "src/link/thread/thread.h"

grobo_session *grobo_control_session(grobo_control *control)
{
    return control == NULL ? NULL : control->session;
}

grobo_robot *grobo_control_robot(grobo_control *control)
{
    return control == NULL ? NULL : control_robot(control);
}

grobo_serial *grobo_control_serial(grobo_control *control)
{
    return control == NULL ? NULL : grobo_session_serial(control->session);
}

/* ---- the line ----------------------------------------------------------------------------- */

static int set_device(void *arg, grobo_control *control)
{
    const char *const *device = arg;

    return grobo_session_set_device(control->session, *device);
}

int grobo_control_set_device(grobo_control *control, const char *device)
{
    return grobo_i_control_call(control, set_device, &device);
}

/* The caller's storage, which stays until the loop is done with it: see wait_for() in call.c. */
typedef struct storage {
    void *bytes;
    size_t size;
    int64_t end_us;
} storage;

static int get_device(void *arg, grobo_control *control)
{
    const storage *to = arg;
    const char *device = grobo_session_device(control->session);
    size_t length = strlen(device);

    if (length >= to->size) {
        return GROBO_ERR_SPACE;
    }
    memcpy(to->bytes, device, length + 1);
    return (int)length;
}

int grobo_control_get_device(grobo_control *control, char *device, size_t device_bytes)
{
    storage to = {.bytes = device, .size = device_bytes};

    return device == NULL ? GROBO_ERR_ARG : grobo_i_control_call(control, get_device, &to);
}

static int open_port(void *arg, grobo_control *control)
{
    (void)arg;
    return grobo_session_open(control->session);
}

int grobo_control_open_port(grobo_control *control)
{
    return grobo_i_control_call(control, open_port, NULL);
}

int grobo_control_post_exit(grobo_control *control, grobo_exit_policy policy)
{
    return control != NULL ? grobo_session_post_exit(control->session, policy) : GROBO_ERR_ARG;
}

static int leave_job(grobo_control *control, control_job *job)
{
    bool up = grobo_session_get_state(control->session) == GROBO_SESSION_UP;

    job->looked = true;
    if (up && grobo_robot_job(control_robot(control)) == GROBO_JOB_ESTOP) {
        return GROBO_ERR_STATE; /* to be over first */
    }
    /* A robot that is gone, or has been left, needs nothing. */
    if (!up || control->skip_exit || grobo_i_control_has_exited(control)) {
        return GROBO_OK;
    }
    return grobo_robot_exit(control_robot(control), GROBO_EXIT_DEFAULT);
}

int grobo_i_control_leave(grobo_control *control, int64_t timeout_us, bool *looked)
{
    control_job job = {.start = leave_job, .urgent = true};
    int r = grobo_i_control_job(control, &job, timeout_us);

    *looked = job.looked || (r != GROBO_ERR_TIMEOUT && r != GROBO_ERR_FULL);
    if (!*looked && !control->skip_exit) {
        (void)grobo_control_post_exit(control, GROBO_EXIT_DEFAULT);
    }
    return r;
}

static int close_port(void *arg, grobo_control *control)
{
    (void)arg;
    grobo_session_close(control->session);
    grobo_i_control_down(control, GROBO_ERR_CLOSED);
    return GROBO_OK;
}

int grobo_control_close_port(grobo_control *control, int64_t timeout_us)
{
    bool looked;

    if (grobo_i_control_inside(control)) {
        return GROBO_ERR_STATE;
    }
    int left = grobo_i_control_leave(control, timeout_us, &looked);
    if (!looked) {
        return left; /* held up: still open, and the exit stands */
    }
    int closed = grobo_i_control_call(control, close_port, NULL);
    return closed < 0 ? closed : left;
}

static int connect_port(void *arg, grobo_control *control)
{
    bool *opened = arg;

    switch (grobo_session_get_state(control->session)) {
    case GROBO_SESSION_UP:
        return GROBO_OK;
    case GROBO_SESSION_CLOSED:
        if (*opened) {
            return control->line_error;
        }
        *opened = true;
        int r = grobo_session_open(control->session);
        return r < 0 ? r : CALL_PENDING;
    case GROBO_SESSION_OPENING:
    case GROBO_SESSION_CHECKING:
    case GROBO_SESSION_WAITING:
        break;
    }
    *opened = true;
    return CALL_PENDING;
}

int grobo_control_connect(grobo_control *control, int64_t timeout_us)
{
    bool opened = false;

    return grobo_i_control_wait(control, connect_port, &opened, timeout_us);
}

bool grobo_control_is_connected(grobo_control *control)
{
    RETURN_LOCKED(control, bool, false, control->up);
}

static int get_cause(void *arg, grobo_control *control)
{
    grobo_os_cause *cause = arg;

    *cause = *grobo_session_cause(control->session);
    return GROBO_OK;
}

int grobo_control_get_cause(grobo_control *control, grobo_os_cause *cause)
{
    return cause == NULL ? GROBO_ERR_ARG : grobo_i_control_call(control, get_cause, cause);
}

static int check_job(grobo_control *control, control_job *job)
{
    (void)job;
    return grobo_robot_check(control_robot(control));
}

int grobo_control_check_connection(grobo_control *control, int64_t timeout_us)
{
    control_job job = {.start = check_job};

    return grobo_i_control_job(control, &job, timeout_us);
}

/* ---- servos ------------------------------------------------------------------------------- */

int grobo_control_get_servo_state(grobo_control *control, int joint)
{
    grobo_joint_info info;
    int r = grobo_robot_joint(grobo_control_robot(control), joint, &info);

    return r < 0 ? r : info.torque_known ? (int)info.state.torque : GROBO_ERR_EMPTY;
}

int grobo_control_get_servo_states(grobo_control *control, int *states, size_t capacity)
{
    if (control == NULL || states == NULL) {
        return GROBO_ERR_ARG;
    }
    int n_joints = grobo_control_joints(control);

    if (capacity < (size_t)n_joints) {
        return GROBO_ERR_SPACE;
    }
    for (int j = 0; j < n_joints; j++) {
        states[j] = grobo_control_get_servo_state(control, j);
    }
    return n_joints;
}

static int torque_job(grobo_control *control, control_job *job)
{
    return grobo_robot_torque(control_robot(control), job->joints, job->torque);
}

int grobo_control_set_servo_states(grobo_control *control, grobo_joint_mask joints,
                                   grobo_torque state, int64_t timeout_us)
{
    control_job job = {.start = torque_job, .joints = joints, .torque = state};

    return grobo_i_control_job(control, &job, timeout_us);
}

int grobo_control_set_servo_state(grobo_control *control, int joint, grobo_torque state,
                                  int64_t timeout_us)
{
    if (control == NULL || joint < 0 || joint >= grobo_control_joints(control)) {
        return GROBO_ERR_ARG;
    }
    int r = grobo_control_set_servo_states(control, GROBO_JOINT_BIT(joint), state, timeout_us);
    return r < 0 ? r : (int)state;
}

/* ---- readings ----------------------------------------------------------------------------- */

int grobo_control_get_current_posture(grobo_control *control, grobo_posture *posture)
{
    return grobo_robot_posture(grobo_control_robot(control), GROBO_NEVER_US, posture);
}

static int sense_job(grobo_control *control, control_job *job)
{
    return grobo_robot_sense(control_robot(control), job->joints, job->sense);
}

/* Reads, and gives the joints that have been read since it began. @return their number, or why. */
static int sense(grobo_control *control, grobo_joint_mask joints, grobo_sense_kind kind,
                 grobo_posture *posture, int64_t timeout_us)
{
    control_job job = {.start = sense_job, .joints = joints, .sense = kind};
    int r = grobo_i_control_job(control, &job, timeout_us);
    grobo_posture sensed;

    if (!job.ended || r == GROBO_ERR_UNPLUGGED || r == GROBO_ERR_CANCELED) {
        return r;
    }
    (void)grobo_robot_posture(control_robot(control), grobo_now_us() - job.begun_us, &sensed);
    sensed.set &= joints;
    if (sensed.set == 0 && r < 0) {
        return r;
    }
    *posture = sensed;
    return grobo_joints_count(sensed.set);
}

int grobo_control_read_posture(grobo_control *control, grobo_posture *posture, int64_t timeout_us)
{
    if (control == NULL || posture == NULL) {
        return GROBO_ERR_ARG;
    }
    return sense(control, GROBO_JOINTS_ALL(grobo_control_joints(control)), GROBO_SENSE_FULL,
                 posture, timeout_us);
}

int grobo_control_read_angle(grobo_control *control, int joint, double *angle_rad,
                             int64_t timeout_us)
{
    grobo_posture sensed;

    if (angle_rad == NULL || control == NULL || joint < 0 ||
        joint >= grobo_control_joints(control)) {
        return GROBO_ERR_ARG;
    }
    int r = sense(control, GROBO_JOINT_BIT(joint), GROBO_SENSE_POSITION, &sensed, timeout_us);
    return r > 0 ? grobo_posture_get_rad(&sensed, joint, angle_rad) : r;
}

/* ---- raw commands ------------------------------------------------------------------------- */

int grobo_control_set_command(grobo_control *control, const void *packet, size_t size)
{
    if ((packet == NULL && size > 0) || control == NULL) {
        return GROBO_ERR_ARG;
    }
    if (size > sizeof control->command) {
        return GROBO_ERR_CAP;
    }
    grobo_i_control_lock(control);
    if (size > 0) {
        memcpy(control->command, packet, size);
    }
    control->command_bytes = size;
    grobo_i_control_unlock(control);
    return (int)size;
}

int grobo_control_get_command(grobo_control *control, void *packet, size_t capacity)
{
    if (control == NULL || (packet == NULL && capacity > 0)) {
        return GROBO_ERR_ARG;
    }
    int r = GROBO_ERR_SPACE;

    grobo_i_control_lock(control);
    if (control->command_bytes <= capacity) {
        r = (int)control->command_bytes;
    }
    if (r > 0) {
        memcpy(packet, control->command, (size_t)r);
    }
    grobo_i_control_unlock(control);
    return r;
}

static int raw_job(grobo_control *control, control_job *job)
{
    if (grobo_robot_job(control_robot(control)) != GROBO_JOB_NONE) {
        return GROBO_ERR_STATE;
    }
    /* It may leave, and even be answered, before the request returns. */
    memcpy(control->raw, job->frame, job->size);
    control->raw_bytes = job->size;
    /* Who is told that it took too long is not to see it leave afterwards. */
    int r = grobo_robot_raw_until(control_robot(control), job->frame, job->size, job->end_us - 1);
    if (r < 0) {
        control->raw_bytes = 0;
    }
    return r;
}

int grobo_control_send_command(grobo_control *control, const void *packet, size_t size,
                               int64_t timeout_us)
{
    control_job job = {.start = raw_job, .size = size};
    int r;

    if (packet == NULL) {
        r = grobo_control_get_command(control, job.frame, sizeof job.frame);
        job.size = (size_t)r;
    } else if (size > sizeof job.frame) {
        return GROBO_ERR_CAP;
    } else {
        memcpy(job.frame, packet, size);
    }
    if (job.size == 0) {
        return GROBO_ERR_EMPTY;
    }
    r = grobo_control_connect(control, timeout_us);
    if (r >= 0) {
        r = grobo_i_control_job(control, &job, timeout_us);
        r = r == GROBO_ERR_STALE && grobo_now_us() >= job.end_us - 1 ? GROBO_ERR_TIMEOUT : r;
    }
    return r < 0 ? r : (int)job.size;
}

static int receive(void *arg, grobo_control *control)
{
    const storage *to = arg;
    bool over = grobo_now_us() >= to->end_us;

    if (control->received_bytes < to->size && over) {
        grobo_i_session_look(control->session); /* somebody held us up, maybe */
    }
    size_t had = control->received_bytes;
    if (had >= to->size) {
        memcpy(to->bytes, control->received, to->size);
        control->received_bytes -= to->size;
        memmove(control->received, control->received + to->size, control->received_bytes);
        return (int)to->size;
    }
    if (!over) {
        return CALL_PENDING;
    }
    control->received_bytes = 0;
    return had > 0 ? GROBO_ERR_SHORT : GROBO_ERR_TIMEOUT;
}

int grobo_control_receive(grobo_control *control, void *bytes, size_t size)
{
    if (bytes == NULL) {
        return GROBO_ERR_ARG;
    }
    storage to = {bytes, size, grobo_now_us() + INT64_C(1000) * GROBO_SILENCE_DEFAULT_MS};

    return size <= GROBO_CONTROL_RECEIVE_BYTES ? grobo_i_control_wait(control, receive, &to, 0)
                                               : GROBO_ERR_CAP;
}

/* ---- safety ------------------------------------------------------------------------------- */

int grobo_control_estop(grobo_control *control)
{
    return control != NULL ? grobo_session_post_estop(control->session) : GROBO_ERR_ARG;
}

bool grobo_control_is_latched(const grobo_control *control)
{
    return control != NULL && grobo_session_is_latched(control->session);
}

/* Not where an emergency stop came after the call. */
static int reset(void *arg, grobo_control *control)
{
    const unsigned *estops = arg;

    return atomic_load(&control->session->estops) != *estops
               ? GROBO_ERR_STATE
               : grobo_robot_reset(control_robot(control));
}

int grobo_control_reset(grobo_control *control)
{
    if (control == NULL) {
        return GROBO_ERR_ARG;
    }
    unsigned estops = atomic_load(&control->session->estops);

    return grobo_i_control_call(control, reset, &estops);
}

static int exit_job(grobo_control *control, control_job *job)
{
    return grobo_robot_exit(control_robot(control), job->policy);
}

int grobo_control_exit(grobo_control *control, grobo_exit_policy policy, int64_t timeout_us)
{
    control_job job = {.start = exit_job, .policy = policy, .urgent = true};
    int r;

    if (grobo_i_control_inside(control)) {
        r = grobo_control_post_exit(control, policy);
        return r < 0 ? r : GROBO_ERR_STATE;
    }
    r = grobo_i_control_job(control, &job, timeout_us);
    if (job.number == 0 && (r == GROBO_ERR_TIMEOUT || r == GROBO_ERR_FULL)) {
        (void)grobo_control_post_exit(control, policy); /* nobody waits, the exit stands */
    }
    return r;
}
