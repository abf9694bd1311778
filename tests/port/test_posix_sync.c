/* SPDX-License-Identifier: MIT */
/* What is to outlive a loss of power is synced, its folder too: the calls to the system are counted
 * here. */
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <grobo/core/port.h>
#include <grobo/posture.h>

#include "tests/support/folder.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"
#include "tools/grctl/cli/journal.h"
#include "tools/grctl/cli/sync.h"
#include "tools/grctl/fleet/spool.h"

/* By what was synced: files, and folders behind them. */
static atomic_int files, folders;
static atomic_int fails; /* errno */

int fsync(int fd)
{
    struct stat at;
    if (fstat(fd, &at) == 0) {
        atomic_fetch_add(S_ISDIR(at.st_mode) ? &folders : &files, 1);
    }
    errno = fails;
    return fails ? -1 : 0;
}

static char path[300];

static int set_up(void)
{
    (void)folder_set_up();
    snprintf(path, sizeof path, "%s", in_folder("kept"));
    files = folders = fails = 0;
    return 0;
}

static int tear_down(void)
{
    char command[400];
    sync_end();
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

TEST_WITH(fixture, an_event_that_waits_for_its_broker)
{
    json_t *event = json_pack("{s:i,s:i}", "v", 1, "n", 1);
    assert_true(spool_add(path, event));
    sync_end();
    assert_true(files == 1 && folders == 1);
    assert_true(spool_add(path, event));
    assert_true(spool_add(path, event));
    sync_end();
    assert_in_range(files, 2, 3); /* one call may be for both */
    json_decref(event);
}

/* The file that is full, by the name that it has then. */
TEST_WITH(fixture, events_of_a_file_that_is_full)
{
    char text[SPOOL_LINE_BYTES / 2];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    json_t *event = json_pack("{s:i,s:s}", "v", 1, "text", text);
    struct stat at;
    while (stat(path, &at) != 0 || at.st_size < SPOOL_FILE_BYTES - 2 * SPOOL_LINE_BYTES) {
        assert_true(spool_add(path, event));
    }
    while (stat(path, &at) == 0) {
        sync_end();
        files = 0;
        assert_true(spool_add(path, event));
    }
    sync_end();
    assert_int_equal(files, 1);
    json_decref(event);
}

static grobo_posture posture_at(double angle_rad)
{
    grobo_posture posture;
    grobo_posture_init(&posture, grobo_i_gr001_model.n_joints);
    for (int j = 0; j < posture.n_joints; j++) {
        grobo_posture_set_rad(&posture, j, angle_rad);
    }
    posture.time_us = 100000;
    return posture;
}

TEST_WITH(fixture, each_posture_of_a_recording)
{
    journal j;
    assert_int_equal(journal_begin(&j, path), 0);
    for (int i = 1; i <= 3; i++) {
        grobo_posture posture = posture_at(i / 10.0);
        assert_int_equal(journal_add(&j, &posture, &grobo_i_gr001_model), 0);
    }
    journal_end(&j, true);
    assert_in_range(files, 1, 3);
    assert_true(folders == files);
}

/* However much of it a disk has: what is there is a motion, up to one posture. */
TEST_WITH(fixture, no_line_of_a_recording_is_in_two_pages)
{
    enum { POSTURES = 300, PAGE_BYTES = 4096 };
    char name[GROBO_PATH_MAX_BYTES];
    journal j;
    assert_int_equal(journal_begin(&j, path), 0);
    snprintf(name, sizeof name, "%s", j.path);
    for (int i = 0; i < POSTURES; i++) {
        grobo_posture posture = posture_at(i / 1000.0);
        assert_int_equal(journal_add(&j, &posture, &grobo_i_gr001_model), 0);
    }
    journal_end(&j, true);
    FILE *file = fopen(name, "rb");
    assert_non_null(file);
    int lines = 0, shown = 0;
    long at = 0, begin = -1;
    for (int c = fgetc(file); c != EOF; c = fgetc(file), at++) {
        begin = begin < 0 && c != ' ' ? at : begin;
        if (c == '\n') {
            assert_int_equal(begin / PAGE_BYTES, at / PAGE_BYTES);
            shown += begin > PAGE_BYTES;
            begin = -1;
            lines++;
        }
    }
    fclose(file);
    assert_int_equal(lines, POSTURES);
    assert_true(shown > 0);
    grobo_motion *motion;
    assert_int_equal(grobo_motion_read_file(name, NULL, NULL, &motion), 0);
    assert_int_equal(grobo_motion_size(motion), POSTURES);
    grobo_motion_free(motion);
}

TEST_WITH(fixture, a_disk_that_refuses_is_told)
{
    json_t *event = json_pack("{s:i,s:i}", "v", 1, "n", 1);
    fails = EIO;
    (void)spool_add(path, event);
    int64_t until_us = grobo_now_us() + 60000000; /* its thread has its turn some time */
    while (spool_add(path, event)) {
        assert_true(grobo_now_us() < until_us);
    }
    json_decref(event);
}
