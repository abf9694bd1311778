#!/bin/sh
# SPDX-License-Identifier: MIT
# A gate that never fails is none: each is fed a sample that breaks its rule and must name the line,
# and a sample that keeps it and must pass.
set -u

. tests/support/tap.sh
gates=$(pwd)/tools/lint
cc=${CC:-gcc}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# sample PATH: writes standard input to a fresh tree that holds nothing else, and goes there.
fresh() {
    rm -rf "$work/tree"
    mkdir -p "$work/tree"
    cd "$work/tree" || exit 1
}

sample() {
    mkdir -p "$(dirname "$1")"
    cat >"$1"
}

scan() {
    rules=$1
    shift
    awk -f "$gates/strip.awk" -f "$gates/$rules.awk" "$@"
}

# refuses TEXT COMMAND...: the command fails and says TEXT.
refuses() {
    expected=$1
    shift
    if "$@" >"$work/said" 2>&1; then
        echo "passed, but should have said: $expected"
        return 1
    fi
    grep -Fq -- "$expected" "$work/said" && return
    echo "expected: $expected"
    cat "$work/said"
    return 1
}

# compile SOURCE: to where the build puts its object.
compile() {
    mkdir -p "build/$(dirname "$1")"
    $cc -std=c11 -O2 ${2:-} -c -o "build/${1%.c}.o" "$1"
}

test_case "lang"

# speaks TEXT TRANSLATION [CODE]: a tree whose one message has that translation.
speaks() {
    fresh
    mkdir -p tools/grctl/lang include/grobo src/robot src/play
    cp "$gates"/../grctl/lang/*.awk tools/grctl/lang
    grep -v '^also ' "$gates/../grctl/lang/rules.txt" >tools/grctl/lang/rules.txt
    : >include/grobo/error.h
    : >src/robot/trip.c
    : >src/play/names.c
    sample tools/grctl/a.h <<C
#define KEYS "  q   end\\n"
C
    sample tools/grctl/b.c <<C
    app_fail(a, 1, "ARG", $1, name);
    ${3:-}
C
    sample tools/grctl/lang/ja.po <<PO
msgid ""
msgstr ""
"Language: ja\\n"

msgid "%s: no\\n  q   end\\n"
msgstr "$2"
PO
    sh "$gates/lang.sh"
}
right='"%s: no\n" KEYS'
check 'lang: a translation fits' speaks "$right" '%s: いいえ\n  q   終わり\n'
check 'lang: a text is missing' refuses 'ja.po:1: lang: missing, of tools/grctl/b.c: "yes"' \
    speaks '"yes"' '%s\n'
check 'lang: and what to do' refuses "'make messages' adds" speaks '"yes"' '%s\n'
check 'lang: a text is left over' refuses 'ja.po:5: lang: no longer in the sources: "%s: no' \
    speaks '"yes"' '%s\n'
check 'lang: an empty one' refuses 'ja.po:5: lang: not translated' speaks "$right" ''
check 'lang: another conversion' refuses 'lang: other conversions than %s' speaks "$right" '%d\n'
check 'lang: one too many' refuses 'lang: other conversions' speaks "$right" '%s%s\n'
check 'lang: one that prints nothing is one' speaks "$right" '%.0sいいえ\n'
check 'lang: the last newline' refuses 'lang: one text ends with a newline' speaks "$right" '%s'
check 'lang: an escape' refuses 'lang: an escape other than' speaks "$right" '%s\033\n'
check 'lang: a sentence without a mark' \
    refuses 'b.c:2: lang: "a sentence here" (puts#1) is not translated: mark it' \
    speaks "$right" '%s\n' 'puts("a sentence here");'
check 'lang: a word of a message' refuses 'b.c:2: lang: "left" (app_note#3) is not translated' \
    speaks "$right" '%s\n' 'app_note(a, "%s", x ? "left" : n);'
check 'lang: JSON is kept' speaks "$right" '%s\n' 'json_pack("{s:s}", "a sentence here", x);'
renewed() {
    speaks '"yes"' '%s\n' >/dev/null
    sh "$gates/lang.sh" --update || return 1
    grep -q '^msgid "yes"$' tools/grctl/lang/ja.po &&
        grep -q '^#~ msgstr "%s\\n"$' tools/grctl/lang/ja.po &&
        refuses 'not translated: "yes"' sh "$gates/lang.sh" &&
        refuses 'the sources lost this text' sh "$gates/lang.sh"
}
check 'lang: a catalogue is made anew' renewed

test_case "layers"

fresh
sample src/bus/a.c <<'C'
#include <math.h>
#include <string.h>
double grobo_a(double *p, const double *q, double x);
double grobo_a(double *p, const double *q, double x)
{
    memcpy(p, q, 3000);
    return sin(x) + atan2(x, 2.0) + hypot(x, 3.0);
}
C
compile src/bus/a.c
check 'layers: the core may use mem* and math' sh "$gates/layers.sh" build
sample src/bus/b.c <<'C'
#include <stdlib.h>
void *grobo_b(void);
void *grobo_b(void)
{
    return malloc(3);
}
C
compile src/bus/b.c
check 'layers: the core may not use malloc' \
    refuses 'src/bus/b.c:1: layers: src/bus may not use malloc' sh "$gates/layers.sh" build

fresh
sample src/bus/a.c <<'C'
int grobo_i_link(void);
int grobo_a(void);
int grobo_a(void)
{
    return grobo_i_link();
}
C
sample src/robot/b.c <<'C'
int grobo_i_link(void);
int grobo_i_link(void)
{
    return 0;
}
C
sample src/robot/c.c <<'C'
int grobo_a(void);
int grobo_c(void);
int grobo_c(void)
{
    return grobo_a();
}
C
compile src/bus/a.c
compile src/robot/b.c
compile src/robot/c.c
check 'layers: a layer does not reach up' \
    refuses 'src/bus/a.c:1: layers: grobo_i_link comes from src/robot' sh "$gates/layers.sh" build
rm build/src/bus/a.o
sample src/bus/a.c <<'C'
int grobo_a(void);
int grobo_a(void)
{
    return 1;
}
C
compile src/bus/a.c
check 'layers: a layer may reach down' sh "$gates/layers.sh" build

# calls FILE MINE YOURS: a file that has one function and calls another.
calls() {
    printf 'int %s(void);\nint %s(void);\nint %s(void)\n{\n    return %s();\n}\n' \
        "$2" "$3" "$2" "$3" | sample "$1"
    compile "$1"
}
fresh
calls src/robot/a.c grobo_a grobo_b
calls src/robot/b.c grobo_b grobo_c
calls src/robot/c.c grobo_c grobo_a
check 'layers: files in a circle' \
    refuses 'src/robot/b.c:1: layers: in a circle of files' sh "$gates/layers.sh" build
fresh
calls src/robot/a.c grobo_a grobo_b
calls src/bus/b.c grobo_b grobo_c
sample src/robot/c.c <<'C'
int grobo_c(void);
int grobo_c(void)
{
    return 1;
}
C
compile src/robot/c.c
check 'layers: folders in a circle' \
    refuses 'src/bus:1: layers: in a circle of folders' sh "$gates/layers.sh" build

# The files of a family's folder are judged by their names.
fresh
printf 'FAMILY(one, first)\nFAMILY(two, second)\n' | sample src/servo/families.list
calls src/base/nothing.c grobo_nothing grobo_nothing
calls src/servo/first/driver.c grobo_driver_of_first grobo_nothing
calls src/servo/first/sim.c grobo_sim_of_first grobo_driver_of_first
check 'layers: the simulated servo may use its family' sh "$gates/layers.sh" build
calls src/servo/first/driver.c grobo_driver_of_first grobo_sim_of_second
calls src/servo/second/sim.c grobo_sim_of_second grobo_nothing
check 'layers: a driver may not use a simulated servo' \
    refuses 'driver.c:1: layers: grobo_sim_of_second comes from src/servo/second/sim' \
    sh "$gates/layers.sh" build
calls src/servo/first/driver.c grobo_driver_of_first grobo_nothing
calls src/servo/first/sim_more.c grobo_sim_of_first grobo_driver_of_second
rm build/src/servo/first/sim.o
calls src/servo/second/driver.c grobo_driver_of_second grobo_nothing
check 'layers: a family may not use another one' \
    refuses 'src/servo/first/sim_more.c:1: layers: grobo_driver_of_second comes from' \
    sh "$gates/layers.sh" build

fresh
sample src/motion/text/a.c <<'C'
#include <stdio.h>
int grobo_a(void);
int grobo_a(void)
{
    return printf("%d\n", 3);
}
C
compile src/motion/text/a.c
check 'layers: the library does not print' \
    refuses 'src/motion/text/a.c:1: layers: src/motion/text may not use printf' \
    sh "$gates/layers.sh" build

fresh
sample include/grobo/a.h <<'C'
GROBO_API int grobo_a(void);
C
sample tools/grctl/main.c <<'C'
int grobo_a(void);
int grobo_i_secret(void);
int main(void)
{
    return grobo_a() + grobo_i_secret();
}
C
compile tools/grctl/main.c
check 'layers: grctl is a user like any other' \
    refuses 'not a public function: grobo_i_secret' sh "$gates/layers.sh" build

fresh
sample src/bus/a.c <<'C'
#include <string.h>
void grobo_a(char *p, const char *q, size_t n);
void grobo_a(char *p, const char *q, size_t n)
{
    char text[20];
    memcpy(text, q, n);
    memcpy(p, text, sizeof text);
}
C
compile src/bus/a.c '-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2'
check 'layers: a fortified memcpy is a memcpy' sh "$gates/layers.sh" build

test_case "symbols"

fresh
sample include/grobo/a.h <<'C'
GROBO_API int grobo_a(int x,
                      int (*f)(int));
/** A word about grobo_other(). */
GROBO_API const char *grobo_text(void) __attribute__((format(printf, 1, 2)));
typedef int (*grobo_fn)(void);
C
sample lib.c <<'C'
int grobo_a(void) { return 0; }
int grobo_text(void) { return 0; }
C
$cc -shared -fPIC -o good.so lib.c
check 'symbols: what headers declare' sh "$gates/symbols.sh" good.so
{ cat lib.c; echo 'const int grobo_text = 3;'; } | grep -v 'int grobo_text(' >data.c
$cc -shared -fPIC -o data.so data.c
check 'symbols: data is reached by a function' \
    refuses 'exports data, grobo_text' sh "$gates/symbols.sh" data.so
echo 'int grobo_extra(void) { return 0; }' >>lib.c
$cc -shared -fPIC -o extra.so lib.c
check 'symbols: an export that no header declares' \
    refuses 'exports grobo_extra' sh "$gates/symbols.sh" extra.so
echo 'int grobo_a(void) { return 0; }' >lib.c
$cc -shared -fPIC -o less.so lib.c
check 'symbols: a declaration that nobody defines' \
    refuses 'include/grobo/a.h:1: symbols: declares grobo_text' sh "$gates/symbols.sh" less.so
echo 'int helper(void) { return 0; }' >>lib.c
$cc -shared -fPIC -o alien.so lib.c
check 'symbols: a name without grobo_' \
    refuses 'helper does not begin with grobo_' sh "$gates/symbols.sh" alien.so

test_case "null"

fresh
sample include/grobo/a.h <<'C'
GROBO_API int grobo_a(int x,
                      const char *text);
GROBO_API int grobo_number(int x);
C
sample tests/unit/test_null.c <<'C'
static void refuse(void)
{
    assert_int_equal(grobo_a(1,
                             NULL),
                     GROBO_ERR_ARG);
}
C
check 'null: each that takes a pointer is tried' sh "$gates/null.sh"
echo 'GROBO_API void grobo_b(double at[3]);' >>include/grobo/a.h
check 'null: one that nobody tried' \
    refuses 'include/grobo/a.h:1: null: no tests/*/test_null*.c gives NULL to grobo_b' \
    sh "$gates/null.sh"
echo '/* grobo_b() takes NULL: all zero. */' >>tests/unit/test_null.c
check 'null: one that takes it' sh "$gates/null.sh"
echo 'GROBO_API void grobo_c(grobo_c_fn fn);' >>include/grobo/a.h
check 'null: a function is a pointer' refuses 'to grobo_c' sh "$gates/null.sh"

test_case "headers"

fresh
sample include/grobo/a.h <<'C'
#include <stdint.h>
static inline int64_t grobo_a(void) { return 0; }
C
check 'headers: one that compiles alone' sh "$gates/headers.sh"
sample include/grobo/a.h <<'C'
int64_t grobo_a(void);
C
check 'headers: one that lacks an include' \
    refuses 'include/grobo/a.h:1: headers: does not compile alone as C11' sh "$gates/headers.sh"
sample include/grobo/a.h <<'C'
int grobo_a(int class);
C
if command -v "${CXX:-g++}" >/dev/null; then
    check 'headers: one that C++ does not take' refuses 'alone as C++11' sh "$gates/headers.sh"
else
    skip 'headers: one that C++ does not take' 'no C++ compiler'
fi
sample include/grobo/grobo.h <<'C'
#include <stdint.h>
C
check 'headers: an umbrella with a hole' \
    refuses 'grobo.h:1: headers: does not include <grobo/a.h>' sh "$gates/headers.sh"
sample include/grobo/grobo.h <<'C'
#include <grobo/a.h>
C
sample include/grobo/core/b.h <<'C'
int grobo_b(int class);
C
sed 's/class/x/' include/grobo/core/b.h >include/grobo/a.h
if command -v "${CXX:-g++}" >/dev/null; then
    check 'headers: one of the core too' \
        refuses 'core/b.h:1: headers: does not compile alone as C++11' sh "$gates/headers.sh"
else
    skip 'headers: one of the core too' 'no C++ compiler'
fi
rm -r include/grobo/core
i=0
while [ $i -lt 201 ]; do
    echo "GROBO_API int grobo_number_$i(void);"
    i=$((i + 1))
done >include/grobo/functions
{ echo '#define GROBO_API' && sed 200q include/grobo/functions; } >include/grobo/a.h
check 'headers: a main shelf of 200 functions' sh "$gates/headers.sh"
{ echo '#define GROBO_API' && cat include/grobo/functions; } >include/grobo/a.h
check 'headers: one more' refuses '201 functions and 203 lines on the main shelf' \
    sh "$gates/headers.sh"
rm include/grobo/a.h include/grobo/grobo.h include/grobo/functions
sample src/bus/private.h <<'C'
struct a { size_t n; };
C
check 'headers: a private one' \
    refuses 'src/bus/private.h:1: headers' sh "$gates/headers.sh"

test_case "seed map"

# A map whose 190 rows are alike, a header and a test that bear it out.
seed_rows() {
    awk 'BEGIN {
        n = split("SC 22 FN 3 RP 20 RM 29 SR 73 GR 43", part, " ")
        for (i = 1; i < n; i += 2) {
            for (k = 1; k <= part[i + 1]; k++) {
                printf "| %s%02d | x | `grobo_a`, `grobo_b.size` | ", part[i], k
                print "a note | `unit/test_a.c:works` |"
            }
        }
    }'
}

fresh
GROBO_SHARED=$work/tree/shared
export GROBO_SHARED
mkdir -p docs
sample include/grobo/a.h <<'C'
/** Not grobo_told() in a comment. */
typedef struct grobo_b {
    struct {
        int depth_m; /**< deep */
    } inner;
    int size; /**< of it */
} grobo_b;
int grobo_a(void);
C
sample tests/unit/test_a.c <<'C'
TEST_WITH(line, works)
{
    assert_int_equal(grobo_a(), 0);
    idle();
}
C
printf '%s\n' "check 'it plays' grctl" | sample tests/cli/a.sh
seed_rows >docs/seed-map.md
check 'seed map: a whole one' sh "$gates/seed_map.sh"

# seed_refuses TEXT SED-COMMAND: the map changed so is refused with this.
seed_refuses() {
    seed_rows | sed "$2" >docs/seed-map.md
    refuses "$1" sh "$gates/seed_map.sh"
}
check 'seed map: a member missing' seed_refuses 'SR70 is missing' '/SR70/d'
check 'seed map: a member twice' seed_refuses 'RM10 stands here again' 's/RM09/RM10/'
check 'seed map: no such member' seed_refuses 'GR44 is no member' '/GR43/{p;s/GR43/GR44/;}'
check 'seed map: a name in a comment only' \
    seed_refuses 'SC03: no public header declares grobo_told' '/SC03/s/grobo_a/grobo_told/'
check 'seed map: no such field' \
    seed_refuses 'no public header declares grobo_b.sized' '/SC03/s/size/sized/'
check 'seed map: no test' seed_refuses 'SC03 names no test' '/SC03/s/| [^|]*|$/| |/'
check 'seed map: no such program' \
    seed_refuses 'no such test program: unit/test_b.c:works' '/SC03/s/test_a/test_b/'
check 'seed map: no such test' \
    seed_refuses 'SC03: no such test: unit/test_a.c:work' '/SC03/s/works/work/'
check 'seed map: a test that is not run' \
    seed_refuses 'SC03: no such test: unit/test_a.c:idle' '/SC03/s/works/idle/'
check 'seed map: a test of something else' \
    seed_refuses 'uses none of the symbols of its row' '/SC03/s/`grobo_a`, //'
check 'seed map: no such check' \
    seed_refuses 'no check called so: cli/a.sh:it stops' '/SC03/s,unit/.*works,cli/a.sh:it stops,'
seed_rows | sed '/SC03/s,unit/.*works,cli/a.sh:it plays,' >docs/seed-map.md
check 'seed map: a check of a script' sh "$gates/seed_map.sh"
printf '# ids\nSC03\ty\twhat it must do\n' | sample shared/seed/members.tsv
check 'seed map: another member than the reference' \
    refuses 'SC03 is y, not x' sh "$gates/seed_map.sh"
unset GROBO_SHARED

test_case "safety"

# safety_rows: a table whose rules name a test.
safety_rows() {
    printf '| %s |\n' 'rule | what | by | tests' '---|---|---|---' \
        'heat | stops | - | `unit/test_a.c:works`' 'cold | stops | - | `cli/a.sh:it plays`'
}
# safety_refuses TEXT SED-COMMAND: the table changed so is refused with this.
safety_refuses() {
    safety_rows | sed "$2" >docs/safety.md
    refuses "$1" named_tests safety docs/safety.md
}
named_tests() {
    rules=$1
    shift
    awk -f "$gates/strip.awk" -f "$gates/named_tests.awk" -f "$gates/$rules.awk" "$@"
}
safety_rows >docs/safety.md
check 'safety: a whole table' named_tests safety docs/safety.md
check 'safety: a rule without a test' \
    safety_refuses 'safety.md:3: safety: heat: names no test' '/heat/s/`[^`]*`/-/'
check 'safety: no such test' safety_refuses 'heat: no such test: unit/test_a.c:work' 's/works/work/'
check 'safety: a test that is not run' safety_refuses 'heat: no such test' 's/works/idle/'
check 'safety: no such check' safety_refuses 'cold: no check called so' 's/it plays/it sings/'
check 'safety: a row cut short' safety_refuses 'heat: a row has four cells' '/heat/s/| - //'
check 'safety: no rules' safety_refuses 'no table of rules' '/heat/d;/cold/d'

test_case "banned"

fresh
sample src/link/a.c <<'C'
/* strcpy(a, b) in a comment, over
   two lines: malloc(3); */
#include <setjmp.h>
static const char *text = "sprintf(x) \" gets(y)";
static int my_strcpy(int x) { return x; }
static void f(struct mem *m) { m->free(m); my_strcpy('"'); snprintf(b, 3, "%d", 1); }
C
check 'banned: words in comments, strings, members and longer names' scan banned src/link/a.c
for call in 'strcpy(a, b)' 'atoi (a)' 'malloc(3)' 'usleep(3)' 'fputs(a, stderr)' 'exit(1)'; do
    echo "void f(void) { $call; }" | sample src/link/a.c
    check "banned: $call in src" refuses 'src/link/a.c:1: banned' scan banned src/link/a.c
done
echo 'void f(void) { malloc(3); printf("x"); }' | sample tools/grctl/a.c
check 'banned: what only the library may not' scan banned tools/grctl/a.c
echo 'void f(void) { usleep(3); }' | sample tests/unit/a.c
sample src/classic/a.c <<'C'
void print(char *text)
{
    fprintf(stderr, "%s\n", text);
    free(text);
}
C
check 'banned: the classic shelf prints and allocates' scan banned src/classic/a.c
check 'banned: a test that sleeps' refuses 'tests/unit/a.c:1: banned' scan banned tests/unit/a.c

test_case "platform"

fresh
printf '#if defined(_WIN32)\n#endif\n' | tee a.c | sample src/bus/a.c
check 'platform: a conditional in src' \
    refuses 'src/bus/a.c:1: platform' scan platform src/bus/a.c
sample ports/posix/a.c <a.c
sample include/grobo/export.h <a.c
check 'platform: where it may stand' scan platform ports/posix/a.c include/grobo/export.h
echo '#  elif __linux__ /* why */' | sample src/bus/a.c
check 'platform: in any spelling' refuses 'src/bus/a.c:1: platform' scan platform src/bus/a.c


printf 'int f(void);\nint g(void)\n{\n    return accept4(1, 0, 0, 0);\n}\n' | tee a.c |
    sample ports/posix/a.c
check 'platform: a call of Linux' \
    refuses 'ports/posix/a.c:4: platform: only Linux' scan platform ports/posix/a.c
sample ports/posix/a_linux.c <a.c
check 'platform: where that may be' scan platform ports/posix/a_linux.c
echo '#include <linux/serial.h>' | sample ports/posix/a.c
check 'platform: a header of Linux' \
    refuses 'ports/posix/a.c:1: platform: only Linux' scan platform ports/posix/a.c
printf '#ifdef __linux__\n#endif\n' | sample ports/posix/a.c
check 'platform: a conditional on Linux' \
    refuses 'ports/posix/a.c:1: platform: only Linux' scan platform ports/posix/a.c
printf 'bool nearer;\nbool near = x < 1;\n' | sample tools/grctl/a.c
check 'platform: a name that Windows takes' \
    refuses 'tools/grctl/a.c:2: platform: near and far' scan platform tools/grctl/a.c

test_case "size"

# body N LINE: a function whose body is N times LINE.
body() {
    printf 'static int f(int a, int b)\n{\n'
    awk -v n="$1" -v line="$2" 'BEGIN { while (n-- > 0) print line }'
    printf '}\n'
}

fresh
body 57 '    a++;' >long.c
check 'size: a function of 60 lines' scan size long.c
body 58 '    a++;' >long.c
check 'size: a function of 61 lines' refuses 'long.c:1: size: f has 61 lines' scan size long.c
body 14 '    if (a) b++; /* if for while && */ x = "? && ||";' >branches.c
check 'size: complexity 15' scan size branches.c
body 15 '    if (a) b++;' >branches.c
check 'size: complexity 16' refuses 'f has complexity 16' scan size branches.c
body 5 '    a = b && a || b ? 1 : 2;' >branches.c
check 'size: operators count' refuses 'f has complexity 16' scan size branches.c
body 40 '    case 3: a = 1; break;' >branches.c
check 'size: a case costs nothing' scan size branches.c
printf 'int f(int a, int b, int c,\n      int (*d)(int, int), int e, int f)\n{\n}\n' >many.c
check 'size: six parameters' scan size many.c
printf 'int f(int a, int b, int c,\n      int d, int e, int f, int g)\n{\n}\n' >many.c
check 'size: seven parameters' refuses 'many.c:1: size: f has 7 parameters' scan size many.c
awk 'BEGIN { for (i = 0; i < 1001; i++) print "int x;" }' >file.c
check 'size: a file of 1001 lines' refuses 'file.c:1001: size: file of 1001' scan size file.c long.c

test_case "braces"

fresh
sample a.c <<'C'
#define RETURN(x) do { return x; } while (0)
int a(int n)
{
    for (int i = 0; i < n; i++) {
        if (i > 2 &&
            n > 3) { /* if (i) */
            return 1;
        } else if (n > 5) {
            return 2;
        } else {
            n--;
        }
    }
    do {
        n--;
    } while (n > 0);
    return n;
}
C
check 'braces: around every body' scan braces a.c
sample b.c <<'C'
int b(int n)
{
    if (n > 2 &&
        n < 5)
        return 1;
    for (; n > 9; n--) {
    }
    if (n) {
        n--;
    } else
        n++;
    return n;
}
C
check 'braces: none after a condition of two lines' refuses 'b.c:4: braces' scan braces b.c
check 'braces: none after else' refuses 'b.c:10: braces' scan braces b.c

test_case "switch"

fresh
cat >a.h <<'C'
typedef enum state {
    STATE_IDLE, /**< not STATE_NAMED_IN_COMMENT */
    STATE_BUSY = 3
} state;
enum { HEADER_BYTE = 0xFA };
C
cat >a.c <<'C'
int f(state s, int byte)
{
    switch (byte) {
    case HEADER_BYTE:
        return 1;
    default:
        break;
    }
    switch (s) {
    case STATE_IDLE: {
        break;
    }
    case STATE_BUSY:
        break;
    }
    return 0;
}
C
check 'switch: default over bytes, none over an enum' scan switch a.h a.c a.h a.c
sed 's/    case STATE_BUSY:/    default:/' a.c >b.c
cat >c.c <<'C'
const char *f(uint16_t value)
{
    switch (value) {
    case STATE_BUSY:
        return "busy";
    default:
        return NULL;
    }
}
C
check 'switch: default over a number that may hold anything' scan switch a.h c.c a.h c.c
check 'switch: default over an enum' refuses 'b.c:13: switch' scan switch a.h b.c a.h b.c

test_case "units"

fresh
cat >a.h <<'C'
struct a {
    int64_t delay_us; /* delay; */
    double angles_rad[20];
    uint16_t voltage_mv, count;
    int timeouts;
};
int64_t grobo_present_time(void);
int grobo_set_speed(int speed_dps);
C
check 'units: names with units' scan units a.h
for line in '    int64_t delay;' '    double goal_angles[20];' 'void f(int timeout, int n);' \
    'void f(uint16_t voltage);'; do
    echo "$line" >a.h
    check "units: $line" refuses 'a.h:1: units' scan units a.h
done

test_case "names and counts of one robot"

fresh
mkdir -p src/robots src/link tools/grctl/cmd
cat >one.yaml <<'Y'
name: gr001
joints:
  - name: R_KNEE_P
  - name: CHEST_P
groups:
  - {name: all, joints: [R_KNEE_P]}
Y
echo 'src/link/known.c a default' >list
# one_robot WHOLE FILE...
one_robot() {
    whole=$1
    shift
    awk -v robot=one.yaml -v list=list -v whole="$whole" -f "$gates/strip.awk" \
        -f "$gates/gr001.awk" "$@"
}
cat >src/link/a.c <<'C'
/* GR001 has 20 joints: R_KNEE_P is one. */
static const char *const words = "as R_KNEE_P of GR001";
const int n = model->n_joints + 120 + joint->motor[2];
double table[200], at = joints[1] * 20.5;
C
check 'gr001: comments, sentences and other numbers' one_robot '' src/link/a.c
for line in 'x = grobo_gr001_driver(w);' 'x = &grobo_i_gr001_model;' \
    'if (strcmp(name, "gr001") == 0) {' 'if (strcmp(name, "GR001") == 0) {' 'double q_rad[20];' \
    'if (model->n_joints == 20) {' 'for (int j = 0; j < n_servos && n_joints >= 21; j++) {' \
    'if (20 < n_motors) {' 'const char *knee = "R_KNEE_P";' 'x = find(model, "CHEST_P");'; do
    echo "$line" >src/link/b.c
    check "gr001: $line" refuses 'src/link/b.c:1: gr001' one_robot '' src/link/b.c
    cp src/link/b.c src/robots/b.c
    check "gr001: its own: $line" one_robot '' src/robots/b.c
done
echo 'x = grobo_gr001_driver(w);' >src/link/known.c
check 'gr001: what is listed' one_robot 1 src/link/known.c
echo 'x = 1;' >src/link/known.c
check 'gr001: what is listed for nothing' refuses 'list:1: gr001: src/link/known.c' \
    one_robot 1 src/link/known.c
echo '.example = "  grctl move R_KNEE_P -40\n",' >tools/grctl/cmd/c.c
check 'gr001: help has examples' one_robot '' tools/grctl/cmd/c.c
echo 'if (strcmp(name, "R_KNEE_P") == 0) {' >tools/grctl/cmd/c.c
check 'gr001: a command that decides by a name' refuses 'tools/grctl/cmd/c.c:1: gr001' \
    one_robot '' tools/grctl/cmd/c.c

test_case "text, format, help, tree"

fresh
licence='/* SPDX-License-Identifier: MIT */'
printf '%s\nint x;\n' "$licence" >a.c
check 'text: clean' awk -f "$gates/text.awk" a.c
printf '%s\n\tint x;\n' "$licence" >a.c
check 'text: tab' refuses 'a.c:2: text: tab' awk -f "$gates/text.awk" a.c
printf '%s\nint x; \n' "$licence" >a.c
check 'text: trailing blank' refuses 'a.c:2: text: trailing' awk -f "$gates/text.awk" a.c
printf 'int x;\n' >a.c
check 'text: licence' refuses 'a.c:1: text: first line' awk -f "$gates/text.awk" a.c
printf '#!/bin/sh\n' >a.sh
printf 'echo\n' >>a.sh
check 'text: licence of a script' refuses 'no SPDX' awk -f "$gates/text.awk" a.sh
printf '%s\n%0101d\n' "$licence" 0 >a.c
check 'text: columns' refuses 'a.c:2: text: longer' awk -f "$gates/text.awk" a.c
printf '%s\n%048d\n' "$licence" 0 | sed '2s/0/関/g' >a.c
check 'text: 96 columns of wide characters' env LC_ALL=C awk -f "$gates/text.awk" a.c
printf '%s\n%051d\n' "$licence" 0 | sed '2s/0/関/g' >a.c
check 'text: 102 columns of them' refuses 'a.c:2: text: longer' \
    env LC_ALL=C awk -f "$gates/text.awk" a.c

both_ways() {
    "$@" && [ -s "$FORMATTED" ] && "$@"
}
printf 'BasedOnStyle: LLVM\n' >.clang-format
printf 'int x ;\n' >a.c
if command -v clang-format-14 >/dev/null; then
    check 'format: not formatted' refuses 'a.c:1: format' sh "$gates/format.sh" a.c
    printf 'int x;\n' >a.c
    check 'format: formatted' sh "$gates/format.sh" a.c
    FORMATTED=$work/formatted
    export FORMATTED
    check 'format: it is remembered' both_ways sh "$gates/format.sh" a.c
    printf 'int x ;\n' >a.c
    check 'format: not when it has changed' refuses 'a.c:1: format' sh "$gates/format.sh" a.c
    check 'format: nor is what is not formatted' refuses 'a.c:1: format' sh "$gates/format.sh" a.c
    printf 'BasedOnStyle: LLVM\nSpaceBeforeParens: Always\n' >.clang-format
    printf 'int x(void);\n' >a.c
    check 'format: nor under another style' refuses 'a.c:1: format' sh "$gates/format.sh" a.c
    unset FORMATTED
fi # elsewhere nobody formats: continuous integration does

printf '.PHONY: all check \\\n  clean\nall: ## x\ncheck: ## y\nclean:\n' >Makefile
check 'help: a target without a comment' refuses 'target clean has no' sh "$gates/help.sh"
printf '.PHONY: all\nall: x ## x\ndist: y ## y\n' >Makefile
check 'help: a target that is not phony' refuses 'target dist is not' sh "$gates/help.sh"
printf '.PHONY: all FORCE\nall: x ## x\n' >Makefile
check 'help: clean' sh "$gates/help.sh"

fresh
mkdir docs
printf '## The tree\n\n| name | is |\n| `docs/` | x |\n| `src/` | y |\n' >docs/design.md
echo x | sample src/a.c
check 'tree: as told' sh "$gates/tree.sh"
echo x | sample src/a.cpp
check 'tree: C++' refuses 'src/a.cpp:1: tree: C++' sh "$gates/tree.sh"
rm src/a.cpp
echo x >notes.txt
check 'tree: a stray file' refuses 'notes.txt stands at the top' sh "$gates/tree.sh"
rm -r notes.txt src
check 'tree: a name too many' refuses 'names src, which is not' sh "$gates/tree.sh"

fresh
echo 'int x;' | sample src/robots/a-b.yaml
echo ' int  x;' | sample src/robots/a_b.c
check 'robots: made of its file' sh "$gates/../robots/make.sh" --check cat
echo 'int y;' | sample src/robots/a_b.c
check 'robots: not made of its file' refuses 'src/robots/a_b.c: robots: differs' \
    sh "$gates/../robots/make.sh" --check cat

fresh
# What stands for the program prints a file of the folder that it is given.
printf '#!/bin/sh\ncat "$1/made"\n' >print
chmod +x print
echo 'file: src/servo/a/table.c' | sample src/servo/models/a/table.yaml
echo 'int x;' | sample src/servo/models/a/made
echo ' int  x;' | sample src/servo/a/table.c
check 'servos: made of its folder' sh "$gates/../servos/make.sh" --check ./print
echo 'int y;' | sample src/servo/a/table.c
check 'servos: not made of its folder' refuses 'src/servo/a/table.c: servos: differs' \
    sh "$gates/../servos/make.sh" --check ./print

test_case "anchors"

# sabotaged FILE LINES: a tree with a function, and with these sabotages in that file.
sabotaged() {
    fresh
    sample src/bus/a.c <<'C'
static int twice(int a)
{
    GROBO_ASSERT(a > 0);
    if (a > 9) {
        return 9;
    }
    return a + a;
}
C
    mkdir -p docs tests/mutants
    echo '| SC01 | twice | `twice` | | `unit/test_a.c:works` |' >docs/seed-map.md
    echo 'function twice' >tests/mutants/scope
    for file in asserts named rows survivors; do
        : >"tests/mutants/$file"
    done
    printf '%b' "$2" >"tests/mutants/$1"
    python3 "$gates/../../tests/mutants/anchors.py"
}
if command -v python3 >/dev/null; then
    check 'anchors: sabotages in their places' \
        sabotaged named 'twice\n- return a + a;\n+ return a;\n'
    check 'anchors: a text that is not there' refuses 'named:1: twice: found 0 times' \
        sabotaged named 'twice\n- return a * a;\n+ return a;\n'
    check 'anchors: a function that is not there' refuses 'not one function thrice' \
        sabotaged named 'thrice\n- return a + a;\n+ return a;\n'
    check 'anchors: an assertion that is not there' refuses '0 assertions, not one: twice: a > 1' \
        sabotaged asserts 'twice trips twice: a > 1\n- a > 9\n+ a > 8\n'
    check 'anchors: the function of a row' refuses 'SC01: missing anchor: twice: found 0 times' \
        sabotaged rows 'SC01 twice\n- a * a\n+ a\n'
    check 'anchors: a mutant that is not made' refuses 'no such mutant: twice | comparison | none' \
        sabotaged survivors 'twice | comparison | none\n    Why not.\n'
fi
done_testing
