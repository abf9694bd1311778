/* SPDX-License-Identifier: MIT */
/*
 * Motors of servos. Those that somebody has identified on real servos are a table; all others are
 * made of what the model's table has from the data sheet, and say so.
 */

#include "src/sim/physics/physics.h"

#define PI 3.14159265358979323846

/* "Rhoban/bam" names the repository of the paper's parameters. */
#define BAM "Rhoban/bam (2026-07-24), arXiv 2410.08650, fitted to real servos"

static const grobo_sim_motor identified[] = {
    /* Model m1. The set point follows the goal with 3400 steps a second. The fit would stall at
     * 3.25 Nm; the seller states 1.91 Nm, which is the bound here. */
    {.model = "STS3215",
     .source = BAM ", model m1",
     .duty_per_rad = 0.166,
     .duty_max = 0.97,
     .kt_nm_a = 1.21164,
     .resistance_ohm = 2.67617,
     .armature_kgm2 = 0.0284034,
     .torque_max_nm = 1.91,
     .profile_rad_s = 3400 * 2 * PI / 4096,
     .friction = {.base_nm = 0.0523930, .viscous_nms = 0.0590852}},
    /* Model m6 from here on. Duty for a gain of 1: 4096 counts a turn, by 256 and 885. */
    {.model = "XL330-M288",
     .source = BAM ", model m6 (\"XL330\"; which gear is not named)",
     .duty_per_rad = 4096 / (2 * PI) / (256 * 885),
     .duty_max = 1,
     .kt_nm_a = 0.366013,
     .resistance_ohm = 2.81139,
     .armature_kgm2 = 0.00180774,
     .friction = {.base_nm = 0.00477118,
                  .viscous_nms = 0.00535967,
                  .stribeck_nm = 0.00467635,
                  .load_external = 8.51587e-6,
                  .load_motor = 0.266786,
                  .load_external_s = 0.0807793,
                  .load_motor_s = 1.07229e-5,
                  .square_external = 0.00490257,
                  .square_motor = 0.00997247,
                  .stribeck_rad_s = 2.89037,
                  .stribeck_power = 8.68326}},
    {.model = "MX-64",
     .source = BAM ", model m6",
     .duty_per_rad = 0.158,
     .duty_max = 0.9625,
     .kt_nm_a = 1.60168,
     .resistance_ohm = 2.31640,
     .armature_kgm2 = 0.0122659,
     .friction = {.base_nm = 6.21792e-7,
                  .viscous_nms = 0.0253370,
                  .stribeck_nm = 0.122695,
                  .load_external = 2.0462e-8,
                  .load_motor = 0.311472,
                  .load_external_s = 0.0140659,
                  .load_motor_s = 0.187744,
                  .square_external = 0.00999998,
                  .square_motor = 0.00690851,
                  .stribeck_rad_s = 2.57528,
                  .stribeck_power = 0.840902}},
    {.model = "MX-106",
     .source = BAM ", model m6",
     .duty_per_rad = 0.158,
     .duty_max = 0.9625,
     .kt_nm_a = 2.20983,
     .resistance_ohm = 2.03366,
     .armature_kgm2 = 0.0260162,
     .friction = {.base_nm = 1.02325e-5,
                  .viscous_nms = 0.0507157,
                  .stribeck_nm = 0.121954,
                  .load_external = 0.0222155,
                  .load_motor = 0.198006,
                  .load_external_s = 0.0871033,
                  .load_motor_s = 0.198600,
                  .square_external = 7.32692e-5,
                  .square_motor = 0.00999993,
                  .stribeck_rad_s = 1.74633,
                  .stribeck_power = 1.14283}},
    {.model = "XL-320",
     .source = BAM ", model m6",
     .duty_per_rad = 0.0504820,
     .duty_max = 1,
     .kt_nm_a = 1.00883,
     .resistance_ohm = 31.5859,
     .armature_kgm2 = 0.00116299,
     .friction = {.base_nm = 4.33378e-7,
                  .viscous_nms = 0.00722517,
                  .stribeck_nm = 0.0163055,
                  .load_external = 0.158325,
                  .load_motor = 3.08821e-6,
                  .load_external_s = 0.245483,
                  .load_motor_s = 5.96572e-9,
                  .square_external = 0.00471093,
                  .square_motor = 0.00361641,
                  .stribeck_rad_s = 2.30105,
                  .stribeck_power = 1.70674}},
};

/* Of a servo that nobody has identified: part of its stall torque that friction takes, inertia for
 * each Nm of it. The middle of what the identified ones have. */
#define FRICTION_PART 0.04
#define ARMATURE_KGM2_NM 0.003
/* Where a table has no torque (RS30x): what the data sheets say of the two sizes, from memory. */
#define TORQUE_FAST_NM 0.69
#define TORQUE_SLOW_NM 0.49
#define SLOW_DPS 400

int grobo_sim_motor_of(const grobo_servo_model *model, grobo_sim_motor *motor)
{
    if (model == NULL || motor == NULL) {
        return GROBO_ERR_ARG;
    }
    for (size_t i = 0; i < sizeof identified / sizeof identified[0]; i++) {
        if (grobo_i_same_text(identified[i].model, model->name)) {
            *motor = identified[i];
            return GROBO_OK;
        }
    }
    double volts = model->voltage_mv / 1000.0, top_rad_s = model->speed_dps * PI / 180;
    double stall_nm = model->torque_mnm > 0         ? model->torque_mnm / 1000.0
                      : model->speed_dps > SLOW_DPS ? TORQUE_FAST_NM
                                                    : TORQUE_SLOW_NM;
    /* Stall: kt V / R less friction is the torque; no load: what friction takes is what is left of
     * kt (V - kt w) / R. */
    double friction_nm = FRICTION_PART * stall_nm;
    double kt = volts / top_rad_s * stall_nm / (stall_nm + friction_nm);
    *motor = (grobo_sim_motor){
        .model = model->name,
        .source = "data sheet: stall torque, speed without load; friction and inertia are chosen",
        .from = GROBO_SIM_MOTOR_DATA_SHEET,
        .duty_max = 1,
        .kt_nm_a = kt,
        .resistance_ohm = kt * volts / (stall_nm + friction_nm),
        .armature_kgm2 = ARMATURE_KGM2_NM * stall_nm,
        .friction = {.base_nm = friction_nm}};
    return GROBO_OK;
}
