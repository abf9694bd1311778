/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cmd/commands.h"
#include "tools/grctl/play/options.h"
#include "tools/grctl/play/whole.h"
#include "tools/grctl/view/picture.h"
#include "tools/grctl/view/plot.h"

enum { OPT_OUT, OPT_JOINTS, OPT_RATE, OPT_BODY, OPT_BALANCE = OPT_BODY + BODY_BALANCE };

static const cli_option options[] = {
    [OPT_OUT] =
        OPTION_TEXT("output", 'o', "OUT", "OUT.svg, OUT.png, or - for SVG to standard output"),
    MOTION_LOOK_ROWS(OPT_JOINTS, OPT_RATE, "draw what is sent at this rate, straight between"),
    BODY_LOOK_ROWS(OPT_BODY),
};

typedef struct order {
    const char *in, *shown; /* the file, and its name without folders */
    const char *out;
    picture_format format;
    char name[GROBO_PATH_MAX_BYTES]; /* of OUT where none is given */
} order;

/* The file's name with another extension, in the directory we are in. */
static int choose_name(app *a, order *o)
{
    const char *base = strcmp(o->in, "-") == 0 ? "plot" : o->shown;
    const char *dot = strrchr(base, '.');
    size_t length = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    int n = snprintf(o->name, sizeof o->name, "%.*s.svg", (int)length, base);
    if (n < 0 || (size_t)n >= sizeof o->name) {
        return app_fail(a, EXIT_USAGE, "SPACE", "%s: its name is too long; give -o OUT.svg", o->in);
    }
    o->out = o->name;
    if (picture_is_foreign(o->out)) {
        return app_fail(a, EXIT_FILE, "EXISTS",
                        "%s is there and no plot of ours; give -o OUT.svg to choose a name",
                        o->out);
    }
    return 0;
}

static int settle(app *a, order *o)
{
    const cli_value *out = app_option(a, OPT_OUT);
    o->in = a->line.argument[0];
    o->shown = strcmp(o->in, "-") == 0 ? "standard input" : file_last_part(o->in);
    o->format = PICTURE_SVG;
    o->out = out->given ? out->text : "-";
    if (!out->given && (a->tty_out || a->json)) {
        return choose_name(a, o);
    }
    if (strcmp(o->out, "-") == 0) {
        return a->json ? app_fail(a, EXIT_USAGE, "ARG",
                                  "--json and the picture cannot both go to standard output")
                       : 0;
    }
    o->format = picture_format_of(o->out);
    if (o->format == PICTURE_NONE) {
        return app_fail(a, EXIT_USAGE, "ARG", "%s: pictures are .svg or .png", o->out);
    }
    return 0;
}

static int choose_joints(app *a, const plot_subject *of, grobo_joint_mask *joints)
{
    const cli_value *list = app_option(a, OPT_JOINTS);
    grobo_posture posture;
    if (list->given) {
        return joints_parse_motion(a, list->text, of->model, of->clip->n_joints, joints);
    }
    *joints |= of->solved;
    for (size_t i = 0; grobo_motion_get(of->motion, i, &posture) == 0; i++) {
        *joints |= posture.set;
    }
    return 0;
}

static json_t *spans_json(const plot_curve *curve)
{
    json_t *all = json_array();
    for (size_t i = 0; i < curve->n_fast; i++) {
        json_array_append_new(all,
                              json_pack("[o,o]", app_json_number(curve->fast[i].from_s * 1e3, 3),
                                        app_json_number(curve->fast[i].to_s * 1e3, 3)));
    }
    return all;
}

static json_t *degrees_json(double angle_rad)
{
    return app_json_number(grobo_deg_from_rad(angle_rad), 3);
}

static json_t *joint_json(const plot_curve *curve)
{
    const grobo_joint *limits = curve->limits;
    json_t *o = json_pack("{s:i,s:s}", "joint", curve->joint, "name", curve->name);
    json_t *limited = !limits
                          ? NULL
                          : json_pack("{s:i,s:[o,o],s:o}", "motor", limits->motor, "limits_deg",
                                      degrees_json(limits->min_rad), degrees_json(limits->max_rad),
                                      "limit_dps", degrees_json(limits->max_speed_rad_s));
    json_t *seen = json_pack("{s:o,s:o,s:o,s:b,s:o}", "min_deg",
                             app_json_number(curve->set ? curve->min_deg : NAN, 3), "max_deg",
                             app_json_number(curve->set ? curve->max_deg : NAN, 3), "peak_dps",
                             app_json_number(curve->set ? curve->peak_speed_dps : NAN, 1),
                             "beyond_limits", plot_beyond(curve), "too_fast_ms", spans_json(curve));
    json_object_update(o, limited);
    json_object_update(o, seen);
    if (curve->model) {
        joints_add_unit(o, curve->model, curve->joint);
    }
    if (curve->model && curve->set) {
        joints_add_value(o, "at_min", curve->model, curve->joint,
                         grobo_rad_from_deg(curve->min_deg));
        joints_add_value(o, "at_max", curve->model, curve->joint,
                         grobo_rad_from_deg(curve->max_deg));
    }
    json_decref(limited);
    json_decref(seen);
    return o;
}

static json_t *balance_json(const plot_balance *b)
{
    const plot_balance_point *worst = b->stands_ever ? &b->points[b->worst] : NULL;
    return json_pack("{s:b,s:b,s:i,s:o*,s:o*}", "stands_always", b->stands_always, "assumed",
                     b->assumed, "problems", b->n_problems, "margin_mm",
                     worst ? app_json_number(worst->margin_m * 1e3, 2) : NULL, "at_ms",
                     worst ? app_json_number(worst->t_s * 1e3, 3) : NULL);
}

static void report(const app *a, const order *o, const plot_data *data)
{
    if (!a->json) {
        if (strcmp(o->out, "-") != 0) {
            app_note(a, "wrote %s", o->out);
        }
        return;
    }
    json_t *joints = json_array();
    for (int i = 0; i < data->n_curves; i++) {
        json_array_append_new(joints, joint_json(&data->curves[i]));
    }
    app_print_json(json_pack("{s:o,s:o,s:I,s:o,s:o,s:o*}", "file", app_json_text(o->in), "output",
                             app_json_text(o->out), "postures", (json_int_t)plot_keys(data),
                             "length_ms", app_json_number(data->length_s * 1e3, 3), "joints",
                             joints, "balance",
                             data->of.balance ? balance_json(data->of.balance) : NULL));
}

/* What a picture needs besides the motion. */
typedef struct work {
    whole played;
    grobo_body *checked;
    plot_balance balance;
    plot_data data;
} work;

static int solve(const app *a, work *w, const grobo_motion *motion, plot_subject *subject,
                 grobo_body_options body)
{
    grobo_posture start;
    grobo_clip_options plain = {GROBO_CLIP_OPTIONS_INIT, .start = &start};
    bool standing;
    grobo_motion_start(motion, subject->model, &start);
    int error = whole_open(a, &w->played, motion, &plain, &body);
    subject->clip = &w->played.clip;
    if (w->played.body) {
        subject->solved = whole_joints(whole_robot_of(a, motion).body);
    }
    if (error || !app_option(a, OPT_BALANCE)->given) {
        return error;
    }
    body.rate_hz = plot_balance_rate((double)subject->clip->length_us / 1e6);
    error = whole_body(a, &w->checked, motion, &body, &standing);
    if (!error) {
        error = plot_balance_collect(&w->balance, w->checked, standing);
    }
    subject->balance = &w->balance;
    return error;
}

static int draw(app *a, const order *o, const plot_data *data)
{
    svg drawing;
    if (!plot_draw(&drawing, data, o->shown)) {
        return app_fail(a, EXIT_ROBOT, "NOMEM", "%s", app_error_text(GROBO_ERR_NOMEM));
    }
    int status = picture_save(a, &drawing, o->out, o->format);
    if (!status) {
        report(a, o, data);
    }
    free(drawing.bytes);
    return status;
}

static int plot(app *a, const order *o, const grobo_motion *motion)
{
    static work w;
    plot_subject subject = {.motion = motion, .model = file_model(a, motion)};
    plot_options how = {.rate_hz = app_number(a, OPT_RATE, 0)};
    grobo_body_options body;
    int status = body_options_read(a, OPT_BODY, how.rate_hz, &body);
    if (status) {
        return status;
    }
    int error = solve(a, &w, motion, &subject, body);
    if (!error) {
        status = choose_joints(a, &subject, &how.joints);
        how.columns = plot_columns(how.joints);
    }
    if (!error && !status) {
        error = plot_collect(&w.data, &subject, &how);
    }
    if (error == GROBO_ERR_TYPE) {
        status =
            app_fail(a, EXIT_FILE, "TYPE",
                     "%s: for a robot whose feet are not known: its balance is unknown", o->in);
    } else if (error) {
        status = app_fail(a, EXIT_FILE, grobo_error_name(error), "%s: %s", o->in,
                          file_error_text(error));
    }
    if (!error && !status) {
        status = draw(a, o, &w.data);
    }
    plot_free(&w.data);
    plot_balance_free(&w.balance);
    grobo_body_free(w.checked);
    whole_close(&w.played);
    return status;
}

static int run(app *a)
{
    static order o;
    grobo_read_options read = {GROBO_READ_OPTIONS_INIT, .model = app_model(a)};
    grobo_motion *motion = NULL;
    memset(&o, 0, sizeof o);
    int status = settle(a, &o);
    if (!status) {
        status = file_load(a, o.in, &read, &motion);
    }
    if (!status) {
        status = plot(a, &o, motion);
    }
    grobo_motion_free(motion);
    return status;
}

const cli_command cmd_plot = {
    .name = "plot",
    COMMAND_ARGUMENTS("FILE", 1, 1, CLI_ARG_FILE),
    .summary = "draw a motion file: angle over time",
    .details =
        "Draws every joint of a motion over time, as it is played: key poses by Choreonoid's\n"
        "curve with legs from ikLinks, .m and .mseq straight from posture to posture, frames as\n"
        "they are. Limits of joints, key poses and stretches too fast for a servo are marked.\n\n"
        "--balance adds a picture of whether the robot will fall: soles, ZMP and centre of mass\n"
        "from above, and how far the ZMP is inside the soles over time. A motion that gives no\n"
        "feet is taken to stand on both.\n\n"
        "Without -o the SVG goes to standard output; on a terminal, and with --json, to a file\n"
        "of FILE's name in this directory, unless that would replace something that is no\n"
        "plot. PNG is made by rsvg-convert, inkscape or ImageMagick, whichever is there.\n",
    .example = "  grctl plot motions/greet.pseq\n"
               "  grctl plot -o greet.png -j right_arm,NECK_Y motions/greet.pseq\n"
               "  grctl plot --balance -o step.svg motions/step.pseq\n",
    COMMAND_OPTIONS(options),
    .run = run,
};
