/* SPDX-License-Identifier: MIT */
/* The live view of `monitor`: what it knows, and how that is drawn. */
#ifndef GRCTL_MONITOR_H
#define GRCTL_MONITOR_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/keys.h"
#include "tools/grctl/play/play.h"

enum { MONITOR_TEXT_BYTES = 256, MONITOR_LOG = 32, MONITOR_GROUP_KEYS = 8 };

typedef struct monitor_cell {
    int joint;
    int row; /* of the layout, which may have more than the screen */
    int column;
} monitor_cell;

/* Where each joint stands; the order of the cells is that of the arrow keys up and down. */
typedef struct monitor_layout {
    monitor_cell cell[GROBO_JOINTS_MAX];
    int n, n_rows, n_columns;
    int height; /* rows that the screen has for it */
} monitor_layout;

typedef struct monitor {
    conn c;
    const grobo_model *model;
    playlist list; /* what p plays; n 0: nothing was named */
    bool prepared; /* the clips of the list are made */
    play_keys keys;
    grobo_joint_mask chosen; /* what torque and nudges are for */
    int cursor;              /* the joint that the arrows chose */
    monitor_layout layout;   /* of the last picture */
    char said[APP_LINE_BYTES];
    bool bad;                                  /* what was said is a complaint */
    char log[MONITOR_LOG][MONITOR_TEXT_BYTES]; /* what was said before, a ring */
    int n_log;                                 /* how often something was said before */
    const char *doing;                         /* what the last job is, for people */
    int job;                                   /* its number, 0 when it is over */
    bool over;
    bool blocks;    /* the terminal knows UTF-8 */
    int64_t up_us;  /* since when the line stands or is lost */
    unsigned drops; /* of the line */
} monitor;

/* Places the joints of any model on so many rows, and at most so many columns. */
void monitor_lay_out(monitor_layout *l, const grobo_model *model, int height, int columns);
/* The first row of the layout on the screen, which shows this joint. */
int monitor_top(const monitor_layout *l, int joint);
/* The joint `by` cells below, or columns to the right; the last is followed by the first. */
int monitor_below(const monitor_layout *l, int joint, int by);
int monitor_beside(const monitor_layout *l, int joint, int by);
/* Is another joint its partner in the mirror? */
bool monitor_has_partner(const grobo_model *model, int joint);

/* What the robot is busy with, for people; NULL where it would take any request. */
const char *monitor_busy(const monitor *m);

/* Draws a picture; the layout becomes that of the screen as it is now. */
void monitor_draw(monitor *m);

#endif
