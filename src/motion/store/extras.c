/* SPDX-License-Identifier: MIT */
/* What a key pose has beside its angles: times and points, link targets, kept keys, a name. */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/store/container.h"

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
