/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>

#include <grobo/core/lines.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/view/render.h"

static const grobo_model *model_of(const conn *c)
{
    return grobo_robot_driver(c->robot)->model;
}

static bool has(const grobo_joint_info *info, grobo_field field)
{
    return (info->state.valid & field) != 0;
}

const char *render_torque(const grobo_joint_info *info)
{
    if (!info->torque_known) {
        return "?";
    }
    switch (info->state.torque) {
    case GROBO_TORQUE_OFF:
        return "off";
    case GROBO_TORQUE_ON:
        return "on";
    case GROBO_TORQUE_BRAKE:
        return "brake";
    }
    return "?";
}

bool render_target(const grobo_joint_info *info, double *target_rad)
{
    bool told =
        has(info, GROBO_FIELD_GOAL) && info->torque_known && info->state.torque == GROBO_TORQUE_ON;
    *target_rad = info->has_target ? info->target_rad : info->state.goal_rad;
    return info->has_target || told;
}

/* The name of a joint's line; NULL: the robot has one. */
static const char *line_of(const conn *c, int joint)
{
    const grobo_lines *lines = grobo_driver_lines(grobo_robot_driver(c->robot));
    return lines ? lines->line[lines->line_of[joint]].name : NULL;
}

/* The column of it, or nothing: a heading, where there is no joint. */
static void line_cell(const conn *c, int joint)
{
    int width = (int)strlen("line");
    for (int k = 0; k < model_of(c)->n_joints; k++) {
        const char *name = line_of(c, k);
        int length = name ? (int)strlen(name) : 0;
        width = length > width ? length : width;
    }
    if (line_of(c, 0)) {
        app_print("%-*s  ", width, joint < 0 ? "line" : line_of(c, joint));
    }
}

/* NULL is null. */
static json_t *integer_or_null(bool known, long value)
{
    return known ? json_integer(value) : NULL;
}

json_t *render_setup_json(const conn *c, int joint)
{
    conn_setup why;
    return conn_setup_of(c, joint, &why)
               ? json_pack("{s:o,s:o}", "message", app_json_text(why.fact), "fix",
                           app_json_text(why.fix))
               : NULL;
}

static json_t *joint_json(const conn *c, int joint)
{
    const grobo_joint *j = grobo_model_joint(model_of(c), joint);
    grobo_joint_info i;
    double target_rad;
    if (grobo_robot_joint(c->robot, joint, &i) < 0) {
        return json_pack("{s:i,s:i,s:s}", "joint", joint, "motor", j->motor, "name", j->name);
    }
    const char *line = line_of(c, joint);
    bool fresh = i.angle_age_us != GROBO_NEVER_US, targeted = render_target(&i, &target_rad);
    json_t *row = json_pack(
        "{s:i,s:i,s:s,s:o,s:o,s:s?,s:o?,s:o?,s:o?,s:o,s:o?,s:o,s:o*,s:s*}", "joint", joint, "motor",
        j->motor, "name", j->name, "angle_deg",
        app_json_number(fresh ? grobo_deg_from_rad(i.state.angle_rad) : NAN, 1), "target_deg",
        app_json_number(targeted ? grobo_deg_from_rad(target_rad) : NAN, 1), "torque",
        i.torque_known ? render_torque(&i) : NULL, "speed_dps",
        integer_or_null(has(&i, GROBO_FIELD_SPEED), i.state.speed_dps), "current_ma",
        integer_or_null(has(&i, GROBO_FIELD_CURRENT), i.state.current_ma), "temperature_c",
        integer_or_null(has(&i, GROBO_FIELD_TEMPERATURE), i.state.temperature_c), "voltage_v",
        app_json_number(has(&i, GROBO_FIELD_VOLTAGE) ? i.state.voltage_mv / 1e3 : NAN, 2), "age_ms",
        integer_or_null(fresh, fresh ? (long)(i.angle_age_us / 1000) : 0), "status",
        app_json_code(grobo_error_name(i.status)), "setup", render_setup_json(c, joint), "line",
        line);
    joints_add_unit(row, model_of(c), joint);
    joints_add_value(row, "value", model_of(c), joint, fresh ? i.state.angle_rad : NAN);
    joints_add_value(row, "target", model_of(c), joint, targeted ? target_rad : NAN);
    return row;
}

json_t *render_joints_json(const conn *c, grobo_joint_mask joints)
{
    json_t *list = json_array();
    for (int j = 0; j < model_of(c)->n_joints; j++) {
        if (joints & GROBO_JOINT_BIT(j)) {
            json_array_append_new(list, joint_json(c, j));
        }
    }
    return list;
}

static void cell(bool known, int width, int decimals, double value)
{
    double unit = pow(10, -decimals);
    if (known) {
        app_print("  %*.*f", width, decimals, fabs(value) < unit / 2 ? 0.0 : value); /* no -0.0 */
    } else {
        app_print("  %*s", width, "-");
    }
}

/* What a column of angles has more where a joint of the robot has a unit of its own. */
static const char *unit_gap(const grobo_model *model)
{
    bool own = false;
    for (int k = 0; k < model->n_joints; k++) {
        own = own || grobo_model_unit(model, k) != GROBO_UNIT_DEG;
    }
    return own ? "  " : "";
}

/* An angle in the joint's unit, and the gap behind its column. */
static void angle_cell(const grobo_model *model, int joint, bool known, int width, double angle_rad)
{
    if (known) {
        double value = grobo_model_value(model, joint, angle_rad);
        app_print("%*.1f%s", width, fabs(value) < 0.05 ? 0.0 : value, joints_mark(model, joint));
    } else {
        app_print("%*s  ", width, "-");
    }
    app_print("%s", unit_gap(model));
}

/* Of the column of names: a longer one would shift its row. */
static int name_width(const grobo_model *model)
{
    int width = 12;
    for (int k = 0; k < model->n_joints; k++) {
        int length = (int)strlen(grobo_model_joint(model, k)->name);
        width = length > width ? length : width;
    }
    return width;
}

void render_status(const conn *c, grobo_joint_mask joints)
{
    const grobo_model *model = model_of(c);
    bool color = c->a->color_out;
    int width = name_width(model);
    const char *gap = unit_gap(model);
    line_cell(c, -1);
    app_print("motor  %-*s  angle%s  target%s  torque  speed  current  temp  volts  age ms\n",
              width, "joint", gap, gap);
    for (int k = 0; k < model->n_joints; k++) {
        grobo_joint_info i;
        double target_rad;
        if (!(joints & GROBO_JOINT_BIT(k)) || grobo_robot_joint(c->robot, k, &i) < 0) {
            continue;
        }
        bool known = i.angle_age_us != GROBO_NEVER_US;
        line_cell(c, k);
        app_print("%5d  %-*s  ", grobo_model_joint(model, k)->motor, width,
                  grobo_model_joint(model, k)->name);
        angle_cell(model, k, known, 5, i.state.angle_rad);
        bool targeted = render_target(&i, &target_rad);
        angle_cell(model, k, targeted, 6, target_rad);
        app_print("%-6s", render_torque(&i));
        cell(has(&i, GROBO_FIELD_SPEED), 5, 0, i.state.speed_dps);
        cell(has(&i, GROBO_FIELD_CURRENT), 7, 0, i.state.current_ma);
        cell(has(&i, GROBO_FIELD_TEMPERATURE), 4, 0, i.state.temperature_c);
        cell(has(&i, GROBO_FIELD_VOLTAGE), 5, 2, i.state.voltage_mv / 1e3);
        cell(known, 6, 0, known ? (double)(i.angle_age_us / 1000) : 0);
        if (i.status != GROBO_OK) {
            app_print("  %s%s%s", color ? "\033[31m" : "", grobo_error_text(i.status),
                      color ? "\033[0m" : "");
        } else if (i.state.overheated) {
            app_print("  %scut its torque for heat: see 'grctl doctor'%s", color ? "\033[31m" : "",
                      color ? "\033[0m" : "");
        }
        app_print("\n");
    }
}

double render_worst_error(const conn *c, int *joint)
{
    double worst = 0;
    *joint = -1;
    for (int k = 0; k < model_of(c)->n_joints; k++) {
        grobo_joint_info i;
        if (grobo_robot_joint(c->robot, k, &i) < 0 || !i.has_target ||
            i.angle_age_us == GROBO_NEVER_US || i.status != GROBO_OK) {
            continue;
        }
        double error = fabs(grobo_deg_from_rad(i.state.angle_rad - i.target_rad));
        if (*joint < 0 || error > worst) {
            worst = error;
            *joint = k;
        }
    }
    return worst;
}

/* The last column: its unit follows. */
static void error_cell(const grobo_model *model, int joint, bool known, double error_rad)
{
    double error = grobo_model_change(model, joint, error_rad);
    bool in_deg = grobo_model_unit(model, joint) == GROBO_UNIT_DEG;
    if (known) {
        app_print("%9.2f%s", fabs(error) < 0.005 ? 0.0 : error,
                  in_deg ? "" : joints_mark(model, joint));
    } else {
        app_print("%9s", "-");
    }
}

void render_reached(const conn *c)
{
    const grobo_model *model = model_of(c);
    int width = name_width(model);
    const char *gap = unit_gap(model);
    line_cell(c, -1);
    app_print("motor  %-*s  target%s  reached%s  error%s\n", width, "joint", gap, gap,
              *gap ? "" : " deg");
    for (int k = 0; k < model->n_joints; k++) {
        grobo_joint_info i;
        if (grobo_robot_joint(c->robot, k, &i) < 0) {
            continue;
        }
        bool both = i.has_target && i.status == GROBO_OK && i.angle_age_us != GROBO_NEVER_US;
        line_cell(c, k);
        app_print("%5d  %-*s  ", grobo_model_joint(model, k)->motor, width,
                  grobo_model_joint(model, k)->name);
        angle_cell(model, k, i.has_target, 6, i.target_rad);
        angle_cell(model, k, i.angle_age_us != GROBO_NEVER_US, 7, i.state.angle_rad);
        error_cell(model, k, both, i.state.angle_rad - i.target_rad);
        if (i.status != GROBO_OK) {
            app_print("  %s", grobo_error_text(i.status));
        }
        app_print("\n");
    }
}
