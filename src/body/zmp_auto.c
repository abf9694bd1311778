/* SPDX-License-Identifier: MIT */
/* Automatic ZMP: choreonoid-whole-body.md, section of that name. Keys are added so that the
 * desired ZMP lies under the support foot while the other swings, and under both between. */
#include <math.h>
#include <string.h>

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

enum { RIGHT = 0, LEFT = 1, BOTH = 2, NEITHER = 3, NONE = 4 };

/* A foot's keys on the way: the one that has come last, the one that had before the event, and the
 * one that comes next. A key that has not come is the first. */
struct foot {
    struct grobo_i_track *track;
    int cur, before, next;
    bool stands;
};

/* The events are the keys of both feet, in their order. The place in the list of ZMP keys goes on
 * with them, and never back: what is inserted stands behind it, whatever its time. */
struct stepping {
    grobo_body *body;
    bool compat11;
    struct foot foot[2];
    int place;        /* in the list of ZMP keys */
    double t0_s;      /* the event before */
    int phase;        /* which foot stands since t0 */
    double double_s;  /* begin of the double support after the last landing */
    int phase_single; /* which stood before that, NONE: no foot has landed */
    bool given;       /* a ZMP key stands in that double support */
};

/* Centre of the sole of a foot, at a place of a foot, on the ground: x, y, 0. */
static void place_sole(const grobo_body_model *model, int foot, const double target[6],
                       double sole_m[3])
{
    double r[9], arm[3];

    grobo_i_rotation_of_rpy(r, target + 3);
    mat_vec(arm, r, model->feet[foot].sole_m);
    vec_add_scaled(sole_m, target, 1, arm);
    sole_m[2] = 0;
}

static const double *key_of(const struct stepping *now, int foot)
{
    return grobo_i_track_row(now->foot[foot].track, now->foot[foot].cur);
}

static void sole_of(const struct stepping *now, int foot, double sole_m[3])
{
    place_sole(now->body->model, foot, key_of(now, foot), sole_m);
}

/* The mean of the soles of the feet whose key that came last stands; without one, the origin. */
static void mean_of_soles(const struct stepping *now, double at_m[3])
{
    int n = 0;

    memset(at_m, 0, 3 * sizeof *at_m);
    for (int foot = 0; foot < 2; foot++) {
        const struct foot *f = &now->foot[foot];
        double sole_m[3];

        if ((f->track->flags[f->cur] & TRACK_TOUCH) != 0) {
            sole_of(now, foot, sole_m);
            vec_add_scaled(at_m, at_m, 1, sole_m);
            n++;
        }
    }
    for (int k = 0; k < 3 && n > 0; k++) {
        at_m[k] /= n;
    }
}

/* Inserts a ZMP key before key `at`, whatever its time; the place stays at its key. */
static void add_zmp(struct stepping *now, int at, double t_s, const double at_m[3])
{
    grobo_i_track_insert(&now->body->zmp, at, t_s, at_m, TRACK_END | TRACK_ADDED);
    now->place += at <= now->place;
}

/* The foot rests: one of its keys is repeated, at another time, before the one that came last. */
static void add_rest(struct stepping *now, int foot, int key, double t_s)
{
    struct foot *f = &now->foot[foot];
    struct grobo_i_track *height = &now->body->height[foot];
    const unsigned flags = f->track->flags[key] | TRACK_AUX;
    const double z = grobo_i_track_row(f->track, key)[2];

    grobo_i_track_insert(f->track, f->cur, t_s, grobo_i_track_row(f->track, key), flags);
    if (height->n > 0) {
        grobo_i_track_insert(height, f->cur, t_s, &z, flags);
    }
    f->before += f->before >= f->cur;
    f->cur++;
    f->next++;
}

static bool away_from_sole(const struct stepping *now, const double zmp_m[3],
                           const double sole_m[3])
{
    double d[3];

    vec_add_scaled(d, zmp_m, -1, sole_m);
    const double d_m = sqrt(vec_dot(d, d));
    return now->compat11 ? d_m >= AT_SOLE_COMPAT11_M : d_m > AT_SOLE_M;
}

/* Between the soles at the keys before the event; Choreonoid has the centre of each sole at the
 * other foot there. */
static void between_soles(const struct stepping *now, double right_part, double at_m[3])
{
    double soles_m[2][3];

    for (int foot = 0; foot < 2; foot++) {
        const struct foot *f = &now->foot[foot];
        place_sole(now->body->model, foot == RIGHT ? LEFT : RIGHT,
                   grobo_i_track_row(f->track, f->before), soles_m[foot]);
    }
    for (int k = 0; k < 3; k++) {
        at_m[k] = right_part * soles_m[RIGHT][k] + (1 - right_part) * soles_m[LEFT][k];
    }
}

/* The ZMP goes to the middle during a double support before `support` alone stands. The place is at
 * the last key inserted then. */
static bool centre_zmp(struct stepping *now, int support)
{
    const double length_s = now->t0_s - now->double_s;
    const bool same = support == now->phase_single;
    const double two_keys_s = now->compat11 ? CENTRED_TWO_KEYS_COMPAT11_S
                              : same        ? CENTRED_TWO_KEYS_S
                                            : CENTRED_TWO_KEYS_STEP_S;
    double at_m[3];

    if (length_s < CENTRED_MIN_S) {
        return false;
    }
    if (length_s > two_keys_s) {
        between_soles(now, 0.5, at_m);
        add_zmp(now, now->place + 1, now->double_s + TRANSFER_S, at_m);
        add_zmp(now, now->place + 2, now->t0_s - TRANSFER_S, at_m);
        now->place += 2;
    } else if (same) {
        const double part = length_s < CENTRED_FULL_S ? 0.5 * length_s / CENTRED_FULL_S : 0.5;

        between_soles(now, support == RIGHT ? 1 - part : part, at_m);
        add_zmp(now, now->place + 1, now->double_s + 0.5 * length_s, at_m);
        now->place++;
    }
    return true;
}

/* Both -> single: the other foot swings from its key before this event. Where the ZMP key at the
 * place is later than that, the next one is half way back to it. */
static void lift(struct stepping *now, int support)
{
    const int swing = support == RIGHT ? LEFT : RIGHT;
    const struct foot *f = &now->foot[swing];
    const struct grobo_i_track *zmp = &now->body->zmp;
    const bool centred = !now->given && centre_zmp(now, support);
    const double s0_s = f->track->t_s[f->before], s1_s = f->track->t_s[f->cur];
    const double z0_s = zmp->t_s[now->place];
    double sole_m[3];

    sole_of(now, support, sole_m);
    if (!away_from_sole(now, grobo_i_track_row(zmp, now->place), sole_m)) {
        return;
    }
    if (!centred && s0_s - z0_s < TRANSFER_S) {
        const double a_s = fmin(z0_s + TRANSFER_S, (s0_s + s1_s) / 2);

        add_zmp(now, now->place + 1, fmax(a_s, (z0_s + a_s) / 2), sole_m);
        add_rest(now, swing, f->before, a_s);
    } else {
        add_zmp(now, now->place + 1, fmax(s0_s, (z0_s + s0_s) / 2), sole_m);
    }
}

/* Single -> both: the other foot lands with its key of this event. Only a ZMP key at that very time
 * can be at the sole already. */
static void land(struct stepping *now, int support, double t_s)
{
    const int swing = support == RIGHT ? LEFT : RIGHT;
    const struct foot *f = &now->foot[swing];
    const struct grobo_i_track *zmp = &now->body->zmp;
    int z1 = now->place;
    double sole_m[3];

    while (z1 < zmp->n && zmp->t_s[z1] < t_s) {
        z1++;
    }
    sole_of(now, support, sole_m);
    if (z1 < zmp->n && zmp->t_s[z1] == t_s &&
        !away_from_sole(now, grobo_i_track_row(zmp, z1), sole_m)) {
        return;
    }
    const double s0_s = f->track->t_s[f->before], s1_s = f->track->t_s[f->cur];

    if (z1 < zmp->n && zmp->t_s[z1] - s1_s < TRANSFER_S) {
        const double a_s = fmax(zmp->t_s[z1] - TRANSFER_S, (s0_s + s1_s) / 2);

        add_zmp(now, z1, a_s, sole_m);
        add_rest(now, swing, f->cur, a_s);
    } else {
        add_zmp(now, z1, s1_s, sole_m);
    }
}

/* The key of a foot that comes next, of both where they come at a time. @return false: none. */
static bool next_event(struct stepping *now, double *t_s)
{
    bool comes[2];
    double at_s[2];

    for (int foot = 0; foot < 2; foot++) {
        const struct foot *f = &now->foot[foot];
        comes[foot] = f->next < f->track->n;
        at_s[foot] = comes[foot] ? f->track->t_s[f->next] : INFINITY;
    }
    for (int foot = 0; foot < 2; foot++) {
        struct foot *f = &now->foot[foot];
        if (comes[foot] && at_s[foot] <= at_s[1 - foot]) {
            f->cur = f->next++;
            f->stands = (f->track->flags[f->cur] & TRACK_TOUCH) != 0;
            *t_s = at_s[foot];
        }
    }
    return comes[RIGHT] || comes[LEFT];
}

static int phase_of(const struct stepping *now)
{
    const bool right = now->foot[RIGHT].stands, left = now->foot[LEFT].stands;

    return right && left ? BOTH : right ? RIGHT : left ? LEFT : NEITHER;
}

/* The last ZMP key, from the place on, before the first that is later than the event before. */
static void move_place(struct stepping *now)
{
    const struct grobo_i_track *zmp = &now->body->zmp;

    while (now->place + 1 < zmp->n && zmp->t_s[now->place + 1] <= now->t0_s) {
        now->place++;
    }
}

static void take_event(struct stepping *now, int phase, double t_s)
{
    const bool single = phase == RIGHT || phase == LEFT;
    const bool was_single = now->phase == RIGHT || now->phase == LEFT;

    if (now->phase == BOTH) {
        now->given = now->given || now->body->zmp.t_s[now->place] > now->double_s;
        if (single) {
            lift(now, phase);
        }
    } else if (phase == BOTH && was_single) {
        land(now, now->phase, t_s);
        now->phase_single = now->phase;
        now->double_s = t_s;
        now->given = false;
    }
}

void grobo_i_zmp_auto(grobo_body *body)
{
    struct stepping now = {.body = body, .phase = NONE, .phase_single = NONE};
    double t_s = 0, at_m[3];

    now.compat11 = body->options.balance == GROBO_BODY_BALANCE_COMPAT11;
    for (int foot = 0; foot < 2; foot++) {
        now.foot[foot] =
            (struct foot){.track = &body->target[GROBO_I_RIGHT + foot], .stands = true};
        if (now.foot[foot].track->n == 0) {
            return;
        }
    }
    if (body->zmp.n == 0) {
        mean_of_soles(&now, at_m);
        add_zmp(&now, 0, 0, at_m);
        now.place = 0;
    }
    while (next_event(&now, &t_s)) {
        const int phase = phase_of(&now);

        move_place(&now);
        take_event(&now, phase, t_s);
        now.phase = phase;
        now.t0_s = t_s;
        now.foot[RIGHT].before = now.foot[RIGHT].cur;
        now.foot[LEFT].before = now.foot[LEFT].cur;
    }
    move_place(&now);
    if (now.place + 1 == body->zmp.n) {
        mean_of_soles(&now, at_m);
        add_zmp(&now, body->zmp.n, now.t0_s + TRANSFER_S, at_m);
    }
}
