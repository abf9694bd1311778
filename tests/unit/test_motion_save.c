/* SPDX-License-Identifier: MIT */
/* Saving motions, and finding them in a directory, through the port's files. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <grobo/core/motion.h>

#include "tests/support/files.h"
#include "tests/support/folder.h"
#include "tests/support/motion_texts.h"
#include "tests/support/os.h"
#include "tests/support/tables.h"
#include "tests/support/test.h"

static const char saved[] = "500  10 -20\n1000  1 2\n";
static const grobo_write_options in_motor_order = {GROBO_WRITE_OPTIONS_INIT,
                                                   .model = &grobo_i_gr001_model};

static int remove_folder(void)
{
    static const char *const names[] = {"a.m",       "b.m",    "Motion1.m", "Motion2.m",
                                        "Motion3.m", "walk.m", "walk.pseq", "walk.yaml",
                                        "walk.mseq", "c.pseq", "c.yaml"};

    (void)remove(in_folder("sub/c.yaml"));
    (void)test_folder_remove(in_folder("sub"));
    /* Fails if a temporary file was left behind. */
    folder_remove(names, sizeof names / sizeof names[0]);
    return 0;
}

/* The file read again for a model, which must give what was saved. */
static grobo_motion *again_as(const char *path, const grobo_model *model, const grobo_motion *same)
{
    const grobo_read_options options = {GROBO_READ_OPTIONS_INIT, .model = model};
    grobo_motion *again = NULL;

    assert_int_equal(grobo_motion_read_file(path, &options, NULL, &again), 0);
    assert_true(same == NULL || grobo_motion_equal(same, again));
    return again;
}

TEST(test_save)
{
    grobo_motion *motion = motion_of(saved, GROBO_FORMAT_M);
    const char *path = in_folder("a.m");
    grobo_model short_model = grobo_i_gr001_model;

    short_model.n_joints = 15; /* to motor 3 */
    for (int i = 0; i < 2; i++) {
        put_file(path, i == 0 ? "" : "1 2 3\n# longer than what comes in its place\n");
        assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, &in_motor_order, NULL),
                         0);
        assert_file(path, saved);
    }
    grobo_motion_free(again_as(path, &grobo_i_gr001_model, motion));
    grobo_motion *two = again_as(path, &short_model, NULL);
    assert_int_equal(grobo_motion_joints(two), short_model.n_joints);
    grobo_motion_free(two);
    grobo_motion_free(motion);
}

/* The name tells the format, and what is read again is what was saved. */
TEST(test_save_formats)
{
    static const struct {
        const char *name, *text, *type;
        grobo_motion_format format;
    } rows[] = {
        {"c.pseq",
         "type: PoseSeq\nname: a\nrefs:\n  - time: 1\n    refer:\n      type: Pose\n"
         "      joints: [ 0, 1 ]\n      q: [ 0.5, -0.25 ]\n",
         "PoseSeq", GROBO_FORMAT_PSEQ},
        {"c.yaml",
         "type: BodyMotion\ncomponents:\n  - type: MultiValueSeq\n    purpose: JointPosition\n"
         "    frameRate: 20\n    numFrames: 2\n    numParts: 2\n"
         "    frames: [ [ 0, 1 ], [ 0.5, -0.25 ] ]\n",
         "BodyMotion", GROBO_FORMAT_YAML},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const char *path = in_folder(rows[i].name);
        grobo_motion *motion = motion_of(rows[i].text, rows[i].format);
        char begins[128] = "";
        assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, NULL, NULL), 0);
        grobo_motion_free(again_as(path, NULL, motion));
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        assert_true(fread(begins, 1, sizeof begins - 1, file) > 0);
        assert_int_equal(fclose(file), 0);
        assert_non_null(strstr(begins, rows[i].type));
        grobo_motion_free(motion);
    }
}

TEST(test_save_refused)
{
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
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

TEST(test_save_never_destroys)
{
    grobo_motion *motion = motion_of(saved, GROBO_FORMAT_M);
    real_files = grobo_files_os();
    grobo_files files = *real_files;
    const char *path = in_folder("b.m");

    files.write = few_writes;
    put_file(path, "100 1 2\n");
    writes_left = 0;
    assert_int_equal(grobo_motion_save(motion, &files, path, NULL, NULL), GROBO_ERR_IO);
    assert_file(path, "100 1 2\n");
    grobo_motion_free(motion);
}

/* Whatever the names say, what a file holds decides; `replace` takes anything. */
TEST(test_save_keeps_other_formats)
{
    static const char *const held[] = {
        "100 1 2\n",
        ("type: PoseSeq\nname: a\nrefs:\n  - time: 1\n    refer:\n      type: Pose\n"
         "      joints: [ 0 ]\n      q: [ 0.5 ]\n"),
        "function y = f(x)\ny = x;\n",
    };
    static const grobo_motion_format formats[] = {GROBO_FORMAT_M, GROBO_FORMAT_PSEQ,
                                                  GROBO_FORMAT_MSEQ, GROBO_FORMAT_YAML};
    grobo_motion *motion = motion_of(saved, GROBO_FORMAT_M);
    const char *path = in_folder("a.m");
    grobo_diagnostics *list = NULL;

    assert_int_equal(grobo_diagnostics_new(NULL, &list), 0);
    for (int h = 0; h < 3; h++) {
        for (int f = 0; f < 4; f++) {
            grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model,
                                           .format = formats[f]};
            int wanted = h == f && h < 2 ? 0 : GROBO_ERR_EXISTS;
            put_file(path, held[h]);
            assert_int_equal(grobo_motion_may_save(grobo_files_os(), path, formats[f]), wanted);
            grobo_diagnostics_clear(list);
            assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, &options, list),
                             wanted);
            if (wanted < 0) {
                assert_file(path, held[h]);
                assert_int_equal(grobo_diagnostics_total(list, GROBO_SEVERITY_ERROR), 1);
            }
            options.replace = true;
            assert_int_equal(grobo_motion_save(motion, grobo_files_os(), path, &options, list), 0);
            assert_int_equal(grobo_motion_may_save(grobo_files_os(), path, formats[f]), 0);
        }
    }
    assert_int_equal(grobo_motion_may_save(grobo_files_os(), in_folder("none"), GROBO_FORMAT_M), 0);
    assert_int_equal(grobo_motion_may_save(grobo_files_os(), folder, GROBO_FORMAT_M), 0);
    assert_int_equal(grobo_motion_may_save(grobo_files_os(), path, GROBO_FORMAT_AUTO),
                     GROBO_ERR_ARG);
    grobo_diagnostics_free(list);
    grobo_motion_free(motion);
}

TEST(test_save_next)
{
    grobo_motion *motion = motion_of("500  10\n", GROBO_FORMAT_M);
    grobo_write_options options = {GROBO_WRITE_OPTIONS_INIT, .model = &grobo_i_gr001_model};
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

/* The system may have spelt the path anew. */
static const char *last_name(const char *path)
{
    const char *last = path;

    for (const char *c = path; *c != '\0'; c++) {
        last = *c == '/' || *c == '\\' ? c + 1 : last;
    }
    return last;
}

TEST(test_find)
{
    const grobo_files *files = grobo_files_os();
    char path[4096] = "untouched";

    assert_int_equal(test_folder_make(in_folder("sub")), 0);
    put_file(in_folder("sub/c.yaml"), "");
    static const char *const found[] = {"walk.mseq", "walk.pseq", "walk.yaml", "walk.m"};
    for (size_t i = 0; i < 4; i++) { /* each goes before those there were */
        put_file(in_folder(found[i]), "");
        assert_int_equal(grobo_motion_find(files, folder, "walk", path, sizeof path), 0);
        assert_string_equal(last_name(path), found[i]);
    }
    assert_int_equal(grobo_motion_find(files, folder, "walk.pseq", path, sizeof path), 0);
    assert_string_equal(last_name(path), "walk.pseq");
    assert_int_equal(grobo_motion_find(files, folder, "sub/c", path, sizeof path), 0);
    static const char *const outside[] = {
        "/etc/passwd", "..", "../x", "sub/../../x", "sub/..", "", "\\x", "c:x", "a/../b"};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        assert_int_equal(grobo_motion_find(files, folder, outside[i], path, sizeof path),
                         GROBO_ERR_OUTSIDE);
    }
    assert_int_equal(grobo_motion_find(files, folder, "nothing", path, sizeof path),
                     GROBO_ERR_NOENT);
    assert_int_equal(grobo_motion_find(files, folder, "walk", path, 3), GROBO_ERR_SPACE);
}

TESTS_BETWEEN(folder_set_up, remove_folder)
