/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/grctl/cli/file.h"
#include "tools/grctl/web/http.h"
#include "tools/grctl/web/page.h"

enum { DISK_BYTES = 1024 * 1024 };

/* Behind the version, where the path has it; NULL: it has not. */
static const char *below_version(const char *path)
{
    size_t n = strlen(page_version);
    return strncmp(path, page_version, n) == 0 && path[n] == '/' ? path + n : NULL;
}

static const page_file *find(const char *path)
{
    const char *below = below_version(path);
    const char *name = strcmp(path, "/") == 0 ? "/index.html" : below ? below : path;
    for (const page_file *f = page_files; f->path; f++) {
        if (strcmp(f->path, name) == 0) {
            return f;
        }
    }
    return NULL;
}

bool page_has(const char *path)
{
    return find(path) != NULL;
}

/* While the page is written: as it is on the disk, by the same names. */
static bool serve_from(const char *folder, http_request *r, const page_file *file)
{
    char path[4096];
    snprintf(path, sizeof path, "%s%s", folder, file->path);
    heap all = file_bytes(path, DISK_BYTES);
    if (!all.bytes) {
        return false;
    }
    http_reply_content(
        r, &(http_content){.type = file->type, .bytes = all.bytes, .size = all.size, .page = true});
    free(all.bytes);
    return true;
}

void page_serve(http_request *r)
{
    const page_file *f = find(r->path);
    const char *folder = getenv("GRCTL_WEB_DIR");
    if (folder && *folder && serve_from(folder, r, f)) {
        return;
    }
    http_reply_content(r, &(http_content){.type = f->type,
                                          .bytes = f->bytes,
                                          .size = f->size,
                                          .etag = f->etag,
                                          .early = f->early,
                                          .lasts = below_version(r->path) != NULL,
                                          .gzip = true,
                                          .page = true});
}
