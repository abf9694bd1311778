/* SPDX-License-Identifier: MIT */
/* URDF: links and joints, each in a list of its own. Source: wiki.ros.org/urdf/XML. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/sketch.h"
#include "tools/grctl/robot/xml.h"

/* What element the ear is in. */
typedef enum place {
    ELSEWHERE,
    ROBOT,
    LINK,
    INERTIAL,
    JOINT,
    CONTROL,      /* ros2_control */
    TRANSMISSION, /* in the robot or in that */
    GEARED,       /* a transmission's joint or actuator */
    REDUCTION,
    OFFSET
} place;

/* Between a motor and a joint. Source: wiki.ros.org/urdf/XML/Transmission; of ros2_control:
 * transmission_interface, simple_transmission_loader. */
typedef struct transmission {
    char name[SKETCH_TEXT_BYTES], joint[SKETCH_TEXT_BYTES];
    int n_joints;
    double reduction; /* turns of the motor for one of the joint */
} transmission;

#define GEAR_MIN 0.001 /* of a robot's file */
#define GEAR_MAX 1000.0

typedef struct reader {
    sketch *s;
    sketch *joints; /* as parts: name is the child */
    place at[XML_DEPTH_MAX];
    sketch_part *part;
    char *complaint; /* "": none yet */
    size_t capacity;
    const char *path;
    double soft_rad[2];
    bool soft, slides;
    char type[24];        /* of the joint that is being read */
    double turned_rad[3]; /* of the inertia that is being read */
    transmission *now, *transmissions;
    int n_transmissions;
    char text[64]; /* of the number that is being read */
    size_t text_used;
} reader;

__attribute__((format(printf, 2, 3))) static void complain(reader *r, const char *format, ...)
{
    va_list list;
    if (*r->complaint) {
        return;
    }
    int n = snprintf(r->complaint, r->capacity, "%s:%u: ", r->path, xml_line());
    va_start(list, format);
    vsnprintf(r->complaint + n, n < (int)r->capacity ? r->capacity - (size_t)n : 0, _(format),
              list);
    va_end(list);
}

static const char *attribute(const char *const *all, const char *name)
{
    for (; *all; all += 2) {
        if (strcmp(all[0], name) == 0) {
            return all[1];
        }
    }
    return NULL;
}

static void take_text(reader *r, const char *const *all, const char *name, char *to)
{
    const char *text = attribute(all, name);
    if (!text || !*text || strlen(text) >= SKETCH_TEXT_BYTES) {
        complain(r, "a '%s' of 1 to %d bytes is wanted", name, SKETCH_TEXT_BYTES - 1);
        return;
    }
    snprintf(to, SKETCH_TEXT_BYTES, "%s", text);
}

/* n numbers with blanks between them; what is missing stays. */
static void take_numbers(reader *r, const char *const *all, const char *name, int n, double *to)
{
    const char *text = attribute(all, name);
    double read[3];
    for (int i = 0; text && i < n; i++) {
        char word[64];
        size_t length;
        text += strspn(text, " \t\r\n");
        length = strcspn(text, " \t\r\n");
        if (length == 0 || length >= sizeof word) {
            complain(r, "'%s': %d number%s wanted", name, n, n == 1 ? " is" : "s are");
            return;
        }
        snprintf(word, sizeof word, "%.*s", (int)length, text);
        if (!cli_read_number(word, &read[i])) {
            complain(r, "'%s': '%s' is not a number", name, word);
            return;
        }
        text += length;
    }
    if (text && text[strspn(text, " \t\r\n")]) {
        complain(r, "'%s': %d number%s wanted", name, n, n == 1 ? " is" : "s are");
    } else if (text) {
        memcpy(to, read, (size_t)n * sizeof *to);
    }
}

static void begin_joint(reader *r, const char *const *all)
{
    const char *type = attribute(all, "type");
    r->part = sketch_add(r->joints);
    r->soft = r->slides = false;
    if (!r->part) {
        complain(r, "more than %d joints", SKETCH_PARTS_MAX);
        return;
    }
    take_text(r, all, "name", r->part->joint);
    r->part->order = r->s->as_listed ? r->joints->n : 0;
    if (!type) {
        complain(r, "joint '%s' has no type", r->part->joint);
    } else if (strcmp(type, "revolute") == 0 || strcmp(type, "continuous") == 0) {
        r->part->motion = SKETCH_TURNS;
    } else if (strcmp(type, "prismatic") == 0) {
        r->slides = true;
        r->part->motion = SKETCH_TURNS;
    } else if (strcmp(type, "fixed") != 0) {
        r->part->motion = SKETCH_WITHOUT;
        snprintf(r->part->note, sizeof r->part->note, "joint %.40s is %.20s", r->part->joint, type);
    }
    snprintf(r->type, sizeof r->type, "%.20s", type ? type : "");
    r->part->limited = false;
    r->part->limits_rad[0] = type && strcmp(type, "continuous") == 0 ? NAN : 0;
}

static void take_limit(reader *r, const char *const *all)
{
    bool turns_on = isnan(r->part->limits_rad[0]);
    double limits[2] = {0, 0};
    take_numbers(r, all, "lower", 1, &limits[0]);
    take_numbers(r, all, "upper", 1, &limits[1]);
    take_numbers(r, all, "velocity", 1, &r->part->speed_rad_s);
    if (!turns_on && (attribute(all, "lower") || attribute(all, "upper"))) {
        memcpy(r->part->limits_rad, limits, sizeof limits);
        r->part->limited = true;
    }
}

static void take_joint(reader *r, const char *name, const char *const *all)
{
    sketch_part *part = r->part;
    if (!part) {
        return;
    }
    if (strcmp(name, "parent") == 0) {
        take_text(r, all, "link", part->parent);
    } else if (strcmp(name, "child") == 0) {
        take_text(r, all, "link", part->name);
    } else if (strcmp(name, "origin") == 0) {
        take_numbers(r, all, "xyz", 3, part->origin_m);
        take_numbers(r, all, "rpy", 3, part->origin_rad);
    } else if (strcmp(name, "axis") == 0) {
        take_numbers(r, all, "xyz", 3, part->axis);
    } else if (strcmp(name, "limit") == 0) {
        take_limit(r, all);
    } else if (strcmp(name, "safety_controller") == 0 && attribute(all, "soft_lower_limit") &&
               attribute(all, "soft_upper_limit")) {
        r->soft = true;
        take_numbers(r, all, "soft_lower_limit", 1, &r->soft_rad[0]);
        take_numbers(r, all, "soft_upper_limit", 1, &r->soft_rad[1]);
    } else if (strcmp(name, "mimic") == 0 && part->motion == SKETCH_TURNS) {
        const char *other = attribute(all, "joint");
        part->motion = SKETCH_WITHOUT;
        snprintf(part->note, sizeof part->note, "joint %.40s follows %.40s", part->joint,
                 other ? other : "another");
    }
}

/* A joint that slides is in metres. How far it goes with a turn of its servo no URDF says: such a
 * guess that half a turn is the whole way. One without limits is left out. */
static void take_slide(const reader *r, sketch_part *part)
{
    double way_mm = (part->limits_rad[1] - part->limits_rad[0]) * 1e3;
    if (!part->limited || !(way_mm >= 0.01 && way_mm < 1e5)) {
        part->motion = SKETCH_WITHOUT;
        snprintf(part->note, sizeof part->note, "joint %.40s is %.20s", part->joint, r->type);
        return;
    }
    part->mm_per_turn = 2 * way_mm;
    double rad_m = grobo_rad_from_deg(360) * 1e3 / part->mm_per_turn;
    part->limits_rad[0] *= rad_m;
    part->limits_rad[1] *= rad_m;
    part->speed_rad_s *= rad_m;
}

/* Softer limits hold where there are some. */
static void end_joint(reader *r)
{
    sketch_part *part = r->part;
    if (part && part->limited && r->soft) {
        part->limits_rad[0] = fmax(part->limits_rad[0], r->soft_rad[0]);
        part->limits_rad[1] = fmin(part->limits_rad[1], r->soft_rad[1]);
    }
    if (part && r->slides && part->motion == SKETCH_TURNS) {
        take_slide(r, part);
    }
    if (part && !part->limited) {
        part->limits_rad[0] = part->limits_rad[1] = 0;
    }
    if (part && (!*part->name || !*part->parent)) {
        complain(r, "joint '%s' has no %s", part->joint, *part->parent ? "child" : "parent");
    }
    r->part = NULL;
}

static void begin_link(reader *r, const char *const *all)
{
    r->part = sketch_add(r->s);
    if (!r->part) {
        complain(r, "more than %d links", SKETCH_PARTS_MAX);
        return;
    }
    take_text(r, all, "name", r->part->name);
}

static void take_inertial(reader *r, const char *name, const char *const *all)
{
    static const char *const entries[] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    sketch_part *part = r->part;
    if (!part) {
        return;
    }
    if (strcmp(name, "mass") == 0) {
        take_numbers(r, all, "value", 1, &part->mass_kg);
    } else if (strcmp(name, "origin") == 0) {
        take_numbers(r, all, "xyz", 3, part->com_m);
        take_numbers(r, all, "rpy", 3, r->turned_rad);
    } else if (strcmp(name, "inertia") == 0) {
        for (int i = 0; i < 6; i++) {
            take_numbers(r, all, entries[i], 1, &part->inertia_kgm2[i]);
        }
    }
}

/* An inertia stands along the axes of its own origin, which may be told before or after it. */
static void end_inertial(reader *r)
{
    if (r->part) {
        sketch_turn_inertia(r->part->inertia_kgm2, r->turned_rad);
    }
    memset(r->turned_rad, 0, sizeof r->turned_rad);
}

/* ---- transmissions --------------------------------------------------------------------------- */

static void begin_transmission(reader *r, const char *const *all)
{
    const char *name = attribute(all, "name");
    if (r->n_transmissions == SKETCH_PARTS_MAX) {
        complain(r, "more than %d transmissions", SKETCH_PARTS_MAX);
        return;
    }
    r->now = &r->transmissions[r->n_transmissions++];
    *r->now = (transmission){.reduction = 1};
    snprintf(r->now->name, sizeof r->now->name, "%.80s", name ? name : "");
}

static bool is_reduction(const char *name)
{
    return strcmp(name, "mechanicalReduction") == 0 || strcmp(name, "mechanical_reduction") == 0;
}

static place begin_geared(reader *r, place in, const char *name, const char *const *all)
{
    if (!r->now) {
        return ELSEWHERE;
    }
    r->text_used = 0;
    if (is_reduction(name)) {
        return REDUCTION;
    }
    if (strcmp(name, "offset") == 0) {
        return OFFSET;
    }
    if (in == TRANSMISSION && strcmp(name, "joint") == 0) {
        r->now->n_joints++;
        take_text(r, all, "name", r->now->joint);
        return GEARED;
    }
    return in == TRANSMISSION && strcmp(name, "actuator") == 0 ? GEARED : ELSEWHERE;
}

static void end_number(reader *r, bool is_offset)
{
    double number;
    char *end = r->text + r->text_used;
    while (end > r->text && strchr(" \t\r\n", end[-1])) {
        end--;
    }
    *end = '\0';
    const char *text = r->text + strspn(r->text, " \t\r\n");
    if (!cli_read_number(text, &number)) {
        complain(r, "transmission '%s': '%s' is not a number", r->now->name, text);
    } else if (is_offset && number != 0) {
        complain(r, "transmission '%s': an offset is not read", r->now->name);
    } else if (!is_offset && !(fabs(number) >= GEAR_MIN && fabs(number) <= GEAR_MAX)) {
        complain(r, "transmission '%s': a reduction of %g to %g is wanted", r->now->name, GEAR_MIN,
                 GEAR_MAX);
    } else if (!is_offset) {
        r->now->reduction *= number;
    }
}

static void end_transmission(reader *r)
{
    transmission *is = r->now;
    r->now = NULL;
    if (is && is->n_joints != 1) {
        complain(r, "transmission '%s' is of %d joints: a servo moves one", is->name, is->n_joints);
    }
}

static void on_text(void *ctx, const char *bytes, size_t size)
{
    reader *r = ctx;
    for (size_t i = 0; i < size && r->text_used < sizeof r->text - 1; i++) {
        r->text[r->text_used++] = bytes[i];
    }
}

/* The gear of each joint. False with a complaint. */
static bool gear(const reader *r, char *complaint, size_t capacity)
{
    for (int t = 0; t < r->n_transmissions; t++) {
        const transmission *is = &r->transmissions[t];
        sketch_part *joint = NULL;
        for (int j = 0; j < r->joints->n && !joint; j++) {
            joint = strcmp(r->joints->part[j].joint, is->joint) == 0 ? &r->joints->part[j] : NULL;
        }
        if (!joint || (joint->gear != 0 && joint->gear != is->reduction)) {
            snprintf(complaint, capacity,
                     joint ? _("transmission '%s': '%s' has another one already")
                           : _("transmission '%s': there is no joint '%s'"),
                     is->name, is->joint);
            return false;
        }
        joint->gear = is->reduction;
    }
    return true;
}

/* ---- the robot ------------------------------------------------------------------------------- */

static void begin_robot(reader *r, const char *name, const char *const *all)
{
    r->at[0] = ROBOT;
    if (strcmp(name, "robot") != 0) {
        complain(r, "a URDF begins with 'robot', not '%.40s'", name);
    } else if (attribute(all, "name")) {
        take_text(r, all, "name", r->s->name);
    }
}

/* What stands in the robot itself. */
static place begin_part(reader *r, const char *name, const char *const *all)
{
    if (strncmp(name, "xacro:", 6) == 0) {
        complain(r, "this is a xacro: make a URDF of it first: xacro %s", r->path);
    } else if (strcmp(name, "link") == 0) {
        begin_link(r, all);
        return LINK;
    } else if (strcmp(name, "joint") == 0) {
        begin_joint(r, all);
        return JOINT;
    } else if (strcmp(name, "transmission") == 0) {
        begin_transmission(r, all);
        return TRANSMISSION;
    }
    return strcmp(name, "ros2_control") == 0 ? CONTROL : ELSEWHERE;
}

static void on_begin(void *ctx, int depth, const char *name, const char *const *all)
{
    reader *r = ctx;
    r->at[depth] = ELSEWHERE;
    if (depth == 0) {
        begin_robot(r, name, all);
        return;
    }
    switch (r->at[depth - 1]) {
    case ROBOT:
        r->at[depth] = begin_part(r, name, all);
        break;
    case LINK:
        r->at[depth] = strcmp(name, "inertial") == 0 ? INERTIAL : ELSEWHERE;
        break;
    case INERTIAL:
        take_inertial(r, name, all);
        break;
    case JOINT:
        take_joint(r, name, all);
        break;
    case CONTROL:
        if (strcmp(name, "transmission") == 0) {
            begin_transmission(r, all);
            r->at[depth] = TRANSMISSION;
        }
        break;
    case TRANSMISSION:
    case GEARED:
        r->at[depth] = begin_geared(r, r->at[depth - 1], name, all);
        break;
    case REDUCTION:
    case OFFSET:
    case ELSEWHERE:
        break;
    }
}

static void on_end(void *ctx, int depth)
{
    reader *r = ctx;
    if (r->at[depth] == JOINT) {
        end_joint(r);
    } else if (r->at[depth] == INERTIAL) {
        end_inertial(r);
    } else if (r->at[depth] == TRANSMISSION) {
        end_transmission(r);
    } else if (r->now && (r->at[depth] == REDUCTION || r->at[depth] == OFFSET)) {
        end_number(r, r->at[depth] == OFFSET);
    }
}

/* A link is carried by the joint whose child it is. */
static bool join(sketch *s, const sketch *joints, char *complaint, size_t capacity)
{
    for (int j = 0; j < joints->n; j++) {
        const sketch_part *joint = &joints->part[j];
        sketch_part *link = NULL;
        for (int i = 0; i < s->n && !link; i++) {
            link = strcmp(s->part[i].name, joint->name) == 0 ? &s->part[i] : NULL;
        }
        if (!link || *link->parent) {
            snprintf(complaint, capacity,
                     link ? _("joint '%s': '%s' has a parent already")
                          : _("joint '%s': there is no link '%s'"),
                     joint->joint, joint->name);
            return false;
        }
        const sketch_part told = *link;
        *link = *joint;
        link->mass_kg = told.mass_kg;
        memcpy(link->com_m, told.com_m, sizeof link->com_m);
        memcpy(link->inertia_kgm2, told.inertia_kgm2, sizeof link->inertia_kgm2);
    }
    return true;
}

bool sketch_read_urdf(sketch *s, const char *path, const char *bytes, size_t size, char *complaint,
                      size_t capacity)
{
    static sketch joints;
    static transmission transmissions[SKETCH_PARTS_MAX];
    char said[APP_LINE_BYTES] = "";
    reader r = {.s = s,
                .joints = &joints,
                .complaint = said,
                .capacity = sizeof said,
                .path = path,
                .transmissions = transmissions};
    const xml_ear ear = {on_begin, on_text, on_end, &r};
    xml_trouble trouble;
    joints.n = 0;
    if (xml_missing()) {
        snprintf(complaint, capacity, "%s: %s", path, xml_missing());
        return false;
    }
    int error = xml_read(bytes, size, &ear, &trouble);
    if (*said) {
        snprintf(complaint, capacity, "%s", said);
        return false;
    }
    if (error) {
        snprintf(complaint, capacity, "%s:%u:%u: %s", path, trouble.line, trouble.column,
                 trouble.text);
        return false;
    }
    int n = snprintf(complaint, capacity, "%s: ", path);
    complaint += n < (int)capacity ? n : (int)capacity;
    capacity -= n < (int)capacity ? (size_t)n : capacity;
    return gear(&r, complaint, capacity) && join(s, &joints, complaint, capacity);
}
