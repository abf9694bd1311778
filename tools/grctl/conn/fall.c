/* SPDX-License-Identifier: MIT */
/*
 * The fall is simulated: a robot of the same masses, gears and friction stands where this one was
 * read, holds the other joints, and lets go. Its base is fixed: of a robot with feet, which may
 * stand on them or hang from a stand, nothing is said.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <grobo/core/robot_plant.h>
#include <grobo/core/sim_physics.h>
#include <grobo/core/sim_static.h>
#include <grobo/core/unit.h>

#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/robot.h"
#include "tools/grctl/conn/fall.h"
#include "tools/grctl/lang/lang.h"

typedef struct fall {
    grobo_joint_mask joints; /* that drop */
    double by_rad[GROBO_JOINTS_MAX];
} fall;

/* By then what falls has fallen. */
#define FALL_US 3000000
/* Less is friction, backlash, and the steps of what was read. */
#define LEAST_DEG 3

static int32_t mdeg_of(const grobo_joint *joint, double angle_rad)
{
    return (int32_t)lround(grobo_deg_from_rad(grobo_joint_to_servo(joint, angle_rad)) * 1000);
}

/* Stands where the robot was read: what keeps its torque cannot move. */
static int stand(conn *c, grobo_sim *sim, grobo_joint_mask joints, grobo_posture *at)
{
    int result = grobo_robot_posture(c->robot, GROBO_NEVER_US, at);
    for (int j = 0; result >= 0 && j < at->n_joints; j++) {
        int32_t mdeg = mdeg_of(&conn_model(c)->joints[j], at->angle_rad[j]);
        if ((at->set & GROBO_JOINT_BIT(j)) != 0) {
            result = grobo_sim_set_angle(sim, j, mdeg, 0);
        }
        if (result >= 0 && (joints & GROBO_JOINT_BIT(j)) == 0) {
            result = grobo_sim_set_wall(sim, j, mdeg, mdeg);
        }
    }
    return result < 0 ? result : 0;
}

static void look(const conn *c, const grobo_sim_physics *physics, const grobo_posture *at, fall *f)
{
    for (int j = 0; j < at->n_joints; j++) {
        grobo_sim_physics_view view;
        grobo_joint_info info;
        bool holds = grobo_robot_joint(c->robot, j, &info) == 0 &&
                     (!info.torque_known || info.state.torque == GROBO_TORQUE_ON);
        if ((at->set & GROBO_JOINT_BIT(j)) == 0 || !holds ||
            grobo_sim_physics_look(physics, j, &view) < 0) {
            continue;
        }
        f->by_rad[j] = fabs(view.angle_rad - at->angle_rad[j]);
        if (grobo_deg_from_rad(f->by_rad[j]) >= LEAST_DEG) {
            f->joints |= GROBO_JOINT_BIT(j);
        }
    }
}

/* Returns 0 or an error. */
static int fall_of(conn *c, grobo_joint_mask joints, fall *f)
{
    static grobo_sim sim; /* too large for a stack */
    const grobo_robot_def *def = robot_of(c->a);
    grobo_sim_physics *physics = NULL;
    grobo_robot_sim setting;
    grobo_posture at;
    *f = (fall){.joints = 0};
    if (!grobo_robot_def_has_weight(def) || def->n_feet > 0) {
        return 0;
    }
    robot_sim(c->a, &setting);
    int result = grobo_robot_def_physics(def, false, NULL, &physics);
    if (result >= 0) {
        setting.config.physics = physics;
        result = grobo_sim_init(&sim, &setting.config, 0);
    }
    if (result >= 0) {
        result = stand(c, &sim, joints, &at);
    }
    if (result >= 0) {
        grobo_sim_step(&sim, FALL_US);
        look(c, physics, &at, f);
    }
    grobo_sim_physics_free(physics);
    return result;
}

bool fall_note(conn *c, grobo_joint_mask joints)
{
    fall f;
    char names[512] = "";
    const grobo_model *model = conn_model(c);
    if (fall_of(c, joints, &f) < 0) {
        return false;
    }
    for (int j = 0; j < model->n_joints; j++) {
        size_t used = strlen(names);
        if ((f.joints & GROBO_JOINT_BIT(j)) != 0) {
            (void)snprintf(names + used, sizeof names - used, "%s%s %.0f %s", used ? ", " : "",
                           model->joints[j].name, fabs(grobo_model_change(model, j, f.by_rad[j])),
                           grobo_unit_name(grobo_model_unit(model, j)));
        }
    }
    if (f.joints != 0) {
        app_note(c->a, "without torque these joints drop: %s", names);
    }
    return f.joints != 0;
}

int fall_ask(conn *c, grobo_joint_mask joints, const char *command)
{
    char answer[8] = "";
    app *a = c->a;
    if (!fall_note(c, joints) || !a->tty_err || !a->tty_in || app_global(a, GLOBAL_YES)->given) {
        return 0;
    }
    output_complain(_("Hold the robot. Switch the torque off? [y/N] "));
    if (!fgets(answer, sizeof answer, stdin) || (answer[0] != 'y' && answer[0] != 'Y')) {
        return app_fail(a, EXIT_SAFETY, "UNSUPPORTED", "%s: the torque stays on", command);
    }
    return 0;
}
