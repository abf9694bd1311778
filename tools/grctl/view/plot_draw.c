/* SPDX-License-Identifier: MIT */
/* Drawing a plot: heading, panels, axes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/motion_io.h>

#include "tools/grctl/view/layout.h"
#include "tools/grctl/view/scale.h"

enum { TEXT_BYTES = 256, MARKS_MOST = 400, BIG_MARKS_MOST = 60, TIPS_MOST = 60 };

/* Bright whatever surrounds it; colours that people who see few of them can tell apart. */
static const char style[] =
    ".page{fill:#fff}\n"
    "text{font-family:sans-serif;font-size:10px;fill:#52606d}\n"
    ".title{font-size:20px;font-weight:bold;fill:#1f2933}\n"
    ".about{font-size:12px}\n"
    ".bad{fill:#c81e2c}\n"
    ".warn{font-size:12px;fill:#c81e2c}\n"
    ".name{font-size:11px;font-weight:bold;fill:#1f2933}\n"
    ".heading{font-size:14px;font-weight:bold}\n"
    ".area{fill:#f7f9fb}\n"
    ".frame{fill:none;stroke:#cbd2d9;stroke-width:1}\n"
    ".grid{stroke:#e1e7ec;stroke-width:1}\n"
    ".zero{stroke:#b8c2cc;stroke-width:1}\n"
    ".beyond{fill:#f3c6cb}\n"
    ".limit{stroke:#c81e2c;stroke-width:1;stroke-dasharray:4 3}\n"
    ".hurry{fill:#fde3bf}\n"
    ".curve{fill:none;stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}\n"
    ".fast{fill:none;stroke:#f08c00;stroke-width:5;stroke-linejoin:round}\n"
    ".key{fill:#fff;stroke-width:1.4}\n"
    ".sole{fill-opacity:.12;stroke-width:1.2}\n.com{fill:none;stroke:#d97706;stroke-width:1.2}\n"
    ".zmp{fill:none;stroke:#6b4aa0;stroke-width:1.6;stroke-linejoin:round}\n"
    ".least{fill:#6b4aa0}\n.worst{fill:#c81e2c}\n.ruler{stroke:#52606d;stroke-width:2}\n"
    ".stance{stroke:none}\n"
    ".plain{stroke:#52606d}\n.right{stroke:#1d5fa8}\n"
    ".left{stroke:#0b7a63}\n.middle{stroke:#6b4aa0}\n"
    ".sole.right,.stance.right{fill:#1d5fa8}\n.sole.left,.stance.left{fill:#0b7a63}\n"
    "text.right{stroke:none;fill:#1d5fa8}\ntext.left{stroke:none;fill:#0b7a63}\n"
    "text.middle{stroke:none;fill:#6b4aa0}\n";

typedef struct pen {
    svg *s;
    const plot_data *data;
    const plot_layout *layout;
    plot_scale time; /* seconds to pixels from the left of a panel */
} pen;

/* ---- one panel ----------------------------------------------------------------------------- */

static double x_at(const pen *p, const plot_panel *panel, double t_s)
{
    return panel->box.x + plot_scale_at(&p->time, t_s);
}

static double y_at(const plot_panel *panel, const plot_scale *angle, double angle_deg)
{
    return panel->box.y + panel->box.height -
           plot_scale_at(angle, plot_value(panel->curve, angle_deg));
}

/* The part of the panel beyond a limit, and the limit's line. */
static void draw_limit(const pen *p, const plot_panel *panel, const plot_scale *angle,
                       double limit_deg, bool upper)
{
    const svg_box *box = &panel->box;
    double y = y_at(panel, angle, limit_deg), bottom = box->y + box->height;
    svg_box beyond = {box->x, upper ? box->y : y, box->width, upper ? y - box->y : bottom - y};
    if (y < box->y || y > bottom) {
        return;
    }
    if (beyond.height > 0) {
        svg_rect(p->s, "beyond", &beyond);
    }
    svg_line(p->s, "limit", box->x, y, box->x + box->width, y);
}

static void draw_hurry(const pen *p, const plot_panel *panel)
{
    const plot_curve *c = panel->curve;
    for (size_t i = 0; i < c->n_fast; i++) {
        double from = x_at(p, panel, c->fast[i].from_s), to = x_at(p, panel, c->fast[i].to_s);
        double wide = fmax(to - from, 1.5);
        svg_rect(p->s, "hurry",
                 &(svg_box){(from + to - wide) / 2, panel->box.y, wide, panel->box.height});
    }
}

/* The points of a curve between two times; those that a straight line replaces are left out. */
static void draw_curve(const pen *p, const plot_panel *panel, const plot_scale *angle,
                       const char *style_class, const plot_span *span)
{
    const plot_curve *c = panel->curve;
    plot_thinner thin;
    svg_polyline(p->s, style_class);
    plot_thin_begin(&thin, p->s);
    for (size_t i = 0; i < c->n_points; i++) {
        const plot_point *at = &c->points[i];
        bool before = i + 1 < c->n_points && c->points[i + 1].t_s <= span->from_s;
        bool behind = i > 0 && c->points[i - 1].t_s >= span->to_s;
        if (!before && !behind) {
            plot_thin_point(&thin, x_at(p, panel, at->t_s), y_at(panel, angle, at->angle_deg));
        }
    }
    plot_thin_end(&thin);
    svg_polyline_end(p->s);
}

static double mark_radius(const plot_data *data)
{
    bool frames = grobo_motion_get_kind(data->of.motion) == GROBO_MOTION_FRAMES;
    if (plot_keys(data) > MARKS_MOST || (frames && plot_keys(data) > BIG_MARKS_MOST)) {
        return 0;
    }
    return plot_keys(data) > BIG_MARKS_MOST ? 1.2 : 2.6;
}

static void draw_marks(const pen *p, const plot_panel *panel, const plot_scale *angle)
{
    const size_t n = plot_keys(p->data);
    double radius = mark_radius(p->data), t_s, deg;
    char style_class[32], tip[TEXT_BYTES], angle_text[64];
    snprintf(style_class, sizeof style_class, "key %s", panel->side);
    for (size_t i = 0; radius > 0 && i < n; i++) {
        grobo_posture posture;
        if (plot_key(p->data, i, &posture, &t_s) < 0 ||
            grobo_posture_get_deg(&posture, panel->curve->joint, &deg) < 0) {
            continue;
        }
        plot_degrees(plot_value(panel->curve, deg), plot_unit(panel->curve), angle_text,
                     sizeof angle_text);
        snprintf(tip, sizeof tip, "%s %s at %.3f s", panel->curve->name, angle_text, t_s);
        svg_circle(p->s, style_class, x_at(p, panel, t_s), y_at(panel, angle, deg), radius,
                   n <= TIPS_MOST ? tip : NULL);
    }
}

/* Two angles in the joint's unit, the lower value first. */
static void range_text(const plot_curve *c, double a_deg, double b_deg, char *low, char *high,
                       size_t capacity)
{
    double a = plot_value(c, a_deg), b = plot_value(c, b_deg);
    plot_degrees(fmin(a, b), "", low, capacity);
    plot_degrees(fmax(a, b), plot_unit(c), high, capacity);
}

/* Range, limits and speed of a joint in words, at the right above its panel. */
static void write_facts(const pen *p, const plot_panel *panel)
{
    const plot_curve *c = panel->curve;
    const svg_box *box = &panel->box;
    const char *unit = plot_unit(c);
    double one = fabs(plot_value(c, 1) - plot_value(c, 0)); /* of the unit in a degree */
    char text[TEXT_BYTES] = "no posture gives it", low[64], high[64];
    int n = 0;
    range_text(c, c->min_deg, c->max_deg, low, high, sizeof low);
    if (c->set && plot_is_still(c)) {
        plot_degrees(plot_value(c, c->min_deg), unit, low, sizeof low);
        n = snprintf(text, sizeof text, "stays at %s", low);
    } else if (c->set) {
        n = snprintf(text, sizeof text, "%s to %s, %.*f%s/s", low, high,
                     c->peak_speed_dps * one < 9.95, c->peak_speed_dps * one, unit);
    }
    if (n > 0 && c->limits) {
        range_text(c, grobo_deg_from_rad(c->limits->min_rad),
                   grobo_deg_from_rad(c->limits->max_rad), low, high, sizeof low);
        n += snprintf(text + n, sizeof text - (size_t)n, "  (limits %s to %s", low, high);
        if (!plot_is_still(c)) {
            n += snprintf(text + n, sizeof text - (size_t)n, ", %.0f%s/s",
                          grobo_deg_from_rad(c->limits->max_speed_rad_s) * one, unit);
        }
        snprintf(text + n, sizeof text - (size_t)n, ")");
    }
    svg_text(p->s, plot_beyond(c) || c->n_fast ? "bad" : "fact", box->x + box->width, box->y - 5,
             "end", text);
}

static void write_name(const pen *p, const plot_panel *panel)
{
    const plot_curve *c = panel->curve;
    char text[TEXT_BYTES];
    if (c->limits) {
        snprintf(text, sizeof text, "%s  m%d", c->name, c->limits->motor);
    } else {
        snprintf(text, sizeof text, "%s", c->name);
    }
    svg_text(p->s, "name", panel->box.x, panel->box.y - 5, "start", text);
}

static void draw_panel(const pen *p, const plot_panel *panel)
{
    const plot_curve *c = panel->curve;
    const plot_span all = {-1, p->data->length_s + 1};
    plot_scale angle = plot_angle_scale(c, panel->box.height, panel->slim);
    char style_class[32];
    write_name(p, panel);
    write_facts(p, panel);
    svg_rect(p->s, "area", &panel->box);
    draw_hurry(p, panel);
    plot_grid(p->s, &panel->box, &p->time, &angle, plot_unit(c), "zero");
    if (c->limits && !panel->slim) {
        bool turned = plot_value(c, 1) < plot_value(c, 0);
        draw_limit(p, panel, &angle, grobo_deg_from_rad(c->limits->min_rad), turned);
        draw_limit(p, panel, &angle, grobo_deg_from_rad(c->limits->max_rad), !turned);
    }
    svg_rect(p->s, "frame", &panel->box);
    snprintf(style_class, sizeof style_class, "curve %s", panel->side);
    for (size_t i = 0; i < c->n_fast; i++) {
        draw_curve(p, panel, &angle, "fast", &c->fast[i]);
    }
    if (c->n_points) {
        draw_curve(p, panel, &angle, style_class, &all);
    }
    draw_marks(p, panel, &angle);
}

/* ---- around them --------------------------------------------------------------------------- */

static void draw_section(const pen *p, const plot_section *section)
{
    char style_class[32];
    snprintf(style_class, sizeof style_class, "heading %s", section->side);
    svg_text(p->s, style_class, section->x, section->y + 18, "start", section->title);
    plot_time_texts(p->s, &p->time, section->plot_x, section->axis_y + 14);
}

/* The beginning of a text that may be long, cut between characters. */
static void shorten(const char *text, size_t most, char *out, size_t capacity)
{
    size_t length = 0, characters = 0;
    while (text[length] && length + 4 < capacity) {
        if ((text[length] & 0xc0) != 0x80 && ++characters > most) {
            break;
        }
        length++;
    }
    snprintf(out, capacity, "%.*s%s", (int)length, text, text[length] ? "…" : "");
}

static const char *key_word(const plot_data *data)
{
    switch (grobo_motion_get_kind(data->of.motion)) {
    case GROBO_MOTION_KEYS:
        return "key pose";
    case GROBO_MOTION_STEPS:
        return "step";
    case GROBO_MOTION_FRAMES:
        return "frame";
    case GROBO_MOTION_POSTURES:
        break;
    }
    return "posture";
}

/* File, kind and length in one line. The file only where it is not the title. */
static void write_about(const pen *p, const char *file)
{
    const plot_data *data = p->data;
    grobo_motion_kind kind = grobo_motion_get_kind(data->of.motion);
    const char *body = grobo_motion_target_body(data->of.motion);
    double rate_hz = grobo_motion_frame_rate(data->of.motion);
    char text[3 * TEXT_BYTES], rate[48] = "", name[TEXT_BYTES] = "", robot[TEXT_BYTES];
    size_t n = plot_keys(data);
    if (*grobo_motion_name(data->of.motion)) {
        shorten(file, 60, name, sizeof name);
    }
    shorten(body, 30, robot, sizeof robot);
    if (rate_hz > 0 && !grobo_motion_has_frame_times(data->of.motion)) {
        snprintf(rate, sizeof rate, " at %.5g Hz", rate_hz);
    }
    snprintf(text, sizeof text, "%s%s%s%s%s, %zu %s%s%s, %.3f s%s%s", name, *name ? ": " : "",
             grobo_motion_format_name(grobo_motion_kind_format(kind)), *body ? " for " : "", robot,
             n, key_word(data), n == 1 ? "" : "s", rate, data->length_s,
             kind == GROBO_MOTION_STEPS ? " (counted from the initial posture)" : "",
             data->of.solved ? ", legs by inverse kinematics" : "");
    svg_text(p->s, "about", PLOT_MARGIN, 62, "start", text);
}

/* What is wrong, in one line: the first few names of each kind. */
static void write_problems(const pen *p)
{
    char text[TEXT_BYTES];
    int beyond = 0, fast = 0, n = 0;
    for (int i = 0; i < p->data->n_curves; i++) {
        beyond += plot_beyond(&p->data->curves[i]);
        fast += p->data->curves[i].n_fast > 0;
    }
    if (beyond) {
        n = snprintf(text, sizeof text, "%d joint%s beyond %s limits%s", beyond,
                     beyond == 1 ? "" : "s", beyond == 1 ? "its" : "their", fast ? "; " : "");
    }
    if (fast) {
        n += snprintf(text + n, sizeof text - (size_t)n, "%d joint%s faster than %s servo", fast,
                      fast == 1 ? "" : "s", fast == 1 ? "its" : "their");
    }
    if (n > 0) {
        svg_text(p->s, "warn", PLOT_WIDTH - PLOT_MARGIN, 86, "end", text);
    }
}

/* One entry of the legend; returns where the next begins. */
static double write_legend_text(const pen *p, double x, const char *text)
{
    svg_text(p->s, "tick", x + 24, 86, "start", text);
    return x + 24 + (double)strlen(text) * 5.6 + 16;
}

static void draw_legend(const pen *p)
{
    bool limits = false, fast = false;
    double x = PLOT_MARGIN, y = 82.5;
    for (int i = 0; i < p->data->n_curves; i++) {
        limits = limits || p->data->curves[i].limits;
        fast = fast || p->data->curves[i].n_fast;
    }
    svg_line(p->s, "curve plain", x, y, x + 18, y);
    x = write_legend_text(p, x, "angle");
    if (mark_radius(p->data) > 0) {
        svg_circle(p->s, "key plain", x + 9, y, mark_radius(p->data), NULL);
        x = write_legend_text(p, x, key_word(p->data));
    }
    if (limits) {
        svg_rect(p->s, "beyond", &(svg_box){x, y - 5, 18, 10});
        svg_line(p->s, "limit", x, y + 5, x + 18, y + 5);
        x = write_legend_text(p, x, "beyond the joint's limit");
    }
    if (fast) {
        svg_rect(p->s, "hurry", &(svg_box){x, y - 5, 18, 10});
        svg_line(p->s, "fast", x, y, x + 18, y);
        write_legend_text(p, x, "faster than the servo can follow");
    }
}

static void draw_head(const pen *p, const char *file)
{
    const char *name = grobo_motion_name(p->data->of.motion);
    char text[TEXT_BYTES];
    shorten(*name ? name : file, 60, text, sizeof text);
    svg_describe(p->s, "title", text);
    svg_describe(p->s, "desc", "Angle over time of each joint of a motion.");
    svg_rect(p->s, "page", &(svg_box){0, 0, PLOT_WIDTH, p->layout->height});
    svg_text(p->s, "title", PLOT_MARGIN, 42, "start", text);
    write_about(p, file);
    write_problems(p);
    if (p->data->n_curves) {
        draw_legend(p);
    } else {
        svg_text(p->s, "about", PLOT_MARGIN, 90, "start",
                 plot_keys(p->data) ? "No posture sets a joint." : "No postures.");
    }
}

bool plot_draw(svg *s, const plot_data *data, const char *file)
{
    plot_layout layout;
    pen p = {.s = s, .data = data, .layout = &layout};
    plot_arrange(&layout, data);
    p.time = plot_time_scale(data->length_s, layout.n_sections ? layout.sections[0].plot_w : 1);
    svg_open(s, PLOT_WIDTH, layout.height, style);
    draw_head(&p, file);
    if (data->of.balance) {
        plot_balance_draw(s, data->of.balance, data->length_s, PLOT_HEAD);
    }
    for (int i = 0; i < layout.n_sections; i++) {
        draw_section(&p, &layout.sections[i]);
    }
    for (int i = 0; i < layout.n_panels; i++) {
        draw_panel(&p, &layout.panels[i]);
    }
    return svg_close(s);
}
