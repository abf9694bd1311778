/* SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "tests/support/folder.h"
#include "tests/support/os.h"
#include "tests/support/test.h"

char folder[256];

int folder_set_up(void)
{
    test_folder_new(folder, sizeof folder);
    return 0;
}

const char *in_folder(const char *name)
{
    static char paths[4][sizeof folder + 64];
    static int next;
    char *path = paths[next++ % 4];
    int length = snprintf(path, sizeof paths[0], "%s/%s", folder, name);

    assert_true(length > 0 && (size_t)length < sizeof paths[0]);
    return path;
}

void folder_remove(const char *const *names, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        (void)remove(in_folder(names[i]));
    }
    assert_int_equal(test_folder_remove(folder), 0);
}
