/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/view/balance.h"
#include "tools/grctl/view/layout.h"
#include "tools/grctl/view/scale.h"

enum { RATE_HZ = 100, FRAMES_MOST = 100000 };

double plot_balance_rate(double length_s)
{
    return length_s * RATE_HZ <= FRAMES_MOST ? RATE_HZ : FRAMES_MOST / length_s;
}

/* ---- collecting ---------------------------------------------------------------------------- */

static bool same_sole(const plot_sole *a, const plot_sole *b)
{
    double most_m = 0;
    for (int i = 0; i < 8; i++) {
        most_m = fmax(most_m, fabs(a->corner_m[i / 2][i % 2] - b->corner_m[i / 2][i % 2]));
    }
    return a->foot == b->foot && most_m < 0.0005;
}

/* A place where a foot comes to stand and has not stood before. */
static void see_sole(plot_balance *b, const grobo_body_balance_frame *frame, int foot)
{
    plot_sole *sole = &b->soles[b->n_soles];
    bool stood = b->n_points && b->points[b->n_points - 1].standing[foot];
    if (!frame->standing[foot] || stood || b->n_soles == PLOT_SOLES_MOST) {
        return;
    }
    sole->foot = foot;
    for (int i = 0; i < 4; i++) {
        memcpy(sole->corner_m[i], frame->sole_m[foot][i], sizeof sole->corner_m[i]);
    }
    for (int i = 0; i < b->n_soles; i++) {
        if (same_sole(&b->soles[i], sole)) {
            return;
        }
    }
    b->n_soles++;
}

static void see_frame(void *ctx, const grobo_body_balance_frame *frame)
{
    plot_balance *b = ctx;
    bool stands = frame->standing[0] || frame->standing[1];
    if (b->n_points == b->capacity) {
        return;
    }
    see_sole(b, frame, 0);
    see_sole(b, frame, 1);
    plot_balance_point *point = &b->points[b->n_points];
    point->t_s = frame->time_s;
    point->margin_m = frame->margin_m;
    memcpy(point->com_m, frame->com_m, sizeof point->com_m);
    memcpy(point->zmp_m, frame->zmp_m, sizeof point->zmp_m);
    memcpy(point->standing, frame->standing, sizeof point->standing);
    b->stands_always = b->stands_always && stands;
    if (stands && (!b->stands_ever || point->margin_m < b->points[b->worst].margin_m)) {
        b->worst = b->n_points;
    }
    b->stands_ever = b->stands_ever || stands;
    b->n_points++;
}

int plot_balance_collect(plot_balance *balance, grobo_body *body, bool assumed)
{
    grobo_body_check_options how = {GROBO_BODY_CHECK_OPTIONS_INIT, .frame = see_frame,
                                    .ctx = balance};
    memset(balance, 0, sizeof *balance);
    balance->capacity = (size_t)grobo_body_frame_count(body);
    balance->points = calloc(balance->capacity, sizeof *balance->points);
    if (!balance->points) {
        return GROBO_ERR_NOMEM;
    }
    balance->assumed = assumed;
    balance->stands_always = true;
    balance->n_problems = grobo_body_check(body, &how);
    return balance->n_problems < 0 ? balance->n_problems : 0;
}

void plot_balance_free(plot_balance *balance)
{
    free(balance->points);
    memset(balance, 0, sizeof *balance);
}

/* ---- from above ---------------------------------------------------------------------------- */

/* A map of the floor: ahead is up, left is left. */
typedef struct map {
    svg *s;
    const plot_balance *b;
    svg_box box;
    double middle_m[2], pixels_a_m;
} map;

enum { MAP_HEIGHT = 270, MAP_AIR_PX = 24 };

static double map_x(const map *m, const double at_m[2])
{
    double x = m->box.x + m->box.width / 2 - (at_m[1] - m->middle_m[1]) * m->pixels_a_m;
    return fmin(fmax(x, m->box.x), m->box.x + m->box.width);
}

static double map_y(const map *m, const double at_m[2])
{
    double y = m->box.y + m->box.height / 2 - (at_m[0] - m->middle_m[0]) * m->pixels_a_m;
    return fmin(fmax(y, m->box.y), m->box.y + m->box.height);
}

/* All soles in the middle, as large as they fit. */
static map make_map(svg *s, const plot_balance *b, double y, double width)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    double room_px[2] = {MAP_HEIGHT - 2 * MAP_AIR_PX, width - 2 * MAP_AIR_PX};
    map m = {.s = s, .b = b, .box = {PLOT_MARGIN + PLOT_GUTTER, y, width, MAP_HEIGHT}};
    for (int i = 0; i < b->n_soles * 4; i++) {
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], b->soles[i / 4].corner_m[i % 4][k]);
            high[k] = fmax(high[k], b->soles[i / 4].corner_m[i % 4][k]);
        }
    }
    for (int k = 0; k < 2 && b->n_soles; k++) {
        m.middle_m[k] = (low[k] + high[k]) / 2;
        room_px[k] /= fmax(high[k] - low[k], 0.1);
    }
    m.pixels_a_m = fmin(room_px[0], room_px[1]);
    return m;
}

static void draw_soles(const map *m)
{
    for (int i = 0; i < m->b->n_soles; i++) {
        const plot_sole *sole = &m->b->soles[i];
        svg_polyline(m->s, sole->foot ? "sole left" : "sole right");
        for (int k = 0; k <= 4; k++) {
            svg_point(m->s, map_x(m, sole->corner_m[k % 4]), map_y(m, sole->corner_m[k % 4]));
        }
        svg_polyline_end(m->s);
    }
}

/* The way of the centre of mass, or of the ZMP. */
static void draw_way(const map *m, const char *style_class, bool zmp)
{
    double drawn_x = -1, drawn_y = -1;
    svg_polyline(m->s, style_class);
    for (size_t i = 0; i < m->b->n_points; i++) {
        const double *at_m = zmp ? m->b->points[i].zmp_m : m->b->points[i].com_m;
        double x = map_x(m, at_m), y = map_y(m, at_m);
        if (fabs(x - drawn_x) + fabs(y - drawn_y) < 0.4 && i + 1 < m->b->n_points) {
            continue;
        }
        svg_point(m->s, x, y);
        drawn_x = x;
        drawn_y = y;
    }
    svg_polyline_end(m->s);
}

/* A bar of a round length, to read sizes by. */
static void draw_ruler(const map *m)
{
    enum { RULER_MM = 20 };
    double length = RULER_MM / 1e3 * m->pixels_a_m, x = m->box.x + 10;
    double y = m->box.y + m->box.height - 10;
    svg_line(m->s, "ruler", x, y, x + length, y);
    svg_text(m->s, "tick", x + length / 2, y - 4, "middle", "20 mm");
    svg_text(m->s, "tick", m->box.x + m->box.width / 2, m->box.y + 12, "middle", "ahead ↑");
}

static void draw_map(svg *s, const plot_balance *b, double y, double width)
{
    map m = make_map(s, b, y, width);
    const plot_balance_point *worst = &b->points[b->worst];
    svg_text(s, "name", m.box.x, y - 5, "start", "From above");
    if (b->assumed) {
        svg_text(s, "fact", m.box.x + width, y - 5, "end", "both feet are taken to stand");
    }
    svg_rect(s, "area", &m.box);
    draw_soles(&m);
    draw_way(&m, "zmp", true);
    draw_way(&m, "com", false);
    if (b->stands_ever) {
        svg_circle(s, worst->margin_m < 0 ? "worst" : "least", map_x(&m, worst->zmp_m),
                   map_y(&m, worst->zmp_m), 3.5, "smallest margin");
    }
    draw_ruler(&m);
    svg_rect(s, "frame", &m.box);
}

/* ---- over time ----------------------------------------------------------------------------- */

enum { MARGIN_HEIGHT = 170, STRIP = 8, STRIP_PITCH = 25 };

static plot_scale margin_scale(const plot_balance *b)
{
    enum { LEAST_MM = -10, MOST_MM = 40, FAR_MM = -60 };
    plot_scale scale = {LEAST_MM, MOST_MM, MARGIN_HEIGHT, 10};
    for (size_t i = 0; i < b->n_points; i++) {
        double mm = b->points[i].margin_m * 1e3;
        if (isfinite(mm)) {
            scale.low = fmin(scale.low, mm - 5);
            scale.high = fmax(scale.high, mm + 5);
        }
    }
    scale.low = fmax(scale.low, FAR_MM);
    scale.step = scale.high - scale.low > 80 ? 20 : 10;
    return scale;
}

/* The margin while a foot stands: a line for each stretch of time. */
static void draw_margin(svg *s, const plot_balance *b, const svg_box *box, const plot_scale *time)
{
    plot_scale margin = margin_scale(b);
    plot_thinner thin;
    bool drawing = false;
    double zero = box->y + box->height - plot_scale_at(&margin, 0);
    svg_rect(s, "area", box);
    svg_rect(s, "beyond", &(svg_box){box->x, zero, box->width, box->y + box->height - zero});
    plot_grid(s, box, time, &margin, " mm", "grid");
    svg_line(s, "limit", box->x, zero, box->x + box->width, zero);
    for (size_t i = 0; i <= b->n_points; i++) {
        const plot_balance_point *p = &b->points[i];
        bool stands = i < b->n_points && (p->standing[0] || p->standing[1]);
        if (drawing && !stands) {
            plot_thin_end(&thin);
            svg_polyline_end(s);
        }
        if (!drawing && stands) {
            svg_polyline(s, "curve middle");
            plot_thin_begin(&thin, s);
        }
        drawing = stands;
        if (!stands) {
            continue;
        }
        double mm = fmax(p->margin_m * 1e3, margin.low);
        plot_thin_point(&thin, box->x + plot_scale_at(time, p->t_s),
                        box->y + box->height - plot_scale_at(&margin, mm));
    }
    svg_rect(s, "frame", box);
}

/* When a foot is meant to stand, as bars. */
static void draw_stance(svg *s, const plot_balance *b, const svg_box *box, const plot_scale *time,
                        int foot)
{
    double from = 0, end = box->x + box->width;
    bool stood = false;
    svg_text(s, "name", box->x, box->y - 5, "start",
             foot ? "Left foot stands" : "Right foot stands");
    svg_rect(s, "area", box);
    for (size_t i = 0; i <= b->n_points; i++) {
        bool stands = i < b->n_points && b->points[i].standing[foot];
        double x = i < b->n_points ? box->x + plot_scale_at(time, b->points[i].t_s) : end;
        if (stands && !stood) {
            from = x;
        }
        if (!stands && stood && x > from) {
            svg_rect(s, foot ? "stance left" : "stance right",
                     &(svg_box){from, box->y, fmin(x, end) - from, box->height});
        }
        stood = stands;
    }
    svg_rect(s, "frame", box);
}

static void write_verdict(svg *s, const plot_balance *b, double x, double y)
{
    char text[192];
    const plot_balance_point *worst = &b->points[b->worst];
    bool falls = !b->stands_always || worst->margin_m < 0;
    if (!b->stands_ever) {
        snprintf(text, sizeof text, "no foot ever stands");
    } else if (worst->margin_m < 0) {
        snprintf(text, sizeof text, "falls: the ZMP is %.0f mm outside the soles at %.2f s",
                 -worst->margin_m * 1e3, worst->t_s);
    } else {
        snprintf(text, sizeof text, "%sat least %.1f mm inside the soles' edge (at %.2f s)",
                 b->stands_always ? "" : "at times no foot stands; else ", worst->margin_m * 1e3,
                 worst->t_s);
    }
    svg_text(s, falls ? "bad" : "fact", x, y, "end", text);
}

static void draw_key(svg *s, double x, double y)
{
    svg_line(s, "zmp", x, y, x + 18, y);
    svg_text(s, "tick", x + 24, y + 3.5, "start", "ZMP");
    svg_line(s, "com", x + 64, y, x + 82, y);
    svg_text(s, "tick", x + 88, y + 3.5, "start", "centre of mass");
}

void plot_balance_draw(svg *s, const plot_balance *balance, double length_s, double y)
{
    double top = y + 30 + PLOT_NAME;
    double width = (PLOT_WIDTH - 2 * PLOT_MARGIN - PLOT_GAP) / 2.0 - PLOT_GUTTER;
    plot_scale time = plot_time_scale(length_s, width);
    svg_box box = {PLOT_WIDTH - PLOT_MARGIN - width, top, width, MARGIN_HEIGHT};
    svg_text(s, "heading middle", PLOT_MARGIN, y + 18, "start", "Balance");
    draw_map(s, balance, top, width);
    draw_key(s, PLOT_MARGIN + PLOT_GUTTER, top + MAP_HEIGHT + 14);
    svg_text(s, "name", box.x, top - 5, "start", "Margin");
    write_verdict(s, balance, box.x + box.width, top - 5);
    draw_margin(s, balance, &box, &time);
    double below = top + MARGIN_HEIGHT + PLOT_NAME + 12;
    for (int foot = 0; foot < 2; foot++) {
        draw_stance(s, balance, &(svg_box){box.x, below + foot * STRIP_PITCH, box.width, STRIP},
                    &time, foot);
    }
    plot_time_texts(s, &time, box.x, below + STRIP_PITCH + STRIP + 14);
}
