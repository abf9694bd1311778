/* SPDX-License-Identifier: MIT */
/*
 * A restless user on a bad line: random requests of every kind (support/restless.h) under faults
 * of every kind, with the rules of safety held at every frame, reading and move:
 *   - no goal outside limits, none faster than its joint from where the joint is;
 *   - no torque comes on away from the joint's present angle and the servo's goal;
 *   - no reading that is not the joint's own, given after it was asked for, taken once;
 *   - a stop is reached within its bound, and nothing moves after it;
 *   - no raw frame leaves after its job ended, or after a stop;
 *   - each job ends once, with a named result, within its bound; a refused request sends nothing;
 *   - nothing moves because a line is back.
 * The rules are in support/judge.h, support/witness.h and support/rig.h. All of them hold on every
 * line. Two like flips pass the sum of a packet: the witness knows of each such packet, and only
 * that one joint is excused, until it is read again.
 *
 * Of the seeds and lines half have weight: the shafts sag, lag and swing.
 *
 * Each seed and line is a test of its own, of four parts: both wirings, and servos that run to
 * their goal when torque comes on or stay where they are. A test that fails prints the command
 * that repeats it and the last frames.
 *
 * Environment (make soak sets it): GROBO_SOAK=6 seeds of half an hour for each line,
 * GROBO_SOAK_FROM the first of them, GROBO_SOAK_LINE one line alone, GROBO_SOAK_MINUTES another
 * length. Without GROBO_SOAK: seed 0, a minute for each line.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/robot_file.h>

#include "tests/support/restless.h"
#include "tests/support/test.h"

#define REPLIES "duplicate=0.01,delay=0.01,split=0.01,rubbish=0.01,silent=0.01,dupid=0.01"

/* A line without faults, every kind of fault alone, so that the robot gets on with what it is
 * asked for; then together. */
static const char *const lines[] = {
    "drop=0",
    "drop=0.01",
    "flip=0.01",
    "duplicate=0.01",
    "delay=0.01",
    "split=0.01",
    "rubbish=0.01",
    "silent=0.01",
    "dupid=0.01",
    "hangup=0.01",
    "brownout=0.01",
    "hangup=0.001,brownout=0.001",
    REPLIES,
    REPLIES ",hangup=0.001,brownout=0.001",
    "all=0.001,hangup=0.001",
    "all=0.01,brownout=0.001",
    "all=0.01,hangup=0.01",
};

enum { LINES = sizeof lines / sizeof lines[0], PARTS = 4, SEEDS_MAX = 1000 };

typedef struct run {
    uint32_t seed;
    int line;
    char name[120];
} run;

static grobo_test_rig rig;
static restless user;
static grobo_sim_physics *physics; /* of a seed with weight, else NULL */
static run runs[SEEDS_MAX * LINES];
static size_t n_runs;
static bool is_one_line; /* of runs */
static uint32_t minutes = 1;

/* What all runs together came to. */
static struct {
    unsigned runs, torque_on, ruined, excused, rests, estops, exits, jobs, raws_void;
    unsigned made_up_commands, made_up_replies, made_up_believed, doubled, late;
    uint64_t frames, believed, injected[GROBO_SIM_FAULTS];
    int64_t virtual_us, estop_us, exit_us; /* the longest */
} total;

static void most(int64_t *worst_us, int64_t us)
{
    *worst_us = us > *worst_us ? us : *worst_us;
}

static void add_up(void)
{
    const judge *w = &user.judge;
    total.frames += rig.frames;
    total.torque_on += rig.torque_on;
    total.believed += rig.witness.believed;
    total.ruined += rig.witness.settings_hit;
    total.made_up_commands += rig.witness.made_up_commands;
    total.made_up_replies += rig.witness.made_up_replies;
    total.made_up_believed += rig.witness.made_up_believed;
    total.doubled += rig.witness.doubled;
    total.late += rig.witness.late;
    total.excused += rig.excused + w->excused;
    total.rests += w->rests;
    total.estops += w->estops;
    total.exits += w->exits;
    total.jobs += w->jobs_ended;
    total.raws_void += w->raws_void;
    most(&total.estop_us, w->estop_worst_us);
    most(&total.exit_us, w->exit_worst_us);
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        total.injected[i] += rig.sim.stats.injected[i];
    }
}

/* ---- a run ----------------------------------------------------------------------------------- */

static void start(const run *r, int part, uint32_t random)
{
    static const int64_t intervals_us[] = {1, 150000, 300000, GROBO_SENSE_NEVER};
    uint32_t variant = r->seed + (uint32_t)r->line;
    const char *faults = lines[r->line];
    grobo_robot_config config = {GROBO_ROBOT_CONFIG_INIT,
                                 .sense_interval_us = intervals_us[(variant + (unsigned)part) % 4],
                                 .accept_unknown_raw = part == 2,
                                 .limit_policy = variant % 3 == 0 ? GROBO_LIMIT_CLAMP : 0,
                                 .estop_torque = variant % 2 == 0 ? GROBO_ESTOP_OFF : 0,
                                 .lost_replies = 30};
    grobo_sim_config sim = {GROBO_SIM_CONFIG_INIT, .seed = random, .start = GROBO_SIM_START_LIMP,
                            .jump_on_torque = part >= 2};
    grobo_sim_physics_free(physics);
    physics = NULL;
    if (variant % 2 == 1) { /* half of the runs have weight */
        assert_int_equal(
            grobo_robot_def_physics(grobo_robot_def_find("gr001"), false, NULL, &physics), 0);
        sim.physics = physics;
    }
    rig_start_driver(&rig,
                     grobo_gr001_driver(part % 2 == 0 ? GROBO_WIRING_BOARD : GROBO_WIRING_BUS),
                     &config, &sim);
    rig.replug_us = 50000;
    assert_true(grobo_sim_set_faults(&rig.sim, faults, strlen(faults)) > 0);
    restless_start(&user, &rig, random);
}

static uint32_t number(const char *name, uint32_t otherwise)
{
    const char *text = getenv(name);
    return text != NULL && text[0] != '\0' ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

/* As the environment wants them. */
static void make_runs(void)
{
    bool is_long = getenv("GROBO_SOAK") != NULL;
    uint32_t seeds = number("GROBO_SOAK", 1);
    uint32_t first = number("GROBO_SOAK_FROM", is_long ? 0 : 1);
    uint32_t only = number("GROBO_SOAK_LINE", LINES);
    is_one_line = only < LINES;
    minutes = number("GROBO_SOAK_MINUTES", is_long ? 30 : 1);
    for (uint32_t seed = first; seed < first + (seeds < SEEDS_MAX ? seeds : SEEDS_MAX); seed++) {
        for (int line = 0; line < LINES; line++) {
            if (is_one_line && (int)only != line) {
                continue;
            }
            run *r = &runs[n_runs++];
            r->seed = seed;
            r->line = line;
            (void)snprintf(r->name, sizeof r->name, "seed %u, line %d: %s", (unsigned)seed, line,
                           lines[line]);
        }
    }
}

static const run *next_run(const run *before)
{
    if (n_runs == 0) {
        make_runs();
    }
    const run *next = before == NULL ? runs : before + 1;
    return next < runs + n_runs ? next : NULL;
}

static void tell(const void *row)
{
    const run *r = row;
    print_message("# A rule is broken at %.6f s, %s wiring%s. The last frames and requests:\n",
                  (double)rig.now_us / 1e6,
                  grobo_driver_wiring(rig.driver) == GROBO_WIRING_BOARD ? "board" : "bus",
                  rig.sim.config.jump_on_torque ? ", servos that jump" : "");
    chronicle_print(&user.judge.notes);
    print_message("# It is repeated by: make soak SEEDS=1 FROM=%u LINE=%d MINUTES=%u\n",
                  (unsigned)r->seed, r->line, (unsigned)minutes);
}

/* A robot that the line gave another id is followed by a new one. */
TEST_FOR(run, next_run, rules_hold)
{
    test_if_it_breaks(tell);
    int64_t part_us = minutes * 60000000LL / PARTS;
    uint32_t random = (row->seed * 100 + (uint32_t)row->line) * 2654435761u + 17;
    for (int part = 0; part < PARTS; part++) {
        for (int64_t left_us = part_us; left_us > 0;) {
            start(row, part, random);
            int64_t lived_us = restless_live(&user, left_us);
            random = user.random;
            left_us -= lived_us;
            total.virtual_us += lived_us;
            add_up();
        }
    }
    total.runs++;
}

/* ---- all of them ----------------------------------------------------------------------------- */

static void report(void)
{
    print_message("# %u runs, %.0f virtual minutes: no rule broken\n", total.runs,
                  (double)total.virtual_us / 60e6);
    print_message("# %llu frames sent, %llu readings believed, each given by its own servo\n",
                  (unsigned long long)total.frames, (unsigned long long)total.believed);
    print_message("# faults:");
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        print_message(" %s %llu", grobo_sim_fault_name(i), (unsigned long long)total.injected[i]);
    }
    print_message("\n# requests accepted of those made:");
    for (int i = 0; i < RESTLESS_KINDS; i++) {
        print_message(" %s %u/%u", restless_name(i), user.accepted[i], user.asked[i]);
    }
    print_message("\n# %u bursts from callbacks; %u jobs ended, %u moves and %u plays done, %u "
                  "torques on, %u trips, %u robots ruined\n",
                  user.in_callbacks, total.jobs, user.moves, user.plays, total.torque_on,
                  user.trips, total.ruined);
    print_message("# %u stops at rest, %u raw frames taken back; %u emergency stops seen through, "
                  "after %.1f s at most; %u exits, %.1f s\n",
                  total.rests, total.raws_void, total.estops, (double)total.estop_us / 1e6,
                  total.exits, (double)total.exit_us / 1e6);
    print_message("# made up by the line with a sum that is right: %u commands, %u replies (%u "
                  "believed); %u replies believed twice, %u later than is told apart; %u goals and "
                  "torques excused by lost or made-up frames\n",
                  total.made_up_commands, total.made_up_replies, total.made_up_believed,
                  total.doubled, total.late, total.excused);
}

/* It was a soak and not a stall. */
TEST(everything_was_done)
{
    if (total.runs < n_runs) {
        skip(); /* not all of it was asked for, or it has failed */
    }
    report();
    assert_true(total.believed > 1000 * minutes * total.runs);
    if (is_one_line) {
        return; /* one line alone may be without the rarest things */
    }
    assert_true(user.moves > 0 && user.plays > 0 && total.torque_on > 0 && user.in_callbacks > 0);
    assert_true(total.rests > 0 && total.estops > 0 && total.exits > 0);
    assert_true(total.raws_void > 0 || minutes < 30); /* the rarest: a minute may be without */
    for (int i = 0; i < RESTLESS_KINDS; i++) {
        if (user.accepted[i] == 0) {
            fail_msg("no request '%s' was ever accepted", restless_name(i));
        }
    }
    for (int i = 0; i < GROBO_SIM_FAULTS; i++) {
        assert_true(total.injected[i] > 0);
    }
}
