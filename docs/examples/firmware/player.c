/* SPDX-License-Identifier: MIT */
/*
 * The other end of the wire: a microcontroller that has a GR001 at its UART and makes it wave, with
 * the engine's limits, read-back and watch over heat and voltage. It holds the last posture.
 */
#include <grobo/core/static.h>

#include "mcu.h"

#define RAD(deg) ((deg)*0.017453292519943295)

/* ---- the motion: a table in flash ---- */

enum { R_SHOULDER_R = 15, R_ELBOW_P = 16, KEYS = 4, KEY_US = 600000 };

static const double elbow_rad[KEYS] = {RAD(-30), RAD(-70), RAD(-30), RAD(-50)};

static int wave_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    (void)grobo_posture_init(posture, grobo_gr001_model()->n_joints);
    (void)grobo_posture_set_rad(posture, R_SHOULDER_R, RAD(-60));
    (void)grobo_posture_set_rad(posture, R_ELBOW_P, elbow_rad[i]);
    posture->time_us = KEY_US;
    *at_us = ((int64_t)i + 1) * KEY_US;
    return 0;
}

static const grobo_clip wave = {
    .key = wave_key, .length_us = KEYS * KEY_US, .n_keys = KEYS, .n_joints = 20};

/* ---- the robot ---- */

static grobo_robot robot;

/* When the robot has answered, it plays. A robot that did not, or could not be brought to where the
 * motion begins, is asked anew; one that was stopped for safety refuses, and stays as it is. */
static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind != GROBO_EVENT_JOB) {
        return;
    }
    if (event->u.job.result < 0) {
        (void)grobo_robot_check(&robot);
    } else if (event->u.job.kind == GROBO_JOB_CHECK) {
        (void)grobo_robot_play(&robot, &wave, NULL);
    }
}

int main(void)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    const grobo_driver *driver = grobo_gr001_driver(GROBO_WIRING_BOARD);
    mcu_start();
    if (grobo_robot_init(&robot, driver, NULL, NULL, mcu_now_us()) < 0) {
        return 1;
    }
    grobo_robot_on_event(&robot, on_event, NULL);
    grobo_robot_link_up(&robot, mcu_now_us());
    (void)grobo_robot_check(&robot);
    for (;;) {
        size_t got = mcu_uart_read(bytes, sizeof bytes);
        grobo_robot_rx(&robot, bytes, got, mcu_now_us());
        grobo_robot_step(&robot, mcu_now_us());
        if (mcu_uart_room() >= sizeof bytes) {
            int n = grobo_robot_tx(&robot, bytes, sizeof bytes, mcu_now_us());
            mcu_uart_write(bytes, n > 0 ? (size_t)n : 0);
        }
        mcu_wait_until(grobo_robot_deadline(&robot, mcu_now_us()));
    }
}
