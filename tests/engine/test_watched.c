/* SPDX-License-Identifier: MIT */
/*
 * While anything moves, each joint is read at least once in GROBO_WATCH_US: the rate of frames
 * that the line allows, what is refused, and what makes room where frames fill the line.
 */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/many_joints.h"
#include "tests/support/rig.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

enum { JOINTS = 20, SECOND_US = 1000000 };

static grobo_test_rig rig;
static rig_clip clip;
/* A minute. */
static const rig_key sway[] = {{0, {{NECK, 0}}}, {2000, {{NECK, 30}}}, {60000, {{NECK, -30}}}};
static int64_t read_us[GROBO_JOINTS_MAX]; /* when last, in full */
static int64_t longest_us;                /* from one reading of a joint to its next */

static void note_age(int joint)
{
    int64_t age_us = rig.now_us - read_us[joint];
    longest_us = age_us > longest_us ? age_us : longest_us;
}

static void on_event(grobo_test_rig *r, const grobo_event *event)
{
    grobo_joint_info info;
    if (event->kind != GROBO_EVENT_JOINT || event->u.joint.result != GROBO_OK) {
        return;
    }
    int joint = event->u.joint.joint;
    assert_int_equal(grobo_robot_joint(&r->robot, joint, &info), 0);
    if (info.full_age_us == 0) {
        note_age(joint);
        read_us[joint] = r->now_us;
    }
}

/* Lets time pass, and returns the longest time from now on that a joint was not read. */
static int64_t longest_unread(int64_t us)
{
    int n = rig.driver->model->n_joints;
    longest_us = 0;
    for (int j = 0; j < n; j++) {
        read_us[j] = rig.now_us;
    }
    rig.on_event = on_event;
    rig_run(&rig, us);
    rig.on_event = NULL;
    for (int j = 0; j < n; j++) {
        note_age(j);
    }
    return longest_us;
}

static void start_playing(const grobo_robot_config *config, const grobo_sim_config *sim,
                          const grobo_play_options *options)
{
    rig_start(&rig, config, sim);
    rig_clip_init(&clip, sway, sizeof sway / sizeof *sway);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
}

static const grobo_play_options at_default = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE};

static grobo_budget budget_now(void)
{
    grobo_budget budget;
    assert_int_equal(grobo_robot_budget(&rig.robot, &budget), 0);
    return budget;
}

TEST_WITH(rig_wirings, the_default_rate_is_what_the_line_allows)
{
    static const struct {
        int motion_us, reading_us, watched_hz, default_hz;
    } want[] = {{18924, 6264, 39, 39}, {9375, 3052, 80, 50}};
    start_playing(NULL, NULL, &at_default);
    grobo_budget budget = budget_now();
    const int w = rig_wiring == GROBO_WIRING_BUS;
    assert_in_range(budget.motion_us, want[w].motion_us - 2, want[w].motion_us + 2);
    assert_in_range(budget.reading_us, want[w].reading_us - 4, want[w].reading_us + 4);
    assert_int_equal(budget.watched_hz, want[w].watched_hz);
    assert_int_equal(budget.default_hz, want[w].default_hz);
    uint64_t before = grobo_robot_get_counters(&rig.robot)->motion_frames;
    rig_run(&rig, 10 * SECOND_US);
    uint64_t frames = grobo_robot_get_counters(&rig.robot)->motion_frames - before;
    assert_in_range(frames, 10 * want[w].default_hz - 1, 10 * want[w].default_hz + 1);
}

TEST_WITH(rig_wirings, each_joint_is_read_at_the_default_rate)
{
    static const int64_t intervals_us[] = {0, 1, 2 * SECOND_US, 60LL * SECOND_US};
    for (int i = 0; i < 4; i++) {
        grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = intervals_us[i]};
        grobo_jitter jitter;
        start_playing(&config, NULL, &at_default);
        int64_t unread_us = longest_unread(10 * SECOND_US);
        print_message("# %s: each joint read every %lld ms\n",
                      rig_wiring == GROBO_WIRING_BUS ? "bus" : "board",
                      (long long)unread_us / 1000);
        assert_true(unread_us <= GROBO_WATCH_US);
        grobo_robot_jitter(&rig.robot, &jitter);
        assert_int_equal(jitter.max_us, 0); /* there is room for them */
        assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 0);
    }
}

/* ---- the rule on other lines and robots ------------------------------------------------------ */

static grobo_driver *driver;

/* Half a minute of the first joint, five degrees to and fro. */
static int nod_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    const double part = 1 - fabs(1 - fmod((double)t_us / 1e6, 2));
    (void)ctx;
    grobo_posture_init_pose(posture, driver->model);
    posture->angle_rad[0] += grobo_rad_from_deg(5 * part);
    return 0;
}

static int nod_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    *at_us = (int64_t)i * SECOND_US;
    return nod_sample(ctx, *at_us, posture);
}

/* Readings of one joint a second beside f frames a second. */
static double rounds_per_s(const grobo_budget *budget, int n, int hz)
{
    double left_us = 1e6 / hz - budget->motion_us;
    return left_us < 0 ? 0 : hz * floor(left_us / budget->reading_us) / n;
}

static void check_rule(const grobo_budget *budget, int n)
{
    int largest_hz = 0;
    for (int hz = 1; hz <= GROBO_PLAY_RATE_MAX_HZ; hz++) {
        if (rounds_per_s(budget, n, hz) * GROBO_WATCH_US / 1e6 >= 1) {
            largest_hz = hz;
        }
    }
    assert_int_equal(budget->watched_hz, largest_hz);
    assert_int_equal(budget->default_hz, largest_hz < 50 ? largest_hz : 50);
}

static void play_at_watched_rate(uint32_t baud_bps, const grobo_budget *budget)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .bus.baud_bps = baud_bps};
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .baud_bps = baud_bps};
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                  .rate_hz = budget->watched_hz};
    rig_start_driver(&rig, driver, &config, &sim);
    grobo_clip nod = {.key = nod_key,
                      .sample = nod_sample,
                      .n_joints = driver->model->n_joints,
                      .n_keys = 31,
                      .length_us = 30LL * SECOND_US};
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &nod, &options), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    int64_t unread_us = longest_unread(8LL * SECOND_US);
    print_message("# %s, %u bps, %d joints: %d Hz, each read every %lld ms\n",
                  grobo_driver_wiring(driver) == GROBO_WIRING_BUS ? "bus" : "board",
                  (unsigned)baud_bps, driver->model->n_joints, budget->watched_hz,
                  (long long)unread_us / 1000);
    assert_true(unread_us <= GROBO_WATCH_US);
}

TEST_WITH(rig_wirings, the_rule_holds_on_other_lines)
{
    static const uint32_t bauds_bps[] = {19200, 57600, 115200, 153600, 230400};
    static const int numbers[] = {1, 7, JOINTS};
    for (size_t i = 0; i < sizeof bauds_bps / sizeof *bauds_bps; i++) {
        for (int k = 0; k < 3; k++) {
            grobo_bus_config line = {.baud_bps = bauds_bps[i]};
            grobo_budget budget;
            driver = many_joints(rig_wiring, numbers[k]);
            assert_int_equal(grobo_budget_init(&budget, driver, NULL, &line), 0);
            check_rule(&budget, numbers[k]);
            if (budget.watched_hz > 0) {
                play_at_watched_rate(bauds_bps[i], &budget);
            }
        }
    }
}

/* 20 joints are not read in 2 s at 2400 bps, whatever else is left out. */
TEST_WITH(rig_wirings, on_too_slow_a_line_no_rate_is_watched)
{
    grobo_bus_config line = {.baud_bps = 2400};
    grobo_budget budget;
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .bus = line};
    driver = many_joints(rig_wiring, JOINTS);
    assert_int_equal(grobo_budget_init(&budget, driver, NULL, &line), 0);
    assert_int_equal(budget.watched_hz, 0);
    assert_int_equal(budget.default_hz, 0);
    rig_start_driver(&rig, driver, &config, NULL);
    rig_clip_init(&clip, sway, sizeof sway / sizeof *sway);
    assert_int_equal(grobo_robot_play(&rig.robot, &clip.clip, &at_default), GROBO_ERR_UNWATCHED);
    line.baud_bps = 100;
    assert_int_equal(grobo_budget_init(&budget, driver, NULL, &line), GROBO_ERR_ARG);
    driver->sense = NULL;
    assert_int_equal(grobo_budget_init(&budget, driver, NULL, NULL), GROBO_ERR_ARG);
    assert_int_equal(budget.watched_hz, 0);
}

/* ---- where there is no room ------------------------------------------------------------------ */

/* An adapter that holds bytes back for 16 ms: no reading fits between two frames. */
TEST_WITH(rig_wirings, a_slow_adapter_hides_no_joint)
{
    static const uint32_t latencies_us[] = {500, 2000, 16000};
    for (int i = 0; i < 3; i++) {
        grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .latency_us = latencies_us[i]};
        grobo_jitter jitter;
        start_playing(NULL, &sim, &at_default);
        int64_t unread_us = longest_unread(10 * SECOND_US);
        grobo_robot_jitter(&rig.robot, &jitter);
        print_message(
            "# replies %u us late: each joint read every %lld ms, frames late by %lld us\n",
            (unsigned)latencies_us[i], (long long)unread_us / 1000, (long long)jitter.max_us);
        assert_true(unread_us <= GROBO_WATCH_US);
        assert_true(jitter.max_us <= budget_now().reading_us + latencies_us[i]);
        assert_true(jitter.frames >= 7u * budget_now().default_hz);
    }
}

static grobo_clip dense_clip;

/* Keys every 10 ms, more than the line can carry: up and down. */
static int dense_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    grobo_posture_init_pose(posture, &grobo_i_gr001_model);
    posture->angle_rad[NECK] =
        grobo_rad_from_deg(i % 400 < 200 ? 0.1 * (double)(i % 400) : 0.1 * (double)(400 - i % 400));
    posture->time_us = 10000;
    *at_us = (int64_t)i * 10000;
    return 0;
}

TEST_WITH(rig_wirings, keys_that_fill_the_line_hide_no_joint)
{
    rig_start(&rig, NULL, NULL);
    dense_clip =
        (grobo_clip){.key = dense_key, .n_joints = JOINTS, .n_keys = 2000, .length_us = 19990000};
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_play(&rig.robot, &dense_clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_forget(&rig);
    assert_true(longest_unread(8LL * SECOND_US) <= GROBO_WATCH_US);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_PLAYING);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    rig_run(&rig, GROBO_WATCH_US);
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(trip);
    assert_int_equal(trip->u.trip.trip, GROBO_TRIP_TEMPERATURE);
}

/* A control loop of the caller's own, with more targets than the line can carry. */
TEST_WITH(rig_wirings, targets_that_fill_the_line_hide_no_joint)
{
    rig_start(&rig, NULL, NULL);
    rig_power(&rig);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_FULL), 0);
    longest_us = 0;
    for (int j = 0; j < JOINTS; j++) {
        read_us[j] = rig.now_us;
    }
    rig.on_event = on_event;
    for (int i = 0; i < 800; i++) {
        grobo_posture target;
        grobo_posture_init_pose(&target, rig.driver->model);
        target.angle_rad[NECK] = grobo_rad_from_deg(0.05 * i);
        target.time_us = 100000;
        (void)grobo_robot_send(&rig.robot, &target);
        rig_run(&rig, 7000);
    }
    for (int j = 0; j < JOINTS; j++) {
        note_age(j);
    }
    assert_true(longest_us <= GROBO_WATCH_US);
}

/* The longest time that a joint other than the knee was not read. */
static int64_t others_unread(int64_t us)
{
    int64_t unread_us = 0;
    for (int64_t until_us = rig.now_us + us; rig.now_us < until_us;) {
        rig_run(&rig, 100000);
        for (int j = 0; j < JOINTS; j++) {
            grobo_joint_info info;
            assert_int_equal(grobo_robot_joint(&rig.robot, j, &info), 0);
            if (j != R_KNEE && info.full_age_us > unread_us) {
                unread_us = info.full_age_us;
            }
        }
    }
    return unread_us;
}

/* What one attempt at a servo that is silent takes. */
static int64_t attempt_us(void)
{
    return budget_now().reading_us + 2 * GROBO_BUS_MARGIN_MIN_US;
}

/* No motion frame waits for more than one attempt at a servo that is silent, and where a reading
 * fits between two frames none waits at all. The others are read. */
TEST_WITH(rig_wirings, a_silent_servo_delays_little)
{
    static const uint32_t latencies_us[] = {0, 2000};
    for (int i = 0; i < 2; i++) {
        grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .lost_replies = -1};
        grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .latency_us = latencies_us[i]};
        grobo_jitter jitter;
        start_playing(&config, &sim, &at_default);
        rig_run(&rig, GROBO_WATCH_US);
        assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
        assert_true(others_unread(8LL * SECOND_US) <= GROBO_WATCH_US);
        grobo_robot_jitter(&rig.robot, &jitter);
        print_message("# a silent servo, replies %u us late: frames late by %lld us\n",
                      (unsigned)latencies_us[i], (long long)jitter.max_us);
        assert_true(jitter.max_us <= (i == 0 ? GROBO_PLAY_LATE_US : attempt_us()));
    }
}

/* Somebody else's lost reply may yet come, so the reading may not leave; the frames may. */
TEST_WITH(rig_wirings, a_reading_that_may_not_leave_delays_no_frame)
{
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT, .lost_replies = -1};
    grobo_jitter jitter;
    start_playing(&config, NULL, &at_default);
    assert_int_equal(grobo_sim_set_cable(&rig.sim, R_KNEE, GROBO_SIM_CABLE_MUTE), 0);
    for (int i = 0; i < 60; i++) {
        int number = grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL);
        rig_expect(&rig, number, GROBO_ERR_TIMEOUT);
        rig_run(&rig, 5000);
    }
    grobo_robot_jitter(&rig.robot, &jitter);
    print_message("# a reading that is held back: frames late by %lld us\n",
                  (long long)jitter.max_us);
    assert_true(jitter.frames > 50);
    assert_true(jitter.max_us <= attempt_us());
}

/* ---- what is stopped at the default rate ----------------------------------------------------- */

static void expect_trip(grobo_trip reason, int joint, int64_t within_us)
{
    int64_t until_us = rig.now_us + within_us;
    while (rig_count(&rig, GROBO_EVENT_TRIP) == 0 && rig.now_us < until_us) {
        rig_run(&rig, 1000);
    }
    const grobo_event *trip = rig_last(&rig, GROBO_EVENT_TRIP);
    assert_non_null(trip);
    assert_int_equal(trip->u.trip.trip, reason);
    assert_true(joint < 0 || trip->u.trip.joint == joint);
    assert_true(trip->u.trip.latched);
    rig_run(&rig, SECOND_US);
    assert_false(grobo_robot_moving(&rig.robot));
}

TEST_WITH(rig_wirings, heat_stops_at_the_default_rate)
{
    start_playing(NULL, NULL, &at_default);
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, L_ELBOW, 67), 0);
    expect_trip(GROBO_TRIP_TEMPERATURE, L_ELBOW, GROBO_WATCH_US);
}

/* The current must last: two readings, the second at least a second after the first. */
TEST_WITH(rig_wirings, current_stops_at_the_default_rate)
{
    start_playing(NULL, NULL, &at_default);
    assert_int_equal(grobo_sim_set_load(&rig.sim, R_KNEE, 800), 0);
    expect_trip(GROBO_TRIP_CURRENT, R_KNEE, 2 * GROBO_WATCH_US);
}

TEST_WITH(rig_wirings, lost_torque_stops_at_the_default_rate)
{
    start_playing(NULL, NULL, &at_default);
    assert_int_equal(grobo_sim_set_register(&rig.sim, SHOULDER, GROBO_RS30X_TORQUE, 0), 0);
    expect_trip(GROBO_TRIP_TORQUE_LOST, SHOULDER, GROBO_WATCH_US);
}

TEST_WITH(rig_wirings, low_voltage_stops_at_the_default_rate)
{
    start_playing(NULL, NULL, &at_default);
    grobo_sim_set_supply(&rig.sim, 5800);
    expect_trip(GROBO_TRIP_VOLTAGE, -1, GROBO_WATCH_US);
}

/* ---- faster ---------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, a_rate_that_leaves_no_time_is_refused)
{
    start_playing(NULL, NULL, &at_default);
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                  .rate_hz = (uint16_t)(budget_now().watched_hz + 1)};
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, &options), GROBO_ERR_UNWATCHED);
    assert_int_equal(grobo_robot_stop(&rig.robot, false), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_IDLE);
    rig_run(&rig, SECOND_US);
    rig_forget(&rig);
    assert_int_equal(grobo_robot_play(&rig.robot, &clip.clip, &options), GROBO_ERR_UNWATCHED);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_NONE);
    assert_int_equal(grobo_robot_play_state(&rig.robot), GROBO_SEQUENCER_IDLE);
    options.rate_hz--;
    assert_true(grobo_robot_play(&rig.robot, &clip.clip, &options) > 0);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 0);
}

TEST_WITH(rig_wirings, an_unwatched_motion_says_so_and_waits_for_no_reading)
{
    rig_start(&rig, NULL, NULL);
    int fast_hz = (int)(1e6 / budget_now().motion_us); /* all that the line carries */
    grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                  .rate_hz = (uint16_t)fast_hz, .unwatched = true};
    grobo_jitter jitter;
    start_playing(NULL, NULL, &options);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 1);
    const grobo_event_unwatched *told = &rig_last(&rig, GROBO_EVENT_UNWATCHED)->u.unwatched;
    assert_int_equal(told->rate_hz, fast_hz);
    assert_int_equal(told->watched_hz, budget_now().watched_hz);
    assert_true(longest_unread(5LL * SECOND_US) > GROBO_WATCH_US);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 1);
    grobo_robot_jitter(&rig.robot, &jitter);
    assert_int_equal(jitter.max_us, 0);
    /* The one behind it is watched, so it says nothing. */
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, &at_default), 1);
    assert_int_equal(grobo_robot_seek(&rig.robot, 59000000), GROBO_OK);
    rig_run(&rig, 6LL * SECOND_US);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 1);
    assert_true(longest_unread(5LL * SECOND_US) <= GROBO_WATCH_US);
    /* And one behind that which is not says so again. */
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &clip.clip, &options), 1);
    assert_int_equal(grobo_robot_seek(&rig.robot, 59000000), GROBO_OK);
    rig_run(&rig, 6LL * SECOND_US);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 2);
}

/* What could be unwatched and need not be is watched. */
TEST_WITH(rig_wirings, permission_alone_changes_nothing)
{
    grobo_play_options options = at_default;
    options.unwatched = true;
    start_playing(NULL, NULL, &options);
    assert_true(longest_unread(6LL * SECOND_US) <= GROBO_WATCH_US);
    assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 0);
}

TEST_WITH(rig_wirings, without_full_readings_a_motion_says_that_it_is_unwatched)
{
    static const grobo_robot_config configs[] = {
        {GROBO_ROBOT_CONFIG_INIT, .sense_interval_us = GROBO_SENSE_NEVER},
        {GROBO_ROBOT_CONFIG_INIT, .sense_position_only = true}};
    for (int i = 0; i < 2; i++) {
        start_playing(&configs[i], NULL, i == 0 ? NULL : &at_default);
        assert_int_equal(rig_count(&rig, GROBO_EVENT_UNWATCHED), 1);
        const grobo_event_unwatched *told = &rig_last(&rig, GROBO_EVENT_UNWATCHED)->u.unwatched;
        assert_int_equal(told->rate_hz, i == 0 ? 0 : budget_now().default_hz);
    }
}
