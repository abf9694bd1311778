/* SPDX-License-Identifier: MIT */
/* The engine's requests, with the present time. */
#include "src/link/session/session.h"

/* Gives an engine's request the present time, and what it wants sent to the line. `given`: nothing
 * that must be there is NULL. */
#define REQUEST(session, given, call)                                                              \
    do {                                                                                           \
        int r_;                                                                                    \
                                                                                                   \
        if ((session) == NULL || !(given)) {                                                       \
            return GROBO_ERR_ARG;                                                                  \
        }                                                                                          \
        if ((session)->state != GROBO_SESSION_UP) {                                                \
            return GROBO_ERR_CLOSED;                                                               \
        }                                                                                          \
        grobo_i_session_enter(session);                                                            \
        r_ = (call);                                                                               \
        grobo_i_session_leave(session);                                                            \
        return r_;                                                                                 \
    } while (0)

int grobo_session_check(grobo_session *session)
{
    REQUEST(session, true, grobo_robot_check(&session->robot, grobo_now_us()));
}

int grobo_session_sense(grobo_session *session, grobo_joint_mask joints, grobo_sense_kind kind)
{
    REQUEST(session, true, grobo_robot_sense(&session->robot, joints, kind, grobo_now_us()));
}

int grobo_session_torque(grobo_session *session, grobo_joint_mask joints, grobo_torque mode)
{
    REQUEST(session, true, grobo_robot_torque(&session->robot, joints, mode, grobo_now_us()));
}

int grobo_session_move(grobo_session *session, const grobo_posture *target)
{
    REQUEST(session, target != NULL, grobo_robot_move(&session->robot, target, grobo_now_us()));
}

int grobo_session_retarget(grobo_session *session, const grobo_posture *target)
{
    REQUEST(session, target != NULL, grobo_robot_retarget(&session->robot, target, grobo_now_us()));
}

int grobo_session_raw(grobo_session *session, const uint8_t *frame, size_t size)
{
    REQUEST(session, frame != NULL, grobo_robot_raw(&session->robot, frame, size, grobo_now_us()));
}

int grobo_session_raw_until(grobo_session *session, const uint8_t *frame, size_t size,
                            int64_t until_us)
{
    REQUEST(session, frame != NULL,
            grobo_robot_raw_until(&session->robot, frame, size, until_us, grobo_now_us()));
}

int grobo_session_registers(grobo_session *session, const grobo_register_io *io)
{
    REQUEST(session, io != NULL, grobo_robot_registers(&session->robot, io, grobo_now_us()));
}

int grobo_session_command(grobo_session *session, int id, grobo_servo_command command)
{
    REQUEST(session, true, grobo_robot_command(&session->robot, id, command, grobo_now_us()));
}

int grobo_session_stored(grobo_session *session, grobo_stored_kind kind, int number)
{
    REQUEST(session, true, grobo_robot_stored(&session->robot, kind, number, grobo_now_us()));
}

int grobo_session_exit(grobo_session *session, grobo_exit_policy policy)
{
    REQUEST(session, true, grobo_robot_exit(&session->robot, policy, grobo_now_us()));
}

int grobo_session_cancel(grobo_session *session)
{
    REQUEST(session, true, grobo_robot_cancel(&session->robot, grobo_now_us()));
}

int grobo_session_play(grobo_session *session, const grobo_clip *clip,
                       const grobo_play_options *options)
{
    REQUEST(session, clip != NULL,
            grobo_robot_play(&session->robot, clip, options, grobo_now_us()));
}

int grobo_session_enqueue(grobo_session *session, const grobo_clip *clip,
                          const grobo_play_options *options)
{
    REQUEST(session, clip != NULL,
            grobo_robot_enqueue(&session->robot, clip, options, grobo_now_us()));
}

int grobo_session_pause(grobo_session *session)
{
    REQUEST(session, true, grobo_robot_pause(&session->robot, grobo_now_us()));
}

int grobo_session_resume(grobo_session *session)
{
    REQUEST(session, true, grobo_robot_resume(&session->robot, grobo_now_us()));
}

int grobo_session_stop(grobo_session *session, bool at_once)
{
    REQUEST(session, true, grobo_robot_stop(&session->robot, at_once, grobo_now_us()));
}

int grobo_session_seek(grobo_session *session, int64_t clip_us)
{
    REQUEST(session, true, grobo_robot_seek(&session->robot, clip_us, grobo_now_us()));
}

int grobo_session_speed(grobo_session *session, int speed_pct)
{
    REQUEST(session, true, grobo_robot_speed(&session->robot, speed_pct, grobo_now_us()));
}

int grobo_session_free_mode(grobo_session *session, grobo_joint_mask joints, bool on)
{
    REQUEST(session, true, grobo_robot_free(&session->robot, joints, on, grobo_now_us()));
}

/* These two are for the engine in any state: a stop is latched without a line as well. */

int grobo_session_estop(grobo_session *session)
{
    if (session == NULL) {
        return GROBO_ERR_ARG;
    }
    int r;

    atomic_fetch_add(&session->estops, 1);
    grobo_i_session_enter(session);
    r = grobo_robot_estop(&session->robot, grobo_now_us());
    grobo_i_session_leave(session);
    return r;
}

/* One that was set since the last look is obeyed, not cleared. */
int grobo_session_reset(grobo_session *session)
{
    if (session == NULL) {
        return GROBO_ERR_ARG;
    }
    grobo_trip_info trip;
    int r = GROBO_OK;

    grobo_i_session_enter(session);
    grobo_i_session_obey(session); /* what was posted came before */
    session->estop.looked_us = 0;
    grobo_i_session_estop_look(session);
    grobo_robot_tripped(&session->robot, &trip);
    if (grobo_robot_job(&session->robot) == GROBO_JOB_ESTOP) {
        r = GROBO_ERR_STATE;
    } else if (session->estop.on && trip.trip == GROBO_TRIP_ESTOP) {
        r = grobo_i_estop_clear(&session->estop.names, &session->cause);
    }
    if (r >= 0) {
        r = grobo_robot_reset(&session->robot, grobo_now_us());
    }
    grobo_i_session_leave(session);
    return r;
}
