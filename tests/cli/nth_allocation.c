/* SPDX-License-Identifier: MIT */
/* To be loaded before a program's libraries (tests/cli/memory.sh): the FAIL_AT-th allocation of the
 * process fails, and no other. How many there were is written to the file COUNT_TO. glibc alone. */
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *old, size_t size);

static atomic_long count;
static atomic_long fail_at;

static int fails(void)
{
    if (fail_at == 0) {
        const char *text = getenv("FAIL_AT");
        fail_at = text != NULL ? strtol(text, NULL, 10) : -1;
    }
    int failing = ++count == fail_at;
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
    FILE *file = path != NULL ? fopen(path, "w") : NULL;
    if (file != NULL) {
        (void)fprintf(file, "%ld\n", atomic_load(&count));
        (void)fclose(file);
    }
}
