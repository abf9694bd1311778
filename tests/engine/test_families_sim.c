/* SPDX-License-Identifier: MIT */
/* The engine on simulated servos of each family: postures, a faulty line, an overload, stops. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <grobo/dxl2.h>
#include <grobo/feetech.h>
#include <grobo/sim_static.h>
#include <grobo/static.h>

#include "src/base/instant.h"

#define RAD(deg) ((deg)*0.017453292519943295)

enum { JOINTS = 4, MS = 1000, S = 1000000 };

typedef struct family {
    const grobo_servo_table *table;
    const char *servo;
    int (*init)(grobo_driver *driver, const grobo_model *model);
    double near_deg; /* of where it was sent */
} family;

static const family families[] = {
    {&grobo_dxl2_table, "XM430-W350", grobo_dxl2_driver_init, 0.5},
    {&grobo_sts_table, "STS3215", grobo_feetech_driver_init, 0.5},
    {&grobo_scs_table, "SCS0009", grobo_feetech_driver_init, 1},
    {&grobo_dxl1_table, "AX-12A", grobo_dxl1_driver_init, 1},
};
enum { FAMILIES = sizeof families / sizeof families[0] };

static const char *const names[JOINTS] = {"A", "B", "C", "D"};
static grobo_joint joints[JOINTS];
static grobo_model model;
static const grobo_servo_model *servos[JOINTS];
static grobo_driver driver;
static grobo_robot robot;
static grobo_sim sim;
static int64_t now_us;
static grobo_event_job done[64];
static int n_done;
static grobo_trip trips[64];
static int n_trips;
static double most_dps; /* that a shaft was seen to turn */

static void on_event(void *ctx, const grobo_event *event)
{
    (void)ctx;
    if (event->kind == GROBO_EVENT_JOB) {
        assert_true(n_done < 64);
        done[n_done++] = event->u.job;
    } else if (event->kind == GROBO_EVENT_TRIP) {
        assert_true(n_trips < 64);
        trips[n_trips++] = event->u.trip.trip;
    }
}

static void set_up(int servo, grobo_register_role role, int32_t value)
{
    const grobo_servo_register *reg = grobo_servo_register_of(servos[servo], role);
    assert_non_null(reg);
    assert_int_equal(grobo_sim_set_register(&sim, servo, reg->address, value), GROBO_OK);
}

static void start(const family *f, const grobo_robot_config *config)
{
    static const grobo_sim_family *const known[] = {&grobo_sim_dxl2, &grobo_sim_dxl1, NULL};
    grobo_robot_config used = *config;
    used.bus.baud_bps = 1000000;
    for (int j = 0; j < JOINTS; j++) {
        servos[j] = grobo_servo_model_named(f->table, f->servo);
        assert_non_null(servos[j]);
        joints[j] = (grobo_joint){.name = names[j],
                                  .min_rad = RAD(-90),
                                  .max_rad = RAD(90),
                                  .max_speed_rad_s = RAD(0.8 * servos[j]->speed_dps),
                                  .servo_model = servos[j]->number,
                                  .motor = (uint8_t)(j + 1),
                                  .mirror = (uint8_t)j,
                                  .mirror_sign = 1,
                                  .sign = j == 1 ? -1 : 1};
    }
    model = (grobo_model){.name = f->servo, .joints = joints, .n_joints = JOINTS};
    const grobo_sim_config with = {GROBO_SIM_CONFIG_INIT,
                                   .model = &model,
                                   .wiring = GROBO_WIRING_BUS,
                                   .servos = servos,
                                   .families = known,
                                   .baud_bps = 1000000,
                                   .supply_mv = servos[0]->voltage_mv,
                                   .seed = 7};
    now_us = S;
    n_done = n_trips = 0;
    assert_int_equal(grobo_sim_init(&sim, &with, now_us), GROBO_OK);
    for (int j = 0; j < JOINTS && f->table == &grobo_dxl2_table; j++) {
        set_up(j, GROBO_ROLE_DIRECTION, GROBO_DXL2_DRIVE_TIME);
    }
    assert_int_equal(f->init(&driver, &model), GROBO_OK);
    assert_int_equal(grobo_robot_init(&robot, &driver, NULL, &used, now_us), GROBO_OK);
    grobo_robot_on_event(&robot, on_event, NULL);
    grobo_robot_link_up(&robot, now_us);
}

static double angle_deg(int joint)
{
    grobo_sim_view view;
    assert_int_equal(grobo_sim_look(&sim, joint, &view), GROBO_OK);
    return view.angle_mdeg / 1000.0 * (joints[joint].sign < 0 ? -1 : 1);
}

static void look(void)
{
    for (int j = 0; j < JOINTS; j++) {
        grobo_sim_view view;
        assert_int_equal(grobo_sim_look(&sim, j, &view), GROBO_OK);
        most_dps = fmax(most_dps, view.speed_dps);
    }
}

static void run(int64_t us)
{
    int64_t until_us = now_us + us;
    for (int spins = 0; now_us <= until_us; spins++) {
        uint8_t b[GROBO_FRAME_MAX_BYTES];
        size_t n;
        assert_true(spins < 4000000);
        grobo_sim_step(&sim, now_us);
        while ((n = grobo_sim_tx(&sim, b, sizeof b, now_us)) > 0) {
            grobo_robot_rx(&robot, b, n, now_us);
        }
        grobo_robot_step(&robot, now_us);
        int size = grobo_robot_tx(&robot, b, sizeof b, now_us);
        assert_true(size >= 0);
        if (size > 0) {
            assert_int_equal(grobo_sim_rx(&sim, b, (size_t)size, now_us), size);
        }
        look();
        int64_t next_us =
            grobo_i_sooner(grobo_robot_deadline(&robot, now_us), grobo_sim_deadline(&sim));
        if (next_us > until_us) {
            now_us = until_us;
            return;
        }
        now_us = grobo_i_later(now_us, next_us);
    }
}

static int wait_job(int number)
{
    assert_true(number > 0);
    for (int64_t end_us = now_us + 60 * (int64_t)S; now_us < end_us; run(MS)) {
        for (int i = 0; i < n_done; i++) {
            if (done[i].number == number) {
                return done[i].result;
            }
        }
    }
    fail_msg("job %d does not end", number);
    return GROBO_ERR_TIMEOUT;
}

static grobo_posture posture(double deg, int time_ms)
{
    grobo_posture p;
    assert_int_equal(grobo_posture_init(&p, JOINTS), 0);
    for (int j = 0; j < JOINTS; j++) {
        p.angle_rad[j] = RAD(deg - 10 * j);
    }
    p.set = GROBO_JOINTS_ALL(JOINTS);
    p.time_us = time_ms * (int64_t)MS;
    return p;
}

static int move(double deg, int time_ms)
{
    grobo_posture p = posture(deg, time_ms);
    return wait_job(grobo_robot_move(&robot, &p));
}

static void at(const family *f, double deg)
{
    for (int j = 0; j < JOINTS; j++) {
        if (fabs(angle_deg(j) - (deg - 10 * j)) > f->near_deg) {
            fail_msg("%s: joint %d is at %f, not %f", f->servo, j, angle_deg(j), deg - 10 * j);
        }
    }
}

static const grobo_robot_config watched = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = 50 * MS};

static void postures_are_played(void **state)
{
    (void)state;
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &watched);
        assert_int_equal(move(30, 1000), GROBO_OK);
        at(&families[i], 30);
        most_dps = 0;
        assert_int_equal(move(-40, 1500), GROBO_OK);
        at(&families[i], -40);
        assert_true(most_dps < 1.3 * 70 / 1.5);   /* straight in time */
        assert_int_equal(move(60, 10), GROBO_OK); /* as fast as they can */
        run(200 * MS);                            /* STS has ramps */
        at(&families[i], 60);
        assert_int_equal(n_trips, 0);
    }
}

/* A line that loses and breaks bytes, and servos that do not hear: what was sent arrives all the
 * same, nothing trips, and no servo goes faster than it may. */
static void a_faulty_line_moves_nothing_wrong(void **state)
{
    (void)state;
    static const char faults[] = "drop=0.002,flip=0.002,silent=0.01,rubbish=0.02,split=0.05";
    for (int i = 0; i < FAMILIES; i++) {
        grobo_robot_config config = watched;
        config.lost_replies = -1;
        start(&families[i], &config);
        assert_int_equal(move(0, 1000), GROBO_OK);
        assert_int_equal(grobo_sim_set_faults(&sim, faults, strlen(faults)), 5);
        int arrived = 0;
        for (int k = 0; k < 20; k++) {
            int result = move(k % 2 == 0 ? 50 : -30, 800);
            arrived += result == GROBO_OK;
            run(500 * MS); /* one that has a speed instead of a time is late for a lost frame */
            if (result == GROBO_OK) {
                at(&families[i], k % 2 == 0 ? 50 : -30);
            }
        }
        assert_true(arrived >= 16);
        assert_int_equal(n_trips, 0);
        assert_true(robot.bus.stats.timeouts > 0 && robot.bus.stats.retries > 0);
        assert_true(robot.bus.stats.resync_bytes + robot.bus.stats.late_bytes > 0);
    }
}

static void an_emergency_stop_stops(void **state)
{
    (void)state;
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &watched);
        assert_int_equal(move(30, 1000), GROBO_OK);
        grobo_posture p = posture(-60, 3000);
        assert_true(grobo_robot_move(&robot, &p) > 0);
        run(1000 * MS);
        double before_deg = angle_deg(0);
        assert_true(before_deg < 20 && before_deg > -30);
        assert_int_equal(wait_job(grobo_robot_estop(&robot)), GROBO_OK);
        run(S);
        assert_true(fabs(angle_deg(0) - before_deg) < 8);
        for (int j = 0; j < JOINTS; j++) {
            grobo_sim_view view;
            assert_int_equal(grobo_sim_look(&sim, j, &view), GROBO_OK);
            assert_int_equal(view.torque, GROBO_TORQUE_ON);
            assert_false(view.moving);
        }
        assert_int_equal(grobo_robot_move(&robot, &p), GROBO_ERR_LATCHED);
    }
}

/* The program dies: an arm ends within a segment of its way. */
static void without_its_host_an_arm_stops(void **state)
{
    (void)state;
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &watched);
        assert_int_equal(move(40, 1000), GROBO_OK);
        grobo_posture p = posture(-50, 4000);
        assert_true(grobo_robot_move(&robot, &p) > 0);
        run(1000 * MS);
        double then_deg = angle_deg(0);
        now_us += 3 * (int64_t)S;
        grobo_sim_step(&sim, now_us);
        assert_true(then_deg - angle_deg(0) < 90.0 * 450 / 4000);
    }
}

static void heat_stops_for_safety(void **state)
{
    (void)state;
    for (int i = 0; i < FAMILIES; i++) {
        start(&families[i], &watched);
        assert_int_equal(move(20, 1000), GROBO_OK);
        assert_int_equal(grobo_sim_set_temperature(&sim, 2, 68), GROBO_OK);
        run(300 * MS);
        assert_true(n_trips > 0);
        assert_true(trips[0] == GROBO_TRIP_TEMPERATURE || trips[0] == GROBO_TRIP_OVERHEATED);
    }
}

static void a_drive_mode_without_time_is_refused(void **state)
{
    (void)state;
    start(&families[0], &watched);
    set_up(2, GROBO_ROLE_DIRECTION, 0);
    assert_int_equal(move(20, 1000), GROBO_ERR_SETUP);
    assert_true(fabs(angle_deg(0)) < 0.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(postures_are_played),
        cmocka_unit_test(a_faulty_line_moves_nothing_wrong),
        cmocka_unit_test(an_emergency_stop_stops),
        cmocka_unit_test(without_its_host_an_arm_stops),
        cmocka_unit_test(heat_stops_for_safety),
        cmocka_unit_test(a_drive_mode_without_time_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
