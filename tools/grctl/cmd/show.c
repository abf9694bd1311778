/* SPDX-License-Identifier: MIT */

#include <stdlib.h>

#include <grobo/core/motion.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/play/options.h"
#include "tools/grctl/view/show.h"

enum { OPT_JOINTS, OPT_RATE, OPT_BODY };

static const cli_option options[] = {
    MOTION_LOOK_ROWS(OPT_JOINTS, OPT_RATE, "what is played, rows per second"),
    BODY_OPTION_ROWS(OPT_BODY),
};

/* ---- what is shown -------------------------------------------------------------------------- */

/* Steps that give no time take the default time: from there on a posture is reached at another time
 * than the file has. */
static int find_times(app *a, show_rows *rows)
{
    grobo_motion_kind kind = grobo_motion_get_kind(rows->motion);
    double before_s = 0, offset_s = 0, time_s = 0;
    if ((kind != GROBO_MOTION_POSTURES && kind != GROBO_MOTION_STEPS) || !rows->n) {
        return 0;
    }
    rows->reached_s = malloc(rows->n * sizeof *rows->reached_s);
    if (!rows->reached_s) {
        return app_fail(a, EXIT_FILE, "NOMEM", "%s: %s", a->line.argument[0],
                        file_error_text(GROBO_ERR_NOMEM));
    }
    for (size_t i = 0; i < rows->n && grobo_motion_time_s(rows->motion, i, &time_s) == 0; i++) {
        bool begins = i == 0 && time_s == 0;
        if (!begins && grobo_motion_step_us(rows->motion, i) == 0) {
            offset_s = before_s + GROBO_MOTION_DEFAULT_US / 1e6 - time_s;
        }
        before_s = rows->reached_s[i] = time_s + offset_s;
    }
    return 0;
}

/* With --rate or a body option the motion as it is played, otherwise as the file has it. */
static int choose_rows(app *a, show_rows *rows)
{
    grobo_body_options body;
    grobo_posture start;
    grobo_clip_options plain = {GROBO_CLIP_OPTIONS_INIT, .start = &start};
    rows->n = grobo_motion_size(rows->motion);
    rows->rate_hz = app_number(a, OPT_RATE, 0);
    int error = body_options_read(a, OPT_BODY, rows->rate_hz, &body);
    if (error) {
        return error;
    }
    rows->as_played = rows->rate_hz > 0 || body_options_given(a, OPT_BODY);
    if (!rows->as_played) {
        return find_times(a, rows);
    }
    grobo_motion_start(rows->motion, rows->model, &start);
    error = whole_open(a, &rows->played, rows->motion, &plain, &body);
    if (error) {
        return app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", a->line.argument[0],
                        file_error_text(error));
    }
    rows->n = rows->played.clip.n_keys;
    if (rows->rate_hz > 0 && rows->n) {
        double n = (double)rows->played.clip.length_us * rows->rate_hz / 1e6 + 1e-6;
        if (n >= GROBO_MOTION_FRAMES_MAX) {
            return app_fail(a, EXIT_FILE, "CAP", "%s: more than %d rows", a->line.argument[0],
                            GROBO_MOTION_FRAMES_MAX);
        }
        rows->n = (size_t)n + 1;
    }
    return 0;
}

/* Those asked for, else those that any row sets. */
static int choose_joints(app *a, show_rows *rows)
{
    const cli_value *list = app_option(a, OPT_JOINTS);
    int n_joints = rows->as_played ? rows->played.clip.n_joints : grobo_motion_joints(rows->motion);
    grobo_joint_mask joints = 0;
    grobo_posture posture;
    double time_s;
    if (list->given) {
        int status = joints_parse_motion(a, list->text, rows->model, n_joints, &joints);
        if (status) {
            return status;
        }
    } else {
        for (size_t i = 0; i < rows->n && show_row(rows, i, &posture, &time_s) == 0; i++) {
            joints |= posture.set;
        }
    }
    for (int j = 0; j < n_joints; j++) {
        if (joints & GROBO_JOINT_BIT(j)) {
            rows->joint[rows->n_joints++] = j;
        }
    }
    return 0;
}

/* ---- printing ------------------------------------------------------------------------------- */

static json_t *key_json(const show_rows *rows, double time_s, const grobo_posture *posture)
{
    json_t *angles = json_array();
    double deg;
    for (int c = 0; c < rows->n_joints; c++) {
        json_array_append_new(angles, grobo_posture_get_deg(posture, rows->joint[c], &deg) == 0
                                          ? app_json_number(deg, 6)
                                          : json_null());
    }
    return json_pack("{s:o,s:o}", "time_ms", app_json_number(time_s * 1e3, 6), "angle_deg", angles);
}

static void print_json(const show_rows *rows, const char *path, const char *format)
{
    char buffer[64];
    grobo_posture posture;
    double time_s, length_us = rows->as_played ? (double)rows->played.clip.length_us
                                               : (double)grobo_motion_length_us(rows->motion, -1);
    json_t *names = json_array(), *keys = json_array();
    for (int c = 0; c < rows->n_joints; c++) {
        json_array_append_new(names, json_string(show_joint_name(rows, c, buffer, sizeof buffer)));
    }
    for (size_t i = 0; i < rows->n && show_row(rows, i, &posture, &time_s) == 0; i++) {
        json_array_append_new(keys, key_json(rows, time_s, &posture));
    }
    app_print_json(json_pack("{s:o,s:s,s:o,s:o,s:o,s:o}", "file", app_json_text(path), "format",
                             format, "name", app_json_text(grobo_motion_name(rows->motion)),
                             "length_ms", app_json_number(length_us / 1e3, 3), "joints", names,
                             "keys", keys));
}

static const char *row_word(const show_rows *rows)
{
    if (rows->rate_hz > 0) {
        return "rows";
    }
    switch (grobo_motion_get_kind(rows->motion)) {
    case GROBO_MOTION_KEYS:
        return "key poses";
    case GROBO_MOTION_STEPS:
        return rows->as_played ? "postures" : "increments";
    case GROBO_MOTION_FRAMES:
        return "frames";
    case GROBO_MOTION_POSTURES:
        break;
    }
    return "postures";
}

/* How many poses give the legs by ikLinks. */
static size_t count_linked(const grobo_motion *motion)
{
    size_t n = 0, links;
    for (size_t i = 0; i < grobo_motion_size(motion); i++) {
        n += grobo_motion_ik_links(motion, i, &links) && links;
    }
    return n;
}

/* "degrees", or of which joints not: "degrees, gripper in %". */
static const char *units_of(const show_rows *rows, char *text, size_t capacity)
{
    size_t used = (size_t)snprintf(text, capacity, "degrees");
    for (int c = 0; c < rows->n_joints && used < capacity; c++) {
        int joint = rows->joint[c];
        grobo_unit unit = rows->model && joint < rows->model->n_joints && !show_is_steps(rows)
                              ? grobo_model_unit(rows->model, joint)
                              : GROBO_UNIT_DEG;
        if (unit != GROBO_UNIT_DEG) {
            used += (size_t)snprintf(text + used, capacity - used, ", %s in %s",
                                     grobo_model_joint(rows->model, joint)->name,
                                     grobo_unit_name(unit));
        }
    }
    return text;
}

static void print_head(const app *a, const show_rows *rows, const char *path, const char *format)
{
    const grobo_motion *motion = rows->motion;
    double length_us = rows->as_played ? (double)rows->played.clip.length_us
                                       : (double)grobo_motion_length_us(motion, -1);
    size_t linked = count_linked(motion);
    const char *name = grobo_motion_name(motion), *body = grobo_motion_target_body(motion);
    char rate[32] = "", units[APP_LINE_BYTES];
    if (grobo_motion_frame_rate(motion) > 0 && !grobo_motion_has_frame_times(motion)) {
        snprintf(rate, sizeof rate, " at %.5g Hz", grobo_motion_frame_rate(motion));
    }
    app_print_line("%s: %s%s%s%s%s%s, %zu %s%s, %.3f s, angles in %s", path, format,
                   *name ? " \"" : "", name, *name ? "\"" : "", *body ? " for " : "", body, rows->n,
                   row_word(rows), rate, length_us / 1e6, units_of(rows, units, sizeof units));
    if (rows->played.body) {
        app_print("legs by inverse kinematics\n");
    } else if (linked) {
        app_print("%zu of %zu poses give legs by ikLinks: %s\n", linked, grobo_motion_size(motion),
                  whole_robot_of(a, motion).body ? "--ik exact shows their angles"
                                                 : "the feet of its robot are not known");
    }
}

static int show(app *a, show_rows *rows)
{
    const char *path = a->line.argument[0];
    const char *format =
        grobo_motion_format_name(grobo_motion_kind_format(grobo_motion_get_kind(rows->motion)));
    int status = choose_rows(a, rows);
    if (!status) {
        status = choose_joints(a, rows);
    }
    if (status) {
        return status;
    }
    if (a->json) {
        print_json(rows, path, format);
    } else {
        print_head(a, rows, path, format);
        show_table(a, rows);
    }
    return 0;
}

static int run(app *a)
{
    static show_rows rows;
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a)};
    grobo_motion *motion = NULL;
    int status = file_load(a, a->line.argument[0], &read, &motion);
    if (status) {
        return status;
    }
    rows = (show_rows){.motion = motion, .model = file_model(a, motion)};
    status = show(a, &rows);
    whole_close(&rows.played);
    free(rows.reached_s);
    grobo_motion_free(motion);
    return status;
}

const cli_command cmd_show = {
    .name = "show",
    COMMAND_ARGUMENTS("FILE", 1, 1, CLI_ARG_FILE),
    .summary = "print a motion file as a table of angles",
    .details = "Prints every posture of a motion file: its time in milliseconds and the angles of\n"
               "its joints in degrees; a dot for a joint that the posture leaves alone. On a\n"
               "terminal rows are split where they do not fit, and angles outside a joint's\n"
               "limits are red; elsewhere every posture is one line.\n\n"
               "With --rate, or with one of the options about legs, the motion is shown as it is\n"
               "played: interpolated, legs from ikLinks solved, increments added up from the\n"
               "initial posture.\n",
    .example = "  grctl show motions/greet.pseq\n  grctl show -j right_arm,NECK_Y greet.pseq\n"
               "  grctl show --rate 10 --ik exact -j legs motions/step.pseq\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
