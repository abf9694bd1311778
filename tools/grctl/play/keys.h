/* SPDX-License-Identifier: MIT */
/* What keys do to a robot that plays: the same in `play` and `monitor`. */
#ifndef GRCTL_PLAY_KEYS_H
#define GRCTL_PLAY_KEYS_H

#include "tools/grctl/conn/conn.h"

typedef struct play_keys {
    conn *c;
    int speed_pct;
    bool stopped; /* somebody stopped it */
    bool estop;   /* the emergency stop was asked for */
} play_keys;

#define PLAY_KEYS_HELP                                                                             \
    "  space   pause, resume\n"                                                                    \
    "  + -     faster, slower, by ten percent\n"                                                   \
    "  s, q    stop smoothly\n"                                                                    \
    "  e       emergency stop\n"

/* Does what a key stands for. False: it stands for nothing. */
bool play_keys_take(play_keys *k, int key);

/* Emergency stop, marked for every other command too. */
void play_keys_estop(play_keys *k);

#endif
