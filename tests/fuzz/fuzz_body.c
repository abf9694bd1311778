/* SPDX-License-Identifier: MIT */
/* Key poses with legs given by targets, from any bytes: they are refused, or every frame has
 * finite angles and every finding of the lint lies within the motion. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/body.h>

#include "tests/fuzz/target.h"
#include "tests/support/tables.h"

enum { KEYS_MAX = 16, TARGETS = 3, JOINTS = 20, FRAMES_MAX = 300 };

struct bytes {
    const uint8_t *data;
    size_t left;
};

struct keys {
    grobo_body_key key[KEYS_MAX];
    grobo_body_target target[KEYS_MAX][TARGETS];
    double q_rad[KEYS_MAX][JOINTS];
};

static unsigned next_byte(struct bytes *bytes)
{
    if (bytes->left == 0) {
        return 0;
    }
    bytes->left--;
    return *bytes->data++;
}

/* A number of the size that is usual, or with 255 any double at all. */
static double next_number(struct bytes *bytes, double middle, double step)
{
    const unsigned byte = next_byte(bytes);
    uint64_t bits = 0;
    double number;

    if (byte != 255) {
        return middle + step * ((double)byte - 127);
    }
    for (int i = 0; i < 8; i++) {
        bits = bits << 8 | next_byte(bytes);
    }
    memcpy(&number, &bits, sizeof number);
    return number;
}

static void next_target(struct bytes *bytes, int which, grobo_body_target *target)
{
    static const int links[TARGETS] = {0, 6, 12};
    const double turn = next_number(bytes, 0, 0.05);
    const double c = cos(turn), s = sin(turn);
    const unsigned flags = next_byte(bytes);
    const double about_y[9] = {c, 0, s, 0, 1, 0, -s, 0, c};
    const double about_z[9] = {c, -s, 0, s, c, 0, 0, 0, 1};

    target->link = flags & 64 ? (int)next_byte(bytes) - 10 : links[which];
    target->at.p_m[0] = next_number(bytes, which == 0 ? 0 : 0.0252, 0.0005);
    target->at.p_m[1] = next_number(bytes, which == 0 ? 0 : which == 1 ? -0.0196 : 0.0196, 0.0005);
    target->at.p_m[2] = next_number(bytes, which == 0 ? 0.145 : 0.02115, 0.0003);
    memcpy(target->at.r, flags & 32 ? about_z : about_y, sizeof about_y);
    target->base = (flags & 1) != 0;
    target->stationary = (flags & 2) != 0;
    target->touching = (flags & 4) != 0;
    target->slave = (flags & 8) != 0;
}

static void next_key(struct bytes *bytes, struct keys *keys, size_t n, double before_s)
{
    grobo_body_key *key = &keys->key[n];
    const unsigned what = next_byte(bytes);

    key->time_s = before_s + next_number(bytes, 0.4, 0.004);
    key->max_transition_s = what & 1 ? next_number(bytes, 0.2, 0.002) : 0;
    key->q_rad = keys->q_rad[n];
    key->targets = keys->target[n];
    for (int which = 0; which < TARGETS; which++) {
        if ((what >> (1 + which) & 1) != 0) {
            next_target(bytes, which, &keys->target[n][key->n_targets++]);
        }
    }
    for (unsigned left = what >> 6; left > 0; left--) {
        const unsigned joint = next_byte(bytes);

        key->joints |= GROBO_JOINT_BIT(joint % JOINTS);
        key->stationary |= joint & 128 ? GROBO_JOINT_BIT(joint % JOINTS) : 0;
        keys->q_rad[n][joint % JOINTS] = next_number(bytes, 0, 0.02);
    }
    key->has_zmp = (what & 16) != 0;
    key->zmp_stationary = (what & 32) != 0;
    for (int k = 0; k < 3 && key->has_zmp; k++) {
        key->zmp_m[k] = next_number(bytes, 0, 0.0005);
    }
}

static void see_finding(void *ctx, const grobo_body_finding *finding)
{
    const int *frames = ctx;

    MUST(*frames > 0 && finding->begin_s <= finding->worst_s && finding->worst_s <= finding->end_s);
}

static void play(grobo_body *body)
{
    int frames = grobo_body_frame_count(body);
    const grobo_body_check_options checks = {GROBO_BODY_CHECK_OPTIONS_INIT,
                                             .robot = &grobo_i_gr001_model, .finding = see_finding,
                                             .ctx = &frames, .falls = frames < 100};

    for (int i = 0; i < frames; i++) {
        double q_rad[GROBO_JOINTS_MAX];
        grobo_body_report report;

        MUST(grobo_body_frame(body, i, q_rad, &report) == 0);
        for (int j = 0; j < JOINTS; j++) {
            MUST(isfinite(q_rad[j]));
        }
        MUST(isfinite(report.root.p_m[0]) && isfinite(report.root.r[8]));
    }
    MUST(grobo_body_check(body, &checks) >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct keys keys;
    struct bytes bytes = {data, size};
    grobo_body_setup setup = {.model = &grobo_i_gr001_body, .keys = keys.key};
    grobo_body *body = NULL;
    size_t needed = 0;

    memset(&keys, 0, sizeof keys);
    const unsigned how = next_byte(&bytes);

    setup.options.ik = (grobo_body_ik)(how % 3);
    setup.options.step = (grobo_body_step)(how >> 2 & 1);
    setup.options.zmp = (grobo_body_zmp_source)(how >> 3 & 1);
    setup.options.balance = (grobo_body_balance)((how >> 4) % 3);
    setup.options.rate_hz = next_number(&bytes, 14, 0.1);
    while (bytes.left > 0 && setup.n_keys < KEYS_MAX) {
        const double before_s = setup.n_keys > 0 ? keys.key[setup.n_keys - 1].time_s : 0;

        next_key(&bytes, &keys, setup.n_keys, before_s);
        setup.n_keys++;
    }
    if (grobo_body_workspace_bytes(&setup, &needed) < 0 || needed > 1u << 17) {
        return 0;
    }
    void *workspace = malloc(needed);

    MUST(workspace != NULL);
    MUST(grobo_body_init(&setup, workspace, needed, &body) == 0);
    if (grobo_body_frame_count(body) <= FRAMES_MAX) {
        play(body);
    }
    free(workspace);
    return 0;
}
