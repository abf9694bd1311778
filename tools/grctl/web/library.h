/* SPDX-License-Identifier: MIT */
/* The folder of motions: its names are the only ones that are opened. */
#ifndef GRCTL_WEB_LIBRARY_H
#define GRCTL_WEB_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

enum { LIBRARY_NAME_BYTES = 256, LIBRARY_PATH_BYTES = 4096 + 256, LIBRARY_FILES_MAX = 1000 };

typedef struct serve serve;
typedef struct http_request http_request;

/* The path of a motion by its name in the list; false: there is none. */
bool library_path(const serve *s, const char *name, char *path, size_t capacity);

#endif
