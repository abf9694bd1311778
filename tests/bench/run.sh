#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints the table of speeds: ours, the floor, the peers, the ratio of ours to the floor; and writes
# it as JSON. Nothing of it is a gate but what the programs promise of memory (their exit status).
#
# usage: GRCTL=build/grctl tests/bench/run.sh BUILD
#
# Instructions are those of callgrind: of two runs, by the difference, so that starting counts for
# nothing. System calls are strace's, in the same way. Without either the rows are missing, and a
# line says so. `make bench-peers` brings the peers.
set -u
LC_ALL=C
export LC_ALL

build=$1
bin=$build/tests/bench
peers=$build/peers
line=$bin/bench_line
python=$peers/python/bin/python
GROBO_LIBMODBUS=$(ls "$peers"/usr/lib/*/libmodbus.so.5 2>/dev/null | head -n 1)
export GROBO_LIBMODBUS
rows=$build/bench.rows
status=0
began_s=$(date +%s)
: >"$rows"

have() {
    command -v "$1" >/dev/null 2>&1
}

say() {
    echo "bench: $1" >&2
}

# row SCENARIO MEASURE WHO VALUE
row() {
    [ -z "$4" ] || printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" "$4" >>"$rows"
}

# How a client is called, without its number of transactions.
client() {
    case $1 in
    pyserial | dynamixel-sdk | rustypot) echo "$python tests/bench/peer.py $1" ;;
    *) echo "$line $1" ;;
    esac
}

who_of() {
    case $1 in
    session) echo grobo ;;
    libevent) echo floor libevent ;;
    sensing) echo grobo in the background ;;
    *) echo "$1" ;;
    esac
}

is_there() {
    case $1 in
    pyserial | dynamixel-sdk | rustypot) [ -x "$python" ] ;;
    libmodbus) [ -n "$GROBO_LIBMODBUS" ] ;;
    esac
}

# difference FEW MANY COMMAND: what a transaction costs. COMMAND N prints a total.
difference() {
    few=$("$3" "$1") many=$("$3" "$2")
    [ -n "$few" ] && [ -n "$many" ] &&
        echo "$few $many $1 $2" | awk '{ print ($2 - $1) / ($4 - $3) }'
}

# What the next two are asked about.
who=session bps=0 lines=1

instructions() {
    # shellcheck disable=SC2046
    $line serve "$bps" 0 0 $lines valgrind --tool=callgrind \
        --callgrind-out-file="$build/bench.callgrind" $(client $who) "$1" 2>&1 |
        awk '/Collected/ { print $4 }'
}

# Rows of a scenario: what a transaction takes, by the difference of two runs; ours without the
# looks for emergency stops, too, which are made by the clock: callgrind is 50 times as slow, and a
# transaction sees 50 times as many of them.
instruction_rows() {
    scenario=$1 measure=$2 few=$3 many=$4
    set --
    for n in "$few" "$many"; do
        total=$(instructions "$n") looks=0
        if [ $who = session ]; then
            looks=$(callgrind_annotate --inclusive=yes --threshold=100 "$build/bench.callgrind" \
                2>/dev/null | awk '/:grobo_i_session_estop_look / {
                    gsub(",", "", $1)
                    looks = $1
                }
                END { print looks + 0 }')
        fi
        [ -n "$total" ] || return 0
        set -- "$@" "$total" "$looks"
    done
    row "$scenario" "$measure" "$(who_of $who)" $((($3 - $1) / (many - few)))
    if [ $who = session ]; then
        row "$scenario" "$measure, without looks for stops" grobo \
            $((($3 - $4 - $1 + $2) / (many - few)))
    fi
}

system_calls() {
    # shellcheck disable=SC2046
    $line serve "$bps" 0 0 $lines strace -f -c -o "$build/bench.strace" $(client $who) "$1" \
        >/dev/null 2>&1
    awk '$NF == "total" { print ($(NF - 1) ~ /^[0-9]+$/ && NF > 5) ? $4 : $(NF - 1) }' \
        "$build/bench.strace"
}

# timing N LATE_PERCENT LATE_US: "rate cpu_us p99_us"
timing() {
    # shellcheck disable=SC2046
    $line serve "$bps" "$2" "$3" $lines $(client $who) "$1" 2>/dev/null
}

clients='session sensing libevent'
for peer in libmodbus rustypot dynamixel-sdk pyserial; do
    if is_there $peer; then
        clients="$clients $peer"
    fi
done

# ---- S1, S2: a transaction -------------------------------------------------------------------

if have valgrind; then
    bps=0
    for who in $clients; do
        instruction_rows S1 'user instructions a transaction' 300 900
    done
else
    say 'no valgrind: no instructions are counted'
fi
if have strace; then
    for bps in 115200 1000000; do
        for who in $clients; do
            row S1 "$bps bps: system calls a transaction" "$(who_of $who)" \
                "$(difference 100 300 system_calls)"
        done
    done
else
    say 'no strace: no system calls are counted'
fi
# Medians of rounds, each of all clients, so that all of them see the same machine.
for bps in 115200 1000000 0; do
    for round in 1 2 3; do
        for who in $clients; do
            case $bps.$who in
            0.dynamixel-sdk | 0.pyserial) n=1000 ;; # a fifth as fast
            0.*) n=5000 ;;
            *) n=400 ;;
            esac
            # shellcheck disable=SC2046
            set -- $(timing $n 0 0)
            [ $# = 3 ] || continue
            [ $bps = 0 ] || row S1 "$bps bps: CPU a transaction, us" "$(who_of $who)" "$2"
            [ $bps != 0 ] || row S2 'no wire time: transactions a second' "$(who_of $who)" "$1"
        done
    done
done

# ---- S3: late replies ------------------------------------------------------------------------

bps=1000000
for late_us in 3000 8000 20000; do
    for who in session libevent; do
        # shellcheck disable=SC2046
        set -- $(timing 1000 1 $late_us)
        late="one reply in 100 late by $((late_us / 1000)) ms"
        [ $# = 3 ] && row S3 "$late: transactions a second" "$(who_of $who)" "$1"
    done
done

# ---- S4, S6: GR001's cycle, and a scan -----------------------------------------------------------

rm -f "$build/bench.pty"
"$GRCTL" -q sim --link "$build/bench.pty" >/dev/null 2>&1 &
robot=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do
    [ -e "$build/bench.pty" ] || sleep 0.2
done
# S6: none of these ids is there. The wire's part is told, too.
scanned=$("$GRCTL" -q --json -d "$build/bench.pty" scan --first 30 --last 49 2>/dev/null)
for field in took wire; do
    row S6 'scan of 20 silent ids, ms' "$([ $field = took ] && echo grobo || echo floor wire)" \
        "$(echo "$scanned" | sed -n "s/.*\"${field}_ms\": *\([0-9.]*\).*/\1/p")"
done
# shellcheck disable=SC2046
set -- $($line cycle 5 "$build/bench.pty")
kill $robot
wait $robot 2>/dev/null
if [ $# = 2 ]; then
    row S4 'GR001: pose and 20 full states, cycles a second' grobo "$1"
    row S4 'GR001: pose and 20 full states, cycles a second' 'floor wire' "$2"
fi

# ---- S5: robots in one thread ----------------------------------------------------------------

bps=0
for lines in 1 8 64 512; do
    for who in session libevent; do
        if have valgrind; then
            instruction_rows S5 "$lines robots: user instructions a transaction" 1000 3000
        fi
        # shellcheck disable=SC2046
        set -- $(timing 10000 0 0)
        [ $# = 3 ] &&
            row S5 "$lines robots: p99 lateness of a 10 ms timer, us" "$(who_of $who)" "$3"
    done
done

# ---- S9: a peer ------------------------------------------------------------------------------

if [ -e "$peers/libyaml-cpp-dev.there" ] && have "${CXX:-g++}"; then
    printf '%s\n' '#include <yaml-cpp/yaml.h>' '#include <cstdio>' '#include <ctime>' \
        'int main(int, char **v) { std::clock_t b = std::clock();' \
        'YAML::Node n = YAML::LoadFile(v[1]);' \
        'std::printf("%g\n", (std::clock() - b) * 1e3 / CLOCKS_PER_SEC); return n.IsNull(); }' \
        >"$build/bench_yaml_cpp.cpp"
    library=$(echo "$peers"/usr/lib/*/libyaml-cpp.a)
    if ${CXX:-g++} -O2 -I"$peers/usr/include" -o "$build/bench_yaml_cpp" \
        "$build/bench_yaml_cpp.cpp" "$library" &&
        "$bin/bench_motion" "$build/bench.yaml" 10000; then
        row S9 'read 3 MB of yaml, ms' yaml-cpp "$("$build/bench_yaml_cpp" "$build/bench.yaml")"
    fi
fi

# ---- what programs of ours measure by themselves ---------------------------------------------

for program in work motion body memory play start; do
    "$bin/bench_$program" >>"$rows" || status=1
done

if have valgrind; then
    tests/bench/count.sh "$build" | while read -r piece count; do
        row "$(awk -v piece="$piece" '$1 == piece { print $2 }' tests/bench/instructions)" \
            "$piece: user instructions" grobo "$count"
    done
fi

sort -s -t "$(printf '\t')" -k 1.2,1n "$rows" |
    awk -f tests/bench/table.awk -v json="$build/bench.json"

# plot FILE SCENARIO PART X TITLE
plot() {
    awk -f tests/bench/plot.awk -v scenario="$2" -v part="$3" -v x="$4" -v title="$5" "$rows" \
        >"$build/bench-$1.svg"
}
plot robots S5 ' robots: user instructions a transaction' 'robots in one thread' \
    'User instructions a transaction'
plot joints S11 ' joints: play and simulated robot, us a frame' 'joints' \
    'Play and simulated robot, us a frame'
plot frames S9 ' frames, us a frame' 'frames of 20 joints' 'Reading yaml, us a frame'
say "took $(($(date +%s) - began_s)) s"
exit $status
