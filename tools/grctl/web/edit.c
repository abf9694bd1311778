/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/heap.h"
#include "tools/grctl/play/play.h"
#include "tools/grctl/web/edit.h"
#include "tools/grctl/web/fields.h"
#include "tools/grctl/web/library.h"
#include "tools/grctl/web/pose.h"

/* What is made, and of what. */
typedef struct making {
    const grobo_model *model;
    const grobo_motion *base;
    grobo_motion *mirrored; /* base, left for right; NULL: nobody has asked for it yet */
    grobo_motion *motion;
    double before_s; /* time of the key before */
    edit_result *result;
    size_t key; /* the one that is read */
} making;

/* The key pose that one is made from; of NULL: it is new. */
typedef struct source {
    const grobo_motion *of;
    size_t n;
} source;

static int complain(const making *m, int error, const char *what)
{
    snprintf(m->result->complaint, sizeof m->result->complaint, "key %zu: %s", m->key, what);
    return error;
}

/* ---- what a key gives ------------------------------------------------------------------------ */

static const field key_fields[] = {
    {.name = "from", .kind = FIELD_WHOLE, .least = 0, .most = 1e9},
    {.name = "mirror", .kind = FIELD_FLAG},
    {.name = "time_ms", .kind = FIELD_NUMBER, .least = -1e15, .most = 1e15},
    {.name = "name", .kind = FIELD_TEXT},
    {.name = "angle_deg", .kind = FIELD_OBJECT},
    {.name = "links", .kind = FIELD_LIST},
    {.name = "stationary", .kind = FIELD_NUMBERS, .most = GROBO_JOINTS_MAX},
    {.name = "zmp_m", .kind = FIELD_NUMBERS, .nullable = true, .least = 3, .most = 3},
    {.name = "max_transition_ms", .kind = FIELD_NUMBER, .least = 0, .most = 1e12},
    {.name = NULL}};
static const field link_fields[] = {
    {.name = "link", .kind = FIELD_TEXT, .needed = true},
    {.name = "p_m", .kind = FIELD_NUMBERS, .least = 3, .most = 3},
    {.name = "rotation", .kind = FIELD_NUMBERS, .least = 9, .most = 9},
    {.name = "base", .kind = FIELD_FLAG},
    {.name = "stationary", .kind = FIELD_FLAG},
    {.name = "touching", .kind = FIELD_FLAG},
    {.name = "slave", .kind = FIELD_FLAG},
    {.name = NULL}};

/* The fields of one key, or of one link of it. */
static int check_fields(const making *m, const json_t *given, const field *fields, const char *what)
{
    char complaint[FIELDS_TEXT_BYTES];
    if (fields_fit(given, fields, what, complaint)) {
        return GROBO_OK;
    }
    snprintf(m->result->complaint, sizeof m->result->complaint, "key %zu: %s", m->key, complaint);
    return GROBO_ERR_ARG;
}

static int read_angles(const making *m, const json_t *angles, grobo_posture *posture)
{
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)angles, name, value)
    {
        int joint = grobo_model_find_joint(m->model, name, strlen(name));
        if (joint < 0) {
            return complain(m, GROBO_ERR_NOTFOUND, "angle_deg names a joint that is none");
        }
        if (json_is_null(value)) {
            posture->set &= ~GROBO_JOINT_BIT(joint);
        } else if (!json_is_number(value) ||
                   grobo_posture_set_deg(posture, joint, json_number_value(value)) < 0) {
            return complain(m, GROBO_ERR_ARG, "an angle is no number");
        }
    }
    return GROBO_OK;
}

static int read_stationary(const making *m, const json_t *list, grobo_key_info *info)
{
    size_t i;
    json_t *value;
    if (!list) {
        return GROBO_OK;
    }
    info->stationary = 0;
    json_array_foreach((json_t *)list, i, value)
    {
        json_int_t joint = json_integer_value(value);
        if (!json_is_integer(value) || joint < 0 || joint >= m->model->n_joints) {
            return complain(m, GROBO_ERR_ARG, "stationary names a joint that is none");
        }
        info->stationary |= GROBO_JOINT_BIT(joint);
    }
    return GROBO_OK;
}

static bool read_vector(const json_t *list, double *values)
{
    grobo_transform at = {{0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    bool fine = list && pose_read_placement(list, NULL, &at);
    if (fine) {
        memcpy(values, at.p_m, sizeof at.p_m);
    }
    return fine;
}

static int read_info(const making *m, const json_t *key, grobo_key_info *info)
{
    const json_t *zmp = json_object_get(key, "zmp_m");
    const json_t *transition = json_object_get(key, "max_transition_ms");
    if (zmp && !json_is_null(zmp) && !read_vector(zmp, info->zmp_m)) {
        return complain(m, GROBO_ERR_ARG, "zmp_m is three numbers or null");
    }
    if (zmp) {
        info->zmp_stationary = info->zmp_stationary || (!info->has_zmp && !json_is_null(zmp));
        info->has_zmp = !json_is_null(zmp);
    }
    if (transition) {
        info->max_transition_s = json_number_value(transition) / 1e3;
    }
    return read_stationary(m, json_object_get(key, "stationary"), info);
}

/* The link of a key that is called so, or, where it has no name, has that number. -1: none. */
static int find_link(const source *from, const char *name)
{
    size_t n = 0;
    const grobo_ik_link *links = from->of ? grobo_motion_ik_links(from->of, from->n, &n) : NULL;
    for (size_t i = 0; i < n; i++) {
        char number[16];
        snprintf(number, sizeof number, "%d", links[i].index);
        if (strcmp(*links[i].name ? links[i].name : number, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

static void read_flag(const json_t *from, const char *key, bool *flag)
{
    const json_t *given = json_object_get(from, key);
    *flag = given ? json_is_true(given) : *flag;
}

/* was: the link that it is in the file, or NULL; what is not given stays as it is there. */
static int read_link(const making *m, const json_t *from, const grobo_ik_link *was,
                     grobo_ik_link *link)
{
    static const grobo_ik_link none = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .index = -1};
    const json_t *p_m = json_object_get(from, "p_m");
    grobo_transform at;
    *link = was ? *was : none;
    memcpy(at.p_m, link->translation_m, sizeof at.p_m);
    memcpy(at.r, link->rotation, sizeof at.r);
    if ((!p_m && !was) || !pose_read_placement(p_m, json_object_get(from, "rotation"), &at)) {
        return complain(m, GROBO_ERR_ARG, "a link has its name, p_m and rotation");
    }
    if (!was) {
        snprintf(link->name, sizeof link->name, "%s",
                 json_string_value(json_object_get(from, "link")));
    }
    memcpy(link->translation_m, at.p_m, sizeof at.p_m);
    memcpy(link->rotation, at.r, sizeof at.r);
    read_flag(from, "base", &link->is_base);
    read_flag(from, "stationary", &link->is_stationary);
    read_flag(from, "touching", &link->is_touching);
    read_flag(from, "slave", &link->is_slave);
    return GROBO_OK;
}

/* The keys of other programs that a link had go along with it. */
static int keep_of_links(const making *m, const source *from, const int *was, size_t count)
{
    size_t n = grobo_motion_size(m->motion) - 1;
    grobo_kept kept;
    int error = GROBO_OK;
    for (size_t i = 0; !error && grobo_motion_get_kept(from->of, from->n, i, &kept) == 0; i++) {
        for (size_t k = 0; k < count && kept.level == GROBO_KEPT_LINK; k++) {
            if (was[k] == kept.link) {
                kept.link = (uint8_t)k;
                error = grobo_motion_keep(m->motion, n, &kept);
                break;
            }
        }
    }
    return error;
}

static int set_links(const making *m, const json_t *list, const source *from)
{
    grobo_ik_link links[GROBO_IK_LINKS_MAX];
    int was[GROBO_IK_LINKS_MAX];
    size_t count = json_array_size(list), n_old;
    if (count > GROBO_IK_LINKS_MAX) {
        return complain(m, GROBO_ERR_CAP, "too many links");
    }
    for (size_t i = 0; i < count; i++) {
        const json_t *link = json_array_get(list, i);
        int error = check_fields(m, link, link_fields, "links");
        if (error) {
            return error;
        }
        was[i] = find_link(from, json_string_value(json_object_get(link, "link")));
        const grobo_ik_link *old =
            was[i] < 0 ? NULL : &grobo_motion_ik_links(from->of, from->n, &n_old)[was[i]];
        error = read_link(m, link, old, &links[i]);
        if (error) {
            return error;
        }
    }
    int error =
        grobo_motion_set_ik_links(m->motion, grobo_motion_size(m->motion) - 1, links, count);
    if (!error && from->of) {
        error = keep_of_links(m, from, was, count);
    }
    return error ? complain(m, error, grobo_error_text(error)) : GROBO_OK;
}

/* ---- a key ----------------------------------------------------------------------------------- */

/* Links and the keys of other programs, as they are; those of links go where links are new. */
static int copy_rest(const making *m, const source *from, size_t to, bool links)
{
    size_t n_links;
    const grobo_ik_link *link = grobo_motion_ik_links(from->of, from->n, &n_links);
    grobo_kept kept;
    int error = links ? grobo_motion_set_ik_links(m->motion, to, link, n_links) : GROBO_OK;
    for (size_t i = 0; !error && grobo_motion_get_kept(from->of, from->n, i, &kept) == 0; i++) {
        if (links || kept.level != GROBO_KEPT_LINK) {
            error = grobo_motion_keep(m->motion, to, &kept);
        }
    }
    return error;
}

/* base, left for right, once for all keys that ask for it. */
static int mirror_base(making *m)
{
    if (m->mirrored) {
        return GROBO_OK;
    }
    int error = grobo_motion_dup(m->base, &m->mirrored);
    if (!error && grobo_motion_joints(m->mirrored) < m->model->n_joints) {
        error = grobo_motion_set_joints(m->mirrored, m->model->n_joints);
    }
    return error < 0 ? error : grobo_motion_mirror(m->mirrored, m->model);
}

/* What a key is made from. */
static int find_source(making *m, const json_t *key, source *from)
{
    const json_t *number = json_object_get(key, "from");
    json_int_t n = json_integer_value(number);
    int error = GROBO_OK;
    *from = (source){.of = NULL};
    if (!number && json_is_object(key) && !json_is_true(json_object_get(key, "mirror"))) {
        return GROBO_OK;
    }
    if (!json_is_integer(number) || !m->base || n < 0 || (size_t)n >= grobo_motion_size(m->base)) {
        return complain(m, GROBO_ERR_ARG, "from is no key of the file");
    }
    *from = (source){.of = m->base, .n = (size_t)n};
    if (json_is_true(json_object_get(key, "mirror"))) {
        error = mirror_base(m);
        from->of = m->mirrored;
    }
    return error ? complain(m, error, "it has a link that has no other side") : GROBO_OK;
}

static int append(making *m, const json_t *key, const grobo_posture *posture, double time_s)
{
    bool keys = grobo_motion_get_kind(m->motion) == GROBO_MOTION_KEYS;
    if (!(time_s >= m->before_s)) {
        return complain(m, GROBO_ERR_ARG, "it is earlier than the one before");
    }
    m->before_s = time_s;
    if (!keys && json_object_get(key, "links")) {
        return complain(m, GROBO_ERR_UNSUPPORTED, "this format has no links");
    }
    int error = grobo_motion_append_at(m->motion, time_s, posture);
    return error ? complain(m, error, grobo_error_text(error)) : GROBO_OK;
}

static int set_rest(making *m, const json_t *key, const source *from, const grobo_key_info *info)
{
    size_t n = grobo_motion_size(m->motion) - 1;
    const json_t *name = json_object_get(key, "name"), *links = json_object_get(key, "links");
    const char *text = name       ? json_string_value(name)
                       : from->of ? grobo_motion_key_name(from->of, from->n)
                                  : "";
    int error = text && *text ? grobo_motion_set_key_name(m->motion, n, text) : GROBO_OK;
    if (!error) {
        error = grobo_motion_set_key(m->motion, n, info);
    }
    if (!error && from->of) {
        error = copy_rest(m, from, n, !links);
    }
    if (!error && links) {
        return set_links(m, links, from);
    }
    return error ? complain(m, error, grobo_error_text(error)) : GROBO_OK;
}

static int add_key(making *m, const json_t *key)
{
    const json_t *time = json_object_get(key, "time_ms");
    grobo_posture posture;
    grobo_key_info info = {0};
    double time_s = json_number_value(time) / 1e3;
    source from;
    int error = check_fields(m, key, key_fields, "keys");
    if (!error) {
        error = find_source(m, key, &from);
    }
    if (error) {
        return error;
    }
    if (!from.of) {
        grobo_posture_init(&posture, m->model->n_joints);
    } else {
        grobo_motion_get(from.of, from.n, &posture);
        grobo_motion_get_key(from.of, from.n, &info);
        posture.n_joints = m->model->n_joints;
    }
    if (!time && from.of) {
        grobo_motion_time_s(from.of, from.n, &time_s);
    } else if (!json_is_number(time)) {
        return complain(m, GROBO_ERR_ARG, "it has no time_ms");
    }
    error = read_angles(m, json_object_get(key, "angle_deg"), &posture);
    if (!error) {
        error = read_info(m, key, &info);
    }
    if (!error) {
        error = append(m, key, &posture, time_s);
    }
    return error ? error : set_rest(m, key, &from, &info);
}

/* An empty motion with what base has as a whole. */
static int begin(making *m, grobo_motion_format format)
{
    int error;
    if (!m->base) { /* postures or key poses: other kinds are made of those when they are written */
        grobo_motion_kind kind = grobo_motion_format_kind(format);
        return grobo_motion_new(kind == GROBO_MOTION_POSTURES ? kind : GROBO_MOTION_KEYS,
                                m->model->n_joints, NULL, &m->motion);
    }
    error = grobo_motion_dup(m->base, &m->motion);
    if (!error) {
        while (grobo_motion_size(m->motion) > 0) { /* increments stay increments */
            grobo_motion_delete_keep_times(m->motion, grobo_motion_size(m->motion) - 1);
        }
        error = grobo_motion_joints(m->motion) < m->model->n_joints
                    ? grobo_motion_set_joints(m->motion, m->model->n_joints)
                    : 0;
    }
    return error < 0 ? error : GROBO_OK;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* By how much joints are moved at a time. */
typedef struct shift {
    double time_s, by_rad[GROBO_JOINTS_MAX];
} shift;

static double line(double a, double b, double part)
{
    return a + (b - a) * part;
}

/* Where in the way from one time to the next, which may be the same. */
static double part_of(double from_s, double to_s, double time_s)
{
    double part = to_s > from_s ? (time_s - from_s) / (to_s - from_s) : 0;
    return fmin(1, fmax(0, part));
}

/* The posture of base at a time; n: the frame before, as found for an earlier time. */
static void sample_base(const making *m, double time_s, size_t *n, grobo_posture *posture)
{
    grobo_posture next;
    double from_s, to_s = 0;
    while (*n + 2 < grobo_motion_size(m->base) &&
           grobo_motion_time_s(m->base, *n + 1, &to_s) == 0 && to_s <= time_s) {
        ++*n;
    }
    grobo_motion_get(m->base, *n, posture);
    if (grobo_motion_get(m->base, *n + 1, &next) < 0) {
        return; /* of one frame */
    }
    grobo_motion_time_s(m->base, *n, &from_s);
    grobo_motion_time_s(m->base, *n + 1, &to_s);
    double part = part_of(from_s, to_s, time_s);
    for (int j = 0; j < posture->n_joints; j++) {
        posture->angle_rad[j] = line(posture->angle_rad[j], next.angle_rad[j], part);
    }
}

/* Where a key names a joint it is as the key says; the others are as in the file. */
static int read_shift(making *m, const json_t *key, double end_s, size_t *n, shift *s)
{
    const json_t *time = json_object_get(key, "time_ms");
    grobo_posture was, wanted;
    int error = check_fields(m, key, key_fields, "keys");
    if (error) {
        return error;
    }
    s->time_s = json_number_value(time) / 1e3;
    if (!json_is_number(time) || !(s->time_s >= 0 && s->time_s <= end_s + 1e-3)) {
        return complain(m, GROBO_ERR_ARG, "it has no time_ms within the frames");
    }
    if (s->time_s < m->before_s) {
        return complain(m, GROBO_ERR_ARG, "it is earlier than the one before");
    }
    if (json_object_size(key) > 1u + (json_object_get(key, "angle_deg") != NULL)) {
        return complain(m, GROBO_ERR_UNSUPPORTED, "frames take time_ms and angle_deg alone");
    }
    m->before_s = s->time_s;
    sample_base(m, s->time_s, n, &was);
    grobo_posture_init(&wanted, m->model->n_joints);
    error = read_angles(m, json_object_get(key, "angle_deg"), &wanted);
    for (int j = 0; !error && j < m->model->n_joints; j++) {
        if (wanted.set & ~was.set & GROBO_JOINT_BIT(j)) {
            return complain(m, GROBO_ERR_NOTFOUND, "the frames have no such joint");
        }
        if (wanted.set & GROBO_JOINT_BIT(j)) {
            s->by_rad[j] = wanted.angle_rad[j] - was.angle_rad[j];
        }
    }
    return error;
}

/* A frame between two keys; one that is not moved stays as it is to the last bit. */
static int shift_frame(making *m, size_t frame, const shift *before, const shift *after)
{
    grobo_posture posture;
    double time_s;
    bool moved = false;
    grobo_motion_get(m->motion, frame, &posture);
    grobo_motion_time_s(m->motion, frame, &time_s);
    double part = part_of(before->time_s, after->time_s, time_s);
    for (int j = 0; j < posture.n_joints; j++) {
        double by_rad = line(before->by_rad[j], after->by_rad[j], part);
        if (by_rad != 0 && (posture.set & GROBO_JOINT_BIT(j))) {
            posture.angle_rad[j] += by_rad;
            moved = true;
        }
    }
    return moved ? grobo_motion_set(m->motion, frame, &posture) : GROBO_OK;
}

/*
 * Frames at a rate keep their times: keys say where joints are at some of them, and from key to key
 * what they change is carried over by a straight line.
 */
static int edit_frames(making *m, const json_t *keys)
{
    size_t count = json_array_size(keys), size = grobo_motion_size(m->base), n = 0;
    shift *shifts = calloc(count, sizeof *shifts);
    double end_s = 0, time_s = 0;
    int error = shifts ? grobo_motion_dup(m->base, &m->motion) : GROBO_ERR_NOMEM;
    if (!error && size > 0) {
        grobo_motion_time_s(m->base, size - 1, &end_s);
    }
    for (m->key = 0; !error && m->key < count; m->key++) {
        error = read_shift(m, json_array_get(keys, m->key), end_s, &n, &shifts[m->key]);
    }
    for (size_t i = 0, k = 0; !error && i < size; i++) {
        grobo_motion_time_s(m->base, i, &time_s);
        while (k + 1 < count && shifts[k + 1].time_s <= time_s) {
            k++;
        }
        error = shift_frame(m, i, &shifts[k], &shifts[k + 1 < count ? k + 1 : k]);
    }
    free(shifts);
    return error;
}

static const field edit_fields[] = {
    {.name = "keys", .kind = FIELD_LIST, .needed = true},
    {.name = "base", .kind = FIELD_OBJECT}, /* of a PUT, which reads it */
    {.name = "kind", .kind = FIELD_WORD, .words = "postures, keys, steps, frames"},
    {.name = NULL}};

int edit_apply(const json_t *edit, const grobo_model *model, const grobo_motion *base,
               grobo_motion_format format, edit_result *result)
{
    const json_t *keys = json_object_get(edit, "keys");
    making m = {.model = model, .base = base, .before_s = -INFINITY, .result = result};
    if (!fields_fit(edit, edit_fields, "edit", result->complaint)) {
        return GROBO_ERR_ARG;
    }
    if (json_array_size(keys) == 0) {
        snprintf(result->complaint, sizeof result->complaint, "keys is no list of key poses");
        return GROBO_ERR_EMPTY;
    }
    bool frames = base && grobo_motion_get_kind(base) == GROBO_MOTION_FRAMES;
    int error = frames ? edit_frames(&m, keys) : begin(&m, format);
    for (m.key = 0; !frames && !error && m.key < json_array_size(keys); m.key++) {
        error = add_key(&m, json_array_get(keys, m.key));
    }
    grobo_motion_free(m.mirrored);
    if (error) {
        grobo_motion_free(m.motion);
        return error;
    }
    result->motion = m.motion;
    return GROBO_OK;
}

/* ---- as a file ------------------------------------------------------------------------------- */

static int put(void *ctx, const void *bytes, size_t size)
{
    heap *to = ctx;
    return to->size + size > LIBRARY_FILE_BYTES ? GROBO_ERR_CAP : heap_sink(to, bytes, size);
}

int edit_write(const grobo_motion *motion, grobo_motion_format format, const grobo_model *model,
               grobo_diagnostics *lost, char **bytes, size_t *size)
{
    heap to = {0};
    grobo_sink sink = {.write = put, .ctx = &to};
    grobo_write_options how = {GROBO_WRITE_OPTIONS_INIT, .model = model,
                               .exact = format == GROBO_FORMAT_M &&
                                        grobo_motion_get_kind(motion) == GROBO_MOTION_POSTURES};
    int error = grobo_motion_write(motion, format, &how, &sink, lost);
    if (error < 0) {
        free(to.bytes);
        return error;
    }
    *bytes = to.bytes;
    *size = to.size;
    return GROBO_OK;
}

/* Frames of many hours: refused before there is memory for them. A number has 2 bytes at least. */
static bool is_too_long(const grobo_motion *motion, grobo_motion_format format)
{
    double length_s = (double)grobo_motion_length_us(motion, -1) / 1e6;
    return format == GROBO_FORMAT_YAML && grobo_motion_get_kind(motion) != GROBO_MOTION_FRAMES &&
           length_s * GROBO_MOTION_RATE_HZ * 2 * grobo_motion_joints(motion) > LIBRARY_FILE_BYTES;
}

/* Targets of legs become angles, where the format has no place for them. 0 or the status. */
static int solve_legs(app *a, const char *name, grobo_motion_format format,
                      const grobo_motion *motion, grobo_motion **solved)
{
    double rate_hz = format == GROBO_FORMAT_YAML ? GROBO_MOTION_RATE_HZ : 0;
    return format == GROBO_FORMAT_PSEQ ? 0
                                       : body_solve(a, PLAY_BODY, name, motion, rate_hz, solved);
}

int edit_file(app *a, const char *name, const grobo_motion *motion, grobo_diagnostics *lost,
              char **bytes, size_t *size)
{
    grobo_motion_format format = grobo_motion_format_of_path(name);
    grobo_motion *solved = NULL;
    int error = GROBO_OK;
    if (is_too_long(motion, format)) {
        error = GROBO_ERR_CAP;
    } else if (solve_legs(a, name, format, motion, &solved)) {
        error = GROBO_ERR_UNREACHABLE;
    } else {
        error = edit_write(solved ? solved : motion, format, app_model(a), lost, bytes, size);
    }
    grobo_motion_free(solved);
    return error;
}
