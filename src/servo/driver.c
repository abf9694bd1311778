/* SPDX-License-Identifier: MIT */
/* What a driver table must have. */
#include <math.h>

#include <grobo/core/driver.h>
#include <grobo/core/lines.h>
#include <grobo/core/sequencer.h>

#include "src/base/sized.h"
#include "src/model/joint.h"

static bool functions_present(const grobo_driver *driver)
{
    return driver->posture != NULL && driver->sense != NULL && driver->parse != NULL &&
           (driver->registers == NULL || driver->write_kind != NULL);
}

static bool limits_sound(const grobo_safety_limits *limits)
{
    return isfinite(limits->approach_rad_s) && limits->approach_rad_s > 0 &&
           limits->lost_replies >= 0 && limits->current_ma >= 0 && limits->voltage_mv >= 0 &&
           limits->current_us >= 0;
}

static bool rest_sound(const grobo_driver *driver)
{
    if (driver->rest_rad == NULL) {
        return true;
    }
    for (int j = 0; j < driver->model->n_joints; j++) {
        const grobo_joint *joint = grobo_i_joint(driver->model, j);
        if (!(driver->rest_rad[j] >= joint->min_rad && driver->rest_rad[j] <= joint->max_rad)) {
            return false;
        }
    }
    return true;
}

static bool readback_sound(const grobo_driver *driver)
{
    if (driver->n_readback > 0 && driver->readback == NULL) {
        return false;
    }
    for (int i = 0; i < driver->n_readback; i++) {
        if (driver->readback[i].joint >= driver->model->n_joints ||
            !isfinite(driver->readback[i].add_rad)) {
            return false;
        }
    }
    return true;
}

static bool times_sound(const grobo_driver *driver)
{
    return driver->time_step_us > 0 && driver->time_max_us >= driver->time_step_us &&
           driver->time_max_us <= GROBO_PLAY_TIME_MAX_US && isfinite(driver->angle_step_rad) &&
           driver->angle_step_rad > 0 && isfinite(driver->accel_rad_s2) &&
           driver->accel_rad_s2 >= 0;
}

static bool has_speed(const grobo_driver *driver)
{
#if GROBO_DRIVERS_PLAIN
    (void)driver;
    return false;
#else
    return GROBO_I_MEMBER(driver, driver->size, speed) != NULL;
#endif
}

#if GROBO_LINES_MAX > 1
const grobo_lines *grobo_driver_lines(const grobo_driver *driver)
{
    return driver == NULL ? NULL : GROBO_I_MEMBER(driver, driver->size, lines);
}
#endif

/* How the servo of a joint talks. */
static const grobo_protocol *protocol_of(const grobo_driver *driver, int joint)
{
#if GROBO_LINES_MAX > 1
    const grobo_lines *lines = grobo_driver_lines(driver);
    return lines != NULL ? lines->line[lines->line_of[joint]].driver.protocol : driver->protocol;
#else
    (void)joint;
    return driver->protocol;
#endif
}

static bool joints_sound(const grobo_driver *driver)
{
    for (int j = 0; j < driver->model->n_joints; j++) {
        const grobo_protocol *protocol = protocol_of(driver, j);
        uint8_t id = grobo_i_joint(driver->model, j)->motor;
        bool limits = grobo_i_joint(driver->model, j)->torque_limit_pct > 0;
        bool turns = !grobo_i_joint_is_wheel(driver->model, j) || has_speed(driver);
        if (!turns || (limits && driver->torque_limit == NULL) || id < protocol->id_min ||
            id > protocol->id_max) {
            return false;
        }
    }
    return true;
}

/* What a build for plain drivers leaves out (limits.h). */
static int check_plain(const grobo_driver *driver)
{
    bool plain = driver->accel_rad_s2 == 0 && !driver->goal_energises && !driver->tells_no_speed &&
                 !driver->keeps_setup && driver->sense_many == NULL && driver->sense_fast == NULL &&
                 driver->sense_more == NULL && driver->watchdog == NULL &&
                 driver->torque_limit == NULL;
    return GROBO_DRIVERS_PLAIN && !plain ? GROBO_ERR_UNSUPPORTED : GROBO_OK;
}

int grobo_driver_copy(grobo_driver *to, const grobo_driver *from)
{
    if (to == NULL || from == NULL) {
        return GROBO_ERR_ARG;
    }
#if GROBO_TABLES_FIXED
    *to = *from;
#else
    size_t known = GROBO_I_END_OF(to, stabilize);
    if (to->size < known || to->size > SIZED_MAX_BYTES || from->size < known) {
        return GROBO_ERR_ARG;
    }
    grobo_i_table_copy(to, to->size, from, from->size);
#endif
    return GROBO_OK;
}

/* Tables whose sizes a version had, and a sound model. */
static bool tables_sound(const grobo_driver *driver)
{
    return GROBO_I_FITS(driver, stabilize) && driver->name != NULL && driver->protocol != NULL &&
           GROBO_I_FITS(driver->protocol, relay) && grobo_model_check(driver->model) >= 0;
}

int grobo_driver_check(const grobo_driver *driver)
{
    if (driver == NULL || !tables_sound(driver)) {
        return GROBO_ERR_ARG;
    }
    bool policy = driver->on_exit == GROBO_EXIT_OFF || driver->on_exit == GROBO_EXIT_HOLD ||
                  driver->on_exit == GROBO_EXIT_SIT;
    if (!policy || !joints_sound(driver) || !times_sound(driver) || !functions_present(driver) ||
        !limits_sound(&driver->limits) || !rest_sound(driver) || !readback_sound(driver)) {
        return GROBO_ERR_ARG;
    }
    return check_plain(driver);
}

grobo_wiring grobo_driver_wiring(const grobo_driver *driver)
{
    if (driver == NULL) {
        return GROBO_WIRING_BOARD;
    }
    return driver->protocol->relay != NULL ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS;
}
