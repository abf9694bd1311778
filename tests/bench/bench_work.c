/* SPDX-License-Identifier: MIT */
/*
 * Pieces of work that are the same in each run, without a clock, a line or another process: their
 * instructions are counted (tests/bench/count.sh), and gated by tests/bench/instructions.
 *
 * usage: bench_work PIECE N   does the piece N times, prints nanoseconds of processor time of each
 *        bench_work           prints rows of all pieces
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/board.h>
#include <grobo/core/body_motion.h>
#include <grobo/core/motion_io.h>
#include <grobo/core/robot.h>
#include <grobo/core/rs30x.h>
#include <grobo/core/sim.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>
#include <grobo/robot_file.h>

#include "tests/bench/bench.h"
#include "tests/bench/one_servo.h"
#include "tests/support/tables.h"

#define SECOND_US 1000000

/* ---- the codec: a pose of 20 joints ------------------------------------------------------- */

static grobo_target target;
static grobo_exchange pose;

static void prepare_codec(void)
{
    const grobo_driver *driver = grobo_gr001_driver(GROBO_WIRING_BOARD);

    (void)grobo_posture_init(&target.posture, driver->model->n_joints);
    for (int j = 0; j < driver->model->n_joints; j++) {
        (void)grobo_posture_set_rad(&target.posture, j, driver->model->joints[j].init_rad);
        target.joint_time_us[j] = 20000;
    }
    (void)driver->posture(driver, NULL, &target, 0, &pose);
}

static void goals(long n)
{
    grobo_rs30x_goal goal[20];

    for (int j = 0; j < 20; j++) {
        goal[j] = (grobo_rs30x_goal){.id = (uint8_t)(j + 1), .pos_ddeg = (int16_t)j, .time_cs = 2};
    }
    for (; n > 0; n--) {
        pose.frame_bytes = (uint16_t)grobo_frame_goals(&grobo_i_board_protocol, goal, 20,
                                                       pose.frame, sizeof pose.frame);
    }
}

/* The same from angles, as the engine has it done. */
static void build(long n)
{
    const grobo_driver *driver = grobo_gr001_driver(GROBO_WIRING_BOARD);

    for (; n > 0; n--) {
        pose.frame_bytes = 0;
        (void)driver->posture(driver, NULL, &target, 0, &pose);
    }
}

static void parse(long n)
{
    grobo_rs30x_parser parser;
    grobo_rs30x_packet packet;

    grobo_rs30x_parser_init(&parser, GROBO_ACCEPT_COMMANDS);
    for (; n > 0; n--) {
        /* Without what the board puts around it: S, the size. */
        (void)grobo_rs30x_parser_feed(&parser, pose.frame + 2, pose.frame_bytes - 2u);
        (void)grobo_rs30x_parser_next(&parser, &packet);
    }
}

/* ---- the engine and a simulated robot, in virtual time ------------------------------------ */

static struct {
    grobo_robot robot;
    grobo_sim sim;
    int64_t now_us;
    double to_deg;
} rig;

static int64_t rig_clock(void *ctx)
{
    (void)ctx;
    return rig.now_us;
}

static void pump(void)
{
    uint8_t bytes[GROBO_FRAME_MAX_BYTES];
    size_t got;
    int size;

    while ((got = grobo_sim_tx(&rig.sim, bytes, sizeof bytes, rig.now_us)) > 0) {
        grobo_robot_rx(&rig.robot, bytes, got, rig.now_us);
    }
    grobo_robot_step(&rig.robot, rig.now_us);
    while ((size = grobo_robot_tx(&rig.robot, bytes, sizeof bytes, rig.now_us)) > 0) {
        (void)grobo_sim_rx(&rig.sim, bytes, (size_t)size, rig.now_us);
    }
}

static void run_us(int64_t span_us)
{
    int64_t end_us = rig.now_us + span_us;

    pump();
    while (rig.now_us < end_us) {
        int64_t robot_us = grobo_robot_deadline(&rig.robot, rig.now_us);
        int64_t sim_us = grobo_sim_packet_deadline(&rig.sim);
        int64_t at_us = robot_us < sim_us ? robot_us : sim_us;

        at_us = at_us < end_us ? at_us : end_us;
        rig.now_us = at_us > rig.now_us ? at_us : rig.now_us;
        pump();
    }
}

static void start_with(const grobo_driver *driver, grobo_wiring wiring, int64_t sense_interval_us)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = sense_interval_us};
    const grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .wiring = wiring, .model = driver->model};
    const grobo_robot_host host = {.clock = rig_clock};

    rig.now_us = SECOND_US;
    if (grobo_sim_init(&rig.sim, &sim, rig.now_us) < 0 ||
        grobo_robot_init(&rig.robot, driver, NULL, &config, rig.now_us) < 0) {
        fputs("bench_work: no robot\n", stderr);
        exit(1);
    }
    grobo_robot_set_host(&rig.robot, &host);
    grobo_robot_link_up(&rig.robot, rig.now_us);
    run_us(SECOND_US);
}

static void start_on(grobo_wiring wiring, int64_t sense_interval_us)
{
    start_with(grobo_gr001_driver(wiring), wiring, sense_interval_us);
}

static void start(int64_t sense_interval_us)
{
    start_on(GROBO_WIRING_BOARD, sense_interval_us);
}

static void prepare_sense(void)
{
    start(SECOND_US);
}

static void prepare_wire(void)
{
    start(1);
}

static void seconds(long n)
{
    run_us(n * SECOND_US);
}

/* ---- weight ---------------------------------------------------------------------------------- */

/* GR001 hangs by its waist, and all of its joints are sent to and fro. */
static void prepare_weight(void)
{
    static grobo_robot_sim setting;
    grobo_sim_physics *physics = NULL;
    const grobo_robot_def *def = grobo_robot_def_at(0);
    rig.now_us = 0;
    if (grobo_robot_def_sim(def, def->wiring, &setting) < 0 ||
        grobo_robot_def_physics(def, false, NULL, &physics) < 0) {
        fputs("bench_work: no weight\n", stderr);
        exit(1);
    }
    setting.config.physics = physics; /* until the program ends */
    if (grobo_sim_init(&rig.sim, &setting.config, rig.now_us) < 0) {
        fputs("bench_work: no robot\n", stderr);
        exit(1);
    }
    for (int i = 0; i < grobo_sim_servos(&rig.sim); i++) {
        (void)grobo_sim_set_register(&rig.sim, i, GROBO_RS30X_TORQUE, 1);
    }
}

static void steps(long n)
{
    for (long k = 0; k < n; k++) {
        for (int i = 0; k % 500 == 0 && i < grobo_sim_servos(&rig.sim); i++) {
            int32_t goal_ddeg = k % 1000 == 0 ? 100 : -100;
            (void)grobo_sim_set_register(&rig.sim, i, GROBO_RS30X_GOAL, goal_ddeg);
        }
        rig.now_us += 1000;
        grobo_sim_step(&rig.sim, rig.now_us);
    }
}

/* ---- a servo that falls silent, in virtual time ---------------------------------------------- */

static int ended;

static void on_end(void *ctx, const grobo_event *event)
{
    (void)ctx;
    ended = event->kind == GROBO_EVENT_JOB ? event->u.job.number : ended;
}

/* How long a reading of these joints takes, in milliseconds. */
static double reading_ms(grobo_joint_mask joints)
{
    const int64_t begin_us = rig.now_us;
    const int job = grobo_robot_sense(&rig.robot, joints, GROBO_SENSE_FULL);

    pump();
    while (ended != job && rig.now_us < begin_us + 60 * SECOND_US) {
        run_us(100);
    }
    return (double)(rig.now_us - begin_us) / 1000;
}

/* Of a robot whose line's latency has been learnt: it has none. The floor is what three attempts
 * take on the wire. */
static void silence_rows_of(grobo_wiring wiring, const char *line)
{
    const struct {
        const char *what;
        grobo_joint_mask joints;
        int count;
    } rows[] = {{"silent servo: time to its error", 1, 1},
                {"reading of 20 silent servos", GROBO_JOINTS_ALL(20), 20}};
    grobo_budget budget;

    start_on(wiring, GROBO_SENSE_NEVER);
    grobo_robot_on_event(&rig.robot, on_end, NULL);
    for (int i = 0; i < 60; i++) {
        (void)reading_ms(GROBO_JOINTS_ALL(20));
    }
    (void)grobo_robot_budget(&rig.robot, &budget);
    for (int j = 0; j < 20; j++) {
        (void)grobo_sim_set_cable(&rig.sim, j, GROBO_SIM_CABLE_OUT);
    }
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double wire_ms = 3.0 * rows[i].count * (double)budget.reading_us / 1000;
        char measure[96];

        (void)snprintf(measure, sizeof measure, "%s, full states%s, ms", rows[i].what, line);
        bench_row("S6", measure, "grobo", reading_ms(rows[i].joints));
        bench_row("S6", measure, "floor wire", wire_ms);
    }
}

static void silence_rows(void)
{
    silence_rows_of(GROBO_WIRING_BUS, "");
    silence_rows_of(GROBO_WIRING_BOARD, " through the board");
}

/* ---- one reading, in the engine alone -------------------------------------------------------- */

static grobo_driver one_servo = GROBO_TABLE_INIT(grobo_driver);
static long ended_well;

static void on_reading(void *ctx, const grobo_event *event)
{
    (void)ctx;
    ended_well += event->kind == GROBO_EVENT_JOB && event->u.job.result == GROBO_OK;
}

static void prepare_reading(void)
{
    const grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                       .sense_interval_us = GROBO_SENSE_NEVER};
    const grobo_robot_host host = {.clock = rig_clock};

    rig.now_us = SECOND_US;
    (void)grobo_rs30x_driver_init(&one_servo, &one_servo_model, &grobo_i_rs30x_protocol);
    (void)grobo_robot_init(&rig.robot, &one_servo, NULL, &config, rig.now_us);
    grobo_robot_set_host(&rig.robot, &host);
    grobo_robot_on_event(&rig.robot, on_reading, NULL);
    grobo_robot_link_up(&rig.robot, rig.now_us);
    grobo_robot_step(&rig.robot, rig.now_us);
}

/* A job each: asked for, sent, answered a millisecond later, told. */
static void readings(long n)
{
    static const uint8_t reply[] = {0xFD, 0xDF, 1, 0, 0x2A, 2, 1, 0, 0, 1 ^ 0x2A ^ 2 ^ 1};
    uint8_t frame[GROBO_FRAME_MAX_BYTES];

    ended_well = 0;
    for (long i = 0; i < n; i++) {
        (void)grobo_robot_sense(&rig.robot, 1, GROBO_SENSE_POSITION);
        (void)grobo_robot_tx(&rig.robot, frame, sizeof frame, rig.now_us);
        rig.now_us += 1000;
        grobo_robot_rx(&rig.robot, reply, sizeof reply, rig.now_us);
        grobo_robot_step(&rig.robot, rig.now_us);
        (void)grobo_robot_deadline(&rig.robot, rig.now_us);
    }
    if (ended_well != n) {
        fprintf(stderr, "bench_work: %ld of %ld readings answered\n", ended_well, n);
        exit(1);
    }
}

/* A wave of all joints. */
static int wave_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    int r = grobo_posture_init(posture, 20);

    for (int j = 0; j < 20; j++) {
        double init_deg = grobo_deg_from_rad(grobo_i_gr001_model.joints[j].init_rad);
        double by_deg = (double)llabs(t_us % 4000000 - 2000000) / 200000.0;

        (void)grobo_posture_set_deg(posture, j, j == 12 ? init_deg - by_deg : init_deg + by_deg);
    }
    return r;
}

static int wave_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    *at_us = (int64_t)i * SECOND_US;
    return wave_sample(ctx, *at_us, posture);
}

static void play(const grobo_clip *wave, uint16_t rate_hz)
{
    const grobo_play_options options = {GROBO_PLAY_OPTIONS_INIT, .mode = GROBO_PLAY_RATE,
                                        .rate_hz = rate_hz, .unwatched = true};
    grobo_clip clip = *wave;

    clip.length_us = INT64_C(3600) * SECOND_US;
    clip.n_keys = 3601;
    (void)grobo_robot_play(&rig.robot, &clip, &options);
    run_us(5 * SECOND_US);
    if (grobo_robot_play_state(&rig.robot) != GROBO_SEQUENCER_PLAYING) {
        fputs("bench_work: it does not play\n", stderr);
        exit(1);
    }
}

static void prepare_play(void)
{
    start(SECOND_US);
    play(&(grobo_clip){.key = wave_key, .sample = wave_sample, .n_joints = 20}, 50);
}

/* ---- the same by number of joints ------------------------------------------------------------ */

static char joint_name[GROBO_JOINTS_MAX][8];
static grobo_joint joint_of[GROBO_JOINTS_MAX];
static grobo_model chain = GROBO_TABLE(grobo_model, .name = "chain", GROBO_MODEL_JOINTS(joint_of));
static grobo_driver chain_driver = GROBO_TABLE_INIT(grobo_driver);

static int chain_sample(void *ctx, int64_t t_us, grobo_posture *posture)
{
    (void)ctx;
    int r = grobo_posture_init(posture, chain.n_joints);

    for (int j = 0; j < chain.n_joints; j++) {
        (void)grobo_posture_set_deg(posture, j, (double)llabs(t_us % 4000000 - 2000000) / 200000.0);
    }
    return r;
}

static int chain_key(void *ctx, size_t i, grobo_posture *posture, int64_t *at_us)
{
    *at_us = (int64_t)i * SECOND_US;
    return chain_sample(ctx, *at_us, posture);
}

/* Engine and simulated robot together; 20 frames a second, since those of 64 joints take the wire
 * 30 ms. */
static void joints_rows(void)
{
    static const uint8_t counts[] = {1, 2, 5, 10, 20, 40, GROBO_JOINTS_MAX};
    enum { RATE_HZ = 20, SPAN_S = 20 };

    for (int j = 0; j < GROBO_JOINTS_MAX; j++) {
        (void)snprintf(joint_name[j], sizeof joint_name[j], "J%d", j);
        joint_of[j] = (grobo_joint){.name = joint_name[j],
                                    .min_rad = -1,
                                    .max_rad = 1,
                                    .max_speed_rad_s = 5,
                                    .motor = (uint8_t)(j + 1),
                                    .mirror = (uint8_t)j,
                                    .mirror_sign = 1};
    }
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        char measure[64];

        chain.n_joints = counts[i];
        (void)grobo_rs30x_driver_init(&chain_driver, &chain, &grobo_i_rs30x_protocol);
        start_with(&chain_driver, GROBO_WIRING_BUS, SECOND_US);
        play(&(grobo_clip){.key = chain_key, .sample = chain_sample, .n_joints = chain.n_joints},
             RATE_HZ);
        const double begin_us = bench_cpu_us();
        run_us((int64_t)SPAN_S * SECOND_US);
        (void)snprintf(measure, sizeof measure, "%d joints: play and simulated robot, us a frame",
                       counts[i]);
        bench_row("S11", measure, "grobo", (bench_cpu_us() - begin_us) / (SPAN_S * RATE_HZ));
    }
}

/* Simulated robots alone, each told a pose 30 times a second. */
static void prepare_poses(void)
{
    const grobo_sim_config config = {GROBO_SIM_CONFIG_INIT};

    prepare_codec();
    rig.now_us = SECOND_US;
    (void)grobo_sim_init(&rig.sim, &config, rig.now_us);
}

static void poses(long n)
{
    uint8_t bytes[64];

    for (long i = 0; i < n * 30; i++) {
        (void)grobo_sim_rx(&rig.sim, pose.frame, pose.frame_bytes, rig.now_us);
        rig.now_us += SECOND_US / 30;
        while (grobo_sim_tx(&rig.sim, bytes, sizeof bytes, rig.now_us) > 0) {
        }
    }
}

/* ---- files and the whole body -------------------------------------------------------------- */

static struct {
    char data[4 << 20];
    size_t size;
} text;

static int take(void *ctx, const void *data, size_t size)
{
    (void)ctx;
    if (size > sizeof text.data - text.size) {
        return GROBO_ERR_SPACE;
    }
    memcpy(text.data + text.size, data, size);
    text.size += size;
    return 0;
}

/* A motion of 1000 postures in memory. */
static void prepare_file(grobo_motion_kind kind)
{
    grobo_motion *motion = NULL;
    grobo_posture posture;

    (void)grobo_motion_new(kind, 20, NULL, &motion);
    if (kind == GROBO_MOTION_FRAMES) {
        (void)grobo_motion_set_frame_rate(motion, 100);
    }
    for (int i = 0; i < 1000; i++) {
        (void)wave_sample(NULL, i * 10000, &posture);
        posture.time_us = 20000;
        (void)grobo_motion_append(motion, &posture);
    }
    text.size = 0;
    (void)grobo_motion_write(motion, GROBO_FORMAT_AUTO, NULL, &(grobo_sink){take, NULL}, NULL);
    grobo_motion_free(motion);
}

static void prepare_yaml(void)
{
    prepare_file(GROBO_MOTION_FRAMES);
}

static void prepare_pseq(void)
{
    prepare_file(GROBO_MOTION_KEYS);
}

static void prepare_m(void)
{
    prepare_file(GROBO_MOTION_POSTURES);
}

static void read_file(long n)
{
    for (; n > 0; n--) {
        grobo_motion *motion = NULL;

        (void)grobo_motion_read_memory(text.data, text.size, NULL, NULL, &motion);
        grobo_motion_free(motion);
    }
}

static grobo_motion *step;

static void prepare_walk(void)
{
    if (grobo_motion_read_file("motions/step.pseq", NULL, NULL, &step) < 0) {
        fputs("bench_work: cannot read motions/step.pseq; run it in the top folder\n", stderr);
        exit(1);
    }
}

static void walk(long n)
{
    const grobo_body_options options = {GROBO_BODY_OPTIONS_INIT, .balance = GROBO_BODY_BALANCE_ON,
                                        .rate_hz = 100};

    for (; n > 0; n--) {
        grobo_body *body = NULL;
        double q_rad[GROBO_JOINTS_MAX];

        if (grobo_body_new(&grobo_i_gr001_body, step, &options, NULL, &body) >= 0) {
            for (int i = 0; i < grobo_body_frame_count(body); i++) {
                (void)grobo_body_frame(body, i, q_rad, NULL);
            }
            grobo_body_free(body);
        }
    }
}

/* ---- all of it ------------------------------------------------------------------------------ */

static const struct piece {
    const char *name, *scenario, *measure;
    void (*prepare)(void);
    void (*work)(long n);
    long n;
    double seconds; /* > 0: rows tell seconds of virtual time in a second, else ns a piece */
} pieces[] = {
    {"reading", "S1", "a reading by a job, in the engine alone, ns", prepare_reading, readings,
     100000, 0},
    {"goals", "S10", "build a pose frame, ns", prepare_codec, goals, 200000, 0},
    {"build", "S10", "build a pose frame from angles, ns", prepare_codec, build, 200000, 0},
    {"parse", "S10", "parse a pose frame, ns", prepare_codec, parse, 200000, 0},
    {"sense", "S11", "1 Hz sensing, s simulated a s", prepare_sense, seconds, 400, 1},
    {"play", "S11", "50 Hz play, s simulated a s", prepare_play, seconds, 200, 1},
    {"wire", "S11", "wire-rate sensing, s simulated a s", prepare_wire, seconds, 200, 1},
    {"poses", "S12", "simulated robots a core at 30 Hz", prepare_poses, poses, 100, 1},
    {"weight", "S16", "a step of 1 ms of 20 joints with weight, ns", prepare_weight, steps, 20000,
     0},
    {"yaml", "S9", "read 1000 frames of yaml, ns", prepare_yaml, read_file, 20, 0},
    {"pseq", "S9", "read 1000 keys of pseq, ns", prepare_pseq, read_file, 20, 0},
    {"m", "S9", "read 1000 postures of m, ns", prepare_m, read_file, 50, 0},
    {"walk", "S15", "solve step.pseq with balancer at 100 Hz, ns", prepare_walk, walk, 20, 0},
};

enum { PIECES = sizeof pieces / sizeof pieces[0], ROUNDS = 5 };

/* The one function whose instructions are counted, with what it calls. */
__attribute__((noinline)) void bench_counted(const struct piece *piece, long n);

void bench_counted(const struct piece *piece, long n)
{
    piece->work(n);
}

/* Least of several rounds. */
static double ns_each(const struct piece *piece, long n)
{
    double least_us = 0;

    for (int round = 0; round < ROUNDS; round++) {
        piece->prepare();
        const double begin_us = bench_cpu_us();
        bench_counted(piece, n);
        const double took_us = bench_cpu_us() - begin_us;

        least_us = round == 0 || took_us < least_us ? took_us : least_us;
    }
    return least_us * 1000 / (double)n;
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < PIECES; i++) {
        const struct piece *piece = &pieces[i];

        if (argc == 1) {
            double ns = ns_each(piece, piece->n);

            bench_row(piece->scenario, piece->measure, "grobo",
                      piece->seconds > 0 ? piece->seconds * 1e9 / ns : ns);
        } else if (argc == 3 && strcmp(argv[1], piece->name) == 0) {
            long n = bench_number(argv[2]);

            piece->prepare();
            bench_counted(piece, n);
            return 0;
        }
    }
    if (argc == 1) {
        silence_rows();
        joints_rows();
    }
    return argc == 1 ? 0 : 2;
}
