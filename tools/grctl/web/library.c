/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <stdio.h>
#include <string.h>

#include "tools/grctl/web/library.h"
#include "tools/grctl/web/serve.h"

bool library_path(const serve *s, const char *name, char *path, size_t capacity)
{
    DIR *folder = opendir(s->options->folder);
    struct dirent *entry;
    bool found = false;
    while (folder && !found && (entry = readdir(folder)) != NULL) {
        if (entry->d_name[0] != '.' && strcmp(entry->d_name, name) == 0) {
            int n = snprintf(path, capacity, "%s/%s", s->options->folder, entry->d_name);
            found = n > 0 && (size_t)n < capacity;
        }
    }
    if (folder) {
        closedir(folder);
    }
    return found;
}
