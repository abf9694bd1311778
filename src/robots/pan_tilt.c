/* SPDX-License-Identifier: MIT */
/* Made from src/robots/pan-tilt.yaml by `make robots`. */
#include "src/robots/robots.h"

#define PI 3.14159265358979323846
#define RAD(angle_deg) ((angle_deg)*PI / 180.0)

static const grobo_joint joints[] = {
    {.name = "pan",
     .min_rad = RAD(-120),
     .max_rad = RAD(120),
     .max_speed_rad_s = RAD(240),
     .init_rad = 0,
     .servo_model = 0x0309,
     .free_current_ma = 0,
     .motor = 1,
     .mirror = 0,
     .mirror_sign = 1},
    {.name = "tilt",
     .min_rad = RAD(-60),
     .max_rad = RAD(45),
     .max_speed_rad_s = RAD(240),
     .init_rad = 0,
     .servo_model = 0x0309,
     .free_current_ma = 0,
     .motor = 2,
     .mirror = 1,
     .mirror_sign = 1,
     .sign = -1,
     .zero_rad = RAD(30)},
};

static const grobo_model model =
    GROBO_TABLE(grobo_model, .name = "pan-tilt", GROBO_MODEL_JOINTS(joints), .n_joints = 2,
                .limit_slack_deg = 0);

const grobo_robot_def grobo_i_robot_pan_tilt = {.name = "pan-tilt",
                                                .title = "Pan and tilt",
                                                .family = &grobo_i_family_feetech,
                                                .model = &model,
                                                .wiring = GROBO_WIRING_BUS,
                                                .baud_bps = 1000000,
                                                .payload_link = -1,
                                                .limits = {.temperature_c = 65,
                                                           .lost_replies = 5,
                                                           .current_ma = 0,
                                                           .voltage_mv = 0,
                                                           .current_us = 0,
                                                           .approach_rad_s = RAD(60)},
                                                .on_exit = GROBO_EXIT_OFF,
                                                .arm = true};
