/* SPDX-License-Identifier: MIT */
/* A sketch as the text of a robot's file. */
#include <math.h>
#include <string.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/robot/sketch.h"

/* What strangers call something, in a comment: one line of ASCII. */
static const char *plain(const char *text)
{
    static char shown[2 * SKETCH_TEXT_BYTES];
    size_t n = 0;
    for (; *text && n < sizeof shown - 1; text++) {
        shown[n++] = (char)(*text >= ' ' && *text < 0x7f ? *text : '?');
    }
    shown[n] = '\0';
    return shown;
}

/* Without the noise of a description that was computed. */
static double tidy(double number, double noise)
{
    return fabs(number) < noise ? 0 : number;
}

static double degrees(double angle_rad)
{
    return tidy(fmod(grobo_deg_from_rad(angle_rad), 360), 1e-6);
}

static double limit(double angle_rad)
{
    return tidy(grobo_deg_from_rad(angle_rad), 1e-6);
}

/* The joint of a part of this name, that turns; NULL: none. */
static const char *joint_of(const sketch *s, const char *name)
{
    for (int i = 0; i < s->n && *name; i++) {
        if (s->part[i].motion == SKETCH_TURNS && strcmp(s->part[i].name, name) == 0) {
            return s->part[i].called;
        }
    }
    return NULL;
}

static void put_mirror(heap *to, const sketch *s, const sketch_part *part)
{
    const char *mirror = joint_of(s, part->mirror);
    if (mirror && strcmp(mirror, part->called) != 0) {
        heap_print(to, ", mirror: %s", mirror);
    }
    if (mirror && part->mirror_sign < 0) {
        heap_print(to, ", mirror_sign: -1");
    }
}

/* Limits, initial posture and speed, in degrees or millimetres. */
static void put_range(heap *to, const sketch_part *part)
{
    double speed_dps = grobo_deg_from_rad(part->speed_rad_s);
    double gear = part->gear != 0 ? fabs(part->gear) : 1;
    bool slides = part->mm_per_turn > 0;
    double one = slides ? part->mm_per_turn / 360 : 1; /* of the unit in a degree */
    const char *unit = slides ? "mm" : "deg";
    heap_print(to, ", limits_%s: [%.6g, %.6g]", unit, limit(part->limits_rad[0]) * one,
               limit(part->limits_rad[1]) * one);
    if (slides) {
        heap_print(to, ", mm_per_turn: %.6g", part->mm_per_turn);
    }
    if (part->init_rad != 0) {
        heap_print(to, ", init_%s: %.6g", unit, limit(part->init_rad) * one);
    }
    if (speed_dps >= 1 && speed_dps < 0.8 * part->servo->speed_dps / gear) {
        heap_print(to, ", speed_%s_s: %.6g", unit, speed_dps * one);
    }
}

static void put_joint(heap *to, const sketch *s, const sketch_part *part)
{
    heap_print(to, "  - {name: %s, id: %d, servo: %s", part->called, part->id, part->servo->name);
    put_range(to, part);
    if (part->zero_rad != 0) {
        heap_print(to, ", zero_deg: %.6g", limit(part->zero_rad));
    }
    double gear = part->gear != 0 ? fabs(part->gear) : 1;
    if (part->gear < 0) {
        heap_print(to, ", sign: -1");
    }
    if (gear != 1) {
        heap_print(to, ", gear: %.6g", gear);
    }
    put_mirror(to, s, part);
    heap_print(to, part->turns ? ", turns: true}" : "}");
    const char *name = *part->joint ? part->joint : part->name;
    if (strcmp(name, part->called) != 0) {
        heap_print(to, " # '%s'", plain(name));
    }
    if (part->mm_per_turn > 0) {
        heap_print(to, " # it slides; mm_per_turn is a guess: measure it");
    }
    if (*part->note) {
        heap_print(to, "%s %s", strcmp(name, part->called) != 0 ? ";" : " #", plain(part->note));
    }
    heap_print(to, "\n");
}

static void put_vector(heap *to, const char *key, const double *v)
{
    if (v[0] == 0 && v[1] == 0 && v[2] == 0) {
        return;
    }
    heap_print(to, ", %s: [%.10g, %.10g, %.10g]", key, v[0], v[1], v[2]);
}

/* Centre of mass and inertia; not one that no body has, as many descriptions have for a
 * placeholder. */
static void put_weight(heap *to, const sketch_part *part)
{
    const double *i = part->inertia_kgm2;
    double all = i[0] + i[1] + i[2], most = fmax(i[0], fmax(i[1], i[2]));
    if (part->mass_kg <= 0) {
        return;
    }
    put_vector(to, "com_m", part->com_m);
    if (fmin(i[0], fmin(i[1], i[2])) > 0 && 2 * most <= all) {
        heap_print(to, ", inertia_kgm2: [%.10g, %.10g, %.10g, %.10g, %.10g, %.10g]", i[0], i[1],
                   i[2], i[3], i[4], i[5]);
    }
}

static void put_link(heap *to, const sketch *s, const sketch_part *part)
{
    double origin_m[3], origin_deg[3], axis[3];
    double length = sqrt(part->axis[0] * part->axis[0] + part->axis[1] * part->axis[1] +
                         part->axis[2] * part->axis[2]);
    for (int k = 0; k < 3; k++) {
        origin_m[k] = tidy(part->origin_m[k], 1e-9);
        origin_deg[k] = degrees(part->origin_rad[k]);
        axis[k] = length > 0 ? tidy(part->axis[k] / length, 1e-9) : 0;
    }
    heap_print(to, "  - {name: %s", part->shown);
    if (part->above >= 0) {
        heap_print(to, ", parent: %s", s->part[part->above].shown);
    }
    if (part->motion == SKETCH_TURNS && part->mm_per_turn == 0) {
        heap_print(to, ", joint: %s", part->called);
        put_vector(to, "axis", axis);
    }
    put_vector(to, "origin_m", origin_m);
    put_vector(to, "origin_deg", origin_deg);
    if (part->mass_kg > 0) {
        heap_print(to, ", mass_kg: %.10g", part->mass_kg);
    }
    put_weight(to, part);
    heap_print(to, "}");
    if (part->motion == SKETCH_WITHOUT) {
        heap_print(to, " # taken as fixed: %s", plain(part->note));
    } else if (part->mm_per_turn > 0) {
        heap_print(to, " # slides by %s; drawn where that is 0", part->called);
    }
    heap_print(to, "\n");
}

/* The part that a foot is, or NULL. */
static const sketch_part *part_of(const sketch *s, const sketch_foot *foot)
{
    for (int i = 0; i < s->n; i++) {
        if (strcmp(s->part[i].name, foot->link) == 0) {
            return &s->part[i];
        }
    }
    return NULL;
}

/* Half of a side of a uniform plate with the mass and inertia of a part, less a tenth to be safe:
 * descriptions have no outline of a sole. `along` and `across` are about the axes of that side and
 * of the other. NAN: the part is no plate. */
static double half_of(const sketch_part *part, double along, double across)
{
    double square_m2 = 6 * (part->inertia_kgm2[2] + across - along) / part->mass_kg;
    return square_m2 > 0 ? round(0.45 * sqrt(square_m2) * 1e3) / 1e3 : NAN;
}

static void put_feet(heap *to, const sketch *s)
{
    const sketch_part *part[2] = {NULL, NULL};
    double half_m[2][2];
    for (int i = 0; i < s->n_feet; i++) {
        part[i] = part_of(s, &s->foot[i]);
        if (!part[i] || part[i]->mass_kg <= 0) {
            return;
        }
        const double *inertia = part[i]->inertia_kgm2;
        half_m[i][0] = half_of(part[i], inertia[0], inertia[1]);
        half_m[i][1] = half_of(part[i], inertia[1], inertia[0]);
        if (!(half_m[i][0] > 0 && half_m[i][1] > 0)) {
            return;
        }
    }
    for (int i = 0; i < s->n_feet; i++) {
        const double *sole_m = s->foot[i].sole_m;
        heap_print(to, "%s  - {link: %s, sole_m: [%.7g, %.7g, %.7g], half_m: [%.3g, %.3g]}\n",
                   i ? ""
                     : "\n# Sizes of the soles are those of plates that weigh as the feet.\n"
                       "feet:\n",
                   part[i]->shown, sole_m[0], sole_m[1], sole_m[2], half_m[i][0], half_m[i][1]);
    }
}

char *sketch_text(sketch *s)
{
    heap to = {0};
    heap_print(&to, "# Made by grctl of %s.\n", plain(s->source));
    heap_print(&to, "# Not known, and to be filled in (docs/guide/own-robot.md):%s%s\n",
               s->guessed_servos ? " family and servos," : "",
               s->bare ? " names, limits of the mechanics," : "");
    heap_print(&to,
               "# which way each servo turns (sign), and where its joint is at 0 (zero_deg).\n");
    heap_print(&to, "name: %s\nfamily: %s\n", s->name, s->family->name);
    if (s->baud_bps) {
        heap_print(&to, "line: {baud: %d}\n", s->baud_bps);
    }
    if (*s->usb) {
        heap_print(&to, "usb: [\"%s\"]\n", s->usb);
    }
    if (s->calibrated) {
        heap_print(&to, "calibrated: true # its servos keep offsets\n");
    }
    heap_print(&to, "\njoints:\n");
    for (int i = 0; i < s->n_joints; i++) {
        put_joint(&to, s, sketch_joint(s, i));
    }
    heap_print(&to, "\ngroups:\n  - {name: all, joints: [");
    for (int i = 0; i < s->n_joints; i++) {
        heap_print(&to, "%s%s", i ? ", " : "", sketch_joint(s, i)->called);
    }
    heap_print(&to, "]}\n");
    if (!s->bare && s->n > GROBO_ROBOT_LINKS_MAX) {
        heap_print(&to, "\n# Its %d parts are left out: a robot's file has at most %d.\n", s->n,
                   GROBO_ROBOT_LINKS_MAX);
    } else if (!s->bare) {
        heap_print(&to, "\nlinks:\n");
        for (int i = 0; i < s->n; i++) {
            put_link(&to, s, &s->part[s->along[i]]);
        }
        put_feet(&to, s);
    }
    return to.bytes;
}
