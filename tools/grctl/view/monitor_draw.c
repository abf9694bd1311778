/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/robot.h>
#include <grobo/core/unit.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/term/screen.h"
#include "tools/grctl/view/monitor.h"
#include "tools/grctl/view/render.h"

enum { LEAST_ROWS = 20, LEAST_COLUMNS = 80, BAR_LEAST = 4, BAR_MOST = 40, GAP = 2 };
/* Columns of a joint: its name at least; angle; torque, heat, current behind its bar. */
enum { NAME_LEAST = 10, NAME_TAIL = 4, ANGLE = 7, AFTER_BAR = 12, COLUMN_LEAST = 37 };
enum { STALE_US = 2000000, WARM_BELOW = 10, BEYOND_DEG = 2, THREE_DIGITS = 100 };
/* Rows: title and heads above the joints; link, play, what was said and help below them. */
enum { ROW_TITLE, ROW_HEADS, ROW_BODY, ROWS_AROUND = 12, ROWS_USUAL = 24 };

/* The picture of a screen of some size. */
typedef struct frame {
    int rows, columns;
    int id, name, bar; /* columns of motor, name and bar */
    int stride;        /* from one column of joints to the next */
    int top;           /* first row of the layout that is seen */
    int link, play, said, help;
} frame;

const char *monitor_busy(const monitor *m)
{
    grobo_job_kind kind = grobo_robot_job(m->c.robot);
    if (kind == GROBO_JOB_ESTOP) {
        return _("emergency stop");
    }
    if (kind == GROBO_JOB_PLAY) {
        return _("getting ready to play");
    }
    if (m->job) {
        return m->doing;
    }
    return grobo_robot_is_playing(m->c.robot)
               ? _(grobo_sequencer_state_name(grobo_robot_play_state(m->c.robot)))
               : NULL;
}

/* ---- a joint --------------------------------------------------------------------------------- */

static screen_style torque_style(const grobo_joint_info *i)
{
    if (!i->torque_known) {
        return SCREEN_DIM;
    }
    return i->state.torque == GROBO_TORQUE_ON      ? SCREEN_GOOD
           : i->state.torque == GROBO_TORQUE_BRAKE ? SCREEN_WARN
                                                   : SCREEN_DIM;
}

static screen_style level_style(int value, int warn, int limit)
{
    return value > limit ? SCREEN_BAD : value > warn ? SCREEN_WARN : SCREEN_PLAIN;
}

static int place_in_bar(const grobo_joint *j, double angle_rad, int width)
{
    double range_rad = j->max_rad - j->min_rad;
    double part = range_rad > 0 ? (angle_rad - j->min_rad) / range_rad : 0.5;
    return part <= 0 ? 0 : part >= 1 ? width - 1 : (int)lround(part * (width - 1));
}

/* The way between the limits: where the joint is, and where it was told to go. */
static void draw_bar(const monitor *m, const grobo_joint *j, const grobo_joint_info *i, int row,
                     int column, int width)
{
    double slack_rad = grobo_rad_from_deg(BEYOND_DEG); /* at a limit is where many postures are */
    bool beyond =
        i->state.angle_rad < j->min_rad - slack_rad || i->state.angle_rad > j->max_rad + slack_rad;
    for (int k = 0; k < width; k++) {
        screen_put(row, column + k, SCREEN_DIM, m->blocks ? "─" : "-");
    }
    if (i->has_target) {
        screen_put(row, column + place_in_bar(j, i->target_rad, width), SCREEN_BOLD,
                   m->blocks ? "│" : "|");
    }
    if (j->wheel) { /* its speed, backwards on the left */
        double part = grobo_rad_from_deg(i->state.speed_dps) / j->max_speed_rad_s / 2 + 0.5;
        int place = (int)lround(fmin(fmax(part, 0), 1) * (width - 1));
        screen_put(row, column + place, torque_style(i), m->blocks ? "█" : "#");
        return;
    }
    screen_put(row, column + place_in_bar(j, i->state.angle_rad, width),
               beyond ? SCREEN_BAD : torque_style(i), m->blocks ? "█" : "#");
}

static void draw_values(const monitor *m, const grobo_joint_info *i, int row, int column)
{
    const grobo_safety_limits *most = &grobo_robot_driver(m->c.robot)->limits;
    char text[32];
    snprintf(text, sizeof text, " %.3s", render_torque(i));
    screen_put(row, column, torque_style(i), text);
    if (i->state.valid & GROBO_FIELD_TEMPERATURE) {
        snprintf(text, sizeof text, "%3d", (int)i->state.temperature_c);
        screen_put(row, column + 4,
                   level_style(i->state.temperature_c, most->temperature_c - WARM_BELOW,
                               most->temperature_c),
                   text);
    }
    if (i->state.valid & GROBO_FIELD_CURRENT) {
        snprintf(text, sizeof text, "%5d", (int)i->state.current_ma);
        screen_put(row, column + 7,
                   level_style(i->state.current_ma, most->current_ma / 2, most->current_ma), text);
    }
}

/* R_ and L_ are what the two columns say. */
static const char *short_name(const monitor *m, int joint)
{
    const char *name = grobo_model_joint(m->model, joint)->name;
    bool sided = monitor_has_partner(m->model, joint) && name[0] && name[1] == '_' && name[2];
    return name + (sided ? 2 : 0);
}

/* A name that is too long keeps its end, in which such names differ. */
static void put_name(const monitor *m, const frame *f, int joint, int row, int column)
{
    bool chosen = (m->chosen & GROBO_JOINT_BIT(joint)) != 0;
    const char *name = short_name(m, joint);
    int length = (int)strlen(name);
    char text[MONITOR_TEXT_BYTES];
    int at = snprintf(text, sizeof text, "%*d%c", f->id, grobo_model_joint(m->model, joint)->motor,
                      chosen ? '>' : ' ');
    if (length > f->name) {
        snprintf(text + at, sizeof text - (size_t)at, "%.*s~%s", f->name - NAME_TAIL - 1, name,
                 name + length - NAME_TAIL);
    } else {
        snprintf(text + at, sizeof text - (size_t)at, "%s", name);
    }
    screen_put(row, column, chosen ? SCREEN_BOLD : SCREEN_PLAIN, text);
}

/* Why there is no angle of now. */
static void put_absence(const frame *f, const grobo_joint_info *i, int row, int column)
{
    char text[MONITOR_TEXT_BYTES], line[MONITOR_TEXT_BYTES];
    if (i->status < 0 && i->status != GROBO_ERR_EMPTY) {
        snprintf(text, sizeof text, " %s", _(grobo_error_text(i->status)));
    } else if (i->angle_age_us == GROBO_NEVER_US) {
        snprintf(text, sizeof text, _(" not read yet"));
    } else {
        snprintf(text, sizeof text, _(" not read for %.0f s"), (double)i->angle_age_us / 1e6);
    }
    snprintf(line, sizeof line, "%.*s", (int)lang_fit(text, ANGLE + f->bar + AFTER_BAR), text);
    screen_put(row, column, SCREEN_BAD, line);
}

static void draw_joint(const monitor *m, const frame *f, const monitor_cell *cell)
{
    int row = ROW_BODY + cell->row - f->top, column = cell->column * f->stride;
    int angle = column + f->id + 1 + f->name, bar = angle + ANGLE;
    const grobo_joint *j = grobo_model_joint(m->model, cell->joint);
    grobo_joint_info i;
    char text[64];
    put_name(m, f, cell->joint, row, column);
    if (grobo_robot_joint(m->c.robot, cell->joint, &i) < 0) {
        return;
    }
    if (i.angle_age_us == GROBO_NEVER_US || i.angle_age_us > STALE_US) {
        put_absence(f, &i, row, angle);
        return;
    }
    double value = grobo_model_value(m->model, cell->joint, i.state.angle_rad);
    grobo_unit unit = grobo_model_unit(m->model, cell->joint);
    int width = unit == GROBO_UNIT_DEG ? 6 : unit == GROBO_UNIT_MM ? 5 : 6;
    bool tenths = fabs(value) < (unit == GROBO_UNIT_MM ? 99.95 : 9999.5);
    snprintf(text, sizeof text, "%*.*f%s", width, tenths ? 1 : 0, value,
             unit == GROBO_UNIT_DEG ? "" : grobo_unit_name(unit));
    if (j->wheel) {
        snprintf(text, sizeof text, "%4d/s", (int)i.state.speed_dps);
    }
    screen_put(row, angle, SCREEN_PLAIN, text);
    draw_bar(m, j, &i, row, bar, f->bar);
    draw_values(m, &i, row, bar + f->bar);
}

static void draw_heads(const frame *f, int column)
{
    int bar = column + f->id + 1 + f->name + ANGLE;
    char text[MONITOR_TEXT_BYTES];
    snprintf(text, sizeof text, "%*s %-*s%6s", f->id, "m", f->name, "joint", "deg");
    screen_put(ROW_HEADS, column, SCREEN_DIM, text);
    screen_put(ROW_HEADS, bar, SCREEN_DIM, f->bar >= 6 ? _("limits") : "");
    screen_put(ROW_HEADS, bar + f->bar, SCREEN_DIM, "      C   mA");
}

/* All joints that the screen has room for; how many are above and below. */
static void draw_joints(const monitor *m, const frame *f)
{
    int above = 0, below = 0;
    for (int column = 0; column < m->layout.n_columns; column++) {
        draw_heads(f, column * f->stride);
    }
    for (int i = 0; i < m->layout.n; i++) {
        const monitor_cell *cell = &m->layout.cell[i];
        if (cell->row < f->top) {
            above++;
        } else if (cell->row >= f->top + m->layout.height) {
            below++;
        } else {
            draw_joint(m, f, cell);
        }
    }
    if (above || below) {
        char text[MONITOR_TEXT_BYTES];
        snprintf(text, sizeof text, _("%d more joints above, %d below: arrows up and down"), above,
                 below);
        screen_put(f->link - 1, 0, SCREEN_WARN, text);
    }
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void draw_title(const monitor *m, int columns)
{
    char text[MONITOR_TEXT_BYTES];
    grobo_trip_info trip;
    grobo_robot_tripped(m->c.robot, &trip);
    snprintf(text, sizeof text, "%s  %s", m->model->name, conn_device(&m->c));
    screen_put(ROW_TITLE, 0, SCREEN_BOLD, text);
    if (!m->c.up) {
        snprintf(text, sizeof text, _(" LINE LOST for %.0f s, trying again "),
                 (double)(grobo_now_us() - m->up_us) / 1e6);
    } else if (trip.trip == GROBO_TRIP_ESTOP) {
        snprintf(text, sizeof text, _(" EMERGENCY STOP: R releases it "));
    } else if (trip.trip != GROBO_TRIP_NONE) {
        snprintf(text, sizeof text, _(" STOPPED: %s: R releases it "),
                 _(grobo_trip_name(trip.trip)));
    } else {
        return;
    }
    screen_put(ROW_TITLE, columns - lang_columns(text, strlen(text)), SCREEN_ALARM, text);
}

static void draw_link(const monitor *m, const frame *f)
{
    const grobo_bus_stats *n = grobo_robot_get_bus_stats(m->c.robot);
    const grobo_safety_limits *limits = &grobo_robot_driver(m->c.robot)->limits;
    int32_t low_mv = 0;
    char text[MONITOR_TEXT_BYTES];
    for (int j = 0; j < m->model->n_joints; j++) {
        grobo_joint_info i;
        if (grobo_robot_joint(m->c.robot, j, &i) == 0 && (i.state.valid & GROBO_FIELD_VOLTAGE) &&
            (!low_mv || i.state.voltage_mv < low_mv)) {
            low_mv = i.state.voltage_mv;
        }
    }
    snprintf(text, sizeof text, low_mv ? "%5.2f V" : "    - V", low_mv / 1e3);
    screen_put(f->link, 0,
               !low_mv                                 ? SCREEN_DIM
               : low_mv < limits->voltage_mv * 11 / 10 ? SCREEN_BAD
                                                       : SCREEN_GOOD,
               text);
    snprintf(text, sizeof text,
             _("%llu replies, %llu timeouts, %llu retries, %llu bad sums; line lost %u times"),
             (unsigned long long)n->rx_frames, (unsigned long long)n->timeouts,
             (unsigned long long)n->retries, (unsigned long long)n->bad_sums, m->drops);
    screen_put(f->link, 9, n->timeouts || n->bad_sums ? SCREEN_WARN : SCREEN_PLAIN, text);
}

/* Of the motion; beside it, or where there is none, what else the robot is busy with. */
static void draw_play(const monitor *m, const frame *f)
{
    grobo_play_progress p;
    char text[MONITOR_TEXT_BYTES];
    int width = f->columns / 3;
    const char *busy = m->job ? monitor_busy(m) : NULL;
    if (!m->list.n) {
        screen_put(f->play, 0, SCREEN_WARN, busy ? busy : "");
        return;
    }
    grobo_robot_progress(m->c.robot, &p);
    int full = p.total_us ? (int)((double)p.t_us / (double)p.total_us * width + 0.5) : 0;
    for (int k = 0; k < width; k++) {
        screen_put(f->play, k, k < full ? SCREEN_GOOD : SCREEN_DIM,
                   m->blocks  ? (k < full ? "█" : "░")
                   : k < full ? "#"
                              : "-");
    }
    snprintf(text, sizeof text, _("%s %.1f of %.1f s at %d %%  %s"),
             _(grobo_sequencer_state_name(p.state)), (double)p.t_us / 1e6, (double)p.total_us / 1e6,
             m->keys.speed_pct, m->list.path[0]);
    screen_put(f->play, width + GAP, busy ? SCREEN_WARN : SCREEN_PLAIN, busy ? busy : text);
}

/* A tall terminal has room for what was said before, the latest first. */
static void draw_log(const monitor *m, const frame *f)
{
    for (int i = 0; i < m->n_log && f->said + 1 + i < f->help - 1; i++) {
        int at = (m->n_log - 1 - i) % MONITOR_LOG;
        screen_put(f->said + 1 + i, 0, SCREEN_DIM, m->log[at]);
        if (i == MONITOR_LOG - 1) {
            return;
        }
    }
}

static void draw_help(const monitor *m, const frame *f)
{
    char groups[16] = "";
    char text[MONITOR_TEXT_BYTES];
    int n = m->model->n_groups < MONITOR_GROUP_KEYS ? m->model->n_groups : MONITOR_GROUP_KEYS;
    if (n) {
        snprintf(groups, sizeof groups, n > 1 ? " 0-%d" : " 0", n - 1);
    }
    snprintf(text, sizeof text,
             _("arrows%s choose   t torque on/off   b brake   [ ] 1 deg   { } 5 deg   i init"),
             groups);
    screen_put(f->help, 0, SCREEN_DIM, text);
    screen_put(f->help + 1, 0, SCREEN_BOLD, _("e EMERGENCY STOP   R release the stop   q quit"));
    if (m->list.n) {
        screen_put(f->help + 2, 0, SCREEN_DIM, _("p play   space pause   + - speed   s stop"));
    }
}

static int longest_name(const monitor *m)
{
    int most = NAME_LEAST;
    for (int j = 0; j < m->model->n_joints; j++) {
        int length = (int)strlen(short_name(m, j));
        most = length > most ? length : most;
    }
    return most;
}

static int digits_of_ids(const grobo_model *model)
{
    for (int j = 0; j < model->n_joints; j++) {
        if (grobo_model_joint(model, j)->motor >= THREE_DIGITS) {
            return 3;
        }
    }
    return 2;
}

/* The layout for this screen, and the columns of a joint: the name before the bar. */
static frame compose(monitor *m, int rows, int columns)
{
    frame f = {.rows = rows, .columns = columns, .id = digits_of_ids(m->model)};
    monitor_lay_out(&m->layout, m->model, rows - ROWS_AROUND,
                    (columns + GAP) / (COLUMN_LEAST + GAP));
    int width = (columns + GAP) / m->layout.n_columns - GAP;
    int around = f.id + 1 + ANGLE + AFTER_BAR, name = longest_name(m);
    f.name = name < width - around - BAR_LEAST ? name : width - around - BAR_LEAST;
    f.bar = width - around - f.name;
    f.bar = f.bar > BAR_MOST ? BAR_MOST : f.bar;
    f.stride = around + f.name + f.bar + GAP;
    f.top = monitor_top(&m->layout, m->cursor);
    int body = m->layout.n_rows < m->layout.height ? m->layout.n_rows : m->layout.height;
    f.link = ROW_BODY + body + 1;
    f.play = f.link + 1;
    f.said = f.play + 2;
    f.help = rows == ROWS_USUAL ? rows - 4 : rows - 3; /* a line below stays free */
    return f;
}

void monitor_draw(monitor *m)
{
    int rows, columns;
    screen_begin(&rows, &columns);
    if (rows < LEAST_ROWS || columns < LEAST_COLUMNS) {
        screen_put(0, 0, SCREEN_WARN, _("terminal too small (80x24 needed)"));
        screen_put(1, 0, SCREEN_BOLD, _("e EMERGENCY STOP   q quit"));
        screen_end();
        return;
    }
    frame f = compose(m, rows, columns);
    draw_title(m, columns);
    draw_joints(m, &f);
    draw_link(m, &f);
    draw_play(m, &f);
    screen_put(f.said, 0, m->bad ? SCREEN_BAD : SCREEN_PLAIN, m->said);
    draw_log(m, &f);
    draw_help(m, &f);
    screen_end();
}
