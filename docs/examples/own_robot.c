/* SPDX-License-Identifier: MIT */
/*
 * A robot of one's own in a file: an arm of four RS30x servos on a bare bus.
 *
 * The tables say what it is made of; the driver is the library's for RS30x servos, with one
 * function of ours: a stabilizer that keeps the gripper level whatever the other joints do. Then
 * the engine is pumped by hand, against a simulated bus and in virtual time; on a real line the
 * bytes would go through a port (or session.h would do all of it).
 */
#include <stdio.h>

#include <grobo/sim_static.h>
#include <grobo/static.h>

#define RAD(deg) ((deg)*0.017453292519943295)

/* ---- what the robot is made of ---- */

enum { BASE, SHOULDER, ELBOW, WRIST, JOINTS };

#define JOINT(name_, index, id, low_deg, high_deg, init_deg)                                       \
    {                                                                                              \
        .name = (name_), .motor = (id), .servo_model = 0x3030, .min_rad = RAD(low_deg),            \
        .max_rad = RAD(high_deg), .init_rad = RAD(init_deg), .max_speed_rad_s = RAD(375),          \
        .mirror = (index), .mirror_sign = 1                                                        \
    }

static const grobo_joint joints[JOINTS] = {
    JOINT("BASE", BASE, 11, -150, 150, 0),
    JOINT("SHOULDER", SHOULDER, 12, -90, 90, -30),
    JOINT("ELBOW", ELBOW, 13, -120, 120, 60),
    JOINT("WRIST", WRIST, 14, -100, 100, -30),
};
static const grobo_group groups[] = {{"all", 0xF}, {"arm", 0x7}};
static const grobo_model model = {"ARM", joints, groups, JOINTS, 2, 0};

/* The gripper is level when shoulder, elbow and wrist add up to zero. What comes out is checked
 * against the limits like any other target. */
static int keep_level(const grobo_driver *self, void *ctx, const grobo_posture *sensed,
                      grobo_posture *target)
{
    (void)self;
    (void)ctx;
    (void)sensed;
    if ((target->set & 0xE) == 0xE) {
        target->angle_rad[WRIST] = -(target->angle_rad[SHOULDER] + target->angle_rad[ELBOW]);
    }
    return GROBO_OK;
}

/* ---- the pump: bytes and the time ---- */

static grobo_robot robot;
static grobo_sim sim;
static int64_t now_us;
static const char *failure;

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB && event->u.job.result < 0) {
        failure = grobo_error_text(event->u.job.result);
    }
}

static void pump(void)
{
    uint8_t buf[GROBO_FRAME_MAX_BYTES];
    size_t got;
    while ((got = grobo_sim_tx(&sim, buf, sizeof buf, now_us)) > 0) {
        grobo_robot_rx(&robot, buf, got, now_us);
    }
    grobo_robot_step(&robot, now_us);
    int n;
    while ((n = grobo_robot_tx(&robot, buf, sizeof buf, now_us)) > 0) {
        (void)grobo_sim_rx(&sim, buf, (size_t)n, now_us);
    }
    int64_t next_us = grobo_robot_deadline(&robot, now_us);
    int64_t sim_us = grobo_sim_packet_deadline(&sim);
    next_us = sim_us < next_us ? sim_us : next_us;
    now_us = next_us > now_us ? next_us : now_us + 1;
}

static int finish(int job)
{
    if (job < 0) {
        failure = grobo_error_text(job);
    }
    while (failure == NULL && grobo_robot_job(&robot) != GROBO_JOB_NONE) {
        pump();
    }
    if (failure != NULL) {
        fprintf(stderr, "own_robot: %s\n", failure);
        return -1;
    }
    return 0;
}

int main(void)
{
    grobo_driver driver;
    grobo_sim_config sim_config = {GROBO_SIM_CONFIG_INIT, .model = &model,
                                   .wiring = GROBO_WIRING_BUS};
    if (grobo_rs30x_driver_init(&driver, &model, &grobo_rs30x_protocol) < 0) {
        return 1;
    }
    driver.stabilize = keep_level;
    driver.on_exit = GROBO_EXIT_SIT; /* goes to its initial posture and lets go */
    if (grobo_sim_init(&sim, &sim_config, now_us) < 0 ||
        grobo_robot_init(&robot, &driver, NULL, NULL, now_us) < 0) {
        return 1;
    }
    grobo_robot_on_event(&robot, on_event, NULL);
    grobo_robot_link_up(&robot, now_us);

    grobo_posture reach;
    (void)grobo_posture_init(&reach, JOINTS);
    (void)grobo_posture_set_deg(&reach, BASE, 45);
    (void)grobo_posture_set_deg(&reach, SHOULDER, 20);
    (void)grobo_posture_set_deg(&reach, ELBOW, 30);
    (void)grobo_posture_set_deg(&reach, WRIST, 0); /* the stabilizer knows better */
    (void)grobo_posture_set_time_ms(&reach, 800);

    if (finish(grobo_robot_check(&robot)) < 0 || finish(grobo_robot_move(&robot, &reach)) < 0) {
        return 1;
    }
    grobo_posture here;
    (void)grobo_robot_posture(&robot, GROBO_NEVER_US, &here);
    for (int j = 0; j < JOINTS; j++) {
        double angle_deg = 0;
        (void)grobo_posture_get_deg(&here, j, &angle_deg);
        printf("%-8s motor %d %7.1f deg\n", joints[j].name, joints[j].motor, angle_deg);
    }
    return finish(grobo_robot_exit(&robot, GROBO_EXIT_DEFAULT)) < 0 ? 1 : 0;
}
