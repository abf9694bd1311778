/* SPDX-License-Identifier: MIT */
/* What a key pose has beside its angles: times and points, link targets, kept keys, a name. */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/store/container.h"
#include "src/motion/text/utf8.h"

/* Texts of one kept key, names included, with their NULs. */
enum { KEPT_MAX_BYTES = GROBO_YAML_SCALAR_MAX_BYTES + GROBO_YAML_KEY_MAX_BYTES };

grobo_i_extra *grobo_i_extra_of(const grobo_mem *mem, const grobo_i_row *row)
{
    if (*row->extra == NULL) {
        *row->extra = grobo_i_new(mem, sizeof **row->extra);
    }
    return *row->extra;
}

void grobo_i_forget_positions(const grobo_mem *mem, grobo_i_extra *extra)
{
    grobo_i_free(mem, extra->positions, extra->n_positions * 2 * sizeof *extra->positions);
    extra->positions = NULL;
    extra->n_positions = 0;
}

void grobo_i_extra_free(const grobo_mem *mem, grobo_i_extra *extra)
{
    if (extra == NULL) {
        return;
    }
    grobo_i_free(mem, extra->links, extra->n_links * sizeof *extra->links);
    grobo_i_forget_positions(mem, extra);
    grobo_i_free_text(mem, extra->name);
    grobo_i_kept_free(mem, extra->kept);
    grobo_i_free(mem, extra, sizeof *extra);
}

static void *copy_block(const grobo_mem *mem, const void *from, size_t bytes, bool *failed)
{
    if (from == NULL || bytes == 0) {
        return NULL;
    }
    void *copy = grobo_i_alloc(mem, bytes);
    if (copy == NULL) {
        *failed = true;
        return NULL;
    }
    memcpy(copy, from, bytes);
    return copy;
}

grobo_i_extra *grobo_i_extra_dup(const grobo_mem *mem, const grobo_i_extra *from)
{
    bool failed = false;
    grobo_i_extra *copy = copy_block(mem, from, sizeof *from, &failed);

    if (copy == NULL) {
        return NULL;
    }
    copy->kept = NULL;
    copy->links = copy_block(mem, from->links, from->n_links * sizeof *from->links, &failed);
    copy->positions =
        copy_block(mem, from->positions, from->n_positions * 2 * sizeof *from->positions, &failed);
    copy->name = NULL;
    if (from->name != NULL) {
        copy->name = copy_block(mem, from->name, strlen(from->name) + 1, &failed);
    }
    if (failed || grobo_i_kept_dup(mem, from->kept, &copy->kept) < 0) {
        grobo_i_extra_free(mem, copy);
        return NULL;
    }
    return copy;
}

/* ---- kept keys ---------------------------------------------------------------------------- */

void grobo_i_kept_free(const grobo_mem *mem, grobo_i_kept *list)
{
    while (list != NULL) {
        grobo_i_kept *next = list->next;
        grobo_i_free(mem, list, sizeof *list + list->key_bytes + list->value_bytes);
        list = next;
    }
}

static bool comes_before(const grobo_kept *a, const grobo_i_kept *b)
{
    return a->level < b->level || (a->level == b->level && a->link < b->link);
}

int grobo_i_kept_add(const grobo_mem *mem, grobo_i_kept **list, const grobo_kept *kept)
{
    size_t key_bytes = strlen(kept->key) + 1;
    size_t value_bytes = strlen(kept->value) + 1;

    if (key_bytes > GROBO_YAML_KEY_MAX_BYTES || value_bytes > KEPT_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    /* By level and link, so that equal keys are equal lists, wherever a file has them. */
    while (*list != NULL && !comes_before(kept, *list)) {
        const grobo_i_kept *old = *list;
        if (old->level == kept->level && old->link == kept->link &&
            strcmp(old->text, kept->key) == 0) {
            return GROBO_ERR_EXISTS;
        }
        list = &(*list)->next;
    }
    grobo_i_kept *made = grobo_i_alloc(mem, sizeof *made + key_bytes + value_bytes);
    if (made == NULL) {
        return GROBO_ERR_NOMEM;
    }
    made->next = *list;
    made->key_bytes = key_bytes;
    made->value_bytes = value_bytes;
    made->level = kept->level;
    made->link = kept->link;
    memcpy(made->text, kept->key, key_bytes);
    memcpy(made->text + key_bytes, kept->value, value_bytes);
    *list = made;
    return 0;
}

int grobo_i_kept_dup(const grobo_mem *mem, const grobo_i_kept *from, grobo_i_kept **list)
{
    grobo_i_kept *head = NULL;
    grobo_i_kept **end = &head;

    for (; from != NULL; from = from->next) {
        size_t bytes = sizeof *from + from->key_bytes + from->value_bytes;
        grobo_i_kept *copy = grobo_i_alloc(mem, bytes);
        if (copy == NULL) {
            grobo_i_kept_free(mem, head);
            return GROBO_ERR_NOMEM;
        }
        memcpy(copy, from, bytes);
        copy->next = NULL;
        *end = copy;
        end = &copy->next;
    }
    *list = head;
    return 0;
}

bool grobo_i_kept_equal(const grobo_i_kept *a, const grobo_i_kept *b)
{
    while (a != NULL && b != NULL) {
        if (a->level != b->level || a->link != b->link || a->key_bytes != b->key_bytes ||
            a->value_bytes != b->value_bytes ||
            memcmp(a->text, b->text, a->key_bytes + a->value_bytes) != 0) {
            return false;
        }
        a = a->next;
        b = b->next;
    }
    return a == b;
}

static grobo_i_kept *const *kept_list(const grobo_motion *motion, size_t n)
{
    grobo_i_row row;

    if (n == GROBO_MOTION_TOP) {
        return &motion->kept;
    }
    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL) {
        return NULL;
    }
    return &(*row.extra)->kept;
}

size_t grobo_motion_kept_count(const grobo_motion *motion, size_t n)
{
    grobo_i_kept *const *list = kept_list(motion, n);
    size_t count = 0;

    for (const grobo_i_kept *kept = list != NULL ? *list : NULL; kept != NULL; kept = kept->next) {
        count++;
    }
    return count;
}

int grobo_motion_get_kept(const grobo_motion *motion, size_t n, size_t i, grobo_kept *kept)
{
    grobo_i_kept *const *list = kept_list(motion, n);
    const grobo_i_kept *found = list != NULL ? *list : NULL;

    while (found != NULL && i > 0) {
        found = found->next;
        i--;
    }
    if (found == NULL) {
        return GROBO_ERR_ARG;
    }
    kept->key = found->text;
    kept->value = found->text + found->key_bytes;
    kept->level = found->level;
    kept->link = found->link;
    return 0;
}

int grobo_motion_keep(grobo_motion *motion, size_t n, const grobo_kept *kept)
{
    bool top = n == GROBO_MOTION_TOP;
    bool of_top = kept->level == GROBO_KEPT_TOP || kept->level == GROBO_KEPT_COMPONENT;
    grobo_i_row row;

    if (kept->key == NULL || kept->value == NULL || top != of_top ||
        !grobo_i_utf8_ok(kept->key, strlen(kept->key)) ||
        !grobo_i_utf8_ok(kept->value, strlen(kept->value))) {
        return GROBO_ERR_ARG;
    }
    if (top) {
        return grobo_i_kept_add(motion->mem, &motion->kept, kept);
    }
    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    if (kept->level == GROBO_KEPT_LINK &&
        (*row.extra == NULL || kept->link >= (*row.extra)->n_links)) {
        return GROBO_ERR_ARG;
    }
    grobo_i_extra *extra = grobo_i_extra_of(motion->mem, &row);
    return extra == NULL ? GROBO_ERR_NOMEM : grobo_i_kept_add(motion->mem, &extra->kept, kept);
}

/* ---- details, links, names ---------------------------------------------------------------- */

static bool all_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i])) {
            return false;
        }
    }
    return true;
}

/* Finite numbers only. */
static bool link_ok(const grobo_ik_link *link)
{
    return all_finite(link->translation_m, 3) && all_finite(link->rotation, 9) &&
           (!link->has_parting_direction || all_finite(link->parting_direction, 3));
}

int grobo_motion_get_key(const grobo_motion *motion, size_t n, grobo_key_info *info)
{
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    if (*row.extra != NULL) {
        *info = (*row.extra)->info;
    } else {
        memset(info, 0, sizeof *info);
    }
    return 0;
}

int grobo_motion_set_key(grobo_motion *motion, size_t n, const grobo_key_info *info)
{
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    if (!isfinite(info->max_transition_s) || (info->has_zmp && !all_finite(info->zmp_m, 3))) {
        return GROBO_ERR_NAN;
    }
    if (info->max_transition_s < 0 || info->max_transition_s > GROBO_I_TIME_MAX_S) {
        return GROBO_ERR_ARG;
    }
    grobo_i_extra *extra = grobo_i_extra_of(motion->mem, &row);
    if (extra == NULL) {
        return GROBO_ERR_NOMEM;
    }
    extra->info = *info;
    return 0;
}

const char *grobo_motion_key_name(const grobo_motion *motion, size_t n)
{
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL || (*row.extra)->name == NULL) {
        return "";
    }
    return (*row.extra)->name;
}

int grobo_motion_set_key_name(grobo_motion *motion, size_t n, const char *name)
{
    size_t length = strlen(name);
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || !grobo_i_utf8_ok(name, length)) {
        return GROBO_ERR_ARG;
    }
    if (length >= GROBO_YAML_SCALAR_MAX_BYTES) {
        return GROBO_ERR_CAP;
    }
    grobo_i_extra *extra = grobo_i_extra_of(motion->mem, &row);
    char *copy = extra != NULL ? grobo_i_copy_text(motion->mem, name, length) : NULL;
    if (copy == NULL) {
        return GROBO_ERR_NOMEM;
    }
    grobo_i_free_text(motion->mem, extra->name);
    extra->name = copy;
    return 0;
}

const grobo_ik_link *grobo_motion_ik_links(const grobo_motion *motion, size_t n, size_t *count)
{
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL) {
        *count = 0;
        return NULL;
    }
    *count = (*row.extra)->n_links;
    return (*row.extra)->links;
}

void grobo_i_drop_kept(const grobo_mem *mem, grobo_i_kept **list, grobo_kept_level level)
{
    while (*list != NULL) {
        grobo_i_kept *kept = *list;
        if (kept->level == level) {
            *list = kept->next;
            kept->next = NULL;
            grobo_i_kept_free(mem, kept);
        } else {
            list = &kept->next;
        }
    }
}

static int check_links(const grobo_ik_link *links, size_t count)
{
    if (count > GROBO_IK_LINKS_MAX) {
        return GROBO_ERR_CAP;
    }
    for (size_t i = 0; i < count; i++) {
        const char *end = memchr(links[i].name, 0, sizeof links[i].name);
        if (end == NULL || !grobo_i_utf8_ok(links[i].name, (size_t)(end - links[i].name)) ||
            links[i].index < -1) {
            return GROBO_ERR_ARG;
        }
        if (!link_ok(&links[i])) {
            return GROBO_ERR_NAN;
        }
    }
    return 0;
}

int grobo_motion_set_ik_links(grobo_motion *motion, size_t n, const grobo_ik_link *links,
                              size_t count)
{
    bool failed = false;
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    int result = check_links(links, count);
    if (result < 0) {
        return result;
    }
    grobo_ik_link *copy = copy_block(motion->mem, links, count * sizeof *links, &failed);
    grobo_i_extra *extra = failed ? NULL : grobo_i_extra_of(motion->mem, &row);
    if (extra == NULL) {
        grobo_i_free(motion->mem, copy, count * sizeof *links);
        return GROBO_ERR_NOMEM;
    }
    grobo_i_free(motion->mem, extra->links, extra->n_links * sizeof *extra->links);
    grobo_i_drop_kept(motion->mem, &extra->kept, GROBO_KEPT_LINK);
    extra->links = copy;
    extra->n_links = (uint8_t)count;
    return 0;
}

/* ---- comparing ---------------------------------------------------------------------------- */

static bool same_doubles(const double *a, const double *b, size_t count)
{
    return memcmp(a, b, count * sizeof *a) == 0;
}

static bool link_equal(const grobo_ik_link *a, const grobo_ik_link *b)
{
    return same_doubles(a->translation_m, b->translation_m, 3) &&
           same_doubles(a->rotation, b->rotation, 9) && a->index == b->index &&
           strcmp(a->name, b->name) == 0 && a->is_base == b->is_base &&
           a->is_stationary == b->is_stationary && a->is_touching == b->is_touching &&
           a->is_slave == b->is_slave && a->has_parting_direction == b->has_parting_direction &&
           (!a->has_parting_direction ||
            same_doubles(a->parting_direction, b->parting_direction, 3));
}

static bool info_equal(const grobo_key_info *a, const grobo_key_info *b)
{
    return same_doubles(&a->max_transition_s, &b->max_transition_s, 1) &&
           a->stationary == b->stationary && a->has_zmp == b->has_zmp &&
           a->zmp_stationary == b->zmp_stationary &&
           (!a->has_zmp || same_doubles(a->zmp_m, b->zmp_m, 3));
}

bool grobo_i_extra_equal(const grobo_i_extra *a, const grobo_i_extra *b)
{
    static const grobo_i_extra nothing;

    a = a != NULL ? a : &nothing;
    b = b != NULL ? b : &nothing;
    if (!info_equal(&a->info, &b->info) || a->n_links != b->n_links ||
        strcmp(a->name != NULL ? a->name : "", b->name != NULL ? b->name : "") != 0 ||
        !grobo_i_kept_equal(a->kept, b->kept)) {
        return false;
    }
    for (size_t i = 0; i < a->n_links; i++) {
        if (!link_equal(&a->links[i], &b->links[i])) {
            return false;
        }
    }
    return true;
}
