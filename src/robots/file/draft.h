/* SPDX-License-Identifier: MIT */
/* A robot's file while it is read: what it says, and where it says it. */
#ifndef GROBO_ROBOTS_DRAFT_H
#define GROBO_ROBOTS_DRAFT_H

#include <grobo/core/lines.h>

#include "src/motion/format/fields.h"
#include "src/robots/robots.h"

enum { GROBO_I_KEYS_MAX = 32 };

typedef char grobo_i_name[GROBO_NAME_MAX_BYTES];

/* The mappings of a file. */
typedef enum grobo_i_block {
    GROBO_I_BLOCK_ROBOT,
    GROBO_I_BLOCK_LINE,
    GROBO_I_BLOCK_SAFETY,
    GROBO_I_BLOCK_JOINT,
    GROBO_I_BLOCK_GROUP,
    GROBO_I_BLOCK_LINK,
    GROBO_I_BLOCK_PAYLOAD,
    GROBO_I_BLOCK_FOOT,
    GROBO_I_BLOCK_MOTOR,
    GROBO_I_BLOCK_LINES,
    GROBO_I_BLOCKS
} grobo_i_block;

/* Key number index of a mapping, NULL behind the last: the schema has the same. */
const char *grobo_i_robot_key(grobo_i_block block, size_t index);
bool grobo_i_robot_key_needed(grobo_i_block block, size_t index);

/* Keys that were there have a place of their value. Numbers are as in the file. */
typedef struct grobo_i_motor_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    double kt_nm_a, resistance_ohm, armature_kgm2, torque_max_nm, friction_nm, viscous_nms,
        backlash_deg;
} grobo_i_motor_draft;

typedef struct grobo_i_joint_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name name, type, servo, mirror, line, follows;
    double servos[2], signs[2], apart_deg, ratio;
    int twin; /* of its second servo, which is a joint of its own: the first one; else -1 */
    double id, limits_deg[2], init_deg, rest_deg, speed_deg_s, torque_limit_pct, free_ma, sign,
        zero_deg, gear, mirror_sign, readback_deg;
    /* Of a linear joint, which have degrees in their place when the joint is read; and angles of a
     * gripper that is closed and open. */
    double limits_mm[2], init_mm, rest_mm, speed_mm_s, mm_per_turn, percent_deg[2];
    double accel_deg_s2; /* of a wheel */
    bool turns;
    grobo_i_motor_draft motor;
} grobo_i_joint_draft;

typedef struct grobo_i_link_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name name, parent, joint;
    double origin_m[3], origin_deg[3], axis[3], mass_kg, com_m[3], inertia_kgm2[6];
} grobo_i_link_draft;

typedef struct grobo_i_group_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name name;
    grobo_joint_mask joints;
    const struct grobo_i_draft *of;
} grobo_i_group_draft;

typedef struct grobo_i_safety_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    double temperature_c, lost_replies, current_ma, current_ms, voltage_mv, approach_deg_s;
} grobo_i_safety_draft;

typedef struct grobo_i_payload_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name link;
    double max_kg;
} grobo_i_payload_draft;

typedef struct grobo_i_foot_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name link;
    double sole_m[3], half_m[2];
} grobo_i_foot_draft;

typedef struct grobo_i_line_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    double baud_bps;
} grobo_i_line_draft;

/* One of several lines. */
typedef struct grobo_i_lines_draft {
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name name, family, wiring, port;
    double baud_bps;
    bool echo;
} grobo_i_lines_draft;

typedef struct grobo_i_draft {
    grobo_i_reader *reader;
    grobo_i_place place, at[GROBO_I_KEYS_MAX];
    grobo_i_name name, title, model, family, wiring, exit;
    double limit_slack_deg;
    bool arm, calibrated;
    grobo_i_line_draft line;
    grobo_i_safety_draft safety;
    grobo_i_payload_draft payload;
    int n_joints, n_groups, n_links, n_usb, n_feet;
    grobo_i_joint_draft joint[GROBO_JOINTS_MAX];
    grobo_i_group_draft group[GROBO_ROBOT_GROUPS_MAX];
    grobo_i_link_draft link[GROBO_ROBOT_LINKS_MAX];
    grobo_usb_id usb[GROBO_ROBOT_USB_MAX];
    grobo_i_foot_draft foot[2];
    int n_lines;
    grobo_i_lines_draft lines[GROBO_LINES_MAX];
} grobo_i_draft;

/* The place of a key's value in a mapping that has it, else of the mapping. */
grobo_i_place grobo_i_place_of(grobo_i_block block, const grobo_i_place *at, grobo_i_place whole,
                               const char *key);
/* Whether the key was there. */
bool grobo_i_has_key(grobo_i_block block, const grobo_i_place *at, const char *key);

enum { GROBO_I_ALIKE_MAX = 8 };

/* What a read file is kept in. */
typedef struct grobo_i_robot_file {
    grobo_robot_def def;
    grobo_model model;
    const grobo_mem *mem;
    const struct grobo_i_beside *beside; /* while it is read; NULL: no files are beside it */
    struct grobo_i_own_servo *own;       /* models of a user's own, a list */
    grobo_joint joints[GROBO_JOINTS_MAX];
    grobo_group groups[GROBO_ROBOT_GROUPS_MAX];
    double rest_rad[GROBO_JOINTS_MAX];
    grobo_readback readback[GROBO_JOINTS_MAX];
    grobo_robot_link links[GROBO_ROBOT_LINKS_MAX];
    grobo_robot_motor motors[GROBO_JOINTS_MAX];
    grobo_usb_id usb[GROBO_ROBOT_USB_MAX];
    const char *alike[GROBO_I_ALIKE_MAX + 1];
    grobo_i_name name, title, model_name, joint_names[GROBO_JOINTS_MAX],
        group_names[GROBO_ROBOT_GROUPS_MAX], link_names[GROBO_ROBOT_LINKS_MAX];
    grobo_robot_file_line lines[GROBO_LINES_MAX];
    grobo_i_name line_names[GROBO_LINES_MAX], line_ports[GROBO_LINES_MAX];
    grobo_lines on_lines;
} grobo_i_robot_file;

/* Reads the text; what is wrong is said. An error ends it, a complaint does not. */
int grobo_i_read_draft(grobo_i_reader *reader, grobo_i_draft *draft);

/* Makes the robot of a draft without a mistake so far. Complains where the parts do not fit. */
int grobo_i_robot_make(const grobo_i_draft *draft, grobo_i_robot_file *file);

/* Complains of a word that is none of those known; `nearest` may be empty. */
int grobo_i_complain_word(grobo_i_reader *reader, grobo_i_place place, const char *what,
                          const char *word, const char *nearest);

#endif
