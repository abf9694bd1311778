/* SPDX-License-Identifier: MIT */
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
