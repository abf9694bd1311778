/* SPDX-License-Identifier: MIT */
/*
 * A witness of both ends of the line: it knows what was said and what was heard. With it a test
 * tells a reply that is believed rightly from one that nobody gave, and a command that a servo
 * was given from one that the line made up.
 *
 * The servos' sum is an exclusive or: two like flips pass it, and neither end can know. Only what
 * the witness saw pass that way excuses anybody, and only the joint it was about.
 */
#ifndef GROBO_TEST_WITNESS_H
#define GROBO_TEST_WITNESS_H

#include <grobo/core/board.h>
#include <grobo/core/bus.h>
#include <grobo/core/driver.h>
#include <grobo/core/sim.h>
#include <grobo/core/static.h>

enum {
    WITNESS_BYTES = 64,
    WITNESS_SENT = 128,
    WITNESS_SAID = 64,
    WITNESS_SEEN = 16,
    WITNESS_QUESTIONS = GROBO_ROBOT_SLOTS + 4
};

/* A packet: sent by the host, said by a servo, or seen to arrive whole at the host. */
typedef struct witness_packet {
    int64_t at_us;
    uint8_t n;
    uint8_t bytes[GROBO_RS30X_PACKET_MAX_BYTES];
    bool sound;           /* said: it is what the servo has to say; seen: it was said */
    bool believed;        /* said */
    bool kept;            /* said: to a question that the board kept behind a broken frame */
    unsigned said_number; /* seen: which one it was */
} witness_packet;

/* A question: its attempts, between which other questions may leave, are one question. */
typedef struct witness_question {
    const grobo_txn *txn;
    int64_t since_us;               /* when its first attempt left */
    int64_t silence_us;             /* how long the one before that asks the same was over, */
    int64_t span_us;                /* and twice the worst lateness that the host had learnt */
    uint8_t motor, address, length; /* what it asks for */
} witness_question;

typedef struct witness {
    const grobo_model *model;
    const grobo_sim *sim;
    const grobo_bus *bus;
    witness_packet sent[WITNESS_SENT], said[WITNESS_SAID], seen[WITNESS_SEEN]; /* rings */
    unsigned n_sent, n_said, n_seen;
    uint8_t tail[WITNESS_BYTES]; /* the bytes that arrived last, ring */
    unsigned n_tail;
    int64_t heard_us; /* when servos heard a command last */
    bool heard_late;  /* the board had kept it */
    witness_question questions[WITNESS_QUESTIONS];
    witness_question answered;            /* by the reading that was believed last */
    int64_t doubled_us[GROBO_JOINTS_MAX]; /* when a doubled reply was believed last */
    int64_t twice_us[GROBO_JOINTS_MAX];   /* when the line said one twice */
    int64_t said_us[GROBO_JOINTS_MAX];    /* when the reading was said that was believed last */
    int64_t goal_us[GROBO_JOINTS_MAX];    /* when the goal was said that was believed last */
    int64_t reboot_us[GROBO_JOINTS_MAX];  /* when a servo last lost what it was told */
    grobo_joint_mask misled;              /* the line made something up about these */
    bool settings_hit;                    /* a made-up command changed what flash keeps */
    unsigned believed;                    /* readings that were believed, and were true */
    unsigned late;                        /* that came later than a reply is told apart */
    unsigned doubled;                     /* that the line said twice, or because of one */
    unsigned made_up_commands, made_up_replies, made_up_believed;
} witness;

void witness_init(witness *w, const grobo_model *model, const grobo_sim *sim, const grobo_bus *bus);
/* The host sends a packet, an attempt of this transaction. */
void witness_sent(witness *w, const uint8_t *packet, size_t n, const grobo_txn *txn,
                  int64_t now_us);
/* The simulator tells. */
void witness_heard(witness *w, const grobo_sim_event *event);
/* Bytes arrive at the host. */
void witness_arrived(witness *w, const uint8_t *bytes, size_t n, int64_t now_us);
/* The host took this for a joint's state. Fails the test if nobody said so: no servo, another one,
 * before its question was first asked. */
void witness_believed(witness *w, int joint, const grobo_joint_state *state, int64_t now_us);
/* True if the reading that was believed last tells of the register at this address. */
bool witness_told(const witness *w, int address);
/* True if a servo restarted after its goal was read last: it has forgotten it, who can know. */
bool witness_restarted(const witness *w, int joint);

#endif
