/* SPDX-License-Identifier: MIT */
/* Automatic ZMP: choreonoid-whole-body.md, section of that name. Keys are added so that the
 * desired ZMP lies under the support foot while the other swings, and under both between. */
#include "src/body/body.h"
#include "src/body/vec.h"

/* The ZMP needs this long from one sole to the next. */
#define TRANSFER_S 0.1
#define CENTRED_MIN_S 0.03
#define CENTRED_TWO_KEYS_S 0.2
#define CENTRED_TWO_KEYS_STEP_S 0.4
#define CENTRED_TWO_KEYS_COMPAT11_S 0.6
#define CENTRED_FULL_S 0.12
#define AT_SOLE_M 0.02
#define AT_SOLE_COMPAT11_M 0.005

enum { RIGHT = 0, LEFT = 1, BOTH = 2, NEITHER = 3 };

struct stepping {
    grobo_body *body;
    bool compat11;
    double t0_s;      /* the foot event before */
    double double_s;  /* b0: begin of the double support */
    int phase;        /* which foot stands since t0 */
    int phase_single; /* which stood before the double support, NEITHER: none */
};

static struct grobo_i_track *foot_track(const struct stepping *now, int foot)
{
    return &now->body->target[GROBO_I_RIGHT + foot];
}

/* Last authored key of a foot at or before a time, -1: none. */
static int foot_key(const struct stepping *now, int foot, double t_s)
{
    const struct grobo_i_track *track = foot_track(now, foot);
    int i = grobo_i_track_find(track, t_s);

    while (i >= 0 && (track->flags[i] & TRACK_AUX) != 0) {
        i--;
    }
    return i;
}

static int phase_at(const struct stepping *now, double t_s)
{
    bool stands[2];

    for (int foot = 0; foot < 2; foot++) {
        const int i = foot_key(now, foot, t_s);

        stands[foot] = i < 0 || (foot_track(now, foot)->flags[i] & TRACK_TOUCH) != 0;
    }
    if (stands[RIGHT] && stands[LEFT]) {
        return BOTH;
    }
    return stands[RIGHT] ? RIGHT : stands[LEFT] ? LEFT : NEITHER;
}

/* Centre of a sole at a place of its foot, on the ground: x, y, 0. */
static void place_sole(const grobo_body_model *model, int foot, const double target[6],
                       double sole_m[3])
{
    double r[9], arm[3];

    grobo_i_rotation_of_rpy(r, target + 3);
    mat_vec(arm, r, model->feet[foot].sole_m);
    vec_add_scaled(sole_m, target, 1, arm);
    sole_m[2] = 0;
}

/* Sole of a foot at a time, by its last key. False if it has no key. */
static bool sole_at(const struct stepping *now, int foot, double t_s, double sole_m[3])
{
    const struct grobo_i_track *track = foot_track(now, foot);
    const int i = foot_key(now, foot, t_s);

    if (track->n == 0) {
        return false;
    }
    place_sole(now->body->model, foot, grobo_i_track_row(track, i < 0 ? 0 : i), sole_m);
    return true;
}

/* Between the soles, left_part of the way from the right one; one sole where only one stands. */
static bool between_soles(const struct stepping *now, double t_s, double left_part, double at_m[3])
{
    const int phase = phase_at(now, t_s);
    double right[3], left[3];
    const bool has_right = phase != LEFT && sole_at(now, RIGHT, t_s, right);
    const bool has_left = phase != RIGHT && sole_at(now, LEFT, t_s, left);

    if (!has_right && !has_left) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        at_m[k] = !has_right  ? left[k]
                  : !has_left ? right[k]
                              : (1 - left_part) * right[k] + left_part * left[k];
    }
    return true;
}

/* Inserts a ZMP key before key `at`, whatever its time. */
static void add_zmp(const struct stepping *now, int at, double t_s, const double at_m[3])
{
    grobo_i_track_insert(&now->body->zmp, at, t_s, at_m, TRACK_END | TRACK_ADDED);
}

/* The foot rests: key i of its track is repeated at another time, auxiliary. */
static void add_rest(const struct stepping *now, int foot, int i, double t_s)
{
    struct grobo_i_track *track = foot_track(now, foot);
    struct grobo_i_track *height = &now->body->height[foot];
    const unsigned flags = track->flags[i] | TRACK_AUX;
    const double z = grobo_i_track_row(track, i)[2];

    grobo_i_track_add(track, t_s, grobo_i_track_row(track, i), flags);
    if (height->n > 0) {
        grobo_i_track_add(height, t_s, &z, flags);
    }
}

static double distance_m(const double a[3], const double b[3])
{
    return hypot(a[0] - b[0], a[1] - b[1]);
}

static bool away_from_sole(const struct stepping *now, const double zmp_m[3],
                           const double sole_m[3])
{
    const double d = distance_m(zmp_m, sole_m);

    return now->compat11 ? d >= AT_SOLE_COMPAT11_M : d > AT_SOLE_M;
}

/* Whether the author gave a ZMP after the double support began, up to key z0. */
static bool author_gave_zmp(const struct stepping *now, int z0)
{
    const struct grobo_i_track *zmp = &now->body->zmp;

    for (int i = z0; i >= 0 && zmp->t_s[i] > now->double_s; i--) {
        if ((zmp->flags[i] & TRACK_ADDED) == 0) {
            return true;
        }
    }
    return false;
}

/* The ZMP goes to the middle during a double support before `support` alone stands. Keys are
 * inserted behind z0, which becomes the last of them. */
static bool centre_zmp(const struct stepping *now, int support, int *z0)
{
    const double length_s = now->t0_s - now->double_s;
    const bool same = support == now->phase_single;
    const double two_keys_s = now->compat11 ? CENTRED_TWO_KEYS_COMPAT11_S
                              : same        ? CENTRED_TWO_KEYS_S
                                            : CENTRED_TWO_KEYS_STEP_S;
    double at_m[3];

    if (length_s < CENTRED_MIN_S || author_gave_zmp(now, *z0)) {
        return false;
    }
    if (length_s > two_keys_s) {
        if (between_soles(now, now->double_s, 0.5, at_m)) {
            add_zmp(now, ++*z0, now->double_s + TRANSFER_S, at_m);
            add_zmp(now, ++*z0, now->t0_s - TRANSFER_S, at_m);
        }
    } else if (same) {
        const double part = length_s < CENTRED_FULL_S ? 0.5 * length_s / CENTRED_FULL_S : 0.5;

        if (between_soles(now, now->double_s, support == RIGHT ? 1 - part : part, at_m)) {
            add_zmp(now, ++*z0, now->double_s + 0.5 * length_s, at_m);
        }
    }
    return true;
}

/* Both -> single: the other foot swings from its key before t1. Choreonoid keeps its place in the
 * list of ZMP keys and inserts behind it. Where every key comes after the last event that place is
 * the first key, and what is inserted has an earlier time than the key before it. */
static void lift(const struct stepping *now, int support, double t1_s)
{
    const int swing = support == RIGHT ? LEFT : RIGHT;
    const struct grobo_i_track *track = foot_track(now, swing);
    const struct grobo_i_track *zmp = &now->body->zmp;
    const int k1 = foot_key(now, swing, t1_s);
    const int found = grobo_i_track_find(zmp, now->t0_s);
    int z0 = found < 0 ? 0 : found;
    double sole_m[3];

    if (zmp->n == 0) {
        return;
    }
    const bool centred = centre_zmp(now, support, &z0);

    if (k1 < 1 || !sole_at(now, support, now->t0_s, sole_m) ||
        !away_from_sole(now, grobo_i_track_row(zmp, z0), sole_m)) {
        return;
    }
    const int k0 = k1 - 1;
    const double s0_s = track->t_s[k0];

    if (!centred && s0_s - zmp->t_s[z0] < TRANSFER_S) {
        const double a_s = fmin(zmp->t_s[z0] + TRANSFER_S, 0.5 * (s0_s + track->t_s[k1]));

        add_zmp(now, z0 + 1, a_s, sole_m);
        add_rest(now, swing, k0, a_s);
    } else {
        add_zmp(now, z0 + 1, s0_s, sole_m);
    }
}

/* Single -> both: the other foot lands with its key at t1. */
static void land(const struct stepping *now, int support, double t1_s)
{
    const int swing = support == RIGHT ? LEFT : RIGHT;
    const struct grobo_i_track *track = foot_track(now, swing);
    const struct grobo_i_track *zmp = &now->body->zmp;
    const int k1 = foot_key(now, swing, t1_s);
    int z1 = grobo_i_track_find(zmp, t1_s) + 1;
    double sole_m[3];

    if (k1 < 1 || !sole_at(now, support, t1_s, sole_m)) {
        return;
    }
    while (z1 > 0 && zmp->from_s[z1 - 1] >= t1_s) {
        z1--;
    }
    if (z1 >= zmp->n) {
        add_zmp(now, z1, t1_s, sole_m);
        return;
    }
    if (!away_from_sole(now, grobo_i_track_row(zmp, z1), sole_m)) {
        return;
    }
    if (zmp->t_s[z1] - t1_s < TRANSFER_S) {
        const double a_s = fmax(zmp->t_s[z1] - TRANSFER_S, 0.5 * (track->t_s[k1 - 1] + t1_s));

        add_zmp(now, z1, a_s, sole_m);
        add_rest(now, swing, k1, a_s);
    } else {
        add_zmp(now, z1, t1_s, sole_m);
    }
}

/* The next time, from key `from` of each foot on, at which its author gave a foot a key. */
static bool next_event(const struct stepping *now, const int from[2], double *t_s)
{
    bool found = false;

    for (int foot = 0; foot < 2; foot++) {
        const struct grobo_i_track *track = foot_track(now, foot);
        int i = from[foot];

        while (i < track->n && (track->flags[i] & TRACK_AUX) != 0) {
            i++;
        }
        if (i < track->n && (!found || track->t_s[i] < *t_s)) {
            *t_s = track->t_s[i];
            found = true;
        }
    }
    return found;
}

static bool event_after(const struct stepping *now, double *t_s)
{
    const int from[2] = {grobo_i_track_find(foot_track(now, RIGHT), *t_s) + 1,
                         grobo_i_track_find(foot_track(now, LEFT), *t_s) + 1};

    return next_event(now, from, t_s);
}

static void begin(struct stepping *now)
{
    double at_m[3];

    now->phase = phase_at(now, now->t0_s);
    now->phase_single = now->phase == BOTH ? NEITHER : now->phase;
    now->double_s = now->t0_s;
    if (now->body->zmp.n == 0 && between_soles(now, 0, 0.5, at_m)) {
        add_zmp(now, 0, 0, at_m);
    }
}

static void end(const struct stepping *now)
{
    const struct grobo_i_track *zmp = &now->body->zmp;
    double at_m[3];

    if (grobo_i_track_find(zmp, now->t0_s) == zmp->n - 1 &&
        between_soles(now, now->t0_s, 0.5, at_m)) {
        add_zmp(now, zmp->n, now->t0_s + TRANSFER_S, at_m);
    }
}

void grobo_i_zmp_auto(grobo_body *body)
{
    static const int start[2] = {0, 0};
    struct stepping now = {.body = body};
    double t_s = 0;

    now.compat11 = body->options.balance == GROBO_BODY_BALANCE_COMPAT11;
    if (!next_event(&now, start, &t_s)) {
        return;
    }
    now.t0_s = t_s;
    begin(&now);
    while (event_after(&now, &t_s)) {
        const int phase = phase_at(&now, t_s);

        if (now.phase == BOTH && (phase == RIGHT || phase == LEFT)) {
            lift(&now, phase, t_s);
            now.phase_single = phase;
        } else if (now.phase != BOTH && phase == BOTH) {
            if (now.phase != NEITHER) {
                land(&now, now.phase, t_s);
            }
            now.double_s = t_s;
        }
        now.phase = phase;
        now.t0_s = t_s;
    }
    end(&now);
}
