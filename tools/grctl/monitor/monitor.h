/* SPDX-License-Identifier: MIT */
/* The live view of `monitor`: what it knows, and how that is drawn. */
#ifndef GRCTL_MONITOR_H
#define GRCTL_MONITOR_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/os/keys.h"
#include "tools/grctl/play/keys.h"
#include "tools/grctl/play/play.h"

enum { MONITOR_TEXT_BYTES = 256, MONITOR_LOG = 32 };

typedef struct monitor {
    conn c;
    const grobo_model *model;
    playlist list; /* what p plays; n 0: nothing was named */
    bool prepared; /* the clips of the list are made */
    play_keys keys;
    grobo_joint_mask chosen; /* what torque and nudges are for */
    int cursor;              /* place of the joint */
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

/* Places of joints on the screen. */
enum { MONITOR_PLACES = 20 };

/* The joint at a place. */
int monitor_joint(const monitor *m, int place);

/* What the robot is busy with, for people; NULL where it would take any request. */
const char *monitor_busy(const monitor *m);

void monitor_draw(const monitor *m);

#endif
