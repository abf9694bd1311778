/* SPDX-License-Identifier: MIT */
/* Every request in every state of the robot: taken, or refused for the reason that is written. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/robot.h>

#include "tests/support/rig.h"
#include "tests/support/test.h"

static grobo_test_rig rig;
static rig_clip clip;

static const rig_key sway[] = {{0, {{NECK, 0}}}, {2000, {{NECK, 30}}}, {4000, {{NECK, -30}}}};

/* ---- states ---------------------------------------------------------------------------------- */

static void make_ready(void)
{
    rig_start(&rig, &quiet, NULL);
    rig_clip_init(&clip, sway, 3);
    rig_power(&rig);
}

static void make_down(void)
{
    make_ready();
    grobo_robot_link_down(&rig.robot, rig.now_us);
}

/* The line is there, and nothing was read. */
static void make_new(void)
{
    rig_start(&rig, &quiet, NULL);
    rig_clip_init(&clip, sway, 3);
}

static void make_limp(void)
{
    make_new();
    rig_expect(&rig, grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_ALL), GROBO_OK);
}

static void make_moving(void)
{
    make_ready();
    grobo_posture target = rig_posture(&rig, NECK, 40, 5000);
    assert_true(grobo_robot_move(&rig.robot, &target) > 0);
    rig_run(&rig, 1500000);
}

static void make_playing(void)
{
    make_ready();
    rig_expect(&rig, grobo_robot_play(&rig.robot, &clip.clip, NULL), GROBO_OK);
    rig_wait_play(&rig, GROBO_SEQUENCER_PLAYING);
    rig_run(&rig, 300000);
}

static void make_paused(void)
{
    make_playing();
    assert_int_equal(grobo_robot_pause(&rig.robot), GROBO_OK);
    rig_run(&rig, 1000000);
}

/* No job, but a joint is on its way. */
static void make_sent(void)
{
    make_ready();
    grobo_posture target = rig_posture(&rig, NECK, 40, 20000);
    assert_int_equal(grobo_robot_send(&rig.robot, &target), GROBO_OK);
    rig_run(&rig, 1000000);
}

static void make_reading(void)
{
    make_ready();
    assert_true(grobo_robot_sense(&rig.robot, rig_all(&rig), GROBO_SENSE_ALL) > 0);
    rig_run(&rig, 20000);
}

static void make_latched(void)
{
    make_ready();
    assert_int_equal(grobo_sim_set_temperature(&rig.sim, R_KNEE, 75), 0);
    rig_expect(&rig, grobo_robot_sense(&rig.robot, GROBO_JOINT_BIT(R_KNEE), GROBO_SENSE_FULL),
               GROBO_OK);
    rig_run(&rig, 500000);
}

static void make_stopping(void)
{
    make_ready();
    assert_true(grobo_robot_estop(&rig.robot) > 0);
    rig_run(&rig, 20000);
}

static void make_leaving(void)
{
    make_ready();
    assert_true(grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD) > 0);
    rig_run(&rig, 20000);
}

/* ---- requests -------------------------------------------------------------------------------- */

static int do_check(void)
{
    return grobo_robot_check(&rig.robot);
}

static int do_sense(void)
{
    return grobo_robot_sense(&rig.robot, 1, GROBO_SENSE_FULL);
}

static int do_on(void)
{
    return grobo_robot_torque(&rig.robot, 1, GROBO_TORQUE_ON);
}

static int do_off(void)
{
    return grobo_robot_torque(&rig.robot, 1, GROBO_TORQUE_OFF);
}

static int do_move(void)
{
    grobo_posture target = rig_posture(&rig, NECK, 10, 1000);
    return grobo_robot_move(&rig.robot, &target);
}

static int do_send(void)
{
    grobo_posture target = rig_posture(&rig, NECK, 10, 1000);
    return grobo_robot_send(&rig.robot, &target);
}

static int do_play(void)
{
    return grobo_robot_play(&rig.robot, &clip.clip, NULL);
}

static int do_enqueue(void)
{
    return grobo_robot_enqueue(&rig.robot, &clip.clip, NULL);
}

static int do_raw(void)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    int n =
        grobo_frame_read(grobo_wiring_protocol(rig_wiring), NECK_ID, 42, 2, frame, sizeof frame);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static int do_raw_goal(void)
{
    uint8_t frame[GROBO_RS30X_PACKET_MAX_BYTES];
    const grobo_rs30x_goal goal = {R_ELBOW_ID, 0, 300};
    int n = grobo_frame_goals(grobo_wiring_protocol(rig_wiring), &goal, 1, frame, sizeof frame);
    return grobo_robot_raw(&rig.robot, frame, (size_t)n);
}

static int do_registers(void)
{
    const grobo_register_io io = {NECK_ID, 42, 2, NULL};
    return grobo_robot_registers(&rig.robot, &io);
}

static int do_reboot(void)
{
    return grobo_robot_command(&rig.robot, NECK_ID, GROBO_SERVO_REBOOT);
}

static int do_exit(void)
{
    return grobo_robot_exit(&rig.robot, GROBO_EXIT_HOLD);
}

static int do_estop(void)
{
    return grobo_robot_estop(&rig.robot);
}

static int do_reset(void)
{
    return grobo_robot_reset(&rig.robot);
}

static int do_cancel(void)
{
    return grobo_robot_cancel(&rig.robot);
}

static int do_stop(void)
{
    return grobo_robot_stop(&rig.robot, false);
}

static int do_pause(void)
{
    return grobo_robot_pause(&rig.robot);
}

static int do_resume(void)
{
    return grobo_robot_resume(&rig.robot);
}

static int do_seek(void)
{
    return grobo_robot_seek(&rig.robot, 100000);
}

static int do_speed(void)
{
    return grobo_robot_speed(&rig.robot, 50);
}

static int do_free(void)
{
    return grobo_robot_free(&rig.robot, GROBO_JOINT_BIT(CHEST), true);
}

static int (*const requests[])(void) = {
    do_check, do_sense,    do_on,        do_off,    do_move,  do_send,  do_play,  do_enqueue,
    do_raw,   do_raw_goal, do_registers, do_reboot, do_exit,  do_estop, do_reset, do_cancel,
    do_stop,  do_pause,    do_resume,    do_seek,   do_speed, do_free};

/* A job, or taken without one; closed, not now (state), latched, stale. */
enum { JOB = '+', TAKEN = '=', CLOSED = 'c', NOT_NOW = '-', LATCHED = 'l', STALE = '?' };

static char kind_of(int result)
{
    switch (result) {
    case GROBO_OK:
        return TAKEN;
    case GROBO_ERR_CLOSED:
        return CLOSED;
    case GROBO_ERR_STATE:
        return NOT_NOW;
    case GROBO_ERR_LATCHED:
        return LATCHED;
    case GROBO_ERR_STALE:
        return STALE;
    default:
        return result > 0 ? JOB : 'x';
    }
}

TEST_WITH(rig_wirings, each_is_taken_or_refused_for_its_reason)
{
    static const struct {
        void (*make)(void);
        const char *expected; /* a letter a request */
    } rows[] = {
        {make_down, "ccccccc-cccccc=------c"},     {make_new, "+++++?+-+?++++=-=----="},
        {make_limp, "+++++-+-++++++=------="},     {make_ready, "+++++=+-++++++=------="},
        {make_moving, "-++++---++--++===-----"},   {make_playing, "++-+---++++-++=-==-==-"},
        {make_paused, "++-+---++++-++=-=-===-"},   {make_sent, "+++++=+-+++-++=-=----="},
        {make_reading, "-++++=--+++-++==------"},  {make_latched, "++l+llll+l++++=---l--l"},
        {make_stopping, "-+l-llll-----+----l--l"}, {make_leaving, "-+----------++==------"},
    };
    enum { REQUESTS = sizeof requests / sizeof requests[0] };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char got[REQUESTS + 1] = "";
        for (size_t k = 0; k < REQUESTS; k++) {
            rows[i].make();
            got[k] = kind_of(requests[k]());
        }
        assert_string_equal(got, rows[i].expected);
    }
}

/* Of two reasons the caller's mistake comes first; what is asked for is not begun. */
TEST_WITH(rig_wirings, leaving_takes_a_policy_that_there_is)
{
    make_moving();
    assert_int_equal(grobo_robot_exit(&rig.robot, (grobo_exit_policy)(GROBO_EXIT_SIT + 1)),
                     GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_MOVE);
    for (int policy = GROBO_EXIT_DEFAULT; policy <= GROBO_EXIT_SIT; policy++) {
        make_ready();
        rig_expect(&rig, grobo_robot_exit(&rig.robot, (grobo_exit_policy)policy), GROBO_OK);
        bool lets_go = policy == GROBO_EXIT_OFF || policy == GROBO_EXIT_SIT;
        assert_int_equal(rig_torque(&rig, NECK), lets_go ? GROBO_TORQUE_OFF : GROBO_TORQUE_ON);
        assert_int_equal((int)lround(rig_angle_deg(&rig, R_KNEE)),
                         policy == GROBO_EXIT_SIT ? -120 : -40);
    }
}

/* Nor does it crash: what a clip must have is asked for before it is looked through. */
TEST_WITH(rig_wirings, a_clip_without_keys_of_its_own_is_refused)
{
    make_playing();
    grobo_clip none = clip.clip;
    none.key = NULL;
    assert_int_equal(grobo_robot_enqueue(&rig.robot, &none, NULL), GROBO_ERR_ARG);
    make_ready();
    assert_int_equal(grobo_robot_play(&rig.robot, &none, NULL), GROBO_ERR_ARG);
    assert_int_equal(grobo_robot_job(&rig.robot), GROBO_JOB_NONE);
}
