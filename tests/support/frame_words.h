/* SPDX-License-Identifier: MIT */
/*
 * Frames of GR001's board in words, and values beside them, to compare what two programs send. It
 * knows nothing of the library: it is also compiled with programs of the original one, as C++.
 */
#ifndef GROBO_TESTS_FRAME_WORDS_H
#define GROBO_TESTS_FRAME_WORDS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Forgets everything. */
void words_begin(void);

/* Bytes that a host sent, as they come. From any thread. */
void words_bytes(const uint8_t *bytes, size_t size);

/* A value that a statement gave, and a text. */
void frame_words_say(double value);
void frame_words_say_text(const char *text);

/*
 * What came since words_begin(): "goals 20 in 25: 2=200 | torque 9=1 | said 1 2". Goals are in the
 * order of their frames; angles of 0 are not told; torque is the last of each motor; readings are
 * left out. Good until the next call.
 */
const char *words_told(void);

#ifdef __cplusplus
}
#endif

#endif
