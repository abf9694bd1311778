/* SPDX-License-Identifier: MIT */
/* components of a body motion: the frames of its joints. */
#include <math.h>
#include <string.h>

#include "src/base/memory.h"
#include "src/motion/format/document.h"

/* What a component proves to be. Unknown until type and content have been read. */
typedef enum component_kind {
    COMPONENT_OPEN = 0,
    COMPONENT_JOINTS,
    COMPONENT_OTHER
} component_kind;

/* A component while it is read. */
typedef struct component {
    grobo_i_document *document;
    grobo_i_place place, frames_place, type_place;
    grobo_i_frame_info info;
    char *type, *content, *purpose;
    size_t first_row;
    bool has_frames, reading;
    /* the frames */
    int columns; /* numbers of each, -1 before the first */
    int count;   /* numbers of the present one */
    bool times;  /* the first of each is its time */
    grobo_i_place row_place;
    double values[1 + GROBO_JOINTS_MAX];
    grobo_i_place places[1 + GROBO_JOINTS_MAX];
} component;

/* ---- what the top and a component have in common ------------------------------------------ */

static int peek_place(grobo_i_events *events, grobo_i_place *place)
{
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    *place = event->place;
    return result;
}

int grobo_i_read_rate(grobo_i_events *events, grobo_i_frame_info *info)
{
    int result = peek_place(events, &info->rate_place);

    if (result == 0) {
        result = grobo_i_read_double(events, "frameRate", &info->rate_hz);
    }
    if (result == 0 && !(info->rate_hz > 0)) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "frame-rate", info->rate_place,
                                  "a frame rate must be above 0");
        info->rate_hz = 1;
    }
    return result;
}

int grobo_i_read_n_frames(grobo_i_events *events, grobo_i_frame_info *info)
{
    int result = peek_place(events, &info->n_frames_place);

    return result < 0 ? result
                      : grobo_i_read_long(events, "numFrames", 0, 999999999, &info->n_frames);
}

int grobo_i_read_n_parts(grobo_i_events *events, grobo_i_frame_info *info)
{
    int result = peek_place(events, &info->n_parts_place);

    return result < 0 ? result
                      : grobo_i_read_long(events, "numParts", 0, 999999999, &info->n_parts);
}

int grobo_i_read_has_frame_time(grobo_i_events *events, grobo_i_frame_info *info)
{
    info->gives_frame_time = true;
    return grobo_i_read_bool(events, "hasFrameTime", &info->has_frame_time);
}

static bool has_frame_time(const component *part)
{
    return part->info.gives_frame_time ? part->info.has_frame_time
                                       : part->document->top.has_frame_time;
}

/* ---- what a component is ------------------------------------------------------------------ */

static bool is_one_of(const char *text, const char *const *words)
{
    for (; *words != NULL; words++) {
        if (strcmp(text, *words) == 0) {
            return true;
        }
    }
    return false;
}

static component_kind kind_of(const component *part)
{
    static const char *const contents[] = {"JointPosition", "JointDisplacement",
                                           "MultiJointDisplacementSeq", NULL};
    bool nothing = part->content == NULL || part->content[0] == '\0';
    const char *content = nothing ? part->purpose : part->content;

    if ((part->type != NULL && strcmp(part->type, "MultiValueSeq") != 0) ||
        (content != NULL && !is_one_of(content, contents))) {
        return COMPONENT_OTHER;
    }
    return part->type != NULL && content != NULL ? COMPONENT_JOINTS : COMPONENT_OPEN;
}

static int read_type(grobo_i_events *events, void *target)
{
    component *part = target;
    int result = peek_place(events, &part->type_place);

    return result < 0 ? result : grobo_i_read_string(events, "type", &part->type);
}

static int read_content(grobo_i_events *events, void *target)
{
    return grobo_i_read_string(events, "content", &((component *)target)->content);
}

static int read_purpose(grobo_i_events *events, void *target)
{
    return grobo_i_read_string(events, "purpose", &((component *)target)->purpose);
}

static int read_rate(grobo_i_events *events, void *target)
{
    return grobo_i_read_rate(events, &((component *)target)->info);
}

static int read_n_frames(grobo_i_events *events, void *target)
{
    return grobo_i_read_n_frames(events, &((component *)target)->info);
}

static int read_n_parts(grobo_i_events *events, void *target)
{
    return grobo_i_read_n_parts(events, &((component *)target)->info);
}

static int read_frame_time(grobo_i_events *events, void *target)
{
    return grobo_i_read_has_frame_time(events, &((component *)target)->info);
}

/* Keys of a component that is skipped, or may be yet, are skipped too: they can be large. */
static int read_unknown(grobo_i_events *events, void *target, const char *key)
{
    component *part = target;

    if (kind_of(part) != COMPONENT_JOINTS || part->document->has_joints) {
        return grobo_i_skip(events);
    }
    return grobo_i_keep_value(events, &events->reader->motion->kept,
                              &(grobo_kept){.key = key, .level = GROBO_KEPT_COMPONENT});
}

/* ---- frames ------------------------------------------------------------------------------- */

/* How many numbers the frames have: from numParts if that is known, else from the first. */
static int set_columns(component *part)
{
    grobo_i_reader *reader = part->document->reader;
    long n_parts = part->info.n_parts >= 0 ? part->info.n_parts : part->document->top.n_parts;

    part->columns = part->count;
    if (n_parts >= 0 && n_parts <= GROBO_JOINTS_MAX) {
        part->columns = (int)n_parts + part->times;
    }
    int n_joints = part->columns - part->times;
    if (n_joints > GROBO_JOINTS_MAX) {
        return grobo_i_refuse(reader, GROBO_ERR_CAP, "joints", part->row_place,
                              "more than %d joints in a frame", GROBO_JOINTS_MAX);
    }
    if (n_joints < 1) {
        return grobo_i_refuse(reader, GROBO_ERR_SYNTAX, "frame-length", part->row_place,
                              "a frame without angles");
    }
    reader->motion->n_joints = (uint8_t)n_joints;
    return 0;
}

static int add_frame(component *part)
{
    grobo_i_reader *reader = part->document->reader;
    grobo_motion *motion = reader->motion;
    grobo_i_row row;
    int first = part->times;
    int result = part->columns < 0 ? set_columns(part) : 0;

    if (result < 0) {
        return result;
    }
    if (part->count != part->columns) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "frame-length", part->row_place,
                                "a frame of %d numbers where %d belong", part->count,
                                part->columns);
    }
    result = grobo_i_row_insert(motion, motion->size, &row);
    if (result < 0) {
        return result;
    }
    *row.line = part->row_place.line;
    if (part->times) {
        result = grobo_i_take_time(reader, row.time_s, part->values[0], part->places[0]);
    }
    for (int j = 0; result == 0 && j < motion->n_joints; j++) {
        result =
            grobo_i_set_angle(reader, &row, j, part->values[first + j], part->places[first + j]);
    }
    return result;
}

static int read_frame(grobo_i_events *events, void *target)
{
    component *part = target;
    const grobo_i_event *event;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    part->row_place = event->place;
    if (event->kind != GROBO_I_LIST) {
        result = grobo_i_complain(events->reader, GROBO_ERR_SYNTAX, "type", event->place,
                                  "frames: a frame that is no list");
        return result < 0 ? result : grobo_i_skip(events);
    }
    grobo_i_numbers numbers = {part->values, part->places, 0, 1 + GROBO_JOINTS_MAX, 0};
    result = grobo_i_read_numbers(events, "frames", &numbers);
    part->count = numbers.count;
    return result < 0 ? result : add_frame(part);
}

/*
 * Frames are taken for joints' unless type or content have said otherwise before; if they say so
 * behind, read_component() takes them out again.
 */
static int read_frames(grobo_i_events *events, void *target)
{
    component *part = target;
    int result = peek_place(events, &part->frames_place);

    part->has_frames = true;
    if (result < 0) {
        return result;
    }
    if (kind_of(part) == COMPONENT_OTHER || part->document->has_joints) {
        return grobo_i_skip(events);
    }
    part->reading = true;
    part->times = has_frame_time(part);
    return grobo_i_read_list(events, "frames", read_frame, part);
}

static const grobo_i_field component_fields[] = {
    {"type", NULL, read_type},
    {"content", NULL, read_content},
    {"purpose", NULL, read_purpose},
    {"frameRate", "frame_rate", read_rate},
    {"numFrames", "num_frames", read_n_frames},
    {"numParts", "num_parts", read_n_parts},
    {"hasFrameTime", "has_frame_time", read_frame_time},
    {"frames", NULL, read_frames},
};

/* ---- a component -------------------------------------------------------------------------- */

/* Says that a component is skipped, and remembers its rate. */
static int pass_over(component *part)
{
    static const char *const known[] = {"MultiValueSeq",       "MultiSE3Seq", "MultiSe3Seq",
                                        "MultiAffine3Seq",     "Vector3Seq",  "MultiVector3Seq",
                                        "MultiDeviceStateSeq", NULL};
    grobo_i_document *document = part->document;
    const char *content = part->content != NULL ? part->content : "no content";

    if (part->type == NULL || !is_one_of(part->type, known)) {
        grobo_i_warn(document->reader, "component-skipped", part->place,
                     "a component of unknown type '%.40s' is skipped",
                     part->type != NULL ? part->type : "");
    } else {
        grobo_i_note(document->reader, "component-skipped", part->place,
                     "a %.40s (%.40s) is skipped", part->type, content);
    }
    if (document->n_others < GROBO_MOTION_COMPONENTS_MAX && part->info.rate_hz > 0) {
        document->others[document->n_others].rate_hz = part->info.rate_hz;
        document->others[document->n_others++].place = part->info.rate_place;
    }
    return 0;
}

static void drop_rows(component *part)
{
    grobo_motion *motion = part->document->reader->motion;

    while (motion->size > part->first_row) {
        grobo_i_row_remove(motion, motion->size - 1);
    }
}

/* hasFrameTime came behind the frames: what was read as the first joint are the times. */
static int take_times_from_frames(component *part)
{
    grobo_i_reader *reader = part->document->reader;
    grobo_motion *motion = reader->motion;
    grobo_i_row row;
    int result = 0;

    for (size_t n = 0; result == 0 && motion->n_joints > 0 && grobo_i_row_at(motion, n, &row);
         n++) {
        result =
            grobo_i_take_time(reader, row.time_s, row.angle_rad[0], (grobo_i_place){*row.line, 0});
        memmove(row.angle_rad, row.angle_rad + 1,
                (size_t)(motion->n_joints - 1) * sizeof *row.angle_rad);
    }
    (void)grobo_motion_set_joints(motion, motion->n_joints - 1);
    part->columns--;
    part->times = true;
    return result;
}

/* The component gave the joints' frames: what it said of them must fit. */
static int take_frames(component *part)
{
    grobo_i_document *document = part->document;
    grobo_i_reader *reader = document->reader;
    int result = 0;

    document->has_joints = true;
    if (!part->times && has_frame_time(part) && part->columns == 1) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "frame-length", part->frames_place,
                                "frames of a time without angles");
    }
    if (!part->times && has_frame_time(part) && part->columns > 1) {
        result = take_times_from_frames(part);
    }
    document->frames = part->info;
    document->frames.has_frame_time = part->times;
    document->frames_place = part->has_frames ? part->frames_place : part->place;
    if (part->info.n_frames >= 0 && (size_t)part->info.n_frames != reader->motion->size) {
        grobo_i_warn(reader, "num-frames", part->info.n_frames_place,
                     "numFrames is %ld, there are %lu", part->info.n_frames,
                     (unsigned long)reader->motion->size);
    }
    return result;
}

static int finish_component(component *part)
{
    component_kind kind = kind_of(part);

    if (kind == COMPONENT_JOINTS && !part->document->has_joints) {
        return take_frames(part);
    }
    drop_rows(part);
    if (kind == COMPONENT_JOINTS) {
        grobo_i_warn(part->document->reader, "component-skipped", part->place,
                     "a second component with joints is skipped");
        return 0;
    }
    return pass_over(part);
}

static int read_component(grobo_i_events *events, void *target)
{
    static const grobo_i_fields fields = {"a component", component_fields,
                                          sizeof component_fields / sizeof component_fields[0],
                                          read_unknown};
    component part;
    const grobo_i_event *event;
    uint32_t seen = 0;
    int result = grobo_i_peek(events, &event);

    if (result < 0) {
        return result;
    }
    memset(&part, 0, sizeof part);
    part.document = target;
    part.place = event->place;
    part.first_row = events->reader->motion->size;
    part.columns = -1;
    part.info.n_frames = part.info.n_parts = -1;
    bool is_map = event->kind == GROBO_I_MAP;
    result = grobo_i_read_map(events, &fields, &part, &seen);
    if (result == 0 && is_map) {
        result = finish_component(&part);
    }
    grobo_i_free_text(events->reader->mem, part.type);
    grobo_i_free_text(events->reader->mem, part.content);
    grobo_i_free_text(events->reader->mem, part.purpose);
    return result;
}

int grobo_i_read_components(grobo_i_events *events, void *target)
{
    grobo_i_document *document = target;

    document->has_components = true;
    return grobo_i_read_list(events, "components", read_component, document);
}

/* ---- the end ------------------------------------------------------------------------------ */

static int check_version(grobo_i_document *document)
{
    grobo_i_reader *reader = document->reader;
    bool composite = strcmp(document->type, "CompositeSeq") == 0;
    bool given = document->version_place.line > 0;
    double version = given ? document->version : 1.0;

    if (!(version >= 1 && version < 5)) {
        return grobo_i_complain(reader, GROBO_ERR_UNSUPPORTED, "version", document->version_place,
                                "a version of the format that is not known");
    }
    if (version >= 2 && !composite) {
        return grobo_i_complain(reader, GROBO_ERR_TYPE, "version", document->type_place,
                                "from version 2 on the type must be CompositeSeq");
    }
    if (version < 2 && composite) {
        return grobo_i_complain(reader, GROBO_ERR_TYPE, "version", document->type_place,
                                "a CompositeSeq needs format_version 2 or later");
    }
    if (document->content != NULL && document->content[0] != '\0' &&
        strcmp(document->content, "BodyMotion") != 0) {
        return grobo_i_complain(reader, GROBO_ERR_TYPE, "content", document->content_place,
                                "'%.40s' is not a body motion", document->content);
    }
    return 0;
}

/* What Choreonoid takes where frames have times of their own and the file gives no rate. */
enum { TIMED_RATE_HZ = 100 };

static int check_rate(grobo_i_document *document)
{
    grobo_i_reader *reader = document->reader;
    const grobo_i_frame_info *frames = &document->frames;
    double rate_hz = frames->rate_hz > 0 ? frames->rate_hz : document->top.rate_hz;

    if (!(rate_hz > 0) && frames->has_frame_time) {
        rate_hz = TIMED_RATE_HZ;
    }
    if (grobo_motion_set_frame_rate(reader->motion, rate_hz) < 0) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "frame-rate",
                                rate_hz > 0 ? frames->rate_place : document->frames_place,
                                rate_hz > 0 ? "a frame rate that low" : "no frame rate");
    }
    for (size_t i = 0; i < document->n_others; i++) {
        if (document->others[i].rate_hz != rate_hz) {
            grobo_i_warn(reader, "frame-rate", document->others[i].place,
                         "a component with another frame rate than the joints have");
        }
    }
    return 0;
}

/* Choreonoid reads no frames whose number of joints is not given. */
static int check_parts(grobo_i_document *document)
{
    grobo_i_reader *reader = document->reader;
    const grobo_i_frame_info *info =
        document->frames.n_parts >= 0 ? &document->frames : &document->top;

    if (info->n_parts < 0) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "no-parts", document->frames_place,
                                "no numParts: how many joints the frames have is not given");
    }
    if (info->n_parts != reader->motion->n_joints) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "frame-length", info->n_parts_place,
                                "numParts is %ld, frames have %d", info->n_parts,
                                reader->motion->n_joints);
    }
    return 0;
}

/* An empty motion as this library writes it. Choreonoid reads no frames that are none. */
static bool is_meant_empty(grobo_i_document *document)
{
    long n_parts = document->frames.n_parts;

    if (document->frames.n_frames != 0 || n_parts < 0 || n_parts > GROBO_JOINTS_MAX ||
        strcmp(document->type, "BodyMotion") != 0) {
        return false;
    }
    document->reader->motion->n_joints = (uint8_t)n_parts;
    return true;
}

int grobo_i_finish_frames(grobo_i_document *document)
{
    grobo_i_reader *reader = document->reader;
    int result = check_version(document);

    if (result < 0) {
        return result;
    }
    if (!document->has_joints) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "no-joints", document->type_place,
                                document->has_components ? "no component with the joints' frames"
                                                         : "no components");
    }
    if (reader->motion->size == 0 && !is_meant_empty(document)) {
        return grobo_i_complain(reader, GROBO_ERR_SYNTAX, "no-frames", document->frames_place,
                                "no frames");
    }
    reader->motion->frame_times = document->frames.has_frame_time;
    result = check_parts(document);
    return result < 0 ? result : check_rate(document);
}
