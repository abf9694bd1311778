/* SPDX-License-Identifier: MIT */
/* What a caller sees and sets of a key pose beside its angles. */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/store/container.h"
#include "src/motion/text/utf8.h"

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
    if (motion == NULL || info == NULL) {
        return GROBO_ERR_ARG;
    }
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
    if (motion == NULL || info == NULL) {
        return GROBO_ERR_ARG;
    }
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
    if (motion == NULL) {
        return NULL;
    }
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL || (*row.extra)->name == NULL) {
        return "";
    }
    return (*row.extra)->name;
}

int grobo_motion_set_key_name(grobo_motion *motion, size_t n, const char *name)
{
    if (motion == NULL || name == NULL) {
        return GROBO_ERR_ARG;
    }
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
    if (motion == NULL || count == NULL) {
        return NULL;
    }
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row) || *row.extra == NULL) {
        *count = 0;
        return NULL;
    }
    *count = (*row.extra)->n_links;
    return (*row.extra)->links;
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
    if ((links == NULL && count > 0) || motion == NULL) {
        return GROBO_ERR_ARG;
    }
    size_t bytes = count * sizeof *links;
    grobo_ik_link *copy = NULL;
    grobo_i_row row;

    if (!grobo_i_row_at(motion, n, &row)) {
        return GROBO_ERR_ARG;
    }
    int result = check_links(links, count);
    if (result < 0) {
        return result;
    }
    if (count > 0) {
        copy = grobo_i_alloc(motion->mem, bytes);
        if (copy == NULL) {
            return GROBO_ERR_NOMEM;
        }
        memcpy(copy, links, bytes);
    }
    grobo_i_extra *extra = grobo_i_extra_of(motion->mem, &row);
    if (extra == NULL) {
        grobo_i_free(motion->mem, copy, bytes);
        return GROBO_ERR_NOMEM;
    }
    grobo_i_free(motion->mem, extra->links, extra->n_links * sizeof *extra->links);
    grobo_i_drop_kept(motion->mem, &extra->kept, GROBO_KEPT_LINK);
    extra->links = copy;
    extra->n_links = (uint8_t)count;
    return 0;
}

/* ---- kept keys ---------------------------------------------------------------------------- */

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
    if (motion == NULL) {
        return 0;
    }
    grobo_i_kept *const *list = kept_list(motion, n);
    size_t count = 0;

    for (const grobo_i_kept *kept = list != NULL ? *list : NULL; kept != NULL; kept = kept->next) {
        count++;
    }
    return count;
}

int grobo_motion_get_kept(const grobo_motion *motion, size_t n, size_t i, grobo_kept *kept)
{
    if (motion == NULL || kept == NULL) {
        return GROBO_ERR_ARG;
    }
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
    if (motion == NULL || kept == NULL) {
        return GROBO_ERR_ARG;
    }
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
