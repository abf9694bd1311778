/* SPDX-License-Identifier: MIT */
/* A full screen of a terminal: screen/ncurses.c, or screen/none.c where ncurses is missing. */
#ifndef GRCTL_SCREEN_H
#define GRCTL_SCREEN_H

#include <stdbool.h>

typedef enum screen_style {
    SCREEN_PLAIN,
    SCREEN_DIM,
    SCREEN_BOLD,
    SCREEN_GOOD,
    SCREEN_WARN,
    SCREEN_BAD,
    SCREEN_ALARM, /* nobody overlooks it */
    SCREEN_STYLES
} screen_style;

/* Keys that are no characters. */
enum {
    SCREEN_KEY_NONE = -1,
    SCREEN_KEY_UP = 0x110000,
    SCREEN_KEY_DOWN,
    SCREEN_KEY_LEFT,
    SCREEN_KEY_RIGHT
};

/* Whether standard input and output are a terminal on which text can be placed. */
bool screen_possible(void);

/*
 * Takes the terminal, after what was printed has gone out. False: nothing changed. It is given back
 * by screen_close(), or at exit.
 */
bool screen_open(bool color);
void screen_close(void);
/* Gives the terminal back until the next screen_end(). */
void screen_pause(void);

/* Begins a picture, empty, as large as the terminal is now. */
void screen_begin(int *rows, int *columns);
/* Text from a place on; what does not fit is left out. */
void screen_put(int row, int column, screen_style style, const char *text);
/* Shows what differs from the picture before. */
void screen_end(void);

/* The next key pressed, SCREEN_KEY_NONE when there is none. Does not wait. */
int screen_key(void);

#endif
