/* SPDX-License-Identifier: MIT */
/*
 * Named robots: $XDG_CONFIG_HOME/grctl/config.yaml (~/.config), then /etc/grctl/config.yaml.
 *
 *   default: kitchen
 *   groups: {stage: [kitchen, cellar]}  # robots that act together: grctl -d stage play ...
 *   warn_fall: false         # play and check do not say that the robot would fall
 *   robots:
 *     kitchen:
 *       device: /dev/serial/by-id/usb-...
 *       robot: so101           # or a file; before trim and offset. Else gr001
 *       wiring: board          # or bus
 *       echo: false            # true: the bus's adapter returns what is sent
 *       baud: 115200
 *       on_exit: hold          # or off, sit: where a command is cut short
 *       trim: {R_KNEE_P: 1.5}  # degrees that the servo stands off: added to what goes out
 *       offset: {m12: 2}       # degrees added to what is read, as the driver's own corrections
 */
#ifndef GRCTL_CONFIG_H
#define GRCTL_CONFIG_H

#include <grobo/core/driver.h>
#include <grobo/core/serial.h>

#include "tools/grctl/cli/app.h"

enum {
    CONFIG_PATH_BYTES = 1024,
    CONFIG_NAME_BYTES = 64,
    CONFIG_FILE_MAX_BYTES = 1 << 20,
    CONFIG_GROUP_MAX = 64
};

/* No trim is larger: more is a servo horn that sits a tooth off. */
#define CONFIG_TRIM_MAX_DEG 20

typedef struct config_robot {
    char name[CONFIG_NAME_BYTES]; /* "": none is configured */
    char path[CONFIG_PATH_BYTES]; /* the file that has it */
    char device[GROBO_DEVICE_MAX_BYTES];
    char def[CONFIG_PATH_BYTES];           /* "": it says nothing of which robot it is */
    cli_value wiring, echo, baud, on_exit; /* as options of the command line */
    double trim_deg[GROBO_JOINTS_MAX];
    double offset_deg[GROBO_JOINTS_MAX];
    bool trimmed, offsets;
    /* where the trim stands in the file, or would: behind its robot, or first; in characters */
    size_t trim_at, trim_end, def_end, first_at, first_column;
    bool flow; /* the robot is written as { ... } */
} config_robot;

/* Robots that act together. */
typedef struct config_group {
    char name[CONFIG_NAME_BYTES];
    char path[CONFIG_PATH_BYTES]; /* the file that has it */
    char robot[CONFIG_GROUP_MAX][CONFIG_NAME_BYTES];
    int n;
} config_group;

/*
 * Finds the robot that the command line names, or the default one where it names no device, and
 * sets the options that were not given. Returns 0, or the exit status with the reason said; the
 * robot is applied then too where it stands before the mistake of the file. Where a group is named,
 * app.group is set, and nothing else.
 */
int config_apply(app *a);

/* The same for one robot of a group, which has a command line of its own. */
int config_apply_member(app *a, const char *name, config_robot *robot);

/* After config_apply(): a name that neither the configuration nor the system has. */
bool config_is_unknown_name(const app *a, const char *device);

/*
 * False where the configuration says warn_fall: false. Asked by commands that work without a
 * configuration too: one that cannot be read says nothing.
 */
bool config_warns_of_falls(const app *a);

/* A robot for the user's file. */
typedef struct config_entry {
    const char *name, *device;
    const char *def;    /* a name, or a path that holds in any folder */
    int baud_bps;       /* 0: says nothing */
    const char *wiring; /* NULL: says nothing */
    const char *file;   /* that was made for it, which config_undo() removes; NULL: none */
} config_entry;

/* What config_undo() did. */
typedef struct config_undone {
    char path[CONFIG_PATH_BYTES]; /* is as it was */
    char file[CONFIG_PATH_BYTES]; /* config_entry.file, "": there was none */
    bool removed;                 /* false: it stays, as it is not what was made */
} config_undone;

/* Whether a robot may be called so: 0, or the exit status with the reason said. */
int config_check_name(app *a, const char *name);

/*
 * Adds a robot to the user's file, which is made where there is none; what was there before is
 * kept for config_undo(). Returns 0, with the file's path, or the exit status with the reason said.
 */
int config_add(app *a, const config_entry *entry, char *path, size_t capacity);

/*
 * Puts the file back as it was before the last config_add(), unless it has changed since, and
 * removes what was made for the robot, unless that has. As above.
 */
int config_undo(app *a, config_undone *undone);

/* Whether a file of this text, at its path, has the robot with this device; found: as it says. */
bool config_find_in(const app *a, const char *text, size_t size, const config_robot *wanted,
                    config_robot *found);

/*
 * Writes the trims of some joints of the robot into its file, as that is now: a temporary one takes
 * its place, and the robot is what it says. As above.
 */
int config_write_trims(app *a, config_robot *robot, grobo_joint_mask joints);

#endif
