/* SPDX-License-Identifier: MIT */
/* Choreonoid's body (YAML): links with their parents. Source: choreonoid,
 * src/Body/StdBodyLoader.cpp, whose angles are degrees unless angleUnit says radian. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <yaml.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/sketch.h"

enum { KEYS_MAX = 256 /* of a link: an alias may name one again and again */ };

typedef struct reader {
    sketch *s;
    yaml_document_t document;
    double unit_rad; /* of an angle */
    char *complaint;
    size_t capacity;
    const char *path;
} reader;

static bool complain(reader *r, const yaml_node_t *at, const char *what)
{
    snprintf(r->complaint, r->capacity, "%s:%u: %s", r->path, (unsigned)at->start_mark.line + 1,
             _(what));
    return false;
}

/* Today's files have joint_type for the jointType of older ones, and both beside one another. */
static bool is_key(const char *name, const char *key)
{
    for (; *name && *key; name++, key++) {
        if (*key >= 'A' && *key <= 'Z' && name[0] == '_' && name[1] == *key - 'A' + 'a') {
            name++;
        } else if (*name != *key) {
            return false;
        }
    }
    return *name == *key;
}

/* The value of a key, or NULL. */
static yaml_node_t *find(reader *r, const yaml_node_t *map, const char *key)
{
    const yaml_node_pair_t *pair;
    if (map->type != YAML_MAPPING_NODE) {
        return NULL;
    }
    for (pair = map->data.mapping.pairs.start; pair < map->data.mapping.pairs.top; pair++) {
        const yaml_node_t *name = yaml_document_get_node(&r->document, pair->key);
        if (name->type == YAML_SCALAR_NODE && is_key((const char *)name->data.scalar.value, key)) {
            return yaml_document_get_node(&r->document, pair->value);
        }
    }
    return NULL;
}

static const char *text_of(const yaml_node_t *node)
{
    return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

static bool take_text(reader *r, const yaml_node_t *map, const char *key, char *to)
{
    const yaml_node_t *node = find(r, map, key);
    const char *text = text_of(node);
    if (node && (!text || strlen(text) >= SKETCH_TEXT_BYTES)) {
        return complain(r, node, "a text of at most 95 bytes is wanted");
    }
    snprintf(to, SKETCH_TEXT_BYTES, "%s", text ? text : "");
    return true;
}

static int length_of(const yaml_node_t *node)
{
    return node->type == YAML_SEQUENCE_NODE
               ? (int)(node->data.sequence.items.top - node->data.sequence.items.start)
               : -1;
}

static yaml_node_t *item(reader *r, const yaml_node_t *list, int i)
{
    return yaml_document_get_node(&r->document, list->data.sequence.items.start[i]);
}

/* n numbers, or -1 that there are none; false with the complaint. */
static bool take_numbers(reader *r, const yaml_node_t *node, int n, double *to)
{
    if (!node) {
        return true;
    }
    if (n == 1) {
        const char *text = text_of(node);
        return (text && cli_read_number(text, to)) || complain(r, node, "a number is wanted");
    }
    if (length_of(node) != n) {
        char what[64];
        snprintf(what, sizeof what, _("%d numbers are wanted"), n);
        return complain(r, node, what);
    }
    for (int i = 0; i < n; i++) {
        if (!take_numbers(r, item(r, node, i), 1, &to[i])) {
            return false;
        }
    }
    return true;
}

/* ---- rotations ------------------------------------------------------------------------------ */

static void multiply(double a[3][3], double b[3][3])
{
    double made[3][3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            made[i][k] = a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k];
        }
    }
    memcpy(a, made, sizeof made);
}

/* About an axis, which need not be of length 1. */
static void turn(double m[3][3], const double *axis, double angle_rad)
{
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double c = cos(angle_rad), s = sin(angle_rad), u[3], one[3][3];
    for (int i = 0; i < 3; i++) {
        u[i] = length > 0 ? axis[i] / length : 0;
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            int other = 3 - i - k; /* where i and k differ */
            double cross = i == k ? 0 : ((i + 1) % 3 == k ? -1 : 1) * u[other] * s;
            one[i][k] = u[i] * u[k] * (1 - c) + (i == k ? c : 0) + cross;
        }
    }
    if (length > 0) {
        multiply(m, one);
    }
}

/* "rotation": an axis and an angle, or several, one in the frame of the one before; else "rpy". */
static bool take_rotation(reader *r, const yaml_node_t *map, double *rpy_rad)
{
    const yaml_node_t *node = find(r, map, "rotation");
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, rpy[3] = {0, 0, 0};
    if (!node) {
        bool fine = take_numbers(r, find(r, map, "rpy"), 3, rpy);
        for (int k = 0; k < 3; k++) {
            rpy_rad[k] = rpy[k] * r->unit_rad;
        }
        return fine;
    }
    bool several = length_of(node) > 0 && length_of(item(r, node, 0)) >= 0;
    int n = several ? length_of(node) : 1;
    if (n > KEYS_MAX) {
        return complain(r, node, "too many rotations");
    }
    for (int i = 0; i < n; i++) {
        double one[4];
        if (!take_numbers(r, several ? item(r, node, i) : node, 4, one)) {
            return false;
        }
        turn(m, one, one[3] * r->unit_rad);
    }
    rpy_rad[0] = atan2(m[2][1], m[2][2]);
    rpy_rad[1] = asin(fmax(-1, fmin(1, -m[2][0])));
    rpy_rad[2] = atan2(m[1][0], m[0][0]);
    return true;
}

/* ---- joints --------------------------------------------------------------------------------- */

static bool take_axis(reader *r, const yaml_node_t *link, sketch_part *part)
{
    const yaml_node_t *node = find(r, link, "jointAxis");
    const char *text = text_of(node);
    static const char names[] = "XYZ";
    if (!text && node) {
        return take_numbers(r, node, 3, part->axis);
    }
    text = text ? text : "Z"; /* as Link.cpp of choreonoid has it */
    bool negative = *text == '-';
    char letter = text[negative];
    letter = letter >= 'x' && letter <= 'z' ? (char)(letter - 'x' + 'X') : letter;
    const char *at = letter ? strchr(names, letter) : NULL;
    if (!at || text[negative + 1]) {
        return complain(r, node, "jointAxis: X, Y, Z, -X, -Y, -Z or three numbers are wanted");
    }
    memset(part->axis, 0, sizeof part->axis);
    part->axis[at - names] = negative ? -1 : 1;
    return true;
}

/* Two of them, or one for both sides; false with the complaint. */
static bool take_limits(reader *r, const yaml_node_t *node, double *limits_rad)
{
    bool both = length_of(node) == 2;
    for (int i = 0; i < 2; i++) {
        const yaml_node_t *one = both ? item(r, node, i) : node;
        const char *text = text_of(one);
        double number = INFINITY;
        if (!(text && strcmp(text, "unlimited") == 0) && !take_numbers(r, one, 1, &number)) {
            return false;
        }
        limits_rad[i] = number * r->unit_rad * (!both && i == 0 ? -1 : 1);
    }
    return true;
}

static bool take_range(reader *r, const yaml_node_t *link, sketch_part *part)
{
    const yaml_node_t *node = find(r, link, "jointRange");
    double limits_rad[2] = {INFINITY, INFINITY};
    if (node && !take_limits(r, node, limits_rad)) {
        return false;
    }
    part->limited = isfinite(limits_rad[0]) && isfinite(limits_rad[1]);
    if (part->limited) {
        memcpy(part->limits_rad, limits_rad, sizeof limits_rad);
    }
    return true;
}

/* The slower direction counts. */
static bool take_speed(reader *r, const yaml_node_t *link, sketch_part *part)
{
    const yaml_node_t *node = find(r, link, "maxJointVelocity");
    double limits_rad_s[2] = {0, 0};
    node = node ? node : find(r, link, "jointVelocityRange");
    if (node && !take_limits(r, node, limits_rad_s)) {
        return false;
    }
    double speed_rad_s = fmin(fabs(limits_rad_s[0]), fabs(limits_rad_s[1]));
    part->speed_rad_s = isfinite(speed_rad_s) ? speed_rad_s : 0;
    return true;
}

static bool take_joint(reader *r, const yaml_node_t *link, sketch_part *part)
{
    const yaml_node_t *type_node = find(r, link, "jointType");
    const char *type = text_of(type_node);
    double number = SKETCH_PARTS_MAX;
    if (!type || strcmp(type, "fixed") == 0 || strcmp(type, "free") == 0) {
        return true;
    }
    if (strcmp(type, "revolute") != 0) {
        part->motion = SKETCH_WITHOUT;
        snprintf(part->note, sizeof part->note, "%.40s is %.20s", part->name, type);
        return true;
    }
    part->motion = SKETCH_TURNS;
    if (!take_numbers(r, find(r, link, "jointId"), 1, &number) ||
        !take_text(r, link, "joint_name", part->joint)) {
        return false;
    }
    part->order = number >= 0 && number < SKETCH_PARTS_MAX ? (int)number : SKETCH_PARTS_MAX;
    return take_axis(r, link, part) && take_range(r, link, part) && take_speed(r, link, part);
}

/* Nine numbers, row by row. */
static bool take_inertia(reader *r, const yaml_node_t *node, double inertia_kgm2[6])
{
    double full[9] = {0};
    if (!take_numbers(r, node, 9, full)) {
        return false;
    }
    const double made[6] = {full[0], full[4], full[8], full[1], full[2], full[5]};
    memcpy(inertia_kgm2, made, sizeof made);
    return true;
}

static bool take_weight(reader *r, const yaml_node_t *link, sketch_part *part)
{
    return take_numbers(r, find(r, link, "mass"), 1, &part->mass_kg) &&
           take_numbers(r, find(r, link, "centerOfMass"), 3, part->com_m) &&
           take_inertia(r, find(r, link, "inertia"), part->inertia_kgm2);
}

static bool take_link(reader *r, const yaml_node_t *link)
{
    const char *type = text_of(find(r, link, "type"));
    if (link->type != YAML_MAPPING_NODE ||
        link->data.mapping.pairs.top - link->data.mapping.pairs.start > KEYS_MAX) {
        return complain(r, link, "a link is a mapping of some keys");
    }
    if (type && strcmp(type, "Skip") == 0) {
        return true;
    }
    if (type && strcmp(type, "Link") != 0) {
        return complain(r, link, "only links of type Link are read");
    }
    sketch_part *part = sketch_add(r->s);
    if (!part) {
        return complain(r, link, "too many links");
    }
    return take_text(r, link, "name", part->name) && take_text(r, link, "parent", part->parent) &&
           (*part->name || complain(r, link, "a link has no name")) &&
           take_numbers(r, find(r, link, "translation"), 3, part->origin_m) &&
           take_weight(r, link, part) && take_rotation(r, link, part->origin_rad) &&
           take_joint(r, link, part);
}

/* "footLinks": link and sole of each foot, for Choreonoid's balancer. Other than two feet: none. */
static bool take_feet(reader *r, const yaml_node_t *root)
{
    const yaml_node_t *list = find(r, root, "footLinks");
    if (!list || length_of(list) != 2) {
        return true;
    }
    for (int i = 0; i < 2; i++) {
        const yaml_node_t *one = item(r, list, i);
        sketch_foot *foot = &r->s->foot[i];
        if (!take_text(r, one, "link", foot->link) ||
            !take_numbers(r, find(r, one, "soleCenter"), 3, foot->sole_m)) {
            return false;
        }
    }
    r->s->n_feet = 2;
    return true;
}

static sketch_part *part_called(const reader *r, const char *name)
{
    for (int i = 0; name && i < r->s->n; i++) {
        if (strcmp(r->s->part[i].name, name) == 0) {
            return &r->s->part[i];
        }
    }
    return NULL;
}

/* "symmetricJoints": [A, B, sign of the angle], or [A]: itself with the other sign. One that names
 * no joint is passed over, as Choreonoid does. */
static bool take_symmetry(reader *r, const yaml_node_t *root)
{
    const yaml_node_t *list = find(r, root, "symmetricJoints");
    for (int i = 0; list && i < length_of(list); i++) {
        const yaml_node_t *row = item(r, list, i);
        int n = length_of(row);
        double sign = n == 1 ? -1 : 1;
        if (n < 1 || n > 3 || (n == 3 && !take_numbers(r, item(r, row, 2), 1, &sign))) {
            return n >= 1 && n <= 3 ? false
                                    : complain(r, row, "one or two joints and a sign are wanted");
        }
        sketch_part *pair[2] = {part_called(r, text_of(item(r, row, 0))),
                                part_called(r, text_of(item(r, row, n > 1)))};
        for (int k = 0; k < 2 && pair[0] && pair[1]; k++) {
            memcpy(pair[k]->mirror, pair[1 - k]->name, sizeof pair[k]->mirror);
            pair[k]->mirror_sign = sign < 0 ? -1 : 1;
        }
    }
    return true;
}

/* "standardPose": an angle for each joint, by its number. */
static bool take_stand(reader *r, const yaml_node_t *root)
{
    const yaml_node_t *list = find(r, root, "standardPose");
    int n = list ? length_of(list) : 0;
    for (int i = 0; i < r->s->n; i++) {
        sketch_part *part = &r->s->part[i];
        if (part->motion == SKETCH_TURNS && part->order < n &&
            !take_numbers(r, item(r, list, part->order), 1, &part->stand_rad)) {
            return false;
        }
        part->stand_rad *= r->unit_rad;
    }
    return true;
}

static bool take_robot(reader *r)
{
    const yaml_node_t *root = yaml_document_get_root_node(&r->document);
    if (!root || root->type != YAML_MAPPING_NODE) {
        snprintf(r->complaint, r->capacity, _("%s: is neither a URDF nor a body of Choreonoid"),
                 r->path);
        return false;
    }
    const char *format = text_of(find(r, root, "format"));
    const char *unit = text_of(find(r, root, "angleUnit"));
    const yaml_node_t *links = find(r, root, "links");
    if (!format || strcmp(format, "ChoreonoidBody") != 0) {
        return complain(r, root,
                        "is neither a URDF nor a body of Choreonoid (format: "
                        "ChoreonoidBody)");
    }
    if (!links || length_of(links) < 0) {
        return complain(r, links ? links : root, "a list of links is wanted");
    }
    r->unit_rad = unit && strcmp(unit, "radian") == 0 ? 1 : grobo_rad_from_deg(1);
    if (!take_text(r, root, "name", r->s->name)) {
        return false;
    }
    for (int i = 0; i < length_of(links); i++) {
        if (!take_link(r, item(r, links, i))) {
            return false;
        }
    }
    return take_feet(r, root) && take_symmetry(r, root) && take_stand(r, root);
}

bool sketch_read_body(sketch *s, const char *path, const char *bytes, size_t size, char *complaint,
                      size_t capacity)
{
    reader r = {.s = s, .path = path, .complaint = complaint, .capacity = capacity};
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) {
        snprintf(complaint, capacity, _("%s: not enough memory"), path);
        return false;
    }
    yaml_parser_set_input_string(&parser, (const unsigned char *)bytes, size);
    bool fine = yaml_parser_load(&parser, &r.document) != 0;
    if (fine) {
        fine = take_robot(&r);
        yaml_document_delete(&r.document);
    } else {
        snprintf(complaint, capacity, "%s:%u:%u: %s", path, (unsigned)parser.problem_mark.line + 1,
                 (unsigned)parser.problem_mark.column + 1,
                 parser.problem ? parser.problem : _("is not YAML"));
    }
    yaml_parser_delete(&parser);
    return fine;
}
