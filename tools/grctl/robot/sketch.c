/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/sketch.h"

enum { NAME_MAX_BYTES = GROBO_NAME_MAX_BYTES - 8 /* room for a number behind it */ };

/* Beside what a servo reaches: its ends are a count or two away. */
#define SPARE_DEG 0.5

sketch_part *sketch_add(sketch *s)
{
    if (s->n == SKETCH_PARTS_MAX) {
        return NULL;
    }
    sketch_part *part = &s->part[s->n++];
    memset(part, 0, sizeof *part);
    part->axis[0] = 1;
    part->above = -1;
    part->order = SKETCH_PARTS_MAX;
    return part;
}

int sketch_joints(const sketch *s)
{
    return s->n_joints;
}

sketch_part *sketch_joint(sketch *s, int i)
{
    return i < s->n_joints ? &s->part[s->joints[i]] : NULL;
}

/* ---- names ---------------------------------------------------------------------------------- */

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* As the reader of robot files wants it: not j3 or m12, which are numbers of joints and motors. */
static void make_name(const char *from, const char *prefix, char *to)
{
    size_t digits = strspn(from[0] ? from + 1 : from, "0123456789");
    bool number = from[0] && strchr("mMjJ", from[0]) && digits > 0 && !from[1 + digits];
    size_t n = 0;
    to[0] = '\0';
    if (!is_letter(from[0]) || number) {
        n = (size_t)snprintf(to, NAME_MAX_BYTES, "%s", prefix);
    }
    for (; *from && n < NAME_MAX_BYTES; from++) {
        bool fits = is_letter(*from) || is_digit(*from) || *from == '.' || *from == '-';
        to[n++] = fits ? *from : '_';
    }
    to[n] = '\0';
}

static bool same_name(const char *a, const char *b)
{
    for (; *a && *b; a++, b++) {
        char x = *a >= 'A' && *a <= 'Z' ? (char)(*a - 'A' + 'a') : *a;
        char y = *b >= 'A' && *b <= 'Z' ? (char)(*b - 'A' + 'a') : *b;
        if (x != y) {
            return false;
        }
    }
    return *a == *b;
}

/* A number behind it where one before it is called so; the group of all joints is one. */
static void make_unique(const sketch *s, const int *list, int before, bool joints, char *name)
{
    size_t length = strlen(name);
    for (int i = joints ? -1 : 0, number = 2; i < before; i++) {
        const sketch_part *other = i < 0 ? NULL : &s->part[list[i]];
        if (same_name(name, !other ? "all" : joints ? other->called : other->shown)) {
            snprintf(name + length, GROBO_NAME_MAX_BYTES - length, "_%d", number++);
            i = joints ? -2 : -1; /* once more from the first */
        }
    }
}

/* ---- order ---------------------------------------------------------------------------------- */

static int find_part(const sketch *s, const char *name)
{
    for (int i = 0; i < s->n; i++) {
        if (strcmp(s->part[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

/* Sets `above`. Returns the first part, or -1 with the complaint. */
static int find_parents(sketch *s, char *complaint, size_t capacity)
{
    int first = -1;
    for (int i = 0; i < s->n; i++) {
        sketch_part *part = &s->part[i];
        if (find_part(s, part->name) != i) {
            snprintf(complaint, capacity, _("two parts are called '%s'"), part->name);
            return -1;
        }
        if (!*part->parent && first >= 0) {
            snprintf(complaint, capacity, _("'%s' and '%s' both have no parent"),
                     s->part[first].name, part->name);
            return -1;
        }
        if (!*part->parent) {
            first = i;
            continue;
        }
        part->above = find_part(s, part->parent);
        if (part->above < 0) {
            snprintf(complaint, capacity, _("'%s' hangs on '%s', which is not there"), part->name,
                     part->parent);
            return -1;
        }
    }
    if (first < 0) {
        snprintf(complaint, capacity, s->n ? _("no part is the first") : _("it has no parts"));
    }
    return first;
}

/* Puts the tree below the first part into `along`: parents first, a branch to its end. */
static bool walk(sketch *s, int first, char *complaint, size_t capacity)
{
    int stack[SKETCH_PARTS_MAX], depth = 0, n = 0;
    stack[depth++] = first;
    while (depth > 0) {
        int at = stack[--depth];
        s->along[n++] = at;
        for (int i = s->n - 1; i >= 0; i--) {
            if (s->part[i].above == at) {
                stack[depth++] = i;
            }
        }
    }
    if (n == s->n) {
        return true;
    }
    for (int i = 0; i < s->n; i++) {
        bool taken = false;
        for (int k = 0; k < n; k++) {
            taken |= s->along[k] == i;
        }
        if (!taken) {
            snprintf(complaint, capacity, _("'%s' hangs on itself"), s->part[i].name);
            break;
        }
    }
    return false;
}

static bool check_parts(const sketch *s, char *complaint, size_t capacity)
{
    for (int i = 0; i < s->n; i++) {
        const sketch_part *part = &s->part[i];
        double length = 0, sum = part->mass_kg + part->limits_rad[0] + part->limits_rad[1];
        bool absurd = part->mass_kg < 0 || part->mass_kg > 10000;
        for (int k = 0; k < 3; k++) {
            length += part->axis[k] * part->axis[k];
            sum += part->origin_m[k] + part->origin_rad[k];
            absurd |= fabs(part->origin_m[k]) > 100;
        }
        if (!isfinite(sum) || !isfinite(length) || absurd) {
            snprintf(complaint, capacity, _("'%s': a number is out of range"), part->name);
            return false;
        }
        if (part->motion == SKETCH_TURNS && length < 1e-12) {
            snprintf(complaint, capacity, _("'%s': its axis has no direction"), part->name);
            return false;
        }
        if (part->motion == SKETCH_TURNS && part->limited &&
            part->limits_rad[0] >= part->limits_rad[1]) {
            snprintf(complaint, capacity, _("'%s': its lower limit is not below the upper one"),
                     *part->joint ? part->joint : part->name);
            return false;
        }
    }
    return true;
}

/* Joints by their order, those of the same along the chain: a URDF may begin with the gripper. */
static void sort_joints(sketch *s)
{
    s->n_joints = 0;
    for (int k = 0; k < s->n; k++) {
        int i = s->bare ? k : s->along[k];
        if (s->part[i].motion != SKETCH_TURNS) {
            continue;
        }
        int at = s->n_joints++;
        for (; at > 0 && s->part[s->joints[at - 1]].order > s->part[i].order; at--) {
            s->joints[at] = s->joints[at - 1];
        }
        s->joints[at] = i;
    }
}

bool sketch_order(sketch *s, char *complaint, size_t capacity)
{
    if (!check_parts(s, complaint, capacity)) {
        return false;
    }
    int first = s->bare ? 0 : find_parents(s, complaint, capacity);
    if (first < 0 || (!s->bare && !walk(s, first, complaint, capacity))) {
        return false;
    }
    sort_joints(s);
    if (s->n_joints == 0 || s->n_joints > GROBO_JOINTS_MAX) {
        snprintf(complaint, capacity,
                 s->n_joints ? _("it has %d joints that turn; a robot's file has at most %d")
                             : _("it has no joint that turns"),
                 s->n_joints, GROBO_JOINTS_MAX);
        return false;
    }
    for (int i = 0; i < s->n_joints; i++) {
        sketch_part *part = &s->part[s->joints[i]];
        make_name(*part->joint ? part->joint : part->name, "joint_", part->called);
        make_unique(s, s->joints, i, true, part->called);
    }
    for (int i = 0; !s->bare && i < s->n; i++) {
        sketch_part *part = &s->part[s->along[i]];
        make_name(part->name, "part_", part->shown);
        make_unique(s, s->along, i, false, part->shown);
    }
    char name[GROBO_NAME_MAX_BYTES];
    make_name(s->name, "robot_", name);
    snprintf(s->name, sizeof s->name, "%s", name);
    return true;
}

/* ---- what servos reach ---------------------------------------------------------------------- */

static bool reaches(const sketch *s, const sketch_part *part)
{
    const grobo_joint joint = {.name = part->called,
                               .min_rad = part->limits_rad[0],
                               .max_rad = part->limits_rad[1],
                               .init_rad = part->limits_rad[0],
                               .max_speed_rad_s = 1,
                               .servo_model = part->servo->number,
                               .motor = 1,
                               .mirror_sign = 1,
                               .turns = part->turns,
                               .sign = part->gear < 0 ? -1 : 0,
                               .gear = fabs(part->gear),
                               .zero_rad = part->zero_rad};
    const grobo_model one =
        GROBO_TABLE(grobo_model, .name = "one", GROBO_MODEL_JOINTS(&joint), .n_joints = 1);
    grobo_driver driver = GROBO_TABLE_INIT(grobo_driver);
    return s->family->init[s->family->wiring](&driver, &one) >= 0;
}

static void note(sketch_part *part, const char *text)
{
    size_t used = strlen(part->note);
    snprintf(part->note + used, sizeof part->note - used, "%s%s", used ? "; " : "", text);
}

/* Whether a joint with gears can reach what its description says. A reduction that it cannot have
 * is that of the gears in the servo, which its angles are counted behind. */
static bool fits_gear(const sketch_part *part, double half_rad)
{
    return !part->limited || part->gear == 0 || fabs(part->gear) == 1 ||
           part->limits_rad[1] - part->limits_rad[0] <= 2 * half_rad;
}

/* Its initial posture: that of the description; else 0, or the middle where that is outside. */
static void stand_within(sketch_part *part)
{
    const double *limits = part->limits_rad;
    if (part->stand_rad != 0) {
        part->init_rad = fmax(limits[0], fmin(limits[1], part->stand_rad));
    } else if (limits[0] > 0 || limits[1] < 0) {
        part->init_rad = (limits[0] + limits[1]) / 2;
    }
}

/* As it is, else with the servo's middle in the middle of the range, else cut. False: its gear
 * does not fit. */
static bool fit_joint(const sketch *s, sketch_part *part)
{
    double reach = part->gear != 0 ? fabs(part->gear) : 1;
    double half_rad = grobo_rad_from_deg(part->servo->span_deg / 2.0 - SPARE_DEG) / reach;
    double *limits = part->limits_rad;
    if (!part->limited) {
        limits[0] = -half_rad;
        limits[1] = half_rad;
        note(part, "limits: what the servo reaches; fill in");
    }
    if (!fits_gear(part, half_rad)) {
        return false;
    }
    if (reach != 1) {
        note(part, "gear: 1 if the servo has it inside");
    }
    if (!reaches(s, part)) {
        part->zero_rad = -(limits[0] + limits[1]) / 2 * (part->gear != 0 ? part->gear : 1);
    }
    if (!reaches(s, part)) {
        char text[64];
        snprintf(text, sizeof text, "the servo does not reach %.4g to %.4g deg",
                 grobo_deg_from_rad(limits[0]), grobo_deg_from_rad(limits[1]));
        note(part, text);
        part->zero_rad = 0;
        bool apart = limits[0] >= half_rad || limits[1] <= -half_rad;
        limits[0] = apart || limits[0] < -half_rad ? -half_rad : limits[0];
        limits[1] = apart || limits[1] > half_rad ? half_rad : limits[1];
    }
    stand_within(part);
    return true;
}

bool sketch_fit(sketch *s, char *complaint, size_t capacity)
{
    for (int i = 0; i < s->n_joints; i++) {
        sketch_part *part = &s->part[s->joints[i]];
        if (!fit_joint(s, part)) {
            snprintf(
                complaint, capacity,
                _("%s: %s does not reach its limits with a reduction of %g; take that out if the "
                  "servo has it inside"),
                part->called, part->servo->name, fabs(part->gear));
            return false;
        }
    }
    return true;
}

void sketch_turn_inertia(double inertia_kgm2[6], const double rpy_rad[3])
{
    const double *i = inertia_kgm2;
    double cr = cos(rpy_rad[0]), sr = sin(rpy_rad[0]), cp = cos(rpy_rad[1]), sp = sin(rpy_rad[1]);
    double cy = cos(rpy_rad[2]), sy = sin(rpy_rad[2]);
    const double r[3][3] = {{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                            {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                            {-sp, cp * sr, cp * cr}};
    const double full[3][3] = {{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}};
    double turned[3][3];
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) {
            turned[a][b] = 0;
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++) {
                    turned[a][b] += r[a][k] * full[k][l] * r[b][l];
                }
            }
        }
    }
    const double made[6] = {turned[0][0], turned[1][1], turned[2][2],
                            turned[0][1], turned[0][2], turned[1][2]};
    memcpy(inertia_kgm2, made, sizeof made);
}
