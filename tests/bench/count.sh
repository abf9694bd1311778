#!/bin/sh
# SPDX-License-Identifier: MIT
# Counts the instructions of the pieces of work of bench_work and of transactions of bench_line, by
# callgrind.
#
# usage: tests/bench/count.sh BUILD [--gate | --update]
#   prints a line a piece: its name, instructions of one. --gate fails where one is more than 3 %
#   off tests/bench/instructions, either way: a gain is to be kept there too; those of a
#   line 8 %, whose timers and threads take their turns by the clock. --update writes them.
#   The figures are of one compiler and one processor, named there; elsewhere nothing is compared.
set -u
LC_ALL=C
export LC_ALL

build=$1
do=${2:-}
kept=tests/bench/instructions
compiler="$(${CC:-gcc} --version 2>/dev/null | head -n 1), $(uname -m)"

if ! command -v valgrind >/dev/null; then
    echo 'count: no valgrind here; nothing is counted' >&2
    exit 0
fi
if [ "${FLAGS:--O2 -g }" != '-O2 -g ' ]; then
    echo "count: skipped: the figures are of -O2 -g, not of $FLAGS" >&2
    exit 0
fi
if [ "$do" = --gate ] && [ "# $compiler" != "$(sed -n 2p $kept)" ]; then
    echo "count: skipped: the figures are of another compiler: $(sed -n '2s/^# //p' $kept)" >&2
    exit 0
fi

# Of a line with a far end: two runs, by the difference, and without the looks for emergency stops,
# which are made by the clock. How often the loop turns for a thread is the system's as well.
line_total() {
    GROBO_BENCH_STILL=1 "$build/tests/bench/bench_line" serve 0 0 0 1 valgrind --tool=callgrind \
        --callgrind-out-file="$build/count.callgrind" "$build/tests/bench/bench_line" "$1" "$2" \
        >/dev/null 2>&1
    callgrind_annotate --inclusive=yes --threshold=100 "$build/count.callgrind" 2>/dev/null |
        awk '{ gsub(",", "", $1) }
            /PROGRAM TOTALS/ { total = $1 }
            /:grobo_i_session_estop_look / && looks == "" { looks = $1 }
            END { print total - looks }'
}

# total PIECE N: instructions of N of them.
total() {
    case $1 in
    session20 | runner)
        few=$(line_total "$1" 300) many=$(line_total "$1" $((300 + $2)))
        echo $((many - few))
        ;;
    *)
        valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=bench_counted \
            "$build/tests/bench/bench_work" "$1" "$2" 2>&1 | awk '/Collected/ { print $4 }'
        ;;
    esac
}

# PIECE SCENARIO N FIGURE
figures=$(grep -v '^#' $kept | while read -r piece scenario n figure; do
    total=$(total "$piece" "$n")
    echo "$piece $scenario $n $((${total:-0} / n)) $figure"
done)

case $do in
--gate)
    echo "$figures" | awk '
        { off = $1 == "runner" || $1 == "session20" ? 0.08 : 0.03 }
        $4 > $5 * (1 + off) || $4 < $5 * (1 - off) {
            printf "count: %s: %d instructions, %d are kept: %+.1f %%", $1, $4, $5, \
                ($4 / $5 - 1) * 100
            print "; make bench-count UPDATE=1 keeps them, where that is meant"
            bad = 1
        }
        END {
            if (!bad) {
                printf "count: %d pieces of work within 3 %% of the figures kept\n", NR
            }
            exit bad
        }'
    ;;
--update)
    {
        sed -n 1p $kept
        echo "# $compiler"
        echo "$figures" | awk '{ print $1, $2, $3, $4 }'
    } >"$build/instructions.new" && mv "$build/instructions.new" $kept
    ;;
*)
    echo "$figures" | awk '{ print $1, $4 }'
    ;;
esac
