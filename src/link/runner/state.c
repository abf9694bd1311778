/* SPDX-License-Identifier: MIT */
/* A runner's facts. */
#include "src/link/runner/runner.h"

const char *grobo_runner_name(const grobo_runner *runner)
{
    return runner == NULL ? NULL : runner->name;
}

int grobo_runner_joints(const grobo_runner *runner)
{
    return runner == NULL ? GROBO_ERR_ARG : runner->driver->model->n_joints;
}

/* With the lock. */
int64_t grobo_i_runner_default_us(const grobo_runner *runner)
{
    int64_t time_us = runner->robot_config.default_time_us;

    return time_us != 0 ? time_us : GROBO_POSTURE_TIME_US;
}
