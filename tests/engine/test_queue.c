/* SPDX-License-Identifier: MIT */
/* Which jobs run side by side, and what waits for its turn: the rules by themselves. */
#include <stdint.h>
#include <string.h>

#include "tests/support/axes_kit.h"
#include "tests/support/test.h"

enum { LAST_NUMBER = 200, JOBS = GROBO_ROBOT_JOBS, QUEUE = GROBO_ROBOT_QUEUE };

/* Kinds that others may run beside. */
static const bool shared[GROBO_JOB_SETTLE + 1] = {
    [GROBO_JOB_MOVE] = true, [GROBO_JOB_SENSE] = true,     [GROBO_JOB_TORQUE] = true,
    [GROBO_JOB_RAW] = true,  [GROBO_JOB_REGISTERS] = true,
};

static void start_idle(void)
{
    start();
    robot.last_number = LAST_NUMBER;
}

/* A job of this kind runs at that place, and waits for something for ever. */
static void run_job(int at, grobo_job_kind kind, grobo_joint_mask joints)
{
    grobo_robot_task *job = &robot.jobs[at];
    job->script = grobo_i_script_sense;
    job->number = 100 + at;
    job->kind = kind;
    job->activity = GROBO_I_WAIT;
    job->joints = job->target.set = joints;
    job->joint = -1;
    job->until_us = job->bound_us = GROBO_NEVER_US;
}

static grobo_robot_request request_of(grobo_job_kind kind, int joint)
{
    grobo_robot_request request = {
        .kind = kind, .joints = GROBO_JOINT_BIT(joint), .sense = GROBO_SENSE_GOAL};
    assert_int_equal(grobo_posture_init(&request.target, N), 0);
    request.target.set = request.joints;
    request.target.angle_rad[joint] = here_rad(joint) + RAD(3);
    request.target.time_us = S;
    return request;
}

/* It waits, and may begin by then. */
static void wait_in_queue(grobo_robot_request request, int64_t begin_by_us)
{
    request.number = 50 + (int)robot.queued;
    request.begin_by_us = begin_by_us;
    robot.queue[robot.queued++] = request;
}

static void expect_begun(int at, int number, grobo_job_kind kind, int joint)
{
    const grobo_robot_task *job = &robot.jobs[at];
    const grobo_robot_request request = request_of(kind, joint);
    bool moves = kind == GROBO_JOB_MOVE;
    assert_int_equal(job->kind, kind);
    assert_int_equal(job->number, number);
    assert_true(job->joints == request.joints);
    assert_ptr_equal(job->script, moves ? grobo_i_script_move : grobo_i_script_sense);
    if (moves) {
        assert_memory_equal(&job->target, &request.target, sizeof request.target);
    } else { /* a target is a move's alone */
        assert_int_equal(job->target.set, 0);
    }
    assert_int_equal(job->activity, GROBO_I_READ); /* it has begun already */
    assert_true(moves || job->sense == GROBO_SENSE_GOAL);
    assert_true(robot.job == robot.jobs);
}

/* ---- side by side ---------------------------------------------------------------------------- */

static int be_admitted(grobo_job_kind running, grobo_job_kind kind, bool same)
{
    if (running == GROBO_JOB_NONE || running == GROBO_JOB_SETTLE) {
        return GROBO_OK; /* what nobody asked for makes way */
    }
    if (!shared[running] || !shared[kind]) {
        return GROBO_I_LATER;
    }
    bool joins = running == GROBO_JOB_SENSE || kind == GROBO_JOB_SENSE ||
                 (running == GROBO_JOB_MOVE && kind == GROBO_JOB_MOVE);
    return same && !joins ? GROBO_I_LATER : GROBO_OK;
}

TEST_WITH(rig_wirings, jobs_run_beside_others_by_their_kinds)
{
    for (int running = GROBO_JOB_NONE; running <= GROBO_JOB_SETTLE; running++) {
        for (int kind = GROBO_JOB_NONE + 1; kind < GROBO_JOB_SETTLE; kind++) {
            for (int i = 0; i < 2 * N; i++) {
                int j = i / 2;
                bool same = i % 2 != 0;
                start_idle();
                run_job(0, (grobo_job_kind)running, bits(j, other_of(j)));
                const grobo_joint_mask of =
                    same ? bits(j, third_of(j)) : ~bits(j, other_of(j)) & GROBO_JOINTS_ALL(N);
                int be = be_admitted((grobo_job_kind)running, (grobo_job_kind)kind, same);
                int is = grobo_i_admit(&robot, (grobo_job_kind)kind, of, false);
                if (is != be) {
                    fail_msg("%d beside %d: %d, not %d", kind, running, is, be);
                }
                bool gone = running == GROBO_JOB_SETTLE;
                assert_int_equal(robot.job->kind, gone ? GROBO_JOB_NONE : running);
            }
        }
    }
}

/* What lies behind the jobs looks like one that has every joint. */
static void put_behind_the_jobs(void)
{
    const grobo_robot_task ghost = {.kind = GROBO_JOB_TORQUE, .joints = GROBO_JOINTS_ALL(N)};
    const size_t skipped = offsetof(grobo_robot, queue) - offsetof(grobo_robot, job);
    const size_t end = offsetof(grobo_robot_task, superseded);
    assert_int_equal(offsetof(grobo_robot, job), offsetof(grobo_robot, jobs) + sizeof robot.jobs);
    assert_true(offsetof(grobo_robot_task, kind) >= skipped && end <= sizeof robot.queue);
    memcpy(robot.queue, (const uint8_t *)&ghost + skipped, end - skipped);
}

/* In the last place as in the first, and no further. */
TEST_WITH(rig_wirings, every_job_that_runs_is_looked_at)
{
    for (int j = 0; j < N; j++) {
        for (int at = 1; at < JOBS; at++) {
            start_idle();
            run_job(0, GROBO_JOB_SENSE, GROBO_JOINTS_ALL(N));
            run_job(at, GROBO_JOB_TORQUE, GROBO_JOINT_BIT(j));
            put_behind_the_jobs();
            assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_MOVE, GROBO_JOINT_BIT(j), true),
                             GROBO_I_LATER);
            assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_MOVE, all_but(j), true), GROBO_OK);
        }
    }
}

/* One place is kept for what takes torque away. */
TEST_WITH(rig_wirings, one_job_less_than_there_is_room_for)
{
    start_idle();
    for (int i = 0; i < JOBS; i++) {
        assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_SENSE, 1, false),
                         i < JOBS - 1 ? GROBO_OK : GROBO_I_LATER);
        run_job(i, GROBO_JOB_SENSE, 1);
    }
    robot.jobs[0].kind = GROBO_JOB_NONE; /* the last one moves up */
    robot.jobs[1].kind = GROBO_JOB_NONE;
    assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_SENSE, 1, false), GROBO_OK);
    assert_int_equal(robot.jobs[0].kind, GROBO_JOB_SENSE);
}

TEST_WITH(rig_wirings, who_may_not_begin_at_all_is_told_so)
{
    for (int moves = 0; moves < 2; moves++) {
        start_idle();
        run_job(0, GROBO_JOB_SETTLE, 1);
        robot.link = false;
        assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_RAW, 1, moves), GROBO_ERR_CLOSED);
        assert_int_equal(robot.job->kind, GROBO_JOB_SETTLE);
        robot.link = true;
        latch(GROBO_TRIP_VOLTAGE);
        assert_int_equal(grobo_i_admit(&robot, GROBO_JOB_RAW, 1, moves),
                         moves ? GROBO_ERR_LATCHED : GROBO_OK);
    }
}

TEST_WITH(rig_wirings, moves_that_run_or_wait_have_their_joints)
{
    for (int j = 0; j < N; j++) {
        for (int at = 0; at < JOBS + QUEUE; at++) {
            for (int kind = GROBO_JOB_NONE; kind <= GROBO_JOB_SETTLE; kind++) {
                start_idle();
                for (int i = 0; i < JOBS; i++) {
                    run_job(i, GROBO_JOB_SENSE, all_but(j));
                }
                for (int i = 0; i < QUEUE; i++) {
                    wait_in_queue(request_of(GROBO_JOB_SENSE, other_of(j)), NOW);
                }
                if (at < JOBS) {
                    run_job(at, (grobo_job_kind)kind, GROBO_JOINT_BIT(j));
                } else {
                    robot.queue[at - JOBS] = request_of((grobo_job_kind)kind, j);
                }
                assert_true(grobo_i_joints_of_moves(&robot) ==
                            (kind == GROBO_JOB_MOVE ? GROBO_JOINT_BIT(j) : 0));
                robot.queued = at < JOBS ? 0 : (unsigned)(at - JOBS); /* the others are old */
                assert_true(grobo_i_joints_of_moves(&robot) ==
                            (kind == GROBO_JOB_MOVE && at < JOBS ? GROBO_JOINT_BIT(j) : 0));
            }
        }
    }
}

/* ---- beginning ------------------------------------------------------------------------------- */

TEST_WITH(rig_wirings, what_nothing_is_in_the_way_of_begins_at_once)
{
    for (int j = 0; j < N; j++) {
        for (int moves = 0; moves < 2; moves++) {
            const grobo_job_kind kind = moves ? GROBO_JOB_MOVE : GROBO_JOB_SENSE;
            const grobo_robot_request request = request_of(kind, j);
            start_idle();
            run_job(0, GROBO_JOB_REGISTERS, GROBO_JOINT_BIT(other_of(j)));
            robot.free_joints = GROBO_JOINTS_ALL(N);
            assert_int_equal(grobo_i_queue_ask(&robot, &request), LAST_NUMBER + 1);
            expect_begun(1, LAST_NUMBER + 1, kind, j);
            assert_int_equal(robot.queued, 0);
            assert_true(robot.free_joints == (moves ? all_but(j) : GROBO_JOINTS_ALL(N)));
        }
    }
}

/* A reading takes it from nobody. Who began before goes on before. */
TEST_WITH(rig_wirings, a_move_takes_its_joints_from_moves_before)
{
    for (int j = 0; j < N; j++) {
        for (int moves = 0; moves < 2; moves++) {
            const grobo_job_kind kind = moves ? GROBO_JOB_MOVE : GROBO_JOB_SENSE;
            const grobo_robot_request request = request_of(kind, j);
            start_idle();
            run_job(0, GROBO_JOB_MOVE, bits(j, other_of(j)));
            assert_int_equal(grobo_i_queue_ask(&robot, &request), LAST_NUMBER + 1);
            expect_begun(1, LAST_NUMBER + 1, kind, j);
            assert_true(robot.jobs[0].joints ==
                        (moves ? GROBO_JOINT_BIT(other_of(j)) : bits(j, other_of(j))));
            assert_true(robot.jobs[0].superseded == (moves ? GROBO_JOINT_BIT(j) : 0));
            assert_int_equal(robot.events_n, 0);
        }
        const grobo_robot_request request = request_of(GROBO_JOB_MOVE, j);
        start_idle();
        run_job(0, GROBO_JOB_MOVE, GROBO_JOINT_BIT(j));
        run_job(1, GROBO_JOB_SENSE, GROBO_JOINTS_ALL(N));
        assert_int_equal(grobo_i_queue_ask(&robot, &request), LAST_NUMBER + 1);
        assert_int_equal(robot.jobs[0].number, 101);
        expect_begun(1, LAST_NUMBER + 1, GROBO_JOB_MOVE, j);
        assert_int_equal(robot.events_n, 1);
        const grobo_event_job *end = &robot.events[robot.events_head].u.job;
        assert_int_equal(end->number, 100);
        assert_int_equal(end->result, GROBO_ERR_SUPERSEDED);
    }
}

TEST_WITH(rig_wirings, a_move_of_what_plays_or_leaves_or_tripped_is_refused)
{
    for (int j = 0; j < N; j++) {
        for (int moves = 0; moves < 2; moves++) {
            const grobo_job_kind kind = moves ? GROBO_JOB_MOVE : GROBO_JOB_SENSE;
            const grobo_robot_request request = request_of(kind, j);
            for (int how = 0; how < 3; how++) { /* played, a joint that is not, not played now */
                start_idle();
                robot.sequencer.state = how < 2 ? GROBO_SEQUENCER_PLAYING : GROBO_SEQUENCER_IDLE;
                robot.clip_joints = how == 1 ? all_but(j) : bits(j, other_of(j));
                assert_int_equal(grobo_i_queue_ask(&robot, &request),
                                 moves && how == 0 ? GROBO_ERR_STATE : LAST_NUMBER + 1);
            }
            for (int leaves = GROBO_JOB_NONE + 1; leaves < GROBO_JOB_SETTLE; leaves++) {
                bool refused = moves && (leaves == GROBO_JOB_EXIT || leaves == GROBO_JOB_ESTOP);
                start_idle();
                run_job(0, (grobo_job_kind)leaves, GROBO_JOINT_BIT(other_of(j)));
                assert_int_equal(grobo_i_queue_ask(&robot, &request),
                                 refused ? GROBO_ERR_STATE : LAST_NUMBER + 1);
                assert_int_equal(robot.queued, !refused && !shared[leaves]);
            }
            start_idle();
            robot.link = false;
            assert_int_equal(grobo_i_queue_ask(&robot, &request), GROBO_ERR_CLOSED);
            robot.link = true;
            latch(GROBO_TRIP_VOLTAGE);
            assert_int_equal(grobo_i_queue_ask(&robot, &request),
                             moves ? GROBO_ERR_LATCHED : LAST_NUMBER + 1);
        }
    }
}

/* ---- waiting --------------------------------------------------------------------------------- */

/* Behind what waits already, though nothing else is in the way. */
TEST_WITH(rig_wirings, what_cannot_begin_waits)
{
    for (int idle = 0; idle < 2; idle++) {
        for (int j = 0; j < N; j++) {
            start_idle();
            run_job(0, idle ? GROBO_JOB_NONE : GROBO_JOB_CHECK, 0);
            if (idle) {
                grobo_robot_request other = request_of(GROBO_JOB_SENSE, 0);
                other.sense = GROBO_SENSE_FULL;
                wait_in_queue(other, NOW + S);
            }
            for (int i = idle; i < QUEUE; i++) {
                const grobo_job_kind kind = i % 2 ? GROBO_JOB_SENSE : GROBO_JOB_MOVE;
                grobo_robot_request request = request_of(kind, j);
                int number = LAST_NUMBER + 1 + i - idle;
                assert_int_equal(grobo_i_queue_ask(&robot, &request), number);
                assert_int_equal(robot.queued, i + 1);
                request.number = number;
                request.begin_by_us = NOW + 2 * S;
                assert_memory_equal(&robot.queue[i], &request, sizeof request);
            }
            grobo_robot_request request = request_of(GROBO_JOB_SENSE, j);
            request.sense = GROBO_SENSE_FULL; /* another one: it cannot join the last */
            assert_int_equal(grobo_i_queue_ask(&robot, &request), GROBO_ERR_FULL);
            assert_int_equal(robot.queued, QUEUE);
            assert_int_equal(robot.last_number, LAST_NUMBER + QUEUE - idle);
            assert_int_equal(robot.jobs[0].kind, idle ? GROBO_JOB_NONE : GROBO_JOB_CHECK);
            assert_int_equal(robot.jobs[1].kind, GROBO_JOB_NONE);
        }
    }
}

/* ---- joining --------------------------------------------------------------------------------- */

/* It is in the middle of reading its joints, of which it has read those that are not left. */
static void read_first(int at, grobo_job_kind kind, grobo_joint_mask joints, grobo_joint_mask left)
{
    run_job(at, kind, joints);
    robot.jobs[at].at = 1;
    robot.jobs[at].activity = GROBO_I_READ;
    robot.jobs[at].todo = left;
    robot.jobs[at].sense = GROBO_SENSE_GOAL;
    robot.jobs[at].singly = kind == GROBO_JOB_MOVE;
    robot.jobs[at].target = request_of(kind, 0).target;
    robot.jobs[at].target.set = joints;
}

static grobo_robot_request single(grobo_job_kind kind, int joint)
{
    grobo_robot_request request = request_of(kind, joint);
    request.singly = kind == GROBO_JOB_MOVE;
    request.joint_time_us[joint] = (int32_t)request.target.time_us;
    return request;
}

static const grobo_job_kind joining[] = {GROBO_JOB_MOVE, GROBO_JOB_SENSE, GROBO_JOB_TORQUE};
enum { JOINING = sizeof joining / sizeof joining[0] };

TEST_WITH(rig_wirings, who_reads_its_joints_is_joined)
{
    for (int k = 0; k < JOINING; k++) {
        for (int j = 0; j < N; j++) {
            start_idle();
            read_first(0, joining[k], GROBO_JOINT_BIT(other_of(j)), 0);
            const grobo_robot_request request = single(joining[k], j);
            robot.free_joints = request.joints;
            assert_int_equal(grobo_i_queue_ask(&robot, &request), 100);
            assert_int_equal(robot.queued, 0);
            assert_int_equal(robot.jobs[1].kind, GROBO_JOB_NONE);
            assert_true(robot.jobs[0].joints == bits(j, other_of(j)));
            assert_true(robot.jobs[0].todo == request.joints);
            assert_true((robot.free_joints == 0) == (joining[k] != GROBO_JOB_SENSE));
            if (joining[k] == GROBO_JOB_MOVE) {
                assert_true(robot.jobs[0].target.set == robot.jobs[0].joints);
                assert_true(robot.jobs[0].target.angle_rad[j] == request.target.angle_rad[j]);
                assert_int_equal(robot.jobs[0].joint_time_us[j], S);
            }
        }
    }
}

/* One that has read a joint, or asked for it, does not serve who asks for it now. */
TEST_WITH(rig_wirings, who_has_read_a_joint_is_not_joined_for_it)
{
    for (int j = 0; j < N; j++) {
        start_idle();
        read_first(0, GROBO_JOB_SENSE, bits(j, other_of(j)), GROBO_JOINT_BIT(other_of(j)));
        const grobo_robot_request request = single(GROBO_JOB_SENSE, j);
        assert_int_equal(grobo_i_queue_ask(&robot, &request), LAST_NUMBER + 1);
        start_idle();
        read_first(0, GROBO_JOB_SENSE, bits(j, other_of(j)), bits(j, other_of(j)));
        robot.slots_end = 1;
        robot.slots[0].use = GROBO_I_USE_JOB;
        robot.slots[0].reads = true;
        robot.slots[0].joint = (uint8_t)j;
        robot.slots[0].job = 100;
        robot.slots[0].txn.sent_us = NOW - 1;
        assert_false(grobo_i_join_job(&robot, &request) == 100);
        robot.slots[0].txn.sent_us = -1; /* it waits for the line: it tells where it is by then */
        assert_int_equal(grobo_i_join_job(&robot, &request), 100);
        robot.slots[0].use = GROBO_I_USE_FREE;
        robot.slots_end = 0;
    }
}

TEST_WITH(rig_wirings, what_differs_is_not_joined)
{
    for (int j = 0; j < N; j++) {
        for (int way = 0; way < 5; way++) {
            start_idle();
            const grobo_job_kind kind = way < 3 ? GROBO_JOB_MOVE : GROBO_JOB_SENSE;
            read_first(0, kind, GROBO_JOINT_BIT(way == 2 ? j : other_of(j)), 0);
            grobo_robot_request request = single(kind, j);
            request.singly = request.singly && way != 0;
            request.target.time_us += way == 1; /* another time, */
            robot.jobs[0].sense = way == 3 ? GROBO_SENSE_FULL : robot.jobs[0].sense;
            robot.jobs[0].at = way == 4 ? 2 : 1;
            assert_int_equal(grobo_i_join_job(&robot, &request), 0);
        }
        /* unless there is no place for one of its own. */
        start_idle();
        read_first(0, GROBO_JOB_MOVE, GROBO_JOINT_BIT(other_of(j)), 0);
        for (int at = 1; at < JOBS - 1; at++) {
            run_job(at, GROBO_JOB_SENSE, 1);
        }
        grobo_robot_request request = single(GROBO_JOB_MOVE, j);
        request.target.time_us++;
        request.joint_time_us[j] = S + 1;
        assert_int_equal(grobo_i_queue_ask(&robot, &request), 100);
        assert_int_equal(robot.jobs[0].joint_time_us[j], S + 1);
    }
}

/* The last that is alike, behind all that have one of its joints. */
TEST_WITH(rig_wirings, what_waits_is_joined)
{
    for (int k = 0; k < JOINING; k++) {
        for (int j = 0; j < N; j++) {
            start_idle();
            run_job(0, joining[k] == GROBO_JOB_TORQUE ? GROBO_JOB_TORQUE : GROBO_JOB_CHECK,
                    GROBO_JOINTS_ALL(N));
            wait_in_queue(single(joining[k], other_of(j)), NOW + S);
            wait_in_queue(single(GROBO_JOB_RAW, third_of(j)), NOW + S);
            grobo_robot_request request = single(joining[k], j);
            assert_int_equal(grobo_i_queue_ask(&robot, &request), 50);
            assert_true(robot.queue[0].joints == bits(j, other_of(j)));
            assert_int_equal(robot.queued, 2);
            request = single(joining[k], third_of(j)); /* nothing goes before what has its joint */
            assert_int_equal(grobo_i_queue_ask(&robot, &request), LAST_NUMBER + 1);
            assert_int_equal(robot.queued, 3);
        }
    }
}

/* Torque on waits for other torque, and is refused where its joint does something else. */
/* What lies on the stack where a request is made next is no small number. */
static __attribute__((noinline)) void dirty_stack(void)
{
    volatile unsigned char below[8192];
    for (size_t i = 0; i < sizeof below; i++) {
        below[i] = 0x7f;
    }
}

TEST_WITH(rig_wirings, a_reading_that_waits_is_joined_by_what_it_sets_alone)
{
    start_idle();
    run_job(0, GROBO_JOB_EXIT, GROBO_JOINTS_ALL(N));
    dirty_stack();
    int first = grobo_robot_sense(&robot, GROBO_JOINT_BIT(0), GROBO_SENSE_FULL);
    assert_true(first > 0);
    dirty_stack();
    assert_int_equal(grobo_robot_sense(&robot, GROBO_JOINT_BIT(1), GROBO_SENSE_FULL), first);
    assert_int_equal(robot.queued, 1);
    assert_true(robot.queue[0].joints == (GROBO_JOINT_BIT(0) | GROBO_JOINT_BIT(1)));
    assert_int_equal(robot.queue[0].target.set, 0);
}

TEST_WITH(rig_wirings, torque_on_waits_for_torque_alone)
{
    for (int running = GROBO_JOB_NONE + 1; running < GROBO_JOB_SETTLE; running++) {
        for (int j = 0; j < N; j++) {
            start_idle();
            run_job(0, (grobo_job_kind)running, GROBO_JOINT_BIT(j));
            const grobo_robot_request request = single(GROBO_JOB_TORQUE, j);
            int is = grobo_i_queue_ask(&robot, &request);
            assert_int_equal(is > 0, running == GROBO_JOB_TORQUE || running == GROBO_JOB_SENSE);
            assert_int_equal(robot.queued, running == GROBO_JOB_TORQUE);
            assert_true(is > 0 || is == GROBO_ERR_STATE);
        }
    }
}

/* ---- turns ----------------------------------------------------------------------------------- */

/* As many as may, the oldest first; who must wait lets nobody pass. */
TEST_WITH(rig_wirings, what_waits_begins_in_its_order)
{
    for (int j = 0; j < N; j++) {
        start_idle();
        run_job(0, GROBO_JOB_TORQUE, GROBO_JOINT_BIT(third_of(j)));
        wait_in_queue(request_of(GROBO_JOB_MOVE, j), NOW + 1);
        wait_in_queue(request_of(GROBO_JOB_MOVE, third_of(j)), NOW + 1);
        wait_in_queue(request_of(GROBO_JOB_SENSE, other_of(j)), NOW + 1);
        wait_in_queue(request_of(GROBO_JOB_SENSE, third_of(j)), NOW + 2);
        robot.queue_may_go = true;
        grobo_i_queue_step(&robot);
        assert_false(robot.queue_may_go);
        expect_begun(1, 50, GROBO_JOB_MOVE, j);
        assert_int_equal(robot.jobs[2].kind, GROBO_JOB_NONE);
        assert_int_equal(robot.queued, 3);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(robot.queue[i].number, 51 + i);
        }
        robot.jobs[0].kind = GROBO_JOB_NONE;
        grobo_i_queue_step(&robot);
        assert_int_equal(robot.jobs[0].number, 50);
        expect_begun(1, 51, GROBO_JOB_MOVE, third_of(j));
        expect_begun(2, 52, GROBO_JOB_SENSE, other_of(j));
        assert_int_equal(robot.queued, 1); /* there is no more room */
        assert_int_equal(robot.queue[0].number, 53);
        assert_int_equal(robot.events_n, 0);
    }
}

/* Event number `at` tells that the job of this joint ended before it began. */
static void expect_ended(int at, int number, grobo_job_kind kind, int joint, int result)
{
    const grobo_event *event =
        &robot.events[(robot.events_head + (unsigned)at) % GROBO_ROBOT_EVENTS];
    assert_int_equal(event->kind, GROBO_EVENT_JOB);
    assert_int_equal(event->u.job.number, number);
    assert_int_equal(event->u.job.kind, kind);
    assert_int_equal(event->u.job.result, result);
    assert_int_equal(event->u.job.joint, -1);
    assert_true(event->u.job.failed == GROBO_JOINT_BIT(joint));
}

/* Or, in its turn, with the reason why it may not begin; those behind it go on. */
TEST_WITH(rig_wirings, what_has_waited_too_long_ends)
{
    for (int j = 0; j < N; j++) {
        for (int late = 0; late < 2; late++) {
            start_idle();
            robot.sequencer.state = late ? GROBO_SEQUENCER_IDLE : GROBO_SEQUENCER_PLAYING;
            robot.clip_joints = GROBO_JOINT_BIT(j);
            wait_in_queue(request_of(GROBO_JOB_MOVE, j), late ? NOW : NOW + 1);
            wait_in_queue(request_of(GROBO_JOB_SENSE, other_of(j)), NOW + 1);
            grobo_i_queue_step(&robot);
            assert_int_equal(robot.queued, 0);
            expect_begun(0, 51, GROBO_JOB_SENSE, other_of(j));
            assert_int_equal(robot.jobs[1].kind, GROBO_JOB_NONE);
            assert_int_equal(robot.events_n, 1);
            expect_ended(0, 50, GROBO_JOB_MOVE, j, late ? GROBO_ERR_STALE : GROBO_ERR_STATE);
        }
    }
}

TEST_WITH(rig_wirings, a_trip_ends_all_that_waits)
{
    for (int latched = 0; latched < 2; latched++) {
        start_idle();
        for (int i = 0; i < QUEUE; i++) {
            wait_in_queue(request_of(i % 2 ? GROBO_JOB_SENSE : GROBO_JOB_MOVE, i), NOW + S);
        }
        grobo_i_trip(&robot, GROBO_TRIP_HOST_STALL, -1, 0, latched);
        assert_int_equal(robot.queued, 0);
        assert_int_equal(robot.events_n, 1 + QUEUE);
        for (int i = 0; i < QUEUE; i++) {
            expect_ended(1 + i, 50 + i, i % 2 ? GROBO_JOB_SENSE : GROBO_JOB_MOVE, i,
                         latched ? GROBO_ERR_LATCHED : GROBO_ERR_CANCELED);
        }
    }
}

TEST_WITH(rig_wirings, the_queue_is_looked_at_when_something_may_have_changed)
{
    for (int may = 0; may < 2; may++) {
        start_idle();
        robot.queue_may_go = may;
        robot.queue[0].begin_by_us = NOW + 7; /* of one that has gone */
        assert_true(grobo_i_queue_deadline(&robot) == GROBO_NEVER_US);
        wait_in_queue(request_of(GROBO_JOB_SENSE, 3), NOW + 5);
        assert_true(grobo_i_queue_deadline(&robot) == (may ? NOW : NOW + 5));
        wait_in_queue(request_of(GROBO_JOB_SENSE, 3), NOW + 4);
        assert_true(grobo_i_queue_deadline(&robot) == (may ? NOW : NOW + 5));
    }
}
