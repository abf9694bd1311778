/* SPDX-License-Identifier: MIT */
/*
 * The ports of `-d auto`: USB adapters, the one used last first. A UART of the board may have
 * anything behind it: it is named, never asked.
 */
#ifndef GRCTL_CHOOSE_H
#define GRCTL_CHOOSE_H

#include <grobo/core/port.h>

enum { CHOOSE_MAX = 32 };

typedef struct choice {
    grobo_port_info usb[CHOOSE_MAX];     /* that may be opened, in the order to be tried */
    grobo_port_info blocked[CHOOSE_MAX]; /* USB adapters that may not: busy or forbidden */
    grobo_port_info uart[CHOOSE_MAX];    /* of the board, neither console nor Bluetooth */
    int n_usb, n_blocked, n_uart;
    const char *scan[CHOOSE_MAX + 1]; /* paths of usb, ended by NULL */
} choice;

/* Begins with nothing. */
void choose_begin(choice *all);
/* Sorts one port in; more than CHOOSE_MAX of a kind are not kept. For grobo_port_list(). */
int choose_take(void *ctx, const grobo_port_info *info);
/* Puts the port used last in front; `last` is its path or its by_id, "" none. Fills scan. */
void choose_end(choice *all, const char *last);

/* The line that makes a blocked port usable. */
void choose_fix(const grobo_port_info *info, char *fix, size_t capacity);

#endif
