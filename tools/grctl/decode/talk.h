/* SPDX-License-Identifier: MIT */
/* Who talks on a line, and in which family's frames: what frames say of whom
 * (grobo/core/words.h). */
#ifndef GRCTL_TALK_H
#define GRCTL_TALK_H

#include <grobo/robot_file.h>

enum { TALK_IDS = 256 };

/* A line: how its frames are read, who is on it, and what was asked last. */
typedef struct talk {
    const grobo_words *words;
    const grobo_model *model;                 /* whose joints have names; NULL: ids only */
    const grobo_servo_model *servo[TALK_IDS]; /* as far as known; NULL: the first of the table */
    grobo_words_sent sent[GROBO_WORDS_SENT_MAX];
} talk;

/* How a series talks, by its name for --family; NULL: there is none. */
const grobo_words *talk_named(const char *name);

/* How a servo talks, and the family that this belongs to. NULL: no family has it. */
const grobo_words *talk_of_servo(const grobo_servo_model *servo);
const grobo_robot_family *talk_family(const grobo_words *words);

/* The servo of an id, for its registers. */
const grobo_servo_model *talk_servo(const talk *t, int id);

/* The name of an id's joint, or NULL. */
const char *talk_joint(const talk *t, int id);

/* Keeps a request. */
void talk_ask(talk *t, const uint8_t *bytes, size_t n);

/* Learns from a reply which servo an id is. */
void talk_learn(talk *t, const grobo_telegram *said);

#endif
