/* SPDX-License-Identifier: MIT */
/* Saving and finding motions where files have modes and links, as on POSIX. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/files.h"
#include "tests/support/folder.h"
#include "tests/support/motion_texts.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static int remove_folder(void)
{
    static const char *const names[] = {"a.m", "b.m", "link.m", "out", "open.m", "astray.m"};

    /* Fails if a temporary file was left behind. */
    folder_remove(names, sizeof names / sizeof names[0]);
    return 0;
}

TEST(test_mode)
{
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    const char *path = in_folder("a.m");
    struct stat status;

    put_file(path, "500  20\n");
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, NULL, NULL), 0);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    grobo_motion_free(motion);
}

TEST(test_save_through_a_link)
{
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    struct stat status;

    put_file(in_folder("b.m"), "500  20\n");
    assert_int_equal(symlink(in_folder("b.m"), in_folder("link.m")), 0);
    assert_int_equal(grobo_motion_save(motion, grobo_files_os(), in_folder("link.m"),
                                       &(grobo_write_options){GROBO_WRITE_OPTIONS_INIT,
                                                              .model = &grobo_i_gr001_model},
                                       NULL),
                     0);
    assert_int_equal(lstat(in_folder("link.m"), &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_file(in_folder("b.m"), "500  10\n");
    grobo_motion_free(motion);
}

/* /dev/stdout is such a link: to a pipe, by no path. It stays, and so does one to nothing. */
TEST(test_save_through_a_link_to_no_file)
{
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model};
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

TEST(test_find_through_links)
{
    const grobo_files *files = grobo_files_os();
    char path[4096] = "untouched";

    assert_int_equal(symlink("/", in_folder("out")), 0);
    assert_int_equal(grobo_motion_find(files, folder, "out/etc/passwd.m", path, sizeof path),
                     GROBO_ERR_NOENT);
    assert_int_equal(unlink(in_folder("out")), 0);
    assert_int_equal(symlink("/etc/passwd", in_folder("out")), 0);
    (void)unlink(in_folder("link.m"));
    assert_int_equal(symlink("/etc/passwd", in_folder("link.m")), 0);
    assert_int_equal(grobo_motion_find(files, folder, "link", path, sizeof path),
                     GROBO_ERR_OUTSIDE);
    assert_string_equal(path, "untouched");
}

TESTS_BETWEEN(folder_set_up, remove_folder)
