/* SPDX-License-Identifier: MIT */
/* curses.h declares bool its own way unless told not to. */
#define NCURSES_ENABLE_STDBOOL_H 1
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <curses.h>
#include <term.h>

#undef columns /* a capability in term.h, a parameter in ours */

#include "tools/grctl/os/os.h"
#include "tools/grctl/screen/screen.h"

enum { ESCAPE_MS = 25 };

static SCREEN *terminal;
static WINDOW *input; /* a pad: reading a key from it draws nothing */
static attr_t attributes[SCREEN_STYLES];

bool screen_possible(void)
{
    int found;
    return isatty(STDIN_FILENO) && isatty(STDOUT_FILENO) && tcgetpgrp(STDIN_FILENO) == getpgrp() &&
           setupterm(NULL, STDOUT_FILENO, &found) == OK && cursor_address && clear_screen;
}

static void choose_attributes(bool color)
{
    static const short colors[SCREEN_STYLES] = {[SCREEN_GOOD] = COLOR_GREEN,
                                                [SCREEN_WARN] = COLOR_YELLOW,
                                                [SCREEN_BAD] = COLOR_RED,
                                                [SCREEN_ALARM] = COLOR_RED};
    static const attr_t plain[SCREEN_STYLES] = {[SCREEN_DIM] = A_DIM,
                                                [SCREEN_BOLD] = A_BOLD,
                                                [SCREEN_WARN] = A_BOLD,
                                                [SCREEN_BAD] = A_REVERSE,
                                                [SCREEN_ALARM] = A_REVERSE | A_BOLD};
    color = color && start_color() == OK && has_colors();
    if (color) {
        use_default_colors();
    }
    for (int i = 0; i < SCREEN_STYLES; i++) {
        attributes[i] = plain[i];
        if (!color || !colors[i]) {
            continue;
        }
        init_pair((short)i, colors[i], -1);
        attributes[i] = (attr_t)COLOR_PAIR(i) | (i == SCREEN_ALARM ? A_REVERSE | A_BOLD : 0);
    }
}

bool screen_open(bool color)
{
    static bool registered;
    if (!registered && atexit(screen_close) != 0) {
        return false;
    }
    registered = true;
    terminal = newterm(NULL, stdout, stdin);
    if (!terminal) {
        return false;
    }
    input = newpad(1, 1);
    if (!input) {
        screen_close();
        return false;
    }
    set_escdelay(ESCAPE_MS);
    cbreak();
    noecho();
    nodelay(input, true);
    keypad(input, true);
    curs_set(0);
    choose_attributes(color);
    return true;
}

void screen_close(void)
{
    if (!terminal) {
        return;
    }
    endwin();
    if (input) {
        delwin(input);
    }
    delscreen(terminal);
    input = NULL;
    terminal = NULL;
}

void screen_pause(void)
{
    if (terminal) {
        endwin();
    }
}

void screen_begin(int *rows, int *columns)
{
    struct winsize size;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0 &&
        (size.ws_row != LINES || size.ws_col != COLS)) {
        resizeterm(size.ws_row, size.ws_col);
        clearok(stdscr, true);
    }
    erase();
    *rows = LINES;
    *columns = COLS;
}

void screen_put(int row, int column, screen_style style, const char *text)
{
    if (row < 0 || row >= LINES || column < 0 || column >= COLS) {
        return;
    }
    attrset((int)attributes[style]);
    move(row, column);
    /* One character after the other until the row is full: a whole text would go on in the next. */
    while (*text && getcury(stdscr) == row) {
        int n = 1;
        while (((unsigned char)text[n] & 0xC0) == 0x80) {
            n++;
        }
        if (addnstr(text, n) == ERR) {
            break;
        }
        text += n;
    }
}

void screen_end(void)
{
    /* Not to a terminal that has been stopped (Ctrl-S): the next picture is as good. */
    if (os_takes_bytes(stdout)) {
        refresh();
    }
}

int screen_key(void)
{
    int key = wgetch(input);
    switch (key) {
    case ERR:
        return SCREEN_KEY_NONE;
    case KEY_UP:
        return SCREEN_KEY_UP;
    case KEY_DOWN:
        return SCREEN_KEY_DOWN;
    case KEY_LEFT:
        return SCREEN_KEY_LEFT;
    case KEY_RIGHT:
        return SCREEN_KEY_RIGHT;
    }
    return key;
}
