/* SPDX-License-Identifier: MIT */
/* refs of .pseq and .mseq: key poses and increments. */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/pose.h"

static int complain_range(grobo_i_events *events, grobo_i_place place, const char *what)
{
    return grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "time-range", place,
                            "%s beyond 10^9 seconds", what);
}

static int read_time(grobo_i_events *events, void *target)
{
    grobo_i_pose_ref *ref = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    grobo_i_place place = event->place;

    ref->has_time = true;
    if (result == 0) {
        result = grobo_i_read_double(events, "time", &ref->time_s);
    }
    if (result == 0) {
        result = grobo_i_take_time(events->reader, &ref->time_s, ref->time_s, place);
    }
    return result;
}

static int read_max_transition(grobo_i_events *events, void *target)
{
    grobo_i_pose_ref *ref = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);
    grobo_i_place place = event->place;

    if (result == 0) {
        result = grobo_i_read_double(events, "maxTransitionTime", &ref->info.max_transition_s);
    }
    if (result == 0 && ref->info.max_transition_s < 0) {
        ref->info.max_transition_s = 0;
        grobo_i_warn(events->reader, "max-transition", place,
                     "a negative maxTransitionTime has no effect");
    }
    if (result == 0 && ref->info.max_transition_s > GROBO_I_TIME_MAX_S) {
        ref->info.max_transition_s = 0;
        result = complain_range(events, place, "a transition");
    }
    return result;
}

static int keep_ref_key(grobo_i_events *events, void *target, const char *key)
{
    return grobo_i_keep_value(events, &((grobo_i_pose_ref *)target)->kept,
                              &(grobo_kept){.key = key, .level = GROBO_KEPT_REF});
}

static const grobo_i_field ref_fields[] = {
    {"time", NULL, read_time},
    {"maxTransitionTime", NULL, read_max_transition},
    {"refer", NULL, grobo_i_read_refer},
};

/* What must be there is, and joints and q fit together. */
static int check_ref(grobo_i_pose_ref *ref)
{
    grobo_i_reader *reader = ref->document->reader;
    const grobo_i_pose_list *joints = &ref->joints, *q = &ref->q;

    if (!ref->has_time || !ref->has_refer) {
        ref->failed = true;
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "key-missing", ref->place,
                                "a ref without '%s'", ref->has_time ? "refer" : "time");
    }
    if (ref->failed || ref->same_as > 0) {
        return 0;
    }
    if (ref->type == GROBO_I_UNTYPED) {
        ref->failed = true;
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "key-missing", ref->refer_place,
                                "a pose without 'type'");
    }
    if (joints->given != q->given) {
        ref->failed = true;
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "key-missing", ref->refer_place,
                                "a pose with '%s' and without '%s'", joints->given ? "joints" : "q",
                                joints->given ? "q" : "joints");
    }
    if (joints->count != q->count) {
        ref->failed = true;
        return grobo_i_complain(
            reader, GROBO_ERR_SYNTAX, "q-length", q->place, "q has %d number%s for %d joint%s",
            q->count, q->count == 1 ? "" : "s", joints->count, joints->count == 1 ? "" : "s");
    }
    return 0;
}

/* True if the pose is one of those that the file's type has; otherwise it is skipped. */
static bool belongs(grobo_i_pose_ref *ref)
{
    grobo_i_document *document = ref->document;
    grobo_motion_kind kind =
        ref->type == GROBO_I_INCREMENTS ? GROBO_MOTION_STEPS : GROBO_MOTION_KEYS;

    if (ref->same_as > 0) {
        return true;
    }
    if (ref->type == GROBO_I_OTHER) {
        if (strcmp(ref->type_text, "PronunSymbol") != 0) {
            grobo_i_warn(document->reader, "ref-skipped", ref->refer_place,
                         "a ref of unknown type '%s' is skipped", ref->type_text);
        } else if (ref->name == NULL) {
            grobo_i_warn(document->reader, "name", ref->refer_place,
                         "a PronunSymbol without 'name' is skipped");
        } else {
            grobo_i_note(document->reader, "ref-skipped", ref->refer_place,
                         "a PronunSymbol is skipped");
        }
        return false;
    }
    if (!document->poses_known) {
        document->poses_known = true;
        document->poses = kind;
    }
    if (document->poses != kind) {
        grobo_i_warn(document->reader, "ref-skipped", ref->refer_place,
                     "a %s is skipped: it does not belong in a %s", ref->type_text,
                     document->poses == GROBO_MOTION_KEYS ? "PoseSeq" : "MotionSeq");
        return false;
    }
    return true;
}

static void widen_motion(grobo_motion *motion, const grobo_i_pose_list *joints)
{
    for (int i = 0; i < joints->count; i++) {
        if ((int)joints->values[i] >= motion->n_joints) {
            motion->n_joints = (uint8_t)(joints->values[i] + 1);
        }
    }
}

/* Angles of the pose into its row. */
static int put_angles(grobo_i_pose_ref *ref, const grobo_i_row *row)
{
    grobo_i_reader *reader = ref->document->reader;

    for (int i = 0; i < ref->joints.count; i++) {
        int joint = (int)ref->joints.values[i];
        if (joint < 0) {
            continue; /* complained about */
        }
        int result = 0;
        if ((*row->set & GROBO_JOINT_BIT(joint)) != 0) {
            result = grobo_i_complain(reader, GROBO_ERR_SYNTAX, "joint-twice",
                                      ref->joints.places[i], "joint %d is there twice", joint);
        }
        if (result == 0) {
            result = grobo_i_set_angle(reader, row, joint, ref->q.values[i], ref->q.places[i]);
        }
        if (result < 0) {
            return result;
        }
    }
    return 0;
}

/* What the pose has besides goes to its row. */
static int put_extra(grobo_i_pose_ref *ref, const grobo_i_row *row)
{
    const grobo_mem *mem = ref->document->reader->mem;
    bool named = ref->name != NULL && ref->name[0] != '\0';
    bool plain = ref->info.max_transition_s == 0 && ref->info.stationary == 0 &&
                 !ref->info.has_zmp && !ref->info.zmp_stationary;

    if (plain && ref->n_links == 0 && ref->kept == NULL && !named) {
        return 0;
    }
    grobo_i_extra *extra = grobo_i_extra_of(mem, row);
    if (extra == NULL) {
        return GROBO_ERR_NOMEM;
    }
    if (ref->n_links > 0) {
        size_t bytes = ref->n_links * sizeof *extra->links;
        extra->links = grobo_i_alloc(mem, bytes);
        if (extra->links == NULL) {
            return GROBO_ERR_NOMEM;
        }
        memcpy(extra->links, ref->links, bytes);
        extra->n_links = ref->n_links;
    }
    extra->info = ref->info;
    extra->kept = ref->kept;
    ref->kept = NULL;
    if (named) {
        extra->name = ref->name;
        ref->name = NULL;
    }
    return 0;
}

/* A pose that was referred to by name: as the other, but for what the ref itself says. */
static int copy_pose(grobo_i_pose_ref *ref, const grobo_i_row *row)
{
    grobo_motion *motion = ref->document->reader->motion;
    grobo_i_row other;

    (void)grobo_i_row_at(motion, ref->same_as - 1, &other);
    for (int j = 0; j < motion->n_joints && j < other.width; j++) {
        row->angle_rad[j] = other.angle_rad[j];
    }
    *row->set = *other.set;
    grobo_i_extra *extra = grobo_i_extra_dup(motion->mem, *other.extra); /* it has a name */
    if (extra == NULL) {
        return GROBO_ERR_NOMEM;
    }
    *row->extra = extra;
    extra->info.max_transition_s = ref->info.max_transition_s;
    grobo_i_drop_kept(motion->mem, &extra->kept, GROBO_KEPT_REF);
    grobo_i_kept **end = &ref->kept;
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *end = extra->kept;
    extra->kept = ref->kept;
    ref->kept = NULL;
    return 0;
}

static int add_pose(grobo_i_pose_ref *ref)
{
    grobo_i_document *document = ref->document;
    grobo_motion *motion = document->reader->motion;
    grobo_i_row row;

    widen_motion(motion, &ref->joints);
    int result = grobo_i_row_insert(motion, motion->size, &row);
    if (result < 0) {
        return result;
    }
    *row.time_s = ref->time_s;
    *row.line = ref->place.line;
    if (ref->same_as > 0) {
        return copy_pose(ref, &row);
    }
    result = put_angles(ref, &row);
    if (result == 0) {
        result = put_extra(ref, &row);
    }
    if (result == 0 && (ref->info.stationary & ~*row.set) != 0) {
        grobo_i_warn(document->reader, "sp-joints", ref->refer_place,
                     "spJoints lists a joint that joints does not");
    }
    if (result == 0 && ref->joints.given && ref->joints.count == 0) {
        grobo_i_warn(document->reader, "joints-empty", ref->joints.place,
                     "empty lists of joints and q: Choreonoid crashes on them");
    }
    const char *name = grobo_motion_key_name(motion, motion->size - 1);
    if (result == 0 && name[0] != '\0') {
        result = grobo_i_name_pose(document, name, motion->size - 1);
    }
    return result;
}

static int read_ref(grobo_i_events *events, void *target)
{
    static const grobo_i_fields fields = {"a ref", ref_fields,
                                          sizeof ref_fields / sizeof ref_fields[0], keep_ref_key};
    grobo_i_pose_ref *ref = target;
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    grobo_i_document *document = ref->document;
    bool is_map = event->kind == GROBO_I_MAP;
    memset(ref, 0, offsetof(grobo_i_pose_ref, joints));
    ref->joints.given = ref->q.given = false;
    ref->joints.count = ref->q.count = 0;
    ref->document = document;
    ref->place = event->place;
    result = grobo_i_read_map(events, &fields, ref, &seen);
    if (result == 0 && is_map) {
        result = check_ref(ref);
    }
    if (result == 0 && is_map && !ref->failed && belongs(ref)) {
        result = add_pose(ref);
    }
    grobo_i_kept_free(events->reader->mem, ref->kept);
    grobo_i_free_text(events->reader->mem, ref->name);
    return result;
}

int grobo_i_read_refs(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;
    grobo_i_pose_ref *ref = grobo_i_alloc(events->reader->mem, sizeof *ref);

    if (ref == NULL) {
        return GROBO_ERR_NOMEM;
    }
    document->has_refs = true;
    ref->document = document;
    int result = grobo_i_read_list(events, "refs", read_ref, ref);
    grobo_i_free(events->reader->mem, ref, sizeof *ref);
    return result;
}
