/* SPDX-License-Identifier: MIT */
/* Prints what happens while the robot moves: jobs that end, safety stops, the line. */
#include <stdio.h>

#include <grobo/grobo.h>

static void on_robot(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        printf("job %d: %s\n", event->u.job.number, grobo_error_text(event->u.job.result));
    } else if (event->kind == GROBO_EVENT_TRIP) {
        printf("safety stop: %s\n", grobo_trip_name(event->u.trip.trip));
    }
}

static void on_line(void *ctx, grobo_session *session, grobo_session_event event, int error)
{
    (void)ctx, (void)event;
    printf("line %s: %s\n", grobo_session_device(session), grobo_error_text(error));
}

int main(void)
{
    const grobo_session_config session = {GROBO_SESSION_CONFIG_INIT, .device = "sim",
                                          .on_robot = on_robot, .on_event = on_line};
    const grobo_runner_config config = {GROBO_RUNNER_CONFIG_INIT, .session = &session};
    grobo_runner *runner = NULL;
    grobo_posture pose;
    grobo_posture_init_pose(&pose, grobo_gr001_model());
    if (grobo_runner_new(&config, &runner) >= 0 && grobo_runner_connect(runner, 0) >= 0) {
        int job = grobo_robot_move(grobo_runner_robot(runner), &pose);
        (void)grobo_runner_wait_job(runner, job, 0);
        (void)grobo_runner_estop(runner);
        (void)grobo_runner_wait(runner, 0);
    }
    return runner == NULL || grobo_runner_free(runner) < 0;
}
