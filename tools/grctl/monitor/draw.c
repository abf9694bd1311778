/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/monitor/monitor.h"
#include "tools/grctl/screen/screen.h"
#include "tools/grctl/show/render.h"

enum { LEAST_ROWS = 20, LEAST_COLUMNS = 80, BAR_MOST = 40, GAP = 2 };
/* Columns of a joint beside its bar: motor, mark, name, angle; torque, heat, current. */
enum { BEFORE_BAR = 20, AFTER_BAR = 12, STALE_US = 2000000, WARM_BELOW = 10, BEYOND_DEG = 2 };
enum { ROW_TITLE, ROW_BODY = 2, ROW_LINK = 15, ROW_PLAY = 16, ROW_SAID = 18, ROW_HELP = 20 };

/* Where joints stand on the screen: the robot's right side left, as one sees who faces us. */
static const struct {
    const char *joint;
    int row;    /* below the title */
    int column; /* 0, 1 */
} places[MONITOR_PLACES] = {
    {"NECK_Y", 0, 0},       {"R_SHOULDER_P", 2, 0}, {"R_SHOULDER_R", 3, 0}, {"R_ELBOW_P", 4, 0},
    {"R_HIP_Y", 6, 0},      {"R_HIP_R", 7, 0},      {"R_HIP_P", 8, 0},      {"R_KNEE_P", 9, 0},
    {"R_ANKLE_P", 10, 0},   {"R_ANKLE_R", 11, 0},   {"CHEST_P", 0, 1},      {"L_SHOULDER_P", 2, 1},
    {"L_SHOULDER_R", 3, 1}, {"L_ELBOW_P", 4, 1},    {"L_HIP_Y", 6, 1},      {"L_HIP_R", 7, 1},
    {"L_HIP_P", 8, 1},      {"L_KNEE_P", 9, 1},     {"L_ANKLE_P", 10, 1},   {"L_ANKLE_R", 11, 1},
};

int monitor_joint(const monitor *m, int place)
{
    const char *name = places[place].joint;
    return grobo_model_find_joint(m->model, name, strlen(name));
}

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
    double part = (angle_rad - j->min_rad) / (j->max_rad - j->min_rad);
    int at = (int)lround(part * (width - 1));
    return at < 0 ? 0 : at >= width ? width - 1 : at;
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

static void draw_joint(const monitor *m, int place, int column, int bar)
{
    int joint = monitor_joint(m, place), row = ROW_BODY + places[place].row;
    const grobo_joint *j = &m->model->joints[joint];
    bool chosen = (m->chosen & GROBO_JOINT_BIT(joint)) != 0;
    const char *name = j->name + (strncmp(j->name + 1, "_", 1) == 0 ? 2 : 0);
    grobo_joint_info i;
    char text[64];
    snprintf(text, sizeof text, "%2d%c%-10s", j->motor, chosen ? '>' : ' ', name);
    screen_put(row, column, chosen ? SCREEN_BOLD : SCREEN_PLAIN, text);
    if (grobo_robot_joint(m->c.robot, joint, &i) < 0) {
        return;
    }
    if (i.angle_age_us == GROBO_NEVER_US || i.angle_age_us > STALE_US) {
        if (i.status < 0 && i.status != GROBO_ERR_EMPTY) {
            const char *why = _(grobo_error_text(i.status));
            snprintf(text, sizeof text, " %.*s", (int)lang_fit(why, 24), why);
        } else if (i.angle_age_us == GROBO_NEVER_US) {
            snprintf(text, sizeof text, _(" not read yet"));
        } else {
            snprintf(text, sizeof text, _(" not read for %.0f s"), (double)i.angle_age_us / 1e6);
        }
        screen_put(row, column + 13, SCREEN_BAD, text);
        return;
    }
    snprintf(text, sizeof text, "%6.1f", grobo_deg_from_rad(i.state.angle_rad) + 0.0);
    screen_put(row, column + 13, SCREEN_PLAIN, text);
    draw_bar(m, j, &i, row, column + BEFORE_BAR, bar);
    draw_values(m, &i, row, column + BEFORE_BAR + bar);
}

static void draw_heads(int column, int bar)
{
    screen_put(ROW_BODY - 1, column, SCREEN_DIM, " m joint        deg");
    screen_put(ROW_BODY - 1, column + BEFORE_BAR, SCREEN_DIM, bar >= 6 ? _("limits") : "");
    screen_put(ROW_BODY - 1, column + BEFORE_BAR + bar, SCREEN_DIM, "      C   mA");
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

static void draw_link(const monitor *m)
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
    snprintf(text, sizeof text, "%5.2f V", low_mv / 1e3);
    screen_put(ROW_LINK, 0,
               low_mv && low_mv < limits->voltage_mv * 11 / 10 ? SCREEN_BAD : SCREEN_GOOD, text);
    snprintf(text, sizeof text,
             _("%llu replies, %llu timeouts, %llu retries, %llu bad sums; line lost %u times"),
             (unsigned long long)n->rx_frames, (unsigned long long)n->timeouts,
             (unsigned long long)n->retries, (unsigned long long)n->bad_sums, m->drops);
    screen_put(ROW_LINK, 9, n->timeouts || n->bad_sums ? SCREEN_WARN : SCREEN_PLAIN, text);
}

/* Of the motion; beside it, or where there is none, what else the robot is busy with. */
static void draw_play(const monitor *m, int columns)
{
    grobo_play_progress p;
    char text[MONITOR_TEXT_BYTES];
    int width = columns / 3;
    const char *busy = m->job ? monitor_busy(m) : NULL;
    if (!m->list.n) {
        screen_put(ROW_PLAY, 0, SCREEN_WARN, busy ? busy : "");
        return;
    }
    grobo_robot_progress(m->c.robot, &p);
    int full = p.total_us ? (int)((double)p.t_us / (double)p.total_us * width + 0.5) : 0;
    for (int k = 0; k < width; k++) {
        screen_put(ROW_PLAY, k, k < full ? SCREEN_GOOD : SCREEN_DIM,
                   m->blocks  ? (k < full ? "█" : "░")
                   : k < full ? "#"
                              : "-");
    }
    snprintf(text, sizeof text, _("%s %.1f of %.1f s at %d %%  %s"),
             _(grobo_sequencer_state_name(p.state)), (double)p.t_us / 1e6, (double)p.total_us / 1e6,
             m->keys.speed_pct, m->list.path[0]);
    screen_put(ROW_PLAY, width + GAP, busy ? SCREEN_WARN : SCREEN_PLAIN, busy ? busy : text);
}

/* At the bottom; on a terminal of 24 rows a line below stays free. */
static int help_row(int rows)
{
    return rows == ROW_HELP + 4 ? ROW_HELP : rows - 3;
}

/* A tall terminal has room for what was said before, the latest first. */
static void draw_log(const monitor *m, int rows)
{
    for (int i = 0; i < m->n_log && ROW_SAID + 1 + i < help_row(rows) - 1; i++) {
        int at = (m->n_log - 1 - i) % MONITOR_LOG;
        screen_put(ROW_SAID + 1 + i, 0, SCREEN_DIM, m->log[at]);
        if (i == MONITOR_LOG - 1) {
            return;
        }
    }
}

static void draw_help(const monitor *m, int rows)
{
    static const char *const lines[] = {
        N_("arrows 0-7 choose   t torque on/off   b brake   [ ] 1 deg   { } 5 deg   i init"),
        N_("e EMERGENCY STOP   R release the stop   q quit"),
    };
    static const char *const play = N_("p play   space pause   + - speed   s stop");
    int row = help_row(rows);
    screen_put(row, 0, SCREEN_DIM, _(lines[0]));
    screen_put(row + 1, 0, SCREEN_BOLD, _(lines[1]));
    if (m->list.n) {
        screen_put(row + 2, 0, SCREEN_DIM, _(play));
    }
}

void monitor_draw(const monitor *m)
{
    int rows, columns;
    screen_begin(&rows, &columns);
    if (rows < LEAST_ROWS || columns < LEAST_COLUMNS) {
        screen_put(0, 0, SCREEN_WARN, _("terminal too small (80x24 needed)"));
        screen_put(1, 0, SCREEN_BOLD, _("e EMERGENCY STOP   q quit"));
        screen_end();
        return;
    }
    int bar = (columns - GAP) / 2 - BEFORE_BAR - AFTER_BAR;
    bar = bar > BAR_MOST ? BAR_MOST : bar;
    draw_title(m, columns);
    for (int side = 0; side < 2; side++) {
        draw_heads(side * (BEFORE_BAR + bar + AFTER_BAR + GAP), bar);
    }
    for (int place = 0; place < MONITOR_PLACES; place++) {
        draw_joint(m, place, places[place].column * (BEFORE_BAR + bar + AFTER_BAR + GAP), bar);
    }
    draw_link(m);
    draw_play(m, columns);
    screen_put(ROW_SAID, 0, m->bad ? SCREEN_BAD : SCREEN_PLAIN, m->said);
    draw_log(m, rows);
    draw_help(m, rows);
    screen_end();
}
