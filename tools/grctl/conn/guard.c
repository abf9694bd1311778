/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include <grobo/core/port.h>
#include <grobo/session.h>

#include "tools/grctl/cli/robot.h"
#include "tools/grctl/conn/guard.h"
#include "tools/grctl/conn/trims.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

static const char *called = "grctl";

_Static_assert(sizeof(guard_robot) <= GROBO_GUARD_DATA_BYTES, "the guard takes less");

/* ---- its own process ------------------------------------------------------------------------ */

/* Of a robot that is not GR001. */
static const grobo_driver *make_driver(const guard_robot *given, grobo_wiring wiring)
{
    static grobo_driver made = GROBO_TABLE_INIT(grobo_driver);
    char complaint[APP_LINE_BYTES];
    const grobo_robot_def *def = robot_find(given->robot, complaint, sizeof complaint);
    return def && grobo_robot_def_driver(def, wiring, &made) == GROBO_OK ? &made : NULL;
}

static const grobo_driver *find_driver(void *ctx, const char *name, grobo_wiring wiring,
                                       const void *data, size_t bytes, void **driver_ctx)
{
    static trims t;
    static config_robot robot;
    guard_robot given = {.trimmed = false};
    (void)ctx;
    if (bytes && bytes <= sizeof given.robot) { /* of a program that is not grctl */
        memcpy(given.robot, data, bytes);
    } else if (bytes == sizeof given) {
        memcpy(&given, data, sizeof given);
    } else if (bytes) {
        return NULL;
    }
    given.robot[sizeof given.robot - 1] = '\0';
    const grobo_driver *inner =
        *given.robot ? make_driver(&given, wiring) : grobo_gr001_driver(wiring);
    if (!inner || strcmp(name, inner->name) != 0) {
        return NULL;
    }
    if (!given.trimmed) {
        return inner;
    }
    memcpy(robot.trim_deg, given.trim_deg, sizeof robot.trim_deg);
    memcpy(robot.offset_deg, given.offset_deg, sizeof robot.offset_deg);
    robot.offsets = given.offsets;
    *driver_ctx = &t;
    return trims_driver(&t, inner, &robot);
}

static void on_stop(void *ctx, grobo_guard_cause cause, int result)
{
    (void)ctx;
    /* One that is only stopped says so when it continues. Nobody may be left to read this. */
    if ((cause != GROBO_GUARD_DIED && result >= 0) || !os_takes_line(stderr)) {
        return;
    }
    if (result < 0) {
        fprintf(stderr,
                _("the program was killed; not every joint is seen to stand: %s; switch the robot "
                  "off\n"),
                app_error_text(result));
    } else {
        fprintf(stderr, _("the program was killed; its guard stopped the robot\n"));
    }
    fflush(stderr);
}

int guard_main(void)
{
    static const grobo_guard_program program = {GROBO_GUARD_PROGRAM_INIT, .driver = find_driver,
                                                .on_stop = on_stop};
    int error = grobo_guard_run(&program);
    if (error == GROBO_ERR_ARG || error == GROBO_ERR_UNSUPPORTED) {
        fprintf(stderr, _("grctl: guard: is started by grctl itself, to stop a robot\n"));
    }
    return error == GROBO_ERR_ARG || error == GROBO_ERR_UNSUPPORTED ? EXIT_USAGE
           : error                                                  ? EXIT_ROBOT
                                                                    : EXIT_DONE;
}

/* ---- the command's -------------------------------------------------------------------------- */

void guard_note_program(const char *argv0)
{
    if (argv0 && *argv0) {
        called = argv0;
    }
}

void guard_start(const app *a, const char *device, grobo_guard **guard)
{
    const char *chosen = getenv("GRCTL_GUARD");
    grobo_guard_config config = {GROBO_GUARD_CONFIG_INIT,
                                 .program = chosen ? chosen : os_own_program(called)};
    if (*guard || strcmp(device, GROBO_DEVICE_SIM) == 0 || !*config.program) {
        return;
    }
    int error = grobo_guard_new(&config, guard);
    if (!error) {
        app_detail(a, "guarded by process %d", grobo_guard_pid(*guard));
    }
    if (error && error != GROBO_ERR_UNSUPPORTED) {
        app_note(a, "no guard: %s; if grctl is killed, joints continue to their goals",
                 app_error_text(error));
    }
}

size_t guard_data(const app *a, guard_robot *given)
{
    const config_robot *robot = a->robot;
    const char *path = robot_path(a);
    if (!robot && !*path) {
        return 0;
    }
    memset(given, 0, sizeof *given);
    snprintf(given->robot, sizeof given->robot, "%s", path);
    given->trimmed = robot != NULL;
    if (robot) {
        memcpy(given->trim_deg, robot->trim_deg, sizeof given->trim_deg);
        memcpy(given->offset_deg, robot->offset_deg, sizeof given->offset_deg);
        given->offsets = robot->offsets;
    }
    return sizeof *given;
}

/* ---- the guard of another, that has the port ------------------------------------------------ */

static int is_with_guard(void *ctx, const grobo_port_info *info)
{
    (void)ctx;
    return info->owner_pid && strcmp(info->owner_name, GROBO_GUARD_NAME) == 0;
}

bool guard_has(const char *device)
{
    char name[64];
    if (strcmp(device, GROBO_DEVICE_AUTO) == 0) {
        return grobo_port_list(is_with_guard, NULL) == 1;
    }
    return grobo_port_owner(device, name, sizeof name) && strcmp(name, GROBO_GUARD_NAME) == 0;
}
