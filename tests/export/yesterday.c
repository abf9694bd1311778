/* SPDX-License-Identifier: MIT */
/*
 * A program that was compiled when structures of configuration and options had two fields less,
 * with the library of today. Behind each structure is a fence: what a library takes from there, it
 * refuses.
 */
#include <stdio.h>
#include <string.h>

#include <grobo/core/body.h>
#include <grobo/core/body_motion.h>
#include <grobo/core/motion_io.h>
#include <grobo/core/serial.h>
#include <grobo/grobo.h>

#define FENCED(type, name, init)                                                                   \
    static struct {                                                                                \
        type config;                                                                               \
        unsigned char fence[256];                                                                  \
    } name = {{init}, {0}};                                                                        \
    memset(name.fence, 0xff, sizeof name.fence)

static int fail(const char *what, int result)
{
    fprintf(stderr, "%s: %s\n", what, grobo_error_text(result));
    return 1;
}

static int swallow(void *ctx, const void *data, size_t size)
{
    (void)ctx, (void)data, (void)size;
    return GROBO_OK;
}

/* What takes options of motions. */
static int with_motions(grobo_motion *motion)
{
    FENCED(grobo_clip_options, clips, GROBO_CLIP_OPTIONS_INIT);
    FENCED(grobo_read_options, reading, GROBO_READ_OPTIONS_INIT);
    FENCED(grobo_check_options, checking, GROBO_CHECK_OPTIONS_INIT);
    FENCED(grobo_write_options, writing, GROBO_WRITE_OPTIONS_INIT);
    FENCED(grobo_body_options, solving, GROBO_BODY_OPTIONS_INIT);
    FENCED(grobo_body_check_options, balance, GROBO_BODY_CHECK_OPTIONS_INIT);
    static const char text[] = "type: PoseSeq\nname: t\nrefs:\n"
                               "- { time: 0, refer: { type: Pose, joints: [ 0 ], q: [ 0 ] } }\n";
    const grobo_sink sink = {swallow, NULL};
    grobo_motion *keys = NULL;
    grobo_body *body = NULL;
    grobo_clip clip;

    int result = grobo_motion_clip(motion, &clips.config, &clip);
    if (result >= 0) {
        grobo_motion_clip_free(&clip);
        result = grobo_motion_check(motion, grobo_gr001_model(), &checking.config, NULL);
    }
    if (result >= 0) {
        result = grobo_motion_write(motion, GROBO_FORMAT_M, &writing.config, &sink, NULL);
    }
    if (result >= 0) {
        result = grobo_motion_read_memory(text, sizeof text - 1, &reading.config, NULL, &keys);
    }
    if (result >= 0) {
        result = grobo_body_new(grobo_gr001_body(), keys, &solving.config, NULL, &body);
    }
    if (result >= 0) {
        result = grobo_body_check(body, &balance.config);
    }
    grobo_body_free(body);
    grobo_motion_free(keys);
    printf("%d %d %d ", (int)sizeof clips.config, (int)sizeof reading.config,
           (int)sizeof checking.config);
    printf("%d %d %d ", (int)sizeof writing.config, (int)sizeof solving.config,
           (int)sizeof balance.config);
    return result;
}

static int play(grobo_runner *runner, const grobo_posture *posture)
{
    FENCED(grobo_play_options, playing, GROBO_PLAY_OPTIONS_INIT);
    grobo_motion *motion = NULL;

    int result = grobo_motion_new(GROBO_MOTION_POSTURES, 20, NULL, &motion);
    if (result >= 0) {
        result = grobo_motion_append(motion, posture);
    }
    if (result >= 0) {
        result = with_motions(motion);
    }
    if (result >= 0) {
        result = grobo_runner_set_motion(runner, motion);
    }
    if (result >= 0) {
        result = grobo_runner_play_motion(runner, &playing.config);
    }
    if (result >= 0) {
        result = grobo_runner_wait(runner, 0);
    }
    grobo_motion_free(motion);
    printf("%d ", (int)sizeof playing.config);
    return result;
}

int main(void)
{
    FENCED(grobo_robot_config, robot, GROBO_ROBOT_CONFIG_INIT);
    FENCED(grobo_sim_config, sim, GROBO_SIM_CONFIG_INIT);
    FENCED(grobo_session_config, session, GROBO_SESSION_CONFIG_INIT);
    FENCED(grobo_runner_config, runner, GROBO_RUNNER_CONFIG_INIT);
    FENCED(grobo_serial_config, serial, GROBO_SERIAL_CONFIG_INIT);
    grobo_serial *port = NULL;
    grobo_runner *robot_of = NULL;
    grobo_posture target;

    robot.config.speed_limit_pct = 50;
    sim.config.unpaced = true;
    session.config.device = "sim";
    session.config.robot = &robot.config;
    session.config.sim = &sim.config;
    runner.config.session = &session.config;
    runner.config.name = "yesterday's";
    int result = grobo_serial_new(&serial.config, &port);
    if (result < 0) {
        return fail("serial", result);
    }
    grobo_serial_free(port);
    result = grobo_runner_new(&runner.config, &robot_of);
    if (result < 0) {
        return fail("runner", result);
    }
    result = grobo_runner_connect(robot_of, 0);
    if (result >= 0) {
        grobo_posture_init_pose(&target, grobo_gr001_model());
        result = grobo_runner_wait_job(robot_of,
                                       grobo_robot_move(grobo_runner_robot(robot_of), &target), 0);
    }
    if (result >= 0) {
        result = play(robot_of, &target);
    }
    if (result < 0 || strcmp(grobo_runner_name(robot_of), "yesterday's") != 0) {
        return fail("move", result);
    }
    grobo_runner_free(robot_of);
    printf("%d %d %d %d %d\n", (int)sizeof robot.config, (int)sizeof sim.config,
           (int)sizeof session.config, (int)sizeof runner.config, (int)sizeof serial.config);
    return 0;
}
