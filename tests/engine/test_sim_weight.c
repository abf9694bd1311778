/* SPDX-License-Identifier: MIT */
/*
 * Simulated servos that carry weight: what they do by their registers, against what the equations
 * of a spring, a lever and a winding say of it.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/robot_file.h>

#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { LIFT = 1, ELBOW = 2, SECOND_US = 1000000 };

#define PI 3.14159265358979323846
/* An STS3215 at P 32 (reference: Open Duck Mini uses the same value), and the fit's friction. */
#define STIFFNESS_NM_RAD 17.8
#define FRICTION_NM 0.0524

static void assert_near(double is, double wanted, double apart)
{
    if (!(fabs(is - wanted) <= apart)) {
        fail_msg("%g is not within %g of %g", is, apart, wanted);
    }
}

static grobo_sim sim;
static grobo_sim_physics *physics;
static grobo_robot_sim setting;
static int64_t now_us;

static const grobo_robot_def *robot_named(const char *name)
{
    for (int i = 0; grobo_i_robot_defs[i] != NULL; i++) {
        if (strcmp(grobo_i_robot_defs[i]->name, name) == 0) {
            return grobo_i_robot_defs[i];
        }
    }
    fail_msg("no robot %s", name);
    return NULL;
}

static int end(void)
{
    grobo_sim_physics_free(physics);
    physics = NULL;
    return 0;
}

/* At its initial posture, limp, at time 0. */
static void begin(const grobo_robot_def *def)
{
    (void)end();
    assert_int_equal(grobo_robot_def_sim(def, def->wiring, &setting), 0);
    assert_int_equal(grobo_robot_def_physics(def, false, NULL, &physics), 0);
    setting.config.physics = physics;
    now_us = 0;
    assert_int_equal(grobo_sim_init(&sim, &setting.config, now_us), 0);
}

static void wait_us(int64_t us)
{
    now_us += us;
    grobo_sim_step(&sim, now_us);
}

static void set(int servo, grobo_register_role role, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(setting.servos[servo], role);
    assert_non_null(reg);
    assert_int_equal(grobo_sim_set_register(&sim, servo, reg->address, value), 0);
}

static void set_named(int servo, const char *name, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_named(setting.servos[servo], name);
    assert_non_null(reg);
    assert_int_equal(grobo_sim_set_register(&sim, servo, reg->address, value), 0);
}

static int32_t get(int servo, grobo_register_role role)
{
    const grobo_servo_register *reg = grobo_servo_register_of(setting.servos[servo], role);
    int32_t value = 0;
    assert_non_null(reg);
    assert_int_equal(grobo_sim_get_register(&sim, servo, reg->address, &value), 0);
    return value;
}

static grobo_sim_physics_view look(int joint)
{
    grobo_sim_physics_view view;
    assert_int_equal(grobo_sim_physics_look(physics, joint, &view), 0);
    return view;
}

static double angle_deg(int servo)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&sim, servo, &view), 0);
    return view.angle_mdeg / 1000.0;
}

/* Holds where it is. */
static void hold_all(void)
{
    for (int i = 0; i < grobo_sim_servos(&sim); i++) {
        set(i, GROBO_ROLE_TORQUE, 1);
    }
}

/* ---- one arm --------------------------------------------------------------------------------- */

TEST(a_limp_arm_falls_to_its_stop)
{
    begin(robot_named("so101"));
    wait_us(3 * SECOND_US);
    assert_near(angle_deg(LIFT), 100, 0.01);
    assert_true(fabs(look(LIFT).speed_rad_s) < 1e-6);
    (void)end();
}

/* A spring of this stiffness under the torque of the links, less what friction may take. */
static void sags(int gain)
{
    begin(robot_named("so101"));
    set_named(LIFT, "position_p", gain);
    hold_all();
    wait_us(3 * SECOND_US);
    const grobo_sim_physics_view view = look(LIFT);
    double error_rad = angle_deg(LIFT) * PI / 180 - view.set_rad;
    double spring_nm = STIFFNESS_NM_RAD * gain / 32 * error_rad;
    double step_nm = STIFFNESS_NM_RAD * gain / 32 * 2 * PI / 4096;
    print_message("P %d: load %.3f Nm, error %.2f deg\n", gain, view.load_nm, error_rad * 180 / PI);
    assert_true(view.load_nm > 0.4);
    assert_true(fabs(spring_nm - view.load_nm) < FRICTION_NM + step_nm + 0.01);
    (void)end();
}

TEST(a_held_joint_sags_by_its_load)
{
    sags(32);
    sags(16);
    sags(8);
}

TEST(the_same_times_give_the_same_angles_to_the_bit)
{
    grobo_sim_physics_view once[6], again[6];
    for (int round = 0; round < 2; round++) {
        begin(robot_named("so101"));
        hold_all();
        int64_t slice_us = round == 0 ? 100000 : 700, goal_us = 500000;
        while (now_us < goal_us) {
            wait_us(now_us + slice_us > goal_us ? goal_us - now_us : slice_us);
        }
        set(LIFT, GROBO_ROLE_GOAL, 1700);
        while (now_us < 2 * SECOND_US) {
            wait_us(now_us + slice_us > 2 * SECOND_US ? 2 * SECOND_US - now_us : slice_us);
        }
        for (int i = 0; i < 6; i++) {
            (round == 0 ? once : again)[i] = look(i);
            (round == 0 ? once : again)[i].motor = NULL;
        }
    }
    assert_memory_equal(once, again, sizeof once);
    (void)end();
}

TEST(a_payload_pulls_and_its_end_lifts)
{
    begin(robot_named("so101"));
    hold_all();
    wait_us(2 * SECOND_US);
    double bare_deg = angle_deg(LIFT), bare_nm = look(LIFT).load_nm;
    assert_int_equal(grobo_sim_set_payload(&sim, "tool", 0.2), 0);
    wait_us(2 * SECOND_US);
    /* The tool is 0.391 m before the base's origin, the axis of lift 0.0692 m: 0.32 m or so. */
    assert_near(look(LIFT).load_nm - bare_nm, 0.2 * 9.80665 * 0.32, 0.06);
    assert_true(angle_deg(LIFT) > bare_deg + 1);
    assert_int_equal(grobo_sim_set_payload(&sim, "tool", 0), 0);
    wait_us(2 * SECOND_US);
    assert_near(look(LIFT).load_nm, bare_nm, 0.01);
    assert_int_equal(grobo_sim_set_payload(&sim, "tail", 0.2), GROBO_ERR_NOTFOUND);
    assert_int_equal(grobo_sim_set_payload(&sim, NULL, NAN), GROBO_ERR_ARG);
    (void)end();
}

TEST(a_wall_stops_a_joint_and_its_servo_is_overloaded)
{
    begin(robot_named("so101"));
    hold_all();
    wait_us(SECOND_US);
    assert_int_equal(grobo_sim_set_wall(&sim, ELBOW, -180000, 10000), 0);
    set(ELBOW, GROBO_ROLE_GOAL, 2048 + 600);
    wait_us(SECOND_US);
    assert_near(angle_deg(ELBOW), 10, 0.05);
    assert_true(get(ELBOW, GROBO_ROLE_CURRENT) * 6.5 > 1000);
    assert_int_equal(get(ELBOW, GROBO_ROLE_ERROR), 0);
    wait_us(3 * SECOND_US); /* 2 s above 80 % */
    assert_int_equal(get(ELBOW, GROBO_ROLE_ERROR), 32);
    wait_us(SECOND_US / 10);
    assert_true(get(ELBOW, GROBO_ROLE_CURRENT) * 6.5 < 700);
    (void)end();
}

TEST(a_hand_pushes_and_the_joint_comes_back)
{
    begin(robot_named("so101"));
    hold_all();
    wait_us(2 * SECOND_US);
    double before_deg = angle_deg(LIFT);
    assert_int_equal(grobo_sim_push(&sim, LIFT, 1), 0);
    wait_us(SECOND_US);
    assert_true(angle_deg(LIFT) > before_deg + 2);
    assert_int_equal(grobo_sim_push(&sim, LIFT, 0), 0);
    wait_us(SECOND_US);
    /* Friction may leave it anywhere within its band. */
    assert_near(angle_deg(LIFT), before_deg, 2 * FRICTION_NM / STIFFNESS_NM_RAD * 180 / PI + 0.2);
    (void)end();
}

TEST(a_hand_that_turns_a_shaft_is_stronger)
{
    begin(robot_named("so101"));
    hold_all();
    wait_us(SECOND_US);
    assert_int_equal(grobo_sim_set_angle(&sim, LIFT, -40000, SECOND_US), 0);
    wait_us(SECOND_US / 2);
    assert_near(angle_deg(LIFT), -20, 1.5);
    wait_us(SECOND_US / 2);
    assert_near(angle_deg(LIFT), -40, 0.5);
    wait_us(2 * SECOND_US); /* lets it go, and the servo brings it back */
    assert_near(angle_deg(LIFT), 0, 3);
    (void)end();
}

TEST(a_weak_supply_sags_and_resets)
{
    begin(robot_named("so101"));
    hold_all();
    wait_us(2 * SECOND_US);
    int32_t held = get(LIFT, GROBO_ROLE_VOLTAGE);
    assert_int_equal(grobo_sim_set_supply_mohm(&sim, 2000), 0);
    wait_us(SECOND_US);
    assert_true(get(LIFT, GROBO_ROLE_VOLTAGE) < held);
    assert_int_equal(grobo_sim_set_supply_mohm(&sim, 20000), 0);
    set(LIFT, GROBO_ROLE_GOAL, 1500);
    wait_us(2 * SECOND_US);
    assert_int_equal(get(LIFT, GROBO_ROLE_TORQUE), 0);
    (void)end();
}

TEST(current_and_heat_are_those_of_the_winding)
{
    begin(robot_named("so101"));
    assert_int_equal(grobo_sim_set_payload(&sim, "tool", 0.3), 0);
    hold_all();
    wait_us(5 * SECOND_US);
    const grobo_sim_physics_view view = look(LIFT);
    /* It carries the load but for what friction does of it. */
    assert_near(fabs(view.winding_a) * 1.21164, view.load_nm, FRICTION_NM + 0.01);
    assert_near(abs(get(LIFT, GROBO_ROLE_CURRENT)) * 6.5, fabs(view.winding_a) * 1000, 7);
    double start_c = get(LIFT, GROBO_ROLE_TEMPERATURE);
    wait_us((int64_t)1800 * SECOND_US);
    double stall_a = 2.4, rise_c = 122 * view.winding_a * view.winding_a / stall_a / stall_a;
    assert_near(get(LIFT, GROBO_ROLE_TEMPERATURE), 25 + rise_c, 1.5);
    assert_true(get(LIFT, GROBO_ROLE_TEMPERATURE) > start_c + 3);
    (void)end();
}

/* ---- a file of one's own ------------------------------------------------------------------- */

static int take_text(void *ctx, void *buffer, size_t size)
{
    const char **text = ctx;
    size_t n = strlen(*text);
    n = n < size ? n : size;
    memcpy(buffer, *text, n);
    *text += n;
    return (int)n;
}

TEST(a_file_overrides_motors)
{
    const char *text = "name: one\nfamily: feetech\njoints:\n"
                       "  - {name: a, id: 1, servo: STS3215, limits_deg: [-90, 90],\n"
                       "     motor: {friction_nm: 0.5, armature_kgm2: 0.01}}\n"
                       "  - {name: b, id: 2, servo: STS3215, limits_deg: [-90, 90]}\n";
    grobo_robot_def *def = NULL;
    assert_int_equal(
        grobo_robot_def_read(&(grobo_source){take_text, &text}, "one", NULL, NULL, &def), 0);
    begin(def);
    const grobo_sim_motor *a = look(0).motor, *b = look(1).motor;
    assert_int_equal(a->from, GROBO_SIM_MOTOR_GIVEN);
    assert_near(a->friction.base_nm, 0.5, 0);
    assert_near(a->friction.viscous_nms, 0, 0);
    assert_near(a->armature_kgm2, 0.01, 0);
    assert_near(a->kt_nm_a, b->kt_nm_a, 0);
    assert_int_equal(b->from, GROBO_SIM_MOTOR_IDENTIFIED);
    assert_near(b->friction.base_nm, 0.0523930, 0);
    (void)end();
    grobo_robot_def_free(def);
}

/* ---- every robot, every model ---------------------------------------------------------------- */

static const grobo_robot_def *next_robot(const grobo_robot_def *before)
{
    for (int i = 0; grobo_i_robot_defs[i] != NULL; i++) {
        if (before == NULL || grobo_i_robot_defs[i] == before) {
            return grobo_i_robot_defs[before == NULL ? 0 : i + 1];
        }
    }
    return NULL;
}

/* It holds where it was, within what its loops can, and stands. */
TEST_FOR(grobo_robot_def, next_robot, each_robot_holds_itself)
{
    double at_deg[GROBO_JOINTS_MAX];
    begin(row);
    for (int i = 0; i < row->model->n_joints; i++) {
        at_deg[i] = angle_deg(i);
    }
    hold_all();
    wait_us(3 * SECOND_US);
    for (int i = 0; i < row->model->n_joints; i++) {
        const grobo_sim_physics_view view = look(i);
        assert_true(isfinite(view.angle_rad));
        assert_true(fabs(view.speed_rad_s) < 0.02);
        assert_near(angle_deg(i), at_deg[i], 8); /* XL330 with a soft loop */
    }
    (void)end();
}

/* A servo with a lever of this share of its stall torque. */
static void hold_lever(const grobo_robot_family *family, const grobo_servo_model *servo)
{
    grobo_sim_motor motor;
    assert_int_equal(grobo_sim_motor_of(servo, &motor), 0);
    double stall_nm = motor.kt_nm_a * servo->voltage_mv / 1000 / motor.resistance_ohm;
    double mass_kg = 0.15 * stall_nm / 9.80665 / 0.1;
    const grobo_joint joint = {.name = "lever",
                               .min_rad = -1.5,
                               .max_rad = 1.5,
                               .max_speed_rad_s = 1,
                               .servo_model = servo->number,
                               .motor = 1,
                               .mirror_sign = 1};
    const grobo_model model =
        GROBO_TABLE(grobo_model, .name = "lever", GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    const grobo_sim_link link = {.parent = -1,
                                 .joint = 0,
                                 .r = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                 .axis = {0, -1, 0},
                                 .mass_kg = mass_kg,
                                 .com_m = {-0.1, 0, 0}};
    const grobo_sim_physics_config config = {GROBO_SIM_PHYSICS_CONFIG_INIT, .model = &model,
                                             .links = &link, .n_links = 1};
    (void)end();
    assert_int_equal(grobo_sim_physics_new(&config, NULL, &physics), 0);
    setting.servos[0] = servo;
    setting.config = (grobo_sim_config){GROBO_SIM_CONFIG_INIT,
                                        .model = &model,
                                        .wiring = GROBO_WIRING_BUS,
                                        .servos = setting.servos,
                                        .families = grobo_i_sim_families,
                                        .baud_bps = family->baud_bps,
                                        .supply_mv = servo->voltage_mv,
                                        .physics = physics};
    now_us = 0;
    assert_int_equal(grobo_sim_init(&sim, &setting.config, 0), 0);
    set(0, GROBO_ROLE_TORQUE, 1);
    wait_us(2 * SECOND_US);
    double held_deg = angle_deg(0), speed_rad_s = look(0).speed_rad_s;
    double current_a = look(0).winding_a;
    set(0, GROBO_ROLE_TORQUE, 0);
    wait_us(2 * SECOND_US);
    print_message("%-14s %5.2f Nm: held with an error of %5.2f deg, %5.0f mA; then %.1f deg\n",
                  servo->name, stall_nm, held_deg, current_a * 1000, angle_deg(0));
    assert_true(fabs(held_deg) < 10); /* the small ones have soft loops */
    assert_true(fabs(speed_rad_s) < 0.02);
    /* The friction that was identified of an XL-320 carries this lever from 52 degrees on. */
    assert_true(fabs(angle_deg(0)) > 50);
}

static const grobo_robot_family *next_family(const grobo_robot_family *before)
{
    for (int i = 0; grobo_i_robot_families[i] != NULL; i++) {
        if (before == NULL || grobo_i_robot_families[i] == before) {
            return grobo_i_robot_families[before == NULL ? 0 : i + 1];
        }
    }
    return NULL;
}

TEST_FOR(grobo_robot_family, next_family, each_model_holds_a_lever_and_drops_it)
{
    for (int t = 0; row->tables[t] != NULL; t++) {
        for (int i = 0; i < row->tables[t]->model_count; i++) {
            hold_lever(row, &row->tables[t]->models[i]);
        }
    }
    (void)end();
}

/* ---- without a world ------------------------------------------------------------------------ */

TEST(without_a_world_there_is_nothing_to_push)
{
    (void)end();
    const grobo_robot_def *def = robot_named("so101");
    assert_int_equal(grobo_robot_def_sim(def, def->wiring, &setting), 0);
    now_us = 0;
    assert_int_equal(grobo_sim_init(&sim, &setting.config, 0), 0);
    assert_int_equal(grobo_sim_push(&sim, 0, 1), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_sim_set_payload(&sim, NULL, 1), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_sim_set_wall(&sim, 0, 0, 1), GROBO_ERR_UNSUPPORTED);
    assert_int_equal(grobo_sim_set_supply_mohm(&sim, 1), GROBO_ERR_UNSUPPORTED);
    wait_us(3 * SECOND_US);
    assert_near(angle_deg(LIFT), 0, 0.001);
}
