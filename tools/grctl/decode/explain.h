/* SPDX-License-Identifier: MIT */
/* Telegrams in words, for people and for scripts. */
#ifndef GRCTL_EXPLAIN_H
#define GRCTL_EXPLAIN_H

#include "tools/grctl/cli/app.h"
#include "tools/grctl/decode/frames.h"
#include "tools/grctl/decode/saytext.h"

/* What a frame of a dialect says, without its newline; for a telegram of shares, explain_shares()
 * has a line for each servo. */
void explain_say(text *t, const frame *f, const telegram *said);
void explain_shares(text *t, const telegram *said);

/* What no servo can do with a whole command of a good sum: a code ("request", "range") and why, or
 * NULL. */
const char *explain_offence(const talk *who, const telegram *said, char *why, size_t capacity);

/* The same for scripts: members of the frame's object, as words_json() has them. */
json_t *explain_packet(const frame *f, const telegram *said);

#endif
