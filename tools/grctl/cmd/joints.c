/* SPDX-License-Identifier: MIT */
/* joints: the robot's table of joints. Offline. */
#include <math.h>
#include <string.h>

#include <grobo/core/unit.h>

#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cmd/commands.h"

enum { NAMES_BYTES = 128 };

/* The line of a joint where there are several, and its groups, split by blanks, without those of
 * every joint. */
static void group_names(const app *a, int joint, char *names)
{
    const grobo_model *model = app_model(a);
    const grobo_robot_def *def = robot_of(a);
    size_t at = 0;
    *names = '\0';
    if (def->n_lines > 0) {
        at = (size_t)snprintf(names, NAMES_BYTES, "(line %s)",
                              def->lines[grobo_model_joint(model, joint)->line].name);
    }
    for (int i = 0; i < model->n_groups && at < NAMES_BYTES; i++) {
        const grobo_group *group = &model->groups[i];
        bool has = (group->joints & GROBO_JOINT_BIT(joint)) != 0;
        if (has && group->joints != GROBO_JOINTS_ALL(model->n_joints)) {
            at +=
                (size_t)snprintf(names + at, NAMES_BYTES - at, "%s%s", at ? " " : "", group->name);
        }
    }
}

static void print_joint(const app *a, int joint)
{
    const grobo_model *model = app_model(a);
    const grobo_joint *j = grobo_model_joint(model, joint);
    char number[8], motor[8], names[NAMES_BYTES];
    snprintf(number, sizeof number, "j%d", joint);
    snprintf(motor, sizeof motor, "m%d", j->motor);
    group_names(a, joint, names);
    if (j->ratio != 0) {
        size_t at = strlen(names);
        snprintf(names + at, sizeof names - at, "%s(follows %s)", at ? " " : "",
                 grobo_model_joint(model, j->follows)->name);
    }
    if (j->wheel) {
        app_print("%-12s  %5s  %5s  %6d     -     -     -  %s%s(wheel, %.0f deg/s)\n", j->name,
                  number, motor, j->motor, names, *names ? " " : "",
                  grobo_deg_from_rad(j->max_speed_rad_s));
        return;
    }
    double low = grobo_model_value(model, joint, j->min_rad);
    double high = grobo_model_value(model, joint, j->max_rad);
    app_print("%-12s  %5s  %5s  %6d  %4.0f  %4.0f  %4.0f%s%s\n", j->name, number, motor, j->motor,
              fmin(low, high), fmax(low, high), grobo_model_value(model, joint, j->init_rad),
              joints_mark(model, joint), names);
}

static json_t *joint_json(const app *a, int joint)
{
    const grobo_model *model = app_model(a);
    const grobo_robot_def *def = robot_of(a);
    const grobo_joint *j = grobo_model_joint(model, joint);
    json_t *row = json_pack("{s:i,s:i,s:i,s:s,s:[o,o],s:o,s:o}", "joint", joint, "motor", j->motor,
                            "id", j->motor, "name", j->name, "limits_deg",
                            app_json_number(grobo_deg_from_rad(j->min_rad), 1),
                            app_json_number(grobo_deg_from_rad(j->max_rad), 1), "init_deg",
                            app_json_number(grobo_deg_from_rad(j->init_rad), 1), "groups",
                            joints_groups_json(model, joint));
    if (def->n_lines > 0) {
        json_object_set_new(row, "line", json_string(def->lines[j->line].name));
    }
    if (j->ratio != 0) {
        json_object_set_new(row, "follows", json_integer(j->follows));
        json_object_set_new(row, "ratio", app_json_number(j->ratio, 6));
    }
    if (j->wheel) {
        json_object_set_new(row, "wheel", json_true());
        json_object_set_new(row, "speed_deg_s",
                            app_json_number(grobo_deg_from_rad(j->max_speed_rad_s), 1));
        json_object_set_new(row, "accel_deg_s2",
                            app_json_number(grobo_deg_from_rad(j->accel_rad_s2), 1));
    }
    joints_add_unit(row, model, joint);
    joints_add_value(row, "at_min", model, joint, j->min_rad);
    joints_add_value(row, "at_max", model, joint, j->max_rad);
    joints_add_value(row, "init", model, joint, j->init_rad);
    return row;
}

static int run(app *a)
{
    const grobo_model *model = app_model(a);
    grobo_joint_mask joints;
    int status = joints_parse_all(a, a->line.n_arguments, a->line.argument, &joints);
    if (status) {
        return status;
    }
    json_t *list = a->json ? json_array() : NULL;
    if (!list) {
        app_print("name          joint  motor     id   min   max  init  groups\n");
    }
    for (int j = 0; j < model->n_joints; j++) {
        if (!(joints & GROBO_JOINT_BIT(j))) {
            continue;
        }
        if (list) {
            json_array_append_new(list, joint_json(a, j));
        } else {
            print_joint(a, j);
        }
    }
    if (list) {
        app_print_json(json_pack("{s:s,s:o}", "robot", model->name, "joints", list));
    }
    return EXIT_DONE;
}

const cli_command cmd_joints = {
    .name = "joints",
    COMMAND_ARGUMENTS("[JOINT|GROUP]...", 0, -1, CLI_ARG_JOINT),
    .summary = "list joints: names, motors, servo ids, limits, groups",
    .details = "Prints the robot's joints, or those named: the three names that a command takes\n"
               "(R_KNEE_P, j3, m9), the servo's id on the bus, the limits and the initial posture\n"
               "in degrees (of linear joints in mm, of grippers with a range in percent), and the\n"
               "groups. Every joint is also in the group all. The table is that of the robot's\n"
               "model: no robot is asked, and trims of a configured robot are not in it.\n",
    .example = "  grctl joints\n  grctl joints right_arm --json\n",
    .run = run,
};
