/* SPDX-License-Identifier: MIT */
/* Poses by name: up to Choreonoid 1.7 a ref may say the name of an earlier pose. */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/pose.h"

/* The slot of a name: its own, or the free one where it belongs. */
static struct grobo_i_pose_slot *slot_of(const grobo_i_document *document, const char *name)
{
    const grobo_i_pose_names *names = &document->names;
    uint64_t hash = grobo_i_hash(name);
    size_t i = (size_t)hash & (names->room - 1);

    while (names->slots[i].pose != 0 &&
           (names->slots[i].hash != hash ||
            strcmp(grobo_motion_key_name(document->reader->motion, names->slots[i].pose - 1),
                   name) != 0)) {
        i = (i + 1) & (names->room - 1);
    }
    names->slots[i].hash = hash;
    return &names->slots[i];
}

void grobo_i_pose_names_free(grobo_i_document *document)
{
    grobo_i_free(document->reader->mem, document->names.slots,
                 document->names.room * sizeof *document->names.slots);
}

static int grow_names(grobo_i_document *document)
{
    grobo_i_pose_names old = document->names;
    grobo_i_pose_names *names = &document->names;
    size_t room = old.room == 0 ? 64 : old.room * 2;

    if (old.count * 2 < old.room) {
        return 0;
    }
    struct grobo_i_pose_slot *slots = grobo_i_new(document->reader->mem, room * sizeof *slots);
    if (slots == NULL) {
        return GROBO_ERR_NOMEM;
    }
    names->slots = slots;
    names->room = room;
    for (size_t i = 0; i < old.room; i++) {
        size_t at = (size_t)old.slots[i].hash & (room - 1);
        while (old.slots[i].pose != 0 && slots[at].pose != 0) {
            at = (at + 1) & (room - 1);
        }
        if (old.slots[i].pose != 0) {
            slots[at] = old.slots[i];
        }
    }
    grobo_i_free(document->reader->mem, old.slots, old.room * sizeof *old.slots);
    return 0;
}

int grobo_i_name_pose(grobo_i_document *document, const char *name, size_t n)
{
    int result = grow_names(document);

    if (result < 0) {
        return result;
    }
    struct grobo_i_pose_slot *slot = slot_of(document, name);
    document->names.count += slot->pose == 0;
    slot->pose = n + 1;
    return 0;
}

size_t grobo_i_pose_named(const grobo_i_document *document, const char *name)
{
    return document->names.room > 0 ? slot_of(document, name)->pose : 0;
}
