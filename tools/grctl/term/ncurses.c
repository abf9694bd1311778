/* SPDX-License-Identifier: MIT */
/*
 * ncurses writes its pictures into a file, and they go on as all output does (output.h): a terminal
 * that takes nothing (Ctrl-S, a reader that is away) holds up nobody, however much of a picture it
 * has taken. The next picture waits until the one before has gone out.
 */
/* curses.h declares bool its own way unless told not to. */
#define NCURSES_ENABLE_STDBOOL_H 1
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <curses.h>
#include <term.h>

#undef columns /* a capability in term.h, a parameter in ours */

#include "tools/grctl/cli/output.h"
#include "tools/grctl/os/os.h"
#include "tools/grctl/term/screen.h"

enum { ESCAPE_MS = 25, PIECE_BYTES = 4096 };

/* How long the terminal has time to take what ends the screen. */
enum { LAST_MS = 200 };

static SCREEN *terminal;
static FILE *drawn;   /* what ncurses writes to: the terminal while it is set up, then `picture` */
static FILE *picture; /* what it has written and nobody has taken yet */
static bool paused;   /* the terminal is as it was found */
static struct termios found_modes, screen_modes;
static WINDOW *input; /* a pad: reading a key from it draws nothing */
static attr_t attributes[SCREEN_STYLES];

/* It has no name, so that it is gone with us; /tmp may be read-only, or not there. */
static bool have_picture(void)
{
    picture = picture ? picture : os_temporary();
    return picture != NULL;
}

bool screen_possible(void)
{
    int found;
    return isatty(STDIN_FILENO) && isatty(STDOUT_FILENO) && tcgetpgrp(STDIN_FILENO) == getpgrp() &&
           setupterm(NULL, STDOUT_FILENO, &found) == OK && cursor_address && clear_screen &&
           have_picture();
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

/* Gives the bytes of a picture to who writes them. */
static void pass_on(void)
{
    char piece[PIECE_BYTES];
    int fd = fileno(picture);
    off_t size = lseek(fd, 0, SEEK_CUR), at = 0;
    while (at < size) {
        ssize_t n = pread(fd, piece, sizeof piece, at);
        if (n <= 0) {
            break;
        }
        output_bytes(piece, (size_t)n);
        at += n;
    }
    (void)!ftruncate(fd, 0);
    (void)lseek(fd, 0, SEEK_SET);
    (void)output_flush();
}

/* Gives the terminal back, as far as it takes that. */
static void end_screen(void)
{
    endwin();
    pass_on();
    for (int ms = 0; ms < LAST_MS && output_is_behind(stdout); ms++) {
        (void)poll(NULL, 0, 1);
    }
    (void)tcsetattr(STDIN_FILENO, TCSANOW, &found_modes);
    paused = true;
}

static void forget(void)
{
    if (input) {
        delwin(input);
    }
    if (terminal) {
        delscreen(terminal);
    }
    if (drawn) {
        (void)fclose(drawn);
    }
    if (picture) {
        (void)fclose(picture);
    }
    input = NULL;
    terminal = NULL;
    drawn = picture = NULL;
}

/* ncurses sets the modes of the terminal it draws on, so it is that until they are set. */
static bool set_up(bool color)
{
    int fd = dup(STDOUT_FILENO);
    drawn = fd < 0 ? NULL : fdopen(fd, "w");
    if (!drawn || !have_picture() || tcgetattr(STDIN_FILENO, &found_modes) != 0) {
        return false;
    }
    terminal = newterm(NULL, drawn, stdin);
    input = terminal ? newpad(1, 1) : NULL;
    if (!input) {
        return false;
    }
    set_escdelay(ESCAPE_MS);
    cbreak();
    noecho();
    nodelay(input, true);
    keypad(input, true);
    curs_set(0);
    choose_attributes(color);
    return tcgetattr(STDIN_FILENO, &screen_modes) == 0 && dup2(fileno(picture), fd) == fd;
}

bool screen_open(bool color)
{
    static bool registered;
    if (!registered && atexit(screen_close) != 0) {
        return false;
    }
    registered = true;
    paused = false;
    if (!set_up(color)) {
        if (terminal) {
            endwin();
        }
        forget();
        return false;
    }
    return true;
}

void screen_close(void)
{
    if (terminal) {
        end_screen();
        forget();
    }
}

void screen_pause(void)
{
    if (terminal && !paused) {
        end_screen();
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
    if (output_is_behind(stdout)) {
        return; /* the next picture is as good */
    }
    if (paused) {
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &screen_modes);
        paused = false;
    }
    refresh();
    pass_on();
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
