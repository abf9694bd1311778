/* SPDX-License-Identifier: MIT */
/*
 * An emergency stop in every state of the engine, in all families, measured by a far side that is
 * not ours: its first frame leaves within one frame on the line and 10 ms, whatever the engine is
 * doing. A joint that this program moves has its halt in that time. One that another program moves,
 * or of which nothing is known, is found by reading, and has its halt when every joint was read.
 *
 * A joint turns in each state, so that there is something to stop. A state that a family does not
 * have (a flash write of servos without flash) is printed.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/robot.h>

#include "tests/support/halt_kit.h"
#include "tests/support/test.h"

#define RAD(deg) ((deg)*0.017453292519943295)
#define FROM_DEG (-60.0)

/* A servo that tells no speed is read again so much later; a way that shows that it turns. */
#define SHOWN_DEG 0.6
enum { SLACK_US = 10000, TWICE_US = 200000, WAY_US = 1500 * HALT_MS };

/* How fast others turn the joint. */
static double others_dps;

/* Who turns the joint when the stop is asked for. */
typedef enum turner { OURS, OTHERS, NOBODY_KNOWS } turner;

typedef struct state {
    const char *name;
    turner turner;
    bool (*enter)(void); /* false: this family has no such state */
} state;

static int moved_servo(void)
{
    return halt.of->driver.model->joints[halt.of->moved].motor - 1;
}

static grobo_joint_mask all(void)
{
    return GROBO_JOINTS_ALL(halt.of->driver.model->n_joints);
}

static void turn_by_others(void)
{
    far_foreign(&halt.far, moved_servo(), 60, others_dps, halt.now_us);
}

static int begin_move(double deg)
{
    grobo_posture p = halt_posture(deg, WAY_US, false);
    return grobo_robot_move(&halt.robot, &p);
}

/* ---- states ---------------------------------------------------------------------------------- */

static bool idle(void)
{
    return true;
}

/* The line has just come, and nothing was read. */
static bool unread(void)
{
    static const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT};
    turn_by_others();
    halt_run(100 * HALT_MS);
    halt_new_engine(&config);
    return true;
}

static bool half_read(void)
{
    bool made = unread();
    halt_run(halt.of->reading_us / 4);
    return made;
}

static bool checking(void)
{
    return grobo_robot_check(&halt.robot) > 0;
}

static bool sensing(void)
{
    return grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL) > 0;
}

static bool sensing_in_motion(void)
{
    bool made = begin_move(60) > 0;
    halt_run(300 * HALT_MS);
    return grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL) > 0 && made;
}

static bool moving(void)
{
    bool made = begin_move(60) > 0;
    halt_run(300 * HALT_MS);
    return made;
}

static bool move_just_begun(void)
{
    bool made = moving();
    grobo_posture p = halt_posture(0, WAY_US, true);
    p.set = GROBO_JOINT_BIT(halt.of->other);
    p.angle_rad[halt.of->other] = RAD(30);
    return grobo_robot_move(&halt.robot, &p) > 0 && made;
}

static bool redirected(void)
{
    bool made = moving();
    grobo_posture p = halt_posture(-50, WAY_US, false);
    return grobo_robot_retarget(&halt.robot, &p) > 0 && made;
}

static bool canceled(void)
{
    bool made = moving();
    return grobo_robot_cancel(&halt.robot) >= 0 && made;
}

static int key_at(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    (void)ctx;
    *posture = halt_posture(i == 0 ? -40 : 60, i == 0 ? 0 : WAY_US, false);
    *at_us = (int64_t)i * WAY_US;
    return 0;
}

static bool begin_play(void)
{
    const grobo_clip clip = {.key = key_at,
                             .length_us = WAY_US,
                             .n_keys = 2,
                             .n_joints = halt.of->driver.model->n_joints};
    return grobo_robot_play(&halt.robot, &clip, NULL) > 0;
}

static bool play_until(grobo_sequencer_state wanted)
{
    bool made = begin_play();
    for (int i = 0; i < 5000 && grobo_robot_play_state(&halt.robot) != wanted; i++) {
        halt_run(HALT_MS);
    }
    halt_run(40 * HALT_MS);
    return made;
}

static bool preparing(void)
{
    bool made = begin_play();
    turn_by_others();
    return made;
}

static bool approaching(void)
{
    return play_until(GROBO_SEQUENCER_APPROACHING);
}

static bool playing(void)
{
    bool made = play_until(GROBO_SEQUENCER_PLAYING);
    halt_run(200 * HALT_MS);
    return made;
}

static bool pausing(void)
{
    bool made = playing();
    return grobo_robot_pause(&halt.robot) >= 0 && made;
}

static bool stopping_softly(void)
{
    bool made = playing();
    return grobo_robot_stop(&halt.robot, false) >= 0 && made;
}

/* What was played last is being read back. */
static bool settling(void)
{
    bool made = playing();
    for (int i = 0; i < 5000 && !grobo_robot_settling(&halt.robot); i++) {
        halt_run(HALT_MS);
    }
    return grobo_robot_settling(&halt.robot) && made;
}

/* The engine has noticed that another program moves a joint. */
static bool adrift(void)
{
    turn_by_others();
    halt_run(1500 * HALT_MS);
    return true;
}

/* A frame of the caller's, for a joint without torque. */
static bool raw_to_limp(void)
{
    grobo_exchange exchange;
    grobo_target target;
    int other = halt.of->other;
    memset(&exchange, 0, sizeof exchange);
    memset(&target, 0, sizeof target);
    int r = halt_wait(grobo_robot_torque(&halt.robot, GROBO_JOINT_BIT(other), GROBO_TORQUE_OFF),
                      2 * HALT_S);
    target.posture = halt_posture(0, HALT_S, true);
    target.posture.set = GROBO_JOINT_BIT(other);
    target.posture.angle_rad[other] = RAD(-10);
    target.joint_time_us[other] = 4 * HALT_S;
    bool made = begin_move(60) > 0;
    halt_run(300 * HALT_MS);
    int last = -1;
    for (int part = 0; last < 0 && part < 2; part++) { /* a KRS is told its speed first */
        if (halt.of->driver.posture(&halt.of->driver, NULL, &target, part, &exchange) != 1) {
            break;
        }
        last = grobo_robot_raw(&halt.robot, exchange.frame, exchange.frame_bytes);
    }
    return r >= 0 && made && last > 0;
}

static bool command(grobo_servo_command what)
{
    int id = halt.of->driver.model->joints[halt.of->other].motor;
    return grobo_robot_command(&halt.robot, id, what) > 0;
}

static bool restarting(void)
{
    return command(GROBO_SERVO_REBOOT);
}

static bool writing_flash(void)
{
    return command(GROBO_SERVO_FLASH);
}

static bool free_mode(void)
{
    return grobo_robot_free(&halt.robot, GROBO_JOINT_BIT(halt.of->other), true) >= 0 &&
           begin_move(60) > 0;
}

static bool switching_torque(void)
{
    return grobo_robot_torque(&halt.robot, GROBO_JOINT_BIT(halt.of->other), GROBO_TORQUE_OFF) > 0;
}

/* Readings of other kinds, one behind the other: none joins the one before. */
static bool queue_full(void)
{
    bool made = moving();
    int r = 1;
    for (int i = 0; i < 32 && r > 0; i++) {
        r = grobo_robot_sense(&halt.robot, all(), (grobo_sense_kind)(i % 3));
    }
    return r == GROBO_ERR_FULL && made;
}

/* As many targets wait as there are joints, behind readings. */
static bool slots_full(void)
{
    bool made = true;
    grobo_posture p = halt_posture(-30, WAY_US, true);
    (void)grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL);
    for (int j = 0; j < halt.of->driver.model->n_joints; j++) {
        p.set = GROBO_JOINT_BIT(j);
        made = grobo_robot_send(&halt.robot, &p) >= 0 && made;
        halt_run(0);
    }
    return true;
}

/* The reply that it awaits never comes. */
static bool awaiting(void)
{
    bool made = moving();
    int r = grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL);
    halt.far.lose_reply = 0;
    halt_run(halt.of->frame_us / 2);
    return r > 0 && made;
}

static bool nobody_answers(void)
{
    bool made = moving();
    halt.far.mute = true;
    (void)grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL);
    halt_run(30 * HALT_MS);
    return made;
}

static bool latched(void)
{
    int r = halt_wait(grobo_robot_estop(&halt.robot), 15 * HALT_S);
    halt_run(200 * HALT_MS);
    return r == GROBO_OK;
}

static bool leaving(void)
{
    bool made = moving();
    int r = grobo_robot_exit(&halt.robot, GROBO_EXIT_HOLD);
    return r > 0 && made;
}

static bool leaving_for_long(void)
{
    bool made = leaving();
    halt_run(40 * HALT_MS);
    turn_by_others();
    return made;
}

/* The system took nothing for the line for a while. What had left goes on. */
static bool held_for(int64_t us)
{
    bool made = moving();
    halt.now_us += us;
    far_step(&halt.far, halt.now_us);
    return made;
}

static bool line_held(void)
{
    return held_for(60 * HALT_MS);
}

static bool line_held_longer(void)
{
    return held_for(100 * HALT_MS);
}

static bool line_held_for_long(void)
{
    return held_for(500 * HALT_MS);
}

/* Its frames wait in the system when the stop is asked for, a reading among them. */
static bool held_while_sensing(void)
{
    bool made = moving();
    int r = grobo_robot_sense(&halt.robot, all(), GROBO_SENSE_ALL);
    halt.now_us += 250 * HALT_MS;
    far_step(&halt.far, halt.now_us);
    return r > 0 && made;
}

static const state states[] = {
    {"idle", OTHERS, idle},
    {"unread after link up", NOBODY_KNOWS, unread},
    {"read by half", NOBODY_KNOWS, half_read},
    {"check", OTHERS, checking},
    {"sensing", OTHERS, sensing},
    {"sensing in motion", OURS, sensing_in_motion},
    {"moving", OURS, moving},
    {"a move just begun", OURS, move_just_begun},
    {"redirected", OURS, redirected},
    {"canceled", OURS, canceled},
    {"preparation of a play", OTHERS, preparing},
    {"approach", OURS, approaching},
    {"playing", OURS, playing},
    {"pausing", OURS, pausing},
    {"stopping softly", OURS, stopping_softly},
    {"settling", OTHERS, settling},
    {"moved by others", OTHERS, adrift},
    {"raw goal to a limp joint", OURS, raw_to_limp},
    {"restart", OTHERS, restarting},
    {"flash write", OTHERS, writing_flash},
    {"free mode", OURS, free_mode},
    {"switching torque", OTHERS, switching_torque},
    {"job queue full", OURS, queue_full},
    {"slots full", OTHERS, slots_full},
    {"a reply that never comes", OURS, awaiting},
    {"nobody answers", OURS, nobody_answers},
    {"latched", OTHERS, latched},
    {"exit", OURS, leaving},
    {"exit, moved by others", OTHERS, leaving_for_long},
    {"line held for 60 ms", OURS, line_held},
    {"line held for 100 ms", OURS, line_held_longer},
    {"line held for 500 ms", OURS, line_held_for_long},
    {"line held while sensing", OURS, held_while_sensing},
};

/* ---- the stop -------------------------------------------------------------------------------- */

static struct {
    int judged, failed, missing;
    double worst_ms;
} sum;

static void judge_first(const state *s)
{
    const halt_base *base = &halt.base[moved_servo()];
    int64_t bound_us = halt.of->frame_us + SLACK_US;
    int64_t first_us = halt.far.first_left_us - halt.asked_us;
    if (halt.far.first_left_us == FAR_NEVER || first_us > bound_us) {
        halt_blame("the first frame is late", -1, (double)first_us / HALT_MS,
                   (double)bound_us / HALT_MS);
    }
    bound_us += s->turner == OURS ? 0 : halt.of->reading_us + 2 * halt.of->frame_us;
    if (s->turner != OURS && halt.of->driver.tells_no_speed) {
        bound_us += TWICE_US + (int64_t)(SHOWN_DEG / others_dps * HALT_S);
    }
    int64_t halt_us = base->halt_left_us - halt.asked_us;
    if (base->turned && base->left_us > bound_us && !halt.far.mute &&
        (base->halt_left_us == FAR_NEVER || halt_us > bound_us)) {
        halt_blame(base->halt_left_us == FAR_NEVER ? "it is never halted" : "it is halted late",
                   moved_servo(), (double)halt_us / HALT_MS, (double)bound_us / HALT_MS);
    }
    sum.worst_ms =
        (double)first_us / HALT_MS > sum.worst_ms ? (double)first_us / HALT_MS : sum.worst_ms;
}

static void judge_state(const halt_robot *robot, const state *s)
{
    const char *one = getenv("GROBO_HALT_STATE");
    if (one != NULL && strcmp(one, s->name) != 0) {
        return;
    }
    halt_begin(robot, FROM_DEG);
    halt_run(500 * HALT_MS);
    halt_make_ready(FROM_DEG);
    if (!s->enter()) {
        print_message("%s: no state \"%s\"\n", robot->name, s->name);
        sum.missing++;
        return;
    }
    if (s->turner == OTHERS && !far_turns(&halt.far, moved_servo(), halt.now_us)) {
        turn_by_others();
    }
    halt_run(2 * HALT_MS);
    halt_traced = one != NULL;
    halt_judge(s->turner == OURS && grobo_robot_is_playing(&halt.robot) ? GROBO_PLAY_STOP_US : 0);
    halt.blind = s->turner != OURS;
    int job = grobo_robot_estop(&halt.robot);
    int r = halt_wait(job, 12 * HALT_S);
    halt_done();
    halt_run(600 * HALT_MS);
    judge_first(s);
    if (r == GROBO_OK) { /* it says that every joint stands */
        halt_verdict(INT64_MAX / 4);
    }
    if (job <= 0) {
        halt_blame("refused", -1, job, 1);
    }
    sum.judged++;
    if (halt.fault[0] != '\0') {
        sum.failed++;
        print_message("GROBO_HALT_FAMILY=%s GROBO_HALT_STATE=\"%s\" "
                      "build/tests/engine/test_halt_states # %s\n",
                      robot->name, s->name, halt.fault);
    }
}

static void judge_all(double dps)
{
    const char *family = getenv("GROBO_HALT_FAMILY");
    others_dps = dps;
    memset(&sum, 0, sizeof sum);
    for (int i = 0; halt_robot_of(i) != NULL; i++) {
        sum.worst_ms = 0;
        if (halt_is_paired(halt_robot_of(i)) ||
            (family != NULL && strcmp(family, halt_robot_of(i)->name) != 0)) {
            continue; /* others turn one servo of a shaft alone in these states */
        }
        for (size_t k = 0; k < sizeof states / sizeof states[0]; k++) {
            judge_state(halt_robot_of(i), &states[k]);
        }
        print_message("%s: the first frame leaves within %.1f ms\n", halt_robot_of(i)->name,
                      sum.worst_ms);
    }
    print_message("%d states, %d that a family does not have, %d broke a rule\n", sum.judged,
                  sum.missing, sum.failed);
    assert_int_equal(sum.failed, 0);
}

TEST(an_emergency_stop_waits_for_nothing)
{
    judge_all(40);
}

/* So fast that a reading is no place to halt it at after 30 ms. */
TEST(nor_where_others_turn_a_joint_fast)
{
    judge_all(150);
}

/* So slowly that some servos tell no speed. */
TEST(nor_where_others_turn_a_joint_slowly)
{
    judge_all(6);
}
