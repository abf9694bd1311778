/* SPDX-License-Identifier: MIT */
/* Notes between the programs of one user: only those that the user alone can have written. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <grobo/estop.h>

#include "ports/common/notes.h"
#include "tests/support/folder.h"
#include "tests/support/test.h"

enum { NOBODY = 65534 };

/* A device that is not there, of this process alone. */
static char device[64];

/* The directory of notes in $XDG_RUNTIME_DIR, which is the test's folder. */
static int set_up(void)
{
    (void)folder_set_up();
    assert_int_equal(setenv("XDG_RUNTIME_DIR", folder, 1), 0);
    snprintf(device, sizeof device, "/nowhere/robot-%ld", (long)getpid());
    return 0;
}

static int tear_down(void)
{
    char command[400];

    assert_int_equal(grobo_estop_clear(device, NULL), GROBO_OK);
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command);
}

static const test_fixture fixture[] = {{NULL, set_up, tear_down}};

/* The path of a note in the directory of the session. */
static const char *note_path(const char *name)
{
    static char path[600];
    char note[300];

    snprintf(note, sizeof note, "grobo/%s", name);
    snprintf(path, sizeof path, "%s", in_folder(note));
    return path;
}

/* The path of the device's mark there. */
static const char *mark_path(void)
{
    char note[128];

    snprintf(note, sizeof note, "estop-%s", device);
    for (char *c = note; *c != '\0'; c++) {
        *c = *c == '/' ? '!' : *c;
    }
    return note_path(note);
}

static void write_file(const char *path, mode_t mode)
{
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    assert_true(fputs("1-1\n", file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static void make_folder(mode_t mode)
{
    assert_int_equal(mkdir(in_folder("grobo"), 0700), 0);
    assert_int_equal(chmod(in_folder("grobo"), mode), 0);
}

/* ---- what is trusted ---------------------------------------------------------------------- */

TEST_WITH(fixture, a_mark_is_for_the_user_alone)
{
    struct stat st;

    assert_false(grobo_estop_stands(device));
    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    assert_true(grobo_estop_stands(device));
    assert_int_equal(lstat(in_folder("grobo"), &st), 0);
    assert_int_equal(st.st_mode & 07777, 0700);
    assert_int_equal(lstat(mark_path(), &st), 0);
    assert_int_equal(st.st_mode & 07777, 0600);
    assert_int_equal(grobo_estop_clear(device, NULL), GROBO_OK);
    assert_false(grobo_estop_stands(device));
    assert_int_not_equal(lstat(mark_path(), &st), 0);
}

TEST_WITH(fixture, a_file_made_by_hand_counts)
{
    make_folder(0700);
    write_file(mark_path(), 0600);
    assert_true(grobo_estop_stands(device));
}

TEST_WITH(fixture, a_directory_open_to_others_is_not_trusted)
{
    static const mode_t modes[] = {0777, 0770, 0755, 0701};

    make_folder(0700);
    write_file(mark_path(), 0600);
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        assert_int_equal(chmod(in_folder("grobo"), modes[i]), 0);
        assert_false(grobo_estop_stands(device));
    }
    assert_int_equal(chmod(in_folder("grobo"), 0700), 0);
    assert_true(grobo_estop_stands(device));
}

TEST_WITH(fixture, nor_is_a_link_to_a_directory)
{
    make_folder(0700);
    write_file(mark_path(), 0600);
    assert_int_equal(rename(in_folder("grobo"), in_folder("other")), 0);
    assert_int_equal(symlink(in_folder("other"), in_folder("grobo")), 0);
    assert_false(grobo_estop_stands(device));
}

TEST_WITH(fixture, nor_is_a_directory_that_others_can_replace)
{
    make_folder(0700);
    write_file(mark_path(), 0600);
    assert_int_equal(chmod(folder, 0777), 0);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(chmod(folder, 01777), 0); /* as /tmp */
    assert_true(grobo_estop_stands(device));
}

TEST_WITH(fixture, nor_is_a_mark_that_is_a_link_or_open_to_others)
{
    make_folder(0700);
    write_file(in_folder("file"), 0600);
    assert_int_equal(symlink(in_folder("file"), mark_path()), 0);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(unlink(mark_path()), 0);
    write_file(mark_path(), 0666);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(unlink(mark_path()), 0);
    assert_int_equal(mkdir(mark_path(), 0700), 0);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(rmdir(mark_path()), 0);
}

TEST_WITH(fixture, nor_is_what_belongs_to_another_user)
{
    if (geteuid() != 0) {
        print_message("only root can give files away\n");
        skip();
    }
    make_folder(0700);
    write_file(mark_path(), 0600);
    assert_int_equal(chown(mark_path(), NOBODY, NOBODY), 0);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(chown(mark_path(), 0, 0), 0);
    assert_true(grobo_estop_stands(device));
    assert_int_equal(chown(in_folder("grobo"), NOBODY, NOBODY), 0);
    assert_false(grobo_estop_stands(device));
    assert_int_equal(chown(in_folder("grobo"), 0, 0), 0);
}

/* The other directory has it then. */
TEST_WITH(fixture, a_directory_that_cannot_be_had_does_not_keep_a_mark_from_being_set)
{
    struct stat st;

    make_folder(0755);
    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    assert_int_not_equal(lstat(mark_path(), &st), 0);
    assert_true(grobo_estop_stands(device));
}

TEST_WITH(fixture, a_link_in_its_place_is_replaced_and_not_followed)
{
    struct stat st;

    make_folder(0700);
    write_file(in_folder("file"), 0600);
    assert_int_equal(symlink(in_folder("file"), mark_path()), 0);
    assert_int_equal(grobo_estop_set(device, NULL, NULL), GROBO_OK);
    assert_int_equal(stat(in_folder("file"), &st), 0);
    assert_int_equal(st.st_size, 4);
    assert_int_equal(lstat(mark_path(), &st), 0);
    assert_true(S_ISREG(st.st_mode));
}

/* ---- names of a device -------------------------------------------------------------------- */

TEST_WITH(fixture, a_mark_by_one_name_is_one_by_all)
{
    char link[300];
    char other[300];

    snprintf(link, sizeof link, "%s", in_folder("link"));
    snprintf(other, sizeof other, "%s", in_folder("other"));
    write_file(in_folder("node"), 0600);
    assert_int_equal(symlink("node", link), 0);
    assert_int_equal(symlink(link, other), 0);
    assert_int_equal(grobo_estop_set(other, NULL, NULL), GROBO_OK);
    assert_true(grobo_estop_stands(link));
    assert_true(grobo_estop_stands(in_folder("node")));
    assert_int_equal(grobo_estop_clear(in_folder("node"), NULL), GROBO_OK);
    assert_false(grobo_estop_stands(other));
    assert_false(grobo_estop_stands(link));
}

/* The link of a device that is unplugged leads nowhere, and is there again with the device. */
TEST_WITH(fixture, a_missing_device_is_marked_by_its_names)
{
    char link[300];

    snprintf(link, sizeof link, "%s", in_folder("link"));
    assert_int_equal(symlink("node", link), 0);
    assert_int_equal(grobo_estop_set(link, NULL, NULL), GROBO_OK);
    write_file(in_folder("node"), 0600);
    assert_true(grobo_estop_stands(in_folder("node")));
    assert_true(grobo_estop_stands(link));
    assert_int_equal(chdir(folder), 0);
    assert_true(grobo_estop_stands("node"));
    assert_true(grobo_estop_stands("./node"));
    assert_int_equal(grobo_estop_clear("./link", NULL), GROBO_OK);
    assert_int_equal(chdir("/"), 0);
    assert_false(grobo_estop_stands(in_folder("node")));
}

/* ---- processes ---------------------------------------------------------------------------- */

TEST_WITH(fixture, a_stopped_process_is_resumed_if_asked)
{
    grobo_i_process child = {.started = 0};
    int status;

    child.pid = (int)fork();
    if (child.pid == 0) {
        (void)raise(SIGSTOP);
        _exit(7);
    }
    assert_int_equal(waitpid(child.pid, &status, WUNTRACED), child.pid);
    assert_true(WIFSTOPPED(status));
    if (grobo_i_process_look(&child, false) == 0) {
        print_message("this system does not say that a process is stopped\n");
    } else {
        assert_int_equal(grobo_i_process_look(&child, false), 1);
    }
    assert_true(grobo_i_process_look(&child, true) >= 0);
    assert_int_equal(waitpid(child.pid, &status, 0), child.pid);
    assert_int_equal(WEXITSTATUS(status), 7);
    assert_int_equal(grobo_i_process_look(&child, true), GROBO_ERR_NOENT);
}

TEST_WITH(fixture, another_process_with_its_number_is_not_touched)
{
    grobo_i_process self;
    grobo_i_process child;
    int status;

    grobo_i_process_self(&self);
    assert_int_equal(self.pid, getpid());
    assert_int_equal(grobo_i_process_look(&self, true), 0);
    if (self.started == 0) {
        print_message("this system does not say when a process started\n");
        skip();
    }
    child = self;
    child.pid = (int)fork();
    if (child.pid == 0) {
        (void)raise(SIGSTOP);
        _exit(0);
    }
    assert_int_equal(waitpid(child.pid, &status, WUNTRACED), child.pid);
    child.started = self.started - 1;
    assert_int_equal(grobo_i_process_look(&child, true), GROBO_ERR_NOENT);
    assert_int_equal(waitpid(child.pid, &status, WUNTRACED | WNOHANG | WCONTINUED), 0);
    assert_int_equal(kill(child.pid, SIGKILL), 0);
    assert_int_equal(waitpid(child.pid, &status, 0), child.pid);
}

/* ---- changes ------------------------------------------------------------------------------ */

TEST_WITH(fixture, a_watch_tells_of_marks_and_of_nothing_else)
{
    grobo_os_cause cause;
    grobo_socket watch = grobo_i_note_watch_open();
    grobo_estop stop;

    if (watch == GROBO_SOCKET_NULL) {
        skip(); /* another system than Linux, or a directory of the network */
    }
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-/"), NOTE_NEWS_NONE);
    assert_true(grobo_i_note_write("holder-x", "1 1\n", &cause) > 0);
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-"), NOTE_NEWS_NONE);
    assert_int_equal(grobo_i_note_remove("holder-x", &cause), GROBO_OK);
    assert_int_equal(grobo_estop_set(device, &stop, NULL), GROBO_OK);
    assert_int_equal(grobo_port_wait(watch, GROBO_PORT_READABLE, 0), GROBO_PORT_READABLE);
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-!nowhere"), NOTE_NEWS_NOTE);
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-!nowhere"), NOTE_NEWS_NONE);
    assert_int_equal(chmod(mark_path(), 0644), 0);
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-!nowhere"), NOTE_NEWS_NOTE);
    assert_int_equal(grobo_estop_clear(device, NULL), GROBO_OK);
    assert_int_equal(grobo_i_note_watch_read(watch, "estop-!nowhere"), NOTE_NEWS_NOTE);
    grobo_i_note_watch_close(watch);
}

TEST_WITH(fixture, a_watch_tells_that_a_directory_is_another_one)
{
    static const char *const become[] = {"rm -rf '%s'", "mv '%s' '%s.old'", "chmod 755 '%s'"};
    char command[1300];

    for (size_t i = 0; i < sizeof become / sizeof become[0]; i++) {
        char path[600];
        grobo_socket watch = grobo_i_note_watch_open();

        if (watch == GROBO_SOCKET_NULL) {
            skip();
        }
        snprintf(path, sizeof path, "%s", in_folder("grobo"));
        snprintf(command, sizeof command, become[i], path, path);
        assert_int_equal(system(command), 0);
        assert_int_equal(grobo_i_note_watch_read(watch, "estop-"), NOTE_NEWS_GONE);
        grobo_i_note_watch_close(watch);
    }
    /* The last one left a directory that others may look into: nothing is watched by halves. */
    assert_int_equal(grobo_i_note_watch_open(), GROBO_SOCKET_NULL);
}

TEST_WITH(fixture, no_watch_by_halves)
{
    assert_int_equal(setenv("XDG_RUNTIME_DIR", in_folder("not there"), 1), 0);
    assert_int_equal(grobo_i_note_watch_open(), GROBO_SOCKET_NULL);
    assert_int_equal(unsetenv("XDG_RUNTIME_DIR"), 0); /* there is none, and there will be none */
    grobo_i_note_watch_close(grobo_i_note_watch_open());
}
