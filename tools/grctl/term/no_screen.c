/* SPDX-License-Identifier: MIT */
#include "tools/grctl/term/screen.h"

bool screen_possible(void)
{
    return false;
}

bool screen_open(bool color)
{
    (void)color;
    return false;
}

void screen_pause(void)
{
}

void screen_close(void)
{
}

void screen_begin(int *rows, int *columns)
{
    *rows = *columns = 0;
}

void screen_put(int row, int column, screen_style style, const char *text)
{
    (void)row;
    (void)column;
    (void)style;
    (void)text;
}

void screen_end(void)
{
}

int screen_key(void)
{
    return SCREEN_KEY_NONE;
}
