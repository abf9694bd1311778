/* SPDX-License-Identifier: MIT */
/* Running a trace again: what the host said goes out, the replies are compared. */
#ifndef GRCTL_REPLAY_H
#define GRCTL_REPLAY_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"
#include "tools/grctl/decode/input.h"
#include "tools/grctl/decode/ledger.h"

/* The two that answer. */
enum { REPLAY_RECORDED, REPLAY_REPLAYED };

typedef struct replay {
    app *a;
    const char *path;
    const char *line; /* of a robot of several lines the one that is replayed; NULL: it has one */
    bool each;        /* one after the other: the trace must have all */
    grobo_wiring wiring;
    int baud_bps;     /* 0: the trace does not tell */
    int64_t first_us; /* of the trace, by its own clock */
    void *ctx;        /* of the way it goes */
    talk talk;
    frames host;
    frames robot[LEDGER_SIDES];
    ledger asked;
    struct {
        unsigned long long frames, equal, differ, missing, extra, silent;
        unsigned long long stray[LEDGER_SIDES], rubbish_bytes[LEDGER_SIDES];
    } count;
} replay;

/* A chunk of the trace; a result other than 0 ends the reading and is returned. */
typedef int (*replay_fn)(void *ctx, const pcapng_chunk *chunk);

/* Reads the trace from its beginning. 0, what `use` returned, or the exit status of a bad file. */
int replay_read(replay *r, replay_fn use, void *ctx);

/* Prepares the comparison; on_host is called for each frame that the host said, with r. */
void replay_begin(replay *r, frames_fn on_host);

/* Notes a frame of the host, to be answered twice. */
void replay_ask(replay *r, const frame *f);

/* Bytes of one that answers, at a time counted from the trace's beginning. */
void replay_answer(replay *r, int who, int64_t time_us, const uint8_t *bytes, size_t n);

/* Says what the comparison came to: EXIT_DONE where nothing differs, else EXIT_ROBOT. */
int replay_report(replay *r);

/* To the simulator, in virtual time; to a robot. 0 or the exit status, the reason said. */
int replay_to_sim(replay *r);
int replay_to_robot(replay *r);

#endif
