/* SPDX-License-Identifier: MIT */
#include <windows.h>
#include <locale.h>
#include <stdint.h>
#include <stdio.h>

#include "tests/support/os.h"
#include "tests/support/test.h"

void test_folder_new(char *path, size_t path_bytes)
{
    char base[MAX_PATH];
    int size;

    assert_true(GetTempPathA(sizeof base, base) > 0);
    for (unsigned n = 0; n < 1000; n++) {
        size = snprintf(path, path_bytes, "%sgrobo-test-%lu-%u", base, GetCurrentProcessId(), n);
        assert_true(size > 0 && (size_t)size < path_bytes);
        if (CreateDirectoryA(path, NULL)) {
            return;
        }
        assert_int_equal(GetLastError(), ERROR_ALREADY_EXISTS);
    }
    fail_msg("%s", "no temporary folder");
}

int test_folder_make(const char *path)
{
    return CreateDirectoryA(path, NULL) ? 0 : -1;
}

int test_folder_remove(const char *path)
{
    return RemoveDirectoryA(path) ? 0 : -1;
}

int64_t test_cpu_us(void)
{
    FILETIME made, over, kernel, user;

    if (!GetProcessTimes(GetCurrentProcess(), &made, &over, &kernel, &user)) {
        return 0;
    }
    return ((((int64_t)kernel.dwHighDateTime + user.dwHighDateTime) << 32) + kernel.dwLowDateTime +
            user.dwLowDateTime) /
           10;
}

bool test_locale_with_comma(void)
{
    return setlocale(LC_NUMERIC, "German_Germany.1252") != NULL;
}
