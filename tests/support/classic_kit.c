/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/classic_kit.h"
#include "tests/support/classic_original.h"

GR001 *g;
RobotPosture *p, *q;
RobotMotion *m;

/* ---- files ---------------------------------------- */

static bool write_files(const char *directory)
{
    static const char *const files[][2] = {{"a.m", CLASSIC_FILE_M},
                                           {"a.mseq", CLASSIC_FILE_MSEQ},
                                           {"a.pseq", CLASSIC_FILE_PSEQ},
                                           {"a.yaml", CLASSIC_FILE_YAML}};
    char path[512];
    bool written = true;

    for (size_t i = 0; written && i < sizeof files / sizeof files[0]; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", directory, files[i][0]);
        FILE *file = fopen(path, "w");
        written = file != NULL && fputs(files[i][1], file) >= 0;
        written = file != NULL && fclose(file) == 0 && written;
    }
    return written;
}

void classic_make_files(void)
{
    (void)folder_set_up();
    assert_true(write_files(folder));
}

void classic_remove_files(void)
{
    static const char *const files[] = {"a.m", "a.mseq",    "a.pseq", "a.yaml",
                                        "b.m", "Motion0.m", "c0.m",   "c1.m"};

    folder_remove(files, sizeof files / sizeof files[0]);
}

/* ---- what statements say ---------------------------------------- */

void say(double value)
{
    frame_words_say(value);
}

void say_file(const char *path)
{
    char text[4096];
    FILE *file = fopen(path, "r");
    size_t length = file != NULL ? fread(text, 1, sizeof text - 1, file) : 0;

    text[length] = '\0';
    frame_words_say_text(file != NULL ? text : "no file");
    if (file != NULL) {
        fclose(file);
    }
}

void say_posture(const RobotPosture *posture)
{
    for (int id = 1; posture != NULL && id <= 20; id++) {
        say(RobotPosture_getDegree(posture, id));
    }
}

void say_motion(const RobotMotion *motion)
{
    for (int i = 0; i < RobotMotion_getSize(motion); i++) {
        say(RobotMotion_get(motion, i)->motionTime);
        say_posture(RobotMotion_get(motion, i));
    }
}

/* ---- judging ---------------------------------------- */

/* What the original sends and gives for a statement; NULL: it was not measured. */
static const char *original_of(const char *name)
{
    for (size_t i = 0; i < sizeof classic_original / sizeof classic_original[0]; i++) {
        if (strcmp(classic_original[i].name, name) == 0) {
            return classic_original[i].told;
        }
    }
    return NULL;
}

void classic_begin(void)
{
    p = RobotPosture_new(20);
    q = RobotPosture_new(20);
    m = RobotMotion_new();
    assert_true(p != NULL && q != NULL && m != NULL);
    assert_int_equal(RobotMotion_setJoints(m, 20), 20);
    (void)RobotPosture_setMotionTime(p, 100);
    (void)RobotPosture_setMotionTime(q, 100);
    words_begin();
}

/* The same, but that a frame of a motion that is played may have less time: it left late. */
static bool alike(const char *told, const char *original, bool played)
{
    while (*told != '\0' && *original != '\0') {
        bool timed = played && strncmp(told, " in ", 4) == 0 && strncmp(original, " in ", 4) == 0;
        if (timed) {
            char *told_end;
            char *original_end;
            if (strtol(told + 4, &told_end, 10) > strtol(original + 4, &original_end, 10)) {
                return false;
            }
            told = told_end;
            original = original_end;
        } else if (*told++ != *original++) {
            return false;
        }
    }
    return *told == *original;
}

static void compare(const statement *row, const char *told, const char *original)
{
    bool played = strncmp(row->name, "SR60", 4) == 0 || strncmp(row->name, "GR35", 4) == 0;

    assert_non_null(original);
    if (row->ours != NULL && strcmp(row->ours, "torque") == 0) {
        /* More frames leave: torque ends as there. */
        assert_non_null(strstr(told, "torque"));
        assert_string_equal(strstr(told, "torque"), original);
    } else if (row->ours != NULL) {
        if (!alike(told, row->ours, played)) {
            assert_string_equal(told, row->ours);
        }
        assert_string_not_equal(told, original);
        assert_non_null(row->why);
    } else if (!alike(told, original, played)) {
        assert_string_equal(told, original);
    }
}

void classic_judge(const statement *row)
{
    row->run();
    if (SerialRobot_isActive(g)) {
        (void)SerialRobot_getAngle(g, 1); /* when it is answered, all before has come */
    }
    const char *told = words_told();
    RobotPosture_delete(p);
    RobotPosture_delete(q);
    RobotMotion_delete(m);
    compare(row, told, original_of(row->name));
}

/* ---- the program ---------------------------------------- */

/* A text in one line. */
static void print_line(const char *name, const char *text)
{
    printf("%s\t", name);
    for (; text != NULL && *text != '\0'; text++) {
        if (*text == '\n') {
            fputs("\\n", stdout);
        } else {
            putchar(*text);
        }
    }
    putchar('\n');
}

int classic_main(int argc, char **argv, const statement *statements, size_t n)
{
    if (argc == 3 && strcmp(argv[1], "--files") == 0) {
        return write_files(argv[2]) ? 0 : 1;
    }
    bool cxx = argc == 2 && strcmp(argv[1], "--cxx") == 0;
    if (!cxx && (argc != 2 || strcmp(argv[1], "--original") != 0)) {
        return test_main(argc, argv);
    }
    for (size_t i = 0; i < n; i++) {
        print_line(statements[i].name, cxx ? statements[i].cxx : original_of(statements[i].name));
    }
    return 0;
}
