/* SPDX-License-Identifier: MIT */
/* The top of a YAML motion file, and what kind of motion it is. */
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/document.h"
#include "src/motion/format/read.h"

/* ---- keys of the top ---------------------------------------------------------------------- */

static int read_type(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    document->type_place = event->place;
    result = grobo_i_read_string(events, "type", &document->type);
    if (result < 0 || document->type == NULL || document->poses_known) {
        return result;
    }
    document->poses_known = true;
    if (strcmp(document->type, "PoseSeq") == 0) {
        document->poses = GROBO_MOTION_KEYS;
    } else if (strcmp(document->type, "MotionSeq") == 0) {
        document->poses = GROBO_MOTION_STEPS;
    } else {
        document->poses_known = false;
    }
    return 0;
}

static int read_name(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;

    return grobo_i_read_string(events, "name", &document->reader->motion->name);
}

static int read_target_body(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;

    return grobo_i_read_string(events, "targetBody", &document->reader->motion->target_body);
}

static int read_content(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    document->content_place = event->place;
    return grobo_i_read_string(events, "content", &document->content);
}

static int read_version(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    document->version_place = event->place;
    return grobo_i_read_double(events, "format version", &document->version);
}

static int read_rate(grobo_i_events *events, void *target)
{
    return grobo_i_read_rate(events, &((grobo_i_document *)target)->top);
}

static int read_n_frames(grobo_i_events *events, void *target)
{
    return grobo_i_read_n_frames(events, &((grobo_i_document *)target)->top);
}

static int read_n_parts(grobo_i_events *events, void *target)
{
    return grobo_i_read_n_parts(events, &((grobo_i_document *)target)->top);
}

static int read_has_frame_time(grobo_i_events *events, void *target)
{
    return grobo_i_read_has_frame_time(events, &((grobo_i_document *)target)->top);
}

static int read_unknown(grobo_i_events *events, void *target, const char *key)
{
    grobo_i_document *document = target;

    return grobo_i_keep_value(events, &document->reader->motion->kept,
                              &(grobo_kept){.key = key, .level = GROBO_KEPT_TOP});
}

/* ---- what it is --------------------------------------------------------------------------- */

static grobo_i_place top_place(const grobo_i_document *document)
{
    return document->type_place.line > 0 ? document->type_place : (grobo_i_place){1, 1};
}

/* The kind that the refs are, where the top's type does not say it. Choreonoid does not look. */
static const char *type_of_refs(const grobo_i_document *document, grobo_motion_kind *kind)
{
    *kind = document->poses_known ? document->poses : GROBO_MOTION_KEYS;
    return *kind == GROBO_MOTION_STEPS ? "MotionSeq" : "PoseSeq";
}

/* The kind the top says, or what it holds if it does not say. */
static int find_kind(grobo_i_document *document, grobo_motion_kind *kind)
{
    static const struct {
        const char *type;
        grobo_motion_kind kind;
    } types[] = {{"PoseSeq", GROBO_MOTION_KEYS},
                 {"MotionSeq", GROBO_MOTION_STEPS},
                 {"BodyMotion", GROBO_MOTION_FRAMES},
                 {"CompositeSeq", GROBO_MOTION_FRAMES}};
    grobo_i_reader *reader = document->reader;

    if (document->type == NULL || document->type[0] == '\0') {
        if (!document->has_refs || document->has_components) {
            return grobo_i_refuse(reader, GROBO_ERR_TYPE, "top-type", top_place(document),
                                  "no 'type': neither key poses nor a body motion");
        }
        grobo_i_warn(reader, "top-type", top_place(document),
                     "no 'type': read as %s, as its refs are", type_of_refs(document, kind));
        return 0;
    }
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (strcmp(document->type, types[i].type) == 0) {
            *kind = types[i].kind;
            return 0;
        }
    }
    if (!document->has_refs || document->has_components) {
        return grobo_i_refuse(reader, GROBO_ERR_TYPE, "top-type", top_place(document),
                              "'%.40s' is not a type of motion file", document->type);
    }
    grobo_i_warn(reader, "top-type", top_place(document),
                 "'%.40s' is not a type of motion file: read as %s, as its refs are",
                 document->type, type_of_refs(document, kind));
    return 0;
}

/* The refs or components found are those that the kind has. */
static int check_contents(grobo_i_document *document, grobo_motion_kind kind)
{
    grobo_i_reader *reader = document->reader;
    bool frames = kind == GROBO_MOTION_FRAMES;

    if ((frames && document->has_refs) || (!frames && document->has_components)) {
        return grobo_i_refuse(reader, GROBO_ERR_TYPE, "top-type", top_place(document),
                              "a %s with %s", document->type != NULL ? document->type : "PoseSeq",
                              frames ? "refs" : "components");
    }
    if (!frames && document->poses_known && document->has_refs && document->poses != kind &&
        reader->motion->size > 0) {
        return grobo_i_refuse(reader, GROBO_ERR_TYPE, "top-type", top_place(document),
                              "its refs are not those of a %s", document->type);
    }
    if (kind == GROBO_MOTION_KEYS && reader->motion->name == NULL) {
        grobo_i_warn(reader, "name", top_place(document),
                     "no 'name': Choreonoid refuses to read it");
    }
    return 0;
}

static int finish(grobo_i_document *document)
{
    grobo_i_reader *reader = document->reader;
    grobo_motion_kind kind = GROBO_MOTION_KEYS;
    int result = find_kind(document, &kind);

    if (result == 0) {
        result = check_contents(document, kind);
    }
    if (result < 0) {
        return result;
    }
    reader->motion->kind = kind;
    reader->top = top_place(document);
    return kind == GROBO_MOTION_FRAMES ? grobo_i_finish_frames(document) : 0;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static int read_document(grobo_i_document *document)
{
    static const grobo_i_field fields[] = {
        {"type", NULL, read_type},
        {"name", NULL, read_name},
        {"targetBody", NULL, read_target_body},
        {"refs", NULL, grobo_i_read_refs},
        {"components", NULL, grobo_i_read_components},
        {"content", NULL, read_content},
        {"formatVersion", "format_version", read_version},
        {"frameRate", "frame_rate", read_rate},
        {"numFrames", "num_frames", read_n_frames},
        {"numParts", "num_parts", read_n_parts},
        {"hasFrameTime", "has_frame_time", read_has_frame_time},
    };
    static const grobo_i_fields top = {"the file", fields, sizeof fields / sizeof fields[0],
                                       read_unknown};
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(&document->events, &event);

    if (result == 0 && event->kind != GROBO_I_MAP) {
        return grobo_i_refuse(document->reader, GROBO_ERR_TYPE, "top-type", event->place,
                              "not a motion file: no mapping at the top");
    }
    if (result == 0) {
        result = grobo_i_read_map(&document->events, &top, document, &seen);
    }
    if (result == 0) {
        result = grobo_i_next(&document->events, &event); /* the document's end */
    }
    if (result < 0) {
        return result;
    }
    grobo_i_place end = event->place;
    result = grobo_i_another_document(&document->events);
    if (result > 0) {
        grobo_i_warn(document->reader, "documents", end, "only the first document is read");
    }
    return result < 0 ? result : 0;
}

int grobo_i_read_yaml(grobo_i_reader *reader)
{
    grobo_i_document document;

    memset(&document, 0, sizeof document);
    document.reader = reader;
    document.top.n_frames = document.top.n_parts = -1;
    int result = grobo_i_events_begin(&document.events, reader);
    if (result < 0) {
        return result;
    }
    result = read_document(&document);
    if (result == 0) {
        result = finish(&document);
    }
    grobo_i_free_text(reader->mem, document.type);
    grobo_i_free_text(reader->mem, document.content);
    grobo_i_pose_names_free(&document);
    grobo_i_events_end(&document.events);
    return result;
}
