/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/files.h"
#include "tests/support/test.h"

char *file_text(const char *path, size_t *size)
{
    enum { BLOCK_BYTES = 65536 };
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    size_t used = 0;
    size_t got = 0;

    if (file == NULL) {
        return NULL;
    }
    do {
        used += got;
        text = realloc(text, used + BLOCK_BYTES + 1);
        assert_non_null(text);
        got = fread(text + used, 1, BLOCK_BYTES, file);
    } while (got > 0);
    text[used] = '\0';
    (void)fclose(file);
    if (size != NULL) {
        *size = used;
    }
    return text;
}

void put_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

void assert_file(const char *path, const char *text)
{
    char *found = file_text(path, NULL);

    assert_non_null(found);
    assert_string_equal(found, text);
    free(found);
}

const char *shared_file(const char *name)
{
    static char path[4096];
    const char *root = getenv("GROBO_SHARED");

    (void)snprintf(path, sizeof path, "%s/%s", root != NULL ? root : "../shared", name);
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        print_message("%s is missing: reference material beside the checkout\n", path);
        skip();
    }
    fclose(file);
    return path;
}
