/* SPDX-License-Identifier: MIT */
/* To be loaded before a program's libraries (tests/cli/memory.sh): the FAIL_AT-th allocation of the
 * process fails, and no other. How many there were is a line of the file COUNT_TO, behind those of
 * other processes: the guard has this loaded too. glibc alone.
 * One of ncurses does not: setupterm() crashes where it has no memory for a name, and nobody can
 * help that. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *old, size_t size);

static atomic_long count;
static atomic_long fail_at;

static int is_of_ncurses(void)
{
    void *callers[32];
    int n = backtrace(callers, (int)(sizeof callers / sizeof callers[0]));
    for (int i = 0; i < n; i++) {
        Dl_info of;
        if (dladdr(callers[i], &of) != 0 && of.dli_fname != NULL &&
            (strstr(of.dli_fname, "libtinfo") != NULL ||
             strstr(of.dli_fname, "libncurses") != NULL)) {
            return 1;
        }
    }
    return 0;
}

static int fails(void)
{
    if (fail_at == 0) {
        const char *text = getenv("FAIL_AT");
        fail_at = text != NULL ? strtol(text, NULL, 10) : -1;
    }
    /* Once: what looks at the callers allocates too. */
    int failing = atomic_fetch_add(&count, 1) + 1 == fail_at && !is_of_ncurses();
    errno = failing ? ENOMEM : errno;
    return failing;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    return fails() ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
    return fails() ? NULL : __libc_realloc(old, size);
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = getenv("COUNT_TO");
    FILE *file = path != NULL ? fopen(path, "a") : NULL;
    if (file != NULL) {
        (void)fprintf(file, "%ld\n", atomic_load(&count));
        (void)fclose(file);
    }
}
