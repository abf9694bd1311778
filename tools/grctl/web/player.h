/* SPDX-License-Identifier: MIT */
/* Motions that are played because a page said so: from the file to its end. */
#ifndef GRCTL_WEB_PLAYER_H
#define GRCTL_WEB_PLAYER_H

#include <jansson.h>

#include <grobo/core/robot.h>

#include "tools/grctl/web/lease.h"

typedef struct serve serve;
typedef struct http_request http_request;
typedef struct player_item player_item;

/* What becomes of a motion whose page is lost. */
typedef enum player_lost { PLAYER_STOP, PLAYER_FINISH, PLAYER_EXIT } player_lost;

typedef struct player {
    player_item *items; /* the one that is played first, then those that wait */
    uint32_t begun;     /* of the engine's count: the first of items is this */
    unsigned epoch;     /* grows with each stop: what was asked for before is not begun */
    player_lost on_lost;
    uint16_t speed_pct;
    bool clamps;
    char by[LEASE_NAME_BYTES];
} player;

void verb_play(serve *s, http_request *r, json_t *body);
void verb_queue(serve *s, http_request *r, json_t *body);

/* Of the state. */
json_t *player_json(serve *s);
/* Where the motion is at an offset from now, by joint; false: nothing is played. */
bool player_at(const serve *s, int64_t offset_us, grobo_posture *posture);

/* A motion that loops is played, or waits. */
bool player_is_endless(const serve *s);

/* Frees what has been played. */
void player_on_event(serve *s, const grobo_event *event);
/* When nothing plays any more. */
void player_free(serve *s);

#endif
