#!/bin/sh
# SPDX-License-Identifier: MIT
# The table of deaths in docs/guide/safety.md: each is died again here, by a grctl that plays or
# moves, on both wirings, and must leave the same on the wire, in order and number, and the joints
# in the same state. Times are reported there and not compared. TOUR_WRITE=yes (make captures)
# writes the table.
. tests/support/cli.sh
. tests/support/guide_blocks.sh

guide=$PWD/docs/guide/safety.md
motion=$PWD/motions/greet.pseq
at_a_time=6 # they wait most of the time
here=$work

# ---- one death -----------------------------------------------------------------------------------

# begins COMMAND...: grctl, its process in $program; $how is put before it.
begins() {
    : >"$work/err"
    # $how is a list of words, or empty.
    # shellcheck disable=SC2086
    $how "$GRCTL" -d "$robot" --wiring "$wiring" --timeout 500 --json -v "$@" \
        >"$work/out" 2>"$work/err" </dev/null &
    program=$!
}
# Where a file may have 1 KiB (2 for some shells), and where the disk has room for 4 KiB.
small_file() {
    no_counters
    ulimit -f 2
    exec "$@"
}
small_disk() {
    mkdir "$work/disk"
    exec unshare -Urm sh -c 'mount -t tmpfs -o size=4k none "$0" && exec "$@"' "$work/disk" "$@"
}
# The last window of its terminal closes: whoever reads the other end goes away.
in_terminal() {
    exec script -qec "exec $*" /dev/null
}
trace=
how=
command_of() {
    case $command in
    play) set -- play "$motion" ;;
    move) set -- move m5 -110 "$move_ms" ;;
    esac
    # A trace of one joint alone would fit on that disk.
    if [ "$death $command" = 'full disk move' ]; then
        printf 'status\n%s\n' "$*" >"$work/script"
        set -- shell "$work/script"
    fi
    # shellcheck disable=SC2086
    begins $trace "$@"
}
is_moving() {
    case $command in
    play) grep -q '"t_ms":[1-9]' "$work/out" && sim_shows '' ', moving' ;;
    move) sim_shows 5 ' -2[2-9]\.[0-9] .*, moving' ;;
    esac
}
stands() {
    ! sim_shows '' ', moving' && tell look && looked_at
}
looked_at() {
    [ "$(tail -n +"$((tell_lines + 1))" "$work/sim.log" | grep -c ' deg ')" -eq 20 ]
}

prepare() {
    move_ms=20000
    case $death in
    SIGXFSZ)
        how=small_file trace="--trace $work/cut.pcapng" move_ms=3000
        ;;
    'full disk')
        how=small_disk trace="--trace $work/disk/cut.pcapng" move_ms=3000
        ;;
    'no memory') move_ms=3000 ;;
    'no descriptor')
        move_ms=3000
        # Who looks for leaks at the end needs one.
        export ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0"
        ;;
    'closed terminal') how=in_terminal ;;
    esac
}
strike() {
    case $death in
    SIG*[LVP]) kill -s "${death#SIG}" $program ;;
    Ctrl-Z) kill -s TSTP $program ;;
    'closed terminal') kill -s KILL $program ;; # that is who has the terminal's other end
    'no descriptor') prlimit --nofile=0 --pid $program ;;
    'no memory') prlimit --as=1 --pid $program ;;
    esac
}
# Is this one of those that the motion outlives?
goes_on() {
    case $death in
    SIGXFSZ | 'full disk' | 'no descriptor' | 'no memory') ;;
    *) return 1 ;;
    esac
}
look_at_all() {
    tell look && wait_for looked_at && tail -n +"$((tell_lines + 1))" "$work/sim.log" >"$work/look"
}
all_stand() {
    look_at_all && ! grep -q ', moving' "$work/look"
}
# Nothing follows on the wire: whoever stopped the joints has released the port, or is suspended.
has_done() {
    case $death in
    Ctrl-Z) case $(ps -o stat= -p $program) in T*) ;; *) return 1 ;; esac ;;
    *) flock -n "$robot" true ;;
    esac
}
# What is left of the program, and the guard, are waited for.
ends() {
    case $death in
    SIGSTOP | Ctrl-Z) kill -s KILL $program ;;
    esac
    wait $program 2>/dev/null
    wait_for exits 0 "$GRCTL" -d "$robot" --wiring "$wiring" --timeout 500 status m5
}

# died DEATH COMMAND WIRING: its row without times in $work/row, those in $work/times.
died() {
    death=$1
    command=$2
    wiring=$3
    prepare
    start_told_sim --wiring "$wiring" --trace "$work/wire.pcapng" || return 1
    command_of
    wait_for is_moving || { cat "$work/out" "$work/err"; return 1; }
    before=$(wc -c <"$work/wire.pcapng")
    struck=$(date +%s%N)
    strike
    goes_on && wait $program
    status=$?
    sleep 0.5 # a time is what is told; a machine that is busy may need more
    all_stand || { [ "${TOUR_WRITE:-}" != yes ] && wait_for all_stand; } || return 1
    wait_for has_done || return 1
    after=$(wc -c <"$work/wire.pcapng")
    goes_on || ends
    stop_sim
    tell_row
}

# ---- what it left --------------------------------------------------------------------------------

by() {
    case $death in
    SIG[KS][IET]* ) echo guard ;;
    *) echo grctl ;;
    esac
}
# The time of the first chunk behind the first $before bytes of the trace, in us: see pcapng_write.
first_us() {
    tail -c +$((before + 13)) "$work/wire.pcapng" | od -An -tu4 -N8 |
        awk '{ printf "%.0f\n", $1 * 4294967296 + $2 }'
}
state() {
    case $command in
    move) grep '^ *5 ' ;;
    play) cat ;;
    esac <"$work/look" | awk -v command="$command" '
        / torque on /{ on++ }
        { n++; split($0, part, " deg "); split(part[1], word, " "); at = word[3] }
        END {
            printf "%s, torque %s", command == "play" ? n " joints stand" \
                : at == -110 ? "R_ELBOW_P stands at its goal" : "R_ELBOW_P stands on its way", \
                on == n ? "on" : "of " on + 0 " on"
        }'
}
tell_row() {
    head -c "$before" "$work/wire.pcapng" >"$work/head.pcapng"
    head -c "$after" "$work/wire.pcapng" >"$work/whole.pcapng"
    "$GRCTL" decode --wiring "$wiring" "$work/head.pcapng" 2>/dev/null >"$work/head"
    "$GRCTL" decode --wiring "$wiring" "$work/whole.pcapng" 2>/dev/null >"$work/whole"
    how_it_ended=$(by)
    ! goes_on || how_it_ended="goes on, exit status $status"
    awk -v n0="$(wc -l <"$work/head")" -v by="$how_it_ended" -v first_us="$(first_us)" \
        -v struck_us="$((struck / 1000))" -v times="$work/times" '
        # How a phase is told: joints that were read, and sent somewhere. One that was read first is
        # of the readings in the background.
        function end_phase() {
            if (phase == "read" && n > (said == "")) {
                said = said (said == "" ? "" : ", ") n " read"
            } else if (phase == "sent") {
                said = said (said == "" ? "" : ", ") "stopped softly"
            }
            phase = ""
            n = 0
            split("", seen)
        }
        # A guard halts a joint as soon as it has read it, and may repeat that: how many joints it
        # read, how many of these it stopped, and whether it read all of those behind that.
        function what_the_guard_did(  i, reads, stops, owed) {
            for (i in read_by_it) { reads++ }
            for (i in stopped_by_it) { stops++; owed += stopped_by_it[i] }
            return reads " read" (stops == 0 ? "" : ", " stops " stopped, " \
                (owed == 0 ? "read again" : owed " not read again"))
        }
        NR == n0 { last = $1 }
        NR == n0 + 1 { first = $1 }
        $2 == "host" && / goal/ && /write/ {
            goal_ms = $1
            goal = "20 joints"
            if (match($0, /servo [0-9]+ \([A-Z_]+\)/)) {
                goal = substr($0, RSTART, RLENGTH)
                sub(/.*\(/, "", goal)
                sub(/\)/, "", goal)
                if (by == "guard" && NR > n0 && match($0, /goal_time [0-9]+ ms/)) {
                    goal = goal ", in" substr($0, RSTART + 9, RLENGTH - 9)
                }
            }
        }
        NR <= n0 || by ~ /^goes on/ { next }
        # What was on its way when it died does not count: the guard waits for a quiet line.
        by == "guard" && !begun {
            begun = $1 - last >= 40 && /read No.30-53 of servo/
            last = $1
            if (!begun) {
                next
            }
        }
        $2 == "host" && /read No.30-53 of servo/ {
            if (phase != "read") {
                end_phase()
                phase = "read"
            }
            match($0, /servo [0-9]+/)
            id = substr($0, RSTART + 6, RLENGTH - 6)
            read_by_it[id] = 1
            if (id in stopped_by_it) {
                stopped_by_it[id] = 0
            }
            n += !(id in seen)
            seen[id] = 1
        }
        $2 == "host" && / goal/ && /write/ {
            if (phase != "sent") {
                end_phase()
                phase = "sent"
            }
            if (match($0, /servo [0-9]+/)) {
                stopped_by_it[substr($0, RSTART + 6, RLENGTH - 6)] = 1
            } else { # several in one frame: none of these deaths leaves so many moving
                stopped_by_it["several"] = 1
            }
            n += match($0, /write [0-9]+ servos/) ? substr($0, RSTART + 6, RLENGTH - 13) : 1
        }
        END {
            end_phase()
            if (by == "guard") {
                said = what_the_guard_did()
            }
            printf "%-37s %-22s", by ~ /^goes on/ ? by : by ": " said, goal
            printf "%.0f", (first_us + (goal_ms - first) * 1000 - struck_us) / 1000 >times
        }' "$work/whole" >"$work/row"
    state >>"$work/row"
}

# ---- all of them ---------------------------------------------------------------------------------

missing=
for tool in prlimit unshare script flock; do
    command -v $tool >/dev/null 2>&1 || missing=$tool
done
unshare -Urm true 2>/dev/null || missing='a user namespace of its own'
[ -z "${EMULATOR:-}" ] || missing='a process that is not emulated'
if [ -n "$missing" ]; then
    echo "1..0 # SKIP needs $missing"
    exit
fi

# as_told: its row is one of the guide's.
as_told() {
    block "$guide" deaths | awk -v head="$(printf '%-15s  %-4s  ' "$death" "$command")" \
        -v wiring="$wiring" -v row="$(cat "$work/row")" '
        index($0, head) == 1 && index($0, wiring) && index($0, row) { found = 1 }
        END { exit !found }'
}
end_case() {
    [ -z "$program" ] || kill -s KILL $program 2>/dev/null
    stop_sim
}
# On a busy machine a death comes late, and what was read until then is told too, or a move ends
# before it is seen: once more then.
case_of() {
    work=$here/$n
    sim_place="--link $work/robot"
    sim_pid=
    program=
    trap end_case EXIT
    for _ in 1 2 3; do
        end_case
        rm -rf "$work"
        mkdir "$work"
        died "$@" >"$work.log" 2>&1 && : >"$work/ok"
        [ "${TOUR_WRITE:-}" != yes ] && { [ ! -e "$work/ok" ] || ! as_told; } || break
    done
}
# What AddressSanitizer does itself without memory is no deed of ours.
left=
! grep -q __asan_init "$GRCTL" || left='no memory'
n=0
while IFS='|' read -r death command; do
    [ "$death" != "$left" ] || continue
    for wiring in board bus; do
        n=$((n + 1))
        (case_of "$death" "$command" "$wiring") &
        echo "$death|$command|$wiring" >"$here/name$n"
        [ $((n % at_a_time)) -ne 0 ] || wait
    done
done <<EOF
SIGKILL|play
SIGKILL|move
SIGSEGV|play
SIGSEGV|move
SIGSTOP|play
SIGSTOP|move
Ctrl-Z|play
Ctrl-Z|move
closed terminal|play
closed terminal|move
SIGXFSZ|play
SIGXFSZ|move
full disk|play
full disk|move
no descriptor|play
no descriptor|move
no memory|play
no memory|move
EOF
wait

# A row for both wirings where they do alike, else one for each.
row() {
    printf '%-15s  %-4s  %-10s  %s  %s\n' "$death" "$command" "$1" "$2" "$3"
}
i=1
while [ $i -lt $n ]; do
    death=$(cut -d '|' -f 1 "$here/name$i")
    command=$(cut -d '|' -f 2 "$here/name$i")
    board=$here/$i
    bus=$here/$((i + 1))
    for one in "$board" "$bus"; do
        name="$death of $command, $(cut -d '|' -f 3 "$here/name${one##*/}")"
        test_that "$name" test -e "$one/ok"
        [ -e "$one/ok" ] || sed 's/^/# /' "$one.log"
    done
    if cmp -s "$board/row" "$bus/row"; then
        row 'board, bus' "$(cat "$board/row")" "$(cat "$board/times") ms, $(cat "$bus/times") ms"
    else
        row board "$(cat "$board/row")" "$(cat "$board/times") ms"
        row bus "$(cat "$bus/row")" "$(cat "$bus/times") ms"
    fi >>"$here/rows"
    i=$((i + 2))
done
{
    printf '%-15s  %-4s  %-10s  %-37s %-22s%-40s  %s\n' death of wiring 'then on the wire' \
        'last goal for' 'joints 500 ms later' 'last goal sent after it'
    cat "$here/rows"
} >"$here/table"
work=$here

# untimed: without the times, which are the last column.
untimed() {
    sed 's/ *-\{0,1\}[0-9]* ms\(, -\{0,1\}[0-9]* ms\)\{0,1\}$//'
}
is_true() {
    block "$guide" deaths | untimed | grep -v "^${left:-none left out}" >"$here/told"
    untimed <"$here/table" | diff "$here/told" -
}
[ "${TOUR_WRITE:-}" != yes ] || [ "$(ls "$here"/*/ok | wc -l)" -ne "$n" ] ||
    replace_block "$guide" deaths "$here/table"
test_that "the guide shows them as they are" is_true
if [ -n "$left" ]; then
    test_case "$left"
    skip "$left" 'AddressSanitizer is in this build'
fi
done_testing
