/* SPDX-License-Identifier: MIT */
/*
 * Replies of each family, sound by their sums and with anything in them, and such that are not:
 * servos whose registers hold any bytes, in front of an engine that reads, moves, stops and leaves.
 *
 * Input: byte 0 the family, byte 1 what is asked for, byte 2 which bytes of replies are changed (0:
 * none); then the registers of the servos, again from the beginning where there are too few.
 */
#include <math.h>
#include <string.h>

#include "tests/fuzz/target.h"
#include "tests/support/halt_kit.h"

enum { HEAD = 3, RUN_US = 400 * HALT_MS };

/* What is asked for, three of it one behind the other. */
static void ask(unsigned what)
{
    grobo_posture p = halt_posture(20, 200 * HALT_MS, true);
    grobo_joint_mask all = GROBO_JOINTS_ALL(halt.of->n_joints);
    switch (what % 6) {
    case 0:
        (void)grobo_robot_sense(&halt.robot, all, GROBO_SENSE_ALL);
        break;
    case 1:
        (void)grobo_robot_move(&halt.robot, &p);
        break;
    case 2:
        (void)grobo_robot_torque(&halt.robot, all, GROBO_TORQUE_ON);
        break;
    case 3:
        (void)grobo_robot_estop(&halt.robot);
        break;
    case 4:
        (void)grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD);
        break;
    default:
        (void)grobo_robot_free(&halt.robot, all, true);
        break;
    }
}

static void fill(const uint8_t *bytes, size_t n)
{
    size_t at = 0;
    for (int i = 0; n > 0 && i < halt.far.n_joints; i++) {
        for (int k = 0; k < FAR_REGISTERS; k++) {
            halt.far.joint[i].reg[k] = bytes[at++ % n];
        }
    }
}

/* Time passes; replies come as they are, or one byte of each is another. */
static void run(int64_t us, uint8_t change)
{
    int64_t until_us = halt.now_us + us;
    while (halt.now_us < until_us) {
        halt_run(HALT_MS);
        for (int i = 0; change != 0 && i < halt.far.n_replies; i++) {
            far_reply *reply = &halt.far.reply[i];
            reply->bytes[change % (unsigned)reply->n] ^= (uint8_t)(change | 1U);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < HEAD) {
        return 0;
    }
    const halt_robot *robot = halt_robot_of(data[0] % HALT_FAMILIES);
    halt_begin(robot, 0);
    fill(data + HEAD, size - HEAD);
    for (unsigned what = data[1], i = 0; i < 3; i++, what /= 6) {
        ask(what);
        run(RUN_US / 4, data[2]);
        fill(data + HEAD, (size - HEAD) / (i + 1));
    }
    run(RUN_US, data[2]);
    for (int j = 0; j < robot->n_joints; j++) {
        grobo_joint_info info;
        MUST(grobo_robot_joint(&halt.robot, j, &info) == GROBO_OK);
        MUST((info.state.valid & GROBO_FIELD_ANGLE) == 0 || isfinite(info.state.angle_rad));
        MUST(!info.has_target || isfinite(info.target_rad));
    }
    return 0;
}
