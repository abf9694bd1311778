/* SPDX-License-Identifier: MIT */
/*
 * The page: files of web/page, compressed in the program, or with GRCTL_WEB_DIR from there. Below
 * page_version they are what they are for ever, and a browser asks for them once.
 */
#ifndef GRCTL_WEB_PAGE_H
#define GRCTL_WEB_PAGE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct http_request http_request;

/* A file; made by embed.sh. */
typedef struct page_file {
    const char *path; /* "/index.html" */
    const char *type;
    const char *etag;
    const char *early;          /* what to ask for along with it, a Link header; or "" */
    const unsigned char *bytes; /* gzip */
    size_t size;
} page_file;
extern const page_file page_files[]; /* path NULL behind the last */
extern const char page_version[];    /* "/v..." */

bool page_has(const char *path);
void page_serve(http_request *r);

#endif
