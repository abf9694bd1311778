/* SPDX-License-Identifier: MIT */
/*
 * The folder of motions. It is read by the worker's thread alone, which keeps what it found; names
 * are those of that list, and no other file is opened.
 */
#ifndef GRCTL_WEB_LIBRARY_H
#define GRCTL_WEB_LIBRARY_H

#include <jansson.h>

#include <grobo/core/motion_io.h>

#include "tools/grctl/cli/app.h"

enum {
    LIBRARY_NAME_BYTES = 256,
    LIBRARY_ETAG_BYTES = 24,
    LIBRARY_FILES_MAX = 1000,
    LIBRARY_FILE_BYTES = 32 * 1024 * 1024
};

typedef struct serve serve;
typedef struct http_request http_request;
typedef struct library library;

/* NULL: no memory. The folder is borrowed. */
library *library_new(const app *a, const char *folder);
void library_free(library *l);

/* ---- in the worker's thread ------------------------------------------------------------------ */

/* A motion file in memory. */
typedef struct library_file {
    char path[GROBO_PATH_MAX_BYTES]; /* for messages: its name in the folder */
    char etag[LIBRARY_ETAG_BYTES];
    char *bytes;
    size_t size;
} library_file;

/* Reads one of the folder. 0 or an error; library_drop() in either case. */
int library_read(library *l, const char *name, library_file *file);
void library_drop(library_file *file);
/* May a new file be called so? */
bool library_is_name(const char *name);

/* ---- in the loop ----------------------------------------------------------------------------- */

/* GET /api/motions, and of one; PUT; preview. Each answers when the worker is done. */
void library_list(serve *s, http_request *r);
void library_get(serve *s, http_request *r, const char *name, double rate_hz);
void library_get_file(serve *s, http_request *r, const char *name);
void library_put(serve *s, http_request *r, const char *name, bool file);
void library_preview(serve *s, http_request *r);
/* Looks for what changed, now and then. */
void library_look(serve *s);

#endif
