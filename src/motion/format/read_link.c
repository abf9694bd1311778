/* SPDX-License-Identifier: MIT */
/* Entries of ikLinks. */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/pose.h"

/* An entry of ikLinks while it is read. */
typedef struct link_entry {
    grobo_i_pose_ref *ref;
    grobo_ik_link *link;
    bool has_translation, has_rotation; /* each with all its numbers */
} link_entry;

static int read_link_name(grobo_i_events *events, void *target)
{
    grobo_ik_link *link = ((link_entry *)target)->link;
    const grobo_i_event *event;
    char *name = NULL;
    int result = grobo_i_peek(events, &event);
    grobo_i_place place = event->place;

    if (result == 0) {
        result = grobo_i_read_string(events, "name of a link", &name);
    }
    if (result < 0 || name == NULL) {
        return result;
    }
    size_t length = strlen(name);
    if (length < sizeof link->name) {
        memcpy(link->name, name, length + 1);
    } else {
        result = grobo_i_complain(events->reader, GROBO_ERR_CAP, "name-length", place,
                                  "a link's name longer than %d bytes", GROBO_NAME_MAX_BYTES - 1);
    }
    grobo_i_free_text(events->reader->mem, name);
    return result;
}

static int read_link_index(grobo_i_events *events, void *target)
{
    grobo_ik_link *link = ((link_entry *)target)->link;
    long index = link->index;
    int result = grobo_i_read_long(events, "index of a link", 0, 1000000, &index);

    link->index = (int)index;
    return result;
}

static int read_is_base(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "isBaseLink", &((link_entry *)target)->link->is_base);
}

static int read_is_stationary(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "isStationaryPoint",
                             &((link_entry *)target)->link->is_stationary);
}

static int read_is_touching(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "isTouching", &((link_entry *)target)->link->is_touching);
}

static int read_is_slave(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "isSlave", &((link_entry *)target)->link->is_slave);
}

/* A list of another length makes the link unusable, not the file. */
static int read_matrix(grobo_i_events *events, const char *what, double *values, int count,
                       bool *whole)
{
    double found[16];
    grobo_i_numbers list = {found, NULL, 0, sizeof found / sizeof found[0], 0};
    int result = grobo_i_read_numbers(events, what, &list);

    *whole = result == 0 && list.count == count;
    if (*whole) {
        memcpy(values, found, (size_t)count * sizeof *values);
    }
    return result;
}

static int read_translation(grobo_i_events *events, void *target)
{
    link_entry *entry = target;

    return read_matrix(events, "translation", entry->link->translation_m, 3,
                       &entry->has_translation);
}

static int read_rotation(grobo_i_events *events, void *target)
{
    link_entry *entry = target;

    return read_matrix(events, "rotation", entry->link->rotation, 9, &entry->has_rotation);
}

static int read_parting_direction(grobo_i_events *events, void *target)
{
    grobo_ik_link *link = ((link_entry *)target)->link;

    link->has_parting_direction = true;
    return grobo_i_read_doubles(events, "partingDirection", link->parting_direction, 3);
}

static int keep_link_key(grobo_i_events *events, void *target, const char *key)
{
    grobo_i_pose_ref *ref = ((link_entry *)target)->ref;

    return grobo_i_keep_value(
        events, &ref->kept,
        &(grobo_kept){.key = key, .level = GROBO_KEPT_LINK, .link = ref->n_links});
}

static const grobo_i_field link_fields[] = {
    {"translation", NULL, read_translation},
    {"rotation", NULL, read_rotation},
    {"name", NULL, read_link_name},
    {"index", NULL, read_link_index},
    {"isBaseLink", NULL, read_is_base},
    {"isStationaryPoint", NULL, read_is_stationary},
    {"isTouching", NULL, read_is_touching},
    {"isSlave", NULL, read_is_slave},
    {"partingDirection", NULL, read_parting_direction},
};

/* Unknown keys of a link that is left out go with it. */
static void drop_link(grobo_i_pose_ref *ref)
{
    grobo_i_kept **list = &ref->kept;

    while (*list != NULL) {
        grobo_i_kept *kept = *list;
        if (kept->level == GROBO_KEPT_LINK && kept->link == ref->n_links) {
            *list = kept->next;
            kept->next = NULL;
            grobo_i_kept_free(ref->document->reader->mem, kept);
        } else {
            list = &kept->next;
        }
    }
}

int grobo_i_read_link(grobo_i_events *events, void *target)
{
    static const grobo_i_fields fields = {"a link of ikLinks", link_fields,
                                          sizeof link_fields / sizeof link_fields[0],
                                          keep_link_key};
    grobo_i_pose_ref *ref = target;
    link_entry entry = {ref, &ref->links[ref->n_links], false, false};
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(events, &event);
    grobo_i_place place = event->place;

    if (result == 0 && ref->n_links == GROBO_IK_LINKS_MAX) {
        return grobo_i_refuse(events->reader, GROBO_ERR_CAP, "ik-links", place,
                              "more than %d ikLinks", GROBO_IK_LINKS_MAX);
    }
    memset(entry.link, 0, sizeof *entry.link);
    entry.link->index = -1;
    bool is_map = result == 0 && event->kind == GROBO_I_MAP;
    if (result == 0) {
        result = grobo_i_read_map(events, &fields, &entry, &seen);
    }
    bool named = entry.link->name[0] != '\0' || entry.link->index >= 0;
    if (result < 0 || !is_map) {
        return result;
    }
    if (!named || !entry.has_translation || !entry.has_rotation) {
        grobo_i_warn(events->reader, "link-skipped", place,
                     "a link of ikLinks without a name or index, a translation of 3 and a rotation "
                     "of 9 numbers is skipped");
        drop_link(ref);
        return 0;
    }
    ref->n_links++;
    return 0;
}
