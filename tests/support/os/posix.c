/* SPDX-License-Identifier: MIT */
#include <locale.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/os.h"
#include "tests/support/test.h"

void test_folder_new(char *path, size_t path_bytes)
{
    const char *base = getenv("TMPDIR");
    int size = snprintf(path, path_bytes, "%s/grobo-test-XXXXXX", base != NULL ? base : "/tmp");

    assert_true(size > 0 && (size_t)size < path_bytes);
    assert_non_null(mkdtemp(path));
}

int test_folder_make(const char *path)
{
    return mkdir(path, 0755);
}

int test_folder_remove(const char *path)
{
    return rmdir(path);
}

int64_t test_cpu_us(void)
{
    struct rusage usage;

    if (getrusage(RUSAGE_SELF, &usage) != 0) {
        return 0;
    }
    return (int64_t)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1000000 +
           usage.ru_utime.tv_usec + usage.ru_stime.tv_usec;
}

bool test_locale_with_comma(void)
{
    static const char name[] = "de_DE.UTF-8";
    char folder[300];
    char command[800];

    if (setlocale(LC_NUMERIC, name) != NULL) {
        return true;
    }
    test_folder_new(folder, sizeof folder);
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 '%s/%s' >'%s/said' 2>&1", folder,
             name, folder);
    bool made = system(command) == 0 && setenv("LOCPATH", folder, 1) == 0 &&
                setlocale(LC_NUMERIC, name) != NULL;
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command) == 0 && made;
}
