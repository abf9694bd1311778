/* SPDX-License-Identifier: MIT */
/*
 * Servo models that a user describes in files beside a robot's file. Such a model is `like` one of
 * the library: that names its series, whose protocol, driver and simulated servo it shares.
 */
#ifndef GROBO_ROBOTS_OWN_H
#define GROBO_ROBOTS_OWN_H

#include "src/robots/file/draft.h"

/* Opens the files that a robot's file names. */
typedef struct grobo_i_beside {
    /* @return 0 and a source, or an error */
    int (*open)(void *ctx, const char *path, grobo_source *source);
    void (*close)(void *ctx, const grobo_source *source);
    void *ctx;
} grobo_i_beside;

/* A model that was read; a file's robot has a list of them. */
typedef struct grobo_i_own_servo grobo_i_own_servo;

/* Whether the servo of a joint is a file: "./my-servo.yaml". */
bool grobo_i_is_own_servo(const char *servo);

/*
 * The model of a file, which is read once for all joints that name it.
 * @param place of the name in the robot's file
 * @return NULL with a complaint
 */
const grobo_servo_model *grobo_i_own_servo_find(grobo_i_reader *reader, grobo_i_robot_file *file,
                                                const grobo_robot_family *family, const char *servo,
                                                grobo_i_place place);

void grobo_i_own_servos_free(const grobo_mem *mem, grobo_i_own_servo *list);

/* Reads a robot's file whose servo files are opened so; NULL: it may name none. As
 * grobo_robot_def_read(). */
int grobo_i_robot_read(const grobo_source *source, const char *name, const grobo_i_beside *beside,
                       grobo_diagnostics *list, const grobo_mem *mem, grobo_robot_def **def);

#endif
