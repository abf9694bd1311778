/* SPDX-License-Identifier: MIT */
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/frame_words.h"

enum { MOTORS = 20, TEXT_BYTES = 8192, FRAME_BYTES = 256 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static char goals[TEXT_BYTES], others[TEXT_BYTES], said[TEXT_BYTES];
static char told[4 * TEXT_BYTES];
static int torque[MOTORS + 1];
static uint8_t frame[FRAME_BYTES], before[FRAME_BYTES];
static size_t n_frame, n_before;

static void add(char *text, const char *more)
{
    size_t length = strlen(text);

    if (length + strlen(more) < TEXT_BYTES) {
        memcpy(text + length, more, strlen(more) + 1);
    }
}

void words_begin(void)
{
    pthread_mutex_lock(&lock);
    goals[0] = others[0] = said[0] = '\0';
    n_frame = n_before = 0;
    for (int id = 0; id <= MOTORS; id++) {
        torque[id] = -1;
    }
    pthread_mutex_unlock(&lock);
}

static int i16(const uint8_t *at)
{
    return (int16_t)(at[0] | at[1] << 8);
}

/* A packet of goals: `each` bytes a motor, from its number on. */
static void take_goals(const uint8_t *data, int n, int each, int id)
{
    char one[64];

    snprintf(one, sizeof one, "%sgoals %d in %d:", goals[0] != '\0' ? "; " : "", n,
             i16(data + (each == 5 ? 3 : 2)));
    add(goals, one);
    for (int i = 0; i < n; i++, data += each) {
        const uint8_t *value = each == 5 ? data + 1 : data;
        int motor = each == 5 ? data[0] : id;
        if (i16(value) != 0) {
            snprintf(one, sizeof one, " %d=%d", motor, i16(value));
            add(goals, one);
        }
    }
}

static void take_torque(int id, int value)
{
    for (int i = 1; i <= MOTORS; i++) {
        if (id == i || id == 255) {
            torque[i] = value;
        }
    }
}

/* FA AF, id, flags, address, length, count, data. */
static void take_packet(const uint8_t *p)
{
    char one[64];
    int n = p[6];
    int each = p[5];

    if (p[3] == 0x0F) {
        return; /* a reading: what was read is said */
    }
    if (p[4] == 0x1E) {
        take_goals(p + 7, p[2] == 0 ? n : 1, p[2] == 0 ? each : 4, p[2]);
    } else if (p[4] == 0x24) {
        for (int i = 0; i < n; i++) {
            take_torque(p[2] == 0 ? p[7 + i * each] : p[2], p[7 + (p[2] == 0 ? i * each + 1 : 0)]);
        }
    } else {
        snprintf(one, sizeof one, " write %d at %d", p[2], p[4]);
        add(others, one);
    }
}

/* Frames that are not answered in time are sent again: they count once. */
static bool is_again(void)
{
    bool again = n_frame == n_before && memcmp(frame, before, n_frame) == 0;

    memcpy(before, frame, n_frame);
    n_before = n_frame;
    return again;
}

static void take_frame(void)
{
    char one[64];

    if (is_again()) {
        return;
    }

    if (frame[0] == 0x41) {
        add(others, " check");
    } else if (frame[0] == 0x50) {
        snprintf(one, sizeof one, " play %c%d", frame[1], frame[2]);
        add(others, one);
    } else if (frame[2] == 0xFA && frame[3] == 0xAF) {
        take_packet(frame + 2);
    } else {
        add(others, " unknown");
    }
}

static size_t wanted(void)
{
    if (n_frame == 0) {
        return 1;
    }
    switch (frame[0]) {
    case 0x41:
        return 2;
    case 0x50:
        return 3;
    case 0x53:
    case 0x54:
        return n_frame < 2 ? 2 : frame[1] + (size_t)2;
    default:
        return 1;
    }
}

void words_bytes(const uint8_t *bytes, size_t size)
{
    pthread_mutex_lock(&lock);
    for (size_t i = 0; i < size; i++) {
        frame[n_frame++] = bytes[i];
        if (n_frame == wanted()) {
            take_frame();
            n_frame = 0;
        }
    }
    pthread_mutex_unlock(&lock);
}

void frame_words_say(double value)
{
    char one[64];

    snprintf(one, sizeof one, "%.6g", value);
    frame_words_say_text(one);
}

void frame_words_say_text(const char *text)
{
    pthread_mutex_lock(&lock);
    add(said, " ");
    add(said, text);
    pthread_mutex_unlock(&lock);
}

/* A part of what is told, with its title. */
static void tell(const char *title, const char *text)
{
    size_t length = strlen(told);

    if (text[0] != '\0') {
        snprintf(told + length, sizeof told - length, "%s%s%s", length > 0 ? " | " : "", title,
                 text);
    }
}

const char *words_told(void)
{
    char switched[TEXT_BYTES] = "";
    char one[32];

    pthread_mutex_lock(&lock);
    for (int id = 1; id <= MOTORS; id++) {
        if (torque[id] >= 0) {
            snprintf(one, sizeof one, " %d=%d", id, torque[id]);
            add(switched, one);
        }
    }
    told[0] = '\0';
    tell("", goals);
    tell("torque", switched);
    tell("sent", others);
    tell("said", said);
    pthread_mutex_unlock(&lock);
    return told;
}
