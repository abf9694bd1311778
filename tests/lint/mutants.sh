#!/bin/sh
# SPDX-License-Identifier: MIT
# The sabotage run must not call anything noticed that was not, and must miss what is not there.
set -u

. tests/support/tap.sh
top=$(pwd)
run=$top/tests/mutants/run.py
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
if ! command -v python3 >/dev/null || ! command -v objcopy >/dev/null; then
    echo "1..0 # SKIP no python3 or no objcopy to make mutants with"
    exit 0
fi
cc=${CC:-gcc}

# A library of two functions, and a test of the first.
cat >core.c <<'C'
static int tripped;

int core_limit(int value)
{
    tripped = 0;
    if (value > 10) {
        tripped = 1;
    }
    return tripped;
}

int core_sum(int n)
{
    int sum = 0;
    for (int i = 0; i < n; i++) {
        sum += i + 1;
    }
    return sum;
}
C
cat >test_core.c <<'C'
#include "tests/support/test.h"
int core_limit(int value);
int core_sum(int n);
TEST(it_trips)
{
    assert_false(core_limit(10) != 0 || core_limit(11) != 1 || core_limit(9) != 0 || SUM);
}
C
$cc -c -o core.o core.c && ar rcs libcore.a core.o || exit 1
$cc -iquote "$top" -c -DSUM=0 -o test_core.o test_core.c &&
    $cc -iquote "$top" -c -DSUM='core_sum(4)!=10' -o test_sum.o test_core.c &&
    $cc -iquote "$top" -c "$top/tests/support/test.c" "$top/tests/support/test_main.c" || exit 1

# mutants OPTION...: of core.c, with the scope, survivors and named sabotages in these files.
: >survivors
: >named
echo 'function core_limit' >scope
mutants() {
    python3 "$run" --sources core.c --tests "${TESTS:-test_core.o}" \
        --libs "test.o libcore.a -lcmocka" --compile "$cc -O1" --link "$cc" \
        --scope scope --survivors survivors --named named \
        --work "$work/build" --jobs 2 "$@" >said 2>&1
}

# says STATUS TEXT COMMAND...
says() {
    expected=$1
    text=$2
    shift 2
    "$@"
    got=$?
    cat said
    [ $got = "$expected" ] && grep -Fq -- "$text" said
}

test_that 'all of a function that is well tested are noticed' \
    says 0 ' passed, 0 failed, 0 skipped' mutants --count 0
check 'it ends with the line that all tests end with' \
    sh -c 'tail -n 1 said | grep -Eq "^[0-9]+ passed, 0 failed, 0 skipped$"'

echo 'unit core_limit' >scope
test_that 'what no test looks at is not noticed' \
    says 1 'not noticed: core_sum | statement | {sum += i + 1; => ;}' mutants --count 0
check 'and the command that repeats it is there' \
    sh -c 'id=$(sed -n "s/.*check-mutants ONLY=//p" said | head -n 1) && [ -n "$id" ]'
id=$(sed -n '/core_sum | statement | {sum +=/{n;s/.*ONLY=//p;}' said)
test_that 'by its name alone' says 1 '0 passed, 1 failed, 0 skipped' mutants --only "$id"
TESTS='test_core.o test_sum.o'
test_that 'a test of it notices, also what never ends' says 0 ' failed, 0 skipped' mutants --count 0
TESTS=

# A test that counts how often it runs, and reaches core_sum alone.
cat >test_other.c <<'C'
#include <stdio.h>
#include "tests/support/test.h"
int core_sum(int n);
TEST(it_is_counted)
{
    FILE *file = fopen("ran", "a");
    assert_non_null(file);
    assert_true(fputs("once\n", file) >= 0 && fclose(file) == 0 && core_sum(0) == 0);
}
C
$cc -iquote "$top" -c test_other.c || exit 1
TESTS='test_other.o test_core.o'
runs_seldom() {
    printf 'core_limit\n- tripped = 0;\n+ ;\n' >named
    : >ran
    says 0 '1 passed, 0 failed' mutants --only named && [ "$(wc -l <ran)" -eq 1 ] || return 1
    printf 'core_sum\n- sum = 0;\n+ sum = n == 0 ? 0 : 1;\n' >named
    : >ran
    says 1 '0 passed, 1 failed' mutants --only named && [ "$(wc -l <ran)" -eq 2 ]
}
test_that 'tests run that reach the line' runs_seldom
: >named
TESTS=

cat >survivors <<'S'
core_sum | statement | {sum += i + 1; => ;}
    Nobody needs the sum.
S
test_that 'a survivor with a reason is skipped' says 1 ' 1 skipped' mutants --count 0
TESTS='test_core.o test_sum.o'
test_that 'but not where it is noticed' says 1 'notices it' mutants --count 0
check 'with a cap it is not tried' says 0 ' 1 skipped' mutants --count 0 --cap-s 9
TESTS=
echo 'core_sum | statement | {sum += i + 1; => ;}' >survivors
test_that 'each needs a reason' says 1 'no reason: core_sum' mutants --count 0
printf 'core_sum | statement | {product *= i; => ;}\n    Gone.\n' >survivors
test_that 'one that is not in the tree is missing' \
    says 1 'missing anchor: core_sum' mutants --count 0
: >survivors

echo 'unit core_product' >scope
test_that 'so is a pattern without a function' says 1 'missing anchor: unit core_product' mutants
echo 'function core_limit' >scope
printf 'core_limit\n- tripped = 0;\n+ ;\n' >named
test_that 'a sabotage by hand is noticed' says 0 '1 passed, 0 failed' mutants --only named
printf 'core_limit\n- tripped = 2;\n+ ;\n' >named
test_that 'its text must be there' says 1 'found 0 times' mutants --only named
printf 'core_gone\n- tripped = 0;\n+ ;\n' >named
test_that 'and its function' says 1 'missing anchor: one function core_gone' mutants --only named
test_that 'nothing is left behind but who noticed what' sh -c '[ "$(ls build)" = killers.json ]'

# ---- the sabotages of the rows of a map ----

mkdir objects objects/unit
cat >map.md <<'M'
| SC01 | limit | `core_limit` |  | `unit/test_rows.c:it_trips` |
| SC02 | sum | `core_sum` |  | `unit/test_rows.c:it_adds` |
M
mkdir tests
cat >tests/test_rows.c <<'C'
#include "tests/support/test.h"
int core_limit(int value);
int core_sum(int n);
TEST(it_trips)
{
    assert_int_equal(core_limit(11), 1);
}
TEST(it_adds)
{
    if (core_sum(4) != 10) {
        *(volatile int *)0 = 0;
    }
}
C
$cc -I "$top" -c -o objects/unit/test_rows.o tests/test_rows.c || exit 1
rows() {
    python3 "${run%/*}/rows.py" --map map.md --rows rows --sources core.c \
        --objects objects \
        --libs 'test.o test_main.o libcore.a -lcmocka' --compile "$cc -O1" --link "$cc" \
        --work "$work/build" "$@" >said 2>&1
}

printf 'SC01 core_limit\n- tripped = 1;\n+ ;\n' >rows
test_that 'a row is killed by an assertion of its test' \
    says 0 '1 passed, 0 failed' rows --only SC01
test_that 'a row without a sabotage is a failure' says 1 '1 rows have no sabotage: SC02' rows
printf 'SC01 core_limit\n- value > 10\n+ value > 9\n' >rows
test_that 'what its test does not look at survives' \
    says 1 'SC01: survives: unit/test_rows.c:it_trips' rows
printf 'SC02 core_sum\n- i + 1\n+ i\n' >rows
test_that 'a crash is no assertion' says 1 'it_adds crashed' rows
printf 'SC01 core_limit\n- tripped = 2;\n+ ;\n' >rows
test_that 'a text that is gone is a failure' \
    says 1 'SC01: missing anchor: core_limit' rows
printf 'SC01 core_gone\n- tripped = 2;\n+ ;\n' >rows
test_that 'so is a function' says 1 'SC01: missing anchor: one function core_gone' rows
printf 'SC01 core_sum\n- i + 1\n+ i\n' >rows
test_that 'a function of another row is none' says 1 "core_sum is none of the row's functions" rows
printf 'SC01 core_limit\n- tripped = 1;\n+ return GROBO_ERR_IO;\n' >rows
test_that 'an error is no sabotage' says 1 'no sabotage' rows

done_testing
