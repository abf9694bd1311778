/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "tools/grctl/show/render.h"

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
    if (!info->torque_known)
        return "?";
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

/*
 * Where the joint was sent: by this process, or as its servo reports. A servo without torque keeps
 * an old goal that it does not go to.
 */
static bool target_of(const grobo_joint_info *info, double *target_rad)
{
    bool told =
        has(info, GROBO_FIELD_GOAL) && info->torque_known && info->state.torque == GROBO_TORQUE_ON;
    *target_rad = info->has_target ? info->target_rad : info->state.goal_rad;
    return info->has_target || told;
}

static json_t *integer_or_null(bool known, long value)
{
    return known ? json_integer(value) : json_null();
}

json_t *render_joint_json(const conn *c, int joint, int64_t now_us)
{
    const grobo_joint *j = &model_of(c)->joints[joint];
    grobo_joint_info i;
    double target_rad;
    bool fresh;
    json_t *o = json_pack("{s:i,s:i,s:s}", "joint", joint, "motor", j->motor, "name", j->name);
    if (grobo_robot_joint(c->robot, joint, &i) < 0)
        return o;
    fresh = i.angle_age_us != GROBO_NEVER_US;
    json_object_set_new(o, "angle_deg",
                        fresh ? app_json_number(grobo_deg_from_rad(i.state.angle_rad), 1)
                              : json_null());
    json_object_set_new(o, "target_deg",
                        target_of(&i, &target_rad)
                            ? app_json_number(grobo_deg_from_rad(target_rad), 1)
                            : json_null());
    json_object_set_new(o, "torque", i.torque_known ? json_string(render_torque(&i)) : json_null());
    json_object_set_new(o, "speed_dps",
                        integer_or_null(has(&i, GROBO_FIELD_SPEED), i.state.speed_dps));
    json_object_set_new(o, "current_ma",
                        integer_or_null(has(&i, GROBO_FIELD_CURRENT), i.state.current_ma));
    json_object_set_new(o, "temperature_c",
                        integer_or_null(has(&i, GROBO_FIELD_TEMPERATURE), i.state.temperature_c));
    json_object_set_new(o, "voltage_v",
                        has(&i, GROBO_FIELD_VOLTAGE) ? app_json_number(i.state.voltage_mv / 1e3, 2)
                                                     : json_null());
    json_object_set_new(o, "age_ms",
                        integer_or_null(fresh, fresh ? (long)(i.angle_age_us / 1000) : 0));
    json_object_set_new(o, "status", app_json_code(grobo_error_name(i.status)));
    return o;
}

static void cell(bool known, int width, int decimals, double value)
{
    double unit = pow(10, -decimals);
    if (known)
        app_print("  %*.*f", width, decimals, fabs(value) < unit / 2 ? 0.0 : value); /* no -0.0 */
    else
        app_print("  %*s", width, "-");
}

void render_status(const conn *c, grobo_joint_mask joints, int64_t now_us)
{
    const grobo_model *model = model_of(c);
    bool color = c->a->color_out;
    app_print("motor  joint         angle  target  torque  speed  current  temp  volts  age ms\n");
    for (int k = 0; k < model->n_joints; k++) {
        grobo_joint_info i;
        double target_rad;
        bool known, targeted;
        if (!(joints & GROBO_JOINT_BIT(k)) || grobo_robot_joint(c->robot, k, &i) < 0)
            continue;
        known = i.angle_age_us != GROBO_NEVER_US;
        app_print("%5d  %-12s", model->joints[k].motor, model->joints[k].name);
        cell(known, 5, 1, grobo_deg_from_rad(i.state.angle_rad));
        targeted = target_of(&i, &target_rad);
        cell(targeted, 6, 1, grobo_deg_from_rad(target_rad));
        app_print("  %-6s", render_torque(&i));
        cell(has(&i, GROBO_FIELD_SPEED), 5, 0, i.state.speed_dps);
        cell(has(&i, GROBO_FIELD_CURRENT), 7, 0, i.state.current_ma);
        cell(has(&i, GROBO_FIELD_TEMPERATURE), 4, 0, i.state.temperature_c);
        cell(has(&i, GROBO_FIELD_VOLTAGE), 5, 2, i.state.voltage_mv / 1e3);
        cell(known, 6, 0, known ? (double)(i.angle_age_us / 1000) : 0);
        if (i.status != GROBO_OK)
            app_print("  %s%s%s", color ? "\033[31m" : "", grobo_error_text(i.status),
                      color ? "\033[0m" : "");
        app_print("\n");
    }
}

double render_worst_error(const conn *c, int64_t now_us, int *joint)
{
    double worst = 0;
    *joint = -1;
    for (int k = 0; k < model_of(c)->n_joints; k++) {
        grobo_joint_info i;
        double error;
        if (grobo_robot_joint(c->robot, k, &i) < 0 || !i.has_target ||
            i.angle_age_us == GROBO_NEVER_US || i.status != GROBO_OK)
            continue;
        error = fabs(grobo_deg_from_rad(i.state.angle_rad - i.target_rad));
        if (*joint < 0 || error > worst) {
            worst = error;
            *joint = k;
        }
    }
    return worst;
}

void render_reached(const conn *c, int64_t now_us)
{
    const grobo_model *model = model_of(c);
    app_print("motor  joint         target  reached  error deg\n");
    for (int k = 0; k < model->n_joints; k++) {
        grobo_joint_info i;
        bool both;
        if (grobo_robot_joint(c->robot, k, &i) < 0)
            continue;
        both = i.has_target && i.status == GROBO_OK && i.angle_age_us != GROBO_NEVER_US;
        app_print("%5d  %-12s", model->joints[k].motor, model->joints[k].name);
        cell(i.has_target, 6, 1, grobo_deg_from_rad(i.target_rad));
        cell(i.angle_age_us != GROBO_NEVER_US, 7, 1, grobo_deg_from_rad(i.state.angle_rad));
        cell(both, 9, 2, grobo_deg_from_rad(i.state.angle_rad - i.target_rad));
        if (i.status != GROBO_OK)
            app_print("  %s", grobo_error_text(i.status));
        app_print("\n");
    }
}
