#!/bin/sh
# SPDX-License-Identifier: MIT
# The classic shelf beside the original library.
#
# With the sources of the original (https://github.com/n-ando/g-robot) in $GROBO_ORIGINAL, they are
# compiled with the statements of tests/link/test_classic_*.c and run against a simulated robot:
# what they send and give is what tests/support/classic_original.h says. It takes two minutes.
# MEASURED=FILE keeps what was measured. Without the sources that is left out; these tests
# compare with the header.
. tests/support/tap.sh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
build=${BUILD:-build}
programs="$build/tests/link/test_classic_data $build/tests/link/test_classic_frames"
original=${GROBO_ORIGINAL:-}

# of_each OPTION...: what the two tests print.
of_each() {
    for program in $programs; do
        "$program" "$@" || return 1
    done
}

# The sources are Windows' first, and older than C++11.
compile() {
    : >"$work/tchar.h"
    ${CXX:-g++} -w -fpermissive -std=gnu++98 '-D__declspec(x)=' -DGR001_EXPORTS -I"$work" \
        -I"$original/libgrobot/include" -I. -include strstream -include map -include string \
        -include stdexcept "$@"
}

# The program: what stands around the statements, and they.
program() {
    cat <<'END'
#include <fstream>
#include <sstream>
#include <GR001/stdafx.h>
#include <GR001/GROBO.h>
#include "tests/support/frame_words.h"

static GR001 *g;
static RobotPosture *p, *q;
static RobotMotion *m;
static std::string folder;
static bool held;

extern "C" ssize_t __real_write(int fd, const void *bytes, size_t size);
extern "C" ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
    if (fd > 2) words_bytes((const uint8_t *)bytes, size);
    return __real_write(fd, bytes, size);
}
static const char *in_folder(const char *name)
{
    static char path[4][512];
    static int n;
    char *to = path[n++ & 3];
    snprintf(to, sizeof path[0], "%s%s%s", folder.c_str(), *name ? "/" : "", name);
    return to;
}
static void say(double value) { frame_words_say(value); }
static void say_posture(RobotPosture *x)
{
    for (int id = 1; x && id <= 20; id++) say(x->getDegree(id));
}
static void say_motion(RobotMotion *x)
{
    for (int i = 0; i < x->getSize(); i++) {
        say(x->get(i)->motionTime);
        say_posture(x->get(i));
    }
}
static void say_file(const char *name)
{
    std::ifstream file(name);
    std::stringstream text;
    text << file.rdbuf();
    frame_words_say_text(file.fail() ? "no file" : text.str().c_str());
}
/* Its thread sleeps between two frames. */
static void go()
{
    usleep(20000);
    while (g->isMoving()) usleep(2000);
    usleep(450000);
}
static void go_on() { usleep(600000); }
/* Its thread reads meanwhile, and takes the replies: it waits for the motion. */
static void quiet()
{
    pthread_mutex_lock(&g->mutex_motion);
    held = true;
    usleep(5000);
}
static void run(const char *name, void (*statement)())
{
    for (int i = 1; i <= 20; i++) g->targetPosture->setDegree(i, 0);
    g->setServo(1, 0);
    g->setMotionTime(200);
    g->startMotion();
    go();
    g->motion->motion.clear();
    p = new RobotPosture(20);
    q = new RobotPosture(20);
    m = new RobotMotion();
    m->setJoints(20);
    p->setMotionTime(100);
    q->setMotionTime(100);
    words_begin();
    try {
        statement();
    } catch (...) {
        frame_words_say_text("throws");
    }
    if (held) pthread_mutex_unlock(&g->mutex_motion);
    held = false;
    FILE *out = fopen(in_folder("measured"), "a");
    fprintf(out, "%s\t", name);
    for (const char *told = words_told(); *told; told++) {
        if (*told == '\n') fputs("\\n", out);
        else fputc(*told, out);
    }
    fputc('\n', out);
    fclose(out);
}
END
    of_each --cxx | awk -F '\t' '
        {
            print "static void s_" $1 "() { " $2 " }"
            calls = calls "    run(\"" $1 "\", s_" $1 ");\n"
        }
        END {
            print "int main(int, char **argv)\n{\n    folder = argv[2];"
            print "    g = new GR001(argv[1]);"
            print "    g->setFreeMotion(0);\n    if (g->connect() < 0) return 1;"
            print "    g->startThread();\n    g->setMotionDir(argv[2]);\n    g->setServo(1, 0);"
            print calls "    _exit(0);\n}"
        }'
}

builds() {
    program >"$work/program.cpp" &&
        ${CC:-cc} -I. -D_XOPEN_SOURCE=700 -c -o "$work/words.o" tests/support/frame_words.c &&
        for name in CUtils SerialPort SerialRobot GROBO YamlParser; do
            compile -c -o "$work/$name.o" "$original/libgrobot/src/$name.cpp" || return 1
        done && compile -o "$work/program" "$work/program.cpp" "$work"/*.o -Wl,--wrap=write -lyaml \
        -lpthread
}

# It looks for a file whose name has a dot more, which Windows does not see.
measures() {
    mkdir "$work/folder" && of_each --files "$work/folder" || return 1
    for name in a.m a.mseq a.pseq a.yaml; do
        : >"$work/folder/$name."
    done
    "$build/grctl" --physics off sim --link "$work/robot" --start zero --no-pacing \
        </dev/null >/dev/null 2>&1 &
    sim=$!
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        [ ! -e "$work/robot" ] || break
        sleep 0.5
    done
    "$work/program" "$work/robot" "$work/folder" 2>/dev/null >&2
    ended=$?
    { kill "$sim" && wait "$sim"; } 2>/dev/null # a child of this step, which is a process
    [ $ended -eq 0 ] && cp "$work/folder/measured" "${MEASURED:-$work/kept}"
}

as_kept() {
    of_each --original >"$work/original" && diff "$work/original" "$work/folder/measured"
}

test_case 'the original sends what is kept'
if [ ! -d "$original/libgrobot" ]; then
    skip 'it is measured' 'no sources of the original: GROBO_ORIGINAL is not set'
elif [ -n "${CROSS:-}" ]; then
    skip 'it is measured' 'the same for all machines'
else
    check 'it is built' builds
    check 'it is measured' measures
    check 'it sends what classic_original.h says' as_kept
fi
done_testing
