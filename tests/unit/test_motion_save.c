/* SPDX-License-Identifier: MIT */
/* Saving motions, and finding them in a directory, through the port's files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "motion_files.h"

static const char saved[] = "500  10 -20\n1000  1 2\n";
static const grobo_write_options in_motor_order = {.model = &grobo_gr001_model};

static char folder[256];

static int make_folder(void **state)
{
    (void)state;
    const char *base = getenv("TMPDIR");

    (void)snprintf(folder, sizeof folder, "%s/grobo-motion-XXXXXX", base != NULL ? base : "/tmp");
    return mkdtemp(folder) != NULL ? 0 : -1;
}

static const char *in_folder(const char *name)
{
    static char paths[4][512];
    static int next;
    char *path = paths[next++ % 4];

    (void)snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static int remove_folder(void **state)
{
    (void)state;
    static const char *const names[] = {
        "a.m", "b.m",    "link.m",    "Motion1.m",  "Motion2.m", "Motion3.m", "sub/c.yaml",
        "out", "walk.m", "walk.pseq", "readonly.m", "open.m",    "astray.m"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        (void)unlink(in_folder(names[i]));
    }
    (void)rmdir(in_folder("sub"));
    /* Fails if a temporary file was left behind. */
    return rmdir(folder);
}

static void put_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void assert_file(const char *path, const char *text)
{
    size_t size;
    char *found = file_text(path, &size);

    assert_non_null(found);
    assert_string_equal(found, text);
    free(found);
}

static void test_save(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of(saved, GROBO_FORMAT_M);
    const char *path = in_folder("a.m");
    struct stat status;

    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, &in_motor_order, NULL), 0);
    assert_file(path, saved);
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, &in_motor_order, NULL), 0);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    grobo_motion_free(motion);
}

static void test_save_refused(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(&list, NULL), 0);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), folder, NULL, list),
                     GROBO_ERR_ISDIR);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), in_folder("none/a.m"), NULL, list),
                     GROBO_ERR_NOENT);
    assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR), 2);
    grobo_diagnostics_free(list);
    grobo_motion_free(motion);
}

/* A save that fails, at any write or at the end, leaves the old file whole and nothing else. */
static const grobo_files *real_files;
static int writes_left;

static int few_writes(grobo_file *file, const void *data, size_t size)
{
    return writes_left-- > 0 ? real_files->write(file, data, size) : GROBO_ERR_IO;
}

static void test_save_never_destroys(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of(saved, GROBO_FORMAT_M);
    real_files = grobo_files_os();
    grobo_files files = *real_files;
    const char *path = in_folder("b.m");

    files.write = few_writes;
    put_file(path, "precious");
    writes_left = 0;
    assert_int_equal(grobo_motion_save(motion, &files, path, NULL, NULL), GROBO_ERR_IO);
    assert_file(path, "precious");
    grobo_motion_free(motion);
}

static void test_save_through_a_link(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    struct stat status;

    put_file(in_folder("b.m"), "old");
    assert_int_equal(symlink(in_folder("b.m"), in_folder("link.m")), 0);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), in_folder("link.m"),
                                       &(grobo_write_options){.model = &grobo_gr001_model}, NULL),
                     0);
    assert_int_equal(lstat(in_folder("link.m"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_file(in_folder("b.m"), "500  10\n");
    grobo_motion_free(motion);
}

/* /dev/stdout is such a link: to a pipe, by no path. It stays, and so does one to nothing. */
static void test_save_through_a_link_to_no_file(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_write_options options = {.model = &grobo_gr001_model};
    struct stat status;
    char open_end[32], text[16] = "";
    int ends[2];

    assert_int_equal(pipe(ends), 0);
    (void)snprintf(open_end, sizeof open_end, "/dev/fd/%d", ends[1]);
    assert_int_equal(symlink(open_end, in_folder("open.m")), 0);
    assert_int_equal(
        grobo_motion_save(motion, grobo_files_os(), in_folder("open.m"), &options, NULL), 0);
    (void)close(ends[1]);
    assert_int_equal(read(ends[0], text, sizeof text), 8);
    assert_string_equal(text, "500  10\n");
    assert_int_equal(lstat(in_folder("open.m"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    (void)close(ends[0]);
    assert_int_equal(symlink(in_folder("nothing.m"), in_folder("astray.m")), 0);
    assert_int_equal(
        grobo_motion_save(motion, grobo_files_os(), in_folder("astray.m"), &options, NULL),
        GROBO_ERR_NOENT);
    assert_int_equal(lstat(in_folder("astray.m"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    grobo_motion_free(motion);
}

static void test_save_next(void **state)
{
    (void)state;
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_write_options options = {.model = &grobo_gr001_model};
    char path[512] = "";

    put_file(in_folder("Motion2.m"), "mine");
    assert_int_equal(
        grobo_motion_save_next(motion, grobo_files_os(), folder, &options, path, sizeof path), 1);
    assert_string_equal(path, in_folder("Motion1.m"));
    assert_file(path, "500  10\n");
    assert_int_equal(grobo_motion_save_next(motion, grobo_files_os(), folder, &options, path, 5),
                     GROBO_ERR_SPACE);
    assert_int_equal(
        grobo_motion_save_next(motion, grobo_files_os(), folder, &options, path, sizeof path), 3);
    assert_file(in_folder("Motion2.m"), "mine");
    assert_int_equal(grobo_motion_save_next(motion, grobo_files_os(), in_folder("nowhere"), NULL,
                                            path, sizeof path),
                     GROBO_ERR_NOENT);
    grobo_motion_free(motion);
}

static void test_find(void **state)
{
    (void)state;
    const grobo_files *files = grobo_files_os();
    char path[4096] = "untouched";

    assert_int_equal(mkdir(in_folder("sub"), 0755), 0);
    put_file(in_folder("walk.pseq"), "");
    put_file(in_folder("sub/c.yaml"), "");
    assert_int_equal(grobo_motion_find(files, folder, "walk", path, sizeof path), 0);
    assert_string_equal(strrchr(path, '/'), "/walk.pseq");
    put_file(in_folder("walk.m"), "");
    assert_int_equal(grobo_motion_find(files, folder, "walk", path, sizeof path), 0);
    assert_string_equal(strrchr(path, '/'), "/walk.m");
    assert_int_equal(grobo_motion_find(files, folder, "walk.pseq", path, sizeof path), 0);
    assert_string_equal(strrchr(path, '/'), "/walk.pseq");
    assert_int_equal(grobo_motion_find(files, folder, "sub/c", path, sizeof path), 0);
    static const char *const outside[] = {
        "/etc/passwd", "..", "../x", "sub/../../x", "sub/..", "", "\\x", "c:x", "a/../b"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        assert_int_equal(grobo_motion_find(files, folder, outside[i], path, sizeof path),
                         GROBO_ERR_PERM);
    }
    assert_int_equal(grobo_motion_find(files, folder, "nothing", path, sizeof path),
                     GROBO_ERR_NOENT);
    assert_int_equal(symlink("/", in_folder("out")), 0);
    assert_int_equal(grobo_motion_find(files, folder, "out/etc/passwd.m", path, sizeof path),
                     GROBO_ERR_NOENT);
    assert_int_equal(unlink(in_folder("out")), 0);
    assert_int_equal(symlink("/etc/passwd", in_folder("out")), 0);
    (void)unlink(in_folder("link.m"));
    assert_int_equal(symlink("/etc/passwd", in_folder("link.m")), 0);
    assert_int_equal(grobo_motion_find(files, folder, "link", path, sizeof path), GROBO_ERR_PERM);
    assert_int_equal(grobo_motion_find(files, folder, "walk", path, 3), GROBO_ERR_SPACE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_save),
        cmocka_unit_test(test_save_refused),
        cmocka_unit_test(test_save_never_destroys),
        cmocka_unit_test(test_save_through_a_link),
        cmocka_unit_test(test_save_through_a_link_to_no_file),
        cmocka_unit_test(test_save_next),
        cmocka_unit_test(test_find),
    };

    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
