/* SPDX-License-Identifier: MIT */
/* For a robot of several lines: a command of one line, run for each or for the one it is on. */
#include <string.h>

#include <grobo/core/lines.h>

#include "tools/grctl/cli/each_line.h"
#include "tools/grctl/cli/joints.h"
#include "tools/grctl/cli/output.h"
#include "tools/grctl/cli/robot.h"

/* What the command does to the robot is undone: the next line begins as this one did. */
static int run_on(app *a, int line, bool headed)
{
    const app before = *a;
    const grobo_robot_file_line *is = &robot_of(a)->lines[line];
    int status = robot_on_line(a, line);
    if (headed && !status) {
        snprintf(a->place, sizeof a->place, "%.60s%.60s: ", before.place, is->name);
        if (a->json) {
            app_json_line(is->name);
        } else if (a->verbosity >= 0) {
            const char *port = a->portless ? "" : app_global(a, GLOBAL_DEVICE)->text;
            app_print("%s: %s, %u bps%s%s\n", is->name, is->family->name, (unsigned)is->baud_bps,
                      *port ? ", " : "", port);
        }
    }
    status = status ? status : a->line.command->run(a);
    app_json_line(NULL);
    *a = before;
    return status;
}

int each_line_refuse_trace(app *a)
{
    if (robot_of(a)->n_lines == 0 || !app_global(a, GLOBAL_TRACE)->given) {
        return EXIT_DONE;
    }
    return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                    "%s: --trace is for one line, as --line %s names it", a->line.command->name,
                    robot_of(a)->lines[0].name);
}

int each_line_all(app *a)
{
    int status = each_line_refuse_trace(a), n_lines = status ? 0 : robot_of(a)->n_lines;
    for (int line = 0; line < n_lines && status < EXIT_SIGNAL; line++) {
        int ended = run_on(a, line, true);
        status = ended > status ? ended : status;
    }
    return status;
}

/* The only line with a servo of this id; negative: there is none, or several. */
static int line_with(const grobo_robot_def *def, int id, int *n)
{
    int line = -1;
    *n = 0;
    for (int j = 0; j < def->model->n_joints; j++) {
        if (grobo_model_joint(def->model, j)->motor == id) {
            line = def->on_lines->line_of[j];
            (*n)++;
        }
    }
    return *n == 1 ? line : -1;
}

/* A servo by the name of a joint, or by an id that one line alone has. */
static int run_of_servo(app *a)
{
    const grobo_robot_def *def = robot_of(a);
    const char *servo = a->line.argument[0];
    double id;
    int n = 0;
    if (!cli_read_number(servo, &id)) {
        int status = 0, joint = joints_parse_one(a, servo, strlen(servo), &status);
        return joint < 0 ? status : run_on(a, def->on_lines->line_of[joint], false);
    }
    int line = line_with(def, (int)id, &n);
    if (line < 0) {
        return app_fail(a, EXIT_USAGE, "ARG",
                        n > 1 ? "%s: %s has %d servos of id %s: name the joint, or the line: "
                                "--line %s"
                              : "%s: %s has %d joints of id %s; name the line of another servo: "
                                "--line %s",
                        a->line.command->name, def->name, n, servo, def->lines[0].name);
    }
    return run_on(a, line, false);
}

int each_line_run(app *a)
{
    const cli_command *command = a->line.command;
    const grobo_robot_def *def = robot_of(a);
    if (def->n_lines == 0 || command->lines == CLI_LINES_WHOLE) {
        return command->run(a);
    }
    if (a->link) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED",
                        "%s: this shell has all lines of %s; 'grctl --line %s shell' has one",
                        command->name, def->name, def->lines[0].name);
    }
    switch (command->lines) {
    case CLI_LINES_WHOLE:
    case CLI_LINES_ONE:
        break;
    case CLI_LINES_EACH:
        return each_line_all(a);
    case CLI_LINES_SERVO:
        return run_of_servo(a);
    }
    return app_fail(a, EXIT_USAGE, "ARG", "%s: %s has %d lines: choose one, as by --line %s",
                    command->name, def->name, def->n_lines, def->lines[0].name);
}
