/* SPDX-License-Identifier: MIT */
/* Who is on a line: ids that answer, at the rates and in the ways that servos talk. */
#ifndef GRCTL_SCAN_H
#define GRCTL_SCAN_H

#include "tools/grctl/conn/conn.h"
#include "tools/grctl/conn/family.h"

enum { SCAN_IDS = 256 };

/* One baud rate. Every whole reply on the line counts for its servo, whenever it comes. */
typedef struct scan_pass {
    /* set by the caller */
    int baud_bps, first, last;
    bool own; /* the robot's own servos: where a joint is missing, it is asked again */
    void (*progress)(const struct scan_pass *p, int id); /* before each question, or NULL */
    void *ctx;
    /* what was found */
    const grobo_driver *driver;
    bool there[SCAN_IDS];
    int why[SCAN_IDS]; /* the error of one that answered in no way that fits, or 0 */
    uint8_t identity[SCAN_IDS][FAMILY_PIECE_BYTES];
    int n;                        /* servos found */
    bool sure;                    /* the line left no doubt */
    int64_t took_us;              /* of asking */
    uint32_t wire_us, timeout_us; /* of a reply: its time on the wire, and what it is given */
    /* private */
    int64_t asked_us[SCAN_IDS];
    uint16_t address; /* of the registers that tell the identity */
    int bytes;        /* of them */
    int asking;
    int64_t heard_us; /* when the last byte came, 0: none has */
    int64_t worst_us; /* the longest that a reply took */
    uint32_t rubbish; /* bytes of this look that are of no whole packet */
    bool late;        /* a reply came after its time */
    const grobo_protocol *protocol;
    uint8_t kept[GROBO_FRAME_MAX_BYTES]; /* of what came, from where a packet may begin */
    size_t n_kept;
} scan_pass;

/* Asks ids first..last of the open line, until it is sure who answers. Returns GROBO_OK or why it
 * could not go on. */
int scan_line(conn *c, scan_pass *p);

/* What the registers of family_identity() say. */
typedef struct scan_identity {
    char model[48]; /* its name, or "unknown model" with the number that it tells */
    const char *family;
    const grobo_servo_model *servo; /* NULL: it does not tell, or is not known */
    bool known;
    int32_t firmware; /* -1: not told */
} scan_identity;
scan_identity scan_identity_of(const grobo_driver *driver, const uint8_t *bytes);

/* A search for servos of families on a line that is opened for each family and rate. */
typedef struct scan_search {
    const char *family; /* "all", or one */
    bool all_rates;     /* and not the usual ones; -b says one */
    int first, last;    /* ids, as far as the family has them */
    const char *who;    /* the command, for messages */
    void (*begins)(struct scan_search *s, scan_pass *p, int rate, int n_rates); /* or NULL */
    /* while the line is open */
    void (*ends)(struct scan_search *s, const grobo_robot_family *family, conn *c,
                 const scan_pass *p);
    void *ctx;
} scan_search;

/* Returns 0, or the exit status with the reason said. */
int scan_families(app *a, scan_search *s);

#endif
