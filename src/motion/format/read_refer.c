/* SPDX-License-Identifier: MIT */
/* A pose: the value of `refer`. */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/pose.h"

static int read_list(grobo_i_events *events, const char *what, grobo_i_pose_list *list)
{
    grobo_i_numbers numbers = {list->values, list->places, 0, GROBO_JOINTS_MAX, 0};
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    list->place = event->place;
    list->given = result == 0 && !grobo_i_is_null(event);
    if (result == 0) {
        result = grobo_i_read_numbers(events, what, &numbers);
    }
    list->count = numbers.count;
    return result;
}

/* A list of joints: one that cannot be becomes -1. */
static int read_joint_list(grobo_i_events *events, const char *what, grobo_i_pose_list *list)
{
    int result = read_list(events, what, list);

    for (int i = 0; i < list->count && result == 0; i++) {
        double joint = list->values[i];
        if (joint >= 0 && joint < GROBO_JOINTS_MAX && joint == (int)joint) {
            continue;
        }
        list->values[i] = -1;
        bool large = joint >= GROBO_JOINTS_MAX;
        result = grobo_i_complain(
            events->reader, large ? GROBO_ERR_CAP : GROBO_ERR_SYNTAX, "joints", list->places[i],
            large ? "%s: joints go up to %d" : "%s: a joint is a whole number from 0 to %d", what,
            GROBO_JOINTS_MAX - 1);
    }
    return result;
}

/* How many joints a line has, so that what is written looks like what was read. */
static void note_layout(grobo_motion *motion, const grobo_i_pose_list *list)
{
    const grobo_i_place *at = list->places;

    if (list->count > GROBO_I_LINE_ITEMS_OLD && at[0].line == at[GROBO_I_LINE_ITEMS_OLD - 1].line &&
        at[0].line < at[GROBO_I_LINE_ITEMS_OLD].line) {
        motion->line_items = GROBO_I_LINE_ITEMS_OLD;
    }
}

static int read_joints(grobo_i_events *events, void *target)
{
    grobo_i_pose_list *joints = &((grobo_i_pose_ref *)target)->joints;
    int result = read_joint_list(events, "joints", joints);

    note_layout(events->reader->motion, joints);
    return result;
}

static int read_q(grobo_i_events *events, void *target)
{
    return read_list(events, "q", &((grobo_i_pose_ref *)target)->q);
}

static int read_sp_joints(grobo_i_events *events, void *target)
{
    grobo_i_pose_ref *ref = target;
    grobo_i_pose_list list;
    int result = read_joint_list(events, "spJoints", &list);

    for (int i = 0; i < list.count; i++) {
        if (list.values[i] >= 0) {
            ref->info.stationary |= GROBO_JOINT_BIT((unsigned)list.values[i]);
        }
    }
    return result;
}

static int read_ik_links(grobo_i_events *events, void *target)
{
    return grobo_i_read_list(events, "ikLinks", grobo_i_read_link, target);
}

static int read_pose_type(grobo_i_events *events, void *target)
{
    grobo_i_pose_ref *ref = target;
    char *type = NULL;
    int result = grobo_i_read_string(events, "type", &type);

    if (type != NULL) {
        size_t length = strlen(type);
        length = length < sizeof ref->type_text ? length : sizeof ref->type_text - 1;
        memcpy(ref->type_text, type, length);
        ref->type_text[length] = '\0';
        ref->type = strcmp(type, "Pose") == 0     ? GROBO_I_POSE
                    : strcmp(type, "Motion") == 0 ? GROBO_I_INCREMENTS
                    : type[0] != '\0'             ? GROBO_I_OTHER
                                                  : GROBO_I_UNTYPED;
        grobo_i_free_text(events->reader->mem, type);
    }
    return result;
}

static int read_pose_name(grobo_i_events *events, void *target)
{
    return grobo_i_read_string(events, "name", &((grobo_i_pose_ref *)target)->name);
}

static int read_zmp(grobo_i_events *events, void *target)
{
    grobo_i_pose_ref *ref = target;

    ref->info.has_zmp = true;
    return grobo_i_read_doubles(events, "zmp", ref->info.zmp_m, 3);
}

static int read_zmp_stationary(grobo_i_events *events, void *target)
{
    return grobo_i_read_bool(events, "isZmpStationaryPoint",
                             &((grobo_i_pose_ref *)target)->info.zmp_stationary);
}

static int keep_pose_key(grobo_i_events *events, void *target, const char *key)
{
    return grobo_i_keep_value(events, &((grobo_i_pose_ref *)target)->kept,
                              &(grobo_kept){.key = key, .level = GROBO_KEPT_POSE});
}

static const grobo_i_field pose_fields[] = {
    {"type", NULL, read_pose_type},
    {"name", NULL, read_pose_name},
    {"joints", NULL, read_joints},
    {"q", NULL, read_q},
    {"spJoints", NULL, read_sp_joints},
    {"ikLinks", NULL, read_ik_links},
    {"zmp", NULL, read_zmp},
    {"isZmpStationaryPoint", NULL, read_zmp_stationary},
};
enum { HAS_ZMP_STATIONARY = 1 << 7 };

/* The name of an earlier pose, as Choreonoid wrote up to 1.7. */
static int read_refer_by_name(grobo_i_events *events, grobo_i_pose_ref *ref)
{
    char *name = NULL;
    int result = grobo_i_read_string(events, "refer", &name);

    if (result < 0 || name == NULL) {
        return result;
    }
    ref->same_as = grobo_i_pose_named(ref->document, name);
    if (ref->same_as == 0) {
        ref->failed = true;
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "refer", ref->refer_place,
                                  "no pose '%.40s' before this", name);
    }
    grobo_i_free_text(events->reader->mem, name);
    return result;
}

int grobo_i_read_refer(grobo_i_events *events, void *target)
{
    static const grobo_i_fields fields = {
        "a pose", pose_fields, sizeof pose_fields / sizeof pose_fields[0], keep_pose_key};
    grobo_i_pose_ref *ref = target;
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    ref->refer_place = event->place;
    if (grobo_i_is_null(event)) {
        return grobo_i_next(events, &event);
    }
    ref->has_refer = true;
    if (event->kind == GROBO_I_SCALAR) {
        return read_refer_by_name(events, ref);
    }
    if (event->kind != GROBO_I_MAP) {
        ref->failed = true;
    }
    result = grobo_i_read_map(events, &fields, ref, &seen);
    if (result == 0 && ref->info.has_zmp && (seen & HAS_ZMP_STATIONARY) == 0) {
        ref->info.zmp_stationary = true; /* as Choreonoid takes it */
    }
    return result;
}
